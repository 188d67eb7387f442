"""``chromanoise matrix``."""

from typing import Any

import click

from chromanoise.analysis import DEFAULT_METHOD, known_matrices
from chromanoise.charts.result_tables import pareto_table
from chromanoise.cli import tables
from chromanoise.cli.copying import print_copy
from chromanoise.cli.options import (
    copy_option,
    table_option,
    with_settings,
)
from chromanoise.cli.output import (
    json_option,
    json_text,
    refuse_taken_inputs,
    table_text,
    write_outputs,
)
from chromanoise.cli.parsing import RenamedOption, command
from chromanoise.cli.running import progress_of_step
from chromanoise.errors import InputError
from chromanoise.exposure import conditions
from chromanoise.io.matrices import matrix_writer
from chromanoise.study import run, study_of


@command()
@with_settings("matrix")
@click.argument("sensor")
@click.option(
    "--matrix",
    cls=RenamedOption,
    old="--method",
    default=DEFAULT_METHOD,
    show_default=True,
    metavar="NAME[=VALUE]|FILE",
    help=f"Method of the matrix: {known_matrices()}; lmmse gives one per light "
    "level; or a file: CSV, JSON, CLF, DNG, DCP.",
)
@click.option(
    "--export",
    help="Write it to FILE.csv, .json, .clf (OpenColorIO) or .dcp.json (camera-profile names).",
)
@click.option(
    "--pareto",
    "weights",
    metavar="FIRST:LAST[:POINTS]",
    help="Color error against noise for weights of the noise from FIRST to LAST, e.g. 0.001:1000; "
    "1 is lmmse, and towards 0 lies least-squares.",
)
@table_option
@json_option
@copy_option
def matrix(
    sensor: str,
    matrix: str,
    export: str | None,
    weights: str | None,
    table: str | None,
    json_target: str | None,
    copy_as: str | None,
    **settings: Any,
) -> None:
    """The color matrix of SENSOR, with its color error, noise, condition and noise gain."""
    study = study_of("matrix", [sensor], {**settings, **_span(weights)}, matrices=[matrix])
    if copy_as is not None:
        print_copy(copy_as, study)
        return
    targets = {"--export": export, "--json": json_target, "--table": table}
    refuse_taken_inputs(targets, [sensor], settings)
    writer = None if export is None else matrix_writer(export, "--export")
    (results,) = run(study, progress=progress_of_step).matrices.values()
    (result,) = results.results
    point, report = result.point, result.report
    write_outputs(
        (export, lambda: "" if writer is None else writer(result.made)),
        (table, lambda: table_text(result.to_table(), str(table))),
        (json_target, lambda: json_text(result.to_dict())),
    )
    if json_target == "-":
        return
    tables.print_conditions(conditions([point]))
    tables.print_matrix(result.matrix, report, point.sensor.label)
    if result.pareto:
        tables.print_table(pareto_table(result.pareto, report, point.sensor.label))


def _span(text: str | None) -> dict[str, Any]:
    """Parse FIRST:LAST[:POINTS]."""
    if text is None:
        return {}
    parts = text.split(":")
    try:
        first, last = map(float, parts[:2])
        points = {"pareto_points": int(parts[2])} if len(parts) == 3 else {}
    except ValueError:
        parts = []
    if len(parts) not in (2, 3):
        raise InputError(
            "--pareto", "must be FIRST:LAST or FIRST:LAST:POINTS, e.g. 0.001:1000", value=text
        )
    return {"pareto_first": first, "pareto_last": last, **points}
