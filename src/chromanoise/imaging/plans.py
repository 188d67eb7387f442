"""Plans: all parameters for the conversion of a block of rows to codes or color, computed once.

A plan contains plain numbers and a source of rows, so that it can be pickled, and another process
computes bit-identical results for its block.
"""

import math
import zlib
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Float32, Float64, Int64, UInt8, UInt16
from chromanoise.color import ColorMatrix, linear_srgb, srgb_from_linear
from chromanoise.errors import InputError
from chromanoise.exposure import OperatingPoint, expected_electrons, white_scene
from chromanoise.imaging.blocks import Scratch
from chromanoise.imaging.light import Light, on_rows
from chromanoise.imaging.records import Converter, Draw, RowsInMemory, Well
from chromanoise.imaging.work import Block, row_pieces
from chromanoise.noise import noise_sources
from chromanoise.scene.rows import ArrayRows
from chromanoise.sensor import Adc, Mosaic

_MOST_E = 1e15  # above, float32 does not resolve single electrons

Counts = Float64[Array, "rows 3 p"]
"""Per row and channel: sum of expected electrons, pixels above full well, bad pixels. [e-, 1, 1]"""


def draw_of(
    operating_point: OperatingPoint,
    *,
    seed: int,
    frame: int = 0,
    noisy: bool = True,
) -> Draw:
    """Noise parameters of an operating point; the noise depends on the name of the sensor.

    If ``noisy`` is false, there is no shot noise and no read noise; all other sources stay.

    Raises
    ------
    InputError
        If seed or frame is not an integer from 0 to 2^32 - 1.
    """
    for name, value in (("seed", seed), ("frame", frame)):
        if not isinstance(value, int) or not 0 <= value < 1 << 32:
            raise InputError(name, "must be a whole number from 0 to 2^32 - 1", value=value)
    pixel = operating_point.sensor.pixel
    noise = noise_sources(operating_point.sensor, operating_point.exposure)
    if not noisy:
        noise = replace(noise, pixel=replace(pixel, read_noise_e=0.0))
    dark_e = _check.within(
        "electrons of the dark current",
        "e-",
        pixel.dark_electrons_e(time_s=operating_point.exposure.time_s),
        0.0,
        _MOST_E,
    )
    share, level_e = noise.levels
    who = zlib.crc32(operating_point.sensor.name.encode())
    return Draw(
        reading_e=np.float32(noise.sd("reading")),
        gain=np.float32(noise.sd("gain")),
        pattern_e=np.float32(noise.sd("pattern")),
        row_e=np.float32(noise.sd("row")),
        column_e=np.float32(noise.sd("column")),
        level_share=np.float32(share),
        levels_e=np.float32(level_e / math.sqrt(pixel.summed_readings)),
        readings=int(pixel.summed_readings),
        dark_e=np.float32(dark_e),
        black_error_e=np.float32(pixel.black_error_e),
        noisy=noisy,
        key=np.uint64((who << 32) | seed),
        frame=np.uint64(frame),
    )


def demand_well(operating_point: OperatingPoint, draw: Draw) -> None:
    """Check that, with clipping, dark electrons do not fill the full well.

    Raises
    ------
    InputError
        If they fill it.
    """
    full_well_e = operating_point.sensor.pixel.full_well_e
    if draw.dark_e >= full_well_e:
        raise InputError(
            operating_point.sensor.name,
            f"must collect fewer dark electrons than its full well of {full_well_e:g} e-",
            value=float(draw.dark_e),
            found=f"collects {draw.dark_e:g} in {operating_point.exposure.time_s:g} s",
            remedy=("expose for less time", "give a smaller dark current"),
        )


def _most_e(operating_point: OperatingPoint, draw: Draw) -> float:
    """Largest reading: full well minus dark electrons, plus the error of the black level. [e-]"""
    offset = float(draw.black_error_e) - float(draw.dark_e)
    return operating_point.sensor.pixel.full_well_e + offset


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RawPlan:
    """Plan for the raw codes of a mosaic.

    Attributes
    ----------
    light, draw
        Parameters of expected electrons, and of noise.
    tile
        Indices of the channels in one period of the mosaic.
    adc
        The converter.
    """

    light: Light
    draw: Draw
    tile: Int64[Array, "ty tx"]
    adc: Converter


def raw_plan(
    light: Light, draw: Draw, operating_point: OperatingPoint, mosaic: Mosaic, adc: Adc
) -> RawPlan:
    """The plan for one frame of a mosaic."""
    demand_well(operating_point, draw)
    names, most_e = operating_point.sensor.names, _most_e(operating_point, draw)
    tile = [[names.index(name) for name in row] for row in mosaic.pattern]
    numbers = (most_e, 1.0 / adc.gain_e_per_dn, adc.black_level_dn, adc.top_code)
    converter = Converter(*(np.float32(number) for number in numbers))
    return RawPlan(light=light, draw=draw, tile=np.array(tile, np.int64), adc=converter)


