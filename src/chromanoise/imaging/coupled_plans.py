"""Plans and blocks of pictures of a sensor whose crosstalk follows counting."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float32, Int64, UInt8, UInt16
from chromanoise.imaging.blocks import Scratch
from chromanoise.imaging.demosaic import mirrored
from chromanoise.imaging.light import Light, on_rows
from chromanoise.imaging.plans import ColorPlan, Counts, RawPlan, plan_for_rows, srgb_table
from chromanoise.imaging.records import Draw, RowsInMemory
from chromanoise.imaging.work import Block, row_pieces
from chromanoise.sensor.noise_source import READ_OUT


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CoupledRawPlan(RawPlan):
    """Plan for the raw codes of a mosaic whose pixels mix with their neighbors after counting.

    Attributes
    ----------
    shares
        Shares of a count that end around its pixel. [1]
    height
        Rows of the picture; neighbors beyond its edge are pixels inside of the same channel.
    """

    shares: Float32[Array, "ky kx"]
    height: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CoupledColorPlan(ColorPlan):
    """Plan for a color image whose channels mix in each pixel after counting.

    Attributes
    ----------
    coupling
        The crosstalk matrix. [1]
    """

    coupling: Float32[Array, "p p"]


def coupled_raw_plan(plan: RawPlan, kernel: Array, height: int) -> CoupledRawPlan:
    """A plan of a mosaic whose neighbors mix by ``kernel``; its light is that of the counts."""
    return CoupledRawPlan(**_values(plan), shares=kernel.astype(np.float32), height=height)


def coupled_color_plan(plan: ColorPlan, coupling: Array) -> CoupledColorPlan:
    """A plan of color, with channels that mix; its light is that of the counts."""
    return CoupledColorPlan(**_values(plan), coupling=coupling.astype(np.float32))


def coupled_raw_block(
    plan: CoupledRawPlan, start: int, stop: int, scratch: Scratch, codes: UInt16[Array, "rows w"]
) -> Counts:
    """Fill ``codes`` with the rows ``start`` to ``stop`` of the mosaic.

    Raises
    ------
    InputError
        As `chromanoise.imaging.plans.raw_block`; also for a row beside the block.
    """
    from chromanoise.imaging.coupled_kernels import count_rows, coupled_raw_rows

    rows, columns = _rows_around(plan, start, stop), codes.shape[1]
    first, last = int(rows.min()), int(rows.max()) + 1
    mean, bad = _means(plan.light, first, last, scratch, columns)
    light, counted = (np.empty((last - first, columns), np.float32) for _ in range(2))
    count_rows(mean, plan.tile, first, _without_readout(plan.draw), light, counted)
    counts = np.zeros((stop - start, 3, plan.light.channels))
    reach, period = plan.shares.shape[1] // 2, plan.tile.shape[1]
    places = (rows - first, mirrored(columns, period, reach))
    coupled_raw_rows(
        light, counted, places, plan.shares, plan.tile, start, plan.draw, plan.adc, codes, counts
    )
    counts[:, 2] = bad[start - first : stop - first, None]
    return counts


def coupled_color_block(
    plan: CoupledColorPlan,
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
        As `chromanoise.imaging.plans.raw_block`.
    """
    from chromanoise.imaging.coupled_kernels import coupled_color_rows

    mean, bad = _means(plan.light, start, stop, scratch, xyz.shape[1])
    counts = np.zeros((stop - start, 3, plan.light.channels))
    draws = (_without_readout(plan.draw), plan.draw)
    where = (xyz, srgb, counts)
    coupled_color_rows(
        mean, plan.coupling, start, draws, plan.well, plan.matrices, srgb_table(), *where
    )
    counts[:, 0] = counts[:, 0] @ plan.coupling.T.astype(np.float64)
    counts[:, 2] = bad[:, None]
    return counts


def coupled_part(plan: Any, start: int, stop: int) -> tuple[Any, list[Block]]:
    """As `plan_for_rows`, with the rows of the neighbors."""
    rows = _rows_around(plan, start, stop)
    part, _ = plan_for_rows(plan, int(rows.min()), int(rows.max()) + 1)
    return part, row_pieces(plan.light.source, start, stop)


def _rows_around(plan: CoupledRawPlan, start: int, stop: int) -> Int64[Array, " rows"]:
    """The rows of the picture that surround each of some rows, neighbors of the first one first."""
    reach = plan.shares.shape[0] // 2
    return mirrored(plan.height, plan.tile.shape[0], reach)[start : stop + 2 * reach]


def _means(
    light: Light, start: int, stop: int, scratch: Scratch, columns: int
) -> tuple[Float32[Array, "rows w p"], Int64[Array, " rows"]]:
    """Expected electrons of some rows, and bad pixels per row. [e-]"""
    from chromanoise.imaging.fused_kernels import electron_rows

    mean = np.zeros((stop - start, columns, light.channels), np.float32)

    def fill(stored: RowsInMemory) -> None:
        electron_rows(stored, mean)

    bad = on_rows(light, start, stop, scratch, mean, fill)
    return mean, bad


def _without_readout(draw: Draw) -> Draw:
    drawn = {f"{one}_e" for one in READ_OUT} & set(Draw._fields)
    nothing: dict[str, Any] = dict.fromkeys((*drawn, "black_error_e"), np.float32(0.0))
    return draw._replace(**nothing)


def _values(plan: RawPlan | ColorPlan) -> dict[str, Any]:
    return {one.name: getattr(plan, one.name) for one in fields(plan)}
