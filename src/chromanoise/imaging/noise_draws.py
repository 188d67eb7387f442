"""Quantile functions without branches, which map one random word to one variate.

Each variate is an increasing function of one word u of 32 bits, through (u + 1/2) / 2^32; the
complement of the word gives the opposite normal variate. Only + - * /, square root, floor and fused
multiply-add are used, whose roundings are fixed, so the bits are the same on every processor.

Functions without annotations are compiled; ``f4`` is float32, ``u4`` uint32. Polynomials are summed
in pairs, because the latency of a chain of products limits speed, not their number. A function
that calls these needs ``error_model="numpy"``, because a test for division by zero prevents
vectorization.
"""

import math
from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise.imaging.simd import fused

FEW_E = np.float32(20.0)
"""Mean from which the expansion is used; below it, the distribution function is summed. [e-]"""

SMOOTH_E = np.float32(0.75)
"""Read noise s from which the steps of whole electrons are negligible: their relative ripple of the
density is 2 exp(-2 pi^2 s^2) = 3e-5, which 10^8 samples do not resolve. [e-]"""

_F = np.float32
_ONE = _F(1.0)
_HALF = _F(0.5)
_TO_SHARE = _F(2.0**-32)
_HIGH_BIT = np.int32(31)

# bits of float32: where the exponent starts, and sqrt(1/2), the least mantissa
_EXPONENT_AT = np.int32(23)
_ROOT_HALF = np.int32(0x3F3504F3)
_LN_2 = _F(0.6931471805599453)

# ln(1 + f) / f for sqrt(1/2) <= 1 + f <= sqrt(2), minimax: the logarithm errs by 3.4e-8
_L0, _L1, _L2, _L3 = (
    _F(0.9999998139228),
    _F(-0.5000066740315),
    _F(0.3333618193219),
    _F(-0.2495934346),
)
_L4, _L5, _L6, _L7 = (
    _F(0.1987304861918),
    _F(-0.1733347148318),
    _F(0.1641997547084),
    _F(-0.1010220041),
)

# normal quantile / (1 - 2t) as a ratio of polynomials in w = -ln 4t(1 - t), minimax: errs by 1.2e-7
_P0, _P1, _P2 = _F(1.2533142805743616), _F(0.4528931760819228), _F(0.08998653582631565)
_P3, _P4, _P5 = _F(0.011902043399865366), _F(0.0010024744612763129), _F(2.921249561208359e-05)
_Q1, _Q2, _Q3 = _F(0.09955993205337688), _F(0.03269102304549773), _F(0.002291294635803468)
_Q4, _Q5 = _F(0.00016975149536817527), _F(1.0038387061978881e-06)


@njit(inline="always", error_model="numpy")
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


@njit(inline="always", error_model="numpy")
@no_type_check
def middle_and_log(word):
    """Of a word (u4), its share being t: 2t - 1 and w = -ln 4t(1 - t), both f4."""
    signed = np.int32(word)
    folded = np.int32(signed ^ np.int32(signed >> _HIGH_BIT))  # the word or its complement
    tail = (_F(folded) + _HALF) * _TO_SHARE
    away = _ONE - (tail + tail)
    return away if signed < 0 else -away, minus_log((tail + tail) * (_ONE + away))


@njit(inline="always", error_model="numpy")
@no_type_check
def quantile_of_log(middle, w):
    """Standard normal variate (f4) from what `middle_and_log` gives."""
    w2 = w * w
    w4 = w2 * w2
    above = fused(fused(w, _P5, _P4), w4, fused(fused(w, _P3, _P2), w2, fused(w, _P1, _P0)))
    below = fused(fused(w, _Q5, _Q4), w4, fused(fused(w, _Q3, _Q2), w2, fused(w, _Q1, _ONE)))
    return middle * above / below


@njit(inline="always", error_model="numpy")
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


@njit(inline="always", error_model="numpy")
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


@njit(inline="always", error_model="numpy")
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


@njit(inline="always", error_model="numpy")
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


@njit(inline="always", error_model="numpy")
@no_type_check
def exponential_less_one(x):
    """e^x - 1 (f4) for x (f4) of -80 to 80; errs by 2e-7 of it, and by 1e-7 |x| of e^x."""
    whole = _F(np.floor(fused(x, _PER_LN_2, _HALF)))
    r = fused(whole, -_LN_2_LOW, fused(whole, -_LN_2_HIGH, x))
    r2 = r * r
    high = fused(fused(r, _X7, _X6), r2, fused(r, _X5, _X4))
    series = fused(r2, fused(high, r2, fused(r, _X3, _X2)), r)
    power = np.int32((np.int32(whole) + _EXPONENT_OF_1) << _EXPONENT_AT).view(np.float32)
    return fused(power, series, power - _ONE)
