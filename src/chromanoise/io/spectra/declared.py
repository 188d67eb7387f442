"""What a file of spectra declares: units, known ``key: value`` lines, and its wavelengths.

Only headings and these keys determine units, scale and quantity. Free text is ignored, so that a
title or a comment about the measurement cannot change them. A list of wavelengths is recognized by
its usual names; where there are several, the one that applies is chosen.
"""

import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import product
from pathlib import Path
from types import MappingProxyType

import numpy as np

from chromanoise.base import Array, Float, Setting, dataclass, printable
from chromanoise.io.source_files import has, refused
from chromanoise.io.spectra.parsed import SENSITIVE_NM, Quantity, Scale, Unit

_KEY = re.compile(r"\s*([A-Za-z][A-Za-z _-]{0,40}?)\s*[:=]\s*(\S.*)")
_OF_WAVELENGTHS = r"(?:wave(?:length)?s?|lambda|x(?:[ _]?axis)?)"
_KEYS = {
    "quantity": r"quantity",
    "unit": r"(?:y[ _]?)?units?",
    "scale": r"scale",
    "level": r"level",
    "per": r"per",
    "wavelength_unit": rf"{_OF_WAVELENGTHS}[ _]?units?|units? of {_OF_WAVELENGTHS}",
}
_QUANTITIES: tuple[tuple[Quantity, str], ...] = (
    ("QE", r"(?:absolute |relative )?(?:qe|quantum[ _]?efficiency)"),
    ("response", r"(?:spectral )?(?:responsivity|sensitivity|response)"),
    ("reflectance", r"(?:spectral )?(?:reflectance|reflectivity)(?: factor)?"),
    ("transmittance", r"(?:spectral )?(?:transmittance|transmission|throughput)"),
    ("power", r"(?:spectral )?(?:power|irradiance|radiance|exitance|flux|spd)"),
)
UNITS: dict[str, Unit] = {
    **dict.fromkeys(("nm", "nanometer", "nanometre"), "nm"),
    **dict.fromkeys(("um", "µm", "μm", "micron", "micrometer", "micrometre"), "um"),
    **dict.fromkeys(("angstrom", "ångström", "ångstrom", "angström", "å", "ang", "aa"), "angstrom"),
    **dict.fromkeys(("1/cm", "cm-1", "cm^-1", "cm⁻¹", "wavenumber", "kayser"), "1/cm"),
}  # fmt: skip
"""Units of wavelengths by their names in lower case, singular."""

_MOST_UM = 20.0
_NOT_READ = ("m", "mm", "ev", "kev", "hz", "ghz", "thz", "phz", "pixel", "px")
_WORD = re.compile(r"1/cm|cm\^?-1|cm⁻¹|[^\W\d_]+")
_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]+?)\s*[\])]\s*$")
_UNIT_OF_VALUES = (
    r"%|percent|pct|fraction|1|dimensionless|none|a\s*/\s*w|e-?\s*/\s*(?:photon|ph)|counts?|dn|"
    r"photons?|quanta|flam|fnu|photlam|photnu|(?:photons?|[µum]?[wj])"
    r"(?:[\s/*.^·⁻¹²0-9-]|per|s(?![a-z])|sec|hz|cm|nm|um|µm|m|sr|angstroms?)*"
)
_OF_VALUES = re.compile(rf"|-|{_UNIT_OF_VALUES}", re.IGNORECASE)
_FACT_OF_COLUMN = re.compile(r"\b(\w+):\s*('[^']*'|\"[^\"]*\"|[^,}\n]*)")
_VALUES = {
    "unit": _UNIT_OF_VALUES,
    "scale": r"%|percent|pct|fraction|as written",
    "wavelength_unit": r"\S{1,20}",
}


def declared_keys(comments: Iterable[str]) -> Mapping[str, str]:
    """The declarations in comment lines, by standard names of the keys.

    Examples
    --------
    >>> dict(declared_keys(["Wavelength units: Angstrom", "bench: 0.2 A/W", "scale = percent"]))
    {'wavelength_unit': 'Angstrom', 'scale': 'percent'}
    """
    found: dict[str, str] = {}
    for match in filter(None, map(_KEY.fullmatch, comments)):
        for key, words in _KEYS.items():
            if re.fullmatch(words, match[1], re.IGNORECASE):
                value = match[2].strip().strip("'\"")
                value = value[1:-1] if value[0] + value[-1] == "[]" else value
                if re.fullmatch(_VALUES.get(key, ".*"), value, re.IGNORECASE):
                    found.setdefault(key, value)
    return MappingProxyType(found)


