"""Cubes of any size, a few rows at a time: numbers are asked for, and only those are read."""

import mmap
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Shaped, UInt8
from chromanoise.scene.file_rows import FileRows, refuse_other_rows


@runtime_checkable
class RowSource(Protocol):
    """``h`` x ``w`` pixels with ``m`` bands somewhere; reading changes nothing, on any thread.

    Sources are nouns: they hold no open file, so that another process can take one and read on.
    """

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns, bands."""

    @property
    def dtype(self) -> np.dtype:
        """Of what ``rows`` gives; in the byte order of this machine."""

    @property
    def chunk_rows(self) -> int:
        """Rows that are stored, and so decoded, together; blocks of a multiple cost least."""

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, with the strides in which they are stored.

        ``into`` is memory that may be used instead of new memory; it then belongs to the result.
        """

    def scratch_bytes(self, rows: int) -> int:
        """How large ``into`` must be for so many rows; 0 if it is not used. [bytes]"""

    def with_bands(self, keep: slice) -> "RowSource":
        """The same with some of the bands; nothing is read."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ArrayRows:
    """An array in memory, or anything that is sliced like one (a dask array).

    Attributes
    ----------
    array
        Axes rows, columns, bands.
    """

    array: Any

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns, bands."""
        height, width, bands = self.array.shape
        return int(height), int(width), int(bands)

    @property
    def dtype(self) -> np.dtype:
        """Of what ``rows`` gives; in the byte order of this machine."""
        return np.dtype(self.array.dtype).newbyteorder("=")

    @property
    def chunk_rows(self) -> int:
        """Rows that are stored, and so decoded, together."""
        chunks = getattr(self.array, "chunks", None)
        return int(chunks[0][0]) if chunks else 1

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, with the strides in which they are stored."""
        refuse_other_rows("the array", self.shape, start, stop)
        return np.asarray(self.array[start:stop]).astype(self.dtype, copy=False)

    def scratch_bytes(self, rows: int) -> int:
        """How large ``into`` must be for so many rows; 0 if it is not used. [bytes]"""
        return 0

    def with_bands(self, keep: slice) -> "ArrayRows":
        """The same with some of the bands; nothing is read."""
        return replace(self, array=self.array[:, :, keep])


def row_source(stored: Array | RowSource) -> RowSource:
    """What reads rows of ``stored``: a memory map is read by its file, never through its pages.

    Parameters
    ----------
    stored
        Axes rows, columns, bands; an array, or a source already.

    Examples
    --------
    >>> source = row_source(np.arange(12).reshape(3, 2, 2))
    >>> source.rows(1, 2).tolist()
    [[[4, 5], [6, 7]]]
    """
    if not isinstance(stored, np.ndarray):
        return stored
    root = _map_beneath(stored)
    if root is None:
        return ArrayRows(array=stored)
    height, width, bands = stored.shape
    down, across, along = stored.strides
    return FileRows(
        path=Path(str(root.filename)),
        offset=int(root.offset) + stored.ctypes.data - root.ctypes.data,
        stored=stored.dtype,
        shape=(height, width, bands),
        strides=(down, across, along),
    )


def with_bands(stored: Array | RowSource, keep: slice) -> Array | RowSource:
    """``stored`` with some of its bands, nothing read and nothing copied."""
    return stored[:, :, keep] if isinstance(stored, np.ndarray) else stored.with_bands(keep)


def block(
    array: Any, axes: Sequence[int], start: int, stop: int, bands: range
) -> Shaped[Array, "rows w m"]:
    """Rows of ``array``, whose axes rows, columns, bands are ``axes``, with some of its bands.

    Only slices that go up are asked for, which is all that libraries of stored arrays know.
    """
    up = bands if bands.step > 0 else bands[::-1]
    asked: list[slice] = [slice(None)] * 3
    asked[axes[0]] = slice(start, stop)
    asked[axes[2]] = slice(up.start, up[-1] + 1, up.step)
    read = np.asarray(array[tuple(asked)]).transpose(axes)
    return read if bands.step > 0 else read[:, :, ::-1]


def _map_beneath(array: Array) -> np.memmap | None:
    """The memory map that a view looks into, if its numbers are those of the file."""
    base: object = array
    while isinstance(base, np.ndarray):
        below: object = base.base
        if isinstance(base, np.memmap) and isinstance(below, mmap.mmap):
            return base if base.mode != "c" and base.filename else None
        base = below
    return None
