"""Style of all Matplotlib figures, and their files in PNG, SVG and PDF.

The colors are color-blind safe; dash patterns, marks and letters repeat what the colors show.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from io import BytesIO
from itertools import cycle
from pathlib import Path
from textwrap import fill
from typing import Any

import matplotlib.style
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.transforms import ScaledTranslation

from chromanoise.base import palette, write_whole
from chromanoise.spectra import INFRARED_FROM_NM

INK, QUIET, FAINT = palette.INK, palette.QUIET, palette.FAINT
"""Text and light; secondary text and helping lines; areas."""

SENSOR_DASHES: dict[str, Any] = {
    "onyx-rgbw": "solid",
    "onyx-rgb-ircut": (0, (6, 2)),
    "onyx-rgb": (0, (2, 1.2)),
    "onyx-rgbw-ircut": (0, (6, 2, 1.5, 2)),
}
_OTHER_DASHES: tuple[Any, ...] = (
    (0, (10, 2)),
    (0, (1, 2.5)),
    (0, (10, 2, 2, 2, 2, 2)),
    (0, (4, 1.2)),
    (0, (1, 1)),
    (0, (10, 2, 1, 2)),
    (0, (4, 4)),
    (0, (2, 1, 6, 1)),
)

_MOST_DASHED = 3
_MARKS = "osD^vP"

_RC = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial", "sans-serif"],
    "font.size": 9.0,
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlepad": 8.0,
    "axes.labelsize": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": QUIET,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "lines.linewidth": 1.6,
    "lines.dash_capstyle": "butt",
    "lines.scale_dashes": True,
    "mathtext.fontset": "dejavusans",
    # text stays text in SVG and PDF, and the same figure gives the same bytes
    "svg.fonttype": "none",
    "svg.hashsalt": "chromanoise",
    "pdf.fonttype": 42,
}


@contextmanager
def chromanoise_style() -> Iterator[None]:
    """Context with Matplotlib's defaults plus this style, independent of the user's settings."""
    with matplotlib.style.context(["default", _RC]):
        yield


def channel_color(name: str) -> str:
    """The color of a channel by its name; the text color for a name outside the palette.

    Parameters
    ----------
    name
        Name of the channel.
    """
    return palette.channel_color(name) or INK


def paled(color: str) -> tuple[float, ...]:
    """A color halfway to white: a second arrow on the same axis, without transparency."""
    return tuple(0.5 + 0.5 * part for part in to_rgb(color))


def as_index(name: str) -> str:
    """A channel's name as the index of a letter in a formula, whatever characters it has."""
    plain = re.sub(r"[\\^~]", "", name)
    escaped = re.sub(r"([_$%#&{}])", r"\\\1", plain)
    return rf"\mathrm{{{escaped}}}"


def sensor_dashes(names: Iterable[str]) -> dict[str, Any]:
    """The dash pattern of each sensor of a figure, so that curves differ not only in color.

    The paper's sensors have fixed patterns; the others get the remaining patterns in order, which
    repeat when all are used.

    Parameters
    ----------
    names
        Names of the sensors; duplicates count once.

    Examples
    --------
    >>> dashes = sensor_dashes(["mine", "onyx-rgbw", "yours"])
    >>> dashes["onyx-rgbw"], dashes["mine"] == dashes["yours"]
    ('solid', False)
    """
    distinct = dict.fromkeys(names)
    others = (name for name in distinct if name not in SENSOR_DASHES)
    free = dict(zip(others, cycle(_OTHER_DASHES), strict=False))
    return {name: SENSOR_DASHES.get(name, free.get(name)) for name in distinct}


def are_many(names: Iterable[str]) -> bool:
    """Whether sensors have their names at their curves and not in a legend: more than three."""
    return len(set(names)) > _MOST_DASHED


