"""Results of a characterization for other programs, and a check of a color matrix's variance.

Noise profiles are written for DNG, darktable and the camera tuning of libcamera; data sheets of
EMVA 1288 and the photon-transfer table of one plane as text, XML and CSV. The check compares the
predicted with the measured variance through a color matrix.
"""

import math
from collections.abc import Mapping, Sequence
from decimal import Decimal
from functools import partial
from typing import Any, ClassVar
from xml.etree import ElementTree

import numpy as np

from chromanoise.apps.camera.characterization import (
    SHARED,
    STATED,
    Characterization,
    PlaneNoise,
    by_iso,
    dynamic_range_db,
    several,
    threshold_e,
)
from chromanoise.base import (
    Array,
    Float,
    InputError,
    JsonKey,
    JsonKeys,
    Setting,
    check,
    dataclass,
    defined,
    pinv,
)
from chromanoise.io import GivenMatrix
from chromanoise.sensor import VarianceLaw, shot_and_dark

_RGB = ("R", "G", "B")
_printable = partial(check.printable, most=None)
_HAAR = 0.25  # variance of white noise in the diagonal band of darktable's Haar transform
_TOP_16 = 16  # bits of the scale of libcamera's tuning files


def color_of_plane(name: str) -> str:
    """The color of a plane: its name without the number of the pixel.

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
    blacks = [_black_of(plane) for plane in result.planes]
    if not blacks:
        raise InputError(result.source, "must have at least one plane", value=0)
    black = sum(blacks) / len(blacks)
    white = _white_dn(result) if white_level_dn is None else float(white_level_dn)
    span = check.positive(f"white minus black level of {result.source}", "DN", white - black)
    of_codes = VarianceLaw(
        floor_e2=np.array([_dark_noise_dn2(plane) for plane in result.planes]),
        slope_e=np.array([plane.gain_dn_per_e for plane in result.planes]),
    )
    pairs = shot_and_dark(of_codes.in_units_of(span))
    of = np.array([color_of_plane(plane.name) for plane in result.planes])
    colors = _RGB if set(of) == set(_RGB) else tuple(dict.fromkeys(of.tolist()))
    means = [pairs[of == color].mean(axis=0) for color in colors]
    return {
        "S": pairs[:, 0].tolist(),
        "O": pairs[:, 1].tolist(),
        "channels": [plane.name for plane in result.planes],
        "black_level_dn": black,
        "white_level_dn": white,
        "dng": {
            "colors": list(colors),
            "NoiseProfile": np.ravel(means).tolist(),
            "BlackLevel": black,
            "WhiteLevel": white,
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
    every = several(results)
    if every:
        maker, model = _maker_and_model(every[0], maker, model)
    ordered = by_iso(every)
    profiles = [_darktable_profile(one, iso, f"{model} iso {iso:g}") for iso, one in ordered]
    sources = ", ".join(one.source for _, one in ordered)
    comment = f"chromanoise, from raw frames of {sources}; not demosaiced, no white balance"
    own = {"comment": comment, "model": model, "profiles": profiles}
    return {"version": 0, "noiseprofiles": [{"maker": maker, "models": [own]}]}


def _darktable_profile(result: Characterization, iso: float, name: str) -> dict[str, Any]:
    dng = noise_profile_json(result)["dng"]
    colors, pairs = dng["colors"], np.reshape(dng["NoiseProfile"], (-1, 2))
    if not set(_RGB) <= set(colors):
        raise InputError(
            result.source,
            "must have planes R, G and B for a darktable profile",
            value=tuple(colors),
            found=f"has {', '.join(colors)}",
        )
    a, b = (_HAAR * pairs[[colors.index(color) for color in _RGB]]).T.tolist()
    whole = int(iso) if float(iso).is_integer() else iso
    return {"name": name, "iso": whole, "a": a, "b": b}


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
    gain = check.positive("analog_gain", "1", analog_gain)
    every = several(results)
    ordered = [(1.0, every[0])] if len(every) == 1 else by_iso(every)
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
        (scale * (level.mean_dn - dark), scale**2 * level.variance_dn2)
        for scale, result in scaled
        for plane in result.planes
        for level in plane.levels
        if level.fitted and level.variance_dn2 > 0
        for dark in (_black_of(plane) if level.dark_mean_dn is None else level.dark_mean_dn,)
    ]
    root, sd = np.sqrt([point for point in points if point[0] > 0]).reshape(-1, 2).T
    if np.unique(root).size < 2:
        raise InputError(
            scaled[0][1].source,
            "must have at least 2 fitted levels of different mean for a libcamera noise model",
            value=int(np.unique(root).size),
            found=f"has {np.unique(root).size}",
        )
    slope, constant = np.polyfit(root, sd, 1).tolist()
    return (constant, slope) if constant >= 0 else (0.0, float((sd / root).mean()))


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
    check.within(f"black level of {source} on a scale of 16 bits", "DN", level, 0.0, 65535.0)
    return round(level)


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
    return _known(plane.dark_variance_dn2, f"dark noise of plane {plane.name}")


def _black_of(plane: PlaneNoise) -> float:
    return _known(plane.black_level_dn, f"black level of plane {plane.name}")


def _bits(result: Characterization) -> float:
    return _known(result.bits, "bits", Setting("bits"))


def _known(
    value: float | None, what: str, remedy: str | Setting = "take frames without light"
) -> float:
    if defined(value) is None:
        raise InputError(what, "must be known for this noise model", found="is not", remedy=remedy)
    return value  # type: ignore[return-value] # refused above


def _maker_and_model(
    result: Characterization, maker: str | None, model: str | None
) -> tuple[str, str]:
    """Maker and model of the arguments, or the first word of the camera and the rest."""
    first, *rest = result.camera.split() or [""]
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


STANDARD = "EMVA Standard 1288, Release 4.0 Linear"


def emva_sheet(result: Characterization, plane: PlaneNoise) -> str:
    """The data sheet of one plane as text, a value with its unit per line, with all digits.

    Notes
    -----
    EMVA Standard 1288, Release 4.0 Linear (2021), chapters 2 and 10: u_e.min = sqrt(sigma_d^2 +
    1 / (12 K^2)) + 1/2, SNR_max = sqrt(u_e.sat), DR = u_e.sat / u_e.min, photons = electrons / QE;
    u_e.sat = QE u_p.sat is the saturation capacity, at the largest variance. The full well, of a
    level above saturation, is an addition. `chromanoise.io.pixels.read_emva_sheet` reads it; ``#``
    starts a comment. Values that are not known are left out; ratios have the unit 1.
    """
    lines = [f"# {STANDARD}", *_heading(result, plane)]
    for (_, _, name, _, unit, _), value, error in _rows(result, plane):
        below = "# below 0, as its error allows: " if value < 0 else ""
        shown = "" if error is None else f"  # +- {error:.2g}"
        lines.append(f"{below}{name} = {_digits(value)} {unit}{shown}")
    return "\n".join([*lines, ""])


def emva_sheet_xml(result: Characterization, plane: PlaneNoise) -> str:
    """The data sheet of one plane as XML, in the form of the reference code of the standard.

    Notes
    -----
    The standard defines no XML. The form is that of ``Results1288.xml`` in the package emva1288
    1.0.2 (https://github.com/EMVA1288/emva1288): the root ``results`` holds sections, each section
    quantities by the names of that package, and each quantity ``short``, ``symbol``, ``unit`` and
    ``value``; QE and PRNU are in %. ``standard_error``, ``full_well``, the section ``converter``
    and the attributes of the root are additions; readers of that form ignore them.
    `chromanoise.io.pixels.read_emva_sheet` reads it with all digits.
    """
    facts = {"standard": STANDARD, "camera": result.camera, "plane": plane.name}
    facts |= {} if result.iso is None else {"iso": f"{result.iso:g}"}
    root = ElementTree.Element("results", {key: _printable(value) for key, value in facts.items()})
    sections: dict[str, ElementTree.Element] = {}
    for (section, tag, _, symbol, unit, short), value, error in _rows(result, plane):
        if section not in sections:
            sections[section] = ElementTree.SubElement(root, section)
        entry = ElementTree.SubElement(sections[section], tag)
        shift = 2 if tag in _PERCENT else 0
        texts = {"short": short, "symbol": symbol, "unit": "%" if shift else unit}
        texts["value"] = _digits(value, shift)
        if error is not None:
            texts["standard_error"] = _digits(error, shift)
        for name, text in texts.items():
            ElementTree.SubElement(entry, name).text = text
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def photon_transfer_csv(plane: PlaneNoise) -> str:
    """The levels of one plane as a table that `read_photon_transfer_csv` reads to the last digit.

    Notes
    -----
    Columns: ``mean_dn``, ``variance_dn2``; ``samples``, the number of samples that gives the stated
    standard error, n = 1 + 2 (variance / error)^2; ``time_ms`` and ``photons_per_pixel`` where all
    levels have them; ``dark_mean_dn`` and ``dark_variance_dn2`` where all levels have darks.
    """
    columns = {name: [getattr(one, name) for one in plane.levels] for name in _COLUMNS}
    partial = {name for name, column in columns.items() if None in column}
    partial |= {*_DARK} if partial & {*_DARK} else set()
    full = {name: column for name, column in columns.items() if name not in partial}
    rows = zip(*full.values(), strict=True)
    lines = [",".join(full), *(",".join(_digits(value) for value in row) for row in rows)]
    return "\n".join([*lines, ""])


def _heading(result: Characterization, plane: PlaneNoise) -> list[str]:
    lines = [f"# camera: {_printable(result.camera) or 'not known'}", f"# plane: {plane.name}"]
    lines += [] if result.iso is None else [f"# ISO: {result.iso:g}"]
    holds = "holds" if result.verdict.holds else "does not hold"
    return [*lines, f"# The linear camera model {holds}."]


def _rows(
    result: Characterization, plane: PlaneNoise
) -> list[tuple[tuple[str, ...], float, float | None]]:
    """The lines of `_FORM` whose values are known, with value and standard error."""
    well, dark_dn2 = plane.saturation_capacity_e, plane.dark_variance_dn2
    least = threshold_e(plane.gain_dn_per_e, plane.dark_noise_e)
    values: dict[str, tuple[float | None, float | None]] = {
        "QE": (plane.qe, plane.qe_se),
        "K": (plane.gain_dn_per_e, plane.gain_dn_per_e_se),
        "sigma_d": (plane.dark_noise_e, plane.dark_noise_e_se),
        "sigma_y_dark": (None if dark_dn2 is None else math.sqrt(dark_dn2), None),
        "u_e_sat": (well, None),
        "full_well": (plane.full_well_e, plane.full_well_e_se),
        "u_e_min": (least, None),
        "u_p_sat": (_photons(well, plane.qe), None),
        "u_p_min": (_photons(least, plane.qe), None),
        "SNR_max_dB": (10 * math.log10(well) if well and well > 0 else None, None),
        "DR_dB": (dynamic_range_db(well, least), None),
        "DSNU1288": (plane.dsnu_e, plane.dsnu_e_se),
        "PRNU1288": (plane.prnu, plane.prnu_se),
        "LE": (plane.linearity_error_percent, None),
        "u_I_mean": (plane.dark_current_e_per_s, plane.dark_current_e_per_s_se),
        "black_level": (plane.black_level_dn, plane.black_level_dn_se),
        "bits": (result.bits, None),
    }
    return [
        (form, value, error)
        for form in _FORM
        for value, error in (values[form[1]],)
        if value is not None and math.isfinite(value)
    ]


_DARK = ("dark_mean_dn", "dark_variance_dn2")
_COLUMNS = ("mean_dn", "variance_dn2", "samples", "time_ms", "photons_per_pixel", *_DARK)
_PERCENT = ("QE", "PRNU1288")
_FORM = (  # section and name in XML, name in text, symbol, unit, meaning
    ("sensitivity", "QE", "QE", "eta", "1", "Quantum efficiency"),
    ("sensitivity", "K", "K", "K", "DN/e-", "System gain"),
    ("sensitivity", "sigma_d", "sigma_d", "sigma_d", "e-", "Temporal dark noise"),
    ("sensitivity", "sigma_y_dark", "sigma_y.dark", "sigma_y.dark", "DN", "Temporal dark noise"),
    ("sensitivity", "u_e_sat", "mu_e.sat", "mu_e.sat", "e-", "Saturation capacity"),
    ("sensitivity", "full_well", "full well", "full well", "e-", "Electrons of a saturated level"),
    ("sensitivity", "u_e_min", "mu_e.min", "mu_e.min", "e-", "Absolute sensitivity threshold"),
    ("sensitivity", "u_p_sat", "mu_p.sat", "mu_p.sat", "p", "Saturation capacity"),
    ("sensitivity", "u_p_min", "mu_p.min", "mu_p.min", "p", "Absolute sensitivity threshold"),
    ("sensitivity", "SNR_max_dB", "SNR_max", "SNR_max.dB", "dB", "Maximum signal-to-noise ratio"),
    ("sensitivity", "DR_dB", "DR", "DR.dB", "dB", "Dynamic range"),
    ("spatial", "DSNU1288", "DSNU1288", "DSNU_1288", "e-", "Dark signal non-uniformity"),
    ("spatial", "PRNU1288", "PRNU1288", "PRNU_1288", "1", "Photo response non-uniformity"),
    ("linearity", "LE", "LE", "LE", "%", "Largest linearity error"),
    ("dark_current", "u_I_mean", "mu_I.mean", "mu_I.mean", "e-/s", "Dark current from mean"),
    ("converter", "black_level", "black level", "mu_y.dark", "DN", "Black level"),
    ("converter", "bits", "bits", "bits", "bit", "Bits of the converter"),
)


def _photons(electrons: float | None, qe: float | None) -> float | None:
    return electrons / qe if electrons is not None and qe else None


def _digits(value: float, shift: int = 0) -> str:
    """All digits of a number, times 10^shift without rounding, so that it is read back exactly."""
    if isinstance(value, int):
        return str(value)
    return str(Decimal(repr(float(value))).scaleb(shift)) if shift else repr(float(value))


@dataclass(frozen=True, kw_only=True, eq=False)
class MatrixCheck:
    """Temporal variance of linear combinations of the planes, at each level from dark to bright.

    Attributes
    ----------
    levels
        Names of the levels.
    measured
        Variance of each row of the matrix, from the covariance of the planes of a cell, without row
        and column noise. [square of (unit of the matrix times e-)]
    predicted
        The same from the linear model of each plane, with independent planes.
    fitted
        Whether all planes are below 70 % of saturation.
    names
        Of the rows of the matrix.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("names", "mean_error"),
        JsonKey(
            "levels",
            ".",
            rows=True,
            keys=(JsonKey("name", "levels"), "fitted", "measured", "predicted"),
        ),
    )
    levels: tuple[str, ...]
    measured: Float[Array, "k q"]
    predicted: Float[Array, "k q"]
    fitted: tuple[bool, ...]
    names: tuple[str, ...]

    def __post_init__(self) -> None:
        check.freeze(self, "measured", "predicted")

    @property
    def mean_error(self) -> Float[Array, " q"]:
        """Mean of predicted over measured variance minus 1, over the levels that were fitted."""
        used = np.array(self.fitted)
        if not used.any():
            return np.full(self.measured.shape[1], np.nan)
        return np.asarray((self.predicted[used] / self.measured[used] - 1).mean(axis=0))


