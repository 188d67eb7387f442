"""Preview of a file for a sensor or a study: crosstalk, a color matrix, a pixel, pairs."""

from dataclasses import fields
from typing import Any

from chromanoise import _check
from chromanoise.catalog.patch_pairs import PAIRS_HEADER, resolve_pairs
from chromanoise.catalog.pixel_files import read_pixel_source
from chromanoise.errors import InputError
from chromanoise.io.crosstalk import crosstalk_table
from chromanoise.io.given_matrices import GivenMatrix, is_matrix_file, read_matrix
from chromanoise.page.uploads import Upload
from chromanoise.sensor import PixelSource

Data = dict[str, Any]
_BESIDE = ("source", "notes", "adc")
_FROM = {"electrons": "raw electrons", "balanced": "white-balanced raw", "from-xyz": "XYZ"}


def crosstalk_preview(upload: Upload) -> Data:
    """What a file of crosstalk holds.

    Raises
    ------
    InputError
        If it is no table of shares of light.
    """
    table = crosstalk_table(upload.path)
    _check.fraction(f"crosstalk of {upload.label}", "1", table.values)
    rows, columns = table.values.shape
    if table.columns:
        line = f"Crosstalk between the channels {', '.join(table.columns)}."
    elif rows == columns and rows % 2:
        line = f"A crosstalk kernel of {rows} x {columns} pixels, for a sensor with a mosaic."
    else:
        raise InputError(
            upload.label,
            "must have as many rows as columns, an odd number, to be a crosstalk kernel",
            value=table.values.shape,
        )
    return {"kind": "crosstalk", "preview": [line]}


def is_pairs(upload: Upload) -> bool:
    """Whether the file is a list of pairs of patches, which its header tells."""
    with upload.path.open("rb") as file:
        start = file.readline(200).decode("utf-8-sig", errors="replace")
    return tuple(word.strip().lower() for word in start.split(",")) == PAIRS_HEADER


def pairs_preview(upload: Upload) -> Data:
    """What a list of pairs of patches holds.

    Raises
    ------
    InputError
        If a line does not name two known patches.
    """
    count = len(resolve_pairs(str(upload.path)).indices)
    return {"kind": "pairs", "preview": [f"Pairs of patches for a machine: {count}."]}


def matrix_preview(upload: Upload) -> Data:
    """What a file of a color matrix holds.

    Raises
    ------
    InputError
        If it holds none.
    """
    if not is_matrix_file(upload.label):
        raise InputError(upload.label, "must have the ending of a color matrix, e.g. .csv or .json")
    found = read_matrix(upload.path)
    rows, columns = found.values.shape
    line = f"A color matrix, {rows} x {columns}: {_FROM[found.kind]} to {_target(found)}"
    return {"kind": "matrix", "preview": [f"{line}{_made_for(found)}.", *found.notes]}


def _target(found: GivenMatrix) -> str:
    if found.kind == "from-xyz":
        return "camera values"
    return "XYZ [lx/e-]" if found.kind == "electrons" else found.target


def _made_for(found: GivenMatrix) -> str:
    level = "" if found.level_lux is None else f"{found.level_lux:g} lx"
    kelvin = "" if found.kelvin is None else f"{found.kelvin:g} K"
    known = [one for one in (found.sensor, found.illuminant, level, kelvin) if one]
    channels = f"; channels {', '.join(found.channels)}" if found.channels else ""
    return f"{channels}; made for {', '.join(known)}" if known else channels


def pixel_preview(upload: Upload) -> Data:
    """What a file with the values of a pixel holds.

    Raises
    ------
    InputError
        If it holds none.
    """
    found = read_pixel_source(upload.path)
    known = _known_values(found)
    line = f"The values of a pixel: {', '.join(known) or 'none that a sensor takes'}."
    return {"kind": "pixel", "preview": [line, *found.notes]}


def _known_values(source: PixelSource) -> list[str]:
    own = [one.name for one in fields(source) if one.name not in _BESIDE]
    known = {name: getattr(source, name) for name in own}
    return [f"{name} = {value:.6g}" for name, value in known.items() if value is not None]
