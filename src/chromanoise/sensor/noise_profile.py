"""The noise profile of DNG and Android, variance = S x + O, and the pixel derived from it.

x is 0 at the black level and 1 at the white level; the variance is in the square of this unit.
"""

from collections.abc import Sequence

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.sensor.adc import Adc
from chromanoise.sensor.pixel_source import PixelSource
from chromanoise.sensor.variance_law import VarianceLaw

ROUNDING_DN2 = 1 / 12
"""Variance that rounding to whole codes adds (Sheppard). [DN^2]"""

_ALIKE = 0.05  # S of channels with the same converter differs by less than this
_RANGE = "{}: {:.4g} e- lie between black and white; the full well may be larger"


def noise_profile(
    adc: Adc, *, read_noise_e: float, white_level_dn: int | None = None
) -> Float[Array, " 2"]:
    """S and O of the noise of a code, variance = S x + O, x = 0 at black and 1 at the white level.

    Parameters
    ----------
    adc
        Gain, black level and top code.
    read_noise_e
        Standard deviation of all noise without light. [e-]
    white_level_dn
        Code at which the pixel saturates; the top code if ``None``. [DN]

    Raises
    ------
    InputError
        If the read noise is negative or not finite.

    Notes
    -----
    DNG 1.4, tag 51041. Shot noise of y codes above black has the variance y / K (codes squared),
    readout (sigma / K)^2 and rounding 1 / 12, with K electrons per code (EMVA 1288, release 4.0,
    the linear camera model); y = R x, with R codes from black to white.

    Examples
    --------
    >>> noise_profile(Adc(bits=8, gain_e_per_dn=2.0, black_level_dn=55), read_noise_e=40.0).round(4)
    array([0.0025, 0.01  ])
    """
    read = _check.not_negative("read_noise_e", "e-", read_noise_e) / adc.gain_e_per_dn
    white_level_dn = adc.top_code if white_level_dn is None else white_level_dn
    of_codes = VarianceLaw(floor_e2=read**2 + ROUNDING_DN2, slope_e=1 / adc.gain_e_per_dn)
    return shot_and_dark(of_codes.in_units_of(white_level_dn - adc.black_level_dn))


def shot_and_dark(law: VarianceLaw) -> Float[Array, "*p 2"]:
    """S and O of a law in units of the range from black to white. [1]

    Parameters
    ----------
    law
        `VarianceLaw.in_units_of` this range; PRNU is left out.

    Examples
    --------
    >>> shot_and_dark(VarianceLaw(floor_e2=9.0, slope_e=1.0).in_units_of(1000.0)).tolist()
    [0.001, 9e-06]
    """
    return law.coefficients[[1, 0]].T


def pixel_from_noise_profile(
    profile: Float[Array, "p 2"],
    *,
    black_level_dn: float,
    white_level_dn: float,
    channels: Sequence[str] = (),
    source: str = "noise profile",
) -> PixelSource:
    """Gain and read noise of the pixel with this noise profile: the inverse of `noise_profile`.

    Parameters
    ----------
    profile
        S and O of each channel. [1]
    black_level_dn, white_level_dn
        Codes of x = 0 and x = 1. [DN]
    channels
        Their names, for messages; their indices (from 0) if not given.
    source
        Where the numbers come from.

    Raises
    ------
    InputError
        If S is not above 0, a number is not finite, white is not above black, or the channels
        differ in S by more than 5 %, which means that codes and noise were multiplied by a gain.

    Notes
    -----
    1 / S = electrons from black to white; the dark variance in codes is O R^2 = (sigma / K)^2
    + 1 / 12. Gain and read noise are those of the mean S and O. A profile does not contain the full
    well: at a high gain (ISO) the codes reach the white level far below the full well.

    Examples
    --------
    >>> source = pixel_from_noise_profile(np.array([[0.0025, 0.0100021]]),
    ...                                   black_level_dn=55, white_level_dn=255)
    >>> source.gain_e_per_dn, round(source.read_noise_e, 3)
    (2.0, 40.0)
    """
    shot, dark = _of_all_channels(profile, channels, black_level_dn, white_level_dn, source)
    range_dn = float(white_level_dn) - float(black_level_dn)
    gain = 1 / (shot * range_dn)
    read_dn2 = dark * range_dn**2 - ROUNDING_DN2
    adc, notes = _converter(gain, float(black_level_dn), float(white_level_dn), source)
    remarks = [_RANGE.format(source, 1 / shot)]
    if read_dn2 < 0:
        remarks.append(
            f"{source}: O is {dark:.3g}, less than rounding alone makes "
            f"({ROUNDING_DN2 / range_dn**2:.3g}), so the read noise is unknown"
        )
    return PixelSource(
        source=source,
        read_noise_e=gain * float(np.sqrt(read_dn2)) if read_dn2 >= 0 else None,
        gain_e_per_dn=gain,
        adc=adc,
        notes=(*remarks, *notes),
    )


