"""``chromanoise rerun``."""

import os
from pathlib import Path

import click

from chromanoise._check import InputError
from chromanoise.cli.options import WHOLE
from chromanoise.cli.running import print_run
from chromanoise.study.runs import study_of_output


@click.command()
@click.argument("output", type=click.Path(path_type=Path))
@click.option("-o", "--out", type=click.Path(path_type=Path), required=True, help="Folder.")
@click.option("--threads", type=WHOLE, help="For pictures. [default: one per core]")
def rerun(output: Path, out: Path, threads: int | None) -> None:
    """Run the study that OUTPUT carries once more: the same bytes, in another folder.

    OUTPUT is a result of `chromanoise run`, or its folder.
    """
    study = study_of_output(output)
    there = output if output.is_dir() else output.parent
    if os.path.realpath(out) == os.path.realpath(there):
        raise InputError(f"--out {out}: holds OUTPUT itself; name another folder to compare with")
    print_run(study, out, threads)
