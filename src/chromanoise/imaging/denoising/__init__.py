"""Denoising with the known noise of the exposure: planes, methods, noise of the result."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.imaging.denoising.denoised_pictures import (
        captured_with as captured_with,
        denoised_electrons as denoised_electrons,
        denoised_mosaic as denoised_mosaic,
        denoised_planes as denoised_planes,
        planes_of_electrons as planes_of_electrons,
        planes_of_mosaic as planes_of_mosaic,
    )
    from chromanoise.imaging.denoising.electron_planes import (
        DenoisingMethod as DenoisingMethod,
        NoisyPlanes as NoisyPlanes,
        packed as packed,
        stabilized as stabilized,
        unpacked as unpacked,
        unstabilized as unstabilized,
    )
    from chromanoise.imaging.denoising.linear import (
        LMMSE as LMMSE,
        WIENER as WIENER,
        LinearFilter as LinearFilter,
        denoised_bank as denoised_bank,
        denoised_covariance as denoised_covariance,
        denoised_noise_spectrum as denoised_noise_spectrum,
        filtered as filtered,
        linear_filters as linear_filters,
    )
    from chromanoise.imaging.denoising.methods import (
        DENOISING as DENOISING,
        denoising_named as denoising_named,
    )
    from chromanoise.imaging.denoising.raw_pictures import (
        Burst as Burst,
        BurstFrame as BurstFrame,
        CodeNoise as CodeNoise,
        DenoisedRaw as DenoisedRaw,
        at_brightness as at_brightness,
        code_noise as code_noise,
        code_noise_of_profile as code_noise_of_profile,
        denoised_raw as denoised_raw,
        measured_noise_ratio as measured_noise_ratio,
        merged_frames as merged_frames,
        neutral_planes as neutral_planes,
        residual_ratio as residual_ratio,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
