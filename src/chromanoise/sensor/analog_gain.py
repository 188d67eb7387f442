"""Analog gain, as an ISO setting applies it before the converter."""

from dataclasses import replace

from chromanoise import _check
from chromanoise.sensor.pixel import of_the_sum
from chromanoise.sensor.sensor import Sensor


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
        Read noise at this gain, of one pixel if the sensor's are binned; ``None`` for that at gain
        1. [e-]

    Raises
    ------
    InputError
        If the gain is not above 0, or the read noise is negative.

    Examples
    --------
    >>> from chromanoise.catalog import sensor_named
    >>> from chromanoise.sensor import white_level_e, with_pixel
    >>> from chromanoise.spectra import DEFAULT_GRID
    >>> sensor = with_pixel(sensor_named("model-rgb", DEFAULT_GRID), {"full_well_e": 8000.0})
    >>> white_level_e(with_analog_gain(sensor, 4.0))
    2000.0
    """
    factor = _check.positive("gain", "1", gain)
    pixel, converter = sensor.pixel, sensor.converter
    if read_noise_e is not None:
        pixel = replace(pixel, **of_the_sum(pixel, {"read_noise_e": read_noise_e}))
    if converter.bits is None or converter.gain_e_per_dn is None:
        pixel = replace(pixel, full_well_e=pixel.full_well_e / factor)
    if converter.gain_e_per_dn is not None:
        converter = replace(converter, gain_e_per_dn=converter.gain_e_per_dn / factor)
    return replace(sensor, pixel=pixel, converter=converter)
