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
from chromanoise.imaging.dot_kernels import I32, I64, folded, loop, pointer_at, shuffled, variable
from chromanoise.imaging.kernel_cache import kernel

_OPTIONS = {"error_model": "numpy", "fastmath": {"contract", "reassoc"}}
_WITHIN = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}  # called by kernels only
_compiled = kernel(**_OPTIONS, **_WITHIN)
LANES = 16
assert PLACES == LANES, "a matrix of a group has a row per place and a vector per row"
_TILE = 69
"""Groups whose distances are taken at once: 3 columns each and a patch are 13 vectors."""
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
    """Writes instructions on vectors."""

    def __init__(self, context, builder, signature, lanes=LANES):
        self.context, self.builder, self.kinds = context, builder, signature.args
        self.lanes = lanes

    def place(self, arguments, array, offset):
        """The place of a vector in the array, given by its number among the arguments."""
        flat = pointer_at(self.context, self.builder, self.kinds[array], arguments[array], offset)
        return self.builder.bitcast(flat, ir.VectorType(flat.type.pointee, self.lanes).as_pointer())

    def load(self, place):
        return self.builder.load(place, align=4)

    def store(self, value, place):
        self.builder.store(value, place, align=4)

    def spread(self, number):
        """The number in all lanes."""
        none = ir.Constant(ir.VectorType(number.type, self.lanes), ir.Undefined)
        one = self.builder.insert_element(none, number, ir.Constant(I32, 0))
        return shuffled(self.builder, one, none, [0] * self.lanes)

    def constant(self, number):
        return ir.Constant(ir.VectorType(ir.DoubleType(), self.lanes), [number] * self.lanes)

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


@intrinsic
@no_type_check
def _add(typing_context, out, to, factor, values, first):
    """Add to a vector of ``out`` a vector of ``values`` times the factor."""

    def generate(context, builder, signature, arguments):
        on = _Vectors(context, builder, signature)
        goal, source = on.place(arguments, 0, arguments[1]), on.place(arguments, 3, arguments[4])
        factor = on.spread(arguments[2])
        on.store(on.fused(factor, on.load(source), on.load(goal)), goal)
        return context.get_dummy_value()

    return types.void(out, types.int64, out.dtype, values, types.int64), generate


@intrinsic
@no_type_check
def _turn(typing_context, values, one, other, cosine, sine):
    """Rotate two vectors: one to c one - s other, other to s one + c other."""

    def generate(context, builder, signature, arguments):
        on = _Vectors(context, builder, signature)
        one, other = (on.place(arguments, 0, arguments[i]) for i in (1, 2))
        cosine, sine = on.spread(arguments[3]), on.spread(arguments[4])
        x, y = on.load(one), on.load(other)
        on.store(on.fused(sine, y, builder.fmul(cosine, x), "fsub"), one)
        on.store(on.fused(sine, x, builder.fmul(cosine, y)), other)
        return context.get_dummy_value()

    number = values.dtype
    return types.void(values, types.int64, types.int64, number, number), generate


@intrinsic
@no_type_check
def _add_squares(typing_context, sums, to, values, here, there, row):
    """Add the squared differences of two places of `SIDE` rows to a vector of the sums."""
    whole = types.int64

    def generate(context, builder, signature, arguments):
        on = _Vectors(context, builder, signature)
        goal = on.place(arguments, 0, arguments[1])
        here, there, row = arguments[3:]
        total = on.load(goal)
        for _ in range(SIDE):
            x, y = (on.load(on.place(arguments, 2, at)) for at in (here, there))
            apart = builder.fsub(x, y)
            total = on.fused(apart, apart, total)
            here, there = builder.add(here, row), builder.add(there, row)
        on.store(total, goal)
        return context.get_dummy_value()

    return types.void(sums, whole, values, whole, whole, whole), generate