def raw_block(
    plan: RawPlan, start: int, stop: int, scratch: Scratch, codes: UInt16[Array, "rows w"]
) -> Counts:
    """Fill ``codes`` with the rows ``start`` to ``stop`` of the mosaic.

    Raises
    ------
    InputError
        If the cube has an invalid reflectance in these rows.
    """
    from chromanoise.imaging.fused_kernels import raw_rows

    counts = np.zeros((stop - start, 3, plan.light.channels))

    def fill(stored: RowsInMemory) -> None:
        raw_rows(stored, plan.tile, start, plan.draw, plan.adc, codes, counts)

    counts[:, 2] = on_rows(plan.light, start, stop, scratch, counts, fill)[:, None]
    return counts


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ColorPlan:
    """Plan for a color image, with all channels at every pixel.

    Attributes
    ----------
    light, draw
        Parameters of expected electrons, and of noise.
    well
        Full well, and whether electrons are clipped to 0 and full well.
    matrices
        Matrices to XYZ (Y = 1 for a perfect white) and to linear sRGB, three rows each. [1/e-]
    """

    light: Light
    draw: Draw
    well: Well
    matrices: Float32[Array, "6 p"]


def color_plan(
    light: Light,
    draw: Draw,
    operating_point: OperatingPoint,
    matrices: Float32[Array, "6 p"],
    *,
    clip: bool,
) -> ColorPlan:
    """The plan for a color image; ``matrices`` are from `color_matrices`."""
    if clip:
        demand_well(operating_point, draw)
    well = Well(np.float32(_most_e(operating_point, draw)), clip)
    return ColorPlan(light=light, draw=draw, well=well, matrices=matrices)


def color_matrices(
    matrix: ColorMatrix, operating_point: OperatingPoint
) -> tuple[Float32[Array, "6 p"], Float64[Array, " 3"]]:
    """Matrices to XYZ and to white-balanced linear sRGB, and XYZ of the white, with Y = 1.

    Raises
    ------
    InputError
        As `white_lux_of`, or if the white is not valid for chromatic adaptation.
    """
    white_lux = white_lux_of(matrix, operating_point)
    to_xyz, white = matrix.matrix / white_lux[1], white_lux / white_lux[1]
    to_srgb = linear_srgb(np.eye(3), white).T @ to_xyz
    return np.concatenate([to_xyz, to_srgb]).astype(np.float32), white


def white_lux_of(matrix: ColorMatrix, operating_point: OperatingPoint) -> Float[Array, " 3"]:
    """XYZ of a perfect white according to the matrix. [lx]

    Raises
    ------
    InputError
        If the matrix is for other channels, or gives the white no luminance.
    """
    sensor, lamp = operating_point.sensor, operating_point.illuminant
    _check.same_names("picture", sensor=sensor.names, matrix=matrix.channels)
    white = matrix.matrix @ expected_electrons(
        white_scene(operating_point), sensor, operating_point.exposure
    )
    if not white[1] > 0:
        raise InputError(
            sensor.name,
            f"its {matrix.made_by} matrix must give a perfect white under {lamp.name} a "
            "luminance > 0 [lx]",
            value=float(white[1]),
            found=f"gives {white[1]:.3g} lx",
            remedy="take another light, sensor or matrix",
        )
    return white


def color_block(
    plan: ColorPlan,
    start: int,
    stop: int,
    scratch: Scratch,
    xyz: Float32[Array, "rows w 3"],
    srgb: UInt8[Array, "rows w 3"],
) -> Counts:
    """Fill ``xyz`` and ``srgb`` with the rows ``start`` to ``stop``.

    Raises
    ------
    InputError
        As `raw_block`.
    """
    from chromanoise.imaging.fused_kernels import color_rows

    counts = np.zeros((stop - start, 3, plan.light.channels))

    def fill(stored: RowsInMemory) -> None:
        table = srgb_table()
        color_rows(stored, start, plan.draw, plan.well, plan.matrices, table, xyz, srgb, counts)

    counts[:, 2] = on_rows(plan.light, start, stop, scratch, counts, fill)[:, None]
    return counts


@cache
def srgb_table() -> UInt8[Array, " entries"]:
    """8-bit codes of linear values at equal steps from 0 to 1."""
    from chromanoise.imaging.color_kernels import ENCODED

    codes = np.round(255 * srgb_from_linear(np.linspace(0, 1, ENCODED))).astype(np.uint8)
    codes.flags.writeable = False  # all images share it
    return codes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ElectronPlan:
    """Plan for expected electrons.

    Attributes
    ----------
    light
        Parameters of expected electrons.
    """

    light: Light


def plan_for_rows(plan: Any, start: int, stop: int) -> tuple[Any, list[Block]]:
    """The plan for rows ``start`` to ``stop`` in another process, and their pieces.

    Of a cube in memory only these rows are sent. A cube in a file is opened again in the other
    process, also if it is a memory map, which would be sent whole and with another axis order.
    """
    light, source, first_row = plan.light, plan.light.source, plan.light.first_row
    if isinstance(source, ArrayRows):
        source, first_row = np.array(source.rows(start, stop)), start
    part = replace(light, cube=replace(light.cube, stored=source), first_row=first_row)
    return replace(plan, light=part), row_pieces(plan.light.source, start, stop)


def electron_block(
    plan: ElectronPlan, start: int, stop: int, scratch: Scratch, out: Float32[Array, "rows w p"]
) -> None:
    """Fill ``out`` with expected electrons of the rows ``start`` to ``stop``. [e-]

    Raises
    ------
    InputError
        As `raw_block`.
    """
    from chromanoise.imaging.fused_kernels import electron_rows

    def fill(stored: RowsInMemory) -> None:
        electron_rows(stored, out)

    on_rows(plan.light, start, stop, scratch, out, fill)
