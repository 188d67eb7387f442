"""Call functions of other libraries in a child process with limits on time and memory.

On a damaged file a library may crash, loop or exhaust the memory, which ``except`` cannot prevent.
The child process is started for the first file and then reused, so that modules are imported only
once. It is replaced after a failure, because the state of the library is then unknown.
"""

import atexit
import contextlib
import errno
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
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, NoReturn, TypeVar

from chromanoise.base.errors import InputError

Result = TypeVar("Result")

LIMIT_S = 20.0
"""Time limit of a call. [s]"""
MEMORY_BYTES = 2**30
"""Memory limit of a call; enforced on Linux only. [bytes]"""
FAILED, NO_MEMORY = 70, 71
"""Exit codes of child processes."""
_ALARM = getattr(signal, "SIGALRM", None)  # not on Windows
TOO_LONG = 1 if _ALARM is None else -_ALARM
"""Exit code of a child process that `stopped_after` has ended."""
_ENDING_S = 2.0
_LARGEST_HEAP_ARRAY_BYTES = 31 << 20
_STATM = Path("/proc/self/statm")
_DATA = 5  # index of the field


def sandboxed(
    function: Callable[..., Result],
    *given: Any,
    path: Path,
    limit_s: float = LIMIT_S,
    memory_bytes: int = MEMORY_BYTES,
) -> Result:
    """Call ``function(*given)`` in the child process and return its result.

    Parameters
    ----------
    function
        A function of an importable module, because it is passed by name.
    given
        Arguments of the function.
    path
        The file that the function reads, for error messages. A relative path refers to the working
        folder.
    limit_s
        Time limit of the call. [s]
    memory_bytes
        Memory limit of the call; enforced on Linux only. [bytes]

    Raises
    ------
    InputError
        If the function raises one, or the child process cannot be started.
    MemoryError
        If the call exceeds the memory limit.
    ValueError
        If the function raises another exception, crashes the process, or exceeds the time limit.
    """
    return _child(os.getpid()).returned(function, given, path, limit_s, memory_bytes)


def close_sandbox() -> None:
    """End the child process; the next call starts a new one."""
    _child(os.getpid()).close()


def started_python(program: str, *arguments: str, **options: Any) -> "subprocess.Popen[bytes]":
    """Start another Python process with the same import path.

    Parameters
    ----------
    program
        Source text that the process runs.
    arguments
        Its ``sys.argv[1:]``.

    Raises
    ------
    RuntimeError
        If this program cannot start another Python, e.g. because it is frozen.
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
    """Wait for a process to end and return its exit code; kill it after 2 s."""
    try:
        return process.wait(_ENDING_S)
    except subprocess.TimeoutExpired:
        process.kill()
        return process.wait()


def exit_after(served: Callable[[], None]) -> NoReturn:
    """Call ``served`` and end this process; print a traceback to stderr if the call fails."""
    code = FAILED
    try:
        served()
        code = 0
    except BaseException as error:
        if is_out_of_memory(error):
            code = NO_MEMORY
        else:
            traceback.print_exc()
    finally:
        os._exit(code)  # without cleanup, in which a library may crash or loop


@contextlib.contextmanager
def stopped_after(limit_s: float) -> Iterator[None]:
    """End this process after ``limit_s`` [s], even if a library loops and holds the lock."""
    if _ALARM is None:
        with open(os.devnull, "w") as nowhere:  # noqa: PTH123
            faulthandler.dump_traceback_later(limit_s, exit=True, file=nowhere)
            try:
                yield
            finally:
                faulthandler.cancel_dump_traceback_later()
        return
    # not faulthandler, which may crash while it reads the frames of a thread that runs
    signal.signal(_ALARM, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, limit_s)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


@cache
def keep_freed_memory() -> None:
    """Let this process use freed memory again instead of asking the system for new pages.

    After an array of up to 32 MiB was freed, glibc takes arrays of that size from the heap, and
    keeps up to twice that size of freed memory. New pages took a third of the time of a verdict,
    and half of the time of a characterization.
    """
    if sys.platform == "linux":
        bytes(_LARGEST_HEAP_ARRAY_BYTES)  # new pages of zeros: not written, they take no memory


def held_bytes() -> int:
    """Data memory of this process; Linux only. [bytes]"""
    return int(_STATM.read_text().split()[_DATA]) * os.sysconf("SC_PAGE_SIZE")


class _Child:
    """One child process, used by one thread at a time."""

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
            except (OSError, EOFError, pickle.UnpicklingError):  # it ended without a reply
                raise _fault(self._exit_code(), limit_s) from None
            except BaseException:  # Ctrl-C or MemoryError: its reply will not be read
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
            self._exit_code()  # another program ended it
        if self._process is None:
            pipe = subprocess.PIPE
            try:
                self._process = started_python(
                    _PROGRAM, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL
                )
            except (RuntimeError, OSError):
                raise InputError(
                    str(path),
                    "cannot be read, because this program cannot start a second Python process",
                    remedy="store it as ENVI or .npy, which are read in place",
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


def set_limit(name: str, value: float) -> None:
    """Limit this process, such as its ``RLIMIT_DATA``, within its hard limit; not on Windows."""
    import resource

    what = getattr(resource, name)
    hard = resource.getrlimit(what)[1]
    soft = hard if math.isinf(value) else math.ceil(value)
    resource.setrlimit(what, (soft if hard == resource.RLIM_INFINITY else min(soft, hard), hard))


def is_out_of_memory(error: BaseException) -> bool:
    """Whether an error, or one that it followed from, says that memory ran out."""
    chain: BaseException | None = error
    while chain is not None:
        # an import raises an OSError or ImportError with the text of the system
        if isinstance(chain, MemoryError) or os.strerror(errno.ENOMEM) in str(chain):
            return True
        chain = chain.__cause__ or chain.__context__
    return False


@cache
def _child(pid: int) -> _Child:
    """The child of process ``pid``; a fork must not read replies meant for its parent."""
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
    if code == TOO_LONG:
        return ValueError(f"its library does not return within {limit_s:g} s")
    return ValueError(f"its library crashes, exit code {code}")


# in the child process

_PROGRAM = "from chromanoise.base.sandbox import main; main()"


def main() -> None:
    """Process calls until the parent process ends."""
    exit_after(_answer_calls)


def _answer_calls() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent process handles Ctrl-C
    _keep_memory_limit()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    reads, writes = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(nowhere, 1)  # what a library prints
    while True:
        try:
            function, given, folder, limit_s, memory_bytes = pickle.load(reads)
        except EOFError:
            return
        _bound(limit_s, memory_bytes)
        with stopped_after(limit_s):
            answer = _answer(function, given, folder)
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
    except Exception as error:  # libraries may raise any exception
        if is_out_of_memory(error):
            return "no memory", None
        from chromanoise.base.check import reason  # here, because it imports numpy

        return "failed", reason(error)


def _keep_memory_limit() -> None:
    """Keep the memory limit of the parent process, which it may have set for one job."""
    if sys.platform == "linux":
        import resource

        soft, _ = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(resource.RLIMIT_DATA, (soft, soft))


def _bound(limit_s: float, memory_bytes: int) -> None:
    """Limit memory and CPU time of the next call, within the limits of the parent process."""
    if sys.platform != "linux":
        return
    set_limit("RLIMIT_CORE", 0)
    set_limit("RLIMIT_DATA", held_bytes() + memory_bytes)
    whole_s = time.process_time() + limit_s * (os.cpu_count() or 1)  # threads count
    set_limit("RLIMIT_CPU", math.ceil(whole_s) + 1)
