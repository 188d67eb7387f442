"""One reading: counted electrons and normal noise, rounded to the codes of a converter and clipped.

`Readout` declares the values that a reading can have: the only lattice of raw codes. Moments,
distributions, quantiles and draws all take it from here.
"""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Int
from chromanoise.errors import InputError
from chromanoise.noise.counts import count_window, over_counts, over_counts_each
from chromanoise.noise.gaussian import FARTHEST, coded_moments, held_moments

_WIDE = 1.5  # read noise per step above which rounding adds step^2 / 12: exp(-2 pi^2 1.5^2) = 5e-20


@dataclass(frozen=True, slots=True, kw_only=True)
class Readout:
    """The values that a channel can have after readout: those of the codes, in electrons.

    A value is clip(round(counted electrons + offset + noise)): bounds and steps are those of the
    values after the offset. The black level of a converter is a whole code, so it moves no step.

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
    A sum over counts of the moments of the censored normal distribution; the omitted probability is
    below 1e-17. Where the probability of clipping is below this, no sum is needed: the moments are
    M + offset and M + s^2, plus step^2 / 12 where s is at least 1.5 steps (Widrow & Kollar,
    *Quantization Noise* (2008), section 4). Where every value is clipped, the variance is 0.

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
