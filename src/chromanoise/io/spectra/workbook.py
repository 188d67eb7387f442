"""Read spreadsheets (``.xlsx``) with openpyxl, if it is installed."""

import importlib
import zipfile
from pathlib import Path
from typing import Any

from chromanoise.errors import InputError
from chromanoise.io.spectra.parsed import Found, Row
from chromanoise.io.spectra.tables import is_number, table_of

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
    book = _openpyxl(path).load_workbook(path, read_only=True, data_only=True)
    try:
        sheets = {sheet.title: _rows(path, sheet) for sheet in book.worksheets}
    finally:
        book.close()
    filled = [(title, rows) for title, rows in sheets.items() if rows]
    if not filled:
        raise InputError(str(path), "has only empty sheets")
    title, rows = next(((t, r) for t, r in filled if _has_numbers(r)), filled[0])
    comments = tuple(r.cells[0] for r in rows if len([c for c in r.cells if c]) == 1)
    form = f"XLSX, sheet {title}" + (f" of {len(filled)}" if len(filled) > 1 else "")
    return table_of(source=str(path), form=form, rows=rows, comments=comments, where="row")


def _has_numbers(rows: list[Row]) -> bool:
    numbers = [[c for c in row.cells if is_number(c, decimal_comma=False)] for row in rows]
    return sum(len(one) > 1 for one in numbers) > 1


def _openpyxl(path: Path) -> Any:
    try:
        return importlib.import_module("openpyxl")
    except ImportError:
        raise InputError(
            str(path),
            "needs the package openpyxl, which is not installed",
            remedy="install it with: pip install 'chromanoise[xlsx]'",
        ) from None


def _refuse_bombs(path: Path) -> None:
    """Raise an error if the archive inflates to too many bytes, or its XML declares entities."""
    with zipfile.ZipFile(path) as archive:
        parts = archive.infolist()
        size = sum(part.file_size for part in parts)
        if size > _LARGEST_BYTES:
            raise InputError(
                str(path),
                f"must unpack to at most {_LARGEST_BYTES // 2**20} MiB",
                value=size,
                found=f"unpacks to {size / 2**20:.0f} MiB",
            )
        for part in parts:
            if part.filename.lower().endswith((".xml", ".rels")):
                text = archive.read(part).replace(b"\0", b"").upper()
                if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
                    raise InputError(
                        str(path),
                        "must not declare a document type",
                        where=f"part {part.filename!r}",
                    )


def _rows(path: Path, sheet: Any) -> list[Row]:
    need = f"must have at most {_MOST_ROWS} rows and {_MOST_COLUMNS} columns"
    size, where = (sheet.max_row, sheet.max_column), f"sheet {sheet.title!r}"
    if (size[0] or 0) > _MOST_ROWS or (size[1] or 0) > _MOST_COLUMNS:
        found = f"has {size[0]} and {size[1]}"
        raise InputError(str(path), need, value=size, found=found, where=where)
    rows = []
    for number, values in enumerate(sheet.iter_rows(values_only=True), 1):
        if number > _MOST_ROWS or len(values) > _MOST_COLUMNS:
            size = (number, len(values))
            raise InputError(str(path), need, value=size, found="has more", where=where)
        if any(value is not None for value in values):
            rows.append(Row(number=number, cells=tuple(_text(value) for value in values)))
    return rows


def _text(value: Any) -> str:
    """A cell as text; numbers with all their digits."""
    if value is None:
        return ""
    return repr(value) if isinstance(value, float) else str(value).strip()
