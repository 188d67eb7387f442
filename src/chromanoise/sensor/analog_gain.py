"""Analog gain, as an ISO setting applies it before the converter, and the signal at white level."""

from dataclasses import replace

from chromanoise import _check
from chromanoise.sensor.adc import adc_of
from chromanoise.sensor.sensor import Sensor


def code_range_e(sensor: Sensor) -> float:
    """Electrons from black level to top code; the full well where the converter is unknown. [e-]"""
    converter = sensor.converter
    if converter.bits is None or converter.gain_e_per_dn is None:
        return sensor.pixel.full_well_e
    adc = adc_of(converter, sensor.pixel)
    return (adc.top_code - adc.black_level_dn) * adc.gain_e_per_dn


def white_level_e(sensor: Sensor, *, dark_e: float = 0.0) -> float:
    """Largest signal: full well minus dark electrons, or the top code if that is lower. [e-]

    Parameters
    ----------
    sensor
        Its pixel and converter.
    dark_e
        Mean number of dark electrons of the exposure. [e-]

    Raises
    ------
    InputError
        If the dark electrons fill the well.

    Examples
    --------
    >>> from chromanoise.catalog import sensor_named
    >>> from chromanoise.sensor import with_pixel
    >>> from chromanoise.spectra import DEFAULT_GRID
    >>> sensor = sensor_named("model-rgb", DEFAULT_GRID)
    >>> white_level_e(with_pixel(sensor, {"full_well_e": 9000.0}), dark_e=100.0)
    8900.0
    >>> white_level_e(with_pixel(sensor, {"bits": 10, "gain_e_per_dn": 2.0}))
    2046.0
    """
    well = _check.positive(
        "full well minus dark electrons", "e-", sensor.pixel.full_well_e - dark_e
    )
    return min(well, code_range_e(sensor))


def with_analog_gain(sensor: Sensor, gain: float, *, read_noise_e: float | None = None) -> Sensor:
    """The sensor at an analog gain: its codes reach the white level at 1/gain of the electrons.

    Parameters
    ----------
    sensor
        At gain 1.
    gain
        Above 0. The quantization step in electrons, and the electrons at the top code, are divided
        by it. Where the converter is unknown, the top code is at the full well.
    read_noise_e
        Read noise at this gain; ``None`` for that at gain 1. [e-]

    Raises
    ------
    InputError
        If the gain is not above 0, or the read noise is negative.

    Examples
    --------
    >>> from chromanoise.catalog import sensor_named
    >>> from chromanoise.sensor import with_pixel
    >>> from chromanoise.spectra import DEFAULT_GRID
    >>> sensor = with_pixel(sensor_named("model-rgb", DEFAULT_GRID), {"full_well_e": 8000.0})
    >>> white_level_e(with_analog_gain(sensor, 4.0))
    2000.0
    """
    factor = _check.positive("gain", "1", gain)
    pixel, converter = sensor.pixel, sensor.converter
    if read_noise_e is not None:
        pixel = replace(pixel, read_noise_e=read_noise_e)
    if converter.bits is None or converter.gain_e_per_dn is None:
        pixel = replace(pixel, full_well_e=pixel.full_well_e / factor)
    if converter.gain_e_per_dn is not None:
        converter = replace(converter, gain_e_per_dn=converter.gain_e_per_dn / factor)
    return replace(sensor, pixel=pixel, converter=converter)
