"""The exact distribution of readings: moments, quantiles, and all values for few electrons.

Mean and variance are of values clipped at black and full well. Rounding and clipping are monotonic,
so they are applied to the quantile function itself, and point masses at black or full well need no
special case. The whole distribution of one reading serves where a Gaussian is not enough.
"""

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np

from chromanoise.base import Array, Bool, Float, InputError, check, dataclass, diagonal
from chromanoise.noise.exposure import Exposure
from chromanoise.noise.measurement import Measurement
from chromanoise.noise.readout import FARTHEST, Moments, Readout, count_law, count_window
from chromanoise.noise.variance import (
    CrosstalkPattern,
    NoiseSources,
    demand_independent_channels,
    noise_sources,
)
from chromanoise.sensor import Sensor, code_range_e


def sensor_moments(mean_e: Float[Array, "*px p"], noise: NoiseSources, readout: Readout) -> Moments:
    """Exact moments of the values that a pixel with these noise sources gives.

    Parameters
    ----------
    mean_e
        Expected electrons of the light, >= 0. [e-]
    noise
        The noise sources. Light and dark electrons are counted (Poisson), telegraph noise has its
        levels; the others are added as one normal variable per channel with their variance.
    readout
        Bounds after the subtraction of the mean dark signal, full well before it; the step is
        that of the converter, unless another is given. Each of several summed readings has an
        equal part of the bounds.

    Raises
    ------
    InputError
        As `read_moments`.

    Notes
    -----
    A product of PRNU and a Poisson count is not normal: its third cumulant, 3 PRNU^2 M^2, is
    omitted. Mean and variance are exact where nothing is clipped.
    """
    mean, n = check.non_negative("mean_e", "e-", mean_e), noise.readings
    if noise.pattern is not None:
        return _over_places(mean, noise, noise.pattern, readout)
    read = noise.moments_of_one_reading(*noise.smooth.of_one_reading(mean, readout))
    return replace(read, mean=n * read.mean, variance=n * read.variance, bias=n * read.mean - mean)


def _over_places(
    mean: Float[Array, "*px p"], noise: NoiseSources, pattern: CrosstalkPattern, readout: Readout
) -> Moments:
    """Moments over the places of each channel, at which different light is counted."""
    alone, found = replace(noise, pattern=None), []
    for i in range(mean.shape[-1]):
        read = sensor_moments(pattern.means_e(mean, i), alone, readout)
        each = (read.mean, read.variance, read.black_share, read.full_share)
        of_mean, variance, black, full = (values.mean(axis=-1) for values in each)
        found.append((of_mean, variance + read.mean.var(axis=-1), black, full))
    of_mean, variance, black, full = (np.stack(each, axis=-1) for each in zip(*found, strict=True))
    return Moments(
        mean=of_mean, variance=variance, bias=of_mean - mean, black_share=black, full_share=full
    )


def counted_readout(
    mean_e: Float[Array, "*px p"], noise: NoiseSources, readout: Readout
) -> tuple[Float[Array, "*px p"], Readout]:
    """Expected light and dark electrons that a pixel counts, and the readout of its codes. [e-]

    A sum of several readings is taken as one with the step of the sum.

    Parameters
    ----------
    mean_e
        Expected electrons of the light. [e-]
    noise
        The noise sources of the pixel.
    readout
        As `sensor_moments`. [e-]

    Notes
    -----
    As in raw pictures, the mean dark signal is subtracted and the error of the black level added
    before the converter rounds.
    """
    of_sum = replace(noise, pattern=None, readings=1)
    counted, bounds, _ = of_sum.of_one_reading(np.asarray(mean_e), readout)
    return counted, bounds


