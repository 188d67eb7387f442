"""Access to cubes of any size by rows: only the requested numbers are read.

For rows that are stored uncompressed in a file, a memory map would be simpler, but its pages count
as memory of the process, and bands that are far apart are loaded page by page. Therefore contiguous
pieces are read into a buffer, which the caller may reuse, because allocating new memory takes
longer than reading.
"""

import math
import mmap
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO, Protocol, runtime_checkable

import numpy as np

from chromanoise.base import Array, InputError, Integer, Shaped, UInt8, dataclass, system_errors_of

_MOST_UNUSED = 4  # times the bytes wanted; above, unused bytes are not kept in memory


class _SingleRows:
    """A source whose rows are stored one by one, and read into new memory."""

    @property
    def chunk_rows(self) -> int:
        """Number of rows that are stored, and therefore decoded, together."""
        return 1

    def scratch_bytes(self, rows: int) -> int:
        """Size of ``into`` for this number of rows; 0 if it is not used. [bytes]"""
        return 0


@dataclass(frozen=True, kw_only=True, eq=False)
class FileRows(_SingleRows):
    """Numbers stored uncompressed in a file, in any order of the axes.

    Attributes
    ----------
    offset
        Position of row 0, column 0, band 0. [bytes]
    stored
        Type of the numbers in the file, byte order included.
    strides
        Step along each axis; may be negative. [bytes]
    """

    path: Path
    offset: int
    stored: np.dtype
    shape: tuple[int, int, int]
    strides: tuple[int, int, int]

    def __post_init__(self) -> None:
        size = self.stored.itemsize
        if any(stride % size for stride in self.strides) or self.stored.kind not in "fiu":
            raise InputError(
                str(self.path),
                "must hold real numbers whose strides are multiples of their size",
                value=self.strides,
                found=f"holds {self.stored} numbers at strides of {self.strides} bytes",
                remedy="save it as ENVI or .npy",
            )
        low = _span(self.shape, self.strides, size)[0] + self.offset
        if low < 0:
            raise InputError(
                str(self.path),
                "must hold all its numbers",
                value=low,
                found=f"its first number would lie at byte {low}",
            )

    @property
    def dtype(self) -> np.dtype:
        """Type of the result of ``rows``, in the byte order of this machine."""
        return self.stored.newbyteorder("=")

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, with the strides in which they are stored."""
        refuse_other_rows(str(self.path), self.shape, start, stop)
        shape = (stop - start, *self.shape[1:])
        plan = _plan(shape, self.strides, self.stored.itemsize)
        buffer = _memory(into, plan.bytes)
        at = self.offset + start * self.strides[0] + plan.low
        with _opened(self.path) as file:
            if plan.scattered:
                return _gathered(self, file, at, shape, plan)
            for k in range(plan.pieces):
                part = memoryview(buffer.data)[k * plan.length : (k + 1) * plan.length]
                _read_into(file, at + k * plan.step, part, self.path)
        numbers = buffer.view(self.stored)
        if not self.stored.isnative:
            numbers = numbers.byteswap(inplace=True).view(self.dtype)
        return np.ndarray(shape, self.dtype, numbers, -plan.low, plan.strides)

    def scratch_bytes(self, rows: int) -> int:
        """Size of ``into`` for this number of rows; 0 if it is not used. [bytes]"""
        shape = (min(rows, self.shape[0]), *self.shape[1:])
        return _plan(shape, self.strides, self.stored.itemsize).bytes

    def with_bands(self, keep: slice) -> "FileRows":
        """The source restricted to some bands; nothing is read."""
        bands = range(self.shape[2])[keep]
        return replace(
            self,
            offset=self.offset + bands.start * self.strides[2],
            shape=(*self.shape[:2], len(bands)),
            strides=(*self.strides[:2], bands.step * self.strides[2]),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class PlaneRows(_SingleRows):
    """A cube of one source per band: pages of one file, or separate files.

    Attributes
    ----------
    planes
        Sources of equal shape, type and strides, each stored row by row without gaps.
    """

    planes: tuple[FileRows, ...]

    def __post_init__(self) -> None:
        first = self.planes[0]
        size = first.stored.itemsize
        packed = (first.shape[1] * size, size)
        for plane in self.planes:
            alike = (plane.shape, plane.stored) == (first.shape, first.stored)
            if not alike or plane.shape[2] != 1 or plane.strides[:2] != packed:
                raise InputError(
                    str(plane.path),
                    "planes must be alike and without gaps",
                    value=plane.shape,
                    found=f"one has shape {plane.shape}, type {plane.stored} "
                    f"and strides {plane.strides}",
                )

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns, bands."""
        return (*self.planes[0].shape[:2], len(self.planes))

    @property
    def dtype(self) -> np.dtype:
        """Type of the result of ``rows``, in the byte order of this machine."""
        return self.planes[0].dtype

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, with the strides in which they are stored."""
        refuse_other_rows(str(self.planes[0].path), self.shape, start, stop)
        shape = (len(self.planes), stop - start, self.shape[1])
        length = shape[1] * shape[2] * self.dtype.itemsize
        buffer = _memory(into, shape[0] * length)
        for k, plane in enumerate(self.planes):
            plane.rows(start, stop, into=buffer[k * length : (k + 1) * length])
        planes = buffer.view(self.dtype).reshape(shape)
        return planes.transpose(1, 2, 0)

    def scratch_bytes(self, rows: int) -> int:
        """Size of ``into`` for this number of rows; 0 if it is not used. [bytes]"""
        return rows * self.shape[1] * self.shape[2] * self.dtype.itemsize

    def with_bands(self, keep: slice) -> "PlaneRows":
        """The source restricted to some bands; nothing is read."""
        return replace(self, planes=self.planes[keep])


def refuse_other_rows(source: str, shape: tuple[int, int, int], start: int, stop: int) -> None:
    """Refuse an empty range of rows, or rows outside the image."""
    if not 0 <= start < stop <= shape[0]:
        raise InputError(
            source,
            f"must be read in rows START < STOP within 0 .. {shape[0]}",
            value=(start, stop),
            found=f"rows {start} to {stop} were requested",
        )


@dataclass(frozen=True, kw_only=True)
class _Plan:
    """The bytes of a file that hold a block: ``pieces`` of ``length`` bytes, ``step`` bytes apart.

    ``low`` is the offset from the first number of a piece to its first byte, negative for negative
    strides; ``strides`` are those in a buffer of all pieces; ``scattered`` is true if the pieces
    hold mostly other rows.
    """

    outer: int = 0
    pieces: int = 1
    step: int = 0
    length: int
    low: int
    strides: tuple[int, int, int]
    scattered: bool = False

    @property
    def bytes(self) -> int:
        return 0 if self.scattered else self.pieces * self.length


def _plan(shape: tuple[int, int, int], strides: tuple[int, int, int], size: int) -> _Plan:
    """One piece if the rows do not overlap; otherwise one per band, or per column."""
    low, high = _span(shape, strides, size)
    if high - low == math.prod(shape) * size or _apart(shape, strides, size):
        return _Plan(length=high - low, low=low, strides=strides)
    outer = 1 if abs(strides[1]) > abs(strides[2]) else 2
    inner = 3 - outer
    low, high = _span((shape[0], shape[inner]), (strides[0], strides[inner]), size)
    length = high - low
    packed = list(strides)
    packed[outer] = length
    return _Plan(
        outer=outer,
        pieces=shape[outer],
        step=strides[outer],
        length=length,
        low=low,
        strides=(packed[0], packed[1], packed[2]),
        scattered=length > _MOST_UNUSED * shape[0] * shape[inner] * size,
    )


def _apart(shape: tuple[int, int, int], strides: tuple[int, int, int], size: int) -> bool:
    """Whether each row ends before the next one begins."""
    low, high = _span(shape[1:], strides[1:], size)
    return abs(strides[0]) >= high - low


def _span(shape: Sequence[int], strides: Sequence[int], size: int) -> tuple[int, int]:
    """First byte, and byte after the last, of all numbers, relative to the first number."""
    ends = [(n - 1) * stride for n, stride in zip(shape, strides, strict=True)]
    return sum(min(end, 0) for end in ends), sum(max(end, 0) for end in ends) + size


def _memory(into: Array | None, size: int) -> UInt8[Array, " bytes"]:
    if into is not None and into.nbytes >= size:
        return into[:size]
    return np.empty(size, dtype=np.uint8)


@contextmanager
def _opened(path: Path) -> Iterator[BinaryIO]:
    """The file; an error of opening or reading is an `InputError`."""
    with system_errors_of(path), path.open("rb", buffering=0) as file:
        yield file


def _read_into(file: BinaryIO, at: int, part: memoryview, path: Path) -> None:
    """Fill ``part``; one read may return less than requested, at most 2 GiB."""
    while part:
        count = _read_some(file, at, part)
        if not count:
            raise InputError(
                str(path),
                "must keep its size while it is read",
                value=len(part),
                found=f"ended {len(part)} bytes too early",
                remedy="copy it again",
            )
        at, part = at + count, part[count:]


def _read_some(file: BinaryIO, at: int, part: memoryview) -> int:
    if hasattr(os, "preadv"):  # half the calls of seek and read; bands are many small pieces
        return os.preadv(file.fileno(), [part], at)
    file.seek(at)
    return int(file.readinto(part))  # type: ignore[attr-defined]


def _gathered(
    source: FileRows, file: BinaryIO, at: int, shape: tuple[int, int, int], plan: _Plan
) -> Shaped[Array, "rows w m"]:
    """A copy, plane by plane, for strides in which rows are the fastest axis."""
    result = np.empty(shape, dtype=source.dtype)
    buffer = np.empty(plan.length, dtype=np.uint8)
    inner = 3 - plan.outer
    flat, strides = (shape[0], shape[inner]), (source.strides[0], source.strides[inner])
    for k in range(plan.pieces):
        _read_into(file, at + k * plan.step, memoryview(buffer.data), source.path)
        plane = np.ndarray(flat, source.stored, buffer, -plan.low, strides)
        np.moveaxis(result, plan.outer, 0)[k] = plane
    return result


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
            First row, counted from 0.
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
            How many rows are read at once.
        """

    def with_bands(self, keep: slice) -> "RowSource":
        """The source restricted to some bands; nothing is read.

        Parameters
        ----------
        keep
            The bands to keep.
        """


