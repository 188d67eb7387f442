"""A table: a title, columns with units and digits, rows of numbers and words."""

import math
from dataclasses import dataclass

from chromanoise import _check
from chromanoise.errors import InputError

Entry = float | int | str | bool | None
"""One cell; ``None`` where a quantity is not defined."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Column:
    """One column of a table.

    Attributes
    ----------
    name
        What it is.
    unit
        Of its numbers; empty for words and for numbers without a unit.
    digits
        How its numbers are rounded for readers, in Python's format language: ``.2f`` two decimals,
        ``.4g`` four digits; empty for all digits.

    Raises
    ------
    InputError
        If the name is empty or the digits are no format of a number.
    """

    name: str
    unit: str = ""
    digits: str = ""

    def __post_init__(self) -> None:
        if not self.name.strip():
            raise InputError("Column.name", "must not be empty", value=self.name)
        try:
            format(1.0, self.digits)
        except ValueError:
            raise InputError(
                "Column.digits",
                "must be a format such as .2f or .4g",
                value=self.digits,
                where=f"column {self.name!r}",
            ) from None


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """Rows of cells under columns.

    Attributes
    ----------
    title
        What it shows.
    columns
        Name, unit and digits of each.
    rows
        One cell per column; ``None`` where a quantity is not defined.
    notes
        What a reader must know.

    Raises
    ------
    InputError
        If a row is not as long as the columns, or a number is not finite.
    """

    title: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Entry, ...], ...]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check.distinct(f"columns of table {self.title!r}", [c.name for c in self.columns])
        for i, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                raise InputError(
                    f"table {self.title!r}",
                    f"must have {len(self.columns)} cells, one per column",
                    value=len(row),
                    found=f"has {len(row)}",
                    where=f"row {i} (from 0)",
                )
            for column, cell in zip(self.columns, row, strict=True):
                if isinstance(cell, float) and not math.isfinite(cell):
                    raise InputError(
                        f"table {self.title!r}",
                        "must be finite",
                        value=cell,
                        where=f"column {column.name!r} in row {i} (from 0)",
                        remedy="use None where it is not defined",
                    )


def written(cell: Entry, digits: str) -> str:
    """A cell as text, its number with the digits of its column; nothing for ``None``.

    Examples
    --------
    >>> written(26.1234, ".1f"), written("Y", ".1f"), written(None, ".1f"), written(0.1, "")
    ('26.1', 'Y', '', '0.1')
    """
    if cell is None:
        return ""
    if isinstance(cell, bool | str):
        return str(cell)
    text = format(cell, digits) if digits else repr(_plain(cell))
    # a small negative number rounds to "-0.0", which no reader wants to meet
    return text.removeprefix("-") if float(text.replace("%", "")) == 0 else text


def _plain(number: float) -> float:
    """Of Python's own type: the text of a NumPy number names its type."""
    return float(number) if isinstance(number, float) else number
