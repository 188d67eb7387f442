"""Charts of a design: the front of a search, and the sensitivity of a sensor to its parameters."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chromanoise.apps.design.pareto_front import (
    FrontFile,
    FrontMember,
    FrontObjective,
    FrontReference,
)
from chromanoise.apps.design.sensitivity import Sensitivity
from chromanoise.base import check
from chromanoise.charts import (
    INK,
    QUIET,
    brief,
    chromanoise_style,
    listed,
    table,
    write_beside,
)
from chromanoise.noise import conditions

_DIGITS = 4


def drawn_front(front: FrontFile, *, x: str | None = None, y: str | None = None) -> dict[str, Any]:
    """The members and the references of a front, with the values of all objectives.

    Parameters
    ----------
    x, y
        Objectives of the two axes; ``None`` for the first and the second.

    Returns
    -------
    dict
        ``title``, ``description``; ``x`` and ``y``; ``axes``, one per objective; ``members``
        and ``references`` with ``values`` and their ``text`` by objective; a member's ``mark`` is
        ``extreme``, ``knee`` or ``member``; ``reading``, its values as text; ``sentences``;
        ``table``.

    Raises
    ------
    InputError
        If the front has no such objective.
    """
    known = tuple(one.name for one in front.objectives)
    across = check.one_of("x", known[0] if x is None else x, known)
    up = check.one_of("y", known[min(1, len(known) - 1)] if y is None else y, known)
    axes = {one.name: _axis(one) for one in front.objectives}
    count = len(front.members)
    sensors = "1 sensor" if count == 1 else f"{count} sensors"
    members = [_member(one, front.objectives) for one in front.members]
    references = [_placed(one, front.objectives) for one in front.references]
    return {
        "title": f"Front of {sensors}{_scenes(front)}",
        "description": _description(front, sensors),
        "x": across,
        "y": up,
        "axes": list(axes.values()),
        "members": members,
        "references": references,
        "sentences": list(front.sentences),
        "table": table(
            ["sensor", *(one["title"] for one in axes.values()), "remarks"],
            [
                [
                    one["name"],
                    *(brief(value, _DIGITS) for value in one["values"].values()),
                    " ".join(one.get("notes", ())),
                ]
                for one in (*references, *members)
            ],
        ),
    }


def _axis(objective: FrontObjective) -> dict[str, str]:
    unit = _shown(objective.unit)
    title = f"{objective.what} [{unit}]" if unit else objective.what
    return {"name": objective.name, "title": title, "better": objective.better}


def _placed(one: FrontReference, objectives: list[FrontObjective]) -> dict[str, Any]:
    values = {each.name: one.objectives[each.name] for each in objectives}
    text = {each.name: _with_unit(values[each.name], each.unit) for each in objectives}
    values_text = "; ".join(f"{each.what} {text[each.name]}" for each in objectives)
    return {
        "name": one.name,
        "values": values,
        "text": text,
        "reading": f"{one.name}: {values_text}.",
    }


def _member(one: FrontMember, objectives: list[FrontObjective]) -> dict[str, Any]:
    what = {each.name: each.what for each in objectives}
    best = [what.get(name, name) for name in one.extreme_of]
    notes = [
        *([f"Best {listed(best)}."] if best else []),
        *(_beside(one.robust, one.robust_extreme_of, objectives, "Within its tolerances")),
        *(_beside(one.nominal, one.nominal_extreme_of, objectives, "Without tolerances")),
        *(["Knee of the front."] if one.knee else []),
        *([f"Held by {', '.join(one.held_by)}."] if one.held_by else []),
    ]
    mark = "knee" if one.knee else "extreme" if best else "member"
    placed = _placed(one, objectives)
    reading = " ".join((placed["reading"], *notes))
    return placed | {"mark": mark, "notes": notes, "reading": reading}


def _beside(
    values: dict[str, float | None],
    extreme_of: list[str],
    objectives: list[FrontObjective],
    words: str,
) -> list[str]:
    """The values of objectives that the search did not optimize, and which of them are the best."""
    if not values:
        return []
    shown = (f"{one.what} {_with_unit(values.get(one.name), one.unit)}" for one in objectives)
    best = [one.what for one in objectives if one.name in extreme_of]
    ending = f"; best {listed(best)}" if best else ""
    return [f"{words}: {', '.join(shown)}{ending}."]


def _with_unit(value: float | None, unit: str) -> str:
    text = brief(value, _DIGITS)
    return text if value is None else f"{text} {_shown(unit)}".strip()


def _shown(unit: str) -> str:
    return "" if unit == "1" else unit.replace("Delta E", "ΔE")


def _scenes(front: FrontFile) -> str:
    names = [one.name for one in front.scenes]
    return f", scene{'' if len(names) == 1 else 's'} {listed(names)}" if names else ""


def _description(front: FrontFile, sensors: str) -> str:
    better = [f"{one.better} {one.what}" for one in front.objectives]
    names = [one.name for one in front.references]
    beside = f" References: {listed(names)}." if names else ""
    return f"{sensors}; better is {listed(better)}.{beside} {' '.join(front.sentences)}".strip()


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
