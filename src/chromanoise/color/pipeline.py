"""The camera's own pipeline, step by step: each takes a `Measurement` and returns a `Measurement`.

raw, black level subtracted -> white balance diag(g) -> color matrix -> exposure gain -> saturation
-> tone curve -> Y'CbCr. The linear steps compose into one matrix and are exact. The tone curve is
propagated to first order here (`encoded`); `encoded_space` and `rendered_lab_space` join all steps
behind XYZ into a `Space`, for `propagate` with the cubature or the exact distribution.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np

from chromanoise.base import Array, Float, InputError, check, congruence, dataclass, inv
from chromanoise.color.spaces import (
    D65_WHITE,
    LAB,
    XYZ_TO_LINEAR_SRGB,
    Space,
    linear_srgb,
    srgb_from_linear,
    srgb_slope,
)
from chromanoise.noise import Measurement, through

RGB = ("R", "G", "B")
ENCODED_RGB = ("R'", "G'", "B'")
LUMA_CHROMA = ("Y'", "Cb", "Cr")
LumaStandard = Literal["bt709", "bt601"]
LUMA_WEIGHTS = {
    "bt709": np.array([0.2126, 0.7152, 0.0722]),
    "bt601": np.array([0.299, 0.587, 0.114]),
}
"""Luma weights of R', G', B': ITU-R BT.709-6 and BT.601-7. [1]"""

TONES = ("srgb", "rec709", "linear")
"""Names of tone curves; any other curve is a gamma, given as a number."""

_STEEPEST = 1e-6  # a power law has no slope at 0; below this value, the slope at this value
_GAMMA = (0.1, 10.0)
_REC709_TOE = 0.018


# ---- white balance ----


def reference_channel(names: Sequence[str], gray_e: Float[Array, " p"]) -> int:
    """Index of the channel whose gain is 1: the first named G..., else that with most electrons.

    Parameters
    ----------
    names
        Names of the channels.
    gray_e
        Electrons of a gray in each channel. [e-]
    """
    green = [i for i, name in enumerate(names) if name.lower().startswith("g")]
    return green[0] if green else int(np.argmax(gray_e))


def gray_gains(gray_e: Float[Array, " p"], names: Sequence[str]) -> Float[Array, " p"]:
    """White balance gains that make the raw of a gray equal in all channels: g_i = m_ref / m_i.

    Parameters
    ----------
    gray_e
        Raw of the gray, black level subtracted. [e-]
    names
        Of the channels; the gain of `reference_channel` is 1.

    Raises
    ------
    InputError
        If a channel has no signal on the gray, so that no gain balances it.

    Examples
    --------
    >>> gray_gains(np.array([50.0, 100.0, 25.0]), ("R", "G", "B"))
    array([2., 1., 4.])
    """
    gray = check.finite("gray", "e-", gray_e)
    check.same_length("channels", gray_e=gray.size, names=len(names))
    dark = [(name, float(m)) for name, m in zip(names, gray, strict=True) if not m > 0]
    if dark:
        raise InputError(
            "white_balance",
            "must have signal in every channel of the gray [e-]",
            value=dark[0][1],
            found=f"channel {dark[0][0]} has {dark[0][1]:.4g} e-, so no gain balances it",
            remedy="omit the channel, or give the gains as numbers",
        )
    return np.asarray(gray[reference_channel(names, gray)] / gray)


def checked_gains(gains: Sequence[float], names: Sequence[str]) -> Float[Array, " p"]:
    """Given gains, one above 0 per channel.

    Parameters
    ----------
    gains
        The given gains. [1]
    names
        Names of the channels.

    Raises
    ------
    InputError
        If their number is not that of the channels, or one is not finite and above 0.
    """
    given = np.asarray(gains, dtype=np.float64)
    if given.shape != (len(names),):
        raise InputError(
            "white_balance",
            "must have one gain per channel",
            value=tuple(given.ravel().tolist()),
            found=f"has {given.size}, and the channels are {', '.join(names)}",
        )
    for name, gain in zip(names, given.tolist(), strict=True):
        if not (np.isfinite(gain) and gain > 0):
            raise InputError(
                "white_balance",
                "must have finite gains > 0 [1]",
                value=gain,
                found=f"that of channel {name} is {gain:g}, which makes it singular",
            )
    return given


