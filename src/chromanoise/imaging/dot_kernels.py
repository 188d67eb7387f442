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

# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"


F32, I32, I64 = ir.FloatType(), ir.IntType(32), ir.IntType(64)


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

    def generate(context, builder, signature, arguments):
        return builder.call(multiply_add(builder, 1), arguments)

    return number(number, number, number), generate


def pointer_at(context, builder, kind, array, offset):
    """Where a number of an array lies."""
    return builder.gep(context.make_array(kind)(context, builder, array).data, [offset])


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
    first = builder.load(pointer)
    vector = ir.VectorType(element, LANES)
    undefined = ir.Constant(vector, ir.Undefined)
    one = builder.insert_element(undefined, first, ir.Constant(I32, 0))
    zeros = ir.Constant(ir.VectorType(I32, LANES), [0] * LANES)
    others = builder.shuffle_vector(one, undefined, zeros)
    numbers = ir.Constant(ir.VectorType(I64, LANES), list(range(LANES)))
    wide = builder.insert_element(
        ir.Constant(ir.VectorType(I64, LANES), ir.Undefined), count, ir.Constant(I32, 0)
    )
    wide = builder.shuffle_vector(wide, wide, zeros)
    mask = builder.icmp_signed("<", numbers, wide)
    suffix = {"float": "f32", "double": "f64"}.get(str(element), str(element))
    place = builder.bitcast(pointer, vector.as_pointer())
    signature = ir.FunctionType(vector, [place.type, I32, mask.type, vector])
    name = f"llvm.masked.load.v{LANES}{suffix}.p0"
    function = cgutils.get_or_insert_function(builder.module, signature, name)
    align = ir.Constant(I32, max(kind.bitwidth // 8, 1))
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
    ahead = builder.add(at, ir.Constant(I64, step))
    builder.cbranch(builder.icmp_signed("<=", ahead, stop), inside, after)
    builder.position_at_end(inside)
    body(at)
    builder.store(ahead, counter)
    builder.branch(test)
    builder.position_at_end(after)


def weight_rows(context, builder, kind, weights, numbers):
    """Where the rows of weights begin."""
    table = context.make_array(kind)(context, builder, weights)
    pitch = cgutils.unpack_tuple(builder, table.shape)[1]
    return [builder.gep(table.data, [builder.mul(pitch, number)]) for number in numbers]


class Extremes:
    """The least and the greatest of each lane, in registers until they are kept."""

    def __init__(self, builder, least, lanes=LANES):
        self.builder = builder
        greatest = builder.gep(least, [ir.Constant(I64, LANES)])
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
    undefined = ir.Constant(vector_of(lanes), ir.Undefined)
    one = builder.insert_element(undefined, value, ir.Constant(I32, 0))
    mask = ir.Constant(ir.VectorType(I32, lanes), [0] * lanes)
    return builder.shuffle_vector(one, undefined, mask)


def ask_memory(builder, pointer, cache):
    """Ask for the line at ``pointer``, into this cache; beyond the array nothing happens."""
    pointer = builder.bitcast(pointer, ir.IntType(8).as_pointer())
    kind = ir.FunctionType(ir.VoidType(), [pointer.type, I32, I32, I32])
    function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
    read, near, data = (ir.Constant(I32, v) for v in (0, 4 - cache, 1))
    builder.call(function, [pointer, read, near, data])


def ask_ahead(builder, pointer, distances):
    """Ask for what lies so many numbers after ``pointer``, into the caches of ``distances``."""
    for cache, numbers in distances.items():
        ask_memory(builder, builder.gep(pointer, [ir.Constant(I64, numbers)]), cache)


# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"


_UNROLLED = 4  # unroll factor of the loop over the bands of a pixel
_LINE = 16  # float32 numbers per cache line
# Prefetch distances, in numbers, per cache level. The far prefetch overlaps memory access with the
# sums; the near one loads the first cache. For pixels of a band there is no near prefetch, because
# sixteen lines of eight bands may map to the same set of the first cache.
_AHEAD = {1: 1024, 2: 8192}
_AHEAD_OF_BAND = {2: 768}


def pixel_adder():
    """The compiled function that sums four channels of a run of pixels.

    (stored, start, pitch, n, bands, weights, channel, out, first, step, seen) -> nothing.
    ``stored`` is a flat array of any number type; a pixel is ``bands`` numbers from ``start``, the
    next one begins ``pitch`` further. ``weights`` is float32, (channels, bands rounded up to 16,
    the rest 0); the sums of the four channels from ``channel`` on go to the flat ``out``, those of
    pixel i to ``first + i * step`` and behind. ``seen`` float32 keeps the least and, behind, the
    greatest stored number of each lane.
    """

    @intrinsic
    @no_type_check
    def add(
        typing_context, stored, start, pitch, n, bands, weights, channel, out, first, step, seen
    ):
        whole = types.int64
        signature = types.void(
            stored, whole, whole, whole, whole, weights, whole, out, whole, whole, seen
        )

        def generate(context, builder, signature, arguments):
            kinds = signature.args
            x, start, pitch, n, bands, w, channel, out, first, step, seen = arguments
            begin = pointer_at(context, builder, kinds[0], x, start)
            goal = pointer_at(context, builder, kinds[7], out, first)
            numbers = [builder.add(channel, ir.Constant(I64, c)) for c in range(4)]
            rows = weight_rows(context, builder, kinds[5], w, numbers)
            extremes = Extremes(builder, context.make_array(kinds[10])(context, builder, seen).data)
            counter = variable(builder, ir.Constant(I64, 0))

            def sums_of(at, *, into_next):
                pixel = builder.gep(begin, [builder.mul(at, pitch)])
                totals = _pixel_sums(
                    builder,
                    pixel,
                    kinds[0].dtype,
                    bands,
                    rows,
                    extremes,
                    into_next=into_next,
                )
                place = builder.gep(goal, [builder.mul(at, step)])
                four = ir.VectorType(F32, 4).as_pointer()
                builder.store(folded(builder, totals), builder.bitcast(place, four), align=4)

            # if the next pixel follows directly, the last lanes may read from it: their weight is
            # 0; the last `LANES` pixels leave room for that however few bands there are
            together = builder.icmp_signed("==", pitch, bands)
            most = builder.sub(n, ir.Constant(I64, LANES))
            most = builder.select(together, most, ir.Constant(I64, 0))
            loop(builder, counter, most, 1, partial(sums_of, into_next=True))
            loop(builder, counter, n, 1, partial(sums_of, into_next=False))
            extremes.keep()
            return context.get_dummy_value()

        return signature, generate

    return add


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
            here = builder.add(at, ir.Constant(I64, k))
            if k % _LINE == 0:
                ask_ahead(builder, builder.gep(pixel, [here]), _AHEAD)
            add(here, whole)

    counter = variable(builder, ir.Constant(I64, 0))
    stop = builder.add(bands, ir.Constant(I64, LANES - 1)) if into_next else bands
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
    """The sum of one pixel with one row of weights; arguments as `pixel_adder` has them."""
    whole = types.int64
    signature = types.float32(stored, whole, whole, weights, whole, seen)

    def generate(context, builder, signature, arguments):
        kinds = signature.args
        x, start, bands, w, row, seen = arguments
        pixel = pointer_at(context, builder, kinds[0], x, start)
        rows = weight_rows(context, builder, kinds[3], w, [row])
        extremes = Extremes(builder, context.make_array(kinds[5])(context, builder, seen).data)
        totals = _pixel_sums(builder, pixel, kinds[0].dtype, bands, rows, extremes, into_next=False)
        extremes.keep()
        return builder.extract_element(folded(builder, totals), ir.Constant(I32, 0))

    return signature, generate


def band_adder(count):
    """The compiled function that adds ``count`` bands of a run of pixels to four channels' sums.

    (stored, start, pitch, n, weights, channel, band, sums, tile, seen) -> nothing. ``stored`` is a
    flat array of any number type in which band k of the run starts at ``start + k * pitch``;
    ``sums`` holds channel c at ``c * tile``; ``seen`` is that of `pixel_adder`. Sixteen pixels at
    a time, band after band by fused multiply-add, to four channels from ``channel`` on: their sums
    stay in registers meanwhile.
    """

    @intrinsic
    @no_type_check
    def add(typing_context, stored, start, pitch, n, weights, channel, band, sums, tile, seen):
        whole = types.int64
        signature = types.void(
            stored, whole, whole, whole, weights, whole, whole, sums, whole, seen
        )

        def generate(context, builder, signature, arguments):
            kinds = signature.args
            x, start, pitch, n, w, channel, band, sums, tile, seen = arguments
            planes = _planes(context, builder, kinds[0], x, start, pitch, count)
            slots = [builder.add(channel, ir.Constant(I64, c)) for c in range(4)]
            totals = [
                pointer_at(context, builder, kinds[7], sums, builder.mul(tile, slot))
                for slot in slots
            ]
            rows = weight_rows(context, builder, kinds[4], w, slots)

            def factor(c, k, at, lanes):
                place = builder.gep(rows[c], [builder.add(band, ir.Constant(I64, k))])
                return spread(builder, builder.load(place), lanes)

            least = context.make_array(kinds[9])(context, builder, seen).data
            counter = variable(builder, ir.Constant(I64, 0))
            for lanes in (RUN_LANES, 1):
                _add_bands(
                    builder, counter, n, lanes, planes, kinds[0].dtype, totals, factor, least
                )
            return context.get_dummy_value()

        return signature, generate

    return add


def own_band_adder(count):
    """The compiled function that adds ``count`` bands to the sums of a run, each with its weight.

    (stored, start, pitch, n, table, band, sums, seen) -> nothing: as `band_adder`, but pixel i has
    one sum only, at sums[i], and its weight of band b stands at table[b * 16 + i % 16].
    """

    @intrinsic
    @no_type_check
    def add(typing_context, stored, start, pitch, n, table, band, sums, seen):
        whole = types.int64
        signature = types.void(stored, whole, whole, whole, table, whole, sums, seen)

        def generate(context, builder, signature, arguments):
            kinds = signature.args
            x, start, pitch, n, table, band, sums, seen = arguments
            planes = _planes(context, builder, kinds[0], x, start, pitch, count)
            totals = [context.make_array(kinds[6])(context, builder, sums).data]
            first = builder.mul(band, ir.Constant(I64, RUN_LANES))
            own = pointer_at(context, builder, kinds[4], table, first)
            least = context.make_array(kinds[7])(context, builder, seen).data

            def factor(_, k, at, lanes):
                column = builder.and_(at, ir.Constant(I64, RUN_LANES - 1))
                place = builder.add(column, ir.Constant(I64, k * RUN_LANES))
                return loaded(builder, builder.gep(own, [place]), kinds[4].dtype, lanes)

            counter = variable(builder, ir.Constant(I64, 0))
            for lanes in (RUN_LANES, 1):
                _add_bands(
                    builder, counter, n, lanes, planes, kinds[0].dtype, totals, factor, least
                )
            return context.get_dummy_value()

        return signature, generate

    return add


def _planes(context, builder, kind, stored, start, pitch, count):
    """Where ``count`` bands of a run begin."""
    steps = [builder.mul(pitch, ir.Constant(I64, k)) for k in range(count)]
    return [pointer_at(context, builder, kind, stored, builder.add(start, s)) for s in steps]


def _add_bands(builder, counter, n, lanes, planes, kind, totals, factor, least):
    """The loop of `band_adder` and `own_band_adder` over ``lanes`` pixels at a time."""
    fma = multiply_add(builder, lanes)
    extremes = Extremes(builder, least, min(lanes, LANES))

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


# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"


BANDS_AT_ONCE = 8
"""Bands per pass, limited by the hardware prefetcher; sums are loaded and stored once per pass."""

_AGAIN = 128  # pixels that stay in the cache until all channels are summed
_ZERO = np.float32(0.0)
_add_some, _add_one = band_adder(BANDS_AT_ONCE), band_adder(1)
_add_pixels = pixel_adder()
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
