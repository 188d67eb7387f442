"""``chromanoise compare``."""

from typing import Any

import click

from chromanoise.analysis import DEFAULT_METHOD, PRIORS, QUANTITIES, SWEEPS
from chromanoise.cli import tables
from chromanoise.cli.copying import print_copy
from chromanoise.cli.options import (
    WHOLE,
    closed_form_options,
    copy_option,
    json_option,
    shared_options,
    table_option,
    with_defaults,
)
from chromanoise.cli.output import refuse_taken_inputs, write_json, write_table
from chromanoise.cli.progress import progress_of_step
from chromanoise.errors import InputError
from chromanoise.exposure import conditions
from chromanoise.study import compare_study, default_of, run

_VARY, _FIRST, _LAST = (default_of("compare", name) for name in ("vary", "first", "last"))
_START = f"{_VARY}={_FIRST:g}:{_LAST:g}"


@click.command()
@with_defaults("compare")
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@shared_options
@closed_form_options
@click.option(
    "--sweep",
    metavar="NAME=FIRST:LAST",
    help=f"Parameter that varies: {', '.join(f'{s.name} [{s.unit}]' for s in SWEEPS.values())}. "
    f"[default: {_START}]",
)
@click.option("--points", type=WHOLE, help="Number of values of the sweep.")
@click.option(
    "--quantity",
    type=click.Choice(list(QUANTITIES)),
    help="Quantity to compare.",
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
    matrices: str,
    table: str | None,
    json_target: str | None,
    copy_as: str | None,
    **settings: Any,
) -> None:
    """Compare SENSORS over a range of one parameter: SNR, color error, crossovers.

    The exposure time is solved once, at --lux and before the sweep, so that the brightest channel
    of a perfect white fills --saturate (99 %) of full well; --time-ms sets it.
    """
    study = compare_study(sensors, {**settings, **_span(sweep)}, matrices=matrices.split(","))
    if copy_as is not None:
        print_copy(copy_as, study)
        return
    refuse_taken_inputs({"--json": json_target, "--table": table}, sensors, settings)
    (result,) = run(study, progress=progress_of_step).sweeps
    if table is not None:
        write_table(result.to_table(), table)
    if json_target:
        write_json(result.to_dict(), json_target)
    if json_target != "-":
        tables.print_conditions(f"the start of the sweep, {conditions(result.points)}")
        tables.print_comparison(result.curves, result.crossovers, result.bands)


def _span(text: str | None) -> dict[str, Any]:
    """Parse NAME=FIRST:LAST: the parameter and its range."""
    if text is None:
        return {}
    name, _, span = text.partition("=")
    try:
        first, last = (float(part) for part in span.split(":"))
    except ValueError:
        raise InputError(
            "--sweep", "must be NAME=FIRST:LAST, e.g. lux=0.01:1000", value=text
        ) from None
    return {"vary": name, "first": first, "last": last}
