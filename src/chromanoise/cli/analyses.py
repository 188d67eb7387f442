"""The commands ``chromanoise analyze``, ``compare`` and ``matrix``.

Functions here also print the messages and the progress of a study.
"""

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import click

from chromanoise.base import InputError
from chromanoise.charts import machine_tables, outcome_tables, pareto_table
from chromanoise.cli import terminal_tables
from chromanoise.cli.options import (
    RenamedOption,
    command,
    copy_option,
    matrix_option,
    notes_option,
    own_option,
    table_option,
    with_settings,
)
from chromanoise.cli.output import (
    as_json,
    as_table,
    fail_if_option,
    json_option,
    leave_if_copied,
    leave_if_failed,
    print_lines,
    progress_of,
    refuse_taken_inputs,
    write_outputs,
)
from chromanoise.imaging import Work
from chromanoise.io import Table, matrix_writer
from chromanoise.noise import conditions
from chromanoise.study import (
    DEFAULT_METHOD,
    MOST_PAIRS_SENSORS,
    PRIORS,
    SWEEPS,
    Analyses,
    Comparison,
    ComparisonMap,
    Condition,
    JudgedResult,
    MatrixResult,
    Step,
    Study,
    Verdict,
    answer_of,
    conditions_of,
    default_of,
    failures_of,
    input_notes,
    known_matrices,
    run,
    run_study,
    study_of,
)


def print_run(
    study: Study,
    out: Path,
    threads: int | None,
    place: Path | None = None,
    *,
    answers: bool = False,
    fail_if: Sequence[str] = (),
) -> list[str]:
    """Run a study whose file names are relative to ``place``, and print the files it writes.

    Returns the sentences of the conditions of ``fail_if`` that are met.

    Parameters
    ----------
    answers
        Whether to print the sentence that answers each of its questions before.
    """
    asked: list[Condition] = []

    def planned(steps: Sequence[Step]) -> None:
        results = [JudgedResult(kind=one.kind, quantity=one.quantity) for one in steps]
        asked.extend(conditions_of(fail_if, results))

    def report(what: str, done: bool) -> None:
        click.echo(f"{what}{' (already done)' if done else ''}", err=True)

    sentences: list[str] = []
    results: list[dict[str, Any]] = []

    def collect(result: dict[str, Any]) -> None:
        sentences.extend(answer_of(result) if answers else ())
        results.extend([result] if asked else ())

    files = run_study(
        study,
        out,
        work=Work(threads=threads),
        planned=planned,
        report=report,
        progress=progress_of_step,
        collect=collect if answers or fail_if else None,
        place=place,
    )
    print_lines(list(dict.fromkeys(sentences)))
    for file in files:
        click.echo(file)
    return failures_of(asked, lambda: results, [one.stem for one in files])


def progress_of_step(step: Step) -> AbstractContextManager[Callable[[int], None]]:
    """Progress of a step of a study."""
    return progress_of(step.what, step.parts, step.unit)


@command()
@with_settings("analyze")
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@matrix_option
@table_option
@json_option
@fail_if_option
@notes_option
@copy_option
def analyze(
    sensors: tuple[str, ...],
    matrix: str,
    table: str | None,
    json_target: str | None,
    fail_if: tuple[str, ...],
    whole_notes: bool,
    copy_as: str | None,
    **settings: Any,
) -> None:
    """Noise of each SENSOR in raw, spectral and color coordinates, for a perfect white.

    SENSOR is a name of the catalog (onyx-rgbw, onyx-rgb-ircut, onyx-rgb, onyx-rgbw-ircut, and
    models of other filter sets: model-rgb-ircut, model-cmy-ircut, model-rgbir ...; all of them:
    `chromanoise catalog sensors`) or a file of QE curves in any format of `chromanoise inspect`.
    """
    study = study_of("analyze", sensors, settings, matrices=[matrix])
    leave_if_copied(copy_as, study)
    asked = conditions_of(fail_if, [JudgedResult(kind=Analyses)])
    refuse_taken_inputs({"--json": json_target, "--table": table}, sensors, settings)
    (result,) = run(study, progress=progress_of_step).analyses.values()
    failed = failures_of(asked, lambda: [result.to_dict()])
    printed = json_target != "-"
    verdict = result.verdict if printed else None
    write_outputs(as_table(table, lambda: _table(result)), as_json(json_target, result.to_dict))
    if verdict is not None:
        _print(result, verdict, whole_notes=whole_notes)
    leave_if_failed(failed)


