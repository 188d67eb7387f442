"""Color spaces with Jacobians for the propagation of noise, color differences, and sRGB pixels.

Every map is exact for physical colors and continues beyond them without clipping: noise makes X, Y
and Z negative or larger than white, and clipping would hide it. The docstring of each map defines
how it continues. For noise see `chromanoise.color.propagate`.

All maps depend only on the ratio of a color to its white: ``xyz`` and ``white`` may have any common
unit.

Color differences are between balanced colors, for which white is X = Y = Z = 1.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from chromanoise.base import Array, Float, InputError, check, dataclass, inv


def balanced_cielab(xyz: Float[Array, "*px 3"]) -> Float[Array, "*px 3"]:
    """CIE 1976 L*, a*, b* of colors divided by their white.

    Parameters
    ----------
    xyz
        X/Xn, Y/Yn, Z/Zn; also below 0, where the linear segment continues. [1]

    Notes
    -----
    CIE 015:2018, eq. 8.3-8.8, as `chromanoise.color.cielab`. The cube root is a power here, as in
    colour-science; it differs from ``np.cbrt`` in the last digit, and so would published results.

    Examples
    --------
    >>> balanced_cielab(np.array([0.125, 0.125, 0.125])).round(12)       # 116 / 2 - 16
    array([42.,  0.,  0.])
    """
    linear = 841 / 108 * xyz + 16 / 116
    return lab_of_cube_roots(np.where(xyz > (24 / 116) ** 3, np.abs(xyz) ** (1 / 3), linear))


def lab_of_cube_roots(roots: Float[Array, "*px 3"]) -> Float[Array, "*px 3"]:
    """L*, a*, b* from the f of X/Xn, Y/Yn and Z/Zn (CIE 015:2018, eq. 8.3-8.5).

    Examples
    --------
    >>> lab_of_cube_roots(np.array([0.5, 0.5, 0.5]))
    array([42.,  0.,  0.])
    """
    x, y, z = roots[..., 0], roots[..., 1], roots[..., 2]
    lab = np.empty(roots.shape)
    lab[..., 0], lab[..., 1], lab[..., 2] = 116 * y - 16, 500 * (x - y), 200 * (y - z)
    return lab


def cie1976_difference(
    first: Float[Array, "*#px 3"], second: Float[Array, "*#px 3"]
) -> Float[Array, "..."]:
    """CIE 1976 color difference of two colors given as L*, a*, b*. [Delta E*ab]

    Parameters
    ----------
    first, second
        L*, a*, b*; their leading axes are broadcast.

    Notes
    -----
    CIE 015:2018, eq. 8.21.

    Examples
    --------
    >>> cie1976_difference(np.array([50.0, 3.0, 4.0]), np.array([50.0, 0.0, 0.0]))
    array(5.)
    """
    away = np.asarray(first - second)
    lightness, a, b = away[..., 0], away[..., 1], away[..., 2]
    return np.asarray(np.sqrt(lightness * lightness + a * a + b * b))  # a third of `norm`'s time


def ciede2000_difference(
    first: Float[Array, "*#px 3"], second: Float[Array, "*#px 3"]
) -> Float[Array, "..."]:
    """CIEDE2000 color difference of two colors given as L*, a*, b*. [1]

    Parameters
    ----------
    first, second
        L*, a*, b*; their leading axes are broadcast.

    Notes
    -----
    CIE 142-2001 (ISO/CIE 11664-6:2014), as Sharma, Wu & Dalal, Color Res. Appl. 30, 21 (2005), eq.
    2-22, with k_L = k_C = k_H = 1.

    Examples
    --------
    Pair 7 of Sharma, Wu & Dalal, Color Res. Appl. 30, 21 (2005), table 1.

    >>> first, second = np.array([50.0, 0.0, 0.0]), np.array([50.0, -1.0, 2.0])
    >>> round(float(ciede2000_difference(first, second)), 4)
    2.3669
    """
    (l1, a1, b1), (l2, a2, b2) = (
        np.moveaxis(np.asarray(lab, dtype=float), -1, 0) for lab in (first, second)
    )
    rise = 1.5 - 0.5 * _toward_one((np.hypot(a1, b1) + np.hypot(a2, b2)) / 2)
    chroma_1, hue_1 = np.hypot(rise * a1, b1), np.arctan2(b1, rise * a1) % (2 * np.pi)
    chroma_2, hue_2 = np.hypot(rise * a2, b2), np.arctan2(b2, rise * a2) % (2 * np.pi)
    turn = hue_2 - hue_1
    wraps = np.abs(turn) > np.pi
    turn = np.where(wraps, turn - np.copysign(2 * np.pi, turn), turn)
    no_hue = chroma_1 * chroma_2 == 0.0
    between = 2 * np.sqrt(chroma_1 * chroma_2) * np.sin(np.where(no_hue, 0.0, turn) / 2)
    middle = hue_1 + hue_2
    middle = np.where(wraps, middle + np.where(middle < 2 * np.pi, 2 * np.pi, -2 * np.pi), middle)
    hue = np.degrees(np.where(no_hue, hue_1 + hue_2, middle / 2))
    chroma, lightness = (chroma_1 + chroma_2) / 2, (l1 + l2) / 2 - 50
    by_hue = (
        1
        - 0.17 * _cos_deg(hue - 30)
        + 0.24 * _cos_deg(2 * hue)
        + 0.32 * _cos_deg(3 * hue + 6)
        - 0.20 * _cos_deg(4 * hue - 63)
    )
    of_lightness = (l2 - l1) / (1 + 0.015 * lightness**2 / np.sqrt(20 + lightness**2))
    of_chroma = (chroma_2 - chroma_1) / (1 + 0.045 * chroma)
    of_hue = between / (1 + 0.015 * chroma * by_hue)
    tilt_deg = 60 * np.exp(-(((hue - 275) / 25) ** 2))
    blue = -2 * _toward_one(chroma) * np.sin(np.radians(tilt_deg))
    squares = of_lightness**2 + of_chroma**2 + of_hue**2 + blue * of_chroma * of_hue
    return np.asarray(np.sqrt(squares))


def _toward_one(chroma: Any) -> Any:
    """Near 1 for a chroma far above 25."""
    seventh = chroma**7
    return np.sqrt(seventh / (seventh + 25.0**7))


def _cos_deg(angle_deg: Any) -> Any:
    return np.cos(np.radians(angle_deg))


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


def srgb_slope(linear: Float[Array, "*px"]) -> Float[Array, "*px"]:
    """The slope of `srgb_from_linear`."""
    power = 1.055 / 2.4 * np.maximum(linear, SRGB_TOE) ** (1 / 2.4 - 1)
    return np.where(linear <= SRGB_TOE, 12.92, power)


_DELTA = 6 / 29  # CIE 015:2018, eq. 8.7: below its cube the cube root becomes a line
_UV = np.array([1.0, 15.0, 3.0])  # CIE 015:2018, eq. 8.25: X + 15 Y + 3 Z
LAB_FROM_CUBE_ROOTS = np.array([[0.0, 116.0, 0.0], [500.0, -500.0, 0.0], [0.0, 200.0, -200.0]])
"""Slopes of `lab_of_cube_roots` (CIE 015:2018, eq. 8.3-8.5)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Space:
    """A color space: a map from XYZ and its Jacobian.

    Attributes
    ----------
    name
        Its name in the standard, e.g. "CIELAB".
    coordinates
        Names of the coordinates, e.g. ("L*", "a*", "b*").
    from_xyz
        (xyz [*px 3], white [3]) -> coordinates [*px 3]; ``xyz`` relative to a ``white`` of Y = 1.
    jacobian
        (xyz [*px 3], white [3]) -> d coordinate_i / d xyz_j. [*px 3 3]
    """

    name: str
    coordinates: tuple[str, str, str]
    from_xyz: Callable[[Array, Array], Array]
    jacobian: Callable[[Array, Array], Array]

    def __post_init__(self) -> None:
        check.distinct("coordinates of a color space", (self.name, *self.coordinates))

    @property
    def has_color_difference(self) -> bool:
        """Whether a distance is a CIE 1976 color difference: in CIELAB and CIELUV."""
        return self.coordinates[0] == "L*"


