"""Blocks of rows: the unit of work for threads, and how a block lies in memory."""

import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import Any

import numpy as np
from jaxtyping import Num, Shaped, UInt8

from chromanoise import _check
from chromanoise._check import Array
from chromanoise.scene.rows import RowSource

Block = tuple[int, int]
"""First row, and the row after the last."""

Layout = tuple[int, int, int, int]
"""Bands, and the steps from row to row, pixel to pixel and band to band. [numbers]"""

_BLOCK_BYTES = 8 << 20  # read at a time: large for the disk, small for the memory
_NATIVE = "bBhHiIfd"  # types that the kernels read as they are


def row_blocks(source: RowSource, *, rows: int | None = None) -> list[Block]:
    """The rows of a source in blocks of ``rows``, or of some megabytes. No result depends on it.

    Raises
    ------
    InputError
        If ``rows`` is less than 1.
    """
    height, width, bands = source.shape
    if rows is not None and rows < 1:
        raise _check.InputError(f"a tile must have at least 1 row, but {rows} are asked for")
    if rows is None:
        row_bytes = width * bands * source.dtype.itemsize
        stored_together = max(source.chunk_rows, 1)
        rows = max(1, _BLOCK_BYTES // row_bytes // stored_together) * stored_together
    return [(start, min(start + rows, height)) for start in range(0, height, rows)]


def thread_count(threads: int | None) -> int:
    """How many threads work: as asked, or one per core.

    Raises
    ------
    InputError
        If less than 1.
    """
    if threads is None:
        return os.cpu_count() or 1
    if threads < 1:
        raise _check.InputError(f"threads must be at least 1, but is {threads}")
    return threads


def over_blocks(
    work: Callable[[int, int], None],
    blocks: Sequence[Block],
    *,
    threads: int,
    progress: Callable[[int], None] | None = None,
) -> None:
    """Do ``work(start, stop)`` for every block, a few at a time; the first fault ends it all.

    Parameters
    ----------
    work
        Must leave the same result in any order.
    blocks
        Of `row_blocks`.
    threads
        Working at once.
    progress
        Is told the number of rows of each finished block.
    """
    todo = iter(blocks)
    doing: dict[Future[None], int] = {}
    pool = ThreadPoolExecutor(threads)
    try:
        while True:
            for start, stop in _some(todo, 2 * threads - len(doing)):
                doing[pool.submit(work, start, stop)] = stop - start
            if not doing:
                return
            done, _ = wait(doing, return_when=FIRST_COMPLETED)
            for future in done:
                rows = doing.pop(future)
                future.result()
                if progress:
                    progress(rows)
    finally:
        pool.shutdown(cancel_futures=True)


def _some(todo: Any, count: int) -> list[Block]:
    return [block for _, block in zip(range(count), todo, strict=False)]


class Scratch(threading.local):
    """Memory of a thread that is used again for every block: fresh memory is slow to touch."""

    def __init__(self) -> None:
        self._memory = np.empty(0, np.uint8)

    def of(self, size_bytes: int) -> UInt8[Array, " bytes"] | None:
        """At least ``size_bytes`` that belong to this thread; ``None`` for none."""
        if size_bytes == 0:
            return None
        if self._memory.size < size_bytes:
            self._memory = np.empty(size_bytes, np.uint8)
        return self._memory[:size_bytes]


def flattened(block: Shaped[Array, "rows w m"]) -> tuple[Num[Array, " numbers"], Layout]:
    """The numbers of a block as they lie in memory, and the steps between them.

    Copied only where the kernels could not read them: bands backwards, other byte order, types
    that are no numbers of the processor.
    """
    if block.dtype.char not in _NATIVE or not block.dtype.isnative:
        block = block.astype(np.float32 if block.dtype.itemsize < 8 else np.float64)
    steps = [stride // block.itemsize for stride in block.strides]
    exact = all(s * block.itemsize == t for s, t in zip(steps, block.strides, strict=True))
    if not (exact and min(steps) > 0 and 1 in (steps[1], steps[2])):
        block = np.ascontiguousarray(block)
        steps = [stride // block.itemsize for stride in block.strides]
    span = 1 + sum((n - 1) * step for n, step in zip(block.shape, steps, strict=True))
    flat = np.lib.stride_tricks.as_strided(block, (span,), (block.itemsize,), writeable=False)
    row, pixel, band = steps
    if block.shape[1] == 1 and band == 1:
        pixel = max(pixel, 2)  # one pixel per row: its bands lie together
    if block.shape[2] == 1 and pixel == 1:
        band = 1
    return flat, (block.shape[2], row, pixel, band)
