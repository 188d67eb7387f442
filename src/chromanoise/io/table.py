"""A table: a title, columns with units and digits, and rows of numbers or text."""

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
        The heading of the column.
    unit
        The unit of its numbers; empty for text and for numbers without a unit.
    digits
        Format of the numbers for display, as a Python format specification: ``.2f`` for two
        decimals, ``.4g`` for four digits; empty for all digits.

    Raises
    ------
    InputError
        If the name is empty or ``digits`` is not a format specification for a number.
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
        The title of the table.
    columns
        The columns.
    rows
        One cell per column; ``None`` where a quantity is not defined.
    notes
        Remarks below the table.

    Raises
    ------
    InputError
        If a row does not have one cell per column, or a number is not finite.
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
    """A cell as text, a number with the digits of its column; empty for ``None``.

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
    # a small negative number would be shown as "-0.0"
    return text.removeprefix("-") if float(text.replace("%", "")) == 0 else text


def written_rows(table: Table) -> list[list[str]]:
    """The cells of all rows as text, with the digits of their columns."""
    return [
        [written(cell, column.digits) for cell, column in zip(row, table.columns, strict=True)]
        for row in table.rows
    ]


def number_text(value: float | None, digits: str = ".2f", none: str = "-") -> str:
    """A number as text; ``none`` for one that is ``None`` or not finite.

    Examples
    --------
    >>> number_text(26.127), number_text(-0.001, ".1f"), number_text(float("nan"))
    ('26.13', '0.0', '-')
    """
    return none if value is None or not math.isfinite(value) else written(value, digits)


def _plain(number: float) -> float:
    """The number as a Python float, because the repr of a NumPy number includes its type."""
    return float(number) if isinstance(number, float) else number
