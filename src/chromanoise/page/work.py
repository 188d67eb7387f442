"""Queues of bounded length, and the worker processes that compute their jobs."""

import asyncio
import logging
import signal
import threading
import time
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from queue import SimpleQueue
from typing import Any

from chromanoise import _sandbox
from chromanoise.page.processes import BEGINS_S, Nursery, ProcessEndedError, Worker
from chromanoise.page.requests import QuestionError
from chromanoise.page.uploads import Upload

_LOG = logging.getLogger("chromanoise.page")
MOST_WAITING = 48
LONGEST_WAIT_S = 25.0  # in a queue: an answer takes at most a minute, a report at most two
ABANDONED_S = 1.0  # a computation without a client may go on this long: its worker is kept
MOST_ANSWER_BYTES = 16_000_000
_KILLED = -9  # SIGKILL, by no name on Windows
_TOO_LONG = (_sandbox.TOO_LONG, -getattr(signal, "SIGXCPU", 24))


@dataclass(frozen=True, slots=True, kw_only=True)
class Lane:
    """A queue, and the processes that work on it.

    Attributes
    ----------
    workers
        How many processes.
    memory_bytes
        Memory of each process beyond what all of them share.
    """

    workers: int
    memory_bytes: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A kind of request, with its queue and limits.

    Attributes
    ----------
    lane
        Of `LANES`.
    cpu_s
        Limit of CPU time; whole seconds. [s]
    limit_s
        Limit of elapsed time, also on a busy machine. [s]
    where
        The key next to which an error is shown.
    """

    lane: str
    cpu_s: int
    limit_s: float
    where: str = ""


LANES: Mapping[str, Lane] = {
    "questions": Lane(workers=2, memory_bytes=100_000_000),
    "pictures": Lane(workers=1, memory_bytes=380_000_000),  # 150 MB of it for compiled kernels
    "reports": Lane(workers=1, memory_bytes=380_000_000),
    "uploads": Lane(workers=1, memory_bytes=240_000_000),
}
_QUESTIONS = ("choices", "story", "explanations", "answer", "texts", "csv")
JOBS: Mapping[str, Job] = {
    **dict.fromkeys(_QUESTIONS, Job(lane="questions", cpu_s=15, limit_s=30.0)),
    "report": Job(lane="reports", cpu_s=60, limit_s=90.0),
    "picture": Job(lane="pictures", cpu_s=25, limit_s=30.0),
    "previewed": Job(lane="uploads", cpu_s=4, limit_s=12.0, where="file"),
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
        name
            Of `JOBS`.
        kept
            The files that it may name.
        given
            Its arguments.

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
            return _result(worker.asked((name, *asked, job.cpu_s, job.limit_s)), job, self._lane)
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

    def begin(self, worker: Worker) -> None:
        with self._lock:
            self._worker = worker

    def end(self) -> None:
        with self._lock:
            self._worker = None

    def stop(self) -> None:
        """End the worker, if it still computes the job."""
        with self._lock:
            if self._worker is not None:
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
    size = len(parts[0])
    if size > MOST_ANSWER_BYTES:
        sentence = (
            f"the answer has {size / 1e6:.0f} MB; the limit is {MOST_ANSWER_BYTES / 1e6:g} MB"
        )
        raise QuestionError((job.where, f"{sentence}; reduce the request"))
    return parts[0]


def _stopped(job: Job, ended: ProcessEndedError, lane: Lane) -> QuestionError:
    code = ended.exit_code
    if not ended.has_begun and ended.seconds >= BEGINS_S:
        sentence = f"the computation did not start within {BEGINS_S:g} s; send the request again"
    elif code in _TOO_LONG or (code is None and ended.seconds >= min(job.cpu_s, job.limit_s)):
        sentence = f"this takes longer than {job.cpu_s} s and was stopped; ask for less"
    elif code == _sandbox.NO_MEMORY:
        sentence = _no_memory(lane)
    elif code == _KILLED:
        sentence = "the operating system stopped this, perhaps for lack of memory; ask for less"
    else:
        _LOG.error("a process that computes ended with exit code %s", code)
        sentence = "the process that computed this failed; the log of the server has the reason"
    return QuestionError((job.where, sentence))


def _no_memory(lane: Lane) -> str:
    return (
        f"this takes more memory than the page gives ({lane.memory_bytes / 1e6:g} MB); ask for less"
    )


def _too_much() -> QuestionError:
    return QuestionError(("", "too many requests are waiting; repeat the request"), status=503)
