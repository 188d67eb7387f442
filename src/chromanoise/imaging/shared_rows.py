"""Blocks of an image on threads or any executor, and rows in memory that processes share.

Each block depends only on its plan and its rows, so the result does not depend on which thread or
process computes a block, nor on the order.

Sending an image between processes takes as long as computing it: it is packed, copied through
sockets and unpacked, each time into new memory. Therefore processes of one machine write rows to
shared memory. Workers do not map the shared memory: they write a few rows at a time, as to a file,
which avoids a page fault for every page.
"""

import errno
import math
import os
import sys
from _thread import start_new_thread
from collections import deque
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import ExitStack, contextmanager
from itertools import islice
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import numpy as np

from chromanoise.base import Array, InputError, Setting, Shaped, dataclass
from chromanoise.imaging.blocks import Scratch, new_rows, release
from chromanoise.spectra import RowSource

Kind = tuple[tuple[int, ...], type[np.generic]]
"""Shape and type of an array, its first axis the rows."""


@dataclass(frozen=True, kw_only=True, eq=False)
class SharedRows:
    """An array of rows in shared memory, initially 0; pickling it sends only its name.

    Attributes
    ----------
    path
        Path at which other processes of this machine open the memory.
    memory
        Identity of the memory, because the path may refer to other memory later.
    shape, dtype
        Shape and type of the array.
    """

    path: str
    memory: tuple[int, int]
    shape: tuple[int, ...]
    dtype: np.dtype

    def mapped(self) -> Shaped[Array, "rows ..."]:
        """The array; it shows the rows that any process writes."""
        return np.asarray(np.memmap(self.path, self.dtype, "r+", shape=self.shape))

    def put(self, first: int, rows: Shaped[Array, "some ..."]) -> None:
        """Write contiguous rows into the array, starting at row ``first``.

        Raises
        ------
        InputError
            If the memory no longer exists, or has no space for the rows.
        """
        at, left = first * rows[:1].nbytes, rows.data.cast("B")
        memory = self._opened()
        try:
            while left:
                written = os.pwrite(memory, left, at)
                at, left = at + written, left[written:]
        except OSError as error:
            raise InputError(
                "the picture",
                f"cannot be kept in memory ({error})",
                remedy="make a part of it at a time",
            ) from None
        finally:
            os.close(memory)

    def _opened(self) -> int:
        """The memory as a file; its identity is checked because the path may be reused."""
        try:
            memory = os.open(self.path, os.O_WRONLY)
        except OSError:
            raise InputError(
                self.path,
                "must be open to every worker, as where all are processes of this machine",
                found="cannot be opened",
                remedy=Setting("same_machine", (False,)),
            ) from None
        if _identity(memory) != self.memory:
            os.close(memory)
            raise InputError("the picture", "was abandoned while a worker made rows of it")
        return memory


def _identity(memory: int) -> tuple[int, int]:
    status = os.fstat(memory)
    return status.st_dev, status.st_ino


@contextmanager
def shared_rows(*kinds: Kind) -> Iterator[tuple[SharedRows, ...] | None]:
    """Memory for these arrays, which is freed with this context; mapped arrays stay valid.

    ``None`` if the system cannot share memory by name, or has too little memory.
    """
    with ExitStack() as stack:
        try:
            shared = tuple(_reserved(stack, shape, np.dtype(kind)) for shape, kind in kinds)
        except (OSError, AttributeError):  # too large, or not Linux
            shared = None
        yield shared


def _reserved(stack: ExitStack, shape: tuple[int, ...], dtype: np.dtype) -> SharedRows:
    size_bytes = math.prod(shape) * dtype.itemsize
    if size_bytes > os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"):
        raise OSError(errno.ENOMEM, f"{size_bytes} bytes are more than this machine's memory")
    memory = os.memfd_create("chromanoise")
    stack.callback(os.close, memory)
    os.truncate(memory, size_bytes)
    path = f"/proc/{os.getpid()}/fd/{memory}"
    return SharedRows(path=path, memory=_identity(memory), shape=shape, dtype=dtype)


