"""Resolve the reflectances that a study names: its chart, its prior, the patch it analyzes.

Resolve the file of pairs of patches that a study names.
"""

import csv
import io
import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np

from chromanoise.base import InputError, check, did_you_mean, regular_file
from chromanoise.io import library_files, read_curves
from chromanoise.io.spectra import ASK, Answers, Found
from chromanoise.spectra import (
    DEFAULT_GRID,
    SMALL_NEGATIVES,
    PatchPairs,
    Spectra,
    all_pairs,
    colorchecker,
    means_on_grid,
    reflectance_named,
    refuse_outside,
    used_on_grid,
)
from chromanoise.spectra.tables import catalog_tables
from chromanoise.study.resolve import file_of

MOST_REFLECTANCE = 2.0
"""Highest reflectance that is accepted; fluorescence and gloss exceed 1."""

_ENDING = re.compile(r"\.[A-Za-z]\w*$")
_FILE_KINDS = ("reflectance", "transmittance", None)


def is_reflectance_file(word: str, folder: Path = Path()) -> bool:
    """Whether a word for reflectances names a file, also with ``:NAME`` of one of its curves.

    Parameters
    ----------
    word
        The word.
    folder
        The folder to which a file name is relative.

    Examples
    --------
    >>> [is_reflectance_file(word) for word in ("cards.csv", "cards.csv:red", "dark skin", "lawn")]
    [True, True, False, False]
    """
    if word in _known_patches():
        return False
    return any(
        name.startswith((".", "/", "~"))
        or "/" in name
        or _ENDING.search(name)
        or os.path.isfile(folder / name)  # noqa: PTH113 - also accepts names that are too long
        for name in (word, *_heads(word))
    )


def reflectance_files(word: str) -> tuple[Path, ...]:
    """The files on which a word for reflectances depends; none if it is a name.

    Raises
    ------
    InputError
        If the data file of a header is missing.
    """
    return library_files(_file_and_name(word)[0]) if is_reflectance_file(word) else ()


def resolve_reflectances(word: str | Found, *, answers: Answers = ASK) -> Spectra:
    """The reflectances in a file, on the default grid, 400-1050 nm.

    Parameters
    ----------
    word
        The file, in any format of `read_curves`, or curves in memory.
    answers
        The user's answers about it; ``beyond`` extrapolates curves that do not cover the grid.

    Raises
    ------
    InputError
        If there is no such file, it cannot be read, holds another quantity, does not cover
        400-1050 nm and ``answers.beyond`` is ``refuse``, or a value is not 0 .. 2.
    """
    file = word if isinstance(word, Found) else file_of(word)
    if not isinstance(file, Found) and not os.path.lexists(file):
        raise InputError(str(word), "cannot be read (No such file or directory)")
    read = read_curves(file, answers=replace(answers, quantity="reflectance"))
    declared = read_curves(file, answers=answers).quantity
    if declared not in _FILE_KINDS:
        raise InputError(
            read.curves.source, "must hold reflectances", value=declared, found=f"holds {declared}"
        )
    notes = (*read.curves.notes, *read.notes, *read.defects)
    curves = replace(read.curves, notes=notes, quantity="reflectance", unit="1")
    remedy = "divide percent by 100" if curves.values.max() > MOST_REFLECTANCE else SMALL_NEGATIVES
    used = used_on_grid(curves.wavelength_nm, DEFAULT_GRID)
    refuse_outside(curves, high=MOST_REFLECTANCE, remedy=remedy, used=used)
    return means_on_grid(curves, DEFAULT_GRID, beyond=answers.beyond)


def resolve_patch(word: str | float | Found, *, answers: Answers = ASK) -> Spectra:
    """One reflectance, on the default grid, 400-1050 nm.

    Parameters
    ----------
    word
        A number, the name of a ColorChecker patch, a reflectance of the catalog (``lawn``,
        ``gray-18``), or ``FILE`` or ``FILE:NAME`` of a file for `resolve_reflectances`.
    answers
        As for `resolve_reflectances`.

    Raises
    ------
    InputError
        If there is no such patch, several curves leave open which, or as `resolve_reflectances`.

    Examples
    --------
    >>> resolve_patch(0.18).values[:2, 0]
    array([0.18, 0.18])
    >>> resolve_patch("dark skin").names
    ('dark skin',)
    """
    if isinstance(word, Found):
        names = tuple(one.name for one in word.columns)
        if len(names) != 1:
            raise InputError(
                "patch",
                "must be one curve",
                value=names,
                found=f"{word.source} has {len(names)} ({', '.join(names[:8])})",
                remedy="select one of them",
            )
        return resolve_reflectances(word, answers=answers)
    if not isinstance(word, str):
        share = check.within("patch", "1", word, 0.0, 1.0)
        flat = colorchecker(DEFAULT_GRID)
        values = np.full((DEFAULT_GRID.n, 1), share)
        return replace(flat, values=values, names=(f"{share:g}",), source=f"{share:g}", notes=())
    chart = colorchecker(DEFAULT_GRID)
    if word in chart.names:
        return _one(chart, word)
    if is_reflectance_file(word):
        file, name = _file_and_name(word)
        return _one(resolve_reflectances(str(file), answers=answers), name)
    if not re.fullmatch(r"gray-[\d.]+", word):
        _refuse_unknown(word)
    return _one(reflectance_named(word, DEFAULT_GRID, beyond=answers.beyond), "")


def _refuse_unknown(word: str) -> None:
    known = _known_patches()
    if word not in known:
        otherwise = "give a number, a file, or a patch of the ColorChecker, e.g. dark skin"
        remedy = did_you_mean(word, known, otherwise, most=2, cutoff=0.6)
        need = "must be a number, a file, or a known name"
        raise InputError("patch", need, value=word, remedy=remedy)


def _known_patches() -> tuple[str, ...]:
    return (*colorchecker(DEFAULT_GRID).names, *catalog_tables("reflectance"))


def _one(spectra: Spectra, name: str) -> Spectra:
    """One curve; the only one if the name is empty."""
    if not name and len(spectra.names) != 1:
        listed = ", ".join(spectra.names[:8])
        raise InputError(
            "patch",
            "must name one of several curves, as FILE:NAME",
            value=spectra.source,
            found=f"names none of the {len(spectra.names)} of {spectra.source} ({listed})",
        )
    wanted = name or spectra.names[0]
    if wanted not in spectra.names:
        otherwise = f"it has {', '.join(spectra.names[:8])}"
        remedy = did_you_mean(wanted, spectra.names, otherwise, most=2, cutoff=0.6)
        need = f"must be a curve of {spectra.source}"
        raise InputError("patch", need, value=wanted, remedy=remedy)
    column = spectra.names.index(wanted)
    return replace(spectra, values=spectra.values[:, [column]], names=(wanted,))


def _heads(word: str) -> list[str]:
    """What stands before each colon, the longest first."""
    return [word[:i] for i in range(len(word) - 1, 0, -1) if word[i] == ":"]


def _file_and_name(word: str) -> tuple[Path, str]:
    """The file, and the name of one of its curves; empty if none is given."""
    for head in (word, *_heads(word)):
        if file_of(head).exists():
            return file_of(head), word[len(head) + 1 :]
    head = next((one for one in _heads(word) if _ENDING.search(one)), word)
    return file_of(head), word[len(head) + 1 :]


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
        raise InputError(word, f"cannot be read ({check.reason(error)})") from None
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
