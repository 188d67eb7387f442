"""Large images as files: TIFF written a few rows at a time, and linear light as OpenEXR.

The space of a TIFF file is allocated before its first row. OpenEXR is float32 or half, without
clipping. Its files are written by the library `OpenEXR` of the Academy Software Foundation (extra
``exr``), which needs the whole image in memory.
"""

import errno
import os
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path
from threading import Lock
from typing import Any, BinaryIO

import numpy as np

from chromanoise.base import Array, Float, InputError, Setting, check, optional_package
from chromanoise.color import linear_srgb
from chromanoise.imaging.blocks import parts_of_rows

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
    to the scratch folder of `chromanoise.base.files.whole_folder`, which is removed.

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
        with suppress(OSError):  # so that the first error is reported
            file.close()
        raise
    with _writing(path):
        file.close()


def write_in_parts(
    rows_of_file: AbstractContextManager[PutRows],
    rows: Array,
    *,
    encoded: Callable[[Array], Array] = lambda part: part,
) -> None:
    """Write a picture in parts of its rows, so that little of it is copied.

    Parameters
    ----------
    rows_of_file
        Result of `tiff_rows`.
    rows
        The picture.
    encoded
        Function from a part to what is written of it.
    """
    with rows_of_file as put:
        for start, part in parts_of_rows(rows):
            put(start, encoded(part))


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


REC709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
"""x, y of red, green, blue and white of sRGB (ITU-R BT.709-6, table 1)."""
CIE_XYZ = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3)
"""The axes X, Y, Z as primaries: channels R, G, B of such a file are X, Y, Z."""

_LARGEST_HALF = 65504.0  # IEEE 754 binary16


def write_linear_exr(
    path: Path, xyz: Float[Array, "h w 3"], white: Float[Array, " 3"], *, half: bool = False
) -> None:
    """Linear sRGB (Rec. 709 primaries), white-balanced, white 1; negative noise is kept.

    Parameters
    ----------
    path
        An existing file is replaced.
    xyz
        Linear, Y = 1 for the white.
    white
        XYZ of a perfect white under the illuminant of the image.
    half
        Use 16-bit floats: half the size, and a relative error of up to 2^-11.

    Raises
    ------
    InputError
        If OpenEXR is not installed, a value is not finite or too large for half, the white is
        not valid for chromatic adaptation, or the file cannot be written.
    """
    color = linear_srgb(xyz.astype(np.float64), white)
    _write_rgb(path, color, half, {"chromaticities": REC709})


def write_xyz_exr(
    path: Path, xyz: Float[Array, "h w 3"], white: Float[Array, " 3"], *, half: bool = False
) -> None:
    """XYZ unchanged, in the channels R, G, B of a file whose primaries are X, Y and Z.

    The chromaticity of ``white`` is stored as ``adoptedNeutral``, so readers can white-balance.

    Parameters
    ----------
    path, xyz, white, half
        As `write_linear_exr`; no chromatic adaptation is applied.

    Raises
    ------
    InputError
        As `write_linear_exr`.
    """
    sees = check.finite("white XYZ", "that of the picture", white)
    if not sees.sum() > 0:
        raise InputError(str(path), "white must have X + Y + Z > 0", value=sees.tolist())
    neutral = tuple(float(v) for v in sees[:2] / sees.sum())
    _write_rgb(path, xyz, half, {"chromaticities": CIE_XYZ, "adoptedNeutral": neutral})


def _write_rgb(
    path: Path, color: Float[Array, "h w 3"], half: bool, attributes: dict[str, Any]
) -> None:
    library = openexr()
    check.shape(str(path), color, color.size > 0, "must have at least one pixel")
    if not np.isfinite(color).all():
        check.finite(f"color of {path}", "1", color)
    if half and (largest := float(np.abs(color).max())) > _LARGEST_HALF:
        raise InputError(
            str(path),
            f"must have values up to {_LARGEST_HALF:g} in half floats",
            value=largest,
            found=f"has values up to {largest:g}",
            remedy=Setting("half", (False,)),
        )
    kept = np.ascontiguousarray(color, dtype=np.float16 if half else np.float32)
    header = {
        "compression": library.ZIP_COMPRESSION,
        "type": library.scanlineimage,
        "software": "chromanoise",
        **attributes,
    }
    try:
        with library.File(header, {"RGB": kept}) as file:
            file.write(str(path))
    except (RuntimeError, OSError) as error:
        raise InputError(str(path), f"cannot be written ({error})") from None


def openexr() -> Any:
    """The imported package OpenEXR.

    Raises
    ------
    InputError
        If it is not installed.
    """
    return optional_package("OpenEXR", "EXR", extra="exr", otherwise=("write TIFF",))