def gains_covariance(gray: Measurement, pixels: int) -> Float[Array, "p p"]:
    """Covariance of gains that are estimated from the mean of n gray pixels, by the delta method.

    Parameters
    ----------
    gray
        Raw of one gray pixel: mean m and covariance S. [e-]
    pixels
        Number n of gray pixels per channel; their noise is independent.

    Raises
    ------
    InputError
        As `gray_gains`, or if there is no pixel.

    Notes
    -----
    g_i = m_ref / m_i, so dg_i/dm_ref = 1 / m_i and dg_i/dm_i = -m_ref / m_i^2; the covariance is
    J S J^T / n (JCGM 102:2011, 6.2). The error is common to all pixels of the picture: it does not
    average out.

    Examples
    --------
    Two channels of 100 e- with variance 100: relative variance 1 % each, over 4 pixels.

    >>> gray = Measurement(mean=np.array([100.0, 100.0]), covariance=np.diag([100.0, 100.0]),
    ...                    names=("G", "R"), kind="raw", unit="e-")
    >>> gains_covariance(gray, 4) + 0.0
    array([[0.   , 0.   ],
           [0.   , 0.005]])
    """
    check.at_least_one("white_balance_pixels", pixels)
    gains = gray_gains(gray.mean, gray.names)
    reference = reference_channel(gray.names, gray.mean)
    slope = -np.diag(gains / gray.mean)
    slope[:, reference] += 1 / gray.mean
    return np.asarray(congruence(slope, gray.covariance) / pixels)


# ---- steps on a measurement ----


def black_subtracted(raw: Measurement, error_e: float) -> Measurement:
    """The raw after the black level is subtracted with an error: a bias of every channel. [e-]

    Parameters
    ----------
    raw
        Mean and covariance of the raw channels. [e-]
    error_e
        Error of the subtracted black level. [e-]
    """
    return replace(raw, mean=raw.mean + error_e) if error_e else raw


def white_balanced(raw: Measurement, gains: Float[Array, " p"]) -> Measurement:
    """The raw times one gain per channel: camera RGB. [e-]

    Parameters
    ----------
    raw
        Raw values without the black level.
    gains
        As from `gray_gains` or `checked_gains`.
    """
    own = raw.reading_variance
    found = through(raw, np.diag(gains), names=raw.names, kind="white-balanced raw", unit=raw.unit)
    return found if own is None else replace(found, reading_variance=own * gains**2)


def matrix_for_balanced(
    matrix: Float[Array, "c p"], gains: Float[Array, " p"]
) -> Float[Array, "c p"]:
    """The matrix for white-balanced raw that agrees with one for raw: C diag(1/g).

    Parameters
    ----------
    matrix
        Matrix for raw values. [lx/e-]
    gains
        White balance gains, one per channel. [1]
    """
    return np.asarray(matrix / gains)


def with_exposure_gain(rgb: Measurement, gain: float) -> Measurement:
    """Linear RGB times one gain.

    Parameters
    ----------
    rgb
        Mean and covariance of R, G, B. [1]
    gain
        The gain. [1]
    """
    return through(
        rgb, gain * np.eye(len(rgb.names)), names=rgb.names, kind=rgb.kind, unit=rgb.unit
    )


def saturation_matrix(saturation: float) -> Float[Array, "3 3"]:
    """Linear RGB with the distance to its Rec. 709 luminance scaled: s I + (1 - s) 1 w^T.

    Parameters
    ----------
    saturation
        s >= 0: 0 gives gray, 1 changes nothing.

    Raises
    ------
    InputError
        If it is negative or not finite.

    Notes
    -----
    P. Haeberli, Matrix Operations for Image Processing (1993), with the weights of ITU-R BT.709-6.

    Examples
    --------
    >>> saturation_matrix(0.0) @ np.array([1.0, 0.0, 0.0])
    array([0.2126, 0.2126, 0.2126])
    """
    s = check.not_negative("saturation", "1", saturation)
    return np.asarray(s * np.eye(3) + (1 - s) * LUMA_WEIGHTS["bt709"])


