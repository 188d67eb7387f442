"""``chromanoise init``."""

from pathlib import Path

import click

from chromanoise._files import write_whole
from chromanoise.cli.parsing import command
from chromanoise.errors import InputError
from chromanoise.study import STARTER


@command()
@click.argument("study", required=False, type=click.Path(path_type=Path))
@click.option("--design", is_flag=True, help="Write a design for `chromanoise optimize` instead.")
def init(study: Path | None, design: bool) -> None:
    """Write a commented starter file STUDY [default: study.toml; with --design design.toml]."""
    file = study or Path("design.toml" if design else "study.toml")
    if file.exists():
        raise InputError(
            str(file), "must not exist yet", remedy=("name another file", "move it away")
        )
    text, next_step = STARTER, "run"
    if design:
        from chromanoise.design import DESIGN_STARTER

        text, next_step = DESIGN_STARTER, "optimize"
    write_whole(file, text.encode("utf-8"))
    click.echo(f"{file}: change it, then `chromanoise {next_step} {file}`")
