"""The benchmark of denoising: scenes, cameras, cells of results, verdict and table.

A scene is a part of a cube with its edges and flat regions; a cell is one scene, camera, light
level and method. By default the cameras, scenes and light levels are those of the paper.
"""

import time
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field, replace
from functools import cache, partial
from itertools import product
from math import inf
from types import MappingProxyType
from typing import Any

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    Float32,
    InputError,
    Integer,
    Setting,
    UInt8,
    check,
    dataclass,
    plain,
)
from chromanoise.color import (
    ColorMatrix,
    adapted_to_d65,
    cielab,
    kernel_matrix,
    scene_xyz,
    srgb_from_xyz,
)
from chromanoise.imaging import (
    ALL_CORES,
    DEMOSAICING,
    Work,
    channel_tile,
    demosaicked,
    draw_of,
    electrons_of_cube,
    mosaic_of,
    noisy_electrons,
    white_lux_of,
)
from chromanoise.imaging.denoising import (
    DENOISING,
    DenoisingMethod,
    NoisyPlanes,
    denoised_planes,
    denoising_named,
    planes_of_electrons,
    planes_of_mosaic,
    unpacked,
)
from chromanoise.metrics import (
    PictureQuality,
    edge_line,
    flat_noise_sd,
    picture_color_difference,
    picture_quality,
    slanted_edge_response,
)
from chromanoise.noise import (
    Exposure,
    OperatingPoint,
    after_counting,
    noise_sources,
    time_to_saturation,
    white_scene,
)
from chromanoise.sensor import ALL, Drawn, Mosaic, Sensor, VarianceLaw, mosaic_named
from chromanoise.spectra import (
    DEFAULT_GRID,
    PATCH_PX,
    SLANTED_EDGES,
    Cube,
    Region,
    Scene,
    builtin_cube,
    equal_energy,
    flat_field,
    interpolation_matrix,
    patch_corners,
    reflectance_rows,
    row_source,
)
from chromanoise.study import sensor_named

LEAST_CROP_PX = 24
"""Least side of a scene: 4 x 4 mosaics have planes of a quarter of it. [px]"""

_MARGIN_PX = 8  # of the flat part of a patch of the chart
_LEAST_FLAT_PX = 16  # of what a part of a cube leaves of a flat region: fewer show no noise


@dataclass(frozen=True, kw_only=True, eq=False)
class BenchmarkScene:
    """A part of a cube, with its known edges and flat regions.

    Attributes
    ----------
    cube
        Only the part, in memory.
    edges
        Region of each slanted edge that lies wholly in the part, by kind and direction.
    flats
        Number of the flat region of each pixel, 0 for none; ``None`` if none is known. Regions of
        which the part holds less than 16 pixels are left out.
    """

    name: str
    cube: Cube
    edges: Mapping[str, Region] = field(default_factory=lambda: MappingProxyType({}))
    flats: Integer[Array, "h w"] | None = None


