"""Denoising methods compared over scenes, sensors and light levels."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.apps.denoising_benchmark.benchmark import (
        BENCHMARK_CAMERAS,
        BENCHMARK_LEVELS_LUX,
        BENCHMARK_SCENES,
        PIXELS_PER_DEGREE,
        BenchmarkCamera as BenchmarkCamera,
        BenchmarkCell as BenchmarkCell,
        BenchmarkScene as BenchmarkScene,
        EdgeSharpness as EdgeSharpness,
        FlatNoise as FlatNoise,
        Verdict as Verdict,
        benchmark_cells as benchmark_cells,
        benchmark_scene as benchmark_scene,
        denoising_benchmark,
        markdown_table as markdown_table,
        verdict as verdict,
        verdict_sentences as verdict_sentences,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
