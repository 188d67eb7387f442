"""``chromanoise card``."""

from pathlib import Path
from typing import Any

import click

from chromanoise.base import InputError, write_whole
from chromanoise.charts import PAPERS_IN, Paper, card_ending, card_of, shown
from chromanoise.cli.options import command, matrix_option, out_option, with_settings
from chromanoise.cli.output import refuse_taken_inputs
from chromanoise.study import study_of


@command()
@with_settings("card")
@click.argument("sensors", nargs=-1, required=True, metavar="SENSOR...")
@matrix_option
@out_option(
    "Output file: FILE.pdf, .svg, .png or .html. An existing file is replaced.",
    required=True,
    heading="",
)
@click.option(
    "--paper",
    type=click.Choice(list(PAPERS_IN)),
    default="16:9",
    show_default=True,
    help="Size of the sheet: a slide, or A4 across.",
)
def card(sensors: tuple[str, ...], matrix: str, out: Path, paper: Paper, **settings: Any) -> None:
    """Write one sheet that compares up to five SENSORS, for slides and paper.

    It has the verdict, quantum efficiency, SNR over the light level, budgets of Y, pictures, visual
    noise and color error of the patches, and the settings. SENSOR is as in `chromanoise analyze`.
    """
    study = study_of("card", sensors, settings, matrices=[matrix])
    refuse_taken_inputs({"--out": out}, sensors, settings)
    try:
        ending = card_ending(out)
    except InputError as error:
        raise error.called("--out") from None
    write_whole(out, card_of(shown(study), paper=paper).content(ending))
    click.echo(out)
