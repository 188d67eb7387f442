# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Groups of similar patches and their filters, compiled; functions release the GIL.

Distances are taken for all groups of a tile at once, along the rows of the picture. The samples of
a group are the last axis of its arrays, zero-padded to a multiple of `LANES`, as are the rows of
matrices. Intrinsics emit SIMD instructions where LLVM does not vectorize; each works on `LANES`
consecutive numbers of a flat array.

The sums over samples may be taken in any order, but in the same one whatever the strip: it depends
only on the number of samples.
"""

from typing import no_type_check

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from chromanoise.imaging.denoising.electron_planes import PLACES, SIDE
from chromanoise.imaging.dot_kernels import (
    F32,
    I32,
    I64,
    folded,
    loop,
    shuffled,
    spread,
    variable,
    written,
)
from chromanoise.imaging.kernel_cache import kernel

_OPTIONS = {"error_model": "numpy", "fastmath": {"contract", "reassoc"}}
_WITHIN = {"no_cpython_wrapper": True}  # called by kernels only
_compiled = kernel(**_OPTIONS, **_WITHIN)
LANES = 16
assert PLACES == LANES, "a matrix of a group has a row per place and a vector per row"
_TILE = 69
"""Groups whose distances are taken at once: 3 columns each and a patch are 13 vectors."""
_DOUBLE, _WHOLE = ir.DoubleType(), types.int64
_ZERO = np.float32(0.0)
_SMALL = np.float32(1e-8)
_TINY = np.float32(1e-20)
_MOST_SWEEPS = 60
_CLEAN = 2.5e5
"""Power of the samples over that of the noise above which they are kept as they are: single
precision could not tell the noise from rounding errors."""
_LEAST_GAIN = 1e-3
"""Largest gain up to which a component counts as noise."""


class _Vectors:
    """Writes instructions on vectors of ``lanes`` numbers."""

    def __init__(self, builder, lanes):
        self.builder, self.lanes = builder, lanes

    def spread(self, number):
        """The number in all lanes."""
        return spread(self.builder, number, self.lanes)

    def constant(self, number, kind=_DOUBLE):
        return ir.Constant(ir.VectorType(kind, self.lanes), [number] * self.lanes)

    def root(self, value):
        kind = ir.FunctionType(value.type, [value.type])
        name = f"llvm.sqrt.v{self.lanes}f64"
        function = cgutils.get_or_insert_function(self.builder.module, kind, name)
        return self.builder.call(function, [value])

    def with_sign(self, value, of):
        """The value, or minus it where the other one is below 0."""
        below = self.builder.fcmp_ordered("<", of, self.constant(0.0))
        return self.builder.select(below, self.builder.fneg(value), value)

    def fused(self, factor, other, term, sign="fadd"):
        """Term + factor * other, or term - factor * other."""
        product = self.builder.fmul(factor, other, flags=("contract",))
        return getattr(self.builder, sign)(term, product, flags=("contract",))


class _Flat:
    """A flat array, from and to which instructions move numbers and vectors."""

    def __init__(self, on, data):
        self.builder, self.lanes, self.data = on.builder, on.lanes, data

    def number(self, at):
        return self.builder.load(self.builder.gep(self.data, [at]))

    def load(self, at):
        return self.builder.load(self._vector(at), align=4)

    def store(self, value, at):
        self.builder.store(value, self._vector(at), align=4)

    def _vector(self, at):
        vector = ir.VectorType(self.data.type.pointee, self.lanes)
        return self.builder.bitcast(self.builder.gep(self.data, [at]), vector.as_pointer())


def _written(write, lanes=LANES):
    """The code generator of an intrinsic whose instructions ``write`` writes, on such vectors."""

    def write_on_vectors(builder, *values):
        on = _Vectors(builder, lanes)
        flat = (one if isinstance(one, ir.Value) else _Flat(on, one.data) for one in values)
        return write(on, builder, *flat)

    return written(write_on_vectors)


@intrinsic
@no_type_check
def _add(typing_context, out, to, factor, values, first):
    """Add to a vector of ``out`` a vector of ``values`` times the factor."""

    def write(on, builder, out, to, factor, values, first):
        out.store(on.fused(on.spread(factor), values.load(first), out.load(to)), to)

    return types.void(out, _WHOLE, out.dtype, values, _WHOLE), _written(write)


@intrinsic
@no_type_check
def _turn(typing_context, values, one, other, cosine, sine):
    """Rotate two vectors: one to c one - s other, other to s one + c other."""

    def write(on, builder, values, one, other, cosine, sine):
        cosine, sine = on.spread(cosine), on.spread(sine)
        x, y = values.load(one), values.load(other)
        values.store(on.fused(sine, y, builder.fmul(cosine, x), "fsub"), one)
        values.store(on.fused(sine, x, builder.fmul(cosine, y)), other)

    return types.void(values, _WHOLE, _WHOLE, values.dtype, values.dtype), _written(write)


@intrinsic
@no_type_check
def _add_squares(typing_context, sums, to, values, here, there, row):
    """Add the squared differences of two places of `SIDE` rows to a vector of the sums."""

    def write(on, builder, sums, to, values, here, there, row):
        total = sums.load(to)
        for _ in range(SIDE):
            apart = builder.fsub(values.load(here), values.load(there))
            total = on.fused(apart, apart, total)
            here, there = builder.add(here, row), builder.add(there, row)
        sums.store(total, to)

    return types.void(sums, _WHOLE, values, _WHOLE, _WHOLE, _WHOLE), _written(write)


@intrinsic
@no_type_check
def _transpose(typing_context, out, to, pitch, values, places, first, shift):
    """Write the vectors at `LANES` places, with a shift, as columns of rows of ``out``."""

    def write(on, builder, out, to, pitch, values, places, first, shift):
        vectors = []
        for lane in range(LANES):
            place = places.number(builder.add(first, I64(lane)))
            vectors.append(values.load(builder.add(place, shift)))
        half = LANES // 2
        low = [lane // 2 + lane % 2 * LANES for lane in range(LANES)]
        for _ in range(LANES.bit_length() - 1):  # each turn interleaves the first and second half
            vectors = [
                shuffled(builder, a, b, [lane + part for lane in low])
                for a, b in zip(vectors[:half], vectors[half:], strict=True)
                for part in (0, half)
            ]
        for vector in vectors:
            out.store(vector, to)
            to = builder.add(to, pitch)

    return types.void(out, _WHOLE, _WHOLE, values, places, _WHOLE, _WHOLE), _written(write)


@intrinsic
@no_type_check
def _combine(typing_context, out, to, base, factors, number, count, rows, first, pitch, width):
    """Write a row of ``out``: the base and the sum of ``count`` rows, times their factors."""

    def write(on, builder, out, to, base, factors, number, count, rows, first, pitch, width):
        at, k, row = (variable(builder, I64(0)) for _ in range(3))
        base = on.spread(base)
        total = variable(builder, base)

        def add(now):
            factor = on.spread(factors.number(builder.add(number, now)))
            here = builder.load(row)
            builder.store(on.fused(factor, rows.load(here), builder.load(total)), total)
            builder.store(builder.add(here, pitch), row)

        def write_vector(now):
            builder.store(I64(0), k)
            builder.store(builder.add(first, now), row)
            builder.store(base, total)
            loop(builder, k, count, 1, add)
            out.store(builder.load(total), builder.add(to, now))

        loop(builder, at, width, LANES, write_vector)

    number = out.dtype
    return types.void(
        out, _WHOLE, number, factors, _WHOLE, _WHOLE, rows, _WHOLE, _WHOLE, _WHOLE
    ), _written(write)


@intrinsic
@no_type_check
def _filter(typing_context, out, to, factors, rows, pitch, width):
    """Write the products of `PLACES` rows with a matrix of factors."""

    def write(on, builder, out, to, factors, rows, pitch, width):
        at = variable(builder, I64(0))
        lines = [builder.mul(pitch, I64(i)) for i in range(PLACES)]

        def write_vectors(now):
            values = [rows.load(builder.add(line, now)) for line in lines]
            for i, line in enumerate(lines):
                total = on.constant(0.0, F32)
                for k, value in enumerate(values):
                    factor = on.spread(factors.number(I64(i * PLACES + k)))
                    total = on.fused(factor, value, total)
                out.store(total, builder.add(builder.add(to, line), now))

        loop(builder, at, width, LANES, write_vectors)

    return types.void(out, _WHOLE, factors, rows, _WHOLE, _WHOLE), _written(write)


_BLOCK = 4


@intrinsic
@no_type_check
def _multiply(typing_context, out, rows, one, other, pitch, jump, times, width):
    """Write the products of 4 rows with 4 others, summed over their width and over some jumps."""

    def write(on, builder, out, rows, one, other, pitch, jump, times, width):
        at, turn = variable(builder, I64(0)), variable(builder, I64(0))
        places = [variable(builder, place) for place in (one, other)]
        totals = [variable(builder, on.constant(0.0, F32)) for _ in range(_BLOCK**2)]

        def four(place, now):
            here = builder.add(builder.load(place), now)
            for _ in range(_BLOCK):
                yield rows.load(here)
                here = builder.add(here, pitch)

        def add(now):
            a, b = (list(four(place, now)) for place in places)
            pairs = [(u, v) for u in a for v in b]
            for (u, v), total in zip(pairs, totals, strict=True):
                builder.store(on.fused(u, v, builder.load(total)), total)

        def add_all(_):
            builder.store(I64(0), at)
            loop(builder, at, width, LANES, add)
            for place in places:
                builder.store(builder.add(builder.load(place), jump), place)

        loop(builder, turn, times, 1, add_all)
        sums = folded(builder, [builder.load(total) for total in totals], LANES)
        out.store(sums, I64(0))

    return types.void(out, rows, _WHOLE, _WHOLE, _WHOLE, _WHOLE, _WHOLE, _WHOLE), _written(write)


@intrinsic
@no_type_check
def _invert(typing_context, matrix):
    """Replace a matrix of `PLACES` rows by its inverse; its smallest pivot, at most 1.

    Gauss-Jordan elimination without pivoting. A symmetric matrix is positive definite if and only
    if all pivots are above 0.
    """

    def write(on, builder, matrix):
        rows = [matrix.load(I64(i * LANES)) for i in range(PLACES)]
        least = one = _DOUBLE(1.0)
        for k in range(PLACES):
            pivot = builder.extract_element(rows[k], I32(k))
            least = builder.select(builder.fcmp_unordered("<", pivot, least), pivot, least)
            inverse = builder.fdiv(one, pivot)
            scaled = builder.fmul(rows[k], on.spread(inverse))
            # a column f becomes f - f (1 + inverse)
            row = builder.insert_element(scaled, builder.fadd(one, inverse), I32(k))
            for i in range(PLACES):
                if i != k:
                    factor = shuffled(builder, rows[i], rows[i], [k] * LANES)
                    rows[i] = on.fused(factor, row, rows[i], "fsub")
            rows[k] = builder.insert_element(scaled, inverse, I32(k))
        for i, row in enumerate(rows):
            matrix.store(row, I64(i * LANES))
        return least

    return types.float64(matrix), _written(write)


_AT_ONCE = 4
"""Matrices whose eigenvalues are found at once: square roots and divisions have a long latency."""
_FLOOR = 1e-200


@intrinsic
@no_type_check
def _sweep(typing_context, d, e, cosines, sines, first, last):
    """One QL step of `_AT_ONCE` tridiagonal matrices; writes the rotations and then a sign.

    The square-root-free form of Pal, Walker and Kahan (LAPACK dsterf).
    """

    def write(on, builder, d, e, cosines, sines, first, last):
        one, floor = on.constant(1.0), on.constant(_FLOOR)

        def place(row):
            return builder.mul(row, I64(_AT_ONCE))

        begin = d.load(place(first))
        root = on.root(e.load(place(first)))
        apart = builder.fsub(d.load(place(builder.add(first, I64(1)))), begin)
        ratio = builder.fdiv(builder.fmul(apart, on.constant(0.5)), root)
        length = on.root(on.fused(ratio, ratio, one))
        length = builder.fadd(ratio, on.with_sign(length, ratio))
        shift = builder.fsub(begin, builder.fdiv(root, length))
        g = builder.fsub(d.load(place(last)), shift)
        g, f = variable(builder, g), variable(builder, builder.fmul(g, g))
        # squares of the cosine and the sine, and the sign of the cosine
        c, s = variable(builder, one), variable(builder, on.constant(0.0))
        sign = variable(builder, one)

        def rotate(now):
            row = builder.sub(builder.sub(last, I64(1)), now)
            after = builder.add(row, I64(1))
            square, diagonal = e.load(place(row)), d.load(place(row))
            old, power, before = builder.load(g), builder.load(f), builder.load(c)
            r = builder.fadd(power, square)
            e.store(on.fused(builder.load(s), r, floor), place(after))
            cosine, sine = builder.fdiv(power, r), builder.fdiv(square, r)
            builder.store(cosine, c)
            builder.store(sine, s)
            turned = on.with_sign(builder.load(sign), old)
            builder.store(turned, sign)
            product = builder.fmul(sine, old)
            new = builder.fsub(builder.fmul(cosine, builder.fsub(diagonal, shift)), product)
            d.store(builder.fadd(old, builder.fsub(diagonal, new)), place(after))
            cosines.store(builder.fmul(turned, on.root(cosine)), place(row))
            sines.store(on.root(sine), place(row))
            usual = builder.fmul(builder.fmul(new, new), builder.fdiv(r, power))
            some = builder.fcmp_ordered(">", power, on.constant(1e-100))
            builder.store(builder.select(some, usual, builder.fmul(before, square)), f)
            builder.store(new, g)

        counter = variable(builder, I64(0))
        loop(builder, counter, builder.sub(last, first), 1, rotate)
        e.store(on.fused(builder.load(s), builder.load(f), floor), place(first))
        d.store(builder.fadd(shift, builder.load(g)), place(first))
        cosines.store(on.with_sign(builder.load(sign), builder.load(g)), place(last))

    return types.void(d, e, cosines, sines, _WHOLE, _WHOLE), _written(write, _AT_ONCE)


@_compiled
@no_type_check
def _negate(values, first, count):
    for j in range(first, first + count):
        values[j] = -values[j]


@_compiled
@no_type_check
def _tridiagonalize(a, v, first, band, lane, room, n):
    """Householder tridiagonalization of n rows; the reflections in v, and the matrix changes.

    ``band``: the diagonal, the squares off it, and the largest of these that count as 0; of the
    ``room``, two arrays are a row each, the last one is two.
    """
    (d, e, small), (u, q, single) = band, room
    width = len(u)
    v[first : first + n * width] = _ZERO
    for i in range(n):
        v[first + i * width + i] = 1.0
    for k in range(n - 2):  # reflections 1 - u u^T h
        square = 0.0
        for j in range(width):
            u[j] = a[k * width + j] if j > k else 0.0
            square += u[j] * u[j]
        if square == 0.0:
            continue
        root = np.sqrt(square) if u[k + 1] > 0 else -np.sqrt(square)
        h = 1.0 / (square + u[k + 1] * root)
        u[k + 1] += root
        _combine(q, 0, 0.0, u, k + 1, n - k - 1, a, (k + 1) * width, width, width)
        f = 0.0
        for j in range(width):
            f += u[j] * q[j]
        for j in range(0, width, LANES):
            _add(q, j, -0.5 * h * f, u, j)
        for i in range(k, n):
            for j in range(0, width, LANES):
                _add(a, i * width + j, -h * u[i], q, j)
                _add(a, i * width + j, -h * q[i], u, j)
        root = np.sqrt(h)
        for j in range(width):
            single[j] = root * u[j]
        at = first + (k + 1) * width
        _combine(single, width, _ZERO, single, k + 1, n - k - 1, v, at, width, width)
        for i in range(k + 1, n):
            for j in range(0, width, LANES):
                _add(v, first + i * width + j, -single[i], single, width + j)
    trace = 0.0
    sign = 1.0
    for i in range(n):
        d[i * _AT_ONCE + lane] = a[i * width + i]
        trace += abs(a[i * width + i])
        if sign < 0.0:
            _negate(v, first + i * width, width)
        if i + 1 < n:
            beside = a[i * width + i + 1]
            e[i * _AT_ONCE + lane] = beside * beside + _FLOOR
            sign = sign if beside >= 0.0 else -sign
    small[lane] = (1e-7 * trace) ** 2 + 2.0 * _FLOOR


@_compiled
@no_type_check
def _diagonalize(v, band, turns, count, width, n):
    """Eigenvalues of `_AT_ONCE` tridiagonal matrices, and eigenvectors into the rows of v."""
    (d, e, small), (cosines, sines) = band, turns
    for lane in range(count, _AT_ONCE):
        small[lane] = np.inf
    for first in range(n - 1):
        for _ in range(_MOST_SWEEPS):
            busy = False
            for lane in range(_AT_ONCE):
                busy = busy or e[first * _AT_ONCE + lane] > small[lane]
            if not busy:
                break
            _sweep(d, e, cosines, sines, first, n - 1)
            for i in range(n - 2, first - 1, -1):
                for lane in range(count):
                    row = (lane * n + i) * width
                    at = i * _AT_ONCE + lane
                    cosine, sine = np.float32(cosines[at]), np.float32(sines[at])
                    for j in range(row, row + width, LANES):
                        _turn(v, j, j + width, cosine, sine)
            for lane in range(count):
                if cosines[(n - 1) * _AT_ONCE + lane] < 0.0:
                    _negate(v, (lane * n + first) * width, width)


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
def _has_signal(cov, work, n):
    """Whether an eigenvalue is above those of noise: not all pivots of edge - C are above 0."""
    edge = (1.0 + np.sqrt(PLACES / n)) ** 2
    for i in range(PLACES):
        if cov[i, i] >= edge:
            return True
    for i in range(PLACES):
        for j in range(PLACES):
            work[i, j] = -cov[i, j]
        work[i, i] += edge
    return not _invert(work.reshape(-1)) > 0.0


@_compiled
@no_type_check
def _set_filter_of_noisy(a, vectors, lane, d, n):
    """Write the filter of a group's noisy samples; the largest gain.

    Noise of variance 1 alone has eigenvalues up to (1 + sqrt(places / n))^2; a signal's eigenvalue
    s appears as (1 + s) (1 + places / (n s)), which is solved for s.
    """
    ratio = PLACES / n
    edge = (1.0 + np.sqrt(ratio)) ** 2
    largest = 0.0
    filters = a.reshape(-1)
    a[:] = _ZERO
    for i in range(PLACES):
        power = d[i * _AT_ONCE + lane]
        if power > edge:
            t = power + 1.0 - ratio
            signal = (t + np.sqrt(max(t * t - 4.0 * power, 0.0))) / 2.0 - 1.0
            gain = signal / (signal + 1.0)
            largest = max(largest, gain)
            row = (lane * PLACES + i) * PLACES
            for r in range(PLACES):
                _add(filters, r * PLACES, np.float32(gain) * vectors[row + r], vectors, row)
    return largest


@_compiled
@no_type_check
def _set_identity(a):
    """Write the filter that keeps all; its largest gain."""
    a[:] = 0.0
    for i in range(PLACES):
        a[i, i] = 1.0
    return 1.0


@_compiled
@no_type_check
def _set_wiener(a, cov):
    """Write C (C + 1)^-1 = 1 - (C + 1)^-1; its largest diagonal entry. C changes."""
    for i in range(PLACES):
        cov[i, i] += 1.0
    _invert(cov.reshape(-1))
    largest = 0.0
    for i in range(PLACES):
        for j in range(PLACES):
            a[i, j] = -cov[i, j]
        a[i, i] = 1.0 - cov[i, i]
        largest = max(largest, 1.0 - cov[i, i])
    return largest


@_compiled
@no_type_check
def _fill_distances(distances, sums, features, shape, y0, first, count, stride, radius):
    """Squared distances of the patches around those of a row of groups.

    Fill ``distances`` (groups, rows and columns of the search) where a patch is in the picture.
    """
    h, w = shape
    pitch = features.shape[2]
    last = w - SIDE
    start, stop = min(first * stride, last), min((first + count - 1) * stride, last) + SIDE
    values = features.reshape(-1)
    for dy in range(max(-radius, -y0), min(radius, h - SIDE - y0) + 1):
        for dx in range(-radius, radius + 1):
            left, right = max(start, -dx), min(stop, w - dx)
            sums[:] = _ZERO
            for c in range(len(features)):
                here = (c * h + y0) * pitch + left
                there = here + dy * pitch + dx
                for x in range(0, right - left, LANES):
                    _add_squares(sums, x, values, here + x, there + x, pitch)
            for g in range(count):
                x = min((first + g) * stride, last) - left
                if 0 <= x <= right - left - SIDE:
                    total = sums[x]
                    for i in range(1, SIDE):
                        total += sums[x + i]
                    distances[g, dy + radius, dx + radius] = total


@_compiled
@no_type_check
def _gather(samples, values, row, across, places, full):
    """Fill the samples (values of a patch, full) from the patches that begin at these places."""
    flat = samples.reshape(-1)
    for i in range(SIDE):
        for s in range(0, across, LANES):
            for j in range(0, full, LANES):
                to = (i * across + s) * samples.shape[1] + j
                _transpose(flat, to, samples.shape[1], values, places, j, i * row + s)


@_compiled
@no_type_check
def _set_means(mean, size, samples, n):
    """The mean of n samples, and that of their sizes."""
    per = np.float32(1.0 / n)
    for s in range(len(mean)):
        total = largest = _ZERO
        for j in range(n):
            total += samples[s, j]
            largest += abs(samples[s, j])
        mean[s], size[s] = total * per, largest * per


@_compiled
@no_type_check
def _standardize(samples, mean, unit, n, full):
    """Subtract the mean of n samples and divide by the unit; fill up with 0."""
    for s in range(len(mean)):
        factor = np.float32(1.0) / unit[s]
        for j in range(full):
            samples[s, j] = (samples[s, j] - mean[s]) * factor
        for j in range(n, full):
            samples[s, j] = _ZERO


@_compiled
@no_type_check
def _rotate(z, samples, axis, p, most, full):
    """Fill a component of the samples."""
    for i in range(PLACES):
        _combine(z, i * most, _ZERO, axis, 0, p, samples, i * p * most, most, full)


@_compiled
@no_type_check
def _fill_covariance(cov, products, z, most, n, full):
    for i in range(0, PLACES, _BLOCK):
        for r in range(0, i + 1, _BLOCK):
            _multiply(products, z, i * most, r * most, most, 0, 1, full)
            for k in range(_BLOCK**2):
                value = products[k] / n
                cov[i + k // _BLOCK, r + k % _BLOCK] = value
                cov[r + k % _BLOCK, i + k // _BLOCK] = value


@_compiled
@no_type_check
def _fill_color(color, products, samples, p, most, full):
    """Fill the unnormalized covariance of the planes; reads up to `_BLOCK` rows of samples on."""
    for c in range(0, p, _BLOCK):
        for b in range(0, c + 1, _BLOCK):
            _multiply(products, samples, c * most, b * most, most, p * most, PLACES, full)
            for k in range(_BLOCK**2):
                row, column = c + k // _BLOCK, b + k % _BLOCK
                if row < p and column < p:
                    color[row, column] = color[column, row] = products[k]


@kernel(**_OPTIONS)
@no_type_check
def add_groups(noisy, pilot, features, shape, noise, second, search, limit, out, weight, activity):
    """Add the estimates of all groups of similar patches to ``out``, with their weights.

    Parameters
    ----------
    noisy, pilot
        Values (h, w p), and the estimate of step 1, used if ``second``. Rows of these, of
        ``features`` and ``out`` have `LANES` or more numbers behind.
    features
        Values (q, h, w) that are compared to find similar patches, in standard deviations of the
        noise.
    shape
        h, w and p.
    noise
        Floor, slope and square (3, p) of the variance of each plane, as of `VarianceLaw`.
    second
        Whether this is step 2.
    search
        Rows and columns in which patches are sought, and between groups, and the fewest patches of
        a group.
    limit
        Squared distance up to which all patches are similar.
    out
        Sum (h, w p) of the weighted estimates.
    weight, activity
        Sums (h w) of the weights, and of the weighted largest gains, of the patches that begin at
        a pixel.
    """
    (h, w, p), (radius, stride, fewest) = shape, search
    floor, slope, square = noise[0], noise[1], noise[2]
    across, row, values = SIDE * p, noisy.shape[1], PLACES * p
    noisy_values, pilot_values, sums_of_values = (
        noisy.reshape(-1),
        pilot.reshape(-1),
        out.reshape(-1),
    )
    side = 2 * radius + 1
    most = -(-side * side // LANES) * LANES
    sums = np.empty(-(-(_TILE * stride + SIDE) // LANES) * LANES, np.float32)
    distances = np.empty((_TILE, side, side), np.float32)
    distance, pixels = np.empty(most, np.float32), np.zeros(most + 1, np.int64)
    places = np.zeros(most + 1, np.int64)
    x = np.zeros((values + LANES, most), np.float32)
    g = np.zeros((values + LANES, most), np.float32)
    z, y = np.empty(PLACES * most, np.float32), np.empty(values * most, np.float32)
    mean, guide_mean = np.empty(values, np.float32), np.empty(values, np.float32)
    unit, size = np.empty(values, np.float32), np.empty(values, np.float32)
    axis, kept_axes = np.empty(p, np.float32), np.empty((p, p), np.float32)
    products = np.empty(_BLOCK**2, np.float32)
    width = -(-p // LANES) * LANES
    color, axes = np.zeros((p, width)), np.zeros(p * width, np.float32)
    u, q, single = np.zeros(width), np.zeros(width), np.zeros(2 * max(width, PLACES), np.float32)
    cov, work = np.empty((PLACES, PLACES)), np.empty((PLACES, PLACES))
    filters, gains = np.empty((p, PLACES, PLACES), np.float32), np.empty(p)
    vectors, solved = np.empty(_AT_ONCE * PLACES**2, np.float32), np.empty(_AT_ONCE, np.int64)
    lanes = _AT_ONCE * max(p, PLACES)
    d = np.zeros(lanes)
    band, turns = (
        (d, np.full(lanes, _FLOOR), np.empty(_AT_ONCE)),
        (np.empty(lanes), np.empty(lanes)),
    )
    row_room = (u[:PLACES], q[:PLACES], single)
    # rows of x in the order of the numbers to which they are added; the last row stays 0
    wide = -(-across // LANES) * LANES
    rows = np.full((SIDE, wide), (values + LANES - 1) * most)
    for i in range(SIDE):
        for s in range(across):
            rows[i, s] = (i * across + s) * most
    block = np.empty((SIDE, wide // LANES, LANES, LANES), np.float32)
    samples, turned, numbers = x.reshape(-1), block.reshape(-1), rows.reshape(-1)
    groups = -(-(w - SIDE) // stride) + 1
    for top in range(0, h - SIDE + stride, stride):
        y0 = min(top, h - SIDE)
        for group in range(groups):
            g0 = group % _TILE
            if g0 == 0:
                count = min(_TILE, groups - group)
                _fill_distances(distances, sums, features, (h, w), y0, group, count, stride, radius)
            x0 = min(group * stride, w - SIDE)
            m = np.int64(0)
            for dy in range(max(-radius, -y0), min(radius, h - SIDE - y0) + 1):
                for dx in range(max(-radius, -x0), min(radius, w - SIDE - x0) + 1):
                    distance[m] = distances[g0, dy + radius, dx + radius]
                    places[m] = (y0 + dy) * row + (x0 + dx) * p
                    pixels[m] = (y0 + dy) * w + x0 + dx
                    m += 1
            bound = _nearest(distance, m, fewest, limit)
            n = np.int64(0)
            for j in range(m):
                places[n] = places[j]
                pixels[n] = pixels[j]
                n += np.int64(distance[j] <= bound)
            full = -(-n // LANES) * LANES
            _gather(x, noisy_values, row, across, places, full)
            _set_means(mean, unit, x, n)
            guide, light = x, mean
            if second:
                _gather(g, pilot_values, row, across, places, full)
                _set_means(guide_mean, size, g, n)
                guide, light = g, guide_mean
            for s in range(values):
                c = s % p
                m0 = max(light[s], _ZERO)
                sd = np.float32(np.sqrt(floor[c] + slope[c] * m0 + square[c] * m0 * m0))
                unit[s] = max(sd, unit[s] * _SMALL, _TINY)
            _standardize(x, mean, unit, n, full)
            if second:
                _standardize(g, guide_mean, unit, n, full)
            _fill_color(color, products, guide.reshape(-1), p, most, full)
            _tridiagonalize(color.reshape(-1), axes, 0, band, 0, (u, q, single), p)
            _diagonalize(axes, band, turns, 1, width, p)
            found = 0
            for k in range(p):
                for c in range(p):
                    kept_axes[k, c] = axes[k * width + c]
                _rotate(z, guide.reshape(-1), kept_axes[k], p, most, full)
                _fill_covariance(cov, products, z, most, n, full)
                power = 0.0
                for i in range(PLACES):
                    power += cov[i, i]
                gains[k] = 0.0
                if power > _CLEAN:
                    gains[k] = _set_identity(filters[k])
                elif second:
                    if power > _LEAST_GAIN:
                        gains[k] = _set_wiener(filters[k], cov)
                elif _has_signal(cov, work, n):
                    at = found * PLACES**2
                    _tridiagonalize(cov.reshape(-1), vectors, at, band, found, row_room, PLACES)
                    solved[found] = k
                    found += 1
                if found and (found == _AT_ONCE or k == p - 1):
                    _diagonalize(vectors, band, turns, found, PLACES, PLACES)
                    for lane in range(found):
                        c = solved[lane]
                        gains[c] = _set_filter_of_noisy(filters[c], vectors, lane, d, n)
                    found = 0
            lost = 0.0
            active = 0.0
            kept = 0
            for k in range(p):
                active = max(active, gains[k])
                if gains[k] <= _LEAST_GAIN:
                    continue
                _rotate(z, samples, kept_axes[k], p, most, full)
                factors = filters[k].reshape(-1)
                for i in range(PLACES**2):
                    lost += factors[i] * factors[i]
                _filter(y, kept * PLACES * most, factors, z, most, full)
                for c in range(p):
                    kept_axes[kept, c] = kept_axes[k, c]
                kept += 1
            # over the variance of the estimate: noise that the filters pass, and of the mean patch
            share = np.float32(1.0 / (lost + values / n))
            for s in range(values):
                for k in range(kept):
                    axis[k] = share * unit[s] * kept_axes[k, s % p]
                first, pitch = s // p * most, PLACES * most
                _combine(samples, s * most, share * mean[s], axis, 0, kept, y, first, pitch, full)
            for first in range(0, n, LANES):
                for i in range(SIDE):
                    for s in range(0, wide, LANES):
                        at = i * wide + s
                        _transpose(turned, at * LANES, LANES, samples, numbers, at, first)
                for j in range(min(LANES, n - first)):
                    start = places[first + j]
                    for i in range(SIDE):
                        for s in range(0, wide, LANES):
                            to, at = start + i * row + s, (i * wide + s + j) * LANES
                            _add(sums_of_values, to, np.float32(1.0), turned, at)
                    weight[pixels[first + j]] += share
                    activity[pixels[first + j]] += share * np.float32(active)
