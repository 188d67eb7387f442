"""Sensors over a sweep: a quantity and the color error."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis import Crossover, Curve
from chromanoise.charts.text import brief
from chromanoise.figures.style import (
    INK,
    QUIET,
    are_many,
    channel_color,
    mark_zero,
    matrix_dashes,
    sensor_dashes,
    sensor_lines,
    sensor_mark,
    spread,
    write_beside,
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
        Curves from `chromanoise.analysis.compared`, all of one sweep and quantity.
    ax
        To draw on.
    crossovers
        Crossovers from `chromanoise.analysis.crossovers`, marked by circles and sweep values.
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
