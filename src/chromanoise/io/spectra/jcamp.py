"""JCAMP-DX files (``.jdx``, ``.dx``): one curve per block.

McDonald & Wilks, Appl. Spectrosc. 42, 151 (1988), version 4.24; Lampen et al., Pure Appl. Chem. 71,
1549 (1999), version 5.01 with ``NTUPLES``. The Python packages for it (jcamp 1.2) do not compare
the number of points and the check values of a file with its declarations.
"""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import field

import numpy as np

from chromanoise.base import Array, dataclass
from chromanoise.io.source_files import errors_within, refused
from chromanoise.io.spectra.cell_tables import finite_number
from chromanoise.io.spectra.declared import known_unit
from chromanoise.io.spectra.parsed import Column, Found, Unit

_LABEL = re.compile(r"\s*##(.*?)=(.*)", re.DOTALL)
_EQUAL_STEPS = re.compile(r"\(?\s*([A-Z])\+\+\(\s*([A-Z])\.\.[A-Z]\s*\)\s*\)?", re.IGNORECASE)
_PAIRS = re.compile(r"\(\s*([A-Z])\s*([A-Z])\s*\.\.\s*[A-Z]{2}\s*\)", re.IGNORECASE)
_TABLES = ("XYDATA", "XYPOINTS", "DATATABLE")
_X = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[Ee][+-]\d+)?)")
_Y = re.compile(
    r"[\s,;]*(?:([@A-Ia-i]|[%J-Rj-r]|[S-Zs])(\d*\.?\d*)|"
    r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[Ee][+-]\d+)?)|(\?))"
)
_DIGITS = {
    letter: sign + str(digit)
    for letters, sign, first in (
        ("@ABCDEFGHI", "", 0), ("abcdefghi", "-", 1), ("%JKLMNOPQR", "", 0), ("jklmnopqr", "-", 1),
        ("STUVWXYZs", "", 1),
    )
    for digit, letter in enumerate(letters, first)
}  # fmt: skip
_DIFFERENCES = frozenset("%JKLMNOPQRjklmnopqr")
_REPEATS = frozenset("STUVWXYZs")
_COMMA = re.compile(r"(?:[+-]?\d+,\d+,\s+[+-]?\d+(?:,\d+)?\s*)+")
_MOST_POINTS = 1_000_000


@dataclass(frozen=True)
class _Table:
    """One table of a block, with the declarations that apply to it."""

    title: str
    facts: dict[str, str]
    form: str
    lines: list[tuple[int, str]] = field(default_factory=list)


def is_jcamp(text: str) -> bool:
    """Whether the first line has the label TITLE, as JCAMP-DX demands."""
    return re.match(r"\s*##\s*TITLE\s*=", text, re.IGNORECASE) is not None


def read_jcamp(text: str, source: str) -> Found:
    """The curves of all blocks, named by their titles; none is divided by another.

    Raises
    ------
    InputError
        If a block has no table of a curve, its numbers contradict its declarations, or its axis
        has no wavelengths; the message names the line or the block.
    """
    tables = list(_tables(text, source))
    if not tables:
        need = "must have a table XYDATA or XYPOINTS, as a JCAMP-DX file of a curve"
        raise refused(source, need, remedy="export the spectrum, not its peaks or its structure")
    units = {_unit(table, source) for table in tables}
    if len(units) > 1:
        need = "must have one unit of wavelengths in all blocks"
        remedy = "export each block to its own file"
        raise refused(source, need, tuple(sorted(units)), remedy=remedy)
    titles = [table.title for table in tables]
    counts = Counter(titles)
    names = [t if counts[t] == 1 else f"{t} ({k})" for k, t in enumerate(titles, 1)]
    several = (f"its {len(tables)} blocks are separate curves",) if len(tables) > 1 else ()
    return Found(
        source=source,
        format="JCAMP-DX",
        columns=tuple(_column(t, n, source) for t, n in zip(tables, names, strict=True)),
        words=" ".join(titles),
        wavelength_unit=units.pop(),
        notes=several,
    )


