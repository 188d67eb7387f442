"""``chromanoise compare``."""

from typing import Any

import click

from chromanoise.analysis import DEFAULT_METHOD, PRIORS, SWEEPS
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
    print_lines,
    refuse_taken_inputs,
    table_text,
    write_outputs,
)
from chromanoise.cli.parsing import command
from chromanoise.cli.running import progress_of_step
from chromanoise.errors import InputError
from chromanoise.exposure import conditions
from chromanoise.study import Comparison, ComparisonMap, default_of, run, study_of

_VARY, _FIRST, _LAST = (default_of("compare", name) for name in ("vary", "first", "last"))
_START = f"{_VARY}={_FIRST:g}:{_LAST:g}"


@command()
@with_settings("compare")
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@click.option(
    "--sweep",
    metavar="NAME=FIRST:LAST",
    help=f"Parameter that varies: {', '.join(f'{s.name} [{s.unit}]' for s in SWEEPS.values())}. "
    "An ircut-nm of 1200 or more is a sensor without the added filter. "
    f"[default: {_START}]",
)
@click.option(
    "--and",
    "second",
    metavar="NAME=FIRST:LAST[:POINTS]",
    help="A second parameter of --sweep that varies too: values on a grid, and the best sensor at "
    f"each pair of values. POINTS is {default_of('compare_map', 'second_points')} by default.",
)
@click.option(
    "--matrix",
    "matrices",
    default=DEFAULT_METHOD,
    show_default=True,
    metavar="NAME[,NAME...]",
    help="Color matrices: kernel and others of `chromanoise matrix`.",
)
@click.option(
    "--prior",
    metavar=f"[{'|'.join([*PRIORS, 'all'])}]|FILE",
    help="Training set of trained matrices; all gives the band of crossovers over all sets; "
    "or a file of reflectances.",
)
@table_option
@json_option
@copy_option
def compare(
    sensors: tuple[str, ...],
    sweep: str | None,
    second: str | None,
    matrices: str,
    table: str | None,
    json_target: str | None,
    copy_as: str | None,
    **settings: Any,
) -> None:
    """Compare SENSORS over a range of one parameter: SNR, color error, crossovers.

    The exposure time is solved once, for the settings that stay fixed, so that the brightest
    channel of a perfect white fills --saturate (99 %) of full well; --time-ms sets it.
    """
    settings |= _span(sweep, "--sweep")
    makers = matrices.split(",")
    function = "compare" if second is None else "compare_map"
    settings |= {} if second is None else _second_span(second)
    study = study_of(function, sensors, settings, matrices=makers)
    if copy_as is not None:
        print_copy(copy_as, study)
        return
    refuse_taken_inputs({"--json": json_target, "--table": table}, sensors, settings)
    results = run(study, progress=progress_of_step)
    result: Comparison | ComparisonMap
    (result,) = results.maps if second is not None else results.sweeps
    write_outputs(
        (table, lambda: table_text(result.to_table(), str(table))),
        (json_target, lambda: json_text(result.to_dict())),
    )
    if json_target != "-":
        fixed = conditions(result.points)
        print_lines([f"Settings (all but those that vary stay fixed): {fixed}"])
        if isinstance(result, ComparisonMap):
            tables.print_maps(result.maps, result.ranking)
            return
        tables.print_comparison(
            result.curves, result.ranking, result.shown_sentences, result.shown_bands
        )


def _second_span(text: str) -> dict[str, Any]:
    """Parse NAME=FIRST:LAST[:POINTS]: the second parameter, its range and its number of values."""
    span, _, points = text.rpartition(":")
    count = {}
    if span.count(":") == 1:
        text = span
        try:
            count = {"second_points": int(points)}
        except ValueError:
            raise InputError(
                "--and", "must end with a whole number of values", value=points
            ) from None
    return {f"second_{key}": value for key, value in _span(text, "--and").items()} | count


def _span(text: str | None, option: str) -> dict[str, Any]:
    """Parse NAME=FIRST:LAST: the parameter and its range."""
    if text is None:
        return {}
    name, _, span = text.partition("=")
    try:
        first, last = (float(part) for part in span.split(":"))
    except ValueError:
        raise InputError(
            option, "must be NAME=FIRST:LAST, e.g. lux=0.01:1000", value=text
        ) from None
    return {"vary": name, "first": first, "last": last}