def variance_through(
    result: Characterization,
    matrix: Float[Array, "q c"],
    channels: tuple[str, ...],
    *,
    names: tuple[str, ...] = (),
) -> MatrixCheck:
    """The variance of each row of a matrix that is applied to electrons, measured and predicted.

    Parameters
    ----------
    matrix
        One column per channel; of several planes of one channel (``G1``, ``G2``) the mean is taken.
    channels
        Names of the columns, e.g. ``("R", "G", "B")``.
    names
        Names of the rows; numbers by default.

    Raises
    ------
    InputError
        If the channels are not those of the planes, or the matrix has another shape.

    Notes
    -----
    C K^-1 S K^-1 C^T with S the covariance of the codes of a cell and K the gains.
    """
    weights = _by_plane(result, check.finite("matrix", "1", matrix), channels)
    gain = np.array([plane.gain_dn_per_e for plane in result.planes])
    rows = weights / gain
    shared = np.array([_shared_dn2(plane) for plane in result.planes])
    every = [*zip(*(plane.levels for plane in result.planes), strict=True)]
    model = np.array([[level.predicted_variance_dn2 for level in levels] for levels in every])
    return MatrixCheck(
        levels=tuple(levels[0].name for levels in every),
        measured=np.einsum("qp,kpr,qr->kq", rows, result.covariance_dn2, rows),
        predicted=np.maximum(model - shared, 0.0) @ (rows**2).T,
        fitted=tuple(all(level.fitted for level in levels) for levels in every),
        names=names or tuple(str(i + 1) for i in range(len(rows))),
    )


