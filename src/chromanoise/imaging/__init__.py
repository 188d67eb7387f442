"""Simulation of whole images: electrons, noise, raw codes, demosaicing, color and files.

Kernels are compiled on their first call and cached; importing this package compiles nothing.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.imaging.demosaic import (
        FilterBank as FilterBank,
        bilinear_filters as bilinear_filters,
        demosaicked as demosaicked,
        malvar_filters as malvar_filters,
    )
    from chromanoise.imaging.demosaic_methods import (
        DEMOSAICING as DEMOSAICING,
        chart_electrons as chart_electrons,
        chart_prior as chart_prior,
    )
    from chromanoise.imaging.demosaic_noise import (
        demosaicked_covariance as demosaicked_covariance,
        flat_field_means as flat_field_means,
        flat_field_noise as flat_field_noise,
        noise_power_spectrum as noise_power_spectrum,
    )
    from chromanoise.imaging.demosaic_priors import (
        PicturePrior as PicturePrior,
        gradient_corrected_filters as gradient_corrected_filters,
        lmmse_filters as lmmse_filters,
        picture_prior as picture_prior,
    )
    from chromanoise.imaging.develop import (
        developed as developed,
        developed_color as developed_color,
    )
    from chromanoise.imaging.dng import (
        RawProfile as RawProfile,
        dng_rows as dng_rows,
        raw_profile as raw_profile,
        write_dng as write_dng,
    )
    from chromanoise.imaging.exr import (
        write_linear_exr as write_linear_exr,
        write_xyz_exr as write_xyz_exr,
    )
    from chromanoise.imaging.noise_equivalent import (
        information_spectrum as information_spectrum,
        noise_equivalent_quanta as noise_equivalent_quanta,
        picture_power_spectrum as picture_power_spectrum,
    )
    from chromanoise.imaging.render import (
        Picture as Picture,
        RawPicture as RawPicture,
        RenderedElectrons as RenderedElectrons,
        acquired as acquired,
        colored as colored,
        electrons_of_cube as electrons_of_cube,
        rendered as rendered,
        rendered_electrons as rendered_electrons,
    )
    from chromanoise.imaging.sampling import noisy_electrons as noisy_electrons
    from chromanoise.imaging.torch_noise import (
        AddCameraNoise as AddCameraNoise,
        NoisyDataset as NoisyDataset,
    )
    from chromanoise.imaging.training_noise import (
        NoiseSampler as NoiseSampler,
        NoisySample as NoisySample,
        sampler as sampler,
    )
    from chromanoise.imaging.unprocessing import (
        Rendering as Rendering,
        draw_rendering as draw_rendering,
        linear_from_srgb as linear_from_srgb,
        mosaicked as mosaicked,
        process as process,
        unprocess as unprocess,
    )
    from chromanoise.imaging.work import Work as Work
    from chromanoise.imaging.writers import (
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
