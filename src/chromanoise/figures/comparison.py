"""Sensors over a sweep: the quantity above, color error below, never one alone."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from chromanoise.analysis import Crossover, Curve
from chromanoise.figures.style import INK, QUIET, channel_color, sensor_dashes

_SHADES = (INK, *(channel_color(name) for name in "BRG"))


def draw_comparison(
    curves: Sequence[Curve], crossed: Sequence[Crossover], axes: tuple[Axes, Axes]
) -> tuple[Axes, Axes]:
    """The quantity on the first axes and mean color error on the second, over the sweep.

    One color per matrix, one dash pattern per sensor; circles mark the crossovers.

    Parameters
    ----------
    curves
        Of `chromanoise.analysis.compared`, all of one sweep and quantity.
    crossed
        Of `chromanoise.analysis.crossovers`.
    axes
        Above and below, which share their abscissa.
    """
    above, below = axes
    matrices = list(dict.fromkeys(curve.matrix for curve in curves))
    patterns = sensor_dashes(curve.sensor for curve in curves)
    for curve in curves:
        color = _SHADES[matrices.index(curve.matrix) % len(_SHADES)]
        dashes = patterns[curve.sensor]
        label = f"{curve.sensor}, {curve.matrix}"
        above.plot(curve.at, curve.value, color=color, linestyle=dashes, label=label)
        below.plot(curve.at, curve.color_error, color=color, linestyle=dashes)
    for crossover in crossed:
        curve = next(
            c for c in curves if (c.sensor, c.matrix) == (crossover.first, crossover.matrix)
        )
        for value in crossover.at:
            height = np.interp(value, curve.at, curve.value)
            above.plot(value, height, "o", color=INK, markerfacecolor="none", markersize=8)
            above.annotate(
                f"{value:.2g} {crossover.sweep.unit}",
                (value, height),
                xytext=(-2, 10),
                textcoords="offset points",
                color=QUIET,
            )
    sweep, quantity = curves[0].sweep, curves[0].quantity
    for ax in axes:
        if sweep.logarithmic:
            ax.set_xscale("log")
        ax.grid(visible=True, alpha=0.25)
    above.set_ylabel(f"{quantity.what} [{quantity.unit}]")
    below.set_ylabel("mean color error [ΔE*ab]")
    below.set_ylim(bottom=0)
    below.set_xlabel(f"{sweep.what} [{sweep.unit}]")
    above.legend(loc="lower right", fontsize=8)
    return axes
