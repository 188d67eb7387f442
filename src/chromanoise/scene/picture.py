"""Pixels in one axis, made a picture."""

import math
from pathlib import Path

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Shaped
from chromanoise.scene.found import Notes, by, refuse_other_shape


def picture(
    path: Path, what: str, array: Array, shape: tuple[int, int] | None, *, by_columns: bool
) -> tuple[Shaped[Array, "rows columns bands"], Notes]:
    """A view with axes (rows, columns, bands), and how the pixels were taken."""
    if array.ndim == 3 and array.size:
        refuse_other_shape(path, array, shape)
        return array, ()
    if array.ndim != 2 or not array.size:
        raise _check.InputError(
            f"{path}: {what} must have axes (rows, columns, bands), or pixels in one axis and "
            f"bands in the other, and not be empty, but is {by(array.shape)}"
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
    told = f"{path}: {what} is {by(array.shape)}"
    if shape is None:
        raise _check.InputError(
            f"{told}, pixels in one axis; say its rows and columns with --shape ROWSxCOLUMNS"
        )
    fits = [min(shape) > 0 and n == math.prod(shape) for n in array.shape]
    if not any(fits):
        raise _check.InputError(
            f"{told}, but --shape {by(shape)} is {math.prod(shape)} pixels, which is neither "
            "axis; mend --shape ROWSxCOLUMNS"
        )
    if all(fits):
        raise _check.InputError(
            f"{told}, and --shape {by(shape)} fits both axes, so pixels and bands cannot be told "
            "apart; save it with axes (rows, columns, bands)"
        )
    return shape
