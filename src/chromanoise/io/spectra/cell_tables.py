"""Interpretation of tables of cells from any format: rows of numbers and their columns.

Spectra may be in rows, and units in the cells of the wavelengths.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import numpy as np

from chromanoise.base import Array, InputError, text_of_cell
from chromanoise.io.source_files import has, refused
from chromanoise.io.spectra.declared import (
    declared_keys,
    is_row_of_units,
    is_wavelength_heading,
    with_units,
)
from chromanoise.io.spectra.parsed import LARGEST, Column, Found, Row, known_columns, missing_notes

_POINT = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d{1,4})?\s*%?", re.ASCII)
_PLAIN = re.compile(r"\d{1,20}(\.\d{0,20})?", re.ASCII)
_COMMA = re.compile(r"[+-]?(\d+(,\d+)?|,\d+)([eEdD][+-]?\d{1,4})?\s*%?", re.ASCII)
_MISSING = ("", "-", "--", "na", "n/a", "#n/a", "null", "none")
_NUMERAL = re.compile(r"[-+]?[.,]?\d|[-+]?(?:nan|inf)", re.IGNORECASE)
_COUNTS_ROWS = re.compile(r"(?i)(?:pixels?|index|points?|frame|row|column|no\.?|nr\.?|#)")
_OTHER_AXIS = re.compile(r"(?i)(?:wave ?numbers?|raman ?shifts?|frequency|(?:photon )?energy)")
_UNIT = re.compile(r"(.*?)[\s_]*(?:\[([^\[\]]*)\]|\(([^()]*)\))")
DIGITIZED = "digitized curves"
_LONGEST_CELL = 400
_MOST_CELLS = 2_000_000
_FEWEST_IN_LIST, _MOST_OF_RANGE = 5, 0.8
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
    if _PLAIN.fullmatch(cell):  # most cells
        return float(cell)
    if not is_number(cell, decimal_comma=decimal_comma):
        return _NAN
    plain = cell.strip().rstrip("% ").lower().replace("d", "e")
    value = float(plain.replace(",", ".") if decimal_comma else plain)
    return value if abs(value) <= LARGEST else _NAN


def finite_number(text: str, source: str, where: str, *, decimal_comma: bool = False) -> float:
    """The number in a cell, as `number_in`; an error names its place if it is none."""
    value = number_in(text, decimal_comma=decimal_comma)
    if value != value:
        raise refused(source, "must be a finite number", text.strip(), where=where)
    return value


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
        raise refused(source, f"must have at most {_MOST_CELLS} cells for a table of spectra")
    rows, twice = with_plain_wavelengths(rows)
    rows, unused = _with_wavelengths_first(rows, decimal == ",")
    rows, turned = as_columns(rows)
    first = _first_row_of_numbers(rows, decimal == ",")
    body = [row for row in rows[first:] if any(row.cells)]
    body, after = _without_words_after(body, decimal == ",", source, where)
    if len(body) < 2:
        need = "must have at least 2 rows of a wavelength and a value"
        raise refused(source, need, len(body), f"has {len(body)} in {len(rows)} {where}s")
    above = [row for row in rows[:first] if any(row.cells)]
    longest = max(len(_bare(row.cells)) for row in body)
    while delimiter == "blanks" and above and _is_sentence(above[-1], longest):
        above.pop()
    _refuse_no_wavelength_before_numbers(above, decimal == ",", source, where)
    named = [tuple(map(_name, _bare(row.cells))) for row in above]
    heads = _with_row_of_units(named)
    width = _width(body, above, head)
    names = _head(heads, head, width)
    _refuse_wavelengths_elsewhere(names, source)
    numbers, ragged = _numbers(body, names, decimal, source, where)
    _refuse_no_wavelengths(numbers, body, _in_pairs(heads, numbers), source, where)
    words = " ".join([*comments, *(" ".join(cells) for cells in heads[:-1])])
    keys = dict(declared_keys([*comments, *(": ".join(h) for h in heads if len(h) == 2)]))
    if _in_percent(body, names, 2 if _in_pairs(heads, numbers) else 1, source, where):
        keys["scale"] = "percent"
    if unit is not None:  # the unit of a quantity, which does not declare the level
        keys.pop("unit", None)
    found = {
        "source": source, "format": form, "words": words, "keys": keys,
        "delimiter": delimiter, "decimal": decimal, "defects": ragged,
        "notes": (*twice, *unused, *turned, *after),
    }  # fmt: skip
    if _in_pairs(heads, numbers):
        return _digitized(found, heads, numbers)
    lines = [row.number for row in body]
    return _shared(found, names, numbers, lines, where, unit)


def _in_percent(
    body: Sequence[Row], names: tuple[str, ...], step: int, source: str, where: str
) -> bool:
    """Whether each value has a percent sign; signs after some values are refused."""
    if not any("%" in cell for row in body for cell in row.cells):
        return False
    cells = [(row, k) for row in body for k in range(1, len(row.cells), step)]
    filled = [(row, k) for row, k in cells if row.cells[k].lower() not in _MISSING]
    signed = [(row, k) for row, k in filled if "%" in row.cells[k]]
    if len(signed) < len(filled) and not any("%" in name for name in names):
        are_few = len(signed) <= len(filled) / 2
        row, k = next((row, k) for row, k in filled if ("%" in row.cells[k]) == are_few)
        need = "must have a percent sign after each value or after none"
        place = f"{where} {row.number}, column {names[k][:40] or str(k + 1)!r}"
        raise refused(source, need, row.cells[k], where=place, remedy="correct it")
    return bool(signed)


def _name(cell: str) -> str:
    """The text of a heading in one line; a cell in a spreadsheet may have several."""
    return _OTHER_SPACES.sub(" ", text_of_cell(cell))


_OTHER_SPACES = re.compile(r" *[^\S ]\s*")


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
    return len(row.cells) > 1 and 0.5 * other < first < 2 * other


def _with_wavelengths_first(
    rows: Sequence[Row], comma: bool
) -> tuple[Sequence[Row], tuple[str, ...]]:
    """Rows without columns that are not curves, if the wavelengths then come first; and a note.

    These are columns of words, row numbers and other axes, such as wavenumbers. They are recognized
    only in a table with a column that has a heading of wavelengths.
    """
    for i, row in enumerate(rows):
        k = next((k for k, cell in enumerate(row.cells) if is_wavelength_heading(cell)), None)
        if k is None or len(row.cells) < 2:
            continue
        below = rows[i + 1 :]
        if len([*_numbers_below(below[:4], k, comma)]) < 2:
            continue
        drop = [
            j
            for j, name in enumerate(row.cells)
            if j != k and _is_no_curve(name, _numbers_below(below, k, comma), j, comma)
        ]
        if any(j not in drop for j in range(k)) or len(drop) == len(row.cells) - 1 or not drop:
            return rows, ()
        kept = [
            Row(one.number, tuple(c for j, c in enumerate(one.cells) if j not in drop))
            for one in rows
        ]
        names = ", ".join(repr(row.cells[j][:40]) for j in drop if row.cells[j])
        note = f"columns that are not curves are not used: {names}"
        return [one for one in kept if any(one.cells)], (note,) if names else ()
    return rows, ()


def _numbers_below(rows: Sequence[Row], k: int, comma: bool) -> Iterator[tuple[str, ...]]:
    """The rows with a number in column ``k``."""
    for row in rows:
        if len(row.cells) > k and is_number(row.cells[k], decimal_comma=comma):
            yield row.cells


def _is_no_curve(name: str, rows: Iterable[tuple[str, ...]], k: int, comma: bool) -> bool:
    """Whether column ``k`` with this heading holds row numbers, another axis or words."""
    bare = name_and_unit(name)[0]
    if _COUNTS_ROWS.fullmatch(bare) or _OTHER_AXIS.fullmatch(bare):
        return True
    words = set()
    for text in (cells[k] for cells in rows if len(cells) > k):
        if is_number(text, decimal_comma=comma):
            return False
        words.add(text.strip().lower())
    # a curve without any value is a curve, too, which is refused where it is read
    return words - {""} != {"nan"}


def _without_words_after(
    body: list[Row], comma: bool, source: str, where: str
) -> tuple[list[Row], tuple[str, ...]]:
    """The rows up to the text that follows the last number, and a note on that text."""
    end = len(body)
    for i in range(len(body) - 1, -1, -1):
        cells = [cell for cell in body[i].cells if cell]
        if not cells or _NUMERAL.match(cells[0]) or cells[0].lower() in _MISSING:
            if len(cells) > 1 and all(is_number(c, decimal_comma=comma) for c in cells[:2]):
                break
        else:
            end = i
    if end == len(body) or any(_NUMERAL.match(row.cells[0]) for row in body[end:]):
        return body, ()
    for row in body[end:]:
        values = [cell for cell in row.cells[1:] if cell]
        numbers = bool(values) and all(is_number(cell, decimal_comma=comma) for cell in values)
        if numbers and _like_a_number(row.cells[0]):
            raise _no_wavelength(row, source, where)
    first = body[end]
    text = next(cell for cell in first.cells if cell)
    count = len(body) - end
    what = f"1 {where}" if count == 1 else f"{count} {where}s"
    note = f"text after the numbers is not used: {what}, from {where} {first.number}, {text[:40]!r}"
    return body[:end], (note,)


def _with_row_of_units(heads: list[tuple[str, ...]]) -> list[tuple[str, ...]]:
    """Append a row of units to the names above it."""
    if len(heads) > 1 and len(heads[-1]) == len(heads[-2]) and is_row_of_units(heads[-1]):
        return [*heads[:-2], with_units(heads[-2], heads[-1])]
    return heads


def _bare(cells: tuple[str, ...]) -> tuple[str, ...]:
    """The rows without the empty cells at the end that spreadsheets write."""
    end = len(cells)
    while end and not cells[end - 1]:
        end -= 1
    return cells[:end]


def _is_sentence(row: Row, longest: int) -> bool:
    """Whether a line between blanks has more words than any row has numbers, and no heading."""
    return len(_bare(row.cells)) > longest and not is_wavelength_heading(row.cells[0])


def _width(body: list[Row], heads: Sequence[Row], head: tuple[str, ...]) -> int:
    lengths = Counter(len(_bare(row.cells)) for row in body)
    usual = max(lengths, key=lambda n: (lengths[n], n))
    named = len(_bare(heads[-1].cells)) if heads else len(head)
    if named < 2:
        return usual
    if usual - named > 1:
        first = heads[-1].cells[0] if heads else head[0]
        return named if is_wavelength_heading(first) else usual
    room = len(heads[-1].cells) if heads else len(head)
    ragged = len(lengths) > 1 and usual > room  # then the heading is correct and the rows are not
    return named if ragged else max(named, usual)


def _refuse_no_wavelength_before_numbers(
    above: Sequence[Row], comma: bool, source: str, where: str
) -> None:
    """Refuse ``4x0, 0.1`` above the rows of data: it is one of them, and no heading."""
    headed = False
    for row in above:
        first, values = row.cells[0], [cell for cell in row.cells[1:] if cell]
        if is_wavelength_heading(first):  # so are units, above numbers as names
            headed = True
            continue
        numbers = [cell for cell in values if is_number(cell, decimal_comma=comma)]
        rest = [cell for cell in values if cell not in numbers]
        if not numbers or not all(cell.lower() in _NO_NUMBER for cell in rest):
            continue
        may_be_names = row is not above[-1] or all(map(str.isdecimal, values))
        is_number_of_data = _like_a_number(first) or (headed and first.lower() in _NO_NUMBER)
        if is_number_of_data or not may_be_names:
            raise _no_wavelength(row, source, where)


def _like_a_number(cell: str) -> bool:
    """Whether a cell is a damaged number as ``4x0`` or ``400 410``, and no date and no name."""
    digits = sum(map(str.isdecimal, cell))
    return digits > sum(map(str.isalpha, cell)) and not _DATE_OR_NAME.match(cell)


_DATE_OR_NAME = re.compile(r"\d{4}-\d\d?-\d|(?!O)[A-Z]+ ?\d+$", re.ASCII)
_NO_NUMBER = (*_MISSING, "nan", "inf")


def _no_wavelength(row: Row, source: str, where: str) -> InputError:
    need, remedy = "must begin with a wavelength", ("correct it", "remove the row")
    return refused(source, need, row.cells[0], where=f"{where} {row.number}", remedy=remedy)


def _refuse_wavelengths_elsewhere(names: tuple[str, ...], source: str) -> None:
    others = [k for k, name in enumerate(names) if is_wavelength_heading(name)]
    if len(others) == 1 and others[0] > 0:
        k = others[0]
        need = "must have the wavelengths in the first column"
        found = f"{names[k][:40]!r} is the heading of column {k + 1}"
        remedy = "move them there, and remove columns that are not curves"
        raise refused(source, need, names[k], found, remedy=remedy)


def _refuse_no_wavelengths(
    numbers: np.ndarray, body: list[Row], pairs: bool, source: str, where: str
) -> None:
    at = numbers[:, ::2] if pairs else numbers[:, :1]
    wrong = np.argwhere(at <= 0)
    if len(wrong):
        i, k = (int(n) for n in wrong[0])
        place = f"{where} {body[i].number}"
        raise refused(source, "the wavelength must be > 0", float(at[i, k]), where=place)


def _numbers(
    body: list[Row], names: tuple[str, ...], decimal: str, source: str, where: str
) -> tuple[np.ndarray, tuple[str, ...]]:
    width = len(names)
    table: list[list[float]] = []
    short: list[int] = []
    for row in body:
        cells = _bare(row.cells)
        if len(cells) > width:
            need = f"must have at most {width} cells, as the heading"
            remedy = "separate cells with semicolons if commas are decimal signs"
            raise has(source, need, len(cells), where=f"{where} {row.number}", remedy=remedy)
        if len(row.cells) < width:
            short.append(row.number)
        if all(map(_PLAIN.fullmatch, cells)):  # most rows
            table.append([*map(float, cells), *[_NAN] * (width - len(cells))])
            continue
        table.append([_NAN] * width)
        for k, cell in enumerate(cells):
            table[-1][k] = value = number_in(cell, decimal_comma=decimal == ",")
            if k == 0 and "%" in cell:
                need, place = "the wavelength must be a plain number", f"{where} {row.number}"
                raise refused(source, need, cell, where=place, remedy="correct it")
            if value != value and cell.lower() not in _MISSING:
                comma = decimal == ","
                too_large = is_number(cell, decimal_comma=comma) and len(cell) < _LONGEST_CELL
                need = f"must be a number{f' below {LARGEST:g}' if too_large else ''}"
                place = f"{where} {row.number}, column {names[k][:40] or str(k + 1)!r}"
                cures = ("correct it", "remove the row")
                raise refused(source, need, cell, where=place, remedy=cures)
    numbers = np.array(table)
    if not short:
        return numbers, ()
    listed = ", ".join(str(number) for number in short[:5]) + (", ..." if len(short) > 5 else "")
    which = f"{where} {listed} has" if len(short) == 1 else f"{where}s {listed} have"
    return numbers, (f"ragged rows: {which} fewer than {width} cells",)


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
    whole = len(heads) > 0 and len(heads[-1]) >= 2 * pairs - 1
    if whole and all(heads[-1][::2]) and not any(heads[-1][1::2]):
        return True
    if whole and all(map(is_wavelength_heading, heads[-1][::2])):
        return True
    at, values = numbers[:, ::2], numbers[:, 1::2]
    known = np.isfinite(at).any(axis=0) & np.isfinite(values).any(axis=0)
    if np.isfinite(at).all() and len({bool(_is_monotone(one)) for one in at.T}) == 2:
        return False  # the wavelengths of all curves, followed by values
    return bool(
        known.all() and np.nanmin(at) >= 150 and np.nanmax(at) <= 5000 and np.nanmax(values) <= 110
    )


def _is_monotone(at: np.ndarray) -> bool:
    steps = np.diff(at)
    return bool((steps > 0).all() or (steps < 0).all())


def _digitized(found: dict, heads: list[tuple[str, ...]], numbers: np.ndarray) -> Found:
    names = [head for head in heads if {c.lower() for c in head} - {"x", "y", ""}]
    axes = [cell for cell in names[-1][::2] if is_wavelength_heading(cell)] if names else []
    if axes:  # each curve has two headings, and its name may be above them
        names = [_names_of_pairs(names[-2:], numbers.shape[1])]
    columns = []
    for k in range(numbers.shape[1] // 2):
        heading = names[-1][2 * k] if names and 2 * k < len(names[-1]) else ""
        name, unit = name_and_unit(heading)
        at, values = numbers[:, 2 * k], numbers[:, 2 * k + 1]
        both = np.isfinite(at) & np.isfinite(values)
        name = name or f"curve {k + 1}"
        columns.append(Column(name=name, unit=unit, wavelength=at[both], values=values[both]))
    note = "each curve has its own list of wavelengths, as digitizers write"
    form = f"{found['format']}, {DIGITIZED}"
    return Found(
        **{**found, "format": form, "notes": (note, *found["notes"])},
        columns=tuple(columns),
        heading=axes[0] if len(set(axes)) == 1 else "",
        named=bool(names),
    )


def _names_of_pairs(heads: list[tuple[str, ...]], width: int) -> tuple[str, ...]:
    """One name per pair of columns, at the place of its wavelengths."""
    above, last = [(*row, *("",) * width)[:width] for row in [("",), *heads][-2:]]
    names = [above[k] or above[k + 1] for k in range(0, width, 2)]
    own = last[1::2]
    if not all(names) or len(set(names)) < len(names):
        names = list(own)
    elif all("%" in text for text in own):
        names = [f"{name} [%]" for name in names]
    return tuple(cell for name in names for cell in (name, ""))


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
        place = f"{where} {at_lines[int(lost[0])]}"
        raise refused(found["source"], "has values but no wavelength", where=place)
    if numbers.shape[1] < 2:
        raise has(found["source"], "must have at least 2 columns", numbers.shape[1])
    names = [name_and_unit(text) if unit is None else (text, unit) for text in head[1:]]
    stems, texts = Counter(name for name, _ in names), Counter(head[1:])
    names = [
        (text, own) if text and stems[stem] > 1 == texts[text] else (stem, own)
        for text, (stem, own) in zip(head[1:], names, strict=True)
    ]
    columns: list[Column] = []
    missing: list[str] = []
    sweeps = _sweeps(numbers[:, 0])
    for k, (stem, unit) in enumerate(names):
        for i, rows in enumerate(sweeps, 1):
            name = stem or f"column {k + 2}"
            name = f"{name} ({i})" if len(sweeps) > 1 else name
            curve = [(name, numbers[rows, k + 1])]
            missing += missing_notes(numbers[rows, 0], curve, "empty cells")
            columns += known_columns(numbers[rows, 0], curve, {name: unit})
    listed = f"the wavelengths are listed {len(sweeps)} times: each list is a separate curve"
    return Found(
        **{
            **found,
            "defects": (*found["defects"], *missing),
            "notes": (*found["notes"], *((listed,) if len(sweeps) > 1 else ())),
        },
        columns=tuple(columns),
        heading=head[0],
        named=any(name for name, _ in names) or len(names) == 1,
    )


def _sweeps(at: Array) -> list[slice]:
    """The rows of each list of wavelengths, where whole lists follow each other.

    A list is whole if it has 5 wavelengths or more in one direction and covers most of the range.
    Overlapping ranges of two spectrometers and single repeated wavelengths do not start a new list.
    """
    steps = np.diff(at)
    if (steps > 0).all():
        return [slice(0, at.size)]
    falls = bool(np.median(np.sign(steps)) < 0) if steps.size else False
    starts = [0, *(np.flatnonzero(steps > 0 if falls else steps < 0) + 1).tolist(), at.size]
    rows = [slice(i, j) for i, j in pairwise(starts)]
    span = _MOST_OF_RANGE * float(np.ptp(at))
    whole = all(i.stop - i.start >= _FEWEST_IN_LIST and np.ptp(at[i]) >= span for i in rows)
    return rows if whole else [slice(0, at.size)]


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


_IN_NM = re.compile(r"(?:spectral data )?(\d+(?:\.\d+)?)\s*[\[(]?nm[\])]?", re.IGNORECASE)
_UNSIGNED = re.compile(r"\d+(?:\.\d+)?", re.ASCII)
_FEWEST_WAVELENGTHS = 5
_LEAST_NM = 100.0


def as_columns(rows: Sequence[Row]) -> tuple[Sequence[Row], tuple[str, ...]]:
    """Rows with one wavelength per row, and a note if the table was transposed.

    Notes
    -----
    Spectra are in rows if the heading has increasing wavelengths after one or more cells of words,
    and the rows below begin with words, or with whole numbers of which some are too small to be
    wavelengths. If the heading says ``wavelength`` above numbers, spectra are in columns.
    """
    for i, row in enumerate(rows):
        if not row.cells or _wavelength(row.cells[0]):
            continue
        words = next((k for k, cell in enumerate(row.cells) if _wavelength(cell)), 0)
        heads = [*map(_wavelength, row.cells[words:])] if words else []
        if len(heads) >= _FEWEST_WAVELENGTHS and all(heads) and _rises(heads):
            below = [other for other in rows[i + 1 :] if any(other.cells)]
            if _are_spectra(row.cells[:words], heads, below):
                return _turned(row, words, heads, below)
            return rows, ()
    return rows, ()


def with_plain_wavelengths(rows: Sequence[Row]) -> tuple[Sequence[Row], tuple[str, ...]]:
    """Rows such as ``380nm, 0.1`` or ``Spectral Data 380[nm], 0.1`` under a heading with the unit.

    If a spectrum is listed several times with different steps, the list with the most wavelengths
    is kept, and a note says so.

    Examples
    --------
    >>> rows = [Row(n, (f"{w}nm", "0.5")) for n, w in ((1, 400), (2, 410))]
    >>> [row.cells for row in with_plain_wavelengths(rows)[0]]
    [('wavelength [nm]', 'column 2'), ('400', '0.5'), ('410', '0.5')]
    """
    starts = (row.cells[0] if row.cells else "" for row in rows)
    at = [None if start[-1:].isdigit() else _IN_NM.fullmatch(start) for start in starts]
    first = next((i for i, match in enumerate(at) if match), None)
    if first is None or sum(map(bool, at)) < 2:
        return rows, ()
    if first and _UNSIGNED.fullmatch(rows[first - 1].cells[0]):
        return rows, ()  # plain wavelengths above: these rows are refused where numbers are read
    plain = [
        Row(row.number, (match[1], *row.cells[1:])) if match else row
        for row, match in zip(rows[first:], at[first:], strict=True)
    ]
    plain, notes = _finest(plain, [float(match[1]) if match else None for match in at[first:]])
    width = len(rows[first].cells)
    above = rows[first - 1].cells if first and len(rows[first - 1].cells) == width else ()
    if above and not (is_wavelength_heading(above[0]) or not above[0]):
        above = ()  # another fact in two cells, such as an integration time
    names = above[1:] or tuple(f"column {k}" for k in range(2, width + 1))
    heading = Row(rows[first].number, ("wavelength [nm]", *names))
    return [*rows[: first - bool(above)], heading, *plain], notes


def _finest(rows: list[Row], at: Sequence[float | None]) -> tuple[list[Row], tuple[str, ...]]:
    """The rows of the list with the most wavelengths, if the first wavelength comes again."""
    starts = [i for i, one in enumerate(at) if one is not None and one == at[0]]
    parts = [range(i, j) for i, j in pairwise([*starts, len(rows)])]
    counts = [sum(at[i] is not None for i in part) for part in parts]
    if len(parts) < 2 or len(set(counts)) < len(counts):
        return rows, ()
    best = counts.index(max(counts))
    kept = [rows[i] for i in parts[best] if at[i] is not None]
    after = [rows[i] for i in parts[-1] if at[i] is None]
    note = (
        f"the spectrum is listed {len(parts)} times: the list of {max(counts)} wavelengths is used"
    )
    return [*kept, *after], (note,)


def _wavelength(cell: str) -> str:
    """The number of a wavelength in a heading; empty if there is none."""
    if _UNSIGNED.fullmatch(cell):
        return cell
    match = _IN_NM.fullmatch(cell)
    return match[1] if match else ""


def _rises(heads: Sequence[str]) -> bool:
    at = [float(head) for head in heads]
    return all(a < b for a, b in pairwise(at)) and at[0] > 0


def _are_spectra(corner: tuple[str, ...], heads: Sequence[str], below: Sequence[Row]) -> bool:
    if not below or any(len(row.cells) < len(corner) + 2 for row in below):
        return False
    columns = list(zip(*(row.cells[: len(corner)] for row in below), strict=True))
    words = [_mostly_words(column) for column in columns]
    if any(map(is_wavelength_heading, corner)) and not words[0]:
        return False
    if any(words):
        return True
    numbers = [float(cell) for cell in columns[0] if _UNSIGNED.fullmatch(cell)]
    whole = len(numbers) == len(below) and all(number == int(number) for number in numbers)
    return whole and min(numbers) < _LEAST_NM <= float(heads[0])


def _mostly_words(column: Sequence[str]) -> bool:
    """Whether more cells hold words than numbers; a single bad number does not count as a name."""
    return sum(1 for cell in column if not _UNSIGNED.fullmatch(cell)) > len(column) / 2


def _turned(
    row: Row, words: int, heads: Sequence[str], below: Sequence[Row]
) -> tuple[Sequence[Row], tuple[str, ...]]:
    known = next((cell for cell in row.cells[:words] if is_wavelength_heading(cell)), "wavelength")
    in_nm = any(map(_IN_NM.fullmatch, row.cells[words:]))
    names = (" ".join(filter(None, other.cells[:words])) for other in below)
    heading = Row(row.number, ("wavelength [nm]" if in_nm else known, *names))
    width = words + len(heads)
    values = zip(*((other.cells + ("",) * width)[words:width] for other in below), strict=True)
    turned = [Row(row.number, (head, *cells)) for head, cells in zip(heads, values, strict=True)]
    note = f"its spectra are in rows: {len(below)} at {len(heads)} wavelengths"
    return [heading, *turned], (note,)
