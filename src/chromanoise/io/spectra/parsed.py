"""Parsed spectra: what a reader found, answers and questions, resampling, and versioned JSON.

Curves with different wavelengths are resampled to a common list of wavelengths. JSON files of other
versions of the schemas raise an error.
"""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from chromanoise.base import Array, Float, InputError, Setting, check, dataclass, json_of
from chromanoise.io.source_files import has, refused
from chromanoise.spectra import Beyond, Spectra

Quantity = Literal["QE", "response", "reflectance", "transmittance", "power"]
Scale = Literal["fraction", "percent"]
Scaled = Literal["fraction", "percent", "as written"]
Level = Literal["absolute", "relative"]
Per = Literal["photon", "energy"]
Unit = Literal["nm", "um", "angstrom", "1/cm"]
Negatives = Literal["refuse", "zero"]

LARGEST = 1e30
"""The largest number of a curve; USGS libraries mark deleted points by -1.23e34."""
SENSITIVE_NM = (400.0, 1050.0)
"""Wavelengths to which silicon is sensitive, and at which curves are judged. [nm]"""


@dataclass(frozen=True, kw_only=True)
class Answers:
    """Metadata that the user supplies for a file; None uses that of the file.

    Attributes
    ----------
    quantity
        The quantity of the curves.
    scale
        Whether values are fractions (1 is the whole) or percent (100 is the whole).
    level
        Whether the values are absolute or only relative.
    per
        Whether light was counted in photons or in energy.
    wavelength_unit
        The unit of the wavelengths.
    beyond
        How to extrapolate a curve that ends before the others of the file or before the grid.
    columns
        The curves to read; if empty, all.
    peak_qe
        The highest quantum efficiency, for relative curves of a sensor. [e-/photon]
    negatives
        Whether small negative values, which digitizing or dark readings can cause, are set to 0.
    """

    quantity: Quantity | None = None
    scale: Scale | None = None
    level: Level | None = None
    per: Per | None = None
    wavelength_unit: Unit | None = None
    beyond: Beyond = "refuse"
    columns: tuple[str, ...] = ()
    peak_qe: float | None = None
    negatives: Negatives = "refuse"

    def __post_init__(self) -> None:
        kinds = (("quantity", Quantity), ("scale", Scale), ("level", Level), ("per", Per))
        more = (("wavelength_unit", Unit), ("beyond", Beyond), ("negatives", Negatives))
        for name, kind in (*kinds, *more):
            given = getattr(self, name)
            if given is not None:
                check.one_of(name, given, get_args(kind))
        if self.peak_qe is not None:
            check.positive("peak_qe", "e-/photon", self.peak_qe)
            check.fraction("peak_qe", "e-/photon", self.peak_qe)


ASK = Answers()
"""No answers: missing metadata becomes a question."""


@dataclass(frozen=True)
class Question:
    """Missing metadata, which neither the file nor its user has given.

    Attributes
    ----------
    about
        The field of `Answers` that is missing.
    asks
        The text of the question.
    settings
        The fields of `Answers` that answer it; one of them is enough.
    """

    about: str
    asks: str
    settings: tuple[Setting, ...]


class Row(NamedTuple):
    """The cells of one row, and its line in the file."""

    number: int
    cells: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class Column:
    """One curve as stored in the file, in the units and order of the file.

    Attributes
    ----------
    name
        The name, without unit.
    unit
        The unit after the name; empty if there is none.
    wavelength
        The wavelengths of the samples, in any order, in the unit of the file.
    values
        The values at these wavelengths.
    """

    name: str
    unit: str = ""
    wavelength: Float[Array, " m"]
    values: Float[Array, " m"]

    def __post_init__(self) -> None:
        check.same_length("points", wavelength=self.wavelength.size, values=self.values.size)
        check.freeze(self, "wavelength", "values")


def known_columns(
    wavelength: Float[Array, " m"],
    curves: Iterable[tuple[str, Float[Array, " m"]]],
    units: Mapping[str, str] = MappingProxyType({}),
) -> tuple[Column, ...]:
    """One column per curve, at those wavelengths at which it has a finite number.

    Units are by name; empty where none is given.
    """
    return tuple(
        Column(
            name=name,
            unit=units.get(name, ""),
            wavelength=wavelength[known],
            values=values[known],
        )
        for name, values in curves
        for known in (np.isfinite(values),)
    )


