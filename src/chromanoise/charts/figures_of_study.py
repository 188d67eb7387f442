"""Sensors over a sweep: a quantity and the color error.

Heat maps of a quantity over two parameters.

Figure 7: the quantum efficiency of every channel.

The figures of a study, with the charts of its report, for papers and slides.
"""

from collections.abc import Mapping, Sequence
from itertools import cycle, islice
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import LogFormatter

from chromanoise.base import Array, Float, palette
from chromanoise.charts.by_name import SECTIONS, drawing
from chromanoise.charts.charted_study import Shown, unclipped_remark
from chromanoise.charts.figure_marks import draw_panel
from chromanoise.charts.figure_style import (
    FAINT,
    INK,
    are_many,
    channel_color,
    chromanoise_style,
    framed_figure,
    legend_beside,
    sensor_label,
    write_sensor,
)
from chromanoise.charts.levels import crossing_rules, curves_chart, level_curves
from chromanoise.charts.maps import sweep_maps
from chromanoise.charts.result_figures import (
    budget_limits_db,
    draw_budget,
    draw_ellipses,
    draw_pareto,
)
from chromanoise.charts.sensitivities import sensitivities_chart
from chromanoise.noise import conditions, light_and_exposure
from chromanoise.sensor import Sensor
from chromanoise.study import (
    Crossover,
    Curve,
    QuantityMap,
    best_of,
    coordinate_budget,
    lead_changes,
    leads,
)

_NAME_POINTS = 11.0  # from one name at the right to the next
_SHADES = (INK, *(channel_color(name) for name in "BRG"))


def draw_comparison(
    curves: Sequence[Curve], ax: Axes, *, crossovers: Sequence[Crossover] = (), title: str = ""
) -> Axes:
    """A quantity over the sweep: one color per matrix, one dash pattern per sensor.

    More than three sensors have one color each, and their names at the ends of their curves; then
    a matrix has a dash pattern.

    Parameters
    ----------
    curves
        Curves from `chromanoise.study.compared`, all of one sweep and quantity.
    ax
        To draw on.
    crossovers
        Crossovers from `chromanoise.study.crossovers`, marked by circles and sweep values.
    title
        Title, which should name the operating point.
    """
    quantity, several = curves[0].quantity, len({curve.matrix for curve in curves}) > 1
    full = several or not are_many(curve.label for curve in curves)
    chart = curves_chart(
        curves,
        [curve.value for curve in curves],
        f"{quantity.what} [{quantity.unit}]",
        names=[f"{one.label}, {one.matrix}" if full else one.label for one in curves],
        rules=crossing_rules(crossovers, curves),
    )
    draw_panel(chart, 0, ax)
    if title:
        ax.set_title(title, loc="left", fontsize=9)
    return ax


def draw_color_errors(curves: Sequence[Curve], ax: Axes) -> Axes:
    """The mean color error of the same curves over the sweep.

    Parameters
    ----------
    curves
        As `draw_comparison`.
    ax
        To draw on.
    """
    chart = curves_chart(
        curves,
        [curve.color_error for curve in curves],
        "mean color error [ΔE*ab]",
        names=[""] * len(curves),
    )
    draw_panel(chart, 0, ax)
    ax.set_ylim(bottom=0)
    return ax


_LETTERS = 72  # of a line of the title
_VALUES = LinearSegmentedColormap.from_list("values", palette.VALUES)
_DIFFERENCES = LinearSegmentedColormap.from_list("differences", palette.DIFFERENCES)


def draw_maps(maps: Sequence[QuantityMap], ax: Axes, *, title: str = "") -> Axes:
    """A heat map over two parameters, with the matrix of the first map.

    Of one sensor, the quantity. Of two, the first minus the second, with the line where they are
    equal. Of more, the best sensor, a color each. Gray: no value, as where a channel is saturated.

    Parameters
    ----------
    maps
        From `chromanoise.study.ranking.mapped`.
    ax
        To draw on.
    title
        Title, which should name the operating point.
    """
    mine = [one for one in maps if one.matrix == maps[0].matrix]
    first = mine[0]
    ax.set_facecolor(FAINT)
    if len(mine) == 1:
        what = f"{first.label}, {first.matrix}"
        _draw_values(first, first.value, ax, label=f"[{first.quantity.unit}]", cmap=_VALUES)
    elif len(mine) == 2:
        what = f"{first.label} minus {mine[1].label}, {first.matrix}; line: equal"
        _draw_difference(first, first.value - mine[1].value, ax)
    else:
        better = "highest" if first.quantity.more_is_better else "lowest"
        what = f"sensor with the {better} {first.quantity.what}, {first.matrix}"
        _draw_best(mine, ax)
    _frame(first, ax)
    lines = [fill(text, _LETTERS, break_on_hyphens=False) for text in (title, what) if text]
    ax.set_title("\n".join(lines), loc="left", fontsize=9, fontweight="normal")
    return ax


