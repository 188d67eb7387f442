"""``chromanoise sensitivity``."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import click

from chromanoise.cli import tables
from chromanoise.cli.options import (
    WHOLE,
    matrix_option,
    table_option,
    with_settings,
)
from chromanoise.cli.output import (
    json_option,
    json_text,
    refuse_taken_inputs,
    table_text,
    write_outputs,
)
from chromanoise.cli.parsing import command
from chromanoise.design import DEFAULT_OBJECTIVES, OBJECTIVES, half_widths, sensitivity_of
from chromanoise.errors import InputError
from chromanoise.io.table import Column, Table
from chromanoise.study import study_of


@command()
@with_settings("sensitivity")
@click.argument("sensor")
@matrix_option
@click.option(
    "--objectives",
    default=",".join(DEFAULT_OBJECTIVES),
    show_default=True,
    metavar="NAME[,NAME...]",
    help=f"Objectives: {', '.join(OBJECTIVES)}. The first one orders the table.",
)
@click.option(
    "--loss",
    "losses",
    multiple=True,
    metavar="NAME=VALUE",
    help="Allowed loss of an objective in its unit, e.g. snr_y_db=0.1. The table then has the "
    "change of each parameter that causes it, alone and together with all others. Repeatable.",
)
@click.option("--tolerance-nm", type=float, help="Tolerance of all wavelengths, half width [nm].")
@click.option(
    "--tolerance-percent", type=float, help="Tolerance of all other values, half width [%]."
)
@click.option(
    "--draws",
    type=WHOLE,
    default=0,
    show_default=True,
    help="Number of random sensors within the tolerances.",
)
@click.option("--seed", type=WHOLE, default=0, show_default=True, help="Seed of the draws.")
@click.option(
    "--keep-matrix",
    is_flag=True,
    help="Use the color matrix of the unchanged sensor for changed sensors (no calibration).",
)
@table_option
@json_option
def sensitivity(
    sensor: str,
    matrix: str,
    objectives: str,
    losses: tuple[str, ...],
    tolerance_nm: float | None,
    tolerance_percent: float | None,
    draws: int,
    seed: int,
    keep_matrix: bool,
    table: str | None,
    json_target: str | None,
    **settings: Any,
) -> None:
    """Effect of 1 nm or 1 % of each parameter of SENSOR on SNR, color error and separation.

    SENSOR is as for `chromanoise analyze`, e.g. a sensor file of a design. The exposure time is
    that of the unchanged sensor.
    """
    study = study_of("sensitivity", [sensor], settings, matrices=[matrix])
    refuse_taken_inputs({"--json": json_target, "--table": table}, [sensor], settings)
    result = sensitivity_of(
        study,
        objectives=[name.strip() for name in objectives.split(",")],
        losses=_losses(losses),
        tolerances=half_widths(tolerance_nm, tolerance_percent),
        draws=draws,
        seed=seed,
        keep_matrix=keep_matrix,
    )
    write_outputs(
        (table, lambda: table_text(result.to_table(), str(table))),
        (json_target, lambda: json_text(result.to_dict())),
    )
    if json_target != "-":
        for part in _parts(result.to_table(), effects=2 + len(result.objectives)):
            tables.print_table(part)


def _parts(whole: Table, *, effects: int) -> list[Table]:
    """The effects and the tolerance budget as two tables, which fit a terminal."""
    first = replace(
        whole,
        columns=whole.columns[:effects],
        rows=tuple(row[:effects] for row in whole.rows if row[1]),  # sums have no effects
    )
    if len(whole.columns) == effects:
        return [first]
    budget = replace(
        whole,
        title="Tolerance budget",
        columns=(whole.columns[0], Column(name="unit"), *whole.columns[effects:]),
        rows=tuple((row[0], str(row[1]).removeprefix("+1 "), *row[effects:]) for row in whole.rows),
    )
    return [replace(first, notes=()), budget]


def _losses(words: Sequence[str]) -> dict[str, float]:
    """Parse NAME=VALUE."""
    found: dict[str, float] = {}
    for word in words:
        name, _, value = word.partition("=")
        try:
            found[name] = float(value)
        except ValueError:
            raise InputError(
                "--loss", "must be NAME=VALUE, e.g. snr_y_db=0.1", value=word
            ) from None
    return found
