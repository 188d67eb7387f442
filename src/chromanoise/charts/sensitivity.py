"""Effects of 1 nm or 1 % of each parameter on the objectives of a sensor."""

from typing import Any

from chromanoise.charts.text import NONE, brief, table
from chromanoise.design import Effect, Sensitivity
from chromanoise.exposure import conditions

_DIGITS = 3
_MOST = 3  # parameters in the description


def drawn_sensitivity(result: Sensitivity) -> dict[str, Any]:
    """One bar per parameter and objective.

    Returns
    -------
    dict
        ``title``, ``description``; ``objectives`` with their value; ``bars``, one per parameter,
        with ``effects`` and their ``text`` by objective; ``notes``; ``table``.
    """
    bars = [_bar(effect, result) for effect in result.effects]
    units = {one.name: one.unit for one in result.objectives}
    first = result.objectives[0]
    largest = "; ".join(
        f"{bar['what']} {bar['text'][first.name]} per {bar['unit']}" for bar in bars[:_MOST]
    )
    return {
        "title": f"Sensitivity of {result.point.sensor.label} at {conditions([result.point])}",
        "description": f"Largest effects on {first.what}: {largest}.",
        "objectives": [
            {"name": one.name, "what": one.what, "unit": one.unit, "value": result.value[one.name]}
            for one in result.objectives
        ],
        "bars": bars,
        "notes": list(result.notes),
        "table": table(
            [
                "parameter",
                "change",
                *(name if unit == "1" else f"{name} [{unit}]" for name, unit in units.items()),
            ],
            [[bar["what"], f"+1 {bar['unit']}", *bar["text"].values()] for bar in bars],
        ),
    }


def _bar(effect: Effect, result: Sensitivity) -> dict[str, Any]:
    text = {}
    for one in result.objectives:
        slope = brief(effect.slope[one.name], _DIGITS)
        text[one.name] = slope if one.unit == "1" or slope == NONE else f"{slope} {one.unit}"
    return {
        "name": effect.parameter.name,
        "what": effect.parameter.what,
        "unit": effect.parameter.unit,
        "effects": dict(effect.slope),
        "text": text,
    }
