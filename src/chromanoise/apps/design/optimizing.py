"""From a design document to its front, for the command and for Python."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any

import numpy as np

from chromanoise.apps.design.algorithms import generation_rng, latin_hypercube, refuse_method
from chromanoise.apps.design.design_document import (
    BEST_REFERENCE,
    ChannelPart,
    ConstraintPart,
    DesignPart,
    DesignStudy,
    FilterPart,
)
from chromanoise.apps.design.evaluation import DesignScene, Objectives
from chromanoise.apps.design.objectives import OBJECTIVES
from chromanoise.apps.design.parameters import (
    Candidates,
    Parameter,
    RobustPart,
    bounds_of,
    over_tolerances,
    refuse_exact,
)
from chromanoise.apps.design.pareto_front import Evaluated, Front, Linearized, Problem
from chromanoise.apps.design.search import SearchOptions
from chromanoise.apps.design.space import LEAST_QE, Channel, DesignSpace, Filter
from chromanoise.base import Array, Float, InputError, check, dataclass
from chromanoise.io.spectra import Answers
from chromanoise.noise import OperatingPoint
from chromanoise.sensor import Sensor, dye_transmittances, mosaic_named, with_channel_names
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.study import (
    KNOWN_SENSORS,
    NOTHING_GIVEN,
    Given,
    keyed,
    light_answers_of,
    operating_points_of,
    prior_of,
    resolve_filter,
    resolve_illuminant,
    sensor_named,
    study_hash,
)

FULLEST = 0.99
"""Greatest share of full well of a channel on a perfect white."""
_SAMPLED = 64  # candidates of which the spread of each constraint is taken


@dataclass(frozen=True, kw_only=True)
class Reference:
    """A sensor with which the designs are compared.

    Attributes
    ----------
    name
        Its name in results.
    objectives
        Value of each objective of the design and of its constraints, by name.
    """

    name: str
    sensor: Sensor
    objectives: Mapping[str, float]


@dataclass(frozen=True, kw_only=True)
class Limit:
    """A constraint with its number.

    Attributes
    ----------
    objective, side, value
        The objective, ``at_most`` or ``at_least``, and the number in the objective's unit.
    origin
        The reference that gave the number; empty where the document gives it.
    """

    objective: str
    side: str
    value: float
    origin: str = ""

    @property
    def name(self) -> str:
        """The constraint as results print it: ``delta_e <= 5.2 (onyx-rgbw)``."""
        sign = "<=" if self.side == "at_most" else ">="
        return f"{self.objective} {sign} {self.value:.6g}" + (
            f" ({self.origin})" if self.origin else ""
        )

    @property
    def sign(self) -> float:
        """1 where smaller values keep the limit, else -1."""
        return 1.0 if self.side == "at_most" else -1.0


FULL_WELL = f"share of full well <= {FULLEST:g}"
"""Name of the constraint that every design has."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Task:
    """All that a search of a design needs.

    Attributes
    ----------
    space
        The sensors that are searched.
    scenes
        Light, exposure and matrix of the evaluation.
    evaluator
        Of the objectives of the design, then of its constraints.
    references
        The sensors of the document.
    limits
        The constraints of the document.
    given
        Objects of Python in place of names.
    """

    document: DesignStudy
    space: DesignSpace
    scenes: tuple[DesignScene, ...]
    evaluator: Objectives
    references: tuple[Reference, ...]
    limits: tuple[Limit, ...]
    given: Given = NOTHING_GIVEN

    @property
    def objectives(self) -> tuple[str, ...]:
        """The objectives of the search."""
        return self.document.design.objectives

    @property
    def draws(self) -> RobustPart | None:
        """Of the tolerances over which the objectives are taken; ``None`` for the exact values."""
        return self.document.design.robust

    def evaluation(self, draws: RobustPart | None) -> "Evaluation":
        """Objectives and constraints over the draws; those of the exact parameters if ``None``.

        Parameters
        ----------
        draws
            Drawn sensors; ``None`` for the exact parameters.
        """
        return Evaluation(
            space=self.space,
            evaluator=self.evaluator,
            objectives=len(self.objectives),
            limits=self.limits,
            draws=draws,
        )

    def problem(self) -> Problem:
        """What the search minimizes."""
        parameters = self.space.parameters
        low, high = bounds_of(parameters)
        evaluate = self.evaluation(self.draws)
        polish = self.document.design.polish
        wanted = self._has_exact_gradients if polish is None else polish
        return Problem(
            names=tuple(one.name for one in parameters),
            low=low,
            high=high,
            objectives=self.objectives,
            better=tuple(OBJECTIVES[name].better for name in self.objectives),
            constraints=(*(one.name for one in self.limits), FULL_WELL),
            evaluate=evaluate,
            gradient=evaluate.linearized if wanted and self.draws is None else None,
            integer=tuple(one.name for one in parameters if one.choices),
            identity=self.identity,
        )

    @property
    def _has_exact_gradients(self) -> bool:
        return self.evaluator.has_exact_gradients(self.space.noise_weight is not None)

    @property
    def identity(self) -> str:
        """A hash of all that determines the objectives; the effort of the search is not in it."""
        lights = [one.point.illuminant.irradiance for one in self.scenes]
        arrays = [*self.space.library.values(), *lights]
        return _identity(self.document, arrays, self.given.objects)


