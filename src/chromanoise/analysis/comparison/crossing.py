"""Crossovers: values of a parameter at which two sensors are equally good, and their sentences."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis.color_matrices import MatrixFunction
from chromanoise.analysis.comparison.curves import Curve
from chromanoise.analysis.comparison.quantities import Quantity, color_error
from chromanoise.analysis.comparison.sweeps import Sweep
from chromanoise.analysis.undefined import plain_fields
from chromanoise.errors import InputError
from chromanoise.exposure import OperatingPoint

TIE = 1e-9
"""Values that differ by at most this are equal. [unit of the quantity]"""
_CROSSING_TOLERANCE = 1e-9  # of the logarithm of the value, or of the span of a linear sweep


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossover:
    """Where two sensors with the same matrix are equally good.

    Attributes
    ----------
    first, second, matrix
        Names.
    labels
        Names of first and second in sentences.
    sweep, quantity
        The parameter that varies, and the quantity.
    at
        Where the sign of their difference changes; empty if it never does. [unit of the sweep]
    color_error
        Of first and second at each of these, to report beside an SNR; NaN where it is not
        defined. [Delta E*ab]
    better_first
        The better sensor at the lowest common value of the sweep; ``None`` if they are equal
        throughout.
    first_at, last_at
        The range in which both have a value. [unit of the sweep]
    """

    first: str
    second: str
    matrix: str
    labels: tuple[str, str]
    sweep: Sweep
    quantity: Quantity
    at: tuple[float, ...]
    color_error: tuple[tuple[float, float], ...]
    better_first: str | None
    first_at: float
    last_at: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Incomparable:
    """Two sensors that have no common value of the sweep at which the quantity is defined.

    Attributes
    ----------
    first, second, matrix
        Names.
    labels
        Names of first and second in sentences.
    why
        A sentence.
    """

    first: str
    second: str
    matrix: str
    labels: tuple[str, str]
    why: str


def crossovers(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    curves: Sequence[Curve],
) -> tuple[Crossover, ...]:
    """For each matrix and each pair of sensors, where their order changes.

    Signs are read off the curves; each change is then refined on the closed form.

    Parameters
    ----------
    contestants, makers
        As they were compared.
    curves
        Of `chromanoise.analysis.compared`.

    Raises
    ------
    InputError
        If a pair has no value of the sweep at which both have the quantity.
    """
    return tuple(_crossover(*pair) for pair in _pairs(contestants, makers, curves))


def crossovers_or_reasons(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    curves: Sequence[Curve],
) -> tuple[Crossover | Incomparable, ...]:
    """As `crossovers`, with an `Incomparable` for each pair that cannot be compared.

    Parameters
    ----------
    contestants, makers, curves
        As for `crossovers`.
    """
    found: list[Crossover | Incomparable] = []
    for maker, one, other in _pairs(contestants, makers, curves):
        try:
            found.append(_crossover(maker, one, other))
        except InputError as error:
            first, second = one[1], other[1]
            pair = Incomparable(
                first=first.sensor,
                second=second.sensor,
                matrix=first.matrix,
                labels=(first.label, second.label),
                why=str(error),
            )
            found.append(pair)
    return tuple(found)


_Side = tuple[OperatingPoint, Curve]


def _pairs(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    curves: Sequence[Curve],
) -> Iterator[tuple[MatrixFunction, _Side, _Side]]:
    for name, maker in makers.items():
        mine = [curve for curve in curves if curve.matrix == name]
        for one, other in combinations(zip(contestants, mine, strict=True), 2):
            yield maker, one, other


def _value_at(
    contestant: OperatingPoint,
    maker: MatrixFunction,
    sweep: Sweep,
    of: Callable[[OperatingPoint, Any], float],
    value: float,
) -> float:
    operating_point = sweep.at(contestant, value)
    return of(operating_point, maker(operating_point))


def _crossover(maker: MatrixFunction, one: _Side, other: _Side) -> Crossover:
    (a, first), (b, second) = one, other
    sweep, quantity = first.sweep, first.quantity
    sign = 1.0 if quantity.more_is_better else -1.0
    lead = sign * (first.value - second.value)
    known = np.flatnonzero(np.isfinite(lead))
    if not known.size:
        _refuse_nothing_common(first, second)

    def lead_at(value: float) -> float:
        ours, theirs = (_value_at(c, maker, sweep, quantity.of, value) for c in (a, b))
        return sign * (ours - theirs)

    changes = [
        (float(first.at[i]), float(first.at[k]))
        for i, k in pairwise(known[np.abs(lead[known]) > TIE])  # a tie has no side
        if lead[i] * lead[k] < 0 and np.isfinite(lead[i : k + 1]).all()
    ]
    at = tuple(_root(lead_at, low, high, sweep.logarithmic) for low, high in changes)
    errors = (tuple(_value_at(c, maker, sweep, color_error, value) for c in (a, b)) for value in at)
    return Crossover(
        first=first.sensor,
        second=second.sensor,
        matrix=first.matrix,
        labels=(first.label, second.label),
        sweep=sweep,
        quantity=quantity,
        at=at,
        color_error=tuple((ours, theirs) for ours, theirs in errors),
        better_first=_first_leader(lead[known], first.sensor, second.sensor),
        first_at=float(first.at[known[0]]),
        last_at=float(first.at[known[-1]]),
    )


def _first_leader(lead: Float[Array, " k"], first: str, second: str) -> str | None:
    ahead = lead[np.abs(lead) > TIE]
    if not ahead.size:
        return None
    return first if ahead[0] > 0 else second


def _refuse_nothing_common(first: Curve, second: Curve) -> None:
    raise InputError(
        f"{first.label} and {second.label}",
        f"must both have a {first.quantity.what} with the {first.matrix} matrix at some "
        f"{first.sweep.what} of the sweep",
        value=(float(first.at[0]), float(first.at[-1])),
        found="have none: they are saturated, or the matrix cannot make that color of this light",
        remedy=("shorten the time", "sweep less light", "take another matrix"),
    )


def _root(function: Callable[[float], float], low: float, high: float, logarithmic: bool) -> float:
    """Where the sign changes that differs at ``low`` and ``high``.

    Notes
    -----
    Inverse quadratic steps where they are safe, halves elsewhere: Chandrupatla, *Adv. Eng. Softw.*
    28 (1997) 145-149.
    """
    there, back = (np.log, np.exp) if logarithmic else (float, float)
    a, b = float(there(low)), float(there(high))
    tolerance = _CROSSING_TOLERANCE * (1.0 if logarithmic else b - a)
    at_a, at_b = function(float(back(a))), function(float(back(b)))
    share = 0.5
    while abs(b - a) > tolerance and at_a != 0:
        x = a + share * (b - a)
        at_x = function(float(back(x)))
        if np.sign(at_x) == np.sign(at_a):
            c, at_c = a, at_a
        else:
            c, at_c, b, at_b = b, at_b, a, at_a
        a, at_a = x, at_x
        share = _next_share((a, at_a), (b, at_b), (c, at_c), tolerance)
    return float(back(a if abs(at_a) < abs(at_b) else b))


Point = tuple[float, float]


def _next_share(a: Point, b: Point, c: Point, tolerance: float) -> float:
    """Share of the way from a to b of the next evaluation; c is the point before."""
    (xa, fa), (xb, fb), (xc, fc) = a, b, c
    place, height = (xa - xb) / (xc - xb), (fa - fb) / (fc - fb)
    share = 0.5
    if height**2 < place and (1 - height) ** 2 < 1 - place:
        share = fa / (fb - fa) * fc / (fb - fc)
        share += (xc - xa) / (xb - xa) * fa / (fc - fa) * fb / (fc - fb)
    least = 0.5 * tolerance / abs(xb - xa) if xb != xa else 0.5
    return min(1 - least, max(least, share)) if least < 0.5 else 0.5


def crossover_as_json(crossover: Crossover) -> dict[str, Any]:
    """One crossover as plain data, with its sentence."""
    return plain_fields(
        crossover,
        *("first", "second", "matrix", "better_first", "first_at", "last_at", "at", "color_error"),
    ) | {"sentence": crossover_sentence(crossover)}


def crossover_sentence(crossover: Crossover) -> str:
    """Which sensor is better over which values, and the color errors at the crossovers.

    Parameters
    ----------
    crossover
        Crossovers of two sensors.
    """
    (first, second), sweep = crossover.labels, crossover.sweep
    last = sweep.with_unit(value_in_words(crossover.last_at, 4))
    span = f"{value_in_words(crossover.first_at, 4)} to {last}"
    leader, other = (first, second)
    if crossover.better_first == crossover.second:
        leader, other = second, first
    if crossover.better_first is None:
        return (
            f"With the {crossover.matrix} matrix {first} and {second} have the same "
            f"{crossover.quantity.what} at every {crossover.sweep.what} from {span}."
        )
    better = "higher" if crossover.quantity.more_is_better else "lower"
    of_raw = crossover.quantity.of_raw
    leads = f"{leader} has the {better} {crossover.quantity.what}"
    if not of_raw:
        leads = f"With the {crossover.matrix} matrix {leads}"
    if not crossover.at:
        return f"{leads} than {other} at every {crossover.sweep.what} from {span}."
    values = [value_in_words(value, 3 if value < 100 else 4) for value in crossover.at]
    between = [f"from {low} to {high}" for low, high in pairwise(values)]
    leaders = (other, leader) * len(values)
    rest = (f"{who} {where}" for who, where in zip(leaders, (*between, "above"), strict=False))
    crossed = f"{leads} below {sweep.with_unit(values[0])} of {sweep.what}, {', '.join(rest)}"
    if of_raw:
        return f"{crossed} (within {span})."
    colors = "; ".join(f"{a:.1f} and {b:.1f}" for a, b in crossover.color_error)
    where = "at the crossover" if len(values) == 1 else "at the crossovers"
    return (
        f"{crossed} (within {span}); {where} the mean color errors of {first} and {second} are "
        f"{colors} Delta E*ab."
    )


def value_in_words(value: float, digits: int = 3) -> str:
    """A value of a sweep for a sentence, rounded; 10000, not 1e+04."""
    text = f"{value:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text and value < 1e6 else text
