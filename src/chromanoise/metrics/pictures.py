"""Errors of a whole picture relative to its reference: color, PSNR, SSIM, false color, flats."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, log10

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Shaped
from chromanoise.color import ciede2000_difference, cielab
from chromanoise.errors import InputError

LabDifference = Callable[[Array, Array], Array]
"""A color difference per pixel from two pictures in L*, a*, b* (`chromanoise.color`)."""

_SSIM_SD_PX, _SSIM_RADIUS_PX = 1.5, 5
_SSIM_K1, _SSIM_K2 = 0.01, 0.03


def picture_color_difference(
    xyz: Float[Array, "h w 3"],
    reference: Float[Array, "h w 3"],
    white: Float[Array, " 3"],
    *,
    difference: LabDifference = ciede2000_difference,
) -> Float[Array, "h w"]:
    """Color difference of each pixel from that of the reference. [1]

    Parameters
    ----------
    xyz, reference
        XYZ in the unit of ``white``; may be negative, where noise exceeds the signal.
    white
        XYZ of a perfect white in the same light.
    difference
        `chromanoise.color.ciede2000_difference` or `chromanoise.color.cie1976_difference`.

    Raises
    ------
    InputError
        If an entry is not finite, the shapes differ, or X, Y or Z of the white is not above 0.

    Notes
    -----
    CIELAB below 0 as `chromanoise.color.cielab`: its linear segment continues.

    Examples
    --------
    >>> gray = np.full((1, 2, 3), 0.125)
    >>> picture_color_difference(gray, 8 * gray, np.ones(3)).round(3)     # L* = 42 and 100
    array([[44.339, 44.339]])
    """
    first, second = same_pictures(xyz, reference)
    return np.asarray(difference(cielab(second, white), cielab(first, white)))


def psnr_db(
    picture: Float[Array, "*px"], reference: Float[Array, "*px"], *, peak: float = 1.0
) -> float:
    """Peak signal-to-noise ratio, over all pixels and channels together. [dB]

    Infinite for equal pictures.

    Parameters
    ----------
    picture, reference
        Values from 0 to ``peak``; usually encoded sRGB (`chromanoise.color.srgb_from_xyz`), not
        linear light.
    peak
        Largest possible value.

    Raises
    ------
    InputError
        If an entry is not finite, or the shapes differ.

    Notes
    -----
    10 log10(peak^2 / mean squared error).

    Examples
    --------
    >>> round(psnr_db(np.full((2, 2, 3), 0.6), np.full((2, 2, 3), 0.5)), 6)
    20.0
    """
    first, second = _same_shape(picture, reference)
    error = float(np.mean((first - second) ** 2))
    return 10 * log10(_check.positive("peak", "1", peak) ** 2 / error) if error > 0 else inf


def structural_similarity(
    picture: Float[Array, "h w"], reference: Float[Array, "h w"], *, peak: float = 1.0
) -> float:
    """Mean structural similarity (SSIM) of two pictures of one channel, 1 for equal ones. [1]

    Parameters
    ----------
    picture, reference
        Values from 0 to ``peak``; usually the luma of encoded RGB
        (`chromanoise.color.LUMA_WEIGHTS`).
    peak
        Largest possible value.

    Raises
    ------
    InputError
        If an entry is not finite, the shapes differ, or a side is shorter than the window.

    Notes
    -----
    Wang, Bovik, Sheikh & Simoncelli, IEEE Trans. Image Process. 13, 600 (2004), eq. 13 and 17:
    Gaussian window of 11 x 11 pixels with a standard deviation of 1.5, K1 = 0.01, K2 = 0.03; the
    mean is over the positions of the window inside the picture.

    Examples
    --------
    >>> ramp = np.linspace(0.0, 1.0, 144).reshape(12, 12)
    >>> structural_similarity(ramp, ramp)
    1.0
    """
    from scipy.ndimage import correlate1d

    x, y = _same_shape(picture, reference)
    window = 2 * _SSIM_RADIUS_PX + 1
    if x.ndim != 2 or min(x.shape) < window:
        raise InputError(
            "picture",
            f"must have one channel and at least {window} x {window} pixels, the window of SSIM",
            value=x.shape,
            found=f"has shape {x.shape}",
        )
    c1, c2 = (k * _check.positive("peak", "1", peak) for k in (_SSIM_K1, _SSIM_K2))
    at = np.arange(-_SSIM_RADIUS_PX, _SSIM_RADIUS_PX + 1)
    weights = np.exp(-0.5 * (at / _SSIM_SD_PX) ** 2)
    weights /= weights.sum()
    inside = slice(_SSIM_RADIUS_PX, -_SSIM_RADIUS_PX)

    def mean(values: Array) -> Array:
        return correlate1d(correlate1d(values, weights, axis=0)[inside], weights)[:, inside]

    x_mean, y_mean = mean(x), mean(y)
    variances = mean(x * x + y * y) - x_mean**2 - y_mean**2
    covariance = mean(x * y) - x_mean * y_mean
    similarity = (2 * x_mean * y_mean + c1**2) * (2 * covariance + c2**2)
    return float(np.mean(similarity / ((x_mean**2 + y_mean**2 + c1**2) * (variances + c2**2))))


@dataclass(frozen=True, slots=True, kw_only=True)
class FalseColor:
    """Mean chromatic error of a picture near the edges of its reference, and elsewhere.

    Attributes
    ----------
    near_edges
        Mean length of the error of (a*, b*) within ``radius_px`` of an edge. [CIELAB]
    elsewhere
        The same over all other pixels, mostly noise; ``None`` if all pixels are near an edge.
    edge_share
        Share of the pixels that are near an edge. [1]
    """

    near_edges: float
    elsewhere: float | None
    edge_share: float


def false_color(
    xyz: Float[Array, "h w 3"],
    reference: Float[Array, "h w 3"],
    white: Float[Array, " 3"],
    *,
    radius_px: float = 2.0,
    edge_per_px: float = 5.0,
) -> FalseColor:
    """Mean chromatic error near the edges of the reference.

    It includes the noise of a* and b*. A value above `FalseColor.elsewhere` shows color that
    interpolation or filtering has moved across edges.

    Parameters
    ----------
    xyz, reference, white
        As `picture_color_difference`; the reference is without noise.
    radius_px
        Largest distance from an edge. [px]
    edge_per_px
        Smallest color change of the reference that counts as an edge, as `near_edges`.
        [Delta E*ab / px]

    Raises
    ------
    InputError
        As `picture_color_difference` and `near_edges`, and if the reference has no edge.

    Notes
    -----
    The error is the chromatic part of the CIE 1976 difference, (da*^2 + db*^2)^(1/2) (CIE 015:2018,
    eq. 8.21 without dL*). Edges and smooth regions are measured separately, as by Lu & Tan, IEEE
    Trans. Image Process. 12, 1194 (2003).
    """
    first, second = same_pictures(xyz, reference)
    lab = cielab(second, white)
    near = near_edges(lab, radius_px=radius_px, edge_per_px=edge_per_px)
    if not near.any():
        raise InputError(
            "reference",
            f"must have an edge: a color change of {edge_per_px:g} Delta E*ab per pixel",
            found="has none",
            remedy="take a scene with edges or lower edge_per_px",
        )
    away = (cielab(first, white) - lab)[..., 1:]
    error = np.hypot(away[..., 0], away[..., 1])
    return FalseColor(
        near_edges=float(error[near].mean()),
        elsewhere=None if near.all() else float(error[~near].mean()),
        edge_share=float(near.mean()),
    )


def near_edges(
    lab: Float[Array, "h w 3"], *, radius_px: float = 2.0, edge_per_px: float = 5.0
) -> Bool[Array, "h w"]:
    """Whether each pixel lies near an edge of a picture without noise.

    Parameters
    ----------
    lab
        L*, a*, b*, at least 2 x 2 pixels.
    radius_px
        Largest distance from an edge pixel, >= 0. [px]
    edge_per_px
        Smallest length of the gradient of (L*, a*, b*) at an edge pixel. [Delta E*ab / px]

    Raises
    ------
    InputError
        If an entry is not finite, the picture is too small, or a parameter is out of range.

    Notes
    -----
    The gradient is the root of the sum of the squared differences along rows and columns, over the
    three coordinates: central differences inside, one-sided ones at the border.
    """
    from scipy.ndimage import distance_transform_edt

    values = _check.finite("lab", "CIELAB", lab)
    radius = _check.not_negative("radius_px", "px", radius_px)
    least = _check.positive("edge_per_px", "Delta E*ab / px", edge_per_px)
    if values.ndim != 3 or values.shape[2] != 3 or min(values.shape[:2]) < 2:
        raise InputError(
            "lab",
            "must have the shape (h, w, 3) with at least 2 x 2 pixels",
            value=values.shape,
            found=f"has shape {values.shape}",
        )
    down, across = np.gradient(values, axis=(0, 1))
    edge = np.einsum("hwc,hwc->hw", down, down) + np.einsum("hwc,hwc->hw", across, across)
    flat = edge < least**2
    if flat.all():
        return ~flat
    return np.asarray(distance_transform_edt(flat) <= radius)


def flat_noise_sd(
    values: Float[Array, "h w q"], regions: Shaped[Array, "h w"]
) -> Float[Array, " q"]:
    """Pooled standard deviation over flat regions, each about its own mean.

    Parameters
    ----------
    values
        A picture in any coordinates: XYZ, CIELAB, electrons.
    regions
        Number of the flat region of each pixel, 0 for none; or a Boolean mask of a single
        region.

    Raises
    ------
    InputError
        If an entry is not finite, a number is not a whole number >= 0, the shapes differ, there is
        no region, or a region has a single pixel.

    Notes
    -----
    s^2 = sum of the squares about the means / (pixels - regions).

    Examples
    --------
    >>> picture = np.array([[[1.0], [3.0], [10.0], [12.0], [99.0]]])
    >>> flat_noise_sd(picture, np.array([[1, 1, 2, 2, 0]]))             # (4 / (4 - 2))^(1/2)
    array([1.41421356])
    """
    picture, marks = _check.finite("values", "1", values), np.asarray(regions)
    if marks.dtype.kind not in "bui" or marks.min(initial=0) < 0:
        raise InputError(
            "regions", "must hold whole numbers >= 0", found=f"holds {marks.dtype} values"
        )
    if picture.ndim != 3 or picture.shape[:2] != marks.shape:
        raise InputError(
            "regions",
            "must have one number per pixel of values (h, w, q)",
            value=marks.shape,
            found=f"has shape {marks.shape}, values have {picture.shape}",
        )
    _, label, count = np.unique(marks[marks > 0], return_inverse=True, return_counts=True)
    if not count.size or count.min() < 2:
        raise InputError(
            "regions",
            "must mark at least one region, each of at least 2 pixels",
            found="marks none" if not count.size else "marks a region of 1 pixel",
        )
    pixels = picture[marks > 0]
    away = [v - (np.bincount(label, v) / count)[label] for v in pixels.T]
    return np.sqrt(np.sum(np.square(away), axis=1) / (label.size - count.size))


def same_pictures(xyz: Array, reference: Array) -> tuple[Array, Array]:
    """Two pictures (h w 3) of one shape as float64, checked."""
    first, second = _same_shape(xyz, reference)
    if first.ndim != 3 or first.shape[2] != 3 or not first.size:
        raise InputError(
            "picture",
            "must have the shape (h, w, 3)",
            value=first.shape,
            found=f"has shape {first.shape}",
        )
    return first, second


def _same_shape(picture: Array, reference: Array) -> tuple[Array, Array]:
    first = _check.finite("picture", "1", picture)
    second = _check.finite("reference", "1", reference)
    if first.shape != second.shape or not first.size:
        raise InputError(
            "reference",
            "must have the shape of the picture and at least one pixel",
            value=second.shape,
            found=f"has shape {second.shape}, the picture has {first.shape}",
        )
    return first, second
