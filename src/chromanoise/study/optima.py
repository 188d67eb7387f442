"""The value of a parameter at which each sensor is best, over a sweep and over a map."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, Literal, TypeVar

import numpy as np

from chromanoise.base import Array, Int, JsonKey, JsonKeys, dataclass, with_short_repr
from chromanoise.io import number_text
from chromanoise.noise import OperatingPoint
from chromanoise.study.color_matrices import MatrixFunction
from chromanoise.study.maps import QuantityMap
from chromanoise.study.ranking import (
    TIE,
    value_in_words,
)
from chromanoise.study.sweeps import Curve, Quantity, Sweep

Place = Literal["inside", "first", "last", "saturation", "everywhere"]
_TOLERANCE = 1e-6  # of the logarithm of the value, or of the span of a linear sweep
_MOST_NAMED = 3  # sensors that a sentence names


@with_short_repr
@dataclass(frozen=True, kw_only=True)
class Optimum:
    """The value of a sweep at which one sensor is best, with one matrix.

    Attributes
    ----------
    sensor, label
        Name of the sensor, and that in sentences.
    matrix
        Name of the matrix method.
    sweep, quantity
        The parameter that varies, and the quantity.
    at
        The best value of the parameter; between two values of the sweep it is refined on the closed
        form. [unit of the sweep]
    value
        The quantity there. [unit of the quantity]
    low, high
        The neighbors of the best value of the sweep: the optimum lies between them; at an end of
        the range, that end. [unit of the sweep]
    place
        ``inside`` the range, its ``first`` or ``last`` value with a result, the last one before
        ``saturation``, or ``everywhere`` where the quantity does not vary.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("sensor", "label", "matrix", "at", "value", "low", "high", "place"),
        JsonKey("sentence", lambda one: optima_sentences([one])[0], text="The same in words."),
    )

    sensor: str
    label: str
    matrix: str
    sweep: Sweep
    quantity: Quantity
    at: float
    value: float
    low: float
    high: float
    place: Place


def optima(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    curves: Sequence[Curve],
) -> tuple[Optimum, ...]:
    """For each sensor and matrix, the best value of the sweep; none without any result.

    Parameters
    ----------
    contestants, makers
        As they were compared.
    curves
        One per matrix and sensor.
    """
    found: list[Optimum] = []
    for name, maker in makers.items():
        mine = [curve for curve in curves if curve.matrix == name]
        for contestant, curve in zip(contestants, mine, strict=True):
            if np.isfinite(curve.value).any():
                found.append(_optimum(contestant, maker, curve))
    return tuple(found)


def _optimum(contestant: OperatingPoint, maker: MatrixFunction, curve: Curve) -> Optimum:
    sweep, quantity = curve.sweep, curve.quantity
    sign = -1.0 if quantity.more_is_better else 1.0
    costs = np.where(np.isfinite(curve.value), sign * curve.value, np.inf)
    i, known = int(np.argmin(costs)), np.flatnonzero(np.isfinite(costs))
    low, high = int(max(i - 1, known[0])), int(min(i + 1, known[-1]))
    at, place = float(curve.at[i]), _place(curve, i, known)
    if place == "inside" and not sweep.whole and np.isfinite(costs[[low, high]]).all():

        def cost(value: float) -> float:
            moved = sweep.at(contestant, value)
            return sign * quantity.of(moved, maker(moved))

        at = _refined(cost, float(curve.at[low]), at, float(curve.at[high]), sweep.logarithmic)
    value = float(curve.value[i])
    if at != curve.at[i]:
        moved = sweep.at(contestant, at)
        value = quantity.of(moved, maker(moved))
    first, last = (low, high) if place == "inside" else (i, i)
    return Optimum(
        sensor=curve.sensor,
        label=curve.label,
        matrix=curve.matrix,
        sweep=sweep,
        quantity=quantity,
        at=at,
        value=value,
        low=float(curve.at[first]),
        high=float(curve.at[last]),
        place=place,
    )


def _place(curve: Curve, i: int, known: Int[Array, " n"]) -> Place:
    if known.size > 1 and np.ptp(curve.value[known]) <= TIE:
        return "everywhere"
    if i == known[-1]:
        is_last = i + 1 < curve.at.size and bool(curve.saturated[i + 1])
        return "saturation" if is_last else "last"
    return "first" if i == known[0] else "inside"


def _refined(
    cost: Callable[[float], float], low: float, middle: float, high: float, logarithmic: bool
) -> float:
    """Where a function is least between ``low`` and ``high``; it is less at ``middle``."""
    from scipy.optimize.elementwise import find_minimum  # most optima are at an end

    there, back = (np.log, np.exp) if logarithmic else (float, float)
    ends: Any = tuple(float(there(value)) for value in (low, middle, high))
    values = np.vectorize(lambda x: cost(float(back(x))), otypes=[float])
    step = _TOLERANCE * (1.0 if logarithmic else ends[2] - ends[0])
    only = {"xatol": step, "xrtol": 0, "fatol": 0, "frtol": 0}
    found = find_minimum(values, ends, tolerances=only)
    return float(back(float(found.x)))


