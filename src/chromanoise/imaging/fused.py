# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""From a block of rows of the cube to codes or color, in one pass that stays in the first cache.

A row is taken in tiles of `TILE` pixels for the expected electrons (`means`), and these in runs of
`RUN` for noise (`noise_blocks`) and codes or color. Functions without annotations are compiled,
serial and free of the interpreter's lock; what threads share is only read.

``flat`` is the block as it lies in memory, its first pixel first; ``lay`` says how: bands, and how
many numbers it is from row to row, from pixel to pixel and from band to band. Where the step from
pixel to pixel is 1, the pixels of a band lie together; otherwise the bands of a pixel do.
"""

import math
from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise.imaging.blocks import RUN_LANES
from chromanoise.imaging.color_kernels import colors_of_run
from chromanoise.imaging.layout import four_apart, four_together
from chromanoise.imaging.means import (
    TILE,
    means_of_mosaic,
    means_of_mosaic_planes,
    means_of_pixels,
    means_of_planes,
    weights_over_columns,
)
from chromanoise.imaging.noise_blocks import noise_of_block, room_for
from chromanoise.imaging.philox import LIGHT, PIXEL_GAIN, PIXEL_OFFSET, ROW, words_at
from chromanoise.imaging.tallies import count_means, hold_at_well, strands_for, total_means
from chromanoise.imaging.variates import normal_quantile

RUN = 256
"""Pixels of a run; with four channels 1024 lanes of noise."""

_F = np.float32
_ZERO, _ONE, _HALF = _F(0.0), _F(1.0), _F(0.5)


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _means_by_pixel(flat, start, lay, n, weights, sums, fours, seen):
    """All channels of a tile, four side by side at each pixel: fours (p / 4, n or more, 4)."""
    bands, _, pixel_pitch, band_pitch = lay
    if pixel_pitch != 1:
        means_of_pixels(flat, start, pixel_pitch, n, bands, weights, fours, seen)
        return
    means_of_planes(flat, start, band_pitch, n, bands, weights, sums, seen)
    planes = sums.reshape(-1, TILE)
    for g in range(fours.shape[0]):
        c = 4 * g
        four_together(
            planes[c, :n],
            planes[c + 1, :n],
            planes[c + 2, :n],
            planes[c + 3, :n],
            fours[g].reshape(-1),
        )


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _means_by_channel(flat, start, lay, n, weights, sums, fours, seen):
    """All channels of a tile, one after the other: sums (p * TILE,)."""
    bands, _, pixel_pitch, band_pitch = lay
    if pixel_pitch == 1:
        means_of_planes(flat, start, band_pitch, n, bands, weights, sums, seen)
        return
    means_of_pixels(flat, start, pixel_pitch, n, bands, weights, fours, seen)
    planes = sums.reshape(-1, TILE)
    for g in range(fours.shape[0]):
        c = 4 * g
        four_apart(
            fours[g].reshape(-1),
            planes[c, :n],
            planes[c + 1, :n],
            planes[c + 2, :n],
            planes[c + 3, :n],
        )


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _mosaic_means(flat, start, lay, n, weights, channel, table, sums, out, seen):
    """The channel over each pixel of a tile: channel (n,) int64."""
    bands, _, pixel_pitch, band_pitch = lay
    if pixel_pitch != 1:
        means_of_mosaic(flat, start, pixel_pitch, n, bands, weights, channel, out, seen)
    elif table.size > 0:
        means_of_mosaic_planes(flat, start, band_pitch, n, bands, table, out, seen)
    else:
        means_of_planes(flat, start, band_pitch, n, bands, weights, sums, seen)
        for i in range(n):
            out[i] = sums[channel[i] * TILE + i]


@njit(cache=True, nogil=True, inline="always")
@no_type_check
def _start_of(row, first, lay):
    """Where a pixel's first band lies in the flat array."""
    return row * lay[1] + first * lay[2]


