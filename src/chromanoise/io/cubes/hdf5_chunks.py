"""HDF5 arrays that are stored in chunks, read without libhdf5.

libhdf5 (2.0.0) returns uninitialized memory for a chunk that inflates to too few bytes, and reads
one chunk at a time. Here an incomplete chunk raises an error, and several threads can read.
"""

import itertools
import math
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Int64, Shaped

DEFLATE, SHUFFLE = 1, 2  # HDF5 filter numbers


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Chunks:
    """An array whose chunks are uncompressed, shuffled or deflated; it supports slicing.

    Attributes
    ----------
    path
        The file.
    index
        Of each chunk the first byte in the file, the length in bytes, and which filters were left
        out (bit k: the k-th); chunks in the order of C.
    filters
        HDF5 numbers of the filters, in the order in which they were applied on writing.
    shape, chunk
        Length of each axis, of the array and of a chunk.
    dtype
        Type of the numbers in the file.
    """

    path: Path
    index: Int64[Array, "chunks 3"]
    filters: tuple[int, ...]
    shape: tuple[int, ...]
    chunk: tuple[int, ...]
    dtype: np.dtype

    def __post_init__(self) -> None:
        _check.same_length("chunks", index=len(self.index), grid=math.prod(self.grid))
        _check.freeze(self, "index")

    @property
    def grid(self) -> tuple[int, ...]:
        """The number of chunks along each axis."""
        return tuple(-(-n // long) for n, long in zip(self.shape, self.chunk, strict=True))

    def __getitem__(self, key: Any) -> Shaped[Array, "..."]:
        """Part of the array, from all chunks that overlap it.

        Parameters
        ----------
        key
            A slice for each axis, which goes up; or ``...`` for the whole array.
        """
        key = (slice(None),) * len(self.shape) if key is ... else key
        wanted = [range(n)[part] for part, n in zip(key, self.shape, strict=True)]
        spans = [range(one[0], one[-1] + 1) for one in wanted]
        result = np.empty([len(span) for span in spans], self.dtype.newbyteorder("="))
        touched = [
            range(span[0] // long, span[-1] // long + 1)
            for span, long in zip(spans, self.chunk, strict=True)
        ]
        with self.path.open("rb", buffering=0) as file:
            for at in itertools.product(*touched):
                overlaps = [
                    _overlap(k * long, long, span)
                    for k, long, span in zip(at, self.chunk, spans, strict=True)
                ]
                numbers = _chunk(self, file, int(np.ravel_multi_index(at, self.grid)))
                result[tuple(to for _, to in overlaps)] = numbers[tuple(of for of, _ in overlaps)]
        return result[tuple(slice(None, None, one.step) for one in wanted)]


def _overlap(first: int, long: int, span: range) -> tuple[slice, slice]:
    """The overlap of a chunk and the requested part: slices of the chunk and of the result."""
    start, stop = max(first, span.start), min(first + long, span.stop)
    return slice(start - first, stop - first), slice(start - span.start, stop - span.start)


def _chunk(source: Chunks, file: BinaryIO, number: int) -> Shaped[Array, "a b c"]:
    first, length, left_out = (int(n) for n in source.index[number])
    file.seek(first)
    content = file.read(length)
    needed = math.prod(source.chunk) * source.dtype.itemsize
    for k, kind in reversed(list(enumerate(source.filters))):
        if left_out >> k & 1:
            continue
        if kind == DEFLATE:
            content = zlib.decompressobj().decompress(content, needed + 1)
        elif kind == SHUFFLE and len(content) == needed:
            content = _in_order(content, source.dtype.itemsize)
    if len(content) != needed:
        raise ValueError(f"chunk {number} holds {len(content)} bytes instead of {needed}")
    return np.frombuffer(content, dtype=source.dtype).reshape(source.chunk)


def _in_order(content: bytes, size: int) -> bytes:
    """Undo the shuffle filter, which stores all first bytes, then all second bytes, ..."""
    return np.frombuffer(content, np.uint8).reshape(size, -1).T.tobytes()
