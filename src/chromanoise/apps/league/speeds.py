"""ISO speeds of a league: single ones, or a range in whole stops."""

import math
from collections.abc import Sequence

from chromanoise.base import InputError, check

DEFAULT_ISO = "100:25600"
MOST_SPEEDS = 32


def iso_speeds(given: str | float | Sequence[float]) -> tuple[float, ...]:
    """ISO speeds of a text, a number or several numbers.

    Parameters
    ----------
    given
        ``100:25600`` for whole stops from the first to the last, ``100,160,400``, or numbers.

    Raises
    ------
    InputError
        If it is not such a text, or a speed is not between 1 and 1e7, or they do not rise.

    Examples
    --------
    >>> iso_speeds("100:1600")
    (100.0, 200.0, 400.0, 800.0, 1600.0)
    """
    if isinstance(given, str) and ":" in given:
        first, last = (_speed(part) for part in _two(given))
        stops = math.log2(last / first)
        speeds = [first * 2**i for i in range(math.floor(stops + 1e-9) + 1)]
    elif isinstance(given, str):
        speeds = [_speed(part) for part in given.split(",")]
    else:
        speeds = [_speed(one) for one in ([given] if isinstance(given, int | float) else given)]
    if sorted(set(speeds)) != speeds or not 1 <= len(speeds) <= MOST_SPEEDS:
        raise InputError(
            "iso",
            f"must rise, and have 1 to {MOST_SPEEDS} values",
            value=given,
            remedy=f"write {DEFAULT_ISO} or 100,200,400",
        )
    return tuple(speeds)


def _two(given: str) -> list[str]:
    parts = given.split(":")
    if len(parts) != 2:
        need = "must have the form FIRST:LAST"
        raise InputError("iso", need, value=given, remedy=f"write {DEFAULT_ISO}")
    return parts


def _speed(given: str | float) -> float:
    need = "must be ISO speeds"
    return check.within("iso", "1", check.number(str(given), "iso", need), 1.0, 1e7)
