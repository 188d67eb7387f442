"""The heat maps of a study: its sweeps of two parameters."""

from collections.abc import Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from chromanoise.base import DIFFERENCES, SENSORS, VALUES, Array, Float, Int, color_between
from chromanoise.charts.charted_study import Look, Shown, unclipped_remark
from chromanoise.charts.description import Axis, Cells, Chart, Panel, column
from chromanoise.charts.numbers import UNDEFINED, brief, decimal, percent
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


def drawn_map(shown: Shown, look: Look) -> Chart:
    """The first sweep of two parameters, with the first matrix, on a grid of `MOST_VALUES`.

    Without such a sweep, a chart without panels whose note says so.
    """
    number = next((i for i, one in enumerate(shown.study.sweeps) if one.second is not None), None)
    if number is None:
        none: dict[str, Any] = {"sensors": (), "columns": (), "panels": ()}
        return Chart(title="", description="", notes=(_NO_MAP,), **none)
    name, maker = next(iter(shown.makers.items()))
    study, note = _coarser(shown.study, number)
    found = sweep_map(study, shown.operating_points, {name: maker}, number)
    first = found.maps[0]
    return map_of(
        found.maps,
        found.lines,
        title=(
            f"{first.quantity.what} over {first.sweep.what} and {first.second.what}, from "
            f"{conditions(shown.operating_points)}{unclipped_remark(shown)}"
        ),
        note=note,
    )


def map_of(
    maps: Sequence[QuantityMap],
    lines: Sequence[CrossoverLine] = (),
    *,
    title: str = "",
    note: str = "",
) -> Chart:
    """A heat map with one matrix.

    Of one sensor, the quantity. Of two, the first minus the second, and the line where they are
    equal. Of more, the best sensor.

    Parameters
    ----------
    lines
        Where two sensors are equal.
    """
    first, several = maps[0], len(maps) > 1
    best = best_of(maps)
    if not several:
        values = first.value
    else:
        values = (
            maps[0].value - maps[1].value if len(maps) == 2 else np.where(best < 0, np.nan, best)
        )
    what, drawn_maps = _what(maps), maps
    leaders = np.unique(best[best >= 0])
    if len(maps) > 2 and leaders.size == 1:  # in one color a map would show nothing
        (leader,) = leaders.tolist()
        what, drawn_maps = f"{maps[leader].label}, lead over the next sensor", (maps[leader],)
        values = _lead(maps, leader)
    scale = _scale(values, best, drawn_maps)
    sweeps = (first.sweep, first.second)
    across, up = (one.ravel().tolist() for one in np.meshgrid(first.at, first.second_at))
    number = partial(decimal, digits=2, none=UNDEFINED)
    columns = [column(_heading(sweeps[0]), across, brief), column(_heading(sweeps[1]), up, brief)]
    for one in maps:
        head = f"{one.label} [{one.quantity.unit}]"
        columns.append(column(head, list(map(defined, one.value.ravel().tolist())), number))
    names = [maps[i].label if i >= 0 else UNDEFINED for i in best.ravel().tolist()]
    if several:
        columns.append(column(None, names, shown="best"))
    drawn = tuple(map(defined, values.ravel().tolist()))
    columns.append(column(None, drawn, None))
    x, y = (
        Axis(
            label=one.head or "",
            low=float(at[0]),
            high=float(at[-1]),
            logarithmic=sweep.logarithmic,
            exact=True,
        )
        for one, at, sweep in zip(columns, (first.at, first.second_at), sweeps, strict=False)
    )
    cells = Cells(
        x=0,
        y=1,
        value=len(columns) - 1,
        across=len(first.at),
        name=what if len(drawn_maps) > 2 else f"{what} [{first.quantity.unit}]",
        equal=_equal(lines[0], first.second_at) if len(maps) == 2 and lines else (),
        **scale,
    )
    notes = [
        "Line: both are equal." if cells.equal else "",
        "Gray: a channel is saturated, or the value is undefined." if None in drawn else "",
        note,
    ]
    return Chart(
        title=title,
        description=_description(drawn_maps, values, what),
        sensors=tuple(one.label for one in maps),
        columns=tuple(columns),
        panels=(Panel(x=x, y=y, marks=(cells,)),),
        notes=tuple(filter(None, [" ".join(filter(None, notes))])),
    )


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


def _heading(sweep: Sweep) -> str:
    return sweep.what if sweep.unit == "1" else f"{sweep.what} [{sweep.unit}]"


def _what(maps: Sequence[QuantityMap]) -> str:
    first = maps[0]
    if len(maps) == 1:
        return f"{first.label}: {first.quantity.what}"
    if len(maps) == 2:
        return f"{first.label} minus {maps[1].label}"
    return f"Sensor with the {'highest' if first.quantity.more_is_better else 'lowest'} value"


def _scale(
    values: Float[Array, "j k"], best: Int[Array, "j k"], maps: Sequence[QuantityMap]
) -> dict[str, Any]:
    """Colors with their ends; of more than two sensors a color each, for the winners a name."""
    if len(maps) > 2:
        names = tuple(one.label if (best == i).any() else "" for i, one in enumerate(maps))
        colors = tuple(SENSORS[i % len(SENSORS)][0] for i in range(len(maps)))
        return {"low": 0.0, "high": len(maps) - 1.0, "colors": colors, "names": names}
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    if len(maps) == 2:
        high = max(high, -low)
        low = -high
    if low == high:
        low, high = low - 1.0, high + 1.0
    stops = DIFFERENCES if len(maps) == 2 else VALUES
    shares = (i / (_SCALE_COLORS - 1) for i in range(_SCALE_COLORS))
    colors = tuple(color_between(stops, one) for one in shares)
    return {"low": low, "high": high, "colors": colors}


def _equal(
    line: CrossoverLine, second_at: Float[Array, " j"]
) -> tuple[tuple[tuple[float, float], ...], ...]:
    """Where two sensors are equal: lines through the crossovers of neighboring rows."""
    rows = second_at.tolist()
    lines = [[(x, rows[0])] for x in line.at[0]]
    open_lines = list(lines)
    for (before, now), y in zip(pairwise(line.at), rows[1:], strict=True):
        points = [(x, y) for x in now]
        if len(before) == len(now):
            for one, point in zip(open_lines, points, strict=True):
                one.append(point)
        else:
            open_lines = [[point] for point in points]
            lines += open_lines
    return tuple(map(tuple, lines))


def _lead(maps: Sequence[QuantityMap], leader: int) -> Float[Array, "j k"]:
    """How far a sensor is before the next best one; NaN where another is undefined."""
    sign = 1 if maps[leader].quantity.more_is_better else -1
    others = [sign * one.value for i, one in enumerate(maps) if i != leader]
    return np.asarray(sign * maps[leader].value - np.max(others, axis=0))


def _description(maps: Sequence[QuantityMap], values: Float[Array, "j k"], what: str) -> str:
    known = values[np.isfinite(values)]
    first = maps[0]
    if not known.size:
        return f"{first.quantity.what} is undefined at all values."
    if len(maps) > 2:
        shares = [f"{one.label} at {percent((values == i).mean())}" for i, one in enumerate(maps)]
        return f"{what}: {', '.join(shares)} of the pairs of values."
    ends = f"{decimal(known.min())} to {decimal(known.max())} {first.quantity.unit}"
    return f"{what}: {ends}."
