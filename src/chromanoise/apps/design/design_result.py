"""A design: reading its file, the search, its result, and the sentences and files about it.

Errors in ``design.toml`` are reported together, each with file, line and key. The output folder has
``front.json``, ``front.csv``, ``front.svg`` and a file per sensor. The sentences state extremes,
knee, references, active limits, tolerances and convergence.
"""

import json
import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from chromanoise.apps.design.design_document import ChannelPart, DesignStudy, FilterPart
from chromanoise.apps.design.evaluation import DesignScene
from chromanoise.apps.design.objectives import OBJECTIVES, Objective
from chromanoise.apps.design.optimizing import (
    Reference,
    Task,
    beside_of,
    impossible,
    start_of,
    task_of,
    with_constraint_sizes,
)
from chromanoise.apps.design.parameters import Parameter
from chromanoise.apps.design.pareto_front import (
    Front,
    FrontConvergence,
    FrontCurves,
    FrontFile,
    FrontMember,
    FrontMilestone,
    FrontObjective,
    FrontReference,
    FrontScene,
    FrontSeed,
    Member,
    front_of,
)
from chromanoise.apps.design.search import FrontResult, Progress, Scheduler, searched_front
from chromanoise.apps.design.space import LEAST_SHARE
from chromanoise.base import (
    InputError,
    __version__,
    claimed_folder,
    dataclass,
    from_above,
    json_file,
    refuse_absent_package,
    refuse_unwritable,
)
from chromanoise.io import Column, Result, Table, axes_of, figures, sensor_json, table_writer
from chromanoise.noise import conditions
from chromanoise.sensor import Pixel, Sensor
from chromanoise.study import (
    NOTHING_GIVEN,
    ExposurePart,
    Given,
    LightPart,
    PixelPart,
    Study,
    beside_file,
    document_from_text,
    document_text,
    is_relative_to_working_folder,
    study_as_command,
    study_as_json,
    unresolved,
    word_beside,
)

_AT_BOUND = 1e-3  # distance from a bound, as a share of the range, at which the bound holds
_HALF = (0.45, 0.55)  # ratios that are called half
_TIMES = 1.5  # ratio from which a multiple is printed, not a percentage
AGREEING_DB, AGREEING_SHARE = 0.05, 0.01
"""Differences of the extremes, and of the hypervolumes, of several seeds up to which a search
counts as converged."""
_ALIKE = 0.005  # relative difference below which no percentage is printed


def held_by(member: Member, parameters: Sequence[Parameter]) -> list[str]:
    """The active constraints and bounds of a member, such as ``R.center_nm <= 680``.

    Bounds of pixels are those of the shares of the channels, e.g. ``R.pixels >= 1 %``.

    Parameters
    ----------
    parameters
        In the order of its values.
    """
    bounds = []
    for value, one in zip(np.asarray(member.values).tolist(), parameters, strict=True):
        if one.choices:
            continue
        low, high = (abs(value - end) <= _AT_BOUND * one.span for end in (one.low, one.high))
        if _is_of_rest(one):  # all of the rest leaves the least share to the channels behind
            names = [] if member.sensor is None else list(member.sensor.names)
            own = one.name.removesuffix(_OF_REST)
            behind = names[names.index(own) + 1 :] if own in names else []
            least = [*([own] if low else []), *(behind if high else [])]
            bounds += [f"{name}.pixels >= {100 * LEAST_SHARE:g} %" for name in least]
            continue
        bounds += [f"{one.name} >= {one.low:g}"] if low else []
        bounds += [f"{one.name} <= {one.high:g}"] if high else []
    return [*member.active, *dict.fromkeys(bounds)]


_OF_REST = ".share_of_rest"


def _is_of_rest(parameter: Parameter) -> bool:
    """Whether a number is a share of the pixels that the channels before it leave."""
    return parameter.name.endswith(_OF_REST)


@dataclass(frozen=True, kw_only=True)
class ShownNumber:
    """A designed number of all members for a table.

    Attributes
    ----------
    values
        One per member [unit], or the name of a choice.
    bounds
        Its range, or all choices, in words.
    """

    name: str
    unit: str
    values: tuple[float, ...] | tuple[str, ...]
    bounds: str