def _table(result: Analyses) -> Table:
    """Of the sensors; with a pipeline of each patch at each ISO."""
    return result.pipeline_table() if result.outputs.pipeline.run else result.to_table()


def _print(result: Analyses, verdict: Verdict, *, whole_notes: bool) -> None:
    """The answer, tables, and what else the verdict says."""
    analyses = result.analyses
    print_lines(one.text for one in verdict.answer)
    terminal_tables.print_conditions(conditions(result.points))
    terminal_tables.print_analyses(analyses, whole_notes=whole_notes)
    if len(analyses) > MOST_PAIRS_SENSORS:
        terminal_tables.print_ranking(result.ranking, "Ranking by SNR of Y [dB]")
    for table in outcome_tables(result):
        terminal_tables.print_table(table)
    readings = [one.machine for one in result.outcomes if one.machine is not None]
    if readings:
        for table in machine_tables(readings):
            terminal_tables.print_table(table)
    print_lines(one.text for one in verdict.details)


_VARY, _FIRST, _LAST = (default_of("compare", name) for name in ("vary", "first", "last"))
_START = f"{_VARY}={_FIRST:g}:{_LAST:g}"


@command()
@with_settings("compare")
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@own_option(
    "--sweep",
    heading="Sweep",
    metavar="NAME=FIRST:LAST",
    help=f"Parameter that varies: {', '.join(f'{s.name} [{s.unit}]' for s in SWEEPS.values())}. "
    "An ircut-nm of 1200 or more is a sensor without the added filter. "
    f"[default: {_START}]",
)
@own_option(
    "--and",
    "second",
    heading="Sweep",
    metavar="NAME=FIRST:LAST[:POINTS]",
    help="A second parameter of --sweep that varies too: values on a grid, and the best sensor at "
    f"each pair of values. POINTS is {default_of('compare_map', 'second_points')} by default.",
)
@own_option(
    "--matrix",
    "matrices",
    heading="Color",
    default=DEFAULT_METHOD,
    show_default=True,
    metavar="NAME[,NAME...]",
    help="Color matrices: kernel and others of `chromanoise matrix`.",
)
@own_option(
    "--prior",
    common=False,
    metavar=f"[{'|'.join([*PRIORS, 'all'])}]|FILE",
    help="Training set of trained matrices; all gives the band of crossovers over all sets; "
    "or a file of reflectances.",
)
@table_option
@json_option
@fail_if_option
@notes_option
@copy_option
def compare(
    sensors: tuple[str, ...],
    sweep: str | None,
    second: str | None,
    matrices: str,
    table: str | None,
    json_target: str | None,
    fail_if: tuple[str, ...],
    whole_notes: bool,
    copy_as: str | None,
    **settings: Any,
) -> None:
    """Compare SENSORS over a range of one parameter: noise, SNR, color error, crossovers.

    The first sentence says which sensor has the least visual noise at equal color error, compared
    at up to 9 values of the range; it is there for 2 to 20 sensors, without --and.

    Auto exposure gives one time, for the settings that stay fixed: the most sensitive channel
    reaches --saturate (99 %) of full well on a perfect white. --time-ms sets another time.
    """
    settings |= _span(sweep, "--sweep")
    makers = matrices.split(",")
    function = "compare" if second is None else "compare_map"
    settings |= {} if second is None else _second_span(second)
    study = study_of(function, sensors, settings, matrices=makers)
    leave_if_copied(copy_as, study)
    kind = Comparison if second is None else ComparisonMap
    judged = JudgedResult(kind=kind, quantity=study.sweeps[0].quantity)
    asked = conditions_of(fail_if, [judged])
    refuse_taken_inputs({"--json": json_target, "--table": table}, sensors, settings)
    results = run(study, progress=progress_of_step)
    result: Comparison | ComparisonMap
    (result,) = results.maps if second is not None else results.sweeps
    failed = failures_of(asked, lambda: [result.to_dict()])
    write_outputs(as_table(table, result.to_table), as_json(json_target, result.to_dict))
    if json_target != "-":
        fixed = conditions(result.points)
        print_lines(result.shown_sentences)
        print_lines([f"Settings (all but those that vary stay fixed): {fixed}"])
        if isinstance(result, ComparisonMap):
            terminal_tables.print_maps(result.maps, result.ranking)
        else:
            terminal_tables.print_comparison(result.curves, result.ranking, result.shown_bands)
        notes = [(one.sensor.label, note) for one in result.points for note in input_notes(one)]
        terminal_tables.print_notes(notes, whole=whole_notes)
    leave_if_failed(failed)


