"""Delimited text: comma, semicolon, tab or spaces; decimal point or comma."""

import csv
import io
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from chromanoise._csv_cells import text_of_comment
from chromanoise.errors import InputError
from chromanoise.io.spectra.declared import (
    declared_keys,
    ecsv_units,
    is_row_of_units,
    is_wavelength_heading,
    with_units,
)
from chromanoise.io.spectra.own_json import UNIT_OF_COLUMN, declared
from chromanoise.io.spectra.parsed import Found, Row, has
from chromanoise.io.spectra.tables import is_number, name_and_unit, table_of

_COMMENT = ("#", "%", "//", ";")
DELIMITERS = {"semicolon": ";", "tab": "\t", "comma": ",", "blanks": None}
"""The characters that separate cells, by name."""

_FACT = re.compile(r"(version|source|notes):\s*(.+)")
_JUDGED_LINES = 200
_LONGEST_LINE = 2**16
_MOST_LINES = 200_000


def read_delimited(text: str, source: str) -> Found:
    """The curves of delimited text; comments start with ``#``, ``%``, ``//`` or ``;``.

    Raises
    ------
    InputError
        If a row is not numeric; the message names the line.
    """
    if text.count("\n") + text.count("\r") > 2 * _MOST_LINES:
        raise InputError(source, f"must have at most {_MOST_LINES} lines for a table of spectra")
    comments: list[Row] = []
    lines: list[tuple[int, str]] = []
    for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1):
        bare = line.strip().strip('"')
        if len(line) > _LONGEST_LINE:
            need = f"must have at most {_LONGEST_LINE} characters"
            raise has(source, need, len(line), where=f"line {number}")
        if bare.startswith(_COMMENT):
            said = bare.lstrip("#/; ")  # %ECSV is kept, because it names the format
            said = said if said.startswith("%ECSV") else said.lstrip("#%/; ")
            comments.append(Row(number=number, cells=(said,)))
        elif bare:
            lines.append((number, line))
    delimiter = _delimiter(lines[:_JUDGED_LINES])
    rows = [Row(number=i, cells=cells_of_line(line, i, delimiter, source)) for i, line in lines]
    texts = [c.cells[0] for c in comments]
    rows = _with_ecsv_units(rows, texts)
    head = _heading_comment(comments, rows)
    decimal = decimal_sign(rows, delimiter, source)
    facts = {str(m[1]): text_of_comment(m[2]) for m in map(_FACT.fullmatch, texts) if m}
    keys = declared_keys(texts)
    found = table_of(
        source=source,
        form="delimited text",
        rows=rows,
        comments=tuple(texts),
        head=head,
        delimiter=delimiter,
        decimal=decimal,
        unit=UNIT_OF_COLUMN.get(keys.get("unit", ""), keys.get("unit"))
        if "version" in facts
        else None,
    )
    return replace(found, **_said(facts, keys))


def _said(facts: Mapping[str, str], keys: Mapping[str, str]) -> dict[str, Any]:
    """Source, notes and keys of a table that this library wrote."""
    notes = tuple(note for note in facts.get("notes", "").split("; ") if note)
    quantity = name_and_unit(keys.get("quantity", ""))[0]  # earlier versions wrote its unit there
    return {
        "said_source": facts.get("source", ""),
        "said_notes": notes,
        **declared({**keys, "quantity": quantity}, notes),
    }


def _delimiter(lines: list[tuple[int, str]]) -> str:
    """The delimiter with which most lines are rows of two or more numbers; in a tie, the first.

    If no line is such a row, the first one or two cells of each line are ignored as words, and
    then all words of lines with two numbers or more.
    """
    cells = {name: [split_line(line, name) for _, line in lines] for name in DELIMITERS}

    def rows_of_numbers(name: str, words: int) -> int:
        return sum(_is_row(row, words, decimal_comma=name != "comma") for row in cells[name])

    def rows_with_numbers(name: str) -> int:
        comma = name != "comma"
        return sum(sum(is_number(c, decimal_comma=comma) for c in row) > 1 for row in cells[name])

    for words in (0, 1, 2):
        if any(rows_of_numbers(name, words) for name in DELIMITERS):
            return max(DELIMITERS, key=lambda name: rows_of_numbers(name, words))
    return max(DELIMITERS, key=rows_with_numbers)


