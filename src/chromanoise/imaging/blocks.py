"""How a block of rows lies in memory, and memory that is used again."""

import contextlib
import math
import mmap
import threading

import numpy as np
from numpy.typing import DTypeLike

from chromanoise._check import Array
from chromanoise._shapes import Num, Shaped, UInt8
from chromanoise.imaging.records import Layout
from chromanoise.scene.rows import RowSource

LANES = 8
"""Bands of a pixel that are added side by side."""
RUN_LANES = 16
"""Pixels of a band that are."""
CHANNELS_AT_ONCE = 4
"""Channels that are summed side by side; weights are filled up with zeros to a multiple of it."""
RUN = 256
"""Pixels of a row that get their noise and color together; with four channels 1024 lanes."""
PADDED_BANDS = 16
"""Weights have a multiple of so many bands, zeros at the end."""

_LARGE_PAGE_BYTES = 2 << 20
_NATIVE = "bBhHiIfd"  # types that the kernels read as they are


def in_large_pages(size_bytes: int) -> UInt8[Array, " bytes"]:
    """New memory in pages of 2 MB, if the system has them; the last may be small.

    Each page that is touched first costs a fault, and a file is copied into large ones in 2/3 of
    the time. numpy asks for them too, but may get memory that was in small pages before.
    """
    if not hasattr(mmap, "MADV_HUGEPAGE"):
        return np.empty(size_bytes, np.uint8)
    own = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS  # Python shares by default, in small pages
    try:
        room = mmap.mmap(-1, size_bytes + _LARGE_PAGE_BYTES, flags=own)
    except (OSError, OverflowError):
        return np.empty(size_bytes, np.uint8)  # which says that there is no memory
    with contextlib.suppress(OSError):  # a system without them
        room.madvise(mmap.MADV_HUGEPAGE)
    memory = np.frombuffer(room, np.uint8)
    first = -memory.ctypes.data % _LARGE_PAGE_BYTES
    return memory[first : first + size_bytes]


def new_rows(shape: tuple[int, ...], dtype: DTypeLike) -> Shaped[Array, "rows ..."]:
    """An array to be filled; a large one in large pages."""
    kind = np.dtype(dtype)
    size_bytes = math.prod(shape) * kind.itemsize
    if size_bytes < 2 * _LARGE_PAGE_BYTES:
        return np.empty(shape, kind)
    return in_large_pages(size_bytes).view(kind).reshape(shape)


class Scratch(threading.local):
    """Memory of a thread that is used again for every block: fresh memory is slow to touch."""

    def __init__(self) -> None:
        self._memory = np.empty(0, np.uint8)

    def of(self, size_bytes: int) -> UInt8[Array, " bytes"] | None:
        """So many bytes that belong to this thread; ``None`` for none."""
        if size_bytes == 0:
            return None
        if self._memory.size < size_bytes:
            self._memory = in_large_pages(size_bytes)
        return self._memory[:size_bytes]


def is_planar(source: RowSource) -> bool:
    """Whether neighbors of a band lie nearer than the bands of a pixel, in the first row.

    It decides the order of sums, and so the last bits, for all blocks of the source alike.
    """
    _, pixel, band = (abs(stride) for stride in source.rows(0, 1).strides)
    return pixel < band


def flattened(
    block: Shaped[Array, "rows w m"], *, planar: bool
) -> tuple[Num[Array, " numbers"], Layout]:
    """The numbers of a block as they lie in memory, and the steps between them.

    Copied where the kernels could not read them in the wanted order: bands backwards or not
    beside each other, other byte order, types that are no numbers of the processor.

    Parameters
    ----------
    block
        Of a source of rows.
    planar
        Of the source: pixels of a band beside each other, or bands of a pixel.
    """
    if block.dtype.char not in _NATIVE or not block.dtype.isnative:
        block = block.astype(np.float32 if block.dtype.itemsize < 8 else np.float64)
    steps = [stride // block.itemsize for stride in block.strides]
    exact = all(s * block.itemsize == t for s, t in zip(steps, block.strides, strict=True))
    apart = block.shape[1] == 1 or steps[1] >= block.shape[2] > 1  # pixels do not overlap
    beside = steps[1] == 1 if planar else steps[2] == 1 and apart
    if not (exact and min(steps) > 0 and beside):
        axes = (0, 2, 1) if planar else (0, 1, 2)
        block = np.ascontiguousarray(block.transpose(axes)).transpose(axes)
        steps = [stride // block.itemsize for stride in block.strides]
    rows, pixels, bands = block.shape
    row, pixel, band = steps
    # numpy says any step of an axis of one; with one band both orders are the same sum
    pixel = 1 if planar or bands == 1 else max(pixel, bands)
    band = (band if bands > 1 else pixels) if planar else 1
    span = 1 + (rows - 1) * row + (pixels - 1) * pixel + (bands - 1) * band
    flat = np.lib.stride_tricks.as_strided(block, (span,), (block.itemsize,), writeable=False)
    return flat, Layout(bands, row, pixel, band)
