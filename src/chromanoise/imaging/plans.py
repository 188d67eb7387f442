"""Plans: all parameters for the conversion of a block of rows, computed once, and the blocks.

A plan has a weight per band and channel for the expected electrons, and the parameters of noise and
of codes or color, also for a sensor whose crosstalk follows counting. Reflectances are checked when
a block is computed. A plan contains plain numbers and a source of rows, so that it can be pickled,
and another process computes bit-identical results for its block.
"""

import math
import zlib
from collections.abc import Callable
from dataclasses import replace
from functools import cache, partial
from typing import Any, Literal

import numpy as np

from chromanoise.base import (
    Array,
    Float,
    Float32,
    Float64,
    InputError,
    Int64,
    UInt8,
    UInt16,
    check,
    dataclass,
    refuse_absent_package,
)
from chromanoise.color import ColorMatrix, kernel_matrix, linear_srgb, srgb_from_linear
from chromanoise.imaging import plain
from chromanoise.imaging.blocks import (
    CHANNELS_AT_ONCE,
    ENCODED,
    LANES,
    PADDED_BANDS,
    Converter,
    Draw,
    RowsInMemory,
    Scratch,
    Well,
    flattened,
    is_planar,
)
from chromanoise.imaging.demosaic import mirrored
from chromanoise.imaging.kernel_cache import kernel_of
from chromanoise.imaging.shared_rows import Block, row_pieces
from chromanoise.noise import (
    OperatingPoint,
    band_weights,
    expected_electrons,
    noise_sources,
    white_scene,
)
from chromanoise.sensor import READ_OUT, Adc, Mosaic
from chromanoise.spectra import (
    BRIGHTEST,
    ArrayRows,
    Beyond,
    Cube,
    PaletteRows,
    RowSource,
    reflectance_rows,
    row_source,
)

_MOST_E = 1e30  # per stored number: so that the sum of all bands fits in float32

