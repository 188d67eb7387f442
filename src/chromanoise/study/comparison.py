"""Sensors against each other while one thing varies: curves, crossovers and the verdict."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from chromanoise import __version__, _check
from chromanoise._check import Array
from chromanoise.exposure import Situation
from chromanoise.study.makers import MatrixMaker, matrices_over_levels
from chromanoise.study.quantities import (
    SNR_Y,
    Quantity,
    color_error,
    color_errors,
    is_saturated,
    is_saturated_over_levels,
)
from chromanoise.study.sweeps import SWEEPS, Sweep

_TIE = 1e-9  # of the unit of a quantity: rounding
_CROSSING_TOLERANCE = 1e-9  # of the logarithm of the value, or of the span of a linear sweep


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curve:
    """One sensor with one matrix over the sweep.

    Attributes
    ----------
    sensor, matrix
        Names.
    time_s
        Integration time before the sweep. [s]
    sweep, quantity
        What varies, and what was asked.
    at
        Where it was computed. [unit of the sweep]
    value
        NaN where it is not defined: a channel is saturated, a color is no signal. [unit of the
        quantity]
    saturated
        Where a channel is saturated on a perfect white.
    color_error
        Mean over the ColorChecker, without noise; NaN where it is not defined. [Delta E*ab]
    """

    sensor: str
    matrix: str
    time_s: float
    sweep: Sweep
    quantity: Quantity
    at: Float[Array, " k"]
    value: Float[Array, " k"]
    saturated: Bool[Array, " k"]
    color_error: Float[Array, " k"]

    def __post_init__(self) -> None:
        _check.freeze(self, "at", "value", "saturated", "color_error")


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossover:
    """Where two sensors with the same matrix change places.

    Attributes
    ----------
    first, second, matrix
        Names.
    sweep, quantity
        What varies, and what was asked.
    at
        Where the sign of their difference changes; empty if it never does. [unit of the sweep]
    color_error
        Of first and second at each of these: SNR is never told alone; NaN where it is not
        defined. [Delta E*ab]
    better_first
        Who leads first, from the lowest common value of the sweep on; ``None`` for equals.
    first_at, last_at
        The range in which both have a value. [unit of the sweep]
    """

    first: str
    second: str
    matrix: str
    sweep: Sweep
    quantity: Quantity
    at: tuple[float, ...]
    color_error: tuple[tuple[float, float], ...]
    better_first: str | None
    first_at: float
    last_at: float


def compared(
    contestants: Sequence[Situation],
    makers: Mapping[str, MatrixMaker],
    at: Float[Array, " k"],
    *,
    sweep: Sweep = SWEEPS["lux"],
    quantity: Quantity = SNR_Y,
) -> tuple[Curve, ...]:
    """Every sensor with every matrix over the sweep.

    Parameters
    ----------
    contestants
        Sensors with their exposures and their light; each keeps all that the sweep does not vary.
    makers
        Matrix methods by name; each is asked anew at every value.
    at
        Increasing. [unit of the sweep]
    sweep
        What varies: one of `SWEEPS`, or your own.
    quantity
        What is asked: one of `QUANTITIES`, or your own.

    Raises
    ------
    InputError
        If the values do not increase or leave what makes sense.
    """
    values = _check.increasing(f"values of {sweep.name}", sweep.unit, at)
    for end in (values[0], values[-1]):
        _check.within(f"sweep of {sweep.name}", sweep.unit, end, sweep.lowest, sweep.highest)
    return tuple(
        _curve(contestant, name, maker, values, sweep, quantity)
        for contestant in contestants
        for name, maker in makers.items()
    )


def crossovers(
    contestants: Sequence[Situation], makers: Mapping[str, MatrixMaker], curves: Sequence[Curve]
) -> tuple[Crossover, ...]:
    """For each pair of sensors and each matrix, where their order changes.

    Signs are read off the curves; each change is then refined on the closed form.

    Parameters
    ----------
    contestants, makers
        As they were compared.
    curves
        Of `compared`.

    Raises
    ------
    InputError
        If a pair has no value of the sweep at which both have the quantity.
    """
    found = []
    for name, maker in makers.items():
        mine = [curve for curve in curves if curve.matrix == name]
        found += [
            _crossover(a, b, maker, curve_a, curve_b)
            for (a, curve_a), (b, curve_b) in combinations(zip(contestants, mine, strict=True), 2)
        ]
    return tuple(found)


def _curve(
    contestant: Situation,
    name: str,
    maker: MatrixMaker,
    values: Float[Array, " k"],
    sweep: Sweep,
    quantity: Quantity,
) -> Curve:
    asked, errors, full = (
        _over_levels(contestant, maker, values, quantity)
        if sweep.name == SWEEPS["lux"].name
        else None
    ) or _one_by_one([sweep.at(contestant, value) for value in values.tolist()], maker, quantity)
    return Curve(
        sensor=contestant.sensor.name,
        matrix=name,
        time_s=contestant.exposure.time_s,
        sweep=sweep,
        quantity=quantity,
        at=values,
        value=asked,
        saturated=full,
        color_error=errors,
    )


_Asked = tuple[Float[Array, " k"], Float[Array, " k"], Bool[Array, " k"]]


def _over_levels(
    contestant: Situation, maker: MatrixMaker, values: Float[Array, " k"], quantity: Quantity
) -> _Asked | None:
    """All levels at once; ``None`` where quantity or maker can only be asked one by one."""
    if quantity.over_levels is None:
        return None
    full = is_saturated_over_levels(contestant, values)
    lit = [SWEEPS["lux"].at(contestant, value) for value in values.tolist()]
    first, matrices = maker(lit[0]), matrices_over_levels(maker, contestant, values)
    if matrices is not None:
        asked = quantity.over_levels(contestant, first, values, matrices=matrices)
        return asked, color_errors(contestant, matrices), full
    if any(maker(each) is not first for each in lit):
        return None
    error = color_error(contestant, first)  # of the one matrix that looks at no light
    return quantity.over_levels(contestant, first, values), np.full(values.size, error), full


def _one_by_one(situations: Sequence[Situation], maker: MatrixMaker, quantity: Quantity) -> _Asked:
    pairs = [(situation, maker(situation)) for situation in situations]
    asked = np.array([quantity.of(*pair) for pair in pairs])
    errors = np.array([color_error(*pair) for pair in pairs])
    return asked, errors, np.array([is_saturated(situation) for situation in situations])


def _asked(
    contestant: Situation,
    maker: MatrixMaker,
    sweep: Sweep,
    of: Callable[[Situation, Any], float],
    value: float,
) -> float:
    situation = sweep.at(contestant, value)
    return of(situation, maker(situation))


def _crossover(
    a: Situation, b: Situation, maker: MatrixMaker, first: Curve, second: Curve
) -> Crossover:
    sweep, quantity = first.sweep, first.quantity
    sign = 1.0 if quantity.more_is_better else -1.0
    lead = sign * (first.value - second.value)
    known = np.flatnonzero(np.isfinite(lead))
    if not known.size:
        _refuse_nothing_common(first, second)

    def lead_at(value: float) -> float:
        ours, theirs = (_asked(c, maker, sweep, quantity.of, value) for c in (a, b))
        return sign * (ours - theirs)

    changes = [
        (float(first.at[i]), float(first.at[k]))
        for i, k in pairwise(known[np.abs(lead[known]) > _TIE])  # a tie has no side
        if lead[i] * lead[k] < 0 and np.isfinite(lead[i : k + 1]).all()
    ]
    at = tuple(_root(lead_at, low, high, sweep.logarithmic) for low, high in changes)
    errors = (tuple(_asked(c, maker, sweep, color_error, value) for c in (a, b)) for value in at)
    return Crossover(
        first=first.sensor,
        second=second.sensor,
        matrix=first.matrix,
        sweep=sweep,
        quantity=quantity,
        at=at,
        color_error=tuple((ours, theirs) for ours, theirs in errors),
        better_first=_first_leader(lead[known], first.sensor, second.sensor),
        first_at=float(first.at[known[0]]),
        last_at=float(first.at[known[-1]]),
    )


def _first_leader(lead: Float[Array, " k"], first: str, second: str) -> str | None:
    ahead = lead[np.abs(lead) > _TIE]
    if not ahead.size:
        return None
    return first if ahead[0] > 0 else second


def _refuse_nothing_common(first: Curve, second: Curve) -> None:
    raise _check.InputError(
        f"{first.sensor} and {second.sensor} have no {first.sweep.what} of the sweep at which both "
        f"have a {first.quantity.what} with the {first.matrix} matrix: they are saturated (shorten "
        "the time, sweep less light) or the matrix cannot make that color of this light"
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
    """How far from a towards b to look next; c lies behind a or b."""
    (xa, fa), (xb, fb), (xc, fc) = a, b, c
    place, height = (xa - xb) / (xc - xb), (fa - fb) / (fc - fb)
    share = 0.5
    if height**2 < place and (1 - height) ** 2 < 1 - place:
        share = fa / (fb - fa) * fc / (fb - fc)
        share += (xc - xa) / (xb - xa) * fa / (fc - fa) * fb / (fc - fb)
    least = 0.5 * tolerance / abs(xb - xa) if xb != xa else 0.5
    return min(1 - least, max(least, share)) if least < 0.5 else 0.5


def comparison_as_json(curves: Sequence[Curve], crossed: Sequence[Crossover]) -> dict[str, Any]:
    """Curves and crossovers as plain data; what is not defined is ``None``."""
    sweep, quantity = curves[0].sweep, curves[0].quantity
    return {
        "version": __version__,
        "sweep": {
            "name": sweep.name,
            "what": sweep.what,
            "unit": sweep.unit,
            "values": curves[0].at.tolist(),
        },
        "quantity": {"name": quantity.name, "what": quantity.what, "unit": quantity.unit},
        "curves": [
            {
                "sensor": curve.sensor,
                "matrix": curve.matrix,
                "time_ms": 1e3 * curve.time_s,
                "value": _defined(curve.value),
                "saturated": curve.saturated.tolist(),
                "color_error": _defined(curve.color_error),
            }
            for curve in curves
        ],
        "crossovers": [crossover_as_json(c) for c in crossed],
    }


def crossover_as_json(crossover: Crossover) -> dict[str, Any]:
    """One crossover as plain data, with its sentence."""
    told = {
        key: getattr(crossover, key)
        for key in ("first", "second", "matrix", "better_first", "first_at", "last_at")
    }
    errors = [_defined(np.array(pair)) for pair in crossover.color_error]
    sentence = crossover_sentence(crossover)
    return told | {"at": list(crossover.at), "color_error": errors, "sentence": sentence}


def _defined(values: Float[Array, " k"]) -> list[float | None]:
    return [value if np.isfinite(value) else None for value in values.tolist()]


def crossover_sentence(crossover: Crossover) -> str:
    """Who wins where, in words."""
    first, second, unit = crossover.first, crossover.second, crossover.sweep.unit
    span = f"{_told(crossover.first_at, 4)} to {_told(crossover.last_at, 4)} {unit}"
    other = second if crossover.better_first == first else first
    if crossover.better_first is None:
        return (
            f"With the {crossover.matrix} matrix {first} and {second} have the same "
            f"{crossover.quantity.what} at every {crossover.sweep.what} from {span}."
        )
    better = "higher" if crossover.quantity.more_is_better else "lower"
    leads = (
        f"With the {crossover.matrix} matrix {crossover.better_first} has the {better} "
        f"{crossover.quantity.what}"
    )
    if not crossover.at:
        return f"{leads} than {other} at every {crossover.sweep.what} from {span}."
    told = [_told(value, 3 if value < 100 else 4) for value in crossover.at]
    between = [f"from {low} to {high}" for low, high in pairwise(told)]
    leaders = (other, crossover.better_first) * len(told)
    rest = (f"{who} {where}" for who, where in zip(leaders, (*between, "above"), strict=False))
    colors = "; ".join(f"{a:.1f} and {b:.1f}" for a, b in crossover.color_error)
    return (
        f"{leads} below {told[0]} {unit} of {crossover.sweep.what}, {', '.join(rest)} (within "
        f"{span}); where they change places the mean color errors of {first} and {second} are "
        f"{colors} Delta E*ab."
    )


def _told(value: float, digits: int) -> str:
    told = f"{value:.{digits}g}"
    return f"{float(told):.0f}" if "e+" in told and value < 1e6 else told  # 10000, not 1e+04
