"""Data classes: what a reader found in a file, the answers of the user, the parsed spectra."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError, Setting
from chromanoise.spectra.curves import Beyond, Spectra

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


@dataclass(frozen=True, slots=True, kw_only=True)
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
                _check.one_of(name, given, get_args(kind))
        if self.peak_qe is not None:
            _check.positive("peak_qe", "e-/photon", self.peak_qe)
            _check.fraction("peak_qe", "e-/photon", self.peak_qe)


ASK = Answers()
"""No answers: missing metadata becomes a question."""


@dataclass(frozen=True, slots=True, kw_only=True)
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """The cells of one row, and its line in the file."""

    number: int
    cells: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
        _check.same_length("points", wavelength=self.wavelength.size, values=self.values.size)
        _check.freeze(self, "wavelength", "values")


def known_columns(
    wavelength: Float[Array, " m"], curves: Iterable[tuple[str, Float[Array, " m"]]]
) -> tuple[Column, ...]:
    """One column per curve, at those wavelengths at which it has a finite number."""
    return tuple(
        Column(name=name, wavelength=wavelength[known], values=values[known])
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


def has(source: str, requirement: str, found: object, **more: Any) -> InputError:
    """The error about a count or name that a file has, which is both value and description."""
    return InputError(source, requirement, value=found, found=f"has {found}", **more)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found(_Described):
    """The content of a file, before units and quantities are interpreted.

    Attributes
    ----------
    source
        The name of the file in messages.
    columns
        The curves.
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
    questions
        Missing metadata.
    own_form
        Whether the heading is ``wavelength_nm``, as in the documented table of a sensor's QE.
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

    def __post_init__(self) -> None:
        if not np.isfinite(self.factor) or self.factor <= 0:
            raise InputError("factor", "must be finite and > 0", value=self.factor)
        if self.deviations is not None:
            _check.same_length(
                "wavelengths",
                curves=self.curves.wavelength_nm.size,
                deviations=self.deviations.wavelength_nm.size,
            )