@dataclass(frozen=True, kw_only=True, eq=False)
class Evaluation:
    """Objectives and constraints of candidates: a function that can be sent to a worker.

    Attributes
    ----------
    space, evaluator
        From parameters to candidates, and from candidates to values.
    objectives
        How many of the evaluator's values are objectives of the search; they come first.
    limits
        The constraints, each on one of the evaluator's values.
    draws
        Of the tolerances over which both are taken; ``None`` for the exact parameters.
    """

    space: DesignSpace
    evaluator: Objectives
    objectives: int
    limits: tuple[Limit, ...]
    draws: RobustPart | None = None

    def __call__(self, values: Float[Array, "m d"]) -> Evaluated:
        """Objectives and violations of ``m`` candidates."""
        found = (
            self._costs(values)
            if self.draws is None
            else over_tolerances(self._costs, values, self.space.parameters, self.draws)
        )
        count = self.objectives
        return Evaluated(objectives=found[:, :count] * self._sign, violation=found[:, count:])

    def _costs(self, values: Float[Array, "m d"]) -> Float[Array, "m c"]:
        """Objectives with the sign of costs, then violations."""
        candidates = self.space.candidates(values)
        found, fullness = self.evaluator.values_and_fullness(candidates)
        costs = found[:, : self.objectives] * self._sign
        dark = (candidates.qe.max(axis=1) < LEAST_QE).any(axis=1)  # cannot be a sensor
        return np.column_stack(
            [
                np.where(dark[:, None], np.inf, costs),
                *(one.sign * (found[:, self._place(one)] - one.value) for one in self.limits),
                fullness - FULLEST,
            ]
        )

    def _place(self, limit: Limit) -> int:
        return self.evaluator.objectives.index(limit.objective)

    @property
    def _sign(self) -> Float[Array, " q"]:
        better = [one.better for one in self.evaluator.entries[: self.objectives]]
        return np.array([1.0 if side == "lower" else -1.0 for side in better])

    def linearized(self, values: Float[Array, "m d"]) -> Linearized:
        """Objectives and violations of candidates with exact parameters, and derivatives."""
        at = self.evaluator.linearization(self.space, values)
        violation, slope, constraint = [], [], []
        for k, one in enumerate(self.limits):
            is_each = one.objective == "least_separation" and one.side == "at_least"
            if is_each and at.separations.shape[1]:
                parts, jacobian = at.separations, at.separations_jacobian
            else:
                own = [self._place(one)]
                parts, jacobian = at.objectives[:, own], at.objectives_jacobian[:, own]
            violation.append(one.sign * (parts - one.value))
            slope.append(one.sign * jacobian)
            constraint += [k] * parts.shape[1]
        return Linearized(
            objectives=at.objectives[:, : self.objectives],
            violation=np.column_stack([*violation, at.fullness - FULLEST]),
            objectives_jacobian=at.objectives_jacobian[:, : self.objectives],
            violation_jacobian=np.concatenate([*slope, at.fullness_slope[:, None]], axis=1),
            constraint=np.array([*constraint, len(self.limits)]),
        )


_EFFORT = (*(one.name for one in fields(SearchOptions)), "members")


def _identity(document: DesignStudy, arrays: Sequence[Array], objects: Mapping[str, Any]) -> str:
    """A hash of a document, of its study's files and objects, and of arrays of its other files.

    The effort of the search and the title are not in it.
    """
    effort = {name: DesignPart.model_fields[name].default for name in _EFFORT}
    design = document.design.model_copy(update=effort)
    plain = document.model_copy(update={"design": design, "title": ""})
    digest = hashlib.sha256(study_hash(plain, objects=objects).encode())
    for one in arrays:
        digest.update(np.ascontiguousarray(one, dtype=np.float64).tobytes())
    return digest.hexdigest()


