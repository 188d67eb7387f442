"""How a block of rows lies in memory, and memory that is used again."""

import threading

import numpy as np
from jaxtyping import Num, Shaped, UInt8

from chromanoise._check import Array

Layout = tuple[int, int, int, int]
"""Bands, and the steps from row to row, pixel to pixel and band to band. [numbers]"""

_NATIVE = "bBhHiIfd"  # types that the kernels read as they are


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
