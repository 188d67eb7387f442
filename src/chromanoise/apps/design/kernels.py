# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""The fast objectives of a batch, compiled: blocks of `LANES` candidates, one per SIMD lane.

Functions without annotations are compiled, serial, and release the GIL; threads take ranges of
blocks. Each lane adds in the same order whatever its block, so the results are bit-identical for
any batch and number of threads.

The same source is compiled for complex numbers, of which the imaginary part is a derivative: the
complex step of Squire & Trapp, SIAM Rev. 40 (1998) 110. So every function is analytic, and
comparisons read the real part. Transcendental functions are polynomials, which the compiler can
vectorize.

Scratch arrays end in the axis of lanes: electrons (r, p, LANES + 8), and matrices (3, p, LANES).
"""

from collections.abc import Callable
from typing import no_type_check

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

from chromanoise.apps.design.objectives import FAST, SNR10
from chromanoise.base import Array
from chromanoise.imaging import kernel

LANES = 32
TOGETHER = 8
"""Number of wavelengths that are added together."""
_APART = 8  # unused lanes, so that what one lane reads or writes spreads over all sets of the cache

COLUMNS = (*FAST, "independence")
_SNR_Y, _NOISE, _TOTAL, _DELTA_E, _CIEDE2000, _VORA, _LUX = range(7)
_LEAST, _MEAN, _INFRARED, _FULLNESS, _INDEPENDENCE = range(7, 12)

GROUPS = ("infrared", "chart", "paired", "training", "axes", "orthonormal")
(_AT_INFRARED, _AT_CHART, _AT_PAIRED, _AT_TRAINING, _AT_AXES, _AT_EYE, _AT_END) = range(7)

KERNEL, NOISE_WEIGHTED, RIDGE, GIVEN = range(4)

_GRAY = 0.18
_LEAST_COLOR = 1e-6
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
_WITHIN = {"no_cpython_wrapper": True}  # called by kernels only
_compiled = kernel(**_OPTIONS, **_WITHIN)
_inlined = kernel(**_OPTIONS, **_WITHIN, forceinline=True)


@_inlined
@no_type_check
def _divisor(x):
    """The number, NaN for 0: a division of complex numbers by 0 would end the kernel."""
    return x if x.real != 0.0 else x + np.nan


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


@_compiled
@no_type_check
def _add_rows(rows, first, q, e):
    """Add eight wavelengths of all rows to the electrons."""
    count, p = e.shape[0], e.shape[1]
    even = count - count % 2
    for r in range(0, even, 2):
        a0, a1, a2, a3 = rows[r, first], rows[r, first + 1], rows[r, first + 2], rows[r, first + 3]
        a4, a5 = rows[r, first + 4], rows[r, first + 5]
        a6, a7 = rows[r, first + 6], rows[r, first + 7]
        b0, b1 = rows[r + 1, first], rows[r + 1, first + 1]
        b2, b3 = rows[r + 1, first + 2], rows[r + 1, first + 3]
        b4, b5 = rows[r + 1, first + 4], rows[r + 1, first + 5]
        b6, b7 = rows[r + 1, first + 6], rows[r + 1, first + 7]
        for c in range(p):
            for k in range(LANES):
                q0, q1, q2, q3 = q[c, 0, k], q[c, 1, k], q[c, 2, k], q[c, 3, k]
                q4, q5, q6, q7 = q[c, 4, k], q[c, 5, k], q[c, 6, k], q[c, 7, k]
                s = e[r, c, k] + a0 * q0 + a1 * q1 + a2 * q2 + a3 * q3
                e[r, c, k] = s + a4 * q4 + a5 * q5 + a6 * q6 + a7 * q7
                t = e[r + 1, c, k] + b0 * q0 + b1 * q1 + b2 * q2 + b3 * q3
                e[r + 1, c, k] = t + b4 * q4 + b5 * q5 + b6 * q6 + b7 * q7
    for r in range(even, count):
        a0, a1, a2, a3 = rows[r, first], rows[r, first + 1], rows[r, first + 2], rows[r, first + 3]
        a4, a5 = rows[r, first + 4], rows[r, first + 5]
        a6, a7 = rows[r, first + 6], rows[r, first + 7]
        for c in range(p):
            for k in range(LANES):
                s = e[r, c, k] + a0 * q[c, 0, k] + a1 * q[c, 1, k] + a2 * q[c, 2, k]
                s = s + a3 * q[c, 3, k] + a4 * q[c, 4, k] + a5 * q[c, 5, k]
                e[r, c, k] = s + a6 * q[c, 6, k] + a7 * q[c, 7, k]


@_compiled
@no_type_check
def _add_gram(squared, first, q, g):
    """Add eight wavelengths to F^T F, its lower half."""
    p = g.shape[0]
    w0, w1, w2, w3 = squared[first], squared[first + 1], squared[first + 2], squared[first + 3]
    w4, w5, w6 = squared[first + 4], squared[first + 5], squared[first + 6]
    w7 = squared[first + 7]
    for c in range(p):
        for d in range(c + 1):
            for k in range(LANES):
                s = g[c, d, k] + w0 * (q[c, 0, k] * q[d, 0, k]) + w1 * (q[c, 1, k] * q[d, 1, k])
                s = s + w2 * (q[c, 2, k] * q[d, 2, k]) + w3 * (q[c, 3, k] * q[d, 3, k])
                s = s + w4 * (q[c, 4, k] * q[d, 4, k]) + w5 * (q[c, 5, k] * q[d, 5, k])
                g[c, d, k] = s + w6 * (q[c, 6, k] * q[d, 6, k]) + w7 * (q[c, 7, k] * q[d, 7, k])


@_compiled
@no_type_check
def _electrons(qe, block, gain, rows, squared, has_gram, q, e, g):
    """Electrons of all rows and F^T F of a block of curves qe (m, p, n)."""
    m, p, n = qe.shape
    e[:] = 0.0
    g[:] = 0.0
    for k in range(LANES):
        one = min(block + k, m - 1)
        factor = gain[one]
        for c in range(p):
            for i in range(n):
                q[i // TOGETHER, c, i % TOGETHER, k] = qe[one, c, i] * factor
    for part in range(q.shape[0]):
        _add_rows(rows, part * TOGETHER, q[part], e)
        if has_gram:
            _add_gram(squared, part * TOGETHER, q[part], g)


@_compiled
@no_type_check
def _electrons_of_choices(choices, block, gain, table, gram, has_gram, e, g):
    """The same for filters of a library: choices (m, p), table (filters, r), gram (f, f)."""
    m, p = choices.shape
    count = e.shape[0]
    for k in range(LANES):
        one = min(block + k, m - 1)
        factor = gain[one]
        for c in range(p):
            own = choices[one, c]
            for r in range(count):
                e[r, c, k] = table[own, r] * factor
            if has_gram:
                for d in range(c + 1):
                    g[c, d, k] = gram[own, choices[one, d]] * (factor * factor)


@_compiled
@no_type_check
def _training_gram(e, at, xyz, g, x):
    """Sums over the training set: E[M M^T], lower half, and E[XYZ M^T]."""
    p = g.shape[0]
    g[:] = 0.0
    x[:] = 0.0
    for t in range(xyz.shape[0]):
        r = at + t
        for c in range(p):
            for d in range(c + 1):
                for k in range(LANES):
                    g[c, d, k] += e[r, c, k] * e[r, d, k]
            for j in range(3):
                weight = xyz[t, j]
                for k in range(LANES):
                    x[j, c, k] += weight * e[r, c, k]


@_compiled
@no_type_check
def _factored(g, lower, scale, line, independence):
    """Cholesky factor of the Gram matrix scaled to a unit diagonal, and 1 over the largest VIF."""
    p = g.shape[0]
    for c in range(p):
        for k in range(LANES):
            scale[c, k] = 1.0 / np.sqrt(_divisor(g[c, c, k]))
    for k in range(LANES):
        independence[k] = 1.0
    for c in range(p):
        for d in range(c + 1):
            for k in range(LANES):
                lower[c, d, k] = g[c, d, k] * scale[c, k] * scale[d, k]
            for b in range(d):
                for k in range(LANES):
                    lower[c, d, k] -= lower[c, b, k] * lower[d, b, k]
            if d < c:
                for k in range(LANES):
                    lower[c, d, k] *= lower[d, d, k]  # the diagonal holds reciprocals
            else:
                for k in range(LANES):
                    s = lower[c, c, k]
                    independence[k] = independence[k] if s.real > 0.0 else 0.0
                    lower[c, c, k] = 1.0 / np.sqrt(s if s.real > 0.0 else s * 0.0 + 1.0)
    for c in range(p):
        for k in range(LANES):
            line[c, k] = lower[c, c, k]
        for d in range(c + 1, p):
            for k in range(LANES):
                line[d, k] = 0.0
            for b in range(c, d):
                for k in range(LANES):
                    line[d, k] -= lower[d, b, k] * line[b, k]
            for k in range(LANES):
                line[d, k] *= lower[d, d, k]
        for k in range(LANES):
            vif = line[c, k] * line[c, k]
            for d in range(c + 1, p):
                vif += line[d, k] * line[d, k]
            share = 1.0 / vif.real
            independence[k] = independence[k] if share > independence[k] else share


@_compiled
@no_type_check
def _solved(lower, scale, x, matrix):
    """The rows of X G^-1."""
    p = scale.shape[0]
    for j in range(x.shape[0]):
        for c in range(p):
            for k in range(LANES):
                matrix[j, c, k] = x[j, c, k] * scale[c, k]
            for d in range(c):
                for k in range(LANES):
                    matrix[j, c, k] -= lower[c, d, k] * matrix[j, d, k]
            for k in range(LANES):
                matrix[j, c, k] *= lower[c, c, k]
        for c in range(p - 1, -1, -1):
            for d in range(c + 1, p):
                for k in range(LANES):
                    matrix[j, c, k] -= lower[d, c, k] * matrix[j, d, k]
            for k in range(LANES):
                matrix[j, c, k] *= lower[c, c, k]
        for c in range(p):
            for k in range(LANES):
                matrix[j, c, k] *= scale[c, k]


@_compiled
@no_type_check
def _vora_value(lower, scale, e, at, scratch, value):
    """The share of an orthonormal basis of the observer in the span of the channels."""
    p = scale.shape[0]
    for k in range(LANES):
        value[k] = 0.0
    for j in range(3):
        for c in range(p):
            for k in range(LANES):
                scratch[c, k] = e[at + j, c, k] * scale[c, k]
            for d in range(c):
                for k in range(LANES):
                    scratch[c, k] -= lower[c, d, k] * scratch[d, k]
            for k in range(LANES):
                scratch[c, k] *= lower[c, c, k]
                value[k] += scratch[c, k] * scratch[c, k] * (1 / 3)


@no_type_check
def variance_of(law, k, mean, squared):
    """Variance by the rows floor, slope and square of a law, at a mean and a mean square."""
    return law[0, k] + law[1, k] * mean + law[2, k] * squared


_variance = _inlined(variance_of)


@_compiled
@no_type_check
def _penalized(e, at, method, strength, weight, law, spread, g):
    """Add the penalty to the diagonal of E[M M^T]: the mean noise, or that of ridge."""
    p = g.shape[0]
    if method == RIDGE:
        for k in range(LANES):
            total = g[0, 0, k] * 0.0
            for c in range(p):
                total += g[c, c, k]
            for c in range(p):
                g[c, c, k] += strength / p * total
        return
    for c in range(p):
        for k in range(LANES):
            noise = _variance(law, k, e[at, c, k], g[c, c, k])
            g[c, c, k] += weight[k] * (noise * spread[c, k])


@_compiled
@no_type_check
def _luminance_snr(e, matrix, law, spread, least, value):
    """Squared SNR of Y of a perfect white; NaN where Y is no signal."""
    p = e.shape[1]
    for k in range(LANES):
        y = e[0, 0, k] * 0.0
        variance = e[0, 0, k] * 0.0
        for c in range(p):
            mean = e[0, c, k]
            own = _variance(law, k, mean, mean * mean)
            weight = matrix[1, c, k]
            y += weight * mean
            variance += weight * weight * (own * spread[c, k])
        value[k] = y * y / _divisor(variance) if y.real > least else y * np.nan


@_compiled
@no_type_check
def _lux_of_snr10(e, matrix, law, spread, full, level_lux, value):
    """SNR10 of Y of a gray, from a quadratic equation; NaN where a channel saturates first."""
    p = e.shape[1]
    for k in range(LANES):
        seen = e[0, 0, k] * 0.0
        shot, spatial, total, most = seen, seen, seen, seen
        for c in range(p):
            per_lux = e[0, c, k] * (_GRAY / level_lux)
            weight = matrix[1, c, k]
            squared = weight * weight * spread[c, k]
            seen += weight * per_lux
            shot += squared * per_lux
            spatial += squared * per_lux * per_lux
            total += squared
            most = per_lux if per_lux.real > most.real else most
        gain = seen * seen - SNR10 * SNR10 * law[2, k] * spatial
        shot = SNR10 * SNR10 * law[1, k] * shot
        root = np.sqrt(shot * shot + 4.0 * gain * (SNR10 * SNR10 * law[0, k] * total))
        lux = (shot + root) / (2.0 * _divisor(gain))
        good = seen.real > 0.0 and gain.real > 0.0 and (lux * most).real <= full[k].real
        value[k] = lux if good else lux * np.nan


@_inlined
@no_type_check
def _relative(t):
    """The cube root of CIELAB and its slope."""
    bright = t.real > _DELTA3
    r = _inverse_cube_root(t if bright else t * 0.0 + _DELTA3)
    r = r * r
    return (t * r if bright else (841 / 108) * t + 16 / 116), (1 / 3) * r


@_compiled
@no_type_check
def _chart_of(e, row, matrix, shift, inverse, lab, slope):
    """L*, a*, b* of one patch relative to the white, and the slopes of the cube roots."""
    p = e.shape[1]
    for j in range(3):
        if p < 4:
            for k in range(LANES):
                lab[j, k] = shift[j, k] + matrix[j, 0, k] * e[row, 0, k]
        else:
            for k in range(LANES):
                s = shift[j, k] + matrix[j, 0, k] * e[row, 0, k] + matrix[j, 1, k] * e[row, 1, k]
                lab[j, k] = s + matrix[j, 2, k] * e[row, 2, k] + matrix[j, 3, k] * e[row, 3, k]
        for c in range(1 if p < 4 else 4, p):
            for k in range(LANES):
                lab[j, k] += matrix[j, c, k] * e[row, c, k]
    for k in range(LANES):
        x, slope_x = _relative(lab[0, k] * inverse[0, k])
        y, slope_y = _relative(lab[1, k] * inverse[1, k])
        z, slope_z = _relative(lab[2, k] * inverse[2, k])
        lab[0, k], lab[1, k], lab[2, k] = 116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)
        slope[0, k], slope[1, k] = slope_x * inverse[0, k], slope_y * inverse[1, k]
        slope[2, k] = slope_z * inverse[2, k]


@_compiled
@no_type_check
def _add_noise_of(e, row, matrix, slope, law, spread, noise):
    """Add the trace of J S J^T of one patch."""
    p = e.shape[1]
    for c in range(p):
        for k in range(LANES):
            mean = e[row, c, k]
            own = _variance(law, k, mean, mean * mean) * spread[c, k]
            x, y, z = (
                slope[0, k] * matrix[0, c, k],
                slope[1, k] * matrix[1, c, k],
                slope[2, k] * matrix[2, c, k],
            )
            lightness, a, b = 116.0 * y, 500.0 * (x - y), 200.0 * (y - z)
            noise[k] += own * (lightness * lightness + a * a + b * b)


@_compiled
@no_type_check
def _chart_errors(e, at, matrix, truth, black_e, law, spread, wanted, scratch, out, block):
    """All objectives of the chart; NaN where the white has no color."""
    p, many = e.shape[1], truth.shape[0]
    shift, inverse, lab, slope = scratch[0:3], scratch[3:6], scratch[6:9], scratch[9:12]
    noise, total, delta, newer = scratch[12], scratch[13], scratch[14], scratch[15]
    good = scratch[16]
    noisy, clean = wanted[_NOISE] or wanted[_TOTAL], wanted[_DELTA_E] or wanted[_CIEDE2000]
    for k in range(LANES):
        good[k] = 1.0
        noise[k], total[k], delta[k], newer[k] = 0.0, 0.0, 0.0, 0.0
    for j in range(3):
        for k in range(LANES):
            white = e[0, 0, k] * matrix[j, 0, k]
            for c in range(1, p):
                white += e[0, c, k] * matrix[j, c, k]
            good[k] = good[k] if white.real > 0.0 else 0.0
            inverse[j, k] = 1.0 / _divisor(white)
            shift[j, k] = 0.0
    for i in range(many):
        l1, a1, b1, c1 = truth[i, 0], truth[i, 1], truth[i, 2], truth[i, 3]
        if clean or (noisy and black_e == 0.0):
            for j in range(3):
                for k in range(LANES):
                    shift[j, k] = 0.0
            _chart_of(e, at + i, matrix, shift, inverse, lab, slope)
        if wanted[_DELTA_E]:
            for k in range(LANES):
                dl, da, db = lab[0, k] - l1, lab[1, k] - a1, lab[2, k] - b1
                delta[k] += np.sqrt(dl * dl + da * da + db * db)
        if wanted[_CIEDE2000]:
            for k in range(LANES):
                newer[k] += _ciede2000(l1, a1, b1, c1, lab[0, k], lab[1, k], lab[2, k])
        if noisy:
            if black_e != 0.0:
                for j in range(3):
                    for k in range(LANES):
                        shift[j, k] = 0.0
                        for c in range(p):
                            shift[j, k] += black_e * matrix[j, c, k]
                _chart_of(e, at + i, matrix, shift, inverse, lab, slope)
            _add_noise_of(e, at + i, matrix, slope, law, spread, noise)
            if wanted[_TOTAL]:
                for k in range(LANES):
                    dl, da, db = lab[0, k] - l1, lab[1, k] - a1, lab[2, k] - b1
                    total[k] += dl * dl + da * da + db * db
    for k in range(LANES):
        hidden = 0.0 if good[k].real > 0.0 else np.nan
        _put(out, block, k, _NOISE, np.sqrt(noise[k] / many) + hidden)
        _put(out, block, k, _TOTAL, np.sqrt((noise[k] + total[k]) / many) + hidden)
        _put(out, block, k, _DELTA_E, delta[k] / many + hidden)
        _put(out, block, k, _CIEDE2000, newer[k] / many + hidden)


@_inlined
@no_type_check
def _put(out, block, k, column, value):
    if block + k < out.shape[1]:
        out[column, block + k] = value


@_compiled
@no_type_check
def _put_all(out, block, column, value):
    for k in range(min(LANES, out.shape[1] - block)):
        out[column, block + k] = value[k]


@_compiled
@no_type_check
def _separations(e, at, many, pairs, law, spread, full, wanted, variance, scratch):
    """Least and mean D_M of the pairs; NaN where a patch saturates a channel."""
    p = e.shape[1]
    least, mean, squared = scratch[0], scratch[1], scratch[2]
    for k in range(LANES):
        least[k], mean[k] = np.inf, 0.0
    for i in range(many):
        for c in range(p):
            for k in range(LANES):
                electrons = e[at + i, c, k]
                own = _variance(law, k, electrons, electrons * electrons)
                variance[i, c, k] = own * (0.5 * spread[c, k])
    for i in range(pairs.shape[0]):
        one, other = pairs[i, 0], pairs[i, 1]
        for k in range(LANES):
            squared[k] = 0.0
        for c in range(p):
            for k in range(LANES):
                apart = e[at + one, c, k] - e[at + other, c, k]
                noise = variance[one, c, k] + variance[other, c, k]
                apart = apart * apart
                endless = apart * 0.0 + (np.inf if apart.real > 0.0 else 0.0)
                squared[k] += apart / noise if noise.real > 0.0 else endless
        for k in range(LANES):
            least[k] = squared[k] if squared[k].real < least[k].real else least[k]
        if wanted[_MEAN]:
            for k in range(LANES):
                mean[k] += np.sqrt(squared[k])
    for k in range(LANES):
        least[k] = np.sqrt(least[k])
        mean[k] = mean[k] / pairs.shape[0]
        for c in range(p):
            hidden = 0.0
            for i in range(many):
                hidden = hidden if e[at + i, c, k].real <= full[k].real else np.nan
            least[k] += hidden
            mean[k] += hidden


@kernel(**_OPTIONS)
@no_type_check
def evaluate(
    start,
    stop,
    qe,
    choices,
    gain,
    law,
    full,
    weight,
    spread,
    rows,
    squared,
    table,
    gram,
    layout,
    pairs,
    training_xyz,
    truth,
    method,
    constants,
    wanted,
    matrices,
    out,
):
    """The objectives of the candidates of the blocks ``start`` to ``stop``.

    Parameters
    ----------
    qe, choices
        Curves (m, p, n); or indices (m, p) of filters of a library where ``qe`` is empty.
    gain, full, weight
        Per candidate: factor on all electrons, white level [e-], weight of the noise in the matrix.
    law
        Floor [e-^2], slope [e-] and square [1] of `chromanoise.sensor.VarianceLaw` (3, m).
    spread
        Factor on the variance of each channel (m, p).
    rows, squared
        Electrons per wavelength of the rows (r, n), and the squared measurement vector of QE 1;
        zeros follow up to a multiple of `TOGETHER`.
    table, gram
        For a library: electrons (filters, r) and inner products (filters, filters).
    layout
        First row of each of `GROUPS`, -1 for none, and the number of rows.
    pairs
        Indices of the two patches of each pair.
    training_xyz
        X, Y, Z of the training rows (t, 3).
    truth
        L*, a*, b* and chroma of the chart for the observer (k, 4).
    method
        `KERNEL`, `NOISE_WEIGHTED`, `RIDGE`, or `GIVEN` for those of ``matrices``.
    constants
        Strength of ridge, Y of the white [lx], error of the black level [e-], illuminance [lx].
    wanted
        Whether each column of `FAST` is computed.
    matrices
        Color matrices (m, 3, p); none for the other methods.
    out
        One row per entry of `COLUMNS`, of which the unwanted ones are not written; NaN where a
        value is not defined. The SNR is squared.
    """
    of_library = qe.shape[0] == 0
    m = out.shape[1]
    p = spread.shape[1]
    count = layout[_AT_END]
    q = np.zeros((rows.shape[1] // TOGETHER, p, TOGETHER, LANES + _APART), qe.dtype)
    e = np.zeros((count, p, LANES + _APART), qe.dtype)
    g = np.zeros((p, p, LANES), qe.dtype)
    lower = np.zeros((p, p, LANES), qe.dtype)
    trained = np.zeros((p, p, LANES), qe.dtype)
    scale = np.zeros((p, LANES), qe.dtype)
    line = np.zeros((p, LANES), qe.dtype)
    x = np.zeros((3, p, LANES), qe.dtype)
    matrix = np.zeros((3, p, LANES), qe.dtype)
    apart = np.zeros((p, LANES), qe.dtype)
    own = np.zeros((2, LANES), qe.dtype)
    noise = np.zeros((3, LANES), qe.dtype)
    scratch = np.zeros((17, LANES), qe.dtype)
    value = np.zeros(LANES, qe.dtype)
    of_channels, of_training = np.ones(LANES), np.ones(LANES)
    at_patches = layout[_AT_PAIRED] if layout[_AT_PAIRED] >= 0 else layout[_AT_CHART]
    many = 0
    for i in range(pairs.shape[0]):
        many = max(many, pairs[i, 0] + 1, pairs[i, 1] + 1)
    variance = np.zeros((many, p, LANES), qe.dtype)
    strength, white_y, black_e, level_lux = constants[0], constants[1], constants[2], constants[3]
    has_gram = wanted[_VORA] or method == KERNEL
    for block in range(start * LANES, min(stop * LANES, m), LANES):
        for k in range(LANES):
            i = min(block + k, m - 1)
            own[0, k], own[1, k] = full[i], weight[i]
            for j in range(3):
                noise[j, k] = law[j, i]
            for c in range(p):
                apart[c, k] = spread[i, c]
            of_channels[k], of_training[k] = 1.0, 1.0
        if of_library:
            _electrons_of_choices(choices, block, gain, table, gram, has_gram, e, g)
        else:
            _electrons(qe, block, gain, rows, squared, has_gram, q, e, g)
        if has_gram:
            _factored(g, lower, scale, line, of_channels)
        if wanted[_VORA]:
            _vora_value(lower, scale, e, layout[_AT_EYE], line, value)
            _put_all(out, block, _VORA, value)
        if method == KERNEL:
            at = layout[_AT_AXES]
            _solved(lower, scale, e[at : at + 3], matrix)
        elif method == GIVEN:
            for k in range(LANES):
                i = min(block + k, m - 1)
                for j in range(3):
                    for c in range(p):
                        matrix[j, c, k] = matrices[i, j, c]
        else:
            at = layout[_AT_TRAINING]
            mean = at + training_xyz.shape[0]
            _training_gram(e, at, training_xyz, trained, x)
            _penalized(e, mean, method, strength, own[1], noise, apart, trained)
            _factored(trained, lower, scale, line, of_training)
            _solved(lower, scale, x, matrix)
        for k in range(LANES):
            fullest = e[0, 0, k]
            infrared = e[0, 0, k] * 0.0 - 1.0
            for c in range(p):
                fullest = e[0, c, k] if e[0, c, k].real > fullest.real else fullest
                if wanted[_INFRARED]:
                    share = e[layout[_AT_INFRARED], c, k] / _divisor(e[0, c, k])
                    infrared = infrared if share.real <= infrared.real else share
            _put(out, block, k, _FULLNESS, fullest / own[0, k])
            _put(out, block, k, _INFRARED, infrared)
            least = of_training[k] if of_training[k] < of_channels[k] else of_channels[k]
            _put(out, block, k, _INDEPENDENCE, least if least > 0.0 else 0.0)
        if wanted[_SNR_Y]:
            _luminance_snr(e, matrix, noise, apart, _LEAST_COLOR * white_y, value)
            _put_all(out, block, _SNR_Y, value)
        if wanted[_LUX]:
            _lux_of_snr10(e, matrix, noise, apart, own[0], level_lux, value)
            _put_all(out, block, _LUX, value)
        if wanted[_NOISE] or wanted[_TOTAL] or wanted[_DELTA_E] or wanted[_CIEDE2000]:
            _chart_errors(
                e, layout[_AT_CHART], matrix, truth, black_e, noise, apart, wanted, scratch, out,
                block,
            )  # fmt: skip
        if wanted[_LEAST] or wanted[_MEAN]:
            _separations(
                e, at_patches, many, pairs, noise, apart, own[0], wanted, variance, scratch
            )
            _put_all(out, block, _LEAST, scratch[0])
            _put_all(out, block, _MEAN, scratch[1])


@kernel(**_OPTIONS)
@no_type_check
def add_slopes(pairs, of_apart, of_noise, electrons, noise, slope):
    """Add the derivatives of the D_M of pairs of patches to ``slope`` (m, pairs, d).

    Parameters
    ----------
    of_apart, of_noise
        Derivatives of D_M with respect to difference and variance of each pair (m, p, pairs).
    electrons, noise
        Derivatives of the electrons and of their variance (m, p, patches, d).
    """
    for i in range(slope.shape[0]):
        for j in range(pairs.shape[0]):
            one, other = pairs[j, 0], pairs[j, 1]
            for c in range(of_apart.shape[1]):
                difference, variance = of_apart[i, c, j], of_noise[i, c, j]
                for k in range(slope.shape[2]):
                    slope[i, j, k] += difference * (
                        electrons[i, c, one, k] - electrons[i, c, other, k]
                    ) + variance * (noise[i, c, one, k] + noise[i, c, other, k])
