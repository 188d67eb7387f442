"""``chromanoise init``."""

from pathlib import Path

import click

from chromanoise._files import write_whole
from chromanoise.cli.parsing import command
from chromanoise.errors import InputError
from chromanoise.study import STARTER


@command()
@click.argument("study", type=click.Path(path_type=Path), default=Path("study.toml"))
def init(study: Path) -> None:
    """Write a commented STUDY to start from [default: study.toml]."""
    if study.exists():
        raise InputError(
            str(study), "must not exist yet", remedy=("name another file", "move it away")
        )
    write_whole(study, STARTER.encode("utf-8"))
    click.echo(f"{study}: change it, then `chromanoise run {study}`")
