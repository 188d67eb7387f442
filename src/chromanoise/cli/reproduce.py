"""``chromanoise reproduce``."""

from pathlib import Path

import click

from chromanoise._files import refuse_unwritable, whole_folder
from chromanoise.cli import tables
from chromanoise.cli.options import WHOLE
from chromanoise.cli.output import write_json
from chromanoise.cli.parsing import command
from chromanoise.cli.progress import progress_of
from chromanoise.paper import (
    paper_planes,
    paper_study,
    reproduced,
    reproduction_as_json,
    witnessed_columns,
)
from chromanoise.spectra import METRICS, Metric


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
        from chromanoise.figures import paper_figures, write_figures
        from chromanoise.paper.pictures import paper_pictures

        first, second = (p.srgb for p in paper_pictures(result.study, seed=seed))
        planes = paper_planes(result.study, seed=seed)
        with whole_folder(out, "reproduce") as folder:
            write_json(reproduction_as_json(result), str(folder / "tables.json"))
            write_figures(paper_figures(result.study, planes, (first, second)), folder)
    if json_target:
        write_json(reproduction_as_json(result), json_target)
    if out:
        click.echo(f"figures 1-10 and tables.json are in {out}", err=json_target == "-")
