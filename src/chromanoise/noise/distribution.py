"""The whole distribution of one reading, for few electrons, where a Gaussian is not enough."""

import math
from dataclasses import dataclass, replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.errors import InputError
from chromanoise.noise.counts import count_law, count_window
from chromanoise.noise.exact import counted_readout
from chromanoise.noise.gaussian import FARTHEST
from chromanoise.noise.readout import Readout
from chromanoise.noise.sources import NoiseSources

MOST_COUNTED_E = 2000.0
"""Largest mean whose distribution is tabulated. [e-]"""

_FEW_E = 1000.0
_MOST_NOISE_E = 100.0  # with more, the skewness of 1000 electrons is below 1e-3

_PER_READ_NOISE = 6  # values per standard deviation of the readout
_LEAST_NOISE_E = 1e-3  # below it the readout is exact
_LEAST_SD_E = 0.02  # in place of less, because 50 of it lie between two counts
_MOST_REACH_E = 1e5
_MOST_ENTRIES = 2**22  # of the table codes x counts; more codes are as good as continuous


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReadingDistribution:
    """Distribution of one reading for k means, on common values.

    Attributes
    ----------
    values_e
        The values in ascending order. [e-]
    probability
        Of each value; one row per mean, whose sum is 1.
    width_e
        Width of the cell of each value for continuous readings; 0 for separate values. [e-]
    """

    values_e: Float[Array, " x"]
    probability: Float[Array, "k x"]
    width_e: float

    def __post_init__(self) -> None:
        _check.increasing("values_e", "e-", self.values_e)
        _check.fraction("probability", "1", self.probability)
        _check.freeze(self, "values_e", "probability")


def few_electrons(mean_e: Float[Array, "*k"], noise: NoiseSources) -> Bool[Array, "*k"]:
    """Whether one reading needs its exact distribution, because a Gaussian is too inaccurate.

    True up to 1000 electrons of light and dark, and up to `MOST_COUNTED_E` where the step of the
    converter exceeds the noise, with at most 100 electrons of noise that is not counted. Not for a
    sum of readings whose step exceeds the noise, of which mean and variance alone are exact.

    Parameters
    ----------
    mean_e
        Expected electrons of the light. [e-]
    noise
        The noise sources.

    Examples
    --------
    >>> from chromanoise.sensor import PAPER_PIXEL
    >>> few_electrons(np.array([10.0, 2000.0]), NoiseSources(pixel=PAPER_PIXEL))
    array([ True, False])
    """
    added, counted = noise.added_variance_e2(mean_e), mean_e + noise.dark_e
    few = np.asarray(counted <= _FEW_E)
    coarse = (
        _coarse_anywhere(mean_e, noise) if noise.readings > 1 else noise.rounding_is_coarse(mean_e)
    )
    few = few & ~coarse if noise.readings > 1 else few | (coarse & (counted <= MOST_COUNTED_E))
    return np.asarray(few & (added <= _MOST_NOISE_E**2))


def _coarse_anywhere(mean_e: Float[Array, "*k"], noise: NoiseSources) -> Bool[Array, "*k"]:
    """`NoiseSources.rounding_is_coarse` at any place of a crosstalk pattern."""
    if noise.pattern is None:
        return noise.rounding_is_coarse(mean_e)
    mean, alone = np.asarray(mean_e), replace(noise, pattern=None)
    found = [
        alone.rounding_is_coarse(noise.pattern.means_e(mean, i)).any(axis=-1)
        for i in range(mean.shape[-1])
    ]
    return np.stack(found, axis=-1)


def reading_distribution(
    mean_e: Float[Array, " k"], noise: NoiseSources, readout: Readout | None = None
) -> ReadingDistribution:
    """Distribution of Poisson counts with Gaussian readout, rounded and clipped.

    Parameters
    ----------
    mean_e
        Expected electrons of the light, from 0 to `MOST_COUNTED_E`. [e-]
    noise
        The noise sources, as in `sensor_moments`.
    readout
        Bounds and step; ``None`` for no bounds and the step of ``noise``.

    Raises
    ------
    InputError
        If a mean is negative or too large, the noise is too large for a table, or several readings
        are summed and the rounding of each is coarse (`NoiseSources.rounding_is_coarse`).

    Examples
    --------
    Without readout noise the values are the counts.

    >>> from chromanoise.sensor import Pixel
    >>> quiet = Pixel(pitch_um=3, full_well_e=9000, read_noise_e=0.0)
    >>> one = reading_distribution(np.array([1.0]), NoiseSources(pixel=quiet))
    >>> one.values_e[:2], one.probability[0, :2].round(3)
    (array([0., 1.]), array([0.368, 0.368]))
    """
    mean = _check.non_negative("mean_e", "e-", mean_e)
    if mean.size and mean.max() > MOST_COUNTED_E:
        raise InputError(
            "mean_e",
            f"must be at most {MOST_COUNTED_E:g} [e-] for a table of its distribution",
            value=float(mean.max()),
            remedy="take the Gaussian form, or less light",
        )
    if noise.readings > 1 and noise.rounding_is_coarse(mean).any():
        raise InputError(
            "noise",
            "must smooth the rounding of each reading, because several are summed",
            value=noise.step_e / np.sqrt(noise.readings),
            found=f"has a step of {noise.step_e / np.sqrt(noise.readings):g} [e-] in each of "
            f"{noise.readings} readings",
            remedy="take `sensor_moments`, whose mean and variance are exact",
        )
    counted, bounds = counted_readout(mean, noise, readout or Readout())
    of_sum = replace(noise, readings=1)
    shifts = of_sum.shifts
    added = np.sqrt(np.broadcast_to(of_sum.smooth.added_variance_e2(mean), mean.shape))
    step = bounds.step_e
    low, high = _reach(counted, added, shifts)
    if high - low > _MOST_REACH_E:
        raise InputError(
            "noise",
            f"must span at most {_MOST_REACH_E:g} [e-] for a table of a distribution",
            value=high - low,
            remedy="take the Gaussian form",
        )
    if step and (high - low) ** 2 / step > _MOST_ENTRIES:
        step, added = 0.0, np.sqrt(added**2 + step**2 / 12)
    if step:
        values, table = _rounded(counted, added, replace(bounds, step_e=step), shifts)
    elif added.max() < _LEAST_NOISE_E and len(shifts) == 1:
        values, table = _rounded(counted, np.zeros_like(added), Readout(step_e=1.0), shifts)
    else:
        values, table = _continuous(counted, np.maximum(added, _LEAST_SD_E), shifts)
    values = values if step else values + bounds.offset_e
    counts_alone = added.max() < _LEAST_NOISE_E and len(shifts) == 1
    width = 0.0 if step or counts_alone else float(values[1] - values[0])
    values, table = _clipped(values, table, bounds)
    return ReadingDistribution(
        values_e=values,
        probability=np.clip(table / table.sum(axis=1, keepdims=True), 0.0, 1.0),
        width_e=width,
    )


