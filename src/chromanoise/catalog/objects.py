"""Curves that are objects of Python: of colour-science, pandas, xarray, NumPy, and our own.

An object becomes the `Found` of a file, so it is interpreted and checked as a file is. The foreign
packages are not imported.
"""

import re
from collections.abc import Mapping
from typing import Any, get_args

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise.errors import InputError
from chromanoise.io.spectra.declared import is_wavelength_heading, wavelength_unit_of
from chromanoise.io.spectra.merging import in_nm
from chromanoise.io.spectra.parsed import LARGEST, Column, Found, Quantity
from chromanoise.spectra import Spectra

CURVES = (
    "a spectral distribution of colour-science, a DataFrame or Series of pandas, a DataArray of "
    "xarray, Spectra, {'wavelength_nm': [...], 'R': [...]}, or (wavelength_nm, values)"
)
"""What counts as curves, in words."""

_PREFIX = "object:"
_AXIS = "wavelength_nm"  # as the heading of a CSV file
_UNNAMED = re.compile(r"\w+ \(\d+\)")  # colour-science: SpectralDistribution (140012345)


def object_word(name: str) -> str:
    """The word of a study that refers to an object of Python.

    Parameters
    ----------
    name
        Name of the object in results.
    """
    return f"{_PREFIX}{name}"


def is_object_word(word: object) -> bool:
    """Whether a word of a study refers to an object of Python.

    Examples
    --------
    >>> is_object_word(object_word("cam")), is_object_word("cam.csv")
    (True, False)
    """
    return isinstance(word, str) and word.startswith(_PREFIX)


def shown_word(word: str) -> str:
    """A word of a study as results show it: an object by its name.

    Examples
    --------
    >>> shown_word(object_word("cam")), shown_word("cam.csv")
    ('cam', 'cam.csv')
    """
    return word.removeprefix(_PREFIX)


def curves_of_object(given: Any, name: str) -> Found | None:
    """The curves in an object of Python, before they are interpreted; ``None`` for other objects.

    Parameters
    ----------
    given
        One of `CURVES`. Wavelengths are in nm, unless the name of an index of pandas or the units
        of a coordinate of xarray declare another unit.
    name
        Name for messages and results, if the object has none.

    Raises
    ------
    InputError
        If the wavelengths do not increase, a value is not a finite number, or the shapes differ.

    Examples
    --------
    >>> found = curves_of_object({"wavelength_nm": [400, 700], "R": [0.1, 0.5]}, "own sensor")
    >>> found.columns[0].name, found.columns[0].values
    ('R', array([0.1, 0.5]))
    """
    if isinstance(given, Spectra):
        known = {"quantity": given.quantity} if given.quantity in get_args(Quantity) else {}
        named = [(one, given.values[:, k]) for k, one in enumerate(given.names)]
        return _found(given.source or name, given.wavelength_nm, named, **known)
    package = _package(given)
    if package == "colour" and hasattr(given, "wavelengths") and hasattr(given, "values"):
        own = "" if _UNNAMED.fullmatch(str(given.name)) else str(given.name)
        values = np.asarray(given.values)
        labels = [own or "value"] if values.ndim == 1 else [str(one) for one in given.labels]
        return _table(own or name, given.wavelengths, values, labels)
    if package == "pandas" and hasattr(given, "index") and hasattr(given, "to_numpy"):
        columns = [str(one) for one in given.columns] if hasattr(given, "columns") else None
        own = str(given.attrs.get("name") or (given.name if columns is None else "") or name)
        heading, columns = str(given.index.name or ""), [own] if columns is None else columns
        return _table(own, given.index, given.to_numpy(), columns, heading=heading)
    if package == "xarray" and hasattr(given, "dims") and hasattr(given, "dtype"):
        return _labeled(given, name)
    if isinstance(given, Mapping) and _AXIS in given:
        others = [(str(one), values) for one, values in given.items() if one != _AXIS]
        return _found(name, given[_AXIS], others)
    if isinstance(given, tuple) and len(given) == 2 and all(map(_is_listed, given)):
        values = _numbers(name, "values", given[1])
        count = values.shape[1] if values.ndim == 2 else 1
        labels = [f"channel {k + 1}" for k in range(count)] if values.ndim == 2 else ["value"]
        return _table(name, given[0], values, labels)
    return None


def is_of_colour_science(given: Any) -> bool:
    """Whether an object is of colour-science, whose lights are power."""
    return _package(given) == "colour"


