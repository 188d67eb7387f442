"""The command line: parse options, call the library, print the result."""

import gc
import os
from collections.abc import Iterator
from contextlib import contextmanager


def main(arguments: list[str] | None = None) -> None:
    """The command ``chromanoise``; Ctrl-C during the imports prints no traceback."""
    # pydantic has no plugins here, and looks for them in the metadata of every package
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    # matrices are small: more threads cost a third more processor time and save none
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    gc.set_threshold(20_000)  # results are kept: more collections would free little
    try:
        with paused_collection():
            from chromanoise.cli.entry import run
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    run(arguments)


@contextmanager
def paused_collection() -> Iterator[None]:
    """Pause the garbage collector during imports.

    Objects created during an import are kept, so that a collection frees nothing. Collections took
    a seventh of the time of `chromanoise analyze`.
    """
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


__all__ = ["main", "paused_collection"]
