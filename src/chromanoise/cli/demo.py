"""``chromanoise demo``.

``chromanoise reproduce``.

``chromanoise cite``: how to cite the program and the paper whose equations it computes.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import click

from chromanoise.apps.paper import (
    CAPTIONS,
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
from chromanoise.cli import tables
from chromanoise.cli.options import WHOLE, command
from chromanoise.cli.output import progress_of, write_json
from chromanoise.imaging import Picture, write_png
from chromanoise.spectra import METRICS, Metric
from chromanoise.study import study_from_text
from chromanoise.web import Sight, demo_page, study_report

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
@click.option("-o", "--out", type=click.Path(path_type=Path), help="Folder for the ten figures.")
@click.option("--json", "json_target", metavar="FILE|-", help="Write JSON; - for standard output.")
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
        tables.print_reproduction(result)
    if out:
        from chromanoise.apps.paper import paper_figures, paper_pictures
        from chromanoise.charts import write_figures

        first, second = (p.srgb for p in paper_pictures(result.study, seed=seed))
        planes = paper_planes(result.study, seed=seed)
        with whole_folder(out, "reproduce") as folder:
            write_json(reproduction_as_json(result), str(folder / "tables.json"))
            write_figures(paper_figures(result.study, planes, (first, second)), folder)
    if json_target:
        write_json(reproduction_as_json(result), json_target)
    if out:
        click.echo(f"figures 1-10 and tables.json are in {out}", err=json_target == "-")


RELEASE_YEAR = "2026"
"""Of the newest release in the changelog."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """What is cited.

    Attributes
    ----------
    kind
        Of the entry, as BibTeX names it.
    fields
        Further fields in their order, as BibTeX names them.
    text
        The reference as one line.
    """

    kind: str
    key: str
    fields: Mapping[str, str]
    text: str


def references(version: str) -> tuple[Reference, Reference]:
    """The program, and the paper.

    Parameters
    ----------
    version
        Of the program that was used.
    """
    title = "chromanoise: from photons to color, with the noise"
    developers = "the chromanoise developers"
    program = Reference(
        kind="software",
        key="chromanoise",
        fields={
            "author": f"{{{developers}}}",
            "title": f"{{{title}}}",
            "version": version,
            "year": RELEASE_YEAR,
            "license": "BSD-3-Clause",
        },
        text=f"{developers.capitalize()}, {title}, version {version} ({RELEASE_YEAR}).",
    )
    of_paper = (
        "Physical noise propagation in color image construction: a geometrical interpretation"
    )
    paper = Reference(
        kind="inproceedings",
        key="clouet2019",
        fields={
            "author": r"Clouet, Axel and Vaillant, J{\'e}r{\^o}me and Alleysson, David",
            "title": f"{{{of_paper}}}",
            "booktitle": "27th Color and Imaging Conference (CIC27)",
            "year": "2019",
        },
        text=f"Axel Clouet, Jérôme Vaillant, David Alleysson, {of_paper}, 27th Color and Imaging "
        "Conference (CIC27), 2019.",
    )
    return program, paper


def as_bibtex(reference: Reference) -> str:
    """The reference as an entry of BibTeX."""
    width = max(map(len, reference.fields))
    lines = [f"  {name:<{width}} = {{{value}}}," for name, value in reference.fields.items()]
    return "\n".join([f"@{reference.kind}{{{reference.key},", *lines, "}"])


@command()
@click.option("--bibtex", is_flag=True, help="Print BibTeX entries.")
def cite(bibtex: bool) -> None:
    """Print how to cite chromanoise and the paper whose equations it computes.

    The version is that of this installation, so that others can repeat the results with it.
    """
    for reference in references(__version__):
        click.echo(as_bibtex(reference) if bibtex else reference.text)
