"""Progress of a computation: an estimate of its duration, and a bar on a terminal."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console

_MEASURED_S = 1.0  # time measured before the total is estimated
_LONG_S = 30.0  # below this, no estimate is printed


@contextmanager
def progress_of(what: str, parts: int, unit: str) -> Iterator[Callable[[int], None]]:
    """Yield a function to be called with each number of newly finished parts, out of ``parts``.

    After the first second of work, a line on standard error gives the estimated total time if that
    is more than half a minute. A terminal also shows a bar.
    """
    console = Console(stderr=True, highlight=False, markup=False, emoji=False, soft_wrap=True)
    start, finished, estimated = time.monotonic(), 0, False
    first: tuple[float, int] | None = None  # the first parts include what is prepared once

    def advance(count: int) -> None:
        nonlocal finished, estimated, first
        finished += count
        now = time.monotonic()
        if first is None:
            first = (now, finished) if finished else None
            return
        if not estimated and finished > first[1] and now - first[0] >= _MEASURED_S:
            estimated = True
            whole = first[0] - start + (now - first[0]) / (finished - first[1]) * (parts - first[1])
            if whole > _LONG_S:
                console.print(f"{what}: takes about {duration(whole)}")

    if not console.is_terminal:
        yield advance
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    rate = TextColumn("{task.completed}/{task.total} " + unit + ", {task.fields[speed]:.0f}/s")
    with Progress(
        BarColumn(), rate, TimeRemainingColumn(), console=console, transient=True
    ) as progress:
        task = progress.add_task(unit, total=parts, speed=0.0)

        def advance_bar(count: int) -> None:
            advance(count)
            progress.advance(task, count)
            speed = progress.tasks[0].speed or 0.0
            progress.update(task, speed=speed)

        yield advance_bar


def duration(seconds: float) -> str:
    """A duration in a readable unit.

    Examples
    --------
    >>> duration(42.3), duration(150.0), duration(90000.0), duration(2e6)
    ('42 s', '2.5 min', '25 h', '23 days')
    """
    for unit, length, most in (("s", 1, 90), ("min", 60, 90 * 60), ("h", 3600, 48 * 3600)):
        if seconds < most:
            return f"{seconds / length:.2g} {unit}"
    return f"{seconds / 86400:.2g} days"
