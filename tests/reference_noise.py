"""The noise kernel in plain numpy: a line per step, all values at once.

Every product, sum, quotient and root stands in the same order and precision as in the compiled
kernel, so the two agree bit for bit. ``a b + c`` in one rounding is made from float64.
"""

import math

import numpy as np

F = np.float32
LOW_WORD = np.uint64(0xFFFFFFFF)
HALF_WORD = np.uint64(32)


def philox4x32(counter, key):
    """Ten rounds over arrays of uint64 that hold 32-bit words (Salmon et al., SC11, 2011)."""
    c0, c1, c2, c3 = (np.asarray(c, np.uint64) for c in counter)
    k0, k1 = (int(k) for k in key)
    for _ in range(10):
        a, b = np.uint64(0xD2511F53) * c0, np.uint64(0xCD9E8D57) * c2
        c0, c1, c2, c3 = (
            (b >> HALF_WORD) ^ c1 ^ np.uint64(k0),
            b & LOW_WORD,
            (a >> HALF_WORD) ^ c3 ^ np.uint64(k1),
            a & LOW_WORD,
        )
        k0, k1 = (k0 + 0x9E3779B9) & 0xFFFFFFFF, (k1 + 0xBB67AE85) & 0xFFFFFFFF
    return c0, c1, c2, c3


def light_words(shape, **place):
    """The words of shot noise, and of shot and read noise drawn as one: (h, w, p) of uint32."""
    return words_for(0, shape, **place)


def readout_words(shape, **place):
    """The words of read noise that is drawn by itself: (h, w, p) of uint32."""
    return words_for(1, shape, **place)


