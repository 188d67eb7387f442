"""Array shapes in signatures: the types of jaxtyping, without its import time.

Type checkers, and programs that import jaxtyping first (as the tests do, to check shapes with
beartype), see jaxtyping's own types. For all others ``Float[Array, "n p"]`` is ``Array``: the
import of jaxtyping and the evaluation of 660 shapes would take 1.5 times as long as that of numpy.
"""

import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING or "jaxtyping" in sys.modules:
    from jaxtyping import Bool as Bool
    from jaxtyping import Complex as Complex
    from jaxtyping import Float as Float
    from jaxtyping import Float32 as Float32
    from jaxtyping import Float64 as Float64
    from jaxtyping import Inexact as Inexact
    from jaxtyping import Int as Int
    from jaxtyping import Int64 as Int64
    from jaxtyping import Integer as Integer
    from jaxtyping import Num as Num
    from jaxtyping import Shaped as Shaped
    from jaxtyping import UInt8 as UInt8
    from jaxtyping import UInt16 as UInt16
else:

    class _Unchecked:
        """The array type without its shape, which is not checked."""

        def __class_getitem__(cls, array_and_shape: tuple[Any, str]) -> Any:
            return array_and_shape[0]

    Bool = Complex = Float = Float32 = Float64 = Inexact = Int = Int64 = _Unchecked
    Integer = Num = Shaped = UInt8 = UInt16 = _Unchecked
