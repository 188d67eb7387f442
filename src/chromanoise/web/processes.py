"""Worker processes, and queues of bounded length for the jobs that they compute.

Processes are started once and end with the server. On Linux one process imports and computes what
all questions need, and forks the workers: they share its memory, and a worker that was stopped is
replaced in milliseconds. On other systems each worker is started separately.
"""

import asyncio
import contextlib
import itertools
import logging
import pickle
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from queue import SimpleQueue
from typing import Any, BinaryIO

from chromanoise.base import dataclass, exit_code, sandbox, started_python
from chromanoise.web.page_questions import QuestionError
from chromanoise.web.uploads import Upload

_SIZE = struct.calcsize("q")
FORKS = sys.platform == "linux"
BEGINS_S = 600.0  # the first pictures after an installation compile for minutes on a busy machine
_REPLY_S = 10.0
_PROGRAM = "from chromanoise.web.worker import main; main()"


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
    has_begun
        Whether it computes a job that it has prepared.

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
        self.is_spent = self.has_begun = False

    def asked(
        self, job: tuple[Any, ...], is_wanted: Callable[[], bool] = lambda: True
    ) -> tuple[Any, ...]:
        """How a job ended, and what it returned.

        Parameters
        ----------
        job
            Its name, the files that it may name, its arguments, and its limits of CPU time and of
            elapsed time [s].
        is_wanted
            Whether anybody still waits for the answer when the job is prepared.

        Raises
        ------
        ProcessEndedError
            If the process ended.
        """
        self.is_spent = True  # until a whole answer has been read
        start, self.has_begun = time.monotonic(), False
        timer = threading.Timer(BEGINS_S, self.interrupt)
        timer.daemon = True
        timer.start()
        try:
            pickle.dump(job, self._writes)
            self._writes.flush()
            self.has_begun = pickle.load(self._reads) == "begins"
            timer.cancel()
            if not is_wanted():
                self.interrupt()
            start = time.monotonic()
            answer, self.is_spent = pickle.load(self._reads)
            return answer
        except (OSError, EOFError, ValueError, pickle.UnpicklingError):
            seconds = time.monotonic() - start
            raise ProcessEndedError(
                seconds, has_begun=self.has_begun, exit_code=self.close()
            ) from None
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
            Memory of a job beyond what the process has prepared; limited on Linux only.

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


_LOG = logging.getLogger("chromanoise.web")
MOST_WAITING = 48
LONGEST_WAIT_S = 100.0  # in a queue
ABANDONED_S = 1.0  # a computation without a client may go on this long: its worker is kept
MOST_ANSWER_BYTES = 16_000_000
_KILLED = -9  # SIGKILL, by no name on Windows
_TOO_LONG = (sandbox.TOO_LONG, -getattr(signal, "SIGXCPU", 24))


@dataclass(frozen=True, kw_only=True)
class Lane:
    """A queue, and the processes that work on it.

    Attributes
    ----------
    memory_bytes
        Memory of a job beyond what its process has prepared.
    """

    workers: int
    memory_bytes: int


@dataclass(frozen=True, kw_only=True)
class Job:
    """A kind of request, with its queue and limits.

    Attributes
    ----------
    cpu_s
        Limit of CPU time; whole seconds. [s]
    limit_s
        Limit of elapsed time, which a busy machine must not reach. [s]
    where
        The key next to which an error is shown.
    """

    lane: str
    cpu_s: int
    limit_s: float
    where: str = ""


LANES: Mapping[str, Lane] = {
    "questions": Lane(workers=2, memory_bytes=100_000_000),
    "pictures": Lane(workers=1, memory_bytes=240_000_000),
    "reports": Lane(workers=1, memory_bytes=240_000_000),
    "uploads": Lane(workers=1, memory_bytes=240_000_000),
}
_QUESTIONS = ("choices", "story", "explanations", "answer", "texts", "csv")
JOBS: Mapping[str, Job] = {
    **dict.fromkeys(_QUESTIONS, Job(lane="questions", cpu_s=15, limit_s=120.0)),
    "report": Job(lane="reports", cpu_s=60, limit_s=300.0),
    "card": Job(lane="reports", cpu_s=60, limit_s=300.0),
    "picture": Job(lane="pictures", cpu_s=25, limit_s=150.0),
    "previewed": Job(lane="uploads", cpu_s=4, limit_s=60.0, where="file"),
}


class Workers:
    """The worker processes, and one thread for each, which waits for its answers.

    Parameters
    ----------
    study
        The study that the page starts with, as plain data; ``None`` for the default.
    """

    def __init__(self, study: dict[str, Any] | None) -> None:
        self._nursery = Nursery(study)
        self._lanes = {name: _Queue(lane, self._nursery) for name, lane in LANES.items()}

    def begin(self) -> None:
        """Start the processes in the background."""
        for queue in self._lanes.values():
            queue.begin()

    async def done(self, name: str, *given: Any, kept: tuple[Upload, ...] = ()) -> Any:
        """What a job returns.

        Parameters
        ----------
        kept
            The files that it may name.

        Raises
        ------
        QuestionError
            With all faults of the question; if it needs too much time or memory, or its answer is
            too long; with status 503, if too many jobs are waiting.
        RuntimeError
            If the job failed.
        """
        return await self._lanes[JOBS[name].lane].done(name, kept, given)

    def close(self) -> None:
        """End all processes and drop the waiting jobs."""
        for queue in self._lanes.values():
            queue.cancel()
        self._nursery.close()
        for queue in self._lanes.values():
            queue.close()


