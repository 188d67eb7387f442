"""Rendering of a cube by a sensor: a noisy color image, or the raw codes of a mosaic."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    Float32,
    InputError,
    Int,
    Setting,
    UInt8,
    UInt16,
    check,
    dataclass,
)
from chromanoise.color import ColorMatrix
from chromanoise.imaging.blocks import Draw, Scratch, new_rows
from chromanoise.imaging.kernel_cache import kernel_of
from chromanoise.imaging.plans import (
    BadPixels,
    ColorPlan,
    ElectronPlan,
    Light,
    color_block,
    color_matrices,
    draw_of,
    electron_block,
    light_of,
    plan_for_rows,
    raw_block,
    raw_plan,
    srgb_table,
    well_of,
)
from chromanoise.imaging.shared_rows import FillBlock, Work, filled, made, row_blocks
from chromanoise.noise import Exposure, OperatingPoint, after_counting
from chromanoise.sensor import (
    Adc,
    Mosaic,
    Sensor,
    adc_of,
    places_of_mosaic,
    refuse_summed_readings,
    shares_after_counting,
    with_channel_names,
    without_crosstalk,
)
from chromanoise.spectra import Beyond, Cube, Illuminant, Metric, bands_within, row_source

ALL_CORES = Work()
"""Default work: one thread per core."""

_COLORED_ROWS = 64
_SHARE_DIGITS = 9  # places whose shares agree to these digits are of one kind


@dataclass(frozen=True, kw_only=True, eq=False)
class Picture:
    """Color image of a cube, rendered by a sensor and its matrix.

    Attributes
    ----------
    operating_point, matrix, seed, frame
        Inputs of the image.
    xyz
        Linear XYZ with noise; Y = 1 for a perfect white captured by the same sensor.
    srgb
        8-bit sRGB, white-balanced on the illuminant.
    white
        XYZ of the perfect white in the units of ``xyz``.
    mean_e
        Mean expected electrons per channel over the image, without dark electrons. [e-]
    above_full_well
        Share of the noisy values per channel that exceed full well, dark electrons included.
    clipped
        Whether electrons were clipped to 0 and full well.
    notes
        Assumptions made during rendering.
    """

    operating_point: OperatingPoint
    matrix: ColorMatrix
    seed: int
    frame: int
    xyz: Float32[Array, "h w 3"]
    srgb: UInt8[Array, "h w 3"]
    white: Float[Array, " 3"]
    mean_e: Float[Array, " p"]
    above_full_well: Float[Array, " p"]
    clipped: bool
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        for pixels in (self.xyz, self.srgb):  # too large to copy
            pixels.flags.writeable = False
        check.freeze(self, "white", "mean_e", "above_full_well")

    @property
    def sensor(self) -> Sensor:
        """Sensor of the operating point."""
        return self.operating_point.sensor

    @property
    def exposure(self) -> Exposure:
        """Exposure of the operating point."""
        return self.operating_point.exposure

    @property
    def illuminant(self) -> Illuminant:
        """Illuminant of the operating point."""
        return self.operating_point.illuminant

    @property
    def level_lux(self) -> float:
        """Illuminance of the operating point. [lx]"""
        return self.operating_point.level_lux

    @property
    def metric(self) -> Metric:
        """Metric of the matrix."""
        return self.matrix.metric


@dataclass(frozen=True, kw_only=True, eq=False)
class RawPicture:
    """Raw image: one code per pixel, of the channel over this pixel.

    Attributes
    ----------
    operating_point, seed, frame
        Inputs of the image.
    mosaic, adc
        The channel of each pixel, and the converter.
    codes
        0 to the top code. [DN]
    mean_e
        Mean expected electrons per channel over its own pixels, without dark electrons. [e-]
    above_full_well
        Share of the noisy values per channel that exceed full well, dark electrons included.
    notes
        Assumptions made during rendering.
    """

    operating_point: OperatingPoint
    seed: int
    frame: int
    mosaic: Mosaic
    adc: Adc
    codes: UInt16[Array, "h w"]
    mean_e: Float[Array, " p"]
    above_full_well: Float[Array, " p"]
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        self.codes.flags.writeable = False
        check.freeze(self, "mean_e", "above_full_well")


def rendered(
    cube: Cube,
    operating_point: OperatingPoint,
    *,
    matrix: ColorMatrix | None = None,
    seed: int = 0,
    frame: int = 0,
    noisy: bool = True,
    clip: bool = False,
    beyond: Beyond = "refuse",
    bad_pixels: BadPixels = "refuse",
    work: Work = ALL_CORES,
) -> Picture:
    """The noisy color image of ``cube``: every channel at every pixel, then the color matrix.

    Parameters
    ----------
    cube
        Reflectances; each number is read once.
    operating_point
        Sensor, exposure and light.
    matrix
        Matrix from electrons to XYZ; the kernel (eq. 6, quanta) if ``None``.
    seed, frame
        Integers from 0 to 2^32 - 1. Equal values give the same image for any threads and tiles.
        Sensors with different names have different noise: that of `noisy_electrons` with the
        seed crc32(name) 2^32 + seed.
    noisy
        If false, there is no shot noise (also none of dark electrons) and no read noise. All
        other sources stay: fixed patterns, and row, column, reset and telegraph noise.
    clip
        Whether electrons are clipped to 0 and full well, as in a real sensor, unlike the paper.
    beyond
        How to extrapolate reflectances where the cube does not cover the grid.
    bad_pixels
        Handling of invalid reflectances (NaN, negative, above 2): ``refuse`` raises an error,
        ``zero`` replaces them by 0 and adds a note on the number of pixels.
    work
        Threads or executor for the computation; the result does not depend on it.

    Raises
    ------
    InputError
        If the cube has an invalid reflectance or does not cover the grid, a number is out of
        range, or the matrix gives no luminance for this illuminant.
    """
    matrix, matrices, white = color_matrices(matrix, operating_point)
    draw = draw_of(operating_point, seed=seed, frame=frame, noisy=noisy)
    ((xyz, srgb, counts),) = _products(
        cube, operating_point, draw, [matrices], clip, beyond, bad_pixels, work
    )
    return Picture(
        operating_point=operating_point,
        matrix=matrix,
        seed=seed,
        frame=frame,
        xyz=xyz,
        srgb=srgb,
        white=white,
        clipped=clip,
        **counts,
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class RenderedElectrons:
    """Noisy electrons of every channel at every pixel.

    Attributes
    ----------
    operating_point, seed, frame
        Inputs of the image.
    values_e
        Electrons after readout, dark electrons subtracted. [e-]
    mean_e, above_full_well, clipped, notes
        As `Picture`.
    """

    operating_point: OperatingPoint
    seed: int
    frame: int
    values_e: Float32[Array, "h w p"]
    mean_e: Float[Array, " p"]
    above_full_well: Float[Array, " p"]
    clipped: bool
    notes: tuple[str, ...]


def rendered_electrons(
    cube: Cube,
    operating_point: OperatingPoint,
    *,
    seed: int = 0,
    frame: int = 0,
    noisy: bool = True,
    clip: bool = False,
    beyond: Beyond = "refuse",
    bad_pixels: BadPixels = "refuse",
    work: Work = ALL_CORES,
) -> RenderedElectrons:
    """The noisy electrons of which `rendered` makes color, for a step between the two.

    Parameters, errors
        As `rendered`.

    Parameters
    ----------
    cube
        The cube of reflectances or radiances.
    operating_point
        A sensor in its light, with its exposure.
    seed
        Seed of the random numbers.
    frame
        Which picture of a burst.
    noisy
        As `rendered`.
    clip
        Whether values are clipped at black and at full well.
    beyond
        Values outside the range of the data: refuse, zero or hold.
    bad_pixels
        Values that are no numbers: refuse them, or set them to zero.
    work
        Threads and memory of the computation.

    Notes
    -----
    The color kernel gives three products of the electrons at a time, so the channels come as
    products with unit vectors, which are exact.
    """
    draw = draw_of(operating_point, seed=seed, frame=frame, noisy=noisy)
    channels = len(operating_point.sensor.names)
    unit = np.eye(-(-channels // 3) * 3, channels, dtype=np.float32)
    rows = [np.pad(unit[i : i + 3], ((0, 3), (0, 0))) for i in range(0, channels, 3)]
    made_of = _products(cube, operating_point, draw, rows, clip, beyond, bad_pixels, work)
    found = [(some, counts) for some, _, counts in made_of]
    parts = [some[..., : channels - 3 * i] for i, (some, _) in enumerate(found)]
    return RenderedElectrons(
        operating_point=operating_point,
        seed=seed,
        frame=frame,
        values_e=parts[0] if len(parts) == 1 else np.concatenate(parts, axis=-1),
        clipped=clip,
        **found[0][1],
    )


def colored(
    electrons: RenderedElectrons,
    *,
    matrix: ColorMatrix | None = None,
    work: Work = ALL_CORES,
) -> Picture:
    """The color image of electrons: the second half of `rendered`.

    Parameters
    ----------
    electrons
        Result of `rendered_electrons`, also after denoising.
    matrix
        As `rendered`.
    work
        Threads and rows per block; an executor is not used, because the electrons are in memory.

    Raises
    ------
    InputError
        If the matrix is for other channels, or gives the white no luminance.
    """
    values = electrons.values_e
    return picture_by_rows(
        electrons,
        (values.shape[0], values.shape[1]),
        _colored_block,
        lambda matrices: (values, matrices),
        matrix,
        work,
        clipped=electrons.clipped,
    )


def picture_by_rows(
    taken: "RenderedElectrons | RawPicture",
    shape: tuple[int, int],
    fill: FillBlock,
    plan_of: Callable[[Float32[Array, "6 p"]], Any],
    matrix: ColorMatrix | None,
    work: Work,
    *,
    clipped: bool,
) -> Picture:
    """The color image of what was captured, filled by rows on threads of this process.

    Parameters
    ----------
    taken
        Its point, counts and notes are those of the image.
    shape
        Rows and columns. [pixels]
    fill
        (plan, start, stop, scratch, xyz, srgb): fills the rows ``start`` to ``stop``.
    plan_of
        Function from the result of `color_matrices` to the plan for ``fill``.
    matrix
        As `rendered`.
    work
        Threads and rows per block.
    clipped
        Whether electrons were clipped to 0 and full well.
    """
    matrix, matrices, white = color_matrices(matrix, taken.operating_point)
    xyz = new_rows((*shape, 3), np.float32, folder=work.folder)
    srgb = new_rows((*shape, 3), np.uint8, folder=work.folder)
    height, rows = shape[0], work.tile_rows or _COLORED_ROWS
    blocks = [(start, min(start + rows, height)) for start in range(0, height, rows)]
    filled(fill, plan_of(matrices), blocks, (xyz, srgb), replace(work, executor=None))
    return Picture(
        operating_point=taken.operating_point,
        matrix=matrix,
        seed=taken.seed,
        frame=taken.frame,
        xyz=xyz,
        srgb=srgb,
        white=white,
        mean_e=taken.mean_e,
        above_full_well=taken.above_full_well,
        clipped=clipped,
        notes=taken.notes,
    )


def _colored_block(
    plan: tuple[Float32[Array, "h w p"], Float32[Array, "6 p"]],
    start: int,
    stop: int,
    scratch: Scratch,
    xyz: Float32[Array, "rows w 3"],
    srgb: UInt8[Array, "rows w 3"],
) -> None:
    """Fill ``xyz`` and ``srgb`` with the rows ``start`` to ``stop``."""
    values, matrices = plan
    color_of_electrons = kernel_of("acquisition", "color_of_electrons", xyz.size)
    color_of_electrons(values[start:stop], matrices, srgb_table(), xyz, srgb)


def _products(
    cube: Cube,
    point: OperatingPoint,
    draw: Draw,
    several: list[Float32[Array, "6 p"]],
    clip: bool,
    beyond: Beyond,
    bad_pixels: BadPixels,
    work: Work,
) -> Iterator[tuple[Float32[Array, "h w 3"], UInt8[Array, "h w 3"], dict[str, Any]]]:
    """For each of several matrices three products of the electrons at every pixel, the products
    with its other rows as codes of sRGB, and the fields of a picture that are counted.
    """
    cube = bands_within(cube, point.sensor.grid)
    light = light_of(cube, _of_counts(point), beyond=beyond, bad_pixels=bad_pixels)
    coupling = after_counting(point.sensor.crosstalk)
    well = well_of(point, draw, held=clip)
    height, width, _ = light.source.shape
    kinds = (((height, width, 3), np.float32), ((height, width, 3), np.uint8))
    blocks = row_blocks(row_source(cube.stored), work)
    for matrices in several:
        plan = ColorPlan(
            light=light,
            draw=draw,
            well=well,
            matrices=matrices,
            coupling=None if coupling is None else coupling.astype(np.float32),
        )
        (products, codes), counts = made(color_block, plan, plan_for_rows, blocks, kinds, work)
        total, above, bad = np.concatenate(counts).sum(axis=0)
        pixels = height * width
        yield products, codes, _counted(point, light, total / pixels, above / pixels, int(bad[0]))


def _counted(
    operating_point: OperatingPoint, light: Light, mean_e: Array, above: Array, bad: int
) -> dict[str, Any]:
    """What is counted while an image is rendered, and the notes, as fields of the image."""
    pixels = "1 pixel" if bad == 1 else f"{bad} pixels"
    mended = f"{pixels} held what is no reflectance; 0 was taken instead"
    notes = (
        *operating_point.sensor.notes,
        *operating_point.illuminant.notes,
        *light.cube.notes,
        *light.notes,
        *((mended,) if bad else ()),
    )
    return {"mean_e": mean_e, "above_full_well": above, "notes": notes}


def acquired(
    cube: Cube,
    operating_point: OperatingPoint,
    *,
    mosaic: Mosaic | None = None,
    adc: Adc | None = None,
    seed: int = 0,
    frame: int = 0,
    noisy: bool = True,
    beyond: Beyond = "refuse",
    bad_pixels: BadPixels = "refuse",
    work: Work = ALL_CORES,
) -> RawPicture:
    """The raw codes of ``cube`` behind a mosaic: only the channel over each pixel is computed.

    Parameters
    ----------
    mosaic
        The channel of each pixel; the sensor's own mosaic if ``None``.
    adc
        The converter; if ``None``, that of the sensor, by default 12 bits, top code at full well,
        black level 0.
    cube, operating_point, seed, frame, noisy, beyond, bad_pixels, work
        As `rendered`. The noise of a pixel is that of its channel in `rendered`, except where
        crosstalk before counting makes places of one channel receive different light.

    Raises
    ------
    InputError
        As `rendered`, or if there is no mosaic or it names a channel that the sensor lacks.
    """
    sensor = operating_point.sensor
    mosaic = mosaic_of(operating_point, mosaic)
    refuse_summed_readings(sensor)
    adc = adc or adc_of(sensor.converter, sensor.pixel)
    cube = bands_within(cube, sensor.grid)
    shares = shares_after_counting(sensor.crosstalk)
    if shares is None:
        counting, places, owner = _at_places(operating_point, mosaic)
    else:
        counting, places, owner = _of_counts(operating_point), mosaic, np.arange(len(sensor.names))
    light = light_of(cube, counting, beyond=beyond, bad_pixels=bad_pixels)
    draw = draw_of(operating_point, seed=seed, frame=frame, noisy=noisy)
    plan = raw_plan(light, draw, counting, places, adc, shares)
    height, width, _ = light.source.shape
    kinds = (((height, width), np.uint16),)
    blocks = row_blocks(row_source(cube.stored), work)
    (codes,), counts = made(raw_block, plan, plan_for_rows, blocks, kinds, work)
    member = owner == np.arange(len(sensor.names))[:, None]
    own = np.maximum(member @ _pixels_of_channels(plan.tile, height, width, light.channels), 1)
    sums = np.concatenate(counts).sum(axis=0)
    total, above = sums[:2] @ member.T
    return RawPicture(
        operating_point=operating_point,
        seed=seed,
        frame=frame,
        mosaic=mosaic,
        adc=adc,
        codes=codes,
        **_counted(operating_point, light, total / own, above / own, int(sums[2, 0])),
    )


def electrons_of_cube(
    cube: Cube,
    operating_point: OperatingPoint,
    *,
    beyond: Beyond = "refuse",
    bad_pixels: BadPixels = "refuse",
    work: Work = ALL_CORES,
) -> Float32[Array, "h w p"]:
    """Expected electrons of every channel at every pixel (eq. 2), without noise. [e-]

    Parameters, errors as `rendered`.

    Parameters
    ----------
    cube
        The cube of reflectances or radiances.
    operating_point
        A sensor in its light, with its exposure.
    beyond
        Values outside the range of the data: refuse, zero or hold.
    bad_pixels
        Values that are no numbers: refuse them, or set them to zero.
    work
        Threads and memory of the computation.
    """
    cube = bands_within(cube, operating_point.sensor.grid)
    light = light_of(cube, operating_point, beyond=beyond, bad_pixels=bad_pixels)
    height, width, _ = light.source.shape
    kinds = (((height, width, light.channels), np.float32),)
    plan, blocks = ElectronPlan(light=light), row_blocks(row_source(cube.stored), work)
    (electrons,), _ = made(electron_block, plan, plan_for_rows, blocks, kinds, work)
    return electrons


def mosaic_of(operating_point: OperatingPoint, mosaic: Mosaic | None) -> Mosaic:
    """The mosaic of a raw image: the given one, otherwise that of the sensor.

    Raises
    ------
    InputError
        If there is none, or it names a channel that the sensor lacks.
    """
    sensor = operating_point.sensor
    mosaic = mosaic or sensor.mosaic
    if mosaic is None:
        raise InputError(
            "mosaic",
            f"must be given, because {sensor.name} has none (one of {', '.join(sensor.names)} "
            "for each pixel)",
            remedy=Setting("mosaic"),
        )
    mosaic = with_channel_names(mosaic, sensor.names)
    for name in mosaic.names:
        check.among(f"mosaic channel of {sensor.name}", name, sensor.names)
    return mosaic


def _of_counts(operating_point: OperatingPoint) -> OperatingPoint:
    """The operating point with the curves of what the pixels count, before any mixing of counts."""
    if after_counting(operating_point.sensor.crosstalk) is None:
        return operating_point
    pure = without_crosstalk(operating_point.sensor)
    assert pure is not None  # a singular one is refused by `with_crosstalk`
    return replace(operating_point, sensor=pure)


def _at_places(
    operating_point: OperatingPoint, mosaic: Mosaic
) -> tuple[OperatingPoint, Mosaic, Int[Array, " q"]]:
    """The operating point, the mosaic, and the channel that each of their channels is part of.

    If crosstalk before counting makes places of one channel receive different light, each kind of
    place is a separate channel, after the channels of the sensor.
    """
    sensor = operating_point.sensor
    names, crosstalk, pure = sensor.names, sensor.crosstalk, without_crosstalk(sensor)
    same = operating_point, mosaic, np.arange(len(names))
    if crosstalk is None or crosstalk.kernel is None or pure is None:
        return same
    if set(mosaic.names) != set(names):
        return same
    places = places_of_mosaic(crosstalk.kernel, mosaic, names)
    away = places.deviations(crosstalk.matrix)
    mean = places.channel_means(away)  # 0 for the mosaic of the crosstalk, wherever it starts
    if not away.any() or np.abs(mean).max() > 10.0**-_SHARE_DIGITS:
        return same
    flat, channel = away.reshape(-1, len(names)), places.tile.ravel()
    kinds = np.column_stack([channel, np.round(flat, _SHARE_DIGITS)])
    _, first, kind = np.unique(kinds, axis=0, return_index=True, return_inverse=True)
    owner = channel[first]  # of each kind of place, sorted by channel
    own = np.unique(owner, return_index=True)[1]
    order = np.concatenate([own, np.setdiff1d(np.arange(len(owner)), own)])
    qe = (sensor.qe[:, owner] + pure.qe @ flat[first].T)[:, order]
    more = tuple(f"{names[owner[i]]} at place {first[i]}" for i in order[len(names) :])
    apart = replace(
        sensor, qe=np.clip(qe, 0.0, 1.0), names=(*names, *more), mosaic=None, crosstalk=None
    )
    tile = np.argsort(order)[kind.reshape(places.tile.shape)]
    pattern = tuple(tuple(apart.names[i] for i in row) for row in tile)
    return replace(operating_point, sensor=apart), Mosaic(pattern), owner[order]


def _pixels_of_channels(tile: Array, height: int, width: int, channels: int) -> Float[Array, " p"]:
    """Number of pixels of each channel in the image."""
    rows, columns = (
        [len(range(first, size, period)) for first in range(period)]
        for size, period in zip((height, width), tile.shape, strict=True)
    )
    return np.bincount(tile.ravel(), np.outer(rows, columns).ravel(), minlength=channels)
