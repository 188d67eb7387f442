"""Sensors: spectral channels, pixel, mosaic, converter and noise data."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.sensor.camera_noise import (
        ROUNDING_DN2,
        CameraNoise as CameraNoise,
        noise_profile as noise_profile,
        pixel_from_noise_profile as pixel_from_noise_profile,
        pixel_without_levels,
        shot_and_dark,
    )
    from chromanoise.sensor.changes import (
        MOST_SHIFT_NM as MOST_SHIFT_NM,
        PIXEL_FILES,
        PixelOverrides as PixelOverrides,
        PixelSource as PixelSource,
        behind_ir_cut as behind_ir_cut,
        moved_curve as moved_curve,
        of_pixel as of_pixel,
        open_questions as open_questions,
        overridden as overridden,
        pixel_from as pixel_from,
        refuse_summed_readings as refuse_summed_readings,
        with_analog_gain as with_analog_gain,
        with_binning as with_binning,
        with_crosstalk as with_crosstalk,
        with_pixel as with_pixel,
        with_shifted_curves as with_shifted_curves,
        without_crosstalk as without_crosstalk,
    )
    from chromanoise.sensor.crosstalk import (
        MOSAIC_NAMES as MOSAIC_NAMES,
        Crosstalk as Crosstalk,
        Mosaic as Mosaic,
        bayer as bayer,
        crosstalk_of_kernel as crosstalk_of_kernel,
        crosstalk_of_share as crosstalk_of_share,
        mosaic_named as mosaic_named,
        places_of_mosaic as places_of_mosaic,
        refuse_other_channels as refuse_other_channels,
        rgb_ir as rgb_ir,
        rgbw_2x2 as rgbw_2x2,
        rgbw_sparse_4x4 as rgbw_sparse_4x4,
        shares_after_counting as shares_after_counting,
        with_channel_names as with_channel_names,
    )
    from chromanoise.sensor.filter_models import (
        FILTER_MODELS as FILTER_MODELS,
        SILICON_NUMBERS as SILICON_NUMBERS,
        FilterModel as FilterModel,
        alternating_stack as alternating_stack,
        cauchy_index as cauchy_index,
        declared_numbers,
        router_collection as router_collection,
        router_shares as router_shares,
        thin_film_stack as thin_film_stack,
    )
    from chromanoise.sensor.filters import (
        LEAST_LENGTH_NM,
        LEAST_LENGTH_UM,
        ModelNumber as ModelNumber,
        Number,
        beer_lambert as beer_lambert,
        dual_band_filter as dual_band_filter,
        dye_of_bands as dye_of_bands,
        fabry_perot_filter as fabry_perot_filter,
        filter_named as filter_named,
        gaussian_filter as gaussian_filter,
        ir_cut as ir_cut,
        ir_cut_model as ir_cut_model,
        is_filter_name as is_filter_name,
        layered_silicon_qe as layered_silicon_qe,
        long_pass as long_pass,
        possible,
        raised_cosine_filter as raised_cosine_filter,
        resin_filter as resin_filter,
        silicon_qe as silicon_qe,
    )
    from chromanoise.sensor.noise_sources import (
        ALL,
        FIXED,
        NORMAL,
        PATTERN,
        READ,
        READ_OUT,
        SHOT,
        SOURCES,
        Drawn,
        LogLinearNoise as LogLinearNoise,
        NoiseKind,
        NoiseSource as NoiseSource,
        PixelReading,
        ReadNoiseLaw as ReadNoiseLaw,
        ReadNoiseSum as ReadNoiseSum,
        ReadNoiseTable as ReadNoiseTable,
        Term,
        VarianceLaw as VarianceLaw,
        read_noise_sum as read_noise_sum,
        sources_of,
        tukey_lambda_variance as tukey_lambda_variance,
    )
    from chromanoise.sensor.partial_pixel import (
        PartialPixel as PartialPixel,
        PixelSettings as PixelSettings,
    )
    from chromanoise.sensor.photon_transfer import (
        photon_transfer_fit as photon_transfer_fit,
        pixel_from_photon_transfer as pixel_from_photon_transfer,
    )
    from chromanoise.sensor.photon_transfer_regression import (
        LEAST_DARK_DN2,
        SAME_TIME,
        PhotonTransfer as PhotonTransfer,
        TransferFit as TransferFit,
    )
    from chromanoise.sensor.pixel import (
        EXTRA_NOISE as EXTRA_NOISE,
        MOST_BINNING as MOST_BINNING,
        PAPER_PIXEL as PAPER_PIXEL,
        PIXEL as PIXEL,
        PIXEL_NOISE as PIXEL_NOISE,
        PIXEL_REQUIRED as PIXEL_REQUIRED,
        UNKNOWN_CONVERTER,
        Adc as Adc,
        BinningMode as BinningMode,
        Converter as Converter,
        Pixel as Pixel,
        adc_of as adc_of,
        adc_to_full_well as adc_to_full_well,
        binned as binned,
        code_step_e as code_step_e,
        extra_noise as extra_noise,
        of_one_reading as of_one_reading,
        of_the_sum as of_the_sum,
        quantization_step_e as quantization_step_e,
        shot_and_read_only as shot_and_read_only,
    )
    from chromanoise.sensor.sensor import (
        MODELS,
        Origin,
        Sensor as Sensor,
        behind_filter as behind_filter,
        blind_channels,
        code_range_e as code_range_e,
        dye_transmittances as dye_transmittances,
        pixels_of as pixels_of,
        refuse_blind_channels as refuse_blind_channels,
        white_level_e as white_level_e,
        white_level_name as white_level_name,
        with_channels as with_channels,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
