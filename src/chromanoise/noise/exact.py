"""Exact mean and variance of readout values, clipped at black and full well, and rounded."""

from dataclasses import dataclass, replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Int
from chromanoise.errors import InputError
from chromanoise.exposure import Exposure
from chromanoise.noise.counts import count_window, over_counts, over_counts_each
from chromanoise.noise.gaussian import FARTHEST, coded_moments, held_moments
from chromanoise.noise.measurement import Measurement
from chromanoise.noise.sources import (
    NoiseSources,
    demand_independent_channels,
    noise_sources,
)
from chromanoise.sensor import Sensor, code_range_e

_WIDE = 1.5  # read noise per step above which rounding adds step^2 / 12: exp(-2 pi^2 1.5^2) = 5e-20


@dataclass(frozen=True, slots=True, kw_only=True)
class Readout:
    """The values that a channel can have after readout.

    Attributes
    ----------
    black_e
        Least value; -inf for a readout that keeps negative values. [e-]
    full_well_e
        Largest value; inf for a readout that never saturates. [e-]
    step_e
        Values are rounded to the nearest multiple, then clipped to the bounds; 0 for no rounding.
        [e-]

    Raises
    ------
    InputError
        If black is not below full well, or the step is negative or not finite.
    """

    black_e: float = float("-inf")
    full_well_e: float = float("inf")
    step_e: float = 0.0

    def __post_init__(self) -> None:
        if not self.black_e < self.full_well_e:
            raise InputError(
                "black_e",
                f"must be below full_well_e of {self.full_well_e:g} [e-]",
                value=self.black_e,
            )
        _check.not_negative("step_e", "e-", self.step_e)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Moments:
    """Mean, variance and clipping of the values read from ``p`` channels.

    Attributes
    ----------
    mean
        Mean of the values read. [e-]
    variance
        Variance of the values read; near a bound it falls because values are clipped, not because
        the measurement is more precise. [e-^2]
    bias
        Mean minus expected electrons. [e-]
    black_share, full_share
        Probability that a value is clipped at black, or at full well.
    """

    mean: Float[Array, "*px p"]
    variance: Float[Array, "*px p"]
    bias: Float[Array, "*px p"]
    black_share: Float[Array, "*px p"]
    full_share: Float[Array, "*px p"]

    def __post_init__(self) -> None:
        _check.finite("Moments.mean", "e-", self.mean)
        _check.non_negative("Moments.variance", "e-^2", self.variance)
        _check.finite("Moments.bias", "e-", self.bias)
        _check.fraction("Moments.black_share", "1", self.black_share)
        _check.fraction("Moments.full_share", "1", self.full_share)
        _check.freeze(self, "mean", "variance", "bias", "black_share", "full_share")


def read_moments(
    mean_e: Float[Array, "*px p"],
    *,
    read_noise_e: float | Float[Array, "*px p"],
    readout: Readout,
) -> Moments:
    """Exact moments of clipped(rounded(Poisson(M) + s Z)), per channel.

    Parameters
    ----------
    mean_e
        Expected electrons M, >= 0. [e-]
    read_noise_e
        Standard deviation s of the readout, >= 0; one number, or one per entry. [e-]
    readout
        Bounds and step.

    Raises
    ------
    InputError
        If a mean is negative or not finite, if a mean above 1e10 is close to a bound or is
        rounded coarsely, or if the step is less than 2e-5 of the read noise.

    Notes
    -----
    A sum over counts of the moments of the censored normal distribution; the omitted probability is
    below 1e-17. Where the probability of clipping is below this, no sum is needed: the moments are
    M and M + s^2, plus step^2 / 12 where s is at least 1.5 steps (Widrow & Kollar, *Quantization
    Noise* (2008), section 4). Where every value is clipped, the variance is 0.

    Examples
    --------
    Full well is one standard deviation, sqrt(9900 + 10^2), above the mean: 15.9 % are clipped.

    >>> held = read_moments(np.array([9900.0, 100.0]), read_noise_e=10.0,
    ...                     readout=Readout(full_well_e=10_000.0))
    >>> held.full_share.round(3)
    array([0.159, 0.   ])
    >>> held.mean.round(1), held.variance.round(1)
    (array([9891.6,  100. ]), array([7494.2,  200. ]))
    """
    mean = _check.non_negative("mean_e", "e-", mean_e)
    noise = np.broadcast_to(_check.non_negative("read_noise_e", "e-", read_noise_e), mean.shape)
    lowest, highest = _reach(mean, noise, readout)
    always_black, always_full = highest < readout.black_e, lowest > readout.full_well_e
    summed = ~always_black & ~always_full
    smooth = noise >= _WIDE * readout.step_e
    summed &= ~smooth | (lowest < readout.black_e) | (highest > readout.full_well_e)
    free = np.zeros_like(mean)
    rows = np.stack([mean, mean + noise**2 + readout.step_e**2 / 12, free, free])
    rows[:, always_black] = np.array([[readout.black_e], [0.0], [1.0], [0.0]])
    rows[:, always_full] = np.array([[readout.full_well_e], [0.0], [0.0], [1.0]])
    if summed.any():
        rows[:, summed] = _summed(mean[summed], noise[summed], readout)
    return Moments(
        mean=rows[0],
        variance=rows[1],
        bias=rows[0] - mean,
        black_share=np.minimum(rows[2], 1.0),  # weights that sum to 1 + 1e-16
        full_share=np.minimum(rows[3], 1.0),
    )


