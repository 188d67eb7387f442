"""The schema of ``front.json``: objectives, scenes, references and members of a front."""

from collections import Counter
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    PlainSerializer,
    ValidationError,
    model_validator,
)

from chromanoise import __version__
from chromanoise._inputs import regular_file
from chromanoise.analysis.color_matrices import matrix_makers
from chromanoise.errors import InputError
from chromanoise.io.spectra.own_json import SCHEMA_VERSION, as_json, held_json
from chromanoise.io.spectra.writing import QE_FACTS, spectra_csv
from chromanoise.sensor import Pixel
from chromanoise.spectra import Spectra
from chromanoise.study.document import ExposurePart, LightPart, PixelPart

FRONT_SCHEMA: Final = "chromanoise front"
"""The value of the key ``schema``."""
_LARGEST_BYTES = 12_000_000
_LONGEST_KEY = 80
_WORDS = {"extra_forbidden": "is an unknown key", "missing": "is missing"}


def _matrix(name: str) -> str:
    matrix_makers([name], "quanta")  # checks name and parameter
    return name


def _with_effect(pixel: PixelPart) -> PixelPart:
    """Without the values that a pixel has by default, some of which a study refuses as idle."""
    given = pixel.model_dump(exclude_none=True)
    usual = {one.name: one.default for one in fields(Pixel)}
    return PixelPart(**{key: value for key, value in given.items() if value != usual.get(key)})


ObjectiveValue = Annotated[float, Field(allow_inf_nan=False)] | None
"""The value of an objective; ``None`` where it is undefined or infinite."""
Share = Annotated[float, Field(ge=0, le=1)]
MatrixName = Annotated[str, AfterValidator(_matrix)] | None
WithoutDefaults = PlainSerializer(
    lambda part: part and part.model_dump(mode="json", exclude_defaults=True)
)
"""Writes only the keys of a table that differ from their defaults."""


class _Record(BaseModel):
    """Immutable; unknown keys are ignored, so that later versions can add some."""

    model_config = ConfigDict(frozen=True, strict=True, defer_build=True)


class FrontObjective(_Record):
    """One objective of the search."""

    name: str = Field(description="Name, e.g. snr_y_db.")
    what: str = Field(description="What it is, in words.")
    unit: str = Field(description="Its unit; 1 if it has none.")
    better: Literal["higher", "lower"] = Field(description="Which values are better.")


class FrontScene(_Record):
    """An operating point of the search, with the tables of a study."""

    name: str = Field(description="Name.")
    light: Annotated[LightPart, WithoutDefaults] = Field(
        LightPart(), description="The table light of a study."
    )
    exposure: Annotated[ExposurePart, WithoutDefaults] = Field(
        ExposurePart(), description="The table exposure of a study."
    )
    matrix: MatrixName = Field(None, description="The color matrix, as a study names it.")


class FrontReference(_Record):
    """A sensor with which the members are compared."""

    name: str = Field(description="Name.")
    objectives: dict[str, ObjectiveValue] = Field(description="Value of each objective.")


class FrontCurves(_Record):
    """Quantum efficiency of a member, with filters, IR-cut and crosstalk."""

    wavelength_nm: list[float] = Field(description="Wavelengths [nm].")
    names: list[str] = Field(description="Names of the channels.")
    qe: list[list[Share]] = Field(description="One row per wavelength [e-/photon].")


class FrontMember(FrontReference):
    """A sensor of the front."""

    sensor: str = Field(description="Its file, relative to front.json.")
    extreme_of: list[str] = Field([], description="Objectives in which no member is better.")
    knee: bool = Field(False, description="Whether it is the knee of the front.")
    held_by: list[str] = Field([], description="Active constraints and bounds.")
    nominal: dict[str, ObjectiveValue] = Field(
        {}, description="Its objectives without tolerances, if the search took them over these."
    )
    robust: dict[str, ObjectiveValue] = Field(
        {}, description="Its worst objectives over the tolerances, if the search did not take them."
    )
    nominal_extreme_of: list[str] = Field(
        [], description="Objectives in which no member is better without tolerances."
    )
    robust_extreme_of: list[str] = Field(
        [], description="Objectives in which no member is better over the tolerances."
    )
    values: dict[str, float] = Field({}, description="Its free parameters.")
    curves: FrontCurves = Field(description="Its quantum efficiency.")
    pixel: Annotated[PixelPart, AfterValidator(_with_effect), WithoutDefaults] = Field(
        PixelPart(), description="The table pixel of a study."
    )
    exposure: Annotated[ExposurePart | None, WithoutDefaults] = Field(
        None, description="Its own exposure, if the time is a free parameter."
    )
    matrix: MatrixName = Field(
        None, description="Its own color matrix, if the weight of the noise is a free parameter."
    )
    analyze: str = Field(
        "", description="Command for the folder of front.json that gives the same SNR of Y."
    )


class FrontMilestone(_Record):
    """The front after a number of evaluations."""

    evaluations: int = Field(description="Evaluated candidates.")
    hypervolume: Annotated[float, Field(ge=0, le=1)] | None = Field(
        description="Share that the front dominates of the box between the best values of the "
        "final front and the reference point; none for one objective."
    )
    best: dict[str, ObjectiveValue] = Field(description="Best value of each objective.")


class FrontSeed(_Record):
    """One of the independent populations of the search."""

    seed: int = Field(description="Its seed.")
    best: dict[str, ObjectiveValue] = Field(description="Its best value of each objective.")


