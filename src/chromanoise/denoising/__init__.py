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
    )
    from chromanoise.denoising.benchmark_scenes import BenchmarkScene, benchmark_scene
    from chromanoise.denoising.method import DenoisingMethod
    from chromanoise.denoising.methods import DENOISING, denoising_named
    from chromanoise.denoising.planes import NoisyPlanes, packed, unpacked
    from chromanoise.denoising.planes_of_exposure import exposed_planes
    from chromanoise.denoising.stabilization import stabilized, unstabilized
    from chromanoise.denoising.strips import denoised_planes

__all__ = [
    "DENOISING",
    "BenchmarkCamera",
    "BenchmarkCell",
    "BenchmarkScene",
    "DenoisingMethod",
    "EdgeSharpness",
    "FlatNoise",
    "NoisyPlanes",
    "Verdict",
    "benchmark_cells",
    "benchmark_scene",
    "denoised_planes",
    "denoising_named",
    "exposed_planes",
    "markdown_table",
    "packed",
    "stabilized",
    "unpacked",
    "unstabilized",
    "verdict",
]
__getattr__, __dir__ = lazy_names(__name__)
