"""``chromanoise analyze``."""

from typing import Any

import click

from chromanoise.cli import tables
from chromanoise.cli.options import (
    EXPOSURE,
    PIXEL,
    only,
    sensor_and_light,
    the_exposure,
    the_illuminant,
    the_sensor,
    the_white,
)
from chromanoise.cli.output import write_json
from chromanoise.study import analyses_as_json, analyzed


@click.command()
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@sensor_and_light
@click.option("--json", "json_target", metavar="FILE|-", help="Write JSON; - for standard output.")
def analyze(sensors: tuple[str, ...], json_target: str | None, **options: Any) -> None:
    """Noise of each SENSOR in raw, spectral and color coordinates, for a perfect white.

    SENSOR is a catalogue name (onyx-rgbw, onyx-rgb-ircut, onyx-rgb, onyx-rgbw-ircut,
    model-rgb-ircut, model-mono) or a CSV file with the header wavelength_nm,R,G,... and the
    absolute QE of each channel.
    """
    beyond = options["beyond"]
    illuminant = the_illuminant(options["illuminant"], beyond=options["illuminant_beyond"])
    scene = the_white(illuminant, options["lux"])
    exposure_rule, pixel = only(options, EXPOSURE), only(options, PIXEL)
    analyses = []
    for name in sensors:
        sensor = the_sensor(name, beyond=beyond, **pixel)
        exposure = the_exposure(scene, sensor, **exposure_rule)
        analyses.append(analyzed(scene, sensor, exposure, options["metric"]))
    if json_target:
        write_json(analyses_as_json(analyses), json_target)
    if json_target != "-":
        tables.print_analyses(analyses)
