"""The figures of a study for papers and slides: comparisons over sweeps, heat maps, QE curves.

They show the charts of the study's report. `draw_sensitivities` is Figure 7 of the paper: the
quantum efficiency of every channel.
"""

from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chromanoise.charts.charted_study import Shown, unclipped_remark
from chromanoise.charts.description import Cells
from chromanoise.charts.figure_marks import draw_panel
from chromanoise.charts.figure_style import (
    are_many,
    chromanoise_style,
    framed_figure,
    sensor_label,
    write_sensor,
)
from chromanoise.charts.heat_map import map_of, sweep_maps
from chromanoise.charts.levels import crossing_rules, curves_chart, level_curves
from chromanoise.charts.registry import SECTIONS, drawing
from chromanoise.charts.result_figures import draw_pareto
from chromanoise.charts.sensitivities import sensitivities_chart
from chromanoise.noise import conditions, light_and_exposure
from chromanoise.sensor import Sensor
from chromanoise.study import Crossover, CrossoverLine, Curve, QuantityMap, lead_changes, leads


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


def draw_maps(
    maps: Sequence[QuantityMap],
    ax: Axes,
    *,
    lines: Sequence[CrossoverLine] = (),
    title: str = "",
) -> Axes:
    """A heat map over two parameters, with the matrix of the first map.

    Of one sensor, the quantity. Of two, the first minus the second, with the line where they are
    equal. Of more, the best sensor, a color each. Gray: no value, as where a channel is saturated.

    Parameters
    ----------
    lines
        Where two sensors are equal, with each matrix.
    title
        Title, which should name the operating point.
    """
    mine = [one for one in maps if one.matrix == maps[0].matrix]
    chart = map_of(mine, [one for one in lines if one.matrix == maps[0].matrix])
    draw_panel(chart, 0, ax)
    (cells,) = (one for one in chart.panels[0].marks if isinstance(one, Cells))
    what = f"{cells.name.partition(' [')[0]}, {maps[0].matrix}"
    what += "; line: equal" if cells.equal else ""
    shown = [fill(text, _LETTERS, break_on_hyphens=False) for text in (title, what) if text]
    ax.set_title("\n".join(shown), loc="left", fontsize=9, fontweight="normal")
    return ax


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
        The dash pattern, from ``sensor_dashes``, where several sensors share a figure.
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
_CAUSE_LETTERS = 12  # of a cause beside the axes
_LABEL_LETTERS = 18  # of a line of the label of a small panel


def study_figures(of: Shown) -> Mapping[str, Figure]:
    """Budget, comparison over the light level, ellipses, Pareto curve and sensitivities, by name.

    In the order of the page and of the report, with their headings and marks. Each sweep of two
    parameters is a heat map besides: ``map-1`` and so on.

    A figure without data for any sensor, e.g. the budget of saturated sensors, is omitted.

    Parameters
    ----------
    of
        A study from ``charted_study``.

    Raises
    ------
    InputError
        If one of them cannot be computed.
    """
    with chromanoise_style():
        figures = {
            "budget": _panelled(of, "budget", row_in=2.6),
            "comparison": _comparison(of),
            **map_figures(of),
            "ellipses": _panelled(of, "ellipses", row_in=4.2, panel_in=3.6, columns=3),
            "pareto": _pareto(of),
            "sensitivities": _panelled(of, "sensitivities", row_in=2.8),
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
            draw_maps(one.maps, figure.add_subplot(), lines=one.lines, title=title)
    return figures


def _entitle(figure: Figure, part: str, title: str = "") -> None:
    """Draw the heading of a chart and its title over all panels, in the width of the figure."""
    heading = next(one.heading for one in SECTIONS if one.part == part)
    letters = int(_LETTERS_PER_IN * figure.get_figwidth())
    lines = fill(title, letters, break_on_hyphens=False)
    figure.suptitle(f"{heading}\n{lines}".strip(), x=0.02, ha="left", fontsize=9)


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


def _panelled(
    of: Shown, part: str, *, row_in: float, panel_in: float = _WIDE_IN, columns: int = 1
) -> Figure | None:
    """A chart with a panel per sensor; ``None`` where no sensor has one.

    Of more than three sensors, the panels are smaller and in one column more: ten fit a page.
    """
    chart = drawing(part, of)
    many, shown = are_many(chart.sensors), [i for i, one in enumerate(chart.panels) if one.marks]
    if not shown:
        return None
    columns = min(columns + many, len(shown))
    width_in = _WIDEST_IN if many else panel_in * columns
    rows = -(-len(shown) // columns)
    figure = framed_figure(width_in, 0.4 + (0.7 if many else 1.0) * row_in * rows)
    axes = list(figure.subplots(rows, columns, squeeze=False).flat)
    letters = int(_LETTERS_PER_IN * width_in / columns) - _MARK_LETTERS
    for ax in axes[len(shown) :]:
        ax.set_axis_off()
    for k, (i, ax) in enumerate(zip(shown, axes, strict=False)):
        draw_panel(chart, i, ax)
        own = letters - (_CAUSE_LETTERS if part == "budget" else 0)
        write_sensor(ax, of.operating_points[i].sensor.origin, i, chart.sensors, letters=own)
        if k % columns:
            ax.set_ylabel("")
        if many:
            _make_small(ax, texts=part == "budget", has_label=k >= len(shown) - columns)
    _entitle(figure, part, "" if part == "sensitivities" else chart.title)
    return figure


def _make_small(ax: Axes, *, texts: bool, has_label: bool) -> None:
    """Make the words of a panel of many small."""
    ax.set_ylabel(fill(ax.get_ylabel(), _LABEL_LETTERS), fontsize=7)
    if not has_label:
        ax.set_xlabel("")
    for text in ax.texts if texts else ():
        text.set_fontsize(_SMALL)
    if texts:
        ax.tick_params(axis="y", labelsize=_SMALL)


def _pareto(of: Shown) -> Figure:
    chart = drawing("pareto", of)
    many = are_many(chart.sensors)
    figure = framed_figure(*((_WIDEST_IN, 5.0) if many else (_WIDE_IN, 4.2)))
    draw_pareto(chart, figure.add_subplot())
    _entitle(figure, "pareto")
    return figure
