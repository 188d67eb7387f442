"""A photon-transfer table from delimited text."""

import math
import re
from pathlib import Path

import numpy as np

from chromanoise.base import Array
from chromanoise.io.pixels.pixel_toml import errors_in_file, source_text
from chromanoise.io.source_files import has, refused
from chromanoise.io.spectra.cell_tables import number_in
from chromanoise.io.spectra.delimited import DELIMITERS, cells_of_line, decimal_sign, split_line
from chromanoise.io.spectra.parsed import Row
from chromanoise.sensor import PhotonTransfer

_NEEDED = ("mean_dn", "variance_dn2")
_SPATIAL = "spatial_variance_dn2"
_NUMBERS = (*_NEEDED, "samples", "time_ms", "dark_mean_dn", "dark_variance_dn2", "photons")
_UNITS = {"dn": "dn", "adu": "dn", "dn^2": "dn2", "dn2": "dn2", "dn²": "dn2", "adu^2": "dn2"}
_QUANTITIES = {
    "mean": "mean",
    "signal": "mean",
    "variance": "variance",
    "var": "variance",
    "temporal variance": "variance",
    "spatial variance": "spatial_variance",
    "dark mean": "dark_mean",
    "dark variance": "dark_variance",
    "time": "time",
    "exposure time": "time",
}
_WITH_UNIT = re.compile(
    rf"({'|'.join(_QUANTITIES)})[ ]*[\[(]?({'|'.join(map(re.escape, (*_UNITS, 'ms')))})[\])]?"
)
_PHOTONS = ("photons", "photons per pixel")
_LARGEST_ROWS = 100_000


