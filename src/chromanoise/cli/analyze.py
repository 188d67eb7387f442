"""``chromanoise analyze``."""

from typing import Any

import click

from chromanoise._check import InputError
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
from chromanoise.color import SPACES
from chromanoise.noise import Readout
from chromanoise.study import (
    analyses_as_json,
    analyzed,
    budgets_as_json,
    color_budgets,
    contravariant_budgets,
    grey_noise,
    grey_noise_as_json,
)


@click.command()
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@sensor_and_light
@click.option(
    "--clip",
    is_flag=True,
    help="Exact moments of electrons held between 0 and full well, instead of eq. 7.",
)
@click.option("--budget", is_flag=True, help="Where the SNR of X, Y and Z goes, in dB per cause.")
@click.option(
    "--space",
    type=click.Choice(list(SPACES)),
    help="Noise of an 18 % grey as the eye sees it, in this space.",
)
@click.option("--json", "json_target", metavar="FILE|-", help="Write JSON; - for standard output.")
def analyze(
    sensors: tuple[str, ...],
    clip: bool,
    budget: bool,
    space: str | None,
    json_target: str | None,
    **options: Any,
) -> None:
    """Noise of each SENSOR in raw, spectral and color coordinates, for a perfect white.

    SENSOR is a name of the catalogue (onyx-rgbw, onyx-rgb-ircut, onyx-rgb, onyx-rgbw-ircut, and
    models of other filter sets: model-rgb-ircut, model-cmy-ircut, model-rgbir ...) or a CSV file
    with the header wavelength_nm,R,G,... and the absolute QE of each channel.
    """
    if clip and (budget or space):
        raise InputError("--clip does not go with --budget or --space, which follow eq. 7")
    beyond = options["beyond"]
    illuminant = the_illuminant(options["illuminant"], beyond=options["illuminant_beyond"])
    scene = the_white(illuminant, options["lux"])
    exposure_rule, pixel = only(options, EXPOSURE), only(options, PIXEL)
    analyses = []
    for name in sensors:
        sensor = the_sensor(name, beyond=beyond, **pixel)
        exposure = the_exposure(scene, sensor, **exposure_rule)
        held = Readout(black_e=0.0, full_well_e=sensor.pixel.full_well_e) if clip else None
        analyses.append(analyzed(scene, sensor, exposure, options["metric"], readout=held))
    greys = [grey_noise(analysis, SPACES[space]) for analysis in analyses] if space else []
    shown = analyses if budget else []
    budgets = [color_budgets(a) for a in shown]
    spectral = [contravariant_budgets(a) for a in shown]
    if json_target:
        told = analyses_as_json(analyses)
        for sensor_told, own in zip(told["sensors"], budgets, strict=False):
            sensor_told["budget"] = budgets_as_json(own)
        for sensor_told, own in zip(told["sensors"], spectral, strict=False):
            sensor_told["contravariant_budget"] = budgets_as_json(own)
        for sensor_told, grey in zip(told["sensors"], greys, strict=False):
            sensor_told["grey_noise"] = grey_noise_as_json(grey)
        write_json(told, json_target)
    if json_target != "-":
        tables.print_analyses(analyses)
        for analysis, own in zip(analyses, budgets, strict=False):
            tables.print_budgets(analysis, own)
        for analysis, own in zip(analyses, spectral, strict=False):
            tables.print_budgets(analysis, own)
        if greys:
            tables.print_grey_noise(analyses, greys)
