"""Run a study step by step and return its results."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chromanoise._check import frozen
from chromanoise._files import claimed_folder
from chromanoise.analysis.color_matrices import MatrixMaker
from chromanoise.analysis.comparison.bands import CrossoverBand, crossover_bands
from chromanoise.analysis.comparison.crossing import crossovers
from chromanoise.analysis.comparison.curves import compared
from chromanoise.analysis.comparison.maps import mapped
from chromanoise.analysis.comparison.quantities import QUANTITIES
from chromanoise.analysis.comparison.ranking import leads, ranking
from chromanoise.analysis.comparison.sweeps import SWEEPS, swept_values
from chromanoise.analysis.pareto import noise_weights, pareto_of
from chromanoise.catalog.objects import shown_word
from chromanoise.errors import InputError
from chromanoise.exposure import OperatingPoint, expected_electrons, white_scene
from chromanoise.metrics import matrix_report
from chromanoise.scene import Cube
from chromanoise.scene.rows import row_source
from chromanoise.spectra import Illuminant, Spectra
from chromanoise.study.analyses import outcome_of
from chromanoise.study.assembly import (
    NOTHING_GIVEN,
    Given,
    balance_light_of,
    keyed,
    makers_of,
    operating_points_of,
    prior_of,
)
from chromanoise.study.document import SecondSweepPart, Study, SweepPart
from chromanoise.study.file_names import file_word, refuse_shared_file_names
from chromanoise.study.results import (
    Analyses,
    Comparison,
    ComparisonMap,
    Matrices,
    MatrixResult,
    Pictures,
    Results,
)

if TYPE_CHECKING:
    from chromanoise.imaging import Work
    from chromanoise.imaging.capture import Camera

Makers = Mapping[str, MatrixMaker]
Points = list[OperatingPoint]
StepResult = Analyses | Matrices | Comparison | ComparisonMap | Pictures
Advance = Callable[[int], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One part of a run.

    Attributes
    ----------
    name
        Name of its output file without suffix.
    what
        Description.
    parts
        Number of its parts.
    unit
        Name of the parts in the plural.
    run
        Function that runs the step. It writes pictures to the given folder (``None``: keeps them in
        memory), calls the given function with the number of newly finished parts, and returns the
        result.
    """

    name: str
    what: str
    parts: int
    unit: str
    run: Callable[[Path | None, Advance], StepResult]


Progress = Callable[[Step], AbstractContextManager[Advance]]
"""For a step, a context that yields a function to call with the number of finished parts."""


def no_progress(_: Step) -> AbstractContextManager[Advance]:
    """Do not report progress."""
    return nullcontext(lambda _: None)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RunPlan:
    """A study whose names are resolved but whose steps are not yet computed.

    Attributes
    ----------
    points
        Each sensor in its light, with its exposure.
    steps
        All steps of the study, in order.
    """

    points: tuple[OperatingPoint, ...]
    steps: tuple[Step, ...]


def run(
    study: Study,
    *,
    given: Given = NOTHING_GIVEN,
    work: "Work | None" = None,
    progress: Progress = no_progress,
    folder: Path | None = None,
) -> Results:
    """Run a study and return all its results.

    Parameters
    ----------
    study
        From `read_study`, or built in Python.
    given
        Objects for names in the study that are not looked up in the catalog or as files.
    work
        Threads and tiles for rendering pictures.
    progress
        Called for each step, to report its finished parts.
    folder
        Folder for pictures; ``None`` keeps them in memory.

    Raises
    ------
    InputError
        If a name is unknown, a file cannot be read, a result cannot be computed, or a picture would
        replace a file that this function did not write.
    """
    plan = run_plan(study, given=given, work=work)
    done: dict[str, StepResult] = {}
    claim = nullcontext() if folder is None else claimed_folder(folder, "render")
    with claim as claimed:
        for step in plan.steps:
            there = nullcontext() if claimed is None else claimed.scratch()
            with there as scratch, progress(step) as advance:
                done[step.name] = step.run(scratch, advance)
    return Results(study=study, points=plan.points, steps=done)


