"""Results as plain data: JSON has no NaN, so numbers that are not defined are ``None``."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import fields
from typing import Any

import numpy as np


def defined(value: float | None) -> float | None:
    """The number, or ``None`` where it is missing or not finite.

    Examples
    --------
    >>> defined(26.1), defined(float("nan"))
    (26.1, None)
    """
    return value if value is not None and math.isfinite(value) else None


def plain_fields(record: Any, *names: str) -> dict[str, Any]:
    """The fields of a record as plain data, by their names; all of them if none is named.

    Parameters
    ----------
    record
        A dataclass of numbers, text, arrays and such records.
    names
        Fields or properties, in the order of the result.
    """
    wanted = names or [field.name for field in fields(record)]
    return {name: plain(getattr(record, name)) for name in wanted}


def plain(value: Any) -> Any:
    """Lists for arrays and tuples, ``None`` for numbers that are not finite.

    Examples
    --------
    >>> plain({"snr": np.array([1.0, np.inf]), "names": ("R", "G")})
    {'snr': [1.0, None], 'names': ['R', 'G']}
    """
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {name: plain(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    return defined(value) if isinstance(value, float) else value


def named(names: Iterable[str], values: Iterable[float]) -> dict[str, float]:
    """One number per name."""
    return {name: float(value) for name, value in zip(names, values, strict=True)}
