"""``chromanoise rerun``."""

import os
from pathlib import Path

import click

from chromanoise.cli.options import WHOLE
from chromanoise.cli.parsing import command
from chromanoise.cli.running import print_run
from chromanoise.errors import InputError
from chromanoise.study import agreement_of, agreement_text, recorded_run


@command()
@click.argument("output", type=click.Path(path_type=Path))
@click.option("-o", "--out", type=click.Path(path_type=Path), required=True, help="Output folder.")
@click.option("--threads", type=WHOLE, help="Threads for pictures. [default: one per core]")
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
