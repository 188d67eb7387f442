"""The schema of ``design.toml``, and the commented design that `chromanoise init --design` writes.

A design has the tables of a study and the table ``design``. The sensors of the study are the
references of the design. The first of them, or the one that ``design.base`` names, gives the grid
and the pixel of all designs.
"""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Annotated, Any, Literal

from chromanoise.apps.design.algorithms import METHODS
from chromanoise.apps.design.evaluation import OverScenes
from chromanoise.apps.design.objectives import OBJECTIVES
from chromanoise.apps.design.parameters import Free, RobustPart, Value, noise_properties
from chromanoise.apps.design.search import DEFAULT_SEARCH, SearchOptions
from chromanoise.apps.design.space import (
    LIBRARY_MODEL,
    MODELS,
    PixelShares,
    Structure,
    model_numbers,
)
from chromanoise.base import (
    After,
    Before,
    Field,
    InputError,
    Setting,
    after,
    check,
    did_you_mean,
    known_name,
    refusal,
    subclass,
)
from chromanoise.sensor import MOSAIC_NAMES, SILICON_NUMBERS, ModelNumber
from chromanoise.study import LightPart, Part, Study

DESIGN_STARTER = f"""\
# A chromanoise design: `chromanoise optimize design.toml -o out/design` searches the sensors
# with the best trade-offs between the objectives. The tables outside of [design] are those of a
# study. File names are relative to the folder of this file.
schema = 1
title = "A sensor for 10 lx"
matrices = ["kernel"]                # or one of least-squares, lmmse, ridge=0.01 ...

[light]
illuminant = "E"                     # A, D65, 3200K, LED660, or a file
level_lux = {LightPart().level_lux}

[exposure]
f_number = 1.8                       # all sensors have one exposure time: the longest at which no
                                     # reference saturates; time_ms = 12 sets another

[[sensors]]                          # the references; the first one gives the pixel
name = "onyx-rgbw"

[[sensors]]
name = "onyx-rgb-ircut"

[design]
objectives = ["snr_y_db", "delta_e"] # SNR of Y and color error; also noise_delta_e,
                                     # ciede2000, vora, snr10_lux, least_separation ...
method = "nsga2"                     # nsga3; de or cma-es for one objective
budget = 30000                       # evaluated sensors
population = 200                     # sensors per generation
seed = 1

# 8 is a fixed number. [20, 80] is free between two bounds. So is
# {{low = 20, high = 80, start = 40, tolerance = 2}}. "R.width_nm" is the number of channel R.
[[design.channels]]
name = "R"
base = "W"                           # the curve of channel W of onyx-rgbw, in place of model
                                     # silicon: the designs and the references share it
filter = "gaussian"                  # resin, fabry-perot, dye ...
center_nm = [560, 680]
width_nm = [15, 80]                  # standard deviation
peak = 0.95

[[design.channels]]
name = "G"
base = "W"
filter = "gaussian"
center_nm = [500, 580]
width_nm = [15, 80]
peak = 0.95

[[design.channels]]
name = "B"
base = "W"
filter = "gaussian"
center_nm = [420, 500]
width_nm = [15, 80]
peak = 0.95

[design.ir_cut]                      # a filter in front of all channels
cutoff_nm = [600, 900]
width_nm = 8

# [[design.scenes]]                  # several scenes: the worst value counts; over_scenes =
                                     # "mean" in [design] takes the mean
# level_lux = 1.0
# illuminant = "A"

[[design.constraints]]               # no larger color error than the better reference
objective = "delta_e"
at_most = "best reference"           # or a number, or the name of a reference; or at_least
"""
"""The commented design file that ``chromanoise init --design`` writes."""


BEST_REFERENCE = "best reference"
"""Limit of a constraint: the best value of all references."""
_FREE_KEYS = ("low", "high", "start", "tolerance")
_FORMS = "must be a number, [low, high], {low = .., high = ..}, or the name of another number"


