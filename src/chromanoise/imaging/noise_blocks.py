"""Shot and read noise of a block of pixels, in loops over lanes that vectorize.

A lane is one channel of one pixel, in memory order. The steps for a block are: random words of all
lanes; their normal quantiles; electrons as if all means were high; then the lanes of low mean are
collected, sampled in parallel, and written back. If any lane still lacks read noise, words for it
are generated for the whole block, and each such lane uses its own. Blocks fit in the first cache.
"""

from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise.imaging.kernel_cache import kernel
from chromanoise.imaging.noise_draws import (
    FEW_E,
    SMOOTH_E,
    chance_of_none,
    middle_and_log,
    poisson_quantile_of_many,
    quantile_of_log,
    read_quantile_of_many,
)
from chromanoise.imaging.philox import LIGHT, PER_CALL, READOUT, groups_of, words_at

LANES = 1024
"""Number of lanes of a block, unless a pixel has more channels."""
GROUP = 32
"""Number of lanes that are sampled in parallel; the slowest lane determines the time."""

_TO_SHARE = 2.0**-32
_ZERO, _INFINITE = np.float32(0.0), np.float32(np.inf)
_PER = np.array([0.0] + [1.0 / k for k in range(1, 81)])


@kernel(error_model="numpy")
@no_type_check
def fill_noise(mean, electrons, start, stop, tile_width, origin, width, frame, seed, read_noise_e):
    """Fill pixels ``start`` to ``stop`` of ``electrons`` (pixels, p); how many means are refused.

    Pixels are counted along the rows of a tile ``tile_width`` wide, whose first one is number
    ``origin`` of a picture ``width`` wide.
    """
    channels = mean.shape[1]
    groups = groups_of(channels)
    most = max(1, LANES // (PER_CALL * groups))
    pixel = np.empty(most * groups, np.uint64)
    group = np.empty(most * groups, np.uint64)
    words = np.empty(PER_CALL * most * groups, np.uint32)
    room = room_for(most * channels)
    refused = 0
    for q in range(most * groups):
        group[q] = q % groups
    for first in range(start, stop, most):
        count = min(most, stop - first)
        lanes = count * channels
        here = mean[first : first + count].reshape(-1)
        there = electrons[first : first + count].reshape(-1)
        refused += count_refused(here)
        name_pixels(pixel, first, count, groups, tile_width, origin, width)
        fill_words(pixel, group, count, channels, LIGHT, frame, seed, words)
        waiting = draw_light(here, words, lanes, read_noise_e, room, there)
        if waiting > 0:
            fill_words(pixel, group, count, channels, READOUT, frame, seed, words)
            draw_readout(words, waiting, lanes, read_noise_e, room, there)
    return refused


@kernel(error_model="numpy")
@no_type_check
def room_for(count):
    """Scratch of `draw_light` and `draw_readout`: which lanes are low, variates, logarithms."""
    return np.empty(count, np.int32), np.empty(count, np.float32), np.empty(count, np.float32)


@kernel(error_model="numpy")
@no_type_check
def name_pixels(pixel, first, count, groups, tile_width, origin, width):
    """Index of the pixel in the whole picture, once for each group of its channels."""
    row, column = first // tile_width, first % tile_width
    q = 0
    for _ in range(count):
        index = np.uint64(origin + row * width + column)
        for _ in range(groups):
            pixel[q] = index
            q += 1
        column += 1
        if column == tile_width:
            row, column = row + 1, 0


@kernel(error_model="numpy")
@no_type_check
def fill_words(pixel, group, count, channels, purpose, frame, seed, words):
    """A word for each channel of ``count`` pixels, in order; pixel, group: of each four words."""
    groups = groups_of(channels)
    purpose = np.uint64(purpose)
    for q in range(count * groups):
        w0, w1, w2, w3 = words_at(pixel[q], purpose, frame, group[q], seed)
        words[4 * q] = w0
        words[4 * q + 1] = w1
        words[4 * q + 2] = w2
        words[4 * q + 3] = w3
    padded = groups * PER_CALL
    if padded > channels:  # remove the padding
        for i in range(1, count):
            for c in range(channels):
                words[i * channels + c] = words[i * padded + c]


@kernel(error_model="numpy")
@no_type_check
def count_refused(mean):
    """How many means are negative, infinite or not a number; counted as `count_few` does."""
    right = np.int32(0)
    for j in range(mean.size):
        right = np.int32(right + np.int32((mean[j] >= _ZERO) & (mean[j] < _INFINITE)))
    return mean.size - right


@kernel(error_model="numpy")
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


@kernel(error_model="numpy")
@no_type_check
def list_low(mean, count, few_e, lanes):
    """How many means are below ``few_e``; ``lanes``, with room for all, starts with these lanes."""
    if count_few(mean[:count], few_e) == 0:
        return 0
    few = 0
    for start in range(0, count, GROUP):
        stop = min(start + GROUP, count)
        if count_few(mean[start:stop], few_e) > 0:
            for j in range(start, stop):
                lanes[few] = j
                few += 1 if mean[j] < few_e else 0
    return few


@kernel(error_model="numpy")
@no_type_check
def count_few(mean, few_e):
    """How many means are low; counted in 32 bits, as wide as the means, to vectorize."""
    few = np.int32(0)
    for j in range(mean.size):
        few = np.int32(few + np.int32(mean[j] < few_e))
    return few


@kernel(error_model="numpy")
@no_type_check
def normal_of_words(words, count, normal, logs):
    """Standard normal variates of ``count`` words; logs has room for as many.

    In two loops, because one alone has more numbers to keep than the processor has registers.
    """
    for j in range(count):
        normal[j], logs[j] = middle_and_log(words[j])
    for j in range(count):
        normal[j] = quantile_of_log(normal[j], logs[j])


@kernel(error_model="numpy")
@no_type_check
def draw_light(mean, words, count, read_noise_e, room, electrons):
    """Electrons of ``count`` lanes; how many of them, listed in ``room``, lack their read noise.

    mean and electrons f4, words of `LIGHT`. Where means are high and the read noise smooths the
    steps of whole electrons, one word makes their sum.
    """
    lanes, normal, logs = room
    few = list_low(mean, count, FEW_E, lanes)
    together = read_noise_e >= SMOOTH_E
    if few < count:
        normal_of_words(words, count, normal, logs)
        if together:
            variance_e2 = read_noise_e * read_noise_e
            for j in range(count):
                electrons[j] = read_quantile_of_many(mean[j], variance_e2, normal[j])
        else:
            for j in range(count):
                electrons[j] = poisson_quantile_of_many(mean[j], normal[j])
    if few > 0:
        count_low(mean, words, electrons, lanes, few)
    if read_noise_e == _ZERO:
        return 0
    return few if together else count


@kernel(error_model="numpy")
@no_type_check
def draw_readout(words, waiting, count, read_noise_e, room, electrons):
    """Add read noise to the ``waiting`` of ``count`` lanes; words of `READOUT`, not kept."""
    lanes, normal, logs = room
    if waiting == count:
        normal_of_words(words, count, normal, logs)
        for j in range(count):
            electrons[j] = electrons[j] + read_noise_e * normal[j]
        return
    for j in range(waiting):
        words[j] = words[np.uintp(lanes[j])]
    normal_of_words(words, waiting, normal, logs)
    for j in range(waiting):
        lane = np.uintp(lanes[j])
        electrons[lane] = electrons[lane] + read_noise_e * normal[j]
