"""Sensors over a sweep: a quantity and the color error.

Heat maps of a quantity over two parameters.

Figure 7: the quantum efficiency of every channel.

The figures of a study, with the charts of its report, for papers and slides.
"""

from collections.abc import Callable, Mapping, Sequence
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
from chromanoise.charts.figure_style import (
    FAINT,
    INK,
    QUIET,
    are_many,
    channel_color,
    chromanoise_style,
    framed_figure,
    legend_beside,
    mark_zero,
    matrix_dashes,
    sensor_dashes,
    sensor_label,
    sensor_lines,
    sensor_mark,
    shade_nir,
    spread,
    write_beside,
    write_sensor,
)
from chromanoise.charts.levels import level_curves
from chromanoise.charts.maps import sweep_maps
from chromanoise.charts.numbers import brief
from chromanoise.charts.result_figures import (
    budget_limits_db,
    draw_budget,
    draw_ellipses,
    draw_pareto,
)
from chromanoise.noise import conditions, light_and_exposure
from chromanoise.sensor import Sensor
from chromanoise.spectra import INFRARED_FROM_NM
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
    _draw_lines(curves, ax, lambda curve: curve.value)
    for crossover in crossovers:
        _mark(crossover, curves, ax)
    quantity = curves[0].quantity
    ax.set_ylabel(f"{quantity.what} [{quantity.unit}]")
    if quantity.unit == "dB":
        mark_zero(ax)
    if title:
        ax.set_title(title, loc="left", fontsize=9)
    if are_many(curve.label for curve in curves):
        _write_names(curves, ax)
    else:
        ax.legend(loc="best", fontsize=8)
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
    _draw_lines(curves, ax, lambda curve: curve.color_error)
    ax.set_ylabel("mean color error [ΔE*ab]")
    ax.set_ylim(bottom=0)
    return ax


def _draw_lines(
    curves: Sequence[Curve], ax: Axes, values_of: Callable[[Curve], Float[Array, " k"]]
) -> None:
    """Lines over the sweep, of several sensors with the mark of each at the end of its line."""
    sensors = list(dict.fromkeys(one.label for one in curves))
    for curve, style in zip(curves, _styles(curves), strict=True):
        values = values_of(curve)
        known = np.flatnonzero(np.isfinite(values))
        if len(sensors) > 1 and len(known):
            style |= sensor_mark(sensors.index(curve.label), style["color"])
            style |= {"markevery": [int(known[-1])], "markersize": 5}
        ax.plot(curve.at, values, label=f"{curve.label}, {curve.matrix}", **style)
    sweep = curves[0].sweep
    if sweep.logarithmic:
        ax.set_xscale("log")
    ax.set_xlabel(f"{sweep.what} [{sweep.unit}]")
    ax.grid(visible=True, alpha=0.25)


def _styles(curves: Sequence[Curve]) -> list[dict[str, Any]]:
    matrices = list(dict.fromkeys(curve.matrix for curve in curves))
    if are_many(curve.label for curve in curves):
        lines = sensor_lines(curve.label for curve in curves)
        of_matrix = matrix_dashes(matrices)
        first = matrices[0]
        return [
            lines[curve.label]
            | ({} if curve.matrix == first else {"linestyle": of_matrix[curve.matrix]})
            for curve in curves
        ]
    patterns = sensor_dashes(curve.label for curve in curves)
    return [
        {
            "color": _SHADES[matrices.index(curve.matrix) % len(_SHADES)],
            "linestyle": patterns[curve.label],
        }
        for curve in curves
    ]


def _write_names(curves: Sequence[Curve], ax: Axes) -> None:
    """Write the name of each curve at the right, with a thin line from where the curve ends."""
    known = [curve for curve in curves if np.isfinite(curve.value).any()]
    ends = [int(np.flatnonzero(np.isfinite(curve.value))[-1]) for curve in known]
    matrices = {curve.matrix for curve in curves}
    low, high = ax.get_ylim()
    wanted = [(curve.value[k] - low) / (high - low) for curve, k in zip(known, ends, strict=True)]
    height_in = ax.get_window_extent().height / ax.figure.dpi
    gap = _NAME_POINTS / (72 * height_in)
    styles = dict(zip(curves, _styles(curves), strict=True))
    for curve, k, place in zip(known, ends, spread(wanted, gap), strict=True):
        ax.annotate(
            f"{curve.label}, {curve.matrix}" if len(matrices) > 1 else curve.label,
            (curve.at[k], curve.value[k]),
            xytext=(1.03, place),
            textcoords="axes fraction",
            fontsize=8,
            va="center",
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-",
                "color": styles[curve]["color"],
                "linewidth": 0.7,
                "linestyle": "dotted",
                "relpos": (0.0, 0.5),
                "shrinkA": 1.0,
                "shrinkB": 0.0,
            },
        )


