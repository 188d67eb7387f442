"""The heat maps of a study: its sweeps of two parameters."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from chromanoise.base import DIFFERENCES, SENSORS, VALUES, Array, Float, color_between
from chromanoise.charts.charted_study import Look, Shown, unclipped_remark
from chromanoise.charts.numbers import UNDEFINED, brief, decimal, percent, table
from chromanoise.noise import conditions
from chromanoise.study import (
    ComparisonMap,
    CrossoverLine,
    QuantityMap,
    Study,
    Sweep,
    best_of,
    defined,
    sweep_map,
)

MOST_VALUES = (25, 17)
"""Largest number of values of the first and of the second parameter in `drawn_map`."""
_SCALE_COLORS = 32
_NO_MAP = "Choose two parameters to compare the sensors on a grid of their values."


def sweep_maps(of: Shown) -> tuple[ComparisonMap, ...]:
    """Each sweep of two parameters of a study, as a run computes it.

    Parameters
    ----------
    of
        The study.

    Raises
    ------
    InputError
        If a value of a sweep cannot be used.
    """
    return tuple(
        sweep_map(of.study, of.operating_points, of.makers, i)
        for i, part in enumerate(of.study.sweeps)
        if part.second is not None
    )


def drawn_map(shown: Shown, look: Look) -> dict[str, Any]:
    """The first sweep of two parameters, with the first matrix, on a grid of `MOST_VALUES`.

    Of one sensor, the quantity. Of two, the first minus the second, and the line where they are
    equal. Of more, the best sensor.
    """
    number = next((i for i, one in enumerate(shown.study.sweeps) if one.second is not None), None)
    if number is None:
        return {"title": "", "description": "", "why_not": _NO_MAP, "table": table([], [])}
    name, maker = next(iter(shown.makers.items()))
    study, note = _coarser(shown.study, number)
    found = sweep_map(study, shown.operating_points, {name: maker}, number)
    maps, (first, *_) = found.maps, found.maps
    kind, values = _kind_and_values(maps)
    scale = _scale(kind, values)
    return {
        "title": (
            f"{first.quantity.what} over {first.sweep.what} and {first.second.what}, from "
            f"{conditions(shown.operating_points)}{unclipped_remark(shown)}"
        ),
        "description": _description(kind, maps, values),
        "why_not": None,
        "kind": kind,
        "matrix": name,
        "what": _what(kind, maps),
        "unit": first.quantity.unit,
        "x": _axis(first.sweep, first.at),
        "y": _axis(first.second, first.second_at),
        "colors": _colors(values, scale),
        "cells": _cells(maps),
        "sensors": [
            {"name": one.label, "values": [[defined(v) for v in row] for row in one.value.tolist()]}
            for one in maps
        ],
        "scale": scale,
        "key": _key(maps, values) if kind == "best" else [],
        "equal": _equal(found.lines[0], first.second_at) if kind == "difference" else [],
        "note": note,
        "table": _table(maps),
    }


def _coarser(study: Study, number: int) -> tuple[Study, str]:
    """The study with at most `MOST_VALUES` of the sweep, and what a run computes instead."""
    part = study.sweeps[number]
    assert part.second is not None  # as `drawn_map`
    asked = (part.points, part.second.points)
    across, up = (min(pair) for pair in zip(asked, MOST_VALUES, strict=True))
    if asked == (across, up):
        return study, ""
    second = part.second.model_copy(update={"points": up})
    fewer = part.model_copy(update={"points": across, "second": second})
    sweeps = (*study.sweeps[:number], fewer, *study.sweeps[number + 1 :])
    note = f"Drawn on {across} by {up} values; a run computes {asked[0]} by {asked[1]}."
    return study.model_copy(update={"sweeps": sweeps}), note


def _kind_and_values(maps: Sequence[QuantityMap]) -> tuple[str, Float[Array, "j k"]]:
    """What is drawn: the quantity, a difference, or the index of the best (NaN for none)."""
    if len(maps) == 1:
        return "value", maps[0].value
    if len(maps) == 2:
        return "difference", maps[0].value - maps[1].value
    best = best_of(maps)
    return "best", np.where(best < 0, np.nan, best)


def _what(kind: str, maps: Sequence[QuantityMap]) -> str:
    first = maps[0]
    if kind == "value":
        return f"{first.label}: {first.quantity.what}"
    if kind == "difference":
        return f"{first.label} minus {maps[1].label}"
    return f"Sensor with the {'highest' if first.quantity.more_is_better else 'lowest'} value"


def _scale(kind: str, values: Float[Array, "j k"]) -> dict[str, Any] | None:
    known = values[np.isfinite(values)]
    if kind == "best" or not known.size:
        return None
    low, high = float(known.min()), float(known.max())
    if kind == "difference":
        high = max(high, -low)
        low = -high
    if low == high:
        low, high = low - 1.0, high + 1.0
    stops = DIFFERENCES if kind == "difference" else VALUES
    shares = (i / (_SCALE_COLORS - 1) for i in range(_SCALE_COLORS))
    return {"low": low, "high": high, "colors": [color_between(stops, one) for one in shares]}


def _colors(values: Float[Array, "j k"], scale: dict[str, Any] | None) -> list[list[str | None]]:
    """The color of each cell; ``None`` where there is no value."""

    def color(value: float) -> str | None:
        if not np.isfinite(value):
            return None
        if scale is None:
            return f"var(--sensor-{int(value) % len(SENSORS)})"
        share = (value - scale["low"]) / (scale["high"] - scale["low"])
        return scale["colors"][round(share * (_SCALE_COLORS - 1))]

    return [[color(value) for value in row] for row in values.tolist()]


def _axis(sweep: Sweep, at: Float[Array, " k"]) -> dict[str, Any]:
    values = at.tolist()
    return {
        "what": _heading(sweep),
        "logarithmic": sweep.logarithmic,
        "values": values,
        "text": [f"{sweep.what} {sweep.with_unit(brief(value))}" for value in values],
    }


def _heading(sweep: Sweep) -> str:
    return sweep.what if sweep.unit == "1" else f"{sweep.what} [{sweep.unit}]"


def _cells(maps: Sequence[QuantityMap]) -> list[list[str]]:
    """The values of all sensors at each pair of values, in words."""
    rows, columns = maps[0].value.shape
    return [
        [", ".join(f"{one.label} {_in_words(one, j, k)}" for one in maps) for k in range(columns)]
        for j in range(rows)
    ]


def _in_words(one: QuantityMap, j: int, k: int) -> str:
    value = defined(float(one.value[j, k]))
    if value is None:
        return "saturated" if one.saturated[j, k] else UNDEFINED
    return f"{decimal(value, 2)} {one.quantity.unit}"


def _key(maps: Sequence[QuantityMap], values: Float[Array, "j k"]) -> list[dict[str, str]]:
    """The sensors that are best somewhere, with their colors."""
    return [
        {"name": one.label, "color": f"var(--sensor-{i % len(SENSORS)})"}
        for i, one in enumerate(maps)
        if (values == i).any()
    ]


def _equal(line: CrossoverLine, second_at: Float[Array, " j"]) -> list[list[list[float]]]:
    """Where two sensors are equal: lines through the crossovers of neighboring rows."""
    rows = second_at.tolist()
    lines = [[[x, rows[0]]] for x in line.at[0]]
    open_lines = list(lines)
    for (before, now), y in zip(pairwise(line.at), rows[1:], strict=True):
        points = [[x, y] for x in now]
        if len(before) == len(now):
            for one, point in zip(open_lines, points, strict=True):
                one.append(point)
        else:
            open_lines = [[point] for point in points]
            lines += open_lines
    return lines


def _description(kind: str, maps: Sequence[QuantityMap], values: Float[Array, "j k"]) -> str:
    known = values[np.isfinite(values)]
    first = maps[0]
    if not known.size:
        return f"{first.quantity.what} is undefined at all values."
    if kind == "best":
        shares = [f"{one.label} at {percent((values == i).mean())}" for i, one in enumerate(maps)]
        return f"{_what(kind, maps)}: {', '.join(shares)} of the pairs of values."
    ends = f"{decimal(known.min())} to {decimal(known.max())} {first.quantity.unit}"
    return f"{_what(kind, maps)}: {ends}."


def _table(maps: Sequence[QuantityMap]) -> dict[str, Any]:
    first = maps[0]
    head = [
        _heading(first.sweep),
        _heading(first.second),
        *(f"{one.label} [{first.quantity.unit}]" for one in maps),
    ]
    best = best_of(maps).tolist()
    rows = [
        [
            brief(x),
            brief(y),
            *(decimal(defined(float(one.value[j, k])), 2, UNDEFINED) for one in maps),
            *([maps[best[j][k]].label if best[j][k] >= 0 else UNDEFINED] if len(maps) > 1 else []),
        ]
        for j, y in enumerate(first.second_at.tolist())
        for k, x in enumerate(first.at.tolist())
    ]
    return table([*head, *(["best"] if len(maps) > 1 else [])], rows)
