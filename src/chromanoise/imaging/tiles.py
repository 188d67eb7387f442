# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Expected electrons of a tile, in the order that noise and color use.

A tile is some thousand pixels of a row, or of several short rows that are contiguous in memory:
memory access is faster for long runs in one band. ``stored`` is the block as stored in memory,
`RowsInMemory`; ``sums`` (p * `TILE`,) and ``fours`` (p / 4, `TILE`, 4), p being rounded up to 4,
are buffers for all channels.

Functions without annotations are compiled, serial, and release the GIL.
"""

from typing import no_type_check

import numpy as np

from chromanoise.imaging.blocks import RUN_LANES
from chromanoise.imaging.kernel_cache import kernel
from chromanoise.imaging.layout import four_apart, four_together
from chromanoise.imaging.means import (
    TILE,
    means_of_mosaic,
    means_of_mosaic_planes,
    means_of_pixels,
    means_of_planes,
    weights_over_columns,
)
from chromanoise.imaging.records import RowsInMemory


@kernel(error_model="numpy")
@no_type_check
def with_own_weights(stored):
    """The same rows with a copy of their weights."""
    return RowsInMemory(stored.flat, stored.lay, stored.weights.copy(), stored.seen)


@kernel(inline="always")
@no_type_check
def rows_of_tile(lay, columns):
    """Rows of a tile: several if they are short and follow each other."""
    follow = lay.row_pitch == columns * lay.pixel_pitch
    return max(1, TILE // columns) if follow else 1


@kernel(inline="always")
@no_type_check
def start_of(row, first, lay):
    """Where a pixel's first band lies in the flat array."""
    return row * lay.row_pitch + first * lay.pixel_pitch


@kernel(error_model="numpy")
@no_type_check
def room_for_tile(stored):
    """``sums`` and ``fours`` for all channels."""
    channels = stored.weights.shape[0]
    return np.empty(channels * TILE, np.float32), np.empty((channels // 4, TILE, 4), np.float32)


@kernel(error_model="numpy")
@no_type_check
def means_by_pixel(stored, start, n, sums, fours):
    """All channels of ``n`` pixels, four side by side at each: fours (p / 4, n or more, 4)."""
    flat, lay, weights, seen = stored
    if lay.pixel_pitch != 1:
        means_of_pixels(flat, start, lay.pixel_pitch, n, lay.bands, weights, fours, seen)
        return
    means_of_planes(flat, start, lay.band_pitch, n, lay.bands, weights, sums, seen)
    for g in range(fours.shape[0]):
        a, b, c, d = _four_planes(sums, g, n)
        four_together(a, b, c, d, fours[g].reshape(-1))


@kernel(error_model="numpy")
@no_type_check
def means_by_channel(stored, start, n, sums, fours):
    """All channels of ``n`` pixels, one after the other: channel c in sums[c * TILE :]."""
    flat, lay, weights, seen = stored
    if lay.pixel_pitch == 1:
        means_of_planes(flat, start, lay.band_pitch, n, lay.bands, weights, sums, seen)
        return
    means_of_pixels(flat, start, lay.pixel_pitch, n, lay.bands, weights, fours, seen)
    for g in range(fours.shape[0]):
        a, b, c, d = _four_planes(sums, g, n)
        four_apart(fours[g].reshape(-1), a, b, c, d)


@kernel(inline="always")
@no_type_check
def _four_planes(sums, g, n):
    at = 4 * g * TILE
    return (
        sums[at : at + n],
        sums[at + TILE : at + TILE + n],
        sums[at + 2 * TILE : at + 2 * TILE + n],
        sums[at + 3 * TILE : at + 3 * TILE + n],
    )


@kernel(error_model="numpy")
@no_type_check
def means_by_filter(stored, start, rows, first, n, over, phase, tables, sums, out):
    """The one channel over each of ``n`` pixels of some rows from column ``first`` on.

    out (rows * n,); over (tile rows, columns) int64: the channel over each pixel; phase: which of
    its rows is over the first one; tables: of `weights_over_columns`, a row for each, or empty.
    """
    flat, lay, weights, seen = stored
    if lay.pixel_pitch != 1:
        for row in range(rows):
            own = over[(phase + row) % over.shape[0]][first : first + n]
            at, there = start + row * lay.row_pitch, out[row * n :]
            means_of_mosaic(flat, at, lay.pixel_pitch, n, lay.bands, weights, own, there, seen)
    elif tables.size > 0:
        means_of_mosaic_planes(flat, start, lay, rows, n, tables, phase, out, seen)
    else:
        means_of_planes(flat, start, lay.band_pitch, rows * n, lay.bands, weights, sums, seen)
        for row in range(rows):
            own = over[(phase + row) % over.shape[0]][first : first + n]
            for i in range(row * n, (row + 1) * n):
                out[i] = sums[own[i - row * n] * TILE + i]


@kernel(error_model="numpy")
@no_type_check
def channels_over(tile, columns):
    """The channel over every pixel of the rows of one period: (tile rows, columns)."""
    over = np.empty((tile.shape[0], columns), np.int64)
    for row in range(tile.shape[0]):
        for column in range(columns):
            over[row, column] = tile[row, column % tile.shape[1]]
    return over


@kernel(error_model="numpy")
@no_type_check
def tables_over(over, period, stored):
    """`weights_over_columns` where pixels lie together and columns repeat in time; else empty."""
    repeats = stored.lay.pixel_pitch == 1 and RUN_LANES % period == 0
    return weights_over_columns(stored.weights, over, stored.lay.bands if repeats else 0)
