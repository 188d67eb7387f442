"""Functions of other libraries, called in a child process with limits of time and memory.

On a damaged file a library may crash, loop or take all memory, which no ``except`` can prevent. The
child process is started with the first file and then kept, so that imports are paid once. It is
replaced after a failure, because a library may be in any state after a damaged file.
"""

import atexit
import contextlib
import faulthandler
import math
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from chromanoise._check import reason
from chromanoise.errors import InputError

Result = TypeVar("Result")

LIMIT_S = 20.0
"""How long a call may take. [s]"""
MEMORY_BYTES = 2**30
"""Memory that a call may take; limited on Linux only. [bytes]"""
WATCHDOG, FAILED, NO_MEMORY = 1, 70, 71
"""Exit codes of child processes; faulthandler sets the first."""
_ENDING_S = 2.0
_STATM = Path("/proc/self/statm")
_DATA = 5  # its number there


def sandboxed(
    function: Callable[..., Result],
    *given: Any,
    path: Path,
    limit_s: float = LIMIT_S,
    memory_bytes: int = MEMORY_BYTES,
) -> Result:
    """What ``function(*given)`` returns, called in the child process.

    Parameters
    ----------
    function
        Of a module that can be imported, since it is passed by its name.
    given
        Its arguments.
    path
        The file that it reads, for error messages; where relative, to the working folder.
    limit_s
        How long the call may take. [s]
    memory_bytes
        Memory that it may take; limited on Linux only. [bytes]

    Raises
    ------
    InputError
        If the function raises one, or no child process can be started.
    MemoryError
        If the memory does not suffice.
    ValueError
        If the function raises another exception, with its reason; or if it crashes the process, or
        does not return in time.
    """
    return _child(os.getpid()).returned(function, given, path, limit_s, memory_bytes)


def close_sandbox() -> None:
    """End the child process; the next call starts another one."""
    _child(os.getpid()).close()


def started_python(program: str, *arguments: str, **options: Any) -> "subprocess.Popen[bytes]":
    """Another Python that imports what this one can import.

    Parameters
    ----------
    program
        Its source text.
    arguments
        In its ``sys.argv[1:]``.
    options
        Of `subprocess.Popen`.

    Raises
    ------
    RuntimeError
        If this Python is part of a program that cannot start another Python.
    """
    if not sys.executable or getattr(sys, "frozen", False):
        raise RuntimeError("this program cannot start a second Python")
    return subprocess.Popen(
        # -P: do not import from the working folder
        [sys.executable, "-P", "-W", "ignore", "-c", program, *arguments],
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join(entry for entry in sys.path if entry),
            "OPENBLAS_NUM_THREADS": os.environ.get("OPENBLAS_NUM_THREADS", "1"),
        },
        **options,
    )


def exit_code(process: "subprocess.Popen[bytes]") -> int:
    """That of a process that should end soon; it is killed if it does not."""
    try:
        return process.wait(_ENDING_S)
    except subprocess.TimeoutExpired:
        process.kill()
        return process.wait()


def exit_after(served: Callable[[], None]) -> NoReturn:
    """End this process, with a traceback on stderr where ``served`` failed."""
    code = FAILED
    try:
        served()
        code = 0
    except MemoryError:
        code = NO_MEMORY
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)  # at once: a library may crash or loop while it ends, too


def held_bytes() -> int:
    """Memory that this process holds; on Linux only. [bytes]"""
    return int(_STATM.read_text().split()[_DATA]) * os.sysconf("SC_PAGE_SIZE")


