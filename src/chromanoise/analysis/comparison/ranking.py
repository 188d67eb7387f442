"""Many sensors: their ranks by one quantity, and the best one over each range of a sweep."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from chromanoise.analysis.color_matrices import MatrixFunction
from chromanoise.analysis.comparison.crossing import TIE, Crossover, value_in_words
from chromanoise.analysis.comparison.curves import Curve
from chromanoise.analysis.comparison.quantities import Quantity
from chromanoise.analysis.comparison.sweeps import Sweep
from chromanoise.analysis.undefined import plain_fields
from chromanoise.exposure import OperatingPoint
from chromanoise.io.table import number_text

MOST_PAIRS_SENSORS = 3
"""Up to this number of sensors each pair has a sentence; more have a ranking and leaders."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rank:
    """The place of one sensor among all, with one matrix.

    Attributes
    ----------
    sensor, label, matrix
        Its names.
    value
        Of the quantity at the operating point; ``None`` where it is not defined.
    rank
        1 for the best; equal values share a rank, and the next ranks are skipped. ``None`` without
        a value.
    tied
        Whether another sensor has the same rank.
    """

    sensor: str
    label: str
    matrix: str
    value: float | None
    rank: int | None
    tied: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Lead:
    """A range of the sweep in which one sensor is the best of all, with one matrix.

    Attributes
    ----------
    sensor, label, matrix
        Its names.
    sweep, quantity
        The parameter that varies, and the quantity.
    first, last
        The ends of the range. [unit of the sweep]
    """

    sensor: str
    label: str
    matrix: str
    sweep: Sweep
    quantity: Quantity
    first: float
    last: float


Named = tuple[str, str, float]
"""Name, label and value of a sensor; NaN where the value is not defined."""


def ranked(found: Sequence[Named], *, matrix: str, more_is_better: bool) -> tuple[Rank, ...]:
    """The sensors from best to worst; equal values share a rank.

    Parameters
    ----------
    found
        Name, label and value of each sensor.
    matrix
        Name of the color matrix.
    more_is_better
        Whether the highest value is the best.

    Notes
    -----
    Values that differ by at most 1e-9 of their unit are equal. Ranks are those of sports: 1, 2, 2,
    4.

    Examples
    --------
    >>> found = [("a", "a", 20.0), ("b", "b", 30.0), ("c", "c", 20.0), ("d", "d", float("nan"))]
    >>> [(r.sensor, r.rank, r.tied) for r in ranked(found, matrix="kernel", more_is_better=True)]
    [('b', 1, False), ('a', 2, True), ('c', 2, True), ('d', None, False)]
    """
    sign = -1.0 if more_is_better else 1.0
    known = sorted((one for one in found if np.isfinite(one[2])), key=lambda one: sign * one[2])
    places = [0] * len(known)
    for i in range(1, len(known)):
        equal = abs(known[i][2] - known[places[i - 1]][2]) <= TIE
        places[i] = places[i - 1] if equal else i
    ranks = [
        Rank(
            sensor=name,
            label=label,
            matrix=matrix,
            value=value,
            rank=place + 1,
            tied=places.count(place) > 1,
        )
        for (name, label, value), place in zip(known, places, strict=True)
    ]
    return (
        *ranks,
        *(
            Rank(sensor=name, label=label, matrix=matrix, value=None, rank=None, tied=False)
            for name, label, value in found
            if not np.isfinite(value)
        ),
    )


def ranking(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    quantity: Quantity,
) -> tuple[Rank, ...]:
    """The sensors ranked by a quantity at their operating points, for each matrix.

    Parameters
    ----------
    contestants, makers
        As `chromanoise.analysis.compared`.
    quantity
        One of `QUANTITIES`, or your own.
    """
    return tuple(
        rank
        for name, maker in makers.items()
        for rank in ranked(
            [(p.sensor.name, p.sensor.label, quantity.of(p, maker(p))) for p in contestants],
            matrix=name,
            more_is_better=quantity.more_is_better,
        )
    )


def matrix_sentences(ranks: Sequence[Rank], quantity: Quantity) -> list[str]:
    """For each sensor with several matrices, a sentence that ranks them at the operating point.

    Parameters
    ----------
    ranks
        Of `ranking`.
    quantity
        That of the ranks.
    """
    sign = -1.0 if quantity.more_is_better else 1.0
    sentences = []
    for name in dict.fromkeys(one.sensor for one in ranks):
        own = [one for one in ranks if one.sensor == name]
        known = [one for one in own if one.value is not None]
        known.sort(key=lambda one: sign * (one.value or 0.0))
        if len(own) > 1 and known:
            text = ", ".join(f"{one.matrix} {number_text(one.value)}" for one in known)
            sentences.append(
                f"{known[0].label}: {quantity.what} [{quantity.unit}] at the fixed settings, best "
                f"matrix first: {text}."
            )
    return sentences


def leads(curves: Sequence[Curve], crossed: Sequence[Crossover]) -> tuple[Lead, ...]:
    """For each matrix, the ranges of the sweep in which one sensor is the best of all.

    Parameters
    ----------
    curves
        Of `chromanoise.analysis.compared`.
    crossed
        Of `chromanoise.analysis.crossovers`: the ends of the ranges.

    Notes
    -----
    The leader is read off the curves at each value of the sweep, so a lead shorter than one step is
    not seen. A range begins and ends at a crossover; where a leader has no value any longer, as it
    is saturated, at the last value of the sweep at which it has one.
    """
    matrices = dict.fromkeys(curve.matrix for curve in curves)
    return tuple(
        lead
        for name in matrices
        for lead in _leads([curve for curve in curves if curve.matrix == name], crossed)
    )


