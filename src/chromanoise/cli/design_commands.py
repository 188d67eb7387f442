"""The commands ``chromanoise optimize`` and ``chromanoise sensitivity``."""

import time
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from chromanoise.apps.design import DEFAULT_OBJECTIVES, OBJECTIVES, half_widths, sensitivity_of
from chromanoise.base import InputError
from chromanoise.cli import terminal_tables
from chromanoise.cli.options import (
    PATH,
    WHOLE,
    command,
    matrix_option,
    notes_option,
    out_option,
    own_option,
    table_option,
    with_settings,
)
from chromanoise.cli.output import (
    as_json,
    as_table,
    duration,
    json_option,
    print_lines,
    refuse_output,
    refuse_taken_inputs,
    write_outputs,
)
from chromanoise.io import Column, Table, head
from chromanoise.study import study_of

if TYPE_CHECKING:
    from chromanoise.apps.design import Design, Progress


_REPORTED_EVERY_S = 10.0
_WIDTH = 100  # largest width of a table
_tolerance_option = partial(own_option, heading="Tolerances")
_SHOWN = 8  # members in the table on the terminal, in addition to extremes and knee


@command()
@click.argument("design", type=PATH)
@click.option("--budget", type=WHOLE, help="Sensors to evaluate. [default: design.budget]")
@click.option("--seed", type=WHOLE, help="Seed of the random numbers. [default: design.seed]")
@click.option("--resume", is_flag=True, help="Continue the stopped search in the output folder.")
@click.option(
    "--scheduler",
    metavar="ADDRESS|local",
    help="Evaluate on a dask cluster, with the same result.",
)
@out_option("Output folder. [default: out/<name of DESIGN>]")
@json_option
def optimize(
    design: Path,
    budget: int | None,
    seed: int | None,
    resume: bool,
    scheduler: str | None,
    out: Path | None,
    json_target: str | None,
) -> None:
    """Search the sensors with the best trade-offs between the objectives of DESIGN.

    DESIGN is a TOML file as `chromanoise init --design` writes it: filters, IR-cut, silicon,
    exposure and matrix, with fixed and free numbers. The output folder receives front.json,
    front.csv, front.svg and sensors/NAME.json, which every command takes as SENSOR. A stopped
    search continues with --resume. A folder that holds another design is refused.
    """
    from chromanoise.apps.design import (
        CHECKPOINT,
        optimized,
        read_design,
        scheduler_at,
        with_effort,
    )

    document = with_effort(read_design(design), budget=budget, seed=seed)
    refuse_output(json_target, "--json", str(design))
    folder = out or Path("out") / design.stem
    cluster: Any = nullcontext() if scheduler is None else scheduler_at(scheduler)
    with cluster as evaluate_on:
        try:
            found = optimized(
                document,
                folder,
                resume=resume,
                evaluate_on=evaluate_on,
                progress=_reporter(document.design.objectives),
            )
        except KeyboardInterrupt:
            if (folder / CHECKPOINT).exists():
                click.echo(f"chromanoise: --resume continues the search of {folder}", err=True)
            raise
    write_outputs(as_json(json_target, found.to_dict))
    if json_target != "-":
        _print_design(found, folder)


def _reporter(objectives: tuple[str, ...]) -> Any:
    """A function that prints the front of a running search, then its polish, every ten seconds."""
    reported = time.monotonic()
    search: tuple[float, int] | None = None  # time and evaluations of the first report
    polish: tuple[float, int] | None = None  # of the first gradients: compiling is over

    def report(now: "Progress") -> None:
        nonlocal reported, search, polish
        moment = time.monotonic()
        search = search or (moment, now.evaluations)
        if polish is None and now.gradients:
            polish, reported = (moment, now.gradients), moment
        (start, first), done, most = search, now.evaluations, now.budget
        if now.most_gradients:
            (start, first), done, most = polish or (moment, 0), now.gradients, now.most_gradients
        if done == first or moment - reported < _REPORTED_EVERY_S:
            return
        reported = moment
        left = duration((moment - start) * (most - done) / (done - first))
        if now.most_gradients:
            click.echo(
                f"polish of the front: {done} of at most about {most} gradients, at most about "
                f"{left} left",
                err=True,
            )
            return
        click.echo(
            f"{done} of {most} sensors, about {left} left before the polish; "
            f"{_front_so_far(now, objectives)}",
            err=True,
        )

    return report


