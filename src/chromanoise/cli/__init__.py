"""The command line: read, one library call, write."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager


def main(arguments: list[str] | None = None) -> None:
    """The command ``chromanoise``; quiet even when it is stopped while it still imports."""
    try:
        with paused_collection():
            from chromanoise.cli.entry import run
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    run(arguments)


@contextmanager
def paused_collection() -> Iterator[None]:
    """Pause the garbage collector during imports.

    What a module creates at its import stays, so that collections find nothing. They took a
    seventh of the time of `chromanoise analyze`.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


__all__ = ["main", "paused_collection"]
