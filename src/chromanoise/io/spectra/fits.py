"""Tables in FITS files, read with astropy."""

import importlib
import io
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise.errors import InputError
from chromanoise.io.spectra.declared import known_unit
from chromanoise.io.spectra.parsed import LARGEST, Found, has, known_columns, missing_notes

_WAVELENGTH = re.compile(r"(?i)(wavelengths?|waves?|wl|lambda|lam|loglam)(?![a-z])")
_MOST_CURVES = 1000


def read_fits(path: Path, content: bytes) -> Found:
    """The curves of the first table with a column of wavelengths, their units from ``TUNITn``.

    Raises
    ------
    InputError
        If astropy is not installed, or no table has such a column.

    Notes
    -----
    FITS Standard 4.0 (IAU FITS Working Group, 2018), sections 4.3 and 7.
    """
    with _astropy_fits(path).open(io.BytesIO(content), memmap=False) as parts:
        for place, part in enumerate(parts):
            names = list(getattr(getattr(part, "columns", None), "names", None) or ())
            at_names = [name for name in names if _WAVELENGTH.match(name)]
            if at_names:
                return _table(path, part, place, at_names[0])
    raise InputError(
        str(path),
        "must have a table with a column named wavelength, wave, lambda or wl",
        remedy=("write the spectrum as such a table", "save it as CSV"),
    )


def _astropy_fits(path: Path) -> Any:
    try:
        return importlib.import_module("astropy.io.fits")
    except ImportError:
        raise InputError(
            str(path),
            "is a FITS file, which needs the package astropy",
            remedy="install it with: pip install 'chromanoise[fits]'",
        ) from None


def _table(path: Path, part: Any, place: int, at_name: str) -> Found:
    if at_name.lower().startswith("loglam"):
        raise InputError(
            str(path), "must hold wavelengths, not their logarithms", where=f"column {at_name!r}"
        )
    units = {column.name: (column.unit or "").strip() for column in part.columns}
    at = _numbers(path, part, at_name)
    if part.data[at_name].dtype.itemsize == 4:  # 0.4 um in 4 bytes is 0.4, not 0.4000000060
        at = np.array([float(str(np.float32(value))) for value in at])
    if not np.isfinite(at).all():
        raise InputError(str(path), "has rows without a wavelength", where=f"column {at_name!r}")
    others = [name for name in part.columns.names if name != at_name]
    curves = {
        name: values for name in others if (values := _curve(path, part, name, at)) is not None
    }
    if not 0 < len(curves) <= _MOST_CURVES:
        need = f"must have 1 to {_MOST_CURVES} columns with the length of {at_name!r}"
        raise has(str(path), need, len(curves))
    unit = known_unit(units[at_name], str(path)) if units[at_name] else ""
    return Found(
        source=str(path),
        format=f"FITS, table in part {place}",
        columns=tuple(
            replace(one, unit=units[one.name]) for one in known_columns(at, curves.items())
        ),
        heading=f"{at_name} [{unit}]" if unit else at_name,
        words=" ".join(str(part.header.get(key, "")) for key in ("EXTNAME", "OBJECT", "TITLE")),
        defects=missing_notes(at, curves.items(), "values that are no number (NaN or TNULL)"),
    )


def _curve(path: Path, part: Any, name: str, at: Array) -> Array | None:
    """The numbers of a column; None if it contains text or has another length."""
    if part.data[name].dtype.kind not in "fiu":
        return None
    values = _numbers(path, part, name)
    return values if values.size == at.size else None


def _numbers(path: Path, part: Any, name: str) -> Array:
    """One number per row, or the one row of a table whose cells are lists; NaN for ``TNULLn``."""
    column = np.asarray(part.data[name])
    if column.dtype.kind not in "fiu" or (column.ndim > 1 and len(column) != 1):
        raise InputError(str(path), "is not a list of numbers", where=f"column {name!r}")
    values = column.astype(np.float64).ravel()
    stored, null = np.asarray(part.data)[name], part.columns[name].null
    if stored.dtype.kind in "iu" and null is not None:  # TNULLn is the number before TSCALn, TZEROn
        values[stored.ravel() == null] = np.nan
    if (np.abs(values) > LARGEST).any():
        raise InputError(
            str(path),
            "must be at most 1e30",
            value=float(np.nanmax(np.abs(values))),
            where=f"column {name!r}",
        )
    return values
