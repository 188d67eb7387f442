"""Lists of wavelengths in files: their usual names, their units, and which of several applies."""

import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from chromanoise._check import Array, printable
from chromanoise._shapes import Float
from chromanoise.errors import InputError, Setting
from chromanoise.io.spectra.declared import UNITS, unit_that_fits

Notes = tuple[str, ...]

_NM_PER_UNIT = {"nm": 1.0, "um": 1000.0, "angstrom": 0.1}
NM_PER = {
    word: _NM_PER_UNIT[unit]
    for name, unit in UNITS.items()
    for word in (name, f"{name}s")
    if unit in _NM_PER_UNIT
}
"""Nanometers per unit, by the unit's names in lower case."""

_UNITS = "|".join(sorted(NM_PER, key=len, reverse=True))
NAMED_WAVELENGTH = re.compile(
    rf"(?<![\w.])(\d{{1,6}}\.?\d{{0,9}}|\.\d{{1,9}})\s{{0,4}}({_UNITS})\b", re.I
)

_ALONE = (
    "wavelength", "wavelengths", "wavelen", "wave", "waves", "wl", "wls", "wvl", "wvls", "wlen",
    "lambda", "lambdas", "lam", "center_wavelength", "center_wavelengths", "centre_wavelength",
    "centre_wavelengths", "central_wavelength", "central_wavelengths", "band_wavelength",
    "band_wavelengths", "band_center", "band_centers", "band_centre", "band_centres",
)  # fmt: skip
_WITH_UNIT = (*_ALONE, "band", "bands", "center", "centers", "centre", "centres", "channels")
SPECTRAL_NAMES = frozenset(_ALONE) | {f"{n}_{u}" for n, u in product(_WITH_UNIT, NM_PER)}
"""Names, in lower case, of lists that hold wavelengths; band numbers have other names."""

BAND_NAMES = SPECTRAL_NAMES | {"band", "bands", "channel", "channels", "spectral", "spectrum"}
_MOST_WAVELENGTHS = 100_000
_SAME = 1e-5  # single precision and rounded units


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Listed:
    """A list in a file that may hold the wavelengths, not yet read.

    Attributes
    ----------
    name
        Name in the file; it may end in a unit (``bands_nm``).
    size
        Number of its entries.
    numbers
        Function that reads them.
    unit
        The unit that the file declares for the list; empty if it declares none.
    """

    name: str
    size: int
    numbers: Callable[[], Array]
    unit: str = ""


def is_list(shape: tuple[int, ...]) -> bool:
    """Whether an array of this shape is one-dimensional, except for axes of length 1."""
    return len(shape) > 0 and max(shape) == np.prod(shape, dtype=object)


def fitting(lists: Sequence[Listed], lengths: Collection[int]) -> tuple[Listed, ...]:
    """The lists with one of these lengths; else the first, which the caller rejects."""
    fit = tuple(one for one in lists if one.size in lengths)
    return fit or tuple(lists[:1])


def listed_wavelengths(
    path: Path | str, lists: Sequence[Listed]
) -> tuple[Float[Array, " m"], Notes]:
    """The wavelengths in one list, or in several that agree. [nm]

    Raises
    ------
    InputError
        If the unit of a list is not known, or two lists differ.
    """
    for one in lists:
        if not 1 <= one.size <= _MOST_WAVELENGTHS:
            raise InputError(
                str(path),
                f"must list 1 to {_MOST_WAVELENGTHS} wavelengths",
                value=one.size,
                found=f"lists {one.size}",
                where=f"array {printable(one.name)!r}",
                remedy=("correct it", Setting("wavelengths")),
            )
    (first, notes), *others = [
        nanometers(path, one.name, np.ravel(one.numbers()), one.unit) for one in lists
    ]
    for one, (other, _) in zip(lists[1:], others, strict=True):
        if first.shape != other.shape or not np.allclose(first, other, rtol=_SAME, atol=0):
            raise InputError(
                str(path),
                "lists of wavelengths must agree",
                value=(lists[0].name, one.name),
                found=f"{printable(lists[0].name)!r} and {printable(one.name)!r} differ",
                remedy=Setting("wavelengths"),
            )
    return first, notes


@np.errstate(all="ignore")  # overflows raise an error later, as out of range
def nanometers(
    path: Path | str, name: str, values: Array, unit: str, *, unit_key: str = "unit"
) -> tuple[Float[Array, " m"], Notes]:
    """Wavelengths in nm, from the unit declared, else from the name or the size of the numbers.

    Numbers that could be either nm or Angstrom are refused.

    Parameters
    ----------
    path, name
        Used in messages; the name may end in a unit.
    values
        The numbers, in any unit.
    unit
        The unit that the file declares; empty if it declares none.
    unit_key
        Name of the field in the file that declares the unit.

    Raises
    ------
    InputError
        If the unit is neither declared nor clear from the numbers.

    Examples
    --------
    >>> nanometers("a file", "wl_um", np.array([0.4, 0.7]), "")
    (array([400., 700.]), ())
    """
    listed = np.asarray(values, dtype=np.float64)
    word = unit.strip().lower()
    in_name = name.lower().rpartition("_")[2]
    unit_text = f"{unit_key} {printable(word)!r}" if word else f"no {unit_key}"
    low, high = listed.min(), listed.max()
    if word in NM_PER:
        return listed * NM_PER[word], ()
    if word in ("", "unknown", "1", "index"):
        if in_name in NM_PER:
            return listed * NM_PER[in_name], ()
        fitting = unit_that_fits(low, high)
        if fitting == "nm" or (fitting == "um" and word != "index"):
            what = "nm" if fitting == "nm" else "micrometers"
            note = f"{name!r} has {unit_text}: wavelengths taken as {what}"
            return listed * NM_PER[fitting], (note,)
    raise InputError(
        str(path),
        "must declare nm or um",
        value=(float(low), float(high)),
        found=f"has {unit_text} for wavelengths {low:g} .. {high:g}",
        where=f"list {printable(name)!r}",
        remedy=("declare it", Setting("wavelengths")),
    )
