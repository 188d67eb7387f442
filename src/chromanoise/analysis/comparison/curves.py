"""A quantity of several sensors as a function of one parameter: one curve each."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.analysis.color_matrices import MatrixFunction, MatrixMaker
from chromanoise.analysis.comparison.quantities import (
    SNR_Y,
    Quantity,
    color_error,
    color_errors,
    is_saturated,
)
from chromanoise.analysis.comparison.sweeps import SWEEPS, Sweep
from chromanoise.exposure import OperatingPoint


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SweptQuantity:
    """A quantity of one sensor with one matrix over a sweep.

    Attributes
    ----------
    sensor, matrix
        Names.
    label
        Name of the sensor in tables and charts.
    sweep, quantity
        The parameter that varies, and the quantity.
    at
        Values of the parameter. [unit of the sweep]
    value
        NaN where it is not defined: a channel is saturated, a color is no signal. [unit of the
        quantity]
    saturated
        Where a channel is saturated on a perfect white.
    """

    sensor: str
    label: str
    matrix: str
    sweep: Sweep
    quantity: Quantity
    at: Float[Array, " k"]
    value: Float[Array, "*j k"]
    saturated: Bool[Array, "*j k"]

    def __post_init__(self) -> None:
        names = (field.name for field in fields(self))
        _check.freeze(
            self, *(name for name in names if isinstance(getattr(self, name), np.ndarray))
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Curve(SweptQuantity):
    """A quantity over one parameter.

    Attributes
    ----------
    time_s
        Exposure time before the sweep. [s]
    color_error
        Mean over the ColorChecker, without noise; NaN where it is not defined. [Delta E*ab]
    """

    time_s: float
    color_error: Float[Array, " k"]


def compared(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    at: Float[Array, " k"],
    *,
    sweep: Sweep = SWEEPS["lux"],
    quantity: Quantity = SNR_Y,
    progress: Callable[[int], None] = lambda _: None,
) -> tuple[Curve, ...]:
    """A quantity of every sensor with every matrix over the sweep.

    Parameters
    ----------
    contestants
        Sensors with their exposures and their light; the sweep changes nothing else of them.
    makers
        Matrix methods by name, from `matrix_makers` or functions of your own; each makes a new
        matrix at every value.
    at
        Increasing. [unit of the sweep]
    sweep
        The parameter that varies: one of `SWEEPS`, or your own.
    quantity
        One of `QUANTITIES`, or your own.
    progress
        Called with the number of newly finished values, out of all values of all curves.

    Raises
    ------
    InputError
        If the values do not increase, or are out of the range of the sweep.
    """
    values = _check.increasing(f"values of {sweep.name}", sweep.unit, at)
    for end in (values[0], values[-1]):
        _check.within(f"sweep of {sweep.name}", sweep.unit, end, sweep.lowest, sweep.highest)
    pairs = [(one, name, maker) for one in contestants for name, maker in makers.items()]
    found = [_over_levels(one, maker, values, sweep, quantity) for one, _, maker in pairs]
    progress(values.size * sum(curve is not None for curve in found))
    slow = [(one, maker) for (one, _, maker), curve in zip(pairs, found, strict=True) if not curve]
    rest = iter(_one_by_one(slow, values, sweep, quantity, progress))
    curves = []
    for (one, name, _), curve in zip(pairs, found, strict=True):
        value, errors, full = curve or next(rest)
        curves.append(
            Curve(
                sensor=one.sensor.name,
                label=one.sensor.label,
                matrix=name,
                time_s=one.exposure.time_s,
                sweep=sweep,
                quantity=quantity,
                at=values,
                value=value,
                saturated=full,
                color_error=errors,
            )
        )
    return tuple(curves)


_OverSweep = tuple[Float[Array, " k"], Float[Array, " k"], Bool[Array, " k"]]


def _over_levels(
    contestant: OperatingPoint,
    maker: MatrixFunction,
    values: Float[Array, " k"],
    sweep: Sweep,
    quantity: Quantity,
) -> _OverSweep | None:
    """All levels at once; ``None`` where the quantity has no function for many levels."""
    if sweep.name != SWEEPS["lux"].name or not isinstance(maker, MatrixMaker):
        return None
    if quantity.over_levels is None:
        return None
    full = is_saturated(contestant, values)
    first = maker(SWEEPS["lux"].at(contestant, float(values[0])))
    matrices = maker.over_levels(contestant, values)
    if matrices is not None:
        found = quantity.over_levels(contestant, first, values, matrices=matrices)
        return found, color_errors(contestant, matrices), full
    error = color_error(contestant, first)  # one matrix for all levels
    return quantity.over_levels(contestant, first, values), np.full(values.size, error), full


def _one_by_one(
    pairs: Sequence[tuple[OperatingPoint, MatrixFunction]],
    values: Float[Array, " k"],
    sweep: Sweep,
    quantity: Quantity,
    progress: Callable[[int], None],
) -> list[_OverSweep]:
    """All curves at each value, so that the first values show how long all of them take."""
    found: list[_OverSweep] = [
        (np.empty(values.size), np.empty(values.size), np.empty(values.size, bool)) for _ in pairs
    ]
    for i, value in enumerate(values.tolist()):
        for (contestant, maker), (of_one, errors, full) in zip(pairs, found, strict=True):
            operating_point = sweep.at(contestant, value)
            matrix = maker(operating_point)
            of_one[i] = quantity.of(operating_point, matrix)
            errors[i] = color_error(operating_point, matrix)
            full[i] = is_saturated(operating_point)
            progress(1)
    return found