def clipping_readout(sensor: Sensor, exposure: Exposure | None = None) -> Readout:
    """Bounds of the sensor's values: black level, and full well or the top code.

    With a converter, the value at full well is also rounded to a code.

    Parameters
    ----------
    sensor, exposure
        As `noise_sources`.
    """
    noise = noise_sources(sensor, exposure)
    well_e, top_e = sensor.pixel.full_well_e, code_range_e(sensor)
    step = noise.step_e * np.sqrt(noise.readings)  # of all readings together
    offset = noise.black_error_e - noise.dark_e
    if step:
        well_e = step * np.floor((well_e + offset) / step + 0.5) - offset
    return Readout(black_e=0.0, full_well_e=float(min(well_e, top_e - offset)))


def raw_measurement(moments: Moments, names: tuple[str, ...]) -> Measurement:
    """The moments of independent channels as a raw measurement with diagonal covariance.

    Parameters
    ----------
    moments
        Of the values read.
    names
        Name of each channel.
    """
    return Measurement(
        mean=moments.mean,
        covariance=diagonal(moments.variance),
        names=names,
        kind="raw",
        unit="e-",
    )


def clipped_measurement(
    mean_e: Float[Array, "*px p"],
    sensor: Sensor,
    readout: Readout,
    exposure: Exposure | None = None,
) -> Measurement:
    """The raw measurement after readout, with exact mean and variance; compare `with_noise`.

    Parameters
    ----------
    mean_e
        Expected electrons of the light, >= 0. [e-]
    sensor, exposure
        As `noise_sources`.
    readout
        E.g. `clipping_readout` of the sensor.

    Raises
    ------
    InputError
        As `sensor_moments`, `noise_sources` and `demand_independent_channels`.

    Notes
    -----
    Channels are independent, so the covariance is diagonal. Near a bound the ratio of this mean to
    this standard deviation is not an SNR: check the clipped shares of `sensor_moments`.
    """
    demand_independent_channels(sensor)
    moments = sensor_moments(mean_e, noise_sources(sensor, exposure), readout)
    return raw_measurement(moments, sensor.names)


_MANY_E = 300.0  # standard deviation above which four cumulants give the distribution to 1e-7 of it
_SMOOTH_E = 1.0  # read noise that smooths single electrons to a ripple of exp(-2 pi^2) = 3e-9
_PER_SD = 64  # steps of the table: error 1e-5 for the skewness of few electrons
_PER_READ_NOISE = 32  # where single electrons are resolved


def poisson_gaussian_ppf(
    normal: Float[Array, "*n"], mean_e: float, *, read_noise_e: float
) -> Float[Array, "*n"]:
    """Quantiles of Poisson(M) + s Z, as a function of a standard normal variable. [e-]

    Parameters
    ----------
    normal
        Values z of the standard normal variable; Phi(z) is the share of readouts below the result.
    mean_e
        Expected electrons M, >= 0. [e-]
    read_noise_e
        Standard deviation s of the readout, >= 0. [e-]

    Raises
    ------
    InputError
        If mean or read noise is negative or not finite.

    Notes
    -----
    F^-1(Phi(z)), by a table of the distribution function, which is a sum over all counts except for
    tails of 1e-18; above a standard deviation of 300 e- by the Cornish-Fisher expansion with the
    cumulants M + s^2, M and M (Abramowitz & Stegun, 26.2.49).

    Examples
    --------
    Poisson(1) is 0 with probability 1/e = 0.368, so up to the normal quantile -0.338.

    >>> poisson_gaussian_ppf(np.array([-0.35, -0.33]), 1.0, read_noise_e=0.0)
    array([0., 1.])
    """
    mean = check.not_negative("mean_e", "e-", mean_e)
    noise = check.not_negative("read_noise_e", "e-", read_noise_e)
    z = np.asarray(normal, dtype=np.float64)
    if mean + noise**2 >= _MANY_E**2:
        return _cornish_fisher(z, mean, noise)
    if noise == 0:
        counts, shares = count_law(mean)
        edges = _normal_scores(np.cumsum(shares), np.append(np.cumsum(shares[:0:-1])[::-1], 0.0))
        at = np.searchsorted(edges, z)
        return counts[np.minimum(at, counts.size - 1)]
    scores, electrons = _table(mean, noise)
    return np.interp(z, scores, electrons)


