"""A bar on the terminal with rate and time left; silent where nobody looks."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn


@contextmanager
def row_progress(rows: int) -> Iterator[Callable[[int], None]]:
    """Told of finished rows, it draws how far they are; on standard error, if that is a screen."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield lambda _: None
        return
    rate = TextColumn("{task.completed}/{task.total} rows, {task.fields[speed]:.0f}/s")
    with Progress(
        BarColumn(), rate, TimeRemainingColumn(), console=console, transient=True
    ) as progress:
        task = progress.add_task("rows", total=rows, speed=0.0)

        def advance(count: int) -> None:
            progress.advance(task, count)
            speed = progress.tasks[0].speed or 0.0
            progress.update(task, speed=speed)

        yield advance