def _draw_values(
    one: QuantityMap, values: Float[Array, "j k"], ax: Axes, *, label: str, **how: Any
) -> None:
    mesh = _draw_cells(one, np.ma.masked_invalid(values), ax, **how)
    ax.figure.colorbar(mesh, ax=ax, label=label)


def _draw_cells(one: QuantityMap, values: Any, ax: Axes, **how: Any) -> QuadMesh:
    mesh = ax.pcolormesh(one.at, one.second_at, values, shading="nearest", **how)
    mesh.set_rasterized(True)
    return mesh


def _draw_difference(one: QuantityMap, values: Float[Array, "j k"], ax: Axes) -> None:
    known = values[np.isfinite(values)]
    reach = float(np.abs(known).max(initial=0.0)) or 1.0
    norm = TwoSlopeNorm(0.0, vmin=-reach, vmax=reach)
    label = f"difference [{one.quantity.unit}]"
    _draw_values(one, values, ax, label=label, cmap=_DIFFERENCES, norm=norm)
    if known.size and known.min() < 0 < known.max() and min(values.shape) > 1:
        ax.contour(one.at, one.second_at, np.ma.masked_invalid(values), [0.0], colors=INK)


def _draw_best(maps: Sequence[QuantityMap], ax: Axes) -> None:
    best = best_of(maps)
    colors = [light for light, _ in islice(cycle(palette.SENSORS), len(maps))]
    how = {"cmap": ListedColormap(colors), "vmin": -0.5, "vmax": len(maps) - 0.5}
    _draw_cells(maps[0], np.ma.masked_less(best, 0), ax, **how)
    winners = [i for i in range(len(maps)) if (best == i).any()]
    patches = [Patch(color=colors[i], label=maps[i].label) for i in winners]
    legend_beside(ax, fontsize=8, handles=patches)


def _frame(one: QuantityMap, ax: Axes) -> None:
    if one.sweep.logarithmic:
        ax.set_xscale("log")
    if one.second.logarithmic:
        ax.set_yscale("log")
    for axis, sweep in ((ax.xaxis, one.sweep), (ax.yaxis, one.second)):
        if sweep.logarithmic:
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(LogFormatter(minor_thresholds=(1.0, 0.5)))
    ax.set_xlabel(f"{one.sweep.what} [{one.sweep.unit}]")
    ax.set_ylabel(f"{one.second.what} [{one.second.unit}]")


def draw_sensitivities(
    sensor: Sensor, ax: Axes, *, top: float | None = None, dashes: Any = None
) -> Axes:
    """Draw quantum efficiency over wavelength, with curve letters and the near infrared shaded.

    Parameters
    ----------
    sensor
        The sensor; all its curves have one dash pattern.
    ax
        Axes of matplotlib to draw on.
    top
        Upper end of the scale, where panels share one. [e-/photon]
    dashes
        The dash pattern, from `sensor_dashes`, where several sensors share a figure.
    """
    draw_panel(sensitivities_chart([sensor]), 0, ax)
    ax.set(title=sensor_label(sensor.label, sensor.origin))
    if top is not None:
        ax.set_ylim(0, top)
    if dashes is not None:
        for line in ax.lines:
            line.set_linestyle(dashes)
    return ax


_WIDE_IN = 6.4
_LETTERS_PER_IN = 13  # of a title
_SMALL = 6.5  # of the words of a panel of many
_WIDEST_IN = 7.2  # of many sensors: A4 and Letter without margins
_MARK_LETTERS = 6  # before a name, and of the ticks


def study_figures(of: Shown) -> Mapping[str, Figure]:
    """Budget, comparison over the light level, ellipses, Pareto curve and sensitivities, by name.

    In the order of the page and of the report, with their headings and marks. Each sweep of two
    parameters is a heat map besides: ``map-1`` and so on.

    A figure without data for any sensor, e.g. the budget of saturated sensors, is omitted.

    Parameters
    ----------
    of
        A study from `chromanoise.charts.charted_study`.

    Raises
    ------
    InputError
        If one of them cannot be computed.
    """
    with chromanoise_style():
        figures = {
            "budget": _budget(of),
            "comparison": _comparison(of),
            **map_figures(of),
            "ellipses": _ellipses(of),
            "pareto": _pareto(of),
            "sensitivities": _sensitivities(of),
        }
    return {name: figure for name, figure in figures.items() if figure is not None}


def map_figures(of: Shown) -> dict[str, Figure]:
    """A heat map per sweep of two parameters: ``map-1`` and so on.

    Parameters
    ----------
    of
        As `study_figures`.

    Raises
    ------
    InputError
        If one of them cannot be computed.
    """
    figures = {}
    with chromanoise_style():
        for i, one in enumerate(sweep_maps(of), 1):
            figures[f"map-{i}"] = figure = framed_figure(_WIDE_IN, 4.2)
            title = f"{one.maps[0].quantity.what}, from {conditions(of.operating_points)}"
            draw_maps(one.maps, figure.add_subplot(), title=title)
    return figures


