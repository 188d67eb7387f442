"""Rows of HDF5 arrays that are stored in chunks, read without libhdf5.

libhdf5 (2.0.0) gives whatever lies in memory for a chunk that inflates to too few bytes, and reads
one chunk at a time. Here a chunk that is not whole is refused, and threads read at once.
"""

import itertools
import math
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Int64, Shaped, UInt8
from chromanoise.scene.faults import reading_rows
from chromanoise.scene.file_rows import refuse_other_rows
from chromanoise.scene.hdf5_child import DEFLATE, SHUFFLE

Box = tuple[range, range, range]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChunkRows:
    """Rows of chunks that are stored plainly, shuffled or deflated.

    Attributes
    ----------
    path
        The file.
    index
        Of each chunk the first byte in the file, the length in bytes, and which filters were left
        out (bit k: the k-th); chunks in the order of C.
    filters
        What each chunk went through when it was written, in that order, as HDF5 numbers them.
    sizes, chunk
        Numbers along each stored axis, in the array and in a chunk.
    axes
        Which of the stored axes are rows, columns, bands.
    bands
        Which of the stored bands, in which order.
    stored
        Type of the numbers in the file.
    """

    path: Path
    index: Int64[Array, "chunks 3"]
    filters: tuple[int, ...]
    sizes: tuple[int, int, int]
    chunk: tuple[int, int, int]
    axes: tuple[int, int, int]
    bands: range
    stored: np.dtype

    def __post_init__(self) -> None:
        _check.same_length("chunks", index=len(self.index), grid=math.prod(self.grid))
        _check.freeze(self, "index")

    @property
    def grid(self) -> tuple[int, int, int]:
        """Chunks along each stored axis."""
        rows, columns, bands = (
            -(-n // long) for n, long in zip(self.sizes, self.chunk, strict=True)
        )
        return rows, columns, bands

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns, bands."""
        return self.sizes[self.axes[0]], self.sizes[self.axes[1]], len(self.bands)

    @property
    def dtype(self) -> np.dtype:
        """Of what ``rows`` gives; in the byte order of this machine."""
        return self.stored.newbyteorder("=")

    @property
    def chunk_rows(self) -> int:
        """Rows that are stored, and so decoded, together."""
        return min(self.chunk[self.axes[0]], self.shape[0])

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, with the strides in which they are stored."""
        refuse_other_rows(str(self.path), self.shape, start, stop)
        up = self.bands if self.bands.step > 0 else self.bands[::-1]
        asked = [range(0, 1)] * 3
        asked[self.axes[0]] = range(start, stop)
        asked[self.axes[1]] = range(self.shape[1])
        asked[self.axes[2]] = range(up[0], up[-1] + 1)
        with reading_rows(self.path, "HDF5"):
            box = _box(self, (asked[0], asked[1], asked[2])).transpose(self.axes)
        return box[:, :, :: up.step] if up == self.bands else box[:, :, :: up.step][:, :, ::-1]

    def scratch_bytes(self, rows: int) -> int:
        """How large ``into`` must be for so many rows; 0 if it is not used. [bytes]"""
        return 0

    def with_bands(self, keep: slice) -> "ChunkRows":
        """The same with some of the bands; nothing is read."""
        return replace(self, bands=self.bands[keep])


def _box(source: ChunkRows, asked: Box) -> Shaped[Array, "a b c"]:
    """A part of the array, its axes as stored, out of all chunks that it touches."""
    result = np.empty([len(span) for span in asked], dtype=source.dtype)
    along = [
        range(span[0] // long, span[-1] // long + 1)
        for span, long in zip(asked, source.chunk, strict=True)
    ]
    with source.path.open("rb", buffering=0) as file:
        for at in itertools.product(*along):
            overlaps = [
                _overlap(k * long, long, span)
                for k, long, span in zip(at, source.chunk, asked, strict=True)
            ]
            number = int(np.ravel_multi_index(at, source.grid))
            numbers = _chunk(source, file, number)
            result[tuple(to for _, to in overlaps)] = numbers[tuple(of for of, _ in overlaps)]
    return result


def _overlap(first: int, long: int, span: range) -> tuple[slice, slice]:
    """Where a chunk and what is asked for meet: in the chunk, and in the result."""
    start, stop = max(first, span.start), min(first + long, span.stop)
    return slice(start - first, stop - first), slice(start - span.start, stop - span.start)


def _chunk(source: ChunkRows, file: BinaryIO, number: int) -> Shaped[Array, "a b c"]:
    first, length, left_out = (int(n) for n in source.index[number])
    file.seek(first)
    content = file.read(length)
    needed = math.prod(source.chunk) * source.stored.itemsize
    for k, kind in reversed(list(enumerate(source.filters))):
        if left_out >> k & 1:
            continue
        if kind == DEFLATE:
            content = zlib.decompressobj().decompress(content, needed + 1)
        elif kind == SHUFFLE and len(content) == needed:
            content = _in_order(content, source.stored.itemsize)
    if len(content) != needed:
        raise ValueError(f"chunk {number} holds {len(content)} bytes instead of {needed}")
    return np.frombuffer(content, dtype=source.stored).reshape(source.chunk)


def _in_order(content: bytes, size: int) -> bytes:
    """Numbers, out of all their first bytes, all their second bytes ..."""
    return np.frombuffer(content, np.uint8).reshape(size, -1).T.tobytes()
