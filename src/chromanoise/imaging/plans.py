"""All that a block of rows needs to become codes or color: worked out once, the same for all.

A plan is plain numbers and a source of rows, so that another process can take it and make the same
bits of its own block.
"""

import zlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from jaxtyping import Float32, Float64, Int64, Num, UInt8, UInt16

from chromanoise import _check
from chromanoise._check import Array
from chromanoise.color import linear_srgb, srgb_from_linear
from chromanoise.exposure import Situation, band_weights, white_scene
from chromanoise.imaging.blocks import Layout, Scratch, flattened
from chromanoise.scene import Cube
from chromanoise.scene.cube import BRIGHTEST, reflectance_rows
from chromanoise.scene.rows import ArrayRows, RowSource, row_source
from chromanoise.sensor import Adc, Imperfections, Mosaic
from chromanoise.spectra import Beyond

_PADDED, _CHANNELS = 16, 4  # weights are filled up with zeros to multiples of these
_LANES = 8  # of which the least and the greatest number are kept, as in `lanes`

Counts = Float64[Array, "rows 2 p"]
"""Per row: sum of expected electrons, and pixels above full well, per channel. [e-, 1]"""

Noise = tuple[np.float32, np.float32, np.float32, np.float32, np.float32, bool]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Light:
    """How the numbers of a cube become expected electrons.

    Attributes
    ----------
    cube
        Where they are read.
    weights
        Electrons per stored number, channels and bands filled up with zeros. [e-]
    channels
        How many are real.
    notes
        What was assumed of the spectra.
    first_row
        Of the picture, that is the cube's first: more than 0 where only a part was sent.
    """

    cube: Cube
    weights: Float32[Array, "q l"]
    channels: int
    notes: tuple[str, ...]
    first_row: int = 0

    @property
    def source(self) -> RowSource:
        """Of the rows."""
        return row_source(self.cube.stored)