BadPixels = Literal["refuse", "zero"]
"""Handling of invalid reflectances."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Light:
    """Parameters for converting the numbers of a cube to expected electrons.

    Attributes
    ----------
    cube
        The cube that is read.
    weights
        Electrons per stored number, with channels and bands padded with zeros. [e-]
    channels
        Number of channels without padding.
    notes
        Assumptions on the spectra.
    planar
        Whether sums run over pixels of a band (planar) or over bands of a pixel.
    bad_pixels
        Handling of invalid reflectances: ``refuse``, or ``zero``.
    first_row
        Row of the image that is the first row of the cube; above 0 if only a part was sent.
    palette_e
        Expected electrons of each palette spectrum, per channel. If given, rows of the cube are
        electrons instead of reflectances, and ``weights`` is the identity. [e-]
    """

    cube: Cube
    weights: Float32[Array, "q l"]
    channels: int
    notes: tuple[str, ...]
    planar: bool
    bad_pixels: BadPixels = "refuse"
    first_row: int = 0
    palette_e: Float32[Array, "k p"] | None = None

    @property
    def source(self) -> RowSource:
        """Of the rows."""
        source = row_source(self.cube.stored)
        if self.palette_e is None:
            return source
        assert isinstance(source, PaletteRows)
        return replace(source, palette=self.palette_e)


def light_of(
    cube: Cube, operating_point: OperatingPoint, *, beyond: Beyond, bad_pixels: BadPixels = "refuse"
) -> Light:
    """Eq. 2 for this cube and operating point, as one weight per band and channel.

    Raises
    ------
    InputError
        As `band_weights`, or if the number of electrons is out of range.
    """
    white, sensor = white_scene(operating_point), operating_point.sensor
    weights, notes = band_weights(cube, white, sensor, operating_point.exposure, beyond=beyond)
    channels, source = weights.shape[1], row_source(cube.stored)
    most = float(np.abs(weights).max() * cube.scale)
    check.within(f"electrons per number of {cube.source}", "e-", most, 0.0, _MOST_E)
    light = Light(
        cube=cube,
        weights=_padded((weights * cube.scale).T),
        channels=channels,
        notes=notes,
        planar=is_planar(source),
        bad_pixels=bad_pixels,
    )
    if isinstance(source, PaletteRows):
        out = np.zeros((1, len(source.palette), channels), np.float32)
        fill = partial(plain.electron_rows, out=out)
        if _were_reflectances(light, source.palette[None], out, fill):
            return replace(light, weights=_padded(np.eye(channels)), palette_e=out[0])
    return light


def _padded(weights: Float[Array, "p m"]) -> Float32[Array, "q l"]:
    """The weights with zeros behind channels and bands, for the vectors of the kernels."""
    channels, bands = weights.shape
    shape = (channels + -channels % CHANNELS_AT_ONCE, bands + -bands % PADDED_BANDS)
    padded = np.zeros(shape, np.float32)
    padded[:channels, :bands] = weights
    return padded


def on_rows(
    light: Light,
    start: int,
    stop: int,
    scratch: Scratch,
    sums: Array,
    fill: Callable[[RowsInMemory], None],
) -> Int64[Array, " rows"]:
    """Read the rows and call ``fill``, which fills ``sums``; the result is bad pixels per row.

    Raises
    ------
    InputError
        If a reflectance is invalid and bad pixels are refused.
    """
    source = light.source
    start, stop = start - light.first_row, stop - light.first_row
    block = source.rows(start, stop, into=scratch.of(source.scratch_bytes(stop - start)))
    bad = np.zeros(stop - start, np.int64)
    if _were_reflectances(light, block, sums, fill):
        return bad
    if light.bad_pixels == "zero":
        mended, bad = _mended(block, light.cube.scale)
        sums[...] = 0
        _were_reflectances(light, mended, sums, fill)
    else:
        # raises an error with the value and its position
        reflectance_rows(light.cube, start, stop, first_row=light.first_row)
    return bad


def _were_reflectances(
    light: Light, block: Array, sums: Array, fill: Callable[[RowsInMemory], None]
) -> bool:
    """Call ``fill``; the result is whether all reflectances were valid."""
    flat, lay = flattened(block, planar=light.planar)
    seen = np.repeat(np.array([3e38, -3e38], np.float32), LANES)
    fill(RowsInMemory(flat=flat, lay=lay, weights=light.weights, seen=seen))
    lowest, highest = float(seen[:LANES].min()), float(seen[LANES:].max())
    known = lowest >= 0 and highest * light.cube.scale <= BRIGHTEST
    return bool((known or light.palette_e is not None) and np.isfinite(sums).all())


def _mended(block: Array, scale: float) -> tuple[Array, Int64[Array, " rows"]]:
    """The block with 0 for invalid reflectances, and the number of such pixels per row."""
    with np.errstate(invalid="ignore", over="ignore"):
        rho = block.astype(np.float64) * scale
    bad = ~((rho >= 0) & (rho <= BRIGHTEST))
    kind = np.float32 if block.dtype.itemsize < 8 else np.float64
    return np.where(bad, 0, block).astype(kind), bad.any(axis=2).sum(axis=1)


_RESOLVED_E = 1e15  # above, float32 does not resolve single electrons

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
    dark_e = check.within(
        "electrons of the dark current",
        "e-",
        pixel.dark_electrons_e(time_s=operating_point.exposure.time_s),
        0.0,
        _RESOLVED_E,
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


@dataclass(frozen=True, kw_only=True, eq=False)
class RawPlan:
    """Plan for the raw codes of a mosaic.

    Attributes
    ----------
    light, draw
        Parameters of expected electrons, and of noise.
    tile
        Indices of the channels in one period of the mosaic.
    shares
        Shares of a count that end around its pixel, if neighbors mix after counting; ``light`` is
        then that of the counts. [1]
    """

    light: Light
    draw: Draw
    tile: Int64[Array, "ty tx"]
    adc: Converter
    height: int
    shares: Float32[Array, "ky kx"] | None


def raw_plan(
    light: Light,
    draw: Draw,
    operating_point: OperatingPoint,
    mosaic: Mosaic,
    adc: Adc,
    shares: Array | None,
) -> RawPlan:
    """The plan for one frame of a mosaic, whose pixels beyond the edge are mirrored."""
    demand_well(operating_point, draw)
    names, most_e = operating_point.sensor.names, _most_e(operating_point, draw)
    tile = [[names.index(name) for name in row] for row in mosaic.pattern]
    numbers = (most_e, 1.0 / adc.gain_e_per_dn, adc.black_level_dn, adc.top_code)
    converter = Converter(*(np.float32(number) for number in numbers))
    return RawPlan(
        light=light,
        draw=draw,
        tile=np.array(tile, np.int64),
        adc=converter,
        height=light.source.shape[0],
        shares=None if shares is None else shares.astype(np.float32),
    )


def raw_block(
    plan: RawPlan, start: int, stop: int, scratch: Scratch, codes: UInt16[Array, "rows w"]
) -> Counts:
    """Fill ``codes`` with the rows ``start`` to ``stop`` of the mosaic.

    Raises
    ------
    InputError
        If the cube has an invalid reflectance in these rows, or in those that mix with them.
    """
    if plan.shares is not None:
        return _coupled_raw_block(plan, plan.shares, start, stop, scratch, codes)
    height, width, bands = plan.light.source.shape
    counts = np.zeros((stop - start, 3, plan.light.channels))

    def fill(stored: RowsInMemory) -> None:
        kind = stored.flat.dtype.name
        raw_rows = kernel_of("fused_kernels", "raw_rows", height * width, bands, kind)
        raw_rows(stored, plan.tile, start, plan.draw, plan.adc, codes, counts)

    counts[:, 2] = on_rows(plan.light, start, stop, scratch, counts, fill)[:, None]
    return counts


@dataclass(frozen=True, kw_only=True, eq=False)
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
    coupling
        The crosstalk matrix, if channels mix after counting; ``light`` is then that of the counts.
        [1]
    """

    light: Light
    draw: Draw
    well: Well
    matrices: Float32[Array, "6 p"]
    coupling: Float32[Array, "p p"] | None