@njit(cache=True, nogil=True, inline="always")
@no_type_check
def _normal(pixel, purpose, frame, channel, seed):
    """A standard normal variate (f4) that belongs to a pixel, or a row, a purpose and a channel."""
    pair = np.uint64(channel >> 1)
    words = words_at(np.uint64(pixel), np.uint64(purpose), np.uint64(frame), pair, seed)
    return normal_quantile(np.uint32(words[0] if channel & 1 == 0 else words[2]))


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _imperfect_means(mean, pixel, n, channels, prnu, dark_e, seed):
    """Sensitivity that differs from pixel to pixel, then the dark electrons.

    channels (p, n) int64: which one each of the p values of a pixel is.
    """
    for c in range(channels.shape[0]):
        for i in range(n):
            gain = _ONE
            if prnu > _ZERO:
                z = _normal(pixel + i, PIXEL_GAIN, 0, channels[c, i], seed)
                gain = max(_ONE + prnu * z, _ZERO)
            mean[c * n + i] = mean[c * n + i] * gain + dark_e


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _imperfect_readout(electrons, pixel, n, channels, dsnu_e, row_e, seed):
    """The dark signal that differs from pixel to pixel, and what the row shares."""
    for c in range(channels.shape[0]):
        for i in range(n):
            offset = row_e
            if dsnu_e > _ZERO:
                z = _normal(pixel + i, PIXEL_OFFSET, 0, channels[c, i], seed)
                offset = offset + dsnu_e * z
            electrons[c * n + i] = electrons[c * n + i] + offset


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _words_of_pair(pixel, pair, frame, seed, shot, read, odd_shot, odd_read):
    """Words of two channels of as many pixels as ``shot`` has."""
    purpose = np.uint64(LIGHT)
    for i in range(shot.size):
        w0, w1, w2, w3 = words_at(np.uint64(pixel + i), purpose, frame, np.uint64(pair), seed)
        shot[i] = w0
        read[i] = w1
        odd_shot[i] = w2
        odd_read[i] = w3


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _words_of_all(pixel, n, p, frame, seed, shot, read, spare):
    """Words of every channel of ``n`` pixels, one channel after the other."""
    for c in range(0, p, 2):
        even, odd = slice(c * n, (c + 1) * n), slice((c + 1) * n, (c + 2) * n)
        if c + 1 < p:
            _words_of_pair(pixel, c // 2, frame, seed, shot[even], read[even], shot[odd], read[odd])
        else:
            _words_of_pair(
                pixel, c // 2, frame, seed, shot[even], read[even], spare[0, :n], spare[1, :n]
            )


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _words_of_mosaic(pixel, n, channel, frame, seed, shot, read):
    """Words of the one channel of each pixel: those that it has when all are rendered."""
    purpose = np.uint64(LIGHT)
    for i in range(n):
        c = channel[i]
        w0, w1, w2, w3 = words_at(np.uint64(pixel + i), purpose, frame, np.uint64(c >> 1), seed)
        odd = (c & 1) == 1
        shot[i] = w2 if odd else w0
        read[i] = w3 if odd else w1


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def electron_rows(flat, lay, rows, columns, weights, channels, out, seen):
    """Expected electrons of all channels: out (rows, columns, p). Nothing but eq. 2."""
    padded = weights.shape[0]
    fours = np.empty((padded // 4, TILE, 4), np.float32)
    sums = np.empty(padded * TILE, np.float32)
    for row in range(rows):
        for first in range(0, columns, TILE):
            n = min(TILE, columns - first)
            start = _start_of(row, first, lay)
            if channels == 4:
                there = out[row, first : first + n].reshape(1, n, 4)
                _means_by_pixel(flat, start, lay, n, weights, sums, there, seen)
                continue
            _means_by_pixel(flat, start, lay, n, weights, sums, fours, seen)
            for i in range(n):
                for c in range(channels):
                    out[row, first + i, c] = fours[c // 4, i, c % 4]


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def raw_rows(
    flat, lay, rows, columns, weights, tile, first_row, noise, frame, seed, adc, codes, counts, seen
):
    """Codes of the mosaic: codes (rows, columns) uint16.

    tile (tile rows, tile columns) int64 of channels; noise: read noise, PRNU, dark electrons,
    DSNU, row noise, whether there is any; adc: electrons at full well, codes per electron, black
    level, top code; counts (rows, 3, p) float64: expected electrons, pixels beyond full well, and
    one to spare.
    """
    row_noise_e = noise[4]
    mean = np.empty(TILE, np.float32)
    sums = np.empty(weights.shape[0] * TILE, np.float32)
    electrons = np.empty(RUN, np.float32)
    shot, read = np.empty(RUN, np.uint32), np.empty(RUN, np.uint32)
    room = room_for(RUN)
    strands = strands_for(tile.shape[1])
    over = _over_rows(tile, columns)
    repeats = lay[2] == 1 and RUN_LANES % tile.shape[1] == 0
    tables = weights_over_columns(weights, over, lay[0] if repeats else 0)
    for row in range(rows):
        at_row = first_row + row
        channel = over[at_row % tile.shape[0]]
        row_e = _ZERO
        if row_noise_e > _ZERO:
            row_e = row_noise_e * _normal(at_row, ROW, frame, 0, seed)
        for first in range(0, columns, TILE):
            n = min(TILE, columns - first)
            start, own = _start_of(row, first, lay), channel[first : first + n]
            _mosaic_means(
                flat, start, lay, n, weights, own, tables[at_row % tile.shape[0]], sums, mean, seen
            )
            count_means(mean[:n], own, strands, counts[row])
            for run in range(0, n, RUN):
                m = min(RUN, n - run)
                own = channel[first + run : first + run + m]
                pixel = at_row * columns + first + run
                _words_of_mosaic(pixel, m, own, np.uint64(frame), seed, shot, read)
                light = mean[run : run + m]
                _acquire(
                    light,
                    shot,
                    read,
                    room,
                    pixel,
                    m,
                    own.reshape(1, -1),
                    noise,
                    row_e,
                    seed,
                    electrons,
                )
                _codes(electrons, m, own, adc, counts[row], codes[row, first + run :])


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _over_rows(tile, columns):
    """The channel over every pixel of the rows of one period: (tile rows, columns)."""
    over = np.empty((tile.shape[0], columns), np.int64)
    for row in range(tile.shape[0]):
        for column in range(columns):
            over[row, column] = tile[row, column % tile.shape[1]]
    return over


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _acquire(mean, shot, read, room, pixel, n, channels, noise, row_e, seed, electrons):
    """One noisy acquisition of ``n`` pixels: electrons (n * p,) from mean (n * p,).

    channels (p, n or more) int64: which one each of the p values of a pixel is.
    """
    p = channels.shape[0]
    read_noise_e, prnu, dark_e, dsnu_e, _, noisy = noise
    if prnu > _ZERO or dark_e > _ZERO:
        _imperfect_means(mean, pixel, n, channels, prnu, dark_e, seed)
    if noisy:
        noise_of_block(mean, shot, read, n * p, read_noise_e, room, electrons)
    else:
        for j in range(n * p):
            electrons[j] = mean[j]
    if dsnu_e > _ZERO or row_e != _ZERO:
        _imperfect_readout(electrons, pixel, n, channels, dsnu_e, row_e, seed)


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _codes(electrons, n, channel, adc, counts, codes):
    """Held at full well, converted, rounded, and held to the range of the converter."""
    full_well_e, dn_per_e, black_dn, top_dn = adc
    for i in range(n):
        held = min(electrons[i], full_well_e)
        code = _F(math.floor(held * dn_per_e + black_dn + _HALF))
        code = code if code > _ZERO else _ZERO  # NaN too
        codes[i] = np.uint16(np.int32(code if code < top_dn else top_dn))
    for i in range(n):
        if electrons[i] > full_well_e:
            counts[1, channel[i]] += 1.0


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def color_rows(
    flat,
    lay,
    rows,
    columns,
    weights,
    channels,
    first_row,
    noise,
    frame,
    seed,
    well,
    matrices,
    table,
    xyz,
    srgb,
    counts,
    seen,
):
    """Every channel at every pixel, then color: xyz (rows, columns, 3) f4, srgb the same uint8.

    noise, counts as `raw_rows`; well: electrons at full well, whether they are held between 0 and
    it; matrices (6, p): to XYZ and to linear sRGB; table: `color_kernels.ENCODED` codes of sRGB.
    """
    row_noise_e, p = noise[4], channels
    colors, entry = np.empty(3 * RUN, np.float32), np.empty(3 * RUN, np.int32)
    fours = np.empty((weights.shape[0] // 4, TILE, 4), np.float32)
    sums, strands = np.empty(weights.shape[0] * TILE, np.float32), strands_for(1)
    every = np.empty((p, RUN), np.int64)
    for c in range(p):
        every[c] = c
    mean, electrons = np.empty(RUN * p, np.float32), np.empty(RUN * p, np.float32)
    shot, read = np.empty(RUN * p, np.uint32), np.empty(RUN * p, np.uint32)
    room, spare = room_for(RUN * p), np.empty((2, RUN), np.uint32)
    for row in range(rows):
        at_row = first_row + row
        row_e = _ZERO
        if row_noise_e > _ZERO:
            row_e = row_noise_e * _normal(at_row, ROW, frame, 0, seed)
        for first in range(0, columns, TILE):
            n = min(TILE, columns - first)
            start = _start_of(row, first, lay)
            _means_by_channel(flat, start, lay, n, weights, sums, fours, seen)
            for c in range(p):
                counts[row, 0, c] += total_means(sums[c * TILE : c * TILE + n], strands)
            for run in range(0, n, RUN):
                m = min(RUN, n - run)
                for c in range(p):
                    mean[c * m : (c + 1) * m] = sums[c * TILE + run : c * TILE + run + m]
                pixel = at_row * columns + first + run
                if noise[5]:
                    _words_of_all(pixel, m, p, np.uint64(frame), seed, shot, read, spare)
                _acquire(mean, shot, read, room, pixel, m, every, noise, row_e, seed, electrons)
                hold_at_well(electrons, m, p, well, counts[row])
                at = first + run
                colors_of_run(
                    electrons, m, p, matrices, table, colors, entry, xyz[row, at:], srgb[row, at:]
                )
