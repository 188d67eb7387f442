"""Access to cubes of any size by rows: only the requested numbers are read."""

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
    """Source of ``h`` x ``w`` pixels with ``m`` bands; reading is thread-safe.

    Sources hold no open file, so that they can be pickled and read in another process.
    """

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns, bands."""

    @property
    def dtype(self) -> np.dtype:
        """Type of the result of ``rows``, in the byte order of this machine."""

    @property
    def chunk_rows(self) -> int:
        """Number of rows that are decoded together; blocks of a multiple are cheapest to read."""

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, with the strides in which they are stored.

        ``into`` is memory that may be used for the result instead of new memory.

        Parameters
        ----------
        start
            First row.
        stop
            Row after the last.
        into
            Memory to read into; ``None``: new memory.
        """

    def scratch_bytes(self, rows: int) -> int:
        """Size of ``into`` for this number of rows; 0 if it is not used. [bytes]

        Parameters
        ----------
        rows
            Number of rows.
        """

    def with_bands(self, keep: slice) -> "RowSource":
        """The source restricted to some bands; nothing is read.

        Parameters
        ----------
        keep
            The bands to keep.
        """


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ArrayRows:
    """An array in memory, or any object that can be sliced like one (a dask array).

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
        """Type of the result of ``rows``, in the byte order of this machine."""
        return np.dtype(self.array.dtype).newbyteorder("=")

    @property
    def chunk_rows(self) -> int:
        """Number of rows that are stored, and therefore decoded, together."""
        chunks = getattr(self.array, "chunks", None)
        return int(chunks[0][0]) if chunks else 1

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, with the strides in which they are stored."""
        refuse_other_rows("the array", self.shape, start, stop)
        return np.asarray(self.array[start:stop]).astype(self.dtype, copy=False)

    def scratch_bytes(self, rows: int) -> int:
        """Size of ``into`` for this number of rows; 0 if it is not used. [bytes]"""
        return 0

    def with_bands(self, keep: slice) -> "ArrayRows":
        """The source restricted to some bands; nothing is read."""
        return replace(self, array=self.array[:, :, keep])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReorderedRows:
    """The bands of a source in another order.

    Attributes
    ----------
    source
        The source.
    order
        For each band, the index of the stored band.
    """

    source: RowSource
    order: tuple[int, ...]

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns, bands."""
        return (*self.source.shape[:2], len(self.order))

    @property
    def dtype(self) -> np.dtype:
        """Type of the result of ``rows``, in the byte order of this machine."""
        return self.source.dtype

    @property
    def chunk_rows(self) -> int:
        """Number of rows that are stored, and therefore decoded, together."""
        return self.source.chunk_rows

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, copied in the order of the bands."""
        return self.source.rows(start, stop, into=into)[:, :, list(self.order)]

    def scratch_bytes(self, rows: int) -> int:
        """Size of ``into`` for this number of rows; 0 if it is not used. [bytes]"""
        return self.source.scratch_bytes(rows)

    def with_bands(self, keep: slice) -> "ReorderedRows":
        """The source restricted to some bands; nothing is read."""
        return replace(self, order=self.order[keep])


def row_source(stored: Array | RowSource) -> RowSource:
    """The source of rows of ``stored``; a memory map is read through its file, not its pages.

    Parameters
    ----------
    stored
        An array with axes rows, columns, bands, or a source of rows.

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
    """``stored`` restricted to some bands; nothing is read or copied."""
    return stored[:, :, keep] if isinstance(stored, np.ndarray) else stored.with_bands(keep)


def block(
    array: Any, axes: Sequence[int], start: int, stop: int, bands: range
) -> Shaped[Array, "rows w m"]:
    """Rows and some bands of ``array``; ``axes`` are its axes of rows, columns and bands.

    Only ascending slices are used, because array storage libraries support no others.
    """
    up = bands if bands.step > 0 else bands[::-1]
    index: list[slice] = [slice(None)] * 3
    index[axes[0]] = slice(start, stop)
    index[axes[2]] = slice(up.start, up[-1] + 1, up.step)
    read = np.asarray(array[tuple(index)]).transpose(axes)
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