def front_sentences(
    front: Front,
    parameters: Sequence[Parameter],
    references: Mapping[str, Mapping[str, float]],
) -> list[str]:
    """One sentence per extreme and for the knee, and how many members beat the references.

    Parameters
    ----------
    references
        Objectives of the references by name.
    """
    sentences = [_sentence(one, front, parameters) for one in front.marked]
    if references:
        sentences.append(_beaten(front, references))
    return sentences


def tolerance_sentence(member: Member, beside: Mapping[str, float], which: str) -> str:
    """What the tolerances cost a member, in words.

    Parameters
    ----------
    beside
        Its ``nominal`` or its ``robust`` objectives, by name, beside those of the front.
    """
    parts = []
    for name, value in member.objectives.items():
        exact, robust = (beside[name], value) if which == "nominal" else (value, beside[name])
        one = OBJECTIVES[name]
        parts.append(f"{one.short} from {_shown(exact, one)} to {_shown(robust, one)}")
    return f"{member.name}: its tolerances change {', '.join(parts)}."


def tolerances_sentence(
    members: Sequence[Member], beside: Sequence[Mapping[str, float]], which: str
) -> str:
    """The extremes of a front in the ``nominal`` or ``robust`` values not used by its search.

    Parameters
    ----------
    members
        Members of a front.
    beside
        The ``nominal`` or ``robust`` objectives of each member, by name.
    """
    parts = []
    for name in members[0].objectives:
        objective = OBJECTIVES[name]
        best = best_of(objective, [one[name] for one in beside])
        shown = _shown(beside[best][name], objective)
        parts.append(f"the {_best(objective)} is {shown} ({members[best].name})")
    words = "Within the tolerances" if which == "robust" else "With exact parameters"
    return f"{words}, {', '.join(parts)}."


def best_of(objective: Objective, values: Sequence[float]) -> int:
    """Index of the best value of an objective; of equal values the first one."""
    return int(np.argmax(values) if objective.better == "higher" else np.argmin(values))


def spread_of(objective: Objective, values: Sequence[float]) -> float:
    """Largest minus smallest of several best values: in dB, otherwise relative to the best one.

    Examples
    --------
    >>> spread_of(OBJECTIVES["delta_e"], [4.0, 4.1])
    0.025
    """
    if not np.isfinite(values).all():
        return float("inf")
    width = float(np.max(values) - np.min(values))
    best = abs(values[best_of(objective, values)])
    if objective.unit == "dB" or width == 0:
        return width
    return round(width / best, 12) if best else float("inf")


def hypervolume_spread(result: FrontResult) -> float | None:
    """Relative difference of the hypervolumes of the seeds; ``None`` for one objective."""
    volumes = [one for one in result.convergence.hypervolumes if one is not None]
    if not volumes:
        return None
    most = max(volumes)
    return (most - min(volumes)) / most if most else float("inf")


def extreme_spreads(result: FrontResult, objectives: Sequence[str]) -> dict[str, float]:
    """`spread_of` the best values of the seeds, by objective."""
    best = result.convergence.best.T.tolist()
    return {
        name: spread_of(OBJECTIVES[name], own) for name, own in zip(objectives, best, strict=True)
    }


def has_converged(result: FrontResult, objectives: Sequence[str]) -> bool | None:
    """Whether the extremes and the hypervolumes of the seeds agree; ``None`` for one seed."""
    if len(result.convergence.seeds) < 2:
        return None
    spread = hypervolume_spread(result)
    agree = all(
        width <= (AGREEING_DB if OBJECTIVES[name].unit == "dB" else AGREEING_SHARE)
        for name, width in extreme_spreads(result, objectives).items()
    )
    return agree and (spread is None or spread <= AGREEING_SHARE)