def read_photon_transfer_csv(path: Path | str) -> PhotonTransfer:
    """Read photon-transfer data from a text file, one row per exposure.

    Parameters
    ----------
    path
        The file. Its first row names the columns, separated by commas, semicolons, tabs or blanks:
        ``mean_dn`` and ``variance_dn2`` (or with the unit in brackets, ``mean [DN]`` and
        ``variance [DN^2]``), or ``spatial_variance_dn2`` if the variance is over the pixels of one
        picture; optionally ``samples`` (number of pixels of each variance), ``light`` (``dark`` or
        ``light``), ``time_ms``, ``dark_mean_dn`` and ``dark_variance_dn2``, and
        ``photons_per_pixel``, where 0 marks a dark row. ``#`` starts a comment. A note names other
        columns, which are not used.

    Raises
    ------
    InputError
        If the file cannot be read, a column is missing, or a cell is not a number; the message
        names file, line and column.
    """
    path = Path(path)
    lines = [
        (i, line)
        for i, line in enumerate(source_text(path).splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines or len(lines) > _LARGEST_ROWS:
        need = f"must have a header {','.join(_NEEDED)} and at most {_LARGEST_ROWS} rows"
        raise refused(path, need, len(lines), f"has {len(lines)} lines")
    sign = _delimiter(lines[0][1])
    header = _header(lines[0], sign, path)
    rows = [Row(i, cells_of_line(line, i, sign, str(path))) for i, line in lines[1:]]
    decimal = decimal_sign(rows, sign, str(path))
    columns = _columns(rows, header, decimal, path)
    unused = [name for name in header if name not in (*_NUMBERS, _SPATIAL, "light")]
    dark = _dark(rows, header, columns.get("photons"), path)
    with errors_in_file(path):
        return PhotonTransfer(
            mean_dn=columns["mean_dn"],
            variance_dn2=columns.get(_SPATIAL, columns.get("variance_dn2", np.array([]))),
            dark=dark,
            samples=columns.get("samples"),
            source=path.name,
            spatial=_SPATIAL in header,
            **{name: columns.get(name) for name in _NUMBERS[3:]},
            notes=(f"{path.name}: columns not used: {', '.join(unused)[:200]}",) if unused else (),
        )


def is_photon_transfer_text(text: str) -> bool:
    r"""Whether the first row that is not a comment names a mean and a variance.

    Examples
    --------
    >>> is_photon_transfer_text("# a bench\nMean [DN];Variance [DN^2]")
    True
    """
    lines = (line.strip() for line in text.splitlines())
    first = next((line for line in lines if line and not line.startswith("#")), "")
    names = _names(first, _delimiter(first))
    found = {name.removeprefix("spatial_") for name in names}
    return any(name in found for name in _NEEDED) or {"mean", "variance"} <= found


def _delimiter(header: str) -> str:
    """The delimiter that splits the header into the most known columns."""
    known = {*_NUMBERS, _SPATIAL, "light", "mean", "variance"}
    return max(DELIMITERS, key=lambda sign: len(known.intersection(_names(header, sign))))


def _names(header: str, sign: str) -> list[str]:
    return [_name(cell) for cell in split_line(header, sign)]


def _name(cell: str) -> str:
    """``mean_dn`` for ``Mean [DN]``, ``variance_dn2`` for ``var (DN^2)``."""
    words = " ".join(cell.strip().lower().replace("_", " ").split())
    if words in _PHOTONS:
        return "photons"
    match = _WITH_UNIT.fullmatch(words)
    if match is None or (match[2] == "ms") != (_QUANTITIES[match[1]] == "time"):
        return cell.strip().lower()
    return f"{_QUANTITIES[match[1]]}_{_UNITS.get(match[2], match[2])}"


def _header(first: tuple[int, str], sign: str, path: Path) -> list[str]:
    where = f"line {first[0]}"
    cells_of_line(first[1], first[0], sign, str(path))
    header = _names(first[1], sign)
    bare = [name for name in ("mean", "variance") if name in header]
    if bare:
        need = "must give the unit of each column"
        found = f"names {' and '.join(bare)} without a unit"
        remedy = f"write {','.join(_NEEDED)} if they are in codes"
        raise refused(path, need, bare, found, where=where, remedy=remedy)
    variances = [name for name in (_NEEDED[1], _SPATIAL) if name in header]
    if len(variances) == 2:
        need = "must name either a temporal or a spatial variance"
        remedy = f"keep only variance_dn2 (for the gain) or only {_SPATIAL}"
        raise refused(path, need, variances, "names both", where=where, remedy=remedy)
    if "mean_dn" not in header or not variances or len(set(header)) < len(header):
        need = f"must name each column once, {' and '.join(_NEEDED)} among them"
        raise refused(path, need, first[1].strip()[:60], where=where)
    return header


def _columns(rows: list[Row], header: list[str], decimal: str, path: Path) -> dict[str, Array]:
    """The numbers of each known column."""
    wanted = [(k, name) for k, name in enumerate(header) if name in (*_NUMBERS, _SPATIAL)]
    columns: dict[str, Array] = {name: np.empty(len(rows)) for _, name in wanted}
    for i, row in enumerate(rows):
        where = f"line {row.number}"
        if len(row.cells) != len(header):
            need = f"must have the {len(header)} cells that the header names"
            remedy = "separate the cells by semicolons if the numbers have decimal commas"
            raise has(path, need, len(row.cells), where=where, remedy=remedy)
        for k, name in wanted:
            columns[name][i] = _number(row.cells[k], decimal, path, f"{where}, column {name!r}")
    return columns


def _dark(rows: list[Row], header: list[str], photons: Array | None, path: Path) -> Array:
    """A mask of the dark rows, by the column ``light`` or by 0 photons."""
    none = np.zeros(len(rows), dtype=bool) if photons is None else photons == 0
    if "light" not in header:
        return none
    at = header.index("light")
    for row, without in zip(rows, none, strict=True):
        where, cell = f"line {row.number}, column 'light'", row.cells[at].lower()
        if cell not in ("dark", "light"):
            raise refused(path, "must be dark or light", row.cells[at][:40], where=where)
        if photons is not None and (cell == "dark") != without:
            raise refused(path, "must agree with the photons of its row", cell, where=where)
    return np.array([row.cells[at].lower() == "dark" for row in rows], dtype=bool)


def _number(cell: str, decimal: str, path: Path, where: str) -> float:
    value = math.nan if "%" in cell else number_in(cell, decimal_comma=decimal == ",")
    if not math.isfinite(value):
        need = "must be a finite number"
        raise refused(path, need, cell[:40], where=where, remedy="correct the cell or omit its row")
    return value
