"""Other table layouts: spectra in rows, units in the cells of wavelengths."""

import re
from collections.abc import Sequence
from itertools import pairwise

from chromanoise.io.spectra.declared import is_wavelength_heading
from chromanoise.io.spectra.parsed import Row

_IN_NM = re.compile(r"(?:spectral data )?(\d+(?:\.\d+)?)\s*[\[(]?nm[\])]?", re.IGNORECASE)
_PLAIN = re.compile(r"\d+(?:\.\d+)?", re.ASCII)
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
        words = next((k for k, cell in enumerate(row.cells) if _wavelength(cell)), 0)
        heads = [*map(_wavelength, row.cells[words:])]
        if words and len(heads) >= _FEWEST_WAVELENGTHS and all(heads) and _rises(heads):
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
    >>> rows = [Row(number=n, cells=(f"{w}nm", "0.5")) for n, w in ((1, 400), (2, 410))]
    >>> [row.cells for row in with_plain_wavelengths(rows)[0]]
    [('wavelength [nm]', 'column 2'), ('400', '0.5'), ('410', '0.5')]
    """
    at = [_IN_NM.fullmatch(row.cells[0]) if row.cells else None for row in rows]
    first = next((i for i, match in enumerate(at) if match), None)
    if first is None or sum(map(bool, at)) < 2:
        return rows, ()
    plain = [
        Row(number=row.number, cells=(match[1], *row.cells[1:])) if match else row
        for row, match in zip(rows[first:], at[first:], strict=True)
    ]
    plain, notes = _finest(plain, [float(match[1]) if match else None for match in at[first:]])
    width = len(rows[first].cells)
    above = rows[first - 1].cells if first and len(rows[first - 1].cells) == width else ()
    if above and not (is_wavelength_heading(above[0]) or not above[0]):
        above = ()  # another fact in two cells, such as an integration time
    names = above[1:] or tuple(f"column {k}" for k in range(2, width + 1))
    heading = Row(number=rows[first].number, cells=("wavelength [nm]", *names))
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
    match = _IN_NM.fullmatch(cell)
    return match[1] if match else cell if _PLAIN.fullmatch(cell) else ""


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
    numbers = [float(cell) for cell in columns[0] if _PLAIN.fullmatch(cell)]
    whole = len(numbers) == len(below) and all(number == int(number) for number in numbers)
    return whole and min(numbers) < _LEAST_NM <= float(heads[0])


def _mostly_words(column: Sequence[str]) -> bool:
    """Whether more cells hold words than numbers; a single bad number does not count as a name."""
    return sum(1 for cell in column if not _PLAIN.fullmatch(cell)) > len(column) / 2


def _turned(
    row: Row, words: int, heads: Sequence[str], below: Sequence[Row]
) -> tuple[Sequence[Row], tuple[str, ...]]:
    known = next((cell for cell in row.cells[:words] if is_wavelength_heading(cell)), "wavelength")
    in_nm = any(map(_IN_NM.fullmatch, row.cells[words:]))
    names = (" ".join(filter(None, other.cells[:words])) for other in below)
    heading = Row(number=row.number, cells=("wavelength [nm]" if in_nm else known, *names))
    width = words + len(heads)
    values = zip(*((other.cells + ("",) * width)[words:width] for other in below), strict=True)
    turned = [
        Row(number=row.number, cells=(head, *cells))
        for head, cells in zip(heads, values, strict=True)
    ]
    note = f"its spectra are in rows: {len(below)} at {len(heads)} wavelengths"
    return [heading, *turned], (note,)
