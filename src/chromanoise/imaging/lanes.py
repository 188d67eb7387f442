# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Sums over the bands of pixels, always in the same order whatever the processor.

A compiler that may reorder a sum gives other bits on another processor; one that may not is eight
times slower. So the order is written down: lane j of eight adds bands j, j + 8, j + 16 ... by fused
multiply-add, and the lanes are folded in halves. Two pixels are taken at a time, so that weights
are fetched once for both. The smallest and the largest stored number are found on the way, because
each number is read only once.
"""

from typing import no_type_check

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

LANES = 8
"""Bands of a pixel that are added side by side."""
_RUN_LANES = 16  # pixels of a band that are
_F32, _I32, _I64 = ir.FloatType(), ir.IntType(32), ir.IntType(64)


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


def _vector(lanes):
    return _F32 if lanes == 1 else ir.VectorType(_F32, lanes)


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
    """The next ``count`` < `LANES` stored numbers; the other lanes repeat the first of them."""
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
    return _as_float(builder, value, kind, _vector(LANES))


def _further(builder, value, known, sign):
    """The lower (or higher) of each lane; a NaN is passed over here and shows in the sums."""
    return builder.select(builder.fcmp_ordered(sign, value, known), value, known)


def _shuffled(builder, a, b, lanes):
    mask = ir.Constant(ir.VectorType(_I32, len(lanes)), lanes)
    return builder.shuffle_vector(a, b, mask)


def _folded(builder, vectors):
    """Each vector's lanes to one sum, halves onto halves; four vectors in one go."""
    apart = LANES  # lanes of each sum that are still to be added
    while len(vectors) in (2, 4):
        apart //= 2
        first = [lane for lane in range(LANES) if not lane & apart]
        lower = first + [LANES + lane for lane in first]
        upper = [lane + apart for lane in lower]
        vectors = [
            builder.fadd(_shuffled(builder, a, b, lower), _shuffled(builder, a, b, upper))
            for a, b in zip(vectors[::2], vectors[1::2], strict=True)
        ]
    (total,) = vectors
    sums = LANES // apart
    half = apart // 2
    while half:
        order = [lane ^ half for lane in range(LANES)]
        total = builder.fadd(total, _shuffled(builder, total, total, order))
        half //= 2
    return [builder.extract_element(total, ir.Constant(_I32, apart * c)) for c in range(sums)]


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


