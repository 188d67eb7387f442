# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Sums over the bands of pixels, in the same order on all processors.

If the compiler may reorder sums, results differ between processors; if it may not, sums are eight
times slower. Therefore the order is explicit: lane j of eight adds bands j, j + 8, j + 16 ... by
fused multiply-add, and the lanes are folded in halves. The smallest and the largest stored number
are found in the same loop, because each number is read only once.
"""

from typing import no_type_check

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from chromanoise.imaging.blocks import LANES

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


def folded(builder, vectors):
    """Each vector's lanes to one sum, halves onto halves: as many sums as vectors, 1 or 4."""
    apart = LANES  # lanes of each sum that remain to be added
    count = len(vectors)
    while len(vectors) > 1:
        apart //= 2
        first = [lane for lane in range(LANES) if not lane & apart]
        lower = first + [LANES + lane for lane in first]
        upper = [lane + apart for lane in lower]
        vectors = [
            builder.fadd(shuffled(builder, a, b, lower), shuffled(builder, a, b, upper))
            for a, b in zip(vectors[::2], vectors[1::2], strict=True)
        ]
    (total,) = vectors
    while apart > 1:
        apart //= 2
        order = [lane ^ apart for lane in range(LANES)]
        total = builder.fadd(total, shuffled(builder, total, total, order))
    sums = [LANES // count * c for c in range(count)]
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