class _Child:
    """One child process, which is asked by one thread at a time."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: subprocess.Popen[bytes] | None = None

    def returned(
        self,
        function: Callable[..., Any],
        given: tuple[Any, ...],
        path: Path,
        limit_s: float,
        memory_bytes: int,
    ) -> Any:
        folder = "" if path.is_absolute() else str(Path.cwd())
        with self._lock:
            try:
                reads, writes = self._streams(path)
                pickle.dump((function, given, folder, limit_s, memory_bytes), writes)
                writes.flush()
                how, what = pickle.load(reads)
            except (OSError, EOFError, pickle.UnpicklingError):  # it ended before its answer
                raise _fault(self._exit_code(), limit_s) from None
            except BaseException:  # Ctrl-C, or no memory: its answer is not read any more
                self._end()
                raise
            if how in ("no memory", "failed"):
                self._end()
        return _result(how, what)

    def close(self) -> None:
        with self._lock:
            self._end()

    def _streams(self, path: Path) -> tuple[Any, Any]:
        if self._process is not None and self._process.poll() is not None:
            self._exit_code()  # it was ended from outside
        if self._process is None:
            pipe = subprocess.PIPE
            try:
                self._process = started_python(
                    _PROGRAM, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL
                )
            except (RuntimeError, OSError):
                raise InputError(
                    f"{path}: is read by a second Python, which this program cannot start; store "
                    "it as ENVI or .npy, which are read in place"
                ) from None
        return self._process.stdout, self._process.stdin

    def _end(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._exit_code()

    def _exit_code(self) -> int:
        process, self._process = self._process, None
        if process is None:
            return FAILED
        for end in (process.stdin, process.stdout):
            with contextlib.suppress(OSError):
                end.close()  # type: ignore[union-attr]
        return exit_code(process)


@cache
def _child(pid: int) -> _Child:
    """That of this process: a fork of it must not read the answers of its parent's."""
    child = _Child()

    def end() -> None:
        if os.getpid() == pid:
            child.close()

    atexit.register(end)
    return child


def _result(how: str, what: Any) -> Any:
    if how == "no memory":
        raise MemoryError
    if how == "failed":
        raise ValueError(what)
    if how == "refused":
        raise what
    return what


def _fault(code: int, limit_s: float) -> Exception:
    if code == NO_MEMORY:
        return MemoryError()
    if code == WATCHDOG:
        return ValueError(f"its library does not return within {limit_s:g} s")
    return ValueError(f"its library crashes, exit code {code}")


# in the child process

_PROGRAM = "from chromanoise._sandbox import main; main()"


def main() -> None:
    """Answer calls until the parent process ends."""
    exit_after(_answer_calls)


def _answer_calls() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent process decides
    nowhere = os.open(os.devnull, os.O_WRONLY)
    reads, writes = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(nowhere, 1)  # what a library prints
    while True:
        try:
            function, given, folder, limit_s, memory_bytes = pickle.load(reads)
        except EOFError:
            return
        _bound(limit_s, memory_bytes)
        # a thread in C: it acts even while a library loops and holds the interpreter lock
        faulthandler.dump_traceback_later(limit_s, exit=True, file=nowhere)
        answer = _answer(function, given, folder)
        faulthandler.cancel_dump_traceback_later()
        pickle.dump(answer, writes, protocol=5)  # arrays are not copied
        writes.flush()
        del answer


def _answer(function: Callable[..., Any], given: tuple[Any, ...], folder: str) -> tuple[str, Any]:
    try:
        if folder:
            os.chdir(folder)
        return "done", function(*given)
    except InputError as error:
        return "refused", error
    except MemoryError:
        return "no memory", None
    except Exception as error:  # libraries raise anything
        return "failed", reason(error)


def _bound(limit_s: float, memory_bytes: int) -> None:
    """Limit memory and CPU time of the next call, within the limits that the parent has."""
    if sys.platform != "linux":
        return
    import resource

    def limit(what: int, value: int) -> None:
        hard = resource.getrlimit(what)[1]
        resource.setrlimit(
            what, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard)
        )

    limit(resource.RLIMIT_CORE, 0)
    limit(resource.RLIMIT_DATA, held_bytes() + memory_bytes)
    whole_s = time.process_time() + limit_s * (os.cpu_count() or 1)  # threads count
    limit(resource.RLIMIT_CPU, math.ceil(whole_s) + 1)
