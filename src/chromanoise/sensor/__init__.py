"""Sensors: spectral channels, pixel, mosaic, converter and noise data."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names
from chromanoise.sensor.adc import (
    Adc as Adc,
    Converter as Converter,
    adc_of as adc_of,
    adc_to_full_well as adc_to_full_well,
    code_step_e as code_step_e,
    quantization_step_e as quantization_step_e,
)
from chromanoise.sensor.changes import (
    MOST_SHIFT_NM as MOST_SHIFT_NM,
    behind_ir_cut as behind_ir_cut,
    moved_curve as moved_curve,
    of_pixel as of_pixel,
    with_analog_gain as with_analog_gain,
    with_binning as with_binning,
    with_crosstalk as with_crosstalk,
    with_pixel as with_pixel,
    with_shifted_curves as with_shifted_curves,
    without_crosstalk as without_crosstalk,
)
from chromanoise.sensor.crosstalk import (
    Crosstalk as Crosstalk,
    crosstalk_of_kernel as crosstalk_of_kernel,
    crosstalk_of_share as crosstalk_of_share,
    places_of_mosaic as places_of_mosaic,
    refuse_other_channels as refuse_other_channels,
    shares_after_counting as shares_after_counting,
)
from chromanoise.sensor.filters import (
    filter_named as filter_named,
    ir_cut as ir_cut,
    ir_cut_model as ir_cut_model,
    is_filter_name as is_filter_name,
    layered_silicon_qe as layered_silicon_qe,
    resin_filter as resin_filter,
    silicon_qe as silicon_qe,
)
from chromanoise.sensor.mosaic import (
    MOSAIC_NAMES as MOSAIC_NAMES,
    Mosaic as Mosaic,
    bayer as bayer,
    mosaic_named as mosaic_named,
    rgb_ir as rgb_ir,
    rgbw_2x2 as rgbw_2x2,
    rgbw_sparse_4x4 as rgbw_sparse_4x4,
    with_channel_names as with_channel_names,
)
from chromanoise.sensor.noise_profile import (
    noise_profile as noise_profile,
    pixel_from_noise_profile as pixel_from_noise_profile,
)
from chromanoise.sensor.overrides import (
    PixelOverrides as PixelOverrides,
    overridden as overridden,
    refuse_summed_readings as refuse_summed_readings,
)
from chromanoise.sensor.partial_pixel import (
    PartialPixel as PartialPixel,
    PixelSettings as PixelSettings,
)
from chromanoise.sensor.pixel import (
    EXTRA_NOISE as EXTRA_NOISE,
    MOST_BINNING as MOST_BINNING,
    PAPER_PIXEL as PAPER_PIXEL,
    PIXEL as PIXEL,
    PIXEL_NOISE as PIXEL_NOISE,
    PIXEL_REQUIRED as PIXEL_REQUIRED,
    BinningMode as BinningMode,
    Pixel as Pixel,
    binned as binned,
    extra_noise as extra_noise,
    of_one_reading as of_one_reading,
    of_the_sum as of_the_sum,
    shot_and_read_only as shot_and_read_only,
)
from chromanoise.sensor.pixel_source import (
    PixelSource as PixelSource,
    open_questions as open_questions,
    pixel_from as pixel_from,
)
from chromanoise.sensor.saturation import (
    code_range_e as code_range_e,
    white_level_e as white_level_e,
    white_level_name as white_level_name,
)
from chromanoise.sensor.sensor import (
    Sensor as Sensor,
    behind_filter as behind_filter,
    pixels_of as pixels_of,
    with_channels as with_channels,
)
from chromanoise.sensor.variance_law import VarianceLaw as VarianceLaw

if TYPE_CHECKING:
    from chromanoise.sensor.camera_noise import CameraNoise as CameraNoise
    from chromanoise.sensor.color_router import (
        router_collection as router_collection,
        router_shares as router_shares,
    )
    from chromanoise.sensor.dyes import dye_transmittances as dye_transmittances
    from chromanoise.sensor.filter_models import (
        FILTER_MODELS as FILTER_MODELS,
        SILICON_NUMBERS as SILICON_NUMBERS,
        FilterModel as FilterModel,
        ModelNumber as ModelNumber,
    )
    from chromanoise.sensor.filter_shapes import (
        beer_lambert as beer_lambert,
        dual_band_filter as dual_band_filter,
        dye_of_bands as dye_of_bands,
        fabry_perot_filter as fabry_perot_filter,
        gaussian_filter as gaussian_filter,
        long_pass as long_pass,
        raised_cosine_filter as raised_cosine_filter,
    )
    from chromanoise.sensor.photon_transfer import (
        PhotonTransfer as PhotonTransfer,
        TransferFit as TransferFit,
        photon_transfer_fit as photon_transfer_fit,
        pixel_from_photon_transfer as pixel_from_photon_transfer,
    )
    from chromanoise.sensor.read_noise import (
        LogLinearNoise as LogLinearNoise,
        ReadNoiseLaw as ReadNoiseLaw,
        ReadNoiseSum as ReadNoiseSum,
        ReadNoiseTable as ReadNoiseTable,
        read_noise_sum as read_noise_sum,
        tukey_lambda_variance as tukey_lambda_variance,
    )
    from chromanoise.sensor.thin_film import (
        alternating_stack as alternating_stack,
        cauchy_index as cauchy_index,
        thin_film_stack as thin_film_stack,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