def benchmark_scene(
    scene: str | Cube, *, crop_px: int | None = None, name: str | None = None
) -> BenchmarkScene:
    """A scene of the benchmark, from the middle of a cube.

    Parameters
    ----------
    scene
        Name of a built-in cube, or a cube.
    crop_px
        Side of the part, at least 24; the whole cube by default. For ``builtin:slanted-edges`` the
        part starts at the first pixel, so that it holds whole edges. [px]
    name
        Name in the tables; that of the cube by default.

    Raises
    ------
    InputError
        If no built-in cube has the name, or the part is larger than the cube or below 24 px.

    Examples
    --------
    >>> sorted(benchmark_scene("builtin:slanted-edges", crop_px=128).edges)
    ['low-contrast vertical', 'luminance vertical']
    """
    cube = builtin_cube(scene) if isinstance(scene, str) else scene
    called = name or (scene if isinstance(scene, str) else cube.source)
    height, width, _ = cube.stored.shape
    rows, columns = (height, width) if crop_px is None else (crop_px, crop_px)
    for side, whole in ((rows, height), (columns, width)):
        if not LEAST_CROP_PX <= side <= whole:
            raise InputError(
                "crop_px",
                f"must be {LEAST_CROP_PX} to {min(height, width)} for the scene {called}",
                value=side,
            )
    edges = called == "builtin:slanted-edges"
    top, left = (0, 0) if edges else ((height - rows) // 2, (width - columns) // 2)
    part = np.array(row_source(cube.stored).rows(top, top + rows)[:, left : left + columns])
    flats = np.zeros((rows, columns), np.int64)
    for number, region in enumerate(_FLATS.get(called, ()), 1):
        marks = np.zeros((height, width), bool)
        marks[region] = True
        inside = marks[top : top + rows, left : left + columns]
        if np.count_nonzero(inside) >= _LEAST_FLAT_PX:
            flats[inside] = number
    return BenchmarkScene(
        name=called,
        cube=replace(cube, stored=part),
        edges={
            f"{edge.kind} {edge.direction}": edge.cell
            for edge in SLANTED_EDGES
            if edges and edge.rows[1] <= rows and edge.columns[1] <= columns
        },
        flats=flats if flats.any() else None,
    )


def _patches() -> tuple[Region, ...]:
    """The insides of the patches of the chart."""
    inside = PATCH_PX - _MARGIN_PX
    return tuple(
        (slice(top + _MARGIN_PX, top + inside), slice(left + _MARGIN_PX, left + inside))
        for top, left in patch_corners()
    )


_FLATS: Mapping[str, tuple[Region, ...]] = {
    "builtin:checker": _patches(),
    "builtin:slanted-edges": tuple(r for edge in SLANTED_EDGES for r in edge.flat_regions),
}


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
PIXELS_PER_DEGREE = 60.0
"""Viewing condition of S-CIELAB: a pixel per minute of arc. [1/deg]"""

_WARM_PX = 64
_SEED_BITS = 64  # of `noisy_electrons`
_SHARED: tuple[Drawn, ...] = ("row", "column", "levels")  # drawn as in pictures


@dataclass(frozen=True, kw_only=True, eq=False)
class BenchmarkCamera:
    """A sensor at one exposure and light, with its color matrix.

    Attributes
    ----------
    point
        Sensor, exposure and light.
    matrix
        From electrons to XYZ. [lx/e-]
    mosaic
        The channel of each pixel; ``None`` for all channels at every pixel.
    demosaic
        A name of `chromanoise.imaging.DEMOSAICING`, applied after denoising of the packed mosaic.
    """

    name: str
    point: OperatingPoint
    matrix: ColorMatrix
    mosaic: Mosaic | None = None
    demosaic: str = "bilinear"


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


@dataclass(frozen=True, kw_only=True)
class EdgeSharpness:
    """Sharpness of a slanted edge in Y, after denoising and in the noise-free picture.

    Attributes
    ----------
    mtf50_cy_px, reference_mtf50_cy_px
        Frequency at which the MTF is 0.5; ``None`` if it is above 1 cycle/px. [cycles/px]
    rise_px, reference_rise_px
        Distance from 10 % to 90 % of the step. [px]
    """

    mtf50_cy_px: float | None
    rise_px: float
    reference_mtf50_cy_px: float | None
    reference_rise_px: float


@dataclass(frozen=True, kw_only=True)
class FlatNoise:
    """Noise on the flat regions of a scene.

    Attributes
    ----------
    lightness_sd, a_sd, b_sd
        Standard deviations of L*, a* and b*. [CIELAB]
    snr_y_db
        Mean of Y over its standard deviation. [dB]
    """

    lightness_sd: float
    a_sd: float
    b_sd: float
    snr_y_db: float


@dataclass(frozen=True, kw_only=True)
class BenchmarkCell:
    """A method on one scene through one camera, compared with the picture without noise.

    Attributes
    ----------
    scene, sensor, lux, method, seed
        Identify the cell; ``sensor`` is the name of the camera, ``lux`` the illuminance [lx].
    quality
        Relative to the noise-free picture of the camera with all channels at every pixel, so it
        includes errors of demosaicing.
    demosaicked_quality
        Relative to the noise-free picture after demosaicing; ``None`` without a mosaic.
    true_ciede2000_mean
        Mean CIEDE2000 relative to the colors of the scene for the observer of the matrix.
    flats
        Noise on flat regions; ``None`` if the scene has none.
    edges
        Sharpness by kind and direction of the edge; ``None`` where no step in Y can be measured.
    snr_y_db
        Mean square of Y without noise over the mean square error of Y: noise and lost detail. [dB]
    seconds
        Time of the method alone. [s]
    srgb, reference_srgb
        The picture, and that of the camera without noise, white-balanced.
    """

    scene: str
    sensor: str
    lux: float
    method: str
    seed: int
    quality: PictureQuality
    demosaicked_quality: PictureQuality | None
    true_ciede2000_mean: float
    flats: FlatNoise | None
    edges: Mapping[str, EdgeSharpness | None]
    snr_y_db: float
    seconds: float
    settings: Mapping[str, Any]
    srgb: UInt8[Array, "h w 3"]
    reference_srgb: UInt8[Array, "h w 3"]

    @property
    def place(self) -> tuple[str, str, float]:
        """Scene, sensor and light level: methods are compared at the same ones."""
        return self.scene, self.sensor, self.lux

    @property
    def rise_px(self) -> float | None:
        """Mean rise distance of the luminance edges; ``None`` without one. [px]"""
        found = (edge for name, edge in self.edges.items() if name.startswith("luminance"))
        rises = [edge.rise_px for edge in found if edge is not None]
        return sum(rises) / len(rises) if rises else None

    @property
    def record(self) -> dict[str, Any]:
        """The cell as JSON data; a number that is not finite is null."""
        quality = plain(self.quality)
        data: dict[str, Any] = plain(
            {
                "scene": self.scene,
                "sensor": self.sensor,
                "lux": self.lux,
                "method": self.method,
                "psnr": quality.pop("psnr_db"),
                **quality,
                "seconds": self.seconds,
                "seed": self.seed,
                "true_ciede2000_mean": self.true_ciede2000_mean,
                "snr_y_db": self.snr_y_db,
                "to_demosaicked": self.demosaicked_quality,
                "flats": self.flats,
                "edges": self.edges,
                "settings": self.settings,
            }
        )
        return data


def benchmark_cells(
    scene: BenchmarkScene,
    camera: BenchmarkCamera,
    methods: Sequence[str],
    *,
    seed: int = 0,
    work: Work = ALL_CORES,
) -> tuple[BenchmarkCell, ...]:
    """One cell per method, all from the same noisy picture.

    Parameters
    ----------
    camera
        Sensor, exposure, light and color matrix.
    seed
        Of the noise, which also depends on the names of scene and camera and on the light; 0 to
        2^64 - 1.
    work
        Threads of the methods.

    Raises
    ------
    InputError
        If a method is unknown or refuses the picture, the sensor has PRNU or crosstalk after
        counting, the cube is invalid, or the seed is out of range.

    Notes
    -----
    Row, column and telegraph noise are drawn as in pictures, all other noise as shot noise and a
    Gaussian readout with the variance of the floor.
    Reflectances hold their last value where the cube does not cover the grid; invalid ones are 0.
    """
    chosen = [denoising_named(name) for name in methods]
    check.whole_of_bits("seed", seed, _SEED_BITS)
    point = camera.point
    mean_e = electrons_of_cube(scene.cube, point, beyond="hold", bad_pixels="zero")
    noise = noise_sources(point.sensor, point.exposure)
    square = noise.law("spatial").square
    if square:
        raise InputError(
            f"sensor {point.sensor.name}",
            "must have no PRNU in the benchmark, which draws temporal noise only",
            value=float(np.sqrt(square)),
        )
    if after_counting(point.sensor.crosstalk) is not None:
        raise InputError(
            f"sensor {point.sensor.name}",
            "must have no crosstalk after counting in the benchmark, whose noise is independent",
            found="has it",
        )
    label = f"{scene.name} {camera.name} {point.level_lux!r}"
    key = zlib.crc32(label.encode()) << 32 ^ seed
    white_e2 = noise.coefficient("floor_e2", ALL, _SHARED)
    noisy_e = noisy_electrons(mean_e, read_noise_e=float(np.sqrt(white_e2)), seed=key)
    if noise.coefficient("floor_e2", _SHARED):
        from chromanoise.imaging import add_readout_offsets

        draw = draw_of(point, seed=0)._replace(key=np.uint64(key), black_error_e=np.float32(0.0))
        add_readout_offsets(noisy_e, camera.mosaic is None, draw)
    compare = _Comparison(scene, camera, mean_e)
    cells = []
    for method in chosen:
        denoised_e, seconds = _denoised(noisy_e, camera, method, work)
        cells.append(compare.cell(denoised_e, method.name, seed, seconds))
    return tuple(cells)


def _denoised(
    noisy_e: Float32[Array, "h w p"], camera: BenchmarkCamera, method: DenoisingMethod, work: Work
) -> tuple[Float[Array, "h w p"], float]:
    """All channels at every pixel after denoising, and the time of the method. [e-], [s]"""
    if camera.mosaic is None:
        return _timed(planes_of_electrons(noisy_e, camera.point), method, work)
    raw = _behind(camera.mosaic, noisy_e, camera)
    planes, seconds = _timed(planes_of_mosaic(raw, camera.point, camera.mosaic), method, work)
    denoised = unpacked(planes, camera.mosaic.shape, raw.shape)
    return _all_channels(camera.mosaic, denoised, camera), seconds


def _timed(
    planes: NoisyPlanes, method: DenoisingMethod, work: Work
) -> tuple[Float32[Array, "h w p"], float]:
    if not method.baseline:
        _compile(method.name, planes.values_e.shape[-1])
    start = time.perf_counter()
    values = denoised_planes(planes, method, work=work)
    return values, time.perf_counter() - start


@cache
def _compile(method: str, planes: int) -> None:
    """Run a method once, so that its kernels are compiled or read before it is timed."""
    denoised_planes(
        NoisyPlanes(
            values_e=np.ones((_WARM_PX, _WARM_PX, planes), np.float32),
            law=VarianceLaw(floor_e2=1.0, slope_e=1.0),
            prior_e2=np.eye(planes),
            prior_mean_e=np.ones(planes),
            names=tuple(map(str, range(planes))),
        ),
        denoising_named(method),
    )


def _behind(
    mosaic: Mosaic, values: Float[Array, "h w p"], camera: BenchmarkCamera
) -> Float32[Array, "h w"]:
    """The one channel over each pixel."""
    tile = channel_tile(mosaic, camera.point.sensor.names)
    height, width, _ = values.shape
    rows, columns = np.arange(height)[:, None], np.arange(width)
    return values[rows, columns, tile[rows % tile.shape[0], columns % tile.shape[1]]]


def _all_channels(
    mosaic: Mosaic, raw_e: Float[Array, "h w"], camera: BenchmarkCamera
) -> Float[Array, "h w p"]:
    return demosaicked(raw_e, DEMOSAICING[camera.demosaic](mosaic, camera.point))


class _Comparison:
    """Pictures of one camera, compared with those without noise."""

    def __init__(
        self, scene: BenchmarkScene, camera: BenchmarkCamera, mean_e: Float32[Array, "h w p"]
    ) -> None:
        self._scene, self._camera = scene, camera
        white_lux = white_lux_of(camera.matrix, camera.point)
        self._white = white_lux / white_lux[1]
        self._to_xyz = camera.matrix.matrix / white_lux[1]
        self._reference = mean_e @ self._to_xyz.T
        self._demosaicked = None
        if camera.mosaic is not None:
            raw_e = _behind(camera.mosaic, mean_e, camera)
            self._demosaicked = _all_channels(camera.mosaic, raw_e, camera) @ self._to_xyz.T
        self._truth = _true_colors(scene.cube, camera)

    def cell(
        self, denoised_e: Float[Array, "h w p"], method: str, seed: int, seconds: float
    ) -> BenchmarkCell:
        """The cell of a denoised picture."""
        camera, point = self._camera, self._camera.point
        xyz = denoised_e @ self._to_xyz.T
        balanced = xyz / self._white
        true = picture_color_difference(balanced, self._truth, np.ones(3))
        return BenchmarkCell(
            scene=self._scene.name,
            sensor=camera.name,
            lux=point.level_lux,
            method=method,
            seed=seed,
            quality=self._quality(xyz, self._reference),
            demosaicked_quality=None
            if self._demosaicked is None
            else self._quality(xyz, self._demosaicked),
            true_ciede2000_mean=float(true.mean()),
            flats=self._flats(xyz),
            edges={name: self._sharpness(xyz[at], name) for name, at in self._scene.edges.items()},
            snr_y_db=self._snr_y_db(xyz),
            seconds=seconds,
            srgb=self._srgb(xyz),
            reference_srgb=self._srgb(self._reference),
            settings={
                "shape": list(xyz.shape[:2]),
                "time_ms": 1e3 * point.exposure.time_s,
                "f_number": point.exposure.f_number,
                "illuminant": point.illuminant.name,
                "channels": list(point.sensor.names),
                "read_noise_e": point.sensor.pixel.read_noise_e,
                "full_well_e": point.sensor.pixel.full_well_e,
                "matrix": camera.matrix.made_by,
                "mosaic": camera.mosaic and [list(row) for row in camera.mosaic.pattern],
                "demosaic": camera.demosaic if camera.mosaic else None,
                "pixels_per_degree": PIXELS_PER_DEGREE,
            },
        )

    def _quality(self, xyz: Array, reference: Array) -> PictureQuality:
        return picture_quality(xyz, reference, self._white, pixels_per_degree=PIXELS_PER_DEGREE)

    def _snr_y_db(self, xyz: Float[Array, "h w 3"]) -> float:
        wanted = self._reference[..., 1]
        error = float(np.square(xyz[..., 1] - wanted).mean())
        return 10 * float(np.log10(np.square(wanted).mean() / error)) if error > 0 else inf

    def _srgb(self, xyz: Float[Array, "h w 3"]) -> UInt8[Array, "h w 3"]:
        shown = srgb_from_xyz(adapted_to_d65(xyz.astype(np.float64), self._white))
        return np.round(255 * shown).astype(np.uint8)

    def _flats(self, xyz: Float[Array, "h w 3"]) -> FlatNoise | None:
        marks = self._scene.flats
        if marks is None:
            return None
        lightness, a, b = flat_noise_sd(cielab(xyz, self._white), marks)
        sd_y = float(flat_noise_sd(xyz[..., 1:2], marks)[0])
        mean_y = float(xyz[..., 1][marks > 0].mean())
        snr_db = 20 * np.log10(mean_y / sd_y) if sd_y > 0 and mean_y > 0 else inf
        return FlatNoise(
            lightness_sd=float(lightness), a_sd=float(a), b_sd=float(b), snr_y_db=float(snr_db)
        )

    def _sharpness(self, xyz: Float[Array, "h w 3"], name: str) -> EdgeSharpness | None:
        reference = self._reference[self._scene.edges[name]][..., 1]
        try:
            line = edge_line(reference)
            sharp = slanted_edge_response(reference, line=line)
            found = slanted_edge_response(xyz[..., 1], line=line)
        except InputError:  # the edge has no step in Y, or noise hides it
            return None
        return EdgeSharpness(
            mtf50_cy_px=found.mtf50_cy_px,
            rise_px=found.rise_px,
            reference_mtf50_cy_px=sharp.mtf50_cy_px,
            reference_rise_px=sharp.rise_px,
        )


def _true_colors(cube: Cube, camera: BenchmarkCamera) -> Float[Array, "h w 3"]:
    """XYZ of the scene for the observer of the matrix, over those of a perfect white. [1]"""
    point, observer = camera.point, camera.matrix.observer
    onto_grid, _ = interpolation_matrix(
        cube.wavelength_nm, point.sensor.grid, beyond="hold", what=f"reflectance of {cube.source}"
    )
    bands = Scene(illuminant=point.illuminant, level_lux=point.level_lux, reflectance=onto_grid.T)
    of_bands = scene_xyz(bands, observer=observer)
    white = scene_xyz(white_scene(point), observer=observer)
    return reflectance_rows(cube, 0, cube.stored.shape[0]) @ of_bands / white


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
        Names of built-in cubes, or scenes by `benchmark_scene`.
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
        `benchmark_cells`; names are checked before the computation.
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


# ---- verdict and table ----


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """A method against all baselines.

    Attributes
    ----------
    places, won
        Number of combinations of scene, sensor and light, and of those in which the method has a
        lower mean CIEDE2000 and a lower mean S-CIELAB than every baseline.
    worst_ratio
        Largest ratio of its CIEDE2000, or its S-CIELAB, to that of the best baseline.
    worst
        Scene, sensor and light of this ratio.
    """

    method: str
    places: int
    won: int
    worst_ratio: float
    worst: tuple[str, str, float]

    @property
    def share(self) -> float:
        """Share of the combinations in which the method won. [1]"""
        return self.won / self.places


def verdict(cells: Iterable[BenchmarkCell], method: str) -> Verdict:
    """How often a method is better than every baseline, and where it is worst.

    Parameters
    ----------
    cells
        Of the method and of baselines; over several seeds the errors are averaged.
    method
        A name of `DENOISING`.

    Raises
    ------
    InputError
        If no combination of scene, sensor and light has both the method and a baseline.
    """
    ratios = {}
    for place, errors in _errors(cells).items():
        others = [
            error for name, error in errors.items() if name != method and DENOISING[name].baseline
        ]
        if method in errors and others:
            best = np.min(others, axis=0)
            ratios[place] = max(map(_ratio, errors[method].tolist(), best.tolist()))
    if not ratios:
        raise InputError(
            "cells", f"must hold the method {method} and a baseline", value=method, found="do not"
        )
    worst = max(ratios, key=lambda place: ratios[place])
    return Verdict(
        method=method,
        places=len(ratios),
        won=sum(ratio < 1 for ratio in ratios.values()),
        worst_ratio=ratios[worst],
        worst=worst,
    )


def _ratio(error: float, best: float) -> float:
    """An error over that of the best baseline; 1 where both are 0."""
    if best > 0:
        return error / best
    return inf if error > 0 else 1.0


def verdict_sentences(cells: Iterable[BenchmarkCell]) -> tuple[str, ...]:
    """One sentence per method that is not a baseline; none if the cells hold no baseline.

    Parameters
    ----------
    cells
        As `verdict`.
    """
    cells = tuple(cells)
    names = tuple(dict.fromkeys(cell.method for cell in cells))
    own = [name for name in names if not DENOISING[name].baseline]
    if len(own) == len(names):
        return ()
    out = []
    for name in own:
        found = verdict(cells, name)
        scene, sensor, lux = found.worst
        out.append(
            f"{name} has a lower mean CIEDE2000 and a lower mean S-CIELAB than every baseline in "
            f"{found.won} of {found.places} combinations of scene, sensor and light level "
            f"({100 * found.share:.0f} %); in its worst one its error is "
            f"{found.worst_ratio:.2f} times that of the best baseline "
            f"({scene}, {sensor}, {lux:g} lx)."
        )
    return tuple(out)


def markdown_table(cells: Iterable[BenchmarkCell]) -> str:
    """Every cell as a table: a row per scene, sensor and light, a column per method.

    A cell holds mean CIEDE2000 / mean S-CIELAB; the lowest of each in a row is bold. Over several
    seeds they are averaged.

    Parameters
    ----------
    cells
        Results of the benchmark, one per scene, sensor, light and method.
    """
    rows = _errors(cells)
    names = list(dict.fromkeys(name for errors in rows.values() for name in errors))
    lines = [
        "| scene | sensor | lux | " + " | ".join(names) + " |",
        "|---|---|---:|" + "---|" * len(names),
    ]
    for (scene, sensor, lux), errors in rows.items():
        least = np.min(list(errors.values()), axis=0)
        texts = (
            " / ".join(
                f"**{value:.2f}**" if value == low else f"{value:.2f}"
                for value, low in zip(errors[name], least, strict=True)
            )
            if name in errors
            else ""
            for name in names
        )
        lines.append(f"| {scene} | {sensor} | {lux:g} | " + " | ".join(texts) + " |")
    return "\n".join(lines) + "\n"


def _errors(
    cells: Iterable[BenchmarkCell],
) -> dict[tuple[str, str, float], dict[str, Float[Array, " 2"]]]:
    """Mean CIEDE2000 and S-CIELAB by place and method, averaged over the seeds."""
    found: dict[tuple[str, str, float], dict[str, list[tuple[float, float]]]] = {}
    for cell in cells:
        errors = cell.quality.ciede2000_mean, cell.quality.scielab_mean
        found.setdefault(cell.place, {}).setdefault(cell.method, []).append(errors)
    return {
        place: {name: np.mean(several, axis=0) for name, several in methods.items()}
        for place, methods in found.items()
    }
