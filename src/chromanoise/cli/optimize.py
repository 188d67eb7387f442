"""``chromanoise optimize``."""

import time
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from chromanoise.cli import tables
from chromanoise.cli.options import WHOLE
from chromanoise.cli.output import json_option, json_text, print_lines, refuse_inputs, write_outputs
from chromanoise.cli.parsing import command
from chromanoise.cli.progress import duration
from chromanoise.exposure import conditions
from chromanoise.io.table import Column, Table
from chromanoise.io.table_formats import head

if TYPE_CHECKING:
    from chromanoise.design import Design, Progress

_REPORTED_EVERY_S = 10.0
_WIDTH = 100  # largest width of a table
_SHOWN = 8  # members in the table on the terminal, in addition to extremes and knee


@command()
@click.argument("design", type=click.Path(path_type=Path))
@click.option("--budget", type=WHOLE, help="Sensors to evaluate. [default: design.budget]")
@click.option("--seed", type=WHOLE, help="Seed of the random numbers. [default: design.seed]")
@click.option("--resume", is_flag=True, help="Continue the stopped search in the output folder.")
@click.option(
    "--scheduler",
    metavar="ADDRESS|local",
    help="Evaluate on a dask cluster, with the same result.",
)
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    help="Output folder. [default: out/<name of DESIGN>]",
)
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
    from chromanoise.design import optimized, read_design, scheduler_at, with_effort

    document = with_effort(read_design(design), budget=budget, seed=seed)
    refuse_inputs(json_target, "--json", str(design))
    folder = out or Path("out") / design.stem
    cluster: Any = nullcontext() if scheduler is None else scheduler_at(scheduler)
    with cluster as evaluate_on:
        found = optimized(
            document,
            folder,
            resume=resume,
            evaluate_on=evaluate_on,
            progress=_reporter(document.design.objectives),
        )
    write_outputs((json_target, lambda: json_text(found.to_dict())))
    if json_target != "-":
        _print_design(found, folder)


def _reporter(objectives: tuple[str, ...]) -> Any:
    """A function that prints the front of a running search every ten seconds."""
    start = reported = time.monotonic()
    first: int | None = None

    def report(now: "Progress") -> None:
        nonlocal first, reported
        first = now.evaluations if first is None else first
        moment = time.monotonic()
        if moment - reported < _REPORTED_EVERY_S:
            return
        reported = moment
        done = now.evaluations - first
        left = (moment - start) * (now.budget - now.evaluations) / done if done else 0.0
        click.echo(
            f"{now.evaluations} of {now.budget} sensors, about {duration(left)} left; "
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
    tables.print_conditions(conditions([one.point for one in found.task.scenes[:1]]))
    tables.print_table(_objectives_table(found), width=_WIDTH)
    tables.print_table(_values_table(found), width=_WIDTH)
    print_lines([*found.sentences, ""])
    written = f"{folder}: front.json, front.csv, front.svg, sensors/ ({len(found.members)} files)"
    print_lines([written])
    command = found.analyze_command(found.front.knee.name, str(folder))
    if command:
        print_lines([f"To analyze the knee: {command}"])


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
    shown = [one for one in found.members if one.extreme_of or one.knee]
    return Table(
        title="Parameters",
        columns=(
            Column(name="parameter"),
            *(Column(name=one.name, digits=".4g") for one in shown),
            Column(name="bounds"),
        ),
        rows=tuple(
            (
                head(Column(name=one.name, unit="" if one.unit == "1" else one.unit)),
                *(float(member.values[i]) for member in shown),
                f"{one.low:g} to {one.high:g}",
            )
            for i, one in enumerate(found.task.space.parameters)
        ),
        notes=("front.csv has all sensors of the front.",),
    )
