"""Changes to a sensor and its pixel, and pixels from the values of one source.

A change concerns the pixel, binning, gain, crosstalk, an added IR-cut filter, or a shift in
wavelength. `PixelOverrides` are the values of a picture that override those of the sensor.

A data sheet, a noise profile and a photon-transfer table each give only some of the values of a
pixel. Missing values are never guessed; they become questions for the user.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import asdict, fields, replace
from typing import Any, Unpack

import numpy as np

from chromanoise.base import Array, Float, InputError, Setting, check, dataclass
from chromanoise.sensor.crosstalk import Crosstalk
from chromanoise.sensor.filters import ir_cut
from chromanoise.sensor.partial_pixel import PartialPixel, PixelSettings
from chromanoise.sensor.pixel import (
    PAPER_PIXEL,
    PIXEL,
    PIXEL_REQUIRED,
    Adc,
    BinningMode,
    Converter,
    Pixel,
    adc_of,
    binned,
    extra_noise,
    of_the_sum,
    refuse_coarse_codes,
)
from chromanoise.sensor.sensor import Sensor, behind_filter


@dataclass(frozen=True, kw_only=True)
class PixelSource(PartialPixel):
    """Values that a source gives for a pixel; ``None`` for values that it does not give.

    The properties of `Pixel`, and:

    Attributes
    ----------
    source
        Where the numbers come from.
    gain_e_per_dn
        Electrons per code. [e-/DN]
    bits, black_level_dn
        Number of bits and black level of the converter. [1], [DN]
    adc
        The converter, where both gain and bits are known.
    qe, qe_at_nm
        Quantum efficiency at one wavelength, to check QE curves against. [e-/photon], [nm]
    notes
        Remarks for readers of a result.

    Raises
    ------
    InputError
        If a number is out of the range of real pixels.
    """

    source: str
    gain_e_per_dn: float | None = None
    bits: int | None = None
    black_level_dn: int | None = None
    adc: Adc | None = None
    qe: float | None = None
    qe_at_nm: float | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = f"of {self.source}"
        for name, unit in (("gain_e_per_dn", "e-/DN"), ("qe_at_nm", "nm")):
            if getattr(self, name) is not None:
                check.positive(f"{name} {where}", unit, getattr(self, name))
        for name in PIXEL_REQUIRED:
            if getattr(self, name) is not None:
                PIXEL[name].demand(f"{name} {where}", getattr(self, name))
        if self.qe is not None and not 0.0 <= self.qe <= 1.0:
            raise InputError(
                f"qe {where}",
                "must be 0 to 1 [e-/photon]",
                value=self.qe,
                remedy="divide percent by 100",
            )


PIXEL_FILES = (
    "a data sheet (lines as 'sigma_d = 2.4 e-'), a photon transfer (CSV headed "
    "mean_dn,variance_dn2), a noise profile ('NoiseProfile: 0.0002 0.000001', or JSON as "
    '{"S": 0.0002, "O": 1e-6, "black_level_dn": 64, "white_level_dn": 1023}), or TOML with '
    "schema = 'chromanoise pixel'"
)
"""The files that can describe a pixel, each with an example, for messages."""


def open_questions(source: PixelSource) -> tuple[str, ...]:
    """One question for each value that the source lacks for a `Pixel`.

    Parameters
    ----------
    source
        The values of a file of a pixel.

    Examples
    --------
    >>> open_questions(PixelSource(source="a sheet", pitch_um=3.0, full_well_e=9000.0))
    ('read_noise_e: what is the read noise? [e-]',)
    """
    return tuple(
        f"{name}: what is the {PIXEL[name].label}?{check.in_brackets(PIXEL[name].unit)}"
        for name in PIXEL_REQUIRED
        if getattr(source, name) is None
    )


def pixel_from(source: PixelSource, **answers: Unpack[PixelSettings]) -> Pixel:
    """The pixel of a source, with answers to its open questions.

    Parameters
    ----------
    answers
        Properties of `Pixel`, each only if the source does not give it.

    Raises
    ------
    InputError
        If a value is still missing, or an answer is given for a value that the source gives.

    Examples
    --------
    >>> sheet = PixelSource(source="a sheet", pitch_um=3.0, full_well_e=9000.0)
    >>> pixel_from(sheet, read_noise_e=2) == Pixel(pitch_um=3, full_well_e=9000, read_noise_e=2)
    True
    """
    own = {name: getattr(source, name) for name in PIXEL if getattr(source, name) is not None}
    for name, answer in answers.items():
        if name in own and answer is not None:
            raise InputError(
                name,
                f"must be omitted where {source.source} gives it",
                value=answer,
                found=f"{answer:g} is given besides {own[name]:g}",
                remedy=("omit it", "correct the source"),
            )
    known = own | {name: one for name, one in answers.items() if one is not None}
    missing = [name for name in PIXEL_REQUIRED if name not in known]
    if missing:
        raise InputError(
            source.source,
            f"must give {', '.join(PIXEL_REQUIRED[:-1])} and {PIXEL_REQUIRED[-1]} for a pixel",
            found=f"gives no {' and no '.join(missing)}",
            remedy=Setting(missing[0]) if len(missing) == 1 else "set each of them",
        )
    return Pixel(**known)


MOST_SHIFT_NM = 200.0
"""Largest shift of curves or of a filter. [nm]"""
LOWEST_EDGE_NM, HIGHEST_EDGE_NM = 450.0, 2000.0


_OF_PIXEL = frozenset(field.name for field in fields(Pixel))
_OF_CONVERTER = frozenset(field.name for field in fields(Converter))


def of_pixel(changes: Mapping[str, Any]) -> dict[str, Any]:
    """The changes that are fields of `Pixel`.

    Parameters
    ----------
    changes
        Values by the names of settings.
    """
    return {name: value for name, value in changes.items() if name in _OF_PIXEL}


def with_pixel(
    sensor: Sensor, changes: Mapping[str, Any], *, varied: Collection[str] = ()
) -> Sensor:
    """The sensor with other values of its pixel and converter.

    Parameters
    ----------
    changes
        Values by the names of the fields of `Pixel` and `Converter`; of one pixel, if the
        sensor's are binned. A 0 among them is a value: a temperature beside a dark current of 0 is
        valid.
    varied
        Names of fields that get other values later.

    Raises
    ------
    InputError
        If a value is out of range, there is no such field, or a value has no effect, e.g. a
        temperature of a pixel without dark current.

    Examples
    --------
    >>> from chromanoise.study import sensor_named
    >>> from chromanoise.spectra import DEFAULT_GRID
    >>> noisy = with_pixel(sensor_named("model-rgb", DEFAULT_GRID), {"dsnu_e": 2.0, "bits": 10})
    >>> noisy.pixel.dsnu_e, noisy.converter.bits
    (2.0, 10)
    """
    if not changes:
        refuse_coarse_codes(sensor.converter, sensor.pixel)
        return sensor
    for name in changes:
        check.among("field of the pixel", name, sorted(_OF_PIXEL | _OF_CONVERTER))
    pixel = replace(sensor.pixel, **of_the_sum(sensor.pixel, of_pixel(changes)))
    for name, one in PIXEL.items():
        idle = one.needs and not any(
            getattr(pixel, needed) or needed in changes or needed in varied for needed in one.needs
        )
        if idle and changes.get(name, none := getattr(PAPER_PIXEL, name)) != none:
            labels = " or ".join(PIXEL[n].label for n in one.needs)
            raise InputError(
                name,
                f"must be given only for a pixel with {labels}",
                value=changes[name],
                found=f"{sensor.name} has none",
                remedy=(*map(Setting, one.needs), "omit it"),
            )
    known = {name: value for name, value in changes.items() if name in _OF_CONVERTER}
    converter = replace(sensor.converter, **known)
    refuse_coarse_codes(converter, pixel)
    silent = changes.get("rtn_share") and not pixel.rtn_amplitude_e
    note = (_NO_TELEGRAPH,) if silent and "rtn_amplitude_e" not in varied else ()
    return replace(sensor, pixel=pixel, converter=converter, notes=(*sensor.notes, *note))


_NO_TELEGRAPH = "no telegraph noise, because the RTN amplitude is 0"


def with_binning(sensor: Sensor, pixels: int, mode: BinningMode = "charge") -> Sensor:
    """The sensor with the sums of ``pixels`` pixels in place of its pixels, and a note on it.

    Parameters
    ----------
    sensor
        A sensor whose pixels are not binned.
    pixels
        Pixels of one channel that are summed; 1 returns the sensor itself.
    mode
        ``charge``: summed before one reading. ``digital``: as many readings are summed.

    Raises
    ------
    InputError
        As `chromanoise.sensor.binned`.

    Examples
    --------
    >>> from chromanoise.study import sensor_named
    >>> from chromanoise.spectra import DEFAULT_GRID
    >>> with_binning(sensor_named("model-rgb", DEFAULT_GRID), 4).notes[-1]
    '4 pixels binned (charge): sum of 20 um, full well 40000 e-, read noise 10 e-'
    """
    pixel = binned(sensor.pixel, pixels, mode)
    if pixel is sensor.pixel:
        return sensor
    note = (
        f"{pixel.summed_pixels} pixels binned ({mode}): sum of {pixel.pitch_um:.4g} um, full well "
        f"{pixel.full_well_e:.6g} e-, read noise {pixel.read_noise_e:.4g} e-"
    )
    return replace(sensor, pixel=pixel, notes=(*sensor.notes, note))


def behind_ir_cut(sensor: Sensor, edge_nm: float, *, noted: bool = True) -> Sensor:
    """The sensor behind a model IR-cut, in addition to any IR-cut that it already has.

    Parameters
    ----------
    edge_nm
        Wavelength of half transmittance; from 450 to 2000. [nm]
    noted
        Whether a note on the added IR-cut is added.

    Raises
    ------
    InputError
        If the edge is outside this range.
    """
    low, high = LOWEST_EDGE_NM, HIGHEST_EDGE_NM
    edge = check.within("edge_nm", "nm", edge_nm, low, high)
    note = f"behind an added model IR-cut at {edge:g} nm" if noted else ""
    return behind_filter(sensor, ir_cut(sensor.grid, edge_nm=edge), name=sensor.name, note=note)


def with_shifted_curves(sensor: Sensor, shift_nm: float) -> Sensor:
    """The sensor with all of its curves shifted in wavelength.

    QE(λ) becomes QE(λ - shift), interpolated linearly on the grid. At the end from which the curves
    move away, the end value is repeated because no data exist there, and a note reports this. At
    the other end, values that move off the grid are dropped.

    Parameters
    ----------
    shift_nm
        Positive toward longer wavelengths; 0 returns the sensor itself. [nm]

    Raises
    ------
    InputError
        If the shift is not finite, or is larger than 200 nm in either direction.

    Examples
    --------
    >>> from chromanoise.sensor.pixel import PAPER_PIXEL
    >>> from chromanoise.spectra import Grid
    >>> steps = np.array([[0.1], [0.5], [0.2]])
    >>> one = Sensor(name="one", grid=Grid.uniform(500, 520, 10), qe=steps, names=("G",),
    ...              pixel=PAPER_PIXEL)
    >>> with_shifted_curves(one, 5.0).qe[:, 0]
    array([0.1 , 0.3 , 0.35])
    """
    shift = check.within("shift_nm", "nm", shift_nm, -MOST_SHIFT_NM, MOST_SHIFT_NM)
    if shift == 0:
        return sensor
    at, grid = sensor.grid.wavelength_nm, sensor.grid
    qe = np.stack([moved_curve(at, curve, shift_nm=shift) for curve in sensor.qe.T], axis=1)
    unknown = (grid.start_nm, min(grid.start_nm + shift, grid.stop_nm))
    if shift < 0:
        unknown = (max(grid.stop_nm + shift, grid.start_nm), grid.stop_nm)
    note = (
        f"curves shifted by {shift:+g} nm; from {unknown[0]:g} to {unknown[1]:g} nm, where no data "
        "exist, the end value is repeated"
    )
    return replace(sensor, qe=qe, notes=(*sensor.notes, note))


def moved_curve(
    wavelength_nm: Float[Array, " n"],
    curve: Float[Array, " n"],
    *,
    shift_nm: float,
    width_share: float = 0.0,
) -> Float[Array, " n"]:
    """A curve shifted in wavelength and stretched about its centroid.

    Interpolated linearly, so that the mean slope of a shift in both directions is the central
    difference of the table. Beyond the table the end value is repeated.

    Parameters
    ----------
    wavelength_nm, curve
        The table. [nm, any unit]
    shift_nm
        Positive toward longer wavelengths. [nm]
    width_share
        Change of its width over the width, above -1. [1]

    Examples
    --------
    >>> moved_curve(np.array([500.0, 510.0, 520.0]), np.array([0.0, 1.0, 0.0]), shift_nm=1.0)
    array([0. , 0.9, 0.1])
    """
    at = wavelength_nm - shift_nm
    if width_share and curve.any():
        center = float(wavelength_nm @ curve / curve.sum())
        at = center + (at - center) / (1 + width_share)
    return np.interp(at, wavelength_nm, curve)


def with_crosstalk(sensor: Sensor, crosstalk: Crosstalk) -> Sensor:
    """The sensor with crosstalk, in addition to what its curves already contain.

    Parameters
    ----------
    sensor
        A sensor to which no crosstalk was added.
    crosstalk
        One row and one column per channel.

    Raises
    ------
    InputError
        If the sizes differ, the sensor has crosstalk already, or crosstalk after counting cannot be
        inverted.
    """
    check.same_length("channels", sensor=len(sensor.names), crosstalk=len(crosstalk.pixels))
    if sensor.crosstalk is not None:
        raise InputError(
            "crosstalk", "must be given once", value=sensor.name, found=f"{sensor.name} has it"
        )
    mixed = replace(sensor, qe=sensor.qe @ crosstalk.matrix.T, crosstalk=crosstalk)
    if crosstalk.stage == "charge" and without_crosstalk(mixed) is None:
        raise InputError(
            "crosstalk",
            "must be invertible, if it comes after counting",
            value=crosstalk.matrix.tolist(),
            found="is singular",
            remedy=("give a smaller share", Setting("crosstalk_stage", ("light",))),
        )
    return mixed


def without_crosstalk(sensor: Sensor) -> Sensor | None:
    """The sensor before crosstalk was added; ``None`` where the mixing cannot be inverted."""
    if sensor.crosstalk is None:
        return sensor
    unmixing = sensor.crosstalk.inverse
    if unmixing is None:
        return None
    pure = sensor.qe @ unmixing.T
    return replace(sensor, qe=np.clip(pure, 0.0, 1.0), crosstalk=None)


def with_analog_gain(sensor: Sensor, gain: float, *, read_noise_e: float | None = None) -> Sensor:
    """The sensor at an analog gain: its codes reach the white level at 1/gain of the electrons.

    Parameters
    ----------
    sensor
        The sensor at a gain of 1.
    gain
        Above 0. The quantization step in electrons, and the electrons at the top code, are divided
        by it. Where the converter is unknown, the top code is at the full well.
    read_noise_e
        Read noise at this gain, of one pixel if the sensor's are binned; ``None`` for that at gain
        1. [e-]

    Raises
    ------
    InputError
        If the gain is not above 0, or the read noise is negative.

    Examples
    --------
    >>> from chromanoise.study import sensor_named
    >>> from chromanoise.sensor import white_level_e, with_pixel
    >>> from chromanoise.spectra import DEFAULT_GRID
    >>> sensor = with_pixel(sensor_named("model-rgb", DEFAULT_GRID), {"full_well_e": 8000.0})
    >>> white_level_e(with_analog_gain(sensor, 4.0))
    2000.0
    """
    factor = check.positive("gain", "1", gain)
    pixel, converter = sensor.pixel, sensor.converter
    if read_noise_e is not None:
        pixel = replace(pixel, **of_the_sum(pixel, {"read_noise_e": read_noise_e}))
    if converter.bits is None or converter.gain_e_per_dn is None:
        pixel = replace(pixel, full_well_e=pixel.full_well_e / factor)
    if converter.gain_e_per_dn is not None:
        converter = replace(converter, gain_e_per_dn=converter.gain_e_per_dn / factor)
    return replace(sensor, pixel=pixel, converter=converter)


@dataclass(frozen=True, kw_only=True)
class PixelOverrides(PartialPixel):
    """Values that override the sensor's own; ``None`` keeps the sensor's value, 0 overrides it.

    The properties of `Pixel`, and:

    Attributes
    ----------
    bits, black_level_dn
        Number of bits and black level of the converter. [1], [DN]
    """

    bits: int | None = None
    black_level_dn: int | None = None


def overridden(sensor: Sensor, given: PixelOverrides, *, raw: bool) -> Sensor:
    """The sensor as a picture uses it; its notes list which of its own values are used.

    Parameters
    ----------
    sensor
        The sensor, with its own pixel and converter.
    given
        Values that override those of the sensor; of one pixel, if the sensor's are binned.
    raw
        Whether the picture is of raw codes; otherwise no converter is used.

    Raises
    ------
    InputError
        If a value is out of range, or as `refuse_summed_readings` for a picture of raw codes.
    """
    if raw:
        refuse_summed_readings(sensor)
    values = {name: value for name, value in asdict(given).items() if value is not None}
    own = extra_noise(sensor.pixel)
    known = sensor.converter.known
    converter = replace(sensor.converter, **{k: v for k, v in values.items() if k in _CONVERTER})
    values |= of_the_sum(sensor.pixel, values)
    pixel = replace(sensor.pixel, **{k: v for k, v in values.items() if k not in _CONVERTER})
    used = {k: v for k, v in own.items() if k not in values}
    replaced = {k: v for k, v in {**own, **known}.items() if k in values and values[k] != v}
    notes = [f"{_listed(used)} of the sensor's pixel in the picture"] if used else []
    crosstalk = sensor.crosstalk
    if raw and crosstalk is not None and crosstalk.stage == "charge" and crosstalk.kernel is None:
        notes.append(
            "crosstalk after counting is applied before counting in raw codes, because its matrix "
            "does not tell the neighbors: their noise stays independent"
        )
    if replaced:
        notes.append(
            f"{', '.join(replaced)} as given, instead of {_listed(replaced)} of the sensor's pixel"
        )
    changed = replace(sensor, converter=converter, pixel=pixel)
    if known:
        notes += _converter_notes(changed, known, raw=raw)
    return replace(changed, notes=(*sensor.notes, *notes))


def refuse_summed_readings(sensor: Sensor) -> None:
    """Refuse raw codes of digital binning: each would be a sum of codes, not a code.

    Raises
    ------
    InputError
        If the sensor sums several readings.
    """
    if sensor.pixel.summed_readings > 1:
        raise InputError(
            "binning_mode",
            "must be 'charge' for the raw codes of a mosaic",
            value="digital",
            found=f"is 'digital': {sensor.name} has sums of {sensor.pixel.summed_readings} codes",
            remedy="take the picture without a mosaic, or bin the charge",
        )


_CONVERTER = ("bits", "black_level_dn")


def _converter_notes(sensor: Sensor, known: Mapping[str, float], *, raw: bool) -> list[str]:
    if not raw:
        return [
            f"{_listed(known)} of the sensor's pixel not used: a picture without a mosaic has no "
            "converter"
        ]
    adc, full_e = adc_of(sensor.converter, sensor.pixel), sensor.pixel.full_well_e
    converter = (
        f"converter: {adc.bits} bits, {adc.gain_e_per_dn:.4g} e-/DN, black {adc.black_level_dn} DN"
    )
    last_e = (adc.top_code - adc.black_level_dn) * adc.gain_e_per_dn
    same = math.isclose(last_e, full_e, rel_tol=1e-3)
    share = "the full well" if same else f"{last_e / full_e:.3g} of the full well"
    return [f"{converter}; the top code is at {last_e:.0f} e-, {share}"]


def _listed(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in values.items())
