"""Fixed-pattern noise of one plane, from sums of frames: DSNU, PRNU, hot pixels (EMVA 1288)."""

import math
from dataclasses import dataclass

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Integer
from chromanoise.characterization.statistics import PlaneSample, independent_pairs
from chromanoise.imaging.frame_sums import SMOOTHED, high_passed_variance, value_counts

_HOT_SIGMA = 6.0  # of the spread of the dark mean: of 10^8 normal pixels, 0.1 lie above
_TO_SIGMA = 1.482602218505602  # from the median absolute deviation of a normal distribution
LEAST_SIDE = 64
"""Least side of a plane that is high-pass filtered. [px]"""
_BINOMIAL = np.array([1.0, 2.0, 1.0]) / 4
_SMOOTH = np.convolve(np.convolve(np.full(7, 1 / 7), np.full(11, 1 / 11)), _BINOMIAL)
"""Smoothing of EMVA 1288 in one direction: 7 and 11 pixels wide, then a binomial of 3."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SpatialVariance:
    """Variance of the pixels of an averaged frame without its temporal part.

    Attributes
    ----------
    variance_dn2, se_dn2
        The variance and its standard error; may be negative by chance. [DN^2]
    mean_dn
        Mean of the pixels used. [DN]
    removed_dn2
        Variance that the high-pass filter removed: uneven light and shading. [DN^2]
    filtered
        Whether the frame was high-pass filtered; its borders are then not used.
    """

    variance_dn2: float
    se_dn2: float
    mean_dn: float
    removed_dn2: float
    filtered: bool

    def signal_dn(self, dark: "SpatialVariance") -> float:
        """Root mean square of the signal above dark, by which the spread of pixels grows. [DN]"""
        return math.sqrt((self.mean_dn - dark.mean_dn) ** 2 + self.removed_dn2)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FixedPattern:
    """The sum of frames of one light, one plane, without the places of its pixels.

    Attributes
    ----------
    frames
        Number of frames in the sum. [1]
    shape
        Rows and columns. [px]
    values, counts
        The different sums in increasing order, and how many pixels have each. [DN], [1]
    high_passed
        Variance of the sum minus its smoothed copy, and the rows and columns of what is left
        without the borders; ``None`` below 64 pixels. [DN^2], [px]
    inner
        Mean and variance of the sum without these borders. [DN], [DN^2]
    """

    frames: int
    shape: tuple[int, int]
    values: Integer[Array, "n"]
    counts: Integer[Array, "n"]
    high_passed: tuple[float, tuple[int, int]] | None
    inner: tuple[float, float]

    @property
    def mean(self) -> float:
        """Mean of the pixels. [DN]"""
        return float(self.values @ self.counts) / math.prod(self.shape)

    @property
    def variance(self) -> float:
        """Variance of the pixels. [DN^2]"""
        return float(self.counts @ (self.values - self.mean) ** 2) / (math.prod(self.shape) - 1)


def fixed_pattern(total: Integer[Array, "h w"], frames: int) -> FixedPattern:
    """What is needed of a sum of frames.

    Parameters
    ----------
    total
        Sum of the frames of one light, one plane. [DN]
    frames
        Their number. [1]
    """
    values, counts = value_counts(total)
    high_passed = high_passed_variance(total) if min(total.shape) >= LEAST_SIDE else None
    border = SMOOTHED // 2 if high_passed else 0
    inside = total[border : total.shape[0] - border, border : total.shape[1] - border]
    return FixedPattern(
        frames=frames,
        shape=total.shape,
        values=values,
        counts=counts,
        high_passed=high_passed,
        inner=(float(inside.mean()), float(inside.var(ddof=1))),
    )


def spatial_variance(
    pattern: FixedPattern,
    sample: PlaneSample,
    *,
    high_pass: bool,
    dark: PlaneSample | None = None,
) -> SpatialVariance:
    """The variance between pixels that is the same in every frame.

    Parameters
    ----------
    pattern
        Of the sum of frames of one light.
    sample
        Temporal statistics of the frames of this light.
    high_pass
        Whether the frame minus its smoothed copy is used, so that uneven light and shading are not
        counted. The variance of white noise is kept by a factor. Not done below 64 pixels.
    dark
        Statistics of the darks of flats that are filtered. Filtering excludes the borders, which
        shading makes darker, so the signal and the shot noise of the remaining pixels are larger.

    Notes
    -----
    EMVA 1288, release 4.0: s^2 = s^2 measured - sigma^2 / L for L frames; the filter is that of its
    section on PRNU.
    """
    frames, measured, (rows, columns) = pattern.frames, pattern.variance, pattern.shape
    filtered = high_pass and pattern.high_passed is not None
    mean, removed = pattern.mean / frames, 0.0
    white, shared = _kept() if filtered else (1.0, 1.0)
    rest = max(sample.rest_dn2, 0.0)
    if high_pass and pattern.high_passed is not None:
        measured, (rows, columns) = pattern.high_passed
        mean = pattern.inner[0] / frames
        removed = max(pattern.inner[1] - measured / white, 0.0) / frames**2
        if dark is not None and sample.mean_dn > dark.mean_dn:
            of_light = (mean - dark.mean_dn) / (sample.mean_dn - dark.mean_dn)
            rest = max(dark.rest_dn2 + of_light * (sample.rest_dn2 - dark.rest_dn2), 0.0)
    measured /= frames**2
    of_rows, of_columns = (max(part, 0.0) for part in (sample.row_dn2, sample.column_dn2))
    temporal = (rest * white + (of_rows + of_columns) * shared) / frames
    by_rows, by_columns = of_rows * shared / frames, of_columns * shared / frames
    own = max(measured - by_rows - by_columns, 0.0)
    error2 = 2 * (own**2 / (rows * columns) + by_rows**2 / rows + by_columns**2 / columns)
    rest_se = rest * math.sqrt(2 / (sample.pixels * independent_pairs(len(sample.frame_means_dn))))
    shared_se = math.hypot(sample.row_se_dn2, sample.column_se_dn2)
    error2 += ((rest_se * white) ** 2 + (shared_se * shared) ** 2) / frames**2
    return SpatialVariance(
        variance_dn2=(measured - temporal) / white,
        se_dn2=math.sqrt(error2) / white,
        mean_dn=mean,
        removed_dn2=removed,
        filtered=filtered,
    )


def hot_pixels(pattern: FixedPattern, sample: PlaneSample) -> int:
    """Number of pixels far above the others in a sum of dark frames.

    Parameters
    ----------
    pattern, sample
        As `spatial_variance`. The spread of the others is that of the median absolute deviation,
        and at least that of the temporal noise: averages of few codes may all be equal.
    """
    values, counts = pattern.values, pattern.counts
    away = values - _median(values, counts)
    order = np.argsort(np.abs(away))
    spread = _TO_SIGMA * _median(np.abs(away)[order], counts[order])
    least = math.sqrt(max(sample.variance_dn2, 1 / 12) * pattern.frames)
    return int(counts[away > _HOT_SIGMA * max(spread, least)].sum())


def _median(values: Array, counts: Array) -> float:
    """Median of sorted values, each of which occurs as often as ``counts`` says."""
    until = np.cumsum(counts)
    middle = np.searchsorted(until, [(until[-1] - 1) // 2, until[-1] // 2], side="right")
    return float(values[middle].mean())


def _kept() -> tuple[float, float]:
    """Factors of the variance of white noise, and of noise that a whole row or column shares."""
    middle, square = float(_SMOOTH[_SMOOTH.size // 2]), float(_SMOOTH @ _SMOOTH)
    return 1 - 2 * middle**2 + square**2, 1 - 2 * middle + square
