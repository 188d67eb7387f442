"""Pixel values of a picture that override those of the sensor."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace

from chromanoise.sensor.adc import adc_of
from chromanoise.sensor.sensor import Sensor


@dataclass(frozen=True, slots=True, kw_only=True)
class PixelOverrides:
    """Values that override the sensor's own; ``None`` keeps the sensor's value, 0 overrides it.

    Attributes
    ----------
    bits, black_level_dn
        Number of bits and black level of the converter. [1], [DN]
    dark_current_e_per_s, dsnu_e, prnu, row_noise_e
        As `Imperfections`. [e-/s], [e-], [1], [e-]
    """

    bits: int | None = None
    black_level_dn: int | None = None
    dark_current_e_per_s: float | None = None
    dsnu_e: float | None = None
    prnu: float | None = None
    row_noise_e: float | None = None


def overridden(sensor: Sensor, given: PixelOverrides, *, raw: bool) -> Sensor:
    """The sensor as a picture uses it; its notes list which of its own values are used.

    Parameters
    ----------
    sensor
        The sensor, with its own imperfections and converter.
    given
        Values that override those of the sensor.
    raw
        Whether the picture is of raw codes; otherwise no converter is used.

    Raises
    ------
    InputError
        If a value is out of range.
    """
    asked = {name: value for name, value in asdict(given).items() if value is not None}
    own = _told(sensor)
    known = sensor.converter.known
    converter = replace(sensor.converter, **{k: v for k, v in asked.items() if k in _CONVERTER})
    flaws = replace(sensor.imperfections, **{k: v for k, v in asked.items() if k not in _CONVERTER})
    used = {k: v for k, v in own.items() if k not in asked}
    won = {k: v for k, v in {**own, **known}.items() if k in asked and asked[k] != v}
    notes = [f"{_listed(used)} of the sensor's pixel in the picture"] if used else []
    if won:
        notes.append(f"{', '.join(won)} as given, instead of {_listed(won)} of the sensor's pixel")
    changed = replace(sensor, converter=converter, imperfections=flaws)
    if known:
        notes += _converter_notes(changed, known, raw=raw)
    return replace(changed, notes=(*sensor.notes, *notes))


def left_out_of_closed_form(sensor: Sensor) -> tuple[str, ...]:
    """A note on the pixel values that closed forms (shot noise and read noise) leave out.

    Examples
    --------
    >>> from chromanoise.sensor import Imperfections
    >>> from chromanoise.catalog import sensor_named
    >>> from chromanoise.spectra import DEFAULT_GRID
    >>> plain = sensor_named("model-rgb", DEFAULT_GRID)
    >>> left_out_of_closed_form(replace(plain, imperfections=Imperfections(prnu=0.01)))
    ('shot noise and read noise only: prnu 0.01 of the pixel left out',)
    """
    values = {**_told(sensor), **sensor.converter.known}
    if not values:
        return ()
    return (f"shot noise and read noise only: {_listed(values)} of the pixel left out",)


_CONVERTER = ("bits", "black_level_dn")


def _told(sensor: Sensor) -> dict[str, float]:
    """The sensor's own imperfections that are not 0."""
    return {name: value for name, value in asdict(sensor.imperfections).items() if value}


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
    if "gain_e_per_dn" in known and sensor.converter.bits is None:
        unused = "the gain of the sensor's pixel is used only where the bits are given too"
        return [f"{converter}; {unused}"]
    last_e = (adc.top_code - adc.black_level_dn) * adc.gain_e_per_dn
    return [f"{converter}; codes end at {last_e:.4g} e-, {last_e / full_e:.3g} of the full well"]


def _listed(values: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in values.items())