def _front_so_far(now: "Progress", objectives: tuple[str, ...]) -> str:
    if not len(now.objectives):
        return "no sensor meets the constraints yet"
    spans = [
        f"{name} {low:.4g} to {high:.4g}"
        for name, low, high in zip(
            objectives, now.objectives.min(axis=0), now.objectives.max(axis=0), strict=True
        )
    ]
    return f"front of {len(now.objectives)}: {', '.join(spans)}"


def _print_design(found: "Design", folder: Path) -> None:
    print_lines(found.sentences)
    terminal_tables.print_conditions(found.conditions)
    terminal_tables.print_table(_objectives_table(found), width=_WIDTH)
    terminal_tables.print_table(_values_table(found), width=_WIDTH)
    print_lines([""])
    written = f"{folder}: front.json, front.csv, front.svg, sensors/ ({len(found.members)} files)"
    print_lines([written])
    command = found.analyze_command(found.front.knee.name, str(folder))
    if command:
        where = " in the first scene" if len(found.task.scenes) > 1 else ""
        print_lines([f"To analyze {found.front.knee.name}{where}: {command}"])


def _objectives_table(found: "Design") -> Table:
    """Objectives of the references, the extremes, the knee, and some members between them."""
    front = found.to_table()
    first = len(found.references)
    spread = np.linspace(first, len(front.rows) - 1, min(_SHOWN, len(found.members)))
    marked = [first + i for i, one in enumerate(found.members) if one.extreme_of or one.knee]
    rows = sorted({*range(first), *marked, *spread.round().astype(int).tolist()})
    columns = [*range(1 + len(found.front.objectives)), -1]
    return Table(
        title=f"Objectives ({len(rows) - first} of {len(found.members)} sensors of the front)",
        columns=tuple(front.columns[j] for j in columns),
        rows=tuple(tuple(front.rows[i][j] for j in columns) for i in rows),
    )


def _values_table(found: "Design") -> Table:
    """Parameters of the extremes and the knee, one row per parameter."""
    shown = [i for i, one in enumerate(found.members) if one.extreme_of or one.knee]
    names = [found.members[i].name for i in shown]
    return Table(
        title="Parameters",
        columns=(
            Column(name="parameter"),
            *(Column(name=name, digits=".4g") for name in names),
            Column(name="bounds"),
        ),
        rows=tuple(
            (
                head(Column(name=one.name, unit=one.unit)),
                *(one.values[i] for i in shown),
                one.bounds,
            )
            for one in found.shown_numbers()
        ),
        notes=("front.csv has all sensors of the front.",),
    )


@command()
@with_settings("sensitivity")
@click.argument("sensor")
@matrix_option
@_tolerance_option(
    "--objectives",
    default=",".join(DEFAULT_OBJECTIVES),
    show_default=True,
    metavar="NAME[,NAME...]",
    help=f"Objectives: {', '.join(OBJECTIVES)}. The first one orders the table.",
)
@_tolerance_option(
    "--loss",
    "losses",
    multiple=True,
    metavar="NAME=VALUE",
    help="Allowed loss of an objective in its unit, e.g. snr_y_db=0.1. The table then has the "
    "change of each parameter that causes it, alone and together with all others. Repeatable.",
)
@_tolerance_option(
    "--tolerance-nm",
    type=float,
    help="Tolerance of all wavelengths, half width [nm].",
)
@_tolerance_option(
    "--tolerance-percent",
    type=float,
    help="Tolerance of all other values, half width [%].",
)
@_tolerance_option(
    "--draws",
    common=False,
    type=WHOLE,
    default=0,
    show_default=True,
    help="Number of random sensors within the tolerances.",
)
@_tolerance_option(
    "--seed",
    type=WHOLE,
    default=0,
    show_default=True,
    common=False,
    help="Seed of the draws.",
)
@_tolerance_option(
    "--keep-matrix",
    common=False,
    is_flag=True,
    help="Use the color matrix of the unchanged sensor for changed sensors (no calibration).",
)
@table_option
@json_option
@notes_option
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
    whole_notes: bool,
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
    write_outputs(as_table(table, result.to_table), as_json(json_target, result.to_dict))
    if json_target != "-":
        print_lines(result.sentences)
        for part in _parts(result.to_table(), effects=2 + len(result.objectives)):
            terminal_tables.print_table(replace(part, notes=()))
        notes = [(result.point.sensor.label, note) for note in result.notes]
        terminal_tables.print_notes(notes, whole=whole_notes)


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
