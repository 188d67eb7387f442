"""Panels of page charts drawn with Matplotlib: lines, points, bars, ellipses, cells, crossings."""

from collections.abc import Sequence
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.patches import Patch, Polygon, Rectangle
from matplotlib.ticker import EngFormatter, LogFormatter, MaxNLocator

from chromanoise.base import Array, Float
from chromanoise.charts.description import (
    MOST_DASHED,
    Bars,
    Cells,
    Chart,
    Cloud,
    Ellipses,
    Line,
    Panel,
    Point,
    Rule,
    Swatches,
)
from chromanoise.charts.figure_style import (
    FAINT,
    INK,
    QUIET,
    are_many,
    channel_color,
    legend_beside,
    mark_zero,
    matrix_dashes,
    sensor_dashes,
    sensor_lines,
    sensor_mark,
    shade_nir,
    spread,
    write_beside,
)
from chromanoise.charts.numbers import decimal
from chromanoise.geometry import unit_circle
from chromanoise.spectra import INFRARED_FROM_NM

_NAME_POINTS = 11.0  # from one name at the right to the next
_LETTERS = 22  # of a line of the legend beside the axes
_REMARK = 12  # letters of a line of a remark
_HALF_WIDTH_NM = 12.0
_GAP, _HEIGHT = 0.02, 0.075  # of the scale: under the letter, and of the letter
_OUTLINE = unit_circle(48)
_THOUSANDS = 1e4
_BAR_ROWS = 0.62  # height of the bars of a row, in rows
_MOST_NUMBERED = 30  # patches of a row
_LUMA, _LIGHT = (0.299, 0.587, 0.114), 0.5  # a color that is lighter has black numbers
_LEAST_ROOM, _NUMBER_ROOM = 0.03, 0.16  # of the scale, below 0 and for the numbers beside the bars


def draw_panel(chart: Chart, i: int, ax: Axes) -> Axes:
    """Draw one panel of a chart, without its title.

    Dots are drawn by the page alone. Swatches have one row per sensor here. The light of a chart
    of sensitivities and the line of the study's own level are left out.

    Parameters
    ----------
    i
        Index of the panel.
    ax
        Axes of matplotlib to draw on.
    """
    panel = chart.panels[i]
    if any(isinstance(one, Bars) for one in panel.marks):
        return draw_waterfalls(chart, [i], ax)
    if any(isinstance(one, Swatches) for one in panel.marks):
        return _draw_swatches(panel, ax)
    curves = [one for one in panel.marks if isinstance(one, Line)]
    pointed = any(isinstance(one, Point) for one in panel.marks)
    for one in curves:
        _draw_curve(chart, one, ax, pointed=pointed)
    for mark in panel.marks:
        if isinstance(mark, Point):
            _draw_point(chart, mark, ax)
        elif isinstance(mark, Cloud):
            x, y = (numbers(chart, i, mark.first, mark.last) for i in (mark.x, mark.y))
            ax.plot(x, y, ".", color=QUIET, alpha=0.6, label=mark.name)
        elif isinstance(mark, Ellipses):
            _draw_ellipses(chart, mark, ax)
        elif isinstance(mark, Cells):
            _draw_cells(chart, mark, ax)
        elif isinstance(mark, Rule) and mark.height is not None:
            _draw_crossing(mark, mark.height, ax)
    _frame(panel, ax)
    if any(one.channel for one in curves):
        ax.set(xlim=(panel.x.low, panel.x.high), ylim=(0, panel.y.high))
        shade_nir(ax, panel.x.high)
        for c in range(len(curves)):
            _write_letter(chart, curves, c, ax)
    elif any(one.name for one in curves) or any(isinstance(one, Cloud) for one in panel.marks):
        _name_curves(chart, panel, curves, ax)
    return ax


def rows_of_waterfalls(chart: Chart, panels: Sequence[int]) -> list[str]:
    """The names of the bars of some panels; a cause of some alone stands where it is among theirs.

    Parameters
    ----------
    chart, panels
        As `draw_waterfalls`.
    """
    bars = [one for i in panels for one in chart.panels[i].marks if isinstance(one, Bars)]
    names = [_texts(chart, one) for one in bars]
    shares = [(k / len(each), name) for each in names for k, name in enumerate(each)]
    return list(dict.fromkeys(name for _, name in sorted(shares, key=lambda one: one[0])))


