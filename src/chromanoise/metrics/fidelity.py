"""Quality of a whole picture relative to its reference, and edge sharpness.

The measures are color difference, PSNR, SSIM, false color, noise on flats, and S-CIELAB: the color
difference of two pictures as seen from a viewing distance, Zhang & Wandell, "A spatial extension of
CIELAB for digital color-image reproduction", SID Symposium Digest 27, 731 (1996); J. Soc. Inf.
Disp. 5, 61 (1997).

Edge sharpness uses the slanted edge of ISO 12233 (e-SFR): MTF and rise distance.
"""

import math
from collections.abc import Callable
from functools import lru_cache
from math import inf, log10

import numpy as np

from chromanoise.base import Array, Bool, Float, InputError, Shaped, check, dataclass, inv
from chromanoise.color import (
    LUMA_WEIGHTS,
    cie1976_difference,
    ciede2000_difference,
    cielab,
    encoded_srgb,
)

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
        Formula of the difference: `chromanoise.color.ciede2000_difference` or
        `chromanoise.color.cie1976_difference`.

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
        Largest possible value of a pixel, in the unit of the pictures.

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
    return 10 * log10(check.positive("peak", "1", peak) ** 2 / error) if error > 0 else inf


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
        Largest possible value of a pixel, in the unit of the pictures.

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
    need = f"must have one channel and at least {window} x {window} pixels, the window of SSIM"
    check.shape("picture", x, x.ndim == 2 and min(x.shape) >= window, need)
    c1, c2 = (k * check.positive("peak", "1", peak) for k in (_SSIM_K1, _SSIM_K2))
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


@dataclass(frozen=True, kw_only=True)
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

    values = check.finite("lab", "CIELAB", lab)
    radius = check.not_negative("radius_px", "px", radius_px)
    least = check.positive("edge_per_px", "Delta E*ab / px", edge_per_px)
    full = values.ndim == 3 and values.shape[2] == 3 and min(values.shape[:2]) >= 2
    check.shape("lab", values, full, "must have the shape (h, w, 3) with at least 2 x 2 pixels")
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
    picture, marks = check.finite("values", "1", values), np.asarray(regions)
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
    _demand_three_planes("picture", first)
    return first, second


def _demand_three_planes(name: str, picture: Array) -> None:
    full = picture.ndim == 3 and picture.shape[2] == 3 and picture.size > 0
    check.shape(name, picture, full, "must have the shape (h, w, 3)")


def _same_shape(picture: Array, reference: Array) -> tuple[Array, Array]:
    first = check.finite("picture", "1", picture)
    second = check.finite("reference", "1", reference)
    if first.shape != second.shape or not first.size:
        raise InputError(
            "reference",
            "must have the shape of the picture and at least one pixel",
            value=second.shape,
            found=f"has shape {second.shape}, the picture has {first.shape}",
        )
    return first, second


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

    picture = check.finite("xyz", "1", xyz)
    scale = check.within("pixels_per_degree", "1/deg", pixels_per_degree, 1.0, 10_000.0)
    _demand_three_planes("xyz", picture)
    opponent = np.asarray(OPPONENT_FROM_XYZ)
    planes = np.moveaxis(picture @ opponent.T, -1, 0)
    passed = np.stack([_passed(plane, planes.shape[1:], scale) for plane in GAUSSIANS])
    seen = idctn(dctn(planes, axes=(1, 2)) * passed, axes=(1, 2))
    return np.moveaxis(seen, 0, -1) @ inv("OPPONENT_FROM_XYZ", opponent).T


def _passed(
    gaussians: tuple[tuple[float, float], ...], shape: tuple[int, ...], pixels_per_degree: float
) -> Array:
    """Transfer of a sum of Gaussians for each cell of the cosine transform; 1 for the mean."""
    passed = np.zeros(shape)
    for share, sd_px in _shares_and_sds_px(gaussians, pixels_per_degree):
        down, across = (_passed_along(count, sd_px) for count in shape)
        passed += share * down[:, None] * across
    return passed


def _shares_and_sds_px(
    gaussians: tuple[tuple[float, float], ...], pixels_per_degree: float
) -> list[tuple[float, float]]:
    total = sum(weight for weight, _ in gaussians)
    return [(weight / total, s / np.sqrt(2) * pixels_per_degree) for weight, s in gaussians]


