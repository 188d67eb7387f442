"""``chromanoise demo``."""

from pathlib import Path

import click

from chromanoise._files import refuse_unwritable, whole_folder
from chromanoise.cli import tables
from chromanoise.cli.output import write_json
from chromanoise.figures import CAPTIONS, paper_figures, write_figures
from chromanoise.imaging import write_png
from chromanoise.report import demo_page
from chromanoise.study import paper_planes, paper_study, reproduced, reproduction_as_json
from chromanoise.study.pictures import paper_pictures


@click.command()
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("out/demo"),
    show_default=True,
    help="Folder for the page, the figures, the pictures and the tables.",
)
def demo(out: Path) -> None:
    """Everything of the paper: tables, verdict, pictures and figures on one page.

    The sensors are a reconstruction consistent with the paper's printed figures.
    """
    refuse_unwritable(out)
    result = reproduced(paper_study())
    tables.print_reproduction(result)
    pictures = paper_pictures(result.study)
    first, second = (picture.srgb for picture in pictures)
    figures = paper_figures(result.study, paper_planes(result.study), (first, second))
    with whole_folder(out) as folder:
        write_figures(figures, folder)
        for picture in pictures:
            write_png(folder / f"{picture.sensor.name}.png", picture.srgb)
        write_json(reproduction_as_json(result), str(folder / "tables.json"))
        drawn = {name: (folder / f"{name}.svg").read_text(encoding="utf-8") for name in figures}
        page = demo_page(result, pictures, drawn, CAPTIONS)
        (folder / "index.html").write_text(page, encoding="utf-8")
    click.echo(f"Open {out / 'index.html'}: the tables, the pictures and figures 1-10.")
