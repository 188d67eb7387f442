"""The main figure of each result: budget, ellipses, stages, Pareto curves, matrices and pictures.

Each title names the operating point. `draw_flow` is Figure 2 of the paper: the stages from scene to
color, with the numbers of one analysis.
"""

from collections.abc import Callable, Sequence
from textwrap import fill
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyBboxPatch

from chromanoise.base import Array, UInt8
from chromanoise.charts.budget_chart import budget_of, coordinate_label, waterfall
from chromanoise.charts.description import Chart, Value
from chromanoise.charts.ellipses import ellipses_of
from chromanoise.charts.figure_marks import draw_panel, draw_waterfalls
from chromanoise.charts.figure_style import INK, QUIET, channel_color, sensor_label, write_beside
from chromanoise.charts.league import league_chart
from chromanoise.charts.pareto_curves import trades_chart
from chromanoise.imaging import Capture
from chromanoise.metrics import Budget
from chromanoise.noise import OperatingPoint, conditions
from chromanoise.sensor import Sensor
from chromanoise.study import (
    Analysis,
    League,
    MatrixResult,
    color_snr_db,
    contravariant_snr_db,
    defined,
    metric_of,
    raw_snr_db,
)


def draw_budget(
    budget: Budget, sensor: Sensor, ax: Axes, *, limits_db: tuple[float, float] | None = None
) -> Axes:
    """Draw one bar per cause; each bar starts at the end of the bar above it.

    Parameters
    ----------
    budget
        The budget of one coordinate.
    sensor
        The sensor of the budget.
    ax
        Axes of matplotlib to draw on.
    limits_db
        Ends of the scale, where panels share one; ``None`` for those of this budget. [dB]
    """
    chart = waterfall([sensor.label], [budget], budget.coordinate)
    draw_panel(chart, 0, ax)
    ax.set(title=sensor_label(sensor.label, sensor.origin), xlim=limits_db or ax.get_xlim())
    return ax


def draw_ellipses(chart: Chart, i: int, ax: Axes) -> Axes:
    """Draw the ellipses of one sensor, crosses at true colors, and lines to measured colors.

    Parameters
    ----------
    chart
        The chart ``ellipses`` of `chromanoise.charts`.
    i
        Index of the sensor.
    ax
        Axes of matplotlib to draw on.
    """
    if chart.panels:
        draw_panel(chart, i, ax)
    else:
        ax.text(0.5, 0.5, fill(chart.notes[i], _LETTERS), transform=ax.transAxes, ha="center")
    ax.set_title(chart.sensors[i])
    return ax


_STAGES = (  # name, symbol, equation, what its numbers are
    ("Scene", r"$\mathbf{L}$", "light", "one flat patch"),
    ("Exposure", r"$\mathbf{M}=\mathbf{F}^T\mathbf{L}$", "eq. 1–2", "electrons"),
    ("Noise", r"$\mathrm{var}=M+\sigma_{rn}^2$", "eq. 7", "raw SNR"),
    (
        "Spectrum",
        r"$\hat{\mathbf{L}}=\mathbf{F}(\mathbf{F}^T\mathbf{F})^{-1}\mathbf{M}$",
        "eq. 3–4",
        "contravariant SNR",
    ),
    ("Color", r"$\mathbf{H}^T\hat{\mathbf{L}}$", "eq. 5", "XYZ, and its SNR"),
)
_PITCH, _BOX = 1.0, 0.80
_TOP, _BOX_HEIGHT, _ROW = 0.0, 0.62, 0.19


