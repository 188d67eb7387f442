"""The commands on studies and their outputs, from ``chromanoise run`` to ``diff``."""

import os
from dataclasses import replace
from pathlib import Path

import click
from click.core import ParameterSource

from chromanoise.base import (
    InputError,
    claimed_folder,
    json_text,
    refuse_unwritable,
    whole_folder,
    write_whole,
)
from chromanoise.charts import shown
from chromanoise.cli.analyses import print_run
from chromanoise.cli.options import PATH, WHOLE, command, out_option
from chromanoise.cli.output import (
    as_json,
    fail_if_option,
    json_option,
    leave_if_failed,
    print_lines,
    refuse_output,
    write_outputs,
)
from chromanoise.cli.terminal_tables import print_table
from chromanoise.study import (
    RESULT_KINDS,
    STARTER,
    Study,
    agreement_of,
    agreement_text,
    differences_of,
    file_digests,
    read_study,
    recorded_run,
    study_schema,
)
from chromanoise.web import sights_of, study_report

_MOST_ROWS = 20
_changes = click.option(
    "--set",
    "changes",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change one value, e.g. light.level_lux=3 or sensors.0.name=onyx-rgb; repeatable.",
)
_threads = click.option(
    "--threads", type=WHOLE, help="Threads for pictures. [default: one per core]"
)


@command()
@click.argument("study", type=PATH)
@out_option("Output folder. [default: out/<name of STUDY>]")
@_changes
@_threads
@fail_if_option
def run(
    study: Path,
    out: Path | None,
    changes: tuple[str, ...],
    threads: int | None,
    fail_if: tuple[str, ...],
) -> None:
    """Run all of STUDY, a TOML file as `chromanoise init` writes it.

    If a run was stopped, the same command computes the missing results. If a run ends with an
    error, the folder stays as it was. Every result records version, study, seed and hash;
    `chromanoise rerun` runs the study of a result again and compares the results.
    """
    failed = print_run(
        read_study(study, changes, change_label="--set"),
        out or Path("out") / study.stem,
        threads,
        answers=True,
        fail_if=fail_if,
    )
    leave_if_failed(failed)


@command()
@click.argument("output", type=PATH)
@out_option("Output folder.", required=True)
@_threads
def rerun(output: Path, out: Path, threads: int | None) -> None:
    """Run the study of OUTPUT again, into another folder, and compare the results.

    OUTPUT is a result of `chromanoise run`, or its folder. The command needs the same version of
    chromanoise. It works from any folder, also after the project was moved; but if results and
    project have only the root folder in common, run the command in the folder of the project.
    Results are
    byte-identical if numpy, scipy, the BLAS kernel and the processor type are also the same;
    otherwise analyses agree to a relative 1e-9. The last line reports the agreement, or where the
    largest difference is; the exit code is 1 if the results do not agree.
    """
    recorded = recorded_run(output)
    if os.path.realpath(out) == os.path.realpath(recorded.folder):
        raise InputError(
            "--out", "must be another folder than that of OUTPUT", value=str(out), remedy="name one"
        )
    print_run(recorded.study, out, threads, recorded.place)
    found = agreement_of(recorded.folder, out)
    click.echo(agreement_text(found), err=True)
    if not found.agrees:
        click.get_current_context().exit(1)


@command()
@click.argument("first", type=PATH)
@click.argument("second", type=PATH)
@json_option
def diff(first: Path, second: Path, json_target: str | None) -> None:
    """Which inputs, settings and numbers of two outputs differ, by size.

    FIRST and SECOND are folders of `chromanoise run`, or files of --json, also of different
    versions of chromanoise. Keys that only one of them has are named. The exit code is 0 if inputs,
    settings and results are equal (numbers to a relative 1e-9; version and machine may differ),
    and 1 if not. The 20 largest differences are printed; --json has all.
    """
    refuse_output(json_target, "--json", str(first), str(second))
    found = differences_of(first, second)
    write_outputs(as_json(json_target, found.to_dict))
    if json_target != "-":
        print_lines(found.causes())
        table = found.to_table()
        print_table(replace(table, rows=table.rows[:_MOST_ROWS]))
        print_lines(found.effects())
    if not found.equal:
        click.get_current_context().exit(1)


@command()
@click.argument("result", type=click.Choice(list(RESULT_KINDS)))
def schema(result: str) -> None:
    """The JSON Schema of what `chromanoise RESULT --json` writes: each key with its description.

    compare-map is `chromanoise compare --and`. A later release may add keys.
    """
    click.echo(json_text(RESULT_KINDS[result].json_schema()), nl=False)


@command()
@click.option(
    "--schema", is_flag=True, help="Print the JSON Schema, for editors and other programs."
)
def study(schema: bool) -> None:
    """Print a commented study file with common keys, or the JSON Schema of all keys."""
    click.echo(json_text(study_schema()) if schema else STARTER, nl=False)


@command()
@click.argument("study", required=False, type=PATH)
@click.option("--design", is_flag=True, help="Write a design for `chromanoise optimize` instead.")
def init(study: Path | None, design: bool) -> None:
    """Write a commented starter file STUDY [default: study.toml; with --design design.toml]."""
    file = study or Path("design.toml" if design else "study.toml")
    if file.exists():
        raise InputError(
            str(file), "must not exist yet", remedy=("name another file", "move it away")
        )
    text, next_step = STARTER, "run"
    if design:
        from chromanoise.apps.design import DESIGN_STARTER

        text, next_step = DESIGN_STARTER, "optimize"
    write_whole(file, text.encode("utf-8"))
    click.echo(f"{file}: change it, then `chromanoise {next_step} {file}`")


@command()
@click.argument("study", type=PATH)
@out_option(
    "Output file. An existing report.html that this command did not write is replaced only if "
    "--out names it.",
    default="report.html",
)
@_changes
@click.option("--figures", type=PATH, help="Folder for the figures as SVG and PDF.")
def report(study: Path, out: Path, changes: tuple[str, ...], figures: Path | None) -> None:
    """Write STUDY as one self-contained HTML file: charts, tables, equations, sliders.

    The file needs no network and no other files.
    """
    parsed = read_study(study, changes, change_label="--set")
    refuse_output(out, "--out", str(study), *file_digests(parsed))
    if figures is not None:
        refuse_unwritable(figures)
    source = click.get_current_context().get_parameter_source("out")
    named = source is not ParameterSource.DEFAULT
    if not named:
        with claimed_folder(out.parent, "report") as claimed:
            claimed.refuse_taken([out.name], remedy=("name it with --out", "move it away"))
    page = _page(parsed, figures)  # figures may go to the same folder, which is claimed once a time
    if named:
        write_whole(out, page)
    else:
        with whole_folder(out.parent, "report") as folder:
            (folder / out.name).write_bytes(page)
    click.echo(out)


def _page(study: Study, figures: Path | None) -> bytes:
    """The HTML of the report; its figures are written if a folder for them is given."""
    charted = shown(study)
    page = study_report(charted, sights_of(charted))
    if figures is not None:
        from chromanoise.charts import study_figures, write_figures

        drawn = study_figures(charted)
        with whole_folder(figures, "report") as folder:
            written = write_figures(drawn, folder, endings=("svg", "pdf"))
        for file in written:
            click.echo(figures / file.name)
    return page.encode("utf-8")