@intrinsic
@no_type_check
def _transpose(typing_context, out, to, pitch, values, places, first, shift):
    """Write the vectors at `LANES` places, with a shift, as columns of rows of ``out``."""
    whole = types.int64

    def generate(context, builder, signature, arguments):
        on = _Vectors(context, builder, signature)
        _, to, pitch, _, _, first, shift = arguments
        vectors = []
        for lane in range(LANES):
            at = builder.add(first, ir.Constant(I64, lane))
            number = builder.load(pointer_at(context, builder, places, arguments[4], at))
            vectors.append(on.load(on.place(arguments, 3, builder.add(number, shift))))
        half = LANES // 2
        low = [lane // 2 + lane % 2 * LANES for lane in range(LANES)]
        for _ in range(LANES.bit_length() - 1):  # each turn interleaves the first and second half
            vectors = [
                shuffled(builder, a, b, [lane + part for lane in low])
                for a, b in zip(vectors[:half], vectors[half:], strict=True)
                for part in (0, half)
            ]
        for vector in vectors:
            on.store(vector, on.place(arguments, 0, to))
            to = builder.add(to, pitch)
        return context.get_dummy_value()

    return types.void(out, whole, whole, values, places, whole, whole), generate


@intrinsic
@no_type_check
def _combine(typing_context, out, to, base, factors, number, count, rows, first, pitch, width):
    """Write a row of ``out``: the base and the sum of ``count`` rows, times their factors."""
    whole = types.int64

    def generate(context, builder, signature, arguments):
        on = _Vectors(context, builder, signature)
        _, to, base, _, number, count, _, first, pitch, width = arguments
        at, zero = variable(builder, ir.Constant(I64, 0)), ir.Constant(I64, 0)
        k, row = variable(builder, zero), variable(builder, zero)
        base = on.spread(base)
        total = variable(builder, base)

        def add(now):
            place = pointer_at(context, builder, factors, arguments[3], builder.add(number, now))
            value = on.load(on.place(arguments, 6, builder.load(row)))
            builder.store(
                on.fused(on.spread(builder.load(place)), value, builder.load(total)), total
            )
            builder.store(builder.add(builder.load(row), pitch), row)

        def write(now):
            builder.store(zero, k)
            builder.store(builder.add(first, now), row)
            builder.store(base, total)
            loop(builder, k, count, 1, add)
            on.store(builder.load(total), on.place(arguments, 0, builder.add(to, now)))

        loop(builder, at, width, LANES, write)
        return context.get_dummy_value()

    number = out.dtype
    return types.void(
        out, whole, number, factors, whole, whole, rows, whole, whole, whole
    ), generate


@intrinsic
@no_type_check
def _filter(typing_context, out, to, factors, rows, pitch, width):
    """Write the products of `PLACES` rows with a matrix of factors."""
    whole = types.int64

    def generate(context, builder, signature, arguments):
        on = _Vectors(context, builder, signature)
        _, to, _, _, pitch, width = arguments
        at = variable(builder, ir.Constant(I64, 0))
        lines = [builder.mul(pitch, ir.Constant(I64, i)) for i in range(PLACES)]

        def write(now):
            values = [on.load(on.place(arguments, 3, builder.add(line, now))) for line in lines]
            for i, line in enumerate(lines):
                total = ir.Constant(values[0].type, [0.0] * LANES)
                for k, value in enumerate(values):
                    number = ir.Constant(I64, i * PLACES + k)
                    place = pointer_at(context, builder, factors, arguments[2], number)
                    total = on.fused(on.spread(builder.load(place)), value, total)
                line = builder.add(builder.add(to, line), now)
                on.store(total, on.place(arguments, 0, line))

        loop(builder, at, width, LANES, write)
        return context.get_dummy_value()

    return types.void(out, whole, factors, rows, whole, whole), generate


_BLOCK = 4


@intrinsic
@no_type_check
def _multiply(typing_context, out, rows, one, other, pitch, jump, times, width):
    """Write the products of 4 rows with 4 others, summed over their width and over some jumps."""
    whole = types.int64

    def generate(context, builder, signature, arguments):
        on = _Vectors(context, builder, signature)
        _, _, *places, pitch, jump, times, width = arguments
        zero = ir.Constant(I64, 0)
        at, turn = variable(builder, zero), variable(builder, zero)
        places = [variable(builder, place) for place in places]
        none = ir.Constant(ir.VectorType(ir.FloatType(), LANES), [0.0] * LANES)
        totals = [variable(builder, none) for _ in range(_BLOCK**2)]

        def four(place, now):
            here = builder.add(builder.load(place), now)
            for _ in range(_BLOCK):
                yield on.load(on.place(arguments, 1, here))
                here = builder.add(here, pitch)

        def add(now):
            a, b = (list(four(place, now)) for place in places)
            pairs = [(u, v) for u in a for v in b]
            for (u, v), total in zip(pairs, totals, strict=True):
                builder.store(on.fused(u, v, builder.load(total)), total)

        def add_all(_):
            builder.store(zero, at)
            loop(builder, at, width, LANES, add)
            for place in places:
                builder.store(builder.add(builder.load(place), jump), place)

        loop(builder, turn, times, 1, add_all)
        sums = folded(builder, [builder.load(total) for total in totals], LANES)
        on.store(sums, on.place(arguments, 0, zero))
        return context.get_dummy_value()

    return types.void(out, rows, whole, whole, whole, whole, whole, whole), generate


@intrinsic
@no_type_check
def _invert(typing_context, matrix):
    """Replace a matrix of `PLACES` rows by its inverse; its smallest pivot, at most 1.

    Gauss-Jordan elimination without pivoting. A symmetric matrix is positive definite if and only
    if all pivots are above 0.
    """

    def generate(context, builder, signature, arguments):
        on = _Vectors(context, builder, signature)
        places = [on.place(arguments, 0, ir.Constant(I64, i * LANES)) for i in range(PLACES)]
        rows = [on.load(place) for place in places]
        one = ir.Constant(ir.DoubleType(), 1.0)
        least = one
        for k in range(PLACES):
            lane = ir.Constant(I32, k)
            pivot = builder.extract_element(rows[k], lane)
            least = builder.select(builder.fcmp_unordered("<", pivot, least), pivot, least)
            inverse = builder.fdiv(one, pivot)
            scaled = builder.fmul(rows[k], on.spread(inverse))
            # a column f becomes f - f (1 + inverse)
            row = builder.insert_element(scaled, builder.fadd(one, inverse), lane)
            for i in range(PLACES):
                if i != k:
                    factor = shuffled(builder, rows[i], rows[i], [k] * LANES)
                    rows[i] = on.fused(factor, row, rows[i], "fsub")
            rows[k] = builder.insert_element(scaled, inverse, lane)
        for row, place in zip(rows, places, strict=True):
            on.store(row, place)
        return least

    return types.float64(matrix), generate


@_compiled
@no_type_check
def _negate(values, first, count):
    for j in range(first, first + count):
        values[j] = -values[j]


_AT_ONCE = 4
"""Matrices whose eigenvalues are found at once: square roots and divisions have a long latency."""
_FLOOR = 1e-200


@intrinsic
@no_type_check
def _sweep(typing_context, d, e, cosines, sines, first, last):
    """One QL step of `_AT_ONCE` tridiagonal matrices; writes the rotations and then a sign.

    The square-root-free form of Pal, Walker and Kahan (LAPACK dsterf).
    """
    whole = types.int64

    def generate(context, builder, signature, arguments):
        on = _Vectors(context, builder, signature, _AT_ONCE)
        first, last = arguments[4:]
        one, floor = ir.Constant(I64, 1), on.constant(_FLOOR)

        def place(array, row):
            return on.place(arguments, array, builder.mul(row, ir.Constant(I64, _AT_ONCE)))

        begin = on.load(place(0, first))
        root = on.root(on.load(place(1, first)))
        apart = builder.fsub(on.load(place(0, builder.add(first, one))), begin)
        ratio = builder.fdiv(builder.fmul(apart, on.constant(0.5)), root)
        length = on.root(on.fused(ratio, ratio, on.constant(1.0)))
        length = builder.fadd(ratio, on.with_sign(length, ratio))
        shift = builder.fsub(begin, builder.fdiv(root, length))
        g = builder.fsub(on.load(place(0, last)), shift)
        g, f = variable(builder, g), variable(builder, builder.fmul(g, g))
        # squares of the cosine and the sine, and the sign of the cosine
        c, s = variable(builder, on.constant(1.0)), variable(builder, on.constant(0.0))
        sign = variable(builder, on.constant(1.0))

        def rotate(now):
            row = builder.sub(builder.sub(last, one), now)
            after = builder.add(row, one)
            square, diagonal = on.load(place(1, row)), on.load(place(0, row))
            old, power, before = builder.load(g), builder.load(f), builder.load(c)
            r = builder.fadd(power, square)
            on.store(on.fused(builder.load(s), r, floor), place(1, after))
            builder.store(builder.fdiv(power, r), c)
            builder.store(builder.fdiv(square, r), s)
            builder.store(on.with_sign(builder.load(sign), old), sign)
            product = builder.fmul(builder.load(s), old)
            new = builder.fsub(
                builder.fmul(builder.load(c), builder.fsub(diagonal, shift)), product
            )
            on.store(builder.fadd(old, builder.fsub(diagonal, new)), place(0, after))
            cosine = builder.fmul(builder.load(sign), on.root(builder.load(c)))
            on.store(cosine, place(2, row))
            on.store(on.root(builder.load(s)), place(3, row))
            usual = builder.fmul(builder.fmul(new, new), builder.fdiv(r, power))
            some = builder.fcmp_ordered(">", power, on.constant(1e-100))
            builder.store(builder.select(some, usual, builder.fmul(before, square)), f)
            builder.store(new, g)

        counter = variable(builder, ir.Constant(I64, 0))
        loop(builder, counter, builder.sub(last, first), 1, rotate)
        on.store(on.fused(builder.load(s), builder.load(f), floor), place(1, first))
        on.store(builder.fadd(shift, builder.load(g)), place(0, first))
        on.store(on.with_sign(builder.load(sign), builder.load(g)), place(2, last))
        return context.get_dummy_value()

    return types.void(d, e, cosines, sines, whole, whole), generate


@_compiled
@no_type_check
def _tridiagonalize(a, v, first, d, e, small, lane, u, q, single, n):
    """Householder tridiagonalization of n rows: diagonal, squares off it, reflections in v.

    ``u`` and ``q`` are a row each, ``single`` are two; the matrix changes.
    """
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
def _diagonalize(v, d, e, cosines, sines, small, count, width, n):
    """Eigenvalues of `_AT_ONCE` tridiagonal matrices, and eigenvectors into the rows of v."""
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
def add_groups(
    noisy,
    pilot,
    features,
    shape,
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
        Values (h, w p), and the estimate of step 1, used if ``second``. Rows of these, of
        ``features`` and ``out`` have `LANES` or more numbers behind.
    features
        Values (q, h, w) that are compared to find similar patches, in standard deviations of the
        noise.
    shape
        h, w and p.
    floor, slope, square
        Variance of the noise of each plane, as of `VarianceLaw`.
    second
        Whether this is step 2.
    radius, stride
        Rows and columns in which patches are sought, and between groups.
    fewest, limit
        Fewest patches of a group, and the squared distance up to which all patches are similar.
    out
        Sum (h, w p) of the weighted estimates.
    weight, activity
        Sums (h w) of the weights, and of the weighted largest gains, of the patches that begin at
        a pixel.
    """
    h, w, p = shape
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
    d, e, small = np.zeros(lanes), np.full(lanes, _FLOOR), np.empty(_AT_ONCE)
    cosines, sines = np.empty(lanes), np.empty(lanes)
    row_u, row_q = u[:PLACES], q[:PLACES]
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
            _tridiagonalize(color.reshape(-1), axes, 0, d, e, small, 0, u, q, single, p)
            _diagonalize(axes, d, e, cosines, sines, small, 1, width, p)
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
                    _tridiagonalize(
                        cov.reshape(-1),
                        vectors,
                        at,
                        d,
                        e,
                        small,
                        found,
                        row_u,
                        row_q,
                        single,
                        PLACES,
                    )
                    solved[found] = k
                    found += 1
                if found and (found == _AT_ONCE or k == p - 1):
                    _diagonalize(vectors, d, e, cosines, sines, small, found, PLACES, PLACES)
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
                            to = start + i * row + s
                            _add(
                                sums_of_values,
                                to,
                                np.float32(1.0),
                                turned,
                                (i * wide + s + j) * LANES,
                            )
                    weight[pixels[first + j]] += share
                    activity[pixels[first + j]] += share * np.float32(active)
