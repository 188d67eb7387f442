"""Reshape arrays with all pixels in one axis to pictures."""

import math
from pathlib import Path

from chromanoise._check import Array
from chromanoise._shapes import (
    Shaped,
)
from chromanoise.errors import (
    InputError,
    Setting,
)
from chromanoise.io.cubes.raw_cube import Notes, by, refuse_other_shape


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
