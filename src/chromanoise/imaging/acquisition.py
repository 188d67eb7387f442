# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Kernels for a run of pixels: expected electrons, noisy readout, color, and counts per row.

Functions without annotations are compiled, serial, and release the GIL; ``draw`` is a `Draw`.

Expected electrons are in the order that noise and color use. A tile is some thousand pixels of a
row, or of several short rows that are contiguous in memory: memory access is faster for long runs
in one band. ``stored`` is the block as stored in memory, `RowsInMemory`; ``sums`` (p * `TILE`,) and
``fours`` (p / 4, `TILE`, 4), p being rounded up to 4, are buffers for all channels.

Noise is added in physical order: PRNU, dark electrons, shot noise and read noise (`noise_draws`),
DSNU, and row, column and telegraph noise. The mean of the dark electrons is subtracted, as sensors
do with their shielded pixels.

Color is eq. 5: electrons to XYZ and to sRGB codes, one channel after the other.

Counts for the summary of an image are expected electrons, and pixels above full well. Sums are
float64 and split into many partial sums, because additions to one sum depend on each other. Partial
sums restart with every tile of a row, so results are bit-identical for any choice of blocks and
threads.
"""

from typing import no_type_check

import numpy as np

from chromanoise.imaging.blocks import (
    COLUMN,
    ENCODED,
    LEVEL,
    LIGHT,
    PIXEL_GAIN,
    PIXEL_LEVELS,
    PIXEL_OFFSET,
    READING,
    READOUT,
    ROW,
    RUN,
    RUN_LANES,
    STRANDS,
    TILE,
    RowsInMemory,
)
from chromanoise.imaging.dot_kernels import (
    fused,
    means_of_mosaic,
    means_of_mosaic_planes,
    means_of_pixels,
    means_of_planes,
    weights_over_columns,
)
from chromanoise.imaging.kernel_cache import inlined, inner, kernel
from chromanoise.imaging.noise_draws import (
    PER_CALL,
    draw_light,
    draw_readout,
    groups_of,
    normal_quantile,
    room_for,
    word_at,
    words_at,
)

_1, _2, _3, _4 = np.uintp(1), np.uintp(2), np.uintp(3), np.uintp(4)


@inner
@no_type_check
def four_apart(pixels, a, b, c, d):
    """Pixels (4 n,), four numbers each, to four arrays (n,)."""
    for i in range(a.size):
        j = _4 * np.uintp(i)
        a[i] = pixels[j]
        b[i] = pixels[j + _1]
        c[i] = pixels[j + _2]
        d[i] = pixels[j + _3]


@inner
@no_type_check
def four_together(a, b, c, d, pixels):
    """Four arrays (n,) to pixels (4 n,), four numbers each."""
    for i in range(a.size):
        j = _4 * np.uintp(i)
        pixels[j] = a[i]
        pixels[j + _1] = b[i]
        pixels[j + _2] = c[i]
        pixels[j + _3] = d[i]


@inner
@no_type_check
def three_together(a, b, c, pixels):
    """Three arrays (n,) to pixels (3 n,), three numbers each."""
    for i in range(a.size):
        j = _3 * np.uintp(i)
        pixels[j] = a[i]
        pixels[j + _1] = b[i]
        pixels[j + _2] = c[i]


_ZERO = np.float32(0.0)


@inner
@no_type_check
def strands_for(period):
    """Strands of a row whose channels repeat after ``period`` pixels: a whole number of periods."""
    return np.empty(max(STRANDS // period, 1) * period)


@inner
@no_type_check
def total_means(mean, strands):
    """Sum of the means of one channel."""
    _fill_strands(mean, strands)
    total = 0.0
    for k in range(min(strands.size, mean.size)):
        total += strands[k]
    return total


@inner
@no_type_check
def count_means(mean, channel, strands, counts):
    """Add the means of pixels to those of the channel over each: counts (3, p)."""
    _fill_strands(mean, strands)
    for k in range(min(strands.size, mean.size)):
        counts[0, channel[k]] += strands[k]


@inner
@no_type_check
def _fill_strands(mean, strands):
    """Strand k: the sum of values k, k + size, k + 2 size ..."""
    for k in range(strands.size):
        strands[k] = 0.0
    for first in range(0, mean.size, strands.size):
        here = mean[first : first + strands.size]
        for k in range(here.size):
            strands[k] += here[k]


@inner
@no_type_check
def _count_above(electrons, most_e):
    """How many exceed full well; counted in 32 bits, as wide as the electrons, to vectorize."""
    above = np.int32(0)
    for i in range(electrons.size):
        above = np.int32(above + np.int32(electrons[i] > most_e))
    return above


@inner
@no_type_check
def hold_at_well(electrons, n, p, well, counts):
    """Count what lies above full well, and clip it to 0 and full well."""
    most_e, held = well
    for c in range(p):
        counts[1, c] += _count_above(electrons[c * n : (c + 1) * n], most_e)
    if held:
        for j in range(n * p):
            electrons[j] = min(max(electrons[j], _ZERO), most_e)


_F = np.float32
_ONE = _F(1.0)
_TO_SHARE, _LOW, _ONE_BIT = _F(2.0**-32), np.uint64(0xFFFFFFFF), np.uint64(1)


@inner
@no_type_check
def room_for_run(channels):
    """Scratch of a run: words, channels being rounded up to 4, and what noise needs."""
    return np.empty(groups_of(channels) * PER_CALL * RUN, np.uint32), room_for(RUN * channels)


@inlined
@no_type_check
def row_offset_e(at_row, draw):
    """What all pixels of a row share: row noise and black-level error."""
    if draw.row_e > _ZERO:
        row_e = draw.row_e * normal_of(at_row, ROW, draw.frame, 0, draw.key)
        return draw.black_error_e + row_e
    return draw.black_error_e


@inner
@no_type_check
def column_offsets_e(channels, columns, draw):
    """Column noise (channels, columns) f4; no columns without any.

    The colors of a mosaic share the offset of a column (one channel); channels at every pixel are
    read in columns of their own.
    """
    if draw.column_e == _ZERO:
        return np.empty((channels, 0), np.float32)
    offsets = np.empty((channels, columns), np.float32)
    for c in range(channels):
        for i in range(columns):
            offsets[c, i] = draw.column_e * normal_of(i, COLUMN, draw.frame, c, draw.key)
    return offsets


@inlined
@no_type_check
def readout_offset_e(pixel, channel, column_e, draw):
    """Column noise ``column_e`` and telegraph noise of one pixel."""
    offset, at, none = column_e, np.uint64(pixel), np.uint64(0)
    if draw.levels_e > _ZERO:
        for reading in range(draw.readings):
            own = channel + reading * READING
            which = word_at(at, np.uint64(PIXEL_LEVELS), none, own, draw.key) & _LOW
            if _F(which) * _TO_SHARE < draw.level_share:
                word = word_at(at, np.uint64(LEVEL), draw.frame, own, draw.key)
                up = (word & _ONE_BIT) == _ONE_BIT
                offset = offset + (draw.levels_e if up else -draw.levels_e)
    return offset


@kernel(error_model="numpy")
@no_type_check
def add_readout_offsets(values, several, draw):
    """Add row, column and telegraph noise to a picture (rows, columns, p) f4, in place.

    several: whether all channels of a pixel are read, not only that of a mosaic.
    """
    rows, columns, p = values.shape
    columns_e = column_offsets_e(p if several else 1, columns, draw)
    for row in range(rows):
        row_e = row_offset_e(row, draw)
        for column in range(columns):
            for c in range(p):
                own = c if several else 0
                column_e = columns_e[own, column] if columns_e.size > 0 else _ZERO
                at = row * columns + column
                values[row, column, c] += row_e + readout_offset_e(at, c, column_e, draw)


@inner
@no_type_check
def acquire(mean, pixel, n, channels, draw, row_e, columns_e, room, electrons):
    """Electrons (n * p,) from mean (n * p,): p values of ``n`` pixels, one after the other.

    channels (p, n or more) int64: which channel each value is; one, the one over each pixel, or
    all. pixel: number of the first one in the whole picture. columns_e: `column_offsets_e` from the
    column of this one on.
    """
    words, block = room
    lanes = n * channels.shape[0]
    # without noise, adding and subtracting dark electrons has no effect
    dark_e = draw.dark_e if draw.noisy else _ZERO
    if draw.gain > _ZERO or dark_e > _ZERO:
        _imperfect_means(mean, pixel, n, channels, draw, dark_e)
    if draw.noisy:
        _fill_words(pixel, n, channels, LIGHT, draw, words)
        waiting = draw_light(mean, words, lanes, draw.reading_e, block, electrons)
        if waiting > 0:
            _fill_words(pixel, n, channels, READOUT, draw, words)
            draw_readout(words, waiting, lanes, draw.reading_e, block, electrons)
    else:
        for j in range(lanes):
            electrons[j] = mean[j]
        if draw.reading_e > _ZERO:
            _fill_words(pixel, n, channels, READOUT, draw, words)
            draw_readout(words, lanes, lanes, draw.reading_e, block, electrons)
    offsets = draw.pattern_e > _ZERO or columns_e.size > 0 or draw.levels_e > _ZERO
    if dark_e > _ZERO or offsets or row_e != _ZERO:
        own = (draw.pattern_e, PIXEL_OFFSET, np.uint64(0))
        add_offsets(electrons, pixel, n, channels, draw, row_e - dark_e, columns_e, own)


@inner
@no_type_check
def _imperfect_means(mean, pixel, n, channels, draw, dark_e):
    """Sensitivity that differs from pixel to pixel, then the dark electrons.

    channels (p, n) int64: which one each of the p values of a pixel is.
    """
    for c in range(channels.shape[0]):
        for i in range(n):
            gain = _ONE
            if draw.gain > _ZERO:
                z = normal_of(pixel + i, PIXEL_GAIN, 0, channels[c, i], draw.key)
                gain = max(_ONE + draw.gain * z, _ZERO)
            mean[c * n + i] = mean[c * n + i] * gain + dark_e


@inner
@no_type_check
def add_offsets(electrons, pixel, n, channels, draw, shared_e, columns_e, own):
    """What a row shares, column and telegraph noise, and normal noise of each pixel's own.

    channels and columns_e as in `acquire`; own: standard deviation, purpose and frame.
    """
    own_e, purpose, frame = own
    for c in range(channels.shape[0]):
        for i in range(n):
            column_e = columns_e[c, i] if columns_e.size > 0 else _ZERO
            offset = shared_e + readout_offset_e(pixel + i, channels[c, i], column_e, draw)
            if own_e > _ZERO:
                z = normal_of(pixel + i, purpose, frame, channels[c, i], draw.key)
                offset = offset + own_e * z
            electrons[c * n + i] = electrons[c * n + i] + offset


@inlined
@no_type_check
def normal_of(pixel, purpose, frame, channel, key):
    """A standard normal variate (f4) that belongs to a pixel, or a row, a purpose and a channel."""
    word = word_at(np.uint64(pixel), np.uint64(purpose), np.uint64(frame), channel, key)
    return normal_quantile(np.uint32(word))


@inner
@no_type_check
def _fill_words(pixel, n, channels, purpose, draw, words):
    """A word for each value, in their order."""
    if channels.shape[0] == 1:
        _words_of_one(pixel, channels[0, :n], purpose, draw.frame, draw.key, words)
        return
    for c in range(0, channels.shape[0], PER_CALL):
        w0, w1 = words[c * n : (c + 1) * n], words[(c + 1) * n : (c + 2) * n]
        w2, w3 = words[(c + 2) * n : (c + 3) * n], words[(c + 3) * n : (c + 4) * n]
        group = np.uint64(c // PER_CALL)
        _words_of_group(pixel, group, purpose, draw.frame, draw.key, w0, w1, w2, w3)


@inner
@no_type_check
def _words_of_group(pixel, group, purpose, frame, key, w0, w1, w2, w3):
    """Words of four channels of as many pixels as ``w0`` has."""
    for i in range(w0.size):
        four = words_at(np.uint64(pixel + i), np.uint64(purpose), frame, group, key)
        w0[i] = four[0]
        w1[i] = four[1]
        w2[i] = four[2]
        w3[i] = four[3]


@inner
@no_type_check
def _words_of_one(pixel, channel, purpose, frame, key, words):
    """The word of the one channel of each pixel: that which it has when all are rendered."""
    for i in range(channel.size):
        words[i] = word_at(np.uint64(pixel + i), np.uint64(purpose), frame, channel[i], key)


_HALF = _F(0.5)


@inner
@no_type_check
def room_for_colors():
    """Scratch of a run: three colors of each pixel, and where their codes stand."""
    return np.empty(3 * RUN, np.float32), np.empty(3 * RUN, np.int32)


@inner
@no_type_check
def colors_of_run(electrons, n, p, matrices, table, room, xyz, srgb):
    """Eq. 5 for a run, channel after channel; sRGB codes are looked up."""
    colors, entry = room
    _products(electrons, n, p, matrices[:3], colors)
    three_together(colors[:n], colors[n : 2 * n], colors[2 * n : 3 * n], xyz.reshape(-1))
    _products(electrons, n, p, matrices[3:], colors)
    _entries(colors[: 3 * n], entry[: 3 * n])
    _codes(table, entry[:n], entry[n : 2 * n], entry[2 * n : 3 * n], srgb)


@inner
@no_type_check
def _products(electrons, n, p, rows, colors):
    """Three rows of a matrix times the channels: colors (3 * n,), one color after the other."""
    odd = p % 2
    for k in range(3):
        color, row = colors[k * n : (k + 1) * n], rows[k]
        if odd:
            _weighted(electrons[:n], row[0], color)
        else:
            _weighted_pair(electrons[:n], electrons[n : 2 * n], row[0], row[1], color)
        for c in range(2 - odd, p, 2):
            here, next_one = electrons[c * n : (c + 1) * n], electrons[(c + 1) * n : (c + 2) * n]
            _add_weighted_pair(here, next_one, row[c], row[c + 1], color)


@inner
@no_type_check
def _weighted(values, weight, out):
    for i in range(out.size):
        out[i] = values[i] * weight


@inner
@no_type_check
def _weighted_pair(values, others, weight, other, out):
    for i in range(out.size):
        out[i] = fused(others[i], other, values[i] * weight)


@inner
@no_type_check
def _add_weighted_pair(values, others, weight, other, out):
    for i in range(out.size):
        out[i] = fused(others[i], other, fused(values[i], weight, out[i]))


@inner
@no_type_check
def _codes(table, first, second, third, srgb):
    for i in range(first.size):
        srgb[i, 0] = table[np.uint32(first[i])]
        srgb[i, 1] = table[np.uint32(second[i])]
        srgb[i, 2] = table[np.uint32(third[i])]


@kernel(error_model="numpy")
@no_type_check
def color_of_electrons(electrons, matrices, table, xyz, srgb):
    """Eq. 5 for rows of electrons (rows, columns, p): xyz and srgb as `color_rows`."""
    rows, columns, p = electrons.shape
    run, room = np.empty(RUN * p, np.float32), room_for_colors()
    for row in range(rows):
        for first in range(0, columns, RUN):
            n = min(RUN, columns - first)
            for i in range(n):
                for c in range(p):
                    run[c * n + i] = electrons[row, first + i, c]
            there, shown = xyz[row, first:], srgb[row, first:]
            colors_of_run(run, n, p, matrices, table, room, there, shown)


@inner
@no_type_check
def _entries(screen, entry):
    """Where in the table of codes a linear value stands; held to 0 .. 1."""
    for i in range(screen.size):
        within = screen[i] if screen[i] > _ZERO else _ZERO  # also for NaN
        within = within if within < _ONE else _ONE
        entry[i] = np.int32(within * _F(ENCODED - 1) + _HALF)


@inner
@no_type_check
def with_own_weights(stored):
    """The same rows with a copy of their weights."""
    return RowsInMemory(stored.flat, stored.lay, stored.weights.copy(), stored.seen)


@inlined
@no_type_check
def rows_of_tile(lay, columns):
    """Rows of a tile: several if they are short and follow each other."""
    follow = lay.row_pitch == columns * lay.pixel_pitch
    return max(1, TILE // columns) if follow else 1


@inlined
@no_type_check
def start_of(row, first, lay):
    """Where a pixel's first band lies in the flat array."""
    return row * lay.row_pitch + first * lay.pixel_pitch