def _leads(curves: Sequence[Curve], crossed: Sequence[Crossover]) -> list[Lead]:
    best = leaders_of(
        np.array([curve.value for curve in curves]), curves[0].quantity.more_is_better
    ).tolist()
    at = curves[0].at.tolist()
    ends: list[tuple[int, float, float]] = []  # leader, first, last
    for i, leader in enumerate(best):
        if leader < 0:
            continue
        if i and best[i - 1] == leader:
            ends[-1] = (leader, ends[-1][1], at[i])
            continue
        first = at[i]
        if i and best[i - 1] >= 0:
            change = _change(curves[best[i - 1]], curves[leader], crossed, at[i - 1], at[i])
            if change is not None:
                ends[-1] = (*ends[-1][:2], change)
                first = change
        ends.append((leader, first, at[i]))
    return [
        Lead(
            sensor=curves[i].sensor,
            label=curves[i].label,
            matrix=curves[i].matrix,
            sweep=curves[i].sweep,
            quantity=curves[i].quantity,
            first=first,
            last=last,
        )
        for i, first, last in ends
    ]


def leaders_of(values: Any, more_is_better: bool) -> Any:
    """Index of the best along the first axis, -1 where none has a value.

    A tie goes to the first of the equals.

    Parameters
    ----------
    values
        One entry per sensor along the first axis; NaN where it is not defined.
    more_is_better
        Whether the highest value is the best.

    Examples
    --------
    >>> leaders_of(np.array([[1.0, 2.0, np.nan], [1.0, 3.0, np.nan]]), True).tolist()
    [0, 1, -1]
    """
    points = np.where(np.isnan(values), -np.inf, values if more_is_better else -values)
    near = points >= points.max(axis=0) - TIE
    return np.where(np.isinf(points.max(axis=0)), -1, near.argmax(axis=0))


def _change(
    one: Curve, other: Curve, crossed: Sequence[Crossover], low: float, high: float
) -> float | None:
    """Where two curves of one matrix cross between two values of the sweep."""
    pair, matrix = {one.sensor, other.sensor}, one.matrix
    found = [
        value
        for crossover in crossed
        if crossover.matrix == matrix and {crossover.first, crossover.second} == pair
        for value in crossover.at
        if low <= value <= high
    ]
    return found[0] if found else None


def leading_crossovers(
    leading: Sequence[Lead], crossed: Sequence[Crossover]
) -> tuple[Crossover, ...]:
    """The crossovers at which the leader changes; of all pairs, those that matter.

    Parameters
    ----------
    leading
        Of `leads`.
    crossed
        Of `chromanoise.analysis.crossovers`.
    """
    changes = {
        (one.matrix, frozenset((one.sensor, other.sensor)))
        for one, other in pairwise(leading)
        if one.matrix == other.matrix and one.last == other.first
    }
    return tuple(
        one for one in crossed if (one.matrix, frozenset((one.first, one.second))) in changes
    )


def lead_changes(leading: Sequence[Lead], crossed: Sequence[Crossover]) -> tuple[Crossover, ...]:
    """`leading_crossovers` with only those of their values at which the leader changes.

    Parameters
    ----------
    leading, crossed
        As `leading_crossovers`.
    """
    ends = {(one.matrix, one.last) for one in leading}
    changes = []
    for one in leading_crossovers(leading, crossed):
        kept = [k for k, value in enumerate(one.at) if (one.matrix, value) in ends]
        at = tuple(one.at[k] for k in kept)
        errors = tuple(one.color_error[k] for k in kept)
        changes.append(replace(one, at=at, color_error=errors))
    return tuple(changes)


def lead_sentences(leading: Sequence[Lead]) -> list[str]:
    """Per matrix, the best sensor over each range of the sweep."""
    sentences = []
    for name in dict.fromkeys(one.matrix for one in leading):
        mine = [one for one in leading if one.matrix == name]
        sweep, quantity = mine[0].sweep, mine[0].quantity
        better = "highest" if quantity.more_is_better else "lowest"
        ranges = [f"{one.label} {sweep.with_unit(_range_in_words(one))}" for one in mine]
        sentences.append(
            f"With the {name} matrix the {better} {quantity.what} of all sensors over "
            f"{sweep.what}: {', '.join(ranges)}."
        )
    return sentences


def _range_in_words(lead: Lead) -> str:
    first, last = value_in_words(lead.first), value_in_words(lead.last)
    return f"at {first}" if first == last else f"from {first} to {last}"


def ranking_as_json(ranks: Sequence[Rank]) -> list[dict[str, Any]]:
    """Ranks as plain data, from best to worst for each matrix."""
    names = ("rank", "tied", "sensor", "label", "matrix", "value")
    return [plain_fields(one, *names) for one in ranks]


def leads_as_json(leading: Sequence[Lead]) -> list[dict[str, Any]]:
    """Leads as plain data."""
    names = ("sensor", "label", "matrix", "first", "last")
    return [plain_fields(one, *names) for one in leading]
