# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Conversion of a block of rows of the cube to electrons, codes or color, in one pass.

A block is split into tiles for the expected electrons, and tiles into runs of one row for noise and
codes or color (`acquisition`), so that the data stay within the caches. Functions without
annotations are compiled, serial, and release the GIL; data shared by threads is read-only.

``stored`` is the block as stored in memory, `RowsInMemory`. Its weights are copied to aligned
memory, because vector loads across cache lines take twice as long.

If the sensor's crosstalk follows counting, pixels count the light with PRNU, dark electrons and
DSNU (`acquire` without readout). The counts are mixed, by a kernel of neighbors in a mosaic or by
the crosstalk matrix where each pixel has all channels. Then read noise, row noise and black-level
error are added.
"""

import math
from typing import no_type_check

import numpy as np

from chromanoise.imaging.acquisition import (
    acquire,
    add_offsets,
    channels_over,
    colors_of_run,
    column_offsets_e,
    count_means,
    every_channel,
    hold_at_well,
    means_by_channel,
    means_by_filter,
    means_by_pixel,
    room_for_colors,
    room_for_run,
    room_for_tile,
    row_offset_e,
    rows_of_tile,
    start_of,
    strands_for,
    tables_over,
    total_means,
    with_own_weights,
)
from chromanoise.imaging.blocks import READOUT, RUN, TILE
from chromanoise.imaging.kernel_cache import inner, kernel

_F = np.float32
_ZERO, _HALF = _F(0.0), _F(0.5)


@kernel(error_model="numpy")
@no_type_check
def electron_rows(stored, out):
    """Expected electrons of all channels: out (rows, columns, p). Nothing but eq. 2."""
    stored = with_own_weights(stored)
    rows, columns, channels = out.shape
    every = out.reshape(rows * columns, channels)
    sums, fours = room_for_tile(stored)
    together = rows_of_tile(stored.lay, columns)
    for top in range(0, rows, together):
        some = min(together, rows - top)
        for first in range(0, columns, TILE):
            n = some * min(TILE, columns - first)
            start, at = start_of(top, first, stored.lay), top * columns + first
            there = every[at : at + n]
            if channels == 4:
                means_by_pixel(stored, start, n, sums, there.reshape(1, n, 4))
                continue
            means_by_pixel(stored, start, n, sums, fours)
            for i in range(n):
                for c in range(channels):
                    there[i, c] = fours[c // 4, i, c % 4]


@kernel(error_model="numpy")
@no_type_check
def raw_rows(stored, tile, first_row, draw, adc, codes, counts):
    """Codes of the mosaic: codes (rows, columns) uint16.

    tile (tile rows, tile columns) int64 of channels; draw: `Draw`; adc: `Converter`; counts (rows,
    3, p) float64: expected electrons, pixels beyond full well, and one to spare.
    """
    stored = with_own_weights(stored)
    rows, columns = codes.shape
    sums, _ = room_for_tile(stored)
    mean, electrons = np.empty(TILE, np.float32), np.empty(RUN, np.float32)
    room, strands = room_for_run(1), strands_for(tile.shape[1])
    over = channels_over(tile, columns)
    tables = tables_over(over, tile.shape[1], stored)
    columns_e = column_offsets_e(1, columns, draw)
    together = rows_of_tile(stored.lay, columns)
    for top in range(0, rows, together):
        some = min(together, rows - top)
        phase = (first_row + top) % tile.shape[0]
        for first in range(0, columns, TILE):
            n = min(TILE, columns - first)
            start = start_of(top, first, stored.lay)
            means_by_filter(stored, start, some, first, n, over, phase, tables, sums, mean)
            for k in range(some):
                row, own = top + k, over[(phase + k) % tile.shape[0]][first : first + n]
                at_row, light = first_row + row, mean[k * n : (k + 1) * n]
                row_e = row_offset_e(at_row, draw)
                count_means(light, own, strands, counts[row])
                for run in range(0, n, RUN):
                    stop = min(run + RUN, n)
                    pixel, channel = at_row * columns + first + run, own[run:stop]
                    some_light, one = light[run:stop], channel.reshape(1, -1)
                    m, here_e = stop - run, columns_e[:, first + run :]
                    acquire(some_light, pixel, m, one, draw, row_e, here_e, room, electrons)
                    codes_of_run(electrons, channel, adc, counts[row], codes[row, first + run :])


@inner
@no_type_check
def codes_of_run(electrons, channel, adc, counts, codes):
    """Held at full well, converted, rounded, and held to the range of the converter."""
    for i in range(channel.size):
        held = min(electrons[i], adc.most_e)
        code = _F(math.floor(held * adc.dn_per_e + adc.black_dn + _HALF))
        code = code if code > _ZERO else _ZERO  # also for NaN
        codes[i] = np.uint16(np.int32(code if code < adc.top_dn else adc.top_dn))
    for i in range(channel.size):
        if electrons[i] > adc.most_e:
            counts[1, channel[i]] += 1.0


@kernel(error_model="numpy")
@no_type_check
def color_rows(stored, first_row, draw, well, matrices, table, xyz, srgb, counts):
    """Every channel at every pixel, then color: xyz (rows, columns, 3) f4, srgb the same uint8.

    draw, counts as `raw_rows`; well: `Well`; matrices (6, p): to XYZ and to linear sRGB; table:
    `blocks.ENCODED` codes of sRGB.
    """
    stored = with_own_weights(stored)
    rows, columns, _ = xyz.shape
    p = matrices.shape[1]
    sums, fours = room_for_tile(stored)
    mean, electrons = np.empty(RUN * p, np.float32), np.empty(RUN * p, np.float32)
    room, shades, strands = room_for_run(p), room_for_colors(), strands_for(1)
    every = every_channel(p)
    columns_e = column_offsets_e(p, columns, draw)
    together = rows_of_tile(stored.lay, columns)
    for top in range(0, rows, together):
        some = min(together, rows - top)
        for first in range(0, columns, TILE):
            n = min(TILE, columns - first)
            start = start_of(top, first, stored.lay)
            means_by_channel(stored, start, some * n, sums, fours)
            for k in range(some):
                row, at_row = top + k, first_row + top + k
                row_e = row_offset_e(at_row, draw)
                for c in range(p):
                    light = sums[c * TILE + k * n : c * TILE + (k + 1) * n]
                    counts[row, 0, c] += total_means(light, strands)
                for run in range(0, n, RUN):
                    m = min(RUN, n - run)
                    for c in range(p):
                        _copy(sums[c * TILE + k * n + run :], mean[c * m : (c + 1) * m])
                    at, pixel = first + run, at_row * columns + first + run
                    here_e = columns_e[:, at:]
                    acquire(mean, pixel, m, every, draw, row_e, here_e, room, electrons)
                    hold_at_well(electrons, m, p, well, counts[row])
                    there, shown = xyz[row, at:], srgb[row, at:]
                    colors_of_run(electrons, m, p, matrices, table, shades, there, shown)


@inner
@no_type_check
def _copy(values, out):
    """Written out, because assigning a slice takes five times as long."""
    for i in range(out.size):
        out[i] = values[i]


@kernel(error_model="numpy")
@no_type_check
def count_rows(mean, tile, first_row, draw, light, counted):
    """What the pixels of a mosaic count: light (expected) and counted, both (rows, columns) f4.

    mean (rows, columns, p) f4; tile, draw: as `raw_rows`, draw without readout.
    """
    rows, columns, _ = mean.shape
    over, room = channels_over(tile, columns), room_for_run(1)
    columns_e = column_offsets_e(1, columns, draw)
    some, electrons = np.empty(RUN, np.float32), np.empty(RUN, np.float32)
    for row in range(rows):
        at_row = first_row + row
        own = over[at_row % tile.shape[0]]
        for first in range(0, columns, RUN):
            n = min(RUN, columns - first)
            channel = own[first : first + n]
            for i in range(n):
                some[i] = mean[row, first + i, channel[i]]
                light[row, first + i] = some[i]
            pixel, one = at_row * columns + first, channel.reshape(1, -1)
            acquire(some, pixel, n, one, draw, _ZERO, columns_e, room, electrons)
            for i in range(n):
                counted[row, first + i] = electrons[i]


@kernel(error_model="numpy")
@no_type_check
def coupled_raw_rows(light, counted, places, shares, tile, first_row, draw, adc, codes, counts):
    """Codes of the mixed counts: codes (rows, columns) uint16.

    places: the rows and the columns of light and counted that surround each row and column; shares
    (ky, kx) f4 of a count that end around it; the rest as `raw_rows`.
    """
    rows, columns = codes.shape
    over, electrons = channels_over(tile, columns), np.empty(RUN, np.float32)
    columns_e = column_offsets_e(1, columns, draw)
    reading = (draw.reading_e, READOUT, draw.frame)
    for row in range(rows):
        at_row = first_row + row
        own, row_e = over[at_row % tile.shape[0]], row_offset_e(at_row, draw)
        for first in range(0, columns, RUN):
            n = min(RUN, columns - first)
            channel = own[first : first + n]
            for i in range(n):
                electrons[i] = _mixed(counted, row, first + i, places, shares)
                counts[row, 0, channel[i]] += _mixed(light, row, first + i, places, shares)
            pixel, one = at_row * columns + first, channel.reshape(1, -1)
            here_e = columns_e[:, first:]
            add_offsets(electrons, pixel, n, one, draw, row_e, here_e, reading)
            codes_of_run(electrons, channel, adc, counts[row], codes[row, first:])


@kernel(error_model="numpy")
@no_type_check
def coupled_color_rows(
    mean, coupling, first_row, draws, well, matrices, table, xyz, srgb, counts
):  # fmt: skip
    """Every channel at every pixel, mixed by a matrix, then color; out as `color_rows`.

    mean (rows, columns, p) f4; coupling (p, p) f4; draws: without readout, and whole.
    """
    inside, draw = draws
    rows, columns, p = mean.shape
    some, counted = np.empty(RUN * p, np.float32), np.empty(RUN * p, np.float32)
    electrons, every = np.empty(RUN * p, np.float32), every_channel(p)
    room, shades = room_for_run(p), room_for_colors()
    reading = (draw.reading_e, READOUT, draw.frame)
    none_e, columns_e = column_offsets_e(p, columns, inside), column_offsets_e(p, columns, draw)
    for row in range(rows):
        at_row = first_row + row
        row_e = row_offset_e(at_row, draw)
        for first in range(0, columns, RUN):
            n, pixel = min(RUN, columns - first), at_row * columns + first
            for c in range(p):
                for i in range(n):
                    some[c * n + i] = mean[row, first + i, c]
                    counts[row, 0, c] += some[c * n + i]
            acquire(some, pixel, n, every, inside, _ZERO, none_e, room, counted)
            for c in range(p):
                for i in range(n):
                    total = _ZERO
                    for k in range(p):
                        total += coupling[c, k] * counted[k * n + i]
                    electrons[c * n + i] = total
            here_e = columns_e[:, first:]
            add_offsets(electrons, pixel, n, every, draw, row_e, here_e, reading)
            hold_at_well(electrons, n, p, well, counts[row])
            there, shown = xyz[row, first:], srgb[row, first:]
            colors_of_run(electrons, n, p, matrices, table, shades, there, shown)


@inner
@no_type_check
def _mixed(values, row, column, places, shares):
    """The sum of the shares of a pixel and its neighbors, in a fixed order."""
    row_at, column_at = places
    last_y, last_x = shares.shape[0] - 1, shares.shape[1] - 1
    total = _ZERO
    for dy in range(last_y + 1):
        for dx in range(last_x + 1):
            share = shares[dy, dx]
            if share > _ZERO:
                total += share * values[row_at[row + last_y - dy], column_at[column + last_x - dx]]
    return total