def draw_waterfalls(
    chart: Chart, panels: Sequence[int], ax: Axes, *, rows: Sequence[str] | None = None
) -> Axes:
    """Draw the bars of some panels on one axes; in each row those of several sensors side by side.

    Parameters
    ----------
    chart
        The chart ``budget`` of `chromanoise.charts`.
    panels
        Indices of the panels, which have bars.
    ax
        Axes of matplotlib to draw on.
    rows
        Names of the bars from above, where axes share them; ``None`` for those of the panels.
    """
    bars = [one for i in panels for one in chart.panels[i].marks if isinstance(one, Bars)]
    names = [_texts(chart, one) for one in bars]
    rows = rows_of_waterfalls(chart, panels) if rows is None else list(rows)
    high = _BAR_ROWS / max(1, len(bars))
    for k, (one, each) in enumerate(zip(bars, names, strict=True)):
        offset = (k - (len(bars) - 1) / 2) * high
        at = np.array([rows.index(name) + offset for name in each])
        shade = None if len(bars) == 1 else str(0.15 + 0.7 * k / len(bars))
        _draw_bars(chart, one, ax, at=at, high=high, shade=shade)
    ax.set_yticks(range(len(rows)), rows)
    ax.tick_params(axis="y", length=0)
    x = chart.panels[0].x
    below = _LEAST_ROOM if x.low < 0 else 0.0
    span = x.high - x.low
    ax.set(
        xlim=(x.low - below * span, x.high + _NUMBER_ROOM * span),
        ylim=(len(rows) - 0.4, -0.6),
        xlabel=x.label,
    )
    ax.set_axisbelow(True)
    ax.grid(visible=True, axis="x", alpha=0.25)
    mark_zero(ax, axis="x")
    return ax


def _draw_bars(
    chart: Chart, one: Bars, ax: Axes, *, at: Float[Array, " k"], high: float, shade: str | None
) -> None:
    start, end = (numbers(chart, index, one.first, one.last) for index in (one.start, one.end))
    start = np.where([role == "total" for role in one.roles], 0.0, start)
    own = {"cost": QUIET, "gain": "none", "total": INK}
    fills = [own[role] if shade is None or role == "gain" else shade for role in one.roles]
    edges = [INK if shade is not None or fill == "none" else fill for fill in fills]
    look: dict[str, Any] = {"color": fills, "edgecolor": edges, "left": start}
    look |= {"height": high, "linewidth": 1.2} if shade is None else {"height": 0.9 * high}
    name = chart.columns[0].values[one.first]
    left = f"{name}: {decimal(float(end[-1]))} dB remain of {decimal(float(end[0]))} dB"
    ax.barh(at, end - start, label=left, **look)
    small: dict[str, Any] = {} if shade is None else {"fontsize": 7}
    for y, right, text in zip(at, np.maximum(start, end), one.texts, strict=True):
        if len(chart.sensors) <= MOST_DASHED or shade is None:
            write_beside(ax, text, (right, y), (4, 0), va="center_baseline", **small)
    for k in range(1, len(at)) if shade is None else ():
        ends = [at[k - 1] + high / 2, at[k] - high / 2]
        joint = end[k - 1]
        ax.plot([joint, joint], ends, color=QUIET, linewidth=0.8)


def _texts(chart: Chart, one: Bars) -> list[str]:
    return [str(name) for name in chart.columns[one.label].values[one.first : one.last]]


def _draw_swatches(panel: Panel, ax: Axes) -> Axes:
    """A row of patches per sensor under their true colors, with the first number of each patch."""
    marks = [one for one in panel.marks if isinstance(one, Swatches)]
    count = max(len(one.colors) for one in marks)
    for y, one in enumerate(marks):
        for x, color in enumerate(one.colors):
            ax.add_patch(Rectangle((x, y - 0.47), 0.97, 0.94, facecolor=color))
        for x, (number, _) in enumerate(one.texts if count <= _MOST_NUMBERED else ()):
            light = np.dot(to_rgb(one.colors[x]), _LUMA) > _LIGHT
            look: dict[str, Any] = {"ha": "center", "va": "center_baseline", "fontsize": 9}
            ax.text(x + 0.485, y, number, color="black" if light else "white", **look)
    ax.set(xlim=(0, count), ylim=(len(marks) - 0.5, -0.5), xticks=[], yticks=range(len(marks)))
    ax.set_yticklabels([one.name or "true color" for one in marks])
    ax.tick_params(axis="y", length=0)
    ax.spines[:].set_visible(False)
    return ax


def _draw_cells(chart: Chart, one: Cells, ax: Axes) -> None:
    rows = len(chart.columns[one.value].values)
    x, y, value = (numbers(chart, index, 0, rows) for index in (one.x, one.y, one.value))
    values = np.ma.masked_invalid(value.reshape(-1, one.across))
    how: dict[str, Any] = {"cmap": LinearSegmentedColormap.from_list("cells", one.colors)}
    how |= {"vmin": one.low, "vmax": one.high, "shading": "nearest", "rasterized": True}
    ax.set_facecolor(FAINT)
    mesh = ax.pcolormesh(x[: one.across], y[:: one.across], values, **how)
    if one.names:
        named = zip(one.colors, one.names, strict=True)
        patches = [Patch(color=color, label=name) for color, name in named if name]
        legend_beside(ax, fontsize=8, handles=patches)
    else:
        ax.figure.colorbar(mesh, ax=ax, label=one.name[one.name.rindex("[") :])
    for points in one.equal:
        ax.plot(*zip(*points, strict=True), color=INK, marker="" if len(points) > 1 else "|")


