"""The content of a file of pixels before it becomes a cube."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Shaped
from chromanoise.errors import (
    InputError,
    Setting,
)
from chromanoise.scene.rows import FileRows, RowSource

Notes = tuple[str, ...]
Wavelengths = Callable[[], tuple[Array, Notes]]
"""Reads the centers of the bands, with notes. [nm]"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """The content of a file; wavelengths and scale are read only if the caller gives none."""

    pixels: Shaped[Array, "h w m"] | RowSource
    wavelengths: Wavelengths | None = None
    scale: Callable[[], float | None] = lambda: None
    description: str = ""
    units: str = ""
    notes: Notes = ()


def by(shape: tuple[int, ...]) -> str:
    """A shape as text: 156x9025."""
    return "x".join(str(n) for n in shape) or "scalar"


def refuse_other_shape(
    path: Path, pixels: Shaped[Array, "h w m"] | RowSource, shape: tuple[int, int] | None
) -> None:
    """Raise an error if ``shape`` contradicts the picture in the file."""
    if shape is not None and tuple(shape) != pixels.shape[:2]:
        raise InputError(
            "shape",
            f"must be that of {path}, {by(pixels.shape[:2])} pixels",
            value=tuple(shape),
            found=f"is {by(shape)}",
            remedy="omit it",
        )


def packed_rows(
    path: Path, offset: int, stored: np.dtype, sizes: Sequence[int], axes: Sequence[int]
) -> FileRows:
    """Rows of an array that is stored in the order of C without gaps.

    ``axes`` are those of rows, columns and bands.
    """
    steps = [math.prod(sizes[axis + 1 :]) * stored.itemsize for axis in range(3)]
    row, column, band = axes
    return FileRows(
        path=path,
        offset=offset,
        stored=stored,
        shape=(sizes[row], sizes[column], sizes[band]),
        strides=(steps[row], steps[column], steps[band]),
    )


def picture(
    path: Path, what: str, array: Array, shape: tuple[int, int] | None, *, by_columns: bool
) -> tuple[Shaped[Array, "rows columns bands"], Notes]:
    """A view with axes (rows, columns, bands), and a note on the order of the pixels."""
    if array.ndim == 3 and array.size:
        refuse_other_shape(path, array, shape)
        return array, ()
    if array.ndim != 2 or not array.size:
        raise InputError(
            str(path),
            "must have axes (rows, columns, bands), or pixels in one axis and bands in the other, "
            "and must not be empty",
            where=what,
            value=array.shape,
            found=f"is {by(array.shape)}",
        )
    rows, columns = _rows_and_columns(path, what, array, shape)
    spectra = array if array.shape[0] == rows * columns else array.T
    if by_columns:
        pixels = spectra.reshape(columns, rows, -1).transpose(1, 0, 2)
        return pixels, ("pixels taken column by column, as MATLAB does",)
    return spectra.reshape(rows, columns, -1), ("pixels taken row by row, as NumPy does",)


def _rows_and_columns(
    path: Path, what: str, array: Array, shape: tuple[int, int] | None
) -> tuple[int, int]:
    if shape is None:
        raise InputError(
            str(path),
            "must have rows and columns in two axes, or a given shape (rows, columns) [pixels]",
            where=what,
            value=array.shape,
            found=f"is {by(array.shape)}",
            remedy=Setting("shape"),
        )
    fits = [min(shape) > 0 and n == math.prod(shape) for n in array.shape]
    if not any(fits):
        raise InputError(
            "shape",
            f"must have as many pixels as an axis of {what} in {path} ({by(array.shape)})",
            value=tuple(shape),
            found=f"{by(shape)} is {math.prod(shape)} pixels",
        )
    if all(fits):
        raise InputError(
            str(path),
            f"must have only one axis of {math.prod(shape)} pixels ({by(shape)})",
            where=what,
            value=array.shape,
            found=f"is {by(array.shape)}, so pixels and bands cannot be distinguished",
            remedy="save it with axes (rows, columns, bands)",
        )
    return shape