def _passed_along(count: int, sd_px: float) -> Array:
    """Transfer along one axis: the Gaussian over each pixel, folded into the mirrored period."""
    at = np.arange(1 - _reach(sd_px), _reach(sd_px))
    period = np.bincount(at % (2 * count), _along_pixels(at, sd_px), minlength=2 * count)
    return np.asarray(np.fft.rfft(period).real[:count])


def _reach(sd_px: float) -> int:
    return int(np.ceil(8 * sd_px)) + 2


def _along_pixels(at: Array, sd_px: float) -> Array:
    """A Gaussian over each of a row of pixels, from far left to far right."""
    edges = (np.append(at, at[-1] + 1) - 0.5) / sd_px
    weights = np.diff([0.5 * math.erfc(-one) for one in edges / math.sqrt(2)])
    return np.asarray(weights / weights.sum())


@lru_cache(maxsize=32)
def scielab_shares(pixels_per_degree: float) -> Float[Array, "3 3"]:
    """Factors by which `scielab_filtered` reduces the covariance of the opponent planes. [1]

    Of noise that is independent from pixel to pixel.

    Parameters
    ----------
    pixels_per_degree
        Resolution at the viewing distance, 1 to 10,000. [1/deg]

    Raises
    ------
    InputError
        If ``pixels_per_degree`` is out of range.
    """
    scale = check.within("pixels_per_degree", "1/deg", pixels_per_degree, 1.0, 10_000.0)
    planes = [_shares_and_sds_px(plane, scale) for plane in GAUSSIANS]
    sds_px = [sd_px for plane in planes for _, sd_px in plane]
    at = np.arange(1 - _reach(max(sds_px)), _reach(max(sds_px)))
    along = np.stack([_along_pixels(at, sd_px) for sd_px in sds_px])
    own = np.repeat(np.eye(len(planes)), [len(plane) for plane in planes], axis=1)
    mixed = own * [share for plane in planes for share, _ in plane]
    shares = mixed @ np.square(along @ along.T) @ mixed.T  # Gaussians factor in x and y
    shares.setflags(write=False)
    return np.asarray(shares)


@dataclass(frozen=True, kw_only=True)
class PictureQuality:
    """Errors of a picture relative to its reference.

    Attributes
    ----------
    psnr_db
        `psnr_db` of encoded sRGB clipped to 0 .. 1, all channels together; infinite for equal
        pictures. [dB]
    ssim
        `structural_similarity` of the luma (ITU-R BT.709-6) of encoded sRGB clipped to 0 .. 1. [1]
    ciede2000_mean, ciede2000_p95
        Mean and 95th percentile of CIEDE2000 over the pixels. [1]
    scielab_mean, scielab_p95
        Mean and 95th percentile of the S-CIELAB difference (CIE 1976). [Delta E*ab]
    false_color
        Chromatic error near edges and elsewhere; ``None`` if the reference has no edge.
    """

    psnr_db: float
    ssim: float
    ciede2000_mean: float
    ciede2000_p95: float
    scielab_mean: float
    scielab_p95: float
    false_color: FalseColor | None


def picture_quality(
    xyz: Float[Array, "h w 3"],
    reference: Float[Array, "h w 3"],
    white: Float[Array, " 3"],
    *,
    pixels_per_degree: float,
) -> PictureQuality:
    """Errors of a picture relative to its noise-free reference.

    Parameters
    ----------
    xyz, reference
        XYZ of CIE 1931 in the unit of ``white``, at least 11 x 11 pixels; may be negative.
    white
        XYZ of a perfect white in the same light.
    pixels_per_degree
        Resolution at the viewing distance, for S-CIELAB. [1/deg]

    Raises
    ------
    InputError
        As `picture_color_difference`, `structural_similarity` and `scielab_difference`.

    Notes
    -----
    For PSNR and SSIM both pictures are adapted to D65 and encoded (IEC 61966-2-1), so values
    that a display clips count as no error; the color differences are of unclipped XYZ.
    """
    first, second = same_pictures(xyz, reference)
    shown, true = (np.clip(encoded_srgb(one, white), 0.0, 1.0) for one in (first, second))
    luma = LUMA_WEIGHTS["bt709"]
    pixel = picture_color_difference(first, second, white)
    seen = scielab_difference(first, second, white, pixels_per_degree=pixels_per_degree)
    has_edges = near_edges(cielab(second, white)).any()
    return PictureQuality(
        psnr_db=psnr_db(shown, true),
        ssim=structural_similarity(shown @ luma, true @ luma),
        ciede2000_mean=float(pixel.mean()),
        ciede2000_p95=float(np.percentile(pixel, 95)),
        scielab_mean=float(seen.mean()),
        scielab_p95=float(np.percentile(seen, 95)),
        false_color=false_color(first, second, white) if has_edges else None,
    )


