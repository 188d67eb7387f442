"""A server of the page as a process of its own, and a chromium to look at it.

Tests, benchmarks and photographs share it.
"""

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

COMMAND = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from chromanoise.cli import main; main()"
)
"""The command line with Ctrl-C, which a shell takes from what it starts in the background."""

_ENDING_S = 60.0


def started(
    *arguments: object, port: int | str = 0, stderr: int | None = None
) -> subprocess.Popen[str]:
    """The process of ``chromanoise serve``; the first word that it prints is its address.

    Parameters
    ----------
    arguments
        Of the command.
    port
        To listen on; 0 for any that is free.
    stderr
        As `subprocess.Popen` takes it.
    """
    return subprocess.Popen(
        [sys.executable, "-c", COMMAND, "serve", "--port", str(port), *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=stderr,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )


def stopped(process: subprocess.Popen[str]) -> None:
    """End a server as Ctrl-C does, or by force where that does not end it."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    try:
        process.communicate(timeout=_ENDING_S)
    finally:
        process.kill()


@contextmanager
def served(*arguments: object, port: int | str = 0) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """The address of a server that lives as long as the context, and its process.

    Parameters
    ----------
    arguments, port
        As `started`.
    """
    process = started(*arguments, port=port)
    try:
        assert process.stdout is not None
        yield process.stdout.readline().split()[0], process
    finally:
        stopped(process)


def chromium_path() -> str | None:
    """Where a chromium is; ``None`` where there is none."""
    return shutil.which("chromium") or shutil.which("chromium-browser")