def draw_flow(analysis: Analysis, ax: Axes, *, rows: int = 4) -> Axes:
    """Draw scene, exposure, noise, spectrum and color in a row, with their numbers below.

    Parameters
    ----------
    analysis
        Results of one sensor.
    ax
        Axes of matplotlib to draw on.
    rows
        Number of rows for channels, so that panels of different sensors have equal height.
    """
    for i, stage in enumerate(_STAGES):
        _draw_stage(ax, i, stage)
    for i in range(len(_STAGES) - 1):
        _draw_step(ax, i)
    _write_scene(analysis, ax)
    electrons = [f"{mean:.0f} e$^-$" for mean in analysis.raw.mean]
    ratios = (raw_snr_db(analysis), contravariant_snr_db(analysis))
    columns = [electrons, *(list(map(_decibels, one.values())) for one in ratios)]
    for column, texts in enumerate(columns, start=1):
        _write_column(ax, column, analysis.sensor.names, texts, channel_color)
    _write_column(ax, 4, analysis.color.names, _color(analysis), lambda _: INK)
    exposure = analysis.exposure
    label = sensor_label(analysis.sensor.name, analysis.sensor.origin)
    ax.set_title(
        f"{label} at {1e3 * exposure.time_s:.1f} ms, f/{exposure.f_number:g}; "
        f"{metric_of([analysis])}"
    )
    last = (len(_STAGES) - 1) * _PITCH + _BOX
    ax.set(xlim=(-0.02, last + 0.02), ylim=(_BOX_HEIGHT + (rows + 1.4) * _ROW, -0.03))
    ax.set_axis_off()
    return ax


def _draw_stage(ax: Axes, i: int, stage: tuple[str, str, str, str]) -> None:
    name, symbol, equation, note = stage
    left, middle = i * _PITCH, i * _PITCH + _BOX / 2
    box = FancyBboxPatch(
        (left, _TOP),
        _BOX,
        _BOX_HEIGHT,
        boxstyle="round,pad=0,rounding_size=0.06",
        facecolor="#F4F4F4",
        edgecolor=QUIET,
        linewidth=0.8,
    )
    ax.add_patch(box)
    ax.text(middle, 0.14, name, ha="center", va="center", fontweight="bold")
    ax.text(middle, 0.33, symbol, ha="center", va="center", fontsize=8)
    ax.text(middle, 0.50, equation, ha="center", va="center", color=QUIET, fontsize=8)
    ax.text(left, _row_at(0), note, ha="left", va="center", color=QUIET, fontsize=8)


def _draw_step(ax: Axes, i: int) -> None:
    start = i * _PITCH + _BOX
    ax.annotate(
        "",
        xy=((i + 1) * _PITCH - 0.02, _BOX_HEIGHT / 2),
        xytext=(start + 0.02, _BOX_HEIGHT / 2),
        arrowprops={"arrowstyle": "-|>", "color": INK, "shrinkA": 0, "shrinkB": 0},
    )


def _write_scene(analysis: Analysis, ax: Axes) -> None:
    scene = analysis.scene
    lines = (
        f"{scene.level_lux:g} lx",
        f"illuminant {scene.illuminant.name}",
        _reflectance(analysis),
    )
    for row, line in enumerate(lines, start=1):
        ax.text(0, _row_at(row), line, va="center")


def _reflectance(analysis: Analysis) -> str:
    rho = analysis.scene.reflectance
    low, high = float(np.min(rho)), float(np.max(rho))
    return f"reflectance {low:g}" + ("" if low == high else f"–{high:g}")


def _write_column(
    ax: Axes, i: int, names: tuple[str, ...], texts: list[str], color: Callable[[str], str]
) -> None:
    for row, (name, text) in enumerate(zip(names, texts, strict=True), start=1):
        at = _row_at(row)
        ax.text(i * _PITCH, at, name, va="center", color=color(name), fontweight="bold")
        weight = "bold" if name == "Y" else "normal"  # the number that the paper is about
        ax.text(i * _PITCH + _BOX, at, text, ha="right", va="center", fontweight=weight)


def _row_at(row: int) -> float:
    return _BOX_HEIGHT + (row + 0.8) * _ROW


def _color(analysis: Analysis) -> list[str]:
    ratios = color_snr_db(analysis)
    return [
        f"{value:.1f} lx,  {_decibels(ratios[name])}"
        for name, value in zip(analysis.color.names, analysis.color.mean, strict=True)
    ]


