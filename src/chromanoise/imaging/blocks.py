"""Parameters and memory of the kernels: named tuples, layouts, and reusable buffers.

Parameters are named tuples because numba accepts these directly, but not dataclasses. Unsigned
indices need no check for negative values, so the loops between interleaved and separate channels
compile to shuffles of whole vectors; with a loop over channels each number would be moved
separately.
"""

import contextlib
import math
import mmap
import os
import shutil
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import DTypeLike

from chromanoise.base import Array, Float32, Num, Shaped, UInt8
from chromanoise.spectra import RowSource


class Layout(NamedTuple):
    """Memory layout of a block of rows: number of bands, and strides. [numbers]

    If the stride from pixel to pixel is 1, the pixels of a band are contiguous; otherwise the bands
    of a pixel are.
    """

    bands: int
    row_pitch: int
    pixel_pitch: int
    band_pitch: int


class RowsInMemory(NamedTuple):
    """Rows of a cube as stored in memory, and the weights from stored numbers to electrons."""

    flat: Num[Array, " numbers"]
    """Flat array that starts at the first band of the first pixel."""
    lay: Layout
    weights: Float32[Array, "channels bands"]
    """Shape: channels rounded up to 4, bands rounded up to 16; padded with 0."""
    seen: Float32[Array, "16"]
    """The smallest number so far in each of `LANES` lanes, then the largest."""


class Draw(NamedTuple):
    """Standard deviations, as `chromanoise.sensor.noise_sources.Drawn`, bias, and random words."""

    reading_e: np.float32
    gain: np.float32
    pattern_e: np.float32
    row_e: np.float32
    column_e: np.float32
    level_share: np.float32
    levels_e: np.float32
    readings: int
    """Readings that are summed, each with its own level."""
    dark_e: np.float32
    black_error_e: np.float32
    noisy: bool
    """Whether there is shot noise."""
    key: np.uint64
    frame: np.uint64


class Converter(NamedTuple):
    """Converter from electrons to codes."""

    most_e: np.float32
    """Full well minus dark electrons, plus the error of the black level."""
    dn_per_e: np.float32
    black_dn: np.float32
    top_dn: np.float32


class Well(NamedTuple):
    """Full well as `Converter`, and whether electrons are clipped to 0 and to it."""

    most_e: np.float32
    held: bool


LANES = 8
"""Number of bands of a pixel that are added in parallel."""
RUN_LANES = 16
"""Number of pixels of a band that are added in parallel."""
CHANNELS_AT_ONCE = 4
"""Number of channels that are summed in parallel; weights are zero-padded to a multiple of it."""
RUN = 256
"""Number of pixels per run for noise and color; 1024 lanes with four channels."""
PADDED_BANDS = 16
"""Bands of the weights are zero-padded to a multiple of this number."""

TILE = 4096
"""Number of pixels whose sums stay in the second cache during the loop over bands."""
STRANDS = 64
"""Partial sums of a row, at most, if the columns of a mosaic do not repeat later."""
ENCODED = 16384
"""Number of entries in the table of sRGB codes."""

LIGHT, READOUT, PIXEL_GAIN, PIXEL_OFFSET, ROW, COLUMN, PIXEL_LEVELS, LEVEL = range(8)
"""Purposes: shot noise, also with read noise as one sum; read noise by itself; PRNU; DSNU; rows;
columns; which pixels have two levels, and which level a reading has."""
READING = 1 << 18
"""Added to a channel for each further reading of a sum."""
FEW_E = np.float32(20.0)
"""Mean from which the expansion is used; below it, the distribution function is summed. [e-]"""
SMOOTH_E = np.float32(0.75)
"""Read noise s from which the steps of whole electrons are negligible: their relative ripple of the
density is 2 exp(-2 pi^2 s^2) = 3e-5, which 10^8 samples do not resolve. [e-]"""

LOG_TERMS = (
    0.9999998139228, -0.5000066740315, 0.3333618193219, -0.2495934346,
    0.1987304861918, -0.1733347148318, 0.1641997547084, -0.1010220041,
)  # fmt: skip
"""ln(1 + f) / f for sqrt(1/2) <= 1 + f <= sqrt(2), minimax: the logarithm errs by 3.4e-8."""
QUANTILE_ABOVE = (
    1.2533142805743616, 0.4528931760819228, 0.08998653582631565,
    0.011902043399865366, 0.0010024744612763129, 2.921249561208359e-05,
)  # fmt: skip
QUANTILE_BELOW = (
    1.0, 0.09955993205337688, 0.03269102304549773,
    0.002291294635803468, 0.00016975149536817527, 1.0038387061978881e-06,
)  # fmt: skip
"""Normal quantile / (1 - 2t) as a ratio of polynomials in w = -ln 4t(1 - t), minimax: errs by
1.2e-7."""

_LARGE_PAGE_BYTES = 2 << 20
_FILE_BYTES = 32 << 20  # arrays from this size on are kept in a file
_PART_BYTES = 1 << 20
_SPARE = 4  # times its size must be free before an array is kept in a file
_NATIVE = "bBhHiIfd"  # types that the kernels read directly


