"""Sensors over a sweep: a quantity and the color error."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from chromanoise.analysis import Crossover, Curve
from chromanoise.figures.style import INK, QUIET, channel_color, sensor_dashes

_SHADES = (INK, *(channel_color(name) for name in "BRG"))


def draw_comparison(
    curves: Sequence[Curve], ax: Axes, *, crossovers: Sequence[Crossover] = (), title: str = ""
) -> Axes:
    """A quantity over the sweep: one color per matrix, one dash pattern per sensor.

    Parameters
    ----------
    curves
        Curves from `chromanoise.analysis.compared`, all of one sweep and quantity.
    ax
        To draw on.
    crossovers
        Crossovers from `chromanoise.analysis.crossovers`, marked by circles and sweep values.
    title
        Title, which should name the operating point.
    """
    for curve, style in zip(curves, _styles(curves), strict=True):
        ax.plot(curve.at, curve.value, label=f"{curve.label}, {curve.matrix}", **style)
    for crossover in crossovers:
        _mark(crossover, curves, ax)
    quantity = curves[0].quantity
    _frame(curves, ax)
    ax.set_ylabel(f"{quantity.what} [{quantity.unit}]")
    if title:
        ax.set_title(title, loc="left", fontsize=9)
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
    for curve, style in zip(curves, _styles(curves), strict=True):
        ax.plot(curve.at, curve.color_error, **style)
    _frame(curves, ax)
    ax.set_ylabel("mean color error [ΔE*ab]")
    ax.set_ylim(bottom=0)
    return ax


def _styles(curves: Sequence[Curve]) -> list[dict[str, Any]]:
    matrices = list(dict.fromkeys(curve.matrix for curve in curves))
    patterns = sensor_dashes(curve.label for curve in curves)
    return [
        {
            "color": _SHADES[matrices.index(curve.matrix) % len(_SHADES)],
            "linestyle": patterns[curve.label],
        }
        for curve in curves
    ]


def _frame(curves: Sequence[Curve], ax: Axes) -> None:
    sweep = curves[0].sweep
    if sweep.logarithmic:
        ax.set_xscale("log")
    ax.set_xlabel(f"{sweep.what} [{sweep.unit}]")
    ax.grid(visible=True, alpha=0.25)


def _mark(crossover: Crossover, curves: Sequence[Curve], ax: Axes) -> None:
    curve = next(c for c in curves if (c.sensor, c.matrix) == (crossover.first, crossover.matrix))
    for value in crossover.at:
        height = float(np.interp(value, curve.at, curve.value))
        ax.plot(value, height, "o", color=INK, markerfacecolor="none", markersize=8)
        ax.annotate(
            f"{value:.2g} {crossover.sweep.unit}",
            (value, height),
            xytext=(-2, 10),
            textcoords="offset points",
            color=QUIET,
        )
