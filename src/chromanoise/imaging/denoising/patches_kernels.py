# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Groups of similar patches and their filters, compiled; functions release the GIL.

The samples of a group are the last axis of its arrays, so that loops over them are vectorized.
The sums over samples may be taken in any order, but in the same one whatever the strip: it depends
only on the number of samples.
"""

from typing import no_type_check

import numpy as np

from chromanoise.imaging.denoising.electron_planes import PLACES, SIDE
from chromanoise.imaging.kernel_cache import kernel

_OPTIONS = {"error_model": "numpy", "fastmath": {"contract", "reassoc"}}
_WITHIN = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}  # called by kernels only
_compiled = kernel(**_OPTIONS, **_WITHIN)
_SMALL = np.float32(1e-8)
_TINY = np.float32(1e-20)
_MOST_SWEEPS = 60
_CLEAN = 2.5e5
"""Power of the samples over that of the noise above which they are kept as they are: single
precision could not tell the noise from rounding errors."""


@_compiled
@no_type_check
def _eigen(v, d, e):
    """Eigenvalues into ``d`` and eigenvectors into the rows of ``v``, which holds the matrix.

    Householder's tridiagonal form, then implicit QL steps (EISPACK tred2 and tql2).
    """
    n = len(d)
    for j in range(n):
        d[j] = v[j, n - 1]
    for i in range(n - 1, 0, -1):
        scale = 0.0
        h = 0.0
        for k in range(i):
            scale += abs(d[k])
        if scale == 0.0:
            e[i] = d[i - 1]
            for j in range(i):
                d[j] = v[j, i - 1]
                v[j, i] = 0.0
                v[i, j] = 0.0
        else:
            for k in range(i):
                d[k] /= scale
                h += d[k] * d[k]
            f = d[i - 1]
            g = -np.sqrt(h) if f > 0 else np.sqrt(h)
            e[i] = scale * g
            h -= f * g
            d[i - 1] = f - g
            for j in range(i):
                e[j] = 0.0
            for j in range(i):
                f = d[j]
                v[i, j] = f
                g = e[j] + v[j, j] * f
                for k in range(j + 1, i):
                    g += v[j, k] * d[k]
                    e[k] += v[j, k] * f
                e[j] = g
            f = 0.0
            for j in range(i):
                e[j] /= h
                f += e[j] * d[j]
            hh = f / (h + h)
            for j in range(i):
                e[j] -= hh * d[j]
            for j in range(i):
                f = d[j]
                g = e[j]
                for k in range(j, i):
                    v[j, k] -= f * e[k] + g * d[k]
                d[j] = v[j, i - 1]
                v[j, i] = 0.0
        d[i] = h
    for i in range(n - 1):
        v[i, n - 1] = v[i, i]
        v[i, i] = 1.0
        h = d[i + 1]
        if h != 0.0:
            for k in range(i + 1):
                d[k] = v[i + 1, k] / h
            for j in range(i + 1):
                g = 0.0
                for k in range(i + 1):
                    g += v[i + 1, k] * v[j, k]
                for k in range(i + 1):
                    v[j, k] -= g * d[k]
        for k in range(i + 1):
            v[i + 1, k] = 0.0
    for j in range(n):
        d[j] = v[j, n - 1]
        v[j, n - 1] = 0.0
    v[n - 1, n - 1] = 1.0
    for i in range(1, n):
        e[i - 1] = e[i]
    e[n - 1] = 0.0
    f = 0.0
    largest = 0.0
    for l in range(n):  # noqa: E741
        largest = max(largest, abs(d[l]) + abs(e[l]))
        m = l
        while m < n - 1 and abs(e[m]) > 1e-12 * largest:
            m += 1
        if m == l:
            d[l] += f
            e[l] = 0.0
            continue
        for _ in range(_MOST_SWEEPS):
            g = d[l]
            s = (d[l + 1] - g) / (2.0 * e[l])
            r = np.sqrt(s * s + 1.0)
            if s < 0:
                r = -r
            d[l] = e[l] / (s + r)
            d[l + 1] = e[l] * (s + r)
            low = d[l + 1]
            h = g - d[l]
            for i in range(l + 2, n):
                d[i] -= h
            f += h
            s = d[m]
            c = c2 = c3 = 1.0
            el1 = e[l + 1]
            t = t2 = 0.0
            for i in range(m - 1, l - 1, -1):
                c3 = c2
                c2 = c
                t2 = t
                g = c * e[i]
                h = c * s
                r = np.sqrt(s * s + e[i] * e[i])
                e[i + 1] = t * r
                t = e[i] / r
                c = s / r
                s = c * d[i] - t * g
                d[i + 1] = h + t * (c * g + t * d[i])
                for k in range(n):
                    h = v[i + 1, k]
                    v[i + 1, k] = t * v[i, k] + c * h
                    v[i, k] = c * v[i, k] - t * h
            s = -t * t2 * c3 * el1 * e[l] / low
            e[l] = t * s
            d[l] = c * s
            if abs(e[l]) <= 1e-12 * largest:
                break
        d[l] += f
        e[l] = 0.0


@_compiled
@no_type_check
def _nearest(distance, count, fewest, limit):
    """The distance up to which patches are similar: the limit, or more for the fewest patches."""
    if fewest >= count:
        return np.float32(np.inf)
    found = 0
    for j in range(count):
        found += np.int64(distance[j] <= limit)
    if found >= fewest:
        return np.float32(limit)
    bits = distance.view(np.int32)
    low, high = np.int32(0), np.int32(0x7F800000)
    while low < high:  # the smallest number that enough distances do not exceed
        middle = np.int32(low + (high - low) // 2)
        found = 0
        for j in range(count):
            found += np.int64(bits[j] <= middle)
        if found >= fewest:
            high = middle
        else:
            low = np.int32(middle + 1)
    return np.int32(low).view(np.float32)


@_compiled
@no_type_check
def _filter_of_noisy(cov, a, d, e, work, n):
    """Write the filter of a group's noisy samples; the largest gain.

    Noise of variance 1 alone has eigenvalues up to (1 + sqrt(places / n))^2; a signal's eigenvalue
    s appears as (1 + s) (1 + places / (n s)), which is solved for s.
    """
    for i in range(PLACES):
        for j in range(PLACES):
            work[i, j] = cov[i, j]
            a[i, j] = 0.0
    _eigen(work, d, e)
    ratio = PLACES / n
    edge = (1.0 + np.sqrt(ratio)) ** 2
    largest = 0.0
    for i in range(PLACES):
        if d[i] > edge:
            t = d[i] + 1.0 - ratio
            signal = (t + np.sqrt(max(t * t - 4.0 * d[i], 0.0))) / 2.0 - 1.0
            gain = signal / (signal + 1.0)
            largest = max(largest, gain)
            for r in range(PLACES):
                f = gain * work[i, r]
                for s in range(PLACES):
                    a[r, s] += f * work[i, s]
    return largest


@_compiled
@no_type_check
def _set_identity(a):
    """Write the filter that keeps all; its largest gain."""
    for i in range(PLACES):
        for j in range(PLACES):
            a[i, j] = 1.0 if i == j else 0.0
    return 1.0


@_compiled
@no_type_check
def _wiener(cov, a, low):
    """Write C (C + 1)^-1 = 1 - (C + 1)^-1; its largest diagonal entry."""
    for i in range(PLACES):  # Cholesky: C + 1 = L L^T, and the inverse of L
        for j in range(i + 1):
            total = cov[i, j]
            if i == j:
                total += 1.0
            for k in range(j):
                total -= low[i, k] * low[j, k]
            low[i, j] = np.sqrt(total) if i == j else total / low[j, j]
    for j in range(PLACES):
        low[j, j] = 1.0 / low[j, j]
        for i in range(j + 1, PLACES):
            total = 0.0
            for k in range(j, i):
                total -= low[i, k] * low[k, j]
            low[i, j] = total / low[i, i]
    largest = 0.0
    for i in range(PLACES):
        for j in range(i + 1):
            total = 0.0
            for k in range(i, PLACES):
                total -= low[k, i] * low[k, j]
            if i == j:
                total += 1.0
            a[i, j] = total
            a[j, i] = total
    for i in range(PLACES):
        largest = max(largest, a[i, i])
    return largest


@_compiled
@no_type_check
def _fill_distances(distance, ys, xs, features, y0, x0, radius):
    """Squared distances of the patches around (y0, x0) to the one there; their number."""
    q, h, w = features.shape
    first, last = max(0, x0 - radius), min(w - SIDE, x0 + radius) + 1
    across = last - first
    m = 0
    for y in range(max(0, y0 - radius), min(h - SIDE, y0 + radius) + 1):
        for j in range(across):
            distance[m + j] = 0.0
            ys[m + j] = y
            xs[m + j] = first + j
        for c in range(q):
            for i in range(SIDE):
                for k in range(SIDE):
                    here = features[c, y0 + i, x0 + k]
                    for j in range(across):
                        t = features[c, y + i, first + k + j] - here
                        distance[m + j] += t * t
        m += across
    return m


@_compiled
@no_type_check
def _gather(samples, mean, picture, ys, xs, n):
    """Fill the deviations of n patches from their mean, and the mean."""
    per = np.float32(1.0 / n)
    for c in range(picture.shape[2]):
        for i in range(SIDE):
            for k in range(SIDE):
                place = i * SIDE + k
                total = np.float32(0.0)
                for j in range(n):
                    value = picture[ys[j] + i, xs[j] + k, c]
                    samples[c, place, j] = value
                    total += value
                total *= per
                mean[c, place] = total
                for j in range(n):
                    samples[c, place, j] -= total


@_compiled
@no_type_check
def _spread(samples, n):
    largest = np.float32(0.0)
    for j in range(n):
        largest = max(largest, abs(samples[j]))
    return largest


@_compiled
@no_type_check
def _scale(samples, factor, n):
    for j in range(n):
        samples[j] *= factor


@_compiled
@no_type_check
def _rotate(z, samples, color, k, n):
    """Fill the component k of samples."""
    for i in range(PLACES):
        for j in range(n):
            z[i, j] = 0.0
        for c in range(len(samples)):
            f = np.float32(color[k, c])
            for j in range(n):
                z[i, j] += f * samples[c, i, j]


@_compiled
@no_type_check
def _fill_covariance(cov, z, n):
    for i in range(PLACES):
        for r in range(i + 1):
            total = np.float32(0.0)
            for j in range(n):
                total += z[i, j] * z[r, j]
            cov[i, r] = total / n
            cov[r, i] = cov[i, r]


@_compiled
@no_type_check
def _fill_color(color, samples, n):
    for c in range(len(samples)):
        for b in range(c + 1):
            s = 0.0
            for i in range(PLACES):
                total = np.float32(0.0)
                for j in range(n):
                    total += samples[c, i, j] * samples[b, i, j]
                s += total
            color[c, b] = s
            color[b, c] = s


@_compiled
@no_type_check
def _add_filtered(total, y, a, z, color, k, n):
    """Add component k after the filter ``a`` to the samples; the sum of squares of the filter."""
    lost = 0.0
    for i in range(PLACES):
        for j in range(n):
            y[j] = 0.0
        for r in range(PLACES):
            lost += a[i, r] * a[i, r]
            f = np.float32(a[i, r])
            for j in range(n):
                y[j] += f * z[r, j]
        for c in range(len(total)):
            f = np.float32(color[k, c])
            for j in range(n):
                total[c, i, j] += f * y[j]
    return lost


@kernel(**_OPTIONS)
@no_type_check
def add_groups(
    noisy,
    pilot,
    features,
    floor,
    slope,
    square,
    second,
    radius,
    stride,
    fewest,
    limit,
    out,
    weight,
    activity,
):
    """Add the estimates of all groups of similar patches to ``out``, with their weights.

    Parameters
    ----------
    noisy, pilot
        Values (h w p), and the estimate of step 1, used if ``second``.
    features
        Values (q h w) that are compared to find similar patches, in standard deviations of the
        noise.
    floor, slope, square
        Variance of the noise of each plane, as of `VarianceLaw`.
    second
        Whether this is step 2.
    radius, stride
        Rows and columns in which patches are sought, and between groups.
    fewest, limit
        Fewest patches of a group, and the squared distance up to which all patches are similar.
    out, weight, activity
        Sums (h w p), (h w), (h w): weighted estimates, weights, weighted largest gains.
    """
    h, w, p = noisy.shape
    most = (2 * radius + 1) ** 2
    distance = np.empty(most, np.float32)
    ys, xs = np.empty(most, np.int64), np.empty(most, np.int64)
    x = np.empty((p, PLACES, most), np.float32)
    g = np.empty((p, PLACES, most), np.float32)
    total = np.empty((p, PLACES, most), np.float32)
    z, y = np.empty((PLACES, most), np.float32), np.empty(most, np.float32)
    mean, guide_mean = np.empty((p, PLACES), np.float32), np.empty((p, PLACES), np.float32)
    sd = np.empty((p, PLACES), np.float32)
    color = np.empty((p, p))
    cd, ce = np.empty(p), np.empty(p)
    cov = np.empty((PLACES, PLACES))
    a = np.empty((PLACES, PLACES))
    work = np.empty((PLACES, PLACES))
    d, e = np.empty(PLACES), np.empty(PLACES)
    for top in range(0, h - SIDE + stride, stride):
        y0 = min(top, h - SIDE)
        for left in range(0, w - SIDE + stride, stride):
            x0 = min(left, w - SIDE)
            m = _fill_distances(distance, ys, xs, features, y0, x0, radius)
            bound = _nearest(distance, m, fewest, limit)
            n = np.int64(0)
            for j in range(m):
                if distance[j] <= bound:
                    ys[n] = ys[j]
                    xs[n] = xs[j]
                    n += 1
            _gather(x, mean, noisy, ys, xs, n)
            guide, light = x, mean
            if second:
                _gather(g, guide_mean, pilot, ys, xs, n)
                guide, light = g, guide_mean
            for c in range(p):
                for i in range(PLACES):
                    m0 = max(light[c, i], np.float32(0.0))
                    unit = np.float32(np.sqrt(floor[c] + slope[c] * m0 + square[c] * m0 * m0))
                    unit = max(unit, _spread(x[c, i], n) * _SMALL, _TINY)
                    sd[c, i] = unit
                    f = np.float32(1.0) / unit
                    _scale(x[c, i], f, n)
                    if second:
                        _scale(g[c, i], f, n)
                    for j in range(n):
                        total[c, i, j] = 0.0
            _fill_color(color, guide, n)
            _eigen(color, cd, ce)
            lost = 0.0
            active = 0.0
            for k in range(p):
                _rotate(z, guide, color, k, n)
                _fill_covariance(cov, z, n)
                power = 0.0
                for i in range(PLACES):
                    power += cov[i, i]
                if power > _CLEAN:
                    largest = _set_identity(a)
                elif second:
                    largest = _wiener(cov, a, work)
                else:
                    largest = _filter_of_noisy(cov, a, d, e, work, n)
                active = max(active, largest)
                if largest <= 1e-3:
                    continue
                if second:
                    _rotate(z, x, color, k, n)
                lost += _add_filtered(total, y, a, z, color, k, n)
            # over the variance of the estimate: noise that the filters pass, and of the mean patch
            share = np.float32(1.0 / (lost + PLACES * p / n))
            for c in range(p):
                for i in range(PLACES):
                    for j in range(n):
                        total[c, i, j] = share * (total[c, i, j] * sd[c, i] + mean[c, i])
            for j in range(n):
                for i in range(SIDE):
                    for k in range(SIDE):
                        for c in range(p):
                            out[ys[j] + i, xs[j] + k, c] += total[c, i * SIDE + k, j]
                        weight[ys[j] + i, xs[j] + k] += share
                        activity[ys[j] + i, xs[j] + k] += share * np.float32(active)
