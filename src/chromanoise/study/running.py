"""A study, run step by step: each step's result is plain data of its own."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from chromanoise._check import distinct
from chromanoise.analysis.color_matrices import MatrixMaker, matrix_makers
from chromanoise.analysis.comparison.bands import bands_as_json, crossover_bands
from chromanoise.analysis.comparison.crossing import crossovers
from chromanoise.analysis.comparison.curves import compared
from chromanoise.analysis.comparison.quantities import QUANTITIES
from chromanoise.analysis.comparison.sweeps import SWEEPS, swept_values
from chromanoise.analysis.export import comparison_as_json
from chromanoise.analysis.pareto import matrix_as_json, noise_weights, pareto_of
from chromanoise.errors import InputError
from chromanoise.exposure import Situation
from chromanoise.imaging import Work
from chromanoise.metrics import matrix_report
from chromanoise.scene.rows import row_source
from chromanoise.study.analyses import outcome_of, outcomes_as_json
from chromanoise.study.assembly import situations_of, twins
from chromanoise.study.document import Study, SweepPart
from chromanoise.study.pictures import file_word, pictures_taken, prepared_cameras

Makers = Mapping[str, MatrixMaker]
Result = dict[str, Any]
Advance = Callable[[int], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One part of a run.

    Attributes
    ----------
    name
        Of its file, without ending.
    what
        In words.
    parts
        Number of its parts.
    unit
        What the parts are, in the plural.
    run
        Runs the step: writes pictures into the given folder, calls the given function with the
        number of newly finished parts, and returns plain data.
    """

    name: str
    what: str
    parts: int
    unit: str
    run: Callable[[Path, Advance], Result]


def study_steps(study: Study, *, work: Work | None = None) -> list[Step]:
    """All that a study asks for, in order: analysis per matrix, sweeps, pictures.

    Raises
    ------
    InputError
        If a name names nothing or a file cannot be read; before anything is computed.
    """
    for key, why in twins(study):
        raise InputError(f"{'.'.join(map(str, key))}: {why}")
    situations = situations_of(study)
    distinct("file names of sensors", [file_word(s.sensor.name) for s in situations])
    makers = matrix_makers(study.matrices, study.metric, prior=study.prior)  # type: ignore[arg-type]
    steps = [
        *_analyses(study, situations, makers),
        *_matrices(study, situations, makers),
        *_sweeps(study, situations, makers),
        *_pictures(study, situations, makers, work or Work()),
    ]
    if not steps:
        raise InputError("the study asks for nothing: no analyses, matrices, sweeps or pictures")
    return steps


def _analyses(study: Study, situations: list[Situation], makers: Makers) -> Iterator[Step]:
    for name in makers if study.outputs.analyses else ():
        yield Step(
            name=f"analysis-{file_word(name)}",
            what=f"every stage with the {name} matrix",
            parts=len(situations),
            unit="sensors",
            run=partial(_analysis, study, situations, makers[name]),
        )


def _matrices(study: Study, situations: list[Situation], makers: Makers) -> Iterator[Step]:
    asked = study.outputs.pareto
    weights = noise_weights(asked.first, asked.last, points=asked.points) if asked else None
    for name in makers if study.outputs.matrix else ():
        yield Step(
            name=f"matrix-{file_word(name)}",
            what=f"the {name} matrix of every sensor",
            parts=len(situations),
            unit="sensors",
            run=partial(_matrix, study, situations, makers[name], weights),
        )


def _sweeps(study: Study, situations: list[Situation], makers: Makers) -> Iterator[Step]:
    for i, part in enumerate(study.sweeps, 1):
        values = swept_values(SWEEPS[part.vary], part.first, part.last, part.points)
        yield Step(
            name=f"sweep-{i}-{part.vary}-{part.quantity}",
            what=f"{QUANTITIES[part.quantity].what} over {SWEEPS[part.vary].what}",
            parts=len(situations) * len(makers) * len(values),
            unit="values",
            run=partial(_sweep, study, situations, makers, part, values),
        )


def _pictures(
    study: Study, situations: list[Situation], makers: Makers, work: Work
) -> Iterator[Step]:
    for i, part in enumerate(study.pictures, 1):
        cube, cameras = prepared_cameras(study, part, situations, makers)
        yield Step(
            name=f"pictures-{i}",
            what=f"{part.cube} through every sensor",
            parts=row_source(cube.stored).shape[0] * part.frames * sum(map(len, cameras.values())),
            unit="rows",
            run=partial(_taken, study, i, cube, cameras, work),
        )


def _taken(
    study: Study,
    number: int,
    cube: Any,
    cameras: Any,
    work: Work,
    folder: Path,
    advance: Advance,
) -> Result:
    work = replace(work, progress=advance)
    return pictures_taken(study, number, cube, cameras, work=work, folder=folder)


def _analysis(
    study: Study, situations: list[Situation], maker: MatrixMaker, folder: Path, advance: Advance
) -> Result:
    outcomes = []
    for situation in situations:
        outcomes.append(outcome_of(situation, maker, study.outputs))
        advance(1)
    return outcomes_as_json(outcomes, study.outputs)


def _matrix(
    study: Study,
    situations: list[Situation],
    maker: MatrixMaker,
    weights: Any,
    folder: Path,
    advance: Advance,
) -> Result:
    told = []
    for situation in situations:
        sensor, exposure, lamp = situation.sensor, situation.exposure, situation.illuminant
        made = maker(situation)
        report = matrix_report(made, sensor, exposure, lamp, level_lux=situation.level_lux)
        curve = None if weights is None else pareto_of(situation, weights, prior=study.prior)
        told.append(matrix_as_json(situation, made, report, curve))
        advance(1)
    return {"sensors": told}


def _sweep(
    study: Study,
    situations: list[Situation],
    makers: Makers,
    part: SweepPart,
    values: Any,
    folder: Path,
    advance: Advance,
) -> Result:
    sweep, quantity = SWEEPS[part.vary], QUANTITIES[part.quantity]
    curves = compared(situations, makers, values, sweep=sweep, quantity=quantity, progress=advance)
    told = comparison_as_json(curves, crossovers(situations, makers, curves))
    told["bands"] = []
    if part.all_priors:
        bands = crossover_bands(
            situations,
            study.matrices,
            values,
            metric=study.metric,  # type: ignore[arg-type]
            sweep=sweep,
            quantity=quantity,
        )
        told["bands"] = bands_as_json(bands)
    return told