def _value(given: Any) -> Value:
    """A fixed number, a free one, or a tie, from its form in TOML."""
    if isinstance(given, str | Free):
        return given
    if _is_number(given):
        if not math.isfinite(given):
            raise ValueError("must be finite")
        return float(given)
    if isinstance(given, list | tuple) and len(given) == 2 and all(map(_is_number, given)):
        return Free(low=float(given[0]), high=float(given[1]))
    if isinstance(given, Mapping):
        for name in given:
            if name not in _FREE_KEYS:
                known = f"known are {', '.join(_FREE_KEYS)}"
                remedy = did_you_mean(name, _FREE_KEYS, known)
                raise ValueError(f"has the unknown key {name}; {remedy}")
    if isinstance(given, Mapping) and {"low", "high"} <= set(given):
        numbers = {name: value for name, value in given.items() if value is not None}
        if all(map(_is_number, numbers.values())):
            return Free(**{name: float(value) for name, value in numbers.items()})
    raise ValueError(_FORMS)


def _is_number(given: Any) -> bool:
    return isinstance(given, int | float) and not isinstance(given, bool)


def _number_or_name(given: Any) -> Any:
    """Give one error message; the schema alone would give one for each type of value."""
    if given is None or isinstance(given, str):
        return given
    if not _is_number(given):
        raise ValueError('must be a number, "best reference", or the name of a reference')
    return float(check.finite("limit", "1", given))


def _known(what: str, names: Sequence[str]) -> After:
    """The one of ``names`` that a word is; others are refused, with the nearest as a remedy."""

    def checked(word: str, place: Any) -> str:
        name = known_name(word, names)
        if name not in names:
            remedy = did_you_mean(name, list(names), f"known are {', '.join(names)}", most=2)
            raise InputError(place.name, f"must be a known {what}", value=name, remedy=remedy)
        return name

    return After(checked)


Numbers = Annotated[Any, Before(_value)]
"""A number of a design: fixed, free or tied."""
LimitWord = Annotated[float | str | None, Before(_number_or_name)]
ObjectiveName = Annotated[str, _known("objective", tuple(OBJECTIVES))]


class NumbersPart(Part, unknown=Numbers):
    """A part whose further keys are numbers of a design."""

    @property
    def numbers(self) -> dict[str, Value]:
        """The numbers that are given, by name."""
        return dict(self.further)

    def known_numbers(self) -> Mapping[str, ModelNumber] | None:
        """The numbers that the part may have; ``None`` if the rest of the design decides."""
        return None

    @after
    def _of_the_model(self) -> "NumbersPart":
        known = self.known_numbers()
        if known is not None:
            errors = [*_unknown(self, known), *_missing(self, known)]
            if errors:
                raise refusal(errors)
        return self


def _unknown(part: NumbersPart, known: Mapping[str, ModelNumber]) -> Iterator[InputError]:
    names = [*type(part).model_fields, *known]
    for name in part.numbers:
        if name not in known:
            remedy = did_you_mean(name, names, f"known are {', '.join(names)}", most=2)
            yield InputError(name, "is an unknown key", remedy=remedy)


def _missing(part: NumbersPart, known: Mapping[str, ModelNumber]) -> Iterator[InputError]:
    for name, number in known.items():
        if number.default is None and name not in part.numbers:
            yield InputError(
                name,
                f"is missing: {number.what}{check.in_brackets(number.unit)}",
                remedy=f"give a number, or bounds as {name} = [low, high]",
            )


FilterName = Annotated[str, _known("filter", MODELS)]
_MODELS = ", ".join(MODELS)
_OF_DYE = "For dye: filters of the catalog or files; the search chooses one of several."
Curves = tuple[str, ...]