def task_of(document: DesignStudy, given: Given = NOTHING_GIVEN) -> Task:
    """The space, the scenes, the references and the constraints of a document.

    Parameters
    ----------
    given
        Objects of Python in place of names.

    Raises
    ------
    InputError
        If something that it names cannot be used, each with its key.
    """
    points = operating_points_of(document, given)
    base = points[_base_index(document)]
    space = space_of(document, base.sensor)
    design = document.design
    wanted = (*design.objectives, *(one.objective for one in design.constraints))
    names = tuple(dict.fromkeys(wanted))
    scenes = scenes_of(document, base, given)
    if design.robust is not None:
        with keyed("design.robust"):
            refuse_exact(space.parameters)
    evaluator = Objectives(scenes=scenes, objectives=names, over_scenes=design.over_scenes)
    references = tuple(_reference(point, evaluator) for point in points)
    task = Task(
        document=document,
        space=space,
        scenes=scenes,
        evaluator=evaluator,
        references=references,
        limits=tuple(
            _limit(part, document, references, f"design.constraints.{i}")
            for i, part in enumerate(design.constraints)
        ),
        given=given,
    )
    _refuse_contradiction(task.limits)
    with keyed("design.method"):
        refuse_method(task.problem(), design.method)
    return task


def _base_index(document: DesignStudy) -> int:
    name = document.design.base
    return 0 if name is None else document.reference_index(name)


def scenes_of(
    document: DesignStudy, base: OperatingPoint, given: Given = NOTHING_GIVEN
) -> tuple[DesignScene, ...]:
    """The scenes of a design; that of its study if it names none.

    A scene without a time has that of the study, or the longest at which no reference saturates in
    its light.

    Raises
    ------
    InputError
        If a scene cannot be made.
    """
    made = partial(
        DesignScene,
        matrix=document.matrices[0],
        metric=document.metric,  # type: ignore[arg-type]  # its schema has checked the name
        prior=prior_of(document),
    )
    if not document.design.scenes:
        return (made(point=base, name="1"),)
    scenes = []
    for i, part in enumerate(document.design.scenes):
        own = part.model_dump(include={"illuminant", "level_lux"}, exclude_none=True)
        exposure = document.exposure
        if part.time_ms is not None:
            exposure = exposure.model_copy(update={"time_ms": part.time_ms})
        study = document.model_copy(
            update={"light": document.light.model_copy(update=own), "exposure": exposure}
        )
        if part.illuminant is not None:  # an error names the scene, not the light of the study
            with keyed(f"design.scenes.{i}.illuminant"):
                resolve_illuminant(part.illuminant, answers=light_answers_of(study))
        with keyed(f"design.scenes.{i}"):
            points = operating_points_of(study, given)
        point = points[_base_index(document)]
        scenes.append(made(point=point, name=part.name or str(i + 1)))
    check.distinct("names of scenes", [one.name for one in scenes])
    return tuple(scenes)


def space_of(document: DesignStudy, base: Sensor) -> DesignSpace:
    """The design space of a document.

    Parameters
    ----------
    base
        Gives grid, pixel and curves.

    Raises
    ------
    InputError
        As `DesignSpace`, with the key of the design.
    """
    design = document.design
    try:
        return DesignSpace(
            base=base,
            channels=tuple(_channel(part) for part in design.channels),
            structure=design.structure,
            ir_cut=None if design.ir_cut is None else _filter(design.ir_cut),
            silicon=design.silicon.numbers,
            layers=design.layers.numbers,
            router=design.router.numbers,
            library=_library(document),
            mosaic=None
            if design.mosaic is None
            else with_channel_names(
                mosaic_named(design.mosaic), [part.name for part in design.channels]
            ),
            pixel_shares=design.pixel_shares,
            crosstalk=design.crosstalk.share,
            time_ms=design.exposure.time_ms,
            noise_weight=design.matrix.noise_weight,
            pixel={name: value for name, value in design.pixel if value is not None},
        )
    except InputError as error:
        if error.setting:
            raise
        raise error.inside(_key_in(error.subject, design.channels), str) from None


def _channel(part: ChannelPart) -> Channel:
    return Channel(
        name=part.name,
        filter=None if part.filter is None else _filter(part),
        ir_cut=None if part.ir_cut is None else _filter(part.ir_cut),
        base=part.base,
    )


def _filter(part: FilterPart | ChannelPart) -> Filter:
    assert part.filter is not None  # a channel may have no filter
    return Filter(model=part.filter, numbers=part.numbers, curves=part.curves)


def _library(document: DesignStudy) -> dict[str, Array]:
    """The transmittances that the filters of model ``dye`` name."""
    library, answers = {}, Answers(quantity="transmittance")
    for key, part in document.filters():
        for word in part.curves:
            with keyed(f"{key}.curves"):
                library[word] = _transmittance(word, answers)
    return library


