"""Noise models for other programs: DNG, darktable, and the camera tuning of libcamera."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.characterization.results import STATED, Characterization, PlaneNoise, by_iso
from chromanoise.errors import InputError, Setting
from chromanoise.sensor import VarianceLaw
from chromanoise.sensor.noise_profile import shot_and_dark

_RGB = ("R", "G", "B")
_HAAR = 0.25  # variance of white noise in the diagonal band of darktable's Haar transform
_TOP_16 = 16  # bits of the scale of libcamera's tuning files


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Normalized:
    """S and O of each plane, variance = S x + O, x = 0 at black and 1 at white level."""

    names: tuple[str, ...]
    pairs: Float[Array, "p 2"]
    black_dn: float
    white_dn: float

    def of_colors(self) -> dict[str, list[float]]:
        """Mean S and O of the planes of each color: red, green, blue, or as they appear."""
        colors = [color_of_plane(name) for name in self.names]
        order = _RGB if set(colors) == set(_RGB) else tuple(dict.fromkeys(colors))
        of = np.array(colors)
        return {color: self.pairs[of == color].mean(axis=0).tolist() for color in order}


def color_of_plane(name: str) -> str:
    """The color of a plane: its name without the number of the pixel.

    Parameters
    ----------
    name
        Name of the plane, such as ``G1``.

    Examples
    --------
    >>> color_of_plane("G2"), color_of_plane("IR"), color_of_plane("2")
    ('G', 'IR', '2')
    """
    return name.rstrip("0123456789") or name


def noise_profile_json(
    result: Characterization, *, white_level_dn: float | None = None
) -> dict[str, Any]:
    """The noise profile of DNG as the JSON that `read_noise_profile` reads.

    Parameters
    ----------
    result
        A characterization.
    white_level_dn
        Code of x = 1; if ``None``, the lowest code at which a plane saturates, and at most the
        largest code of the converter. [DN]

    Returns
    -------
    dict
        ``S``, ``O`` and ``channels`` of each plane, ``black_level_dn``, ``white_level_dn``, and
        ``dng`` with the values of the tags of a DNG, one pair per color.

    Raises
    ------
    InputError
        If the bits, a black level or the dark noise of a plane is not known, or the white level is
        not above black.

    Notes
    -----
    Adobe DNG 1.7, tag 51041 NoiseProfile: the standard deviation of a linear signal x from 0 to 1
    is sqrt(S x + O); one pair for each color plane, in the order of the tag CFAPlaneColor, by
    default red, green, blue. With R codes from black to white, S = K / R and O = ((K sigma_d)^2 +
    1/12) / R^2, because rounding to codes is part of the noise of a file. The planes of one color
    share the mean of their S and of their O.
    """
    profile = _normalized(result, white_level_dn)
    colors = profile.of_colors()
    return {
        "S": profile.pairs[:, 0].tolist(),
        "O": profile.pairs[:, 1].tolist(),
        "channels": list(profile.names),
        "black_level_dn": profile.black_dn,
        "white_level_dn": profile.white_dn,
        "dng": {
            "colors": list(colors),
            "NoiseProfile": [number for pair in colors.values() for number in pair],
            "BlackLevel": profile.black_dn,
            "WhiteLevel": profile.white_dn,
        },
    }


def noise_profile_line(result: Characterization, *, white_level_dn: float | None = None) -> str:
    """The tags of a DNG as text: ``NoiseProfile: S O ...``, ``BlackLevel:``, ``WhiteLevel:``.

    Parameters
    ----------
    result, white_level_dn
        As `noise_profile_json`.

    Raises
    ------
    InputError
        As `noise_profile_json`.
    """
    dng = noise_profile_json(result, white_level_dn=white_level_dn)["dng"]
    numbers = " ".join(map(repr, dng["NoiseProfile"]))
    levels = f"BlackLevel: {dng['BlackLevel']!r}\nWhiteLevel: {dng['WhiteLevel']!r}\n"
    return f"NoiseProfile: {numbers}\n{levels}"


def noise_profiles_json(results: Sequence[Characterization]) -> dict[str, Any]:
    """DNG noise profiles of one camera, one per ISO setting.

    Parameters
    ----------
    results
        One characterization per ISO setting.

    Returns
    -------
    dict
        ``profiles``, by increasing ISO: ``iso``, and the keys of `noise_profile_json`. A DNG file
        holds the profile of its ISO setting only.

    Raises
    ------
    InputError
        If the cameras differ, an ISO is missing or repeated, or as `noise_profile_json`.
    """
    return {"profiles": [{"iso": iso, **noise_profile_json(one)} for iso, one in by_iso(results)]}


def darktable_json(
    results: Characterization | Sequence[Characterization],
    *,
    maker: str | None = None,
    model: str | None = None,
) -> dict[str, Any]:
    """A file ``noiseprofiles.json`` of darktable: ``a`` and ``b`` of R, G and B for each ISO.

    Parameters
    ----------
    results
        A characterization, or one per ISO setting of one camera.
    maker, model
        As in the files of the camera; if ``None``, the first word and the rest of
        ``result.camera``.

    Raises
    ------
    InputError
        If the camera, an ISO or one of the planes R, G and B is missing, cameras differ, an ISO is
        repeated, or as `noise_profile_json`.

    Notes
    -----
    darktable, ``tools/noise/noiseprofile.c`` and ``data/noiseprofiles.json``: variance = a x + b
    with x = 1 at the white level, where the noise is measured in the diagonal band of one level of
    a Haar transform with the filter (1, -1) / 2 in both directions. White noise has a quarter of
    its variance there, so a = S / 4 and b = O / 4. darktable measures developed pictures;
    demosaicing, which lowers the noise further, and white balance, which scales red and blue, are
    left out, because they are not properties of the sensor. b / a does not depend on them.
    """
    every = [results] if isinstance(results, Characterization) else list(results)
    first = next(iter(every), None)
    if first is not None:
        maker, model = _maker_and_model(first, maker, model)
    ordered = by_iso(every)
    profiles = [_darktable_profile(one, iso, f"{model} iso {iso:g}") for iso, one in ordered]
    sources = ", ".join(one.source for _, one in ordered)
    comment = f"chromanoise, from raw frames of {sources}; not demosaiced, no white balance"
    own = {"comment": comment, "model": model, "profiles": profiles}
    return {"version": 0, "noiseprofiles": [{"maker": maker, "models": [own]}]}


def _darktable_profile(result: Characterization, iso: float, name: str) -> dict[str, Any]:
    colors = _normalized(result, None).of_colors()
    missing = [color for color in _RGB if color not in colors]
    if missing:
        raise InputError(
            result.source,
            "must have planes R, G and B for a darktable profile",
            value=tuple(colors),
            found=f"has {', '.join(colors)}",
        )
    return {
        "name": name,
        "iso": int(iso) if float(iso).is_integer() else iso,
        "a": [_HAAR * colors[color][0] for color in _RGB],
        "b": [_HAAR * colors[color][1] for color in _RGB],
    }


def libcamera_json(
    results: Characterization | Sequence[Characterization], *, analog_gain: float = 1.0
) -> dict[str, Any]:
    """The sections ``rpi.black_level`` and ``rpi.noise`` of a camera tuning file of libcamera.

    Parameters
    ----------
    results
        A characterization, or one per ISO setting of one camera. The levels of all results are
        fitted together, as the tuning tool of libcamera fits the images of all gains.
    analog_gain
        Analog gain of the frames, from which the sections are converted to gain 1; for several
        results, the gain at the lowest ISO. At other ISO settings, the gain is proportional to the
        ISO. [1]

    Returns
    -------
    dict
        ``version`` and ``algorithms`` with the two sections, to be copied into the tuning file of
        the sensor.

    Raises
    ------
    InputError
        If the bits or a black level is not known, fewer than 2 levels of different mean were
        fitted, or the cameras of several results differ or one has no ISO of its own.

    Notes
    -----
    libcamera, ``src/ipa/rpi/controller/rpi``: ``black_level.cpp`` takes the black level on a scale
    of 16 bits ("64 in 10 bits" is 4096), for red, green and blue if they differ; ``noise.cpp`` has
    the noise at analog gain 1 and multiplies both numbers by the root of the gain.
    ``utils/raspberrypi/ctt/ctt_noise.py`` fits them: standard deviation = reference_constant +
    reference_slope sqrt(mean), both above black, on the scale of 16 bits and divided by the analog
    gain, by least squares without weights over the patches of all channels; a negative constant is
    set to 0 and the slope is then the mean of standard deviation / sqrt(mean). Here the levels of
    all planes that were fitted take the place of the patches, so noise without light is no part of
    the fit.
    """
    gain = _check.positive("analog_gain", "1", analog_gain)
    every = [results] if isinstance(results, Characterization) else list(results)
    if len(every) == 1:
        gains = [(gain, every[0])]
    else:
        ordered = by_iso(every)
        gains = [(gain * iso / ordered[0][0], one) for iso, one in ordered]
    scale = 2.0 ** (_TOP_16 - _bits(gains[0][1]))
    constant, slope = _straight_noise([(scale / own, one) for own, one in gains])
    return {
        "version": 2.0,
        "algorithms": [
            {"rpi.black_level": _black_levels(gains[0][1], scale)},
            {"rpi.noise": {"reference_constant": constant, "reference_slope": slope}},
        ],
    }


def _straight_noise(scaled: Sequence[tuple[float, Characterization]]) -> tuple[float, float]:
    """Constant and slope of the standard deviation over the root of the mean, each scaled."""
    points = [
        (scale * _signal_dn(plane, level.mean_dn, level.dark_mean_dn), scale**2 * variance)
        for scale, result in scaled
        for plane in result.planes
        for level in plane.levels
        for variance in (level.variance_dn2,)
        if level.fitted and variance > 0
    ]
    lit = np.sqrt(np.array([point for point in points if point[0] > 0]).reshape(-1, 2))
    root, sd = lit[:, 0], lit[:, 1]
    if np.unique(root).size < 2:
        raise InputError(
            scaled[0][1].source,
            "must have at least 2 fitted levels of different mean for a libcamera noise model",
            value=int(np.unique(root).size),
            found=f"has {np.unique(root).size}",
        )
    offset = root - root.mean()
    slope = float(offset @ (sd - sd.mean()) / (offset @ offset))
    constant = float(sd.mean() - slope * root.mean())
    return (constant, slope) if constant >= 0 else (0.0, float((sd / root).mean()))


def _signal_dn(plane: PlaneNoise, mean_dn: float, dark_mean_dn: float | None) -> float:
    return mean_dn - (dark_mean_dn if dark_mean_dn is not None else _black_of(plane))


def _black_levels(result: Characterization, scale: float) -> Mapping[str, int]:
    """The common black level on the scale of 16 bits, and those of the colors if they differ."""
    levels: dict[str, list[float]] = {}
    for plane in result.planes:
        levels.setdefault(color_of_plane(plane.name), []).append(scale * _black_of(plane))
    every = [value for values in levels.values() for value in values]
    common = _whole_16(sum(every) / len(every), result.source)
    own = {
        f"black_level_{color.lower()}": _whole_16(sum(values) / len(values), result.source)
        for color, values in levels.items()
        if color in _RGB
    }
    same = all(level == common for level in own.values())
    return {"black_level": common} | ({} if same else own)


def _whole_16(level: float, source: str) -> int:
    _check.within(f"black level of {source} on a scale of 16 bits", "DN", level, 0.0, 65535.0)
    return round(level)


def _normalized(result: Characterization, white_level_dn: float | None) -> _Normalized:
    blacks = [_black_of(plane) for plane in result.planes]
    if not blacks:
        raise InputError(result.source, "must have at least one plane", value=0)
    black = sum(blacks) / len(blacks)
    white = _white_dn(result) if white_level_dn is None else float(white_level_dn)
    span = _check.positive(f"white minus black level of {result.source}", "DN", white - black)
    of_codes = VarianceLaw(
        floor_e2=np.array([_dark_noise_dn2(plane) for plane in result.planes]),
        slope_e=np.array([plane.gain_dn_per_e for plane in result.planes]),
    )
    return _Normalized(
        names=tuple(plane.name for plane in result.planes),
        pairs=shot_and_dark(of_codes.in_units_of(span)),
        black_dn=black,
        white_dn=white,
    )


def _white_dn(result: Characterization) -> float:
    """The lowest code at which a plane saturates, by its full well or by the converter. [DN]"""
    wells = [
        _black_of(plane) + plane.gain_dn_per_e * plane.full_well_e
        for plane in result.planes
        if plane.full_well_e is not None and math.isfinite(plane.full_well_e)
    ]
    return min([2.0 ** _bits(result) - 1, *map(round, wells)])


def _dark_noise_dn2(plane: PlaneNoise) -> float:
    """Variance of the codes without light, rounding included. [DN^2]"""
    if plane.dark_variance_dn2 is None or not math.isfinite(plane.dark_variance_dn2):
        raise _unknown(f"dark noise of plane {plane.name}", "take frames without light")
    return plane.dark_variance_dn2


def _black_of(plane: PlaneNoise) -> float:
    if plane.black_level_dn is None or not math.isfinite(plane.black_level_dn):
        raise _unknown(f"black level of plane {plane.name}", "take frames without light")
    return plane.black_level_dn


def _bits(result: Characterization) -> int:
    if result.bits is None:
        raise _unknown("bits", Setting("bits"))
    return result.bits


def _unknown(what: str, remedy: str | Setting) -> InputError:
    return InputError(what, "must be known for this noise model", found="is not", remedy=remedy)


def _maker_and_model(
    result: Characterization, maker: str | None, model: str | None
) -> tuple[str, str]:
    """Maker and model of the arguments, or the first word of the camera and the rest."""
    words: Sequence[str] = result.camera.split()
    first = words[0] if words else ""
    rest = words[1:]
    if rest and rest[0].casefold() == first.casefold():  # Canon Canon EOS R5
        rest = rest[1:]
    maker = first if maker is None else maker
    model = " ".join(rest) if model is None else model
    for name, value in (("maker", maker), ("model", model)):
        if not value:
            raise InputError(
                name,
                "must be known for a darktable profile",
                value=result.camera,
                found="is not",
                remedy=STATED.format('camera = "Maker Model"'),
            )
    return maker, model
