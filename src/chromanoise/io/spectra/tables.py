"""Interpret tables of cells from any format: find the rows of numbers and assign the columns."""

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np

from chromanoise._check import Array
from chromanoise._csv_cells import text_of_cell
from chromanoise.errors import InputError
from chromanoise.io.spectra.declared import (
    declared_keys,
    is_row_of_units,
    is_wavelength_heading,
    with_units,
)
from chromanoise.io.spectra.layouts import as_columns, with_plain_wavelengths
from chromanoise.io.spectra.parsed import Column, Found, Row

_POINT = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d{1,4})?\s*%?", re.ASCII)
_COMMA = re.compile(r"[+-]?(\d+(,\d+)?|,\d+)([eEdD][+-]?\d{1,4})?\s*%?", re.ASCII)
_MISSING = ("", "-", "--", "na", "n/a", "#n/a", "null", "none")
_UNIT = re.compile(r"(.*?)[\s_]*(?:\[([^\[\]]*)\]|\(([^()]*)\))")
DIGITIZED = "digitized curves"
_LARGEST = 1e30
_LONGEST_CELL = 400
_MOST_CELLS = 2_000_000
_NAN = float("nan")


def is_number(cell: str, *, decimal_comma: bool) -> bool:
    """Whether a cell is a number, with or without a percent sign.

    Examples
    --------
    >>> [is_number(c, decimal_comma=False) for c in ("1e-3", "12 %", "1_0", "inf", "0,5")]
    [True, True, False, False, False]
    """
    if len(cell) > _LONGEST_CELL:
        return False
    pattern = _COMMA if decimal_comma and "," in cell else _POINT
    return pattern.fullmatch(cell.strip()) is not None


def number_in(cell: str, *, decimal_comma: bool = False) -> float:
    """The number in a cell without its percent sign; NaN if it is not a number or exceeds 1e30.

    Examples
    --------
    >>> number_in("1,5D2", decimal_comma=True), number_in("12 %"), number_in("high")
    (150.0, 12.0, nan)
    """
    if not is_number(cell, decimal_comma=decimal_comma):
        return _NAN
    plain = cell.strip().rstrip("% ").lower().replace("d", "e")
    value = float(plain.replace(",", ".") if decimal_comma else plain)
    return value if abs(value) <= _LARGEST else _NAN


def table_of(
    *,
    source: str,
    form: str,
    rows: Sequence[Row],
    comments: tuple[str, ...] = (),
    head: tuple[str, ...] = (),
    delimiter: str = "",
    decimal: str = ".",
    where: str = "line",
    unit: str | None = None,
) -> Found:
    """The curves of a table: one column of wavelengths and n curves, or two columns per curve.

    If ``unit`` is given, it applies to all curves, and headings contain only names.

    Raises
    ------
    InputError
        If fewer than two rows have numbers, or a cell of them is not a number; the message names
        the line.
    """
    if sum(len(row.cells) for row in rows) > _MOST_CELLS:
        raise InputError(source, f"must have at most {_MOST_CELLS} cells for a table of spectra")
    rows, turned = as_columns(with_plain_wavelengths(rows))
    first = _first_row_of_numbers(rows, decimal == ",")
    body = [row for row in rows[first:] if any(row.cells)]
    if len(body) < 2:
        raise InputError(
            source,
            "must have at least 2 rows of a wavelength and a value",
            value=len(body),
            found=f"has {len(body)} in {len(rows)} {where}s",
        )
    above = [tuple(map(text_of_cell, _bare(row.cells))) for row in rows[:first]]
    heads = _with_row_of_units(above)
    width = _width(body, rows[:first], head)
    names = _head(heads, head, width)
    _refuse_wavelengths_elsewhere(names, source)
    numbers, ragged = _numbers(body, names, decimal, source, where)
    _refuse_no_wavelengths(numbers, body, _in_pairs(heads, numbers), source, where)
    words = " ".join([*comments, *(" ".join(cells) for cells in heads[:-1])])
    keys = dict(declared_keys([*comments, *(": ".join(h) for h in heads if len(h) == 2)]))
    if any("%" in cell for cell in body[0].cells):
        keys["scale"] = "percent"
    if unit is not None:  # the unit of a quantity, which does not declare the level
        keys.pop("unit", None)
    found = {
        "source": source, "format": form, "words": words, "keys": keys,
        "delimiter": delimiter, "decimal": decimal, "defects": ragged, "notes": turned,
    }  # fmt: skip
    if _in_pairs(heads, numbers):
        return _digitized(found, heads, numbers)
    lines = [row.number for row in body]
    return _shared(found, names, numbers, lines, where, unit)


