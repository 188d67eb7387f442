# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Random draws of the kernels: Philox words, quantiles, and shot and read noise of blocks.

Functions without annotations are compiled; a word is a uint64 whose high half is ignored, for the
wide multiplication of the processor; ``f4`` is float32, ``u4`` uint32.

Words are a function of seed, pixel, purpose, frame and channel only (Philox4x32-10). A cipher turns
the 64-bit key and the 128-bit counter into four words of 32 bits. There is no state, so the order
of tiles, threads and machines is arbitrary. The counter:

====  =======  ==================================================================
word  bits     what
====  =======  ==================================================================
0     0 .. 31  pixel index, low half
1     0 .. 15  pixel index, high half: 2^48 pixels
1     16 .. 31 purpose: ``LIGHT``, ``PIXEL_GAIN`` ..., so that options that are
               switched on leave the words of all other noise as they were
2     0 .. 31  frame
3     0 .. 13  group of four channels: channel // 4
3     16 .. 29 number of the reading in a sum; the rest is 0
====  =======  ==================================================================

The key is the seed, low half first. The pixel index counts along the rows of the whole picture.
The four words belong to the four channels of the group, in their order.

Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11 (2011),
doi:10.1145/2063384.2063405.

Quantile functions map one random word to one variate, without branches. Each variate is an
increasing function of one word u of 32 bits, through (u + 1/2) / 2^32; the complement of the word
gives the opposite normal variate. Only + - * /, square root, floor and fused multiply-add are used,
whose roundings are fixed, so the bits are the same on every processor.

Polynomials are summed in pairs, because the latency of a chain of products limits speed, not their
number. A function that calls the quantile functions needs ``error_model="numpy"``, because a test
for division by zero prevents vectorization.

Noise of a block of pixels is drawn in loops over lanes that vectorize. A lane is one channel of one
pixel, in memory order. The steps for a block are: random words of all lanes; their normal
quantiles; electrons as if all means were high; then the lanes of low mean are collected, sampled in
parallel, and written back. If any lane still lacks read noise, words for it are generated for the
whole block, and each such lane uses its own. Blocks fit in the first cache.

Poisson variates of means below 20 electrons take one word, and the same time at every mean. A count
of mean M is the sum of a count of the largest multiple of 1/2 e- in M, drawn from a table, and a
count of the rest. The table is that of the alias method: the high 6 bits of the word select one of
64 columns of equal chance, in which at most two counts share the low 26 bits. The position within
the part of a count is uniform, and draws the count of the rest. All chances are multiples of 2^-32.