def _second_span(text: str) -> dict[str, Any]:
    """Parse NAME=FIRST:LAST[:POINTS]: the second parameter, its range and its number of values."""
    span, _, points = text.rpartition(":")
    if span.count(":") != 1:
        span, points = text, ""
    try:
        count = {"second_points": int(points)} if points or span != text else {}
    except ValueError:
        raise InputError("--and", "must end with a whole number of values", value=points) from None
    return {f"second_{key}": value for key, value in _span(span, "--and").items()} | count


def _span(text: str | None, option: str) -> dict[str, Any]:
    """Parse NAME=FIRST:LAST: the parameter and its range."""
    if text is None:
        return {}
    name, _, span = text.partition("=")
    try:
        first, last = (float(part) for part in span.split(":"))
    except ValueError:
        raise InputError(
            option, "must be NAME=FIRST:LAST, e.g. lux=0.01:1000", value=text
        ) from None
    return {"vary": name, "first": first, "last": last}


@command()
@with_settings("matrix")
@click.argument("sensor")
@click.option(
    "--matrix",
    cls=RenamedOption,
    heading="Color",
    old="--method",
    default=DEFAULT_METHOD,
    show_default=True,
    metavar="NAME[=VALUE]|FILE",
    help=f"Method of the matrix: {known_matrices()}; lmmse gives one per light "
    "level; or a file: CSV, JSON, CLF, DNG, DCP.",
)
@own_option(
    "--export",
    heading="Output",
    help="Write it to FILE.csv, .json, .clf (OpenColorIO) or .dcp.json (camera-profile names).",
)
@own_option(
    "--pareto",
    "weights",
    heading="Color",
    metavar="FIRST:LAST[:POINTS]",
    help="Color error against noise for weights of the noise from FIRST to LAST, e.g. 0.001:1000; "
    "1 is lmmse, and towards 0 lies least-squares.",
)
@table_option
@json_option
@fail_if_option
@notes_option
@copy_option
def matrix(
    sensor: str,
    matrix: str,
    export: str | None,
    weights: str | None,
    table: str | None,
    json_target: str | None,
    fail_if: tuple[str, ...],
    whole_notes: bool,
    copy_as: str | None,
    **settings: Any,
) -> None:
    """The color matrix of SENSOR, with its color error, noise, condition and noise gain."""
    study = study_of(
        "matrix", [sensor], {**settings, **_span_of_matrix(weights)}, matrices=[matrix]
    )
    leave_if_copied(copy_as, study)
    asked = conditions_of(fail_if, [JudgedResult(kind=MatrixResult)])
    targets = {"--export": export, "--json": json_target, "--table": table}
    refuse_taken_inputs(targets, [sensor], settings)
    writer = None if export is None else matrix_writer(export, "--export")
    (results,) = run(study, progress=progress_of_step).matrices.values()
    (result,) = results.results
    point, report = result.point, result.report
    failed = failures_of(asked, lambda: [result.to_dict()])
    write_outputs(
        (export, lambda: "" if writer is None else writer(result.made)),
        as_table(table, result.to_table),
        as_json(json_target, result.to_dict),
    )
    if json_target != "-":
        print_lines(results.sentences)
        terminal_tables.print_conditions(conditions([point]))
        terminal_tables.print_matrix(result.matrix, report, point.sensor.label)
        if result.pareto:
            terminal_tables.print_table(pareto_table(result.pareto, report, point.sensor.label))
        notes = [(point.sensor.label, one) for one in input_notes(point, result.matrix)]
        terminal_tables.print_notes(notes, whole=whole_notes)
    leave_if_failed(failed)


def _span_of_matrix(text: str | None) -> dict[str, Any]:
    """Parse FIRST:LAST[:POINTS]."""
    if text is None:
        return {}
    try:
        first, last, *points = text.split(":")
        (count,) = map(int, points or ["0"])
        span = {"pareto_first": float(first), "pareto_last": float(last)}
    except ValueError:
        demand = "must be FIRST:LAST or FIRST:LAST:POINTS, e.g. 0.001:1000"
        raise InputError("--pareto", demand, value=text) from None
    return span | ({"pareto_points": count} if points else {})
