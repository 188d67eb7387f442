"""Color error against noise, over the weight of the noise in the matrix."""

from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import Any

from matplotlib.axes import Axes

from chromanoise.figures.style import (
    INK,
    QUIET,
    are_many,
    legend_beside,
    mark_zero,
    sensor_lines,
    sensor_mark,
    write_beside,
)

_LETTERS = 22  # of a line of the legend beside the axes


def draw_pareto(data: dict[str, Any], ax: Axes) -> Axes:
    """Draw one curve per sensor, ends labeled by weight, and a large mark at the current matrix.

    Of more than three sensors, the title has the weights at the ends, which are the same for all.

    Parameters
    ----------
    data
        The chart ``pareto`` of `chromanoise.charts`.
    ax
        Axes of matplotlib to draw on.
    """
    lines = sensor_lines(sensor["name"] for sensor in data["sensors"])
    many = are_many(lines)
    for i, sensor in enumerate(data["sensors"]):
        name, line = sensor["name"], lines[sensor["name"]]
        known = [p for p in sensor["points"] if None not in (p["snr_db"], p["color_error"])]
        snr, error = [p["snr_db"] for p in known], [p["color_error"] for p in known]
        weights = [] if many else [p["text"] for p in known]
        draw_trade(snr, error, weights, ax, line=line)
        now = sensor["now"]
        look = line | sensor_mark(i, line["color"])
        where = ([], []) if None in now.values() else ([now["snr_db"]], [now["color_error"]])
        ax.plot(*where, label=fill(name, _LETTERS) if many else name, **look)
    ax.grid(visible=True, alpha=0.25)
    if data["logarithmic"]:
        ax.set_yscale("log")
    else:
        ax.set_ylim(bottom=0)
    mark_zero(ax, axis="x")
    ax.set(xlabel="SNR of Y [dB]", ylabel="training error, mean [ΔE*ab]")
    ends = [data["sensors"][0]["points"][k]["text"] for k in (0, -1)]
    along = f"Curves: the weight of the noise from {ends[0]} to {ends[1]} (right)."
    weights_note = along if many else "Numbers: the weight of the noise."
    key = f"{weights_note} Mark: the {data['matrix']} matrix."
    ax.set_title(f"{data['title']}\n{key}", loc="left", fontweight="normal", fontsize=9)
    if many:
        legend_beside(ax, fontsize=7)
    else:
        ax.legend(loc="best", fontsize=8)
    return ax


def draw_trade(
    snr_db: Sequence[float],
    color_error: Sequence[float],
    weights: Sequence[str],
    ax: Axes,
    *,
    line: Mapping[str, Any] | None = None,
    label: str | None = None,
) -> Axes:
    """Draw one curve of color error against SNR, with ends labeled by weight.

    Parameters
    ----------
    snr_db, color_error
        One value per weight. [dB], [Delta E*ab]
    weights
        As text.
    ax
        To draw on.
    line, label
        Color and dash pattern of the curve, from `sensor_lines`; its name in the legend.
    """
    look = dict(line or {"color": INK, "linestyle": "solid"})
    ax.plot(snr_db, color_error, label=label, **look)
    ax.plot(snr_db, color_error, ".", color=look["color"], markersize=4)
    ends = ((0, -1), (-1, 1)) if len(weights) else ()
    for k, side in ends:
        quiet = {
            "ha": "left" if side > 0 else "right",
            "va": "center",
            "color": QUIET,
            "fontsize": 8,
        }
        write_beside(ax, weights[k], (snr_db[k], color_error[k]), (5 * side, 7 * side), **quiet)
    return ax
