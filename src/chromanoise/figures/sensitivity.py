"""The effects of parameters on the first objective as bars."""

from matplotlib.axes import Axes

from chromanoise.charts.sensitivity import drawn_sensitivity
from chromanoise.design import Sensitivity
from chromanoise.figures.style import INK, QUIET

_MOST = 15


def draw_sensitivity(result: Sensitivity, ax: Axes) -> Axes:
    """Draw one bar per parameter, the 15 with the largest effect on the first objective.

    Parameters
    ----------
    result
        From `chromanoise.sensitivity`.
    ax
        Axes.
    """
    drawn = drawn_sensitivity(result)
    one = drawn["objectives"][0]
    bars = [bar for bar in drawn["bars"] if bar["effects"][one["name"]] is not None][:_MOST]
    for row, bar in enumerate(bars):
        size = bar["effects"][one["name"]]
        ax.barh(row, size, color=INK if size >= 0 else QUIET)
    ax.set_yticks(range(len(bars)), [f"{bar['what']}, +1 {bar['unit']}" for bar in bars])
    ax.invert_yaxis()
    ax.set(xlabel=f"change of {one['what']} [{one['unit']}]", title=drawn["title"])
    return ax
