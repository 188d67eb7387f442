"""Figures of a design: the front of a search, and the sensitivity of a sensor."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chromanoise.charts.front import drawn_front, drawn_sensitivity
from chromanoise.design import FrontFile, Sensitivity
from chromanoise.figures.style import INK, QUIET, chromanoise_style, write_beside

_REFERENCES = "sD^vP*"
_MOST_NAMED = 6
_SIZE_IN = (6.4, 4.4)


def draw_front(front: FrontFile, ax: Axes) -> Axes:
    """Draw the members as dots, extremes and knee with their names, and the references as marks.

    Parameters
    ----------
    front
        The front; its first two objectives are drawn.
    ax
        To draw on.
    """
    data = drawn_front(front)
    axes = {one["name"]: one for one in data["axes"]}
    x, y = data["x"], data["y"]
    for mark, size, color in (("member", 5, QUIET), ("extreme", 7, INK), ("knee", 7, INK)):
        placed = _placed([one for one in data["members"] if one["mark"] == mark], x, y)
        fill = "white" if mark == "extreme" else color
        ax.plot(*placed, "o", markersize=size, color=color, markerfacecolor=fill, label=_KEY[mark])
    named = [one for one in data["members"] if one["mark"] != "member"][:_MOST_NAMED]
    for one in named:
        if None not in (one["values"][x], one["values"][y]):
            at, is_knee = (one["values"][x], one["values"][y]), one["mark"] == "knee"
            by, side = ((8, -10), "left") if is_knee else ((-8, 0), "right")
            write_beside(ax, one["name"], at, by, ha=side, va="center", fontsize=8, color=QUIET)
    for i, one in enumerate(data["references"]):
        shape = _REFERENCES[i % len(_REFERENCES)]
        ax.plot(*_placed([one], x, y), shape, color=INK, linestyle="none", label=one["name"])
    ax.set(xlabel=axes[x]["title"], ylabel=axes[y]["title"])
    ax.grid(visible=True, alpha=0.25)
    ax.margins(0.1)
    ax.set_title(data["title"], loc="left", fontweight="normal", fontsize=9)
    ax.legend(loc="best", fontsize=8)
    return ax


_KEY = {"member": "sensor of the front", "extreme": "best in one objective", "knee": "knee"}


def _placed(entries: list[dict[str, Any]], x: str, y: str) -> tuple[list[float], list[float]]:
    known = [one["values"] for one in entries if None not in (one["values"][x], one["values"][y])]
    return [one[x] for one in known], [one[y] for one in known]


def front_figure(front: FrontFile) -> Figure:
    """`draw_front` on a figure of its own.

    Parameters
    ----------
    front
        The front.
    """
    with chromanoise_style():
        figure = Figure(figsize=_SIZE_IN, layout="constrained")
        draw_front(front, figure.add_subplot())
    return figure


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
