"""``chromanoise matrix``."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
from jaxtyping import Float

from chromanoise._check import Array, InputError
from chromanoise._files import write_whole
from chromanoise.cli import tables
from chromanoise.cli.merit_tables import print_pareto
from chromanoise.cli.options import (
    EXPOSURE,
    json_option,
    only,
    prior_option,
    refuse_idle_prior,
    sensor_and_light,
    the_exposure,
    the_light,
    the_sensors,
)
from chromanoise.cli.output import refuse_inputs, write_json
from chromanoise.exposure import Situation, expected_electrons
from chromanoise.merit import matrix_report
from chromanoise.study import (
    known_matrices,
    matrix_as_json,
    matrix_makers,
    noise_weights,
    pareto_of,
)
from chromanoise.study.matrix_files import (
    MadeMatrix,
    matrix_clf,
    matrix_csv,
    matrix_json,
    matrix_profile_json,
)

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
@json_option
def matrix(
    sensor: str,
    method: str,
    prior: str,
    export: Path | None,
    weights_told: str | None,
    json_target: str | None,
    **options: Any,
) -> None:
    """The color matrix of SENSOR, with its color error, noise, condition and noise gain."""
    if weights_told is None:  # the curve is trained, whatever the matrix
        refuse_idle_prior([method])
    refuse_inputs(export, "--export", sensor, options["illuminant"])
    refuse_inputs(json_target, "--json", sensor, options["illuminant"])
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
        white_e = expected_electrons(white, camera, exposure)
        told = MadeMatrix(
            sensor=camera.name,
            illuminant=illuminant.name,
            level_lux=white.level_lux,
            time_s=exposure.time_s,
            matrix=made,
            white_e=white_e,
            white_lux=float(made.matrix[1] @ white_e),
            notes=(*camera.notes, *illuminant.notes),
        )
        write_whole(export, writer(told).encode("utf-8"))
    curve = None if weights is None else pareto_of(situation, weights, prior=prior)
    if json_target is not None:
        write_json(matrix_as_json(situation, made, report, curve), json_target)
    if json_target == "-":
        return
    tables.print_matrix(made, report, camera.name)
    if curve:
        print_pareto(curve, report, camera.name)


def _weights(told: str) -> Float[Array, " q"]:
    """The weights that FIRST:LAST[:POINTS] asks for."""
    wanted = "--pareto takes FIRST:LAST or FIRST:LAST:POINTS, as 0.001:1000"
    parts = told.split(":")
    if len(parts) not in (2, 3):
        raise InputError(f"{wanted}, but is {told!r}")
    try:
        first, last = map(float, parts[:2])
        points = {"points": int(parts[2])} if len(parts) == 3 else {}
    except ValueError:
        raise InputError(f"{wanted}, but {told!r} has a part that is no number") from None
    return noise_weights(first, last, **points)


def _writer(export: Path) -> Callable[[MadeMatrix], str]:
    for ending, writer in _WRITERS.items():
        if export.name.lower().endswith(ending):
            return writer
    raise InputError(f"{export}: a matrix is written as {', '.join(_WRITERS)}; end the name so")