def missing_notes(
    wavelength: Float[Array, " m"], curves: Iterable[tuple[str, Float[Array, " m"]]], what: str
) -> tuple[str, ...]:
    """A sentence per curve that lacks values at some wavelengths, which are in the file's unit."""
    notes = []
    for name, values in curves:
        lost = wavelength[~np.isfinite(values)]
        if lost.size:
            span = f"{lost.min():g}" if lost.size == 1 else f"{lost.min():g}-{lost.max():g}"
            notes.append(
                f"{name}: {lost.size} {what} at {span}; straight lines join their neighbors"
            )
    return tuple(notes)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Described:
    """What a file is, as its reader found it and as its curves are interpreted.

    Attributes
    ----------
    format
        The kind of file.
    delimiter, decimal
        The cell delimiter and the decimal mark of a text; empty if not applicable.
    quantity, level, per
        The quantity of the curves, whether they are absolute or relative, and whether light was
        counted in photons or energy; None if unknown.
    notes, defects
        How the file was processed, and the defects that were detected.
    said_source, said_notes
        The source of the curves and the notes on them, as the file declares them.
    """

    format: str
    delimiter: str = ""
    decimal: str = ""
    quantity: Quantity | None = None
    level: Level | None = None
    per: Per | None = None
    notes: tuple[str, ...] = ()
    defects: tuple[str, ...] = ()
    said_source: str = ""
    said_notes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True, eq=False)
class Found(_Described):
    """The content of a file, before units and quantities are interpreted.

    Attributes
    ----------
    source
        The name of the file in messages.
    heading
        The heading of the column of wavelengths.
    words
        Titles and comments: free text, which has no effect.
    keys
        Declarations of the file, with the names of `declared_keys`.
    wavelength_unit, scale
        What the format itself implies, as also quantity, level and per.
    named
        Whether the file names its curves.
    """

    source: str
    columns: tuple[Column, ...]
    heading: str = ""
    words: str = ""
    keys: Mapping[str, str] = field(default_factory=dict)
    wavelength_unit: Unit | None = None
    scale: Scaled | None = None
    named: bool = True


@dataclass(frozen=True, kw_only=True, eq=False)
class ParsedSpectra(_Described):
    """Curves with their metadata, notes on processing, and open questions.

    Attributes
    ----------
    curves
        The curves on common increasing wavelengths, multiplied by ``factor``.
    wavelength_unit
        The unit of the wavelengths in the file.
    scale, factor
        ``fraction``, ``percent`` or ``as written``, and the factor applied to the numbers.
    step_nm
        Distance between neighboring wavelengths; None if it varies. [nm]
    gaps_nm
        Start and end of each gap that is much wider than the usual step. [nm]
    merged
        The number of points that were merged with others at the same wavelength.
    deviations
        Standard deviations, if the file has columns of them.
    own_form
        Whether the heading is ``wavelength_nm``, as in the documented table of a sensor's QE.
    units
        The unit of each curve in its heading; empty where it has none.
    """

    curves: Spectra
    wavelength_unit: Unit
    scale: Scaled
    factor: float = 1.0
    step_nm: float | None = None
    gaps_nm: tuple[tuple[float, float], ...] = ()
    merged: int = 0
    deviations: Spectra | None = None
    questions: tuple[Question, ...] = ()
    own_form: bool = False
    units: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not np.isfinite(self.factor) or self.factor <= 0:
            raise refused("factor", "must be finite and > 0", self.factor)
        if self.deviations is not None:
            check.same_length(
                "wavelengths",
                curves=self.curves.wavelength_nm.size,
                deviations=self.deviations.wavelength_nm.size,
            )


_WIDE, _WIDE_NM = 2.5, 5.0
_MOST_VALUES = 4_000_000


