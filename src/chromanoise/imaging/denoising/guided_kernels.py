# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Local linear estimates of planes in square windows.

Functions without annotations are compiled, serial, and release the GIL. Windows have their centers
at even rows and columns. Every sum is taken anew for each window, in the same order whatever the
strip, so no rounding comes from pixels outside the window. All new arrays have three axes, because
`np.empty` is compiled anew for each number of axes.
"""

from functools import partial
from typing import no_type_check

import numpy as np

from chromanoise.imaging.denoising.guided_plain import LEAST_E2, LEAST_VARIANCE
from chromanoise.imaging.kernel_cache import inner, kernel

_LANES = 32
_F = np.float32
_ZERO, _ONE, _TWO, _FOUR = _F(0.0), _F(1.0), _F(2.0), _F(4.0)
_TINY = _F(1e-30)
_FASTMATH = {"contract"}
_compiled = kernel(error_model="numpy", fastmath=_FASTMATH)
_within = partial(inner, fastmath=_FASTMATH)


@_compiled
@no_type_check
def add_estimates(values, noise, row_share, column_share, radius, edge, estimate, weight, active):
    """Add to each pixel the weighted estimates of the windows of one size that hold it.

    values (p, h, w); noise (3, p): floor, slope and square of `VarianceLaw`; row_share (h,) and
    column_share (w,): the variance of a pixel is that of the noise times both; edge: least power of
    a component that is kept whole, over the largest of pure noise; estimate (p, h, w) and weight
    (h, w): sums; active (h, w) becomes the mean over the windows of the largest gain.
    """
    p, h, w = values.shape
    rows, columns, count = (h + 1) // 2, (w + 1) // 2, p * p + p + 2
    held = radius + 2
    ring = np.empty((held, count, columns), np.float32)
    done = 0
    for y in range(h):
        top, bottom = max(0, (y - radius + 1) // 2), min(rows, (y + radius) // 2 + 1)
        while done < bottom:
            first, last = max(0, 2 * done - radius), min(h, 2 * done + radius + 1)
            share = _mean(row_share, first, last)
            _window_row(
                values[:, first:last], noise, share, column_share, radius, edge, ring[done % held]
            )
            done += 1
        _add_row(ring, top, bottom, radius, values[:, y], estimate[:, y], weight[y], active[y])


@_within
@no_type_check
def _window_row(values, noise, row_share, column_share, radius, edge, out):
    """The linear estimates of one row of windows.

    values (p, rows of the windows, w); out (p * p + p + 2, columns): of each window the matrix and
    the constant times its weight, its weight, and its largest gain.
    """
    p, h, w = values.shape
    count, columns = out.shape
    pairs = p + p * (p + 1) // 2
    sums = np.empty((1, pairs, 2 * _LANES + 2 * radius))[0]
    moments = np.empty((1, pairs, _LANES))[0]
    share = np.empty((1, 1, _LANES))[0, 0]
    number = np.empty((1, 1, _LANES), np.float32)[0, 0]
    mean = np.empty((1, p, _LANES), np.float32)[0]
    unit = np.empty((1, p, _LANES), np.float32)[0]
    power = np.empty((p, p, _LANES), np.float32)
    basis = np.empty((p, p, _LANES), np.float32)
    some = np.empty((1, count, _LANES), np.float32)[0]
    for first in range(0, columns, _LANES):
        start = 2 * first - radius
        left, right = max(0, start), min(w, start + 2 * _LANES + 2 * radius)
        _column_sums(values[:, :, left:right], sums, left - start)
        for lane in range(_LANES):
            x = 2 * (first + lane)
            near, end = min(w - 1, max(0, x - radius)), min(w, x + radius + 1)
            number[lane] = (end - near) * h
            share[lane] = row_share * _mean(column_share, near, end)
        for k in range(pairs):
            moments[k] = 0.0
            for i in range(2 * radius + 1):
                for lane in range(_LANES):
                    moments[k, lane] += sums[k, 2 * lane + i]
            for lane in range(_LANES):
                moments[k, lane] /= np.float64(number[lane])
        _whitened(moments, number, noise, share, mean, unit, power)
        _diagonalized(power, basis)
        _shrunk(power, basis, number, mean, unit, edge, some)
        lanes = min(_LANES, columns - first)
        for k in range(count):
            for lane in range(lanes):
                out[k, first + lane] = some[k, lane]


@_within
@no_type_check
def _mean(values, start, stop):
    total = 0.0
    for i in range(start, stop):
        total += values[i]
    return total / (stop - start)


@_within
@no_type_check
def _column_sums(values, sums, skipped):
    """Of each column, the sums of the planes and of their products; 0 outside the picture."""
    p, h, w = values.shape
    sums[:] = 0.0
    for y in range(h):
        k = p
        for a in range(p):
            for x in range(w):
                sums[a, skipped + x] += values[a, y, x]
            for b in range(a + 1):
                for x in range(w):
                    u, v = np.float64(values[a, y, x]), np.float64(values[b, y, x])
                    sums[k, skipped + x] += u * v
                k += 1


@_within
@no_type_check
def _whitened(moments, number, noise, share, mean, unit, power):
    """Means, standard deviations of the noise, and the covariance in their unit."""
    p = mean.shape[0]
    k = p
    for a in range(p):
        square = k + a
        for lane in range(_LANES):
            m = moments[a, lane]
            light = max(m, 0.0)
            variance = noise[0, a] + light * (noise[1, a] + light * noise[2, a])
            variance *= share[lane]
            variance = max(variance, LEAST_VARIANCE * moments[square, lane]) + LEAST_E2
            mean[a, lane] = m
            unit[a, lane] = np.sqrt(variance)
        for b in range(a + 1):
            for lane in range(_LANES):
                n = np.float64(number[lane])
                c = (moments[k, lane] - moments[a, lane] * moments[b, lane]) * n / max(n - 1.0, 1.0)
                c /= np.float64(unit[a, lane]) * np.float64(unit[b, lane])
                power[a, b, lane] = c
                power[b, a, lane] = c
            k += 1


@_within
@no_type_check
def _diagonalized(a, basis):
    """Jacobi's rotations, of every lane at once: a becomes diagonal, basis its eigenvectors.

    Golub & Van Loan, Matrix Computations, section 8.5. A fixed number of sweeps: where the last one
    leaves a small off-diagonal entry, the basis is still orthonormal.
    """
    p = a.shape[0]
    basis[:] = _ZERO
    for i in range(p):
        basis[i, i] = _ONE
    cosine = np.empty((1, 1, _LANES), np.float32)[0, 0]
    sine = np.empty((1, 1, _LANES), np.float32)[0, 0]
    for _ in range(3 if p < 4 else 4 if p < 6 else 6):
        for i in range(p - 1):
            for j in range(i + 1, p):
                for lane in range(_LANES):
                    twice = _TWO * a[i, j, lane]
                    apart = a[j, j, lane] - a[i, i, lane]
                    root = np.sqrt(apart * apart + twice * twice)
                    t = twice / (abs(apart) + root + _TINY)
                    t = t if apart >= _ZERO else -t
                    c = _ONE / np.sqrt(_ONE + t * t)
                    s = t * c
                    cosine[lane], sine[lane] = c, s
                    change = t * a[i, j, lane]
                    a[i, i, lane] -= change
                    a[j, j, lane] += change
                    a[i, j, lane] = _ZERO
                for k in range(p):
                    if k != i and k != j:
                        _rotated(a[min(k, i), max(k, i)], a[min(k, j), max(k, j)], cosine, sine)
                    _rotated(basis[i, k], basis[j, k], cosine, sine)


@_within
@no_type_check
def _rotated(x, y, cosine, sine):
    for lane in range(_LANES):
        u, v = x[lane], y[lane]
        x[lane] = cosine[lane] * u - sine[lane] * v
        y[lane] = sine[lane] * u + cosine[lane] * v


@_within
@no_type_check
def _shrunk(power, basis, number, mean, unit, edge, out):
    """The estimate from the power of each component, as `_window_row` stores it."""
    p = mean.shape[0]
    gain = np.empty((1, p, _LANES), np.float32)[0]
    weight, active = out[p * p + p], out[p * p + p + 1]
    active[:] = _ZERO
    for lane in range(_LANES):
        weight[lane] = _F(p) / number[lane]
    for i in range(p):
        for lane in range(_LANES):
            ratio = _F(p) / number[lane]
            found = power[i, i, lane]
            # the largest power of noise alone (Marchenko & Pastur), and the signal's power below
            # what was found (Baik & Silverstein, J. Multivar. Anal. 97 (2006) 1382)
            root = _ONE + np.sqrt(ratio)
            most = root * root
            middle = found + _ONE - ratio
            root = np.sqrt(max(middle * middle - _FOUR * found, _ZERO))
            signal = max((middle + root) / _TWO - _ONE, _ZERO)
            kept = min(max((found / most - _ONE) / (edge - _ONE), _ZERO), _ONE)
            f = kept * signal / (signal + _ONE)
            gain[i, lane] = f
            weight[lane] += f * f
            active[lane] = max(active[lane], f)
    for lane in range(_LANES):  # inverse square of the noise that is left
        weight[lane] = _ONE / (weight[lane] * weight[lane])
    for a in range(p):
        constant = out[p * p + a]
        for lane in range(_LANES):
            constant[lane] = mean[a, lane]
        for b in range(p):
            for lane in range(_LANES):
                total = _ZERO
                for i in range(p):
                    total += basis[i, a, lane] * gain[i, lane] * basis[i, b, lane]
                total *= unit[a, lane] / unit[b, lane]
                constant[lane] -= total * mean[b, lane]
                out[a * p + b, lane] = total * weight[lane]
        for lane in range(_LANES):
            constant[lane] *= weight[lane]


@_within
@no_type_check
def _add_row(ring, top, bottom, radius, values, estimate, weight, active):
    """The estimates for one row of pixels, from the rows of windows ``top`` to ``bottom``."""
    p, w = values.shape
    held, count, columns = ring.shape
    pad = radius // 2
    even, odd = 2 * pad + 1, 2 * ((radius + 1) // 2)  # windows that hold a pixel of this parity
    later = pad - (radius - 1) // 2
    vertical = np.empty((1, count, columns + 2 * pad + 2), np.float32)[0]
    vertical[:] = _ZERO
    line = np.empty((1, 1, 2 * columns), np.float32)[0, 0]
    for row in range(top, bottom):
        for k in range(count):
            for x in range(columns):
                vertical[k, pad + x] += ring[row % held, k, x]
    for k in range(count):
        line[:] = _ZERO
        for i in range(even):
            for x in range(columns):
                line[2 * x] += vertical[k, x + i]
        for i in range(odd):
            for x in range(columns):
                line[2 * x + 1] += vertical[k, later + x + i]
        if k < p * p:
            for x in range(w):
                estimate[k // p, x] += line[x] * values[k % p, x]
        elif k < p * p + p:
            for x in range(w):
                estimate[k - p * p, x] += line[x]
        elif k == p * p + p:
            for x in range(w):
                weight[x] += line[x]
        else:
            for x in range(w):
                n = min(columns, (x + radius) // 2 + 1) - max(0, (x - radius + 1) // 2)
                active[x] = line[x] / _F(n * (bottom - top))
