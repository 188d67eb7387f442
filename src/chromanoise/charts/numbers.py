"""Numbers as text, for tables, labels and sentences of charts."""

from collections.abc import Sequence
from decimal import ROUND_HALF_UP, Decimal
from typing import Any

NONE = "–"
"""Text of a cell without a value."""
UNDEFINED = "undefined"
"""Text of a cell where a ratio is undefined."""
_MINUS = "\N{MINUS SIGN}"


def decimal(value: float | None, digits: int = 1, none: str = NONE) -> str:
    """A number with fixed decimals, ties rounded away from 0, and a true minus sign.

    Parameters
    ----------
    value
        A finite number, or ``None``.
    none
        The text for ``None``.

    Examples
    --------
    >>> decimal(12.25, 1), decimal(-0.01, 1), decimal(None, 1)
    ('12.3', '0.0', '–')
    """
    if value is None:
        return none
    text = f"{value:.{digits}f}"
    if (abs(value) * 10.0**digits) % 1 == 0.5:  # a tie, which Python rounds to even
        text = str(Decimal(value).quantize(Decimal(1).scaleb(-digits), ROUND_HALF_UP))
    return text.replace("-", "" if float(text) == 0 else _MINUS)


def signed(value: float, digits: int = 1) -> str:
    """A change in dB with its sign.

    Examples
    --------
    >>> signed(3.14), signed(-3.14), signed(0.01)
    ('+3.1', '−3.1', '0.0')
    """
    text = decimal(value, digits)
    return text if text.startswith(_MINUS) or float(text) == 0 else f"+{text}"


def brief(value: float | None, digits: int = 3) -> str:
    """A number in its shortest form with the given number of significant digits.

    Examples
    --------
    >>> brief(0.05), brief(1234.0), brief(2e-4), brief(205.31, 4)
    ('0.05', '1230', '2.0e−4', '205.3')
    """
    if value is None:
        return NONE
    if value and not 1e-3 <= abs(value) < 1e6:
        mantissa, _, power = f"{value:.1e}".partition("e")
        return f"{mantissa}e{int(power):+d}".replace("-", _MINUS)
    exact = Decimal(value)
    place = Decimal(1).scaleb(exact.adjusted() - digits + 1) if value else Decimal(1)
    text = f"{exact.quantize(place, ROUND_HALF_UP):f}"
    return (text.rstrip("0").rstrip(".") if "." in text else text).replace("-", _MINUS)


def electrons(value: float) -> str:
    """A number of electrons with four significant digits, or more up to whole electrons.

    Examples
    --------
    >>> electrons(12345.6), electrons(205.31), electrons(0.012346)
    ('12346', '205.3', '0.01235')
    """
    return decimal(value, 0) if abs(value) >= 1000 else brief(value, 4)


def percent(share: float) -> str:
    """A share in whole percent.

    Examples
    --------
    >>> percent(0.304)
    '30 %'
    """
    return f"{decimal(100 * share, 0)} %"


def listed(names: Sequence[str]) -> str:
    """Names in one sentence.

    Examples
    --------
    >>> listed(["a"]), listed(["a", "b", "c"])
    ('a', 'a, b and c')
    """
    return " and ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> dict[str, Any]:
    """A table as plain data: one text per column of the head, and of each row."""
    return {"head": list(head), "rows": [list(row) for row in rows]}


def three_digits(value: float) -> str:
    """Three significant digits, zeros at the end kept (6.50)."""
    return f"{value:#.3g}".removesuffix(".") if 1e-3 <= value < 999.5 else brief(value, 3)
