"""Pixel values of a picture that override those of the sensor."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace

from chromanoise.errors import InputError
from chromanoise.sensor.adc import adc_of
from chromanoise.sensor.partial_pixel import PartialPixel
from chromanoise.sensor.pixel import extra_noise, of_the_sum
from chromanoise.sensor.sensor import Sensor


@dataclass(frozen=True, slots=True, kw_only=True)
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

    Parameters
    ----------
    sensor
        The sensor.

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
