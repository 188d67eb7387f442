"""Averages over three jointly normal variables, by fixed points instead of draws."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import eigh
from chromanoise._shapes import Float

_VALUES_PER_CHUNK = 500_000  # cubature points at once: some 50 MB, however large the picture
_EMPTY = 64 * np.finfo(float).eps  # eigenvalues below this share of the largest are rounding


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Cubature:
    """Points and weights that stand for three independent standard normal variables.

    Attributes
    ----------
    points
        One row per point.
    weights
        > 0, sum 1.
    """

    points: Float[Array, "n 3"]
    weights: Float[Array, " n"]

    def __post_init__(self) -> None:
        _check.same_length("points", points=len(self.points), weights=self.weights.size)
        _check.freeze(self, "points", "weights")


def gaussian_cubature(*, radii: int = 16, latitudes: int = 8, longitudes: int = 32) -> Cubature:
    """A product rule over the sphere for three standard normal variables.

    Along a ray from the mean even a color difference, the length of a vector, is smooth, and the
    hemispheres part at the equator of the first axis, so a difference that only this axis makes is
    averaged exactly too. The Gauss-Hermite product misses such means by .6 % with 8000 points.

    Parameters
    ----------
    radii
        Gauss points for the radius, whose density is r^2 exp(-r^2 / 2).
    latitudes
        Gauss-Legendre points per hemisphere, along the first axis.
    longitudes
        Equal steps around the first axis, turned from ring to ring.

    Raises
    ------
    InputError
        If a count is below 2.

    Notes
    -----
    A. H. Stroud, Approximate Calculation of Multiple Integrals (1971), 2.6-2.7. Polynomials are
    exact up to the smallest of 2 radii - 1, 2 latitudes - 1, longitudes - 1.

    Examples
    --------
    >>> rule = gaussian_cubature(radii=4, latitudes=3, longitudes=6)
    >>> (rule.points.T * rule.weights @ rule.points).round(12) + 0.0      # unit covariance
    array([[1., 0., 0.],
           [0., 1., 0.],
           [0., 0., 1.]])
    """
    for name, count in (("radii", radii), ("latitudes", latitudes), ("longitudes", longitudes)):
        if count < 2:
            raise _check.InputError(f"{name} of a cubature must be at least 2, but is {count}")
    return _gaussian_cubature(radii, latitudes, longitudes)


def gaussian_expectation(
    of: Callable[[Array], Array],
    mean: Float[Array, "*px 3"],
    covariance: Float[Array, "*px 3 3"],
    *,
    rule: Cubature | None = None,
) -> Float[Array, "*px q"]:
    """Mean of a function of three jointly normal variables.

    Parameters
    ----------
    of
        Takes values [..., 3] and gives [..., q].
    mean, covariance
        Of the variables; the covariance may be singular.
    rule
        By default `gaussian_cubature`.

    Raises
    ------
    InputError
        If mean or covariance is not finite, or a variance is negative in some direction.

    Examples
    --------
    >>> mean_of_squares = gaussian_expectation(np.square, np.ones(3), np.diag([1.0, 4.0, 0.0]))
    >>> mean_of_squares.round(9)                                  # mean^2 + variance
    array([2., 5., 1.])
    """
    centers = _check.finite("mean", "1", mean)
    root = covariance_root(_check.finite("covariance", "1", covariance), np.ones(3))
    found, _ = gaussian_moments(
        lambda values, center: of(values), centers, root, rule or gaussian_cubature()
    )
    return found


def covariance_root(covariance: Float[Array, "*px 3 3"], scale: Float[Array, " 3"]) -> Array:
    """A square root by eigenvalues, columns by size; what is rounding only becomes zero.

    Taken in units of ``scale``: the white, so that noise common to X, Y, Z is one clean direction.
    """
    values, vectors = eigh(
        "covariance relative to the white", covariance / (scale[:, None] * scale)
    )
    largest = np.abs(values).max(axis=-1, keepdims=True)
    if (values < -1e-6 * largest).any():
        raise _check.InputError(
            f"a covariance must have no negative variance in any direction, but {values.min():g} "
            "is one (in units of the white squared); check how it was put together"
        )
    kept = values > _EMPTY * largest
    root = vectors * np.sqrt(np.where(kept, values, 0.0))[..., None, :]
    return scale[:, None] * root[..., ::-1]


def gaussian_moments(
    of: Callable[[Array, Array], Array],
    mean: Float[Array, "*px 3"],
    root: Float[Array, "*px 3 3"],
    rule: Cubature,
) -> tuple[Array, Array]:
    """Mean and covariance of ``of(values [m n 3], center [m 1 3])`` [m n q] over the Gaussian."""
    centers, roots = mean.reshape(-1, 1, 3), root.reshape(-1, 3, 3)
    step = max(1, _VALUES_PER_CHUNK // rule.weights.size)
    means, covariances = [], []
    for start in range(0, max(1, len(centers)), step):
        center = centers[start : start + step]
        values = center + rule.points @ np.swapaxes(roots[start : start + step], -1, -2)
        still = of(center, center)  # taken off first: a bias is small beside a coordinate
        away = of(values, center) - still
        shift = (rule.weights @ away)[:, None]
        away = away - shift
        means.append((still + shift)[:, 0])
        covariances.append(np.swapaxes(away, -1, -2) @ (rule.weights[:, None] * away))
    px = mean.shape[:-1]
    first, second = np.concatenate(means), np.concatenate(covariances)
    return first.reshape(*px, *first.shape[1:]), second.reshape(*px, *second.shape[1:])


@cache
def _gaussian_cubature(radii: int, latitudes: int, longitudes: int) -> Cubature:
    r, r_weight = _radius_rule(radii)
    c, c_weight = np.polynomial.legendre.leggauss(latitudes)
    c, c_weight = (c + 1) / 2, c_weight / 2  # one hemisphere
    i, j, k = np.indices((radii, latitudes, longitudes)).reshape(3, -1)
    turn = (i * latitudes + j) / 1.618034  # golden: no two rings share a meridian
    angle = 2 * np.pi * (k + turn) / longitudes
    ring = np.sqrt(1 - c[j] ** 2)
    direction = np.stack([c[j], ring * np.cos(angle), ring * np.sin(angle)], axis=-1)
    points, weights = r[i, None] * direction, r_weight[i] * c_weight[j] / (2 * longitudes)
    weights = np.concatenate([weights, weights])
    return Cubature(points=np.concatenate([points, -points]), weights=weights / weights.sum())


def _radius_rule(count: int) -> tuple[Array, Array]:
    """Gauss points for the length of three standard normals (Stieltjes, then Golub-Welsch)."""
    r, weight = np.polynomial.legendre.leggauss(400)
    r, weight = 7 * (r + 1), weight * (7 * (r + 1)) ** 2 * np.exp(-((7 * (r + 1)) ** 2) / 2)
    weight = weight / weight.sum()
    before, now = np.zeros_like(r), np.ones_like(r)
    centers, widths, square = [], [], 1.0
    for _ in range(count):
        last, square = square, float(weight @ now**2)
        centers.append(float(weight @ (r * now**2)) / square)
        widths.append(square / last)
        before, now = now, (r - centers[-1]) * now - widths[-1] * before
    off = np.sqrt(widths[1:])
    jacobi = np.diag(centers) + np.diag(off, 1) + np.diag(off, -1)
    nodes, vectors = eigh("Gauss rule", jacobi)
    return nodes, vectors[0] ** 2
