"""Tables of results, written as CSV, JSON, Markdown and LaTeX.

A table has a title, columns with units and digits, and rows of numbers or text. CSV and JSON have
all digits, so reading them restores the same numbers; Markdown and LaTeX round to the digits of the
column. An undefined value is an empty cell, or ``null`` in JSON.
"""

import math
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from chromanoise.base import (
    InputError,
    __version__,
    check,
    csv_text,
    dataclass,
    defined,
    json_text,
    with_short_repr,
)
from chromanoise.io.source_files import has, refused
from chromanoise.io.spectra.parsed import SCHEMA_VERSION, held_json, named, word_of, words_of

Entry = float | int | str | bool | None
"""One cell; ``None`` where a quantity is not defined."""


@dataclass(frozen=True, kw_only=True)
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
            raise refused("Column.name", "must not be empty", self.name)
        try:
            format(1.0, self.digits)
        except ValueError:
            need = "must be a format such as .2f or .4g"
            where = f"column {self.name!r}"
            raise refused("Column.digits", need, self.digits, where=where) from None


@with_short_repr
@dataclass(frozen=True, kw_only=True)
class Table:
    """Rows of cells under columns.

    Attributes
    ----------
    title
        The title of the table.
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
        check.distinct(f"columns of table {self.title!r}", [c.name for c in self.columns])
        for i, row in enumerate(self.rows):
            if len(row) != len(self.columns):
                need = f"must have {len(self.columns)} cells, one per column"
                raise has(f"table {self.title!r}", need, len(row), where=f"row {i} (from 0)")
            for column, cell in zip(self.columns, row, strict=True):
                if isinstance(cell, float) and not math.isfinite(cell):
                    need = "must be finite"
                    where = f"column {column.name!r} in row {i} (from 0)"
                    remedy = "use None where it is not defined"
                    raise refused(f"table {self.title!r}", need, cell, where=where, remedy=remedy)


Row = TypeVar("Row")
ColumnOf = tuple[str, str, str, Callable[[Row], Entry]]
"""Name, unit and digits of a column, and its cell in a row."""


def table_of(
    title: str, rows: Iterable[Row], *columns: ColumnOf[Row], notes: Iterable[str] = ()
) -> Table:
    """A table with one row per record; numbers that are not finite are not defined.

    Examples
    --------
    >>> table = table_of("shares", [0.5, math.inf], ("share", "1", ".1f", float))
    >>> table.rows
    ((0.5,), (None,))
    """
    return Table(
        title=title,
        columns=tuple(Column(name=n, unit=unit, digits=digits) for n, unit, digits, _ in columns),
        rows=tuple(tuple(_cell(of(row)) for *_, of in columns) for row in rows),
        notes=tuple(dict.fromkeys(notes)),
    )


def _cell(value: Any) -> Entry:
    cell: Entry = value.item() if isinstance(value, np.generic) else value
    return defined(cell) if isinstance(cell, float) else cell


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


SCHEMA = "chromanoise table"

_LABEL = re.compile(r"[A-Za-z0-9:._-]+")
_MARKDOWN = re.compile(r"([\\`*_\[\]<>#|~&])")
_LATEX = {
    "\\": r"\textbackslash{}",
    "{": r"\{",
    "}": r"\}",
    "$": r"\$",
    "&": r"\&",
    "#": r"\#",
    "%": r"\%",
    "_": r"\_",
    "^": r"\textasciicircum{}",
    "~": r"\textasciitilde{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    '"': r"\textquotedblright{}",
    "[": "{[}",  # after a line's end it would open an option
    "]": "{]}",
    "*": "{*}",  # after a line's end too
    "-": "{-}",  # two would become a dash
    "`": r"\textasciigrave{}",
    "'": r"\textquotesingle{}",
    "µ": r"$\mu$",
    "μ": r"$\mu$",
    "λ": r"$\lambda$",
    "σ": r"$\sigma$",
    "Δ": r"$\Delta$",
    "°": r"$^{\circ}$",
    "²": "$^{2}$",
    "³": "$^{3}$",
    "⁻": "$^{-}$",
    "¹": "$^{1}$",
    "−": "$-$",
    "±": r"$\pm$",
    "×": r"$\times$",
    "·": r"$\cdot$",
}


def table_writer(path: Path) -> Callable[[Table], str]:
    """The function that writes a table as text, chosen by the suffix of the file name.

    Raises
    ------
    InputError
        If the suffix is not supported.
    """
    writers = {".csv": table_csv, ".json": table_json, ".md": table_markdown, ".tex": table_latex}
    ending = path.suffix.lower()
    if ending not in writers:
        need = f"must end in {', '.join(writers)} for a table"
        raise refused(path, need, path.suffix, f"ends in {path.suffix!r}")
    return writers[ending]


def table_csv(table: Table) -> str:
    """A row of headings, ``name [unit]``, then the rows with all digits, as RFC 4180 with LF.

    Text that a spreadsheet would interpret as a formula is prefixed with an apostrophe.
    """
    rows = (
        [0.0 if isinstance(cell, float) and cell == 0 else cell for cell in row]  # not -0.0
        for row in table.rows
    )
    return csv_text([map(head, table.columns), *rows])


def table_json(table: Table) -> str:
    """All data of the table with all digits; `table_from_json` reads it."""
    data: dict[str, Any] = {
        "schema": SCHEMA,
        "schema_version": SCHEMA_VERSION,
        "version": __version__,
        "title": table.title,
        "columns": [{"name": c.name, "unit": c.unit, "digits": c.digits} for c in table.columns],
        "rows": [list(row) for row in table.rows],
        "notes": list(table.notes),
    }
    return json_text(data)


def table_from_json(text: str, *, source: str = "table") -> Table:
    """Read the table from text of `table_json`.

    Raises
    ------
    InputError
        If the text is not JSON, has another schema or version, or is not a table.
    """
    held = held_json(text, SCHEMA, source=source)
    try:
        return Table(
            title=word_of(held["title"]),
            columns=tuple(
                Column(**{key: word_of(c[key]) for key in ("name", "unit", "digits")})
                for c in held["columns"]
            ),
            rows=tuple(tuple(_entry(cell) for cell in row) for row in held["rows"]),
            notes=words_of(held["notes"]),
        )
    except InputError as error:
        raise named(error, source) from None
    except (KeyError, TypeError):
        raise refused(
            source, "must have title, columns (name, unit, digits), rows and notes, as a table"
        ) from None


def table_markdown(table: Table) -> str:
    """The title and a table in GitHub-flavored Markdown; columns of numbers are right-aligned."""
    heads = " | ".join(_markdown(head(column)) for column in table.columns)
    rules = " | ".join("---:" if _numeric(table, i) else "---" for i in range(len(table.columns)))
    rows = [" | ".join(map(_markdown, row)) for row in written_rows(table)]
    lines = [
        f"**{_markdown(table.title)}**",
        "",
        *(f"| {line} |" for line in (heads, rules, *rows)),
    ]
    lines += ["", *(f"* {_markdown(note)}" for note in table.notes)] if table.notes else []
    return "\n".join(lines) + "\n"


def table_latex(table: Table, label: str = "") -> str:
    r"""A LaTeX ``table`` with the rules of the package booktabs and a ``\caption``, in UTF-8.

    Parameters
    ----------
    table
        The table; its headings are ``name [unit]``.
    label
        The label for ``\ref``; if empty, no ``\label`` is written.

    Raises
    ------
    InputError
        If the label has characters other than letters, digits and ``: . _ -``.
    """
    if label and not _LABEL.fullmatch(label):
        raise refused("label", "must consist of letters, digits and : . _ -", label)
    kinds = "".join("r" if _numeric(table, i) else "l" for i in range(len(table.columns)))
    heads = " & ".join(_latex(head(column)) for column in table.columns)
    rows = [
        " & ".join(
            f"${text}$" if text.startswith("-") and not isinstance(cell, str) else _latex(text)
            for cell, text in zip(cells, texts, strict=True)
        )
        for cells, texts in zip(table.rows, written_rows(table), strict=True)
    ]
    lines = [
        r"% needs \usepackage{booktabs}",
        r"\begin{table}",
        rf"\caption{{{_latex(table.title)}}}",
        *([rf"\label{{{label}}}"] if label else []),
        rf"\begin{{tabular}}{{{kinds}}}",
        r"\toprule",
        rf"{heads} \\",
        r"\midrule",
        *(rf"{row} \\" for row in rows),
        r"\bottomrule",
        r"\end{tabular}",
        *(rf"\par {_latex(note)}" for note in table.notes),
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"


def head(column: Column) -> str:
    """The heading of a column: name and unit.

    Examples
    --------
    >>> head(Column(name="time", unit="ms")), head(Column(name="sensor"))
    ('time [ms]', 'sensor')
    """
    return f"{column.name} [{column.unit}]" if column.unit else column.name


def _numeric(table: Table, i: int) -> bool:
    cells = [row[i] for row in table.rows if row[i] is not None]
    return bool(cells) and not any(isinstance(cell, str | bool) for cell in cells)


def _markdown(text: str) -> str:
    return _MARKDOWN.sub(r"\\\1", " ".join(text.split()))


def _latex(text: str) -> str:
    return "".join(_LATEX.get(letter, letter) for letter in " ".join(text.split()))


def _entry(value: Any) -> Entry:
    if value is not None and not isinstance(value, bool | int | float | str):
        raise TypeError
    return value