def _entitle(figure: Figure, part: str, title: str = "") -> None:
    """Draw the heading of a chart and its title over all panels, in the width of the figure."""
    heading = next(one.heading for one in SECTIONS if one.part == part)
    letters = int(_LETTERS_PER_IN * figure.get_figwidth())
    lines = fill(title, letters, break_on_hyphens=False)
    figure.suptitle(f"{heading}\n{lines}".strip(), x=0.02, ha="left", fontsize=9)


def _panels(
    of: Shown, count: int, *, row_in: float, columns: int = 1
) -> tuple[Figure, list[Axes], int]:
    """A figure with panels in one column or, of more than three sensors, in two; letters of each.

    Ten sensors fit a page.
    """
    width_in = _WIDE_IN
    if are_many(one.sensor.label for one in of.operating_points):
        columns, width_in, row_in = max(2, columns), _WIDEST_IN, 0.7 * row_in
    rows = -(-count // columns)
    figure = framed_figure(width_in, 0.4 + row_in * rows)
    axes = list(figure.subplots(rows, columns, squeeze=False).flat)
    for ax in axes[count:]:
        ax.set_axis_off()
    return figure, axes[:count], int(_LETTERS_PER_IN * width_in / columns) - _MARK_LETTERS


def _sensitivities(of: Shown) -> Figure:
    sensors = [one.sensor for one in of.operating_points]
    figure, panels, letters = _panels(of, len(sensors), row_in=2.8)
    chart = sensitivities_chart(sensors)
    names = chart.sensors
    for i, (sensor, ax) in enumerate(zip(sensors, panels, strict=True)):
        draw_panel(chart, i, ax)
        write_sensor(ax, sensor.origin, i, names, letters=letters)
        if are_many(names):
            ax.set_ylabel("QE [e$^-$/photon]", fontsize=7)
            ax.set_xlabel("wavelength [nm]" if i >= len(names) - 2 else "")
    _entitle(figure, "sensitivities")
    return figure


def _comparison(of: Shown) -> Figure:
    curves, pairs = level_curves(of)
    many = are_many(curve.label for curve in curves)
    figure = framed_figure(_WIDEST_IN if many else _WIDE_IN, 5.8)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    crossed: Sequence[Crossover] = [pair for pair in pairs if isinstance(pair, Crossover)]
    if many:
        crossed = lead_changes(leads(curves, crossed), crossed)
    title = (
        f"{curves[0].quantity.what} against illuminance ({light_and_exposure(of.operating_points)})"
        f"{unclipped_remark(of)}"
    )
    draw_comparison(curves, above, crossovers=crossed).set_xlabel("")
    draw_color_errors(curves, below)
    _entitle(figure, "levels", title)
    return figure


def _budget(of: Shown) -> Figure | None:
    found = [(i, one, coordinate_budget(one, "Y")) for i, one in enumerate(of.analyses)]
    budgets = [(i, one.sensor, budget) for i, one, budget in found if budget is not None]
    if not budgets:
        return None
    figure, panels, letters = _panels(of, len(budgets), row_in=2.6)
    limits_db = budget_limits_db([budget for _, _, budget in budgets])
    names = [one.sensor.label for one in of.analyses]
    for (i, sensor, budget), ax in zip(budgets, panels, strict=True):
        draw_budget(budget, sensor, ax, limits_db=limits_db)
        write_sensor(ax, sensor.origin, i, names, letters=letters - 12)
        if are_many(names):
            ax.tick_params(axis="y", labelsize=_SMALL)
            for text in ax.texts:
                text.set_fontsize(_SMALL)
    if are_many(names):
        for ax in panels[:-2]:
            ax.set_xlabel("")
    _entitle(figure, "budget", f"Budget of the SNR of Y at {conditions(of.operating_points)}")
    return figure


def _ellipses(of: Shown) -> Figure | None:
    chart = drawing("ellipses", of)
    shown = [i for i, panel in enumerate(chart.panels) if panel.marks]
    if not shown:
        return None
    names = chart.sensors
    columns = min(4 if are_many(names) else 3, len(shown))
    figure, panels, letters = _panels(of, len(shown), row_in=4.2, columns=columns)
    if not are_many(names):
        figure.set_figwidth(3.6 * columns)
    for i, ax in zip(shown, panels, strict=True):
        draw_ellipses(chart, i, ax)
        write_sensor(ax, "", i, names, letters=letters)
    for k, ax in enumerate(panels):
        if k % columns:
            ax.set_ylabel("")
    _entitle(figure, "ellipses", chart.title)
    return figure


def _pareto(of: Shown) -> Figure:
    chart = drawing("pareto", of)
    many = are_many(chart.sensors)
    figure = framed_figure(*((_WIDEST_IN, 5.0) if many else (_WIDE_IN, 4.2)))
    draw_pareto(chart, figure.add_subplot())
    _entitle(figure, "pareto")
    return figure
