"""The computations behind the routes of the page, and the process that answers with them.

The process has limits of time and memory.
"""

import contextlib
import math
import os
import pickle
import signal
import socket
import struct
import sys
import time
import traceback
from functools import partial
from typing import Any, BinaryIO

from chromanoise.base import (
    InputError,
    exit_after,
    held_bytes,
    is_out_of_memory,
    keep_freed_memory,
    set_limit,
    stopped_after,
)
from chromanoise.imaging import watch_compiling
from chromanoise.web.page_questions import QuestionError
from chromanoise.web.services import Services
from chromanoise.web.uploads import Kept, Upload

_SIZE = struct.calcsize("q")
_EXIT_S = 1.0  # a process that has closed its channel needs less


def main() -> None:
    """Fork workers or answer questions until the server ends."""
    if sys.argv[1] == "forks":
        _forking(socket.socket(fileno=0))
        os._exit(0)  # at once: nothing is left to clean up
    reads, writes = sys.stdin.buffer, sys.stdout.buffer
    (size,) = struct.unpack("q", reads.read(_SIZE))
    study = reads.read(size)
    exit_after(
        lambda: _Answering(Services(Kept(), study=pickle.loads(study)), reads, writes, None).serve()
    )


def _forking(control: socket.socket) -> None:
    (size,) = struct.unpack("q", control.recv(_SIZE, socket.MSG_WAITALL))
    services = Services(Kept(), study=pickle.loads(control.recv(size, socket.MSG_WAITALL)))
    with contextlib.suppress(QuestionError, InputError):  # reported to the request that needs it
        services.warm()
    children: dict[int, int] = {}
    while True:
        message, ends, *_ = socket.recv_fds(control, 2 * _SIZE, 1)
        if not message:
            for child in children.values():
                _exit_code(child, wait_s=0.0)
            return
        number, memory_bytes = struct.unpack("qq", message)
        if not ends:
            code = _exit_code(children.pop(number), wait_s=_EXIT_S)
            with contextlib.suppress(OSError):  # the server is gone, as the next message shows
                control.sendall(struct.pack("q", code))
            continue
        child = os.fork()
        if child == 0:
            control.close()
            exit_after(partial(_child, services, ends[0], memory_bytes))
        with contextlib.suppress(OSError):  # the child may have been quicker
            os.setpgid(child, child)
        os.close(ends[0])
        children[number] = child


def _exit_code(child: int, *, wait_s: float) -> int:
    """End a child, and whatever it started, such as the process that reads HDF5 files.

    Returns its exit code, or the negative number of the signal that ended it.
    """
    end = time.monotonic() + wait_s
    while not os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT):
        if time.monotonic() >= end:
            break
        time.sleep(0.002)
    with contextlib.suppress(OSError):
        os.killpg(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _child(services: Services, end: int, memory_bytes: int) -> None:
    with contextlib.suppress(OSError):
        os.setpgid(0, 0)
    keep_freed_memory()
    set_limit("RLIMIT_CORE", 0)
    with socket.socket(fileno=end) as channel:
        reads, writes = channel.makefile("rb"), channel.makefile("wb")
        _Answering(services, reads, writes, memory_bytes).serve()


class _Answering:
    """The services, the streams to the server, and the memory of a job; ``None``: no limits."""

    def __init__(
        self, services: Services, reads: BinaryIO, writes: BinaryIO, memory_bytes: int | None
    ) -> None:
        self._services, self._reads, self._writes = services, reads, writes
        self._memory_bytes = memory_bytes
        self._prepared_bytes = 0 if memory_bytes is None else held_bytes()
        self._limit_s, self._kernels, self._began_s = math.inf, 0, 0.0

    def serve(self) -> None:
        """Answer until the server ends, or until another process should replace this one."""
        with watch_compiling(self._compiling):
            self._serve()

    def _serve(self) -> None:
        while (asked := self._asked()) is not None:
            name, kept, given, cpu_s, limit_s = asked
            answer = self._prepared(kept, (name, *given))
            self._tell("begins")
            if answer[0] == "done":
                self._bound(cpu_s)
                with stopped_after(limit_s):
                    answer = answered(self._services, name, kept, given)
            is_spent = answer[0] in ("no memory", "failed") or self._is_spent(cpu_s)
            self._tell((answer, is_spent))
            if is_spent:
                return

    def _prepared(self, kept: tuple[Upload, ...], given: tuple[Any, ...]) -> tuple[Any, ...]:
        """Prepare a job without limits: what the libraries need is not what a user asks for."""
        if self._memory_bytes is None:
            return answered(self._services, "prepare", kept, given)
        self._limit_s = math.inf
        set_limit("RLIMIT_CPU", math.inf)
        set_limit("RLIMIT_DATA", math.inf)
        before = held_bytes()
        answer = answered(self._services, "prepare", kept, given)
        self._prepared_bytes += max(0, held_bytes() - before)
        return answer

    def _bound(self, cpu_s: float) -> None:
        """Limit this process and those that it starts from now on."""
        if self._memory_bytes is not None:
            self._limit_s = time.process_time() + cpu_s
            set_limit("RLIMIT_CPU", self._limit_s)
            set_limit("RLIMIT_DATA", self._prepared_bytes + self._memory_bytes)

    def _compiling(self, is_begin: bool) -> None:
        """CPU time in which a kernel is compiled does not count; elapsed time does."""
        if math.isinf(self._limit_s):
            return
        if is_begin and self._kernels == 0:
            self._began_s = time.process_time()
            set_limit("RLIMIT_CPU", math.inf)
        self._kernels += 1 if is_begin else -1
        if self._kernels == 0:
            self._limit_s += time.process_time() - self._began_s
            set_limit("RLIMIT_CPU", self._limit_s)

    def _is_spent(self, cpu_s: int) -> bool:
        """Whether a new process should replace it: its child processes inherit its CPU time."""
        if self._memory_bytes is None:
            return False
        most = self._prepared_bytes + self._memory_bytes // 2
        return held_bytes() > most or time.process_time() > cpu_s

    def _asked(self) -> tuple[str, tuple[Upload, ...], tuple[Any, ...], int, float] | None:
        try:
            return pickle.load(self._reads)
        except (EOFError, OSError, pickle.UnpicklingError):  # the server is gone
            return None

    def _tell(self, what: Any) -> None:
        with contextlib.suppress(OSError):  # the server has ended; the next read finds out
            pickle.dump(what, self._writes)
            self._writes.flush()


def answered(
    services: Services, name: str, kept: tuple[Upload, ...], given: tuple[Any, ...]
) -> tuple[Any, ...]:
    """How a job ended (done, refused, failed, no memory), and what it returned.

    Parameters
    ----------
    services
        The services that compute.
    name, given
        One of its methods, and the arguments.
    kept
        Files that the question may name.
    """
    services.uploads.hold(kept)
    try:
        return "done", getattr(services, name)(*given)
    except QuestionError as error:
        return "refused", error.faults, error.status
    except RecursionError:
        return "refused", (("", "request JSON is nested too deeply"),), 400
    except Exception as error:
        # a SystemError: where an import runs out of memory
        if isinstance(error, SystemError) or is_out_of_memory(error):
            return ("no memory",)
        return "failed", traceback.format_exc()
