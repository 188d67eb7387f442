"""A run of a study, step by step, with its pictures.

The settings and cameras of the pictures are prepared before the computation.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from chromanoise.base import InputError, claimed_folder, dataclass, frozen
from chromanoise.imaging import (
    Camera,
    Capture,
    CaptureSettings,
    Work,
    camera_for,
    capture_summary,
    write_capture,
)
from chromanoise.imaging.denoising import captured_with, denoising_named
from chromanoise.metrics import matrix_report
from chromanoise.noise import OperatingPoint, expected_electrons, white_scene
from chromanoise.sensor import PIXEL_NOISE, PixelOverrides, mosaic_named
from chromanoise.spectra import Cube, Illuminant, Spectra, row_source
from chromanoise.study.assembly import (
    NOTHING_GIVEN,
    Given,
    balance_light_of,
    cube_of,
    keyed,
    makers_of,
    operating_points_of,
    prior_of,
    values_of_sweep,
)
from chromanoise.study.color_matrices import MatrixMaker
from chromanoise.study.color_noise import noise_weights, pareto_of
from chromanoise.study.equal_color_sweeps import equal_color_ranges
from chromanoise.study.maps import mapped
from chromanoise.study.ranking import (
    CrossoverBand,
    crossover_bands,
    crossovers,
    leads,
    optima,
    ranking,
)
from chromanoise.study.reading import file_word, refuse_shared_file_names
from chromanoise.study.resolve_names import shown_word
from chromanoise.study.results import (
    Analyses,
    Comparison,
    ComparisonMap,
    Matrices,
    MatrixResult,
    Outcome,
    Pictures,
    Results,
    outcome_of,
)
from chromanoise.study.schema import PicturePart, Study
from chromanoise.study.sweeps import QUANTITIES, SWEEPS, compared


def capture_settings_of(
    part: PicturePart, *, seed: int, key: str = "pictures.0"
) -> CaptureSettings:
    """What a part of a study asks of its pictures.

    Parameters
    ----------
    seed
        Of all noise that is drawn.
    key
        Of the part, for errors.

    Raises
    ------
    InputError
        If a mosaic or a format is unknown, or a format is of what is not made.
    """
    mosaic = None
    if part.mosaic is not None and part.mosaic != "sensor":
        with keyed(f"{key}.mosaic"):
            mosaic = mosaic_named(part.mosaic)
    return CaptureSettings(
        mosaic=mosaic,
        raw=part.mosaic is not None,
        demosaic=None if part.raw_only else part.demosaic or "bilinear",
        pixel=PixelOverrides(
            bits=part.bits,
            black_level_dn=part.black_level,
            **{name: getattr(part, name) for name in PIXEL_NOISE},
        ),
        seed=seed,
        clip=part.clip,
        beyond=part.beyond,
        bad_pixels=part.bad_pixels,
        formats=part.formats,
    )


def prepared_cameras(
    study: Study,
    number: int,
    operating_points: list[OperatingPoint],
    makers: Mapping[str, MatrixMaker],
    given: Given = NOTHING_GIVEN,
) -> tuple[Cube, dict[str, list[Camera]]]:
    """The cube, and the cameras of each matrix, of a part of the pictures (from 0).

    Parameters
    ----------
    number
        Which part, from 0.
    operating_points
        Operating points of the sensors.
    makers
        Methods of color matrices by name.
    given
        Objects in place of names.

    Raises
    ------
    InputError
        If the cube cannot be read, or as ``capture_settings_of`` and ``camera_for``.
    """
    refuse_shared_file_names(operating_points, makers)
    part, key = study.pictures[number], f"pictures.{number}"
    cube = cube_of(part, key=key, given=given)
    with _keyed(key):
        if part.denoise is not None:
            denoising_named(part.denoise)  # refused here if its package is absent
        settings = capture_settings_of(part, seed=study.seed, key=key)
        return cube, {
            name: [camera_for(cube, each, maker(each), settings) for each in operating_points]
            for name, maker in makers.items()
        }


def _keyed(key: str) -> AbstractContextManager[None]:
    """An error inside names the keys of a part of the pictures."""
    own = {name: f"{key}.{name}" for name in PicturePart.model_fields}
    own |= {"black_level_dn": f"{key}.black_level", "names of formats": f"{key}.formats"}
    own |= {"binning_mode": "sensors.0.pixel.binning_mode"}
    return keyed(key, lambda name: own.get(name, name), own)


@dataclass(frozen=True, kw_only=True, eq=False)
class TakenPicture:
    """One picture of a study.

    Attributes
    ----------
    matrix
        Name of its color matrix.
    capture
        Its codes, its color, or both.
    stem
        Name of its files without their endings.
    files, not_written
        Names of the files that were written, and notes on those that could not be.
    """

    matrix: str
    capture: Capture
    stem: str
    files: list[str]
    not_written: list[str]

    @property
    def record(self) -> dict[str, Any]:
        """The picture as plain data: its matrix, settings, statistics and files."""
        data = {"matrix": self.matrix} | capture_summary(self.capture, self.files)
        return data | {"not_written": self.not_written}


def taken_pictures(
    study: Study,
    number: int,
    cube: Cube,
    cameras: Mapping[str, list[Camera]],
    *,
    work: Work,
    folder: Path | None = None,
    stem: str = "picture-{number}-{sensor}-{matrix}",
    frames: int | None = None,
) -> Iterator[TakenPicture]:
    """Each picture of a part (from 0) as soon as it is taken and, if a folder is given, written.

    Parameters
    ----------
    study, number, cube, cameras
        The study, the part, and the result of `prepared_cameras` for it.
    work
        Threads or executor for the computation.
    folder
        Folder for the files; ``None`` to write none.
    stem
        Names of the files; the frame is added where the part has several.
    frames
        Number of frames, the first ones; ``None`` for those of the part.

    Raises
    ------
    InputError
        If the cube holds what is no reflectance, or a file cannot be written.
    """
    part = study.pictures[number]
    first = sum(one.frames for one in study.pictures[:number])  # no two parts share their noise
    work = replace(work, folder=folder)
    method = None if part.denoise is None else denoising_named(part.denoise)
    for i in range(len(study.sensors)):
        for name, own in cameras.items():
            sensor = file_word(own[i].operating_point.sensor.name)
            start = stem.format(number=number + 1, sensor=sensor, matrix=file_word(name))
            for frame in range(part.frames if frames is None else frames):
                with _keyed(f"pictures.{number}"):
                    capture = captured_with(cube, own[i], method, frame=first + frame, work=work)
                full = start + (f"-{frame:04d}" if part.frames > 1 else "")
                files, missing = write_capture(folder, full, capture) if folder else ([], [])
                yield TakenPicture(
                    matrix=name, capture=capture, stem=full, files=files, not_written=missing
                )
                del capture  # before the next one needs memory


Makers = Mapping[str, MatrixMaker]
Points = list[OperatingPoint]
StepResult = Analyses | Matrices | Comparison | ComparisonMap | Pictures
Advance = Callable[[int], None]


@dataclass(frozen=True, kw_only=True)
class Step:
    """One part of a run.

    Attributes
    ----------
    name
        Name of its output file without suffix.
    parts
        Number of its parts.
    unit
        Name of the parts in the plural.
    run
        Function that runs the step. It writes pictures to the given folder (``None``: keeps them in
        memory), calls the given function with the number of newly finished parts, and returns the
        result.
    kind
        Class of the result.
    quantity
        Name of the quantity that is compared; empty for other steps.
    """

    name: str
    what: str
    parts: int
    unit: str
    run: Callable[[Path | None, Advance], StepResult]
    kind: type[StepResult]
    quantity: str = ""


Progress = Callable[[Step], AbstractContextManager[Advance]]
"""For a step, a context that yields a function to call with the number of finished parts."""


def no_progress(_: Step) -> AbstractContextManager[Advance]:
    """Do not report progress."""
    return nullcontext(lambda _: None)


@dataclass(frozen=True, kw_only=True, eq=False)
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
    work: Work | None = None,
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


def run_plan(study: Study, *, given: Given = NOTHING_GIVEN, work: Work | None = None) -> RunPlan:
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
    points, makers = operating_points_of(study, given), makers_of(study, given)
    refuse_shared_file_names(points, makers)
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
        *(_sweep(study, points, makers, number, given) for number in range(len(study.sweeps))),
    )


def _analysis(
    study: Study, points: Points, name: str, maker: MatrixMaker, balance_light: Illuminant | None
) -> Step:
    def outcome(point: OperatingPoint) -> Outcome:
        return outcome_of(point, maker, study.outputs, balance_light=balance_light)

    def run(folder: Path | None, advance: Advance) -> Analyses:
        return Analyses(
            matrix=name,
            points=tuple(points),
            outcomes=_of_each(points, outcome, advance),
            outputs=study.outputs,
            prior=maker.prior,
            equal=study.exposure.equal,
        )

    return Step(
        name=f"analysis-{file_word(name)}",
        what=f"every stage with the {name} matrix",
        parts=len(points),
        unit="sensors",
        run=run,
        kind=Analyses,
    )


def _of_each(
    points: Points, result: Callable[[OperatingPoint], Any], advance: Advance
) -> tuple[Any, ...]:
    """The result of each point; progress is reported after each."""
    results = []
    for point in points:
        results.append(result(point))
        advance(1)
    return tuple(results)


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
        prior = prior_of(study, given)
        results = _of_each(points, lambda point: result(point, prior), advance)
        return Matrices(method=name, results=results)

    return Step(
        name=f"matrix-{file_word(name)}",
        what=f"the {name} matrix of every sensor",
        parts=len(points),
        unit="sensors",
        run=run,
        kind=Matrices,
    )


def _sweep(study: Study, points: Points, makers: Makers, number: int, given: Given) -> Step:
    part = study.sweeps[number]
    sweep, quantity = SWEEPS[part.vary], QUANTITIES[part.quantity]
    values = values_of_sweep(part, f"sweeps.{number}")

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
            optima=optima(points, makers, curves),
            equal_color=()
            if quantity.of_raw
            else equal_color_ranges(points, sweep, curves[0].at, prior=prior_of(study, given)),
            equal=study.exposure.equal,
            prior=study.prior,
        )

    def grid(folder: Path | None, advance: Advance) -> ComparisonMap:
        return sweep_map(study, points, makers, number, progress=advance)

    varied, over, count = part.vary, sweep.what, len(values)
    if part.second is not None:
        varied = f"{varied}-{part.second.vary}"
        over = f"{over} and {SWEEPS[part.second.vary].what}"
        count *= len(values_of_sweep(part.second, f"sweeps.{number}.second"))
    return Step(
        name=f"sweep-{number + 1}-{varied}-{part.quantity}",
        what=f"{quantity.what} over {over}",
        parts=len(points) * len(makers) * count,
        unit="values",
        run=curves if part.second is None else grid,
        kind=Comparison if part.second is None else ComparisonMap,
        quantity=part.quantity,
    )


def _pictures(
    study: Study, points: Points, makers: Makers, work: Work | None, given: Given
) -> Iterator[Step]:
    for i, part in enumerate(study.pictures):
        cube, cameras = prepared_cameras(study, i, points, makers, given)
        yield Step(
            name=f"pictures-{i + 1}",
            what=f"{shown_word(part.cube)} through every sensor",
            parts=row_source(cube.stored).shape[0] * part.frames * sum(map(len, cameras.values())),
            unit="rows",
            run=partial(_taken, study, i, cube, cameras, work or Work()),
            kind=Pictures,
        )


def _taken(
    study: Study,
    number: int,
    cube: Cube,
    cameras: Mapping[str, list[Camera]],
    work: Work,
    folder: Path | None,
    advance: Advance,
) -> Pictures:
    """All pictures of a part (from 0), in memory, or summaries of those that were written."""
    work = replace(work, progress=advance)
    summaries, kept = [], []
    points: dict[str, OperatingPoint] = {}
    for one in taken_pictures(study, number, cube, cameras, work=work, folder=folder):
        point = one.capture.camera.operating_point
        points[point.sensor.name] = point
        summaries.append(one.record)
        if folder is None:
            kept.append(one.capture)
        del one  # before the next one needs memory
    return Pictures(
        cube=shown_word(study.pictures[number].cube),
        points=tuple(points.values()),
        summaries=tuple(summaries),
        captures=tuple(kept),
    )


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
    values = values_of_sweep(part, f"sweeps.{number}")
    rows = values_of_sweep(part.second, f"sweeps.{number}.second")
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