Block = tuple[int, int]
"""First row, and the row after the last."""

FillBlock = Callable[..., Any]
"""(plan, start, stop, scratch, one array per output) -> the result for the block."""

Part = Callable[[Any, int, int], tuple[Any, list[Block]]]
"""The plan for the rows of a block in another process, and the pieces in which to fill it."""

_SENT_AHEAD = 16  # blocks queued at an executor
_LARGE_BLOCK_BYTES = 64 << 20  # for data in memory, or sent to workers
_BLOCK_BESIDE_BYTES = 1 << 30  # of a file, for a local process: a task costs 10 ms
_BLOCK_ELSEWHERE_BYTES = 256 << 20  # for a remote process, which sends its rows back
_MOST_CHUNK_BYTES = 256 << 20  # most bytes that are decoded together
_TURNS = 4  # smallest number of blocks per worker, so that all end together
_TURNS_OF_EQUALS = 2  # the same for threads, or workers of one machine
_HANDFUL = 4  # most blocks that a thread takes at a time, to reduce waits for the lock
_HANDFULS = 16  # smallest number of batches per thread
_MOST_THREADS = 1024
_BLOCK_BYTES = 8 << 20  # bytes per read: efficient for the disk, small in memory


@dataclass(frozen=True, kw_only=True, eq=False)
class Work:
    """Threads or executor, and rows per task. The result is bit-identical for all settings.

    Attributes
    ----------
    threads
        Number of concurrent workers; the number of local cores if ``None``.
    tile_rows
        Rows per task; if ``None``, chosen to suit memory, file and workers.
    executor
        Executor used instead of threads of this process: from `concurrent.futures`, or
        ``dask.distributed.Client.get_executor()``. Its workers must have access to the cube's
        file; a cube in memory is sent to them.
    same_machine
        Whether the executor's workers are processes of this machine, which write their rows to
        shared memory instead of sending them.
    progress
        Function called with the number of rows that were completed.
    folder
        Folder for files without a name that hold large pictures; ``None`` to hold them in memory.

    Raises
    ------
    InputError
        If the number of threads is not 1 to 1024, or the number of rows is less than 1.
    """

    threads: int | None = None
    tile_rows: int | None = None
    executor: Executor | None = None
    same_machine: bool = False
    progress: Callable[[int], None] | None = None
    folder: Path | None = None

    def __post_init__(self) -> None:
        if self.threads is not None and not 1 <= self.threads <= _MOST_THREADS:
            raise InputError("threads", f"must be 1 to {_MOST_THREADS}", value=self.threads)
        if self.tile_rows is not None and self.tile_rows < 1:
            raise InputError("tile_rows", "must be at least 1 [rows]", value=self.tile_rows)


def row_blocks(source: RowSource, work: Work) -> list[Block]:
    """The rows of a source in blocks."""
    height = source.shape[0]
    rows = work.tile_rows or _rows_of(source, _block_bytes(source, work))
    return [(start, min(start + rows, height)) for start in range(0, height, rows)]


def row_pieces(source: RowSource, start: int, stop: int) -> list[Block]:
    """A block in pieces that stay in the cache from reading to computation."""
    rows = _rows_of(source, _BLOCK_BYTES) if source.scratch_bytes(1) > 0 else stop - start
    return [(first, min(first + rows, stop)) for first in range(start, stop, rows)]