class FrontConvergence(_Record):
    """How far the search has converged."""

    converged: bool | None = Field(
        description="Whether the seeds agree within 0.05 dB or 1 % and the hypervolume rose by at "
        "most 2 % in the second half of the evaluations; none for one seed."
    )
    evaluations: int = Field(description="Evaluated candidates.")
    gradients: int = Field(description="Computed gradients.")
    undefined: int = Field(
        description="Evaluated candidates with an undefined objective, which count as infeasible."
    )
    seeds: list[FrontSeed] = Field(description="The populations.")
    spread: dict[str, ObjectiveValue] = Field(
        description="Difference of the best values of the seeds: in dB, otherwise relative to the "
        "best."
    )
    gain: dict[str, ObjectiveValue] = Field(
        description="Improvement of the best value of each objective by the final polish, in its "
        "unit."
    )
    reference: dict[str, ObjectiveValue] = Field(
        description="The reference point of the hypervolume."
    )
    milestones: list[FrontMilestone] = Field(description="The front over the evaluations.")


class FrontFile(_Record):
    """The content of ``front.json``."""

    schema_name: Literal["chromanoise front"] = Field(
        FRONT_SCHEMA, alias="schema", description="Kind of the file."
    )
    schema_version: int = Field(SCHEMA_VERSION, description="Version of this schema.")
    version: str = Field(__version__, description="Version of chromanoise that wrote the file.")
    objectives: list[FrontObjective] = Field(min_length=1, description="The objectives.")
    scenes: list[FrontScene] = Field([], description="The operating points of the search.")
    references: list[FrontReference] = Field(
        [], description="The sensors of the design file, for comparison."
    )
    members: list[FrontMember] = Field(min_length=1, description="The sensors of the front.")
    convergence: FrontConvergence | None = Field(
        None, description="How far the search has converged."
    )
    sentences: list[str] = Field([], description="One sentence per extreme and for the knee.")

    @model_validator(mode="after")
    def _consistent(self) -> "FrontFile":
        names = [one.name for one in self.objectives]
        _refuse_repeated("objectives", names)
        _refuse_repeated("members", [one.name for one in (*self.references, *self.members)])
        for one in (*self.references, *self.members):
            if set(one.objectives) != set(names):
                raise InputError(
                    one.name,
                    f"must have a value for each of {', '.join(names)}",
                    value=tuple(one.objectives),
                    found=f"has {', '.join(one.objectives) or 'none'}",
                )
        return self

    def as_json(self) -> str:
        """The text of ``front.json``."""
        return as_json(self.model_dump(mode="json", by_alias=True))


def read_front(path: Path | str) -> FrontFile:
    """The front in a file ``front.json``.

    Parameters
    ----------
    path
        The file.

    Raises
    ------
    InputError
        If the file cannot be read, or is no front.
    """
    path = Path(path)
    regular_file(path)
    try:
        with path.open("rb") as file:
            content = file.read(_LARGEST_BYTES + 1)
        text = content.decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(str(path), "is not a UTF-8 text file") from None
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror})") from None
    if len(content) > _LARGEST_BYTES:
        limit = f"must have at most {_LARGEST_BYTES / 1e6:g} MB, as a front"
        raise InputError(str(path), limit, found="has more")
    return front_from_text(text, source=str(path))


def front_from_text(text: str, *, source: str) -> FrontFile:
    """The front in the text of ``front.json``.

    Parameters
    ----------
    text
        The whole file.
    source
        The name of the file, for errors.

    Raises
    ------
    InputError
        If it is not JSON, or has another schema or version; or the first wrong value, with its key.
    """
    held_json(text, FRONT_SCHEMA, source=source)
    try:
        return FrontFile.model_validate_json(text)
    except ValidationError as error:
        raise _first_fault(error.errors(include_url=False)[0], source) from None


def member_csv(member: FrontMember) -> str:
    """The curves of a member, as `read_sensor_csv` reads them.

    Parameters
    ----------
    member
        A member of the front.

    Raises
    ------
    InputError
        If the curves are invalid.
    """
    curves = member.curves
    shape = (len(curves.wavelength_nm), len(curves.names))
    if any(len(row) != shape[1] for row in curves.qe) or len(curves.qe) != shape[0]:
        raise InputError(
            f"curves of {member.name}",
            f"must be {shape[0]} rows (wavelengths) of {shape[1]} numbers (names)",
            found=f"has {len(curves.qe)} rows of {len(curves.qe[0]) if curves.qe else 0}",
        )
    spectra = Spectra(
        wavelength_nm=np.array(curves.wavelength_nm, dtype=float),
        values=np.array(curves.qe, dtype=float).reshape(shape),
        names=tuple(curves.names),
        quantity="QE",
        unit="e-/photon",
        source=member.name,
    )
    return spectra_csv(spectra, QE_FACTS)


def _refuse_repeated(subject: str, names: list[str]) -> None:
    repeated = [name for name, count in Counter(names).items() if count > 1]
    if repeated:
        raise InputError(subject, "must have different names", value=repeated[0])


def _first_fault(fault: Any, source: str) -> InputError:
    place = ".".join(str(step)[:_LONGEST_KEY] for step in fault["loc"])
    raised = fault.get("ctx", {}).get("error")
    if isinstance(raised, InputError):
        own = place.endswith(raised.subject)  # of one value, not of several
        return raised.within(source, place if own else f"{place} {raised.subject}".strip())
    given = fault.get("input")
    shown = given if isinstance(given, str | int | float) else None
    said = _WORDS.get(fault["type"]) or str(fault["msg"]).replace("Input should", "must")
    text = f"{said[:1].lower()}{said[1:]}"
    return InputError(source, text, value=shown, where=f"key {place!r}")
