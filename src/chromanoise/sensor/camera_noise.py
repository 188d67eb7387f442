"""Noise of a camera in codes, and its sources: noise profiles of DNG and Android, and ELD.

A noise profile is variance = S x + O: x is 0 at the black level and 1 at the white level; the
variance is in the square of this unit. `pixel_from_noise_profile` derives a pixel from it. ELD's
calibration is the dictionary of a file ``camera_params/*.npy``.

A sampler of training data needs the noise in codes, per channel of a mosaic. `Pixel` has one design
for all channels and one gain. A camera that was measured, or calibrated in the way of ELD, has a
gain and a read noise for each channel, and changes them with the ISO setting.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, Literal, cast, get_args

import numpy as np

from chromanoise.base import Array, Float, InputError, Setting, check, dataclass
from chromanoise.sensor.changes import PixelSource
from chromanoise.sensor.crosstalk import Mosaic
from chromanoise.sensor.noise_sources import (
    LARGEST_LAMBDA,
    LEAST_LAMBDA,
    MOST_DN,
    MOST_E,
    LogLinearNoise,
    PixelReading,
    ReadNoiseLaw,
    ReadNoiseTable,
    VarianceLaw,
    above_zero,
    tukey_lambda_variance,
)
from chromanoise.sensor.pixel import PIXEL, PIXEL_NOISE, Adc, adc_of
from chromanoise.sensor.sensor import Sensor

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
    read = check.not_negative("read_noise_e", "e-", read_noise_e) / adc.gain_e_per_dn
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
    profile: Float[Array, "p 2"], *, source: str = "noise profile"
) -> PixelSource:
    """Read noise from a profile without levels, in electrons, rounding to codes included.

    Parameters
    ----------
    profile
        S and O of each channel. [1]
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
    shot, dark = _of_all_channels(profile, (), 0.0, 1.0, source)
    check.not_negative(f"O of {source}", "1", dark)
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
    values = check.finite(f"noise profile of {source}", "1", profile)
    names = tuple(channels) or tuple(str(i) for i in range(len(values)))
    check.same_length("channels", profile=len(values), names=len(names))
    if values.ndim != 2 or values.shape[1] != 2 or not len(values):
        raise InputError(
            source,
            "must give S and O of each channel",
            value=values.shape,
            found=f"its profile has shape {values.shape}",
        )
    for name, (shot, _) in zip(names, values.tolist(), strict=True):
        check.within(f"S of channel {name} of {source}", "1", shot, 1e-15, 1e3)
    check.not_negative(f"black level of {source}", "DN", black_dn)
    check.within(f"white level of {source}", "DN", white_dn, 1.0, 1e9)
    check.positive(f"white minus black level of {source}", "DN", white_dn - black_dn)
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


ReadNoiseShape = Literal["tukey-lambda", "gaussian"]
"""Distribution of ELD's read noise."""


def eld_noise(
    params: Mapping[str, Any], *, read: ReadNoiseShape, profile: str
) -> tuple[tuple[float, float], dict[str, Any]]:
    """The range of the gain [DN/e-], and fields of `CameraNoise`, of the parameters of ELD.

    Parameters
    ----------
    params, read, profile
        As `CameraNoise.from_eld`.

    Raises
    ------
    InputError
        If a key is missing or a value is not as described.

    Notes
    -----
    Wei, Fu, Yang & Huang, CVPR (2020), eqs. 8-11.
    """
    read = cast(ReadNoiseShape, check.one_of("read", read, get_args(ReadNoiseShape)))
    one = _mapping(params, profile)
    low, high = _number(params, "Kmin"), _number(params, "Kmax")
    if not 0 < low <= high:
        raise _of_eld(
            "must have 0 < Kmin <= Kmax [DN/e-]",
            value=(low, high),
            found=f"have Kmin = {low:g} and Kmax = {high:g}",
            remedy="give K, not its logarithm",
        )
    heavy = read == "tukey-lambda"
    if heavy and ("G_shape" not in params or "G_scale" not in one):
        missing = "G_scale" if "G_shape" in params else "G_shape"
        raise _of_eld(
            f"must have {missing} for Tukey lambda read noise",
            found="do not",
            remedy=Setting("read", ("gaussian",)),
        )
    shapes = _row_of_numbers(params, "G_shape") if heavy else ()
    offsets = None
    if params.get("color_bias") is not None:
        given = check.finite("color_bias", "DN", params["color_bias"])
        rows = given.ndim == 2 and given.shape[1] == 4
        check.shape("color_bias", given, rows, "must have rows of 4 values: R, G1, B, G2 [DN]")
        offsets = given[:, [0, 1, 3, 2]]
    return (low, high), {
        "tail_lambda": shapes,
        "read_noise_law": _log_linear(one, "G_scale" if heavy else "g_scale", tukey_scale=heavy),
        "row_noise_law": _log_linear(one, "R_scale") if "R_scale" in one else None,
        "black_offsets_dn": offsets,
    }


