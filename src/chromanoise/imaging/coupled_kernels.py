# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Rows of a sensor whose crosstalk follows counting: pixels count, neighbors mix, readout follows.

Pixels count the light with PRNU, dark electrons and DSNU (`acquire` without readout). The counts
are mixed, by a kernel of neighbors in a mosaic or by the crosstalk matrix where each pixel has all
channels. Then read noise, row noise and black-level error are added.

Functions without annotations are compiled, serial, and release the GIL.
"""

from typing import no_type_check

import numpy as np

from chromanoise.imaging.accumulators import hold_at_well
from chromanoise.imaging.acquisition import (
    acquire,
    column_offsets_e,
    normal_of,
    readout_offset_e,
    room_for_run,
    row_offset_e,
)
from chromanoise.imaging.blocks import RUN
from chromanoise.imaging.color_kernels import colors_of_run
from chromanoise.imaging.fused_kernels import codes_of_run
from chromanoise.imaging.kernel_cache import kernel
from chromanoise.imaging.philox import READOUT
from chromanoise.imaging.tiles import channels_over

_ZERO = np.float32(0.0)


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
    for row in range(rows):
        at_row = first_row + row
        own, row_e = over[at_row % tile.shape[0]], row_offset_e(at_row, draw)
        for first in range(0, columns, RUN):
            n = min(RUN, columns - first)
            channel = own[first : first + n]
            for i in range(n):
                electrons[i] = _mixed(counted, row, first + i, places, shares)
                counts[row, 0, channel[i]] += _mixed(light, row, first + i, places, shares)
            pixel = at_row * columns + first
            here_e = columns_e[:, first:]
            _read_out(electrons, pixel, n, channel.reshape(1, -1), draw, row_e, here_e)
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
    electrons = np.empty(RUN * p, np.float32)
    colors, entry = np.empty(3 * RUN, np.float32), np.empty(3 * RUN, np.int32)
    room, every = room_for_run(p), np.empty((p, RUN), np.int64)
    for c in range(p):
        every[c] = c
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
            _read_out(electrons, pixel, n, every, draw, row_e, columns_e[:, first:])
            hold_at_well(electrons, n, p, well, counts[row])
            there, shown = xyz[row, first:], srgb[row, first:]
            colors_of_run(electrons, n, p, matrices, table, colors, entry, there, shown)


@kernel(error_model="numpy")
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


@kernel(error_model="numpy")
@no_type_check
def _read_out(electrons, pixel, n, channels, draw, row_e, columns_e):
    """Add what the readout adds: channels and columns_e as in `acquire`."""
    for c in range(channels.shape[0]):
        for i in range(n):
            column_e = columns_e[c, i] if columns_e.size > 0 else _ZERO
            added = row_e + readout_offset_e(pixel + i, channels[c, i], column_e, draw)
            if draw.reading_e > _ZERO:
                z = normal_of(pixel + i, READOUT, draw.frame, channels[c, i], draw.key)
                added = added + draw.reading_e * z
            electrons[c * n + i] = electrons[c * n + i] + added
