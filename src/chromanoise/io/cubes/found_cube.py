"""The content of a file of pixels before it becomes a cube, and checks of its arrays.

Arrays that are not numeric, or that are implausibly large, are rejected before memory is allocated.
Exceptions of third-party readers become errors of this library.
"""

import math
import os
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

from chromanoise.base import Array, InputError, Setting, Shaped, dataclass, reason
from chromanoise.io.source_files import by, has, refuse_not_numbers, refused
from chromanoise.spectra import FileRows, RowSource

IN_PLACE = "store it as ENVI or .npy, which are read in place"
_SIGNATURES = {
    b"PK\x03\x04": "a zip archive",
    b"\x93NUMPY": "a NumPy array (.npy)",
    b"\x89HDF\r\n\x1a\n": "an HDF5 file",
    b"CDF": "a NetCDF-3 file",
    b"MATLAB 5.0": "a MATLAB 5 file",
    b"MATLAB 7.3": "a MATLAB 7.3 file",
    b"II*\0": "a TIFF file",
    b"MM\0*": "a TIFF file",
    b"II+\0": "a BigTIFF file",
    b"MM\0+": "a BigTIFF file",
    b"\x89PNG\r\n": "a PNG picture",
    b"\xff\xd8\xff": "a JPEG picture",
    b"GIF8": "a GIF picture",
    b"%PDF": "a PDF document",
    b"\x1f\x8b": "a gzip file",
    b"BZh": "a bzip2 file",
    b"\xfd7zXZ": "an xz file",
    b"(\xb5/\xfd": "a Zstandard file",
    b"7z\xbc\xaf": "a 7-Zip archive",
    b"ENVI": "an ENVI header",
    **{bytes((0x80, version)): "a Python pickle, which is never loaded" for version in range(2, 6)},
}
_OWN = {
    "NPZ": ("a zip archive",),
    "NumPy": ("a NumPy array (.npy)",),
    "MATLAB": ("a MATLAB 5 file",),
    "MATLAB 7.3": ("an HDF5 file", "a MATLAB 7.3 file"),
    "HDF5": ("an HDF5 file",),
    "TIFF": ("a TIFF file", "a BigTIFF file"),
    "PNG": ("a PNG picture",),
}


@contextmanager
def reading(path: Path, kind: str) -> Iterator[None]:
    """Turn any exception of a third-party reader into an `InputError`, and ignore warnings."""
    with warnings.catch_warnings(), reading_rows(path, kind):
        warnings.simplefilter("ignore")
        yield


@contextmanager
def reading_rows(path: Path, kind: str) -> Iterator[None]:
    """Like `reading`, for several threads: warning filters, which they share, are not changed."""
    try:
        yield
    except InputError:
        raise
    except MemoryError:
        raise refused(
            path, "must fit into the memory of this machine", found="is too large", remedy=IN_PLACE
        ) from None
    except Exception as error:  # parsers raise arbitrary exceptions
        raise _unreadable(path, kind, error) from None


def _unreadable(path: Path, kind: str, error: Exception) -> InputError:
    other = _content_of(path)
    if other and other not in _OWN.get(kind, ()):
        remedy = ("correct the ending of its name", "name another file")
        return has(path, f"must be in {kind} format", other, "is", remedy=remedy)
    cause = reason(error)
    need = f"is not a readable {kind} file{f' ({cause})' if cause else ''}"
    return refused(path, need, remedy="save it again, because it is damaged or truncated")


def _content_of(path: Path) -> str:
    """The format that the first bytes of a file identify; empty if they identify none."""
    start = b""
    with suppress(OSError), path.open("rb") as file:
        start = file.read(16)
    return next((kind for sign, kind in _SIGNATURES.items() if start.startswith(sign)), "")


Notes = tuple[str, ...]
Wavelengths = Callable[[], tuple[Array, Notes]]
"""Reads the centers of the bands, with notes. [nm]"""


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """The content of a file; wavelengths and scale are read only if the caller gives none."""

    pixels: Shaped[Array, "h w m"] | RowSource
    wavelengths: Wavelengths | None = None
    scale: Callable[[], float | None] = lambda: None
    description: str = ""
    units: str = ""
    notes: Notes = ()


def refuse_other_shape(
    path: Path, pixels: Shaped[Array, "h w m"] | RowSource, shape: tuple[int, int] | None
) -> None:
    """Raise an error if ``shape`` contradicts the picture in the file."""
    if shape is not None and tuple(shape) != pixels.shape[:2]:
        need = f"must be that of {path}, {by(pixels.shape[:2])} pixels"
        raise refused("shape", need, tuple(shape), f"is {by(shape)}", remedy="omit it")


def packed_rows(
    path: Path, offset: int, stored: np.dtype, sizes: Sequence[int], axes: Sequence[int]
) -> FileRows:
    """Rows of an array that is stored in the order of C without gaps.

    ``axes`` are those of rows, columns and bands.
    """
    steps = [math.prod(sizes[axis + 1 :]) * stored.itemsize for axis in range(3)]
    row, column, band = axes
    return FileRows(
        path=path,
        offset=offset,
        stored=stored,
        shape=(sizes[row], sizes[column], sizes[band]),
        strides=(steps[row], steps[column], steps[band]),
    )