def _of_eld(requirement: str, **facts: Any) -> InputError:
    return InputError("ELD parameters", requirement, **facts)


def _mapping(params: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    found = params.get(key) if isinstance(params, Mapping) else None
    if not isinstance(found, Mapping):
        raise _of_eld(
            f"must be a dictionary with the dictionary {key}",
            value=type(params).__name__,
            found=f"have no {key}" if isinstance(params, Mapping) else None,
            remedy="take np.load(file, allow_pickle=True).item() of a file that you trust",
        )
    return found


def _number(params: Mapping[str, Any], key: str, where: str = "") -> float:
    place = f"{where}.{key}" if where else key
    if key not in params:
        raise _of_eld(f"must have {place}", found="do not")
    try:
        number = float(params[key])
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise _of_eld("must be a finite number", value=params[key], where=place)
    return number


def _row_of_numbers(params: Mapping[str, Any], key: str) -> tuple[float, ...]:
    try:
        array = np.atleast_1d(np.asarray(params[key], dtype=np.float64))
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 1 or not array.size:
        raise _of_eld("must be one or more numbers", value=params[key], where=key)
    return tuple(array.tolist())


def _log_linear(
    profile: Mapping[str, Any], key: str, *, tukey_scale: bool = False
) -> LogLinearNoise:
    found = profile.get(key)
    if not isinstance(found, Mapping):
        raise _of_eld(
            f"must have {key} with slope, bias and sigma",
            value=found,
            found=f"have no {key}" if found is None else "",
        )
    values = {name: _number(found, name, key) for name in ("slope", "bias", "sigma")}
    return LogLinearNoise(**values, tukey_scale=tukey_scale)


_MOST_GAIN = 1e9


@dataclass(frozen=True, kw_only=True, eq=False)
class CameraNoise:
    """Noise of a camera at one ISO setting, and how it changes with the gain.

    code = black level + K (electrons - mean dark electrons), rounded and clipped to 0 .. top code.

    Attributes
    ----------
    gain_dn_per_e
        Gain K of each channel at ``iso``, > 0. [DN/e-]
    read_noise_e
        Standard deviation of the readout of each channel at ``iso``, rounding not included. [e-]
    black_level_dn
        Mean code without light, of each channel. [DN]
    top_code_dn
        Largest code: the white level. [DN]
    mosaic
        The channel of each pixel; ``None`` for a monochrome camera, or for one that measures all
        channels in each pixel.
    iso
        ISO setting of ``gain_dn_per_e``; ``None`` if not known. [1]
    full_well_e
        Electrons at which a pixel saturates, dark electrons included; ``None`` if the top code is
        lower. [e-]
    dark_current_e_per_s
        Dark electrons per second; their mean is subtracted from the codes. [e-/s]
    dsnu_e
        Standard deviation of the dark signal over the pixels. [e-]
    prnu
        Standard deviation of the sensitivity over the pixels. [1]
    row_noise_e
        Standard deviation of the offset that all pixels of a row share, new in each frame. [e-]
    column_noise_e
        The same of the pixels of a column. [e-]
    rtn_share, rtn_amplitude_e
        Random telegraph noise: share of the pixels that switch between two levels, and the
        difference between the levels. [1], [e-]
    tail_lambda
        Shapes of the Tukey lambda distribution of the read noise, one of which is used per item;
        empty for normal read noise. The variance is ``read_noise_e`` squared for every shape. [1]
    read_noise_law, row_noise_law, column_noise_law, dsnu_law
        Noise in DN as a function of the gain. Without ``read_noise_law``, a camera has only one
        ISO setting; without the others, row noise, column noise and DSNU in electrons are equal at
        all gains.
    gain_range_dn_per_e
        Lowest and highest gain drawn for an item; ``None`` if items use that at ``iso``. [DN/e-]
    black_offsets_dn
        Measured deviations of the black levels (ELD's color bias), (n, p): each item uses one of
        the n rows. ``None`` for no deviation. [DN]

    Raises
    ------
    InputError
        If a number is out of range, the channels are not those of the mosaic, or the lengths
        differ.

    Notes
    -----
    Names as in EMVA 1288, release 4.0; tails, laws and color bias as Wei, Fu, Yang & Huang, CVPR
    (2020).

    Examples
    --------
    >>> from chromanoise.sensor import ReadNoiseSum, bayer
    >>> camera = CameraNoise(names=("R", "G", "B"), mosaic=bayer(), top_code_dn=1023, iso=100,
    ...     gain_dn_per_e=np.array([0.25, 0.25, 0.25]), read_noise_e=np.array([3.0, 3.0, 3.0]),
    ...     black_level_dn=np.array([64.0, 64.0, 64.0]),
    ...     read_noise_law=ReadNoiseSum(after_gain_dn=0.6, before_gain_e=1.8))
    >>> camera.at_iso(400).gain_dn_per_e, camera.at_iso(400).read_noise_e.round(3)
    (array([1., 1., 1.]), array([1.897, 1.897, 1.897]))
    """

    names: tuple[str, ...]
    gain_dn_per_e: Float[Array, " p"]
    read_noise_e: Float[Array, " p"]
    black_level_dn: Float[Array, " p"]
    top_code_dn: float
    mosaic: Mosaic | None = None
    iso: float | None = None
    full_well_e: float | None = None
    dark_current_e_per_s: float = 0.0
    dsnu_e: float = 0.0
    prnu: float = 0.0
    row_noise_e: float = 0.0
    column_noise_e: float = 0.0
    rtn_share: float = 0.0
    rtn_amplitude_e: float = 0.0
    tail_lambda: tuple[float, ...] = ()
    read_noise_law: ReadNoiseLaw | None = None
    row_noise_law: LogLinearNoise | ReadNoiseTable | None = None
    column_noise_law: ReadNoiseTable | None = None
    dsnu_law: ReadNoiseTable | None = None
    gain_range_dn_per_e: tuple[float, float] | None = None
    black_offsets_dn: Float[Array, "n p"] | None = None

    def __post_init__(self) -> None:
        names = check.distinct("channel names", self.names)
        if not names:
            raise InputError("channel names", "must name at least one channel", value=())
        object.__setattr__(self, "names", names)
        if self.mosaic is not None and set(self.mosaic.names) != set(names):
            raise InputError(
                "mosaic",
                f"must have the channels {', '.join(names)}",
                value=self.mosaic.names,
                found=f"has {', '.join(self.mosaic.names)}",
            )
        gain = self._per_channel("gain_dn_per_e", "DN/e-", _MOST_GAIN)
        above_zero("gain_dn_per_e", "DN/e-", gain)
        self._per_channel("read_noise_e", "e-", MOST_E)
        top = check.within("top_code_dn", "DN", self.top_code_dn, 1, MOST_DN)
        if int(top) != top:
            raise InputError("top_code_dn", "must be a whole number [DN]", value=top)
        black = self._per_channel("black_level_dn", "DN", MOST_DN)
        if (black >= top).any():
            raise InputError(
                "black_level_dn",
                f"must be below the top code of {top:g} [DN]",
                value=float(black[black >= top][0]),
            )
        if self.iso is not None:
            check.within("iso", "1", self.iso, 1e-3, 1e9)
        if self.full_well_e is not None:
            check.within("full_well_e", "e-", self.full_well_e, 1e-3, MOST_E)
        for name in _PLAIN:
            PIXEL[name].demand(name, getattr(self, name))
        self._check_laws()

    def _check_laws(self) -> None:
        shapes = tuple(float(one) for one in self.tail_lambda)
        for one in shapes:
            check.within("tail_lambda", "1", one, LEAST_LAMBDA, LARGEST_LAMBDA)
        object.__setattr__(self, "tail_lambda", shapes)
        law = self.read_noise_law
        if isinstance(law, LogLinearNoise) and law.tukey_scale and not shapes:
            raise InputError(
                "tail_lambda", "must be given, because the read noise is a Tukey lambda scale"
            )
        if self.gain_range_dn_per_e is not None:
            low, high = (float(one) for one in self.gain_range_dn_per_e)
            check.within("lowest gain", "DN/e-", low, 1e-9, _MOST_GAIN)
            check.within("highest gain", "DN/e-", high, low, _MOST_GAIN)
            if law is None:
                raise InputError(
                    "read_noise_law",
                    "must be given, because items have different gains",
                    remedy=Setting("read_noise_law"),
                )
        if self.black_offsets_dn is not None:
            offsets = check.finite("black_offsets_dn", "DN", self.black_offsets_dn)
            count = len(self.names)
            rows = offsets.ndim == 2 and offsets.size > 0 and offsets.shape[1] == count
            need = f"must have rows of {count} values, one per channel"
            check.shape("black_offsets_dn", offsets, rows, need)
            check.keep(self, black_offsets_dn=offsets)

    def _per_channel(self, name: str, unit: str, most: float) -> Array:
        values = check.non_negative(name, unit, getattr(self, name))
        count = len(self.names)
        need = f"must have one value for each of {count} channels [{unit}]"
        check.shape(name, values, values.shape == (count,), need)
        if (values > most).any():
            raise InputError(name, f"must be at most {most:g} [{unit}]", value=float(values.max()))
        check.keep(self, **{name: values})
        return values

    def at_iso(self, iso: float) -> "CameraNoise":
        """The camera at another ISO setting, to which the gain is proportional.

        Parameters
        ----------
        iso
            ISO setting, > 0; any number. [1]

        Returns
        -------
        CameraNoise
            With the gain and the read noise of this setting; noise that scatters about its law
            has its median.

        Raises
        ------
        InputError
            If the ISO setting of the camera, or the law of its read noise, is not known.

        Notes
        -----
        ISO 12232 (2019): the analog gain, and so K of EMVA 1288, is proportional to the setting.
        The black level in DN does not depend on it.
        """
        iso = check.within("iso", "1", iso, 1e-3, 1e9)
        if self.iso is None:
            raise InputError(
                "iso",
                "must be absent for a camera whose own ISO is not known",
                value=iso,
                remedy="give the camera its ISO",
            )
        if iso == self.iso:
            return replace(self, gain_range_dn_per_e=None)
        return replace(self.at_gain(self.gain_dn_per_e * (iso / self.iso)), iso=iso)

    def at_gain(
        self,
        gain_dn_per_e: Float[Array, " p"],
        *,
        read_score: float = 0.0,
        row_score: float = 0.0,
        tail_lambda: float | None = None,
    ) -> "CameraNoise":
        """The camera at another gain.

        Parameters
        ----------
        gain_dn_per_e
            Gain per channel. [DN/e-]
        read_score, row_score
            Deviation of the logarithm of the noise from its law, in standard deviations. [1]
        tail_lambda
            The shape of the read noise; ``None`` for the first of the camera.

        Returns
        -------
        CameraNoise
            With one shape, and no range of gains.

        Raises
        ------
        InputError
            If the law of the read noise is not known, or a gain is outside its table.

        Notes
        -----
        A read noise given as a Tukey lambda scale s is s sqrt(variance of scale 1): see Joiner &
        Rosenblatt, JASA 66 (1971) 394.
        """
        if self.read_noise_law is None:
            raise InputError(
                "iso",
                "must be that of the camera, because its read noise at other gains is not known",
                value=None,
                found=f"differs from {self.iso:g}" if self.iso is not None else "differs",
                remedy="give read_noise_law, e.g. of read_noise_sum",
            )
        gain = above_zero("gain_dn_per_e", "DN/e-", gain_dn_per_e)
        law, shapes = self.read_noise_law, self.tail_lambda
        if tail_lambda is not None:
            shapes = (tail_lambda,)
        read_dn = law.noise_dn(gain, score=read_score)
        if isinstance(law, LogLinearNoise) and law.tukey_scale:
            read_dn = read_dn * math.sqrt(tukey_lambda_variance(shapes[0]))
        laws = (
            ("row_noise_e", self.row_noise_law, row_score),
            ("column_noise_e", self.column_noise_law, 0.0),
            ("dsnu_e", self.dsnu_law, 0.0),
        )
        others: dict[str, Any] = {
            name: float(np.mean(one.noise_dn(gain, score=score) / gain))
            for name, one, score in laws
            if one is not None
        }
        ratio = float(gain[0] / self.gain_dn_per_e[0])
        return replace(
            self,
            iso=None if self.iso is None else self.iso * ratio,
            gain_dn_per_e=gain,
            read_noise_e=read_dn / gain,
            **others,
            tail_lambda=shapes[:1],
            gain_range_dn_per_e=None,
        )

    def draw_settings(
        self, rng: "np.random.Generator", *, iso: float | None = None
    ) -> "CameraNoise":
        """The camera at the settings of one item: gain, noises about their laws, shape, offsets.

        Parameters
        ----------
        rng
            Random stream of the item.
        iso
            ISO setting; ``None`` for a gain of the range, or, without a range, the camera's own.

        Returns
        -------
        CameraNoise
            With one gain, one shape and one row of offsets. ln(K) is uniform over the range.

        Raises
        ------
        InputError
            As `at_iso` and `at_gain`.

        Notes
        -----
        Wei, Fu, Yang & Huang, CVPR (2020), section 4.2: joint sampling of the parameters.
        """
        uniform, read_score, row_score = rng.random(), *rng.standard_normal(2)
        shape_share, offset_share = rng.random(2)
        shapes = self.tail_lambda
        shape = shapes[int(shape_share * len(shapes))] if shapes else None
        own, scale = self, None
        if iso is not None and self.iso is None:
            own = self.at_iso(iso)  # refused there
        elif iso is not None and self.iso is not None and iso != self.iso:
            scale = check.within("iso", "1", iso, 1e-3, 1e9) / self.iso
        elif iso is None and self.gain_range_dn_per_e is not None:
            low, high = (math.log(one) for one in self.gain_range_dn_per_e)
            scale = math.exp(low + uniform * (high - low)) / self.gain_dn_per_e[0]
        elif shape is not None:
            own = replace(self, tail_lambda=(shape,), gain_range_dn_per_e=None)
        if scale is not None:
            own = self.at_gain(
                self.gain_dn_per_e * scale,
                read_score=float(read_score),
                row_score=float(row_score),
                tail_lambda=shape,
            )
            own = own if iso is None else replace(own, iso=iso)
        if own.black_offsets_dn is None or len(own.black_offsets_dn) == 1:
            return own
        row = int(offset_share * len(own.black_offsets_dn))
        return replace(own, black_offsets_dn=own.black_offsets_dn[row : row + 1])

    @classmethod
    def from_sensor(cls, sensor: Sensor) -> "CameraNoise":
        """The camera of a sensor: its pixel and its converter.

        Parameters
        ----------
        sensor
            With a mosaic, or with all channels in each pixel. Without the bits or the gain of the
            converter the assumptions are those of `adc_of`.

        Returns
        -------
        CameraNoise
            Without an ISO. The dark current is that at the pixel's temperature; the error of the
            black level is one row of offsets.

        Raises
        ------
        InputError
            If the pixel is the sum of several readings.

        Notes
        -----
        EMVA 1288, release 4.0, the linear camera model: K = 1 / (electrons per code).
        """
        pixel = sensor.pixel
        names = sensor.names if sensor.mosaic is None else sensor.mosaic.names
        if pixel.summed_readings != 1:
            raise InputError(
                f"sensor {sensor.name}",
                "must be read once per pixel",
                value=pixel.summed_readings,
                found=f"sums {pixel.summed_readings} readings",
                remedy="bin by charge",
            )
        adc = adc_of(sensor.converter, pixel)
        reading = PixelReading(pixel=pixel)
        error_dn = pixel.black_error_e / adc.gain_e_per_dn
        return cls(
            names=names,
            mosaic=sensor.mosaic,
            gain_dn_per_e=np.full(len(names), 1 / adc.gain_e_per_dn),
            read_noise_e=np.full(len(names), reading.sd("reading")),
            black_level_dn=np.full(len(names), float(adc.black_level_dn)),
            top_code_dn=float(adc.top_code),
            full_well_e=pixel.full_well_e,
            dark_current_e_per_s=pixel.dark_electrons_e(time_s=1.0),
            dsnu_e=reading.sd("pattern"),
            prnu=reading.sd("gain"),
            row_noise_e=reading.sd("row"),
            column_noise_e=reading.sd("column"),
            rtn_share=pixel.rtn_share,
            rtn_amplitude_e=pixel.rtn_amplitude_e,
            black_offsets_dn=np.full((1, len(names)), error_dn) if error_dn else None,
        )

    @classmethod
    def from_eld(
        cls,
        params: Mapping[str, Any],
        *,
        black_level_dn: float,
        top_code_dn: float,
        read: ReadNoiseShape = "tukey-lambda",
        profile: str = "Profile-1",
    ) -> "CameraNoise":
        """The camera of a calibration in the format of ELD.

        Parameters
        ----------
        params
            The dictionary of a file ``camera_params/*.npy``: ``Kmin`` and ``Kmax`` [DN/e-],
            ``G_shape`` (shapes of the Tukey lambda distribution), ``color_bias`` (rows of R, G1,
            B, G2 [DN], optional) and, below the name of the profile, ``G_scale`` (Tukey lambda),
            ``g_scale`` (normal) and ``R_scale`` (rows, optional): each ``slope``, ``bias`` and
            ``sigma`` of ln(noise in DN) over ln(K).
        black_level_dn, top_code_dn
            Of the camera; ELD's format does not contain them. [DN]
        read
            Which distribution the read noise has.
        profile
            Name of the profile.

        Returns
        -------
        CameraNoise
            A Bayer mosaic of R, G1, G2 and B; for each item, ln(K) is drawn uniformly between
            ln(Kmin) and ln(Kmax). Its own gain is the geometric mean of Kmin and Kmax.

        Raises
        ------
        InputError
            If a key is missing or a value is not as described.

        Notes
        -----
        Wei, Fu, Yang & Huang, CVPR (2020), eqs. 2, 8-11: shot noise, Tukey lambda noise, row noise
        and quantization, each as a function of K. The quantization noise, uniform over one step,
        is here the rounding to codes.
        """
        gains, of_eld = eld_noise(params, read=read, profile=profile)
        gain = math.sqrt(math.prod(gains))
        start = cls(
            names=("R", "G1", "G2", "B"),
            mosaic=Mosaic((("R", "G1"), ("G2", "B"))),
            gain_dn_per_e=np.full(4, gain),
            read_noise_e=np.zeros(4),
            black_level_dn=np.full(4, float(black_level_dn)),
            top_code_dn=float(top_code_dn),
            **of_eld,
        )
        own = start.at_gain(start.gain_dn_per_e)
        return replace(own, tail_lambda=start.tail_lambda, gain_range_dn_per_e=gains)


_PLAIN = tuple(name for name in PIXEL_NOISE if name in {one.name for one in fields(CameraNoise)})
