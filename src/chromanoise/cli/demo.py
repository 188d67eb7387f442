"""The commands ``chromanoise demo``, ``reproduce`` and ``cite``.

``cite`` prints how to cite the program and the paper whose equations it computes.
"""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from chromanoise.apps.paper import (
    CAPTIONS,
    Reproduction,
    paper_figures,
    paper_pictures,
    paper_planes,
    paper_study,
    reproduced,
    reproduction_as_json,
    witnessed_columns,
)
from chromanoise.base import __version__, refuse_unwritable, whole_folder
from chromanoise.charts import shown, write_figures
from chromanoise.cli import terminal_tables
from chromanoise.cli.options import WHOLE, command, out_option
from chromanoise.cli.output import json_option, progress_of, write_json
from chromanoise.imaging import Picture, write_png
from chromanoise.spectra import METRICS, Metric
from chromanoise.study import study_from_text
from chromanoise.web import Sight, demo_page, study_report

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
@out_option("Folder for the page, the figures, the pictures and the tables.", default="out/demo")
def demo(out: Path) -> None:
    """All results of the paper: tables, conclusion, pictures and figures on one page.

    The sensors are a reconstruction consistent with the paper's printed figures.
    """
    refuse_unwritable(out)
    result = reproduced(paper_study())
    terminal_tables.print_reproduction(result)
    pictures = paper_pictures(result.study)
    with whole_folder(out, "demo") as folder:
        figures = _write_figures(result, pictures, 0, folder)
        for picture in pictures:
            write_png(folder / f"{picture.sensor.name}.png", picture.srgb)
        drawn = {name: (folder / f"{name}.svg").read_text(encoding="utf-8") for name in figures}
        (folder / "report.html").write_text(_report(pictures), encoding="utf-8")
        page = demo_page(result, pictures, drawn, CAPTIONS, tuple(folder.iterdir()))
        (folder / "index.html").write_text(page, encoding="utf-8")
    click.echo(f"Open {out / 'index.html'}: the tables, the pictures and figures 1-10.")
    click.echo(f"Open {out / 'report.html'}: both sensors as a report, with sliders.")


def _write_figures(
    result: Reproduction, pictures: tuple[Picture, Picture], seed: int, folder: Path
) -> "dict[str, Figure]":
    """Write the ten figures and the tables."""
    first, second = (picture.srgb for picture in pictures)
    planes = paper_planes(result.study, seed=seed)
    figures = paper_figures(result.study, planes, (first, second))
    write_figures(figures, folder)
    write_json(reproduction_as_json(result), str(folder / "tables.json"))
    return figures


def _report(pictures: tuple[Picture, Picture]) -> str:
    """The report of the same two sensors, with pictures that are already rendered."""
    taken = Sight(
        cube="builtin:checker",
        matrix="kernel",
        sensors=tuple(picture.sensor.name for picture in pictures),
        pictures=tuple(picture.srgb for picture in pictures),
    )
    return study_report(shown(study_from_text(STUDY, source="the demo")), [taken])


@command()
@click.option(
    "--draws", type=WHOLE, default=5000, show_default=True, help="Number of acquisitions."
)
@click.option("--seed", type=WHOLE, default=0, show_default=True, help="Seed of the Monte Carlo.")
@click.option(
    "--metric",
    type=click.Choice(METRICS),
    default="quanta",
    show_default=True,
    help="Unit in which spectra are vectors.",
)
@click.option("--clip", is_flag=True, help="Clip each draw between 0 and full well.")
@out_option("Folder for the ten figures.")
@json_option
def reproduce(
    draws: int, seed: int, metric: Metric, clip: bool, out: Path | None, json_target: str | None
) -> None:
    """The paper's Tables 2-5: as printed, in closed form, by Monte Carlo.

    The sensors are a reconstruction consistent with the paper's printed figures.
    """
    if out:
        refuse_unwritable(out)
    study = paper_study(metric)
    drawn = draws * len(witnessed_columns(study))
    with progress_of("the Monte Carlo", drawn, "draws") as progress:
        result = reproduced(study, draws=draws, seed=seed, clip=clip, progress=progress)
    if json_target != "-":
        terminal_tables.print_reproduction(result)
    if out:
        pictures = paper_pictures(result.study, seed=seed)
        with whole_folder(out, "reproduce") as folder:
            _write_figures(result, pictures, seed, folder)
    if json_target:
        write_json(reproduction_as_json(result), json_target)
    if out:
        click.echo(f"figures 1-10 and tables.json are in {out}", err=json_target == "-")


RELEASE_YEAR = "2026"
"""Of the newest release in the changelog."""


def references(version: str) -> tuple[tuple[str, dict[str, str], str], ...]:
    """The program and the paper: the head and the fields of BibTeX, and the reference as one line.

    Parameters
    ----------
    version
        Of the program that was used.
    """
    title = "chromanoise: from photons to color, with the noise"
    developers = "the chromanoise developers"
    program = {
        "author": f"{{{developers}}}",
        "title": f"{{{title}}}",
        "version": version,
        "year": RELEASE_YEAR,
        "license": "BSD-3-Clause",
    }
    of_paper = (
        "Physical noise propagation in color image construction: a geometrical interpretation"
    )
    paper = {
        "author": r"Clouet, Axel and Vaillant, J{\'e}r{\^o}me and Alleysson, David",
        "title": f"{{{of_paper}}}",
        "booktitle": "27th Color and Imaging Conference (CIC27)",
        "year": "2019",
    }
    developed = f"{developers.capitalize()}, {title}, version {version} ({RELEASE_YEAR})."
    written = (
        f"Axel Clouet, Jérôme Vaillant, David Alleysson, {of_paper}, 27th Color and Imaging "
        "Conference (CIC27), 2019."
    )
    return (
        ("software{chromanoise", program, developed),
        ("inproceedings{clouet2019", paper, written),
    )


@command()
@click.option("--bibtex", is_flag=True, help="Print BibTeX entries.")
def cite(bibtex: bool) -> None:
    """Print how to cite chromanoise and the paper whose equations it computes.

    The version is that of this installation, so that others can repeat the results with it.
    """
    for head, fields, text in references(__version__):
        width = max(map(len, fields))
        lines = [f"  {name:<{width}} = {{{value}}}," for name, value in fields.items()]
        click.echo("\n".join([f"@{head},", *lines, "}"]) if bibtex else text)