def _rows_of(source: RowSource, size_bytes: int) -> int:
    """Number of rows with about this many bytes, in whole chunks if these are not too large."""
    _, width, bands = source.shape
    row_bytes = width * bands * source.dtype.itemsize
    together = max(source.chunk_rows, 1)
    rows = max(1, round(size_bytes / row_bytes / together)) * together
    most_bytes = max(size_bytes, _MOST_CHUNK_BYTES)  # larger chunks are decoded more than once
    return min(rows, max(1, most_bytes // row_bytes))


def _block_bytes(source: RowSource, work: Work) -> int:
    """Block size: large if nothing is copied, because the overhead of a block equals about 1 MB."""
    in_file = source.scratch_bytes(1) > 0
    if in_file and work.executor is None:
        return _BLOCK_BYTES
    whole = math.prod(source.shape) * source.dtype.itemsize
    are_equals = work.executor is None or work.same_machine
    turns = (_TURNS_OF_EQUALS if are_equals else _TURNS) * threads_of(work)
    most = _BLOCK_BESIDE_BYTES if work.same_machine else _BLOCK_ELSEWHERE_BYTES
    most = most if in_file else _LARGE_BLOCK_BYTES
    return min(max(whole // turns, _BLOCK_BYTES), most)


def threads_of(work: Work) -> int:
    """Number of concurrent workers."""
    return work.threads or os.cpu_count() or 1


def made(
    fill: FillBlock, plan: Any, part: Part, blocks: list[Block], kinds: tuple[Kind, ...], work: Work
) -> tuple[tuple[Array, ...], list[Any]]:
    """New arrays filled block by block, and the result for each block, in order.

    Parameters
    ----------
    fill
        A function that depends only on plan and block.
    plan
        All data that ``fill`` needs.
    part
        Function that gives the part of the plan to send to an executor.
    kinds
        Shapes and types of the arrays; the first axis is rows.
    work
        Threads or executor. The first error ends the computation.
    """
    if (disabled := os.environ.get("NUMBA_DISABLE_JIT", "0")) not in ("", "0"):
        raise InputError(
            "NUMBA_DISABLE_JIT",
            "must not be set, because pictures need compiled kernels",
            value=disabled,
            remedy="unset it",
        )
    with ExitStack() as stack:
        in_place = work.executor is not None and work.same_machine
        shared = stack.enter_context(shared_rows(*kinds)) if in_place else None
        if shared is None:
            outputs = tuple(new_rows(shape, dtype, folder=work.folder) for shape, dtype in kinds)
        else:
            outputs = tuple(rows.mapped() for rows in shared)
        if work.executor is None:
            return outputs, filled(fill, plan, blocks, outputs, work)
        submit = _submission(work.executor, fill, plan, part, outputs, shared)
        nested = _in_order(submit, blocks, work)
    return outputs, [counts for block in nested for counts in block]


def filled(
    fill: FillBlock, plan: Any, blocks: list[Block], outputs: tuple[Array, ...], work: Work
) -> list[Any]:
    """Fill the rows of ``outputs`` by the calling thread and others; otherwise as `made`."""
    threads = 1 if sys.platform == "wasi" else threads_of(work)
    scratch, size = Scratch(), max(1, min(_HANDFUL, len(blocks) // (_HANDFULS * threads)))
    handfuls = [blocks[i : i + size] for i in range(0, len(blocks), size)]
    turns, ended = iter(handfuls), deque[int]()
    counts: dict[int, list[Any]] = {}
    errors: dict[int, BaseException] = {}

    def fill_in_turn(after_each: Callable[[], object]) -> None:
        for some in turns:
            first = some[0][0]
            try:
                counts[first] = [
                    fill(plan, start, stop, scratch, *(out[start:stop] for out in outputs))
                    for start, stop in some
                ]
                for out in outputs:
                    release(out)
                ended.append(some[-1][1] - first)
                after_each()
            except BaseException as error:
                errors[first] = error
            if errors:
                return

    def report_progress() -> None:
        while work.progress and ended:
            work.progress(ended.popleft())

    def in_another_thread() -> None:
        try:
            fill_in_turn(lambda: None)
        finally:
            finished.put(None)

    finished, others = SimpleQueue[None](), 0
    try:
        while others < min(threads, len(handfuls)) - 1:
            try:
                start_new_thread(in_another_thread, ())  # `Thread` would wait until it runs
            except RuntimeError:  # no memory for its stack: those that run do all
                break
            others += 1
        fill_in_turn(report_progress)
    finally:
        deque(turns, maxlen=0)  # after an interruption the others end, too
        for _ in range(others):
            finished.get()
    if errors:  # the first in order, whatever the timing
        raise errors[min(errors)]
    report_progress()
    return [one for some in handfuls for one in counts[some[0][0]]]


Submit = Callable[[int, int], tuple["Future[Any]", Callable[[Any], Any]]]
"""A function from a block to its future, and to a function that handles its result here."""


def _submission(
    executor: Executor,
    fill: FillBlock,
    plan: Any,
    part: Part,
    outputs: tuple[Array, ...],
    shared: tuple[SharedRows, ...] | None,
) -> Submit:
    """How a block is given to workers, which fill shared memory, or send the rows back.

    A block that is filled twice has the same bits both times.
    """

    def submit(start: int, stop: int) -> tuple["Future[Any]", Callable[[Any], Any]]:
        own, pieces = part(plan, start, stop)
        if shared is not None:
            future = executor.submit(_filled_and_put, fill, own, pieces, shared)
            return future, lambda counts: counts
        kinds = [((stop - start, *out.shape[1:]), out.dtype) for out in outputs]

        def place(result: Any) -> Any:
            counts, parts = result
            for out, rows in zip(outputs, parts, strict=True):
                out[start:stop] = rows
                release(out)
            return counts

        return executor.submit(_filled_and_sent, fill, own, pieces, kinds), place

    return submit


def _filled_and_sent(fill: FillBlock, plan: Any, pieces: list[Block], kinds: list[Any]) -> Any:
    """Runs in another process: fills new arrays, which are sent back."""
    rows, first = tuple(new_rows(shape, dtype) for shape, dtype in kinds), pieces[0][0]
    counts = []
    for start, stop in pieces:
        parts = (one[start - first : stop - first] for one in rows)
        counts.append(fill(plan, start, stop, _scratch_there, *parts))
    return counts, rows


def _filled_and_put(
    fill: FillBlock, plan: Any, pieces: list[Block], shared: tuple[SharedRows, ...]
) -> Any:
    """Runs in another process of the same machine."""
    most = max(stop - start for start, stop in pieces)
    room = tuple(new_rows((most, *rows.shape[1:]), rows.dtype) for rows in shared)
    counts = []
    for start, stop in pieces:
        parts = tuple(rows[: stop - start] for rows in room)
        counts.append(fill(plan, start, stop, _scratch_there, *parts))
        for rows, part in zip(shared, parts, strict=True):
            rows.put(start, part)
    return counts


_scratch_there = Scratch()


def _in_order(submit: Submit, blocks: list[Block], work: Work) -> list[Any]:
    """Submit a few blocks at a time, which limits memory and reports an error early."""
    todo: Iterator[tuple[int, Block]] = iter(enumerate(blocks))
    doing: dict[Future[Any], tuple[int, Callable[[Any], Any]]] = {}
    counts: list[Any] = [None] * len(blocks)
    try:
        while True:
            for number, block in islice(todo, _SENT_AHEAD - len(doing)):
                future, place = submit(*block)
                doing[future] = (number, place)
            if not doing:
                return counts
            done, _ = wait(doing, return_when=FIRST_COMPLETED)
            if any(future.exception() for future in done):
                _raise_first(doing)
            for future in done:
                number, place = doing.pop(future)
                counts[number] = place(future.result())
                if work.progress:
                    start, stop = blocks[number]
                    work.progress(stop - start)
    finally:
        for future in doing:
            future.cancel()


def _raise_first(doing: dict["Future[Any]", tuple[int, Callable[[Any], Any]]]) -> None:
    """The error of the first failed block in order, independent of timing."""
    for future in sorted(doing, key=lambda one: doing[one][0]):
        future.result()
