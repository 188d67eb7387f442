# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Sums over the bands of one pixel, sixteen bands at a time and always in the same order.

A compiler that may reorder a sum gives other bits on another processor; one that may not is eight
times slower. So the order is written down: lane j of sixteen adds bands j, j + 16, j + 32 ... by
fused multiply-add, and the lanes are folded in halves. The smallest and the largest stored number
are found on the way, because each number is read only once.
"""

from typing import no_type_check

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

LANES = 16
_F32, _I32, _I64 = ir.FloatType(), ir.IntType(32), ir.IntType(64)
_LANES = ir.VectorType(_F32, LANES)


def _fma(builder, kind, name):
    signature = ir.FunctionType(kind, [kind] * 3)
    return cgutils.get_or_insert_function(builder.module, signature, f"llvm.fma.{name}")


def _pointer(context, builder, kind, array, offset):
    return builder.gep(context.make_array(kind)(context, builder, array).data, [offset])


def _as_float(builder, value, kind, wanted):
    """Stored numbers of any type as float32."""
    if isinstance(kind, types.Float):
        return value if kind.bitwidth == 32 else builder.fptrunc(value, wanted)
    return builder.sitofp(value, wanted) if kind.signed else builder.uitofp(value, wanted)


def _loaded(builder, pointer, kind, width):
    """``width`` stored numbers as float32; unaligned, as a picture's rows are."""
    element = pointer.type.pointee
    if width == 1:
        return _as_float(builder, builder.load(pointer), kind, _F32)
    vector = ir.VectorType(element, width)
    value = builder.load(
        builder.bitcast(pointer, vector.as_pointer()), align=max(kind.bitwidth // 8, 1)
    )
    return _as_float(builder, value, kind, ir.VectorType(_F32, width))


def _some_loaded(builder, pointer, kind, count):
    """The next ``count`` < 16 stored numbers; the other lanes repeat the first of them."""
    element = pointer.type.pointee
    first = builder.load(pointer)
    vector = ir.VectorType(element, LANES)
    undefined = ir.Constant(vector, ir.Undefined)
    one = builder.insert_element(undefined, first, ir.Constant(_I32, 0))
    zeros = ir.Constant(ir.VectorType(_I32, LANES), [0] * LANES)
    others = builder.shuffle_vector(one, undefined, zeros)
    numbers = ir.Constant(ir.VectorType(_I64, LANES), list(range(LANES)))
    wide = builder.insert_element(
        ir.Constant(ir.VectorType(_I64, LANES), ir.Undefined), count, ir.Constant(_I32, 0)
    )
    wide = builder.shuffle_vector(wide, wide, zeros)
    mask = builder.icmp_signed("<", numbers, wide)
    suffix = {"float": "f32", "double": "f64"}.get(str(element), str(element))
    place = builder.bitcast(pointer, vector.as_pointer())
    signature = ir.FunctionType(vector, [place.type, _I32, mask.type, vector])
    name = f"llvm.masked.load.v{LANES}{suffix}.p0"
    function = cgutils.get_or_insert_function(builder.module, signature, name)
    align = ir.Constant(_I32, max(kind.bitwidth // 8, 1))
    value = builder.call(function, [place, align, mask, others])
    return _as_float(builder, value, kind, _LANES)


def _further(builder, value, known, sign):
    """The lower (or higher) of each lane; a NaN is passed over here and shows in the sums."""
    return builder.select(builder.fcmp_ordered(sign, value, known), value, known)


def _shuffled(builder, a, b, lanes):
    mask = ir.Constant(ir.VectorType(_I32, len(lanes)), lanes)
    return builder.shuffle_vector(a, b, mask)


def _folded(builder, vectors):
    """Each vector's sixteen lanes to one sum, halves onto halves; four vectors in one go."""
    if len(vectors) == 1:
        (total,) = vectors
        for half in (8, 4, 2, 1):
            order = [(lane + half) % LANES for lane in range(LANES)]
            total = builder.fadd(total, _shuffled(builder, total, total, order))
        return [builder.extract_element(total, ir.Constant(_I32, 0))]
    for half in (8, 4):  # eight, then four lanes of each vector are left apart
        first = [lane for lane in range(LANES) if not lane & half]
        lower = first + [LANES + lane for lane in first]
        upper = [lane + half for lane in lower]
        vectors = [
            builder.fadd(_shuffled(builder, a, b, lower), _shuffled(builder, a, b, upper))
            for a, b in zip(vectors[::2], vectors[1::2], strict=True)
        ]
    (total,) = vectors
    for half in (2, 1):
        order = [lane ^ half for lane in range(LANES)]
        total = builder.fadd(total, _shuffled(builder, total, total, order))
    return [builder.extract_element(total, ir.Constant(_I32, 4 * c)) for c in range(4)]


def _loop(builder, counter, stop, step, body):
    """While counter + step <= stop: body, counter += step."""
    test = builder.append_basic_block("test")
    inside = builder.append_basic_block("inside")
    after = builder.append_basic_block("after")
    builder.branch(test)
    builder.position_at_end(test)
    at = builder.load(counter)
    ahead = builder.add(at, ir.Constant(_I64, step))
    builder.cbranch(builder.icmp_signed("<=", ahead, stop), inside, after)
    builder.position_at_end(inside)
    body(at)
    builder.store(ahead, counter)
    builder.branch(test)
    builder.position_at_end(after)


def weighted_sums(width):
    """The compiled function (stored, start, bands, weights, row, seen) -> width sums.

    ``stored`` is a flat array of any number type, of which ``bands`` numbers from ``start`` are
    one pixel; ``weights`` is float32, (channels, bands rounded up to 16, the rest 0), of which
    ``width`` rows (1 or 4) from ``row`` are used; ``seen`` (32,) float32 keeps the least and the
    greatest stored number of each lane.
    """

    @intrinsic
    @no_type_check
    def sums(typing_context, stored, start, bands, weights, row, seen):
        result = types.UniTuple(types.float32, width)
        whole = types.int64
        signature = result(stored, whole, whole, weights, whole, seen)

        def generate(context, builder, signature, arguments):
            kinds = signature.args
            x, start, bands, w, row, seen = arguments
            pixel = _pointer(context, builder, kinds[0], x, start)
            least = context.make_array(kinds[5])(context, builder, seen).data
            greatest = builder.gep(least, [ir.Constant(_I64, LANES)])
            table = context.make_array(kinds[3])(context, builder, w)
            pitch = cgutils.unpack_tuple(builder, table.shape)[1]
            starts = [builder.add(row, ir.Constant(_I64, c)) for c in range(width)]
            rows = [builder.gep(table.data, [builder.mul(pitch, at)]) for at in starts]
            counter = _variable(builder, ir.Constant(_I64, 0))
            zero = ir.Constant(_LANES, [0.0] * LANES)
            totals = [_variable(builder, zero) for _ in range(width)]
            signs = ("<", ">")
            ends = [builder.bitcast(end, _LANES.as_pointer()) for end in (least, greatest)]
            extremes = [_variable(builder, builder.load(end, align=4)) for end in ends]
            fma = _fma(builder, _LANES, "v16f32")

            def add(at, value):
                for total, weight_row in zip(totals, rows, strict=True):
                    place = builder.gep(weight_row, [at])
                    weight = _loaded(builder, place, kinds[3].dtype, LANES)
                    builder.store(builder.call(fma, [value, weight, builder.load(total)]), total)
                for known, sign in zip(extremes, signs, strict=True):
                    builder.store(_further(builder, value, builder.load(known), sign), known)

            def add_sixteen(at):
                place = builder.gep(pixel, [at])
                add(at, _loaded(builder, place, kinds[0].dtype, LANES))

            _loop(builder, counter, bands, LANES, add_sixteen)
            at = builder.load(counter)
            with builder.if_then(builder.icmp_signed("<", at, bands)):
                place = builder.gep(pixel, [at])
                rest = builder.sub(bands, at)
                add(at, _some_loaded(builder, place, kinds[0].dtype, rest))
            for known, end in zip(extremes, ends, strict=True):
                builder.store(builder.load(known), end, align=4)
            told = _folded(builder, [builder.load(total) for total in totals])
            return context.make_tuple(builder, signature.return_type, told)

        return signature, generate

    return sums


def _variable(builder, value):
    """A place that the compiler can keep in a register."""
    place = cgutils.alloca_once(builder, value.type)
    builder.store(value, place)
    return place


def band_adder(count):
    """The compiled function that adds ``count`` bands of a run of pixels to four channels' sums.

    (stored, start, pitch, n, weights, channel, band, sums, tile, ends) -> nothing. ``stored`` is a
    flat array of any number type in which band k of the run starts at ``start + k * pitch``;
    ``sums`` holds channel c at ``c * tile``, and at ``ends * tile`` and behind it the least and the
    greatest number of each pixel so far. Sixteen pixels at a time, band after band by fused
    multiply-add, to four channels from ``channel`` on.
    """

    @intrinsic
    @no_type_check
    def add(typing_context, stored, start, pitch, n, weights, channel, band, sums, tile, ends):
        whole = types.int64
        signature = types.void(
            stored, whole, whole, whole, weights, whole, whole, sums, whole, whole
        )

        def generate(context, builder, signature, arguments):
            kinds = signature.args
            x, start, pitch, n, w, channel, band, sums, tile, ends = arguments
            planes = [
                _pointer(
                    context,
                    builder,
                    kinds[0],
                    x,
                    builder.add(start, builder.mul(pitch, ir.Constant(_I64, k))),
                )
                for k in range(count)
            ]
            one = ir.Constant(_I64, 1)
            slots = [builder.add(channel, ir.Constant(_I64, c)) for c in range(4)]
            totals = [
                _pointer(context, builder, kinds[7], sums, builder.mul(tile, slot))
                for slot in (*slots, ends, builder.add(ends, one))
            ]
            table = context.make_array(kinds[4])(context, builder, w)
            bands = cgutils.unpack_tuple(builder, table.shape)[1]
            factors = []
            for c in range(4):
                row = builder.mul(builder.add(channel, ir.Constant(_I64, c)), bands)
                at = builder.add(row, band)
                factors.append(
                    [
                        builder.load(
                            builder.gep(table.data, [builder.add(at, ir.Constant(_I64, k))])
                        )
                        for k in range(count)
                    ]
                )
            counter = _variable(builder, ir.Constant(_I64, 0))
            for lanes, kind, name in ((LANES, _LANES, "v16f32"), (1, _F32, "f32")):
                fma = _fma(builder, kind, name)
                spread = [[_spread(builder, f, lanes) for f in row] for row in factors]

                def body(at, lanes=lanes, kind=kind, fma=fma, spread=spread):
                    values = [
                        _loaded(builder, builder.gep(plane, [at]), kinds[0].dtype, lanes)
                        for plane in planes
                    ]
                    places = [
                        builder.bitcast(builder.gep(t, [at]), kind.as_pointer()) for t in totals
                    ]
                    for place, row in zip(places[:4], spread, strict=True):
                        total = builder.load(place, align=4)
                        for value, factor in zip(values, row, strict=True):
                            total = builder.call(fma, [value, factor, total])
                        builder.store(total, place, align=4)
                    for place, sign in zip(places[4:], ("<", ">"), strict=True):
                        known = builder.load(place, align=4)
                        for value in values:
                            known = _further(builder, value, known, sign)
                        builder.store(known, place, align=4)

                _loop(builder, counter, n, lanes, body)
            return context.get_dummy_value()

        return signature, generate

    return add


def _spread(builder, value, lanes):
    """One number in every lane."""
    if lanes == 1:
        return value
    undefined = ir.Constant(_LANES, ir.Undefined)
    one = builder.insert_element(undefined, value, ir.Constant(_I32, 0))
    mask = ir.Constant(ir.VectorType(_I32, LANES), [0] * LANES)
    return builder.shuffle_vector(one, undefined, mask)


@intrinsic
@no_type_check
def prefetch(typing_context, stored, at):
    """Ask the memory for the cache line of ``stored[at]``; beyond the array nothing happens."""
    signature = types.void(stored, types.int64)

    def generate(context, builder, signature, arguments):
        pointer = _pointer(context, builder, signature.args[0], *arguments)
        pointer = builder.bitcast(pointer, ir.IntType(8).as_pointer())
        kind = ir.FunctionType(ir.VoidType(), [pointer.type, _I32, _I32, _I32])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        read, keep, data = (ir.Constant(_I32, v) for v in (0, 3, 1))
        builder.call(function, [pointer, read, keep, data])
        return context.get_dummy_value()

    return signature, generate