class _FilterNumbers(NumbersPart):
    """A part whose numbers are those of a filter."""

    @after
    def _curves_of_a_dye(self) -> "_FilterNumbers":
        model, curves = getattr(self, "filter", None), getattr(self, "curves", ())
        if (model == LIBRARY_MODEL) != bool(curves):
            demand = "must be given" if model == LIBRARY_MODEL else "must be given only"
            raise InputError("curves", f"{demand} for filter = {LIBRARY_MODEL!r}")
        return self

    def known_numbers(self) -> Mapping[str, ModelNumber]:
        """The numbers of the filter."""
        model = getattr(self, "filter", None)
        return {} if model is None else model_numbers(model, self.numbers)

    @classmethod
    def known_keys(cls, given: Mapping[str, Any]) -> Collection[str]:
        """The keys of the part, with the numbers of its filter.

        Parameters
        ----------
        given
            Its values by key, not yet checked.
        """
        model = known_name(str(given.get("filter", cls.model_fields["filter"].default)), MODELS)
        numbers = [name.replace("-", "_") for name in given]  # several films or bands
        return [
            *super().known_keys(given),
            *(model_numbers(model, numbers) if model in MODELS else ()),
        ]


class FilterPart(_FilterNumbers):
    """A filter; its further keys are the numbers of its model."""

    filter: FilterName = Field("ir-cut", description=f"Its model: {_MODELS}.")
    curves: Curves = Field((), description=_OF_DYE)


class ChannelPart(_FilterNumbers):
    """A channel; its further keys are the numbers of its filter."""

    name: str = Field(description="Name of the channel.")
    filter: FilterName | None = Field(None, description=f"Its filter: {_MODELS}; default: none.")
    curves: Curves = Field((), description=_OF_DYE)
    base: str | None = Field(
        None, description="Channel of the base whose curve it filters; default: silicon."
    )
    ir_cut: FilterPart | None = Field(None, description="A second filter on this channel.")


class SiliconPart(NumbersPart):
    """The photodiode; its keys are the numbers of its model."""

    @classmethod
    def known_keys(cls, given: Mapping[str, Any]) -> Collection[str]:
        """The numbers of silicon.

        Parameters
        ----------
        given
            Its values by key, not yet checked.
        """
        return SILICON_NUMBERS

    def known_numbers(self) -> Mapping[str, ModelNumber]:
        """The numbers of silicon."""
        return SILICON_NUMBERS


class ExposureNumbers(Part):
    """The exposure, where it is designed."""

    time_ms: Numbers = Field(None, description="Exposure time [ms]; default: that of the scene.")


class MatrixNumbers(Part):
    """The color matrix, where it is designed."""

    noise_weight: Numbers = Field(
        None, description="Weight of the noise in the matrix: 0 least squares, 1 LMMSE."
    )


class CrosstalkNumbers(Part):
    """Crosstalk before counting, where it is not that of the base."""

    share: Numbers = Field(
        None, description="Share of the light of a pixel that ends in its four neighbors."
    )


_NOISE: dict[str, Any] = {
    name: (Numbers, Field(None, description=one.help)) for name, one in noise_properties().items()
}


@lambda part: subclass(part, part.__name__, _NOISE, __doc__=part.__doc__)
class PixelNumbers(Part):
    """The noise of the pixel, where it is not that of the base."""


class ScenePart(Part):
    """A scene; what it omits is that of the study."""

    name: str | None = Field(None, description="Name in results; default: its number.")
    illuminant: str | None = Field(None, description="Its light.")
    level_lux: Annotated[float, Field(gt=0, finite=True)] | None = Field(
        None, description="Its illuminance [lx]."
    )
    time_ms: Annotated[float, Field(gt=0, finite=True)] | None = Field(
        None, description="Its exposure time [ms]; default: that of the study's light."
    )


class ConstraintPart(Part):
    """A limit of an objective."""

    objective: ObjectiveName = Field(description=f"One of {', '.join(OBJECTIVES)}.")
    at_most: LimitWord = Field(None, description="Number, best reference, or name of a reference.")
    at_least: LimitWord = Field(None, description="Number, best reference, or name of a reference.")

    @after
    def _one_limit(self) -> "ConstraintPart":
        if (self.at_most is None) == (self.at_least is None):
            raise InputError(
                "at_most",
                "must be given, or at_least in its place",
                found="both are given" if self.at_most is not None else "none is given",
            )
        return self

    @property
    def side(self) -> Literal["at_most", "at_least"]:
        """Which limit is given."""
        return "at_least" if self.at_most is None else "at_most"

    @property
    def limit(self) -> float | str:
        """The limit as given."""
        given = self.at_least if self.at_most is None else self.at_most
        assert given is not None  # one of both is given
        return given