def _mark(crossover: Crossover, curves: Sequence[Curve], ax: Axes) -> None:
    curve = next(c for c in curves if (c.sensor, c.matrix) == (crossover.first, crossover.matrix))
    for value in crossover.at:
        height = float(np.interp(value, curve.at, curve.value))
        ax.plot(value, height, "o", color=INK, markerfacecolor="none", markersize=8)
        box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.5}
        text = f"{brief(value, 2 if value < 100 else 3)} {crossover.sweep.unit}"
        write_beside(ax, text, (value, height), (-2, 10), color=QUIET, bbox=box)


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


_HALF_WIDTH_NM = 12.0
_GAP, _HEIGHT = 0.02, 0.075  # of the scale: under the letter, and of the letter
_CENTERED: dict[str, Any] = {"ha": "center", "va": "center_baseline"}


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
    wavelength_nm = sensor.grid.wavelength_nm
    dashes = dashes or sensor_dashes([sensor.label])[sensor.label]
    for i, name in enumerate(sensor.names):
        ax.plot(wavelength_nm, sensor.qe[:, i], color=channel_color(name), linestyle=dashes)
    shade_nir(ax, wavelength_nm[-1])
    ax.set(
        xlim=(wavelength_nm[0], wavelength_nm[-1]),
        ylim=(0, top or 1.15 * sensor.qe.max()),
        xlabel="wavelength [nm]",
        ylabel="quantum efficiency [e$^-$/photon]",
        title=sensor_label(sensor.label, sensor.origin),
    )
    for i, name in enumerate(sensor.names):
        at, height = _letter_place(wavelength_nm, sensor.qe, i, ax.get_ylim()[1])
        color = channel_color(name)
        ax.text(at, height, name, color=color, fontweight="bold", fontsize=11, **_CENTERED)
    return ax


def _letter_place(
    wavelength_nm: Float[Array, " n"], qe: Float[Array, "n p"], i: int, top: float
) -> tuple[float, float]:
    """Position of the letter of channel ``i``: at a high, flat part, clear of all curves."""
    inner = (wavelength_nm > wavelength_nm[0] + _HALF_WIDTH_NM) & (
        wavelength_nm < wavelength_nm[-1] - _HALF_WIDTH_NM
    )
    places = [
        _rated_place(wavelength_nm, qe, i, at, side, top)
        for at in wavelength_nm[inner]
        for side in (1, -1)
    ]
    _, at, height = max(places)
    return at, height


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
    highest = 1.15 * max(float(sensor.qe.max()) for sensor in sensors)
    names = [sensor.label for sensor in sensors]
    patterns = dict.fromkeys(names, "solid") if are_many(names) else sensor_dashes(names)
    for i, (sensor, ax) in enumerate(zip(sensors, panels, strict=True)):
        draw_sensitivities(sensor, ax, top=highest, dashes=patterns[sensor.label])
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
    data = drawing("ellipses", of)
    shown = [i for i, sensor in enumerate(data["sensors"]) if sensor["patches"]]
    if not shown:
        return None
    names = [sensor["name"] for sensor in data["sensors"]]
    columns = min(4 if are_many(names) else 3, len(shown))
    figure, panels, letters = _panels(of, len(shown), row_in=4.2, columns=columns)
    if not are_many(names):
        figure.set_figwidth(3.6 * columns)
    for i, ax in zip(shown, panels, strict=True):
        draw_ellipses(data, i, ax)
        write_sensor(ax, "", i, names, letters=letters)
    for k, ax in enumerate(panels):
        if k % columns:
            ax.set_ylabel("")
    _entitle(figure, "ellipses", data["title"])
    return figure


def _pareto(of: Shown) -> Figure:
    data = drawing("pareto", of)
    many = are_many(sensor["name"] for sensor in data["sensors"])
    figure = framed_figure(*((_WIDEST_IN, 5.0) if many else (_WIDE_IN, 4.2)))
    draw_pareto(data, figure.add_subplot())
    _entitle(figure, "pareto")
    return figure
