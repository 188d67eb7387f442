"""The command line in its own process, which always ends with the test."""

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress
from pathlib import Path

import httpx

import chromanoise
from served_page import COMMAND

IGNORING = COMMAND.replace("signal.default_int_handler", "signal.SIG_IGN")
"""The command as a shell starts it in the background: with SIGINT ignored."""


def printed(script, *arguments, cwd=None, **variables):
    """What a script prints in a process of its own, which must succeed."""
    done = subprocess.run(
        [sys.executable, "-c", script, *map(str, arguments)], cwd=cwd, env=_with(variables),
        capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def _with(variables):
    """The environment, where this package is found, with further variables."""
    return {**os.environ, "PYTHONPATH": str(Path(chromanoise.__file__).parents[1]), **variables}


def is_running(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@contextmanager
def command(*arguments, script=COMMAND, **variables):
    """A process of the command, in a process group of its own that ends with the context."""
    process = subprocess.Popen(
        [sys.executable, "-c", script, *map(str, arguments)], env=_with(variables),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        yield process
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def wait_for(happened, process, *, seconds=300):
    """Wait until a function of no arguments is true, while a process lives."""
    end = time.monotonic() + seconds
    while not happened():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end
        time.sleep(0.02)


class Patient(httpx.HTTPTransport):
    """Sends a request again where the server of the page is too busy (503), as the page does."""

    def handle_request(self, request):
        end = time.monotonic() + 600
        while True:
            reply = super().handle_request(request)
            if reply.status_code != 503 or time.monotonic() > end:
                return reply
            reply.close()
            time.sleep(float(reply.headers.get("Retry-After", 0.5)))