def quantity_of_key(keys: Mapping[str, str]) -> Quantity | None:
    """The quantity that a key names; None for any other value.

    Examples
    --------
    >>> quantity_of_key({"quantity": "QE [e-/photon]"})
    'QE'
    >>> quantity_of_key({"quantity": "three sensors, reflectance standard used"})
    """
    name = _BRACKETS.sub("", keys.get("quantity", "")).strip()
    for quantity, words in _QUANTITIES:
        if re.fullmatch(words, name, re.IGNORECASE):
            return quantity
    return None


def scale_of_key(keys: Mapping[str, str]) -> Scale | None:
    """``percent`` or ``fraction``, if a key declares it."""
    text = f"{keys.get('scale', '')} {keys.get('unit', '')}".lower().split()
    if {"percent", "%", "pct"} & set(text):
        return "percent"
    return "fraction" if "fraction" in text else None


def wavelength_unit_of(heading: str) -> Unit | None:
    """The unit named in the heading of the wavelengths or in a declared unit.

    Raises
    ------
    InputError
        If the heading names two units, or one that is not supported for wavelengths.

    Examples
    --------
    >>> [wavelength_unit_of(h) for h in ("Wavelength [um]", "wave_nm", "lambda (A)", "x", "cm-1")]
    ['um', 'nm', 'angstrom', None, '1/cm']
    """
    bracket = _BRACKETS.search(heading)
    inside = bracket[1].strip() if bracket else ""
    words = [word for word in re.split(r"[\s_,/]+", heading.strip("[]() ")) if word]
    last = inside or (words[-1] if words else "")
    if last.lower() in _NOT_READ or re.match(r"[\d.]+\s*[^\W\d]", inside):
        raise refused(
            "heading of the wavelengths", "must have the unit nm, um, angstrom or 1/cm", last
        )
    if (inside or heading[-2:].strip("_")) in ("A", "A.", "AA") and (inside or "_" in heading):
        return "angstrom"
    found = [
        UNITS.get(word.lower()) or UNITS.get(word.lower().rstrip("s"))
        for word in _WORD.findall(heading)
    ]
    units = {unit for unit in found if unit}
    if len(units) > 1:
        held = f"{heading[:60]!r} names {' and '.join(sorted(units))}"
        raise refused("heading of the wavelengths", "must name one unit", heading, held)
    return next(iter(units), None)


def unit_that_fits(low: float, high: float) -> Unit | None:
    """The only unit in which the numbers are wavelengths to which silicon is sensitive.

    Parameters
    ----------
    low, high
        The smallest and the largest number.

    Returns
    -------
    unit
        ``None`` if none fits, or if a unit ten times smaller also fits.

    Examples
    --------
    >>> [unit_that_fits(*span) for span in ((380, 780), (0.38, 1.1), (3000, 11000), (1000, 3950))]
    ['nm', 'um', None, None]
    """
    if 0.1 <= low < 1e-3 * SENSITIVE_NM[1] and high < _MOST_UM:
        return "um"
    if 100 <= low < 1000 and _fits(low, high) and not _fits(low / 10, high / 10):
        return "nm"
    return None


def _fits(low_nm: float, high_nm: float) -> bool:
    return bool(low_nm < SENSITIVE_NM[1] and high_nm > SENSITIVE_NM[0])


def known_unit(unit: str, source: str) -> Unit:
    """The unit of wavelengths that a format names.

    Raises
    ------
    InputError
        If the unit is not supported for wavelengths.

    Examples
    --------
    >>> known_unit("Micrometers", "a library")
    'um'
    """
    bare = unit.strip()
    known = None if bare.lower() in _NOT_READ else wavelength_unit_of(f"[{bare}]")
    if known is None:
        raise refused(
            source, "wavelengths must be in nm, um, angstrom or 1/cm", unit, f"are in {unit[:40]!r}"
        )
    return known


def is_wavelength_heading(cell: str) -> bool:
    """Whether a cell is only the heading of a column of wavelengths.

    Examples
    --------
    >>> [is_wavelength_heading(c) for c in ("Wavelength in nm", "wl", "1/cm", "error 1 nm", "5 nm")]
    [True, True, True, False, False]
    """
    if re.search(r"\d", _WORD.sub("", cell.lower())):
        return False
    words = [w for w in _WORD.findall(cell.lower()) if w not in ("in", "vac", "vacuum", "air")]
    names = {"wavelength", "wave", "lambda", "λ", "wl", "wvl", "center", "centre", "band", "a"}
    known = [w for w in words if w in names or w.rstrip("s") in names or w.rstrip("s") in UNITS]
    return bool(words) and len(known) == len(words) and words != ["a"]