Walker, "An efficient method for generating discrete random variables with general distributions",
ACM Trans. Math. Softw. 3 (1977), 253-256, doi:10.1145/355744.355749.
"""

import math
from decimal import Decimal
from typing import no_type_check

import numpy as np

from chromanoise.imaging.blocks import (
    FEW_E,
    LIGHT,
    LOG_TERMS,
    QUANTILE_ABOVE,
    QUANTILE_BELOW,
    READOUT,
    SMOOTH_E,
)
from chromanoise.imaging.dot_kernels import fused
from chromanoise.imaging.kernel_cache import inlined, inner, kernel

PER_CALL = 4
"""Number of channels that share one call of the cipher, one word each."""

_WORD = np.uint64(0xFFFFFFFF)
_HALF = np.uint64(32)
_PURPOSE_AT = np.uint64(16)
_MULTIPLY_0 = np.uint64(0xD2511F53)
_MULTIPLY_1 = np.uint64(0xCD9E8D57)
_WEYL_0 = np.uint64(0x9E3779B9)
_WEYL_1 = np.uint64(0xBB67AE85)


@inlined
@no_type_check
def _two_rounds(c0, c1, c2, c3, k0, k1):
    """Two rounds of the cipher; only the low halves of what goes in and comes out matter."""
    a = (c0 & _WORD) * _MULTIPLY_0
    b = (c2 & _WORD) * _MULTIPLY_1
    d0 = (b >> _HALF) ^ c1 ^ k0
    d2 = (a >> _HALF) ^ c3 ^ k1
    e = (d0 & _WORD) * _MULTIPLY_0
    f = (d2 & _WORD) * _MULTIPLY_1
    return (
        (f >> _HALF) ^ b ^ (k0 + _WEYL_0),
        f,
        (e >> _HALF) ^ a ^ (k1 + _WEYL_1),
        e,
    )


@inlined
@no_type_check
def philox4x32(c0, c1, c2, c3, k0, k1):
    """Four words (c0 .. c3: the counter, k0, k1: the key), each in the low half of a uint64.

    The rounds stand one after the other because a loop here keeps the loop around it from
    being vectorized.
    """
    two = np.uint64(2)
    w0, w1, w2, w3 = _two_rounds(c0, c1, c2, c3, k0, k1)
    k0, k1 = k0 + two * _WEYL_0, k1 + two * _WEYL_1
    w0, w1, w2, w3 = _two_rounds(w0, w1, w2, w3, k0, k1)
    k0, k1 = k0 + two * _WEYL_0, k1 + two * _WEYL_1
    w0, w1, w2, w3 = _two_rounds(w0, w1, w2, w3, k0, k1)
    k0, k1 = k0 + two * _WEYL_0, k1 + two * _WEYL_1
    w0, w1, w2, w3 = _two_rounds(w0, w1, w2, w3, k0, k1)
    k0, k1 = k0 + two * _WEYL_0, k1 + two * _WEYL_1
    w0, w1, w2, w3 = _two_rounds(w0, w1, w2, w3, k0, k1)
    return w0 & _WORD, w1 & _WORD, w2 & _WORD, w3 & _WORD


@inlined
@no_type_check
def groups_of(channels):
    """So many groups these channels need."""
    return (channels + PER_CALL - 1) // PER_CALL


@inlined
@no_type_check
def words_at(pixel, purpose, frame, group, seed):
    """The four words of a pixel (all arguments uint64) for one purpose, frame and group."""
    high = (pixel >> _HALF) | (purpose << _PURPOSE_AT)
    return philox4x32(pixel, high, frame, group, seed & _WORD, seed >> _HALF)


@inlined
@no_type_check
def word_at(pixel, purpose, frame, channel, seed):
    """The one word of a pixel that belongs to a channel (int64)."""
    w0, w1, w2, w3 = words_at(pixel, purpose, frame, np.uint64(channel >> 2), seed)
    odd, later = (channel & 1) == 1, (channel & 2) == 2
    low, high = (w1 if odd else w0), (w3 if odd else w2)
    return high if later else low


_F = np.float32
_ONE = _F(1.0)
_HALF_FLOAT = _F(0.5)
_TO_SHARE = _F(2.0**-32)
_HIGH_BIT = np.int32(31)

# bits of float32: where the exponent starts, and sqrt(1/2), the least mantissa
_EXPONENT_AT = np.int32(23)
_ROOT_HALF = np.int32(0x3F3504F3)
_LN_2 = _F(0.6931471805599453)

_L0, _L1, _L2, _L3, _L4, _L5, _L6, _L7 = map(_F, LOG_TERMS)
_P0, _P1, _P2, _P3, _P4, _P5 = map(_F, QUANTILE_ABOVE)
_, _Q1, _Q2, _Q3, _Q4, _Q5 = map(_F, QUANTILE_BELOW)


@inlined
@no_type_check
def minus_log(y):
    """-ln y (f4) for a normal y > 0; errs by 1e-7 of it or of 1."""
    bits = _F(y).view(np.int32)
    exponent = np.int32(np.int32(bits - _ROOT_HALF) >> _EXPONENT_AT)
    f = np.int32(bits - np.int32(exponent << _EXPONENT_AT)).view(np.float32) - _ONE
    f2 = f * f
    low = fused(fused(f, _L3, _L2), f2, fused(f, _L1, _L0))
    high = fused(fused(f, _L7, _L6), f2, fused(f, _L5, _L4))
    series = fused(high, f2 * f2, low)
    return fused(_F(exponent), -_LN_2, -(series * f))


@inlined
@no_type_check
def middle_and_log(word):
    """Of a word (u4), its share being t: 2t - 1 and w = -ln 4t(1 - t), both f4."""
    signed = np.int32(word)
    folded = np.int32(signed ^ np.int32(signed >> _HIGH_BIT))  # the word or its complement
    tail = (_F(folded) + _HALF_FLOAT) * _TO_SHARE
    away = _ONE - (tail + tail)
    return away if signed < 0 else -away, minus_log((tail + tail) * (_ONE + away))


@inlined
@no_type_check
def quantile_of_log(middle, w):
    """Standard normal variate (f4) from what `middle_and_log` gives."""
    w2 = w * w
    w4 = w2 * w2
    above = fused(fused(w, _P5, _P4), w4, fused(fused(w, _P3, _P2), w2, fused(w, _P1, _P0)))
    below = fused(fused(w, _Q5, _Q4), w4, fused(fused(w, _Q3, _Q2), w2, fused(w, _Q1, _ONE)))
    return middle * above / below


@inlined
@no_type_check
def normal_quantile(word):
    """Standard normal variate (f4) of a word (u4), -6.3 to 6.3; errs by 4e-7 of it."""
    middle, w = middle_and_log(word)
    return quantile_of_log(middle, w)


_C1, _THIRD = _F(1 / 6), _F(1 / 3)
_A1, _A3 = _F(-1 / 36), _F(-1 / 72)
_B0, _B2, _B4 = _F(-8 / 405), _F(7 / 810), _F(1 / 270)
_D1, _D3, _D5 = _F(671 / 38880), _F(-137 / 38880), _F(-23 / 17280)
_ZERO = _F(0.0)


@inlined
@no_type_check
def poisson_quantile_of_many(mean, z):
    """Poisson variate (f4) of mean >= ``FEW_E`` at the normal quantile z (both f4).

    Cornish-Fisher to the order mean^-3/2. The mean's whole electrons are set aside first: what is
    left is some hundred electrons, of which float32 holds the hundred-thousandth.
    """
    root = _F(math.sqrt(mean))
    i = _ONE / root
    whole = _F(np.floor(mean))
    s = z * z
    order_2 = z * fused(s, _A3, _A1)
    order_3 = fused(s, fused(s, _B4, _B2), _B0)
    order_4 = z * fused(s, fused(s, _D5, _D3), _D1)
    away = fused(root, z, fused(s, _C1, _THIRD))
    away = fused(i, fused(i, fused(i, order_4, order_3), order_2), away)
    return max(whole + _F(np.floor((mean - whole) + away)), _ZERO)


_G0, _G1 = _F(-3 / 24), _F(1 / 24)
_H0, _H1 = _F(-5 / 36), _F(2 / 36)
_I0, _I1, _I2 = _F(3 / 120), _F(-6 / 120), _F(1 / 120)
_J0, _J1, _J2 = _F(2 / 24), _F(-5 / 24), _F(1 / 24)
_K0, _K1, _K2 = _F(17 / 324), _F(-53 / 324), _F(12 / 324)
_SIXTH = _F(1 / 6)


@inlined
@no_type_check
def read_quantile_of_many(mean, variance_e2, z):
    """Poisson variate plus normal read noise of >= ``SMOOTH_E`` (f4) at the normal quantile z.

    Cornish-Fisher for a sum whose cumulants are M, V = M + s^2, M, M, M: with q = M / V the terms
    of order V^-k/2 are polynomials in q and z. To V^-1, which is enough from
    ``FEW_E`` on: at M = 20 e- the chances err by 5e-6. Where the read noise is larger, they err by
    as much at lower means, and from s = 2.65 e- on by less at every mean.
    """
    inverse = _ONE / (mean + variance_e2)
    i, q, s = _F(math.sqrt(inverse)), mean * inverse, z * z
    order_1 = z * fused(-q, fused(s, _H1, _H0), fused(s, _G1, _G0))
    of_q = fused(-q, fused(s, fused(s, _K2, _K1), _K0), fused(s, fused(s, _J2, _J1), _J0))
    order_2 = fused(-q, of_q, fused(s, fused(s, _I2, _I1), _I0))
    away = fused(i, fused(i, order_2, order_1), fused(s, _SIXTH, -_SIXTH))
    return mean + fused(q, away, (mean + variance_e2) * i * z)


# e^-x for 0 <= x <= 5/8: its Taylor series to x^9, which errs by 3e-9 x^9 < 4e-11 ...
_E = tuple((-1.0) ** k / math.factorial(k) for k in range(12))
_SHRINK = 1.0 / 32.0


@inlined
@no_type_check
def chance_of_none(mean):
    """e^-mean (float64) for a mean (float64) of 0 to ``FEW_E``; errs by 1e-12 of it."""
    x = mean * _SHRINK
    x2 = x * x
    x4 = x2 * x2
    low = (_E[0] + _E[1] * x) + (_E[2] + _E[3] * x) * x2
    middle = (_E[4] + _E[5] * x) + (_E[6] + _E[7] * x) * x2
    high = (_E[8] + _E[9] * x) + (_E[10] + _E[11] * x) * x2
    y = low + (middle + high * x4) * x4
    y = y * y
    y = y * y
    y = y * y
    y = y * y
    return y * y


_PER_LN_2 = _F(1 / 0.6931471805599453)
_LN_2_HIGH, _LN_2_LOW = _F(0.693145751953125), _F(1.428606765330187e-06)
_EXPONENT_OF_1 = np.int32(127)
_X2, _X3, _X4, _X5, _X6, _X7 = (_F(1 / math.factorial(k)) for k in range(2, 8))


@inlined
@no_type_check
def exponential_less_one(x):
    """e^x - 1 (f4) for x (f4) of -80 to 80; errs by 2e-7 of it, and by 1e-7 |x| of e^x."""
    whole = _F(np.floor(fused(x, _PER_LN_2, _HALF_FLOAT)))
    r = fused(whole, -_LN_2_LOW, fused(whole, -_LN_2_HIGH, x))
    r2 = r * r
    high = fused(fused(r, _X7, _X6), r2, fused(r, _X5, _X4))
    series = fused(r2, fused(high, r2, fused(r, _X3, _X2)), r)
    power = np.int32((np.int32(whole) + _EXPONENT_OF_1) << _EXPONENT_AT).view(np.float32)
    return fused(power, series, power - _ONE)


LANES = 1024
"""Number of lanes of a block, unless a pixel has more channels."""
GROUP = 32
"""Number of lanes that are sampled in parallel; the slowest lane determines the time."""

_SHARE_OF_WORD = 2.0**-32
_INFINITE = _F(np.inf)
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


@inner
@no_type_check
def room_for(count):
    """Scratch of `draw_light` and `draw_readout`: which lanes are low, variates, logarithms."""
    return np.empty(count, np.int32), np.empty(count, np.float32), np.empty(count, np.float32)


@inner
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


@inner
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


@inner
@no_type_check
def count_refused(mean):
    """How many means are negative, infinite or not a number; counted as `count_few` does."""
    right = np.int32(0)
    for j in range(mean.size):
        right = np.int32(right + np.int32((mean[j] >= _ZERO) & (mean[j] < _INFINITE)))
    return mean.size - right


@inner
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
            left[j] = (left[j] + 0.5) * _SHARE_OF_WORD - chance[j]
            found[j] = 0.0
        _count_together(low, left, chance, found)
        if together:
            for j in range(GROUP):
                electrons[first + np.uintp(j)] = found[j]
        else:
            for j in range(n):
                electrons[np.uintp(lanes[start + j])] = found[j]


@inlined
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


@inner
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


@inner
@no_type_check
def count_few(mean, few_e):
    """How many means are low; counted in 32 bits, as wide as the means, to vectorize."""
    few = np.int32(0)
    for j in range(mean.size):
        few = np.int32(few + np.int32(mean[j] < few_e))
    return few


@inner
@no_type_check
def normal_of_words(words, count, normal, logs):
    """Standard normal variates of ``count`` words; logs has room for as many.

    In two loops, because one alone has more numbers to keep than the processor has registers.
    """
    for j in range(count):
        normal[j], logs[j] = middle_and_log(words[j])
    for j in range(count):
        normal[j] = quantile_of_log(normal[j], logs[j])


@inner
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


@inner
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


_CELL_E = 0.5
_CELLS = int(FEW_E / _CELL_E)
_COLUMNS, _PART_BITS = 64, 26
_PART = 1 << _PART_BITS


def _chances(mean: float) -> list[int]:
    """Chances of 0 to 63 electrons in units of 2^-32; their sum is 2^32."""
    chance = [float(Decimal(-mean).exp())]
    for k in range(1, _COLUMNS):
        chance.append(chance[-1] * mean / k)
    units = [round(one * _COLUMNS * _PART) for one in chance]
    units[int(mean)] += _COLUMNS * _PART - sum(units)
    return units


def _aliases(units: list[int]) -> list[int]:
    """Of each column: length of the part of its own count, times 64, plus the other count."""
    left = list(units)
    short = [k for k, size in enumerate(left) if size < _PART]
    long = [k for k, size in enumerate(left) if size > _PART]
    entries = list(range(_COLUMNS))  # columns of one count
    while short:
        k, other = short.pop(), long[-1]
        entries[k] = left[k] * _COLUMNS + other
        left[other] -= _PART - left[k]
        if left[other] <= _PART:
            long.pop()
            if left[other] < _PART:
                short.append(other)
    return entries


ALIASES = np.array(
    [entry for cell in range(_CELLS) for entry in _aliases(_chances(cell * _CELL_E))], np.uint32
).view(np.int32)
"""64 columns, by the high 6 bits of the word, for each multiple of 1/2 e- below 20 e-."""

_PER_E, _E_PER_CELL = _F(1 / _CELL_E), _F(_CELL_E)
_LAST_CELL = _F(_CELLS - 1)
_LOW = np.uint32(_PART - 1)
_OTHER = np.uint32(_COLUMNS - 1)
_SIX, _AT = np.uint32(6), np.uint32(_PART_BITS)
_WHOLE = np.int32(_PART)


@inlined
@no_type_check
def cell_of(mean):
    """Which multiple of 1/2 e- is drawn from the table (i4); the last or the first for others."""
    cell = mean * _PER_E
    cell = cell if cell > _ZERO else _ZERO  # also for not a number
    return np.int32(cell if cell < _LAST_CELL else _LAST_CELL)


@inlined
@no_type_check
def start_of(cell):
    """Mean (f4) of a cell."""
    return _F(cell) * _E_PER_CELL


@inlined
@no_type_check
def place_of(cell, word):
    """Where in the table the column of a word lies (i4)."""
    return np.int32(np.int32(cell << np.int32(6)) + np.int32(word >> _AT))


@inlined
@no_type_check
def leading_count(entry, word):
    """Count (i4) by the entry of a column, and a uniform share (f4) between 0 and 1."""
    entry = np.uint32(entry)
    own, at = np.int32(entry >> _SIX), np.int32(word & _LOW)
    is_own = at < own
    count = np.int32(word >> _AT) if is_own else np.int32(entry & _OTHER)
    start = np.int32(0) if is_own else own
    size = own if is_own else np.int32(_WHOLE - own)
    return count, (_F(np.int32(at - start)) + _HALF_FLOAT) / _F(size)


_EXPONENTIAL = tuple(_F((-1.0) ** k / math.factorial(k)) for k in range(8))
_S2, _S3, _S4, _S5, _S6, _S7, _S8 = (_F(1 / k) for k in range(2, 9))


@inlined
@no_type_check
def few_more(mean, share):
    """Poisson variate (f4) of mean 0 to 1/2 (f4) at the upper share (f4); chances err by 1e-7."""
    m2 = mean * mean
    low = fused(
        fused(mean, _EXPONENTIAL[3], _EXPONENTIAL[2]),
        m2,
        fused(mean, _EXPONENTIAL[1], _EXPONENTIAL[0]),
    )
    high = fused(
        fused(mean, _EXPONENTIAL[7], _EXPONENTIAL[6]),
        m2,
        fused(mean, _EXPONENTIAL[5], _EXPONENTIAL[4]),
    )
    c1 = fused(high, m2 * m2, low) * mean
    c2 = c1 * mean * _S2
    c3 = c2 * mean * _S3
    c4 = c3 * mean * _S4
    c5 = c4 * mean * _S5
    c6 = c5 * mean * _S6
    c7 = c6 * mean * _S7
    above = fused(c7, mean * _S8, c7)  # chance of 7 or more
    count = _ONE if share < above else _ZERO
    above += c6
    count += _ONE if share < above else _ZERO
    above += c5
    count += _ONE if share < above else _ZERO
    above += c4
    count += _ONE if share < above else _ZERO
    above += c3
    count += _ONE if share < above else _ZERO
    above += c2
    count += _ONE if share < above else _ZERO
    above += c1
    count += _ONE if share < above else _ZERO
    return count
