"""The quantile function of the exact Poisson-Gaussian distribution.

Rounding and clipping are monotonic, so they are applied to the quantile function itself, and point
masses at black or full well need no special case.
"""

from functools import lru_cache

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.noise.counts import count_law
from chromanoise.noise.gaussian import FARTHEST
from chromanoise.noise.readout import Readout
from chromanoise.noise.sources import NoiseSources

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
    mean = _check.not_negative("mean_e", "e-", mean_e)
    noise = _check.not_negative("read_noise_e", "e-", read_noise_e)
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
    light, readout, sd = noise.of_one_reading(np.array([mean_e]))
    counted = float(light[0] + noise.dark_e / noise.readings)
    ends = poisson_gaussian_ppf(np.array([-3.2905, 3.2905]), counted, read_noise_e=float(sd[0]))
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
    return _check.frozen(_normal_scores(below, above)), _check.frozen(electrons)


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
    """Share of the readouts below and above each value; far counts need no Gaussian."""
    from scipy.special import ndtr

    counts, shares = count_law(mean)
    near = min(counts.size, int(2 * FARTHEST * noise) + 2)
    first = np.ceil(electrons - FARTHEST * noise - counts[0]).astype(np.int64)
    first = np.clip(first, 0, counts.size - near)
    at = first[:, None] + np.arange(near)
    with np.errstate(over="ignore"):  # overflows to inf for a read noise of 1e-308 e-
        away = (electrons[:, None] - counts[at]) / noise
    upto = np.concatenate([[0.0], np.cumsum(shares)])
    onward = np.concatenate([np.cumsum(shares[::-1])[::-1], [0.0]])
    below = upto[first] + (shares[at] * ndtr(away)).sum(axis=1)
    above = onward[first + near] + (shares[at] * ndtr(-away)).sum(axis=1)
    return below, above


def _normal_scores(below: Float[Array, " t"], above: Float[Array, " t"]) -> Float[Array, " t"]:
    """Standard normal quantiles, each from the smaller tail, because 1 - 1e-20 rounds to 1."""
    from scipy.special import ndtri

    tail = np.clip(np.minimum(below, above), 1e-300, 0.5)
    return np.where(below < above, ndtri(tail), -ndtri(tail))
