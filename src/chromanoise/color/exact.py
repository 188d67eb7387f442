"""Noise in curved spaces from the electrons themselves: right in the dark and when held.

The third route to the eye. It takes no normal law for granted: each channel follows the exact law
of its readout (`chromanoise.noise.electrons_of_normal`), point masses at black and full well
included, and the average over all channels at once is taken at the points of randomized nets.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import qr
from chromanoise._shapes import Float
from chromanoise.color.spaces import LAB, Space
from chromanoise.noise import (
    Measurement,
    Readout,
    electrons_of_normal,
    read_moments,
    read_values,
)
from chromanoise.rng import stream

UNBOUNDED = Readout()
"""A readout that keeps every value, as the paper's."""

_NETS = 8  # scrambled each for itself, so that they tell their own error
_SEED = 20191
_MOST_VALUES = 2**22  # points x channels of one net: some 250 MB for the eight


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ExactNoise:
    """What the eye makes of the true law of the readouts of one color, or of a few.

    Attributes
    ----------
    space
        Name of the space.
    still
        Coordinates of the expected electrons: the color without noise and without clipping.
    noisy
        Mean and covariance of the coordinates as they are read.
    bias
        Mean minus ``still``.
    mean_error, sd_error
        Standard error of this route's own mean and standard deviation per coordinate.
    chroma_sd, chroma_bias, delta_e
        Standard deviation of C*; mean of C* minus that of ``still``; mean CIE 1976 color
        difference to ``still``. ``None`` in a space where a distance is no color difference.
    """

    space: str
    still: Float[Array, "*px 3"]
    noisy: Measurement
    bias: Float[Array, "*px 3"]
    mean_error: Float[Array, "*px 3"]
    sd_error: Float[Array, "*px 3"]
    chroma_sd: Float[Array, "*px"] | None
    chroma_bias: Float[Array, "*px"] | None
    delta_e: Float[Array, "*px"] | None

    def __post_init__(self) -> None:
        _check.freeze(self, "still", "bias", "mean_error", "sd_error")
        if self.delta_e is not None:
            _check.freeze(self, "chroma_sd", "chroma_bias", "delta_e")


def exact_noise(
    mean_e: Float[Array, "*px p"],
    matrix: Float[Array, "3 p"],
    white: Float[Array, " 3"],
    *,
    read_noise_e: float,
    readout: Readout = UNBOUNDED,
    space: Space = LAB,
    points: int = 2**16,
) -> ExactNoise:
    """Mean, covariance and bias of a color as it is read, in a space that bends.

    Parameters
    ----------
    mean_e
        Expected electrons per channel, >= 0; one color, or a few, which are taken one by one. [e-]
    matrix
        From electrons to X, Y, Z, e.g. `ColorMatrix.matrix`. [lx/e-]
    white
        XYZ of a perfect white under the same light. [lx]
    read_noise_e
        Standard deviation of the readout, >= 0. [e-]
    readout
        Bounds and step; by default nothing is held or rounded.
    space
        Where to.
    points
        Per net, a power of 2; eight nets are taken.

    Raises
    ------
    InputError
        If a mean is negative or not finite, the matrix has not one column per channel, the white
        is not above 0, or ``points`` is not a power of 2 or too large.

    Notes
    -----
    Sobol' nets, scrambled by random matrices (Matousek, *J. Complexity* 14 (1998) 527), go through
    the quantile function of each channel, turned so that the first coordinate of the net carries
    the first of the space, and so on (Imai & Tan, *J. Comput. Finance* 10 (2006) 129).
    ``mean_error`` and ``sd_error`` come from the nets: mostly below 3e-4 of a standard deviation
    for up to four channels, 3e-3 for sixteen in the dark.

    Examples
    --------
    Far down in the toe L* is a line, 903.3 Y: mean 0 and standard deviation 903.3 * 1e-6 * 2.

    >>> dark = exact_noise(np.zeros(1), np.full((3, 1), 1e-6), np.ones(3), read_noise_e=2.0)
    >>> np.sqrt(dark.noisy.variance[0]).round(6)
    np.float64(0.001807)
    """
    electrons = _check.non_negative("mean_e", "e-", mean_e)
    _check.same_length("channels", mean_e=electrons.shape[-1], matrix=matrix.shape[1])
    most = _MOST_VALUES // max(1, electrons.shape[-1])
    if points < 2 or points & (points - 1) or points > most:
        raise _check.InputError(
            f"points must be a power of 2 from 2 to {most} for {electrons.shape[-1]} channels, "
            f"but is {points}"
        )
    rows = electrons.reshape(-1, electrons.shape[-1])
    still = space.from_xyz(rows @ matrix.T, white)
    with_color = space.coordinates[0] == "L*"
    found = []
    for row, center in zip(rows, still, strict=True):
        turn = _turned(row, matrix, white, read_noise_e, readout, space)
        of = _seen(space, white, center, with_color)
        found.append(_moments(of, row, matrix, read_noise_e, readout, turn, points))
    px = electrons.shape[:-1]
    shift, covariance, mean_error, sd_error = (
        np.stack(part).reshape(*px, *part[0].shape) for part in zip(*found, strict=True)
    )
    still = still.reshape(*px, 3)
    return _told(space, still, shift, covariance, mean_error, sd_error, with_color)


