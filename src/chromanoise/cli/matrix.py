"""``chromanoise matrix``."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from chromanoise._check import Array, InputError
from chromanoise._files import write_whole
from chromanoise._shapes import Float
from chromanoise.cli import tables
from chromanoise.cli.copying import matrix_told, print_copy
from chromanoise.cli.merit_tables import print_pareto
from chromanoise.cli.options import (
    EXPOSURE,
    copy_option,
    json_option,
    only,
    prior_option,
    refuse_idle_prior,
    sensor_and_light,
    table_option,
    the_exposure,
    the_light,
    the_sensors,
)
from chromanoise.cli.output import refuse_taken_inputs, write_json, write_table
from chromanoise.color import ColorMatrix
from chromanoise.exposure import Situation, expected_electrons, white_scene
from chromanoise.merit import matrix_report
from chromanoise.sensor import left_out_of_closed_form
from chromanoise.study import (
    known_matrices,
    matrix_as_json,
    matrix_makers,
    noise_weights,
    pareto_of,
)
from chromanoise.study.files.matrices import (
    MadeMatrix,
    matrix_clf,
    matrix_csv,
    matrix_json,
    matrix_profile_json,
)
from chromanoise.study.tables import matrix_as_table

_WRITERS: dict[str, Callable[[MadeMatrix], str]] = {
    ".dcp.json": matrix_profile_json,
    ".csv": matrix_csv,
    ".json": matrix_json,
    ".clf": matrix_clf,
}


@click.command()
@click.argument("sensor")
@sensor_and_light
@click.option(
    "--method",
    default="kernel",
    show_default=True,
    metavar="NAME[=VALUE]",
    help=f"How the matrix is made: {known_matrices()}; lmmse gives one per light level.",
)
@prior_option
@click.option(
    "--export",
    type=click.Path(path_type=Path),
    help="Write it to FILE.csv, .json, .clf (OpenColorIO) or .dcp.json (camera-profile names).",
)
@click.option(
    "--pareto",
    "weights_told",
    metavar="FIRST:LAST[:POINTS]",
    help="Color error against noise for weights of the noise from FIRST to LAST, e.g. 0.001:1000; "
    "1 is lmmse, and towards 0 lies least-squares.",
)
@table_option
@json_option
@copy_option
def matrix(
    sensor: str,
    method: str,
    prior: str,
    export: Path | None,
    weights_told: str | None,
    table: Path | None,
    json_target: str | None,
    copy_as: str | None,
    **options: Any,
) -> None:
    """The color matrix of SENSOR, with its color error, noise, condition and noise gain."""
    if weights_told is None:  # the curve is trained, whatever the matrix
        refuse_idle_prior([method])
    if copy_as is not None:
        pareto = None if weights_told is None else _span(weights_told)
        print_copy(copy_as, matrix_told(click.get_current_context().params, pareto))
        return
    targets = {"--export": export, "--json": json_target, "--table": table}
    refuse_taken_inputs(targets, [sensor], options)
    if export:
        writer = _writer(export)
    weights = None if weights_told is None else _weights(weights_told)
    illuminant, white = the_light(options)
    (camera,) = the_sensors((sensor,), options)
    exposure = the_exposure(white, camera, **only(options, EXPOSURE))
    situation = Situation(
        sensor=camera, exposure=exposure, illuminant=illuminant, level_lux=white.level_lux
    )
    (maker,) = matrix_makers([method], options["metric"], prior=prior).values()
    made = maker(situation)
    report = matrix_report(made, camera, exposure, illuminant, level_lux=white.level_lux)
    if export:
        write_whole(export, writer(_made(situation, made)).encode("utf-8"))
    curve = None if weights is None else pareto_of(situation, weights, prior=prior)
    if table is not None:
        write_table(matrix_as_table(made, report, camera.name), table)
    if json_target is not None:
        write_json(matrix_as_json(situation, made, report, curve), json_target)
    if json_target == "-":
        return
    tables.print_matrix(made, report, camera.name)
    if curve:
        print_pareto(curve, report, camera.name)


def _made(situation: Situation, made: ColorMatrix) -> MadeMatrix:
    """The matrix with what a reader of its file must know."""
    sensor, exposure, lamp = situation.sensor, situation.exposure, situation.illuminant
    white_e = expected_electrons(white_scene(situation), sensor, exposure)
    return MadeMatrix(
        sensor=sensor.name,
        illuminant=lamp.name,
        level_lux=situation.level_lux,
        time_s=exposure.time_s,
        matrix=made,
        white_e=white_e,
        white_lux=float(made.matrix[1] @ white_e),
        notes=(*sensor.notes, *left_out_of_closed_form(sensor), *lamp.notes),
    )


def _weights(told: str) -> Float[Array, " q"]:
    """The weights that FIRST:LAST[:POINTS] asks for."""
    span = _span(told)
    return noise_weights(span.pop("first"), span.pop("last"), **span)


def _span(told: str) -> dict[str, Any]:
    """First, last and perhaps points of FIRST:LAST[:POINTS]."""
    wanted = "--pareto takes FIRST:LAST or FIRST:LAST:POINTS, as 0.001:1000"
    parts = told.split(":")
    if len(parts) not in (2, 3):
        raise InputError(f"{wanted}, but is {told!r}")
    try:
        first, last = map(float, parts[:2])
        points = {"points": int(parts[2])} if len(parts) == 3 else {}
    except ValueError:
        raise InputError(f"{wanted}, but {told!r} has a part that is no number") from None
    return {"first": first, "last": last, **points}


def _writer(export: Path) -> Callable[[MadeMatrix], str]:
    for ending, writer in _WRITERS.items():
        if export.name.lower().endswith(ending):
            return writer
    raise InputError(f"{export}: a matrix is written as {', '.join(_WRITERS)}; end the name so")
