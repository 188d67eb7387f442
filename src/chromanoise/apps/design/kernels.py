# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""CIELAB and CIEDE2000 of many candidates, compiled: loops over the last axis that use SIMD.

Functions without annotations are compiled, serial, and release the GIL. The same source is compiled
for complex numbers, of which the imaginary part is a derivative, so every function is analytic, and
comparisons read the real part. Transcendental functions are polynomials, which the compiler can
vectorize.
"""

from collections.abc import Callable
from typing import no_type_check

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

from chromanoise.base import Array
from chromanoise.imaging import kernel

_DELTA3 = (6 / 29) ** 3
_COS275, _SIN275 = np.cos(np.radians(275.0)), np.sin(np.radians(275.0))
_COS30, _SIN30 = np.cos(np.radians(30.0)), np.sin(np.radians(30.0))
_COS6, _SIN6 = np.cos(np.radians(6.0)), np.sin(np.radians(6.0))
_COS63, _SIN63 = np.cos(np.radians(63.0)), np.sin(np.radians(63.0))
_COS85, _COS130 = np.cos(np.radians(85.0)), np.cos(np.radians(130.0))


def _polynomial(function: Callable[[Array], Array], degree: int, low: float) -> tuple[float, ...]:
    """Coefficients of the polynomial through a function at the Chebyshev points of low to 1."""
    through = Chebyshev.interpolate(function, degree, [low, 1.0])
    return tuple(through.convert(kind=Polynomial).coef.tolist())


_TURN = _polynomial(lambda c: np.exp(-((np.degrees(np.arccos(c)) / 50.0) ** 2)), 12, _COS130)
"""exp(-(angle / 25 deg)^2)^(1/4) by the cosine; its fourth power errs by at most 4e-13."""
_SINE = _polynomial(lambda s: np.sin(np.pi / 3 * np.sqrt(s)) / np.sqrt(s), 5, 0.0)
"""Sin(60 deg x) / x by x^2; errs by at most 2e-13."""

_TWO52 = 4503599627370496.0
_TWO52_BITS = np.int64(0x4330000000000000)
_LOW32 = np.int64(0xFFFFFFFF)
_CUBE_MAGIC = 1430257664.0 - 62980.0  # 2^20 (1023 + 1023 / 3), less half the error of a chord
_ROOT_MAGIC = np.int64(0x5FE6EB50C7B537A9)

_OPTIONS = {"error_model": "numpy", "fastmath": {"contract"}}
_inlined = kernel(  # called by kernels only
    **_OPTIONS, no_cpython_wrapper=True, no_cfunc_wrapper=True, forceinline=True
)


@_inlined
@no_type_check
def _inverse_cube_root(x):
    """x^(-1/3) for a real part above 0: a guess from the exponent, two steps of high order."""
    high = np.float64(x.real).view(np.int64) >> np.int64(32)
    number = np.int64(high | _TWO52_BITS).view(np.float64) - _TWO52
    guess = np.float64(_CUBE_MAGIC - number * (1.0 / 3.0) + _TWO52).view(np.int64) & _LOW32
    r = np.int64(guess << np.int64(32)).view(np.float64)
    h = 1.0 - x * (r * r * r)
    s = r + r * (h * (1 / 3 + h * (2 / 9 + h * (14 / 81 + h * (35 / 243)))))
    h = 1.0 - x * (s * s * s)
    return s + s * (h * (1 / 3 + h * (2 / 9 + h * (14 / 81))))


@_inlined
@no_type_check
def _inverse_root(x):
    """x^(-1/2); where the real part is below 1e-290, that of 1e-290."""
    x = x if x.real > 1e-290 else x * 0.0 + 1e-290
    guess = np.int64(_ROOT_MAGIC - (np.float64(x.real).view(np.int64) >> np.int64(1)))
    r = guess.view(np.float64)
    h = 1.0 - x * (r * r)
    s = r + r * (h * (1 / 2 + h * (3 / 8 + h * (5 / 16 + h * (35 / 128)))))
    h = 1.0 - x * (s * s)
    return s + s * (h * (1 / 2 + h * (3 / 8)))


@_inlined
@no_type_check
def _share_of_25(chroma):
    """Square root of C^7 / (C^7 + 25^7)."""
    c = chroma * (1 / 25)
    seven = c * c * c
    seven = seven * seven * c
    return seven * _inverse_root(seven * seven + seven)


@_inlined
@no_type_check
def _sin_of_rotation(c):
    """Sin of the angle of rotation, for the cosine of the angle from 275 degrees above -0.64."""
    p = _TURN[12] * c + _TURN[11]
    p = (p * c + _TURN[10]) * c + _TURN[9]
    p = (p * c + _TURN[8]) * c + _TURN[7]
    p = (p * c + _TURN[6]) * c + _TURN[5]
    p = (p * c + _TURN[4]) * c + _TURN[3]
    p = (p * c + _TURN[2]) * c + _TURN[1]
    p = p * c + _TURN[0]
    p = p * p
    turn = p * p
    s = turn * turn
    p = (_SINE[5] * s + _SINE[4]) * s + _SINE[3]
    p = (p * s + _SINE[2]) * s + _SINE[1]
    return turn * (p * s + _SINE[0])


@_inlined
@no_type_check
def _ciede2000(l1, a1, b1, c1, l2, a2, b2):
    """CIEDE2000 of two colors; c1 is the chroma of the first.

    The mean hue is the direction of the bisector of the two hues, so no angle is needed.
    """
    stretch = 1.5 - 0.5 * _share_of_25(0.5 * (c1 + np.sqrt(a2 * a2 + b2 * b2)))
    x1, x2 = stretch * a1, stretch * a2
    squared1, squared2 = x1 * x1 + b1 * b1, x2 * x2 + b2 * b2
    i1, i2 = _inverse_root(squared1), _inverse_root(squared2)
    c1p, c2p = squared1 * i1, squared2 * i2
    ux, uy, vx, vy = x1 * i1, b1 * i1, x2 * i2, b2 * i2
    cross = ux * vy - uy * vx
    near = (ux * vx + uy * vy).real >= 0.0
    sign = 1.0 if cross.real >= 0.0 else -1.0
    mx = ux + vx if near else sign * (vy - uy)
    my = uy + vy if near else sign * (ux - vx)
    length2 = mx * mx + my * my
    scale = _inverse_root(length2)
    ch, sh = mx * scale, my * scale
    hue = 2.0 * np.sqrt(c1p * c2p) * ((cross if near else sign * 0.5 * length2) * scale)
    cosine2, sine2 = ch * ch - sh * sh, 2.0 * (ch * sh)
    cosine3, sine3 = cosine2 * ch - sine2 * sh, sine2 * ch + cosine2 * sh
    cosine4, sine4 = cosine2 * cosine2 - sine2 * sine2, 2.0 * (sine2 * cosine2)
    t = (
        1.0
        - 0.17 * (ch * _COS30 + sh * _SIN30)
        + 0.24 * cosine2
        + 0.32 * (cosine3 * _COS6 - sine3 * _SIN6)
        - 0.20 * (cosine4 * _COS63 + sine4 * _SIN63)
    )
    from_blue = ch * _COS275 + sh * _SIN275
    red = (sh * _COS275 - ch * _SIN275).real > 0.0
    turned = _sin_of_rotation(from_blue)
    turned = turned if from_blue.real > (_COS85 if red else _COS130) else turned * 0.0
    chroma = 0.5 * (c1p + c2p)
    rotation = -2.0 * _share_of_25(chroma) * turned
    lightness = 0.5 * (l1 + l2) - 50.0
    lightness = lightness * lightness
    root = np.sqrt(20.0 + lightness)
    weight_l, weight_c = root + 0.015 * lightness, 1.0 + 0.045 * chroma
    weight_h = 1.0 + 0.015 * chroma * t
    dl = (l2 - l1) * root * (weight_c * weight_h)
    dc = (c2p - c1p) * (weight_l * weight_h)
    dh = hue * (weight_l * weight_c)
    sum_ = dl * dl + dc * dc + dh * dh + rotation * (dc * dh)
    return np.sqrt(sum_ if sum_.real > 0.0 else sum_ * 0.0) / (weight_l * weight_c * weight_h)


@_inlined
@no_type_check
def _relative(t):
    """The cube root of CIELAB and its slope."""
    bright = t.real > _DELTA3
    r = _inverse_cube_root(t if bright else t * 0.0 + _DELTA3)
    r = r * r
    return (t * r if bright else (841 / 108) * t + 16 / 116), (1 / 3) * r


@kernel(**_OPTIONS)
@no_type_check
def cielab(share, lab, slope):
    """L*, a*, b* (3, k, m) of X, Y, Z relative to a white, and the slopes of the cube roots."""
    for i in range(share.shape[1]):
        for k in range(share.shape[2]):
            x, slope[0, i, k] = _relative(share[0, i, k])
            y, slope[1, i, k] = _relative(share[1, i, k])
            z, slope[2, i, k] = _relative(share[2, i, k])
            lab[0, i, k], lab[1, i, k], lab[2, i, k] = (
                116.0 * y - 16.0,
                500.0 * (x - y),
                200.0 * (y - z),
            )


@kernel(**_OPTIONS)
@no_type_check
def ciede2000(truth, lab, found):
    """CIEDE2000 (k, m) from true colors (k, 3) to those of candidates (3, k, m)."""
    for i in range(lab.shape[1]):
        l1, a1, b1 = truth[i, 0], truth[i, 1], truth[i, 2]
        c1 = np.sqrt(a1 * a1 + b1 * b1)
        for k in range(lab.shape[2]):
            found[i, k] = _ciede2000(l1, a1, b1, c1, lab[0, i, k], lab[1, i, k], lab[2, i, k])


@kernel(error_model="numpy", fastmath={"contract", "reassoc"})
@no_type_check
def weighted_gram(qe, weights, gram):
    """Inner products (p, p, m) of the curves (m, p, n) of each candidate."""
    for k in range(qe.shape[0]):
        for c in range(qe.shape[1]):
            for d in range(c + 1):
                total = qe[k, c, 0] * 0.0
                for i in range(qe.shape[2]):
                    total += weights[i] * qe[k, c, i] * qe[k, d, i]
                gram[c, d, k] = gram[d, c, k] = total


@kernel(**_OPTIONS)
@no_type_check
def inverse(gram, independence):
    """Each matrix (p, p, m) becomes its inverse, by elimination with a unit diagonal.

    ``independence`` is lowered to 1 over the largest variance inflation; 0 where there is none.
    """
    p = gram.shape[0]
    left = np.empty((p, p), gram.dtype)
    scale = np.empty(p, gram.dtype)
    for k in range(gram.shape[2]):
        least = independence[k]
        for c in range(p):
            scale[c] = 1.0 / np.sqrt(gram[c, c, k])
        for c in range(p):
            for d in range(p):
                left[c, d] = gram[c, d, k] * scale[c] * scale[d]
        for c in range(p):
            least = least if left[c, c].real > 0.0 else 0.0
            pivot = 1.0 / left[c, c]
            left[c, c] = 1.0
            for d in range(p):
                left[c, d] *= pivot
            for b in range(p):
                factor = left[b, c]
                if b != c:
                    left[b, c] = 0.0
                    for d in range(p):
                        left[b, d] -= factor * left[c, d]
        for c in range(p):
            least = min(least, 1.0 / left[c, c].real)
            for d in range(p):
                gram[c, d, k] = left[c, d] * scale[c] * scale[d]
        independence[k] = least if least > 0.0 else 0.0
