"""Read spectra from CSV text: ``wavelength_nm`` and one column per curve."""

import csv
import io
import math
from pathlib import Path

import numpy as np

from chromanoise.base import InputError, regular_file, system_errors_of, text_of_cell
from chromanoise.spectra.curves import Spectra

_LARGEST_BYTES = 64 * 2**20


def read_spectra_csv(path: Path | str, *, quantity: str, unit: str) -> Spectra:
    """The curves of a CSV file whose first row is ``wavelength_nm,name,name,...``.

    Parameters
    ----------
    path
        The file, UTF-8. Lines that start with ``#`` are comments.
    quantity, unit
        Quantity and unit of the columns; used in messages.

    Raises
    ------
    InputError
        If the file cannot be read or a cell is not a number; the message names file, line and
        column.
    """
    text = small_text(Path(path), _LARGEST_BYTES, what=" for a table of spectra", form="CSV UTF-8")
    return spectra_from_text(text, source=str(path), quantity=quantity, unit=unit)


def small_text(path: Path, largest_bytes: int, *, what: str = "", form: str = "UTF-8") -> str:
    """The UTF-8 text of a file; errors name the largest size, ``what`` for and the right form.

    Raises
    ------
    InputError
        If the file cannot be read, is larger, or is not UTF-8.
    """
    size = regular_file(path).st_size
    if size > largest_bytes:
        need = f"must be at most {largest_bytes // 2**20} MiB{what}"
        raise InputError(str(path), need, value=size, found=f"is {size / 2**20:.1f} MiB")
    try:
        with system_errors_of(path):
            return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        where, remedy = f"byte {error.start}", f"save it as {form}"
        raise InputError(str(path), "is not UTF-8 text", where=where, remedy=remedy) from None


def spectra_from_text(text: str, *, source: str, quantity: str, unit: str) -> Spectra:
    r"""The curves of CSV text; ``source`` is its name in messages and results.

    Examples
    --------
    >>> spectra_from_text("wavelength_nm,G\n500,.4\n510,.5", source="a line",
    ...                   quantity="QE", unit="e-/photon").values.ravel()
    array([0.4, 0.5])
    """
    lines = [(i, line) for i, line in enumerate(text.splitlines(), 1) if line.strip()]
    lines = [(i, line) for i, line in lines if not line.lstrip().startswith("#")]
    if len(lines) < 3:
        raise InputError(
            source,
            "must have a header wavelength_nm,name,... and at least 2 rows",
            value=len(lines),
            found=f"has {len(lines)} lines",
        )
    header = _cells(lines[0][1], lines[0][0], source)
    if header[0].lower() != "wavelength_nm" or len(header) < 2:
        raise InputError(
            source,
            "must be the header wavelength_nm,name,...",
            value=header[0],
            found=f"starts with {header[0][:60]!r}",
            where=f"line {lines[0][0]}",
            remedy="separate cells with commas",
        )
    rows = [_numbers(line, i, header, source) for i, line in lines[1:]]
    _refuse_unsorted([row[0] for row in rows], [i for i, _ in lines[1:]], source)
    table = np.array(rows, dtype=np.float64)
    return Spectra(
        wavelength_nm=table[:, 0],
        values=table[:, 1:],
        names=tuple(map(text_of_cell, header[1:])),
        quantity=quantity,
        unit=unit,
        source=source,
    )


def _cells(line: str, number: int, source: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader(io.StringIO(line), strict=True))]
    except csv.Error as error:
        raise InputError(
            source, f"is not a row of a CSV ({error})", where=f"line {number}"
        ) from None


def _numbers(line: str, number: int, header: list[str], source: str) -> list[float]:
    cells = _cells(line, number, source)
    if len(cells) != len(header):
        raise InputError(
            source,
            f"must have {len(header)} cells, as the header",
            value=len(cells),
            found=f"has {len(cells)}",
            where=f"line {number}",
            remedy="give each row one cell per column, with a decimal point",
        )
    values = []
    for name, cell in zip(header, cells, strict=True):
        try:
            value = math.nan if "_" in cell else float(cell)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(
                source,
                "must be a finite number",
                value=cell,
                where=f"line {number}, column {name!r}",
                remedy="correct it, or remove the row",
            )
        values.append(value)
    return values


def _refuse_unsorted(wavelengths: list[float], numbers: list[int], source: str) -> None:
    for i in range(1, len(wavelengths)):
        if wavelengths[i] <= wavelengths[i - 1]:
            raise InputError(
                source,
                "wavelength_nm must increase",
                value=wavelengths[i],
                found=f"{wavelengths[i]:g} nm follows {wavelengths[i - 1]:g} nm",
                where=f"line {numbers[i]}",
                remedy="sort the rows and remove repeated ones",
            )