def _tables(text: str, source: str) -> Iterator[_Table]:
    title = ""
    facts: dict[str, str] = {}
    shared: dict[str, str] = {}
    table: _Table | None = None
    for number, raw in enumerate(re.split(r"\r\n|\r|\n", text), 1):
        line = raw.partition("$$")[0]
        labeled = _LABEL.match(line)
        if labeled is None:
            if table is not None and line.strip():
                table.lines.append((number, line.strip()))
            continue
        label = re.sub(r"[\s/_-]", "", labeled[1]).upper()
        value = labeled[2].strip()
        if table is not None:
            yield table
            table = None
        if label == "TITLE":
            title, facts, shared = value, {}, {}
        elif label == "NTUPLES":
            shared = facts
        elif label in _TABLES:
            form = value.partition(",")[0] if label == "DATATABLE" else value
            own = _of_tuple(facts, form, source) if label == "DATATABLE" else facts
            page = facts.get("PAGE", "")
            table = _Table(", ".join(filter(None, (title, page))), {**shared, **own}, form)
        else:
            facts[label] = value
    if table is not None:
        yield table


def _of_tuple(facts: dict[str, str], form: str, source: str) -> dict[str, str]:
    """The declarations of a table of ``NTUPLES`` under the labels of a plain block."""
    lists = {key: [c.strip() for c in value.split(",")] for key, value in facts.items()}
    match = _EQUAL_STEPS.match(form) or _PAIRS.match(form)
    symbols = [symbol.upper() for symbol in lists.get("SYMBOL", [])]
    if match is None or not {match[1].upper(), match[2].upper()} <= set(symbols):
        raise refused(
            source, "must declare the symbols of its table in NTUPLES", form, where="DATA TABLE"
        )
    x, y = (symbols.index(match[k].upper()) for k in (1, 2))
    wanted = {
        "XUNITS": ("UNITS", x), "YUNITS": ("UNITS", y), "XFACTOR": ("FACTOR", x),
        "YFACTOR": ("FACTOR", y), "FIRSTX": ("FIRST", x), "LASTX": ("LAST", x),
        "NPOINTS": ("VARDIM", y),
    }  # fmt: skip
    found = {key: lists.get(label, [])[at : at + 1] for key, (label, at) in wanted.items()}
    return {key: value[0] for key, value in found.items() if value and value[0]}


def _unit(table: _Table, source: str) -> Unit:
    with errors_within(source, f"XUNITS of block {table.title[:60]!r}"):
        return known_unit(table.facts.get("XUNITS", ""), source)


def _column(table: _Table, name: str, source: str) -> Column:
    where = f"block {name[:60]!r}"
    if _EQUAL_STEPS.match(table.form):
        at, values = _equal_steps(table, where, source)
    elif _PAIRS.match(table.form):
        at, values = _pairs(table, where, source)
    else:
        raise refused(source, "must be (X++(Y..Y)) or (XY..XY)", table.form, where=where)
    known = np.isfinite(values)
    unit = table.facts.get("YUNITS", "")
    return Column(name=name, unit=unit, wavelength=at[known], values=values[known])


def _number(table: _Table, label: str, where: str, source: str, default: str = "") -> float:
    text = table.facts.get(label, default)
    return finite_number(text, source, f"{label} of {where}", decimal_comma="," in text)


def _refuse_other_count(table: _Table, count: int, where: str, source: str) -> None:
    if "NPOINTS" in table.facts and _number(table, "NPOINTS", where, source) != count:
        need = f"must have {table.facts['NPOINTS']} points, as NPOINTS declares"
        raise refused(source, need, count, f"has {count}: it is damaged or cut short", where=where)


