# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Eq. 2 for the pixels of a cube: expected electrons are stored numbers times weights.

The cube is read once, in its memory order. If the bands of a pixel are contiguous (BIP), each pixel
is summed by `dot_kernels`; if the pixels of a band are contiguous (BIL, BSQ), a run of pixels is
summed band by band. Both orders are fixed, so results are bit-identical for any choice of blocks.

Functions without annotations are compiled; a tile is ``n`` consecutive pixels.
"""

from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise.imaging.blocks import CHANNELS_AT_ONCE, RUN_LANES
from chromanoise.imaging.dot_kernels import band_adder, own_band_adder, pixel_adder, weighted_sum

BANDS_AT_ONCE = 8
"""Bands per pass, limited by the hardware prefetcher; sums are loaded and stored once per pass."""
TILE = 4096
"""Number of pixels whose sums stay in the second cache during the loop over bands."""

_AGAIN = 128  # pixels that stay in the cache until all channels are summed
_ZERO = np.float32(0.0)
_add_some, _add_one = band_adder(BANDS_AT_ONCE), band_adder(1)
_add_pixels = pixel_adder()
_add_some_own, _add_own = own_band_adder(BANDS_AT_ONCE), own_band_adder(1)


@njit(nogil=True, inline="never", error_model="numpy")
@no_type_check
def means_of_pixels(flat, start, pitch, n, bands, weights, fours, seen):
    """All channels of ``n`` pixels, ``pitch`` apart, whose bands lie together from ``flat[start]``.

    weights (p rounded up to 4, bands rounded up to 16) float32, the rest 0; fours (p / 4, n or
    more, 4) float32: four channels side by side at each pixel; seen (2 * `LANES`,) float32: least
    and greatest stored numbers so far.
    """
    every, step = fours.reshape(-1), CHANNELS_AT_ONCE
    for i in range(0, n, _AGAIN):
        at, some = start + i * pitch, min(_AGAIN, n - i)
        for c in range(0, weights.shape[0], step):
            first = c * fours.shape[1] + step * i
            _add_pixels(flat, at, pitch, some, bands, weights, c, every, first, step, seen)


@njit(nogil=True, inline="never", error_model="numpy")
@no_type_check
def means_of_mosaic(flat, start, pitch, n, bands, weights, channel, out, seen):
    """Only the channel over each pixel: channel (n,) int64, out (n,)."""
    for i in range(n):
        at = start + i * pitch
        out[i] = weighted_sum(flat, at, bands, weights, channel[i], seen)


@njit(nogil=True, inline="never", error_model="numpy")
@no_type_check
def means_of_planes(flat, start, band_pitch, n, bands, weights, sums, seen):
    """All channels of ``n`` <= `TILE` pixels whose neighbors lie together: sums (p * TILE,).

    Channel c of pixel i is sums[c * TILE + i].
    """
    channels = weights.shape[0]
    for j in range(channels * TILE):
        sums[j] = _ZERO
    whole = bands - bands % BANDS_AT_ONCE
    for b in range(0, whole, BANDS_AT_ONCE):
        at = start + b * band_pitch
        for c in range(0, channels, CHANNELS_AT_ONCE):
            _add_some(flat, at, band_pitch, n, weights, c, b, sums, TILE, seen)
    for b in range(whole, bands):
        at = start + b * band_pitch
        for c in range(0, channels, CHANNELS_AT_ONCE):
            _add_one(flat, at, band_pitch, n, weights, c, b, sums, TILE, seen)


@njit(nogil=True, error_model="numpy")
@no_type_check
def weights_over_columns(weights, over, bands):
    """The weight of each band at each of `RUN_LANES` columns: (tile rows, bands * RUN_LANES).

    Where the columns of a mosaic repeat in that many, each pixel of a band needs one product only.
    """
    table = np.zeros((over.shape[0], bands * RUN_LANES), np.float32)
    for row in range(over.shape[0]):
        for i in range(min(RUN_LANES, over.shape[1])):
            for b in range(bands):
                table[row, b * RUN_LANES + i] = weights[over[row, i], b]
    return table


@njit(nogil=True, inline="never", error_model="numpy")
@no_type_check
def means_of_mosaic_planes(flat, start, lay, rows, n, tables, phase, out, seen):
    """Only the channel over each of ``n`` pixels of some rows: out (rows * n,).

    tables: of `weights_over_columns`, its row ``phase`` for the first one; the first pixel of a row
    stands at a multiple of their columns.
    """
    for i in range(rows * n):
        out[i] = _ZERO
    whole = lay.bands - lay.bands % BANDS_AT_ONCE
    for b in range(0, whole, BANDS_AT_ONCE):
        for row in range(rows):
            at, there = start + b * lay.band_pitch + row * lay.row_pitch, out[row * n :]
            table = tables[(phase + row) % tables.shape[0]]
            _add_some_own(flat, at, lay.band_pitch, n, table, b, there, seen)
    for b in range(whole, lay.bands):
        for row in range(rows):
            at, there = start + b * lay.band_pitch + row * lay.row_pitch, out[row * n :]
            table = tables[(phase + row) % tables.shape[0]]
            _add_own(flat, at, lay.band_pitch, n, table, b, there, seen)
