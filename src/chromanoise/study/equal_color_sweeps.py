"""Which sensor has the least visual noise at equal color error, over a sweep."""

from collections.abc import Sequence
from itertools import groupby
from typing import Any, ClassVar, Literal

import numpy as np

from chromanoise.base import Array, Float, JsonKey, JsonKeys, dataclass, with_short_repr
from chromanoise.noise import OperatingPoint
from chromanoise.spectra import Spectra
from chromanoise.study.color_matrices import DEFAULT_PRIOR
from chromanoise.study.ranking import value_in_words
from chromanoise.study.sweeps import Sweep
from chromanoise.study.trade_offs import MOST_CHECKED, EqualColor, LeftOut, equal_color

_VALUES = 9  # of a sweep, at which sensors are compared

Outcome = Literal["leads", "tie", "lost", "not compared"]


@with_short_repr
@dataclass(frozen=True, kw_only=True)
class EqualColorRange:
    """Consecutive compared values of a sweep with the same outcome.

    Attributes
    ----------
    sweep
        The parameter that varies.
    first, last
        The lowest and the highest of these values. [unit of the sweep]
    outcome
        Whether a sensor leads, two or more tie, color is lost in the noise of each, or fewer than
        two can be compared.
    winner, sensor
        Name of the sensor of least visual noise, and its label in sentences; ``None`` where none
        leads.
    tied
        Labels of the sensors that tie, where two or more do.
    margin_db
        Visual noise of the second sensor over that of the first: smallest and largest of the
        range; ``None`` without a comparison. [dB]
    tie_db, at_color_error
        Largest margin that is a tie, and the color error of the comparison, as ``margin_db``. [dB,
        Delta E*ab]
    left_out
        The sensors that cannot be compared at these values, with the reason at the first.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("first", "last", "outcome", "winner", JsonKey("label", "sensor"), "tied"),
        *("margin_db", "tie_db", "at_color_error", "left_out"),
    )

    sweep: Sweep
    first: float
    last: float
    outcome: Outcome
    winner: str | None
    sensor: str | None
    tied: tuple[str, ...]
    margin_db: tuple[float, float] | None
    tie_db: tuple[float, float] | None
    at_color_error: tuple[float, float] | None
    left_out: tuple[LeftOut, ...]


def equal_color_ranges(
    points: Sequence[OperatingPoint],
    sweep: Sweep,
    at: Float[Array, " k"],
    *,
    prior: str | Spectra = DEFAULT_PRIOR,
) -> tuple[EqualColorRange, ...]:
    """Which sensor has the least visual noise at equal color error, over up to nine values.

    Empty for one sensor, or for more than 20.

    Parameters
    ----------
    points
        Sensors with their exposures, in one light.
    sweep
        The parameter that varies.
    at
        Its values, increasing. [unit of the sweep]
    prior
        The training set, as for `equal_color`.

    Raises
    ------
    InputError
        If the values do not increase, or one is outside of what the sweep can vary.
    """
    at = sweep.checked(at)
    if not 1 < len(points) <= MOST_CHECKED:
        return ()
    some = np.unique(np.linspace(0, at.size - 1, min(_VALUES, at.size)).round().astype(int))
    found = [
        (value, equal_color([sweep.at(one, value) for one in points], prior=prior, turns=False))
        for value in at[some].tolist()
    ]
    ranges = []
    for (outcome, *_), group in groupby(found, key=lambda one: _outcome(one[1])):
        values, there = zip(*group, strict=True)
        first = there[0]
        ranges.append(
            EqualColorRange(
                sweep=sweep,
                first=values[0],
                last=values[-1],
                outcome=outcome,
                winner=first.winner,
                sensor=None if first.winner is None else first.standings[0].sensor,
                tied=_tied(first),
                margin_db=_span([one.margin_db for one in there]),
                tie_db=_span([one.tie_db for one in there]),
                at_color_error=_span([one.at_color_error for one in there]),
                left_out=first.left_out,
            )
        )
    return tuple(ranges)


def _tied(found: EqualColor) -> tuple[str, ...]:
    return tuple(one.sensor for one in found.tied) if found.is_tie else ()


def _outcome(found: EqualColor) -> tuple[Any, ...]:
    """The outcome, the winner, and who ties or is left out."""
    outcome: Outcome = "tie" if found.is_tie else "lost"
    if not found.standings:
        outcome = "not compared"
    elif found.winner is not None:
        outcome = "leads"
    return outcome, found.winner, sorted(_tied(found)), [one.name for one in found.left_out]


def _span(values: Sequence[float | None]) -> tuple[float, float] | None:
    known = [one for one in values if one is not None]
    return (min(known), max(known)) if known else None


def range_sentences(ranges: Sequence[EqualColorRange]) -> list[str]:
    """Which sensor leads where, and by how much; then where none does, and why.

    Last, where fewer than two sensors can be compared.

    Parameters
    ----------
    ranges
        The ranges of one sweep.
    """
    order = ("leads", "tie", "lost")
    compared = [one for one in ranges if one.outcome != "not compared"]
    told = sorted(compared, key=lambda one: order.index(one.outcome)) or list(ranges[:1])
    sentences = [_sentence(one, is_first=k == 0) for k, one in enumerate(told)]
    if 0 < len(compared) < len(ranges):
        where = " and ".join(_where(one) for one in ranges if one not in compared)
        sentences.append(f"Fewer than two sensors can be compared {where}.")
    return sentences


def _where(one: EqualColorRange) -> str:
    low, high = value_in_words(one.first), one.sweep.with_unit(value_in_words(one.last))
    return f"at {high}" if one.first == one.last else f"from {low} to {high}"


def _sentence(one: EqualColorRange, *, is_first: bool) -> str:
    where = f"{_where(one)} ({one.sweep.what})" if is_first else _where(one)
    least, most = (f"{db:.1f}" for db in one.margin_db or (0.0, 0.0))
    by = f"{least} dB" if least == most else f"{least} to {most} dB"
    who = {
        "leads": f"{one.sensor} has the least visual noise {where}, {by} below the next sensor",
        "tie": f"{' and '.join(one.tied)} tie in visual noise {where}",
        "lost": f"no sensor leads {where}, because color is lost in the noise of each",
        "not compared": f"fewer than two sensors can be compared {where}",
    }[one.outcome]
    left_out = ", ".join(f"{each.sensor} ({each.why})" for each in one.left_out)
    but = f"; not compared: {left_out}" if left_out else ""
    at = "At equal color error"
    at = f"{at} (noise-aware matrices, up to {_VALUES} values compared)" if is_first else at
    return f"{at}, {who}{but}."
