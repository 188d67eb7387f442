"""The CIE chromaticity x, y, with its Jacobian for the propagation of noise."""

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.color.spaces import Space


def xyy(xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]) -> Float[Array, "*px 3"]:
    """Chromaticity x, y and luminance Y; the chromaticity is kept finite.

    Parameters
    ----------
    xyz
        X, Y, Z in any unit.
    white
        Ignored: a chromaticity does not depend on a white.

    Notes
    -----
    CIE 015:2018, eq. 7.1, with 1/d of x = X/d, d = X + Y + Z, replaced by d / max(d^2, a^2/4),
    where a is the sum of the absolute values: physical colors are unchanged, and where noise makes
    d cross zero the pole is replaced by a line, as in `cieluv`. Black has x = y = 0.

    Examples
    --------
    >>> xyy(np.array([1.0, 2.0, 1.0]), np.ones(3))
    array([0.25, 0.5 , 2.  ])
    """
    d, size = _sums(xyz)
    return np.concatenate([xyz[..., :2] / size * (d / size), xyz[..., 1:2]], axis=-1)


def _xyy_jacobian(xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]) -> Float[Array, "*px 3 3"]:
    d, size = _sums(xyz)
    regular = np.abs(d) >= size  # there the size is |d|
    toward = np.where(regular, np.sign(d), 0.5 * np.sign(xyz))  # slope of the size
    reciprocal = d / size**2
    slope = 1 / size**2 - 2 * d * toward / size**3
    own = np.eye(2, 3) * reciprocal[..., None]
    chromaticity = own + xyz[..., :2, None] * slope[..., None, :]
    luminance = np.broadcast_to(np.eye(3)[1], (*xyz.shape[:-1], 1, 3))
    return np.concatenate([chromaticity, luminance], axis=-2)


def _sums(xyz: Float[Array, "*px 3"]) -> tuple[Float[Array, "*px 1"], Float[Array, "*px 1"]]:
    """X + Y + Z, and its size: at least half the sum of the absolute values, never 0."""
    d, half = xyz.sum(axis=-1, keepdims=True), np.abs(xyz).sum(axis=-1, keepdims=True) / 2
    return d, np.where(half > 0, np.maximum(np.abs(d), half), 1.0)


XYY = Space(name="xyY", coordinates=("x", "y", "Y"), from_xyz=xyy, jacobian=_xyy_jacobian)
"""Chromaticity and luminance: x, y, Y."""
