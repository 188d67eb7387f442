"""``chromanoise analyze``."""

from typing import Any

import click

from chromanoise._check import InputError, distinct
from chromanoise.cli import tables
from chromanoise.cli.merit_tables import print_merits
from chromanoise.cli.options import (
    EXPOSURE,
    json_option,
    matrix_option,
    only,
    prior_option,
    refuse_idle_prior,
    sensor_and_light,
    the_exposure,
    the_light,
    the_sensors,
)
from chromanoise.cli.output import refuse_inputs, write_json
from chromanoise.color import SPACES, UNBOUNDED
from chromanoise.exposure import Situation
from chromanoise.noise import Readout
from chromanoise.study import (
    analyses_as_json,
    analyzed,
    budgets_as_json,
    chart_as_json,
    chart_noise,
    color_budgets,
    contravariant_budgets,
    grey_noise,
    grey_noise_as_json,
    matrix_makers,
    merits_as_json,
    merits_of,
)


@click.command()
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@sensor_and_light
@click.option(
    "--clip",
    is_flag=True,
    help="Exact moments of electrons held between 0 and full well, instead of eq. 7.",
)
@matrix_option
@prior_option
@click.option("--chart", is_flag=True, help="Color error and noise of each ColorChecker patch.")
@click.option("--budget", is_flag=True, help="Where the SNR goes, in dB per cause.")
@click.option(
    "--merit",
    is_flag=True,
    help="Figures of merit: Neugebauer, Vora, SMI, SNR10, ISO speed, visual noise, bits ...",
)
@click.option(
    "--space",
    type=click.Choice(list(SPACES)),
    help="Noise of an 18 % grey as the eye sees it, in this space.",
)
@json_option
def analyze(
    sensors: tuple[str, ...],
    clip: bool,
    method: str,
    prior: str,
    chart: bool,
    budget: bool,
    merit: bool,
    space: str | None,
    json_target: str | None,
    **options: Any,
) -> None:
    """Noise of each SENSOR in raw, spectral and color coordinates, for a perfect white.

    SENSOR is a name of the catalogue (onyx-rgbw, onyx-rgb-ircut, onyx-rgb, onyx-rgbw-ircut, and
    models of other filter sets: model-rgb-ircut, model-cmy-ircut, model-rgbir ...) or a CSV file
    with the header wavelength_nm,R,G,... and the absolute QE of each channel.
    """
    if clip and (budget or merit):
        raise InputError("--clip does not go with --budget or --merit: they follow eq. 7")
    refuse_idle_prior([method])
    refuse_inputs(json_target, "--json", *sensors, options["illuminant"])
    illuminant, white = the_light(options)
    (maker,) = matrix_makers([method], options["metric"], prior=prior).values()
    analyses, grey_noises, charts = [], [], []
    cameras = the_sensors(sensors, options)
    distinct("names of sensors", [camera.name for camera in cameras])
    for sensor in cameras:
        exposure = the_exposure(white, sensor, **only(options, EXPOSURE))
        held = Readout(black_e=0.0, full_well_e=sensor.pixel.full_well_e) if clip else None
        situation = Situation(
            sensor=sensor, exposure=exposure, illuminant=illuminant, level_lux=white.level_lux
        )
        matrix = maker(situation)
        analyses.append(analyzed(white, sensor, exposure, readout=held, matrix=matrix))
        if space:
            grey_noises.append(grey_noise(analyses[-1], SPACES[space], readout=held))
        if chart:
            charts.append(chart_noise(analyses[-1], readout=held or UNBOUNDED))
    merits = [merits_of(analysis, maker=maker) for analysis in (analyses if merit else [])]
    if json_target:
        told = analyses_as_json(analyses)
        for i, (sensor_told, analysis) in enumerate(zip(told["sensors"], analyses, strict=True)):
            if budget:
                sensor_told |= budgets_as_json(analysis)
            if space:
                sensor_told["grey_noise"] = grey_noise_as_json(grey_noises[i])
            if chart:
                sensor_told["chart"] = chart_as_json(charts[i])
            if merit:
                sensor_told["merits"] = merits_as_json(merits[i])
        write_json(told, json_target)
    if json_target != "-":
        tables.print_analyses(analyses)
        for analysis in analyses if budget else []:
            tables.print_budgets(analysis, color_budgets(analysis))
            tables.print_budgets(analysis, contravariant_budgets(analysis))
            tables.print_lab_budgets(analysis)
        for analysis, patches in zip(analyses, charts, strict=False):
            tables.print_chart(analysis, patches)
        print_merits(merits)
        if space:
            tables.print_grey_noise(analyses, grey_noises)