def is_row_of_units(cells: Iterable[str]) -> bool:
    """Whether the cells are a unit of wavelengths followed only by units of values.

    Examples
    --------
    >>> is_row_of_units(["nm", "%", "%"]), is_row_of_units(["ANGSTROM", "FLAM"])
    (True, True)
    >>> is_row_of_units(["[nm]", "[counts]", "[% transmittance]"])
    True
    >>> is_row_of_units(["nm", "R", "G"]), is_row_of_units(["wavelength", "%"])
    (False, False)
    """
    whole = [cell.strip() for cell in cells]
    first, *rest = [cell.strip("[]()").strip() for cell in whole] or [""]
    known = first.lower() in UNITS or first.lower().rstrip("s") in UNITS
    bracketed = all(cell[:1] + cell[-1:] in ("[]", "()") for cell in whole)
    units = bracketed or all(map(_OF_VALUES.fullmatch, rest))
    return known and bool(rest) and units and any(rest)


def with_units(names: Iterable[str], units: Iterable[str]) -> tuple[str, ...]:
    """Headings with the units below them appended: ``wavelength``, ``nm`` become one cell."""
    return tuple(
        f"{name} [{bare}]" if (bare := unit.strip().strip("[]()")) else name
        for name, unit in zip(names, units, strict=True)
    )


def ecsv_units(comments: Iterable[str]) -> Mapping[str, str]:
    """The unit of each column that the header of an ECSV file declares.

    Notes
    -----
    Enhanced CSV, Astropy Proposal for Enhancement 6: comment lines that begin with ``%ECSV`` and
    hold YAML with ``name`` and ``unit`` of each column, in flow or in block style.

    Examples
    --------
    >>> dict(ecsv_units(["%ECSV 1.0", "---", "- {name: wave, unit: Angstrom, datatype: float64}"]))
    {'wave': 'Angstrom'}
    """
    lines = list(comments)
    if not any(line.startswith(("%ECSV", "ECSV")) for line in lines):
        return MappingProxyType({})
    found: dict[str, str] = {}
    for entry in re.split(r"(?m)^\s*-\s", "\n".join(lines)):
        facts: dict[str, str] = {}
        for key, value in _FACT_OF_COLUMN.findall(entry):  # a description may mention a unit
            facts.setdefault(key, value.strip().strip("'\""))
        if facts.get("name") and facts.get("unit"):
            found[facts["name"]] = facts["unit"]
    return MappingProxyType(found)


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
_NAMED_WAVELENGTH = re.compile(
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


@dataclass(frozen=True, kw_only=True, eq=False)
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


def named_wavelengths(texts: Sequence[str]) -> Float[Array, " m"] | None:
    """The wavelength in each text, such as ``376.44 Nanometers``; None if a text has none. [nm]

    Examples
    --------
    >>> named_wavelengths(["Band 1: 0.45 um", "Band 2 (500 nm)"]), named_wavelengths(["red"])
    (array([450., 500.]), None)
    """
    found = [_NAMED_WAVELENGTH.search(text) for text in texts]
    if not found or None in found:
        return None
    return np.array([float(m[1]) * NM_PER[m[2].lower()] for m in found if m is not None])


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
            need = f"must list 1 to {_MOST_WAVELENGTHS} wavelengths"
            where = f"array {printable(one.name)!r}"
            remedy = ("correct it", Setting("wavelengths"))
            raise has(path, need, one.size, "lists", where=where, remedy=remedy)
    (first, notes), *others = [
        nanometers(path, one.name, np.ravel(one.numbers()), one.unit) for one in lists
    ]
    for one, (other, _) in zip(lists[1:], others, strict=True):
        if first.shape != other.shape or not np.allclose(first, other, rtol=_SAME, atol=0):
            need = "lists of wavelengths must agree"
            found = f"{printable(lists[0].name)!r} and {printable(one.name)!r} differ"
            names = (lists[0].name, one.name)
            raise refused(path, need, names, found, remedy=Setting("wavelengths"))
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
    need = "must declare nm or um"
    found = f"has {unit_text} for wavelengths {low:g} .. {high:g}"
    where = f"list {printable(name)!r}"
    remedy = ("declare it", Setting("wavelengths"))
    raise refused(path, need, (float(low), float(high)), found, where=where, remedy=remedy)
