"""``chromanoise run``."""

from pathlib import Path

import click

from chromanoise.cli.options import WHOLE
from chromanoise.cli.parsing import command
from chromanoise.cli.running import print_run
from chromanoise.study import read_study


@command()
@click.argument("study", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    help="Output folder. [default: out/<name of STUDY>]",
)
@click.option(
    "--set",
    "changes",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change one value, e.g. light.level_lux=3 or sensors.0.name=onyx-rgb; repeatable.",
)
@click.option("--threads", type=WHOLE, help="Threads for pictures. [default: one per core]")
def run(study: Path, out: Path | None, changes: tuple[str, ...], threads: int | None) -> None:
    """Run all of STUDY, a TOML file as `chromanoise init` writes it.

    If a run was stopped, the same command computes the missing results. If a run ends with an
    error, the folder stays as it was. Every result records version, study, seed and hash;
    `chromanoise rerun` runs the study of a result again and compares the results.
    """
    print_run(
        read_study(study, changes, change_label="--set"), out or Path("out") / study.stem, threads
    )
