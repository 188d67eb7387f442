"""``chromanoise compare``."""

from pathlib import Path
from typing import Any

import click

from chromanoise._check import distinct, one_of
from chromanoise.analysis import (
    DEFAULT_PRIOR,
    PRIORS,
    QUANTITIES,
    SWEEPS,
    Sweep,
    bands_as_json,
    compared,
    comparison_as_json,
    crossover_bands,
    crossovers,
    matrix_makers,
    swept_values,
)
from chromanoise.analysis.tables import curves_as_table
from chromanoise.cli import tables
from chromanoise.cli.copying import compare_told, print_copy
from chromanoise.cli.options import (
    EXPOSURE,
    LENS,
    WHOLE,
    copy_option,
    json_option,
    only,
    refuse_idle_prior,
    sensor_and_light,
    table_option,
    the_exposure,
    the_lens,
    the_light,
    the_sensors,
)
from chromanoise.cli.output import refuse_taken_inputs, write_json, write_table
from chromanoise.cli.progress import progress_of
from chromanoise.errors import InputError
from chromanoise.exposure import EQUAL_TERMS, Situation


@click.command()
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@sensor_and_light
@click.option(
    "--equal",
    type=click.Choice(list(EQUAL_TERMS)),
    default="exposure",
    show_default=True,
    help="On which terms: one time for all; each filled alike; the same photons for each set of "
    "channels (a 4-channel set spreads over 4 pixels).",
)
@click.option(
    "--sweep",
    default="lux=0.01:1000",
    show_default=True,
    metavar="NAME=FIRST:LAST",
    help=f"What varies: {', '.join(f'{s.name} [{s.unit}]' for s in SWEEPS.values())}.",
)
@click.option("--points", type=WHOLE, default=61, show_default=True, help="Values of the sweep.")
@click.option(
    "--quantity",
    type=click.Choice(list(QUANTITIES)),
    default="snr-y",
    show_default=True,
    help="What is compared.",
)
@click.option(
    "--matrix",
    "matrices",
    default="kernel",
    show_default=True,
    metavar="NAME[,NAME...]",
    help="Color matrices: kernel and others of `chromanoise matrix`.",
)
@click.option(
    "--prior",
    type=click.Choice([*PRIORS, "all"]),
    default=DEFAULT_PRIOR,
    show_default=True,
    help="What trained matrices are trained on; all gives the band of crossovers over them.",
)
@table_option
@json_option
@copy_option
def compare(
    sensors: tuple[str, ...],
    equal: str,
    sweep: str,
    points: int,
    quantity: str,
    matrices: str,
    prior: str,
    table: Path | None,
    json_target: str | None,
    copy_as: str | None,
    **options: Any,
) -> None:
    """Compare SENSORs while one thing varies: SNR, color error, crossovers.

    The times are solved once, at --lux and before the sweep, so that the brightest channel of a
    perfect white fills --saturate (99 %) of full well; --time-ms sets one for all.
    """
    varied, values = _swept(sweep, points)
    _refuse_swept(varied, options)
    refuse_idle_prior(matrices.split(","))
    if copy_as is not None:
        # the ends as they were told: a geometric row of values may miss the last by a rounding
        print_copy(copy_as, compare_told(click.get_current_context().params, *_ends(sweep)))
        return
    refuse_taken_inputs({"--json": json_target, "--table": table}, sensors, options)
    illuminant, white = the_light(options)
    cameras = the_sensors(sensors, options)
    distinct("names of sensors", [camera.name for camera in cameras])
    contestants = [
        Situation(
            sensor=sensor, exposure=exposure, illuminant=illuminant, level_lux=white.level_lux
        )
        for sensor, exposure in zip(
            cameras, _exposures(white, cameras, equal, options), strict=True
        )
    ]
    names, asked = matrices.split(","), QUANTITIES[quantity]
    metric, one_prior = options["metric"], DEFAULT_PRIOR if prior == "all" else prior
    makers = matrix_makers(names, metric, prior=one_prior)
    parts = len(contestants) * len(makers) * len(values)
    with progress_of("the comparison", parts, "values") as advance:
        curves = compared(
            contestants, makers, values, sweep=varied, quantity=asked, progress=advance
        )
    crossed = crossovers(contestants, makers, curves)
    bands = (
        crossover_bands(contestants, names, values, metric=metric, sweep=varied, quantity=asked)
        if prior == "all"
        else ()
    )
    if table is not None:
        write_table(curves_as_table(curves), table)
    if json_target:
        told = comparison_as_json(curves, crossed)
        told |= {"equal": equal, "prior": one_prior, "bands": bands_as_json(bands)}
        write_json(told, json_target)
    if json_target != "-":
        tables.print_comparison(curves, crossed, bands)


def _refuse_swept(varied: Sweep, options: dict[str, Any]) -> None:
    """What varies is not also given."""
    given = {"time-ms": "time_ms", "read-noise-e": "read_noise_e"}.get(varied.name)
    if given and options[given] is not None:
        option = f"--{given.replace('_', '-')}"
        raise InputError(f"{option} gives one {varied.what}, but --sweep varies it; leave one away")


def _exposures(white: Any, cameras: list[Any], equal: str, options: dict[str, Any]) -> Any:
    if options["time_ms"] is None:
        return EQUAL_TERMS[equal](white, cameras, **the_lens(**only(options, LENS)))
    if equal != "exposure":
        raise InputError(f"--time-ms gives all sensors one time, so it excludes --equal {equal}")
    return [the_exposure(white, camera, **only(options, EXPOSURE)) for camera in cameras]


def _swept(text: str, points: int) -> tuple[Sweep, Any]:
    first, last = _ends(text)
    varied = SWEEPS[one_of("sweep", text.partition("=")[0], tuple(SWEEPS))]
    return varied, swept_values(varied, first, last, points)


def _ends(text: str) -> tuple[float, float]:
    """FIRST and LAST of NAME=FIRST:LAST."""
    try:
        first, last = (float(part) for part in text.partition("=")[2].split(":"))
    except ValueError:
        raise InputError(
            f"--sweep takes NAME=FIRST:LAST, e.g. lux=0.01:1000, but is {text!r}"
        ) from None
    return first, last