def pixel_without_levels(
    profile: Float[Array, "p 2"], *, channels: Sequence[str] = (), source: str = "noise profile"
) -> PixelSource:
    """Read noise from a profile without levels, in electrons, rounding to codes included.

    Parameters
    ----------
    profile
        S and O of each channel. [1]
    channels
        As `pixel_from_noise_profile`.
    source
        Where the numbers come from.

    Raises
    ------
    InputError
        As `pixel_from_noise_profile`.

    Notes
    -----
    1 / S electrons lie between black and white, so O = (sigma S)^2; black and white level
    would give the gain, and with it the part of O that is rounding.

    Examples
    --------
    >>> round(pixel_without_levels(np.array([[2e-4, 1e-6]])).read_noise_e, 9)    # 5000 e- sqrt(O)
    5.0
    """
    shot, dark = _of_all_channels(profile, channels, 0.0, 1.0, source)
    _check.not_negative(f"O of {source}", "1", dark)
    return PixelSource(
        source=source,
        read_noise_e=float(np.sqrt(dark)) / shot,
        notes=(
            _RANGE.format(source, 1 / shot),
            f"{source}: has no BlackLevel and WhiteLevel, so its gain stays unknown and the read "
            "noise includes rounding to codes",
        ),
    )


def _of_all_channels(
    profile: Array, channels: Sequence[str], black_dn: float, white_dn: float, source: str
) -> tuple[float, float]:
    """Mean S and O of the channels, which must be those of one converter."""
    values = _check.finite(f"noise profile of {source}", "1", profile)
    names = tuple(channels) or tuple(str(i) for i in range(len(values)))
    _check.same_length("channels", profile=len(values), names=len(names))
    if values.ndim != 2 or values.shape[1] != 2 or not len(values):
        raise InputError(
            source,
            "must give S and O of each channel",
            value=values.shape,
            found=f"its profile has shape {values.shape}",
        )
    for name, (shot, _) in zip(names, values.tolist(), strict=True):
        _check.within(f"S of channel {name} of {source}", "1", shot, 1e-15, 1e3)
    _check.not_negative(f"black level of {source}", "DN", black_dn)
    _check.within(f"white level of {source}", "DN", white_dn, 1.0, 1e9)
    _check.positive(f"white minus black level of {source}", "DN", white_dn - black_dn)
    shots = values[:, 0]
    if shots.max() > (1 + _ALIKE) * shots.min():
        listed = ", ".join(f"{n} {s:.3g}" for n, s in zip(names, shots.tolist(), strict=True))
        raise InputError(
            source,
            "must have the same S in all channels",
            value=dict(zip(names, shots.tolist(), strict=True)),
            found=f"S is {listed}, so the codes were multiplied, as by a white balance",
            remedy="give S and O of one channel that was not multiplied, usually green",
        )
    shot, dark = values.mean(axis=0).tolist()
    return shot, dark


def _converter(
    gain: float, black_dn: float, white_dn: float, source: str
) -> tuple[Adc | None, tuple[str, ...]]:
    """A converter with the bits that the white level needs, and notes on doubts."""
    bits = max(8, int(np.ceil(np.log2(white_dn + 1))))
    if bits > 16 or not black_dn.is_integer():
        return None, (
            f"{source}: levels of {black_dn:g} and {white_dn:g} DN do not fit a converter of 8 to "
            "16 bits with an integer black level; give its bits and black level",
        )
    adc = Adc(bits=bits, gain_e_per_dn=gain, black_level_dn=int(black_dn))
    if adc.top_code == white_dn:
        return adc, ()
    return adc, (
        f"{source}: white level {white_dn:g} implies {bits} bits (top code {adc.top_code})",
    )