def _is_row(cells: list[str], words: int, *, decimal_comma: bool) -> bool:
    filled = [cell.strip() for cell in cells if cell.strip()]
    numbers = filled[words:]
    return len(filled) > max(words, 1) and all(
        is_number(c, decimal_comma=decimal_comma) for c in numbers
    )


def split_line(line: str, delimiter: str) -> list[str]:
    """The cells of a line, for a delimiter of `DELIMITERS`; quoted cells stay whole."""
    sign = DELIMITERS[delimiter]
    if sign is None:
        return _split_at_blanks(line)
    return _quoted(line, sign) if '"' in line else line.split(sign)


def _split_at_blanks(line: str) -> list[str]:
    """Cells separated by spaces; quoted cells and names with bracketed units stay whole."""
    if '"' in line:
        return [cell for cell in _quoted(" ".join(line.split()), " ") if cell]
    return re.sub(r"(?<=\w)\s+(?=[\[(])", "", line).split()


def _quoted(line: str, sign: str) -> list[str]:
    try:
        return next(csv.reader(io.StringIO(line), delimiter=sign, skipinitialspace=True), [])
    except csv.Error:
        return line.split(sign)


def cells_of_line(line: str, number: int, delimiter: str, source: str) -> tuple[str, ...]:
    """The cells of a line, stripped of spaces; an unclosed quotation raises an error."""
    if line.count('"') % 2:
        raise InputError(source, "has a quotation mark that is not closed", where=f"line {number}")
    return tuple(cell.strip() for cell in split_line(line, delimiter))


def _heading_comment(comments: list[Row], rows: list[Row]) -> tuple[str, ...]:
    """The last comment before the numbers that is a heading, with units from the next comment."""
    if not rows:
        return ()
    width = max(len(row.cells) for row in rows[:_JUDGED_LINES])
    above = [c for c in comments if c.number < rows[0].number]
    for i, comment in reversed(list(enumerate(above))):
        for sign in (",", ";", "\t", None):
            cells = _parted(comment, sign)
            above_it = _parted(above[i - 1], sign) if i else ()
            if is_row_of_units(cells) and len(above_it) == len(cells):
                continue  # the comment above has the names
            fits = len(cells) == width if sign is None else len(cells) >= width
            if fits and width > 1 and is_wavelength_heading(cells[0]):
                units = _parted(above[i + 1], sign) if i + 1 < len(above) else ()
                if len(units) == len(cells) and is_row_of_units(units):
                    cells = with_units(cells, units)
                return cells[:width]
    return ()


def _parted(comment: Row, sign: str | None) -> tuple[str, ...]:
    text = comment.cells[0]
    return tuple(map(str.strip, text.split(sign) if sign else _split_at_blanks(text)))


def _with_ecsv_units(rows: list[Row], comments: list[str]) -> list[Row]:
    """The heading of an ECSV file, with the unit of each column after its name."""
    units = ecsv_units(comments)
    if not rows or not set(rows[0].cells) & set(units):
        return rows
    cells = tuple(with_units(rows[0].cells, (units.get(name, "") for name in rows[0].cells)))
    return [Row(number=rows[0].number, cells=cells), *rows[1:]]


def decimal_sign(rows: list[Row], delimiter: str, source: str) -> str:
    """The decimal mark of rows of several cells; two different marks raise an error."""
    if delimiter == "comma":
        return "."
    with_comma = with_point = 0
    for row in rows:
        for cell in row.cells if sum(map(bool, row.cells)) > 1 else ():
            if not with_comma and "," in cell and is_number(cell, decimal_comma=True):
                with_comma = row.number
            elif not with_point and "." in cell and is_number(cell, decimal_comma=False):
                with_point = row.number
    if with_comma and with_point:
        raise InputError(
            source,
            "must have one decimal sign",
            value=(with_comma, with_point),
            found=f"line {with_comma} has a decimal comma and line {with_point} a decimal point",
            remedy="write all numbers in one way",
        )
    return "," if with_comma else "."