def with_saturation(rgb: Measurement, saturation: float) -> Measurement:
    """Linear RGB through `saturation_matrix`.

    Parameters
    ----------
    rgb
        Mean and covariance of R, G, B. [1]
    saturation
        Scale of the distance of linear R, G, B to their luminance. [1]
    """
    return through(
        rgb, saturation_matrix(saturation), names=rgb.names, kind=rgb.kind, unit=rgb.unit
    )


@dataclass(frozen=True, kw_only=True)
class ToneCurve:
    """A tone curve with its slope; both continue below 0 and above 1 without clipping.

    Attributes
    ----------
    name
        Of its result, e.g. "sRGB".
    of, slope
        From linear values to encoded ones, and to the derivative.
    """

    name: str
    of: Callable[[Array], Array]
    slope: Callable[[Array], Array]


def tone_curve(tone: str | float) -> ToneCurve:
    """A tone curve by name, or the power law x^(1/gamma) by its gamma.

    Parameters
    ----------
    tone
        ``srgb``, ``rec709``, ``linear``, or a gamma from 0.1 to 10.

    Raises
    ------
    InputError
        If the name is unknown, or the gamma out of range.

    Notes
    -----
    IEC 61966-2-1:1999; ITU-R BT.709-6. Below 0 their lines continue, and a power law is odd. Its
    slope at 0 is infinite; below 1e-6 the slope at 1e-6 is used.

    Examples
    --------
    >>> [tone_curve(tone).of(np.array([0.25])).round(4).item() for tone in (*TONES, 2.0)]
    [0.5371, 0.4899, 0.25, 0.5]
    """
    if isinstance(tone, str):
        return _NAMED[check.one_of("tone", tone, TONES)]
    gamma = check.within("tone", "as a gamma", tone, *_GAMMA)
    return ToneCurve(
        name=f"gamma {gamma:g}",
        of=partial(_power, exponent=1 / gamma),
        slope=partial(_power_slope, exponent=1 / gamma),
    )


def encoded(rgb: Measurement, curve: ToneCurve) -> Measurement:
    """Encoded RGB to first order: covariance J S J^T with the slopes at the mean.

    Parameters
    ----------
    rgb
        Mean and covariance of linear R, G, B. [1]
    """
    slope = curve.slope(rgb.mean)
    return Measurement(
        mean=curve.of(rgb.mean),
        covariance=slope[..., :, None] * rgb.covariance * slope[..., None, :],
        names=ENCODED_RGB,
        kind=curve.name,
        unit="1",
    )


def luma_chroma_matrix(standard: LumaStandard = "bt709") -> Float[Array, "3 3"]:
    """From R', G', B' to Y', Cb, Cr, full range: Y' in 0 .. 1, Cb and Cr in -0.5 .. 0.5.

    Parameters
    ----------
    standard
        ``bt709`` or ``bt601`` (JPEG).

    Raises
    ------
    InputError
        If there is no such standard.

    Notes
    -----
    ITU-R BT.709-6, 3.2-3.3, and BT.601-7: Y' = w R'G'B', Cb = (B' - Y') / (2 - 2 w_B),
    Cr = (R' - Y') / (2 - 2 w_R).

    Examples
    --------
    >>> luma_chroma_matrix("bt601").round(4)[1]
    array([-0.1687, -0.3313,  0.5   ])
    """
    luma = LUMA_WEIGHTS[check.one_of("luma", standard, tuple(LUMA_WEIGHTS))]
    red, _, blue = np.eye(3)
    return np.stack([luma, (blue - luma) / (2 - 2 * luma[2]), (red - luma) / (2 - 2 * luma[0])])


def luma_chroma(rgb: Measurement, standard: LumaStandard = "bt709") -> Measurement:
    """Encoded RGB as Y', Cb, Cr.

    Parameters
    ----------
    rgb
        Mean and covariance of encoded R, G, B. [1]
    standard
        Weights of the luma: ``bt709`` or ``bt601``.
    """
    return through(
        rgb, luma_chroma_matrix(standard), names=LUMA_CHROMA, kind="Y'CbCr", unit=rgb.unit
    )