_BIN_PX = 0.25
_LEAST_SIDE_PX = 16
_LEAST_REACH_PX = 4.0
_PASSES = 4
_STANDARD_ERRORS = 5.0
_PADDING = 16  # of the Fourier transform, so that linear interpolation between its points suffices


@dataclass(frozen=True, kw_only=True)
class EdgeLine:
    """A straight edge in a region of a picture.

    Attributes
    ----------
    position_px
        Column in which a nearly vertical edge crosses the middle of the rows, or row in which a
        nearly horizontal one crosses the middle of the columns; pixel centers are whole numbers.
        [px]
    slope
        Columns per row, or rows per column; 0 is exactly vertical or horizontal. [px/px]
    horizontal
        Whether the edge is nearly horizontal.
    """

    position_px: float
    slope: float
    horizontal: bool = False

    @property
    def angle_deg(self) -> float:
        """Angle between the edge and the pixel axis that is nearest to it. [deg]"""
        return float(np.degrees(np.arctan(self.slope)))


@dataclass(frozen=True, kw_only=True, eq=False)
class EdgeResponse:
    """Sharpness of an edge, perpendicular to it.

    Attributes
    ----------
    line
        Where the edge lies.
    frequency_cy_px
        Spatial frequencies, 0 to 1. [cycles/px]
    mtf
        Modulation transfer at these frequencies, 1 at frequency 0. [1]
    mtf50_cy_px
        Lowest frequency at which the MTF is 0.5; ``None`` if it stays above 0.5 up to 1 cycle/px.
        [cycles/px]
    rise_px
        Distance in which the edge rises from 10 % to 90 % of its step. [px]
    step
        Difference between the two sides, in the unit of the region.
    step_to_noise
        ``step`` over the standard deviation of the pixels of a side; infinite without noise. [1]
    """

    line: EdgeLine
    frequency_cy_px: Float[Array, " m"]
    mtf: Float[Array, " m"]
    mtf50_cy_px: float | None
    rise_px: float
    step: float
    step_to_noise: float

    def __post_init__(self) -> None:
        check.freeze(self, "frequency_cy_px", "mtf")