def read_values(electrons: Float[Array, "*n"], readout: Readout) -> Float[Array, "*n"]:
    """Values of counted electrons: offset added, rounded to the nearest step, then clipped. [e-]

    Parameters
    ----------
    electrons
        Poisson electrons and read noise. [e-]
    readout
        Bounds, step and offset.

    Examples
    --------
    >>> read_values(np.array([-3.0, 4.9, 99.0]), Readout(black_e=0.0, full_well_e=10.0, step_e=2.0))
    array([ 0.,  4., 10.])
    """
    step, offset = readout.step_e, readout.offset_e
    values = electrons + offset if offset else electrons
    coded = step * np.floor(values / step + 0.5) if step else values
    return np.clip(coded, readout.black_e, readout.full_well_e)


def code_count(mean_e: float, noise: NoiseSources) -> int:
    """Number of codes between the quantiles 0.05 % and 99.95 % of a reading.

    Parameters
    ----------
    mean_e
        Expected electrons of the light. [e-]
    noise
        Noise sources of one reading, or of a sum of readings. For a sum, the result is the number
        of codes of one of its readings.

    Examples
    --------
    The range of 99.9 % is 3.29 standard deviations to each side: 2 * 3.29 * 10 / 1 = 66 steps.

    >>> from chromanoise.sensor import PAPER_PIXEL
    >>> code_count(0.0, NoiseSources(pixel=PAPER_PIXEL, step_e=1.0))
    67
    """
    (counted,), readout, (sd,) = noise.of_one_reading(np.array([mean_e]))
    ends = poisson_gaussian_ppf(np.array([-3.2905, 3.2905]), float(counted), read_noise_e=float(sd))
    first, last = read_values(ends, readout) / readout.step_e
    return round(last - first) + 1


def _cornish_fisher(z: Float[Array, "*n"], mean: float, noise: float) -> Float[Array, "*n"]:
    sd = np.sqrt(mean + noise**2)
    skew, excess = mean / sd**3, mean / sd**4
    bent = skew / 6 * (z**2 - 1) + excess / 24 * (z**3 - 3 * z) - skew**2 / 36 * (2 * z**3 - 5 * z)
    return np.asarray(mean + sd * (z + bent))


@lru_cache(maxsize=128)  # reused while color spaces and matrices change
def _table(mean: float, noise: float) -> tuple[Float[Array, " t"], Float[Array, " t"]]:
    """Standard normal quantiles in ascending order, and the values read there. [1, e-]"""
    electrons = _places(mean, noise)
    below, above = _shares_beside(electrons, mean, noise)
    return check.frozen(_normal_scores(below, above)), check.frozen(electrons)


def _places(mean: float, noise: float) -> Float[Array, " t"]:
    """Points of the distribution table, dense enough for linear interpolation. [e-]"""
    counts, _ = count_law(mean)
    reach = FARTHEST * noise
    if 2 * reach < 1:  # single electrons are resolved
        steps = np.linspace(-reach, reach, int(2 * FARTHEST * _PER_READ_NOISE))
        return (counts[:, None] + steps).ravel()
    blurred = noise >= _SMOOTH_E
    step = np.sqrt(mean + noise**2) / _PER_SD if blurred else noise / _PER_READ_NOISE
    return np.arange(counts[0] - reach, counts[-1] + reach + step, step)


def _shares_beside(
    electrons: Float[Array, " t"], mean: float, noise: float
) -> tuple[Float[Array, " t"], Float[Array, " t"]]:
    """Shares of the readouts below and above each value.

    More than one standard deviation from the mean, on one side of the median, only the smaller
    share is computed; the larger is returned as 1.
    """
    sd = np.sqrt(mean + noise**2)
    below, above = np.ones_like(electrons), np.ones_like(electrons)
    for shares, side, here in (
        (below, 1.0, electrons <= mean + sd),
        (above, -1.0, electrons >= mean - sd),
    ):
        shares[here] = _share_on_side(electrons[here], mean, noise, side)
    return below, above