def convergence_sentences(result: FrontResult, objectives: Sequence[str]) -> list[str]:
    """Sentences on the effort of a search, its convergence, and what to do if not converged.

    Parameters
    ----------
    result
        Result of the search.
    objectives
        Names of its objectives.
    """
    own, count = result.convergence, len(result.convergence.seeds)
    polish = f", {result.gradient_evaluations} gradients" if result.gradient_evaluations else ""
    effort = f"{result.evaluations} sensors{polish}, {count} seed{'' if count == 1 else 's'}"
    converged = has_converged(result, objectives)
    if converged is None:
        sentences = [
            f"Whether the search has converged is not known ({effort}): it takes design.seeds of 2 "
            "or more, and a budget of a population for each."
        ]
    else:
        spreads = [
            (width, OBJECTIVES[name].unit, OBJECTIVES[name].short)
            for name, width in extreme_spreads(result, objectives).items()
        ]
        volumes = hypervolume_spread(result)
        spreads += [] if volumes is None else [(volumes, "1", "the hypervolume")]
        differences = [f"{_spread_text(width, unit)} in {what}" for width, unit, what in spreads]
        verdict = (
            "The search has converged"
            if converged
            else "The search has not converged; raise design.budget"
        )
        sentences = [
            f"{verdict} ({effort}): the best values of the seeds differ by "
            f"{', '.join(differences)}."
        ]
    if result.undefined:
        sentences.append(
            f"{result.undefined} of {result.evaluations} sensors count as infeasible, because an "
            "objective is undefined: a channel has no signal or is saturated."
        )
    sentences += [f"The polish ended early: {one}." for one in own.failures]
    return sentences


def _spread_text(width: float, unit: str) -> str:
    if not np.isfinite(width):
        return "undefined"
    return f"{width:.2g} dB" if unit == "dB" else f"{100 * width:.2g} %"


def beats(member: Mapping[str, float], other: Mapping[str, float], names: Sequence[str]) -> bool:
    """Whether a design is no worse in any objective and better in one.

    Examples
    --------
    >>> beats({"snr_y_db": 26.0, "delta_e": 3.0}, {"snr_y_db": 25.0, "delta_e": 3.0},
    ...       ["snr_y_db", "delta_e"])
    True
    """
    gains = [_gain(OBJECTIVES[name], member[name], other[name]) for name in names]
    return all(gain >= 0 for gain in gains) and any(gain > 0 for gain in gains)


def _gain(objective: Objective, value: float, other: float) -> float:
    if value == other:  # also both infinite
        return 0.0
    return value - other if objective.better == "higher" else other - value


def _beaten(front: Front, references: Mapping[str, Mapping[str, float]]) -> str:
    winners = [
        one
        for one in front.members
        if all(beats(one.objectives, other, front.objectives) for other in references.values())
    ]
    names = " and ".join(references)
    count = f"{len(winners)} of {len(front.members)} sensors"
    are = "is" if len(winners) == 1 else "are"
    return f"{count} {are} better than {names} in at least one objective and worse in none."


def _sentence(member: Member, front: Front, parameters: Sequence[Parameter]) -> str:
    parts = []
    for name in member.extreme_of:
        objective = OBJECTIVES[name]
        value = _shown(member.objectives[name], objective)
        parts.append(f"the {_best(objective)} ({value})")
    for name in front.objectives:
        if name not in member.extreme_of:
            gain = "" if member.extreme_of else _gain_for(member, front.best(name), front)
            parts.append(f"{_shortfall(member, front.best(name), OBJECTIVES[name])}{gain}")
    held = held_by(member, parameters)
    end = f" Held by {', '.join(held)}." if held else ""
    return f"{member.name}: {'; '.join(parts)}.{end}"


def _best(objective: Objective) -> str:
    return f"{'best' if objective.better == 'higher' else 'lowest'} {objective.short}"


def _shortfall(member: Member, best: Member, objective: Objective) -> str:
    """How far a member is from the best value of an objective."""
    value, goal = member.objectives[objective.name], best.objectives[objective.name]
    if objective.unit == "dB":
        return f"{abs(value - goal):.1f} dB short of the {_best(objective)}"
    ratio = value / goal if goal else np.inf
    if abs(ratio - 1) < _ALIKE:
        return f"within {100 * _ALIKE:g} % of the {_best(objective)}"
    side = "above" if ratio > 1 else "below"
    percent = f"{_percent(abs(ratio - 1))} {side} the {_best(objective)}"
    return _multiple(value, ratio, objective, _best(objective), percent)


def _gain_for(member: Member, best: Member, front: Front) -> str:
    """What a member gains over another one, in the first objective in which it is better."""
    for name in front.objectives:
        objective = OBJECTIVES[name]
        value, before = member.objectives[name], best.objectives[name]
        if _gain(objective, value, before) > 0:
            return f" for {_gained(value, before, objective)}"
    return ""


