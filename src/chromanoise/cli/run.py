"""``chromanoise run``."""

from pathlib import Path

import click

from chromanoise.cli.options import WHOLE
from chromanoise.cli.running import print_run
from chromanoise.study import read_study


@click.command()
@click.argument("study", type=click.Path(path_type=Path))
@click.option(
    "-o", "--out", type=click.Path(path_type=Path), help="Folder. [default: out/<name of STUDY>]"
)
@click.option(
    "--set",
    "changes",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change one value, e.g. light.level_lux=3 or sensors.0.name=onyx-rgb; repeatable.",
)
@click.option("--threads", type=WHOLE, help="For pictures. [default: one per core]")
def run(study: Path, out: Path | None, changes: tuple[str, ...], threads: int | None) -> None:
    """Run all of STUDY, a TOML file as `chromanoise init` writes it.

    A run that was stopped goes on where it was. Every result carries version, study, seed and
    hash; `chromanoise rerun` takes any of them, runs its study again and compares the results.
    """
    print_run(
        read_study(study, changes, change_label="--set"), out or Path("out") / study.stem, threads
    )