def _share_on_side(
    electrons: Float[Array, " t"], mean: float, noise: float, side: float
) -> Float[Array, " t"]:
    """Share of the readouts below (``side`` 1) or above (-1); far counts need no Gaussian."""
    from scipy.special import ndtr

    counts, shares = count_law(mean)
    near = min(counts.size, int(2 * FARTHEST * noise) + 2)
    first = np.ceil(electrons - FARTHEST * noise - counts[0]).astype(np.int64)
    first = np.clip(first, 0, counts.size - near)
    at = first[:, None] + np.arange(near)
    with np.errstate(over="ignore"):  # overflows to inf for a read noise of 1e-308 e-
        away = (side * electrons[:, None] - (side * counts)[at]) / noise
    if side > 0:
        far = np.concatenate([[0.0], np.cumsum(shares)])[first]
    else:
        far = np.concatenate([np.cumsum(shares[::-1])[::-1], [0.0]])[first + near]
    return np.asarray(far + (shares[at] * ndtr(away)).sum(axis=1))


def _normal_scores(below: Float[Array, " t"], above: Float[Array, " t"]) -> Float[Array, " t"]:
    """Standard normal quantiles, each from the smaller tail, because 1 - 1e-20 rounds to 1."""
    from scipy.special import ndtri

    tail = np.clip(np.minimum(below, above), 1e-300, 0.5)
    return np.where(below < above, ndtri(tail), -ndtri(tail))


MOST_COUNTED_E = 2000.0
"""Largest mean whose distribution is tabulated. [e-]"""

_FEW_E = 1000.0
_MOST_NOISE_E = 100.0  # with more, the skewness of 1000 electrons is below 1e-3

_VALUES_PER_DEVIATION = 6  # values per standard deviation of the readout
_LEAST_NOISE_E = 1e-3  # below it the readout is exact
_LEAST_SD_E = 0.02  # in place of less, because 50 of it lie between two counts
_MOST_REACH_E = 1e5
_MOST_ENTRIES = 2**22  # of the table codes x counts; more codes are as good as continuous


@dataclass(frozen=True, kw_only=True, eq=False)
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
        check.increasing("values_e", "e-", self.values_e)
        check.fraction("probability", "1", self.probability)
        check.freeze(self, "values_e", "probability")


def few_electrons(mean_e: Float[Array, "*k"], noise: NoiseSources) -> Bool[Array, "*k"]:
    """Whether one reading needs its exact distribution, because a Gaussian is too inaccurate.

    True up to 1000 electrons of light and dark, and up to ``MOST_COUNTED_E`` where the step of the
    converter exceeds the noise, with at most 100 electrons of noise that is not counted. Not for a
    sum of readings whose step exceeds the noise, of which mean and variance alone are exact.

    Parameters
    ----------
    mean_e
        Expected electrons of the light. [e-]

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
        Expected electrons of the light, from 0 to ``MOST_COUNTED_E``. [e-]
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
    mean = check.non_negative("mean_e", "e-", mean_e)
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
    of_sum = replace(noise, readings=1)
    counted, bounds, added = of_sum.smooth.of_one_reading(mean, readout or Readout())
    shifts, step = of_sum.shifts, bounds.step_e
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
    counts_alone = added.max() < _LEAST_NOISE_E and len(shifts) == 1
    if step:
        values, table = _rounded(counted, added, bounds, shifts)
    elif counts_alone:
        values, table = _rounded(counted, np.zeros_like(added), Readout(step_e=1.0), shifts)
    else:
        values, table = _continuous(counted, np.maximum(added, _LEAST_SD_E), shifts)
    values = values if step else values + bounds.offset_e
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
        Index of the channel, from 0.
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
    per_e = math.ceil(_VALUES_PER_DEVIATION / float(added.min()))
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