def _gained(value: float, before: float, objective: Objective) -> str:
    if objective.unit == "dB":
        return f"{abs(value - before):.1f} dB more {objective.short}"
    ratio = value / before if before else np.inf
    if _HALF[0] <= ratio <= _HALF[1]:
        return f"half the {objective.short}"
    percent = f"{_percent(ratio)} of the {objective.short}"
    return _multiple(value, ratio, objective, objective.short, percent)


def _multiple(value: float, ratio: float, objective: Objective, what: str, percent: str) -> str:
    """A large ratio as a multiple, a small one in percent; the value where there is no ratio."""
    if not np.isfinite(ratio):
        return f"a {objective.short} of {_shown(value, objective)}"
    if ratio >= _TIMES:
        times = f"{ratio:.0f}" if ratio >= 10 else f"{ratio:.2g}"
        return f"{times} times the {what}"
    return percent


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.1 else f"{100 * share:.2g} %"


def _shown(value: float, objective: Objective) -> str:
    unit = "" if objective.unit == "1" else f" {objective.unit}"
    return f"{value:.4g}{unit}" if np.isfinite(value) else "undefined"


SENSORS = "sensors"
"""Folder of the members' files, beside ``front.json``."""
_KEPT = ("metric", "observer", "prior", "reflectances")  # keys that a member's study takes over


