"""``chromanoise demo``."""

from pathlib import Path

import click

from chromanoise._files import refuse_unwritable, whole_folder
from chromanoise.charts import shown
from chromanoise.cli import tables
from chromanoise.cli.output import write_json
from chromanoise.cli.parsing import command
from chromanoise.figures import CAPTIONS, paper_figures, write_figures
from chromanoise.imaging import Picture, write_png
from chromanoise.paper import (
    paper_planes,
    paper_study,
    reproduced,
    reproduction_as_json,
)
from chromanoise.paper.pictures import paper_pictures
from chromanoise.report import Sight, demo_page, study_report
from chromanoise.study import study_from_text

STUDY = """\
title = "Can the IR-cut be dropped? The paper's two sensors"

[[sensors]]
name = "onyx-rgb-ircut"

[[sensors]]
name = "onyx-rgbw"

[[pictures]]
cube = "builtin:checker"
"""
"""The paper's two sensors, at the longest time at which neither saturates."""


@command()
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    default=Path("out/demo"),
    show_default=True,
    help="Folder for the page, the figures, the pictures and the tables.",
)
def demo(out: Path) -> None:
    """All results of the paper: tables, conclusion, pictures and figures on one page.

    The sensors are a reconstruction consistent with the paper's printed figures.
    """
    refuse_unwritable(out)
    result = reproduced(paper_study())
    tables.print_reproduction(result)
    pictures = paper_pictures(result.study)
    first, second = (picture.srgb for picture in pictures)
    figures = paper_figures(result.study, paper_planes(result.study), (first, second))
    with whole_folder(out, "demo") as folder:
        write_figures(figures, folder)
        for picture in pictures:
            write_png(folder / f"{picture.sensor.name}.png", picture.srgb)
        write_json(reproduction_as_json(result), str(folder / "tables.json"))
        drawn = {name: (folder / f"{name}.svg").read_text(encoding="utf-8") for name in figures}
        (folder / "report.html").write_text(_report(pictures), encoding="utf-8")
        page = demo_page(result, pictures, drawn, CAPTIONS, tuple(folder.iterdir()))
        (folder / "index.html").write_text(page, encoding="utf-8")
    click.echo(f"Open {out / 'index.html'}: the tables, the pictures and figures 1-10.")
    click.echo(f"Open {out / 'report.html'}: both sensors as a report, with sliders.")


def _report(pictures: tuple[Picture, Picture]) -> str:
    """The report of the same two sensors, with pictures that are already rendered."""
    taken = Sight(
        cube="builtin:checker",
        matrix="kernel",
        sensors=tuple(picture.sensor.name for picture in pictures),
        pictures=tuple(picture.srgb for picture in pictures),
    )
    return study_report(shown(study_from_text(STUDY, source="the demo")), [taken])