def linear_srgb(xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]) -> Float[Array, "*px 3"]:
    """Linear sRGB: Rec. 709 primaries, white-balanced by Bradford, 1 for the white; unclipped.

    Parameters
    ----------
    xyz
        In the unit of ``white``.
    white
        XYZ of a perfect white in the same light.

    Raises
    ------
    InputError
        If the white is no color that an eye could adapt to.

    Notes
    -----
    IEC 61966-2-1:1999, with its printed matrix.

    Examples
    --------
    >>> linear_srgb(np.array([0.5, 0.5, 0.5]), np.ones(3)).round(3)
    array([0.5, 0.5, 0.5])
    """
    return adapted_to_d65(xyz, _white(white)) @ XYZ_TO_LINEAR_SRGB.T


def encoded_srgb(xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]) -> Float[Array, "*px 3"]:
    """Encoded sRGB, 0 .. 1 in gamut; the linear segment and the power law continue beyond.

    Parameters
    ----------
    xyz, white
        As `linear_srgb`.

    Raises
    ------
    InputError
        If the white is no color that an eye could adapt to.

    Notes
    -----
    IEC 61966-2-1:1999, as `srgb_from_linear`.

    Examples
    --------
    >>> encoded_srgb(np.array([[0.18, 0.18, 0.18], [-0.01, -0.01, -0.01]]), np.ones(3)).round(3)
    array([[ 0.461,  0.461,  0.461],
           [-0.129, -0.129, -0.129]])
    """
    return srgb_from_linear(linear_srgb(xyz, white))


