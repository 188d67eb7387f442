"""S-CIELAB: color difference of two pictures as seen from a viewing distance.

Zhang & Wandell, "A spatial extension of CIELAB for digital color-image reproduction", SID Symposium
Digest 27, 731 (1996); J. Soc. Inf. Disp. 5, 61 (1997).
"""

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import inv
from chromanoise._shapes import Float
from chromanoise.color import cie1976_difference
from chromanoise.errors import InputError
from chromanoise.metrics.pictures import LabDifference, picture_color_difference, same_pictures

OPPONENT_FROM_XYZ = (
    (0.2787336, 0.7218031, -0.1065520),
    (-0.4487736, 0.2898056, 0.0771569),
    (0.0859513, -0.5899859, 0.5011089),
)
"""Luminance, red-green and blue-yellow of Poirson & Wandell (1993) from X, Y, Z of CIE 1931.

As in the authors' code (cmatrix.m, 1996-98). Reprints of the matrix with three digits give the last
entry of the second row as -0.077; the code has +0.077, with which a neutral is closer to 0."""

GAUSSIANS = (
    ((0.921, 0.0283), (0.105, 0.133), (-0.108, 4.336)),
    ((0.531, 0.0392), (0.330, 0.494)),
    ((0.488, 0.0536), (0.371, 0.386)),
)
"""Weight [1] and spread s [deg] of each Gaussian exp(-(x^2 + y^2)/s^2), per opponent plane.

As printed in the table of Zhang & Wandell (1996). The standard deviation is s / 2^(1/2). The code
that the authors distribute has other numbers (0.05, 0.225, 7.0 deg ...). Its first version takes
them as full widths at half maximum, which agree with these spreads within 7 %; later versions
(ISETCam) take them as half widths, which blurs twice as far. Here the published table is used."""


def scielab_difference(
    xyz: Float[Array, "h w 3"],
    reference: Float[Array, "h w 3"],
    white: Float[Array, " 3"],
    *,
    pixels_per_degree: float,
    difference: LabDifference = cie1976_difference,
) -> Float[Array, "h w"]:
    """S-CIELAB difference of each pixel from that of the reference. [Delta E]

    Parameters
    ----------
    xyz, reference
        XYZ of CIE 1931 in the unit of ``white``; may be negative.
    white
        XYZ of a perfect white in the same light.
    pixels_per_degree
        Resolution at the viewing distance (`chromanoise.metrics.pixels_per_degree`), 1 to 10,000.
        [1/deg]
    difference
        CIE 1976, as published, or `chromanoise.color.ciede2000_difference`.

    Raises
    ------
    InputError
        As `picture_color_difference`, and if ``pixels_per_degree`` is out of range.

    Notes
    -----
    `scielab_filtered` of both pictures, then their color difference. Unlike in the authors' code,
    values are not clipped to 0 .. white, because clipping noise at 0 would shift the mean.

    Examples
    --------
    Uniform pictures have their CIELAB difference: here L* = 42 and 100.

    >>> gray = np.full((4, 4, 3), 0.125)
    >>> scielab_difference(gray, 8 * gray, np.ones(3), pixels_per_degree=60.0).round(9)[0]
    array([58., 58., 58., 58.])
    """
    first, second = same_pictures(xyz, reference)
    return picture_color_difference(
        scielab_filtered(first, pixels_per_degree=pixels_per_degree),
        scielab_filtered(second, pixels_per_degree=pixels_per_degree),
        white,
        difference=difference,
    )


def scielab_filtered(
    xyz: Float[Array, "h w 3"], *, pixels_per_degree: float
) -> Float[Array, "h w 3"]:
    """XYZ after the spatial filters of S-CIELAB: each opponent plane by its sum of Gaussians.

    Parameters
    ----------
    xyz
        XYZ of CIE 1931, in any unit.
    pixels_per_degree
        Resolution at the viewing distance, 1 to 10,000. [1/deg]

    Raises
    ------
    InputError
        If an entry is not finite, the shape is not (h, w, 3), or ``pixels_per_degree`` is out of
        range.

    Notes
    -----
    A pixel is a uniform square, over which each Gaussian is integrated; the weights of a plane are
    divided by their sum, so a uniform picture is unchanged. The borders are mirrored, which makes
    the convolution a product in the discrete cosine transform. The Gaussians are not cut off (the
    authors' code limits them to 1 degree).
    """
    from scipy.fft import dctn, idctn

    picture = _check.finite("xyz", "1", xyz)
    scale = _check.within("pixels_per_degree", "1/deg", pixels_per_degree, 1.0, 10_000.0)
    if picture.ndim != 3 or picture.shape[2] != 3 or not picture.size:
        raise InputError(
            "xyz",
            "must have the shape (h, w, 3)",
            value=picture.shape,
            found=f"has shape {picture.shape}",
        )
    opponent = np.asarray(OPPONENT_FROM_XYZ)
    planes = np.moveaxis(picture @ opponent.T, -1, 0)
    passed = np.stack([_passed(plane, planes.shape[1:], scale) for plane in GAUSSIANS])
    seen = idctn(dctn(planes, axes=(1, 2)) * passed, axes=(1, 2))
    return np.moveaxis(seen, 0, -1) @ inv("OPPONENT_FROM_XYZ", opponent).T


def _passed(
    gaussians: tuple[tuple[float, float], ...], shape: tuple[int, ...], pixels_per_degree: float
) -> Array:
    """Transfer of a sum of Gaussians for each cell of the cosine transform; 1 for the mean."""
    total = sum(weight for weight, _ in gaussians)
    passed = np.zeros(shape)
    for weight, spread_deg in gaussians:
        sd_px = spread_deg / np.sqrt(2) * pixels_per_degree
        down, across = (_passed_along(count, sd_px) for count in shape)
        passed += weight / total * down[:, None] * across
    return passed


def _passed_along(count: int, sd_px: float) -> Array:
    """Transfer along one axis: the Gaussian over each pixel, folded into the mirrored period."""
    from scipy.special import ndtr

    reach = int(np.ceil(8 * sd_px)) + 1
    at = np.arange(-reach, reach + 1)
    weights = np.diff(ndtr((np.append(at, reach + 1) - 0.5) / sd_px))
    period = np.bincount(at % (2 * count), weights, minlength=2 * count)
    return np.asarray(np.fft.rfft(period / period.sum()).real[:count])
