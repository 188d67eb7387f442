"""SNR over the light level, with the crossovers of sensors."""

import math
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np

from chromanoise.base import Array, Float
from chromanoise.charts.charted_study import Look, Shown, unclipped_remark
from chromanoise.charts.description import Axis, Chart, Line, Mark, Panel, Rule, as_data, column
from chromanoise.charts.numbers import UNDEFINED, brief, decimal, listed
from chromanoise.noise import level_in_words, light_and_exposure
from chromanoise.study import (
    MOST_PAIRS_SENSORS,
    QUANTITIES,
    SWEEPS,
    Crossover,
    Curve,
    Incomparable,
    Quantity,
    compared,
    crossover_sentence,
    crossovers_or_reasons,
    defined,
    fullest_level_lux,
    lead_sentences,
    leading_crossovers,
    leads,
    swept_values,
)

LOWEST_LUX, HIGHEST_LUX = 0.01, 10_000.0
"""Range of the curves and of the page's slider: moonlight to a cloudy day. [lx]"""
_PER_DECADE = 12  # includes the points of ``chromanoise compare``


def drawn_levels(shown: Shown, look: Look) -> Chart:
    """Curves of SNR over lux, each sensor with each matrix, and their crossovers.

    Of more than three sensors, only the crossovers at which the leader changes, and the leaders.

    Exposure times are those at the study's level, as in ``chromanoise compare``, which
    never clips.
    """
    quantity, level_lux = _quantity(shown, look), shown.study.light.level_lux
    curves, pairs = level_curves(shown, quantity)
    found = [one for one in pairs if isinstance(one, Crossover)]
    leading = leads(curves, found)
    many = len(shown.operating_points) > MOST_PAIRS_SENSORS
    crossed = leading_crossovers(leading, found) if many else pairs
    crossings = [one for one in crossed if isinstance(one, Crossover) and one.at]
    rules, numbered = _numbered(crossings, curves)
    apart = [
        crossover_sentence(one) if isinstance(one, Crossover) else one.why
        for one in crossed
        if one not in crossings
    ]
    names = [f"{one.label}, {one.matrix}" if len(shown.makers) > 1 else one.label for one in curves]
    return curves_chart(
        curves,
        [curve.value for curve in curves],
        f"{quantity.what} [{quantity.unit}]",
        names=names,
        rules=(*rules, _now(level_lux)),
        title=(
            f"{quantity.what} against illuminance ({light_and_exposure(shown.operating_points)})"
            f"{unclipped_remark(shown)}"
        ),
        description=_description(names, curves, [*numbered, *apart]),
        numbered=numbered,
        notes=(
            *apart,
            *(lead_sentences(leading) if many else ()),
            *_notes(shown, curves, names, quantity.what),
        ),
    )


def _now(level_lux: float) -> Rule:
    return Rule(at=level_lux, role="now", text=f"now {level_in_words(level_lux)}")


def at_level(data: dict[str, Any], level_lux: float) -> dict[str, Any]:
    """The chart ``levels`` as plain data with the line of the study's level elsewhere.

    Parameters
    ----------
    data
        The chart at any level, with the same exposure time.
    level_lux
        The level. [lx]
    """
    (panel,) = data["panels"]
    moved = as_data(_now(level_lux))
    marks = [moved if one.get("role") == "now" else one for one in panel["marks"]]
    return {**data, "panels": [{**panel, "marks": marks}]}


