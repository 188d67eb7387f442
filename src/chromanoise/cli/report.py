"""``chromanoise report``."""

from pathlib import Path

import click

from chromanoise._files import refuse_unwritable, whole_folder, write_whole
from chromanoise.charts import shown
from chromanoise.cli.output import refuse_inputs
from chromanoise.errors import InputError
from chromanoise.page.equations import EQUATIONS
from chromanoise.report import sights_of, study_report
from chromanoise.study import file_digests, read_study


@click.command()
@click.argument("study", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    default=Path("report.html"),
    show_default=True,
    help="The file.",
)
@click.option(
    "--set",
    "changes",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change one value, e.g. light.level_lux=3 or sensors.0.name=onyx-rgb; repeatable.",
)
@click.option(
    "--figures", type=click.Path(path_type=Path), help="Also its figures, as SVG and PDF."
)
def report(study: Path, out: Path, changes: tuple[str, ...], figures: Path | None) -> None:
    """STUDY as one page that travels: charts, tables, equations, sliders.

    The page is one file that asks for nothing else: open it from disk, send it, print it.
    """
    asked = read_study(study, changes)
    refuse_inputs(out, "--out", str(study), *file_digests(asked))
    _refuse_unwritable_file(out)
    if figures is not None:
        refuse_unwritable(figures)
    there = shown(asked)
    page = study_report(there, EQUATIONS, sights_of(there))
    if figures is not None:
        from chromanoise.figures import study_figures, write_figures

        drawn = study_figures(there)
        with whole_folder(figures) as folder:
            written = write_figures(drawn, folder, endings=("svg", "pdf"))
        for file in written:
            click.echo(figures / file.name)
    write_whole(out, page.encode("utf-8"))
    click.echo(out)


def _refuse_unwritable_file(out: Path) -> None:
    """Say before anything is computed that the file could not be kept."""
    if out.is_dir():
        raise InputError(
            "--out",
            "must be a file",
            value=str(out),
            found=f"{out} is a folder",
            remedy="name a file",
        )
    if not out.exists() or out.is_file():
        refuse_unwritable(out.parent)