@dataclass(frozen=True, kw_only=True, eq=False)
class ArrayRows(_SingleRows):
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

    def with_bands(self, keep: slice) -> "ArrayRows":
        """The source restricted to some bands; nothing is read."""
        return replace(self, array=self.array[:, :, keep])


@dataclass(frozen=True, kw_only=True, eq=False)
class ReorderedRows:
    """The bands of a source in another order.

    Attributes
    ----------
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


@dataclass(frozen=True, kw_only=True, eq=False)
class PaletteRows(_SingleRows):
    """A cube of few different spectra: the pixels of a synthetic scene.

    Attributes
    ----------
    palette
        The different spectra.
    index
        Index into ``palette`` of each pixel.
    """

    palette: Shaped[Array, "k m"]
    index: Integer[Array, "h w"]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Shaped[Array, "h w m"]:
        """The whole cube, for numpy."""
        return self.palette[self.index].astype(dtype or self.dtype)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns, bands."""
        height, width = self.index.shape
        return height, width, self.palette.shape[1]

    @property
    def dtype(self) -> np.dtype:
        """Type of the result of ``rows``, in the byte order of this machine."""
        return self.palette.dtype

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, in new memory."""
        refuse_other_rows("the scene", self.shape, start, stop)
        return np.take(self.palette, self.index[start:stop], axis=0)

    def with_bands(self, keep: slice) -> "PaletteRows":
        """The source restricted to some bands; nothing is read."""
        return replace(self, palette=self.palette[:, keep])


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
