"""Averages over the Poisson distribution of moments that are known per count.

A count has probability exp(peak(n) - deviance(n, M)), where the peak is the logarithm of the
probability of n at mean n, and the deviance is n log(n / M) + M - n. Both are accurate to rounding
for a million electrons, where exp(n log M - M - log n!) loses seven digits. C. Loader, "Fast and
accurate computation of binomial probabilities" (2000).
"""

import math
from collections.abc import Callable, Iterator

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float, Int
from chromanoise.errors import InputError

_LOG_TAIL = -math.log(1e-18)  # each omitted tail has a probability below 1e-18
_MOST_E = 1e10  # above it one sum has more than two million terms
_ENTRIES = 2**18  # of the table means x counts in memory


def count_window(
    mean_e: Float[Array, "*px p"],
) -> tuple[Float[Array, "*px p"], Float[Array, "*px p"]]:
    """Range of Poisson counts for these means; each omitted tail is below 1e-18. [e-]

    Notes
    -----
    Chernoff and Bernstein: P(N <= M - t) <= exp(-t^2 / (2 M)) and
    P(N >= M + t) <= exp(-t^2 / (2 (M + t / 3))); Boucheron, Lugosi & Massart, *Concentration
    Inequalities* (2013), sections 2.2 and 2.8.
    """
    spread = 2 * _LOG_TAIL * mean_e
    skew = _LOG_TAIL / 3
    lowest = np.floor(np.maximum(mean_e - np.sqrt(spread), 0.0))
    return lowest, np.ceil(mean_e + skew + np.sqrt(skew**2 + spread))


def count_law(mean_e: float) -> tuple[Float[Array, " m"], Float[Array, " m"]]:
    """Counts of `count_window` for one mean, and the Poisson probability of each.

    Examples
    --------
    >>> counts, shares = count_law(1.0)                           # 1/e for 0 and for 1
    >>> shares[:2].round(5)
    array([0.36788, 0.36788])
    """
    lowest, highest = count_window(np.array([mean_e]))
    counts = np.arange(lowest[0], highest[0] + 1)
    return counts, _weights(np.array([mean_e]), counts, np.arange(counts.size)[None])[0]


def over_counts(
    mean_e: Float[Array, "*px p"],
    given_count: Callable[[Float[Array, " m"]], Float[Array, "k m"]],
) -> Float[Array, "k *px p"]:
    """Mean, variance and other averages over Poisson counts, from values per count.

    Parameters
    ----------
    mean_e
        Means of the Poisson distributions, >= 0. Equal means are computed once. [e-]
    given_count
        Function from m counts to the mean, the variance, and any other quantities to average.

    Raises
    ------
    InputError
        If ``mean_e`` is empty, or a mean is too large for a sum over single electrons.

    Notes
    -----
    Law of total variance, var = E var(. | n) + var E(. | n): all terms are squares, so there is no
    cancellation when a variance is far below the square of the mean.

    Examples
    --------
    Without further noise the electrons are Poisson: mean 3, variance 3.

    >>> moments = over_counts(np.array([3.0]), lambda n: np.stack([n, np.zeros_like(n)]))
    >>> moments.round(12)
    array([[3.],
           [3.]])
    """
    _refuse_many(mean_e)
    means, back = np.unique(mean_e, return_inverse=True)
    parts = [_summed(means[rows], given_count) for rows in _runs(means)]
    return np.concatenate(parts, axis=1)[:, back.reshape(mean_e.shape)]