@dataclass(frozen=True, kw_only=True, eq=False)
class Design(Result):
    """The front of a design: sensors of which none is better than another in all objectives.

    Attributes
    ----------
    front
        The members, the best in the first objective first, with their sensors.
    result
        Counts and the whole front.
    beside
        The ``nominal`` or ``robust`` objectives of each member, by name; empty without tolerances.
    """

    task: Task
    front: Front
    result: FrontResult
    beside: tuple[Mapping[str, float], ...] = ()

    @property
    def members(self) -> tuple[Member, ...]:
        """The members of the front."""
        return self.front.members

    @property
    def references(self) -> tuple[Reference, ...]:
        """The sensors with which the members are compared."""
        return self.task.references

    @property
    def sentences(self) -> tuple[str, ...]:
        """The extremes and the knee in words."""
        names = self.front.objectives
        references = {
            one.name: one.objectives
            for one in self.references
            if all(np.isfinite(one.objectives[name]) for name in names)
        }
        sentences = front_sentences(self.front, self.task.space.parameters, references)
        sentences += self._pixel_sentences()
        sentences += [
            f"{one.name} is not compared: it saturates or has an undefined objective."
            for one in self.references
            if one.name not in references
        ]
        if self.beside:
            sentences += [
                tolerance_sentence(one, beside, self.beside_name)
                for one, beside in zip(self.members, self._beside, strict=True)
                if one in self.front.marked
            ]
            sentences.append(tolerances_sentence(self.members, self._beside, self.beside_name))
        else:
            sentences.append(
                "The design has no tolerances, so the extremes hold for exact parameters only."
            )
        sentences += convergence_sentences(self.result, names)
        return tuple(sentences)

    @property
    def beside_name(self) -> str:
        """What `beside` holds: ``nominal`` or ``robust`` objectives."""
        return "robust" if self.task.draws is None else "nominal"

    @property
    def _beside(self) -> tuple[Mapping[str, float], ...]:
        return self.beside or ({},) * len(self.members)

    def pixel_percent(self, member: Member) -> dict[str, float]:
        """Share of the pixels of each channel of a member; empty where they are not free. [%]

        Parameters
        ----------
        member
            A member of the front.

        Returns
        -------
        Percent by the name of the channel
        """
        space = self.task.space
        found = space.shares(np.asarray(member.values, dtype=float)[None, :])
        if found is None or space.pixel_shares != "free":
            return {}
        return dict(zip(space.names, (100.0 * found[0].real).tolist(), strict=True))

    def shown_numbers(self) -> tuple[ShownNumber, ...]:
        """The free numbers, with the shares of the pixels of all channels in percent.

        A search varies each share as part of what the channels before leave (``share_of_rest``).
        """
        found: list[ShownNumber] = []
        parameters = self.task.space.parameters
        shares = [self.pixel_percent(one) for one in self.members]
        most = 1.0 - (len(self.task.space.channels) - 1) * LEAST_SHARE
        bounds = f"{100 * LEAST_SHARE:g} to {100 * most:g}"
        for i, one in enumerate(parameters):
            if one.choices:
                chosen = tuple(one.choices[round(member.values[i])] for member in self.members)
                own = ", ".join(one.choices)
                found.append(ShownNumber(name=one.name, unit="", values=chosen, bounds=own))
            elif not _is_of_rest(one):
                values = tuple(float(member.values[i]) for member in self.members)
                unit = "" if one.unit == "1" else one.unit
                own = f"{one.low:g} to {one.high:g}"
                found.append(ShownNumber(name=one.name, unit=unit, values=values, bounds=own))
            elif i == 0 or not _is_of_rest(parameters[i - 1]):
                found += [
                    ShownNumber(
                        name=f"{name}.pixels",
                        unit="%",
                        values=tuple(share[name] for share in shares),
                        bounds=bounds,
                    )
                    for name in self.task.space.names
                ]
        return tuple(found)

    def _pixel_sentences(self) -> list[str]:
        texts = []
        for one in self.front.marked:
            shares = self.pixel_percent(one)
            if shares:
                percents = "/".join(f"{share:.0f}" for share in shares.values())
                texts.append(f"{one.name} {percents} %")
        if not texts:
            return []
        return [f"Pixels of {', '.join(self.task.space.names)}: {'; '.join(texts)}."]

    def sensor(self, name: str) -> Sensor:
        """The sensor of a member.

        Parameters
        ----------
        name
            Name of the member.

        Returns
        -------
        Sensor

        Raises
        ------
        InputError
            If there is no such member.
        """
        return self._member(name).sensor

    def analyze_command(self, name: str, folder: str = "") -> str:
        """The command that analyzes a member in the first scene, with the digits of the front.

        Empty where shares of pixels are designed, which a study cannot describe.

        Parameters
        ----------
        name
            Name of the member.
        folder
            Folder of ``front.json``, empty for the working folder.

        Returns
        -------
        str

        Raises
        ------
        InputError
            If there is no such member.
        """
        member, scene = self._member(name), self.task.scenes[0]
        if self.task.space.pixel_shares != "equal":  # a study has no shares of pixels
            return ""
        document = self.task.document
        data = document.model_dump(by_alias=True, exclude_defaults=True)
        kept = {key: data[key] for key in _KEPT if key in data}
        matrix = self._matrix(member) or document.matrices[0]
        exposure = self._exposure(scene, member)
        light = document.light.model_copy(
            update={"illuminant": self._light(scene), "level_lux": scene.point.level_lux}
        )
        file = f"{folder}/{_file(member)}" if folder else _file(member)
        study = Study.model_validate(
            kept
            | {
                "light": light.model_dump(exclude_defaults=True),
                "exposure": exposure.model_dump(exclude_defaults=True),
                "sensors": [{"name": file}],
                "matrices": [matrix],
                "outputs": {"budget": False},
            }
        )
        return study_as_command(study)

    def to_file(self) -> FrontFile:
        """The front as the page and ``front.json`` hold it."""
        parameters = self.task.space.parameters
        return FrontFile(
            objectives=[
                FrontObjective(name=one.name, what=one.what, unit=one.unit, better=one.better)
                for one in map(OBJECTIVES.__getitem__, self.front.objectives)
            ],
            scenes=[
                FrontScene(
                    name=scene.name,
                    light=LightPart(illuminant=self._light(scene), level_lux=scene.point.level_lux),
                    exposure=self._exposure(scene),
                    matrix=scene.matrix,
                )
                for scene in self.task.scenes
            ],
            references=[
                FrontReference(name=one.name, objectives=self._finite(dict(one.objectives)))
                for one in self.references
            ],
            members=[
                FrontMember(
                    name=one.name,
                    objectives=self._finite(dict(one.objectives)),
                    sensor=_file(one),
                    extreme_of=list(one.extreme_of),
                    knee=one.knee,
                    held_by=held_by(one, parameters),
                    **self._beside_fields(one, beside),
                    values=dict(
                        zip(
                            (parameter.name for parameter in parameters),
                            np.asarray(one.values).tolist(),
                            strict=True,
                        )
                    ),
                    curves=_curves(one.sensor),
                    pixel=_pixel_part(one.sensor.pixel),
                    exposure=self._exposure(self.task.scenes[0], one)
                    if self._time_ms(one) is not None
                    else None,
                    matrix=self._matrix(one),
                    analyze=self.analyze_command(one.name),
                )
                for one, beside in zip(self.members, self._beside, strict=True)
            ],
            convergence=self._convergence(),
            sentences=list(self.sentences),
        )

    def _beside_fields(self, member: Member, beside: Mapping[str, float]) -> dict[str, Any]:
        """The objectives `beside` of a member, and those of which no member has a better value."""
        if not beside:
            return {}
        best = {
            name: self.members[best_of(OBJECTIVES[name], [one[name] for one in self._beside])]
            for name in self.front.objectives
        }
        return {
            self.beside_name: self._finite(dict(beside)),
            f"{self.beside_name}_extreme_of": [n for n, one in best.items() if one is member],
        }

    def _convergence(self) -> FrontConvergence:
        result, names = self.result, self.front.objectives
        own = result.convergence

        def named(values: Any) -> dict[str, float | None]:
            return self._finite(dict(zip(names, np.asarray(values).tolist(), strict=True)))

        return FrontConvergence(
            converged=has_converged(result, names),
            evaluations=result.evaluations,
            gradients=result.gradient_evaluations,
            undefined=result.undefined,
            seeds=[
                FrontSeed(seed=seed, best=named(best), hypervolume=volume)
                for seed, best, volume in zip(own.seeds, own.best, own.hypervolumes, strict=True)
            ],
            spread=self._finite(extreme_spreads(result, names)),
            gain=named(own.gain),
            reference=named(own.reference),
            milestones=[
                FrontMilestone(
                    evaluations=one.evaluations, hypervolume=one.hypervolume, best=named(one.best)
                )
                for one in own.milestones
            ],
        )

    def to_dict(self) -> dict[str, Any]:
        """As ``front.json``."""
        return self.to_file().model_dump(mode="json", by_alias=True)

    def to_table(self) -> Table:
        """One row per reference and member: objectives, then free parameters."""
        parameters = self.task.space.parameters
        objectives = [OBJECTIVES[name] for name in self.front.objectives]
        numbers = self.shown_numbers()
        shown: list[Objective | ShownNumber] = [*objectives, *numbers]
        beside_names = self.front.objectives if self.beside else ()
        columns = [
            Column(name="sensor"),
            *(
                Column(name=one.name, unit="" if one.unit == "1" else one.unit, digits=".4g")
                for one in shown
            ),
            *(Column(name=f"{name}_{self.beside_name}", digits=".4g") for name in beside_names),
            Column(name="extreme of"),
            Column(name="held by"),
        ]
        rows: list[tuple[Any, ...]] = []
        for reference in self.references:
            found = self._finite(dict(reference.objectives))
            empty = len(numbers) + len(beside_names)
            rows.append((reference.name, *found.values(), *[None] * empty, "", ""))
        for i, (one, beside) in enumerate(zip(self.members, self._beside, strict=True)):
            marks = [*one.extreme_of, *(["knee"] if one.knee else [])]
            rows.append(
                (
                    one.name,
                    *self._finite(dict(one.objectives)).values(),
                    *(number.values[i] for number in numbers),
                    *(self._finite(dict(beside)).values() if beside else ()),
                    ", ".join(marks),
                    ", ".join(held_by(one, parameters)),
                )
            )
        return Table(
            title=f"Front of a design at {self.conditions}",
            columns=tuple(columns),
            rows=tuple(rows),
        )

    def plot(self, ax: Any = None) -> Any:
        """Draw the second objective against the first: members and references."""
        return from_above("design").draw_front(self.to_file(), axes_of(ax))

    def __repr__(self) -> str:
        """Number of members and the operating point."""
        return f"<Design: front of {len(self.members)} sensors at {self.conditions}>"

    def _repr_html_(self) -> str:
        return self._html(f"At {self.conditions}", self.sentences)

    @property
    def conditions(self) -> str:
        """The operating point in words; of several scenes all, and which of their values counts."""
        first, *others = [conditions([one.point]) for one in self.task.scenes]
        if not others:
            return first
        counts = f"the {self.task.evaluator.over_scenes} of {1 + len(others)} scenes"
        return f"{counts}: {'; '.join([first, *others])}"

    def _member(self, name: str) -> Member:
        for one in self.members:
            if one.name == name:
                return one
        raise InputError("name", "must be a member of the front", value=name)

    def _light(self, scene: DesignScene) -> str:
        document = self.task.document
        parts = document.design.scenes
        own = parts[self.task.scenes.index(scene)].illuminant if parts else None
        return own or document.light.illuminant

    def _exposure(self, scene: DesignScene, member: Member | None = None) -> ExposurePart:
        exposure = scene.point.exposure
        own = None if member is None else self._time_ms(member)
        return ExposurePart(
            time_ms=1e3 * exposure.time_s if own is None else own,
            f_number=exposure.f_number,
            magnification=exposure.magnification,
        )

    def _time_ms(self, member: Member) -> float | None:
        return self._number("exposure.time_ms", member, self.task.space.time_ms)

    def _matrix(self, member: Member) -> str | None:
        weight = self._number("matrix.noise_weight", member, self.task.space.noise_weight)
        return None if weight is None else f"noise-regularized={weight!r}"

    def _number(self, name: str, member: Member, given: Any) -> float | None:
        """A designed number of a member, also where it is fixed or tied; ``None`` if not."""
        if given is None:
            return None
        row = np.asarray(member.values)[None]
        return float(np.broadcast_to(self.task.space.number(name, row), (1,))[0])

    def _finite(self, objectives: dict[str, float]) -> dict[str, float | None]:
        """The objectives of the front; ``None`` where undefined or infinite."""
        names = self.front.objectives
        return {name: objectives[name] if np.isfinite(objectives[name]) else None for name in names}


