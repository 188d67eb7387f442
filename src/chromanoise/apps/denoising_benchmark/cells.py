"""The benchmark of denoising on the paper's cameras: scenes, cameras and light levels by name."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import product

from chromanoise.apps.denoising_benchmark.benchmark import (
    BenchmarkCamera,
    BenchmarkCell,
    BenchmarkScene,
    benchmark_cells,
    benchmark_scene,
)
from chromanoise.base import InputError, Setting
from chromanoise.color import kernel_matrix
from chromanoise.imaging import ALL_CORES, Work, mosaic_of
from chromanoise.imaging.denoising import DENOISING, denoising_named
from chromanoise.noise import Exposure, OperatingPoint, time_to_saturation
from chromanoise.sensor import Sensor, mosaic_named
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import sensor_named

BENCHMARK_CAMERAS = (
    "onyx-rgbw",
    "onyx-rgb-ircut",
    "model-rgbir",
    "onyx-rgb-ircut:bayer",
)
"""Sensors, with all channels at every pixel or, after a colon, behind a mosaic."""
BENCHMARK_SCENES = (
    "builtin:checker",
    "builtin:dead-leaves",
    "builtin:slanted-edges",
    "builtin:foliage",
)
BENCHMARK_LEVELS_LUX = (100.0, 10.0, 1.0, 0.1)

_F_NUMBER, _SHARE, _LEVEL_LUX = 1.8, 0.99, 10.0  # the paper's


def benchmark_camera(name: str, *, level_lux: float, demosaic: str = "bilinear") -> BenchmarkCamera:
    """A camera of the benchmark at a light level.

    Parameters
    ----------
    name
        A sensor of the catalog, or a sensor, a colon and a mosaic (`BENCHMARK_CAMERAS`).
    level_lux
        Illuminance on the scene, of illuminant E. [lx]
    demosaic
        A name of `chromanoise.imaging.DEMOSAICING`, for a mosaic.

    Raises
    ------
    InputError
        If there is no such sensor or mosaic, or the level is not positive.

    Notes
    -----
    The paper's exposure and matrix (kernel, eq. 6): f/1.8 and the time at which onyx-rgbw reaches
    99 % of full well on a perfect white at 10 lx, 11.94 ms, for all cameras and levels up to 10 lx.
    Above 10 lx it is the longest time at which nothing saturates, so that 100 lx gives as many
    electrons as 10 lx.
    """
    sensor_name, colon, mosaic = name.partition(":")
    light = equal_energy(DEFAULT_GRID)
    brightest = flat_field(light, level_lux=max(level_lux, _LEVEL_LUX))
    time_s = time_to_saturation(
        brightest, sensor_named("onyx-rgbw"), f_number=_F_NUMBER, share=_SHARE
    )
    sensor, exposure = _complete(sensor_name), Exposure(time_s=time_s, f_number=_F_NUMBER)
    point = OperatingPoint(sensor=sensor, exposure=exposure, illuminant=light, level_lux=level_lux)
    own = None if not colon or mosaic == "sensor" else mosaic_named(mosaic)
    return BenchmarkCamera(
        name=name,
        point=point,
        matrix=kernel_matrix(sensor, exposure),
        mosaic=mosaic_of(point, own) if colon else None,
        demosaic=demosaic,
    )


def _complete(name: str) -> Sensor:
    """A sensor of the catalog that needs no setting beside its name.

    Raises
    ------
    InputError
        If there is none with this name, or it needs another setting.
    """
    try:
        return sensor_named(name)
    except InputError as error:
        needed = [one.name for one in error.remedy if isinstance(one, Setting)]
        if not needed:
            raise
        raise InputError(
            f"sensor {name}",
            "must be known by its name alone in the benchmark",
            value=name,
            found=f"needs {', '.join(needed)}",
            remedy=f"take another sensor, e.g. {', '.join(BENCHMARK_CAMERAS[:3])}",
        ) from None


def denoising_benchmark(
    scenes: Sequence[str | BenchmarkScene] = BENCHMARK_SCENES,
    cameras: Sequence[str] = BENCHMARK_CAMERAS,
    levels_lux: Sequence[float] = BENCHMARK_LEVELS_LUX,
    methods: Sequence[str] | None = None,
    *,
    seeds: Sequence[int] = (0,),
    crop_px: int | None = None,
    demosaic: str = "bilinear",
    work: Work = ALL_CORES,
    progress: Callable[[int], None] | None = None,
) -> tuple[BenchmarkCell, ...]:
    """All cells of the benchmark: scenes, cameras, light levels, methods and seeds.

    Parameters
    ----------
    scenes
        Names of built-in cubes, or scenes by `chromanoise.imaging.denoising.benchmark_scene`.
    cameras
        As `benchmark_camera`.
    levels_lux
        Illuminances of illuminant E. [lx]
    methods
        Names of `chromanoise.imaging.denoising.DENOISING`; all by default.
    seeds
        Each is another draw of the noise, and another cell.
    crop_px
        Side of the part of a scene that is given by name. [px]
    demosaic
        As `benchmark_camera`.
    work
        Threads of the methods, or an executor, e.g. `concurrent.futures.ProcessPoolExecutor`, to
        which pictures are sent; each worker runs a method on one thread. The cells are the same
        for any setting, except for the measured times.
    progress
        Called with the number of cells that were completed.

    Raises
    ------
    InputError
        As `benchmark_scene`, `benchmark_camera` and
        `chromanoise.imaging.denoising.benchmark_cells`; names are checked before the computation.
    """
    chosen = tuple(denoising_named(name).name for name in (methods or DENOISING))
    shown = [
        benchmark_scene(scene, crop_px=crop_px) if isinstance(scene, str) else scene
        for scene in scenes
    ]
    made = [
        benchmark_camera(name, level_lux=lux, demosaic=demosaic)
        for name, lux in product(cameras, levels_lux)
    ]
    each = work if work.executor is None else replace(work, executor=None, threads=1, progress=None)
    run = partial(_cells, methods=chosen, work=each)
    tasks = zip(*product(shown, made, seeds), strict=True)
    results = (map if work.executor is None else work.executor.map)(run, *tasks)
    cells: list[BenchmarkCell] = []
    for some in results:
        cells += some
        if progress:
            progress(len(some))
    return tuple(cells)


def _cells(
    scene: BenchmarkScene,
    camera: BenchmarkCamera,
    seed: int,
    *,
    methods: tuple[str, ...],
    work: Work,
) -> tuple[BenchmarkCell, ...]:
    return benchmark_cells(scene, camera, methods, seed=seed, work=work)
