"""Turn exceptions of third-party readers into errors of this library."""

import importlib.util
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from chromanoise._check import reason
from chromanoise.errors import InputError

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


def library(name: str, what: str, *, extra: str = "cubes", where: str = "") -> Any:
    """Import an optional package that only some cubes need.

    Parameters
    ----------
    name
        Name of the package.
    what, where
        The file that needs the package, and the place in it.
    extra
        The extra of chromanoise that installs it.

    Raises
    ------
    InputError
        If the package is not installed.
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        raise _absent(name, what, extra, where) from None


def refuse_absent_library(name: str, what: str, *, extra: str = "cubes", where: str = "") -> None:
    """Like `library`, for a package that only the child process imports."""
    if importlib.util.find_spec(name) is None:
        raise _absent(name, what, extra, where)


def _absent(name: str, what: str, extra: str, where: str) -> InputError:
    return InputError(
        what,
        f"needs the package {name}, which is not installed",
        where=where,
        remedy=f"install it with pip install 'chromanoise[{extra}]'",
    )


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
        raise InputError(
            str(path),
            "must fit into the memory of this machine",
            found="is too large",
            remedy=IN_PLACE,
        ) from None
    except Exception as error:  # parsers raise arbitrary exceptions
        raise _unreadable(path, kind, error) from None


def _unreadable(path: Path, kind: str, error: Exception) -> InputError:
    other = _content_of(path)
    if other and other not in _OWN.get(kind, ()):
        return InputError(
            str(path),
            f"must be in {kind} format",
            value=other,
            found=f"is {other}",
            remedy=("correct the ending of its name", "name another file"),
        )
    cause = reason(error)
    return InputError(
        str(path),
        f"is not a readable {kind} file{f' ({cause})' if cause else ''}",
        remedy="save it again, because it is damaged or truncated",
    )


def _content_of(path: Path) -> str:
    """The format that the first bytes of a file identify; empty if they identify none."""
    start = b""
    with suppress(OSError), path.open("rb") as file:
        start = file.read(16)
    return next((kind for sign, kind in _SIGNATURES.items() if start.startswith(sign)), "")
