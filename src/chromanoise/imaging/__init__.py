"""Simulation of whole images: electrons, noise, raw codes, demosaicing, color and files.

Kernels are compiled on their first call and cached; importing this package compiles nothing.
"""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.imaging.acquisition import add_readout_offsets
    from chromanoise.imaging.blocks import (
        COLUMN,
        LEVEL,
        LIGHT,
        PIXEL_GAIN,
        PIXEL_LEVELS,
        PIXEL_OFFSET,
        READOUT,
        ROW,
        new_rows,
    )
    from chromanoise.imaging.capture import (
        Camera,
        Capture,
        CaptureSettings,
        any_picture,
        camera_for,
        capture_summary,
        is_held,
        write_capture,
    )
    from chromanoise.imaging.demosaic import (
        FilterBank as FilterBank,
        bilinear_filters as bilinear_filters,
        channel_tile,
        demosaicked as demosaicked,
        malvar_filters as malvar_filters,
    )
    from chromanoise.imaging.demosaic_methods import (
        DEMOSAICING as DEMOSAICING,
        PicturePrior as PicturePrior,
        chart_electrons as chart_electrons,
        chart_prior as chart_prior,
        demosaicked_covariance as demosaicked_covariance,
        flat_field_means as flat_field_means,
        flat_field_noise as flat_field_noise,
        gradient_corrected_filters as gradient_corrected_filters,
        lmmse_filters as lmmse_filters,
        noise_power_spectrum as noise_power_spectrum,
        picture_prior as picture_prior,
    )
    from chromanoise.imaging.develop import (
        developed as developed,
        developed_color as developed_color,
    )
    from chromanoise.imaging.distributed import client_of, cluster
    from chromanoise.imaging.dng import (
        RawProfile as RawProfile,
        dng_rows as dng_rows,
        raw_profile as raw_profile,
        write_dng as write_dng,
    )
    from chromanoise.imaging.dot_kernels import fused
    from chromanoise.imaging.formats import FORMATS, MOST_FRAMES
    from chromanoise.imaging.frame_sums import (
        SMOOTHED,
        PairSums,
        PatternSums,
        ScaledPairSums,
        add_plane,
        difference_rests,
        neighbor_products,
    )
    from chromanoise.imaging.kernel_cache import inlined, inner, kernel, watch_compiling
    from chromanoise.imaging.noise_draws import (
        ALIASES,
        LANES,
        cell_of,
        count_few,
        count_refused,
        exponential_less_one,
        few_more,
        leading_count,
        list_low,
        minus_log,
        normal_of_words,
        normal_quantile,
        place_of,
        poisson_quantile_of_many,
        read_quantile_of_many,
        room_for,
        start_of,
        words_at,
    )
    from chromanoise.imaging.noise_equivalent import (
        information_spectrum as information_spectrum,
        noise_equivalent_quanta as noise_equivalent_quanta,
        picture_power_spectrum as picture_power_spectrum,
    )
    from chromanoise.imaging.plans import draw_of, white_lux_of
    from chromanoise.imaging.render import (
        ALL_CORES,
        Picture as Picture,
        RawPicture as RawPicture,
        RenderedElectrons as RenderedElectrons,
        acquired as acquired,
        colored as colored,
        electrons_of_cube as electrons_of_cube,
        mosaic_of,
        rendered as rendered,
        rendered_electrons as rendered_electrons,
    )
    from chromanoise.imaging.row_files import (
        tiff_rows,
        write_linear_exr as write_linear_exr,
        write_xyz_exr as write_xyz_exr,
    )
    from chromanoise.imaging.sampling import noisy_electrons as noisy_electrons
    from chromanoise.imaging.shared_rows import Work as Work
    from chromanoise.imaging.writers import (
        mosaic_description,
        mosaic_tiff_rows as mosaic_tiff_rows,
        picture_summary as picture_summary,
        png_bytes as png_bytes,
        raw_summary as raw_summary,
        sixteen_bit_srgb as sixteen_bit_srgb,
        srgb_tiff_rows as srgb_tiff_rows,
        write_mosaic_tiff as write_mosaic_tiff,
        write_png as write_png,
        write_srgb_tiff as write_srgb_tiff,
        write_xyz_tiff as write_xyz_tiff,
        xyz_tiff_rows as xyz_tiff_rows,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
