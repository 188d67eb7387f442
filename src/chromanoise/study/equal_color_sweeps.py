"""Which sensor has the least visual noise at equal color error, over a sweep."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import ClassVar

import numpy as np

from chromanoise.base import Array, Float, JsonKey, JsonKeys, with_short_repr
from chromanoise.noise import OperatingPoint
from chromanoise.spectra import Spectra
from chromanoise.study.color_matrices import DEFAULT_PRIOR
from chromanoise.study.ranking import value_in_words
from chromanoise.study.sweeps import Sweep
from chromanoise.study.trade_offs import EqualColor, equal_color

_VALUES = 9  # of a sweep, at which sensors are compared
_MOST_SENSORS = 20  # beyond, the comparison takes longer than the sweep


@with_short_repr
@dataclass(frozen=True, slots=True, kw_only=True)
class EqualColorRange:
    """Compared values of a sweep, one after the other, at which the same sensor comes first.

    Attributes
    ----------
    sweep
        The parameter that varies.
    first, last
        The lowest and the highest of these values. [unit of the sweep]
    winner, sensor
        Name of the sensor of least visual noise, and its label in sentences; ``None`` for ties.
    margin_db
        Noise of the second sensor over that of the winner: the least and the most. [dB]
    left_out
        Labels of the sensors that cannot be compared there.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("first", "last", "winner", JsonKey("label", "sensor"), "margin_db", "left_out"),
        JsonKey("sentence", lambda one: range_sentence(one), text="The same in words."),
    )

    sweep: Sweep
    first: float
    last: float
    winner: str | None
    sensor: str | None
    margin_db: tuple[float, float]
    left_out: tuple[str, ...]


def equal_color_ranges(
    points: Sequence[OperatingPoint],
    sweep: Sweep,
    at: Float[Array, " k"],
    *,
    prior: str | Spectra = DEFAULT_PRIOR,
) -> tuple[EqualColorRange, ...]:
    """Who has the least visual noise at equal color error, at up to nine values of a sweep.

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
    for key, group in groupby(found, key=lambda one: _who(one[1])):
        values, there = zip(*group, strict=True)
        if key is None:
            continue
        first, margins = there[0], [one.margin_db or 0.0 for one in there]
        ranges.append(
            EqualColorRange(
                sweep=sweep,
                first=values[0],
                last=values[-1],
                winner=first.winner,
                sensor=None if first.winner is None else first.standings[0].sensor,
                margin_db=(min(margins), max(margins)),
                left_out=tuple(one.sensor for one in first.left_out),
            )
        )
    return tuple(ranges)


def _who(found: EqualColor) -> tuple[str | None, tuple[str, ...]] | None:
    """The winner and who is left out; ``None`` without a comparison."""
    if not found.standings:
        return None
    return found.winner, tuple(one.name for one in found.left_out)


def range_sentence(one: EqualColorRange) -> str:
    """Who leads, over which values, and by how much.

    Parameters
    ----------
    one
        A range.
    """
    sweep, (least_db, most_db) = one.sweep, one.margin_db
    last = sweep.with_unit(value_in_words(one.last, 4))
    where = f"at {last} of {sweep.what}"
    if one.first != one.last:
        where = f"from {value_in_words(one.first, 4)} to {last} of {sweep.what}"
    if one.winner is None:
        who = "no sensor has clearly the least visual noise at equal color error"
    else:
        by = f"{least_db:.1f}" if f"{least_db:.1f}" == f"{most_db:.1f}" else ""
        by = by or f"{least_db:.1f} to {most_db:.1f}"
        who = f"{one.sensor} has the least visual noise at equal color error, by {by} dB"
    but = f" (not compared: {', '.join(one.left_out)})" if one.left_out else ""
    return f"{where[0].upper()}{where[1:]}, {who}{but}."
