"""Which sensor has the least visual noise at equal color error, over a sweep."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import ClassVar, Literal

import numpy as np

from chromanoise.base import Array, Float, JsonKey, JsonKeys, with_short_repr
from chromanoise.noise import OperatingPoint
from chromanoise.spectra import Spectra
from chromanoise.study.color_matrices import DEFAULT_PRIOR
from chromanoise.study.ranking import value_in_words
from chromanoise.study.sweeps import Sweep
from chromanoise.study.trade_offs import EqualColor, LeftOut, equal_color

_VALUES = 9  # of a sweep, at which sensors are compared
_MOST_SENSORS = 20  # beyond, the comparison takes longer than the sweep

Outcome = Literal["leads", "tie", "lost"]


@with_short_repr
@dataclass(frozen=True, slots=True, kw_only=True)
class EqualColorRange:
    """Consecutive compared values of a sweep with the same winner.

    Attributes
    ----------
    sweep
        The parameter that varies.
    first, last
        The lowest and the highest of these values. [unit of the sweep]
    outcome
        Whether a sensor leads, two or more tie, or color is lost in the noise of each.
    winner, sensor
        Name of the sensor of least visual noise, and its label in sentences; ``None`` where none
        leads.
    margin_db
        Visual noise of the second sensor over that of the first: smallest and largest of the
        range. [dB]
    left_out
        The sensors that cannot be compared at one of these values or more, with the reason.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("first", "last", "outcome", "winner", JsonKey("label", "sensor"), "margin_db"),
        "left_out",
    )

    sweep: Sweep
    first: float
    last: float
    outcome: Outcome
    winner: str | None
    sensor: str | None
    margin_db: tuple[float, float]
    left_out: tuple[LeftOut, ...]


def equal_color_ranges(
    points: Sequence[OperatingPoint],
    sweep: Sweep,
    at: Float[Array, " k"],
    *,
    prior: str | Spectra = DEFAULT_PRIOR,
) -> tuple[EqualColorRange, ...]:
    """Which sensor has the least visual noise at equal color error, over up to nine values.

    Empty for one sensor, or for more than 20. Values at which fewer than two sensors can be
    compared are in no range.

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
    """
    if not 1 < len(points) <= _MOST_SENSORS:
        return ()
    some = np.unique(np.linspace(0, at.size - 1, min(_VALUES, at.size)).round().astype(int))
    found = [
        (value, equal_color([sweep.at(one, value) for one in points], prior=prior, turns=False))
        for value in at[some].tolist()
    ]
    ranges = []
    for outcome, group in groupby(found, key=lambda one: _outcome(one[1])):
        if outcome is None:
            continue
        values, there = zip(*group, strict=True)
        first, margins_db = there[0], [one.margin_db or 0.0 for one in there]
        left_out = {one.name: one for each in there for one in each.left_out}
        ranges.append(
            EqualColorRange(
                sweep=sweep,
                first=values[0],
                last=values[-1],
                outcome=outcome[0],
                winner=first.winner,
                sensor=None if first.winner is None else first.standings[0].sensor,
                margin_db=(min(margins_db), max(margins_db)),
                left_out=tuple(left_out.values()),
            )
        )
    return tuple(ranges)


def _outcome(found: EqualColor) -> tuple[Outcome, str | None] | None:
    """The outcome and the winner; ``None`` without a comparison."""
    if not found.standings:
        return None
    if found.winner is not None:
        return "leads", found.winner
    return "tie" if found.is_tie else "lost", None


def range_sentences(ranges: Sequence[EqualColorRange]) -> list[str]:
    """Which sensor leads where, and by how much; then where none does.

    Parameters
    ----------
    ranges
        The ranges of one sweep.
    """
    led = [one for one in ranges if one.outcome == "leads"]
    rest = [one for one in ranges if one.outcome != "leads"]
    return [_sentence(one, is_first=k == 0) for k, one in enumerate([*led, *rest])]


def _sentence(one: EqualColorRange, *, is_first: bool) -> str:
    low, high = value_in_words(one.first), one.sweep.with_unit(value_in_words(one.last))
    over = f" ({one.sweep.what})" if is_first else ""
    where = f"at {high}{over}" if one.first == one.last else f"from {low} to {high}{over}"
    least, most = (f"{db:.1f}" for db in one.margin_db)
    by = f"{least} dB" if least == most else f"{least} to {most} dB"
    who = {
        "leads": f"{one.sensor} has the least visual noise {where}, {by} below the next sensor",
        "tie": f"sensors tie in visual noise {where}",
        "lost": f"no sensor leads {where}, because color is lost in the noise of each",
    }[one.outcome]
    but = "".join(f"; {each.sensor} drops out where {each.why}" for each in one.left_out)
    at = "At equal color error"
    at = f"{at} (noise-aware matrices, up to {_VALUES} values compared)" if is_first else at
    return f"{at}, {who}{but}."
