"""Tables of spectra in delimited text, CGATS files, and spreadsheets (``.xlsx``).

Delimiters are comma, semicolon, tab or spaces; numbers have a decimal point or comma. CGATS are
files such as the ``.sp`` files of Argyll. Spreadsheets need openpyxl.
"""

import csv
import io
import re
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import optional_package, text_of_comment
from chromanoise.io.source_files import has, refused
from chromanoise.io.spectra.cell_tables import (
    finite_number,
    is_number,
    name_and_unit,
    number_in,
    table_of,
)
from chromanoise.io.spectra.declared import (
    declared_keys,
    ecsv_units,
    is_row_of_units,
    is_wavelength_heading,
    with_units,
)
from chromanoise.io.spectra.parsed import (
    UNIT_OF_COLUMN,
    Column,
    Found,
    Level,
    Per,
    Quantity,
    Row,
    declared,
)

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
        raise refused(source, f"must have at most {_MOST_LINES} lines for a table of spectra")
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
            comments.append(Row(number, (said,)))
        elif bare:
            lines.append((number, line))
    delimiter = _delimiter(lines[:_JUDGED_LINES])
    rows = [Row(i, cells_of_line(line, i, delimiter, source)) for i, line in lines]
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

    If only one of them divides any line, it is that one.
    If no line is such a row, the first one or two cells of each line are ignored as words, and
    then all words of lines with two numbers or more.
    """
    cells = {
        name: [
            row
            for _, line in lines
            if (sign is None or sign in line) and len(row := split_line(line, name)) > 1
        ]
        for name, sign in DELIMITERS.items()
    }

    apart = [name for name, rows in cells.items() if rows]
    if len(apart) == 1:
        return apart[0]

    def rows_of_numbers(name: str, words: int) -> int:
        return sum(_is_row(row, words, decimal_comma=name != "comma") for row in cells[name])

    def rows_with_numbers(name: str) -> int:
        comma = name != "comma"
        return sum(sum(is_number(c, decimal_comma=comma) for c in row) > 1 for row in cells[name])

    for words in (0, 1, 2):
        counts = {name: rows_of_numbers(name, words) for name in DELIMITERS}
        if any(counts.values()):
            return max(counts, key=counts.__getitem__)
    return max(DELIMITERS, key=rows_with_numbers)


def _is_row(cells: list[str], words: int, *, decimal_comma: bool) -> bool:
    if len(cells) <= max(words, 1):
        return False
    filled = [cell for cell in map(str.strip, cells) if cell]
    return len(filled) > max(words, 1) and all(
        is_number(c, decimal_comma=decimal_comma) for c in filled[words:]
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
    whole = re.sub(r"(?<=\w)\s+(?=[\[(])", "", line) if "[" in line or "(" in line else line
    return whole.split()


def _quoted(line: str, sign: str) -> list[str]:
    try:
        return next(csv.reader(io.StringIO(line), delimiter=sign, skipinitialspace=True), [])
    except csv.Error:
        return line.split(sign)


def cells_of_line(line: str, number: int, delimiter: str, source: str) -> tuple[str, ...]:
    """The cells of a line, stripped of spaces; an unclosed quotation raises an error."""
    if line.count('"') % 2:
        raise refused(source, "has a quotation mark that is not closed", where=f"line {number}")
    return tuple(map(str.strip, split_line(line, delimiter)))


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
    return [Row(rows[0].number, cells), *rows[1:]]


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
        need = "must have one decimal sign"
        found = f"line {with_comma} has a decimal comma and line {with_point} a decimal point"
        remedy = "write all numbers in one way"
        raise refused(source, need, (with_comma, with_point), found, remedy=remedy)
    return "," if with_comma else "."


_TOKEN = re.compile(r'"[^"\n]*"|\S+')
_FIELD = re.compile(r"(?:SPEC(?:TRAL)?_?(?:NM)?_?|NM_?|R_)(\d+(?:\.\d+)?)", re.IGNORECASE)
_KINDS: dict[str, tuple[Quantity, Per | None, Level | None]] = {
    "EMISSION": ("power", "energy", "absolute"),
    "AMBIENT": ("power", "energy", "absolute"),
    "EMISSION_FLASH": ("power", "energy", "absolute"),
    "AMBIENT_FLASH": ("power", "energy", "absolute"),
    "REFLECTIVE": ("reflectance", None, None),
    "TRANSMISSIVE": ("transmittance", None, None),
    "SENSITIVITY": ("response", None, None),
}
_Token = tuple[int, str]


def is_cgats(text: str) -> bool:
    """Whether the text has the table of a CGATS file."""
    return "BEGIN_DATA_FORMAT" in text and "BEGIN_DATA" in text


def read_cgats(text: str, source: str) -> Found:
    """The spectra of the first table, one curve per set.

    Raises
    ------
    InputError
        If the table has no spectral fields, or a value is not a number; the message names the line.
    """
    tokens = _tokens(text)
    words = [token for _, token in tokens]
    fields = words[_between(words, "BEGIN_DATA_FORMAT", "END_DATA_FORMAT", source)]
    table = _between(words, "BEGIN_DATA", "END_DATA", source)
    facts = _facts(tokens[: words.index("BEGIN_DATA_FORMAT")])
    spectral = [i for i, field in enumerate(fields) if _FIELD.fullmatch(field)]
    wavelength = _wavelengths(facts, [fields[i] for i in spectral], source)
    sets = _sets(tokens[table], fields, source)
    norm = _norm(facts, source)
    values = (
        np.array(
            [
                [finite_number(row[i][1], source, f"line {row[i][0]}") for i in spectral]
                for row in sets
            ]
        )
        / norm
    )
    quantity, per, level = _KINDS.get(facts.get("MEAS_TYPE", "").upper(), (None, None, None))
    notes = (f"values divided by SPECTRAL_NORM {norm:g}",) if norm != 1 else ()
    return Found(
        source=source,
        format="CGATS",
        columns=tuple(
            Column(name=_name(row, fields, k), wavelength=wavelength, values=values[k])
            for k, row in enumerate(sets)
        ),
        words=" ".join(facts.values()),
        wavelength_unit="nm",
        quantity=quantity,
        per=per,
        level=level,
        notes=notes,
    )


def _tokens(text: str) -> list[_Token]:
    return [
        (number, token.strip('"'))
        for number, line in enumerate(re.split(r"\r\n|\r|\n", text), 1)
        if not line.lstrip().startswith("#")
        for token in _TOKEN.findall(line)
    ]


def _between(words: list[str], first: str, last: str, source: str) -> slice:
    try:
        start = words.index(first) + 1
        return slice(start, words.index(last, start))
    except ValueError:
        raise refused(
            source, f"must have {first} and {last} around a part of a CGATS file"
        ) from None


def _facts(tokens: list[_Token]) -> dict[str, str]:
    """The first two words of each line."""
    lines: dict[int, list[str]] = {}
    for number, token in tokens:
        lines.setdefault(number, []).append(token)
    return {line[0]: line[1] for line in lines.values() if len(line) > 1}


def _wavelengths(facts: dict[str, str], fields: list[str], source: str) -> np.ndarray:
    if len(fields) < 2:
        need = "must have at least 2 spectral fields (SPEC_400 ...) in its CGATS table"
        raise has(source, need, len(fields), remedy="check that it is a table of spectra")
    named = np.array([float(match[1]) for f in fields if (match := _FIELD.fullmatch(f))])
    ends = [facts.get(key, "") for key in ("SPECTRAL_START_NM", "SPECTRAL_END_NM")]
    if not all(np.isfinite(number_in(end)) for end in ends):
        return named
    expected = np.linspace(number_in(ends[0]), number_in(ends[1]), named.size)
    if np.abs(expected - named).max() > 1.0:  # the names of the fields are rounded
        required = "SPECTRAL_START_NM and SPECTRAL_END_NM must agree with the fields"
        found = f"are {ends[0]} and {ends[1]}, and the fields are {fields[0]} to {fields[-1]}"
        raise refused(source, required, (ends[0], ends[1]), found)
    return expected


def _norm(facts: dict[str, str], source: str) -> float:
    text = facts.get("SPECTRAL_NORM", "1")
    norm = number_in(text)
    if not 1e-30 < norm < 1e30:
        raise refused(source, "must be a number > 0", text, where="SPECTRAL_NORM")
    return norm


def _sets(tokens: list[_Token], fields: list[str], source: str) -> list[list[_Token]]:
    if not tokens or len(tokens) % len(fields):
        line = tokens[-1][0] if tokens else 0
        need = f"must have sets of {len(fields)} values, as many as fields"
        found = f"has {len(tokens)} values in all"
        raise refused(source, need, len(tokens), found, where=f"line {line}")
    return [tokens[i : i + len(fields)] for i in range(0, len(tokens), len(fields))]


def _name(row: list[_Token], fields: list[str], k: int) -> str:
    for key in ("SAMPLE_NAME", "SAMPLE_ID", "SAMPLE_LOC"):
        if key in fields and row[fields.index(key)][1]:
            return row[fields.index(key)][1]
    return f"sample {k + 1}"


_LARGEST_BYTES = 16 * 2**20  # these take some seconds to read
_MOST_ROWS, _MOST_COLUMNS = 20_000, 1_000


def read_workbook(path: Path) -> Found:
    """Read the curves of the first sheet that has two rows with numbers in two columns.

    Raises
    ------
    InputError
        If openpyxl is not installed, the file inflates to more than 16 MiB or declares a document
        type, or a cell is not a number; the message names the row.
    """
    _refuse_bombs(path)
    openpyxl = optional_package("openpyxl", str(path), extra="xlsx")
    book = openpyxl.load_workbook(path, read_only=True, data_only=True)
    try:
        sheets = {sheet.title: _rows(path, sheet) for sheet in book.worksheets}
    finally:
        book.close()
    filled = [(title, rows) for title, rows in sheets.items() if rows]
    if not filled:
        raise refused(path, "has only empty sheets")
    title, rows = next(((t, r) for t, r in filled if _has_numbers(r)), filled[0])
    comments = tuple(r.cells[0] for r in rows if len([c for c in r.cells if c]) == 1)
    form = f"XLSX, sheet {title}" + (f" of {len(filled)}" if len(filled) > 1 else "")
    return table_of(source=str(path), form=form, rows=rows, comments=comments, where="row")


def _has_numbers(rows: list[Row]) -> bool:
    numbers = [[c for c in row.cells if is_number(c, decimal_comma=False)] for row in rows]
    return sum(len(one) > 1 for one in numbers) > 1


def _refuse_bombs(path: Path) -> None:
    """Raise an error if the archive inflates to too many bytes, or its XML declares entities."""
    with zipfile.ZipFile(path) as archive:
        parts = archive.infolist()
        size = sum(part.file_size for part in parts)
        if size > _LARGEST_BYTES:
            need = f"must unpack to at most {_LARGEST_BYTES // 2**20} MiB"
            raise refused(path, need, size, f"unpacks to {size / 2**20:.0f} MiB")
        for part in parts:
            if part.filename.lower().endswith((".xml", ".rels")):
                text = archive.read(part).replace(b"\0", b"").upper()
                if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
                    raise refused(
                        path, "must not declare a document type", where=f"part {part.filename!r}"
                    )


def _rows(path: Path, sheet: Any) -> list[Row]:
    need = f"must have at most {_MOST_ROWS} rows and {_MOST_COLUMNS} columns"
    size, where = (sheet.max_row, sheet.max_column), f"sheet {sheet.title!r}"
    if (size[0] or 0) > _MOST_ROWS or (size[1] or 0) > _MOST_COLUMNS:
        raise refused(path, need, size, f"has {size[0]} and {size[1]}", where=where)
    rows = []
    for number, values in enumerate(sheet.iter_rows(values_only=True), 1):
        if number > _MOST_ROWS or len(values) > _MOST_COLUMNS:
            size = (number, len(values))
            raise refused(path, need, size, "has more", where=where)
        if any(value is not None for value in values):
            rows.append(Row(number, tuple(_text(value) for value in values)))
    return rows


def _text(value: Any) -> str:
    """A cell as text; numbers with all their digits."""
    if value is None:
        return ""
    return repr(value) if isinstance(value, float) else str(value).strip()