def channel_distribution(
    mean_e: Float[Array, "k p"],
    channel: int,
    noise: NoiseSources,
    readout: Readout | None = None,
) -> ReadingDistribution:
    """`reading_distribution` of one channel at ``k`` lights.

    With a pattern of crosstalk, the mean of the distributions at the places of the channel.

    Parameters
    ----------
    mean_e
        Expected electrons of the light; one column per channel. [e-]
    channel
        Its index.
    noise, readout
        As `reading_distribution`.

    Raises
    ------
    InputError
        As `reading_distribution`.
    """
    if noise.pattern is None:
        return reading_distribution(mean_e[:, channel], noise, readout)
    means = noise.pattern.means_e(mean_e, channel)
    every = reading_distribution(means.ravel(), replace(noise, pattern=None), readout)
    at_places = every.probability.reshape(*means.shape, -1)
    return replace(every, probability=at_places.mean(axis=1))


Shifts = tuple[tuple[float, float], ...]


def _reach(
    counted: Float[Array, " k"], added: Float[Array, " k"], shifts: Shifts
) -> tuple[float, float]:
    lowest, highest = count_window(counted)
    away = max(shift for _, shift in shifts)
    return (
        math.floor(float((lowest - FARTHEST * added).min() - away)),
        math.ceil(float((highest + FARTHEST * added).max() + away)),
    )


def _continuous(
    counted: Float[Array, " k"], added: Float[Array, " k"], shifts: Shifts
) -> tuple[Float[Array, " x"], Float[Array, "k x"]]:
    """Density times cell; single electrons lie on the grid."""
    low, high = _reach(counted, added, shifts)
    per_e = math.ceil(_PER_READ_NOISE / float(added.min()))
    values = low + np.arange((high - low) * per_e + 1) / per_e
    table = np.zeros((counted.size, values.size))
    for row, mean, sd in zip(table, counted, added, strict=True):
        counts, shares = count_law(float(mean))
        own = np.zeros((counts.size - 1) * per_e + 1)
        own[::per_e] = shares
        reach = math.floor(FARTHEST * sd * per_e)
        around = np.arange(-reach, reach + 1)
        for weight, shift in shifts:
            whole = round(shift * per_e)
            bell = np.exp(-0.5 * ((around + whole - shift * per_e) / (sd * per_e)) ** 2)
            start = int(counts[0] - low) * per_e + whole - reach
            row[start : start + own.size + 2 * reach] += weight * np.convolve(own, bell)
    return values, table


def _rounded(
    counted: Float[Array, " k"], added: Float[Array, " k"], bounds: Readout, shifts: Shifts
) -> tuple[Float[Array, " x"], Float[Array, "k x"]]:
    from scipy.special import ndtr

    step, offset = bounds.step_e, bounds.offset_e
    low, high = _reach(counted, added, shifts)
    first, last = math.floor((low + offset) / step), math.ceil((high + offset) / step) + 1
    codes = np.arange(first, last + 1)
    table = np.zeros((counted.size, codes.size))
    for row, mean, sd in zip(table, counted, added, strict=True):
        counts, shares = count_law(float(mean))
        for weight, shift in shifts:
            if sd < _LEAST_NOISE_E:
                at = np.floor((counts + offset + shift) / step + 0.5).astype(np.int64) - first
                np.add.at(row, at, weight * shares)
                continue
            lowest = counts[0] + offset + shift - FARTHEST * sd
            highest = counts[-1] + offset + shift + FARTHEST * sd
            start, stop = math.floor(lowest / step) - first, math.ceil(highest / step) + 2 - first
            edges = (codes[start:stop, None] - 0.5) * step - (counts + offset + shift)
            below, above = ndtr(edges / sd), ndtr(-edges / sd)
            between = np.where(edges[:-1] > 0, above[:-1] - above[1:], below[1:] - below[:-1])
            row[start : stop - 1] += weight * (between @ shares)
    return codes * step, table


def _clipped(
    values: Float[Array, " x"], table: Float[Array, "k x"], bounds: Readout
) -> tuple[Float[Array, " y"], Float[Array, "k y"]]:
    at = np.clip(values, bounds.black_e, bounds.full_well_e)
    kept, cell = np.unique(at, return_inverse=True)
    if kept.size == values.size:
        return values, table
    merged = np.zeros((len(table), kept.size))
    np.add.at(merged.T, cell, table.T)
    return kept, merged