def numbers(chart: Chart, index: int, first: int, last: int) -> Float[Array, " k"]:
    """Rows of a column of a chart, NaN where a value is undefined."""
    return np.array(chart.columns[index].values[first:last], dtype=float)


def _curve(chart: Chart, one: Line) -> tuple[Float[Array, " k"], Float[Array, " k"]]:
    return (
        numbers(chart, one.x, one.first, one.last),
        numbers(chart, one.y, one.first, one.last),
    )


def line_style(chart: Chart, one: Line) -> dict[str, Any]:
    """Color and dash of a curve: a color per sensor, and a dash per matrix.

    A channel has its own color, and a dash per sensor of up to three.
    """
    names = chart.sensors
    if one.channel:
        dash = "solid" if are_many(names) else sensor_dashes(names)[names[one.sensor]]
        return {"color": channel_color(one.channel), "linestyle": dash}
    style = sensor_lines(names)[names[one.sensor]]
    dashes = list(matrix_dashes(map(str, range(one.matrix + 1))).values())
    return style | ({"linestyle": dashes[one.matrix]} if one.matrix else {})


def _draw_curve(chart: Chart, one: Line, ax: Axes, *, pointed: bool) -> None:
    """A curve; where its sensor has a point, that has the mark and the name."""
    x, y = _curve(chart, one)
    style, known = line_style(chart, one), np.flatnonzero(np.isfinite(x + y))
    many, several = are_many(chart.sensors), len(chart.sensors) > 1
    if several and known.size and not one.channel and not pointed:
        style |= sensor_mark(one.sensor, style["color"])
        style |= {"markevery": [int(known[-1])], "markersize": 5}
    ax.plot(x, y, label=None if pointed else one.name, **style)
    if one.texts:
        ax.plot(x[known], y[known], ".", color=style["color"], markersize=4)
        for k, side in ((0, -1), (-1, 1)) if known.size and not many else ():
            look: dict[str, Any] = {"ha": "left" if side > 0 else "right", "va": "center"}
            at, text = (x[known[k]], y[known[k]]), one.texts[known[k]]
            write_beside(ax, text, at, (5 * side, 7 * side), color=QUIET, fontsize=8, **look)


def _draw_point(chart: Chart, one: Point, ax: Axes) -> None:
    x, y = (numbers(chart, index, one.row, one.row + 1) for index in (one.x, one.y))
    name = chart.sensors[one.sensor]
    line = sensor_lines(chart.sensors)[name]
    label = fill(name, _LETTERS) if are_many(chart.sensors) else name
    known = np.isfinite(x + y)
    ax.plot(x[known], y[known], label=label, **line | sensor_mark(one.sensor, line["color"]))


def _draw_ellipses(chart: Chart, one: Ellipses, ax: Axes) -> None:
    truth, center = (
        np.stack([numbers(chart, index, one.first, one.last) for index in pair], axis=1)
        for pair in (one.truth, one.center)
    )
    half_axes = np.stack(
        [numbers(chart, index, one.first, one.last) for index in one.half_axes], axis=1
    ).reshape(-1, 2, 2)
    for at, true, halves, color in zip(center, truth, half_axes, one.colors, strict=True):
        outline = at + _OUTLINE @ halves
        ax.add_patch(Polygon(outline, facecolor=color, edgecolor=INK, linewidth=0.7, alpha=0.6))
        ax.plot(*zip(true, at, strict=True), color=INK, linewidth=0.7)
        ax.plot(*true, "+", color=INK, markersize=5)


def _draw_crossing(one: Rule, height: float, ax: Axes) -> None:
    ax.plot(one.at, height, "o", color=INK, markerfacecolor="none", markersize=8)
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.5}
    write_beside(ax, one.text, (one.at, height), (-2, 10), color=QUIET, bbox=box)


