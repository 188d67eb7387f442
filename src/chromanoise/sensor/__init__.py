"""What a camera is: channels on silicon, the pixel under them, the mosaic over them."""

from chromanoise.sensor.adc import Adc, Converter, adc_of, adc_to_full_well
from chromanoise.sensor.catalogue import KNOWN_SENSORS, SENSOR_NAMES, sensor_named
from chromanoise.sensor.catalogue_tables import sensor_from_table
from chromanoise.sensor.changes import behind_ir_cut, with_shifted_curves
from chromanoise.sensor.darktable import (
    RelativeNoise,
    pixel_from_darktable,
    read_darktable_noise,
)
from chromanoise.sensor.emva import pixel_from_emva, read_emva_sheet
from chromanoise.sensor.filters import (
    filter_named,
    ir_cut,
    is_filter_name,
    resin_filter,
    silicon_qe,
)
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
from chromanoise.sensor.noise_profile import (
    noise_profile,
    noise_without_light_e,
    pixel_from_noise_profile,
    read_noise_profile,
)
from chromanoise.sensor.overrides import (
    PixelOverrides,
    left_out_of_closed_form,
    overridden,
)
from chromanoise.sensor.photon_transfer import (
    PhotonTransfer,
    TransferFit,
    photon_transfer_fit,
    pixel_from_photon_transfer,
)
from chromanoise.sensor.photon_transfer_csv import read_photon_transfer_csv
from chromanoise.sensor.pixel import PAPER_PIXEL, Pixel
from chromanoise.sensor.pixel_source import PixelSource, open_questions, pixel_from
from chromanoise.sensor.readers import read_sensor, read_sensor_csv
from chromanoise.sensor.sensor import Sensor, behind_filter, pixels_of, with_channels

__all__ = [
    "KNOWN_SENSORS",
    "MOSAIC_NAMES",
    "PAPER_PIXEL",
    "SENSOR_NAMES",
    "Adc",
    "Converter",
    "Imperfections",
    "Mosaic",
    "PhotonTransfer",
    "Pixel",
    "PixelOverrides",
    "PixelSource",
    "RelativeNoise",
    "Sensor",
    "TransferFit",
    "adc_of",
    "adc_to_full_well",
    "bayer",
    "behind_filter",
    "behind_ir_cut",
    "filter_named",
    "ir_cut",
    "is_filter_name",
    "left_out_of_closed_form",
    "mosaic_named",
    "noise_profile",
    "noise_without_light_e",
    "open_questions",
    "overridden",
    "photon_transfer_fit",
    "pixel_from",
    "pixel_from_darktable",
    "pixel_from_emva",
    "pixel_from_noise_profile",
    "pixel_from_photon_transfer",
    "pixels_of",
    "read_darktable_noise",
    "read_emva_sheet",
    "read_noise_profile",
    "read_photon_transfer_csv",
    "read_sensor",
    "read_sensor_csv",
    "resin_filter",
    "rgb_ir",
    "rgbw_2x2",
    "rgbw_sparse_4x4",
    "sensor_from_table",
    "sensor_named",
    "silicon_qe",
    "with_channels",
    "with_shifted_curves",
]
