"""Settings and results of the camera's own pipeline, and the results as plain data."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis.undefined import named, plain, plain_fields
from chromanoise.color import tone_curve
from chromanoise.color.pipeline import LumaStandard
from chromanoise.errors import InputError
from chromanoise.noise import Measurement
from chromanoise.spectra import Illuminant
from chromanoise.units import decibel

BASE_ISO = 100.0
"""ISO of the operating point, at which the sensor has the analog gain 1."""

_MOST_GAIN = 1e6
_MOST_READ_NOISE_E = 1e12


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PipelineSettings:
    """Settings of the pipeline.

    Attributes
    ----------
    white_balance
        ``gray``: equal raw of an 18 % gray as it is read; an illuminant: equal raw of a white under
        it; or one gain per channel.
    white_balance_pixels
        Number of gray pixels from which the gains are estimated; ``None`` for exact gains.
    exposure_gain, saturation
        Factor of linear RGB, and of its distance to luminance. [1]
    tone
        ``srgb``, ``rec709``, ``linear``, or a gamma.
    luma
        ``bt709`` or ``bt601``.
    iso
        ISO settings; at each, the analog gain is the ISO over the base, and the exposure is divided
        by it, so that the codes stay the same.
    base_iso
        ISO of the operating point.
    iso_read_noise_e
        Read noise at each ISO; ``None`` for the same at all. [e-]

    Raises
    ------
    InputError
        If a value is out of range, an ISO is below the base, or there is not one read noise per
        ISO.
    """

    white_balance: str | Illuminant | tuple[float, ...] = "gray"
    white_balance_pixels: int | None = None
    exposure_gain: float = 1.0
    saturation: float = 1.0
    tone: str | float = "srgb"
    luma: LumaStandard = "bt709"
    iso: tuple[float, ...] = (BASE_ISO,)
    base_iso: float = BASE_ISO
    iso_read_noise_e: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        if isinstance(self.white_balance, str):
            _check.one_of("white_balance", self.white_balance, ("gray",))
        if self.white_balance_pixels is not None and self.white_balance != "gray":
            raise InputError(
                "white_balance_pixels",
                "must be given only with gains estimated from gray pixels",
                value=self.white_balance_pixels,
                found="the gains are not",
                remedy="omit it, or balance by gray",
            )
        _check.positive("exposure_gain", "1", self.exposure_gain)
        _check.not_negative("saturation", "1", self.saturation)
        tone_curve(self.tone)
        _check.positive("base_iso", "ISO", self.base_iso)
        for iso in self.iso:
            if not self.base_iso <= iso <= _MOST_GAIN * self.base_iso:
                raise InputError(
                    "iso",
                    f"must be 1 to {_MOST_GAIN:g} times the base ISO of {self.base_iso:g}",
                    value=iso,
                )
        if self.iso_read_noise_e is not None:
            for read in self.iso_read_noise_e:
                _check.within("iso_read_noise_e", "e-", read, 0.0, _MOST_READ_NOISE_E)
            if len(self.iso_read_noise_e) != len(self.iso):
                raise InputError(
                    "iso_read_noise_e",
                    "must have one value per ISO [e-]",
                    value=self.iso_read_noise_e,
                    found=f"has {len(self.iso_read_noise_e)} for {len(self.iso)} ISO settings",
                )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PipelineStep:
    """The patches after one step.

    Attributes
    ----------
    name
        E.g. ``raw``, ``white-balanced``, ``sRGB``, ``Y'CbCr``.
    measurement
        Mean and covariance of the 24 patches.
    """

    name: str
    measurement: Measurement


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GainStep:
    """The sensor at one ISO.

    Attributes
    ----------
    iso, gain
        ISO, and analog gain over that at the base ISO. [1]
    read_noise_e
        Read noise at this gain; that of the sum for binned pixels. [e-]
    white_level_e
        Largest signal: full well, or top code if that is lower. [e-]
    gain_dn_per_e
        Gain K of the converter; ``None`` where it is unknown. [DN/e-]
    dynamic_range_db
        White level over temporal noise in the dark, per channel; inf without noise. [dB]
    emva_dynamic_range_db
        White level over the absolute sensitivity threshold, temporal noise in the dark + 1/2 e-
        (EMVA 1288, release 4.0), per channel. [dB]
    noise_profile
        S and O of each channel: variance S x + O, x = 1 at the white level (DNG). PRNU is not
        included, because its variance is quadratic.
    steps
        The patches after each step at this gain.
    """

    iso: float
    gain: float
    read_noise_e: float
    white_level_e: float
    gain_dn_per_e: float | None
    dynamic_range_db: Float[Array, " p"]
    emva_dynamic_range_db: Float[Array, " p"]
    noise_profile: Float[Array, "p 2"]
    steps: tuple[PipelineStep, ...]

    @property
    def dynamic_range_stops(self) -> Float[Array, " p"]:
        """The dynamic range as a power of two, per channel."""
        return self.dynamic_range_db / decibel(np.array(2.0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WhiteBalanceNoise:
    """Error of gains that are estimated from gray pixels, common to all pixels of the picture.

    Attributes
    ----------
    pixels
        Number of gray pixels.
    gains_covariance
        Of the gains. [1]
    lab_covariance
        Of the shift of each patch in CIELAB.
    """

    pixels: int
    gains_covariance: Float[Array, "p p"]
    lab_covariance: Float[Array, "24 3 3"]

    @property
    def delta_e(self) -> Float[Array, "24"]:
        """Root mean square shift of each patch. [Delta E*ab]"""
        return np.asarray(np.sqrt(np.trace(self.lab_covariance, axis1=-2, axis2=-1)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PipelineNoise:
    """Noise of the chart through the pipeline of one sensor.

    Attributes
    ----------
    settings
        Of the pipeline.
    patches, channels
        Names of the 24 patches and of the channels.
    gains
        White balance gains.
    steps
        The patches after each step, at the operating point.
    iso
        The sensor and the patches at each ISO.
    white_balance_noise
        ``None`` where the gains are exact.
    notes
        Remarks: readings that clip, and where the first order fails.
    """

    settings: PipelineSettings
    patches: tuple[str, ...]
    channels: tuple[str, ...]
    gains: Float[Array, " p"]
    steps: tuple[PipelineStep, ...]
    iso: tuple[GainStep, ...]
    white_balance_noise: WhiteBalanceNoise | None
    notes: tuple[str, ...]

    def step(self, name: str) -> Measurement:
        """The patches after the step of this name.

        Parameters
        ----------
        name
            Name of the step, as in `steps`.

        Raises
        ------
        InputError
            If there is no such step.
        """
        known = {one.name: one.measurement for one in self.steps}
        return known[_check.one_of("step", name, tuple(known))]


def pipeline_as_json(found: PipelineNoise | None) -> dict[str, Any] | None:
    """Gains, and mean and covariance of each patch after each step and at each ISO.

    Parameters
    ----------
    found
        Noise after each step; ``None`` where it is undefined.
    """
    if found is None:
        return None
    settings = found.settings
    balance = settings.white_balance
    if isinstance(balance, Illuminant):
        balance = balance.name
    return {
        "white_balance": balance if isinstance(balance, str) else list(balance),
        "gains": named(found.channels, found.gains),
        **plain_fields(settings, "exposure_gain", "saturation", "tone", "luma"),
        "steps": _steps_as_json(found.steps, found.patches),
        "iso": [_gain_as_json(one, found) for one in found.iso],
        "white_balance_noise": _balance_noise_as_json(found),
        "notes": list(found.notes),
    }


def _gain_as_json(one: GainStep, found: PipelineNoise) -> dict[str, Any]:
    channels = found.channels
    return {
        **plain_fields(one, "iso", "gain", "gain_dn_per_e", "read_noise_e", "white_level_e"),
        "dynamic_range_db": plain(named(channels, one.dynamic_range_db)),
        "dynamic_range_stops": plain(named(channels, one.dynamic_range_stops)),
        "emva_dynamic_range_db": named(channels, one.emva_dynamic_range_db),
        "noise_profile": {
            name: named(channels, one.noise_profile[:, i]) for i, name in enumerate(("S", "O"))
        },
        "steps": _steps_as_json(one.steps, found.patches),
    }


def _balance_noise_as_json(found: PipelineNoise) -> dict[str, Any] | None:
    noise = found.white_balance_noise
    if noise is None:
        return None
    return {
        "pixels": noise.pixels,
        "gains_sd": named(found.channels, np.sqrt(np.diagonal(noise.gains_covariance))),
        "gains_covariance": noise.gains_covariance.tolist(),
        "patches": [
            {"patch": name, "lab_covariance": covariance.tolist(), "delta_e": float(delta_e)}
            for name, covariance, delta_e in zip(
                found.patches, noise.lab_covariance, noise.delta_e, strict=True
            )
        ],
    }


def _steps_as_json(steps: Sequence[PipelineStep], patches: Sequence[str]) -> list[dict[str, Any]]:
    return [
        {
            "name": step.name,
            "unit": step.measurement.unit,
            "coordinates": list(step.measurement.names),
            "patches": [
                {"patch": name, "mean": mean.tolist(), "covariance": covariance.tolist()}
                for name, mean, covariance in zip(
                    patches, step.measurement.mean, step.measurement.covariance, strict=True
                )
            ],
        }
        for step in steps
    ]
