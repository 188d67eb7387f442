"""Sensors: spectral channels, pixel, mosaic, converter and noise data."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names
from chromanoise.sensor.adc import (
    Adc,
    Converter,
    adc_of,
    adc_to_full_well,
    code_step_e,
    quantization_step_e,
)
from chromanoise.sensor.changes import (
    MOST_SHIFT_NM,
    behind_ir_cut,
    moved_curve,
    of_pixel,
    with_analog_gain,
    with_binning,
    with_crosstalk,
    with_pixel,
    with_shifted_curves,
    without_crosstalk,
)
from chromanoise.sensor.crosstalk import (
    Crosstalk,
    crosstalk_of_kernel,
    crosstalk_of_share,
    places_of_mosaic,
    refuse_other_channels,
    shares_after_counting,
)
from chromanoise.sensor.filters import (
    filter_named,
    ir_cut,
    ir_cut_model,
    is_filter_name,
    layered_silicon_qe,
    resin_filter,
    silicon_qe,
)
from chromanoise.sensor.mosaic import (
    MOSAIC_NAMES,
    Mosaic,
    bayer,
    mosaic_named,
    rgb_ir,
    rgbw_2x2,
    rgbw_sparse_4x4,
    with_channel_names,
)
from chromanoise.sensor.noise_profile import (
    noise_profile,
    pixel_from_noise_profile,
)
from chromanoise.sensor.overrides import (
    PixelOverrides,
    overridden,
    refuse_summed_readings,
)
from chromanoise.sensor.partial_pixel import PartialPixel, PixelSettings
from chromanoise.sensor.pixel import (
    EXTRA_NOISE,
    MOST_BINNING,
    PAPER_PIXEL,
    PIXEL,
    PIXEL_NOISE,
    PIXEL_REQUIRED,
    BinningMode,
    Pixel,
    binned,
    extra_noise,
    of_one_reading,
    of_the_sum,
    shot_and_read_only,
)
from chromanoise.sensor.pixel_source import (
    PixelSource,
    open_questions,
    pixel_from,
)
from chromanoise.sensor.saturation import code_range_e, white_level_e, white_level_name
from chromanoise.sensor.sensor import (
    Sensor,
    behind_filter,
    pixels_of,
    with_channels,
)
from chromanoise.sensor.variance_law import VarianceLaw

if TYPE_CHECKING:
    from chromanoise.sensor.camera_noise import CameraNoise
    from chromanoise.sensor.color_router import router_collection, router_shares
    from chromanoise.sensor.dyes import dye_transmittances
    from chromanoise.sensor.filter_models import (
        FILTER_MODELS,
        SILICON_NUMBERS,
        FilterModel,
        ModelNumber,
    )
    from chromanoise.sensor.filter_shapes import (
        beer_lambert,
        dual_band_filter,
        dye_of_bands,
        fabry_perot_filter,
        gaussian_filter,
        long_pass,
        raised_cosine_filter,
    )
    from chromanoise.sensor.photon_transfer import (
        PhotonTransfer,
        TransferFit,
        photon_transfer_fit,
        pixel_from_photon_transfer,
    )
    from chromanoise.sensor.read_noise import (
        LogLinearNoise,
        ReadNoiseLaw,
        ReadNoiseSum,
        ReadNoiseTable,
        read_noise_sum,
        tukey_lambda_variance,
    )
    from chromanoise.sensor.thin_film import alternating_stack, cauchy_index, thin_film_stack

__all__ = [
    "EXTRA_NOISE",
    "FILTER_MODELS",
    "MOSAIC_NAMES",
    "MOST_BINNING",
    "MOST_SHIFT_NM",
    "PAPER_PIXEL",
    "PIXEL",
    "PIXEL_NOISE",
    "PIXEL_REQUIRED",
    "SILICON_NUMBERS",
    "Adc",
    "BinningMode",
    "CameraNoise",
    "Converter",
    "Crosstalk",
    "FilterModel",
    "LogLinearNoise",
    "ModelNumber",
    "Mosaic",
    "PartialPixel",
    "PhotonTransfer",
    "Pixel",
    "PixelOverrides",
    "PixelSettings",
    "PixelSource",
    "ReadNoiseLaw",
    "ReadNoiseSum",
    "ReadNoiseTable",
    "Sensor",
    "TransferFit",
    "VarianceLaw",
    "adc_of",
    "adc_to_full_well",
    "alternating_stack",
    "bayer",
    "beer_lambert",
    "behind_filter",
    "behind_ir_cut",
    "binned",
    "cauchy_index",
    "code_range_e",
    "code_step_e",
    "crosstalk_of_kernel",
    "crosstalk_of_share",
    "dual_band_filter",
    "dye_of_bands",
    "dye_transmittances",
    "extra_noise",
    "fabry_perot_filter",
    "filter_named",
    "gaussian_filter",
    "ir_cut",
    "ir_cut_model",
    "is_filter_name",
    "layered_silicon_qe",
    "long_pass",
    "mosaic_named",
    "moved_curve",
    "noise_profile",
    "of_one_reading",
    "of_pixel",
    "of_the_sum",
    "open_questions",
    "overridden",
    "photon_transfer_fit",
    "pixel_from",
    "pixel_from_noise_profile",
    "pixel_from_photon_transfer",
    "pixels_of",
    "places_of_mosaic",
    "quantization_step_e",
    "raised_cosine_filter",
    "read_noise_sum",
    "refuse_other_channels",
    "refuse_summed_readings",
    "resin_filter",
    "rgb_ir",
    "rgbw_2x2",
    "rgbw_sparse_4x4",
    "router_collection",
    "router_shares",
    "shares_after_counting",
    "shot_and_read_only",
    "silicon_qe",
    "thin_film_stack",
    "tukey_lambda_variance",
    "white_level_e",
    "white_level_name",
    "with_analog_gain",
    "with_binning",
    "with_channel_names",
    "with_channels",
    "with_crosstalk",
    "with_pixel",
    "with_shifted_curves",
    "without_crosstalk",
]
__getattr__, __dir__ = lazy_names(__name__)
