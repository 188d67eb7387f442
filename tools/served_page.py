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

_COMMAND = "from chromanoise.cli import main; main()"
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
        [sys.executable, "-c", _COMMAND, "serve", "--port", str(port), *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=stderr,
        text=True,
        env=os.environ | {"PYTHONUNBUFFERED": "1"},
    )


def stopped(process: subprocess.Popen[str]) -> None:
    """End a server as Ctrl-C does."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    process.communicate(timeout=_ENDING_S)


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
