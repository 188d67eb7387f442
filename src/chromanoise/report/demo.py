"""The page of ``chromanoise demo``: verdict, pictures, tables, equations, figures, downloads."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from chromanoise import __version__
from chromanoise._palette import channel_color
from chromanoise.catalog.sensors import RECONSTRUCTION
from chromanoise.charts import cause_label
from chromanoise.charts.explanations import explanation_as_json
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
from chromanoise.report.bundle import data_address, environment, with_paper_symbols

_EXPLAINED = ("electrons", "raw", "contravariant", "spectral", "color", "bound", "budget")
_GROUPS = {  # of downloads, in their order: heading, and the files by their endings
    "Pages": (".html",),
    "Tables as data": (".json", ".csv"),
    "Figures and pictures": (".svg", ".pdf", ".png"),
}


def demo_page(
    result: Reproduction,
    pictures: tuple[Picture, Picture],
    figures: Mapping[str, str],
    captions: Mapping[str, str],
    files: Sequence[Path] = (),
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
    files
        The files beside the page, which it offers to download.
    """
    made = environment()
    made.filters["symbols"] = with_paper_symbols
    made.filters["db"] = lambda value: number_text(value).replace("-", "\N{MINUS SIGN}")
    made.filters["printed"] = as_printed
    made.filters["cause"] = lambda cause: cause_label(cause, "Y")
    return made.get_template("demo.html.j2").render(
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
        explanations=[(name, explanation_as_json(name)) for name in _EXPLAINED],
        downloads=_downloads(files),
        pictures=[
            (picture, data_address(png_bytes(picture.srgb), "image/png")) for picture in pictures
        ],
        figures=[
            (
                name,
                data_address(svg.encode(), "image/svg+xml"),
                f"{_numbered(name)} {captions[name]}",
            )
            for name, svg in figures.items()
        ],
    )


def _numbered(name: str) -> str:
    """Figure 3. of figure-03-measurement."""
    return f"Figure {int(name.split('-')[1])}."


def _downloads(files: Sequence[Path]) -> list[tuple[str, list[tuple[str, list[tuple[str, str]]]]]]:
    """Files by group and name: under each name its address and size in each format."""
    groups = []
    for heading, endings in _GROUPS.items():
        named: dict[str, list[tuple[str, str]]] = {}
        for file in sorted(files):
            if file.suffix in endings:
                named.setdefault(file.stem, []).append((file.name, _size(file.stat().st_size)))
        if named:
            groups.append((heading, list(named.items())))
    return groups


def _size(count: int) -> str:
    """A number of bytes.

    Examples
    --------
    >>> _size(20), _size(20480), _size(2_500_000)
    ('1 kB', '20 kB', '2.5 MB')
    """
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{max(1, round(count / 1e3))} kB"
