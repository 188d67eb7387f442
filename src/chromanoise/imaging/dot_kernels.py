# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Compiled sums over the bands of pixels: eq. 2, expected electrons of a cube.

Expected electrons are stored numbers times weights. If the compiler may reorder sums, results
differ between processors; if it may not, sums are eight times slower. Therefore the order is
explicit: lane j of eight adds bands j, j + 8, j + 16 ... by fused multiply-add, and the lanes are
folded in halves. The smallest and the largest stored number are found in the same loop, because
each number is read only once.

The cube is read once, in its memory order. If the bands of a pixel are contiguous (BIP), each pixel
is summed by itself; if the pixels of a band are contiguous (BIL, BSQ), a run of pixels is summed
band by band. Both orders are fixed, so results are bit-identical for any choice of blocks.

Functions without annotations are compiled; a tile is ``n`` consecutive pixels.
"""

from functools import partial
from typing import no_type_check

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from chromanoise.imaging.blocks import CHANNELS_AT_ONCE, LANES, RUN_LANES, TILE
from chromanoise.imaging.kernel_cache import inner

F32, I32, I64 = ir.FloatType(), ir.IntType(32), ir.IntType(64)
_WHOLE = types.int64


def multiply_add(builder, lanes):
    """Number of lanes of the fused multiply-add."""
    kind, name = vector_of(lanes), "f32" if lanes == 1 else f"v{lanes}f32"
    signature = ir.FunctionType(kind, [kind] * 3)
    return cgutils.get_or_insert_function(builder.module, signature, f"llvm.fma.{name}")


@intrinsic
@no_type_check
def fused(typing_context, factor, other, term):
    """Factor * other + term of float32, rounded once; for compiled functions."""
    number = types.float32

    def write(builder, *numbers):
        return builder.call(multiply_add(builder, 1), numbers)

    return number(number, number, number), written(write)


def written(write):
    """The code generator of an intrinsic whose instructions ``write`` writes.

    Arrays are given to it as structures with ``data`` and ``shape``.
    """

    def generate(context, builder, signature, arguments):
        values = [
            context.make_array(kind)(context, builder, value)
            if isinstance(kind, types.Array)
            else value
            for kind, value in zip(signature.args, arguments, strict=True)
        ]
        returned = write(builder, *values)
        return context.get_dummy_value() if returned is None else returned

    return generate


def _as_float(builder, value, kind, wanted):
    """Stored numbers of any type as float32."""
    if isinstance(kind, types.Float):
        return value if kind.bitwidth == 32 else builder.fptrunc(value, wanted)
    return builder.sitofp(value, wanted) if kind.signed else builder.uitofp(value, wanted)


def vector_of(lanes):
    """The type of so many float32."""
    return F32 if lanes == 1 else ir.VectorType(F32, lanes)


def loaded(builder, pointer, kind, width):
    """``width`` stored numbers as float32; unaligned, as a picture's rows are."""
    element = pointer.type.pointee
    if width == 1:
        return _as_float(builder, builder.load(pointer), kind, F32)
    vector = ir.VectorType(element, width)
    value = builder.load(
        builder.bitcast(pointer, vector.as_pointer()), align=max(kind.bitwidth // 8, 1)
    )
    return _as_float(builder, value, kind, vector_of(width))


def vector_at(builder, pointer, width):
    """``width`` float32 from ``pointer`` on."""
    return builder.load(builder.bitcast(pointer, vector_of(width).as_pointer()), align=4)


def some_loaded(builder, pointer, kind, count):
    """The next ``count`` < `LANES` stored numbers; the other lanes repeat the first of them."""
    element = pointer.type.pointee
    others = spread(builder, builder.load(pointer), LANES)
    numbers = ir.Constant(ir.VectorType(I64, LANES), list(range(LANES)))
    mask = builder.icmp_signed("<", numbers, spread(builder, count, LANES))
    suffix = {"float": "f32", "double": "f64"}.get(str(element), str(element))
    place = builder.bitcast(pointer, others.type.as_pointer())
    signature = ir.FunctionType(others.type, [place.type, I32, mask.type, others.type])
    name = f"llvm.masked.load.v{LANES}{suffix}.p0"
    function = cgutils.get_or_insert_function(builder.module, signature, name)
    align = I32(max(kind.bitwidth // 8, 1))
    value = builder.call(function, [place, align, mask, others])
    return _as_float(builder, value, kind, vector_of(LANES))


def _further(builder, value, known, sign):
    """The lower (or higher) of each lane; a NaN is passed over here and shows in the sums."""
    return builder.select(builder.fcmp_ordered(sign, value, known), value, known)


def shuffled(builder, a, b, lanes):
    """These lanes of two vectors."""
    mask = ir.Constant(ir.VectorType(I32, len(lanes)), lanes)
    return builder.shuffle_vector(a, b, mask)


def folded(builder, vectors, lanes=LANES):
    """Horizontal sum of each vector, by pairwise folding; their number is a power of 2."""
    apart = lanes  # lanes of each sum that remain to be added
    count = len(vectors)
    while len(vectors) > 1:
        apart //= 2
        first = [lane for lane in range(lanes) if not lane & apart]
        lower = first + [lanes + lane for lane in first]
        upper = [lane + apart for lane in lower]
        vectors = [
            builder.fadd(shuffled(builder, a, b, lower), shuffled(builder, a, b, upper))
            for a, b in zip(vectors[::2], vectors[1::2], strict=True)
        ]
    (total,) = vectors
    while apart > 1:
        apart //= 2
        order = [lane ^ apart for lane in range(lanes)]
        total = builder.fadd(total, shuffled(builder, total, total, order))
    sums = [lanes // count * c for c in range(count)]
    return shuffled(builder, total, total, sums)


def loop(builder, counter, stop, step, body):
    """While counter + step <= stop: body, counter += step."""
    test = builder.append_basic_block("test")
    inside = builder.append_basic_block("inside")
    after = builder.append_basic_block("after")
    builder.branch(test)
    builder.position_at_end(test)
    at = builder.load(counter)
    ahead = builder.add(at, I64(step))
    builder.cbranch(builder.icmp_signed("<=", ahead, stop), inside, after)
    builder.position_at_end(inside)
    body(at)
    builder.store(ahead, counter)
    builder.branch(test)
    builder.position_at_end(after)


def weight_rows(builder, weights, numbers):
    """Where the rows of weights begin."""
    pitch = cgutils.unpack_tuple(builder, weights.shape)[1]
    return [builder.gep(weights.data, [builder.mul(pitch, number)]) for number in numbers]


class Extremes:
    """The least and the greatest of each lane, in registers until they are kept."""

    def __init__(self, builder, least, lanes=LANES):
        self.builder = builder
        greatest = builder.gep(least, [I64(LANES)])
        pointer = vector_of(lanes).as_pointer()
        self.ends = [builder.bitcast(end, pointer) for end in (least, greatest)]
        self.known = [variable(builder, builder.load(end, align=4)) for end in self.ends]

    def see(self, value):
        """Take a vector into account."""
        builder = self.builder
        for known, sign in zip(self.known, ("<", ">"), strict=True):
            builder.store(_further(builder, value, builder.load(known), sign), known)

    def keep(self):
        """Write them where they came from."""
        for known, end in zip(self.known, self.ends, strict=True):
            self.builder.store(self.builder.load(known), end, align=4)


def variable(builder, value):
    """A place that the compiler can keep in a register."""
    place = cgutils.alloca_once(builder, value.type)
    builder.store(value, place)
    return place


def spread(builder, value, lanes):
    """One number in every lane."""
    if lanes == 1:
        return value
    undefined = ir.Constant(ir.VectorType(value.type, lanes), ir.Undefined)
    one = builder.insert_element(undefined, value, I32(0))
    return shuffled(builder, one, undefined, [0] * lanes)


def ask_memory(builder, pointer, cache):
    """Ask for the line at ``pointer``, into this cache; beyond the array nothing happens."""
    pointer = builder.bitcast(pointer, ir.IntType(8).as_pointer())
    kind = ir.FunctionType(ir.VoidType(), [pointer.type, I32, I32, I32])
    function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
    read, near, data = (I32(v) for v in (0, 4 - cache, 1))
    builder.call(function, [pointer, read, near, data])


def ask_ahead(builder, pointer, distances):
    """Ask for what lies so many numbers after ``pointer``, into the caches of ``distances``."""
    for cache, numbers in distances.items():
        ask_memory(builder, builder.gep(pointer, [I64(numbers)]), cache)


_UNROLLED = 4  # unroll factor of the loop over the bands of a pixel
_LINE = 16  # float32 numbers per cache line
# Prefetch distances, in numbers, per cache level. The far prefetch overlaps memory access with the
# sums; the near one loads the first cache. For pixels of a band there is no near prefetch, because
# sixteen lines of eight bands may map to the same set of the first cache.
_AHEAD = {1: 1024, 2: 8192}
_AHEAD_OF_BAND = {2: 768}


@intrinsic
@no_type_check
def _add_pixels(
    typing_context, stored, start, pitch, n, bands, weights, channel, out, first, step, seen
):
    """Sum four channels of a run of pixels.

    ``stored`` is a flat array of any number type; a pixel is ``bands`` numbers from ``start``, the
    next one begins ``pitch`` further. ``weights`` is float32, (channels, bands rounded up to 16,
    the rest 0); the sums of the four channels from ``channel`` on go to the flat ``out``, those of
    pixel i to ``first + i * step`` and behind. ``seen`` float32 keeps the least and, behind, the
    greatest stored number of each lane.
    """
    kind = stored.dtype

    def write(builder, stored, start, pitch, n, bands, weights, channel, out, first, step, seen):
        begin, goal = builder.gep(stored.data, [start]), builder.gep(out.data, [first])
        rows = weight_rows(builder, weights, [builder.add(channel, I64(c)) for c in range(4)])
        extremes = Extremes(builder, seen.data)
        counter = variable(builder, I64(0))

        def sums_of(at, *, into_next):
            pixel = builder.gep(begin, [builder.mul(at, pitch)])
            totals = _pixel_sums(builder, pixel, kind, bands, rows, extremes, into_next=into_next)
            place = builder.gep(goal, [builder.mul(at, step)])
            four = vector_of(4).as_pointer()
            builder.store(folded(builder, totals), builder.bitcast(place, four), align=4)

        # if the next pixel follows directly, the last lanes may read from it: their weight is
        # 0; the last `LANES` pixels leave room for that however few bands there are
        together = builder.icmp_signed("==", pitch, bands)
        most = builder.select(together, builder.sub(n, I64(LANES)), I64(0))
        loop(builder, counter, most, 1, partial(sums_of, into_next=True))
        loop(builder, counter, n, 1, partial(sums_of, into_next=False))
        extremes.keep()

    return types.void(
        stored, _WHOLE, _WHOLE, _WHOLE, _WHOLE, weights, _WHOLE, out, _WHOLE, _WHOLE, seen
    ), written(write)


def _pixel_sums(builder, pixel, kind, bands, rows, extremes, *, into_next):
    """Lanes of the sums of one pixel, one vector for each row of weights.

    The memory is asked where the loop is written out: only there do answers come in time.
    """
    zero = ir.Constant(vector_of(LANES), [0.0] * LANES)
    totals = [variable(builder, zero) for _ in rows]
    fma = multiply_add(builder, LANES)

    def add(at, load):
        value = load(builder.gep(pixel, [at]))
        for row, total in zip(rows, totals, strict=True):
            weight = vector_at(builder, builder.gep(row, [at]), LANES)
            builder.store(builder.call(fma, [value, weight, builder.load(total)]), total)
        extremes.see(value)

    def whole(place):
        return loaded(builder, place, kind, LANES)

    def some(at):
        for k in range(0, _UNROLLED * LANES, LANES):
            here = builder.add(at, I64(k))
            if k % _LINE == 0:
                ask_ahead(builder, builder.gep(pixel, [here]), _AHEAD)
            add(here, whole)

    counter = variable(builder, I64(0))
    stop = builder.add(bands, I64(LANES - 1)) if into_next else bands
    loop(builder, counter, stop, _UNROLLED * LANES, some)
    loop(builder, counter, stop, LANES, lambda at: add(at, whole))
    if not into_next:
        at = builder.load(counter)
        with builder.if_then(builder.icmp_signed("<", at, bands)):
            rest = builder.sub(bands, at)
            add(at, lambda place: some_loaded(builder, place, kind, rest))
    return [builder.load(total) for total in totals]


@intrinsic
@no_type_check
def weighted_sum(typing_context, stored, start, bands, weights, row, seen):
    """The sum of one pixel with one row of weights; arguments as `_add_pixels` has them."""
    kind = stored.dtype

    def write(builder, stored, start, bands, weights, row, seen):
        pixel = builder.gep(stored.data, [start])
        rows = weight_rows(builder, weights, [row])
        extremes = Extremes(builder, seen.data)
        totals = _pixel_sums(builder, pixel, kind, bands, rows, extremes, into_next=False)
        extremes.keep()
        return builder.extract_element(folded(builder, totals), I32(0))

    return types.float32(stored, _WHOLE, _WHOLE, weights, _WHOLE, seen), written(write)


def band_adder(count):
    """The compiled function that adds ``count`` bands of a run of pixels to four channels' sums.

    (stored, start, pitch, n, weights, channel, band, sums, tile, seen) -> nothing. ``stored`` is a
    flat array of any number type in which band k of the run starts at ``start + k * pitch``;
    ``sums`` holds channel c at ``c * tile``; ``seen`` is that of `_add_pixels`. Sixteen pixels at
    a time, band after band by fused multiply-add, to four channels from ``channel`` on: their sums
    stay in registers meanwhile.
    """

    @intrinsic
    @no_type_check
    def add(typing_context, stored, start, pitch, n, weights, channel, band, sums, tile, seen):
        kind = stored.dtype

        def write(builder, stored, start, pitch, n, weights, channel, band, sums, tile, seen):
            slots = [builder.add(channel, I64(c)) for c in range(4)]
            totals = [builder.gep(sums.data, [builder.mul(tile, slot)]) for slot in slots]
            rows = weight_rows(builder, weights, slots)

            def factor(c, k, at, lanes):
                place = builder.gep(rows[c], [builder.add(band, I64(k))])
                return spread(builder, builder.load(place), lanes)

            planes = _planes(builder, stored, start, pitch, count)
            _add_bands(builder, n, planes, kind, totals, factor, seen)

        return types.void(
            stored, _WHOLE, _WHOLE, _WHOLE, weights, _WHOLE, _WHOLE, sums, _WHOLE, seen
        ), written(write)

    return add


def own_band_adder(count):
    """The compiled function that adds ``count`` bands to the sums of a run, each with its weight.

    (stored, start, pitch, n, table, band, sums, seen) -> nothing: as `band_adder`, but pixel i has
    one sum only, at sums[i], and its weight of band b stands at table[b * 16 + i % 16].
    """

    @intrinsic
    @no_type_check
    def add(typing_context, stored, start, pitch, n, table, band, sums, seen):
        kind, of_table = stored.dtype, table.dtype

        def write(builder, stored, start, pitch, n, table, band, sums, seen):
            own = builder.gep(table.data, [builder.mul(band, I64(RUN_LANES))])

            def factor(_, k, at, lanes):
                column = builder.and_(at, I64(RUN_LANES - 1))
                place = builder.add(column, I64(k * RUN_LANES))
                return loaded(builder, builder.gep(own, [place]), of_table, lanes)

            planes = _planes(builder, stored, start, pitch, count)
            _add_bands(builder, n, planes, kind, [sums.data], factor, seen)

        return types.void(stored, _WHOLE, _WHOLE, _WHOLE, table, _WHOLE, sums, seen), written(write)

    return add


def _planes(builder, stored, start, pitch, count):
    """Where ``count`` bands of a run begin."""
    steps = [builder.mul(pitch, I64(k)) for k in range(count)]
    return [builder.gep(stored.data, [builder.add(start, step)]) for step in steps]


def _add_bands(builder, n, planes, kind, totals, factor, seen):
    """The loops of `band_adder` and `own_band_adder`: `RUN_LANES` pixels at a time, then one."""
    counter = variable(builder, I64(0))
    for lanes in (RUN_LANES, 1):
        _add_to_pixels(builder, counter, n, lanes, planes, kind, totals, factor, seen)


def _add_to_pixels(builder, counter, n, lanes, planes, kind, totals, factor, seen):
    """The loop over ``lanes`` pixels at a time."""
    fma = multiply_add(builder, lanes)
    extremes = Extremes(builder, seen.data, min(lanes, LANES))

    def body(at):
        places = [
            builder.bitcast(builder.gep(total, [at]), vector_of(lanes).as_pointer())
            for total in totals
        ]
        now = [builder.load(place, align=4) for place in places]
        for k, plane in enumerate(planes):
            here = builder.gep(plane, [at])
            ask_ahead(builder, here, _AHEAD_OF_BAND)
            value = loaded(builder, here, kind, lanes)
            now = [
                builder.call(fma, [value, factor(c, k, at, lanes), total])
                for c, total in enumerate(now)
            ]
            for first in range(0, lanes, LANES):
                some = list(range(first, first + LANES))
                extremes.see(value if lanes == 1 else shuffled(builder, value, value, some))
        for place, total in zip(places, now, strict=True):
            builder.store(total, place, align=4)

    loop(builder, counter, n, lanes, body)
    extremes.keep()


BANDS_AT_ONCE = 8
"""Bands per pass, limited by the hardware prefetcher; sums are loaded and stored once per pass."""

_AGAIN = 128  # pixels that stay in the cache until all channels are summed
_ZERO = np.float32(0.0)
_add_some, _add_one = band_adder(BANDS_AT_ONCE), band_adder(1)
_add_some_own, _add_own = own_band_adder(BANDS_AT_ONCE), own_band_adder(1)


@inner
@no_type_check
def means_of_pixels(flat, start, pitch, n, bands, weights, fours, seen):
    """All channels of ``n`` pixels, ``pitch`` apart, whose bands lie together from ``flat[start]``.

    weights (p rounded up to 4, bands rounded up to 16) float32, the rest 0; fours (p / 4, n or
    more, 4) float32: four channels side by side at each pixel; seen (2 * `LANES`,) float32: least
    and greatest stored numbers so far.
    """
    every, step = fours.reshape(-1), CHANNELS_AT_ONCE
    for i in range(0, n, _AGAIN):
        at, some = start + i * pitch, min(_AGAIN, n - i)
        for c in range(0, weights.shape[0], step):
            first = c * fours.shape[1] + step * i
            _add_pixels(flat, at, pitch, some, bands, weights, c, every, first, step, seen)


@inner
@no_type_check
def means_of_mosaic(flat, start, pitch, n, bands, weights, channel, out, seen):
    """Only the channel over each pixel: channel (n,) int64, out (n,)."""
    for i in range(n):
        at = start + i * pitch
        out[i] = weighted_sum(flat, at, bands, weights, channel[i], seen)


@inner
@no_type_check
def means_of_planes(flat, start, band_pitch, n, bands, weights, sums, seen):
    """All channels of ``n`` <= `TILE` pixels whose neighbors lie together: sums (p * TILE,).

    Channel c of pixel i is sums[c * TILE + i].
    """
    channels = weights.shape[0]
    for j in range(channels * TILE):
        sums[j] = _ZERO
    whole = bands - bands % BANDS_AT_ONCE
    for b in range(0, whole, BANDS_AT_ONCE):
        at = start + b * band_pitch
        for c in range(0, channels, CHANNELS_AT_ONCE):
            _add_some(flat, at, band_pitch, n, weights, c, b, sums, TILE, seen)
    for b in range(whole, bands):
        at = start + b * band_pitch
        for c in range(0, channels, CHANNELS_AT_ONCE):
            _add_one(flat, at, band_pitch, n, weights, c, b, sums, TILE, seen)


@inner
@no_type_check
def weights_over_columns(weights, over, bands):
    """The weight of each band at each of `RUN_LANES` columns: (tile rows, bands * RUN_LANES).

    Where the columns of a mosaic repeat in that many, each pixel of a band needs one product only.
    """
    table = np.zeros((over.shape[0], bands * RUN_LANES), np.float32)
    for row in range(over.shape[0]):
        for i in range(min(RUN_LANES, over.shape[1])):
            for b in range(bands):
                table[row, b * RUN_LANES + i] = weights[over[row, i], b]
    return table


@inner
@no_type_check
def means_of_mosaic_planes(flat, start, lay, rows, n, tables, phase, out, seen):
    """Only the channel over each of ``n`` pixels of some rows: out (rows * n,).

    tables: of `weights_over_columns`, its row ``phase`` for the first one; the first pixel of a row
    stands at a multiple of their columns.
    """
    for i in range(rows * n):
        out[i] = _ZERO
    whole = lay.bands - lay.bands % BANDS_AT_ONCE
    for b in range(0, whole, BANDS_AT_ONCE):
        for row in range(rows):
            at, there = start + b * lay.band_pitch + row * lay.row_pitch, out[row * n :]
            table = tables[(phase + row) % tables.shape[0]]
            _add_some_own(flat, at, lay.band_pitch, n, table, b, there, seen)
    for b in range(whole, lay.bands):
        for row in range(rows):
            at, there = start + b * lay.band_pitch + row * lay.row_pitch, out[row * n :]
            table = tables[(phase + row) % tables.shape[0]]
            _add_own(flat, at, lay.band_pitch, n, table, b, there, seen)
