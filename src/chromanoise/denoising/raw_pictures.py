"""Raw pictures of any camera: their planes, and a check of the noise model."""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Float32
from chromanoise.denoising.burst import BurstFrame, merged_frames
from chromanoise.denoising.method import DenoisingMethod
from chromanoise.denoising.pictures import place_correlation, planes_of_mosaic
from chromanoise.denoising.planes import NoisyPlanes, packed, unpacked
from chromanoise.denoising.raw_noise import CodeNoise
from chromanoise.denoising.strips import denoised_planes
from chromanoise.errors import InputError, Setting
from chromanoise.exposure import OperatingPoint
from chromanoise.imaging import Work, chart_electrons
from chromanoise.imaging.demosaic import channel_tile
from chromanoise.imaging.render import ALL_CORES
from chromanoise.sensor import Mosaic

_SPREAD = 0.6
"""Standard deviation of a channel over its mean: 0.4 to 0.7 for the ColorChecker."""
_CHANNELS = 0.9
"""Correlation of two channels: 0.65 to 0.99 for the ColorChecker."""
_ROWS = 256
_BLOCK = 16
"""Rows and columns of a block of a plane in which noise is measured. [pixels]"""
_FEWEST_BLOCKS = 20
_FURTHEST = 5.0
"""Standard errors by which the mean of a picture may be below black."""
_TENTH_Z = -1.2816
"""The value below which a tenth of a standard normal distribution lies."""
_DIFFERENCE_POWER = 36.0
"""Sum of the squares of the second difference along rows and columns."""
_DIFFERENCE_CORRELATION = (1 + 2 * (4 / 6) ** 2 + 2 * (1 / 6) ** 2) ** 2
"""Sum of the squared autocorrelation of that difference."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DenoisedRaw:
    """A raw picture after denoising.

    Attributes
    ----------
    values_e
        Electrons; those of the picture where it is saturated. [e-]
    names
        Planes: the places of the mosaic's tile.
    residual
        Root mean square of picture minus result over the noise of the picture, per plane; NaN
        where no value is used. [1]
    measured
        Noise of the picture where it is smoothest over its expected noise, per plane; NaN where
        there are no such places. [1]
    frames
        Number of merged frames.
    """

    values_e: Float32[Array, "h w"]
    names: tuple[str, ...]
    residual: Float[Array, " k"]
    measured: Float[Array, " k"]
    frames: int


def at_brightness(
    operating_point: OperatingPoint,
    mosaic: Mosaic,
    raw_e: Float32[Array, "h w"],
    noise: CodeNoise,
) -> OperatingPoint:
    """The operating point at which the ColorChecker has the mean of a picture.

    Parameters
    ----------
    operating_point
        Sensor, light and exposure; the illuminance is replaced.
    mosaic
        The channel of each pixel.
    raw_e
        The picture. [e-]
    noise
        Of the picture. Its standard error is the least mean that is used.

    Raises
    ------
    InputError
        If the mean of the picture is further below 0 than noise explains, or as
        `planes_of_mosaic`.
    """
    channels = channel_tile(mosaic, operating_point.sensor.names).ravel()
    chart = chart_electrons(operating_point)[:, channels].mean()
    scale = _mean_above_black(raw_e, noise)[0] / float(chart)
    return replace(operating_point, level_lux=operating_point.level_lux * scale)


def neutral_planes(raw_e: Float32[Array, "h w"], mosaic: Mosaic, noise: CodeNoise) -> NoisyPlanes:
    """The planes of a raw picture of an unknown sensor, with a prior of nearly gray scenes.

    Parameters
    ----------
    raw_e
        The picture. [e-]
    mosaic
        The channel of each pixel.
    noise
        Of the picture.

    Raises
    ------
    InputError
        If the mean of the picture is further below 0 than noise explains, or the mosaic has other
        channels than the noise.

    Notes
    -----
    The prior mean is that of each plane, at least its standard error in the dark. Each plane varies
    by 0.6 of its mean, and two channels have a correlation of 0.9, about as the ColorChecker.
    Neighbors are as in `planes_of_mosaic`.
    """
    _, error_e = _mean_above_black(raw_e, noise)
    tile = channel_tile(mosaic, noise.names)
    planes_e, channels = packed(raw_e, tile)
    mean = np.maximum(planes_e.mean(axis=(0, 1), dtype=np.float64), error_e)
    same = np.equal.outer(channels, channels)
    alike = np.where(same, 1.0, _CHANNELS) * place_correlation(tile)
    return NoisyPlanes(
        values_e=planes_e,
        law=noise.law.take(channels),
        prior_e2=np.outer(mean, mean) * _SPREAD**2 * alike,
        prior_mean_e=mean,
        names=mosaic.place_names,
    )


def denoised_raw(
    raw_e: Float32[Array, "h w"],
    mosaic: Mosaic,
    noise: CodeNoise,
    method: DenoisingMethod,
    *,
    operating_point: OperatingPoint | None = None,
    others: Iterable[tuple[Float32[Array, "h w"], float]] = (),
    work: Work = ALL_CORES,
) -> DenoisedRaw:
    """A raw picture, or a burst of them, after denoising.

    Parameters
    ----------
    raw_e
        The picture, or the first one. [e-]
    mosaic
        The channel of each pixel.
    noise
        Of a picture.
    method
        Of `DENOISING`.
    operating_point
        Its sensor gives the covariance of the planes; `neutral_planes` without it.
    others
        Further pictures of a burst in their own electrons, each with its exposure over that of the
        first. [e-], [1]
    work
        As `denoised_planes`.

    Raises
    ------
    InputError
        As `neutral_planes`, `planes_of_mosaic`, `merged_frames` and the method.
    """
    tile = channel_tile(mosaic, noise.names)
    channels = tile.ravel()
    if operating_point is None:
        planes = neutral_planes(raw_e, mosaic, noise)
    else:
        known = planes_of_mosaic(raw_e, operating_point, mosaic, step_e=0.0)
        planes = replace(known, law=noise.law.take(channels))
    most_e = np.float32(np.inf)
    if noise.saturation_dn is not None:
        most_e = noise.electrons(np.array([[noise.saturation_dn]]))[0, 0]
    kept = planes.values_e >= most_e
    frames = [BurstFrame(values_e=packed(e, tile)[0], exposure=t) for e, t in others]
    if frames:
        burst = merged_frames(
            planes,
            frames,
            fixed=noise.spatial.take(channels),
            saturation_e=float(most_e),
        )
        planes, kept = burst.planes, burst.used == 0
    clean = denoised_planes(planes, method, work=work)
    clean[kept] = planes.values_e[kept]
    return DenoisedRaw(
        values_e=unpacked(clean, mosaic.shape, (raw_e.shape[0], raw_e.shape[1])),
        names=planes.names,
        residual=residual_ratio(planes, clean, kept),
        measured=measured_noise_ratio(planes, kept),
        frames=1 + len(frames),
    )


def residual_ratio(
    planes: NoisyPlanes, clean_e: Float32[Array, "h w p"], omitted: Bool[Array, "h w p"]
) -> Float[Array, " p"]:
    """Root mean square of what denoising removed over the standard deviation of the noise. [1]

    It is 1 where all noise was removed, lower where some noise remains, and higher where detail was
    removed or the picture has more noise than assumed.

    Parameters
    ----------
    planes
        Noisy values and their noise.
    clean_e
        Values after denoising. [e-]
    omitted
        Values that are not used.

    Returns
    -------
    ratio
        Per plane; NaN where no value is used or has noise.

    Examples
    --------
    >>> from chromanoise.sensor import VarianceLaw
    >>> planes = NoisyPlanes(
    ...     values_e=np.array([[[7.0], [13.0]]], np.float32), prior_e2=np.eye(1),
    ...     law=VarianceLaw(floor_e2=9.0), prior_mean_e=np.ones(1), names=("W",))
    >>> residual_ratio(planes, np.full((1, 2, 1), 10, np.float32), np.zeros((1, 2, 1), bool))
    array([1.])
    """
    sums, counts = np.zeros(len(planes.names)), np.zeros(len(planes.names))
    for start in range(0, len(clean_e), _ROWS):
        rows = slice(start, start + _ROWS)
        variance = planes.variance_e2(clean_e[rows])
        used = ~omitted[rows] & (variance > 0)
        squares = (planes.values_e[rows] - clean_e[rows]).astype(np.float64) ** 2
        sums += np.divide(squares, variance, out=np.zeros_like(squares), where=used).sum((0, 1))
        counts += used.sum((0, 1))
    return np.sqrt(np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0))


def measured_noise_ratio(planes: NoisyPlanes, omitted: Bool[Array, "h w p"]) -> Float[Array, " p"]:
    """Noise of a picture where it is smoothest over its expected noise. [1]

    It does not depend on a denoising method. It is 1 where the expected noise is right, and lower
    where it is too high. Detail everywhere in the picture raises it.

    Parameters
    ----------
    planes
        Noisy values and their noise.
    omitted
        Values that are not used.

    Returns
    -------
    ratio
        Standard deviations, per plane; NaN with fewer than 20 blocks of 16 x 16 used values.

    Notes
    -----
    The mean square of the second difference along rows and columns, 36 times the variance
    (Immerkaer, Computer Vision and Image Understanding 64 (1996), 300-302), in blocks. Of the
    blocks, the value below which a tenth lies is compared with that of noise alone, whose mean
    square has a relative variance of 2 a / n with n values and a the sum of the squared
    autocorrelation of the difference.
    """
    height, width, count = planes.values_e.shape
    found: list[list[Float[Array, " m"]]] = [[] for _ in range(count)]
    for top in range(0, height - _BLOCK - 1, _BLOCK):
        rows = slice(top, top + _BLOCK + 2)
        used = np.logical_not(omitted[rows].any(axis=0)).reshape(width, count)
        for i in range(count):
            values = planes.values_e[rows, :, i].astype(np.float64)
            across = values[:, :-2] - 2 * values[:, 1:-1] + values[:, 2:]
            second = across[:-2] - 2 * across[1:-1] + across[2:]
            whole = (width - 2) // _BLOCK * _BLOCK
            squares = (second[:, :whole] ** 2).reshape(_BLOCK, -1, _BLOCK).mean(axis=(0, 2))
            means = values[1:-1, 1 : 1 + whole].reshape(_BLOCK, -1, _BLOCK).mean(axis=(0, 2))
            flags = used[1 : 1 + whole, i].reshape(-1, _BLOCK).all(axis=1)
            variance = planes.variance_e2(np.repeat(means[:, None], count, axis=1))[:, i]
            flags &= variance > 0
            found[i].append(squares[flags] / (_DIFFERENCE_POWER * variance[flags]))
    of_noise = 1 + _TENTH_Z * math.sqrt(2 * _DIFFERENCE_CORRELATION) / _BLOCK
    blocks = [np.concatenate(each) if each else np.zeros(0) for each in found]
    return np.array(
        [
            math.sqrt(np.quantile(each, 0.1) / of_noise) if each.size >= _FEWEST_BLOCKS else np.nan
            for each in blocks
        ]
    )


def _mean_above_black(raw_e: Float32[Array, "h w"], noise: CodeNoise) -> tuple[float, float]:
    """Mean of a picture, at least its standard error in the dark, and that error. [e-]

    Raises
    ------
    InputError
        If the mean is further below 0 than 5 standard errors and half a code.
    """
    mean = float(raw_e.mean(dtype=np.float64))
    error_e = math.sqrt(np.max(noise.law.floor_e2) / raw_e.size)
    if mean < -_FURTHEST * error_e - noise.gain_e_per_dn / 2 or not max(mean, error_e) > 0:
        raise InputError(
            "mean of the picture",
            "must not be below the black level by more than noise explains",
            value=mean,
            found=f"is {mean:.4g} e- from it",
            remedy=Setting("black_level"),
        )
    return max(mean, error_e), error_e