def _shares(given: Any) -> PixelShares:
    """Give one error message; the schema alone would give one for each type of value."""
    if isinstance(given, list | tuple) and all(map(_is_number, given)):
        return tuple(map(float, given))
    if given in ("equal", "free"):
        return given
    raise ValueError("must be equal, free, or one share per channel with the sum 1")


class DesignPart(Part):
    """Free numbers, objectives and search settings."""

    objectives: Annotated[tuple[ObjectiveName, ...], Field(min_length=1)] = Field(
        description=f"What is optimized: {', '.join(OBJECTIVES)}."
    )
    base: str | None = Field(
        None,
        description="Reference whose grid, pixel and curves the designs use; default: the first.",
    )
    channels: Annotated[tuple[ChannelPart, ...], Field(min_length=1)] = Field(
        description="The channels: name, filter, and the numbers of the filter."
    )
    ir_cut: FilterPart | None = Field(None, description="A filter in front of all channels.")
    silicon: SiliconPart = Field(SiliconPart(), description="The photodiode.")
    structure: Structure = Field(
        "mosaic", description="Pixels side by side, layers in silicon, or a color router."
    )
    layers: NumbersPart = Field(
        NumbersPart(), description="With layers: NAME_um, thickness of the layer of each channel."
    )
    router: NumbersPart = Field(
        NumbersPart(), description="With router: efficiency, NAME_selectivity, crossing_1_nm ..."
    )
    mosaic: str | None = Field(
        None, description=f"Channel of each pixel: {', '.join(MOSAIC_NAMES)}, or rows as RG/GB."
    )
    pixel_shares: Annotated[Any, Before(_shares)] = Field(
        "equal", description="Shares of the pixels: equal, free, or one number per channel."
    )
    crosstalk: CrosstalkNumbers = Field(CrosstalkNumbers(), description="Crosstalk.")
    pixel: PixelNumbers = Field(PixelNumbers(), description="The pixel.")
    exposure: ExposureNumbers = Field(ExposureNumbers(), description="Exposure of the designs.")
    matrix: MatrixNumbers = Field(MatrixNumbers(), description="Color matrix of the designs.")
    scenes: tuple[ScenePart, ...] = Field(
        (), description="Scenes of the objectives; default: that of the study."
    )
    over_scenes: OverScenes = Field(
        "worst", description="Whether the worst or the mean value over the scenes counts."
    )
    constraints: tuple[ConstraintPart, ...] = Field((), description="Limits on objectives.")
    robust: RobustPart | None = Field(
        None, description="Objectives over the tolerances; default: those of the exact parameters."
    )
    method: Annotated[str, _known("method", tuple(METHODS))] = Field(
        DEFAULT_SEARCH.method, description=f"Search: {', '.join(METHODS)}."
    )
    budget: int = Field(DEFAULT_SEARCH.budget, description="Number of evaluated candidates.")
    population: int = Field(DEFAULT_SEARCH.population, description="Candidates per generation.")
    seed: int = Field(DEFAULT_SEARCH.seed, description="Seed of the search.")
    seeds: int = Field(
        DEFAULT_SEARCH.seeds,
        description="Number of independent populations, which share the budget; their agreement "
        "measures the convergence.",
    )
    polish: bool | None = Field(
        DEFAULT_SEARCH.polish,
        description="Improve the front by gradients; default: if all objectives have exact "
        "gradients.",
    )
    members: Annotated[int, Field(ge=1, le=10_000)] = Field(
        100, description="Largest number of sensors of the front, extremes and knee included."
    )

    @after
    def _possible_search(self) -> "DesignPart":
        _ = self.search
        return self

    @property
    def search(self) -> SearchOptions:
        """Method and effort of the search."""
        return SearchOptions(**{one.name: getattr(self, one.name) for one in fields(SearchOptions)})

    @after
    def _different_objectives(self) -> "DesignPart":
        check.distinct("objectives", self.objectives)
        return self

    @after
    def _differentiable(self) -> "DesignPart":
        if self.polish and self.robust is not None:
            raise InputError(
                "polish",
                "must be false with design.robust, whose statistic has no exact gradients",
                value=True,
            )
        return self


