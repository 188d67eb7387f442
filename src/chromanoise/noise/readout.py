"""One reading: counted electrons and normal noise, rounded to the codes of a converter and clipped.

`Readout` declares the values that a reading can have: the only lattice of raw codes. Moments,
distributions, quantiles and draws all take it from here.
"""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Int
from chromanoise.errors import InputError
from chromanoise.noise.counts import count_window, over_counts, over_counts_each
from chromanoise.noise.gaussian import FARTHEST, coded_moments, held_moments

_WIDE = 1.5  # read noise per step above which rounding adds step^2 / 12: exp(-2 pi^2 1.5^2) = 5e-20
_NEGLECTED = 1e-6  # of variance and mean: less than 1e-5 dB of an SNR
_MOST_ORDER = 10**9
_MOST_SUMMED_E = 1e8  # with more electrons a sum over counts takes seconds


@dataclass(frozen=True, slots=True, kw_only=True)
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
        _check.not_negative("step_e", "e-", self.step_e)
        _check.finite("offset_e", "e-", self.offset_e)


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
    mean = _check.non_negative("mean_e", "e-", mean_e)
    noise = np.broadcast_to(_check.non_negative("read_noise_e", "e-", read_noise_e), mean.shape)
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
    return lowest + readout.offset_e - margin, highest + readout.offset_e + margin


def _summed(
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
        found[:, of == i] = _summed(mean[of == i], noise[of == i], readout)
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
