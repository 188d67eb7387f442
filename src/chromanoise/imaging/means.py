# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Eq. 2 for the pixels of a cube: stored numbers times weights are expected electrons.

The cube is read once, as it lies. Where the bands of a pixel lie together (BIP) each pixel is
summed by `lanes`; where the pixels of a band lie together (BIL, BSQ) a run of them is summed band
by band. Both orders are fixed, so no choice of blocks changes a bit.

Functions without annotations are compiled; ``n`` pixels of one row are a run.
"""

from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise.imaging.lanes import LANES, band_adder, prefetch, weighted_sums

CHANNELS_AT_ONCE = 4
_AHEAD = 8  # pixels for which the memory is asked in advance
TILE = 2048
"""Pixels of a run whose sums are kept in the cache while the bands go by."""

_ZERO = np.float32(0.0)
_add_four, _add_one = band_adder(4), band_adder(1)
_four_of_two, _four = weighted_sums(CHANNELS_AT_ONCE, 2), weighted_sums(CHANNELS_AT_ONCE, 1)
_one = weighted_sums(1, 1)
_LINE = 16  # float32 of a cache line


@njit(nogil=True, inline="never", error_model="numpy")
@no_type_check
def means_of_pixels(flat, start, pitch, n, bands, weights, out, seen):
    """All channels of ``n`` pixels, ``pitch`` apart, whose bands lie together from ``flat[start]``.

    weights (p rounded up to 4, bands rounded up to 16) float32, the rest 0; out (n, same p)
    float32; seen (2 * `LANES`,) float32: least and greatest stored numbers so far.
    """
    even = n - n % 2
    for i in range(0, even, 2):
        at = start + i * pitch
        for line in range(0, 2 * pitch, _LINE):
            prefetch(flat, at + _AHEAD * pitch + line)
        for c in range(0, weights.shape[0], CHANNELS_AT_ONCE):
            a, b, d, e, f, g, h, k = _four_of_two(flat, at, pitch, bands, weights, c, 0, seen)
            out[i, c], out[i, c + 1], out[i, c + 2], out[i, c + 3] = a, b, d, e
            out[i + 1, c], out[i + 1, c + 1], out[i + 1, c + 2], out[i + 1, c + 3] = f, g, h, k
    if even < n:
        at = start + even * pitch
        for c in range(0, weights.shape[0], CHANNELS_AT_ONCE):
            a, b, d, e = _four(flat, at, pitch, bands, weights, c, 0, seen)
            out[even, c], out[even, c + 1], out[even, c + 2], out[even, c + 3] = a, b, d, e


@njit(nogil=True, inline="never", error_model="numpy")
@no_type_check
def means_of_mosaic(flat, start, pitch, n, bands, weights, channel, out, seen):
    """Only the channel over each pixel: channel (n,) int64, out (n,)."""
    for i in range(n):
        at = start + i * pitch
        for line in range(0, bands, _LINE):
            prefetch(flat, at + _AHEAD * pitch + line)
        (out[i],) = _one(flat, at, pitch, bands, weights, channel, i, seen)


@njit(nogil=True, inline="never", error_model="numpy")
@no_type_check
def means_of_planes(flat, start, band_pitch, n, bands, weights, sums, seen):
    """All channels of ``n`` <= `TILE` pixels whose neighbors lie together: sums (p + 2) * TILE.

    Channel c of pixel i is sums[c * TILE + i]. Four bands at a time, so that sums are kept and
    fetched a quarter as often.
    """
    channels = weights.shape[0]
    for j in range(channels * TILE):
        sums[j] = _ZERO
    for i in range(n):
        sums[channels * TILE + i] = seen[0]
        sums[(channels + 1) * TILE + i] = seen[LANES]
    whole = bands - bands % 4
    for b in range(0, bands):
        at = start + b * band_pitch
        if b >= whole:
            for c in range(0, channels, CHANNELS_AT_ONCE):
                _add_one(flat, at, band_pitch, n, weights, c, b, sums, TILE, channels)
        elif b % 4 == 0:
            for c in range(0, channels, CHANNELS_AT_ONCE):
                _add_four(flat, at, band_pitch, n, weights, c, b, sums, TILE, channels)
    for i in range(n):
        seen[0] = min(seen[0], sums[channels * TILE + i])
        seen[LANES] = max(seen[LANES], sums[(channels + 1) * TILE + i])
