"""Codes of raw frames as they are stored: bounds, planes read in place, and whole numbers."""

import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Integer, Shaped
from chromanoise.errors import InputError
from chromanoise.io.cubes.raw_cube import by

MOST_PIXELS = 400_000_000
"""Most pixels of one frame."""
MOST_FRAMES = 20_000
"""Most frames of one file."""
_BLOCK_PIXELS = 4_000_000
_LARGEST = 2**31 - 1


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredPlane:
    """Reads an uncompressed frame from its place in a file.

    Attributes
    ----------
    path
        The file.
    size
        Its size when the header was read. [bytes]
    offset
        Where the first code is. [bytes]
    stored
        Type of a code, with its byte order.
    shape
        Rows and columns. [px]
    by_columns
        Whether the columns are stored one after another.
    """

    path: Path
    size: int
    offset: int
    stored: np.dtype
    shape: tuple[int, int]
    by_columns: bool = False

    def __call__(self) -> Integer[Array, "h w"]:
        """The codes. [DN]

        Raises
        ------
        InputError
            If the file cannot be read, has another size, or holds fractions.
        """
        return whole_codes(str(self.path), self.values())

    @property
    def has_rows(self) -> bool:
        """Whether the rows are stored one after another, as integers."""
        return not self.by_columns and self.stored.kind in "ui"

    def blocks(self, rows: int) -> Iterator[Integer[Array, "rows w"]]:
        """The codes of ``rows`` rows at a time, in memory that is used again for the next. [DN]

        Raises
        ------
        InputError
            As the call.
        """
        memory = np.empty((min(rows, self.shape[0]), self.shape[1]), self.stored)
        with self._opened() as file:
            for start in range(0, self.shape[0], rows):
                block = memory[: self.shape[0] - start]
                if file.readinto(block) != block.nbytes:  # type: ignore[attr-defined]
                    raise self._of_other_size(self.path.stat().st_size)
                yield whole_codes(str(self.path), block)

    def values(self) -> Shaped[Array, "h w"]:
        """The numbers in the file, before they are checked.

        Raises
        ------
        InputError
            If the file cannot be read or has another size.
        """
        with self._opened() as file:
            count = math.prod(self.shape)
            values: Any = np.fromfile(file, self.stored, count)
        if values.size != count:
            raise self._of_other_size(self.path.stat().st_size)
        return values.reshape(self.shape[::-1]).T if self.by_columns else values.reshape(self.shape)

    @contextmanager
    def _opened(self) -> Iterator[BinaryIO]:
        """The file at the first code."""
        try:
            with self.path.open("rb", buffering=0) as file:
                size = os.fstat(file.fileno()).st_size
                if size != self.size:
                    raise self._of_other_size(size)
                file.seek(self.offset)
                yield file
        except OSError as error:
            raise InputError(str(self.path), f"cannot be read ({error.strerror})") from None

    def _of_other_size(self, size: int) -> InputError:
        return InputError(
            str(self.path),
            f"must have {self.size} bytes, as when its header was read",
            value=size,
            found=f"has {size}",
        )


def refuse_shape(path: Path, where: str, shape: tuple[int, ...]) -> None:
    """Refuse a frame or stack that is empty, too large, or not of one channel.

    Parameters
    ----------
    path, where
        The file and the array in it.
    shape
        Rows and columns, or frames, rows and columns.

    Raises
    ------
    InputError
        If there are other dimensions, a side is 0, or there are too many pixels or frames.
    """
    if len(shape) not in (2, 3):
        raise InputError(
            str(path),
            "must hold frames of rows and columns, or a stack of them",
            where=where,
            value=shape,
            found=f"has {len(shape)} dimensions" if len(shape) != 1 else "is a list",
        )
    if min(shape) < 1:
        raise InputError(
            str(path), "must not be empty", where=where, value=shape, found=f"is {by(shape)}"
        )
    if math.prod(shape[-2:]) > MOST_PIXELS:
        raise InputError(
            str(path),
            f"must have at most {MOST_PIXELS // 10**6} million pixels a frame",
            where=where,
            value=shape,
            found=f"is declared as {by(shape)}",
        )
    if len(shape) == 3 and shape[0] > MOST_FRAMES:
        raise InputError(
            str(path),
            f"must hold at most {MOST_FRAMES} frames",
            where=where,
            value=shape[0],
            found=f"holds {shape[0]}",
        )
    if len(shape) == 3 and shape[2] in (3, 4):
        raise refused_picture(path, f"is a color picture of {by(shape)}", where)


def refused_picture(path: Path, found: str, where: str = "") -> InputError:
    """The error for a picture of several channels, or of a lossy format."""
    return InputError(
        str(path),
        "must be a raw frame of one channel",
        where=where,
        found=found,
        remedy="use the frames before they are demosaicked or compressed, e.g. as DNG, TIFF or NPY",
    )


def whole_codes(name: str, values: Shaped[Array, "h w"]) -> Integer[Array, "h w"]:
    """Integers of the byte order of this machine; floats without fractions become integers.

    Parameters
    ----------
    name
        The file, for the error.
    values
        Integers are returned as they are. Floats become uint16, or int32 if they do not fit.

    Raises
    ------
    InputError
        If a value is not a whole number of 32 bits, or the values are not numbers.

    Examples
    --------
    >>> whole_codes("a.npy", np.array([[64.0, 1023.0]]))
    array([[  64, 1023]], dtype=uint16)
    """
    if values.dtype.kind in "ui":
        return values.astype(values.dtype.newbyteorder("="), copy=False)
    if values.dtype.kind != "f":
        kind = "objects" if values.dtype.hasobject else values.dtype.name
        raise InputError(name, "must hold integer codes", value=kind, found=f"holds {kind}")
    rows = max(1, _BLOCK_PIXELS // values.shape[1])
    low = high = 0.0
    for start in range(0, values.shape[0], rows):
        block = values[start : start + rows]
        with np.errstate(invalid="ignore"):
            bad = ~(np.isfinite(block) & (np.rint(block) == block) & (np.abs(block) <= _LARGEST))
        if bad.any():
            row, column = (int(i) for i in np.argwhere(bad)[0])
            first = float(block[row, column])
            raise InputError(
                name,
                "must hold whole codes, because processed frames are not raw",
                value=first,
                found=f"holds {first:g} in row {start + row}, column {column} (from 0)",
                remedy="use the frames as the camera delivers them",
            )
        low, high = min(low, float(block.min())), max(high, float(block.max()))
    return values.astype(np.uint16 if low >= 0 and high <= 65535 else np.int32)
