"""Exact mean and variance of the values that a pixel gives, clipped at black and full well."""

from dataclasses import replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.exposure import Exposure
from chromanoise.noise.measurement import Measurement
from chromanoise.noise.readout import Moments, Readout, read_moments
from chromanoise.noise.sources import (
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
    mean, n = _check.non_negative("mean_e", "e-", mean_e), noise.readings
    if noise.pattern is not None:
        return _over_places(mean, noise, noise.pattern, readout)
    light, one, sd = noise.smooth.of_one_reading(mean)
    bounds = Readout(
        black_e=readout.black_e / n,
        full_well_e=readout.full_well_e / n + one.offset_e,
        step_e=readout.step_e or one.step_e,
        offset_e=one.offset_e,
    )
    counted = light + noise.dark_e / n
    read = noise.over_levels(
        lambda shift_e: read_moments(
            counted, read_noise_e=sd, readout=replace(bounds, offset_e=one.offset_e + shift_e)
        )
    )
    read = replace(read, bias=read.mean - light)
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
    offset = noise.black_error_e - noise.dark_e
    bounds = Readout(
        black_e=readout.black_e,
        full_well_e=readout.full_well_e + offset,
        step_e=readout.step_e or noise.step_e,
        offset_e=offset,
    )
    return np.asarray(mean_e) + noise.dark_e, bounds


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