def run_plan(study: Study, *, given: Given = NOTHING_GIVEN, work: "Work | None" = None) -> RunPlan:
    """The study with its names resolved and its steps in order.

    Parameters
    ----------
    study, given, work
        As `run`.

    Raises
    ------
    InputError
        If a name is unknown or a file cannot be read; raised before any computation.
    """
    points = operating_points_of(study, given)
    refuse_shared_file_names(points)
    makers = makers_of(study, given)
    steps = (
        *result_steps(study, points, makers, given=given),
        *_pictures(study, points, makers, work, given),
    )
    if not steps:
        raise InputError(
            "the study", "must ask for analyses, matrices, sweeps or pictures", found="has none"
        )
    return RunPlan(points=tuple(points), steps=steps)


def result_steps(
    study: Study, points: Points, makers: Makers, *, given: Given = NOTHING_GIVEN
) -> tuple[Step, ...]:
    """All steps of a study but its pictures: analyses, matrices, sweeps.

    Parameters
    ----------
    study, given
        As `run`.
    points, makers
        Its operating points and color matrices.

    Raises
    ------
    InputError
        If a name is unknown or a file cannot be read.
    """
    out, named = study.outputs, list(makers.items())
    balance = balance_light_of(study, given)
    with keyed("outputs.pareto"):
        pareto = out.pareto
        weights = noise_weights(pareto.first, pareto.last, points=pareto.points) if pareto else None
    return (
        *(_analysis(study, points, *one, balance) for one in named if out.analyses),
        *(_matrix(study, points, *one, weights, given) for one in named if out.matrix),
        *(_sweep(study, points, makers, number) for number in range(len(study.sweeps))),
    )


def _analysis(
    study: Study, points: Points, name: str, maker: MatrixMaker, balance_light: Illuminant | None
) -> Step:
    def run(folder: Path | None, advance: Advance) -> Analyses:
        outcomes = []
        for point in points:
            outcomes.append(outcome_of(point, maker, study.outputs, balance_light=balance_light))
            advance(1)
        return Analyses(
            matrix=name, points=tuple(points), outcomes=tuple(outcomes), outputs=study.outputs
        )

    return Step(
        name=f"analysis-{file_word(name)}",
        what=f"every stage with the {name} matrix",
        parts=len(points),
        unit="sensors",
        run=run,
    )


def _matrix(
    study: Study, points: Points, name: str, maker: MatrixMaker, weights: Any, given: Given
) -> Step:
    def result(point: OperatingPoint, prior: str | Spectra) -> MatrixResult:
        made = maker(point)
        report = matrix_report(
            made,
            point.sensor,
            point.exposure,
            point.illuminant,
            level_lux=point.level_lux,
            chart=point.chart,
            patch=point.patch,
        )
        curve = None if weights is None else pareto_of(point, weights, prior=prior)
        white_e = frozen(expected_electrons(white_scene(point), point.sensor, point.exposure))
        return MatrixResult(point=point, matrix=made, report=report, white_e=white_e, pareto=curve)

    def run(folder: Path | None, advance: Advance) -> Matrices:
        results = []
        prior = prior_of(study, given)
        for point in points:
            results.append(result(point, prior))
            advance(1)
        return Matrices(method=name, results=tuple(results))

    return Step(
        name=f"matrix-{file_word(name)}",
        what=f"the {name} matrix of every sensor",
        parts=len(points),
        unit="sensors",
        run=run,
    )