def sensor_lines(names: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Color and dash pattern of the line of each sensor of a figure, as arguments of ``plot``.

    Each sensor has a color; from the eleventh on, the colors repeat with a dash pattern.

    Parameters
    ----------
    names
        Names of the sensors; duplicates count once.

    Examples
    --------
    >>> sensor_lines(["onyx-rgbw"])
    {'onyx-rgbw': {'color': '#3F90DA', 'linestyle': 'solid'}}
    >>> len({line["color"] for line in sensor_lines("abcdefghij").values()})
    10
    """
    colors, patterns = [light for light, _ in palette.SENSORS], ("solid", *_OTHER_DASHES)
    return {
        name: {
            "color": colors[i % len(colors)],
            "linestyle": patterns[i // len(colors) % len(patterns)],
        }
        for i, name in enumerate(dict.fromkeys(names))
    }


def sensor_mark(i: int, color: Any = INK) -> dict[str, Any]:
    """The mark of a sensor by its index, as arguments of ``plot``: the same as in the SVG charts.

    Twelve sensors differ: six shapes, full or hollow.

    Parameters
    ----------
    i
        Index of the sensor in the study.

    Examples
    --------
    >>> [sensor_mark(i)["marker"] for i in (0, 1, 6)]
    ['o', 's', 'o']
    """
    turn, shape = divmod(i, len(_MARKS))
    fill = color if shape % 2 == turn % 2 else "white"
    return {"marker": _MARKS[shape % len(_MARKS)], "color": color, "markerfacecolor": fill}


def write_sensor(ax: Axes, origin: str, i: int, names: Sequence[str], *, letters: int) -> None:
    """The title of a panel: a sensor's name after its mark, smaller of many sensors.

    Parameters
    ----------
    origin
        Origin of the curves, told of up to three sensors.
    i
        Index of the sensor in the study.
    names
        Names of all sensors of the study.
    letters
        Length of a line.
    """
    many, before = are_many(names), "\u00a0" * 4 if len(names) > 1 else ""  # SVG drops others
    size, weight = (8.0, "normal") if many else (10.0, "bold")
    label = names[i] if many else sensor_label(names[i], origin)
    title = fill(label, letters, initial_indent=before, subsequent_indent=before)
    ax.set_title(title, fontsize=size, fontweight=weight)
    if not before:
        return
    root = ax.get_figure(root=True)
    assert root is not None  # a panel of a study's figure
    up = (8.0 + size * (0.36 + 1.2 * title.count("\n"))) / 72  # beside the first line
    above = ScaledTranslation(4 / 72, up, root.dpi_scale_trans)
    look = sensor_mark(i, sensor_lines(names)[names[i]]["color"])
    ax.plot([0], [1], transform=ax.transAxes + above, clip_on=False, markersize=6, **look)


def mark_zero(ax: Axes, *, axis: str = "y") -> None:
    """Draw the line of 0 dB where an axis has negative values."""
    low, high = sorted(ax.get_ylim() if axis == "y" else ax.get_xlim())
    if low < 0 <= high:
        (ax.axhline if axis == "y" else ax.axvline)(0, color=INK, linewidth=0.8, zorder=1)


def matrix_dashes(names: Iterable[str]) -> dict[str, Any]:
    """A dash pattern per matrix, the first solid; for figures with a color per sensor."""
    return dict(zip(dict.fromkeys(names), cycle(("solid", *_OTHER_DASHES)), strict=False))


def spread(wanted: Sequence[float], gap: float) -> list[float]:
    """Places between 0 and 1 near the wanted ones, ``gap`` apart, in the same order.

    Parameters
    ----------
    wanted
        Wanted places.
    gap
        Least distance; smaller where there is not enough room.

    Examples
    --------
    >>> [round(place, 3) for place in spread([0.5, 0.5, 0.9], 0.1)]
    [0.5, 0.6, 0.9]
    """
    step = min(gap, 1 / max(1, len(wanted) - 1))
    order = sorted(range(len(wanted)), key=lambda i: wanted[i])
    places = [0.0] * len(wanted)
    low = 0.0
    for i in order:
        places[i] = max(wanted[i], low)
        low = places[i] + step
    high = 1.0
    for i in reversed(order):
        places[i] = min(places[i], high)
        high = places[i] - step
    return places


def sensor_label(sensor_name: str, origin: str) -> str:
    """The sensor's name, and whether its curves are a reconstruction or a model."""
    return f"{sensor_name} ({origin})" if origin in ("reconstruction", "model") else sensor_name


def framed_figure(width_in: float, height_in: float) -> Figure:
    """A figure that makes room for the labels of its axes."""
    engine = ConstrainedLayoutEngine(w_pad=0.075, h_pad=0.075)
    return Figure(figsize=(width_in, height_in), layout=engine)


def write_beside(
    ax: Axes, text: str, at: Sequence[float], by: tuple[float, float], **look: Any
) -> None:
    """Write a text some points right of and above a place; ``look`` as of ``annotate``."""
    ax.annotate(text, (at[0], at[1]), xytext=by, textcoords="offset points", **look)


def legend_beside(ax: Axes, *, fontsize: float, **more: Any) -> None:
    """Put the legend at the right of the axes."""
    place: dict[str, Any] = {"loc": "upper left", "bbox_to_anchor": (1.01, 1.0)}
    ax.legend(**place, fontsize=fontsize, frameon=False, **more)


def write_heading(ax: Axes, title: str, facts: str = "") -> None:
    """A bold title, and under it one quiet line of facts."""
    lines = facts.count("\n") + 1 if facts else 0
    ax.set_title(title, pad=8.0 + 12.0 * lines)
    if facts:
        look: dict[str, Any] = {"ha": "left", "va": "bottom", "color": QUIET, "fontsize": 8}
        corner: dict[str, Any] = {"xycoords": "axes fraction", "annotation_clip": False}
        write_beside(ax, facts, (0, 1), (0, 6), **look, **corner)


def shade_nir(ax: Axes, last_nm: float) -> None:
    """A quiet area over the wavelengths that carry no color."""
    ax.axvspan(INFRARED_FROM_NM, last_nm, color=FAINT, alpha=0.6, linewidth=0, zorder=0)
    ax.text(
        last_nm - 5,
        0.97,
        "near infrared",
        transform=ax.get_xaxis_transform(),
        ha="right",
        va="top",
        color=QUIET,
        fontsize=8,
    )


_DPI = 150
_FORMATS: dict[str, dict[str, Any]] = {  # without a date, so that equal figures are equal files
    "png": {},
    "svg": {"metadata": {"Date": None}},
    "pdf": {"metadata": {"CreationDate": None}},
}


def write_figures(
    figures: Mapping[str, Figure], folder: Path | str, *, endings: Sequence[str] = tuple(_FORMATS)
) -> tuple[Path, ...]:
    """Write each figure in each format, named by its key; every file is written atomically.

    Parameters
    ----------
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


def figure_bytes(figure: Figure, ending: str, *, dpi: int = _DPI) -> bytes:
    """The bytes of one file: ``png``, ``svg`` or ``pdf``; equal figures give equal bytes.

    Parameters
    ----------
    dpi
        Dots per inch of a PNG, and of pictures inside other files.
    """
    buffer = BytesIO()
    with chromanoise_style():
        figure.savefig(buffer, format=ending, **_FORMATS[ending], dpi=dpi)
    return buffer.getvalue()
