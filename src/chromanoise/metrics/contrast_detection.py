"""Contrast detection probability: how often two noisy patches show the contrast of the scene.

The published idea of the working group IEEE P2020 (Geese, Seger & Paolillo, "Detection
Probabilities: Performance Prediction for Sensors of Autonomous Vehicles", Electronic Imaging 2018,
AVM-148); no conformity is claimed.
"""

from typing import Literal, get_args

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.noise.distribution import ReadingDistribution

Contrast = Literal["weber", "michelson"]
"""(bright - dark) / dark, or (bright - dark) / (bright + dark)."""

_NODES = 256
_FARTHEST_SD = 9.0
_ROUNDING = 1e-9


def contrast_detection_probability(
    bright: Float[Array, "*m"],
    dark: Float[Array, "*m"],
    *,
    bright_sd: Float[Array, "*m"],
    dark_sd: Float[Array, "*m"],
    tolerance: float = 0.5,
    contrast: Contrast = "weber",
) -> Float[Array, "*m"]:
    """Probability P(|C - C0| <= tolerance C0) for two patches with independent Gaussian noise.

    C is the contrast of two readings and C0 that of their means. A reading whose contrast is not
    defined (no dark signal) does not count as detected.

    Parameters
    ----------
    bright, dark
        Means of the two patches in one unit, > 0 and different; they are exchanged where the first
        is darker.
    bright_sd, dark_sd
        Standard deviations of one reading, > 0, in the same unit.
    tolerance
        Relative tolerance of the contrast, > 0.
    contrast
        ``weber`` or ``michelson``.

    Raises
    ------
    InputError
        If a value is out of range.

    Examples
    --------
    Grays of 100 and 50 units with noise of 5: Weber contrast 1, detected between 0.5 and 1.5.

    >>> of = contrast_detection_probability(np.array(100.0), np.array(50.0),
    ...     bright_sd=np.array(5.0), dark_sd=np.array(5.0))
    >>> round(float(of), 3)
    0.966
    """
    first, second, first_sd, second_sd = np.broadcast_arrays(
        *(
            _check.non_negative(name, "1", values)
            for name, values in (
                ("bright", bright),
                ("dark", dark),
                ("bright_sd", bright_sd),
                ("dark_sd", dark_sd),
            )
        )
    )
    if not ((first_sd > 0).all() and (second_sd > 0).all()):
        smallest = float(min(first_sd.min(), second_sd.min()))
        raise InputError("bright_sd, dark_sd", "must be > 0", value=smallest)
    swapped = first < second
    high, low = np.where(swapped, second, first), np.where(swapped, first, second)
    high_sd, low_sd = np.where(swapped, second_sd, first_sd), np.where(swapped, first_sd, second_sd)
    least, most = _slopes(high, low, tolerance, contrast)
    from scipy.special import ndtr

    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    start = np.maximum(low - _FARTHEST_SD * low_sd, 0.0)
    half = (low + _FARTHEST_SD * low_sd - start) / 2
    at = start[..., None] + half[..., None] * (nodes + 1)
    density = np.exp(-0.5 * ((at - low[..., None]) / low_sd[..., None]) ** 2)
    density /= np.sqrt(2 * np.pi) * low_sd[..., None]
    upper, lower = (
        ndtr((slope[..., None] * at - high[..., None]) / high_sd[..., None])
        for slope in (most, least)
    )
    return np.asarray(half * ((upper - lower) * density @ weights))


def exact_contrast_detection_probability(
    readings: ReadingDistribution,
    mean_e: Float[Array, " 2"],
    *,
    tolerance: float = 0.5,
    contrast: Contrast = "weber",
) -> float:
    """`contrast_detection_probability` from the exact distribution of few electrons.

    Parameters
    ----------
    readings
        Distribution of one reading of a brighter (first) and a darker (second) patch.
    mean_e
        Expected electrons of both. [e-]
    tolerance, contrast
        As `contrast_detection_probability`.

    Raises
    ------
    InputError
        If the distribution does not have two rows, or a value is out of range.

    Examples
    --------
    Counts with means 2 and 1 show a contrast from 0.5 to 1.5 only as 2:1, 3:2, 4:2, 5:2 ...

    >>> from chromanoise.noise import NoiseSources, reading_distribution
    >>> from chromanoise.sensor import Pixel
    >>> pixel = Pixel(pitch_um=3, full_well_e=9000, read_noise_e=0.0)
    >>> means = np.array([2.0, 1.0])
    >>> counts = reading_distribution(means, NoiseSources(pixel=pixel))
    >>> round(exact_contrast_detection_probability(counts, means), 3)
    0.159
    """
    _check.same_length("patches", readings=len(readings.probability), mean_e=len(mean_e), pair=2)
    high, low = (np.asarray(one, dtype=np.float64) for one in mean_e)
    if high < low:
        raise InputError(
            "mean_e", "must be that of the brighter patch first", value=tuple(map(float, mean_e))
        )
    least, most = _slopes(high, low, tolerance, contrast)
    values = readings.values_e
    upto = np.concatenate([[0.0], np.cumsum(readings.probability[0])])
    width = readings.width_e
    share = np.clip((values + width / 2) / width, 0, 1) if width else (values > 0).astype(float)
    dark = readings.probability[1] * share  # of a cell around 0 the part above 0
    at = np.where(share < 1, (values + width / 2) / 2, values)
    lit = share > 0

    def below(limit: Float[Array, " x"], *, included: bool) -> Float[Array, " x"]:
        if width:
            edges = np.append(values - width / 2, values[-1] + width / 2)
            return np.interp(limit, edges, upto)
        room = _ROUNDING * np.abs(limit) * (1 if included else -1)
        return upto[np.searchsorted(values, limit + room, side="right" if included else "left")]

    between = below(most * at[lit], included=True) - below(least * at[lit], included=False)
    return float(np.clip(between @ dark[lit], 0.0, 1.0))


def _slopes(
    high: Float[Array, "*m"], low: Float[Array, "*m"], tolerance: float, contrast: Contrast
) -> tuple[Float[Array, "*m"], Float[Array, "*m"]]:
    """The bright reading must lie between these multiples of the dark one."""
    _check.positive("tolerance", "1", tolerance)
    _check.one_of("contrast", contrast, get_args(Contrast))
    if not (low > 0).all() or not (high > low).all():
        raise InputError(
            "the two patches",
            "must have signal and different means",
            value=(float(np.min(high)), float(np.min(low))),
        )
    if contrast == "weber":
        true = (high - low) / low
        return np.asarray(1 + (1 - tolerance) * true), np.asarray(1 + (1 + tolerance) * true)
    true = (high - low) / (high + low)
    least, most = (1 - tolerance) * true, (1 + tolerance) * true
    endless = most >= 1  # a negative dark reading has more; it is not detected
    upper = np.where(endless, np.inf, (1 + most) / np.where(endless, 1.0, 1 - most))
    return np.asarray((1 + least) / (1 - least)), np.asarray(upper)
