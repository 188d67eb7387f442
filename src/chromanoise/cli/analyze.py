"""``chromanoise analyze``."""

from pathlib import Path
from typing import Any

import click

from chromanoise._check import InputError, distinct
from chromanoise.cli import tables
from chromanoise.cli.merit_tables import print_merits
from chromanoise.cli.options import (
    EXPOSURE,
    copy_option,
    json_option,
    matrix_option,
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
from chromanoise.cli.progress import progress_of
from chromanoise.color import SPACES
from chromanoise.exposure import Situation
from chromanoise.study import color_budgets, contravariant_budgets, matrix_makers
from chromanoise.study.runs import Outcome, OutputsPart, outcome_of, outcomes_as_json
from chromanoise.study.tables import analyses_as_table


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
@table_option
@json_option
@copy_option
def analyze(
    sensors: tuple[str, ...],
    clip: bool,
    method: str,
    prior: str,
    chart: bool,
    budget: bool,
    merit: bool,
    space: str | None,
    table: Path | None,
    json_target: str | None,
    copy_as: str | None,
    **options: Any,
) -> None:
    """Noise of each SENSOR in raw, spectral and color coordinates, for a perfect white.

    SENSOR is a name of the catalogue (onyx-rgbw, onyx-rgb-ircut, onyx-rgb, onyx-rgbw-ircut, and
    models of other filter sets: model-rgb-ircut, model-cmy-ircut, model-rgbir ...; all of them:
    `chromanoise catalog sensors`) or a file of QE curves in any format of `chromanoise inspect`.
    """
    if clip and (budget or merit):
        raise InputError("--clip does not go with --budget or --merit: they follow eq. 7")
    refuse_idle_prior([method])
    if copy_as is not None:
        from chromanoise.cli.copying import analyze_told, print_copy

        print_copy(copy_as, analyze_told(click.get_current_context().params))
        return
    refuse_taken_inputs({"--json": json_target, "--table": table}, sensors, options)
    illuminant, white = the_light(options)
    (maker,) = matrix_makers([method], options["metric"], prior=prior).values()
    cameras = the_sensors(sensors, options)
    distinct("names of sensors", [camera.name for camera in cameras])
    outputs = OutputsPart(clip=clip, budget=budget, merit=merit, chart=chart, space=space)
    outcomes = []
    with progress_of("the analysis", len(cameras), "sensors") as advance:
        for sensor in cameras:
            exposure = the_exposure(white, sensor, **only(options, EXPOSURE))
            situation = Situation(
                sensor=sensor, exposure=exposure, illuminant=illuminant, level_lux=white.level_lux
            )
            outcomes.append(outcome_of(situation, maker, outputs))
            advance(1)
    if table is not None:
        write_table(analyses_as_table([outcome.analysis for outcome in outcomes]), table)
    if json_target:
        write_json(outcomes_as_json(outcomes, outputs), json_target)
    if json_target != "-":
        _print(outcomes, outputs)


def _print(outcomes: list[Outcome], outputs: OutputsPart) -> None:
    analyses = [outcome.analysis for outcome in outcomes]
    tables.print_analyses(analyses)
    for analysis in analyses if outputs.budget else []:
        tables.print_budgets(analysis, color_budgets(analysis))
        tables.print_budgets(analysis, contravariant_budgets(analysis))
        tables.print_lab_budgets(analysis)
    for outcome in outcomes if outputs.chart else []:
        tables.print_chart(outcome.analysis, outcome.chart)
    print_merits([outcome.merits for outcome in outcomes if outcome.merits is not None])
    if outputs.space is not None:
        tables.print_grey_noise(analyses, [outcome.grey_noise for outcome in outcomes])
