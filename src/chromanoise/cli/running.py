"""What `run` and `rerun` tell while they work."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import click

from chromanoise.cli.progress import progress_of
from chromanoise.imaging import Work
from chromanoise.study import Step, Study, run_study


def print_run(study: Study, out: Path, threads: int | None, place: Path | None = None) -> None:
    """Run a study whose file names are relative to ``place``, and print the files it writes."""

    def told(what: str, done: bool) -> None:
        click.echo(f"{what}{' (stood there)' if done else ''}", err=True)

    work = Work(threads=threads)
    for file in run_study(study, out, work=work, told=told, progress=_progress, place=place):
        click.echo(file)


def _progress(step: Step) -> AbstractContextManager[Callable[[int], None]]:
    return progress_of(step.what, step.parts, step.unit)
