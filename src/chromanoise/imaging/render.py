"""Rendering of a cube by a sensor: a noisy color image, or the raw codes of a mosaic."""

from dataclasses import dataclass, replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Float32, UInt8, UInt16
from chromanoise.color import ColorMatrix, kernel_matrix
from chromanoise.errors import InputError, Setting
from chromanoise.exposure import Exposure, OperatingPoint
from chromanoise.imaging.coupled_plans import (
    coupled_color_block,
    coupled_color_plan,
    coupled_part,
    coupled_raw_block,
    coupled_raw_plan,
)
from chromanoise.imaging.light import BadPixels, Light, light_of
from chromanoise.imaging.plans import (
    ElectronPlan,
    color_block,
    color_matrices,
    color_plan,
    draw_of,
    electron_block,
    plan_for_rows,
    raw_block,
    raw_plan,
)
from chromanoise.imaging.work import FillBlock, Part, Work, made, row_blocks
from chromanoise.noise import after_counting
from chromanoise.scene import Cube, bands_within
from chromanoise.sensor import (
    Adc,
    Mosaic,
    Sensor,
    adc_of,
    refuse_summed_readings,
    shares_after_counting,
    without_crosstalk,
)
from chromanoise.spectra import Beyond, Illuminant, Metric

ALL_CORES = Work()
"""Default work: one thread per core."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
        _check.freeze(self, "white", "mean_e", "above_full_well")

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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
        _check.freeze(self, "mean_e", "above_full_well")


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
        If false, there is no shot noise (also none of dark electrons) and no read noise; PRNU,
        DSNU and row noise stay.
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
    cube = bands_within(cube, operating_point.sensor.grid)
    point = operating_point
    light = light_of(cube, _of_counts(point), beyond=beyond, bad_pixels=bad_pixels)
    draw = draw_of(point, seed=seed, frame=frame, noisy=noisy)
    matrix = matrix or kernel_matrix(point.sensor, point.exposure, observer=point.observer)
    matrices, white = color_matrices(matrix, operating_point)
    plan = color_plan(light, draw, operating_point, matrices, clip=clip)
    height, width, _ = light.source.shape
    kinds = (((height, width, 3), np.float32), ((height, width, 3), np.uint8))
    blocks = row_blocks(light.source, work)
    fill: FillBlock = color_block
    if (coupling := after_counting(point.sensor.crosstalk)) is not None:
        plan, fill = coupled_color_plan(plan, coupling), coupled_color_block
    (xyz, srgb), counts = made(fill, plan, plan_for_rows, blocks, kinds, work)
    total, above, bad = np.concatenate(counts).sum(axis=0)
    return Picture(
        operating_point=operating_point,
        matrix=matrix,
        seed=seed,
        frame=frame,
        xyz=xyz,
        srgb=srgb,
        white=white,
        mean_e=total / (height * width),
        above_full_well=above / (height * width),
        clipped=clip,
        notes=_notes(operating_point, light, int(bad[0])),
    )


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
        As `rendered`. The noise of a pixel is that of its channel in `rendered`.

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
    counting = operating_point if shares is None else _of_counts(operating_point)
    light = light_of(cube, counting, beyond=beyond, bad_pixels=bad_pixels)
    draw = draw_of(operating_point, seed=seed, frame=frame, noisy=noisy)
    plan = raw_plan(light, draw, operating_point, mosaic, adc)
    height, width, _ = light.source.shape
    fill: FillBlock = raw_block
    part: Part = plan_for_rows
    if shares is not None:
        plan = coupled_raw_plan(plan, shares, height)
        fill, part = coupled_raw_block, coupled_part
    kinds = (((height, width), np.uint16),)
    blocks = row_blocks(light.source, work)
    (codes,), counts = made(fill, plan, part, blocks, kinds, work)
    own = _pixels_of_channels(plan.tile, height, width, light.channels)
    total, above, bad = np.concatenate(counts).sum(axis=0)
    return RawPicture(
        operating_point=operating_point,
        seed=seed,
        frame=frame,
        mosaic=mosaic,
        adc=adc,
        codes=codes,
        mean_e=total / np.maximum(own, 1),
        above_full_well=above / np.maximum(own, 1),
        notes=_notes(operating_point, light, int(bad[0])),
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
    """
    cube = bands_within(cube, operating_point.sensor.grid)
    light = light_of(cube, operating_point, beyond=beyond, bad_pixels=bad_pixels)
    height, width, _ = light.source.shape
    kinds = (((height, width, light.channels), np.float32),)
    plan, blocks = ElectronPlan(light=light), row_blocks(light.source, work)
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
    for name in mosaic.names:
        _check.one_of(f"mosaic channel of {sensor.name}", name, sensor.names)
    return mosaic


def _of_counts(operating_point: OperatingPoint) -> OperatingPoint:
    """The operating point with the curves of what the pixels count, before any mixing of counts."""
    if after_counting(operating_point.sensor.crosstalk) is None:
        return operating_point
    pure = without_crosstalk(operating_point.sensor)
    assert pure is not None  # a singular one is refused by `with_crosstalk`
    return replace(operating_point, sensor=pure)


def _pixels_of_channels(tile: Array, height: int, width: int, channels: int) -> Float[Array, " p"]:
    """Number of pixels of each channel in the image."""
    rows, columns = tile.shape
    whole = np.tile(tile, (-(-height // rows), 1))[:height]
    counts = np.zeros(channels)
    for column in range(columns):
        pixels = len(range(column, width, columns))
        counts += pixels * np.bincount(whole[:, column], minlength=channels)
    return counts


def _notes(operating_point: OperatingPoint, light: Light, bad: int) -> tuple[str, ...]:
    pixels = "1 pixel" if bad == 1 else f"{bad} pixels"
    mended = f"{pixels} held what is no reflectance; 0 was taken instead"
    notes = (
        *operating_point.sensor.notes,
        *operating_point.illuminant.notes,
        *light.cube.notes,
        *light.notes,
    )
    return (*notes, mended) if bad else notes
