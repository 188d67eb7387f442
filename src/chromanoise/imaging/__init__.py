"""Simulation of whole images: electrons, noise, raw codes, demosaicing, color and files.

Kernels are compiled on their first call and cached; importing this package compiles nothing.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.imaging.demosaic import (
        FilterBank,
        bilinear_filters,
        demosaicked,
        malvar_filters,
    )
    from chromanoise.imaging.demosaic_methods import DEMOSAICING, chart_electrons, chart_prior
    from chromanoise.imaging.demosaic_noise import (
        demosaicked_covariance,
        flat_field_means,
        flat_field_noise,
        noise_power_spectrum,
    )
    from chromanoise.imaging.demosaic_priors import (
        PicturePrior,
        gradient_corrected_filters,
        lmmse_filters,
        picture_prior,
    )
    from chromanoise.imaging.develop import developed, developed_color
    from chromanoise.imaging.dng import RawProfile, dng_rows, raw_profile, write_dng
    from chromanoise.imaging.exr import write_linear_exr, write_xyz_exr
    from chromanoise.imaging.noise_equivalent import (
        information_spectrum,
        noise_equivalent_quanta,
        picture_power_spectrum,
    )
    from chromanoise.imaging.render import (
        Picture,
        RawPicture,
        RenderedElectrons,
        acquired,
        colored,
        electrons_of_cube,
        rendered,
        rendered_electrons,
    )
    from chromanoise.imaging.sampling import noisy_electrons
    from chromanoise.imaging.torch_noise import AddCameraNoise, NoisyDataset
    from chromanoise.imaging.training_noise import NoiseSampler, NoisySample, sampler
    from chromanoise.imaging.unprocessing import (
        Rendering,
        draw_rendering,
        linear_from_srgb,
        mosaicked,
        process,
        unprocess,
    )
    from chromanoise.imaging.work import Work
    from chromanoise.imaging.writers import (
        mosaic_tiff_rows,
        picture_summary,
        png_bytes,
        raw_summary,
        sixteen_bit_srgb,
        srgb_tiff_rows,
        write_mosaic_tiff,
        write_png,
        write_srgb_tiff,
        write_xyz_tiff,
        xyz_tiff_rows,
    )

__all__ = [
    "DEMOSAICING",
    "AddCameraNoise",
    "FilterBank",
    "NoiseSampler",
    "NoisyDataset",
    "NoisySample",
    "Picture",
    "PicturePrior",
    "RawPicture",
    "RawProfile",
    "RenderedElectrons",
    "Rendering",
    "Work",
    "acquired",
    "bilinear_filters",
    "chart_electrons",
    "chart_prior",
    "colored",
    "demosaicked",
    "demosaicked_covariance",
    "developed",
    "developed_color",
    "dng_rows",
    "draw_rendering",
    "electrons_of_cube",
    "flat_field_means",
    "flat_field_noise",
    "gradient_corrected_filters",
    "information_spectrum",
    "linear_from_srgb",
    "lmmse_filters",
    "malvar_filters",
    "mosaic_tiff_rows",
    "mosaicked",
    "noise_equivalent_quanta",
    "noise_power_spectrum",
    "noisy_electrons",
    "picture_power_spectrum",
    "picture_prior",
    "picture_summary",
    "png_bytes",
    "process",
    "raw_profile",
    "raw_summary",
    "rendered",
    "rendered_electrons",
    "sampler",
    "sixteen_bit_srgb",
    "srgb_tiff_rows",
    "unprocess",
    "write_dng",
    "write_linear_exr",
    "write_mosaic_tiff",
    "write_png",
    "write_srgb_tiff",
    "write_xyz_exr",
    "write_xyz_tiff",
    "xyz_tiff_rows",
]
__getattr__, __dir__ = lazy_names(__name__)