def cielab(xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]) -> Float[Array, "*px 3"]:
    """CIE 1976 L*, a*, b*; the linear segment continues below zero, the cube root above white.

    Parameters
    ----------
    xyz
        In the unit of ``white``.
    white
        XYZ of a perfect white in the same light.

    Raises
    ------
    InputError
        If X, Y or Z of the white is not above 0.

    Notes
    -----
    CIE 015:2018, eq. 8.3-8.8.

    Examples
    --------
    >>> cielab(np.array([0.125, 0.125, 0.125]), np.ones(3))       # 116 / 2 - 16
    array([42.,  0.,  0.])
    """
    return lab_of_cube_roots(_cube_root(xyz / _white(white)))


def cieluv(xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]) -> Float[Array, "*px 3"]:
    """CIE 1976 L*, u*, v*; the linear segment continues below zero, the chromaticity stays finite.

    Parameters
    ----------
    xyz, white
        As `cielab`.

    Raises
    ------
    InputError
        If X, Y or Z of the white is not above 0.

    Notes
    -----
    CIE 015:2018, eq. 8.25-8.30, with 1/d of u' = 4X/d and v' = 9Y/d, d = X + 15 Y + 3 Z, replaced
    by d / max(d^2, a^2/4), where a is d with the absolute values of X, Y, Z. Physical colors are
    unchanged, as d^2 >= a^2/4. Where noise makes d cross zero, the pole of 1/d (which would make
    the variance of u* and v* infinite) is replaced by a line through zero. At black u* = v* = 0,
    and their slope is 0.

    Examples
    --------
    >>> cieluv(np.array([0.125, 0.125, 0.125]), np.ones(3)) + 0.0
    array([42.,  0.,  0.])
    """
    seen, neutral = _chromaticity(xyz), _chromaticity(_white(white))
    lightness = 116 * _cube_root(xyz[..., 1:2] / white[1]) - 16
    seen = np.where((xyz == 0).all(axis=-1, keepdims=True), neutral, seen)
    return np.concatenate([lightness, 13 * lightness * (seen - neutral)], axis=-1)


def _linear_srgb_jacobian(
    xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]
) -> Float[Array, "*px 3 3"]:
    matrix = linear_srgb(np.eye(3), white).T  # linear: its columns are the images of the axes
    return np.broadcast_to(matrix, (*xyz.shape, 3))


def _encoded_srgb_jacobian(
    xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]
) -> Float[Array, "*px 3 3"]:
    slope = srgb_slope(linear_srgb(xyz, white))
    return slope[..., None] * _linear_srgb_jacobian(xyz, white)


def _cielab_jacobian(
    xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]
) -> Float[Array, "*px 3 3"]:
    slope = cube_root_slope(xyz / _white(white)) / white
    return LAB_FROM_CUBE_ROOTS * slope[..., None, :]


def _cieluv_jacobian(
    xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]
) -> Float[Array, "*px 3 3"]:
    black = (xyz == 0).all(axis=-1, keepdims=True)  # the slope of the chromaticity is 0 there
    neutral = _chromaticity(_white(white))
    y = xyz[..., 1:2] / white[1]
    lightness = (116 * _cube_root(y) - 16)[..., None]
    rising = 116 * cube_root_slope(y) * np.array([0.0, 1.0, 0.0]) / white[1]
    away = np.where(black, 0.0, _chromaticity(xyz) - neutral)
    slope = np.array([[4.0], [9.0]]) * _shares_slope(xyz, _UV)
    turning = np.where(black[..., None], 0.0, slope)
    uv = 13 * (away[..., None] * rising[..., None, :] + lightness * turning)
    return np.concatenate([rising[..., None, :], uv], axis=-2)