def _file(member: Member) -> str:
    return f"{SENSORS}/{member.name}.json"


def _curves(sensor: Sensor) -> FrontCurves:
    return FrontCurves(
        wavelength_nm=sensor.grid.wavelength_nm.tolist(),
        names=list(sensor.names),
        qe=np.asarray(sensor.qe).tolist(),
    )


def _pixel_part(pixel: Pixel) -> PixelPart:
    known = {name: value for name, value in asdict(pixel).items() if name in PixelPart.model_fields}
    return PixelPart(**known)


def searched(
    task: Task,
    *,
    checkpoint: Path | None = None,
    resume: bool = False,
    evaluate_on: Scheduler | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Design:
    """Search the front of a design.

    Parameters
    ----------
    checkpoint, resume, evaluate_on, progress
        As `chromanoise.apps.design.searched_front`.

    Raises
    ------
    InputError
        As `chromanoise.apps.design.searched_front`.
    """
    design, problem = task.document.design, with_constraint_sizes(task)
    found = searched_front(
        problem,
        design.search,
        start=start_of(task.space.parameters),
        checkpoint=checkpoint,
        resume=resume,
        evaluate_on=evaluate_on,
        progress=progress,
    )
    front = front_of(
        problem,
        found.values,
        found.objectives,
        found.violation,
        most=design.members,
        sensor_of=lambda values, name: task.space.sensor(values, name=name),
    )
    return Design(task=task, front=front, result=found, beside=beside_of(task, front))


def read_design(path: Path | str) -> DesignStudy:
    """The design in a TOML file.

    Parameters
    ----------
    path
        The file; file names in it are relative to its folder.

    Returns
    -------
    DesignStudy
        With file names relative to the working folder.

    Raises
    ------
    InputError
        If the file cannot be read; all errors in it, one line each, with file, line and key.
    """
    refuse_absent_package("numba", "optimize", extra="compiled")
    path = Path(path)

    def placed(document: DesignStudy) -> DesignStudy:
        return _with_files_beside(beside_file(document, path), path)

    def unfit(document: DesignStudy) -> list[InputError]:
        document = placed(document)
        return unresolved(document) or impossible(document)

    text = document_text(path, "design")
    return placed(document_from_text(DesignStudy, text, source=str(path), unfit=unfit))


def _with_files_beside(document: DesignStudy, path: Path) -> DesignStudy:
    """The document with files of lights and dyes relative to the working folder."""
    if is_relative_to_working_folder(path):
        return document
    folder = path.parent
    scenes = tuple(
        part.model_copy(update={"illuminant": word_beside(part.illuminant, "light", folder)})
        if part.illuminant is not None
        else part
        for part in document.design.scenes
    )
    channels = tuple(_with_curves_beside(part, folder) for part in document.design.channels)
    front = document.design.ir_cut
    ir_cut = None if front is None else _with_curves_beside(front, folder)
    changes = {"scenes": scenes, "channels": channels, "ir_cut": ir_cut}
    return document.model_copy(update={"design": document.design.model_copy(update=changes)})


FilteredPart = TypeVar("FilteredPart", FilterPart, ChannelPart)


def _with_curves_beside(part: FilteredPart, folder: Path) -> FilteredPart:
    changes: dict[str, Any] = {
        "curves": tuple(word_beside(word, "filter", folder) for word in part.curves)
    }
    if isinstance(part, ChannelPart) and part.ir_cut is not None:
        changes["ir_cut"] = _with_curves_beside(part.ir_cut, folder)
    return part.model_copy(update=changes)


RECORD, CHECKPOINT = "design.json", "search.npz"
_MOST_RECORD_BYTES = 64 << 20
FRONT_JSON, FRONT_CSV, FRONT_SVG = "front.json", "front.csv", "front.svg"
_MEMBER = re.compile(r"best-.+|knee|member-[0-9]+")


def optimized(
    document: DesignStudy,
    folder: Path | None,
    *,
    resume: bool = False,
    given: Given = NOTHING_GIVEN,
    evaluate_on: Scheduler | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Design:
    """Search the front of a design, and write it into a folder.

    Parameters
    ----------
    folder
        For the outputs and the checkpoint of the search; ``None`` writes nothing.
    resume
        Whether to continue the stopped search in the folder.
    given, evaluate_on, progress
        As `searched`.

    Raises
    ------
    InputError
        As `searched`, or if the folder cannot be written or holds another design.
    """
    if folder is None:
        if resume:
            raise InputError("resume", "must be given with the folder of the stopped search")
        return searched(task_of(document, given), evaluate_on=evaluate_on, progress=progress)
    refuse_unwritable(folder)
    task = task_of(document, given)
    _refuse_other_design(folder, task.identity)
    if resume and not (folder / CHECKPOINT).exists():
        raise InputError(
            str(folder),
            "must hold a stopped search to resume",
            found=f"has no {CHECKPOINT}",
            remedy="omit resume",
        )
    with claimed_folder(folder, "optimize") as claimed:
        claimed.refuse_taken([FRONT_JSON, FRONT_CSV, FRONT_SVG, *_members_in(folder)])
        if not (folder / RECORD).exists():
            record = {
                "version": __version__,
                "identity": task.identity,
                "design": study_as_json(document),
            }
            with claimed.scratch() as scratch:
                text = f"{json.dumps(record, indent=1)}\n"
                (scratch / RECORD).write_text(text, encoding="utf-8")
        claimed.keep(CHECKPOINT, adopted=resume)
        design = searched(
            task,
            checkpoint=folder / CHECKPOINT,
            resume=resume,
            evaluate_on=evaluate_on,
            progress=progress,
        )
        with claimed.scratch(outdated=f"{SENSORS}/*.json") as scratch:
            _write_design(design, scratch)
    return design


def _write_design(design: Design, folder: Path) -> None:
    (folder / SENSORS).mkdir()
    for one in design.members:
        text = sensor_json(one.sensor)
        (folder / SENSORS / f"{one.name}.json").write_text(text, encoding="utf-8")
    csv = table_writer(Path(FRONT_CSV))(design.to_table())
    (folder / FRONT_CSV).write_text(csv, encoding="utf-8")
    drawn = {Path(FRONT_SVG).stem: from_above("design").front_figure(design.to_file())}
    figures().write_figures(drawn, folder, endings=("svg",))
    (folder / FRONT_JSON).write_text(design.to_file().as_json(), encoding="utf-8")


def _members_in(folder: Path) -> list[str]:
    """Files of the folder with names that a member of a front may have."""
    files = (folder / SENSORS).glob("*.json")
    return [f"{SENSORS}/{file.name}" for file in files if _MEMBER.fullmatch(file.stem)]


def _refuse_other_design(folder: Path, identity: str) -> None:
    file = folder / RECORD
    before = None
    if file.exists():
        with suppress(InputError):
            record = json_file(file, most_bytes=_MOST_RECORD_BYTES)
            before = record.get("identity") if isinstance(record, dict) else None
    elif not (folder / FRONT_JSON).exists():
        return
    if before != identity:
        raise InputError(
            str(folder),
            "must not hold another design",
            value=str(folder),
            found="holds results of another design, another version or other files",
            remedy=("choose another folder", "remove it"),
        )
