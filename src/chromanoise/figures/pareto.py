"""Color error against noise, over the weight of the noise in the matrix."""

from typing import Any

from matplotlib.axes import Axes

from chromanoise.figures.style import INK, QUIET, sensor_dashes

_MARKS = "osD^vP"


def draw_pareto(data: dict[str, Any], ax: Axes) -> Axes:
    """One curve per sensor, its ends told by their weight, and a large mark where it is now.

    Parameters
    ----------
    data
        The drawing ``pareto`` of `chromanoise.charts`.
    """
    patterns = sensor_dashes(sensor["name"] for sensor in data["sensors"])
    for i, sensor in enumerate(data["sensors"]):
        name, dashes = sensor["name"], patterns[sensor["name"]]
        known = [p for p in sensor["points"] if None not in (p["snr_db"], p["color_error"])]
        at = [(p["snr_db"], p["color_error"]) for p in known]
        snr, error = [one[0] for one in at], [one[1] for one in at]
        ax.plot(snr, error, color=INK, linestyle=dashes)
        ax.plot(snr, error, ".", color=INK, markersize=4)
        for point, side in zip((*known[:1], *known[-1:]), (-1, 1), strict=False):
            _write_weight(ax, point, side)
        now = sensor["now"]
        turn, shape = divmod(i, len(_MARKS))
        mark, fill = _MARKS[shape], INK if shape % 2 == turn % 2 else "white"
        where = ([], []) if None in now.values() else ([now["snr_db"]], [now["color_error"]])
        ax.plot(*where, mark, color=INK, markerfacecolor=fill, linestyle=dashes, label=name)
    ax.grid(visible=True, alpha=0.25)
    ax.set_ylim(bottom=0)
    ax.set(xlabel="SNR of Y [dB]", ylabel="color error, mean [ΔE*ab]")
    title = f"Numbers: the weight of the noise. Mark: the {data['matrix']} matrix."
    ax.set_title(title, fontweight="normal", fontsize=9)
    ax.legend(loc="best", fontsize=8)
    return ax


def _write_weight(ax: Axes, point: dict[str, Any], side: int) -> None:
    ax.annotate(
        f"{point['weight']:g}",
        (point["snr_db"], point["color_error"]),
        xytext=(5 * side, 7 * side),
        textcoords="offset points",
        ha="left" if side > 0 else "right",
        va="center",
        color=QUIET,
        fontsize=8,
    )