def slanted_edge_response(
    region: Float[Array, "h w"], *, line: EdgeLine | None = None, reach_px: float = 16.0
) -> EdgeResponse:
    """MTF, MTF50 and 10-90 % rise distance of one slanted edge.

    Parameters
    ----------
    region
        Linear values (Y, not an encoded picture) around one straight edge, from border to border of
        the region, at least 16 x 16 pixels.
    line
        The edge, where it is known, e.g. by `edge_line` of the noise-free reference; ``None`` to
        fit it to the region.
    reach_px
        Largest distance from the edge of the pixels that are used, >= 4; smaller where the region
        ends earlier. A larger one includes wider flare and more noise. [px]

    Raises
    ------
    InputError
        As `edge_line`; if the line leaves less than 4 px of the region on a side, or the step
        between the sides is below 5 standard errors.

    Notes
    -----
    ISO 12233:2017, annex D: the distance of each pixel from the edge, means in bins of 1/4 pixel
    (the edge spread function), differences, window, Fourier transform. Three steps differ. The
    distance is perpendicular to the edge. Differences are of adjacent bins, so the differences and
    the bin width are both corrected by sinc^2(f/4) (the correction printed in the 2014 and 2017
    editions is for other differences). The window is flat up to half the reach and falls as a
    cosine to its end (the edition of 2023 has a Tukey window in place of Hamming's).

    Noise lowers the first crossing of 0.5 and shortens the rise. Measured on a region of 64 x 64
    with an MTF50 of 0.22 and a rise of 2.21 px, 100 draws: at a ``step_to_noise`` of 10, MTF50
    0.218 +- 0.017 and rise 2.21 +- 0.15; at 5, 0.214 +- 0.03 and 2.19 +- 0.24; at 2, 0.20 +- 0.06
    and 2.0 +- 0.4; at 1, 0.18 +- 0.11 and 1.5 +- 0.6. Below 5 average several pictures, lengthen
    the region, or give ``line``. The bins lengthen the rise by 1.6 % at 2 px, 0.7 % at 3 px.

    Examples
    --------
    >>> y, x = np.mgrid[:40, :40]
    >>> ramp = np.clip((x - 19.5 - 0.1 * (y - 19.5)) / np.hypot(1.0, 0.1) / 5.0 + 0.5, 0.0, 1.0)
    >>> round(slanted_edge_response(ramp).rise_px, 1)                     # 0.8 of 5 px
    4.0
    """
    values = _region(region)
    reach = check.positive("reach_px", "px", reach_px)
    line = edge_line(values) if line is None else line
    upright = values.T if line.horizontal else values
    distance, available = _distances(upright.shape, line)
    reach = min(reach, available)
    if reach < _LEAST_REACH_PX:
        raise InputError(
            "reach_px" if available >= _LEAST_REACH_PX else "region",
            f"must have at least {_LEAST_REACH_PX:g} px on either side of the edge",
            value=reach,
            found=f"has {max(reach, 0.0):.3g} px",
            remedy="take a larger region around the edge",
        )
    outer = (np.abs(distance) > reach / 2) & (np.abs(distance) <= reach)
    low, high = upright[outer & (distance < 0)], upright[outer & (distance > 0)]
    step = float(high.mean() - low.mean())
    variances = low.var(), high.var()
    error = float(np.sqrt(variances[0] / low.size + variances[1] / high.size))
    rounding = 64 * np.finfo(float).eps * float(np.abs(values).max())
    if not abs(step) > max(_STANDARD_ERRORS * error, rounding):
        raise InputError(
            "region",
            "must hold an edge whose step exceeds 5 standard errors of the means of its sides",
            value=abs(step),
            found=f"has a step of {abs(step):.3g} with a standard error of {error:.3g}",
            remedy="take another region, or a brighter or larger one",
        )
    spread = _edge_spread(upright, distance, reach)
    at = (np.arange(spread.size) + 0.5) * _BIN_PX - reach
    frequency, mtf = _mtf(spread, at)
    sd = float(np.sqrt(np.mean(variances)))
    return EdgeResponse(
        line=line,
        frequency_cy_px=frequency,
        mtf=mtf,
        mtf50_cy_px=_first_fall(frequency, mtf, 0.5),
        rise_px=_rise(at, (spread - low.mean()) / step),
        step=abs(step),
        step_to_noise=abs(step) / sd if sd > 0 else float("inf"),
    )


