"""The chart of the front of a search."""

from typing import Any

from chromanoise.apps.design.pareto_front import (
    FrontFile,
    FrontMember,
    FrontObjective,
    FrontReference,
)
from chromanoise.base import check
from chromanoise.charts import brief, listed, table

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
