"""The readout of Poisson electrons: noise, rounding and clipping, with exact moments.

One reading is counted electrons and normal noise, rounded to the codes of a converter and clipped.
`Readout` declares the values that a reading can have: the only lattice of raw codes. Moments,
distributions, quantiles and draws all take it from here. A known number of electrons gives a
clipped, rounded Gaussian; its moments, and those of any function, are averaged over the Poisson
distribution of the count.

A count has probability exp(peak(n) - deviance(n, M)), where the peak is the logarithm of the
probability of n at mean n, and the deviance is n log(n / M) + M - n. Both are accurate to rounding
for a million electrons, where exp(n log M - M - log n!) loses seven digits. C. Loader, "Fast and
accurate computation of binomial probabilities" (2000).
"""

import math
from collections.abc import Callable, Iterator

import numpy as np

from chromanoise.base import Array, Bool, Float, InputError, Int, check, dataclass

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
    _refuse_uncountable(mean_e)
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
    _refuse_uncountable(mean_e)
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


def _refuse_uncountable(mean_e: Float[Array, "*px p"]) -> None:
    check.shape("mean_e", mean_e, mean_e.size > 0, "must hold at least one channel to sum over")
    remedy = "take wider bounds and no step, or less light"
    refuse_many(mean_e, _MOST_E, "for an exact sum over electrons", remedy)