def words_for(purpose, shape, *, seed, frame=0, first_row=0, first_column=0, width=None):
    """One word for each channel of each pixel; four channels share a counter."""
    height, own_width, channels = shape
    width = own_width if width is None else width
    rows = first_row + np.arange(height, dtype=np.uint64)[:, None, None]
    columns = first_column + np.arange(own_width, dtype=np.uint64)[:, None]
    pixel = rows * np.uint64(width) + columns
    group = np.arange((channels + 3) // 4, dtype=np.uint64)
    pixel, group, frames = np.broadcast_arrays(pixel, group, np.uint64(frame))
    high = pixel >> HALF_WORD | np.uint64(purpose << 16)
    words = philox4x32((pixel & LOW_WORD, high, frames, group), (seed & 0xFFFFFFFF, seed >> 32))
    padded = np.stack(words, axis=-1).reshape(height, own_width, -1)
    return padded[..., :channels].astype(np.uint32)


def fused(a, b, c):
    """a b + c rounded once: the product is exact in float64, the sum there is rounded to odd.

    Boldo & Melquiond, "Emulation of a FMA and correctly rounded sums", IEEE TC 57 (2008) 462.
    """
    product, c = np.multiply(a, b, dtype=np.float64), np.float64(c)
    total = np.atleast_1d(product + c)
    back = total - product
    rest = (product - (total - back)) + (c - back)  # what the sum has lost
    even = (total.view(np.int64) & 1) == 0
    odd = np.nextafter(total, np.where(rest > 0, np.inf, -np.inf))
    return np.where(even & (rest != 0), odd, total).astype(F)


def normal_quantiles(words):
    """Standard normal variates of 32-bit words, in float32."""
    signed = words.view(np.int32)
    tail = ((signed ^ (signed >> 31)).astype(F) + F(0.5)) * F(2.0**-32)
    away = F(1) - (tail + tail)
    y = (tail + tail) * (F(1) + away)
    exponent = (y.view(np.int32) - np.int32(0x3F3504F3)) >> 23
    f = (y.view(np.int32) - (exponent << 23)).view(F) - F(1)
    log = [
        0.9999998139228, -0.5000066740315, 0.3333618193219, -0.2495934346,
        0.1987304861918, -0.1733347148318, 0.1641997547084, -0.1010220041,
    ]  # fmt: skip
    f2 = f * f
    log = fused(fused_quartet(log[4:], f, f2), f2 * f2, fused_quartet(log[:4], f, f2))
    w = fused(exponent.astype(F), -F(0.6931471805599453), -(log * f))
    above = [
        1.2533142805743616, 0.4528931760819228, 0.08998653582631565, 0.011902043399865366,
        0.0010024744612763129, 2.921249561208359e-05,
    ]  # fmt: skip
    below = [
        1.0, 0.09955993205337688, 0.03269102304549773, 0.002291294635803468,
        0.00016975149536817527, 1.0038387061978881e-06,
    ]  # fmt: skip
    above, below = fused_sextet(above, w), fused_sextet(below, w)
    z = away * above / below
    return np.where(signed < 0, z, -z)


def quartet(c, x, x2):
    """A polynomial of four coefficients, lowest first."""
    c0, c1, c2, c3 = (x.dtype.type(one) for one in c)
    return (c0 + c1 * x) + (c2 + c3 * x) * x2


def fused_pair(c, x):
    return fused(x, F(c[1]), F(c[0]))


def fused_quartet(c, x, x2):
    """As `quartet`, each product fused with its sum."""
    return fused(fused_pair(c[2:], x), x2, fused_pair(c[:2], x))


def fused_sextet(c, x):
    """A polynomial of six coefficients, lowest first."""
    x2 = x * x
    return fused(fused_pair(c[4:], x), x2 * x2, fused_quartet(c[:4], x, x2))


def many_electrons(mean, z):
    """Cornish-Fisher to the order mean^-3/2, in float32."""
    root = np.sqrt(mean)
    i, s, whole = F(1) / root, z * z, np.floor(mean)
    second = z * fused_pair([-1 / 36, -1 / 72], s)
    third = fused(s, fused_pair([7 / 810, 1 / 270], s), F(-8 / 405))
    fourth = z * fused(s, fused_pair([-137 / 38880, -23 / 17280], s), F(671 / 38880))
    away = fused(root, z, fused_pair([1 / 3, 1 / 6], s))
    away = fused(i, fused(i, fused(i, fourth, third), second), away)
    return np.maximum(whole + np.floor((mean - whole) + away), F(0))


def many_read_electrons(mean, read_noise_e, z):
    """Cornish-Fisher of electrons plus read noise to the order variance^-1, in float32."""
    variance = mean + read_noise_e * read_noise_e
    inverse = F(1) / variance
    i, q, s = np.sqrt(inverse), mean * inverse, z * z
    first = z * fused(-q, fused_pair([-5 / 36, 2 / 36], s), fused_pair([-3 / 24, 1 / 24], s))
    constant, linear, square = (
        fused(s, fused_pair(c[1:], s), F(c[0]))
        for c in (
            [3 / 120, -6 / 120, 1 / 120],
            [2 / 24, -5 / 24, 1 / 24],
            [17 / 324, -53 / 324, 12 / 324],
        )
    )
    second = fused(-q, fused(-q, square, linear), constant)
    away = fused(i, fused(i, second, first), fused_pair([-1 / 6, 1 / 6], s))
    return mean + fused(q, away, variance * i * z)


def few_electrons(mean, words):
    """The distribution function summed from 0 electrons on, in float64."""
    mean = mean.astype(np.float64)
    e = [(-1.0) ** k / math.factorial(k) for k in range(12)]
    x = mean * (1.0 / 32.0)
    x2 = x * x
    x4 = x2 * x2
    low, middle, high = (quartet(e[k : k + 4], x, x2) for k in (0, 4, 8))
    chance = low + (middle + high * x4) * x4
    for _ in range(5):
        chance = chance * chance
    left = (words + 0.5) * 2.0**-32 - chance
    electrons = np.zeros_like(mean)
    for k in range(1, 77):
        electrons += left >= 0
        chance = chance * (mean * (1.0 / k))
        left = left - chance
    return electrons.astype(F)


def noisy_electrons(mean_e, *, read_noise_e, seed, **place):
    """What chromanoise.imaging.noisy_electrons returns."""
    mean, noise = np.asarray(mean_e, F), F(read_noise_e)
    light = light_words(mean.shape, seed=seed, **place)
    read = normal_quantiles(readout_words(mean.shape, seed=seed, **place))
    many, smooth = mean >= 20, noise >= 0.75
    z, electrons = normal_quantiles(light[many]), np.empty_like(mean)
    if smooth:
        electrons[many] = many_read_electrons(mean[many], noise, z)
    else:
        electrons[many] = many_electrons(mean[many], z)
    electrons[~many] = few_electrons(mean[~many], light[~many])
    apart = ~many if smooth else np.full(mean.shape, noise > 0)
    electrons[apart] += noise * read[apart]
    return electrons
