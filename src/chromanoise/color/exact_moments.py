"""Noise in a color space from the exact Poisson-Gaussian distribution of the electrons.

The result is also valid in the dark and with clipping: each channel follows the exact distribution
of its readout (`chromanoise.noise.poisson_gaussian_ppf`) with point masses at black and full well,
and the average over all channels uses randomized quasi-Monte Carlo nets.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import qr
from chromanoise._shapes import Bool, Float
from chromanoise.color.cubatures import cubature
from chromanoise.color.noisy_colors import ElectronSource, NoisyColor
from chromanoise.color.propagation import SpaceMoments
from chromanoise.color.spaces import Space
from chromanoise.errors import InputError
from chromanoise.noise import (
    NoiseSources,
    counted_readout,
    few_electrons,
    poisson_gaussian_ppf,
    read_values,
    sensor_moments,
)
from chromanoise.rng import stream

_NETS = 8  # each scrambled independently, to estimate the error
_SEED = 20191
_MOST_VALUES = 2**22  # points x channels of one net: some 250 MB for the eight
_CLIPPED = 1e-6  # share of readings, from which clipping is noticed in a color


def exact(color: NoisyColor, space: Space, *, points: int = 2**16) -> SpaceMoments:
    """Moments over the exact distribution of the electrons after readout; for `propagate`.

    Parameters
    ----------
    color
        A color with its source (`noisy_color`), or a few colors, which are computed one by one.
    space
        The color space.
    points
        Points per net, a power of 2; eight nets are used.

    Raises
    ------
    InputError
        If the color has no source, the white is not above 0, or ``points`` is not a power of 2 or
        too large.

    Notes
    -----
    Sobol' nets, scrambled by random matrices (Matousek, *J. Complexity* 14 (1998) 527), are mapped
    by the quantile function of each channel, after a rotation that aligns the first coordinate of
    the net with the first coordinate of the space, and so on (Imai & Tan, *J. Comput. Finance* 10
    (2006) 129). ``mean_error`` and ``sd_error`` are estimated from the nets: mostly below 3e-4 of a
    standard deviation for up to four channels, 3e-3 for sixteen in the dark.

    Examples
    --------
    Near black L* is linear, 903.3 Y: mean 0 and standard deviation 903.3 * 1e-6 * 10.

    >>> from chromanoise.color import LAB, noisy_color, propagate
    >>> from chromanoise.noise import NoiseSources
    >>> from chromanoise.sensor import PAPER_PIXEL
    >>> dark = ElectronSource(mean_e=np.zeros(1), matrix=np.full((3, 1), 1e-6),
    ...                       noise=NoiseSources(pixel=PAPER_PIXEL))
    >>> propagate(noisy_color(dark, np.ones(3)), LAB, exact).sd[0].round(6)
    np.float64(0.009033)
    """
    source = _source(color)
    channels = source.mean_e.shape[-1]
    most = _MOST_VALUES // max(1, channels * (1 + _has_cases(source)))
    if points < 2 or points & (points - 1) or points > most:
        raise InputError(
            "points",
            f"must be a power of 2 from 2 to {most} for {channels} channels",
            value=points,
        )
    rows = source.mean_e.reshape(-1, channels)
    noiseless = space.from_xyz(color.noiseless_xyz.reshape(-1, 3), color.white)
    found = []
    for row, center in zip(rows, noiseless, strict=True):
        turn = _turned(row, source, color.white, space)
        of = _seen(space, color.white, center)
        found.append(_moments(of, row, source, turn, points))
    px = source.mean_e.shape[:-1]
    bias, covariance, mean_error, sd_error = (
        np.stack(part).reshape(*px, *part[0].shape) for part in zip(*found, strict=True)
    )
    if not space.has_color_difference:
        return SpaceMoments(
            bias=bias, covariance=covariance, mean_error=mean_error, sd_error=sd_error
        )
    return SpaceMoments(
        bias=bias[..., :3],
        covariance=covariance[..., :3, :3],
        chroma_sd=np.asarray(np.sqrt(covariance[..., 3, 3])),
        chroma_bias=np.asarray(bias[..., 3]),
        delta_e=np.asarray(bias[..., 4]),
        mean_error=mean_error[..., :3],
        sd_error=sd_error[..., :3],
    )


def normal_fails(source: ElectronSource) -> Bool[Array, "*px"]:
    """Where a normal distribution of the readings is too inaccurate for the noise of a color.

    True with few electrons in a channel (`chromanoise.noise.few_electrons`), with a step of the
    converter that exceeds the noise, or with clipped readings; but not for sums of readings that
    are rounded coarsely, of which mean and variance alone are exact.

    Parameters
    ----------
    source
        Channels, noise and readout.
    """
    noise = source.noise
    coarse = noise.rounding_is_coarse(source.mean_e).any(axis=-1)
    found = few_electrons(source.mean_e, noise).any(axis=-1) | coarse
    if not math.isinf(source.readout.black_e) or not math.isinf(source.readout.full_well_e):
        read = sensor_moments(source.mean_e, source.noise, source.readout)
        found |= (read.black_share + read.full_share > _CLIPPED).any(axis=-1)
    return np.asarray(found & ~coarse if noise.readings > 1 else found)


def exact_where_needed(color: NoisyColor, space: Space, *, points: int = 2**11) -> SpaceMoments:
    """`exact` where `normal_fails`, and the cubature of a normal distribution elsewhere.

    Parameters
    ----------
    color, space, points
        As `exact`.

    Raises
    ------
    InputError
        As `exact`.
    """
    source, found = _source(color), cubature(color, space)
    for at in np.argwhere(normal_fails(source)):
        one = tuple(at.tolist())
        few = replace(
            color,
            xyz=replace(color.xyz, mean=color.xyz.mean[one], covariance=color.xyz.covariance[one]),
            source=replace(source, mean_e=source.mean_e[one]),
        )
        better = exact(few, space, points=points)
        found = replace(
            found,
            **{
                name: _with(getattr(found, name), one, value)
                for name in ("bias", "covariance", "chroma_sd", "chroma_bias", "delta_e")
                if (value := getattr(better, name)) is not None
            },
        )
    return found


def _with(values: Array, at: tuple[int, ...], value: Array) -> Array:
    changed = np.array(values)
    changed[at] = value
    return changed


def _source(color: NoisyColor) -> ElectronSource:
    if color.source is None:
        raise InputError(
            "source of the noisy color",
            "must be given for the exact method",
            found="is missing",
            remedy="make the color by noisy_color, or take the cubature",
        )
    return color.source


def _seen(space: Space, white: Array, still: Array) -> Callable[[Array], Array]:
    """Coordinates minus the noiseless ones, then the same of C*, then the color difference."""

    def seen(xyz: Array) -> Array:
        noisy = space.from_xyz(xyz, white)
        away = noisy - still
        if not space.has_color_difference:
            return away
        chroma = np.hypot(noisy[:, 1], noisy[:, 2]) - math.hypot(still[1], still[2])
        return np.column_stack([away, chroma, np.linalg.norm(away, axis=1)])

    return seen


def _moments(
    of: Callable[[Array], Array],
    mean_e: Float[Array, " p"],
    source: ElectronSource,
    turn: Float[Array, "p p"],
    points: int,
) -> tuple[Array, Array, Array, Array]:
    """Mean, covariance, and the standard errors of mean and standard deviation over the nets."""
    pattern, p = source.noise.pattern, mean_e.size
    several = _has_cases(source)
    net = _nets(p * (1 + several), points)
    normal = net[..., :p] @ turn.T
    for i in range(p):
        places = mean_e[i : i + 1] if pattern is None else pattern.means_e(mean_e, i)
        normal[..., i] = _read(normal[..., i], places, net[..., p + i] if several else None, source)
    means, covariances = [], []
    for read in normal:
        away = of(read @ source.matrix.T)
        means.append(away.mean(axis=0))
        away -= means[-1]  # the square of a net's own error is a millionth of the variance
        covariances.append(away.T @ away / points)
    covariance = np.mean(covariances, axis=0)
    sds = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
    mean_error, sd_error = (
        np.std(each, axis=0, ddof=1) / math.sqrt(_NETS) for each in (means, sds)
    )
    return np.mean(means, axis=0), 0.5 * (covariance + covariance.T), mean_error, sd_error


def _has_cases(source: ElectronSource) -> bool:
    """Whether a channel has places with different light, or levels of telegraph noise."""
    return source.noise.pattern is not None or len(_of_sum(source).shifts) > 1


def _of_sum(source: ElectronSource) -> NoiseSources:
    """The noise at one place, of readings that are summed taken as one."""
    return replace(source.noise, pattern=None, readings=1)


def _read(
    normal: Float[Array, "k n"],
    places_e: Float[Array, " m"],
    choice: Float[Array, "k n"] | None,
    source: ElectronSource,
) -> Float[Array, "k n"]:
    """Readings of one channel; a standard normal ``choice`` is its place and level."""
    from scipy.special import ndtr

    noise, found = _of_sum(source), np.empty_like(normal)
    counted, readout = counted_readout(places_e, noise, source.readout)
    added = np.sqrt(np.broadcast_to(noise.smooth.added_variance_e2(places_e), places_e.shape))
    cases = [
        (share / places_e.size, shift_e, mean, sd)
        for mean, sd in zip(counted.tolist(), added.tolist(), strict=True)
        for share, shift_e in noise.shifts
    ]
    ends = np.cumsum([share for share, *_ in cases])[:-1]
    chosen = 0 if choice is None else np.searchsorted(ends, ndtr(choice))
    for number, (_, shift_e, mean, sd) in enumerate(cases):
        here = np.broadcast_to(chosen == number, normal.shape)
        electrons = poisson_gaussian_ppf(normal[here], mean, read_noise_e=sd)
        found[here] = read_values(electrons + shift_e, readout)
    return found


def _turned(
    mean_e: Float[Array, " p"], source: ElectronSource, white: Float[Array, " 3"], space: Space
) -> Float[Array, "p p"]:
    """The rotation whose first column alone changes the first coordinate, and so on."""
    matrix = source.matrix
    if not np.all(_of_sum(source).smooth.added_variance_e2(mean_e)):
        return np.eye(mean_e.size)  # a net averages steps of single electrons best along its axes
    moments = sensor_moments(mean_e, source.noise, source.readout)
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