def _pairs(table: _Table, where: str, source: str) -> tuple[Array, Array]:
    comma = all(_COMMA.fullmatch(line) for _, line in table.lines)
    numbers: list[float] = []
    for number, line in table.lines:
        parted = re.sub(r",(?=\s|$)", " ", line) if comma else line.replace(",", " ")
        numbers += [
            finite_number(cell, source, f"line {number}", decimal_comma=comma)
            for cell in parted.replace(";", " ").split()
        ]
    _refuse_other_count(table, (len(numbers) + 1) // 2, where, source)
    if len(numbers) % 2:
        raise refused(source, "must hold pairs of numbers", len(numbers), where=where)
    points = np.array(numbers).reshape(-1, 2)
    factors = [_number(table, label, where, source, "1") for label in ("XFACTOR", "YFACTOR")]
    return points[:, 0] * factors[0], points[:, 1] * factors[1]


def _equal_steps(table: _Table, where: str, source: str) -> tuple[Array, Array]:
    stored: list[float] = []
    starts: list[tuple[int, int, float]] = []
    differs = False
    for number, line in table.lines:
        start = _X.match(line)
        if start is None:
            raise refused(source, "must begin with a wavelength", line[:40], where=f"line {number}")
        values, ends_in_difference = _ordinates(line[start.end() :], number, source)
        if differs and stored and values:  # the first value repeats the last one, as a check
            if values[0] != stored[-1]:
                need = f"must begin with {stored[-1]:g}, the last value of the line before"
                remedy = "export it again, because it is damaged"
                raise refused(source, need, values[0], where=f"line {number}", remedy=remedy)
            stored.pop()
        starts.append((number, len(stored), float(start[1])))
        stored += values
        differs = ends_in_difference
        if len(stored) > _MOST_POINTS:
            raise refused(source, f"must have at most {_MOST_POINTS} points", where=where)
    _refuse_other_count(table, len(stored), where, source)
    first, last = (_number(table, label, where, source) for label in ("FIRSTX", "LASTX"))
    at = np.linspace(first, last, len(stored))
    _refuse_other_start(table, starts, at, where, source)
    factor = _number(table, "YFACTOR", where, source, "1")
    return at, np.array(stored) * factor


def _refuse_other_start(
    table: _Table, starts: Sequence[tuple[int, int, float]], at: Array, where: str, source: str
) -> None:
    """Raise an error if a line does not begin at the wavelength that follows from its place."""
    factor = _number(table, "XFACTOR", where, source, "1")
    step = abs(float(at[1] - at[0])) if at.size > 1 else 0.0
    for number, place, stored in starts:
        if place < at.size and abs(stored * factor - at[place]) > max(step, abs(factor)):
            need = f"must begin at {at[place]:g}, as FIRSTX, LASTX and the points before declare"
            remedy = "export it again, because it is damaged"
            raise refused(source, need, stored * factor, where=f"line {number}", remedy=remedy)


def _ordinates(text: str, number: int, source: str) -> tuple[list[float], bool]:
    """The values of a line in any of the forms of JCAMP-DX, and whether the last is a difference.

    Examples
    --------
    >>> _ordinates(" 1 2 -3", 1, "s")[0], _ordinates("+1+2-3", 1, "s")[0]
    ([1.0, 2.0, -3.0], [1.0, 2.0, -3.0])
    >>> _ordinates("A0J%Tj2", 1, "s")  # 10, +1, 0 twice, -12
    ([10.0, 11.0, 11.0, 11.0, -1.0], True)
    """
    values: list[float] = []
    at, change, differs = 0, 0.0, False
    while at < len(text.rstrip(" \t,;")):
        match = _Y.match(text, at)
        letter = match[1] if match else None
        repeats = letter is not None and letter in _REPEATS
        if match is None or ((repeats or letter in _DIFFERENCES) and not values):
            need = "must be numbers in a form of JCAMP-DX"
            raise refused(source, need, text[at : at + 20], where=f"line {number}")
        at = match.end()
        if letter is None:
            values.append(float(match[3]) if match[3] else float("nan"))
            differs = False
        elif repeats:
            count = int(_DIGITS[letter] + match[2]) - 1
            if count + len(values) > _MOST_POINTS:
                raise refused(
                    source, f"must have at most {_MOST_POINTS} points", where=f"line {number}"
                )
            for _ in range(count):
                values.append(values[-1] + (change if differs else 0.0))
        elif letter in _DIFFERENCES:
            change, differs = float(_DIGITS[letter] + match[2]), True
            values.append(values[-1] + change)
        else:
            values.append(float(_DIGITS[letter] + match[2]))
            differs = False
    return values, differs
