"""``chromanoise optimize``."""

import time
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from chromanoise.cli import tables
from chromanoise.cli.options import WHOLE
from chromanoise.cli.output import json_option, json_text, print_lines, refuse_inputs, write_outputs
from chromanoise.cli.parsing import command
from chromanoise.cli.progress import duration
from chromanoise.exposure import conditions

if TYPE_CHECKING:
    from chromanoise.design import Design, Progress

_REPORTED_EVERY_S = 10.0
_SHOWN = 12  # members in the table on the terminal


@command()
@click.argument("design", type=click.Path(path_type=Path))
@click.option("--budget", type=WHOLE, help="Evaluated sensors. [default: design.budget]")
@click.option("--seed", type=WHOLE, help="Seed of the search. [default: design.seed]")
@click.option("--resume", is_flag=True, help="Continue the stopped search in the output folder.")
@click.option(
    "--scheduler",
    metavar="ADDRESS|local",
    help="Evaluate on a dask cluster; the front is the same.",
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
    """Search the sensors of DESIGN for the best trades between its objectives.

    DESIGN is a TOML file as `chromanoise init --design` writes it: channels with filters, IR-cut,
    silicon, exposure and matrix, with fixed and free numbers. The output folder has front.json,
    front.csv, front.svg and sensors/NAME.json, which every command takes as SENSOR. A stopped
    search continues with --resume. A folder with another design is refused.
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
        return "none meets the constraints so far"
    spans = [
        f"{name} {low:.4g} to {high:.4g}"
        for name, low, high in zip(
            objectives, now.objectives.min(axis=0), now.objectives.max(axis=0), strict=True
        )
    ]
    return f"front of {len(now.objectives)}: {', '.join(spans)}"


def _print_design(found: "Design", folder: Path) -> None:
    tables.print_conditions(conditions([one.point for one in found.task.scenes[:1]]))
    tables.print_front(found.to_table(), most=_SHOWN + len(found.references))
    print_lines([*found.sentences, ""])
    written = f"{folder}: front.json, front.csv, front.svg, sensors/ ({len(found.members)} files)"
    print_lines([written])
    command = found.analyze_command(found.front.knee.name, str(folder))
    if command:
        print_lines([f"The knee again: {command}"])
