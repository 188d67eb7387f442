"""What `run` and `rerun` tell while they work."""

from pathlib import Path

import click

from chromanoise.imaging import Work
from chromanoise.study.runs import Study, run_study


def print_run(study: Study, out: Path, threads: int | None) -> None:
    """Run a study and name its files."""

    def told(what: str, done: bool) -> None:
        click.echo(f"{what}{' (stood there)' if done else ''}", err=True)

    for file in run_study(study, out, work=Work(threads=threads), told=told):
        click.echo(file)
