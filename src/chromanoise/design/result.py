"""The result of a design: its front as data, table and figure."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from chromanoise.design.front import Front, Member
from chromanoise.design.front_file import (
    FrontConvergence,
    FrontCurves,
    FrontFile,
    FrontMember,
    FrontMilestone,
    FrontObjective,
    FrontReference,
    FrontScene,
    FrontSeed,
)
from chromanoise.design.objectives import OBJECTIVES, Objective
from chromanoise.design.optimizing import Reference, Search, Task
from chromanoise.design.parameters import Parameter
from chromanoise.design.scenes import DesignScene
from chromanoise.design.sentences import (
    best_of,
    convergence_sentences,
    front_sentences,
    has_converged,
    held_by,
    spread_of,
    tolerance_sentence,
    tolerances_sentence,
)
from chromanoise.errors import InputError
from chromanoise.exposure import conditions
from chromanoise.io.result import Result, axes_of, figures
from chromanoise.io.table import Column, Table
from chromanoise.sensor import Pixel, Sensor
from chromanoise.study import Study, study_as_command
from chromanoise.study.document import ExposurePart, LightPart, PixelPart

SENSORS = "sensors"
"""Folder of the members' files, beside ``front.json``."""
_KEPT = ("metric", "observer", "prior", "reflectances")  # keys that a member's study takes over


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Design(Result):
    """The front of a design: sensors of which none is better than another in all objectives.

    Attributes
    ----------
    search
        What was searched, and the front with its sensors.
    """

    search: Search

    @property
    def task(self) -> Task:
        """What was searched."""
        return self.search.task

    @property
    def front(self) -> Front:
        """The members, the best in the first objective first."""
        return self.search.front

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
        sentences += [
            f"{one.name} is not compared: it saturates or has an undefined objective."
            for one in self.references
            if one.name not in references
        ]
        if self.search.beside:
            sentences += [
                tolerance_sentence(one, beside, self.beside_name)
                for one, beside in zip(self.members, self._beside, strict=True)
                if one.extreme_of or one.knee
            ]
            sentences.append(tolerances_sentence(self.members, self._beside, self.beside_name))
        else:
            sentences.append(
                "The design has no tolerances, so the extremes hold for exact parameters only."
            )
        sentences += convergence_sentences(self.search.result, names)
        return tuple(sentences)

    @property
    def beside_name(self) -> str:
        """What `Search.beside` holds: ``nominal`` or ``robust`` objectives."""
        return "robust" if self.task.draws is None else "nominal"

    @property
    def _beside(self) -> tuple[Mapping[str, float], ...]:
        return self.search.beside or ({},) * len(self.members)

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
        result, names = self.search.result, self.front.objectives
        own = result.convergence

        def named(values: Any) -> dict[str, float | None]:
            return self._finite(dict(zip(names, np.asarray(values).tolist(), strict=True)))

        spreads = [
            spread_of(OBJECTIVES[name], best)
            for name, best in zip(names, own.best.T.tolist(), strict=True)
        ]
        return FrontConvergence(
            converged=has_converged(result, names),
            evaluations=result.evaluations,
            gradients=result.gradient_evaluations,
            undefined=result.undefined,
            seeds=[
                FrontSeed(seed=seed, best=named(best))
                for seed, best in zip(own.seeds, own.best, strict=True)
            ],
            spread=named(spreads),
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
        objectives: list[Objective | Parameter] = [
            OBJECTIVES[name] for name in self.front.objectives
        ]
        beside_names = self.front.objectives if self.search.beside else ()
        columns = [
            Column(name="sensor"),
            *(
                Column(name=one.name, unit="" if one.unit == "1" else one.unit, digits=".4g")
                for one in [*objectives, *parameters]
            ),
            *(Column(name=f"{name}_{self.beside_name}", digits=".4g") for name in beside_names),
            Column(name="extreme of"),
            Column(name="held by"),
        ]
        rows: list[tuple[Any, ...]] = []
        for reference in self.references:
            found = self._finite(dict(reference.objectives))
            empty = len(parameters) + len(beside_names)
            rows.append((reference.name, *found.values(), *[None] * empty, "", ""))
        for one, beside in zip(self.members, self._beside, strict=True):
            marks = [*one.extreme_of, *(["knee"] if one.knee else [])]
            rows.append(
                (
                    one.name,
                    *self._finite(dict(one.objectives)).values(),
                    *np.asarray(one.values).tolist(),
                    *(self._finite(dict(beside)).values() if beside else ()),
                    ", ".join(marks),
                    ", ".join(held_by(one, parameters)),
                )
            )
        scene = conditions([self.task.scenes[0].point])
        return Table(
            title=f"Front of a design at {scene}", columns=tuple(columns), rows=tuple(rows)
        )

    def plot(self, ax: Any = None) -> Any:
        """Draw the second objective against the first: members and references."""
        return figures().draw_front(self.to_file(), axes_of(ax))

    def __repr__(self) -> str:
        """Number of members and the operating point."""
        scene = conditions([self.task.scenes[0].point])
        return f"<Design: front of {len(self.members)} sensors at {scene}>"

    def _repr_html_(self) -> str:
        return self._html(f"At {conditions([self.task.scenes[0].point])}", self.sentences)

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