def _cube_root(t: Array) -> Array:
    """The f of CIELAB."""
    return np.where(t > _DELTA**3, np.cbrt(t), t / (3 * _DELTA**2) + 4 / 29)


def cube_root_slope(t: Float[Array, "*px"]) -> Float[Array, "*px"]:
    """Slope of the f of CIELAB (CIE 015:2018, eq. 8.6-8.8); constant in the linear segment. [1]"""
    return 1 / (3 * np.cbrt(np.maximum(t, _DELTA**3)) ** 2)


def _chromaticity(xyz: Float[Array, "*px 3"]) -> Float[Array, "*px 2"]:
    """u', v' (CIE 015:2018, eq. 8.25 and 8.26)."""
    return np.array([4.0, 9.0]) * _shares(xyz, _UV)


def _shares(xyz: Float[Array, "*px 3"], weights: Float[Array, " 3"]) -> Float[Array, "*px 2"]:
    """X and Y over a weighted sum of X, Y, Z that is kept away from 0."""
    d, size = _sums(xyz, weights)
    return xyz[..., :2] / size * (d / size)


def _shares_slope(
    xyz: Float[Array, "*px 3"], weights: Float[Array, " 3"]
) -> Float[Array, "*px 2 3"]:
    """The Jacobian of `_shares`."""
    d, size = _sums(xyz, weights)
    bent = weights / size**2 - d * weights * np.sign(xyz) / size**3
    slope = np.where(np.abs(d) >= size, -weights / size**2, bent)  # of the reciprocal
    return np.eye(2, 3) * (d / size**2)[..., None] + xyz[..., :2, None] * slope[..., None, :]


def _sums(
    xyz: Float[Array, "*px 3"], weights: Float[Array, " 3"]
) -> tuple[Float[Array, "*px 1"], Float[Array, "*px 1"]]:
    """The weighted sum d, and max(|d|, half the sum of the weighted magnitudes); 1 for black."""
    d, half = (xyz @ weights)[..., None], (np.abs(xyz) @ weights)[..., None] / 2
    return d, np.where(half > 0, np.maximum(np.abs(d), half), 1.0)


def _white(white: Float[Array, " 3"]) -> Float[Array, " 3"]:
    checked = check.finite("white XYZ", "that of the color", white)
    if not (checked > 0).all():
        found = checked.round(4).tolist()
        raise InputError(
            "white",
            "must be > 0 in X, Y and Z",
            value=found,
            found=f"is {found}",
            remedy="take the color of a perfect white in the light of the scene",
        )
    return checked


LINEAR_SRGB = Space(
    name="linear sRGB",
    coordinates=("R", "G", "B"),
    from_xyz=linear_srgb,
    jacobian=_linear_srgb_jacobian,
)
"""Linear sRGB: R, G, B, not clipped."""
SRGB = Space(
    name="sRGB",
    coordinates=("R'", "G'", "B'"),
    from_xyz=encoded_srgb,
    jacobian=_encoded_srgb_jacobian,
)
"""sRGB as it is encoded: R', G', B', not clipped."""
LAB = Space(
    name="CIELAB",
    coordinates=("L*", "a*", "b*"),
    from_xyz=cielab,
    jacobian=_cielab_jacobian,
)
"""CIELAB: L*, a*, b*."""
LUV = Space(
    name="CIELUV",
    coordinates=("L*", "u*", "v*"),
    from_xyz=cieluv,
    jacobian=_cieluv_jacobian,
)
"""CIELUV: L*, u*, v*."""

SPACES: dict[str, Space] = {
    "linear-srgb": LINEAR_SRGB,
    "srgb": SRGB,
    "lab": LAB,
    "luv": LUV,
}
"""Color spaces by their command-line name."""


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
    return np.concatenate([_shares(xyz, np.ones(3)), xyz[..., 1:2]], axis=-1)


def _xyy_jacobian(xyz: Float[Array, "*px 3"], white: Float[Array, " 3"]) -> Float[Array, "*px 3 3"]:
    luminance = np.broadcast_to(np.eye(3)[1], (*xyz.shape[:-1], 1, 3))
    return np.concatenate([_shares_slope(xyz, np.ones(3)), luminance], axis=-2)


XYY = Space(name="xyY", coordinates=("x", "y", "Y"), from_xyz=xyy, jacobian=_xyy_jacobian)
"""Chromaticity and luminance: x, y, Y."""
