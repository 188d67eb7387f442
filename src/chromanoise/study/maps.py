"""A quantity over two parameters: a map per sensor, and lines where two are equally good."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import ClassVar

import numpy as np

from chromanoise.base import Array, Float, InputError, Int, JsonKeys, dataclass, with_short_repr
from chromanoise.noise import OperatingPoint
from chromanoise.study.color_matrices import MatrixFunction
from chromanoise.study.ranking import (
    MOST_PAIRS_SENSORS,
    BestValue,
    Crossover,
    best_sentences,
    crossovers_or_reasons,
    leaders_of,
    value_in_words,
)
from chromanoise.study.sweeps import (
    SNR_Y,
    Curve,
    Quantity,
    Sweep,
    SweptQuantity,
    by_matrix,
    compared,
)


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class QuantityMap(SweptQuantity):
    """A quantity over two parameters: one row of values per value of the second.

    Attributes
    ----------
    second_at
        Its values. [unit of ``second``]
    """

    second: Sweep
    second_at: Float[Array, " j"]

    @property
    def over(self) -> str:
        """What varies, in words."""
        return f"{self.sweep.what} and {self.second.what}"


@dataclass(frozen=True, kw_only=True)
class CrossoverLine:
    """Crossovers of two sensors with one matrix, for each value of the second sweep.

    Attributes
    ----------
    first, second, matrix
        Names of the two sensors and of the matrix.
    at
        Their values of the first sweep, one entry per value of the second sweep; empty where there
        is none. [unit of the first sweep]
    """

    first: str
    second: str
    matrix: str
    at: tuple[tuple[float, ...], ...]


def mapped(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    at: Float[Array, " k"],
    second_at: Float[Array, " j"],
    *,
    sweep: Sweep,
    second: Sweep,
    quantity: Quantity = SNR_Y,
    progress: Callable[[int], None] = lambda _: None,
) -> tuple[tuple[QuantityMap, ...], tuple[CrossoverLine, ...]]:
    """A quantity of every sensor with every matrix over two sweeps, and the crossovers of pairs.

    Parameters
    ----------
    contestants, makers, quantity, progress
        As `chromanoise.study.compared`.
    at, second_at
        Increasing. [units of the sweeps]
    sweep, second
        Two different ones of `SWEEPS`, or your own.

    Returns
    -------
    maps, lines
        One map per sensor and matrix; of up to three sensors, one line per pair and matrix.

    Raises
    ------
    InputError
        If both sweeps vary the same parameter, or as `chromanoise.study.compared`.

    Notes
    -----
    Each row is a sweep of its own, at a fixed second value. A sweep that replaces the light
    comes before one that adds to it.
    """
    if sweep.name == second.name:
        raise InputError(
            "second",
            "must vary another parameter than the first sweep",
            value=second.name,
            found=None,
        )
    rows = second.checked(second_at)
    curves: list[tuple[Curve, ...]] = []
    crossed: list[dict[tuple[str, str, str], tuple[float, ...]]] = []
    for value in rows.tolist():
        if sweep.replaces_light:
            moved, both = list(contestants), _then(sweep, second, value)
        else:
            moved, both = [second.at(one, value) for one in contestants], sweep
        row = compared(moved, makers, at, sweep=both, quantity=quantity, progress=progress)
        curves.append(row)
        if len(contestants) <= MOST_PAIRS_SENSORS:
            pairs = crossovers_or_reasons(moved, makers, row)
            known = [pair for pair in pairs if isinstance(pair, Crossover)]
            crossed.append({(one.first, one.second, one.matrix): one.at for one in known})
    maps = tuple(
        QuantityMap(
            **one.subject | {"sweep": sweep},
            second=second,
            at=one.at,
            second_at=rows,
            value=np.array([row[i].value for row in curves]),
            saturated=np.array([row[i].saturated for row in curves]),
        )
        for i, one in enumerate(curves[0])
    )
    lines = tuple(
        CrossoverLine(
            first=a.sensor,
            second=b.sensor,
            matrix=name,
            at=tuple(row.get((a.sensor, b.sensor, name), ()) for row in crossed),
        )
        for name, mine in by_matrix(maps).items()
        for a, b in combinations(mine, 2)
        if crossed
    )
    return maps, lines


def _then(sweep: Sweep, second: Sweep, value: float) -> Sweep:
    """The sweep, with the second parameter set after it."""

    def both(operating_point: OperatingPoint, first: float) -> OperatingPoint:
        return second.at(sweep.at(operating_point, first), value)

    return replace(sweep, at=both)


def best_of(maps: Sequence[QuantityMap]) -> Int[Array, "j k"]:
    """Index of the best map at each pair of values, the first of equal ones; -1 without a value."""
    values = np.array([one.value for one in maps])
    return np.asarray(leaders_of(values, maps[0].quantity.more_is_better))


@dataclass(frozen=True, kw_only=True)
class BestCell(BestValue):
    """The pair of values at which one sensor is best, with one matrix.

    Attributes
    ----------
    second
        The parameter that varies besides ``sweep``.
    at, second_at
        The values of the grid. [units of the sweeps]
    """

    KEYS: ClassVar[JsonKeys] = ("sensor", "label", "matrix", "at", "second_at", "value")

    second: Sweep
    at: float
    second_at: float


def best_cells(maps: Sequence[QuantityMap]) -> tuple[BestCell, ...]:
    """For each sensor and matrix, its best pair of values; none without any result."""
    found = []
    for one in maps:
        points = one.points
        j, k = np.unravel_index(int(np.argmax(points)), points.shape)
        if np.isfinite(points[j, k]):
            cell = BestCell(
                **one.subject,
                second=one.second,
                at=float(one.at[k]),
                second_at=float(one.second_at[j]),
                value=float(one.value[j, k]),
            )
            found.append(cell)
    return tuple(found)


def best_cell_sentences(found: Sequence[BestCell]) -> list[str]:
    """Per matrix, at which pair of values each sensor is best, the best sensor first."""
    return best_sentences(found, lambda one, _: _place_in_words(one))


def _place_in_words(one: BestCell) -> tuple[str, str]:
    at = one.sweep.with_unit(value_in_words(one.at))
    second = one.second.with_unit(value_in_words(one.second_at))
    return f"{at} of {one.sweep.what} and {second} of {one.second.what}", ""
