"""``chromanoise matrix``."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from chromanoise._check import InputError
from chromanoise._files import write_whole
from chromanoise.cli import tables
from chromanoise.cli.options import (
    EXPOSURE,
    only,
    sensor_and_light,
    the_exposure,
    the_light,
    the_sensors,
)
from chromanoise.exposure import Situation, expected_electrons
from chromanoise.merit import matrix_report
from chromanoise.study import DEFAULT_PRIOR, PRIORS, known_matrices, matrix_makers
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
@click.option(
    "--prior",
    type=click.Choice(list(PRIORS)),
    default=DEFAULT_PRIOR,
    show_default=True,
    help="What a trained matrix is trained on.",
)
@click.option(
    "--export",
    type=click.Path(path_type=Path),
    help="Write it to FILE.csv, .json, .clf (OpenColorIO) or .dcp.json (camera-profile names).",
)
def matrix(sensor: str, method: str, prior: str, export: Path | None, **options: Any) -> None:
    """The color matrix of SENSOR, with its color error, noise, condition and noise gain."""
    if export:
        writer = _writer(export)
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
    tables.print_matrix(made, report, camera.name)


def _writer(export: Path) -> Callable[[MadeMatrix], str]:
    for ending, writer in _WRITERS.items():
        if export.name.lower().endswith(ending):
            return writer
    raise InputError(f"{export}: a matrix is written as {', '.join(_WRITERS)}; end the name so")
