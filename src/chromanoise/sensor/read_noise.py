"""Read noise: its distribution, and how it depends on the gain.

Three laws: ELD's straight line of logarithms, noise before and after the gain, a measured table.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError

LEAST_LAMBDA, LARGEST_LAMBDA = -0.4, 0.8
"""Shapes of the Tukey lambda distribution that are sampled; its variance ends at -0.5."""

_LEAST_SHARE = 2.0**-33  # of a random word of 32 bits
_LOGISTIC = 1e-5  # shapes below it are taken as 0, the logistic distribution
MOST_E, MOST_DN = 1e9, 2.0**24
"""Largest noise. [e-], [DN]"""


def tukey_lambda_variance(shape: float) -> float:
    """Variance of the Tukey lambda distribution of scale 1, sampled with words of 32 bits. [1]

    Parameters
    ----------
    shape
        lambda: 0.14 is nearly normal, 0 the logistic distribution, below 0 the tails are heavy.

    Returns
    -------
    float
        Of the quantile function Q(u) = (u^lambda - (1 - u)^lambda) / lambda for the shares u from
        2^-33 to 1 - 2^-33, the only ones that a word of 32 bits gives. At lambda = -0.25 it is
        3e-5 below the variance of all shares.

    Raises
    ------
    InputError
        If the shape is not from -0.4 to 0.8.

    Notes
    -----
    Joiner & Rosenblatt, "Some properties of the range in samples from Tukey's symmetric lambda
    distributions", JASA 66 (1971) 394.

    Examples
    --------
    Near 0 it is the variance of the logistic distribution, pi^2 / 3.

    >>> round(tukey_lambda_variance(0.0), 4), round(math.pi**2 / 3, 4)
    (3.2899, 3.2899)
    """
    from scipy.special import beta, betainc

    at = _check.within("tail_lambda", "1", shape, LEAST_LAMBDA, LARGEST_LAMBDA)
    if abs(at) < _LOGISTIC:
        return math.pi**2 / 3
    low, high = _LEAST_SHARE, 1 - _LEAST_SHARE
    squares = (high ** (2 * at + 1) - low ** (2 * at + 1)) / (2 * at + 1)
    inside = float(betainc(at + 1, at + 1, high) - betainc(at + 1, at + 1, low))
    products = float(beta(at + 1, at + 1)) * inside
    return 2 * (squares - products) / at**2 / (high - low)


@dataclass(frozen=True, slots=True, kw_only=True)
class LogLinearNoise:
    """ELD's law of noise against gain: ln(noise) = slope ln(K) + bias + N(0, sigma^2).

    Attributes
    ----------
    slope, bias
        Of the straight line; K in DN/e-, the noise in DN. [1]
    sigma
        Standard deviation of ln(noise) about the line. [1]
    tukey_scale
        Whether the noise is the scale of a Tukey lambda distribution, not a standard deviation.

    Raises
    ------
    InputError
        If a number is not finite, or ``sigma`` is negative.

    Notes
    -----
    Wei, Fu, Yang & Huang, "A physics-based noise formation model for extreme low-light raw
    denoising", CVPR (2020), eq. 11.
    """

    slope: float
    bias: float
    sigma: float = 0.0
    tukey_scale: bool = False

    def __post_init__(self) -> None:
        _check.within("slope", "1", self.slope, -100, 100)
        _check.within("bias", "1", self.bias, -100, 100)
        _check.within("sigma", "1", self.sigma, 0, 100)

    def noise_dn(self, gain_dn_per_e: Float[Array, " p"], *, score: float = 0) -> Array:
        """The noise at a gain. [DN]

        Parameters
        ----------
        gain_dn_per_e
            Gain per channel. [DN/e-]
        score
            Deviation of ln(noise) from the line, in units of ``sigma``. [1]

        Returns
        -------
        (p,) array
        """
        return np.exp(self.slope * np.log(gain_dn_per_e) + self.bias + self.sigma * score)


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadNoiseSum:
    """Read noise before and after the gain: sigma_dn^2 = a + b K^2.

    Attributes
    ----------
    after_gain_dn
        Noise after the amplifier, mostly of the converter: the root of a, >= 0. [DN]
    before_gain_e
        Noise before the amplifier: the root of b, >= 0. [e-]

    Raises
    ------
    InputError
        If a number is negative or not finite.
    """

    after_gain_dn: float
    before_gain_e: float

    def __post_init__(self) -> None:
        _check.within("after_gain_dn", "DN", self.after_gain_dn, 0, MOST_DN)
        _check.within("before_gain_e", "e-", self.before_gain_e, 0, MOST_E)

    def noise_dn(self, gain_dn_per_e: Float[Array, " p"], *, score: float = 0) -> Array:
        """The read noise at a gain; it does not scatter, so ``score`` is not used. [DN]

        Parameters
        ----------
        gain_dn_per_e
            Gain per channel. [DN/e-]
        score
            As `LogLinearNoise.noise_dn`. [1]

        Returns
        -------
        (p,) array

        Examples
        --------
        >>> ReadNoiseSum(after_gain_dn=3.0, before_gain_e=2.0).noise_dn(np.array([2.0]))
        array([5.])
        """
        return np.hypot(self.after_gain_dn, self.before_gain_e * np.asarray(gain_dn_per_e))


def read_noise_sum(
    gain_dn_per_e: Float[Array, " n"], read_noise_dn: Float[Array, " n"]
) -> ReadNoiseSum:
    """The law sigma_dn^2 = a + b K^2 fitted to a table of read noise against gain.

    Parameters
    ----------
    gain_dn_per_e
        Two or more different gains. [DN/e-]
    read_noise_dn
        Read noise at each, > 0. [DN]

    Returns
    -------
    ReadNoiseSum
        The least-squares fit of the relative deviation of the variance, with a and b >= 0.

    Raises
    ------
    InputError
        If the lengths differ, a number is not above 0, or all gains are equal.

    Examples
    --------
    >>> fit = read_noise_sum(np.array([1.0, 2.0, 4.0]), np.sqrt([10.0, 13.0, 25.0]))
    >>> round(fit.after_gain_dn, 6), round(fit.before_gain_e, 6)
    (3.0, 1.0)
    """
    gain = above_zero("gain_dn_per_e", "DN/e-", gain_dn_per_e)
    noise = above_zero("read_noise_dn", "DN", read_noise_dn)
    _check.same_length("entries", gain_dn_per_e=gain.size, read_noise_dn=noise.size)
    if np.unique(gain).size < 2:
        raise InputError("gain_dn_per_e", "must have two different gains", value=gain.tolist())
    one, square = 1 / noise**2, (gain / noise) ** 2  # a one + b square = 1
    aa, ab, bb = one @ one, one @ square, square @ square
    a = (one.sum() * bb - square.sum() * ab) / (aa * bb - ab**2)
    b = (square.sum() * aa - one.sum() * ab) / (aa * bb - ab**2)
    if a < 0:
        a, b = 0.0, square.sum() / bb
    elif b < 0:
        a, b = one.sum() / aa, 0.0
    return ReadNoiseSum(after_gain_dn=float(np.sqrt(a)), before_gain_e=float(np.sqrt(b)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReadNoiseTable:
    """Measured noise of readout against gain, interpolated linearly in ln(noise) and ln(K).

    Attributes
    ----------
    gain_dn_per_e
        Two or more gains, increasing, > 0. [DN/e-]
    read_noise_dn
        Read noise at each gain, > 0. [DN]

    Raises
    ------
    InputError
        If the gains do not increase, a number is not above 0, or the lengths differ.
    """

    gain_dn_per_e: Float[Array, " n"]
    read_noise_dn: Float[Array, " n"]

    def __post_init__(self) -> None:
        gain = _check.increasing("gain_dn_per_e", "DN/e-", self.gain_dn_per_e)
        above_zero("gain_dn_per_e", "DN/e-", gain)
        noise = above_zero("read_noise_dn", "DN", self.read_noise_dn)
        _check.same_length("entries", gain_dn_per_e=gain.size, read_noise_dn=noise.size)
        object.__setattr__(self, "gain_dn_per_e", _check.frozen(gain))
        object.__setattr__(self, "read_noise_dn", _check.frozen(noise))

    def noise_dn(self, gain_dn_per_e: Float[Array, " p"], *, score: float = 0) -> Array:
        """The read noise at a gain; it does not scatter, so ``score`` is not used. [DN]

        Parameters
        ----------
        gain_dn_per_e
            Gain per channel. [DN/e-]
        score
            As `LogLinearNoise.noise_dn`. [1]

        Returns
        -------
        (p,) array

        Raises
        ------
        InputError
            If a gain is outside the table.

        Examples
        --------
        >>> table = ReadNoiseTable(gain_dn_per_e=np.array([1.0, 4.0]),
        ...                        read_noise_dn=np.array([2.0, 8.0]))
        >>> table.noise_dn(np.array([2.0])).round(6)
        array([4.])
        """
        gain = np.asarray(gain_dn_per_e, dtype=np.float64)
        low, high = self.gain_dn_per_e[0], self.gain_dn_per_e[-1]
        outside = (gain < low * (1 - 1e-9)) | (gain > high * (1 + 1e-9))
        if outside.any():
            first = float(gain[outside][0])
            raise InputError(
                "gain_dn_per_e",
                f"must be within the read-noise table, {low:g} to {high:g} [DN/e-]",
                value=first,
                remedy=("take another ISO", "fit the table with read_noise_sum"),
            )
        at = np.interp(np.log(gain), np.log(self.gain_dn_per_e), np.log(self.read_noise_dn))
        return np.exp(at)


ReadNoiseLaw = LogLinearNoise | ReadNoiseSum | ReadNoiseTable
"""How the read noise in DN depends on the gain."""


def above_zero(name: str, unit: str, values: Any) -> Array:
    """One-dimensional finite numbers > 0.

    Raises
    ------
    InputError
        If a number is not finite or not above 0.
    """
    array = np.atleast_1d(_check.non_negative(name, unit, values))
    if not (array > 0).all():
        at = int(np.argmin(array))
        raise InputError(
            name, f"must be finite and > 0 [{unit}]", value=float(array[at]), where=f"index ({at},)"
        )
    return array