def weighted_sums(width, pixels):
    """The compiled function (stored, start, pitch, bands, weights, row, at, seen) -> sums.

    ``stored`` is a flat array of any number type; a pixel is ``bands`` numbers from ``start``, the
    next one begins ``pitch`` further. ``weights`` is float32, (channels, bands rounded up to 16,
    the rest 0). With a width of 4 all pixels use four rows from ``row`` on, ``at`` being 0; with a
    width of 1 each uses its own: ``row`` is an array that holds it from ``at`` on. ``seen`` float32
    keeps the least and, behind, the greatest stored number of each lane. All sums of the first
    pixel come first.
    """

    @intrinsic
    @no_type_check
    def sums(typing_context, stored, start, pitch, bands, weights, row, at, seen):
        whole = types.int64
        result = types.UniTuple(types.float32, width * pixels)
        signature = result(stored, whole, whole, whole, weights, row, whole, seen)

        def generate(context, builder, signature, arguments):
            kinds = signature.args
            x, start, pitch, bands, w, row, first, seen = arguments
            steps = [builder.mul(pitch, ir.Constant(_I64, i)) for i in range(pixels)]
            starts = [
                _pointer(context, builder, kinds[0], x, builder.add(start, step)) for step in steps
            ]
            if width == 1:
                own = _pointer(context, builder, kinds[5], row, first)
                numbers = [
                    builder.load(builder.gep(own, [ir.Constant(_I64, i)])) for i in range(pixels)
                ]
            else:
                numbers = [builder.add(row, ir.Constant(_I64, c)) for c in range(width)]
            rows = _weight_rows(context, builder, kinds[4], w, numbers)
            zero = ir.Constant(_vector(LANES), [0.0] * LANES)
            totals = [[_variable(builder, zero) for _ in range(width)] for _ in range(pixels)]
            least = context.make_array(kinds[7])(context, builder, seen).data
            extremes = _Extremes(builder, least)
            fma = _fma(builder, _vector(LANES), f"v{LANES}f32")

            def add(at, load):
                values = [load(builder.gep(pixel, [at])) for pixel in starts]
                for number, weight_row in enumerate(rows):
                    place = builder.gep(weight_row, [at])
                    weight = _loaded(builder, place, kinds[4].dtype, LANES)
                    for i in [number] if width == 1 else range(pixels):
                        total = totals[i][0 if width == 1 else number]
                        more = builder.call(fma, [values[i], weight, builder.load(total)])
                        builder.store(more, total)
                for value in values:
                    extremes.see(value)

            counter = _variable(builder, ir.Constant(_I64, 0))
            kind = kinds[0].dtype
            _loop(
                builder,
                counter,
                bands,
                LANES,
                lambda at: add(at, lambda place: _loaded(builder, place, kind, LANES)),
            )
            at = builder.load(counter)
            with builder.if_then(builder.icmp_signed("<", at, bands)):
                rest = builder.sub(bands, at)
                add(at, lambda place: _some_loaded(builder, place, kind, rest))
            extremes.keep()
            told = []
            for total in totals:
                told += _folded(builder, [builder.load(one) for one in total])
            return context.make_tuple(builder, signature.return_type, told)

        return signature, generate

    return sums


def _weight_rows(context, builder, kind, weights, numbers):
    """Where the rows of weights begin."""
    table = context.make_array(kind)(context, builder, weights)
    pitch = cgutils.unpack_tuple(builder, table.shape)[1]
    return [builder.gep(table.data, [builder.mul(pitch, number)]) for number in numbers]


class _Extremes:
    """The least and the greatest of each lane, in registers until they are kept."""

    def __init__(self, builder, least):
        self.builder = builder
        greatest = builder.gep(least, [ir.Constant(_I64, LANES)])
        pointer = _vector(LANES).as_pointer()
        self.ends = [builder.bitcast(end, pointer) for end in (least, greatest)]
        self.known = [_variable(builder, builder.load(end, align=4)) for end in self.ends]

    def see(self, value):
        builder = self.builder
        for known, sign in zip(self.known, ("<", ">"), strict=True):
            builder.store(_further(builder, value, builder.load(known), sign), known)

    def keep(self):
        for known, end in zip(self.known, self.ends, strict=True):
            self.builder.store(self.builder.load(known), end, align=4)


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
            for lanes, name in ((_RUN_LANES, f"v{_RUN_LANES}f32"), (1, "f32")):
                kind = _vector(lanes)
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
    undefined = ir.Constant(_vector(lanes), ir.Undefined)
    one = builder.insert_element(undefined, value, ir.Constant(_I32, 0))
    mask = ir.Constant(ir.VectorType(_I32, lanes), [0] * lanes)
    return builder.shuffle_vector(one, undefined, mask)


def _ask(builder, pointer):
    """Ask the memory for the cache line at ``pointer``; beyond the array nothing happens."""
    pointer = builder.bitcast(pointer, ir.IntType(8).as_pointer())
    kind = ir.FunctionType(ir.VoidType(), [pointer.type, _I32, _I32, _I32])
    function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
    read, keep, data = (ir.Constant(_I32, v) for v in (0, 3, 1))
    builder.call(function, [pointer, read, keep, data])


@intrinsic
@no_type_check
def prefetch(typing_context, stored, at):
    """Ask the memory for the cache line of ``stored[at]``."""
    signature = types.void(stored, types.int64)

    def generate(context, builder, signature, arguments):
        _ask(builder, _pointer(context, builder, signature.args[0], *arguments))
        return context.get_dummy_value()

    return signature, generate
