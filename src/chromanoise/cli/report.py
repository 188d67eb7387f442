"""``chromanoise report``."""

from pathlib import Path

import click
from click.core import ParameterSource

from chromanoise._files import claimed_folder, refuse_unwritable, whole_folder, write_whole
from chromanoise.charts import shown
from chromanoise.cli.output import refuse_inputs
from chromanoise.cli.parsing import command
from chromanoise.errors import InputError
from chromanoise.report import sights_of, study_report
from chromanoise.study import Study, file_digests, read_study


@command()
@click.argument("study", type=click.Path(path_type=Path))
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    default=Path("report.html"),
    show_default=True,
    help="Output file. An existing report.html that this command did not write is replaced only if "
    "--out names it.",
)
@click.option(
    "--set",
    "changes",
    multiple=True,
    metavar="KEY=VALUE",
    help="Change one value, e.g. light.level_lux=3 or sensors.0.name=onyx-rgb; repeatable.",
)
@click.option(
    "--figures", type=click.Path(path_type=Path), help="Folder for the figures as SVG and PDF."
)
def report(study: Path, out: Path, changes: tuple[str, ...], figures: Path | None) -> None:
    """Write STUDY as one self-contained HTML file: charts, tables, equations, sliders.

    The file needs no network and no other files.
    """
    parsed = read_study(study, changes, change_label="--set")
    refuse_inputs(out, "--out", str(study), *file_digests(parsed))
    _refuse_unwritable_file(out)
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
        from chromanoise.figures import study_figures, write_figures

        drawn = study_figures(charted)
        with whole_folder(figures, "report") as folder:
            written = write_figures(drawn, folder, endings=("svg", "pdf"))
        for file in written:
            click.echo(figures / file.name)
    return page.encode("utf-8")


def _refuse_unwritable_file(out: Path) -> None:
    """Raise an error before any computation if the file cannot be written."""
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
