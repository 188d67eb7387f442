"""Image files written a few rows at a time; space is allocated before the first row."""

import errno
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock
from typing import Any, BinaryIO

import numpy as np

from chromanoise._check import Array
from chromanoise.errors import InputError

PutRows = Callable[[int, Array], None]
"""Function (index of the first row, rows): called from any thread, in any order, once per row."""


@contextmanager
def tiff_rows(
    path: Path,
    *,
    shape: tuple[int, ...],
    dtype: str,
    photometric: int | str,
    description: str,
    extratags: tuple[tuple[Any, ...], ...] = (),
) -> Iterator[PutRows]:
    """Write a little-endian uncompressed TIFF of one strip with the yielded function.

    Only the current rows are in memory. Space is allocated before the first row, so that a full
    disk raises an error before a long computation. After an error the incomplete file stays: write
    to the scratch folder of `chromanoise._files.whole_folder`, which is removed.

    Parameters
    ----------
    path
        An existing file is replaced.
    shape
        (rows, columns) or (rows, columns, samples).
    dtype
        Type of numpy; rows of another type are refused, not converted.
    photometric, description, extratags
        As `tifffile.imwrite` takes them; a description may contain any character (UTF-8).

    Raises
    ------
    InputError
        If the picture is empty, the file cannot be written, rows have a wrong shape, or one is
        missing at the end.
    """
    if not all(size >= 1 for size in shape):
        raise InputError(
            str(path), "must have at least one pixel", value=shape, found=f"has shape {shape}"
        )
    missing = np.ones(shape[0], dtype=bool)
    lock = Lock()
    with _writing(path):
        file, offset = _empty_tiff(
            path,
            shape=shape,
            dtype=dtype,
            photometric=photometric,
            description=description.encode(),
            extratags=extratags,
            planarconfig="contig" if len(shape) == 3 else None,
        )
    row_bytes = int(np.prod(shape[1:])) * np.dtype(dtype).itemsize

    def put(start: int, rows: Array) -> None:
        _refuse_unfit(path, start, rows, shape, dtype)
        little = np.ascontiguousarray(rows, dtype=np.dtype(dtype).newbyteorder("<"))
        with lock, _writing(path):
            file.seek(offset + start * row_bytes)
            file.write(little.data)
            missing[start : start + rows.shape[0]] = False

    try:
        yield put
        if missing.any():
            raise InputError(
                str(path),
                f"must be given all {shape[0]} rows",
                where=f"row {int(missing.argmax())} (from 0)",
                value=int(missing.sum()),
                found=f"this and others, {int(missing.sum())} in all, were never written",
            )
    except BaseException:
        _closed_quietly(file)  # so that the first error is reported
        raise
    with _writing(path):
        file.close()


def _empty_tiff(path: Path, **how: Any) -> tuple[BinaryIO, int]:
    """The file with its tags and allocated space, and the position of the pixels."""
    import tifffile

    place = tifffile.imwrite(
        path, byteorder="<", metadata=None, software="chromanoise", returnoffset=True, **how
    )
    assert place is not None  # one uncompressed strip
    offset, size = place
    file = path.open("r+b")
    try:
        _claim(file, offset + size)
    except BaseException:
        file.close()
        raise
    return file, offset


def _claim(file: BinaryIO, size: int) -> None:
    """Allocate the space if the system supports it; otherwise a full disk is detected later."""
    if not hasattr(os, "posix_fallocate"):
        return
    try:
        os.posix_fallocate(file.fileno(), 0, size)
    except OSError as error:
        if error.errno not in (errno.EOPNOTSUPP, errno.EINVAL, errno.ENOSYS):
            raise


def _closed_quietly(file: BinaryIO) -> None:
    try:
        file.close()
    except OSError:
        return


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    """Context that turns an OSError into an InputError."""
    try:
        yield
    except OSError as error:
        raise InputError(str(path), f"cannot be written ({error.strerror})") from None


def _refuse_unfit(path: Path, start: int, rows: Array, shape: tuple[int, ...], dtype: str) -> None:
    if rows.dtype.newbyteorder("=") != np.dtype(dtype):
        raise InputError(
            str(path),
            f"rows must be {dtype}",
            value=str(rows.dtype),
            found=f"are {rows.dtype}",
            remedy="convert them first",
        )
    if rows.shape[1:] != shape[1:]:
        raise InputError(
            str(path),
            f"rows must have shape {shape[1:]}",
            where=f"rows from {start}",
            value=rows.shape[1:],
            found=f"have {rows.shape[1:]}",
        )
    if not 0 <= start <= start + rows.shape[0] <= shape[0]:
        raise InputError(
            str(path),
            f"rows must lie within 0 .. {shape[0] - 1}",
            value=(start, start + rows.shape[0] - 1),
            found=f"{start} to {start + rows.shape[0] - 1} were given",
        )