def _decibels(value: float | None) -> str:
    return "undefined" if value is None else f"{value:.1f} dB"


_LETTERS = 22  # of a line of the legend beside the axes


def draw_pareto(chart: Chart, ax: Axes) -> Axes:
    """Draw one curve per sensor, ends labeled by weight, and a large mark at the current matrix.

    Of more than three sensors, the weights have no labels.

    Parameters
    ----------
    chart
        The chart ``pareto`` of `chromanoise.charts`.
    ax
        Axes of matplotlib to draw on.
    """
    if chart.panels:
        draw_panel(chart, 0, ax)
    notes = "\n".join(chart.notes)
    ax.set_title(f"{chart.title}\n{notes}", loc="left", fontweight="normal", fontsize=9)
    return ax


Panels = Literal["budget", "ellipses", "flow"]
"""A chart with a panel per sensor."""

_WIDE = 62  # characters of a title line that fit the axes of a default figure
_LEGEND_ROW = 0.45  # of a line of the legend, in rows of bars


def draw_analyses(analyses: Sequence[Analysis], ax: Axes, *, coordinate: str = "Y") -> Axes:
    """Draw the budget of one coordinate: in each row the bars of all sensors. [dB]

    The legend gives the remaining SNR; for a sensor without a budget it says why.

    Parameters
    ----------
    analyses
        Analyses under one light.
    coordinate
        X, Y or Z, a contravariant coordinate as M^R, or L*, a*, b* of a gray.
    """
    chart = budget_of(analyses, coordinate)
    drawn = [i for i, panel in enumerate(chart.panels) if panel.marks]
    draw_waterfalls(chart, drawn, ax)
    lines = 0
    for panel in chart.panels:
        reason = fill(panel.absence.partition(";")[0], _WIDE)
        lines += reason.count("\n") + 1
        if reason:
            ax.plot([], [], " ", label=reason)
    bottom, top = ax.get_ylim()
    ax.set_ylim(bottom + _LEGEND_ROW * lines, top)  # the legend is below
    ax.legend(loc="lower right", fontsize=8)
    what = f"Budget of the SNR of {coordinate_label(coordinate)}"
    return _titled(ax, what, [one.point for one in analyses])


def draw_panels(analyses: Sequence[Analysis], kind: Panels, axes: Sequence[Axes]) -> Sequence[Axes]:
    """Draw one chart of each sensor on axes of its own, on equal scales.

    Parameters
    ----------
    analyses
        Analyses under one light.
    kind
        ``budget`` of the SNR of Y, noise ``ellipses`` of the patches in a* and b*, or ``flow``
        from the scene to the color.
    axes
        To draw on, one per sensor.
    """
    if kind == "flow":
        return [draw_flow(analysis, ax) for analysis, ax in zip(analyses, axes, strict=True)]
    if kind == "ellipses":
        ellipses = ellipses_of(analyses, "ab")
        return [draw_ellipses(ellipses, i, ax) for i, ax in enumerate(axes)]
    budgets = budget_of(analyses, "Y")
    for i, (analysis, ax) in enumerate(zip(analyses, axes, strict=True)):
        if budgets.panels[i].marks:
            draw_panel(budgets, i, ax)
            ax.set_title(sensor_label(analysis.sensor.label, analysis.sensor.origin))
        else:
            ax.set_title(f"{analysis.sensor.label}: no budget")
            ax.set_axis_off()
    return axes


def draw_matrices(results: Sequence[MatrixResult], ax: Axes) -> Axes:
    """Draw color error against SNR where the results have a Pareto curve, else matrices as bars.

    The curve is one line per sensor, with ends labeled by weight. A matrix has one bar per entry,
    grouped by coordinate, with the letter and the color of the channel. [lx/e-]

    Parameters
    ----------
    results
        One result per sensor, all by one method.
    """
    if all(one.pareto is not None for one in results):
        _draw_curves(results, ax)
        what = "Training error against SNR"
    else:
        _draw_entries(results, ax)
        what = f"{results[0].report.made_by} matrix"
    return _titled(ax, what, [one.point for one in results])


