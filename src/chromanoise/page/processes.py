"""Worker processes: started once, forked on Linux, ended with the server.

On Linux one process imports and computes what all questions need, and forks the workers: they share
its memory, and a worker that was stopped is replaced in milliseconds. On other systems each worker
is started separately.
"""

import contextlib
import itertools
import pickle
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any, BinaryIO

from chromanoise._sandbox import exit_code, started_python

_SIZE = struct.calcsize("q")
FORKS = sys.platform == "linux"
BEGINS_S = 120.0  # the first picture after an installation compiles for half a minute
_REPLY_S = 10.0
_PROGRAM = "from chromanoise.page.worker import main; main()"


class ProcessEndedError(Exception):
    """A worker process ended without an answer.

    Attributes
    ----------
    seconds
        After which it ended; those in which it was started do not count.
    has_begun
        Whether it had begun to compute.
    exit_code
        As `subprocess.Popen.returncode`; ``None`` where it is not known.
    """

    def __init__(self, seconds: float, *, has_begun: bool, exit_code: int | None) -> None:
        super().__init__(f"the process ended after {seconds:.1f} s")
        self.seconds, self.has_begun, self.exit_code = seconds, has_begun, exit_code


class Worker:
    """One process that computes.

    Attributes
    ----------
    is_spent
        Whether it ended, failed or keeps much memory: another one takes its place.

    Parameters
    ----------
    reads, writes
        Its answers, and its questions.
    interrupt
        Ends what it writes, from another thread.
    ended
        Ends the process, and returns its exit code where that is known.
    """

    def __init__(
        self,
        reads: BinaryIO,
        writes: BinaryIO,
        *,
        interrupt: Callable[[], None],
        ended: Callable[[], int | None],
    ) -> None:
        self._reads, self._writes = reads, writes
        self._interrupt, self._ended = interrupt, ended
        self.is_spent = False

    def asked(self, job: tuple[Any, ...]) -> tuple[Any, ...]:
        """How a job ended, and what it returned.

        Parameters
        ----------
        job
            Its name, the files that it may name, its arguments, and its limits of CPU time and of
            elapsed time [s].

        Raises
        ------
        ProcessEndedError
            If the process ended.
        """
        self.is_spent = True  # until a whole answer has been read
        start, has_begun = time.monotonic(), False
        timer = threading.Timer(BEGINS_S, self.interrupt)
        timer.daemon = True
        timer.start()
        try:
            pickle.dump(job, self._writes)
            self._writes.flush()
            has_begun = pickle.load(self._reads) == "begins"
            timer.cancel()
            start = time.monotonic()
            answer, self.is_spent = pickle.load(self._reads)
            return answer
        except (OSError, EOFError, ValueError, pickle.UnpicklingError):
            seconds = time.monotonic() - start
            raise ProcessEndedError(seconds, has_begun=has_begun, exit_code=self.close()) from None
        finally:
            timer.cancel()
            if self.is_spent:
                self.close()

    def close(self) -> int | None:
        """End the process; its exit code where that is known."""
        if self._reads.closed:
            return None
        for end in (self._writes, self._reads):
            with contextlib.suppress(OSError):
                end.close()
        return self._ended()

    def interrupt(self) -> None:
        """Make the job that another thread waits for fail with `ProcessEndedError`."""
        with contextlib.suppress(OSError):  # it has ended
            self._interrupt()


class Nursery:
    """Starts the worker processes.

    Parameters
    ----------
    study
        The study that the page starts with, as plain data; ``None`` for the default.
    """

    def __init__(self, study: dict[str, Any] | None) -> None:
        self._first = pickle.dumps(study)
        self._started: list[subprocess.Popen[bytes]] = []
        self._control: socket.socket | None = None
        self._numbers = itertools.count()
        self._lock = threading.Lock()
        self._is_closed = False

    def worker(self, memory_bytes: int) -> Worker:
        """A new process.

        Parameters
        ----------
        memory_bytes
            Memory beyond what it starts with; limited on Linux only.

        Raises
        ------
        RuntimeError
            If it cannot be started.
        """
        with self._lock:
            if self._is_closed:
                raise RuntimeError("the server is shutting down")
            return self._forked(memory_bytes) if FORKS else self._alone()

    def close(self) -> None:
        """End all processes."""
        with self._lock:
            self._is_closed = True
            if self._control is not None:
                self._control.close()
        for process in self._started:
            if not FORKS:
                process.kill()
            exit_code(process)
            for end in (process.stdin, process.stdout):
                if end is not None:
                    end.close()

    def _forked(self, memory_bytes: int) -> Worker:
        ours, theirs = socket.socketpair()
        with theirs:
            for attempt in (0, 1):
                try:
                    self._control = self._control or self._mother()
                    number = next(self._numbers)
                    message = struct.pack("qq", number, memory_bytes)
                    socket.send_fds(self._control, [message], [theirs.fileno()])
                    break
                except OSError:  # it has ended: start another one
                    self._control = None
                    if attempt:
                        raise RuntimeError("no process that computes can be started") from None
        with ours:  # the files keep it open
            return Worker(
                ours.makefile("rb"),
                ours.makefile("wb"),
                interrupt=partial(ours.shutdown, socket.SHUT_RDWR),
                ended=partial(self._exit_code, self._control, number),
            )

    def _exit_code(self, control: socket.socket | None, number: int) -> int | None:
        """That of a forked process, after its end; ``None`` where whoever forked it is gone."""
        with self._lock:
            if control is None or self._is_closed or control is not self._control:
                return None
            try:
                control.sendall(struct.pack("qq", number, 0))
                (code,) = struct.unpack("q", control.recv(_SIZE, socket.MSG_WAITALL))
            except (OSError, struct.error):  # it ended, or does not reply in time: another one
                control.close()
                self._control = None
                self._started[-1].kill()
                return None
            return code

    def _mother(self) -> socket.socket:
        ours, theirs = socket.socketpair()
        with theirs:
            self._started.append(_started("forks", stdin=theirs.fileno()))
        ours.settimeout(_REPLY_S)
        ours.sendall(struct.pack("q", len(self._first)) + self._first)
        return ours

    def _alone(self) -> Worker:
        process = _started("alone", stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._started = [one for one in self._started if one.poll() is None] + [process]
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(struct.pack("q", len(self._first)) + self._first)
        return Worker(
            process.stdout,  # type: ignore[arg-type]
            process.stdin,  # type: ignore[arg-type]
            interrupt=process.kill,
            ended=partial(exit_code, process),
        )


def _started(how: str, **ends: int) -> "subprocess.Popen[bytes]":
    try:
        # in a new session Ctrl-C reaches only the server, which ends them
        return started_python(_PROGRAM, how, start_new_session=True, **ends)
    except RuntimeError:
        raise RuntimeError(
            "the page needs worker processes, but this Python cannot start another Python"
        ) from None
