"""Denoising with the known noise of the exposure: planes, methods, noise of the result."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.denoising.burst import Burst, BurstFrame, merged_frames
    from chromanoise.denoising.linear import LMMSE, WIENER, LinearFilter, filtered, linear_filters
    from chromanoise.denoising.method import DenoisingMethod
    from chromanoise.denoising.methods import DENOISING
    from chromanoise.denoising.pictures import (
        captured_with,
        denoised_electrons,
        denoised_mosaic,
        planes_of_electrons,
        planes_of_mosaic,
    )
    from chromanoise.denoising.planes import NoisyPlanes, packed, unpacked
    from chromanoise.denoising.prediction import (
        denoised_bank,
        denoised_covariance,
        denoised_noise_spectrum,
    )
    from chromanoise.denoising.raw_noise import CodeNoise, code_noise, code_noise_of_profile
    from chromanoise.denoising.raw_pictures import (
        DenoisedRaw,
        at_brightness,
        denoised_raw,
        measured_noise_ratio,
        neutral_planes,
        residual_ratio,
    )
    from chromanoise.denoising.strips import denoised_planes

__all__ = [
    "DENOISING",
    "LMMSE",
    "WIENER",
    "Burst",
    "BurstFrame",
    "CodeNoise",
    "DenoisedRaw",
    "DenoisingMethod",
    "LinearFilter",
    "NoisyPlanes",
    "at_brightness",
    "captured_with",
    "code_noise",
    "code_noise_of_profile",
    "denoised_bank",
    "denoised_covariance",
    "denoised_electrons",
    "denoised_mosaic",
    "denoised_noise_spectrum",
    "denoised_planes",
    "denoised_raw",
    "filtered",
    "linear_filters",
    "measured_noise_ratio",
    "merged_frames",
    "neutral_planes",
    "packed",
    "planes_of_electrons",
    "planes_of_mosaic",
    "residual_ratio",
    "unpacked",
]
__getattr__, __dir__ = lazy_names(__name__)