class _Queue:
    def __init__(self, lane: Lane, nursery: Nursery) -> None:
        self._lane, self._nursery = lane, nursery
        self._pool = ThreadPoolExecutor(lane.workers, thread_name_prefix="chromanoise")
        self._idle: SimpleQueue[Worker | None] = SimpleQueue()
        for _ in range(lane.workers):
            self._idle.put(None)  # a process is started when the first job comes
        self._waiting = 0

    def begin(self) -> None:
        self._pool.submit(self._begun)

    async def done(self, name: str, *asked: Any) -> Any:
        if self._waiting >= MOST_WAITING:
            raise _too_much()
        self._waiting += 1
        since = time.monotonic()
        loop, turn = asyncio.get_running_loop(), _Turn()
        task = loop.run_in_executor(self._pool, lambda: self._answered(name, asked, since, turn))
        task.add_done_callback(self._left)
        try:
            return await asyncio.shield(task)
        except asyncio.CancelledError:  # the client has disconnected
            task.cancel()  # if it has not begun
            loop.call_later(ABANDONED_S, turn.stop)
            raise

    def cancel(self) -> None:
        self._pool.shutdown(wait=False, cancel_futures=True)

    def close(self) -> None:
        """To be called when all processes have ended."""
        self._pool.shutdown()
        while not self._idle.empty():
            if (worker := self._idle.get()) is not None:
                worker.close()

    def _left(self, task: "asyncio.Future[Any]") -> None:
        self._waiting -= 1
        if not task.cancelled():
            task.exception()  # asked for, so that no log tells of one that nobody waits for

    def _answered(self, name: str, asked: tuple[Any, ...], since: float, turn: "_Turn") -> Any:
        if time.monotonic() - since > LONGEST_WAIT_S:
            raise _too_much()
        job = JOBS[name]
        worker = self._idle.get()  # never blocks: there are as many entries as threads
        try:
            worker = self._ready(worker)
            turn.begin(worker)
            given = (name, *asked, job.cpu_s, job.limit_s)
            return _result(worker.asked(given, turn.is_wanted), job, self._lane)
        except ProcessEndedError as ended:
            raise _stopped(job, ended, self._lane) from None
        finally:
            turn.end()
            self._idle.put(None if worker is None or worker.is_spent else worker)

    def _begun(self) -> None:
        worker = self._idle.get()
        try:
            worker = self._ready(worker)
        finally:
            self._idle.put(worker)

    def _ready(self, worker: Worker | None) -> Worker:
        return worker or self._nursery.worker(self._lane.memory_bytes)


class _Turn:
    """The worker that computes a job, as long as it does."""

    def __init__(self) -> None:
        self._worker: Worker | None = None
        self._lock = threading.Lock()
        self._is_abandoned = False

    def begin(self, worker: Worker) -> None:
        with self._lock:
            self._worker = worker

    def end(self) -> None:
        with self._lock:
            self._worker = None

    def is_wanted(self) -> bool:
        """Whether nobody has called `stop`."""
        return not self._is_abandoned

    def stop(self) -> None:
        """End the worker, if it still computes the job; what it prepares, the next job uses."""
        with self._lock:
            self._is_abandoned = True
            if self._worker is not None and self._worker.has_begun:
                self._worker.interrupt()


def _result(answer: tuple[Any, ...], job: Job, lane: Lane) -> Any:
    kind, *parts = answer
    if kind == "refused":
        faults, status = parts
        raise QuestionError(*faults, status=status)
    if kind == "no memory":
        raise QuestionError((job.where, _no_memory(lane)))
    if kind == "failed":
        _LOG.error("%s", parts[0])
        raise RuntimeError("a job failed")
    (found,) = parts
    size = len(found[0] if isinstance(found, tuple) else found)  # a file has its name beside it
    if size > MOST_ANSWER_BYTES:
        sentence = (
            f"the answer has {size / 1e6:.0f} MB; the limit is {MOST_ANSWER_BYTES / 1e6:g} MB"
        )
        raise QuestionError((job.where, f"{sentence}; reduce the request"))
    return found


def _stopped(job: Job, ended: ProcessEndedError, lane: Lane) -> QuestionError:
    code, status = ended.exit_code, 200
    if not ended.has_begun and ended.seconds >= BEGINS_S:
        sentence = f"the computation did not start within {BEGINS_S / 60:g} minutes"
        sentence, status = f"{sentence}; repeat the request", 503
    elif code in _TOO_LONG or (code is None and ended.seconds >= min(job.cpu_s, job.limit_s)):
        sentence = f"this takes longer than {job.cpu_s} s and was stopped; ask for less"
    elif code == sandbox.NO_MEMORY:
        sentence = _no_memory(lane)
    elif code == _KILLED:
        sentence = "the operating system stopped this, perhaps for lack of memory; ask for less"
    else:
        _LOG.error("a process that computes ended with exit code %s", code)
        sentence = "the process that computed this failed; the log of the server has the reason"
    return QuestionError((job.where, sentence), status=status)


def _no_memory(lane: Lane) -> str:
    return (
        f"this takes more memory than the page gives ({lane.memory_bytes / 1e6:g} MB); ask for less"
    )


def _too_much() -> QuestionError:
    return QuestionError(("", "too many requests are waiting; repeat the request"), status=503)
