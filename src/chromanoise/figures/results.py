"""The main chart of each result, on one axes; every title names the operating point."""

from collections.abc import Sequence
from textwrap import fill
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.container import BarContainer

from chromanoise._check import Array
from chromanoise._shapes import UInt8
from chromanoise.analysis import Analysis, coordinate_budget
from chromanoise.charts import cause_label
from chromanoise.charts.charted_study import saturation_sentence
from chromanoise.charts.ellipses import ellipses_of
from chromanoise.charts.text import UNDEFINED, brief, decimal
from chromanoise.exposure import OperatingPoint, conditions
from chromanoise.figures.budget import budget_limits_db, draw_budget
from chromanoise.figures.ellipses import draw_ellipses
from chromanoise.figures.flow import draw_flow
from chromanoise.figures.pareto import draw_trade
from chromanoise.figures.style import (
    INK,
    are_many,
    channel_color,
    mark_zero,
    sensor_lines,
    sensor_mark,
    write_beside,
)
from chromanoise.imaging.capture import Capture
from chromanoise.metrics import Budget
from chromanoise.study import MatrixResult

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
    data = ellipses_of(analyses, "ab") if kind == "ellipses" else {}
    for i, (analysis, budget, ax) in enumerate(zip(analyses, budgets, axes, strict=True)):
        if kind == "ellipses":
            draw_ellipses(data, i, ax)
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
    lines = sensor_lines(one.point.sensor.label for one in results)
    for i, one in enumerate(results):
        mark = sensor_mark(i, lines[one.point.sensor.label]["color"])
        assert one.pareto is not None  # called only for results with a curve
        name, curve = one.point.sensor.label, one.pareto
        trades = zip(curve.snr_y_db.tolist(), curve.delta_e, curve.weight.tolist(), strict=True)
        known = [(snr, error, w) for snr, error, w in trades if error is not None]
        draw_trade(
            [snr for snr, _, _ in known],
            [error for _, error, _ in known],
            [] if are_many(lines) else [brief(weight) for _, _, weight in known],
            ax,
            line=lines[name] | ({"markevery": [-1]} | mark if len(results) > 1 else {}),
            label=name,
        )
    ax.margins(0.1)
    ax.set(xlabel="SNR of Y [dB]", ylabel="training error, mean [ΔE*ab]")
    ax.set_ylim(bottom=0)
    mark_zero(ax, axis="x")
    ax.grid(visible=True, alpha=0.25)
    ax.legend(loc="best", fontsize=8, title="numbers: weight of the noise", title_fontsize=8)


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