def optima_sentences(found: Sequence[Optimum]) -> list[str]:
    """Per matrix, at which value of the sweep each sensor is best, the best sensor first."""
    sentences = []
    for name in dict.fromkeys(one.matrix for one in found):
        mine = _best_first([one for one in found if one.matrix == name])
        texts = [_in_words(one, is_first=one is mine[0]) for one in mine[:_MOST_NAMED]]
        sentences.append(_sentence(name, mine[0].quantity, texts, len(mine)))
    return sentences


def _in_words(one: Optimum, *, is_first: bool) -> str:
    low, high = value_in_words(one.low, 4), value_in_words(one.high, 4)
    where = {
        "inside": f", between {low} and {high}",
        "first": ", the lower end of the range",
        "last": ", the upper end of the range",
        "saturation": ", the last value before saturation",
        "everywhere": "",
    }[one.place]
    at = one.sweep.with_unit(value_in_words(one.at))
    at = f"{at} of {one.sweep.what}" if is_first else at
    at = f"every {one.sweep.what}" if one.place == "everywhere" else at
    return f"at {at} for {one.label} ({_with_unit(one.value, one.quantity)}{where})"


def _sentence(matrix: str, quantity: Quantity, texts: Sequence[str], count: int) -> str:
    start = quantity.what if quantity.of_raw else f"with the {matrix} matrix, {quantity.what}"
    best = "highest" if quantity.more_is_better else "lowest"
    sentence = f"{start} is {best} {', '.join(texts)}{_rest(count)}."
    return f"{sentence[0].upper()}{sentence[1:]}"


def _with_unit(value: float, quantity: Quantity) -> str:
    text = number_text(value)
    return text if quantity.unit == "1" else f"{text} {quantity.unit}"


def _rest(count: int) -> str:
    more = count - _MOST_NAMED
    return f"; the JSON has the other {more}" if more > 0 else ""


@dataclass(frozen=True, kw_only=True)
class BestCell:
    """The pair of values at which one sensor is best, with one matrix.

    Attributes
    ----------
    sensor, label
        Name of the sensor, and that in sentences.
    matrix
        Name of the matrix method.
    sweep, second, quantity
        The parameters that vary, and the quantity.
    at, second_at
        The values of the grid. [units of the sweeps]
    value
        The quantity there. [unit of the quantity]
    """

    KEYS: ClassVar[JsonKeys] = ("sensor", "label", "matrix", "at", "second_at", "value")

    sensor: str
    label: str
    matrix: str
    sweep: Sweep
    second: Sweep
    quantity: Quantity
    at: float
    second_at: float
    value: float


def best_cells(maps: Sequence[QuantityMap]) -> tuple[BestCell, ...]:
    """For each sensor and matrix, its best pair of values; none without any result."""
    found = []
    for one in maps:
        sign = -1.0 if one.quantity.more_is_better else 1.0
        costs = np.where(np.isfinite(one.value), sign * one.value, np.inf)
        j, k = np.unravel_index(int(np.argmin(costs)), costs.shape)
        if not np.isfinite(costs[j, k]):
            continue
        cell = BestCell(
            sensor=one.sensor,
            label=one.label,
            matrix=one.matrix,
            sweep=one.sweep,
            second=one.second,
            quantity=one.quantity,
            at=float(one.at[k]),
            second_at=float(one.second_at[j]),
            value=float(one.value[j, k]),
        )
        found.append(cell)
    return tuple(found)


def best_cell_sentences(found: Sequence[BestCell]) -> list[str]:
    """Per matrix, at which pair of values each sensor is best, the best sensor first."""
    sentences = []
    for name in dict.fromkeys(one.matrix for one in found):
        mine = _best_first([one for one in found if one.matrix == name])
        texts = [_cell_in_words(one) for one in mine[:_MOST_NAMED]]
        sentences.append(_sentence(name, mine[0].quantity, texts, len(mine)))
    return sentences


def _cell_in_words(one: BestCell) -> str:
    at = one.sweep.with_unit(value_in_words(one.at))
    second = one.second.with_unit(value_in_words(one.second_at))
    where = f"at {at} of {one.sweep.what} and {second} of {one.second.what}"
    return f"{where} for {one.label} ({_with_unit(one.value, one.quantity)})"


Best = TypeVar("Best", Optimum, BestCell)


def _best_first(found: Sequence[Best]) -> list[Best]:
    sign = -1.0 if found[0].quantity.more_is_better else 1.0
    return sorted(found, key=lambda one: sign * one.value)