def picture(
    path: Path, what: str, array: Array, shape: tuple[int, int] | None, *, by_columns: bool
) -> tuple[Shaped[Array, "rows columns bands"], Notes]:
    """A view with axes (rows, columns, bands), and a note on the order of the pixels."""
    if array.ndim == 3 and array.size:
        refuse_other_shape(path, array, shape)
        return array, ()
    if array.ndim != 2 or not array.size:
        raise has(
            path,
            "must have axes (rows, columns, bands), or pixels in one axis and bands in the other, "
            "and must not be empty",
            array.shape,
            "is",
            where=what,
        )
    rows, columns = _rows_and_columns(path, what, array, shape)
    spectra = array if array.shape[0] == rows * columns else array.T
    if by_columns:
        pixels = spectra.reshape(columns, rows, -1).transpose(1, 0, 2)
        return pixels, ("pixels taken column by column, as MATLAB does",)
    return spectra.reshape(rows, columns, -1), ("pixels taken row by row, as NumPy does",)


def _rows_and_columns(
    path: Path, what: str, array: Array, shape: tuple[int, int] | None
) -> tuple[int, int]:
    if shape is None:
        need = "must have rows and columns in two axes, or a given shape (rows, columns) [pixels]"
        raise has(path, need, array.shape, "is", where=what, remedy=Setting("shape"))
    fits = [min(shape) > 0 and n == math.prod(shape) for n in array.shape]
    if not any(fits):
        need = f"must have as many pixels as an axis of {what} in {path} ({by(array.shape)})"
        raise refused("shape", need, tuple(shape), f"{by(shape)} is {math.prod(shape)} pixels")
    if all(fits):
        need = f"must have only one axis of {math.prod(shape)} pixels ({by(shape)})"
        found = f"is {by(array.shape)}, so pixels and bands cannot be distinguished"
        remedy = "save it with axes (rows, columns, bands)"
        raise refused(path, need, array.shape, found, where=what, remedy=remedy)
    return shape


MOST_INFLATED = 1032
"""Largest compression ratio of deflate; files that declare a larger one are refused."""

_MEMORY_BYTES = 8 * 2**30  # where the system does not report it
_GROUP_LIMITS = ("/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes")


def refuse_impossible(
    path: Path,
    name: str,
    shape: tuple[int, ...],
    dtype: np.dtype,
    *,
    size: int | None = None,
    stored_item_bytes: int | None = None,
) -> None:
    """Raise an error for an array that is not numeric or exceeds its file or the memory.

    Parameters
    ----------
    path, name
        The file, and the array in it that will be loaded into memory.
    shape, dtype
        Shape and type as the file declares them.
    size
        Size of all stored data, if it differs from the size of ``path``. [bytes]
    stored_item_bytes
        Size of one number before compression, where the file may store it in fewer bytes than
        ``dtype`` has. [bytes]
    """
    refuse_empty(path, name, shape, dtype)
    count = math.prod(shape)
    size = path.stat().st_size if size is None else size
    if count * (stored_item_bytes or dtype.itemsize) > size * MOST_INFLATED:
        need = f"must fit into the {size} bytes of the file"
        found = f"is declared as {by(shape)}"
        remedy = "save it again, because the file is damaged"
        raise refused(path, need, shape, found, where=f"array {name!r}", remedy=remedy)
    size = count * dtype.itemsize
    if size > memory_bytes():
        need = f"must fit into the available memory of {_bytes(memory_bytes())}"
        found = f"needs {_bytes(size)}"
        raise refused(path, need, size, found, where=f"array {name!r}", remedy=IN_PLACE)


def refuse_empty(path: Path, name: str, shape: tuple[int, ...], dtype: np.dtype) -> None:
    """Raise an error for an array without numbers, or of anything but real numbers."""
    refuse_not_numbers(path, name, dtype)
    if min(shape, default=1) < 1:
        raise has(
            path, "must not be empty", shape, "is", where=f"array {name!r}", remedy="save it again"
        )


def refuse_other_size(
    path: Path, where: str, read: tuple[int, ...], declared: tuple[int, ...]
) -> None:
    """Raise an error for numbers of another shape than declared."""
    if read != declared:
        need = f"must be {by(declared)}, as it declares"
        remedy = "save it again, because it is damaged"
        raise has(path, need, read, "is", where=where, remedy=remedy)


def _bytes(count: int) -> str:
    for power, unit in ((3, "GiB"), (2, "MiB"), (1, "KiB")):
        if count >= 1024**power:
            return f"{count / 1024**power:.1f} {unit}"
    return f"{count} bytes"


def memory_bytes() -> int:
    """Memory available to this process: free memory, within the limit of its cgroup. [bytes]"""
    limits = [_installed_bytes()]
    with suppress(OSError):
        available = re.search(r"MemAvailable:\s*(\d+) kB", Path("/proc/meminfo").read_text())
        limits += [int(available[1]) * 1024] if available else []
    for file in _GROUP_LIMITS:
        with suppress(OSError, ValueError):  # "max": no limit
            limits.append(int(Path(file).read_text()))
    return min(limits)


def _installed_bytes() -> int:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return _MEMORY_BYTES
