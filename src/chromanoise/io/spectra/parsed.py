"""What a file of spectra says, what its user adds, and what was understood of both."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import (
    Float,
)
from chromanoise.errors import (
    InputError,
    Setting,
)
from chromanoise.spectra.curves import Beyond, Spectra

Quantity = Literal["QE", "response", "reflectance", "transmittance", "power"]
Scale = Literal["fraction", "percent"]
Scaled = Literal["fraction", "percent", "as written"]
Level = Literal["absolute", "relative"]
Per = Literal["photon", "energy"]
Unit = Literal["nm", "um", "angstrom", "1/cm"]
Negatives = Literal["refuse", "zero"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Answers:
    """What the user says about a file; None leaves it to the file.

    Attributes
    ----------
    quantity
        What the curves are.
    scale
        Whether 1 or 100 is the whole.
    level
        Whether the height of the curves means something.
    per
        Whether light was counted in photons or in energy.
    wavelength_unit
        The unit of the wavelengths.
    beyond
        What a curve is where others of the file go on.
    columns
        The curves that are wanted; none: all.
    peak_qe
        Of relative curves of a sensor: the highest quantum efficiency. [e-/photon]
    negatives
        Whether small negative values, as digitizing or a dark reading leaves them, are set to 0.
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
"""No answer: what the file does not say becomes a question."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Question:
    """Something that neither the file nor its user has said.

    Attributes
    ----------
    about
        The field of `Answers` that it is about.
    asks
        The question.
    settings
        Fields of `Answers` that answer it: one of them is enough.
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
    """One curve as it stands in the file, in the file's own units and order.

    Attributes
    ----------
    name
        Its name, without unit.
    unit
        The unit beside the name; empty where there is none.
    wavelength
        Where it is given, in any order, in the file's unit.
    values
        What it is there.
    """

    name: str
    unit: str
    wavelength: Float[Array, " m"]
    values: Float[Array, " m"]

    def __post_init__(self) -> None:
        _check.same_length("points", wavelength=self.wavelength.size, values=self.values.size)
        _check.freeze(self, "wavelength", "values")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """What a reader found in a file, before it is given a meaning.

    Attributes
    ----------
    source
        The file, as messages name it.
    format
        The kind of file.
    columns
        The curves.
    heading
        What stands over the column of wavelengths.
    words
        Titles and comments: free text, which has no effect.
    keys
        Declarations of the file, with the names of `declared_keys`.
    delimiter, decimal
        How a text parts cells and fractions; empty where that does not apply.
    quantity, level, per, wavelength_unit, scale
        What the format itself says.
    named
        Whether the file names its curves.
    notes, defects
        What the reader did, and what it stumbled over.
    said_source, said_notes
        Where the file says that its curves come from, and the notes that it keeps of them.
    """

    source: str
    format: str
    columns: tuple[Column, ...]
    heading: str = ""
    words: str = ""
    keys: Mapping[str, str] = field(default_factory=dict)
    delimiter: str = ""
    decimal: str = ""
    quantity: Quantity | None = None
    level: Level | None = None
    per: Per | None = None
    wavelength_unit: Unit | None = None
    scale: Scaled | None = None
    named: bool = True
    notes: tuple[str, ...] = ()
    defects: tuple[str, ...] = ()
    said_source: str = ""
    said_notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ParsedSpectra:
    """Curves, and all that is known, was done and remains open about them.

    Attributes
    ----------
    curves
        On one list of increasing wavelengths, the factor of ``scale`` applied.
    format, delimiter, decimal
        The kind of file; how its text parts cells and fractions.
    wavelength_unit
        In which the file gives wavelengths.
    scale, factor
        ``fraction``, ``percent`` or ``as written``, and by what the numbers were multiplied.
    step_nm
        Distance of neighbors; None where it varies. [nm]
    gaps_nm
        From and to of each stretch that is much wider than the steps. [nm]
    merged
        Points that stood at a wavelength of their curve more than once and became one.
    quantity, level, per
        What the curves are, whether their height means something, whether light was counted in
        photons or energy; None where unknown.
    deviations
        Standard deviations, where the file gives them beside the curves.
    notes, defects, questions
        What was done, what the numbers show to be wrong or odd, what remains to be answered.
    own_form
        Whether it is headed ``wavelength_nm``, as the documented table of a sensor's QE.
    said_source, said_notes
        As `Found`.
    """

    curves: Spectra
    format: str
    delimiter: str
    decimal: str
    wavelength_unit: Unit
    scale: Scaled
    factor: float
    step_nm: float | None
    gaps_nm: tuple[tuple[float, float], ...]
    merged: int
    quantity: Quantity | None
    level: Level | None
    per: Per | None
    deviations: Spectra | None
    notes: tuple[str, ...]
    defects: tuple[str, ...]
    questions: tuple[Question, ...]
    own_form: bool = False
    said_source: str = ""
    said_notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not np.isfinite(self.factor) or self.factor <= 0:
            raise InputError("factor", "must be finite and > 0", value=self.factor)
        if self.deviations is not None:
            _check.same_length(
                "wavelengths",
                curves=self.curves.wavelength_nm.size,
                deviations=self.deviations.wavelength_nm.size,
            )
