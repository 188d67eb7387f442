"""Wavelengths of the bands of a cube from a separate text file."""

import math
import re
from pathlib import Path

import numpy as np

from chromanoise._check import Array, reason
from chromanoise._inputs import regular_file
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.io.spectra.declared import declared_keys, is_wavelength_heading, wavelength_unit_of
from chromanoise.io.spectra.parsed import Unit
from chromanoise.io.spectra.wavelength_lists import NM_PER

_LARGEST_BYTES = 2**20
_LIST = "name a text file that lists one wavelength per band"
_CELL = re.compile(r"[,;\t]|\s{2,}")
_BETWEEN = re.compile(r"\s*[,;]\s*|\s+")


def read_wavelengths(path: Path, bands: int) -> Float[Array, " bands"]:
    r"""The wavelengths in a text file. [nm]

    One per line, or in the first column of a table, or a list over any number of lines, separated
    by comma, semicolon, blank or tab. A heading and lines that begin with ``#`` may come first; the
    numbers are nm unless these name um or Angstrom.

    Parameters
    ----------
    path
        The file.
    bands
        The number of bands of the cube, which is also the number of wavelengths.

    Raises
    ------
    InputError
        If the file cannot be read, an entry is not a number, or the number of entries is not
        ``bands``.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     file = Path(folder) / "bands.csv"
    ...     _ = file.write_text("center (um),width (um)\n0.45,0.01\n0.7,0.02\n")
    ...     read_wavelengths(file, 2)
    array([450., 700.])
    """
    heading, rows = _parts(path, _text(path))
    nm_per = _unit(path, heading)
    columns = [row[:1] for row in rows]
    counts = [sum(len(row) for row in part) for part in (columns, rows)]
    if bands not in counts:
        texts = " or ".join(str(count) for count in dict.fromkeys(counts))
        raise InputError(
            str(path),
            f"must list one wavelength for each of the {bands} bands of the cube",
            value=tuple(dict.fromkeys(counts)),
            found=f"lists {texts}",
        )
    cells = [cell for row in (columns if counts[0] == bands else rows) for cell in row]
    values = [_number(cell) for cell in cells]
    if not all(math.isfinite(value) for value in values):
        wrong = next(i for i, value in enumerate(values) if not math.isfinite(value))
        raise InputError(
            str(path), "must be a number", where=f"entry {wrong + 1}", value=cells[wrong][:40]
        )
    return np.array(values) * nm_per


def _text(path: Path) -> str:
    size = regular_file(path).st_size
    if size > _LARGEST_BYTES:
        raise InputError(
            str(path),
            f"must have at most {_LARGEST_BYTES // 2**20} MiB",
            value=size,
            found=f"has {size} bytes",
            remedy=_LIST,
        )
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(
            str(path),
            "must be a UTF-8 text file",
            value=error.start,
            found=f"byte {error.start} is not text",
            remedy=_LIST,
        ) from None
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({reason(error)})") from None


def _parts(path: Path, text: str) -> tuple[str, list[list[str]]]:
    """The lines before the first number, and the cells of each line from there on."""
    heading: list[str] = []
    rows: list[list[str]] = []
    for line in text.splitlines():
        cells = [cell for cell in _BETWEEN.split(line.strip()) if cell]
        if line.lstrip().startswith("#") or (not rows and cells and math.isnan(_number(cells[0]))):
            heading.append(line)
        elif cells:
            rows.append(cells)
    if not rows:
        raise InputError(str(path), "must list one wavelength per band", found="lists none")
    return "\n".join(heading), rows


def _unit(path: Path, heading: str) -> float:
    """Nanometers per unit that a heading above the numbers, or a declared key, names."""
    lines = [line.lstrip("# ").strip() for line in heading.splitlines()]
    first = [_CELL.split(line, maxsplit=1)[0] for line in lines]
    key = declared_keys(lines).get("wavelength_unit")
    texts = [*([f"[{key}]"] if key else []), *filter(is_wavelength_heading, first)]
    units = {_unit_of(path, text) for text in texts} - {None}
    if len(units) > 1:
        names = tuple(sorted(str(unit) for unit in units))
        raise InputError(
            str(path),
            "headings must name one unit",
            value=names,
            found=f"name {' and '.join(names)}",
        )
    return NM_PER[next(iter(units)) or "nm"] if units else 1.0


def _unit_of(path: Path, text: str) -> Unit | None:
    try:
        unit = wavelength_unit_of(text)
    except InputError as error:
        raise InputError(
            str(path),
            error.requirement,
            value=error.value,
            found=error.found,
            where=", ".join(part for part in (error.subject, error.where) if part),
            remedy=error.remedy,
        ) from None
    if unit == "1/cm":
        raise InputError(
            str(path),
            "must list wavelengths",
            value=unit,
            found="lists wavenumbers",
            remedy="write wavelengths in nm",
        )
    return unit


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan
