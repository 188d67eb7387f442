"""The dB budget of one coordinate as a waterfall chart.

Noise of every ColorChecker patch in a plane of color, on equal axes.

Figure 2: the stages from scene to color, with the numbers of one analysis.

Color error against noise, over the weight of the noise in the matrix.

The main chart of each result, on one axes; every title names the operating point.
"""

from collections.abc import Callable, Sequence
from textwrap import fill
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.container import BarContainer
from matplotlib.patches import FancyBboxPatch

from chromanoise.base import Array, UInt8
from chromanoise.charts.budget import budget_steps, cause_label
from chromanoise.charts.charted_study import saturation_sentence
from chromanoise.charts.description import Chart, Value
from chromanoise.charts.ellipses import ellipses_of
from chromanoise.charts.figure_marks import draw_panel
from chromanoise.charts.figure_style import (
    INK,
    QUIET,
    are_many,
    channel_color,
    mark_zero,
    sensor_label,
    write_beside,
)
from chromanoise.charts.numbers import UNDEFINED, decimal
from chromanoise.charts.pareto_curves import trades_chart
from chromanoise.imaging import Capture
from chromanoise.metrics import Budget
from chromanoise.noise import OperatingPoint, conditions
from chromanoise.sensor import Sensor
from chromanoise.study import (
    Analysis,
    MatrixResult,
    color_snr_db,
    contravariant_snr_db,
    coordinate_budget,
    defined,
    metric_of,
    raw_snr_db,
)

_HIGH = 0.62  # of a bar, in rows
_ROOM = 0.16  # of the scale, for the numbers beside the bars


def budget_limits_db(budgets: Sequence[Budget]) -> tuple[float, float]:
    """The scale that holds all bars of some budgets from 0 dB, and the numbers beside them."""
    ends = [step["to_db"] for budget in budgets for step in budget_steps(budget)]
    low, high = min(0.0, *ends), max(0.0, *ends)
    return low - (0.03 * (high - low) if low < 0 else 0.0), high + _ROOM * (high - low)


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
    steps = budget_steps(budget)
    for row, step in enumerate(steps):
        is_change = step["kind"] in ("cost", "gain")
        start, end = step["from_db"] if is_change else 0.0, step["to_db"]
        fill = {"cost": QUIET, "gain": "none"}.get(step["kind"], INK)
        edge = INK if fill == "none" else fill
        look: dict[str, Any] = {"facecolor": fill, "edgecolor": edge, "linewidth": 1.2}
        ax.barh(row, abs(end - start), left=min(start, end), height=_HIGH, **look)
        write_beside(ax, step["text"], (max(start, end), row), (4, 0), va="center_baseline")
        if is_change:
            ends = [row - 1 + _HIGH / 2, row - _HIGH / 2]
            ax.plot([start, start], ends, color=QUIET, linewidth=0.8)
    ax.set_yticks(range(len(steps)), [step["label"] for step in steps])
    ax.tick_params(axis="y", length=0)
    ax.set(
        xlim=limits_db or budget_limits_db([budget]),
        ylim=(len(steps) - 0.4, -0.6),
        xlabel="SNR [dB]",
        title=sensor_label(sensor.label, sensor.origin),
    )
    ax.set_axisbelow(True)
    ax.grid(visible=True, axis="x", alpha=0.25)
    mark_zero(ax, axis="x")
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
_HEIGHT = 0.8  # of the bars of one row together, in rows


def draw_analyses(analyses: Sequence[Analysis], ax: Axes, *, coordinate: str = "Y") -> Axes:
    """Draw the loss of SNR of one coordinate: a bar per sensor and cause. [dB]

    The legend gives the remaining SNR. A sensor without a budget has no bars, and the legend calls
    its SNR undefined.

    Parameters
    ----------
    analyses
        Analyses under one light.
    ax
        To draw on.
    coordinate
        X, Y or Z, a contravariant coordinate as M^R, or L*, a*, b* of a gray.
    """
    budgets = [coordinate_budget(one, coordinate) for one in analyses]
    causes = next(([c.cause for c in one.costs] for one in budgets if one is not None), [])
    high = _HEIGHT / len(analyses)
    for i, (analysis, budget) in enumerate(zip(analyses, budgets, strict=True)):
        offset = (i - (len(analyses) - 1) / 2) * high
        bars = _draw_losses(analysis, budget, ax, shade=i / len(analyses), offset=offset, high=high)
        if bars is not None and not are_many(one.sensor.label for one in analyses):
            _write_losses(bars, ax)
    ax.axvline(0, color=INK, linewidth=0.8)
    ax.set_yticks(range(len(causes)), [fill(cause_label(c, coordinate), 16) for c in causes])
    ax.set_ylim(len(causes) - 0.4 + _LEGEND_ROW * len(analyses), -0.6)  # the legend is below
    ax.margins(x=0.15)
    ax.set_xlabel(f"loss of SNR of {coordinate} [dB]")
    ax.set_axisbelow(True)
    ax.grid(visible=True, axis="x", alpha=0.25)
    ax.legend(loc="lower right", fontsize=8)
    return _titled(ax, f"Losses from all photons to {coordinate}", [one.point for one in analyses])


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
    budgets = [coordinate_budget(one, "Y") for one in analyses]
    known = [one for one in budgets if one is not None]
    chart = ellipses_of(analyses, "ab") if kind == "ellipses" else None
    for i, (analysis, budget, ax) in enumerate(zip(analyses, budgets, axes, strict=True)):
        if chart is not None:
            draw_ellipses(chart, i, ax)
        elif kind == "flow":
            draw_flow(analysis, ax)
        elif budget is not None:
            draw_budget(budget, analysis.sensor, ax, limits_db=budget_limits_db(known))
        else:
            ax.set_title(f"{analysis.sensor.label}: no budget")
            ax.set_axis_off()
    return axes


def _draw_losses(
    analysis: Analysis, budget: Budget | None, ax: Axes, *, shade: float, offset: float, high: float
) -> BarContainer | None:
    name = analysis.sensor.label
    if budget is None:
        if saturation_sentence(analysis):
            why = "saturated"
        else:
            why = f"SNR {UNDEFINED}" if analysis.readout is None else "no budget with clipping"
        ax.plot([], [], " ", label=f"{name}: {why}")
        return None
    losses = [cost.loss_db for cost in budget.costs]
    rows = np.arange(len(losses)) + offset
    label = f"{name}: {decimal(budget.snr_db)} dB left of {decimal(budget.photons_db)} dB"
    color = str(0.15 + 0.7 * shade)
    bars = ax.barh(rows, losses, height=0.9 * high, color=color, edgecolor=INK, linewidth=0.6)
    bars.set_label(label)
    return bars


def _write_losses(bars: BarContainer, ax: Axes) -> None:
    for bar in bars:
        loss = float(bar.get_width())
        at = (max(loss, 0.0), bar.get_y() + bar.get_height() / 2)
        write_beside(ax, decimal(loss), at, (3, 0), va="center_baseline", fontsize=7)


def draw_matrices(results: Sequence[MatrixResult], ax: Axes) -> Axes:
    """Draw color error against SNR where the results have a Pareto curve, else matrices as bars.

    The curve is one line per sensor, with ends labeled by weight. A matrix has one bar per entry,
    grouped by coordinate, with the letter and the color of the channel. [lx/e-]

    Parameters
    ----------
    results
        One result per sensor, all by one method.
    ax
        To draw on.
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
    ax
        To draw on.
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
