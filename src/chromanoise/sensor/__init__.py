"""Sensors: spectral channels, pixel, mosaic, converter and noise data."""

from chromanoise.sensor.adc import (
    Adc,
    Converter,
    adc_of,
    adc_to_full_well,
)
from chromanoise.sensor.changes import (
    behind_ir_cut,
    with_shifted_curves,
)
from chromanoise.sensor.filters import (
    filter_named,
    ir_cut,
    is_filter_name,
    resin_filter,
    silicon_qe,
)
from chromanoise.sensor.imperfections import (
    Imperfections,
)
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
from chromanoise.sensor.pixel import (
    PAPER_PIXEL,
    Pixel,
)
from chromanoise.sensor.pixel_source import (
    PixelSource,
    open_questions,
    pixel_from,
)
from chromanoise.sensor.sensor import (
    Sensor,
    behind_filter,
    pixels_of,
    with_channels,
)

__all__ = [
    "MOSAIC_NAMES",
    "PAPER_PIXEL",
    "Adc",
    "Converter",
    "Imperfections",
    "Mosaic",
    "PhotonTransfer",
    "Pixel",
    "PixelOverrides",
    "PixelSource",
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
    "pixel_from_noise_profile",
    "pixel_from_photon_transfer",
    "pixels_of",
    "resin_filter",
    "rgb_ir",
    "rgbw_2x2",
    "rgbw_sparse_4x4",
    "silicon_qe",
    "with_channels",
    "with_shifted_curves",
]
