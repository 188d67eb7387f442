"""Read a crosstalk matrix or kernel from a table of text."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from chromanoise import _inputs
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError, Setting
from chromanoise.io.given_matrices import are_numbers
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
    table = crosstalk_table(path)
    if table.columns:
        return _matrix(path, table, names, mosaic)
    if mosaic is None:
        raise InputError(
            str(path),
            "must name the channels in its first line, or be a kernel for a mosaic",
            value=table.values.shape,
            found="has numbers only, and the sensor has no mosaic",
            remedy=Setting("mosaic"),
        )
    with _errors_of(path):
        return crosstalk_of_kernel(table.values, mosaic, names)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CrosstalkTable:
    """The numbers of a crosstalk file, before they are applied to a sensor.

    Attributes
    ----------
    columns, rows
        Names of the channels of each column and row; empty for a kernel.
    values
        Shares of the light; a matrix has as many rows as columns. [1]
    """

    columns: tuple[str, ...]
    rows: tuple[str, ...]
    values: Float[Array, "r c"]


def crosstalk_table(path: Path) -> CrosstalkTable:
    """The numbers of a crosstalk file; their range is checked with the sensor.

    Parameters
    ----------
    path
        As for `read_crosstalk`.

    Raises
    ------
    InputError
        If the file is no table of numbers, or a matrix with names is not square.
    """
    rows = _rows(path)
    if are_numbers(rows[0]):
        if len({len(row) for row in rows}) > 1:
            raise InputError(str(path), "must have rows of equal length", value=len(rows))
        return CrosstalkTable(columns=(), rows=(), values=_numbers(path, rows, first=0))
    head, body = rows[0], rows[1:]
    has_labels = bool(body) and not are_numbers(body[0][:1])
    cells = [row[1:] if has_labels else row for row in body]
    columns = head[1:] if cells and len(head) == len(cells[0]) + 1 else head
    if len(cells) != len(columns) or any(len(row) != len(columns) for row in cells):
        need = f"must have {len(columns)} rows of {len(columns)} numbers"
        raise InputError(str(path), need, value=[len(row) for row in cells])
    return CrosstalkTable(
        columns=tuple(columns),
        rows=tuple(row[0] for row in body) if has_labels else tuple(columns),
        values=_numbers(path, cells, first=1),
    )


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


def _matrix(
    path: Path, table: CrosstalkTable, names: tuple[str, ...], mosaic: Mosaic | None
) -> Crosstalk:
    for what, given in (("columns", table.columns), ("rows", table.rows)):
        if sorted(given) != sorted(names):
            need = f"must have {what} for the channels {', '.join(names)}"
            raise InputError(str(path), need, value=given, found=f"has {', '.join(given)[:80]}")
    order_rows = [table.rows.index(name) for name in names]
    order_columns = [table.columns.index(name) for name in names]
    pixels = (1,) * len(names)
    if mosaic is not None and sorted(mosaic.names) == sorted(names):
        flat = [channel for row in mosaic.pattern for channel in row]
        pixels = tuple(flat.count(name) for name in names)
    with _errors_of(path):
        return Crosstalk(matrix=table.values[np.ix_(order_rows, order_columns)], pixels=pixels)


@contextmanager
def _errors_of(path: Path) -> Iterator[None]:
    try:
        yield
    except InputError as error:
        raise error.within(str(path)) from None


def _numbers(path: Path, rows: list[list[str]], *, first: int) -> Float[Array, "r c"]:
    for line, row in enumerate(rows, start=first + 1):
        for cell in row:
            if not are_numbers([cell]):
                where = f"row {line} of the table"
                raise InputError(str(path), "must hold numbers", value=cell, where=where)
    return np.array([[float(cell) for cell in row] for row in rows])
