"""The largest signal of a pixel: its full well, or the top code of its converter."""

import math

from chromanoise.sensor.adc import adc_of
from chromanoise.sensor.sensor import Sensor


def code_range_e(sensor: Sensor) -> float:
    """Electrons from black level to top code; inf where bits or gain are not known. [e-]

    Where n readings are summed (`chromanoise.sensor.binned`), it is n times that of one reading.

    Parameters
    ----------
    sensor
        The sensor.
    """
    converter = sensor.converter
    if converter.bits is None or converter.gain_e_per_dn is None:
        return math.inf
    adc = adc_of(converter, sensor.pixel)
    codes = adc.top_code - adc.black_level_dn
    return codes * adc.gain_e_per_dn * sensor.pixel.summed_readings


def white_level_e(sensor: Sensor, *, dark_e: float = 0.0) -> float:
    """Largest signal: full well minus dark electrons, or the top code if that is lower. [e-]

    Dark electrons take up part of the well; their mean is subtracted from the codes, which start at
    the black level. The result is 0 or less where dark electrons fill the whole well.

    Parameters
    ----------
    sensor
        Its pixel and converter.
    dark_e
        Mean number of dark electrons of the exposure. [e-]

    Notes
    -----
    EMVA 1288, release 4.0, calls it the saturation capacity and finds it at the largest variance.

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
    return min(sensor.pixel.full_well_e - dark_e, code_range_e(sensor))


def white_level_name(sensor: Sensor, *, dark_e: float = 0.0) -> str:
    """What limits the signal: ``full well`` or ``top code`` (`white_level_e`).

    Parameters
    ----------
    sensor
        The sensor.
    dark_e
        Dark electrons. [e-]
    """
    well_e = sensor.pixel.full_well_e - dark_e
    return "top code" if code_range_e(sensor) < well_e else "full well"
