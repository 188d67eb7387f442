"""A table as text: CSV and JSON for programs, Markdown and LaTeX for readers.

CSV and JSON have all digits, so reading them restores the same numbers; Markdown and LaTeX round to
the digits of the column. An undefined value is an empty cell, or ``null`` in JSON.
"""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from chromanoise import __version__
from chromanoise._csv_cells import csv_text
from chromanoise.errors import InputError
from chromanoise.io.spectra.own_json import SCHEMA_VERSION, held_json, named, word_of, words_of
from chromanoise.io.table import Column, Entry, Table, written_rows

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
        raise InputError(
            str(path),
            f"must end in {', '.join(writers)} for a table",
            value=path.suffix,
            found=f"ends in {path.suffix!r}",
        )
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
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


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
        raise InputError(
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
        raise InputError("label", "must consist of letters, digits and : . _ -", value=label)
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
