"""Read a crosstalk matrix or kernel from a table of text."""

from pathlib import Path

import numpy as np

from chromanoise import _inputs
from chromanoise.errors import InputError, Setting
from chromanoise.sensor import Crosstalk, Mosaic, crosstalk_of_kernel

_MOST_BYTES = 100_000


def read_crosstalk(path: Path, names: tuple[str, ...], mosaic: Mosaic | None) -> Crosstalk:
    """The crosstalk in a file: a matrix with a heading of channel names, or a kernel of neighbors.

    Parameters
    ----------
    path
        Comma, semicolon, tab or space between numbers; lines that start with ``#`` are comments.
        A matrix names the channels in its first line, each row optionally in its first column:
        row i holds the shares of each channel that channel i receives. Numbers without names are
        a kernel: the shares of the light of one pixel that end around it.
    names
        The channels of the sensor.
    mosaic
        Its mosaic: needed for a kernel, and counts the pixels of each channel for a matrix.

    Raises
    ------
    InputError
        If the file is no such table, its channels differ from the sensor's, a kernel is given
        without mosaic, or a channel gives more light than it has.
    """
    rows = _rows(path)
    try:
        if not _are_numbers(rows[0]):
            return _matrix(path, rows, names, mosaic)
        kernel = np.array([[_number(path, i, cell) for cell in row] for i, row in enumerate(rows)])
        if mosaic is None:
            raise InputError(
                str(path),
                "must name the channels in its first line, or be a kernel for a mosaic",
                value=rows[0],
                found="has numbers only, and the sensor has no mosaic",
                remedy=Setting("mosaic"),
            )
        return crosstalk_of_kernel(kernel, mosaic, names)
    except ValueError as error:
        if isinstance(error, InputError):
            raise
        raise InputError(str(path), "must have rows of equal length", value=len(rows)) from None


def _rows(path: Path) -> list[list[str]]:
    _inputs.regular_file(path)
    try:
        with path.open("rb") as file:
            text = file.read(_MOST_BYTES + 1).decode("utf-8-sig")
    except OSError as error:
        raise InputError(str(path), f"cannot be read ({error.strerror})") from None
    except UnicodeDecodeError:
        raise InputError(str(path), "must be a UTF-8 text file") from None
    if len(text) > _MOST_BYTES:
        raise InputError(str(path), f"must have at most {_MOST_BYTES} bytes", found="has more")
    lines = [line.strip() for line in text.splitlines()]
    used = [line for line in lines if line and not line.startswith("#")]
    if not used:
        raise InputError(str(path), "must hold a table of numbers", found="is empty")
    mark = next((mark for mark in (",", ";", "\t") if mark in used[0]), None)
    return [[cell.strip() for cell in line.split(mark)] for line in used]


def _are_numbers(cells: list[str]) -> bool:
    try:
        [float(cell) for cell in cells]
    except ValueError:
        return False
    return True


def _matrix(
    path: Path, rows: list[list[str]], names: tuple[str, ...], mosaic: Mosaic | None
) -> Crosstalk:
    head, body = rows[0], rows[1:]
    labeled = len(head) == len(names) + 1 and head[0] not in names
    columns = head[1:] if labeled else head
    has_labels = bool(body) and not _are_numbers(body[0][:1])
    lines = [row[0] for row in body] if has_labels else list(columns)
    cells = [row[1:] if has_labels else row for row in body]
    for what, given in (("columns", columns), ("rows", lines)):
        if sorted(given) != sorted(names):
            raise InputError(
                str(path),
                f"must have {what} for the channels {', '.join(names)}",
                value=given,
                found=f"has {', '.join(given)[:80]}",
            )
    if len(cells) != len(names) or any(len(row) != len(names) for row in cells):
        raise InputError(
            str(path),
            f"must have {len(names)} rows of {len(names)} numbers",
            value=[len(row) for row in cells],
        )
    numbers = np.array([[_number(path, i, c) for c in row] for i, row in enumerate(cells, start=1)])
    order_rows = [lines.index(name) for name in names]
    order_columns = [list(columns).index(name) for name in names]
    pixels = (1,) * len(names)
    if mosaic is not None and sorted(mosaic.names) == sorted(names):
        flat = [channel for row in mosaic.pattern for channel in row]
        pixels = tuple(flat.count(name) for name in names)
    return Crosstalk(matrix=numbers[np.ix_(order_rows, order_columns)], pixels=pixels)


def _number(path: Path, line: int, cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        raise InputError(
            str(path), "must hold numbers", value=cell, where=f"row {line + 1} of the table"
        ) from None