@dataclass(frozen=True, kw_only=True, eq=False)
class Sorted:
    """One curve at increasing wavelengths.

    Attributes
    ----------
    name
        The name of the curve.
    wavelength_nm
        Increasing wavelengths. [nm]
    values
        The values, in the unit of the file.
    unsorted
        Whether the rows of the file are not in increasing order.
    merged
        The number of points that were merged with others at the same wavelength.
    conflicts_nm
        Wavelengths at which merged points have different values. [nm]
    """

    name: str
    wavelength_nm: Float[Array, " m"]
    values: Float[Array, " m"]
    unsorted: bool
    merged: int
    conflicts_nm: tuple[float, ...]

    def __post_init__(self) -> None:
        check.same_length("points", at=self.wavelength_nm.size, values=self.values.size)
        check.freeze(self, "wavelength_nm", "values")


def in_nm(wavelength: Float[Array, " m"], unit: Unit) -> Float[Array, " m"]:
    """Convert wavelengths in a unit, or wavenumbers in 1/cm, without sorting. [nm]

    Examples
    --------
    >>> in_nm(np.array([0.4]), "um"), in_nm(np.array([5500.0]), "angstrom")
    (array([400.]), array([550.]))
    >>> in_nm(np.array([20000.0]), "1/cm")
    array([500.])
    """
    if unit == "nm":
        return wavelength
    if unit == "1/cm":
        return np.round(1e7 / wavelength, 9)
    # 0.4 * 1000 is not always 400
    return np.round(wavelength * 1000 if unit == "um" else wavelength / 10, 9)


def sorted_points(column: Column, unit: Unit, source: str) -> Sorted:
    """Sort a curve by wavelength, and merge repeated wavelengths to their mean.

    Raises
    ------
    InputError
        If fewer than two wavelengths remain.

    Examples
    --------
    >>> column = Column(name="R", unit="", wavelength=np.array([0.5, 0.4, 0.5]),
    ...                 values=np.array([3.0, 1.0, 5.0]))
    >>> sorted_points(column, "um", "a file").values
    array([1., 4.])
    """
    at = in_nm(column.wavelength, unit)
    steps = np.diff(at)
    if steps.size and steps.min() > 0:  # most columns
        return Sorted(
            name=column.name,
            wavelength_nm=at,
            values=column.values,
            unsorted=False,
            merged=0,
            conflicts_nm=(),
        )
    order = np.argsort(at, kind="stable")
    rising, values = at[order], column.values[order]
    distinct, first, count = np.unique(rising, return_index=True, return_counts=True)
    if distinct.size < 2:
        where = f"curve {column.name!r}"
        raise has(source, "must have at least 2 wavelengths", distinct.size, where=where)
    spread = np.maximum.reduceat(values, first) - np.minimum.reduceat(values, first)
    means = np.where(spread > 0, np.add.reduceat(values, first) / count, values[first])
    return Sorted(
        name=column.name,
        wavelength_nm=distinct,
        values=means,
        unsorted=bool((steps < 0).any() and not (steps < 0).all()),
        merged=int(at.size - distinct.size),
        conflicts_nm=tuple(float(w) for w in distinct[spread > 0]),
    )


def on_common(
    points: list[Sorted], beyond: Beyond, source: str
) -> tuple[tuple[Float[Array, " m"], Float[Array, "m k"]], tuple[str, ...]]:
    """Interpolate all curves linearly to the union of their wavelengths.

    A curve that ends before the others is extrapolated by ``zero`` or ``hold``; with ``refuse``,
    all curves are cut to their common range.
    """
    at = points[0].wavelength_nm
    same = all(np.array_equal(p.wavelength_nm, at) for p in points[1:])
    if not same:
        at = np.unique(np.concatenate([p.wavelength_nm for p in points]))
    if at.size * len(points) > _MOST_VALUES:
        need = f"must have at most {_MOST_VALUES} values"
        found = f"has {len(points)} curves at {at.size} wavelengths"
        raise refused(source, need, at.size * len(points), found)
    if same:
        return (at, np.stack([p.values for p in points], axis=1)), ()
    starts = [float(p.wavelength_nm[0]) for p in points]
    ends = [float(p.wavelength_nm[-1]) for p in points]
    low, high = max(starts), min(ends)
    notes: tuple[str, ...] = ()
    if min(starts) < low or high < max(ends):
        shared = f"the curves share {low:g}-{high:g} nm of {min(starts):g}-{max(ends):g} nm"
        if beyond == "refuse":
            at = at[(at >= low) & (at <= high)]
            notes = (f"{shared}: cut to what they share (beyond zero or hold keeps the rest)",)
        else:
            notes = (f"{shared}: {beyond} beyond each curve's own end",)
    if at.size < 2:
        need = "curves must share at least 2 wavelengths"
        found = f"share {at.size}"
        raise refused(source, need, at.size, found, remedy=Setting("beyond", ("zero", "hold")))
    side = 0.0 if beyond == "zero" else None
    values = [np.interp(at, p.wavelength_nm, p.values, left=side, right=side) for p in points]
    return (at, np.stack(values, axis=1)), notes