def in_large_pages(size_bytes: int) -> UInt8[Array, " bytes"]:
    """New memory in pages of 2 MB, if the system has them; the last may be small.

    The first access to each page causes a page fault; copying a file into large pages takes 2/3 of
    the time. numpy requests them too, but may reuse memory with small pages.
    """
    if not hasattr(mmap, "MADV_HUGEPAGE"):
        return np.empty(size_bytes, np.uint8)
    own = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS  # not the default: shared, small pages
    try:
        room = mmap.mmap(-1, size_bytes + _LARGE_PAGE_BYTES, flags=own)
    except (OSError, OverflowError):
        return np.empty(size_bytes, np.uint8)  # which raises MemoryError
    with contextlib.suppress(OSError):  # a system without large pages
        room.madvise(mmap.MADV_HUGEPAGE)
    memory = np.frombuffer(room, np.uint8)
    first = -memory.ctypes.data % _LARGE_PAGE_BYTES
    return memory[first : first + size_bytes]


def new_rows(
    shape: tuple[int, ...], dtype: DTypeLike, *, folder: Path | None = None
) -> Shaped[Array, "rows ..."]:
    """A new array of any content, in large pages if it is large.

    Parameters
    ----------
    folder
        Where a file without a name holds an array above 32 MB, if there is space; memory then holds
        only rows that were not yet given to `release`. ``None``: memory.
    """
    kind = np.dtype(dtype)
    size_bytes = math.prod(shape) * kind.itemsize
    if size_bytes < 2 * _LARGE_PAGE_BYTES:
        return np.empty(shape, kind)
    if folder is not None and size_bytes >= _FILE_BYTES and hasattr(mmap, "MADV_DONTNEED"):
        with contextlib.suppress(OSError):  # no space, or a file system that cannot claim it
            return np.ndarray(shape, kind, _mapped_file(folder, size_bytes))
    return in_large_pages(size_bytes).view(kind).reshape(shape)


class _MappedFile(mmap.mmap):
    """Memory that shows a file: its pages may be dropped, unlike those of anonymous memory."""


def _mapped_file(folder: Path, size_bytes: int) -> _MappedFile:
    """A mapped file whose space is claimed, because a write to a full disk would kill the process.

    Raises
    ------
    OSError
        If the folder has no space, or the system cannot claim it.
    """
    if not hasattr(os, "posix_fallocate"):
        raise OSError("space cannot be claimed")
    if shutil.disk_usage(folder).free < _SPARE * size_bytes:
        raise OSError("the space is needed for the files of the picture")
    with tempfile.TemporaryFile(dir=folder) as file:
        os.posix_fallocate(file.fileno(), 0, size_bytes)
        return _MappedFile(file.fileno(), size_bytes)


def release(rows: Shaped[Array, "rows ..."]) -> None:
    """Drop the memory of the whole array of these rows if a file holds it; no number is lost."""
    owner: object = rows
    while isinstance(owner, np.ndarray):
        owner = owner.base
    if isinstance(owner, _MappedFile):
        owner.madvise(mmap.MADV_DONTNEED)


def parts_of_rows(
    rows: Shaped[Array, "rows ..."],
) -> Iterator[tuple[int, Shaped[Array, "some ..."]]]:
    """First row and rows of parts of about 1 MB; the memory of each is released after its use."""
    count = max(1, _PART_BYTES // max(1, rows[:1].nbytes))
    for start in range(0, rows.shape[0], count):
        yield start, rows[start : start + count]
        release(rows)


class Scratch(threading.local):
    """Memory of a thread that is reused for every block, because first access to memory is slow."""

    def __init__(self) -> None:
        self._memory = np.empty(0, np.uint8)

    def of(self, size_bytes: int) -> UInt8[Array, " bytes"] | None:
        """Memory of this size that belongs to this thread; ``None`` for size 0."""
        if size_bytes == 0:
            return None
        if self._memory.size < size_bytes:
            self._memory = in_large_pages(size_bytes)
        return self._memory[:size_bytes]


def is_planar(source: RowSource) -> bool:
    """Whether neighbors in a band are closer in memory than the bands of a pixel, in the first row.

    It determines the order of sums, and so the last bits, equally for all blocks of the source.
    """
    _, pixel, band = (abs(stride) for stride in source.rows(0, 1).strides)
    return pixel < band


def flattened(
    block: Shaped[Array, "rows w m"], *, planar: bool
) -> tuple[Num[Array, " numbers"], Layout]:
    """The numbers of a block as stored in memory, and their strides.

    They are copied if the kernels cannot read them directly: reversed or non-contiguous bands,
    another byte order, or types that the processor does not support.

    Parameters
    ----------
    block
        Block from a source of rows.
    planar
        Layout of the source: whether the pixels of a band are contiguous, or the bands of a pixel.
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
    # the stride of an axis of length 1 is arbitrary; with one band both orders give the same sum
    pixel = 1 if planar or bands == 1 else max(pixel, bands)
    band = (band if bands > 1 else pixels) if planar else 1
    span = 1 + (rows - 1) * row + (pixels - 1) * pixel + (bands - 1) * band
    flat = np.lib.stride_tricks.as_strided(block, (span,), (block.itemsize,), writeable=False)
    return flat, Layout(bands, row, pixel, band)
