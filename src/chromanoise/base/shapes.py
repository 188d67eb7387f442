"""Array shapes in signatures: the types of jaxtyping, without its import time.

Type checkers, and programs that import jaxtyping first (as the tests do, to check shapes with
beartype), see jaxtyping's own types. For all others ``Float[Array, "n p"]`` is ``Array``: the
import of jaxtyping and the evaluation of 660 shapes would take 1.5 times as long as that of numpy.
"""

import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING or "jaxtyping" in sys.modules:
    from jaxtyping import (
        Bool as Bool,
        Complex as Complex,
        Float as Float,
        Float32 as Float32,
        Float64 as Float64,
        Inexact as Inexact,
        Int as Int,
        Int64 as Int64,
        Integer as Integer,
        Num as Num,
        Shaped as Shaped,
        UInt8 as UInt8,
        UInt16 as UInt16,
    )
else:

    class _Unchecked:
        """The array type without its shape, which is not checked."""

        def __class_getitem__(cls, array_and_shape: tuple[Any, str]) -> Any:
            return array_and_shape[0]

    Bool = Complex = Float = Float32 = Float64 = Inexact = Int = Int64 = _Unchecked
    Integer = Num = Shaped = UInt8 = UInt16 = _Unchecked
