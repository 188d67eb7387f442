"""Denoising with the known noise of the exposure: planes, methods, noise of the result."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.denoising.benchmark import (
        BenchmarkCamera,
        BenchmarkCell,
        EdgeSharpness,
        FlatNoise,
        Verdict,
        benchmark_cells,
        markdown_table,
        verdict,
        verdict_sentences,
    )
    from chromanoise.denoising.benchmark_scenes import BenchmarkScene, benchmark_scene
    from chromanoise.denoising.burst import Burst, BurstFrame, merged_frames
    from chromanoise.denoising.linear import LMMSE, WIENER, LinearFilter, filtered, linear_filters
    from chromanoise.denoising.method import DenoisingMethod
    from chromanoise.denoising.methods import DENOISING, denoising_named
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
    from chromanoise.denoising.stabilization import stabilized, unstabilized
    from chromanoise.denoising.strips import denoised_planes

__all__ = [
    "DENOISING",
    "LMMSE",
    "WIENER",
    "BenchmarkCamera",
    "BenchmarkCell",
    "BenchmarkScene",
    "Burst",
    "BurstFrame",
    "CodeNoise",
    "DenoisedRaw",
    "DenoisingMethod",
    "EdgeSharpness",
    "FlatNoise",
    "LinearFilter",
    "NoisyPlanes",
    "Verdict",
    "at_brightness",
    "benchmark_cells",
    "benchmark_scene",
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
    "denoising_named",
    "filtered",
    "linear_filters",
    "markdown_table",
    "measured_noise_ratio",
    "merged_frames",
    "neutral_planes",
    "packed",
    "planes_of_electrons",
    "planes_of_mosaic",
    "residual_ratio",
    "stabilized",
    "unpacked",
    "unstabilized",
    "verdict",
    "verdict_sentences",
]
__getattr__, __dir__ = lazy_names(__name__)
