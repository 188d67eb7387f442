"""Color error against noise, over the weight of the noise in the matrix."""

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes

from chromanoise.figures.style import INK, QUIET, sensor_dashes

_MARKS = "osD^vP"


def draw_pareto(data: dict[str, Any], ax: Axes) -> Axes:
    """Draw one curve per sensor, ends labeled by weight, and a large mark at the current matrix.

    Parameters
    ----------
    data
        The chart ``pareto`` of `chromanoise.charts`.
    """
    patterns = sensor_dashes(sensor["name"] for sensor in data["sensors"])
    for i, sensor in enumerate(data["sensors"]):
        name, dashes = sensor["name"], patterns[sensor["name"]]
        known = [p for p in sensor["points"] if None not in (p["snr_db"], p["color_error"])]
        snr, error = [p["snr_db"] for p in known], [p["color_error"] for p in known]
        draw_trade(snr, error, [p["text"] for p in known], ax, dashes=dashes)
        now = sensor["now"]
        turn, shape = divmod(i, len(_MARKS))
        mark, fill = _MARKS[shape], INK if shape % 2 == turn % 2 else "white"
        where = ([], []) if None in now.values() else ([now["snr_db"]], [now["color_error"]])
        ax.plot(*where, mark, color=INK, markerfacecolor=fill, linestyle=dashes, label=name)
    ax.grid(visible=True, alpha=0.25)
    ax.set_ylim(bottom=0)
    ax.set(xlabel="SNR of Y [dB]", ylabel="color error, mean [ΔE*ab]")
    key = f"Numbers: the weight of the noise. Mark: the {data['matrix']} matrix."
    ax.set_title(f"{data['title']}\n{key}", loc="left", fontweight="normal", fontsize=9)
    ax.legend(loc="best", fontsize=8)
    return ax


def draw_trade(
    snr_db: Sequence[float],
    color_error: Sequence[float],
    weights: Sequence[str],
    ax: Axes,
    *,
    dashes: Any = "solid",
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
    dashes, label
        Of the curve.
    """
    ax.plot(snr_db, color_error, color=INK, linestyle=dashes, label=label)
    ax.plot(snr_db, color_error, ".", color=INK, markersize=4)
    ends = ((0, -1), (-1, 1)) if len(weights) else ()
    for k, side in ends:
        _write_weight(ax, weights[k], (snr_db[k], color_error[k]), side)
    return ax


def _write_weight(ax: Axes, weight: str, at: tuple[float, float], side: int) -> None:
    ax.annotate(
        weight,
        at,
        xytext=(5 * side, 7 * side),
        textcoords="offset points",
        ha="left" if side > 0 else "right",
        va="center",
        color=QUIET,
        fontsize=8,
    )
