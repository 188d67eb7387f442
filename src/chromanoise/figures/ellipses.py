"""Noise of every ColorChecker patch in a plane of color, on equal axes."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon
from matplotlib.ticker import EngFormatter, MaxNLocator

from chromanoise.figures.style import INK

_THOUSANDS = 1e4


def draw_ellipses(data: dict[str, Any], i: int, ax: Axes) -> Axes:
    """Draw the ellipses of one sensor, crosses at true colors, and lines to measured colors.

    Parameters
    ----------
    data
        The chart ``ellipses`` of `chromanoise.charts`.
    i
        Index of the sensor.
    ax
        Axes of matplotlib to draw on.
    """
    sensor = data["sensors"][i]
    for patch in sensor["patches"]:
        outline = np.array(patch["outline"])
        ax.add_patch(
            Polygon(outline, facecolor=patch["srgb"], edgecolor=INK, linewidth=0.7, alpha=0.6)
        )
        truth, center = patch["truth"], patch["center"]
        ax.plot([truth[0], center[0]], [truth[1], center[1]], color=INK, linewidth=0.7)
        ax.plot(*truth, "+", color=INK, markersize=5)
    (left, bottom), (right, top) = data["window"]
    margin = 0.03 * max(right - left, top - bottom)
    ax.set(xlim=(left - margin, right + margin), ylim=(bottom - margin, top + margin))
    ax.set_aspect("equal", adjustable="box")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(3, steps=[1, 2, 5, 10]))
        if max(map(abs, (left, right, bottom, top))) >= _THOUSANDS:
            axis.set_major_formatter(EngFormatter(sep=""))
    ax.grid(visible=True, alpha=0.25)
    ax.set(xlabel=data["names"][0], ylabel=data["names"][1], title=sensor["name"])
    if sensor["larger"]:
        box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0}
        where: dict[str, Any] = {
            "transform": ax.transAxes,
            "ha": "right",
            "va": "top",
            "fontsize": 7,
        }
        ax.text(0.97, 0.97, "larger than\nthe panel", bbox=box, **where)
    if sensor["why_not"]:
        ax.text(0.5, 0.5, "saturated", transform=ax.transAxes, ha="center")
    return ax