def _first_row_of_numbers(rows: Sequence[Row], comma: bool) -> int:
    """The first row of data, which may have a faulty cell: then its wavelength shows what it is."""
    for i, row in enumerate(rows):
        cells = [cell for cell in row.cells if cell]
        if len(cells) > 1 and all(is_number(c, decimal_comma=comma) for c in cells[:2]):
            while i and _continues(rows[i - 1], rows[i], comma):
                i -= 1
            return i
    return len(rows)


def _continues(row: Row, following: Row, comma: bool) -> bool:
    """Whether a row begins with a number as close to that of the following row as wavelengths."""
    first, other = (number_in(one.cells[0], decimal_comma=comma) for one in (row, following))
    return sum(map(bool, row.cells)) > 1 and 0.5 * other < first < 2 * other


def _with_row_of_units(heads: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Append a row of units to the names above it."""
    if len(heads) > 1 and len(heads[-1]) == len(heads[-2]) and is_row_of_units(heads[-1]):
        return [*heads[:-2], with_units(heads[-2], heads[-1])]
    return heads


def _bare(cells: tuple[str, ...]) -> tuple[str, ...]:
    """The rows without the empty cells at the end that spreadsheets write."""
    last = max((i for i, cell in enumerate(cells) if cell), default=-1)
    return cells[: last + 1]


def _width(body: list[Row], heads: Sequence[Row], head: tuple[str, ...]) -> int:
    lengths = Counter(len(_bare(row.cells)) for row in body)
    usual = max(lengths, key=lambda n: (lengths[n], n))
    named = len(_bare(heads[-1].cells)) if heads else len(head)
    if named < 2 or usual - named > 1:
        return usual
    room = len(heads[-1].cells) if heads else len(head)
    ragged = len(lengths) > 1 and usual > room  # then the heading is correct and the rows are not
    return named if ragged else max(named, usual)


def _refuse_wavelengths_elsewhere(names: tuple[str, ...], source: str) -> None:
    others = [k for k, name in enumerate(names) if is_wavelength_heading(name)]
    if len(others) == 1 and others[0] > 0:
        k = others[0]
        raise InputError(
            source,
            "must have the wavelengths in the first column",
            value=names[k],
            found=f"{names[k][:40]!r} is the heading of column {k + 1}",
            remedy="move them there, and remove columns that are not curves",
        )


def _refuse_no_wavelengths(
    numbers: np.ndarray, body: list[Row], pairs: bool, source: str, where: str
) -> None:
    at = numbers[:, ::2] if pairs else numbers[:, :1]
    wrong = np.argwhere(at <= 0)
    if len(wrong):
        i, k = (int(n) for n in wrong[0])
        raise InputError(
            source,
            "the wavelength must be > 0",
            value=float(at[i, k]),
            where=f"{where} {body[i].number}",
        )


def _numbers(
    body: list[Row], names: tuple[str, ...], decimal: str, source: str, where: str
) -> tuple[np.ndarray, tuple[str, ...]]:
    width = len(names)
    table = np.full((len(body), width), _NAN)
    short: list[int] = []
    for i, row in enumerate(body):
        cells = _bare(row.cells)
        if len(cells) > width:
            raise InputError(
                source,
                f"must have at most {width} cells, as the heading",
                value=len(cells),
                found=f"has {len(cells)}",
                where=f"{where} {row.number}",
                remedy="separate cells with semicolons if commas are decimal signs",
            )
        if len(row.cells) < width:
            short.append(row.number)
        for k, cell in enumerate(cells):
            table[i, k] = value = number_in(cell, decimal_comma=decimal == ",")
            if value != value and cell.lower() not in _MISSING:
                raise InputError(
                    source,
                    f"must be a finite number below {_LARGEST:g}",
                    value=cell,
                    where=f"{where} {row.number}, column {names[k][:40] or str(k + 1)!r}",
                    remedy=("correct it", "remove the row"),
                )
    if not short:
        return table, ()
    numbers = ", ".join(str(number) for number in short[:5]) + (", ..." if len(short) > 5 else "")
    which = f"{where} {numbers} has" if len(short) == 1 else f"{where}s {numbers} have"
    return table, (f"ragged rows: {which} fewer than {width} cells",)


def _in_pairs(heads: list[tuple[str, ...]], numbers: np.ndarray) -> bool:
    """Whether each curve has its own wavelengths, by the heading (X,Y) or by the numbers."""
    pairs = numbers.shape[1] // 2
    if pairs < 1 or numbers.shape[1] % 2:
        return False
    last = tuple(cell.lower() for cell in heads[-1]) if heads else ()
    if last == ("x", "y") * pairs:
        return True
    if pairs < 2 or (last[:1] == ("wavelength_nm",) and "wavelength_nm" not in last[1:]):
        return False
    if len(heads) and all(heads[-1][::2]) and not any(heads[-1][1::2]):
        return True
    at, values = numbers[:, ::2], numbers[:, 1::2]
    known = np.isfinite(at).any(axis=0) & np.isfinite(values).any(axis=0)
    return bool(
        known.all() and np.nanmin(at) >= 150 and np.nanmax(at) <= 5000 and np.nanmax(values) <= 110
    )


def _digitized(found: dict, heads: list[tuple[str, ...]], numbers: np.ndarray) -> Found:
    names = [head for head in heads if {c.lower() for c in head} - {"x", "y", ""}]
    columns = []
    for k in range(numbers.shape[1] // 2):
        heading = names[-1][2 * k] if names and 2 * k < len(names[-1]) else ""
        name, unit = name_and_unit(heading)
        at, values = numbers[:, 2 * k], numbers[:, 2 * k + 1]
        both = np.isfinite(at) & np.isfinite(values)
        columns.append(
            Column(
                name=name or f"curve {k + 1}",
                unit=unit,
                wavelength=at[both],
                values=values[both],
            )
        )
    note = "each curve has its own list of wavelengths, as digitizers write"
    form = f"{found['format']}, {DIGITIZED}"
    return Found(
        **{**found, "format": form, "notes": (note,)}, columns=tuple(columns), named=bool(names)
    )


def _head(heads: list[tuple[str, ...]], comment: tuple[str, ...], width: int) -> tuple[str, ...]:
    if heads and len(heads[-1]) > 1:
        return (*heads[-1], *("",) * width)[:width]
    return (*comment, *("",) * width)[:width]


def _shared(
    found: dict,
    head: tuple[str, ...],
    numbers: np.ndarray,
    at_lines: list[int],
    where: str,
    unit: str | None,
) -> Found:
    lost = np.flatnonzero(~np.isfinite(numbers[:, 0]))
    if lost.size:
        raise InputError(
            found["source"],
            "has values but no wavelength",
            where=f"{where} {at_lines[int(lost[0])]}",
        )
    if numbers.shape[1] < 2:
        raise InputError(
            found["source"],
            "must have at least 2 columns",
            value=numbers.shape[1],
            found=f"has {numbers.shape[1]}",
        )
    names = [name_and_unit(text) if unit is None else (text, unit) for text in head[1:]]
    columns, missing = [], []
    for k, (name, unit) in enumerate(names):
        known = np.isfinite(numbers[:, k + 1])
        name = name or f"column {k + 2}"
        missing += missing_notes(name, numbers[:, 0], known, "empty cells")
        columns.append(
            Column(name=name, unit=unit, wavelength=numbers[known, 0], values=numbers[known, k + 1])
        )
    return Found(
        **{**found, "defects": (*found["defects"], *missing)},
        columns=tuple(columns),
        heading=head[0],
        named=any(name for name, _ in names) or len(names) == 1,
    )


def missing_notes(name: str, wavelength: Array, known: Array, what: str) -> list[str]:
    """A sentence if a curve lacks values at some wavelengths, which are in the file's unit."""
    lost = wavelength[~known]
    if not lost.size:
        return []
    span = f"{lost.min():g}" if lost.size == 1 else f"{lost.min():g}-{lost.max():g}"
    return [f"{name}: {lost.size} {what} at {span}; straight lines join their neighbors"]


def name_and_unit(text: str) -> tuple[str, str]:
    """The name of a column and the unit after it, in brackets or as a percent sign.

    Spaces inside the unit do not matter: ``[A / W]`` is A/W, ``(nm )`` is nm.

    Examples
    --------
    >>> name_and_unit("QE [ % ]"), name_and_unit("R [A / W]"), name_and_unit("R")
    (('QE', '%'), ('R', 'A/W'), ('R', ''))
    >>> name_and_unit("E [W m-2  nm-1 ]"), name_and_unit("QE %")
    (('E', 'W m-2 nm-1'), ('QE', '%'))
    """
    bare = " ".join(text.split())
    match = _UNIT.fullmatch(bare)
    if match and match[1]:
        return match[1].strip(), re.sub(
            r" ?([/^*·]) ?", r"\1", (match[2] or match[3] or "").strip()
        )
    if bare.endswith(" %"):
        return bare[:-2].rstrip(), "%"
    return bare, ""
