"""Separation of two patches near black, from the exact distributions of their readings."""

from collections.abc import Sequence

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Integer
from chromanoise.errors import InputError
from chromanoise.noise.distribution import ReadingDistribution

_BINS = 2**15
_FARTHEST = 60.0  # a log likelihood ratio beyond it has a weight below e^-30
_LEAST_RANGE = 1e-6  # of the table, where two patches are equal
_NO_MASS = 1e-16  # of a value, which does not widen the table


def exact_separation_probability(
    channels: Sequence[ReadingDistribution], pairs: Integer[Array, "m 2"]
) -> Float[Array, " m"]:
    """Probability that an ideal reader names the right one of two patches, with independent noise.

    The patches are equally frequent; 0.5 is chance. The error is below 1e-5.

    Parameters
    ----------
    channels
        One per channel, with one row per patch; their noise is independent.
    pairs
        Indices of the two patches of each pair.

    Raises
    ------
    InputError
        If there is no channel, or the channels have different numbers of patches.

    Notes
    -----
    As `gaussian_separation_probability`: half the sum of e^(-|l|/2) g(l). The density
    sqrt(p q) of the logarithm l of the likelihood ratio is tabulated per channel; the density of
    the sum over the channels is their convolution, by fast Fourier transform. The table is as wide
    as the ratios of the pair, so that nearly equal patches have the same digits.

    Examples
    --------
    Counts with means 0 and 1: the reader errs on half of the zeros of the second, 1/(2e).

    >>> from chromanoise.noise import NoiseSources, reading_distribution
    >>> from chromanoise.sensor import Pixel
    >>> pixel = Pixel(pitch_um=3, full_well_e=9000, read_noise_e=0.0)
    >>> counts = reading_distribution(np.array([0.0, 1.0]), NoiseSources(pixel=pixel))
    >>> exact_separation_probability([counts], np.array([[0, 1]])).round(4)
    array([0.8161])
    """
    if not channels:
        raise InputError("channels", "must hold at least one channel", value=0)
    patches = {f"channel {i}": len(each.probability) for i, each in enumerate(channels)}
    _check.same_length("patches", **patches)
    error = [_error_probability(channels, int(i), int(j)) for i, j in pairs]
    return 1.0 - np.asarray(error, dtype=np.float64)


def _error_probability(channels: Sequence[ReadingDistribution], one: int, other: int) -> float:
    ratios = [_log_ratio(each.probability[one], each.probability[other]) for each in channels]
    widest = sum(np.abs(r[m > _NO_MASS]).max(initial=0.0) for r, m in ratios)
    farthest = float(np.clip(widest, _LEAST_RANGE, _FARTHEST))
    at = np.fft.fftfreq(_BINS, 1.0 / (2 * farthest))
    kernel = np.fft.rfft(np.exp(-0.5 * np.abs(at))).real
    spectrum = np.ones(kernel.size, dtype=complex)
    for ratio, mass in ratios:
        near = np.abs(ratio) <= farthest
        place = ratio[near] * (_BINS / (2 * farthest))
        below = np.floor(place).astype(np.int64)
        share = (place - below) * mass[near]
        table = np.bincount(below % _BINS, mass[near] - share, _BINS)
        table += np.bincount((below + 1) % _BINS, share, _BINS)
        spectrum *= np.fft.rfft(table)
    power = spectrum.real * kernel
    total = 2 * power.sum() - power[0] - power[-1]  # of both halves of the spectrum
    return float(np.clip(total / _BINS / 2, 0.0, 0.5))


def _log_ratio(
    p: Float[Array, " x"], q: Float[Array, " x"]
) -> tuple[Float[Array, " y"], Float[Array, " y"]]:
    """Logarithm of p / q where both are above 0, and the root of p q."""
    both = (p > 0) & (q > 0)
    return np.log(p[both]) - np.log(q[both]), np.sqrt(p[both]) * np.sqrt(q[both])