def _package(given: Any) -> str:
    """The package of an object or of what its class is derived from, if it is a foreign one."""
    packages = [cls.__module__.partition(".")[0] for cls in type(given).__mro__]
    return next((one for one in packages if one in ("colour", "pandas", "xarray")), "")


def _is_listed(one: Any) -> bool:
    return isinstance(one, list | tuple | np.ndarray) and np.ndim(one) > 0


def _labeled(given: Any, name: str) -> Found:
    """The curves of a DataArray with a dimension of wavelengths and at most one of curves."""
    own = str(getattr(given, "name", None) or name)
    found = [
        dim
        for dim in given.dims
        if str(dim) != "band" and is_wavelength_heading(str(dim).replace("_", " "))
    ]
    if len(found) != 1 or len(given.dims) > 2:
        raise InputError(
            own,
            "must be a DataArray with one dimension wavelength, and at most one of curves",
            value=tuple(map(str, given.dims)),
            found=f"has the dimensions {', '.join(map(str, given.dims)) or 'none'}",
        )
    (axis,) = found
    if axis not in given.coords:
        raise InputError(own, "must have wavelengths as a coordinate", value=str(axis))
    coordinate, others = given.coords[axis], [dim for dim in given.dims if dim != axis]
    values = np.asarray(given.transpose(axis, *others).values)
    labels = [own]
    if others:
        known = others[0] in given.coords
        at = given.coords[others[0]].values if known else range(values.shape[1])
        labels = [str(one) for one in at]
    units = coordinate.attrs.get("units", "")
    heading = f"wavelength [{units}]" if units else str(axis)
    unit = str(given.attrs.get("units", ""))
    return _table(own, coordinate.values, values, labels, heading=heading, unit=unit)


def _table(
    source: str,
    wavelength: Any,
    values: Any,
    names: list[str],
    *,
    heading: str = "",
    unit: str = "",
) -> Found:
    """The columns of one array; rows are wavelengths."""
    array = _numbers(source, "values", values)
    array = array[:, None] if array.ndim == 1 else array
    if array.ndim != 2 or len(names) != array.shape[1] or not array.size:
        raise InputError(
            source, "must have axes (wavelengths, curves)", value=np.shape(values), found=None
        )
    columns = [(name, array[:, k]) for k, name in enumerate(names)]
    return _found(source, wavelength, columns, heading=heading, unit=unit)


def _found(
    source: str,
    wavelength: Any,
    columns: list[tuple[str, Any]],
    *,
    heading: str = "",
    unit: str = "",
    **known: Any,
) -> Found:
    """Curves at one list of wavelengths; ``unit`` is that of the values."""
    axis = None
    if heading and is_wavelength_heading(heading.replace("_", " ")):
        axis = wavelength_unit_of(heading)
    at = _check.increasing(
        f"wavelengths of {source}",
        "nm",
        in_nm(_numbers(source, "wavelengths", wavelength), axis or "nm"),
    )
    if not columns:
        raise InputError(source, "must have at least one curve", value=0, found="has none")
    made = []
    for name, given in columns:
        where = f"curve {name!r}"
        values = _numbers(source, where, given)
        if values.shape != at.shape:
            need, found = f"must have {at.size} values, one per wavelength", values.shape
            raise InputError(source, need, value=found, found=f"has shape {found}", where=where)
        bad = ~(np.abs(values) <= LARGEST)
        if bad.any():
            first = int(np.argmax(bad))
            raise InputError(
                source,
                f"must be finite numbers of at most {LARGEST:g}",
                value=float(values[first]),
                found=f"is {values[first]:g} ({int(bad.sum())} of {bad.size} values)",
                where=f"{where} at {at[first]:g} nm",
                remedy="interpolate or remove them",
            )
        made.append(Column(name=name, unit=unit, wavelength=at, values=values))
    return Found(
        source=source,
        format="object of Python",
        columns=tuple(made),
        heading=_AXIS,
        wavelength_unit="nm",
        **known,
    )


def _numbers(source: str, what: str, given: Any) -> Array:
    """An array of real numbers; masked and missing values are NaN."""
    try:
        if isinstance(given, np.ma.MaskedArray):
            given = np.ma.filled(given.astype(np.float64), np.nan)
        if np.asarray(given).dtype.kind not in "fiuO":
            raise TypeError(f"numbers of type {np.asarray(given).dtype}")
        return np.array(given, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        reason = " ".join(str(error).split())[:80]
        raise InputError(
            source, "must hold real numbers", found=f"does not ({reason})", where=what
        ) from None
