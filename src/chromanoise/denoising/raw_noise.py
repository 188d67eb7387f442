"""The noise of the codes of a raw picture: from a pixel, or from the noise profile of a DNG."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float32, Shaped
from chromanoise.errors import InputError, Setting
from chromanoise.noise import NoiseSources
from chromanoise.sensor import VarianceLaw
from chromanoise.sensor.noise_profile import shot_and_dark


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CodeNoise:
    """Scale and noise of the codes of a raw picture, in electrons.

    Attributes
    ----------
    names
        Channels.
    gain_e_per_dn
        Electrons per code. [e-/DN]
    black_level_dn
        Code without light. [DN]
    saturation_dn
        Lowest saturated code; ``None`` if it is not known. [DN]
    temporal
        Variance that changes from frame to frame, per channel; a law without channels counts for
        all of them.
    spatial
        Variance that is the same in every frame, per channel.
    source
        Where the noise comes from.

    Raises
    ------
    InputError
        If a value is not finite or negative, or the white level is not above black.
    """

    names: tuple[str, ...]
    gain_e_per_dn: float
    black_level_dn: float
    saturation_dn: float | None
    temporal: VarianceLaw
    spatial: VarianceLaw
    source: str

    def __post_init__(self) -> None:
        _check.positive("gain_e_per_dn", "e-/DN", self.gain_e_per_dn)
        _check.not_negative("black_level", "DN", self.black_level_dn)
        for name in ("temporal", "spatial"):
            object.__setattr__(self, name, getattr(self, name).of_planes(len(self.names)))
        if self.saturation_dn is not None:
            _range_dn(self.black_level_dn, self.saturation_dn)

    @property
    def law(self) -> VarianceLaw:
        """Variance of one reading, per channel."""
        return self.temporal + self.spatial

    def electrons(self, codes: Shaped[Array, "h w"]) -> Float32[Array, "h w"]:
        """Electrons of codes. [e-]

        Parameters
        ----------
        codes
            Codes of the converter. [DN]
        """
        values = codes.astype(np.float32)
        values -= np.float32(self.black_level_dn)
        values *= np.float32(self.gain_e_per_dn)
        return values

    def codes(self, values_e: Float32[Array, "h w"]) -> Float32[Array, "h w"]:
        """Codes of electrons, neither rounded nor clipped. [DN]

        Parameters
        ----------
        values_e
            Electrons. [e-]
        """
        return np.asarray(
            values_e / np.float32(self.gain_e_per_dn) + np.float32(self.black_level_dn)
        )

    def to_dict(self) -> dict[str, Any]:
        """The noise as plain data; S and O only where the white level is known."""
        data: dict[str, Any] = {
            "source": self.source,
            "gain_dn_per_e": 1 / self.gain_e_per_dn,
            "black_level_dn": self.black_level_dn,
            "white_level_dn": self.saturation_dn,
            "prnu": math.sqrt(np.max(self.spatial.square)),
        }
        data["channels"] = {
            name: self._of_channel(self.law.take(i)) for i, name in enumerate(self.names)
        }
        return data

    def _of_channel(self, law: VarianceLaw) -> dict[str, float]:
        floor, slope, _ = law.coefficients.tolist()
        data = {"floor_e2": floor, "slope_e": slope, "noise_without_light_e": floor**0.5}
        if self.saturation_dn is None:
            return data
        range_e = _range_dn(self.black_level_dn, self.saturation_dn) * self.gain_e_per_dn
        shot, dark = shot_and_dark(law.in_units_of(range_e)).tolist()
        return data | {"S": shot, "O": dark}


def code_noise(
    sources: NoiseSources,
    names: Sequence[str],
    *,
    black_level_dn: float,
    saturation_dn: float | None,
    source: str,
) -> CodeNoise:
    """The noise of raw codes, from the noise sources of a pixel.

    Parameters
    ----------
    sources
        Of the pixel; ``step_e`` is the gain of the codes.
    names
        Channels.
    black_level_dn, saturation_dn, source
        As `CodeNoise`.

    Raises
    ------
    InputError
        As `CodeNoise`.

    Examples
    --------
    >>> from chromanoise.sensor import Pixel
    >>> pixel = Pixel(pitch_um=3, full_well_e=9000, read_noise_e=3.0)
    >>> noise = code_noise(NoiseSources(pixel=pixel, step_e=2.0), ("W",), black_level_dn=64,
    ...                    saturation_dn=None, source="an example")
    >>> noise.law.floor_e2.round(3), noise.electrons(np.array([[164]]))
    (array([9.333]), array([[200.]], dtype=float32))
    """
    return CodeNoise(
        names=tuple(names),
        gain_e_per_dn=sources.step_e,
        black_level_dn=float(black_level_dn),
        saturation_dn=saturation_dn,
        temporal=sources.law("temporal"),
        spatial=sources.law("spatial"),
        source=source,
    )


def code_noise_of_profile(
    profile: Mapping[str, tuple[float, float]],
    names: Sequence[str],
    *,
    black_level_dn: float,
    white_level_dn: float,
    source: str,
) -> CodeNoise:
    """The noise of raw codes, from a noise profile: variance = S x + O.

    Parameters
    ----------
    profile
        S and O of each channel, with x = 0 at black and 1 at the white level. [1]
    names
        Channels.
    black_level_dn, white_level_dn
        Codes of x = 0 and x = 1. [DN]
    source
        As `CodeNoise`.

    Raises
    ------
    InputError
        As `CodeNoise`, or if S is not above 0 or O is negative.

    Notes
    -----
    DNG 1.4, tag 51041. With R codes from black to white the variance of a code is S R y + O R^2 at
    y codes above black. Counted electrons have a variance equal to their mean, so S R codes
    are one electron. Where the channels differ in S (codes multiplied after the converter), one
    electron is the mean of their S R, and the slope of their law differs from 1.

    Examples
    --------
    >>> noise = code_noise_of_profile({"W": (0.0025, 0.01)}, ("W",), black_level_dn=55,
    ...                               white_level_dn=255, source="an example")
    >>> noise.gain_e_per_dn, noise.law.floor_e2
    (2.0, array([1600.]))
    """
    pairs = np.array([profile[name] for name in names])
    for name, (shot, dark) in zip(names, pairs.tolist(), strict=True):
        _check.positive(f"S of channel {name} of {source}", "1", shot)
        _check.not_negative(f"O of channel {name} of {source}", "1", dark)
    range_dn = _range_dn(black_level_dn, white_level_dn)
    gain = 1 / (pairs[:, 0].mean() * range_dn)
    of_range = VarianceLaw(floor_e2=pairs[:, 1], slope_e=pairs[:, 0])
    return CodeNoise(
        names=tuple(names),
        gain_e_per_dn=float(gain),
        black_level_dn=float(black_level_dn),
        saturation_dn=float(white_level_dn),
        temporal=of_range.in_units_of(1 / (range_dn * gain)),
        spatial=VarianceLaw(),
        source=source,
    )


def _range_dn(black_level_dn: float, white_level_dn: float) -> float:
    """Codes from black to white, above 0. [DN]"""
    if not black_level_dn < white_level_dn < math.inf:
        raise InputError(
            "white_level",
            f"must be finite and above the black level {black_level_dn:g} [DN]",
            value=white_level_dn,
            remedy=(Setting("black_level"), Setting("white_level")),
        )
    return white_level_dn - black_level_dn