def edge_line(region: Float[Array, "h w"]) -> EdgeLine:
    """The straight edge in a region, by the centroids of its rows or columns.

    Parameters
    ----------
    region
        As `slanted_edge_response`.

    Raises
    ------
    InputError
        If an entry is not finite, the region is smaller than 16 x 16 pixels, it holds no edge, or
        the edge is not slanted: it must cross at least 1 px from end to end.

    Notes
    -----
    ISO 12233:2017, annex D: centroids of the differences along each row under a Hamming window, and
    a line through them; the window is then centered on that line. Four passes. Rows in which the
    window holds less than half of the mean step are not used.
    """
    values = _region(region)
    middle = [side // 2 for side in values.shape]
    down = abs(values[: middle[0]].mean() - values[-middle[0] :].mean())
    across = abs(values[:, : middle[1]].mean() - values[:, -middle[1] :].mean())
    horizontal = bool(down > across)
    upright = values.T if horizontal else values
    height, width = upright.shape
    steps = np.diff(upright, axis=1)
    at, rows = np.arange(width - 1) + 0.5, np.arange(height) - (height - 1) / 2
    centers, half = np.full(height, (width - 1) / 2), width / 2
    position, slope = 0.0, 0.0
    for _ in range(_PASSES):
        away = (at - centers[:, None]) / half
        weighted = steps * np.where(np.abs(away) < 1, 0.54 + 0.46 * np.cos(np.pi * away), 0.0)
        sums = weighted.sum(axis=1)
        mean = float(sums.mean())
        used = sums * np.sign(mean) > 0.5 * abs(mean)
        if 2 * np.count_nonzero(used) <= height or not abs(mean) > 1e-12 * np.abs(values).max():
            raise _no_edge()
        centroid = (weighted @ at)[used] / sums[used]
        slope, position = np.polynomial.Polynomial.fit(rows[used], centroid, 1).convert().coef[::-1]
        centers = position + slope * rows
        if not (centers.min() > 0 and centers.max() < width - 1):
            raise _no_edge()
    if abs(slope) * (height - 1) < 1:
        raise InputError(
            "region",
            "must hold an edge that crosses at least 1 px from end to end",
            value=float(slope) * (height - 1),
            found=f"crosses {abs(slope) * (height - 1):.3g} px",
            remedy="tilt the edge by about 5 degrees or lengthen the region",
        )
    return EdgeLine(position_px=float(position), slope=float(slope), horizontal=horizontal)


def _region(region: Array) -> Array:
    values = check.finite("region", "1", region)
    need = f"must have one channel and at least {_LEAST_SIDE_PX} x {_LEAST_SIDE_PX} pixels"
    check.shape("region", values, values.ndim == 2 and min(values.shape) >= _LEAST_SIDE_PX, need)
    return values


def _no_edge() -> InputError:
    return InputError(
        "region",
        "must hold one straight edge from border to border",
        found="has none that can be located",
        remedy="take another region, or give the line",
    )


def _distances(shape: tuple[int, ...], line: EdgeLine) -> tuple[Array, float]:
    """Distance of each pixel from the edge, and the largest one that all rows reach. [px]"""
    height, width = shape
    edge = line.position_px + line.slope * (np.arange(height) - (height - 1) / 2)
    shrink = 1 / np.hypot(1.0, line.slope)
    reach = min(edge.min(), width - 1 - edge.max()) * shrink
    return (np.arange(width) - edge[:, None]) * shrink, float(reach // _BIN_PX * _BIN_PX)


def _edge_spread(upright: Array, distance: Array, reach: float) -> Array:
    """The edge at the centers of the bins, by lines between the means of the pixels of each bin."""
    place = np.floor((distance + reach) / _BIN_PX).astype(np.int64)
    count = round(2 * reach / _BIN_PX)
    inside = (place >= 0) & (place < count)
    pixels = np.bincount(place[inside], minlength=count)
    filled = pixels > 0
    means, places = (
        np.bincount(place[inside], of[inside], minlength=count)[filled] / pixels[filled]
        for of in (upright, distance)
    )
    return np.interp((np.arange(count) + 0.5) * _BIN_PX - reach, places, means)


def _mtf(spread: Array, at: Array) -> tuple[Array, Array]:
    """Frequencies up to 1 cycle/px and the MTF, without the bins and the differences."""
    share = np.abs(at[1:] + at[:-1]) / 2 / -(at[0] - _BIN_PX / 2)
    window = np.where(share < 0.5, 1.0, 0.5 + 0.5 * np.cos(np.pi * (2 * share - 1)))
    transform = np.abs(np.fft.rfft(np.diff(spread) * window, _PADDING * spread.size))
    frequency = np.fft.rfftfreq(_PADDING * spread.size, _BIN_PX)
    mtf = transform / transform[0] / np.sinc(frequency * _BIN_PX) ** 2
    return frequency[frequency <= 1.0], mtf[frequency <= 1.0]


def _first_fall(frequency: Array, mtf: Array, level: float) -> float | None:
    below = np.flatnonzero(mtf < level)
    if not below.size:
        return None
    i = int(below[0])
    share = (mtf[i - 1] - level) / (mtf[i - 1] - mtf[i])
    return float(frequency[i - 1] + share * (frequency[i] - frequency[i - 1]))


def _rise(at: Array, spread: Array) -> float:
    """Distance from the last 10 % before the edge to the first 90 % after it. [px]"""
    start = int(np.flatnonzero((spread <= 0.1) & (at < 0))[-1])
    end = start + int(np.flatnonzero(spread[start:] >= 0.9)[0])
    low = np.interp(0.1, spread[start : start + 2], at[start : start + 2])
    high = np.interp(0.9, spread[end - 1 : end + 1], at[end - 1 : end + 1])
    return float(high - low)