def variance_through_file(result: Characterization, given: GivenMatrix) -> MatrixCheck:
    """`variance_through` for the color matrix of a file.

    Parameters
    ----------
    given
        From ``read_matrix``. A matrix for white-balanced raw is applied
        to electrons divided by those of the brightest fitted level, whose light counts as white.

    Raises
    ------
    InputError
        As `variance_through`, or if no level is below saturation in all planes.
    """
    own = tuple(dict.fromkeys(color_of_plane(plane.name) for plane in result.planes))
    channels = given.channels or own
    values = given.values
    if given.kind == "from-xyz":
        values = pinv(f"matrix of {given.source}", values)
    elif given.kind == "balanced":
        white = _white_e(result)
        values = values / np.array([white.get(name, 1.0) for name in channels])
    names = ("X", "Y", "Z") if given.target == "XYZ" else ("R", "G", "B")
    return variance_through(result, values, channels, names=names)


def _white_e(result: Characterization) -> dict[str, float]:
    """Electrons of each channel at the brightest level that was fitted in all planes."""
    every = zip(*(plane.levels for plane in result.planes), strict=True)
    fitted = [levels for levels in every if all(level.fitted for level in levels)]
    if not fitted:
        raise InputError(
            result.source, "must have a level below 70 % of saturation in all planes for a matrix"
        )
    electrons: dict[str, list[float]] = {}
    for plane, level in zip(result.planes, fitted[-1], strict=True):
        above = level.mean_dn - (level.dark_mean_dn or 0.0)
        electrons.setdefault(color_of_plane(plane.name), []).append(above / plane.gain_dn_per_e)
    return {name: float(np.mean(values)) for name, values in electrons.items()}


def _shared_dn2(plane: PlaneNoise) -> float:
    """Variance of row and column noise. [DN^2]"""
    parts = (getattr(plane, name) or 0.0 for name in SHARED)
    return plane.gain_dn_per_e**2 * sum(part**2 for part in parts)


def _by_plane(
    result: Characterization, matrix: Float[Array, "q c"], channels: tuple[str, ...]
) -> Float[Array, "q p"]:
    """One column per plane; the channel of ``G1`` is ``G``, unless there is a channel ``G1``."""
    names = [plane.name for plane in result.planes]
    of_plane = [name if name in channels else color_of_plane(name) for name in names]
    if sorted(set(of_plane)) != sorted(channels):
        raise InputError(
            "matrix",
            f"must have the channels of the planes {', '.join(names)}",
            value=channels,
            found=f"has {', '.join(channels)}",
        )
    fits = matrix.ndim == 2 and matrix.shape[1] == len(channels)
    check.shape("matrix", matrix, fits, f"must have one column for each of {', '.join(channels)}")
    columns = [channels.index(name) for name in of_plane]
    counts = np.array([of_plane.count(name) for name in of_plane])
    return np.asarray(matrix[:, columns] / counts)