def well_of(operating_point: OperatingPoint, draw: Draw, *, held: bool) -> Well:
    """Full well of a color image, and whether electrons are clipped to 0 and to it.

    Raises
    ------
    InputError
        As `demand_well`, if they are clipped.
    """
    if held:
        demand_well(operating_point, draw)
    return Well(np.float32(_most_e(operating_point, draw)), held)


def color_matrices(
    matrix: ColorMatrix | None, operating_point: OperatingPoint
) -> tuple[ColorMatrix, Float32[Array, "6 p"], Float64[Array, " 3"]]:
    """The matrix; matrices to XYZ and to white-balanced linear sRGB, and XYZ of the white, Y = 1.

    The matrix is the kernel (eq. 6, quanta) if ``None``.

    Raises
    ------
    InputError
        As `white_lux_of`, or if the white is not valid for chromatic adaptation.
    """
    point = operating_point
    matrix = matrix or kernel_matrix(point.sensor, point.exposure, observer=point.observer)
    white_lux = white_lux_of(matrix, point)
    to_xyz, white = matrix.matrix / white_lux[1], white_lux / white_lux[1]
    to_srgb = linear_srgb(np.eye(3), white).T @ to_xyz
    return matrix, np.concatenate([to_xyz, to_srgb]).astype(np.float32), white


def white_lux_of(matrix: ColorMatrix, operating_point: OperatingPoint) -> Float[Array, " 3"]:
    """XYZ of a perfect white according to the matrix. [lx]

    Raises
    ------
    InputError
        If the matrix is for other channels, or gives the white no luminance.
    """
    sensor, lamp = operating_point.sensor, operating_point.illuminant
    check.same_names("picture", sensor=sensor.names, matrix=matrix.channels)
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
    if plan.coupling is not None:
        return _coupled_color_block(plan, plan.coupling, start, stop, scratch, xyz, srgb)
    height, width, bands = plan.light.source.shape
    values = height * width * plan.light.channels
    counts = np.zeros((stop - start, 3, plan.light.channels))

    def fill(stored: RowsInMemory) -> None:
        table = srgb_table()
        kind = stored.flat.dtype.name
        color_rows = kernel_of("fused_kernels", "color_rows", values, bands, kind)
        color_rows(stored, start, plan.draw, plan.well, plan.matrices, table, xyz, srgb, counts)

    counts[:, 2] = on_rows(plan.light, start, stop, scratch, counts, fill)[:, None]
    return counts


@cache
def srgb_table() -> UInt8[Array, " entries"]:
    """8-bit codes of linear values at equal steps from 0 to 1."""
    codes = np.round(255 * srgb_from_linear(np.linspace(0, 1, ENCODED))).astype(np.uint8)
    codes.flags.writeable = False  # all images share it
    return codes