def _told(
    space: Space,
    still: Array,
    shift: Array,
    covariance: Array,
    mean_error: Array,
    sd_error: Array,
    with_color: bool,
) -> ExactNoise:
    chroma_sd = np.asarray(np.sqrt(covariance[..., 3, 3])) if with_color else None
    return ExactNoise(
        space=space.name,
        still=still,
        noisy=Measurement(
            mean=still + shift[..., :3],
            covariance=covariance[..., :3, :3],
            names=space.coordinates,
            kind=space.name,
            unit="1",
        ),
        bias=shift[..., :3],
        mean_error=mean_error[..., :3],
        sd_error=sd_error[..., :3],
        chroma_sd=chroma_sd,
        chroma_bias=np.asarray(shift[..., 3]) if with_color else None,
        delta_e=np.asarray(shift[..., 4]) if with_color else None,
    )


def _seen(space: Space, white: Array, still: Array, with_color: bool) -> Callable[[Array], Array]:
    """Coordinates less the still ones, then C* less the still one and the color difference."""

    def seen(xyz: Array) -> Array:
        noisy = space.from_xyz(xyz, white)
        away = noisy - still
        if not with_color:
            return away
        chroma = np.hypot(noisy[:, 1], noisy[:, 2]) - math.hypot(still[1], still[2])
        return np.column_stack([away, chroma, np.linalg.norm(away, axis=1)])

    return seen


def _moments(
    of: Callable[[Array], Array],
    mean_e: Float[Array, " p"],
    matrix: Float[Array, "3 p"],
    read_noise_e: float,
    readout: Readout,
    turn: Float[Array, "p p"],
    points: int,
) -> tuple[Array, Array, Array, Array]:
    """Mean, covariance, and the standard errors of mean and standard deviation over the nets."""
    normal = _nets(mean_e.size, points) @ turn.T
    for i, mean in enumerate(mean_e.tolist()):
        electrons = electrons_of_normal(normal[..., i], mean, read_noise_e=read_noise_e)
        normal[..., i] = read_values(electrons, readout)
    means, covariances = [], []
    for read in normal:
        away = of(read @ matrix.T)
        means.append(away.mean(axis=0))
        away -= means[-1]  # the square of a net's own error is a millionth of the variance
        covariances.append(away.T @ away / points)
    covariance = np.mean(covariances, axis=0)
    sds = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
    mean_error, sd_error = (
        np.std(each, axis=0, ddof=1) / math.sqrt(_NETS) for each in (means, sds)
    )
    return np.mean(means, axis=0), 0.5 * (covariance + covariance.T), mean_error, sd_error


def _turned(
    mean_e: Float[Array, " p"],
    matrix: Float[Array, "3 p"],
    white: Float[Array, " 3"],
    read_noise_e: float,
    readout: Readout,
    space: Space,
) -> Float[Array, "p p"]:
    """The rotation whose first column is all that moves the first coordinate, and so on."""
    if read_noise_e == 0:  # single electrons make jumps, which a net takes best along its axes
        return np.eye(mean_e.size)
    moments = read_moments(mean_e, read_noise_e=read_noise_e, readout=readout)
    slope = space.jacobian(matrix @ moments.mean, white)
    moving = slope @ matrix * np.sqrt(moments.variance)
    return np.asarray(qr(f"noise in {space.name}", moving.T, mode="complete")[0])


@lru_cache(maxsize=2)
def _nets(channels: int, points: int) -> Float[Array, "k n p"]:
    """Points of the scrambled nets as standard normal variables."""
    from scipy.special import ndtri
    from scipy.stats.qmc import Sobol

    nets = [
        Sobol(channels, scramble=True, bits=30, seed=stream(_SEED, channels, number)).random(points)
        for number in range(_NETS)
    ]
    return _check.frozen(ndtri(np.stack(nets) + 0.5**31))  # none at 0, whose quantile is infinite