def over_counts_each(
    mean_e: Float[Array, " m"],
    given_counts: Callable[[Float[Array, " w"], Int[Array, " w"]], Float[Array, "k w"]],
) -> Float[Array, "k m"]:
    """As `over_counts`, where the values per count differ between the means.

    Parameters
    ----------
    mean_e
        Means of the Poisson distributions, >= 0. [e-]
    given_counts
        Function from counts, and the index of the mean of each, to the mean, the variance, and any
        other quantities to average.

    Raises
    ------
    InputError
        As `over_counts`.
    """
    _refuse_many(mean_e)
    lowest, highest = count_window(mean_e)
    order = np.argsort(highest - lowest)  # rows of similar width share a table
    parts, first = [], 0
    while first < order.size:
        rows = order[first : first + max(1, int(_ENTRIES // (highest - lowest)[order[first:]][0]))]
        width = int((highest - lowest)[rows].max()) + 1
        rows = rows[: max(1, _ENTRIES // width)]
        width = int((highest - lowest)[rows].max()) + 1
        count = lowest[rows][:, None] + np.arange(width)
        at = np.arange(count.size).reshape(count.shape)
        weights = _weights(mean_e[rows], count.ravel(), at)
        given = given_counts(count.ravel(), np.repeat(rows, width)).reshape(-1, *count.shape)
        parts.append(_averaged(weights, given))
        first += rows.size
    found = np.concatenate(parts, axis=1)
    return found[:, np.argsort(order)]


def _refuse_many(mean_e: Float[Array, "*px p"]) -> None:
    if mean_e.size == 0:
        raise InputError(
            "mean_e",
            "must hold at least one channel to sum over",
            value=mean_e.shape,
            found=f"has shape {mean_e.shape}",
        )
    if mean_e.max() > _MOST_E:
        most = float(mean_e.max())
        raise InputError(
            "mean_e",
            f"must be at most {_MOST_E:g} [e-] for an exact sum over electrons",
            value=most,
            found=f"reaches {most:g}",
            remedy="take wider bounds and no step, or less light",
        )


def _averaged(weights: Float[Array, "u w"], given: Float[Array, "k u w"]) -> Float[Array, "k u"]:
    mean = (weights * given[0]).sum(axis=1)
    between = (weights * (given[0] - mean[:, None]) ** 2).sum(axis=1)
    averages = [(weights * row).sum(axis=1) for row in given[1:]]
    return np.stack([mean, averages[0] + between, *averages[1:]])


def _runs(means: Float[Array, " u"]) -> Iterator[slice]:
    """Groups of means whose count windows overlap and fit one table."""
    lowest, highest = count_window(means)
    gaps = 1 + np.flatnonzero(lowest[1:] > highest[:-1] + 1)
    for start, stop in zip([0, *gaps.tolist()], [*gaps.tolist(), means.size], strict=True):
        rows = max(1, int(_ENTRIES // (highest[stop - 1] - lowest[stop - 1] + 1)))
        for first in range(start, stop, rows):
            yield slice(first, min(first + rows, stop))


def _summed(
    means: Float[Array, " u"],
    given_count: Callable[[Float[Array, " m"]], Float[Array, "k m"]],
) -> Float[Array, "k u"]:
    lowest, highest = count_window(means)
    width = int((highest - lowest).max()) + 1
    lattice = np.arange(lowest[0], lowest[-1] + width)
    at = (lowest - lowest[0]).astype(np.int64)[:, None] + np.arange(width)
    weights = _weights(means, lattice, at)
    given = given_count(lattice)
    return _averaged(weights, given[:, at])


def _weights(
    means: Float[Array, " u"], lattice: Float[Array, " m"], at: Int[Array, "u w"]
) -> Float[Array, "u w"]:
    """Poisson probabilities of the counts ``lattice[at]``, one row per mean."""
    count, mean = lattice[at], means[:, None]
    some = np.maximum(count, 1.0)
    excess = (mean - some) / some
    with np.errstate(divide="ignore"):  # log 0 = -inf: without light the count is 0
        far = np.log(mean / some)
    near = np.log1p(np.maximum(excess, -0.5))
    deviance = some * (excess - np.where(np.abs(excess) < 0.5, near, far))
    weights = np.exp(_log_peak(lattice)[at] - np.where(count == 0, mean, deviance))
    return weights / weights.sum(axis=1, keepdims=True)


def _log_peak(count: Float[Array, " m"]) -> Float[Array, " m"]:
    """Logarithm of the Poisson probability of n at mean n, n^n e^-n / n!."""
    from scipy.special import gammaln, xlogy

    few = np.minimum(count, 32.0)
    many = np.maximum(count, 32.0)
    series = 1 / (12 * many) - 1 / (360 * many**3) + 1 / (1260 * many**5) - 1 / (1680 * many**7)
    stirling = -0.5 * np.log(2 * np.pi * many) - series
    return np.where(count < 32, xlogy(few, few) - few - gammaln(few + 1), stirling)