@dataclass(frozen=True, kw_only=True, eq=False)
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

    Of a cube in memory only these rows are sent, and the neighbors that mix with them. A cube in
    a file is opened again in the other process, also if it is a memory map, which would be sent
    whole and with another axis order.
    """
    light, source = plan.light, row_source(plan.light.cube.stored)
    first_row = light.first_row
    pieces = row_pieces(source, start, stop)
    if isinstance(source, ArrayRows):
        first_row, end = start, stop
        if (shares := getattr(plan, "shares", None)) is not None:
            rows = _rows_around(plan, len(shares), start, stop)
            first_row, end = int(rows.min()), int(rows.max()) + 1
        source = ArrayRows(array=np.array(source.rows(first_row, end)))
    part = replace(light, cube=replace(light.cube, stored=source), first_row=first_row)
    return replace(plan, light=part), pieces


def electron_block(
    plan: ElectronPlan, start: int, stop: int, scratch: Scratch, out: Float32[Array, "rows w p"]
) -> Int64[Array, " rows"]:
    """Fill ``out`` with expected electrons of some rows; the result is bad pixels per row. [e-]

    Raises
    ------
    InputError
        As `raw_block`.
    """
    bands = plan.light.cube.wavelength_nm.size
    electron_rows = kernel_of("fused_kernels", "electron_rows", out.size, bands)
    return on_rows(plan.light, start, stop, scratch, out, lambda stored: electron_rows(stored, out))


def _coupled_raw_block(
    plan: RawPlan,
    shares: Float32[Array, "ky kx"],
    start: int,
    stop: int,
    scratch: Scratch,
    codes: UInt16[Array, "rows w"],
) -> Counts:
    refuse_absent_package("numba", "crosstalk of charge", extra="compiled")
    from chromanoise.imaging.fused_kernels import count_rows, coupled_raw_rows

    rows, columns = _rows_around(plan, len(shares), start, stop), codes.shape[1]
    first, last = int(rows.min()), int(rows.max()) + 1
    mean, bad = _means(plan.light, first, last, scratch, columns)
    light, counted = (np.empty((last - first, columns), np.float32) for _ in range(2))
    count_rows(mean, plan.tile, first, _without_readout(plan.draw), light, counted)
    counts = np.zeros((stop - start, 3, plan.light.channels))
    reach, period = shares.shape[1] // 2, plan.tile.shape[1]
    places = (rows - first, mirrored(columns, period, reach))
    coupled_raw_rows(
        light, counted, places, shares, plan.tile, start, plan.draw, plan.adc, codes, counts
    )
    counts[:, 2] = bad[start - first : stop - first, None]
    return counts


def _coupled_color_block(
    plan: ColorPlan,
    coupling: Float32[Array, "p p"],
    start: int,
    stop: int,
    scratch: Scratch,
    xyz: Float32[Array, "rows w 3"],
    srgb: UInt8[Array, "rows w 3"],
) -> Counts:
    refuse_absent_package("numba", "crosstalk of charge", extra="compiled")
    from chromanoise.imaging.fused_kernels import coupled_color_rows

    mean, bad = _means(plan.light, start, stop, scratch, xyz.shape[1])
    counts = np.zeros((stop - start, 3, plan.light.channels))
    draws = (_without_readout(plan.draw), plan.draw)
    where = (xyz, srgb, counts)
    coupled_color_rows(mean, coupling, start, draws, plan.well, plan.matrices, srgb_table(), *where)
    counts[:, 0] = counts[:, 0] @ coupling.T.astype(np.float64)
    counts[:, 2] = bad[:, None]
    return counts


def _rows_around(plan: RawPlan, side: int, start: int, stop: int) -> Int64[Array, " rows"]:
    """The rows of the picture that surround each of some rows, neighbors of the first one first."""
    reach = side // 2
    return mirrored(plan.height, plan.tile.shape[0], reach)[start : stop + 2 * reach]


def _means(
    light: Light, start: int, stop: int, scratch: Scratch, columns: int
) -> tuple[Float32[Array, "rows w p"], Int64[Array, " rows"]]:
    """Expected electrons of some rows, and bad pixels per row. [e-]"""
    mean = np.zeros((stop - start, columns, light.channels), np.float32)
    return mean, electron_block(ElectronPlan(light=light), start, stop, scratch, mean)


def _without_readout(draw: Draw) -> Draw:
    drawn = {f"{one}_e" for one in READ_OUT} & set(Draw._fields)
    nothing: dict[str, Any] = dict.fromkeys((*drawn, "black_error_e"), np.float32(0.0))
    return draw._replace(**nothing)
