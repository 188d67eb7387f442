"""Fixed-pattern noise of one plane, from averaged frames: DSNU, PRNU, hot pixels (EMVA 1288)."""

import math
from dataclasses import dataclass

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.characterization.statistics import PlaneSample, independent_pairs

_HOT_SIGMA = 6.0  # of the spread of the dark mean: of 10^8 normal pixels, 0.1 lie above
_TO_SIGMA = 1.482602218505602  # from the median absolute deviation of a normal distribution
LEAST_SIDE = 64
"""Least side of a plane that is high-pass filtered. [px]"""
_WIDTHS, _BINOMIAL = (7, 11), np.array([1.0, 2.0, 1.0]) / 4
_SMOOTH = np.convolve(np.convolve(np.full(7, 1 / 7), np.full(11, 1 / 11)), _BINOMIAL)
"""Smoothing of EMVA 1288 in one direction: 7 and 11 pixels wide, then a binomial of 3."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpatialVariance:
    """Variance of the pixels of an averaged frame without its temporal part.

    Attributes
    ----------
    variance_dn2, se_dn2
        The variance and its standard error; may be negative by chance. [DN^2]
    filtered
        Whether the frame was high-pass filtered.
    """

    variance_dn2: float
    se_dn2: float
    filtered: bool


def spatial_variance(
    mean: Float[Array, "h w"], sample: PlaneSample, *, frames: int, high_pass: bool
) -> SpatialVariance:
    """The variance between pixels that is the same in every frame.

    Parameters
    ----------
    mean
        Mean of the frames of one light, one plane. [DN]
    sample
        Temporal statistics of the frames of this light.
    frames
        Number of frames that were averaged. [1]
    high_pass
        Whether the frame minus its smoothed copy is used, so that uneven light and shading are not
        counted. The variance of white noise is kept by a factor. Not done below 64 pixels.

    Notes
    -----
    EMVA 1288, release 4.0: s^2 = s^2 measured - sigma^2 / L for L frames; the filter is that of its
    section on PRNU.
    """
    filtered = high_pass and min(mean.shape) >= LEAST_SIDE
    image = _without_shading(mean) if filtered else mean
    white, shared = _kept() if filtered else (1.0, 1.0)
    measured = float(image.var(dtype=np.float64, ddof=1))
    of_rows, of_columns = (max(part, 0.0) for part in (sample.row_dn2, sample.column_dn2))
    rest = max(sample.rest_dn2, 0.0)
    temporal = (rest * white + (of_rows + of_columns) * shared) / frames
    rows, columns = image.shape
    by_rows, by_columns = of_rows * shared / frames, of_columns * shared / frames
    own = max(measured - by_rows - by_columns, 0.0)
    error2 = 2 * (own**2 / image.size + by_rows**2 / rows + by_columns**2 / columns)
    rest_se = rest * math.sqrt(2 / (sample.pixels * independent_pairs(len(sample.frame_means_dn))))
    shared_se = math.hypot(sample.row_se_dn2, sample.column_se_dn2)
    error2 += ((rest_se * white) ** 2 + (shared_se * shared) ** 2) / frames**2
    return SpatialVariance(
        variance_dn2=(measured - temporal) / white,
        se_dn2=math.sqrt(error2) / white,
        filtered=filtered,
    )


def hot_pixels(dark_mean: Float[Array, "h w"], sample: PlaneSample, *, frames: int) -> int:
    """Number of pixels far above the others in an averaged dark frame.

    Parameters
    ----------
    dark_mean, sample, frames
        As `spatial_variance`. The spread of the others is that of the median absolute deviation,
        and at least that of the temporal noise: averages of few codes may all be equal.
    """
    median = float(np.median(dark_mean))
    spread = _TO_SIGMA * float(np.median(np.abs(dark_mean - median)))
    least = math.sqrt(max(sample.variance_dn2, 1 / 12) / frames)
    return int((dark_mean - median > _HOT_SIGMA * max(spread, least)).sum())


def _kept() -> tuple[float, float]:
    """Factors of the variance of white noise, and of noise that a whole row or column shares."""
    middle, square = float(_SMOOTH[_SMOOTH.size // 2]), float(_SMOOTH @ _SMOOTH)
    return 1 - 2 * middle**2 + square**2, 1 - 2 * middle + square


def _without_shading(mean: Float[Array, "h w"]) -> Float[Array, "h2 w2"]:
    """The frame minus its smoothed copy, without the borders."""
    from scipy.ndimage import convolve1d, uniform_filter1d

    smooth = mean
    for axis in (0, 1):
        for width in _WIDTHS:
            smooth = uniform_filter1d(smooth, width, axis=axis)
        smooth = convolve1d(smooth, _BINOMIAL, axis=axis)
    border = _SMOOTH.size // 2
    return np.asarray((mean - smooth)[border:-border, border:-border])
