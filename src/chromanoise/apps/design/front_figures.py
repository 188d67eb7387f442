"""Figures of a design: the front of a search, and the sensitivity of a sensor to its parameters."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chromanoise.apps.design.front_charts import drawn_front
from chromanoise.apps.design.pareto_front import FrontFile
from chromanoise.apps.design.sensitivity import Sensitivity
from chromanoise.charts import INK, QUIET, chromanoise_style, write_beside
from chromanoise.noise import conditions

_REFERENCES = "sD^vP*"
_MOST_NAMED = 6
_SIZE_IN = (6.4, 4.4)


def draw_front(front: FrontFile, ax: Axes) -> Axes:
    """Draw the members as dots, extremes and knee with their names, and the references as marks.

    Parameters
    ----------
    front
        The front; its first two objectives are drawn.
    """
    data = drawn_front(front)
    axes = {one["name"]: one for one in data["axes"]}
    x, y = data["x"], data["y"]
    for mark, size, color in (("member", 5, QUIET), ("extreme", 7, INK), ("knee", 7, INK)):
        placed = _points([one for one in data["members"] if one["mark"] == mark], x, y)
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
        ax.plot(*_points([one], x, y), shape, color=INK, linestyle="none", label=one["name"])
    ax.set(xlabel=axes[x]["title"], ylabel=axes[y]["title"])
    ax.grid(visible=True, alpha=0.25)
    ax.margins(0.1)
    ax.set_title(data["title"], loc="left", fontweight="normal", fontsize=9)
    ax.legend(loc="best", fontsize=8)
    return ax


_KEY = {"member": "sensor of the front", "extreme": "best in one objective", "knee": "knee"}


def _points(entries: list[dict[str, Any]], x: str, y: str) -> tuple[list[float], list[float]]:
    known = [one["values"] for one in entries if None not in (one["values"][x], one["values"][y])]
    return [one[x] for one in known], [one[y] for one in known]


def front_figure(front: FrontFile) -> Figure:
    """`draw_front` on a figure of its own."""
    with chromanoise_style():
        figure = Figure(figsize=_SIZE_IN, layout="constrained")
        draw_front(front, figure.add_subplot())
    return figure


_MOST_BARS = 15


def draw_sensitivity(result: Sensitivity, ax: Axes) -> Axes:
    """Draw one bar per parameter, the 15 with the largest effect on the first objective."""
    first = result.objectives[0]
    sizes = [(one.parameter, one.slope[first.name]) for one in result.effects]
    bars = [(one, size) for one, size in sizes if size is not None][:_MOST_BARS]
    for row, (_, size) in enumerate(bars):
        ax.barh(row, size, color=INK if size >= 0 else QUIET)
    ax.set_yticks(range(len(bars)), [f"{one.what}, +1 {one.unit}" for one, _ in bars])
    ax.invert_yaxis()
    title = f"Sensitivity of {result.point.sensor.label} at {conditions([result.point])}"
    ax.set(xlabel=f"change of {first.what} [{first.unit}]", title=title)
    return ax
