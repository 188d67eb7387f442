"""Undefined numbers in plain data: JSON has no NaN, so they are ``None``."""

import math


def defined(value: float | None) -> float | None:
    """The number, or ``None`` where it is missing or not finite.

    Examples
    --------
    >>> defined(26.1), defined(float("nan"))
    (26.1, None)
    """
    return value if value is not None and math.isfinite(value) else None
