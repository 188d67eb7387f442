"""Conversion of linear XYZ to sRGB pixels."""

import numpy as np

from chromanoise._check import Array
from chromanoise._linalg import inv
from chromanoise._shapes import Float
from chromanoise.errors import InputError

SRGB_TOE = 0.0031308
"""Linear value up to which sRGB is encoded by a line (IEC 61966-2-1)."""

D65_WHITE = np.array([0.95047, 1.0, 1.08883])
"""XYZ of the sRGB white (IEC 61966-2-1)."""

XYZ_TO_LINEAR_SRGB = np.array(
    [
        [3.2406, -1.5372, -0.4986],
        [-0.9689, 1.8758, 0.0415],
        [0.0557, -0.2040, 1.0570],
    ]
)
"""IEC 61966-2-1:1999, as printed."""

BRADFORD = np.array(
    [
        [0.8951, 0.2664, -0.1614],
        [-0.7502, 1.7135, 0.0367],
        [0.0389, -0.0685, 1.0296],
    ]
)
"""Cone response of the Bradford transform (Lam 1985; ICC.1:2022, annex E)."""


def adapted_to_d65(xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]) -> Float[Array, "*px 3"]:
    """XYZ adapted from ``white`` to D65: von Kries scaling in Bradford's cone space.

    Parameters
    ----------
    xyz
        Linear, Y = 1 for the white.
    white
        XYZ of a perfect white under the light of the picture.

    Raises
    ------
    InputError
        If the white is no color that an eye can adapt to.

    Examples
    --------
    >>> adapted_to_d65(np.array([1.0, 1.0, 1.0]), np.ones(3)).round(5)
    array([0.95047, 1.     , 1.08883])
    """
    cones = BRADFORD @ white
    if not (cones > 0).all():
        found = white.round(4).tolist()
        raise InputError(
            "white",
            "must be a color that an eye can adapt to (Bradford's cone responses > 0)",
            value=found,
            found=f"is XYZ = {found}: the sensor and its matrix do not see this light",
            remedy="take another lamp or matrix",
        )
    gain = (BRADFORD @ D65_WHITE) / cones
    return xyz @ (inv("BRADFORD", BRADFORD) @ np.diag(gain) @ BRADFORD).T


def srgb_from_xyz(xyz: Float[Array, "*px 3"]) -> Float[Array, "*px 3"]:
    """Encoded sRGB, 0 .. 1, with out-of-gamut colors clipped (IEC 61966-2-1).

    Parameters
    ----------
    xyz
        Relative to D65, Y = 1 for white.

    Examples
    --------
    >>> srgb_from_xyz(D65_WHITE * np.array([[1.0], [0.18], [0.0]])).round(3)
    array([[1.   , 1.   , 1.   ],
           [0.461, 0.461, 0.461],
           [0.   , 0.   , 0.   ]])
    """
    return srgb_from_linear(np.clip(xyz @ XYZ_TO_LINEAR_SRGB.T, 0.0, 1.0))


def srgb_from_linear(linear: Float[Array, "*px"]) -> Float[Array, "*px"]:
    """Encoded sRGB of linear values; the line continues below 0, the power law above 1.

    Parameters
    ----------
    linear
        Linear values; 1 is the white. [1]

    Notes
    -----
    IEC 61966-2-1:1999. The two pieces differ by 2e-8 at 0.0031308, as in the standard.
    """
    power = np.maximum(linear, SRGB_TOE) ** (1 / 2.4)
    return np.where(linear <= SRGB_TOE, 12.92 * linear, 1.055 * power - 0.055)