def _draw_curves(results: Sequence[MatrixResult], ax: Axes) -> None:
    rows: list[tuple[Value, ...]] = []
    for one in results:
        assert one.pareto is not None  # called only for results with a curve
        name, curve = one.point.sensor.label, one.pareto
        trades = zip(curve.weight.tolist(), curve.delta_e, curve.snr_y_db.tolist(), strict=True)
        rows += [(name, weight, error, defined(snr)) for weight, error, snr in trades]
    chart = trades_chart([one.point.sensor.label for one in results], rows)
    if chart.panels:
        draw_panel(chart, 0, ax)
    ax.margins(0.1)


def _draw_entries(results: Sequence[MatrixResult], ax: Axes) -> None:
    ticks, names, at = [], [], 0.0
    for one in results:
        for coordinate, row in zip(one.matrix.coordinates, one.matrix.matrix, strict=True):
            places = at + np.arange(len(row))
            colors = [channel_color(name) for name in one.matrix.channels]
            ax.bar(places, row, width=0.9, color=colors)
            for place, value, channel in zip(places, row, one.matrix.channels, strict=True):
                by, side = ((0, 3), "bottom") if value >= 0 else ((0, -3), "top")
                write_beside(ax, channel, (place, value), by, ha="center", va=side, fontsize=7)
            ticks.append(float(places.mean()))
            names.append(coordinate)
            at = float(places[-1]) + 2.0
        if len(results) > 1:
            names[-2] = f"{names[-2]}\n{one.point.sensor.label}"  # under the middle of X, Y, Z
        at += 1.0
    ax.axhline(0, color=INK, linewidth=0.8)
    ax.set_xticks(ticks, names, fontsize=8)
    ax.tick_params(axis="x", length=0)
    ax.margins(y=0.12)
    ax.set_axisbelow(True)
    ax.set_ylabel("entry of the matrix [lx/e⁻]")
    ax.grid(visible=True, axis="y", alpha=0.25)


def draw_capture(capture: Capture, ax: Axes) -> Axes:
    """Draw a picture without interpolation; mosaic codes without color as gray, from 0 to the top.

    Parameters
    ----------
    capture
        Codes, color, or both.
    """
    point = capture.camera.operating_point
    if capture.picture is not None:
        draw_picture(capture.picture.srgb, ax)
        what = f"{point.sensor.label}, sRGB"
    else:
        assert capture.raw is not None  # a capture has codes or color
        top = capture.raw.adc.top_code
        ax.imshow(capture.raw.codes, interpolation="none", cmap="gray", vmin=0, vmax=top)
        ax.set_axis_off()
        what = f"{point.sensor.label}, codes of 0 to {top} DN"
    return _titled(ax, what, [point])


def _titled(ax: Axes, what: str, points: Sequence[OperatingPoint]) -> Axes:
    facts = fill(f"at {conditions(points)}", _WIDE, break_on_hyphens=False)
    ax.set_title(f"{what}\n{facts}", loc="left", fontsize=9)
    return ax


def draw_picture(srgb: UInt8[Array, "h w 3"], ax: Axes, *, title: str = "") -> Axes:
    """Draw a picture without interpolation, which would smooth the noise.

    Parameters
    ----------
    srgb
        Encoded sRGB, 8 bits.
    ax
        Axes of matplotlib to draw on.
    title
        Text above the drawing.
    """
    ax.imshow(srgb, interpolation="none")
    ax.set_title(title)
    ax.set_axis_off()
    return ax


def draw_league(league: League, ax: Axes) -> Axes:
    """Draw a league on axes of matplotlib.

    Parameters
    ----------
    league
        With the cameras and the sensors of one's own.
    ax
        Axes of matplotlib to draw on.
    """
    names = [one.name for one in league.sensors]
    return draw_panel(league_chart(names, league, league.sensors, ()), 0, ax)