def step_nm(wavelength_nm: Float[Array, " m"]) -> float | None:
    """The distance between neighbors; None if it varies by more than 0.1 %. [nm]

    Examples
    --------
    >>> step_nm(np.array([400.0, 405.0, 410.0])), step_nm(np.array([400.0, 405.0, 420.0]))
    (5.0, None)
    """
    steps = np.diff(wavelength_nm)
    if steps.max() == steps.min():  # most tables
        return float(steps[0])
    middle = float(np.median(steps))
    return middle if np.abs(steps - middle).max() <= 1e-3 * middle else None


def gaps_nm(wavelength_nm: Float[Array, " m"]) -> tuple[tuple[float, float], ...]:
    """Start and end of steps wider than 2.5 times the usual step and wider than 5 nm. [nm]

    Examples
    --------
    >>> gaps_nm(np.array([400.0, 410.0, 420.0, 430.0, 500.0]))
    ((430.0, 500.0),)
    """
    steps = np.diff(wavelength_nm)
    if not steps.size or steps.max() <= _WIDE * steps.min():  # most tables
        return ()
    wide = np.flatnonzero(steps > max(_WIDE * float(np.median(steps)), _WIDE_NM))
    return tuple((float(wavelength_nm[i]), float(wavelength_nm[i + 1])) for i in wide)


SCHEMA_VERSION = 1
"""The version of every schema; a file of another version is not read."""

SPECTRA_SCHEMA = "chromanoise spectra"
UNIT_OF_COLUMN = {"1": "", "e-/photon": ""}
"""Units that the quantity implies; in a heading, e-/photon would also declare absolute values."""


def named(error: InputError, source: str) -> InputError:
    """The error about a value, with the file that contains the value as its subject."""
    return error if source in error.subject else error.within(source)


def held_json(text: str, schema: str, *, source: str) -> dict[str, Any]:
    """The data in a text of one of our own schemas.

    Parameters
    ----------
    schema
        The schema, e.g. ``chromanoise sensor``.
    source
        The origin of the text; used in errors.

    Raises
    ------
    InputError
        As `json_of`, or if it has another schema or version.
    """
    held = json_of(text, source)
    found = held.get("schema") if isinstance(held, dict) else None
    if found != schema or not isinstance(held, dict):
        raise refused(source, f"must be {schema!r}", found, where="key 'schema'")
    _refuse_other_version(held, source)
    return held