def refuse_many(mean_e: Float[Array, "*px p"], most_e: float, purpose: str, remedy: str) -> None:
    """Refuse more electrons than a computation can count."""
    largest = float(mean_e.max(initial=0.0))
    if largest > most_e:
        raise InputError(
            "mean_e",
            f"must be at most {most_e:g} [e-] {purpose}",
            value=largest,
            found=f"reaches {largest:g}",
            remedy=remedy,
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
    few = np.minimum(count, len(_LOG_PEAKS) - 1).astype(np.int64)
    many = np.maximum(count, 32.0)
    series = 1 / (12 * many) - 1 / (360 * many**3) + 1 / (1260 * many**5) - 1 / (1680 * many**7)
    stirling = -0.5 * np.log(2 * np.pi * many) - series
    return np.where(count < len(_LOG_PEAKS), _LOG_PEAKS[few], stirling)


_LOG_PEAKS = np.array([n * math.log(max(n, 1)) - n - math.lgamma(n + 1) for n in range(32)])


FARTHEST = 9.1
"""Number of standard deviations beyond which one tail of a Gaussian is below 1e-18."""

_MOST_CODES = 2**20


def held_moments(
    electrons: Float[Array, " m"],
    *,
    read_noise_e: float | Float[Array, " m"],
    black_e: float,
    full_well_e: float,
) -> Float[Array, "4 m"]:
    """Mean, variance, share below black and share above full well of n + s Z, clipped.

    Parameters
    ----------
    electrons
        n, the known number of electrons. [e-]
    read_noise_e
        s, >= 0; one number, or one above 0 per entry. [e-]
    black_e, full_well_e
        The bounds; they may be infinite. [e-]

    Notes
    -----
    The censored normal distribution (Tobin, *Econometrica* 26 (1958) 24), by partial moments about
    the point c of the range that is nearest to n, so that no large squares cancel.

    Examples
    --------
    Zero signal clipped at black: mean 1 / sqrt(2 pi) and variance (1 - 1 / pi) / 2.

    >>> held_moments(np.array([0.0]), read_noise_e=1.0, black_e=0.0, full_well_e=9e9).round(5)
    array([[0.39894],
           [0.34085],
           [0.5    ],
           [0.     ]])
    """
    center = np.clip(electrons, black_e, full_well_e)
    if np.ndim(read_noise_e) == 0 and read_noise_e == 0:
        sure = np.zeros_like(center)
        return np.stack([center, sure, electrons < black_e, electrons > full_well_e])
    from scipy.special import ndtr

    away = (center - electrons) / read_noise_e
    above, above_square = _capped_excess(away, (full_well_e - center) / read_noise_e)
    below, below_square = _capped_excess(-away, (center - black_e) / read_noise_e)
    shift = above - below
    variance = np.maximum(above_square + below_square - shift**2, 0.0)  # -1e-17 by rounding
    return np.stack(
        [
            center + read_noise_e * shift,
            read_noise_e**2 * variance,
            ndtr((black_e - electrons) / read_noise_e),
            ndtr((electrons - full_well_e) / read_noise_e),
        ]
    )


def _capped_excess(
    start: Float[Array, " m"], cap: Float[Array, " m"]
) -> tuple[Float[Array, " m"], Float[Array, " m"]]:
    """First and second moment of min(max(Z - start, 0), cap), where start >= 0 or cap = 0."""
    cap = np.minimum(cap, 40.0)  # above it the Gaussian is 0 in double precision
    once, twice = _excess(start)
    once_beyond, twice_beyond = _excess(start + cap)
    return once - once_beyond, twice - twice_beyond - 2 * cap * once_beyond


def _excess(start: Float[Array, " m"]) -> tuple[Float[Array, " m"], Float[Array, " m"]]:
    """First and second moment of max(Z - start, 0): phi - u Q, and (1 + u^2) Q - u phi."""
    from scipy.special import ndtr

    density = np.exp(-0.5 * start**2) / math.sqrt(2 * math.pi)
    tail = ndtr(-start)
    return density - start * tail, (1 + start**2) * tail - start * density


def coded_moments(
    electrons: Float[Array, " m"],
    *,
    read_noise_e: float,
    black_e: float,
    full_well_e: float,
    step_e: float,
) -> Float[Array, "4 m"]:
    """As `held_moments`, with n + s Z first rounded to the nearest multiple of a step.

    Parameters
    ----------
    electrons, read_noise_e, black_e, full_well_e
        As in `held_moments`. [e-]
    step_e
        Step, > 0; a value halfway between two multiples is rounded up. [e-]

    Raises
    ------
    InputError
        If the read noise spans more than a million steps.

    Notes
    -----
    Code k has the probability of (k - 1/2) step <= n + s Z < (k + 1/2) step.

    Examples
    --------
    Halfway between two codes, small noise gives either code: variance step^2 / 4.

    >>> coded_moments(np.array([1.0]), read_noise_e=1e-3, black_e=0.0, full_well_e=100.0,
    ...               step_e=2.0)[:2].round(9)
    array([[1.],
           [1.]])
    """
    reach = FARTHEST * read_noise_e / step_e
    if 2 * reach > _MOST_CODES:
        raise InputError(
            "step_e",
            f"must be at least {2 * FARTHEST / _MOST_CODES:.2g} of the read noise of "
            f"{read_noise_e:g} [e-]",
            value=step_e,
            remedy="take 0 for no rounding",
        )
    codes = 2 * math.ceil(reach) + 3
    rows = max(1, _ENTRIES // codes)
    slack = 1e-9 * step_e  # so that 3 * 0.1 does not exceed 0.3

    def coded(some: Float[Array, " r"]) -> Float[Array, "4 r"]:
        nearest = np.floor(some / step_e + 0.5)
        code = nearest[:, None] + np.arange(codes) - codes // 2
        multiple = code * step_e
        value = np.clip(multiple, black_e, full_well_e)
        share = _shares((code[:, 1:] - 0.5) * step_e - some[:, None], read_noise_e)
        middle = value[:, codes // 2]
        mean = middle + (share * (value - middle[:, None])).sum(axis=1)
        variance = (share * (value - mean[:, None]) ** 2).sum(axis=1)
        raised = (share * (multiple < black_e - slack)).sum(axis=1)
        lowered = (share * (multiple > full_well_e + slack)).sum(axis=1)
        return np.stack([mean, variance, raised, lowered])

    return _in_parts(coded, electrons, rows)


def _in_parts(
    of: Callable[[Float[Array, " r"]], Float[Array, "k r"]], values: Float[Array, " m"], rows: int
) -> Float[Array, "k m"]:
    """A function of many values, of so many at once as fit into memory."""
    parts = [of(values[i : i + rows]) for i in range(0, values.size, rows)]
    return np.concatenate(parts, axis=1)


def _shares(threshold_e: Float[Array, "m t"], read_noise_e: float) -> Float[Array, "m k"]:
    """Probability of each code between thresholds relative to n; the outer two are unbounded."""
    if read_noise_e == 0:
        below = (threshold_e > 0).astype(np.float64)  # n on a threshold takes the upper code
        above = 1.0 - below
    else:
        from scipy.special import ndtr

        below, above = ndtr(threshold_e / read_noise_e), ndtr(-threshold_e / read_noise_e)
    ends = np.ones_like(below[:, :1])
    from_below = np.diff(below, axis=1, prepend=0 * ends, append=ends)
    from_above = -np.diff(above, axis=1, prepend=ends, append=0 * ends)
    # the difference of the smaller tails, because 1 - 1e-20 rounds to 1
    upper = np.concatenate([0 * ends, threshold_e], axis=1) > 0
    return np.where(upper, from_above, from_below)


_PANELS = (-FARTHEST, -4.5, -1.5, 1.5, 4.5, FARTHEST)  # standard deviations
_NODES = 24  # per panel: exact to rounding for a Gaussian times a smooth function

Function = Callable[[Float[Array, " m"]], Float[Array, " m"]]


@dataclass(frozen=True, kw_only=True, eq=False)
class Expectation:
    """Mean and variance of a function of noisy electrons.

    Attributes
    ----------
    mean
        Mean, in the unit of the function.
    variance
        Variance, in that unit squared.
    """

    mean: Float[Array, "*px p"]
    variance: Float[Array, "*px p"]

    def __post_init__(self) -> None:
        check.finite("Expectation.mean", "unit of the function", self.mean)
        check.non_negative("Expectation.variance", "unit of the function^2", self.variance)
        check.freeze(self, "mean", "variance")


def expectation(
    function: Function,
    mean_e: Float[Array, "*px p"],
    *,
    read_noise_e: float,
    kinks_e: tuple[float, ...] = (),
) -> Expectation:
    """Mean and variance of function(Poisson(M) + s Z), without random samples or derivatives.

    Parameters
    ----------
    function
        Function from an array of noisy electrons, which may be negative, to one number each. [e-]
    mean_e
        Expected electrons M, >= 0. [e-]
    read_noise_e
        Standard deviation s of the readout, >= 0. [e-]
    kinks_e
        Points where the function is not smooth; the quadrature is split there. [e-]

    Raises
    ------
    InputError
        If a mean is negative, not finite or too large for a sum over electrons, or if the
        function does not give one finite number per value.

    Notes
    -----
    A sum over all counts except for tails of 1e-18, and Gauss-Legendre panels over the read noise:
    exact to rounding for a function that is smooth over 3 s between its kinks. A kink missing from
    ``kinks_e`` causes an error of about 1e-3 of its change of slope times s, a jump one of about a
    tenth of the jump times the probability of values within s of it.

    Examples
    --------
    A square: the mean is M + M^2 + s^2 = 1 + 1 + 4.

    >>> expectation(np.square, np.array([1.0]), read_noise_e=2.0).mean.round(9)
    array([6.])
    """
    mean = check.non_negative("mean_e", "e-", mean_e)
    noise = check.not_negative("read_noise_e", "e-", read_noise_e)
    kinks = check.finite("kinks_e", "e-", kinks_e)

    def given_count(count: Float[Array, " m"]) -> Float[Array, "2 m"]:
        if noise == 0:
            value = _values(function, count)
            return np.stack([value, np.zeros_like(value)])
        rows = max(1, _ENTRIES // (_NODES * (len(_PANELS) + kinks.size)))
        return _in_parts(lambda some: _smoothed(function, some, noise, kinks), count, rows)

    moments = over_counts(mean, given_count)
    return Expectation(mean=moments[0], variance=moments[1])


def _smoothed(
    function: Function, count: Float[Array, " m"], noise: float, kinks: Float[Array, " k"]
) -> Float[Array, "2 m"]:
    """Mean and variance over the read noise, for each count."""
    cuts = np.clip((kinks - count[:, None]) / noise, -FARTHEST, FARTHEST)
    edges = np.broadcast_to(np.array(_PANELS), (count.size, len(_PANELS)))
    edges = np.sort(np.concatenate([edges, cuts], axis=1), axis=1)
    node, weight = np.polynomial.legendre.leggauss(_NODES)
    half = np.diff(edges, axis=1)[..., None] / 2
    z = (edges[:, :-1, None] + half * (1 + node)).reshape(count.size, -1)
    weights = (half * weight).reshape(z.shape) * np.exp(-0.5 * z**2) / math.sqrt(2 * math.pi)
    weights /= weights.sum(axis=1, keepdims=True)
    electrons = count[:, None] + noise * z
    value = _values(function, electrons.ravel()).reshape(z.shape)
    mean = (weights * value).sum(axis=1)
    return np.stack([mean, (weights * (value - mean[:, None]) ** 2).sum(axis=1)])


def _values(function: Function, electrons: Float[Array, " m"]) -> Float[Array, " m"]:
    value = np.asarray(function(electrons), dtype=np.float64)
    if value.shape != electrons.shape:
        raise InputError(
            "function",
            f"must give one number per value, {electrons.shape}",
            value=value.shape,
            found=f"gives shape {value.shape}",
        )
    bad = np.flatnonzero(~np.isfinite(value))
    if bad.size:
        first = float(value[bad[0]])
        raise InputError(
            "function",
            "must be finite",
            value=first,
            found=f"is {first:g} at {electrons[bad[0]]:g} e-",
            remedy="extend it to every value that the noise can reach",
        )
    return value


_WIDE = 1.5  # read noise per step above which rounding adds step^2 / 12: exp(-2 pi^2 1.5^2) = 5e-20
_NEGLECTED = 1e-6  # of variance and mean: less than 1e-5 dB of an SNR
_MOST_ORDER = 10**9
_MOST_SUMMED_E = 1e8  # with more electrons a sum over counts takes seconds


@dataclass(frozen=True, kw_only=True)
class Readout:
    """The values that a channel can have after readout: those of the codes, in electrons.

    A value is clip(round(counted electrons + offset + noise)), so bounds and steps refer to values
    that include the offset. The black level of a converter is a whole code, so it does not shift
    the steps.

    Attributes
    ----------
    black_e
        Least value; -inf for a readout that keeps negative values. [e-]
    full_well_e
        Largest value; inf for a readout that never saturates. [e-]
    step_e
        Values are rounded to the nearest multiple, then clipped to the bounds; 0 for no rounding.
        [e-]
    offset_e
        Added to the counted electrons before rounding: the error of the black level minus the mean
        number of dark electrons (`counted_readout`). [e-]

    Raises
    ------
    InputError
        If black is not below full well, the step is negative, or step or offset is not finite.
    """

    black_e: float = float("-inf")
    full_well_e: float = float("inf")
    step_e: float = 0.0
    offset_e: float = 0.0

    def __post_init__(self) -> None:
        if not self.black_e < self.full_well_e:
            raise InputError(
                "black_e",
                f"must be below full_well_e of {self.full_well_e:g} [e-]",
                value=self.black_e,
            )
        check.not_negative("step_e", "e-", self.step_e)
        check.finite("offset_e", "e-", self.offset_e)


@dataclass(frozen=True, kw_only=True, eq=False)
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
        check.finite("Moments.mean", "e-", self.mean)
        check.non_negative("Moments.variance", "e-^2", self.variance)
        check.finite("Moments.bias", "e-", self.bias)
        check.fraction("Moments.black_share", "1", self.black_share)
        check.fraction("Moments.full_share", "1", self.full_share)
        check.freeze(self, "mean", "variance", "bias", "black_share", "full_share")


def read_moments(
    mean_e: Float[Array, "*px p"],
    *,
    read_noise_e: float | Float[Array, "*px p"],
    readout: Readout,
) -> Moments:
    """Exact moments of clipped(rounded(Poisson(M) + offset + s Z)), per channel.

    Parameters
    ----------
    mean_e
        Expected electrons M, >= 0. [e-]
    read_noise_e
        Standard deviation s of the readout, >= 0; one number, or one per entry. [e-]
    readout
        Bounds, step and offset.

    Raises
    ------
    InputError
        If a mean is negative or not finite, if a mean above 1e10 is close to a bound or is
        rounded coarsely, or if the step is less than 2e-5 of the read noise.

    Notes
    -----
    The result is a sum over counts of the moments of the censored normal distribution; the omitted
    probability is below 1e-17. If the probability of clipping is smaller, no sum is needed: the
    mean is M + offset and the variance M + s^2, plus step^2 / 12 if s is at least 1.5 steps (Widrow
    & Kollar, *Quantization Noise* (2008), section 4). If every value is clipped, the variance is 0.

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
    mean = check.non_negative("mean_e", "e-", mean_e)
    noise = np.broadcast_to(check.non_negative("read_noise_e", "e-", read_noise_e), mean.shape)
    lowest, highest = _reach(mean, noise, readout)
    always_black, always_full = highest < readout.black_e, lowest > readout.full_well_e
    summed = ~always_black & ~always_full
    smooth = noise >= _WIDE * readout.step_e
    summed &= ~smooth | (lowest < readout.black_e) | (highest > readout.full_well_e)
    free = np.zeros_like(mean)
    spread = mean + noise**2 + readout.step_e**2 / 12
    rows = np.stack([mean + readout.offset_e, spread, free, free])
    rows[:, always_black] = np.array([[readout.black_e], [0.0], [1.0], [0.0]])
    rows[:, always_full] = np.array([[readout.full_well_e], [0.0], [0.0], [1.0]])
    if summed.any():
        rows[:, summed] = _summed_codes(mean[summed], noise[summed], readout)
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
    return lowest + readout.offset_e - margin, highest + readout.offset_e + margin


def _summed_codes(
    mean: Float[Array, " m"], noise: Float[Array, " m"], readout: Readout
) -> Float[Array, "4 m"]:
    black, full, step = float(readout.black_e), float(readout.full_well_e), readout.step_e
    offset = readout.offset_e
    bounds = {"black_e": black, "full_well_e": full}
    if (noise == noise[0]).all():
        one = float(noise[0])

        def given_count(count: Float[Array, " m"]) -> Float[Array, "4 m"]:
            if step == 0:
                return held_moments(count + offset, read_noise_e=one, **bounds)
            return coded_moments(count + offset, read_noise_e=one, step_e=step, **bounds)

        return over_counts(mean, given_count)
    if step == 0 and (noise > 0).all():

        def given_counts(count: Float[Array, " w"], row: Int[Array, " w"]) -> Float[Array, "4 w"]:
            return held_moments(count + offset, read_noise_e=noise[row], **bounds)

        return over_counts_each(mean, given_counts)
    levels, of = np.unique(noise, return_inverse=True)
    found = np.empty((4, mean.size))
    for i in range(levels.size):
        found[:, of == i] = _summed_codes(mean[of == i], noise[of == i], readout)
    return found


def additive_rounding_fails(
    mean_e: Float[Array, "*px p"],
    *,
    counted_e: Float[Array, "*px p"],
    read_noise_e: Float[Array, "*px p"],
    step_e: float,
) -> Bool[Array, "*px p"]:
    """Where the effect of rounding is not just a variance of step^2 / 12 without bias.

    True where the neglected terms exceed a millionth of the variance, or of the mean.

    Parameters
    ----------
    mean_e
        Expected electrons of the light. [e-]
    counted_e
        Expected electrons that are counted, dark ones included. [e-]
    read_noise_e
        Standard deviation of the readout. [e-]
    step_e
        Electrons per code; 0 for no rounding. [e-]

    Notes
    -----
    The k-th neglected term has the size |phi(2 pi k / step)| of the characteristic function of the
    unrounded reading, exp(-M (1 - cos u) - s^2 u^2 / 2): about exp(-2 pi^2 sigma^2 / step^2) for
    k = 1 and a coarse step. Of the other terms only those with k near whole multiples of the step
    matter, because the noise does not smooth single electrons. Widrow & Kollar, *Quantization
    Noise* (2008), chapters 4, 5.

    Examples
    --------
    A step of 31 e- with 3.5 e- of noise, and one of 2 e-.

    >>> light, sd = np.array([3.0]), np.array([3.0])
    >>> [bool(additive_rounding_fails(light, counted_e=light, read_noise_e=sd, step_e=q)[0])
    ...  for q in (31.0, 2.0)]
    [True, False]
    """
    failing = np.zeros(np.shape(counted_e), dtype=bool)
    if not step_e:
        return failing
    variance = counted_e + read_noise_e**2
    shift, spread = np.zeros_like(variance), np.zeros_like(variance)
    orders = {1, *(round(j * step_e + d) for j in range(1, 5) for d in (-0.5, 0.0, 0.5))}
    for k in sorted(k for k in orders if 0 < k < _MOST_ORDER):
        u = 2 * np.pi * k / step_e
        size = np.exp(-counted_e * (1 - np.cos(u)) - 0.5 * (read_noise_e * u) ** 2)
        together = np.hypot(counted_e * np.sin(u), counted_e * (np.cos(u) - 1))
        shift += size * 2 / u
        spread += size * (2 / u) * (2 / u + 2 * (together + u * read_noise_e**2))
    moved = shift > _NEGLECTED * np.maximum(mean_e, 1e-3 * np.sqrt(variance))
    failing = moved | (spread > _NEGLECTED * (variance + step_e**2 / 12))
    return np.asarray(failing & (counted_e < _MOST_SUMMED_E))


def largest_code_share(
    mean_e: Float[Array, " m"],
    *,
    read_noise_e: Float[Array, " m"],
    readout: Readout,
    shifts: tuple[tuple[float, float], ...],
) -> Float[Array, " m"]:
    """Share of the readings that have the most frequent code, for steps far above the noise. [1]

    Parameters
    ----------
    mean_e, read_noise_e, readout
        As `read_moments`; the step is above 0.
    shifts
        As `chromanoise.noise.NoiseSources.shifts`.
    """
    from scipy.special import ndtr

    step, offset = readout.step_e, readout.offset_e
    middle = np.floor((mean_e + offset) / step + 0.5)
    sd = np.maximum(read_noise_e, 1e-9 * step)

    def given_counts(count: Float[Array, " w"], row: Int[Array, " w"]) -> Float[Array, "5 w"]:
        codes = middle[row] + np.array([[-1.5], [-0.5], [0.5], [1.5]])
        edges = codes * step - (count + offset)
        below = sum(share * ndtr((edges - shift_e) / sd[row]) for share, shift_e in shifts)
        return np.concatenate([np.zeros((2, count.size)), np.diff(below, axis=0)])

    return over_counts_each(mean_e, given_counts)[2:].max(axis=0)
