"""What a camera is: channels on silicon, the pixel under them, the mosaic over them."""

from chromanoise.sensor.adc import Adc, adc_to_full_well
from chromanoise.sensor.catalogue import SENSOR_NAMES, sensor_named
from chromanoise.sensor.filters import ir_cut, resin_filter, silicon_qe
from chromanoise.sensor.imperfections import Imperfections
from chromanoise.sensor.mosaic import (
    MOSAIC_NAMES,
    Mosaic,
    bayer,
    mosaic_named,
    rgb_ir,
    rgbw_2x2,
    rgbw_sparse_4x4,
)
from chromanoise.sensor.pixel import PAPER_PIXEL, Pixel
from chromanoise.sensor.readers import read_sensor_csv
from chromanoise.sensor.sensor import Sensor, behind_filter, pixels_of, with_channels

__all__ = [
    "MOSAIC_NAMES",
    "PAPER_PIXEL",
    "SENSOR_NAMES",
    "Adc",
    "Imperfections",
    "Mosaic",
    "Pixel",
    "Sensor",
    "adc_to_full_well",
    "bayer",
    "behind_filter",
    "ir_cut",
    "mosaic_named",
    "pixels_of",
    "read_sensor_csv",
    "resin_filter",
    "rgb_ir",
    "rgbw_2x2",
    "rgbw_sparse_4x4",
    "sensor_named",
    "silicon_qe",
    "with_channels",
]
