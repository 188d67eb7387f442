"""Denoising with the known noise of the exposure: planes, methods, noise of the result."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.denoising.benchmark import (
        BenchmarkCamera as BenchmarkCamera,
        BenchmarkCell as BenchmarkCell,
        EdgeSharpness as EdgeSharpness,
        FlatNoise as FlatNoise,
        Verdict as Verdict,
        benchmark_cells as benchmark_cells,
        markdown_table as markdown_table,
        verdict as verdict,
        verdict_sentences as verdict_sentences,
    )
    from chromanoise.denoising.benchmark_scenes import (
        BenchmarkScene as BenchmarkScene,
        benchmark_scene as benchmark_scene,
    )
    from chromanoise.denoising.burst import (
        Burst as Burst,
        BurstFrame as BurstFrame,
        merged_frames as merged_frames,
    )
    from chromanoise.denoising.linear import (
        LMMSE as LMMSE,
        WIENER as WIENER,
        LinearFilter as LinearFilter,
        filtered as filtered,
        linear_filters as linear_filters,
    )
    from chromanoise.denoising.method import DenoisingMethod as DenoisingMethod
    from chromanoise.denoising.methods import (
        DENOISING as DENOISING,
        denoising_named as denoising_named,
    )
    from chromanoise.denoising.pictures import (
        captured_with as captured_with,
        denoised_electrons as denoised_electrons,
        denoised_mosaic as denoised_mosaic,
        planes_of_electrons as planes_of_electrons,
        planes_of_mosaic as planes_of_mosaic,
    )
    from chromanoise.denoising.planes import (
        NoisyPlanes as NoisyPlanes,
        packed as packed,
        unpacked as unpacked,
    )
    from chromanoise.denoising.prediction import (
        denoised_bank as denoised_bank,
        denoised_covariance as denoised_covariance,
        denoised_noise_spectrum as denoised_noise_spectrum,
    )
    from chromanoise.denoising.raw_noise import (
        CodeNoise as CodeNoise,
        code_noise as code_noise,
        code_noise_of_profile as code_noise_of_profile,
    )
    from chromanoise.denoising.raw_pictures import (
        DenoisedRaw as DenoisedRaw,
        at_brightness as at_brightness,
        denoised_raw as denoised_raw,
        measured_noise_ratio as measured_noise_ratio,
        neutral_planes as neutral_planes,
        residual_ratio as residual_ratio,
    )
    from chromanoise.denoising.stabilization import (
        stabilized as stabilized,
        unstabilized as unstabilized,
    )
    from chromanoise.denoising.strips import denoised_planes as denoised_planes

__getattr__, __dir__, __all__ = lazy_names(__name__)
