"""Variance stabilization: planes of unit noise, for methods that expect white Gaussian noise.

The generalized Anscombe transform with the sensitivity of the pixels folded in, and its exact
unbiased inverse.
"""

from functools import lru_cache

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float, Float32
from chromanoise.denoising.planes import NoisyPlanes
from chromanoise.errors import InputError

_EXACT_COUNTS = 400.0  # mean counts up to which the expectation is summed
_MEANS = 48
_SDS, _STEPS = 6.0, 121  # of the Gaussian part: reach and number of nodes


def stabilized(planes: NoisyPlanes) -> Float[Array, "h w p"]:
    """Values with a variance of about 1 at every signal. [1]

    Parameters
    ----------
    planes
        Noisy values and their noise.

    Raises
    ------
    InputError
        If a plane has neither a noise floor nor shot noise.

    Notes
    -----
    The integral of 1 / (variance at the mean m)^(1/2), with 3/8 slope^2 added to the floor. Without
    PRNU this is the generalized Anscombe transform (Starck, Murtagh & Bijaoui, "Image processing
    and data analysis", 1998, eq. 1.61) up to a constant. The variance of PRNU, which differs from
    pixel to pixel independently, is folded in as its part that grows with m^2; this makes the
    transform grow logarithmically where PRNU dominates. Values at which the variance of the formula
    would be negative count as those at which it is 0, as in the reference.

    Measured with 400,000 draws each: the standard deviation is 0.97 to 1.05 at any signal for a
    read noise of 1 to 10 e-, 1.00 +- 0.01 from 10 e- of signal on, and falls to 0 with the signal
    where there is no read noise.

    Examples
    --------
    Without PRNU, twice the root of the electrons plus 3/8 and the variance of the readout.

    >>> planes = NoisyPlanes(
    ...     values_e=np.array([[[0.0], [96.0]]], np.float32), floor_e2=np.array([3.625]),
    ...     slope_e=np.ones(1), prnu=np.zeros(1), prior_e2=np.eye(1), prior_mean_e=np.ones(1),
    ...     names=("W",))
    >>> stabilized(planes).ravel()                                          # 2 (10 - 2)
    array([ 0., 16.])
    """
    out = np.empty(planes.values_e.shape)
    for i, law in enumerate(_laws(planes)):
        out[..., i] = _forward(planes.values_e[..., i].astype(np.float64), *law)
    return out


def unstabilized(stable: Float[Array, "h w p"], planes: NoisyPlanes) -> Float32[Array, "h w p"]:
    """Exact unbiased inverse of `stabilized`: the mean of the values before it. [e-]

    Parameters
    ----------
    stable
        Denoised values of `stabilized`: estimates of the mean of the stabilized values. [1]
    planes
        The planes that were stabilized.

    Notes
    -----
    Makitalo & Foi, "Optimal inversion of the generalized Anscombe transformation for
    Poisson-Gaussian noise", IEEE Trans. Image Process. 22 (2013) 91. The expectation is summed up
    to 400 counts, not approximated; above, the asymptotic inverse agrees within 1e-3 e-. The
    algebraic inverse continues below the expectation of no signal, so that residual noise around
    0 is not clipped, which would brighten dark areas.
    """
    out = np.empty(stable.shape, np.float32)
    for i, law in enumerate(_laws(planes)):
        expected, bias_e = _biases(*law)
        algebraic = _inverse(stable[..., i], *law)
        out[..., i] = algebraic + np.interp(stable[..., i], expected, bias_e)
    return out


def _laws(planes: NoisyPlanes) -> list[tuple[float, float, float]]:
    """Floor, slope and PRNU of each plane, checked."""
    columns = (planes.floor_e2, planes.slope_e, planes.prnu)
    laws = [tuple(float(v) for v in law) for law in zip(*columns, strict=True)]
    for name, law in zip(planes.names, laws, strict=True):
        if not law[0] + law[1] > 0:
            raise InputError(
                f"noise of plane {name}",
                "must be above 0 without signal, or be shot noise, to be stabilized",
                value=law[0],
                remedy="give a read noise above 0",
            )
    return laws  # type: ignore[return-value]


def _floor(floor: float, slope: float) -> float:
    return floor + 0.375 * slope**2


def _forward(y: Array, floor: float, slope: float, prnu: float) -> Array:
    """The integral of 1 / sd from 0 to y: 2 artanh(prnu y / (sd(y) + sd(0))) / prnu."""
    c, a = _floor(floor, slope), prnu**2
    discriminant = slope**2 - 4 * a * c
    if slope > 0 and discriminant >= 0:
        y = np.maximum(y, -2 * c / (slope + np.sqrt(discriminant)))
    sd = np.sqrt(np.maximum((a * y + slope) * y + c, 0.0))
    half = y / (sd + np.sqrt(c))
    return 2 * (np.arctanh(prnu * half) / prnu if prnu else half)


def _inverse(z: Array, floor: float, slope: float, prnu: float) -> Array:
    """The value whose `_forward` is ``z``, continued to all z."""
    half = np.tanh(prnu * z / 2) / prnu if prnu else z / 2
    least = -np.sqrt(_floor(floor, slope)) / slope if slope else -np.inf
    half = np.maximum(half, least)
    top = half * (2 * np.sqrt(_floor(floor, slope)) + slope * half)
    return np.asarray(top / (1 - (prnu * half) ** 2))


@lru_cache(maxsize=64)
def _biases(floor: float, slope: float, prnu: float) -> tuple[Array, Array]:
    """Expectations of stabilized values, rising, and mean minus algebraic inverse at each."""
    counts = np.concatenate([[0.0], np.geomspace(0.01, _EXACT_COUNTS, _MEANS)])
    scale = slope or np.sqrt(floor)
    means = counts * scale
    expected = [_expected(m, floor, slope, prnu) for m in means]
    far = scale * np.geomspace(1.02 * _EXACT_COUNTS, 1e9, 2 * _MEANS)
    variance = (prnu**2 * far + slope) * far + floor
    curvature = (2 * prnu**2 * far + slope) / (2 * (variance + 0.375 * slope**2))
    far_bias = 0.5 * variance * curvature
    z = np.array([*expected, *_forward(far - far_bias, floor, slope, prnu)])
    bias = np.concatenate([means - _inverse(np.array(expected), floor, slope, prnu), far_bias])
    return z, bias


def _expected(mean: float, floor: float, slope: float, prnu: float) -> float:
    """Expectation of the stabilized values of a mean: Poisson counts, and a Gaussian for the rest.

    The Gaussian has the variance of the readout and of PRNU.
    """
    from scipy.special import gammaln, xlogy

    at = np.linspace(-_SDS, _SDS, _STEPS)
    weights = np.exp(-0.5 * at**2)
    weights /= weights.sum()
    values = np.sqrt(floor + (prnu * mean) ** 2) * at
    if slope == 0:
        return float(weights @ _forward(mean + values, floor, slope, prnu))
    rate = mean / slope
    k = np.arange(int(rate + 10 * np.sqrt(rate) + 20))
    probability = np.exp(xlogy(k, rate) - rate - gammaln(k + 1))
    stable = _forward(slope * k[:, None] + values, floor, slope, prnu)
    return float(probability @ stable @ weights)