_IDLE = ("seed", "sweeps", "pictures", "outputs")


class DesignStudy(Study):
    """A design: the tables of a study, whose sensors are the references, and ``[design]``.

    Raises
    ------
    RecordError
        As `Study`, or if a table has no effect on a design.
    """

    design: DesignPart = Field(description="What is designed.")

    def reference_index(self, word: str) -> int:
        """Index of the sensor that results call by a word, or otherwise of that with this name.

        Parameters
        ----------
        word
            A label or a name of one of the sensors.
        """
        shown = [one.label or one.name for one in self.sensors]
        return (shown if word in shown else [one.name for one in self.sensors]).index(word)

    def filters(self) -> Iterator[tuple[str, FilterPart | ChannelPart]]:
        """Key and part of each filter of the design."""
        for i, channel in enumerate(self.design.channels):
            yield f"design.channels.{i}", channel
            if channel.ir_cut is not None:
                yield f"design.channels.{i}.ir_cut", channel.ir_cut
        if self.design.ir_cut is not None:
            yield "design.ir_cut", self.design.ir_cut

    @after
    def _with_effect(self) -> "DesignStudy":
        errors = [*_idle_tables(self), *_unknown_references(self)]
        if errors:
            raise refusal(errors)
        return self


def _idle_tables(document: DesignStudy) -> Iterator[InputError]:
    for name in _IDLE:
        if name in document.model_fields_set and getattr(document, name):
            yield InputError(
                name,
                "must not be given in a design, where it changes nothing",
                remedy="give design.seed" if name == "seed" else "omit it",
                setting=name,
            )
    if len(document.matrices) > 1:
        yield InputError(
            "matrices",
            "must be one matrix in a design",
            value=", ".join(map(str, document.matrices)),
            setting="matrices",
        )
    if document.exposure.equal != "exposure":
        yield InputError(
            "equal",
            "must be exposure in a design: one time for all designs of a scene",
            value=document.exposure.equal,
            remedy=Setting("exposure.equal", omit=True),
            setting="exposure.equal",
        )


def _unknown_references(document: DesignStudy) -> Iterator[InputError]:
    names = [part.name for part in document.sensors]
    known = [*dict.fromkeys([*names, *(one.label for one in document.sensors if one.label)])]
    design = document.design
    given: list[tuple[str, object]] = [("design.base", design.base)]
    given += [
        (f"design.constraints.{i}.{part.side}", part.limit)
        for i, part in enumerate(design.constraints)
    ]
    for key, word in given:
        others = [BEST_REFERENCE] if key != "design.base" else []
        if isinstance(word, str) and word not in [*known, *others]:
            yield InputError(
                key.rpartition(".")[2],
                "must be the name of a reference, that is, of one of the sensors",
                value=word,
                remedy=did_you_mean(word, known, f"known are {', '.join([*others, *known])}"),
                setting=key,
            )


def with_effort(
    document: DesignStudy, *, budget: int | None = None, seed: int | None = None
) -> DesignStudy:
    """The design with another budget or seed of the search; ``None`` keeps that of the document.

    Parameters
    ----------
    budget
        Number of evaluations; ``None`` keeps that of the document.
    seed
        Seed of the search; ``None`` keeps that of the document.

    Raises
    ------
    InputError
        If one of them is not possible.
    """
    given = {"budget": budget, "seed": seed}
    changes = {name: value for name, value in given.items() if value is not None}
    design = document.design.model_copy(update=changes)
    _ = design.search  # checks it
    return document.model_copy(update={"design": design})
