"""The page of ``chromanoise demo``: the paper's tables, verdict, pictures and figures."""

import base64
from collections.abc import Mapping
from importlib import resources

import jinja2

from chromanoise import __version__
from chromanoise._palette import channel_color
from chromanoise.catalog.sensors import RECONSTRUCTION
from chromanoise.imaging import Picture, png_bytes
from chromanoise.io.table import number_text
from chromanoise.paper import (
    Reproduction,
    as_printed,
    luminance_budget,
    paper_tables,
    set_aside_reasons,
    table_5_finding,
    verdict,
)
from chromanoise.paper.study import PRINTED_TIMES_MS, RGB_12, RGBW_12, WELL_SHARE


def demo_page(
    result: Reproduction,
    pictures: tuple[Picture, Picture],
    figures: Mapping[str, str],
    captions: Mapping[str, str],
) -> str:
    """The page as self-contained HTML, without network access.

    Parameters
    ----------
    result
        The tables and the study behind them.
    pictures
        The same scene through both sensors.
    figures, captions
        SVG text and one sentence per figure, by the figure's name.
    """
    template = resources.files("chromanoise.report").joinpath("demo.html.j2").read_text("utf-8")
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["db"] = number_text
    environment.filters["printed"] = as_printed
    return environment.from_string(template).render(
        version=__version__,
        mark=channel_color("B"),
        result=result,
        verdict=verdict(result.study),
        table_5=table_5_finding(result.study),
        set_aside=set_aside_reasons(result.study),
        note=RECONSTRUCTION,
        well_percent=100 * WELL_SHARE,
        times=[
            (name, printed, 1e3 * result.study.times_s[name])
            for name, printed in PRINTED_TIMES_MS.items()
        ],
        tables=paper_tables(result),
        budgets=[
            (column, luminance_budget(result.study.columns[column])) for column in (RGBW_12, RGB_12)
        ],
        pictures=[(picture, _data_uri(png_bytes(picture.srgb))) for picture in pictures],
        figures=[
            (name, _data_uri(svg.encode(), "image/svg+xml"), f"{_numbered(name)} {captions[name]}")
            for name, svg in figures.items()
        ],
    )


def _numbered(name: str) -> str:
    """Figure 3. of figure-03-measurement."""
    return f"Figure {int(name.split('-')[1])}."


def _data_uri(content: bytes, kind: str = "image/png") -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"
