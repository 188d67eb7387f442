"""Resolve the file of pairs of patches that a study names."""

import csv
import io
from dataclasses import replace

import numpy as np

from chromanoise import _check
from chromanoise._inputs import regular_file
from chromanoise.catalog.reflectances import (
    is_reflectance_file,
    resolve_patch,
    resolve_reflectances,
)
from chromanoise.catalog.resolve import file_of
from chromanoise.errors import InputError
from chromanoise.io.spectra import ASK, Answers
from chromanoise.io.spectra.parsed import Found
from chromanoise.spectra import PatchPairs, Spectra, all_pairs

PAIRS_HEADER = ("first", "second")
"""Of a list of pairs."""
_MOST_PAIRS = 2_000
_MOST_BYTES = 2**20


def resolve_pairs(word: str | Found, *, answers: Answers = ASK) -> PatchPairs:
    """The pairs of patches in a file, with reflectances on the default grid, 400-1050 nm.

    Parameters
    ----------
    word
        A list in CSV with the header ``first,second``, whose lines name two patches each: patches
        of the ColorChecker, reflectances of the catalog (``skin``), or numbers (``0.18``). Or a
        file of reflectances for `resolve_reflectances`, or curves in memory, all of whose pairs are
        taken.
    answers
        As for `resolve_reflectances`.

    Raises
    ------
    InputError
        If there is no such file, a line does not name two known patches, or as
        `resolve_reflectances`.
    """
    lines = None if isinstance(word, Found) else _listed(word)
    if isinstance(word, Found) or lines is None:
        curves = resolve_reflectances(word, answers=answers)
        if len(curves.names) * (len(curves.names) - 1) // 2 > _MOST_PAIRS:
            need, count = f"must have at most {_MOST_PAIRS} pairs of curves", len(curves.names)
            remedy = "name the pairs in a list with the header first,second"
            found = f"has {count} curves"
            raise InputError(curves.source, need, value=count, found=found, remedy=remedy)
        return all_pairs(curves)
    patches: dict[str, Spectra] = {}
    column: dict[str, int] = {}
    pairs = []
    for number, line in lines:
        where = f"{word}, line {number}"
        if len(line) != 2:
            raise InputError(
                "pairs", "must name two patches per line", value=",".join(line), where=where
            )
        for name in line:
            if name not in patches:
                column[name] = len(patches)
                patches[name] = _patch(name, where, answers)
        pairs.append([column[name] for name in line])
        if line[0] == line[1]:
            raise InputError("pairs", "must be of two patches", value=line[0], where=where)
    columns = [each.values[:, 0] for each in patches.values()]
    first = next(iter(patches.values()), None)
    if first is None:
        raise InputError(word, "must hold at least one pair of patches", found="has none")
    notes = tuple(dict.fromkeys(note for each in patches.values() for note in each.notes))
    table = replace(
        first, values=np.stack(columns, axis=1), names=tuple(patches), source=word, notes=notes
    )
    return PatchPairs(patches=table, indices=np.array(pairs))


def _patch(name: str, where: str, answers: Answers) -> Spectra:
    if is_reflectance_file(name):
        raise InputError(
            "pairs",
            "must name patches of the ColorChecker or of the catalog",
            value=name,
            where=where,
            remedy="put own curves into one file of reflectances: all its pairs are taken",
        )
    try:
        share: float | str = float(name)
    except ValueError:
        share = name
    try:
        return resolve_patch(share, answers=answers)
    except InputError as error:
        raise error.within(where) from None


def _listed(word: str) -> list[tuple[int, list[str]]] | None:
    """The lines of a list of pairs with their numbers; ``None`` for a file of reflectances."""
    path = file_of(word)
    regular_file(path)
    try:
        with path.open("rb") as file:
            start = file.read(_MOST_BYTES + 1)
    except OSError as error:
        raise InputError(word, f"cannot be read ({_check.reason(error)})") from None
    text = start.decode("utf-8-sig", errors="replace")
    reader = csv.reader(io.StringIO(text, newline=None))
    rows: list[tuple[int, list[str]]] = []
    try:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if not any(cells) or cells[0].startswith("#"):
                continue
            if not rows and tuple(cell.casefold() for cell in cells) != PAIRS_HEADER:
                return None
            rows.append((reader.line_num, cells))
    except csv.Error as error:
        if not rows:
            return None
        where = f"line {reader.line_num}"
        raise InputError(word, "must be a list in CSV", found=str(error), where=where) from None
    if not rows:
        return None
    if len(start) > _MOST_BYTES or len(rows) - 1 > _MOST_PAIRS:
        raise InputError(word, f"must hold at most {_MOST_PAIRS} pairs", value=len(rows) - 1)
    return rows[1:]