def _frame(panel: Panel, ax: Axes) -> None:
    x, y = panel.x, panel.y
    ax.set(xlabel=x.label, ylabel=y.label)
    if x.logarithmic:
        ax.set_xscale("log")
    if y.logarithmic:
        ax.set_yscale("log")
    if any(isinstance(one, Cells) for one in panel.marks):
        for axis, one in ((ax.xaxis, x), (ax.yaxis, y)):
            if one.logarithmic:
                axis.set_major_formatter("{x:g}")
                axis.set_minor_formatter(LogFormatter(minor_thresholds=(1.0, 0.5)))
        return
    ax.grid(visible=True, alpha=0.25)
    if panel.equal:
        margin = 0.03 * max(x.high - x.low, y.high - y.low)
        ax.set(xlim=(x.low - margin, x.high + margin), ylim=(y.low - margin, y.high + margin))
        ax.set_aspect("equal", adjustable="box")
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
            if max(map(abs, (x.low, x.high, y.low, y.high))) >= _THOUSANDS:
                axis.set_major_formatter(EngFormatter(sep=""))
    elif y.low == 0 and not y.logarithmic:
        ax.set_ylim(bottom=0)
    for name, one in (("x", x), ("y", y)):
        if one.zero:
            mark_zero(ax, axis=name)
    small: dict[str, Any] = {"transform": ax.transAxes, "fontsize": 7}
    if panel.remark:
        box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0}
        text = fill(panel.remark, _REMARK)
        ax.text(0.97, 0.97, text, bbox=box, ha="right", va="top", **small)
    if panel.absence:
        ax.text(0.5, 0.5, fill(panel.absence, _LETTERS), ha="center", va="center", **small)


def _name_curves(chart: Chart, panel: Panel, curves: Sequence[Line], ax: Axes) -> None:
    if not are_many(chart.sensors):
        ax.legend(loc="best", fontsize=8)
    elif any(isinstance(one, Point) for one in panel.marks):
        legend_beside(ax, fontsize=7)
    else:
        _write_names(chart, curves, ax)


def _write_names(chart: Chart, curves: Sequence[Line], ax: Axes) -> None:
    """Write the name of each curve at the right, with a thin line from where the curve ends."""
    ends = []
    for one in curves:
        x, y = _curve(chart, one)
        known = np.flatnonzero(np.isfinite(y))
        if known.size:
            ends.append((one, x[known[-1]], y[known[-1]]))
    low, high = ax.get_ylim()
    height_in = ax.get_window_extent().height / ax.figure.dpi
    wanted = [(y - low) / (high - low) for _, _, y in ends]
    places = spread(wanted, _NAME_POINTS / (72 * height_in))
    for (one, x, y), place in zip(ends, places, strict=True):
        ax.annotate(
            one.name,
            (x, y),
            xytext=(1.03, place),
            textcoords="axes fraction",
            fontsize=8,
            va="center",
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-",
                "color": line_style(chart, one)["color"],
                "linewidth": 0.7,
                "linestyle": "dotted",
                "relpos": (0.0, 0.5),
                "shrinkA": 1.0,
                "shrinkB": 0.0,
            },
        )


def _write_letter(chart: Chart, curves: Sequence[Line], i: int, ax: Axes) -> None:
    """The letter of a channel in its color, at a high, flat part, clear of all curves."""
    at = numbers(chart, curves[i].x, curves[i].first, curves[i].last)
    values = np.stack([_curve(chart, one)[1] for one in curves], axis=1)
    top = ax.get_ylim()[1]
    inner = (at > at[0] + _HALF_WIDTH_NM) & (at < at[-1] - _HALF_WIDTH_NM)
    places = [
        _rated_place(at, values, i, place, side, top) for place in at[inner] for side in (1, -1)
    ]
    _, x, y = max(places)
    color = channel_color(curves[i].channel)
    centered: dict[str, Any] = {"ha": "center", "va": "center_baseline"}
    ax.text(x, y, curves[i].channel, color=color, fontweight="bold", fontsize=11, **centered)


def _rated_place(
    wavelength_nm: Float[Array, " n"],
    qe: Float[Array, "n p"],
    i: int,
    at: float,
    side: int,
    top: float,
) -> tuple[float, float, float]:
    """Rating and position of a place above (side 1) or below (-1) the curve."""
    near = qe[np.abs(wavelength_nm - at) <= _HALF_WIDTH_NM]
    own, others = near[:, i], np.delete(near, i, axis=1)
    edge = own.max() if side > 0 else own.min()
    height = edge + side * (_GAP + _HEIGHT / 2) * top
    reach = (_HEIGHT / 2 + _GAP / 2) * top
    low, high = height - reach, height + reach
    hit = ((others.max(axis=0) > low) & (others.min(axis=0) < high)).any()
    outside = low < 0 or high > top
    rating = own.mean() - 3 * np.ptp(own)
    rating += 0.1 * top * (side > 0)  # prefer places above the curve
    rating -= 0.5 * top * (at > INFRARED_FROM_NM)  # prefer the visible range
    rating -= 10 * top * (hit or outside)
    return float(rating), float(at), float(height)