@inner
@no_type_check
def room_for_tile(stored):
    """``sums`` and ``fours`` for all channels."""
    channels = stored.weights.shape[0]
    return np.empty(channels * TILE, np.float32), np.empty((channels // 4, TILE, 4), np.float32)


@inner
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


@inner
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


@inlined
@no_type_check
def _four_planes(sums, g, n):
    at = 4 * g * TILE
    return (
        sums[at : at + n],
        sums[at + TILE : at + TILE + n],
        sums[at + 2 * TILE : at + 2 * TILE + n],
        sums[at + 3 * TILE : at + 3 * TILE + n],
    )


@inner
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


@inner
@no_type_check
def every_channel(p):
    """All channels over each pixel of a run: (p, `RUN`)."""
    every = np.empty((p, RUN), np.int64)
    for c in range(p):
        every[c] = c
    return every


@inner
@no_type_check
def channels_over(tile, columns):
    """The channel over every pixel of the rows of one period: (tile rows, columns)."""
    over = np.empty((tile.shape[0], columns), np.int64)
    for row in range(tile.shape[0]):
        for column in range(columns):
            over[row, column] = tile[row, column % tile.shape[1]]
    return over


@inner
@no_type_check
def tables_over(over, period, stored):
    """`weights_over_columns` where pixels lie together and columns repeat in time; else empty."""
    repeats = stored.lay.pixel_pitch == 1 and RUN_LANES % period == 0
    return weights_over_columns(stored.weights, over, stored.lay.bands if repeats else 0)
