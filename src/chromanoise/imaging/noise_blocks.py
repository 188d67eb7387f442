"""Shot and read noise of a block of pixels: every loop over lanes is one that vectorizes.

A lane is one channel of one pixel, in the order of memory. A block goes through: words of all
lanes; their normal quantiles; electrons as if all means were high; then the lanes of low mean are
collected, counted side by side, and put in place. Blocks stay in the first cache.
"""

from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise.imaging.philox import LIGHT, words_at
from chromanoise.imaging.variates import (
    FEW_E,
    chance_of_none,
    middle_and_log,
    poisson_quantile_of_many,
    quantile_of_log,
)

LANES = 1024
"""Lanes of a block, if a pixel has not more channels than that."""
GROUP = 32
"""Lanes that are counted side by side: as long as the slowest of them takes."""

_TO_SHARE = 2.0**-32
_ZERO, _INFINITE = np.float32(0.0), np.float32(np.inf)
_PER = np.array([0.0] + [1.0 / k for k in range(1, 81)])


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def fill_noise(mean, electrons, start, stop, tile_width, origin, width, frame, seed, read_noise_e):
    """Fill pixels ``start`` to ``stop`` of ``electrons`` (pixels, p); how many means are refused.

    Pixels are counted along the rows of a tile ``tile_width`` wide, whose first one is number
    ``origin`` of a picture ``width`` wide.
    """
    channels = mean.shape[1]
    pairs = (channels + 1) // 2
    most = max(1, LANES // (2 * pairs))
    pixel = np.empty(most * pairs, np.uint64)
    pair = np.empty(most * pairs, np.uint64)
    shot = np.empty(2 * most * pairs, np.uint32)
    read = np.empty(2 * most * pairs, np.uint32)
    room = room_for(most * channels)
    refused = 0
    for q in range(most * pairs):
        pair[q] = q % pairs
    for first in range(start, stop, most):
        count = min(most, stop - first)
        name_pixels(pixel, first, count, pairs, tile_width, origin, width)
        fill_words(pixel, pair, count * pairs, frame, seed, shot, read)
        if channels % 2:
            drop_padding(shot, count, channels)
            drop_padding(read, count, channels)
        here = mean[first : first + count].reshape(-1)
        there = electrons[first : first + count].reshape(-1)
        refused += count_refused(here)
        noise_of_block(here, shot, read, count * channels, read_noise_e, room, there)
    return refused


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def room_for(count):
    """Scratch of `noise_of_block` for so many lanes: which are low, variates, logarithms."""
    return np.empty(count, np.int32), np.empty(count, np.float32), np.empty(count, np.float32)


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def name_pixels(pixel, first, count, pairs, tile_width, origin, width):
    """Index of the pixel in the whole picture, once for each pair of its channels."""
    row, column = first // tile_width, first % tile_width
    q = 0
    for _ in range(count):
        index = np.uint64(origin + row * width + column)
        for _ in range(pairs):
            pixel[q] = index
            q += 1
        column += 1
        if column == tile_width:
            row, column = row + 1, 0


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def drop_padding(words, count, channels):
    """Close the gap that the last pair of an odd number of channels leaves at each pixel."""
    for i in range(1, count):
        for c in range(channels):
            words[i * channels + c] = words[i * (channels + 1) + c]


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def count_refused(mean):
    """How many means are negative, infinite or not a number."""
    refused = 0
    for j in range(mean.size):
        refused += 0 if (mean[j] >= _ZERO) & (mean[j] < _INFINITE) else 1
    return refused


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def fill_words(pixel, pair, count, frame, seed, shot, read):
    """Words of shot and read noise for ``count`` channel pairs; two lanes each, in order."""
    purpose = np.uint64(LIGHT)
    for q in range(count):
        w0, w1, w2, w3 = words_at(pixel[q], purpose, frame, pair[q], seed)
        shot[2 * q] = w0
        read[2 * q] = w1
        shot[2 * q + 1] = w2
        read[2 * q + 1] = w3


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def count_low(mean, words, electrons, lanes, count):
    """Poisson electrons of the ``count`` lanes listed in ``lanes``, whose means are low.

    Electron by electron the chance of it is taken off the share until nothing is left. Lanes that
    lie together are read together; unsigned indices spare the question whether they are negative.
    """
    left = np.empty(GROUP)
    chance = np.empty(GROUP)
    low = np.empty(GROUP)
    found = np.empty(GROUP)
    for start in range(0, count, GROUP):
        n = min(GROUP, count - start)
        first = np.uintp(lanes[start])
        together = n == GROUP and lanes[start + GROUP - 1] - lanes[start] == GROUP - 1
        if together:
            for j in range(GROUP):
                low[j] = mean[first + np.uintp(j)]
                left[j] = words[first + np.uintp(j)]
        else:
            for j in range(n):
                low[j] = mean[np.uintp(lanes[start + j])]
                left[j] = words[np.uintp(lanes[start + j])]
            for j in range(n, GROUP):
                low[j] = left[j] = 0.0
        for j in range(GROUP):
            chance[j] = chance_of_none(low[j])
            left[j] = (left[j] + 0.5) * _TO_SHARE - chance[j]
            found[j] = 0.0
        _count_together(low, left, chance, found)
        if together:
            for j in range(GROUP):
                electrons[first + np.uintp(j)] = found[j]
        else:
            for j in range(n):
                electrons[np.uintp(lanes[start + j])] = found[j]


@njit(inline="always", error_model="numpy")
@no_type_check
def _count_together(low, left, chance, found):
    for k in range(1, 77, 4):
        counting = 0
        for j in range(GROUP):
            counting += 1 if left[j] >= 0.0 else 0
        if counting == 0:
            break
        for j in range(GROUP):
            m, r, c, f = low[j], left[j], chance[j], found[j]
            f += 1.0 if r >= 0.0 else 0.0
            c *= m * _PER[k]
            r -= c
            f += 1.0 if r >= 0.0 else 0.0
            c *= m * _PER[k + 1]
            r -= c
            f += 1.0 if r >= 0.0 else 0.0
            c *= m * _PER[k + 2]
            r -= c
            f += 1.0 if r >= 0.0 else 0.0
            c *= m * _PER[k + 3]
            r -= c
            left[j], chance[j], found[j] = r, c, f


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def list_low(mean, count, lanes):
    """How many means are low; their lanes come first in ``lanes``, which has room for all."""
    if _count_few(mean[:count]) == 0:
        return 0
    few = 0
    for start in range(0, count, GROUP):
        stop = min(start + GROUP, count)
        if _count_few(mean[start:stop]) > 0:
            for j in range(start, stop):
                lanes[few] = j
                few += 1 if mean[j] < FEW_E else 0
    return few


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def _count_few(mean):
    """How many means are low; counted in 32 bits, as wide as the means, to vectorize."""
    few = np.int32(0)
    for j in range(mean.size):
        few = np.int32(few + np.int32(mean[j] < FEW_E))
    return few


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def normal_of_words(words, count, normal, logs):
    """Standard normal variates of ``count`` words; logs has room for as many.

    In two loops, because one alone has more numbers to keep than the processor has registers.
    """
    for j in range(count):
        normal[j], logs[j] = middle_and_log(words[j])
    for j in range(count):
        normal[j] = quantile_of_log(normal[j], logs[j])


@njit(cache=True, nogil=True, error_model="numpy")
@no_type_check
def noise_of_block(mean, shot, read, count, read_noise_e, room, electrons):
    """Noisy electrons of ``count`` lanes from their means and words; means and electrons f4."""
    lanes, normal, logs = room
    few = list_low(mean, count, lanes)
    if few < count:
        normal_of_words(shot, count, normal, logs)
        for j in range(count):
            electrons[j] = poisson_quantile_of_many(mean[j], normal[j])
    if few > 0:
        count_low(mean, shot, electrons, lanes, few)
    if read_noise_e > _ZERO:
        normal_of_words(read, count, normal, logs)
        for j in range(count):
            electrons[j] = electrons[j] + read_noise_e * normal[j]