# ---- all steps behind XYZ as one space ----


def rendering_matrix(
    white: Float[Array, " 3"], *, exposure_gain: float = 1.0, saturation: float = 1.0
) -> Float[Array, "3 3"]:
    """From XYZ to linear sRGB after exposure gain and saturation: the linear steps, composed.

    Parameters
    ----------
    white
        XYZ of a perfect white, adapted to D65 by Bradford, as `linear_srgb`.
    exposure_gain, saturation
        Of these two steps.

    Raises
    ------
    InputError
        As `linear_srgb` and `saturation_matrix`, or if the gain is not above 0.
    """
    gain = check.positive("exposure_gain", "1", exposure_gain)
    return np.asarray(gain * saturation_matrix(saturation) @ linear_srgb(np.eye(3), white).T)


def encoded_space(curve: ToneCurve, *, exposure_gain: float, saturation: float) -> Space:
    """XYZ to encoded RGB as a `Space`: all steps from the color matrix to the tone curve.

    Parameters
    ----------
    exposure_gain
        Gain of linear R, G, B. [1]
    saturation
        Scale of the distance of linear R, G, B to their luminance. [1]
    """
    steps = partial(rendering_matrix, exposure_gain=exposure_gain, saturation=saturation)

    def from_xyz(xyz: Array, white: Array) -> Array:
        return curve.of(xyz @ steps(white).T)

    def jacobian(xyz: Array, white: Array) -> Array:
        matrix = steps(white)
        return np.asarray(curve.slope(xyz @ matrix.T)[..., None] * matrix)

    return Space(name=curve.name, coordinates=ENCODED_RGB, from_xyz=from_xyz, jacobian=jacobian)


def rendered_lab_space(*, exposure_gain: float, saturation: float) -> Space:
    """XYZ to the CIELAB of the rendered picture as a `Space`.

    The display undoes the tone curve, so the color is that of linear sRGB after exposure gain and
    saturation, relative to D65.

    Parameters
    ----------
    exposure_gain
        Gain of linear R, G, B. [1]
    saturation
        Scale of the distance of linear R, G, B to their luminance. [1]
    """

    def rendered(white: Array) -> Array:
        steps = rendering_matrix(white, exposure_gain=exposure_gain, saturation=saturation)
        return inv("XYZ_TO_LINEAR_SRGB", XYZ_TO_LINEAR_SRGB) @ steps

    def from_xyz(xyz: Array, white: Array) -> Array:
        return LAB.from_xyz(xyz @ rendered(white).T, D65_WHITE)

    def jacobian(xyz: Array, white: Array) -> Array:
        matrix = rendered(white)
        return np.asarray(LAB.jacobian(xyz @ matrix.T, D65_WHITE) @ matrix)

    return Space(name=LAB.name, coordinates=LAB.coordinates, from_xyz=from_xyz, jacobian=jacobian)


def _rec709(x: Array) -> Array:
    return np.where(x < _REC709_TOE, 4.5 * x, 1.099 * np.maximum(x, _REC709_TOE) ** 0.45 - 0.099)


def _rec709_slope(x: Array) -> Array:
    return np.where(x < _REC709_TOE, 4.5, 1.099 * 0.45 * np.maximum(x, _REC709_TOE) ** -0.55)


def _power(x: Array, *, exponent: float) -> Array:
    return np.asarray(np.sign(x) * np.abs(x) ** exponent)


def _power_slope(x: Array, *, exponent: float) -> Array:
    return np.asarray(exponent * np.maximum(np.abs(x), _STEEPEST) ** (exponent - 1))


_NAMED = {
    "srgb": ToneCurve(name="sRGB", of=srgb_from_linear, slope=srgb_slope),
    "rec709": ToneCurve(name="Rec. 709", of=_rec709, slope=_rec709_slope),
    "linear": ToneCurve(name="linear", of=np.array, slope=np.ones_like),
}
