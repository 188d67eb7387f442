"""``chromanoise league``."""

from typing import Any

import click

from chromanoise.base import InputError
from chromanoise.cli.options import command, own_option, table_option, with_settings
from chromanoise.cli.output import (
    as_json,
    as_table,
    json_option,
    print_lines,
    refuse_taken_inputs,
    write_outputs,
)
from chromanoise.cli.terminal_tables import print_table
from chromanoise.study import DEFAULT_ISO, RANKED, league_of_study, study_of

_SHOWN = 3  # ISO speeds in the table on a terminal


@command()
@with_settings("league")
@click.argument("sensors", nargs=-1, metavar="[SENSOR]...")
@own_option(
    "--iso",
    default=DEFAULT_ISO,
    show_default=True,
    metavar="FIRST:LAST|A,B,...",
    help="ISO speeds: a range in whole stops, or a list.",
)
@own_option(
    "--sort",
    "by",
    type=click.Choice([one.name for one in RANKED]),
    metavar="|".join(one.name for one in RANKED),
    default=RANKED[0].name,
    show_default=True,
    help="The number by which the cameras are sorted, the best first.",
)
@table_option
@json_option
def league(
    sensors: tuple[str, ...],
    iso: str,
    by: Any,
    table: str | None,
    json_target: str | None,
    **settings: Any,
) -> None:
    """Rank the cameras of the catalog, with each SENSOR among them.

    Shows color SNR loss, color error, SMI, the number of distinguishable colors, and visual noise
    per pixel area at each ISO speed. Low loss, error and noise are good; high SMI and colors are
    good. SENSOR is as in `chromanoise analyze`, with 3 channels or more.
    """
    refuse_taken_inputs({"--json": json_target, "--table": table}, sensors, settings)
    given = [name for name, value in settings.items() if value is not None]
    if given and not sensors:
        raise InputError("SENSOR", "must be given, because options of sensors are", value=given[0])
    study = study_of("league", sensors, settings) if sensors else None
    result = league_of_study(study, iso=iso, by=by)
    write_outputs(as_table(table, result.to_table), as_json(json_target, result.to_dict))
    if json_target != "-":
        print_lines(result.sentences)
        print_table(result.short_table(_SHOWN))