def own_spectra(held: Mapping[str, Any], source: str) -> Found:
    """The curves in JSON of the schema ``chromanoise spectra``, as `convert` writes it.

    Raises
    ------
    InputError
        If the version differs, or a value is missing or invalid.
    """
    _refuse_other_version(held, source)
    with own_json(source, "spectra"):
        wavelength = check.finite("wavelength_nm", "nm", array_of(held["wavelength_nm"], 1))
        values = array_of(held["values"], 2)
        names = words_of(held["names"])
        quantity, unit = word_of(held["quantity"]), word_of(held["unit"])
        said_source, said_notes = word_of(held["source"]), words_of(held["notes"])
    if values.shape != (wavelength.size, len(names)):
        need = f"must be {wavelength.size} rows (wavelengths) of {len(names)} numbers (names)"
        found = f"is {values.shape[0]} of {values.shape[1]}"
        raise refused(source, need, values.shape, found, where="key 'values'")
    if not (np.abs(values) <= LARGEST).all():
        need = "must be finite and at most 1e30"
        where = "key 'values'"
        raise refused(source, need, float(np.abs(values).max()), where=where, remedy="correct them")
    ratio = quantity in ("QE", "reflectance", "transmittance")
    texts = {key: value for key, value in held.items() if isinstance(value, str)}
    facts = {"scale": "fraction" if ratio else "as written", **texts}
    return Found(
        source=source,
        format="chromanoise's own JSON, spectra",
        columns=tuple(
            Column(
                name=name,
                unit=UNIT_OF_COLUMN.get(unit, unit),
                wavelength=wavelength,
                values=values[:, k],
            )
            for k, name in enumerate(names)
        ),
        heading="wavelength_nm",  # the heading of the CSV of the same curves
        wavelength_unit="nm",
        said_source=said_source,
        said_notes=said_notes,
        **declared(facts, said_notes),
    )


def declared(facts: Mapping[str, str], notes: tuple[str, ...] = ()) -> dict[str, Any]:
    """Quantity, level, per and scale of a file of this library, as fields of `Found`.

    Unknown words are ignored. Files of earlier versions have level and per in their notes.

    Examples
    --------
    >>> declared({"quantity": "QE", "level": "absolute", "scale": "fraction"})
    {'quantity': 'QE', 'level': 'absolute', 'scale': 'fraction'}
    >>> declared({"quantity": "spectra"}, ("light counted per photon",))
    {'per': 'photon'}
    """
    noted = {
        key: note.removeprefix(before)
        for note in notes
        for key, before in (("level", "level: "), ("per", "light counted per "))
        if note.startswith(before)
    }
    kinds = {"quantity": Quantity, "level": Level, "per": Per, "scale": Scaled}
    found = {**noted, **facts}
    return {key: found[key] for key, kind in kinds.items() if found.get(key) in get_args(kind)}


@contextmanager
def own_json(source: str, what: str) -> Iterator[None]:
    """Exceptions for a value in JSON of one of our schemas become errors about the file."""
    try:
        yield
    except InputError as error:
        raise named(error, source) from None
    except (KeyError, TypeError, OverflowError) as error:
        fault = f"{error.args[0]!r} is missing" if isinstance(error, KeyError) else str(error)
        fault = " ".join(fault.split())[:200]
        need = f"is not the JSON of a {what} as chromanoise writes it ({fault})"
        raise refused(source, need) from None


def word_of(value: Any) -> str:
    """A text in JSON; a TypeError for anything else."""
    if not isinstance(value, str):
        raise TypeError(f"{str(value)[:40]} is not text")
    return value


def words_of(values: Any) -> tuple[str, ...]:
    """A list of texts in JSON; a TypeError for anything else."""
    if not isinstance(values, list):
        raise TypeError(f"{str(values)[:40]} is not a list of text")
    return tuple(word_of(value) for value in values)


def number_of(value: Any) -> float:
    """A number in JSON; a TypeError for anything else."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"{str(value)[:40]} is not a number")
    return float(value)


def array_of(values: Any, depth: int) -> Array:
    """Numbers in ``depth`` lists, the inner ones equally long; a TypeError for anything else."""
    if not isinstance(values, list):
        raise TypeError(f"{str(values)[:40]} is not a list of numbers")
    if depth == 1:
        return np.array([number_of(value) for value in values], dtype=np.float64)
    arrays = [array_of(row, depth - 1) for row in values]
    if not arrays or len({array.size for array in arrays}) > 1:
        raise TypeError("rows of numbers are not equally long")
    return np.stack(arrays)


def _refuse_other_version(held: Mapping[str, Any], source: str) -> None:
    if held.get("schema_version") != SCHEMA_VERSION:
        need = f"must be {SCHEMA_VERSION}"
        where = "key 'schema_version'"
        remedy = "read it with the version that wrote it"
        raise refused(source, need, held.get("schema_version"), where=where, remedy=remedy)
