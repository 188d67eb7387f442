# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Compiled sums over the bands of pixels: for one pixel or a run, by pixel or by band."""

from functools import partial
from typing import no_type_check

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from chromanoise.imaging.blocks import LANES, RUN_LANES
from chromanoise.imaging.simd import (
    F32,
    I32,
    I64,
    Extremes,
    ask_ahead,
    folded,
    loaded,
    loop,
    multiply_add,
    pointer_at,
    shuffled,
    some_loaded,
    spread,
    variable,
    vector_at,
    vector_of,
    weight_rows,
)

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