def light_of(cube: Cube, situation: Situation, *, beyond: Beyond) -> Light:
    """Eq. 2 for this cube in this situation, folded into one weight per band and channel.

    Raises
    ------
    InputError
        As `band_weights`.
    """
    white, sensor = white_scene(situation), situation.sensor
    weights, notes = band_weights(cube, white, sensor, situation.exposure, beyond=beyond)
    bands, channels = weights.shape
    padded = np.zeros(
        (-(-channels // _CHANNELS) * _CHANNELS, -(-bands // _PADDED) * _PADDED), np.float32
    )
    padded[:channels, :bands] = (weights * cube.scale).T
    return Light(cube=cube, weights=padded, channels=channels, notes=notes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Draw:
    """Which noise: its strengths, and where its random words come from.

    Attributes
    ----------
    noise
        Read noise, PRNU, dark electrons, DSNU, row noise; whether there is shot noise. [e-]
    key, frame
        Of the random words.
    """

    noise: Noise
    key: int
    frame: int


def draw_of(
    situation: Situation,
    *,
    seed: int,
    frame: int = 0,
    imperfections: Imperfections | None = None,
    noisy: bool = True,
) -> Draw:
    """The noise of a sensor in use; sensors of different names draw different noise.

    Raises
    ------
    InputError
        If seed or frame are no whole numbers from 0 to 2^32 - 1.
    """
    for name, value in (("seed", seed), ("frame", frame)):
        if value != int(value) or not 0 <= value < 1 << 32:
            raise _check.InputError(
                f"{name} must be a whole number from 0 to 2^32 - 1, but is {value}"
            )
    more = imperfections or Imperfections()
    dark_e = more.dark_current_e_per_s * situation.exposure.time_s
    strengths = (
        situation.sensor.pixel.read_noise_e,
        more.prnu,
        dark_e,
        more.dsnu_e,
        more.row_noise_e,
    )
    who = zlib.crc32(situation.sensor.name.encode())
    read, prnu, dark, dsnu, row = (np.float32(value) for value in strengths)
    return Draw(
        noise=(read, prnu, dark, dsnu, row, noisy), key=(who << 32) | int(seed), frame=int(frame)
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RawPlan:
    """From rows to codes of a mosaic.

    Attributes
    ----------
    light, draw
        Expected electrons, and noise.
    tile
        Numbers of channels in one period of the mosaic.
    adc
        Full well [e-], codes per electron, black level, top code. [DN]
    """

    light: Light
    draw: Draw
    tile: Int64[Array, "ty tx"]
    adc: tuple[np.float32, np.float32, np.float32, np.float32]


def raw_plan(light: Light, draw: Draw, situation: Situation, mosaic: Mosaic, adc: Adc) -> RawPlan:
    """The plan of one frame of a mosaic."""
    names, well = situation.sensor.names, situation.sensor.pixel.full_well_e
    tile = [[names.index(name) for name in row] for row in mosaic.pattern]
    numbers = (well, 1.0 / adc.gain_e_per_dn, adc.black_level_dn, adc.top_code)
    full, gain, black, top = (np.float32(number) for number in numbers)
    return RawPlan(
        light=light, draw=draw, tile=np.array(tile, np.int64), adc=(full, gain, black, top)
    )


def raw_block(
    plan: RawPlan, start: int, stop: int, scratch: Scratch, codes: UInt16[Array, "rows w"]
) -> Counts:
    """Fill ``codes`` with the rows ``start`` to ``stop`` of the mosaic.

    Raises
    ------
    InputError
        If the cube holds what is no reflectance there.
    """
    from chromanoise.imaging.fused import raw_rows

    counts = np.zeros((stop - start, 2, plan.light.channels))

    def fill(flat: Num[Array, " numbers"], lay: Layout, seen: Float32[Array, "16"]) -> None:
        raw_rows(
            flat,
            lay,
            *codes.shape,
            plan.light.weights,
            plan.tile,
            start,
            plan.draw.noise,
            plan.draw.frame,
            np.uint64(plan.draw.key),
            plan.adc,
            codes,
            counts,
            seen,
        )

    _on_rows(plan.light, start, stop, scratch, counts, fill)
    return counts


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ColorPlan:
    """From rows to color, with all channels at every pixel.

    Attributes
    ----------
    light, draw
        Expected electrons, and noise.
    well
        Full well, and whether electrons are held between 0 and it. [e-]
    matrices
        To XYZ of which a perfect white has Y = 1, and to linear sRGB, three rows each. [1/e-]
    """

    light: Light
    draw: Draw
    well: tuple[np.float32, bool]
    matrices: Float32[Array, "6 p"]


def color_plan(
    light: Light,
    draw: Draw,
    situation: Situation,
    to_xyz: Float64[Array, "3 p"],
    white: Float64[Array, " 3"],
    *,
    clip: bool,
) -> ColorPlan:
    """The plan of a picture; sRGB is white-balanced on ``white``."""
    to_srgb = linear_srgb(np.eye(3), white).T @ to_xyz
    return ColorPlan(
        light=light,
        draw=draw,
        well=(np.float32(situation.sensor.pixel.full_well_e), clip),
        matrices=np.concatenate([to_xyz, to_srgb]).astype(np.float32),
    )


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
    from chromanoise.imaging.fused import color_rows

    counts = np.zeros((stop - start, 2, plan.light.channels))

    def fill(flat: Num[Array, " numbers"], lay: Layout, seen: Float32[Array, "16"]) -> None:
        color_rows(
            flat,
            lay,
            *xyz.shape[:2],
            plan.light.weights,
            plan.light.channels,
            start,
            plan.draw.noise,
            plan.draw.frame,
            np.uint64(plan.draw.key),
            plan.well,
            plan.matrices,
            srgb_table(),
            xyz,
            srgb,
            counts,
            seen,
        )

    _on_rows(plan.light, start, stop, scratch, counts, fill)
    return counts


@cache
def srgb_table() -> UInt8[Array, " entries"]:
    """8-bit codes of linear values, evenly from 0 to 1."""
    from chromanoise.imaging.color_kernels import ENCODED

    return np.round(255 * srgb_from_linear(np.linspace(0, 1, ENCODED))).astype(np.uint8)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ElectronPlan:
    """From rows to expected electrons.

    Attributes
    ----------
    light
        Expected electrons.
    """

    light: Light


def plan_for_rows(plan: Any, start: int, stop: int) -> Any:
    """The plan as another process needs it for the rows ``start`` to ``stop``.

    A cube in memory goes along with these rows only; one in a file is opened there again, also
    where it is a memory map, which would go along whole and in another order of axes.
    """
    light, source, first_row = plan.light, plan.light.source, plan.light.first_row
    if isinstance(source, ArrayRows):
        source, first_row = np.array(source.rows(start, stop)), start
    part = replace(light, cube=replace(light.cube, stored=source), first_row=first_row)
    return replace(plan, light=part)


def electron_block(
    plan: ElectronPlan, start: int, stop: int, scratch: Scratch, out: Float32[Array, "rows w p"]
) -> None:
    """Fill ``out`` with expected electrons of the rows ``start`` to ``stop``. [e-]

    Raises
    ------
    InputError
        As `raw_block`.
    """
    from chromanoise.imaging.fused import electron_rows

    def fill(flat: Num[Array, " numbers"], lay: Layout, seen: Float32[Array, "16"]) -> None:
        light = plan.light
        electron_rows(flat, lay, *out.shape[:2], light.weights, light.channels, out, seen)

    _on_rows(plan.light, start, stop, scratch, out, fill)


def _on_rows(
    light: Light, start: int, stop: int, scratch: Scratch, sums: Any, fill: Callable[..., None]
) -> None:
    """Read the rows, do the work, and refuse numbers that are no reflectance."""
    source = light.source
    start, stop = start - light.first_row, stop - light.first_row
    block = source.rows(start, stop, into=scratch.of(source.scratch_bytes(stop - start)))
    flat, lay = flattened(block)
    seen = np.repeat(np.array([3e38, -3e38], np.float32), _LANES)
    fill(flat, lay, seen)
    lowest, highest = float(seen[:_LANES].min()), float(seen[_LANES:].max())
    if not (lowest >= 0 and highest * light.cube.scale <= BRIGHTEST and np.isfinite(sums).all()):
        # says which value is wrong, and where
        reflectance_rows(light.cube, start, stop, first_row=light.first_row)