def _transmittance(word: str, answers: Answers) -> Array:
    """Of a filter, or of the dye of a channel of the catalog, as ``mt9v024-rgbw:R``."""
    name, _, channel = word.rpartition(":")
    if name not in KNOWN_SENSORS:
        return resolve_filter(word, answers=answers).values[:, 0]
    dyes = dye_transmittances(sensor_named(name, DEFAULT_GRID))
    own = [one.rpartition(":")[2] for one in dyes.names]
    check.among(f"dye of {name}", channel, own)
    return dyes.values[:, own.index(channel)]


def _key_in(subject: str, channels: Sequence[ChannelPart]) -> str:
    """The key of a number that an error calls ``bounds of R.center_nm``."""
    name = subject.rpartition(" ")[2]
    place, dot, rest = name.partition(".")
    for i, channel in enumerate(channels):
        if dot and place == channel.name:
            return f"design.channels.{i}.{rest}"
    return f"design.{name}" if dot else "design"


def impossible(document: DesignStudy) -> list[InputError]:
    """Errors of a document whose names are all known but whose design cannot be made."""
    try:
        task_of(document)
    except InputError as error:
        return [error if error.setting else error.inside("design", str)]
    return []


def _reference(point: OperatingPoint, evaluator: Objectives) -> Reference:
    """A sensor of the document, in the scenes of the design with its own pixel."""
    sensor = point.sensor
    scenes = tuple(
        replace(scene, point=replace(scene.point, sensor=sensor)) for scene in evaluator.scenes
    )
    own = replace(evaluator, scenes=scenes)
    (values,) = own.values(Candidates(qe=np.asarray(sensor.qe)[None]))
    names = evaluator.objectives
    return Reference(
        name=sensor.label,
        sensor=sensor,
        objectives=dict(zip(names, values.tolist(), strict=True)),
    )


def _limit(
    part: ConstraintPart, document: DesignStudy, references: Sequence[Reference], key: str
) -> Limit:
    limit = part.limit
    if not isinstance(limit, str):
        return Limit(objective=part.objective, side=part.side, value=limit)
    values = {one.name: one.objectives[part.objective] for one in references}
    if limit == BEST_REFERENCE:
        choose = min if OBJECTIVES[part.objective].better == "lower" else max
        name = choose(values, key=lambda one: values[one])
    else:
        name = references[document.reference_index(limit)].name
    if not np.isfinite(values[name]):
        raise InputError(
            part.side,
            f"must be the value of a reference whose {part.objective} is defined",
            value=limit,
            found=f"is that of {name}, which is saturated or has none",
            setting=f"{key}.{part.side}",
        )
    return Limit(objective=part.objective, side=part.side, value=values[name], origin=name)


def _refuse_contradiction(limits: Sequence[Limit]) -> None:
    """Refuse two limits of one objective that no design can meet together."""
    for most in limits:
        for least in limits:
            sides = (most.side, least.side) == ("at_most", "at_least")
            if sides and most.objective == least.objective and most.value < least.value:
                raise InputError(
                    "constraints",
                    "must be met together by one design",
                    found=f"{most.name} and {least.name} contradict each other",
                    setting="design.constraints",
                )


def with_constraint_sizes(task: Task) -> Problem:
    """The problem whose constraints have their spread over the design space as size.

    The sizes depend on the design alone, so that a search that is resumed has the same. Two digits
    do not depend on the rounding of a processor.
    """
    problem = task.problem()
    values = latin_hypercube(problem, _SAMPLED, generation_rng(0, 0))
    sizes = []
    for column in task.evaluation(None)(values).violation.T:
        defined = column[np.isfinite(column)]
        spread = float(f"{defined.std():.2g}") if defined.size else 0.0
        sizes.append(spread or 1.0)
    return replace(problem, constraint_sizes=tuple(sizes))


def beside_of(task: Task, front: Front) -> tuple[Mapping[str, float], ...]:
    """Further objectives of each member, by name, where parameters have tolerances.

    The nominal ones, of the exact parameters, if the search took them over the tolerances, else the
    robust ones, the worst of the draws. Empty without tolerances.
    """
    if not any(one.tolerance for one in task.space.parameters):
        return ()
    evaluate = task.evaluation(RobustPart() if task.draws is None else None)
    found = evaluate(np.array([one.values for one in front.members])).objectives
    return tuple(dict(zip(task.objectives, row, strict=True)) for row in found.tolist())


def start_of(parameters: Sequence[Parameter]) -> Float[Array, "1 d"] | None:
    """One candidate at the starts, elsewhere in the middle; ``None`` if there is no start."""
    if all(one.start is None for one in parameters):
        return None
    middle = [0.5 * (one.low + one.high) if one.start is None else one.start for one in parameters]
    return np.array([middle])
