"""Messages and progress of a study during the computation."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from pathlib import Path

import click

from chromanoise.cli.progress import progress_of
from chromanoise.imaging import Work
from chromanoise.study import Step, Study, run_study


def print_run(study: Study, out: Path, threads: int | None, place: Path | None = None) -> None:
    """Run a study whose file names are relative to ``place``, and print the files it writes."""

    def report(what: str, done: bool) -> None:
        click.echo(f"{what}{' (already done)' if done else ''}", err=True)

    work = Work(threads=threads)
    for file in run_study(
        study, out, work=work, report=report, progress=progress_of_step, place=place
    ):
        click.echo(file)


def progress_of_step(step: Step) -> AbstractContextManager[Callable[[int], None]]:
    """Progress of a step of a study."""
    return progress_of(step.what, step.parts, step.unit)