def _sweep(study: Study, points: Points, makers: Makers, number: int) -> Step:
    part = study.sweeps[number]
    sweep, quantity = SWEEPS[part.vary], QUANTITIES[part.quantity]
    values = _values(part, f"sweeps.{number}")

    def curves(folder: Path | None, advance: Advance) -> Comparison:
        curves = compared(points, makers, values, sweep=sweep, quantity=quantity, progress=advance)
        bands: tuple[CrossoverBand, ...] = ()
        if part.all_priors:
            bands = crossover_bands(
                points,
                study.matrices,
                values,
                metric=study.metric,  # type: ignore[arg-type]
                sweep=sweep,
                quantity=quantity,
            )
        crossed = crossovers(points, makers, curves)
        return Comparison(
            points=tuple(points),
            curves=tuple(curves),
            crossovers=crossed,
            bands=bands,
            ranking=ranking(points, makers, quantity),
            leads=leads(curves, crossed),
            equal=study.exposure.equal,
            prior=study.prior,
        )

    def map_(folder: Path | None, advance: Advance) -> ComparisonMap:
        return sweep_map(study, points, makers, number, progress=advance)

    varied, over, count = part.vary, sweep.what, len(values)
    if part.second is not None:
        varied = f"{varied}-{part.second.vary}"
        over = f"{over} and {SWEEPS[part.second.vary].what}"
        count *= len(_values(part.second, f"sweeps.{number}.second"))
    return Step(
        name=f"sweep-{number + 1}-{varied}-{part.quantity}",
        what=f"{quantity.what} over {over}",
        parts=len(points) * len(makers) * count,
        unit="values",
        run=curves if part.second is None else map_,
    )


def _pictures(
    study: Study, points: Points, makers: Makers, work: "Work | None", given: Given
) -> Iterator[Step]:
    if not study.pictures:
        return
    from chromanoise.imaging import Work  # an analysis starts without the imaging packages
    from chromanoise.study.pictures import prepared_cameras

    for i, part in enumerate(study.pictures):
        cube, cameras = prepared_cameras(study, i, points, makers, given)
        yield Step(
            name=f"pictures-{i + 1}",
            what=f"{shown_word(part.cube)} through every sensor",
            parts=row_source(cube.stored).shape[0] * part.frames * sum(map(len, cameras.values())),
            unit="rows",
            run=_taken(study, i, cube, cameras, work or Work()),
        )


def _taken(
    study: Study, number: int, cube: Cube, cameras: "dict[str, list[Camera]]", work: "Work"
) -> Callable[[Path | None, Advance], Pictures]:
    from chromanoise.study.pictures import pictures_taken

    def run(folder: Path | None, advance: Advance) -> Pictures:
        threads = replace(work, progress=advance)
        return pictures_taken(study, number, cube, cameras, work=threads, folder=folder)

    return run


def _values(part: SweepPart | SecondSweepPart, key: str) -> Any:
    """The values of one parameter; an error names its key."""
    with keyed(f"{key}.vary"):
        try:
            return swept_values(SWEEPS[part.vary], part.first, part.last, part.points)
        except InputError as error:
            raise error.within("vary") from None


def sweep_map(
    study: Study,
    points: Sequence[OperatingPoint],
    makers: Makers,
    number: int,
    *,
    progress: Advance = lambda _: None,
) -> ComparisonMap:
    """A sweep of two parameters.

    Parameters
    ----------
    study
        Of which the sweep is used.
    points, makers
        Its operating points and color matrices.
    number
        Place of the sweep in the study, from 0; it has a second parameter.
    progress
        Called with the number of newly finished values.

    Raises
    ------
    InputError
        If a value cannot be used.
    """
    part = study.sweeps[number]
    assert part.second is not None  # see ``number``
    values = _values(part, f"sweeps.{number}")
    rows = _values(part.second, f"sweeps.{number}.second")
    quantity = QUANTITIES[part.quantity]
    maps, lines = mapped(
        points,
        makers,
        values,
        rows,
        sweep=SWEEPS[part.vary],
        second=SWEEPS[part.second.vary],
        quantity=quantity,
        progress=progress,
    )
    return ComparisonMap(
        points=tuple(points),
        maps=maps,
        lines=lines,
        ranking=ranking(points, makers, quantity),
        equal=study.exposure.equal,
        prior=study.prior,
    )
