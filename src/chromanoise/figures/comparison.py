"""Sensors over the light level: luminance SNR above, color error below, never one alone."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from chromanoise.figures.style import INK, QUIET, sensor_dashes
from chromanoise.study import Crossover, Curve

_SHADES = (INK, "#0072B2", "#D55E00", "#009E73")


def draw_comparison(
    curves: Sequence[Curve], crossed: Sequence[Crossover], axes: tuple[Axes, Axes]
) -> tuple[Axes, Axes]:
    """SNR of Y on the first axes and mean color error on the second, against illuminance.

    One color per matrix, one dash pattern per sensor; circles mark the crossovers.
    """
    above, below = axes
    matrices = list(dict.fromkeys(curve.matrix for curve in curves))
    for curve in curves:
        color = _SHADES[matrices.index(curve.matrix) % len(_SHADES)]
        dashes = sensor_dashes(curve.sensor)
        label = f"{curve.sensor}, {curve.matrix}"
        above.plot(curve.level_lux, curve.snr_y_db, color=color, linestyle=dashes, label=label)
        below.plot(curve.level_lux, curve.color_error, color=color, linestyle=dashes)
    for crossover in crossed:
        curve = next(
            c for c in curves if (c.sensor, c.matrix) == (crossover.first, crossover.matrix)
        )
        for level in crossover.level_lux:
            height = np.interp(np.log(level), np.log(curve.level_lux), curve.snr_y_db)
            above.plot(level, height, "o", color=INK, markerfacecolor="none", markersize=8)
            above.annotate(
                f"{level:.2g} lx",
                (level, height),
                xytext=(-2, 10),
                textcoords="offset points",
                color=QUIET,
            )
    for ax in axes:
        ax.set_xscale("log")
        ax.grid(visible=True, alpha=0.25)
    above.set_ylabel("SNR of Y [dB]")
    below.set_ylabel("mean color error [ΔE*ab]")
    below.set_ylim(bottom=0)
    below.set_xlabel("illuminance [lx]")
    above.legend(loc="lower right", fontsize=8)
    return axes