def _reach(
    mean: Float[Array, "*px p"], noise: Float[Array, "*px p"], readout: Readout
) -> tuple[Float[Array, "*px p"], Float[Array, "*px p"]]:
    """Range of the rounded values, except for a probability of 1e-17. [e-]"""
    lowest, highest = count_window(mean)
    margin = FARTHEST * noise + readout.step_e
    return lowest - margin, highest + margin


def _summed(
    mean: Float[Array, " m"], noise: Float[Array, " m"], readout: Readout
) -> Float[Array, "4 m"]:
    black, full, step = float(readout.black_e), float(readout.full_well_e), readout.step_e
    bounds = {"black_e": black, "full_well_e": full}
    if (noise == noise[0]).all():
        one = float(noise[0])

        def given_count(count: Float[Array, " m"]) -> Float[Array, "4 m"]:
            if step == 0:
                return held_moments(count, read_noise_e=one, **bounds)
            return coded_moments(count, read_noise_e=one, step_e=step, **bounds)

        return over_counts(mean, given_count)
    if step == 0 and (noise > 0).all():

        def given_counts(count: Float[Array, " w"], row: Int[Array, " w"]) -> Float[Array, "4 w"]:
            return held_moments(count, read_noise_e=noise[row], **bounds)

        return over_counts_each(mean, given_counts)
    levels, of = np.unique(noise, return_inverse=True)
    found = np.empty((4, mean.size))
    for i in range(levels.size):
        found[:, of == i] = _summed(mean[of == i], noise[of == i], readout)
    return found


def sensor_moments(mean_e: Float[Array, "*px p"], noise: NoiseSources, readout: Readout) -> Moments:
    """Exact moments of the values that a pixel with these noise sources gives.

    Parameters
    ----------
    mean_e
        Expected electrons of the light, >= 0. [e-]
    noise
        The noise sources. Light and dark electrons are counted (Poisson); the other sources are
        added as one normal variable per channel with their variance.
    readout
        Bounds after the subtraction of the mean dark signal, full well before it; the step is
        that of the converter, unless another is given.

    Raises
    ------
    InputError
        As `read_moments`.

    Notes
    -----
    A product of PRNU and a Poisson count is not normal: its third cumulant, 3 PRNU^2 M^2, is
    omitted. Mean and variance are exact where nothing is clipped.
    """
    mean = _check.non_negative("mean_e", "e-", mean_e)
    counted, shifted = counted_readout(mean, noise, readout)
    found = read_moments(
        counted, read_noise_e=np.sqrt(noise.added_variance_e2(mean)), readout=shifted
    )
    if not noise.dark_e and not noise.black_error_e:
        return found
    read = found.mean - noise.dark_e + noise.black_error_e
    return replace(found, mean=read, bias=read - mean)


def counted_readout(
    mean_e: Float[Array, "*px p"], noise: NoiseSources, readout: Readout
) -> tuple[Float[Array, "*px p"], Readout]:
    """Electrons of light and dark, and the readout before the mean dark is subtracted. [e-]

    Parameters
    ----------
    mean_e
        Expected electrons of each channel. [e-]
    noise
        The noise sources of the pixel.
    readout
        Its limits and step, after the mean dark is subtracted. [e-]
    """
    offset = noise.dark_e - noise.black_error_e
    shifted = Readout(
        black_e=readout.black_e + offset,
        full_well_e=readout.full_well_e,
        step_e=readout.step_e or noise.step_e,
    )
    return np.asarray(mean_e) + noise.dark_e, shifted


def clipping_readout(sensor: Sensor, exposure: Exposure | None = None) -> Readout:
    """Bounds of the sensor's values: black level, and full well or the top code.

    Parameters
    ----------
    sensor, exposure
        As `noise_sources`.
    """
    dark_e = noise_sources(sensor, exposure).dark_e
    return Readout(
        black_e=0.0, full_well_e=min(sensor.pixel.full_well_e, code_range_e(sensor) + dark_e)
    )


def raw_measurement(moments: Moments, names: tuple[str, ...]) -> Measurement:
    """The moments of independent channels as a raw measurement with diagonal covariance.

    Parameters
    ----------
    moments
        Of the values read.
    names
        One per channel.
    """
    return Measurement(
        mean=moments.mean,
        covariance=moments.variance[..., None] * np.eye(moments.mean.shape[-1]),
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
