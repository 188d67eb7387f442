"""Numbers in plain data: NaN stands in no JSON, so what is not defined is ``None``."""

import math


def defined(value: float | None) -> float | None:
    """The number, ``None`` where there is none or it is not finite.

    Examples
    --------
    >>> defined(26.1), defined(float("nan"))
    (26.1, None)
    """
    return value if value is not None and math.isfinite(value) else None
