"""Write figures to PNG, SVG and PDF files."""

from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from chromanoise._files import write_whole
from chromanoise.figures.style import chromanoise_style

_DPI = 150
_FORMATS: dict[str, dict[str, Any]] = {  # without a date, so that equal figures are equal files
    "png": {"dpi": _DPI},
    "svg": {"metadata": {"Date": None}},
    "pdf": {"metadata": {"CreationDate": None}},
}


def write_figures(
    figures: Mapping[str, Figure], folder: Path | str, *, endings: Sequence[str] = tuple(_FORMATS)
) -> tuple[Path, ...]:
    """Write each figure in each format, named by its key; every file is written atomically.

    Parameters
    ----------
    figures
        E.g. of `paper_figures`.
    folder
        Made if it does not exist.
    endings
        Of ``png``, ``svg`` and ``pdf``.

    Returns
    -------
    paths
        What was written, in the order of the figures.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for name, figure in figures.items():
        for ending in endings:
            path = folder / f"{name}.{ending}"
            write_whole(path, figure_bytes(figure, ending))
            written.append(path)
    return tuple(written)


def figure_bytes(figure: Figure, ending: str) -> bytes:
    """The bytes of one file: ``png``, ``svg`` or ``pdf``; equal figures give equal bytes."""
    buffer = BytesIO()
    with chromanoise_style():
        figure.savefig(buffer, format=ending, **_FORMATS[ending])
    return buffer.getvalue()
