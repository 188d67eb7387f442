"""``chromanoise compare``."""

from typing import Any

import click
import numpy as np

from chromanoise._check import InputError, distinct, positive
from chromanoise.cli import tables
from chromanoise.cli.makers import matrix_makers
from chromanoise.cli.options import (
    EXPOSURE,
    only,
    sensor_and_light,
    the_exposure,
    the_light,
    the_sensors,
)
from chromanoise.cli.output import write_json
from chromanoise.exposure import Exposure, saturating_exposure
from chromanoise.scene import Scene
from chromanoise.sensor import Sensor
from chromanoise.study.comparison import Contestant, compared, comparison_as_json, crossovers


@click.command()
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@sensor_and_light
@click.option(
    "--sweep",
    default="lux=0.01:1000",
    show_default=True,
    metavar="lux=FIRST:LAST",
    help="Light levels, evenly in their logarithm.",
)
@click.option("--points", type=int, default=61, show_default=True, help="Levels of the sweep.")
@click.option(
    "--matrix",
    "matrices",
    default="kernel",
    show_default=True,
    metavar="NAME[,NAME...]",
    help="Color matrices: kernel and others of `chromanoise matrix`.",
)
@click.option("--json", "json_target", metavar="FILE|-", help="Write JSON; - for standard output.")
def compare(
    sensors: tuple[str, ...],
    sweep: str,
    points: int,
    matrices: str,
    json_target: str | None,
    **options: Any,
) -> None:
    """Compare SENSORs over the light level: luminance SNR, color error, crossovers.

    Without --time-ms or --saturate all sensors share the time at which the first of them reaches
    99 % of full well at --lux (equal exposure). With --saturate each has its own (equal
    saturation).
    """
    illuminant, white = the_light(options)
    cameras = the_sensors(sensors, options)
    distinct("names of sensors", [camera.name for camera in cameras])
    exposures = _exposures(white, cameras, only(options, EXPOSURE))
    contestants = [
        Contestant(sensor=sensor, exposure=exposure)
        for sensor, exposure in zip(cameras, exposures, strict=True)
    ]
    makers = matrix_makers(matrices.split(","), illuminant, options["metric"])
    curves = compared(contestants, makers, illuminant, _levels(sweep, points))
    crossed = crossovers(contestants, makers, illuminant, curves)
    if json_target:
        write_json(comparison_as_json(curves, crossed), json_target)
    if json_target != "-":
        tables.print_comparison(curves, crossed)


def _exposures(white: Scene, cameras: list[Sensor], rule: dict[str, Any]) -> list[Exposure]:
    if rule["time_ms"] is not None or rule["saturate"] is not None:
        return [the_exposure(white, camera, **rule) for camera in cameras]
    lens = {key: rule[key] for key in ("f_number", "magnification")}
    own = [saturating_exposure(white, camera, **lens) for camera in cameras]
    return [min(own, key=lambda exposure: exposure.time_s)] * len(cameras)


def _levels(sweep: str, points: int) -> Any:
    name, _, span = sweep.partition("=")
    parts = span.split(":")
    try:
        first, last = (float(part) for part in parts)
    except ValueError:
        raise InputError(f"--sweep takes lux=FIRST:LAST, but is {sweep!r}") from None
    if name != "lux":
        raise InputError(f"--sweep knows lux, but asks for {name!r}")
    positive("--sweep's first level", "lx", first)
    if not last > first:
        raise InputError(f"--sweep must rise, but goes from {first:g} to {last:g} lx")
    if not 2 <= points <= 100_000:
        raise InputError(f"--points must be 2 to 100000, but is {points}")
    return np.geomspace(first, last, points)
