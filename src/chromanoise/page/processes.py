"""Processes that compute: started once, forked where that can be done, gone with the server.

On Linux one process imports and computes what all questions need, and forks the others: they share
its memory, and one that was stopped is replaced in milliseconds. Elsewhere each is started alone.
"""

import contextlib
import os
import pickle
import socket
import struct
import subprocess
import sys
import threading
import time
from typing import Any, BinaryIO

FORKS = sys.platform == "linux"
_ENDING_S = 2.0  # whoever forks needs longer only while it imports and has no children yet
_PROGRAM = "from chromanoise.page.worker import main; main()"


class ProcessEndedError(Exception):
    """A process that ended in place of an answer.

    Attributes
    ----------
    seconds
        After which it ended; those in which it was started do not count.
    """

    def __init__(self, seconds: float) -> None:
        super().__init__(f"the process ended after {seconds:.1f} s")
        self.seconds = seconds


class Worker:
    """One process that computes.

    Attributes
    ----------
    is_spent
        Whether it ended, or keeps much memory: another one takes its place.

    Parameters
    ----------
    reads, writes
        Its answers, and its questions.
    """

    def __init__(self, reads: BinaryIO, writes: BinaryIO) -> None:
        self._reads, self._writes = reads, writes
        self.is_spent = False

    def asked(self, job: tuple[Any, ...]) -> tuple[Any, ...]:
        """How a job ended, and what it returned.

        Parameters
        ----------
        job
            Its name, the files that it may name, its arguments, and for how long it may compute and
            take [s].

        Raises
        ------
        ProcessEndedError
            If the process ended.
        """
        start = time.monotonic()
        try:
            pickle.dump(job, self._writes)
            self._writes.flush()
            pickle.load(self._reads)  # it begins
            start = time.monotonic()
            answer, self.is_spent = pickle.load(self._reads)
        except (OSError, EOFError, ValueError, pickle.UnpicklingError):
            self.is_spent = True
            raise ProcessEndedError(time.monotonic() - start) from None
        finally:
            if self.is_spent:
                self.close()
        return answer

    def close(self) -> None:
        """Let it go: it ends where it has nothing to do."""
        for end in (self._writes, self._reads):
            with contextlib.suppress(OSError):
                end.close()


class Nursery:
    """Where the processes come from.

    Parameters
    ----------
    study
        That the page starts with, as plain data; ``None`` for the page's own.
    """

    def __init__(self, study: dict[str, Any] | None) -> None:
        self._first = pickle.dumps(study)
        self._started: list[subprocess.Popen[bytes]] = []
        self._control: socket.socket | None = None
        self._lock = threading.Lock()
        self._is_closed = False

    def worker(self, memory_bytes: int) -> Worker:
        """A new process.

        Parameters
        ----------
        memory_bytes
            What it may take beyond what it starts with; observed on Linux only.

        Raises
        ------
        RuntimeError
            If it cannot be started.
        """
        with self._lock:
            if self._is_closed:
                raise RuntimeError("the server ends")
            return self._forked(memory_bytes) if FORKS else self._alone()

    def close(self) -> None:
        """End them all."""
        with self._lock:
            self._is_closed = True
            if self._control is not None:
                self._control.close()
        for process in self._started:
            try:
                process.wait(_ENDING_S if FORKS else 0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            for end in (process.stdin, process.stdout):
                if end is not None:
                    end.close()

    def _forked(self, memory_bytes: int) -> Worker:
        ours, theirs = socket.socketpair()
        with theirs:
            for attempt in (0, 1):
                try:
                    self._control = self._control or self._mother()
                    message = struct.pack("q", memory_bytes)
                    socket.send_fds(self._control, [message], [theirs.fileno()])
                    break
                except OSError:  # it ended: another one
                    self._control = None
                    if attempt:
                        raise RuntimeError("no process that computes can be started") from None
        with ours:
            return Worker(ours.makefile("rb"), ours.makefile("wb"))

    def _mother(self) -> socket.socket:
        ours, theirs = socket.socketpair()
        with theirs:
            self._started.append(_started("forks", stdin=theirs.fileno()))
        ours.sendall(struct.pack("q", len(self._first)) + self._first)
        return ours

    def _alone(self) -> Worker:
        process = _started("alone", stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._started = [one for one in self._started if one.poll() is None] + [process]
        assert process.stdin is not None
        assert process.stdout is not None
        process.stdin.write(struct.pack("q", len(self._first)) + self._first)
        return Worker(process.stdout, process.stdin)  # type: ignore[arg-type]


def _started(how: str, **ends: int) -> "subprocess.Popen[bytes]":
    if not sys.executable or getattr(sys, "frozen", False):
        raise RuntimeError("the page is computed by a second Python, which this one cannot start")
    return subprocess.Popen(
        # -P: what lies in the working folder is not imported
        [sys.executable, "-P", "-W", "ignore", "-c", _PROGRAM, how],
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join(entry for entry in sys.path if entry),
            "OPENBLAS_NUM_THREADS": os.environ.get("OPENBLAS_NUM_THREADS", "1"),
        },
        start_new_session=True,  # Ctrl-C reaches the server alone, which ends them
        **ends,  # type: ignore[call-overload]
    )
