"""The free numbers of a design: bounds, start, tolerance, ties."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from chromanoise import _check
from chromanoise.errors import InputError, did_you_mean, known_name
from chromanoise.sensor.filters import possible


@dataclass(frozen=True, slots=True, kw_only=True)
class Free:
    """A number that the search chooses, as a design gives it.

    Attributes
    ----------
    low, high
        Bounds, in the unit of the parameter.
    start
        Where a search with a warm start begins, or ``None``.
    tolerance
        Half width of the manufacturing spread, in the unit of the parameter.
    """

    low: float
    high: float
    start: float | None = None
    tolerance: float = 0.0


Value = float | Free | str
"""A fixed number, a free one, or the name of the parameter to which it is tied."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parameter:
    """One free number of a design space: one coordinate of a search.

    Attributes
    ----------
    name
        Part and number, as ``R.center_nm``.
    unit
        Unit of all its values; ``1`` for a ratio.
    low, high
        Bounds of the search.
    start
        Where a search with a warm start begins, or ``None``.
    tolerance
        Half width of the manufacturing spread.
    least, most
        Physical limits; deviations by the tolerance stay within them.
    choices
        Names between which it chooses; then its value is the index of one, rounded to the nearest.

    Raises
    ------
    InputError
        If a number is not finite, the bounds are not in order or not possible, the start is outside
        the bounds, or the tolerance is negative.

    Examples
    --------
    >>> Parameter(name="R.center_nm", unit="nm", low=560.0, high=680.0).span
    120.0
    """

    name: str
    unit: str
    low: float
    high: float
    start: float | None = None
    tolerance: float = 0.0
    least: float = -math.inf
    most: float = math.inf
    choices: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        low = float(_check.finite(f"lower bound of {self.name}", self.unit, self.low))
        high = float(_check.finite(f"upper bound of {self.name}", self.unit, self.high))
        if not low < high:
            raise InputError(
                f"bounds of {self.name}",
                f"must satisfy low < high{_check.in_brackets(self.unit)}",
                value=(low, high),
                found=f"are {low:g} and {high:g}",
                remedy="give one number to fix it, or exchange the bounds",
            )
        for bound in (low, high):
            self.refuse_impossible(bound)
        if self.start is not None:
            _check.within(f"start of {self.name}", self.unit, self.start, low, high)
        _check.not_negative(f"tolerance of {self.name}", self.unit, self.tolerance)

    @property
    def span(self) -> float:
        """Distance of the bounds, in the unit of the parameter."""
        return self.high - self.low

    def refuse_impossible(self, value: float) -> None:
        """Refuse a value that is not physically possible.

        Parameters
        ----------
        value
            Value in the unit of the parameter.

        Raises
        ------
        InputError
            If the value is outside `least` to `most`.
        """
        refuse_outside(self.name, self.unit, value, self.least, self.most)


def refuse_outside(name: str, unit: str, value: float, least: float, most: float) -> None:
    """Refuse a value that is not finite, or not physically possible.

    Raises
    ------
    InputError
        If it is.
    """
    if not least <= value <= most or not math.isfinite(value):
        remedy = "divide percent by 100" if most == 1 and 1 < value <= 100 else ()
        demand = f"must be {possible(least, most)}{_check.in_brackets(unit)}"
        raise InputError(name, demand, value=value, remedy=remedy)


def tied_to(name: str, values: Mapping[str, Value]) -> str:
    """The name at the end of a chain of ties: the number that ``name`` takes.

    Parameters
    ----------
    name
        The name of a number of the design.
    values
        All numbers of the design by name.

    Raises
    ------
    InputError
        If a tie leads to a number that the design does not have, or in a circle.

    Examples
    --------
    >>> tied_to("G.width_nm", {"R.width_nm": Free(low=20, high=80), "G.width_nm": "R.width_nm"})
    'R.width_nm'
    """
    chain = [name]
    while isinstance(target := values[chain[-1]], str):
        target = known_name(target, values)
        if target in chain:
            raise InputError(
                chain[-1],
                "must be tied to another parameter",
                value=target,
                found=f"is tied in a circle: {' = '.join((*chain, target))}",
                remedy="give one of them a number or bounds",
            )
        if target not in values:
            raise InputError(
                chain[-1],
                "must be tied to a parameter of the design",
                value=target,
                remedy=did_you_mean(target, list(values), f"known: {', '.join(values)}"),
            )
        chain.append(target)
    return chain[-1]