def curves_chart(
    curves: Sequence[Curve],
    values: Sequence[Float[Array, " k"]],
    label: str,
    *,
    names: Sequence[str],
    rules: Sequence[Rule] = (),
    title: str = "",
    description: str = "",
    numbered: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> Chart:
    """Curves over one parameter on one panel.

    Parameters
    ----------
    curves
        Of `chromanoise.study.compared`, all of one sweep.
    values
        What is drawn of each; NaN where it is undefined.
    label
        Of the axis up, with the unit.
    names
        A name per curve.
    rules, title, description, numbered, notes
        As `Chart` and its panel have them.
    """
    sweep, unit = curves[0].sweep, label.rpartition(" ")[2]
    sensors = tuple(dict.fromkeys(curve.label for curve in curves))
    matrices = list(dict.fromkeys(curve.matrix for curve in curves))
    at = curves[0].at.tolist()
    known = np.concatenate([one[np.isfinite(one)] for one in values])
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    cell = partial(decimal, digits=2, none=UNDEFINED)
    columns, marks = [column(f"{sweep.what} [{sweep.unit}]", at, brief)], list[Mark]()
    for curve, name, each in zip(curves, names, values, strict=True):
        line = Line(
            x=0,
            y=len(columns),
            first=0,
            last=len(at),
            name=name,
            sensor=sensors.index(curve.label),
            matrix=matrices.index(curve.matrix),
        )
        marks.append(line)
        columns.append(column(f"{name} {unit}", [defined(one) for one in each.tolist()], cell))
    across = Axis(
        label=columns[0].head or "",
        low=at[0],
        high=at[-1],
        logarithmic=sweep.logarithmic,
        exact=True,
    )
    up = Axis(label=label, low=low, high=high, zero=unit == "[dB]")
    return Chart(
        title=title,
        description=description,
        sensors=sensors,
        columns=tuple(columns),
        panels=(Panel(x=across, y=up, marks=(*marks, *rules)),),
        named="ends",
        numbered=tuple(numbered),
        notes=tuple(notes),
    )


def crossing_rules(crossings: Sequence[Crossover], curves: Sequence[Curve]) -> list[Rule]:
    """A rule for each value at which two curves cross."""
    rules = []
    for one in crossings:
        mine = next(c for c in curves if (c.sensor, c.matrix) == (one.first, one.matrix))
        for at in one.at:
            text = f"{brief(at, 2 if at < 100 else 3)} {one.sweep.unit}"
            height = float(np.interp(at, mine.at, mine.value))
            rules.append(Rule(at=at, role="crossing", text=text, height=height))
    return rules


def _numbered(
    crossings: Sequence[Crossover], curves: Sequence[Curve]
) -> tuple[list[Rule], list[str]]:
    """The rules in the order of their places, and the sentence of each."""
    rules = crossing_rules(crossings, curves)
    sentences = [crossover_sentence(one) for one in crossings for _ in one.at]
    order = sorted(range(len(rules)), key=lambda i: rules[i].at)
    return [rules[i] for i in order], [sentences[i] for i in order]


def level_curves(
    shown: Shown, quantity: Quantity = QUANTITIES["snr-y"]
) -> tuple[Sequence[Curve], Sequence[Crossover | Incomparable]]:
    """A quantity of each sensor with each matrix over the light level, with crossovers."""
    values, makers = drawn_lux(shown), shown.makers
    curves = compared(
        shown.operating_points, makers, values, sweep=SWEEPS["lux"], quantity=quantity
    )
    return curves, crossovers_or_reasons(shown.operating_points, makers, curves)


def drawn_lux(shown: Shown) -> Float[Array, " k"]:
    """The light levels of the curves, extended by whole decades to include the study's. [lx]"""
    sweep, level = SWEEPS["lux"], shown.study.light.level_lux
    first = min(LOWEST_LUX, 10.0 ** math.floor(math.log10(level)))
    last = max(HIGHEST_LUX, 10.0 ** math.ceil(math.log10(level)))
    points = 1 + _PER_DECADE * round(math.log10(last / first))
    return swept_values(sweep, max(first, sweep.lowest), min(last, sweep.highest), points)


def _quantity(shown: Shown, look: Look) -> Quantity:
    """For an eye the SNR of the selected X, Y or Z, else of Y; for a machine the separation."""
    if shown.study.outputs.reader == "machine":
        return QUANTITIES["separation"]
    return QUANTITIES.get(f"snr-{look.coordinate.lower()}", QUANTITIES["snr-y"])


def _notes(shown: Shown, curves: Sequence[Curve], names: Sequence[str], what: str) -> Iterator[str]:
    """The level at which each sensor saturates, and the curves without any value."""
    last_lux = curves[0].at[-1]
    full = [
        f"{one.sensor.label} {level_in_words(lux)}"
        for one in shown.operating_points
        if (lux := fullest_level_lux(one)) is not None and lux < last_lux
    ]
    if full:
        yield f"Saturated from: {listed(full)}."
    each = zip(curves, names, strict=True)
    empty = [name for curve, name in each if not np.isfinite(curve.value).any()]
    if empty:
        yield f"{what} is undefined in this range: {listed(empty)}."


def _description(names: Sequence[str], curves: Sequence[Curve], crossed: Sequence[str]) -> str:
    parts = []
    for name, curve in zip(names, curves, strict=True):
        there = np.flatnonzero(np.isfinite(curve.value))
        if not len(there):
            parts.append(f"The curve of {name} is undefined in this range.")
            continue
        first, last = (
            f"{decimal(float(curve.value[k]))} {curve.quantity.unit} at "
            f"{level_in_words(float(curve.at[k]))}"
            for k in (there[0], there[-1])
        )
        parts.append(f"{name} goes from {first} to {last}.")
    return " ".join([*parts, *crossed])
