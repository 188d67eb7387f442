"""A photon-transfer table from CSV: ``mean_dn,variance_dn2``, perhaps ``samples`` and ``light``."""

import csv
import math
import re
from pathlib import Path

import numpy as np

from chromanoise._check import InputError
from chromanoise.sensor.photon_transfer import PhotonTransfer
from chromanoise.sensor.source_text import source_text

_NEEDED = ("mean_dn", "variance_dn2")
_KNOWN = (*_NEEDED, "samples", "light")
_ALIASES = {"mean": "mean", "signal": "mean", "variance": "variance", "var": "variance"}
_CODES = {"dn": "dn", "adu": "dn", "dn^2": "dn2", "dn2": "dn2", "dn²": "dn2", "adu^2": "dn2"}
_WITH_UNIT = re.compile(
    rf"({'|'.join(_ALIASES)})[\s_]*[\[(]?({'|'.join(map(re.escape, _CODES))})[\])]?"
)
_LARGEST_ROWS = 100_000


def read_photon_transfer_csv(path: Path | str) -> PhotonTransfer:
    """The photon transfer of a CSV file, one row per light.

    Parameters
    ----------
    path
        The first row names the columns: ``mean_dn`` and ``variance_dn2`` (or with the unit in
        brackets, ``mean [DN]`` and ``variance [DN^2]``), perhaps ``samples`` (pixels behind each
        variance) and ``light`` (``dark`` or ``light``). ``#`` starts a comment.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing, or a cell is not a number; file, line and
        column are told.
    """
    path = Path(path)
    lines = [
        (i, line)
        for i, line in enumerate(source_text(path).splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines or len(lines) > _LARGEST_ROWS:
        raise InputError(
            f"{path}: a photon transfer has a header {','.join(_NEEDED)} and at most "
            f"{_LARGEST_ROWS} rows, but this file has {len(lines)} lines"
        )
    header = _header(lines[0], path)
    rows = [_row(line, number, header, path) for number, line in lines[1:]]
    return PhotonTransfer(
        mean_dn=np.array([row["mean_dn"] for row in rows]),
        variance_dn2=np.array([row["variance_dn2"] for row in rows]),
        dark=np.array([row["light"] == 0.0 for row in rows], dtype=bool),
        samples=np.array([row["samples"] for row in rows]) if "samples" in header else None,
        source=path.name,
    )


def _cells(line: str, where: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line], strict=True))]
    except csv.Error as error:
        raise InputError(f"{where} is no row of a CSV ({error})") from None


def is_photon_transfer_text(text: str) -> bool:
    r"""Whether the first row that is no comment names a mean and a variance.

    Examples
    --------
    >>> is_photon_transfer_text("# a bench\nMean [DN],Variance [DN^2]")
    True
    """
    lines = (line.strip().lower() for line in text.splitlines())
    first = next((line for line in lines if line and not line.startswith("#")), "")
    names = [_name(cell) for cell in first.split(",")]
    return any(name in names for name in _NEEDED) or {"mean", "variance"} <= set(names)


def _name(cell: str) -> str:
    """``mean_dn`` for ``Mean [DN]``, ``variance_dn2`` for ``var (DN^2)``."""
    match = _WITH_UNIT.fullmatch(cell.strip().lower())
    return f"{_ALIASES[match[1]]}_{_CODES[match[2]]}" if match else cell.strip().lower()


def _header(first: tuple[int, str], path: Path) -> list[str]:
    where = f"{path}: line {first[0]}"
    header = [_name(cell) for cell in _cells(first[1], where)]
    bare = [name for name in ("mean", "variance") if name in header]
    if bare:
        raise InputError(
            f"{where} names {' and '.join(bare)} without a unit; if they are in codes, write "
            f"{','.join(_NEEDED)}"
        )
    missing = [name for name in _NEEDED if name not in header]
    if missing or len(set(header)) < len(header):
        raise InputError(
            f"{where} must name each column once, {' and '.join(_NEEDED)} among them, "
            f"but is {first[1].strip()[:60]!r}"
        )
    return header


def _row(line: str, number: int, header: list[str], path: Path) -> dict[str, float]:
    where = f"{path}: line {number}"
    cells = _cells(line, where)
    if len(cells) != len(header):
        raise InputError(f"{where} has {len(cells)} cells, but the header names {len(header)}")
    row = {"light": 1.0}
    for name, cell in zip(header, cells, strict=True):
        if name == "light":
            if cell.lower() not in ("dark", "light"):
                raise InputError(f"{where}, column light: {cell[:40]!r} is neither dark nor light")
            row[name] = float(cell.lower() == "light")
        elif name in _KNOWN:
            row[name] = _number(cell, f"{where}, column {name}")
    return row


def _number(cell: str, where: str) -> float:
    try:
        value = math.nan if "_" in cell else float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{where}: {cell[:40]!r} is not a finite number; mend it or leave it out")
    return value
