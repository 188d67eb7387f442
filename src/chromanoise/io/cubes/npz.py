"""Arrays in NumPy's file formats; pickled data are never loaded."""

import io
import math
import zipfile
from pathlib import Path
from typing import IO

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Shaped
from chromanoise.errors import InputError
from chromanoise.io.cubes.errors import reading
from chromanoise.io.cubes.labeled import Store, array_store
from chromanoise.io.cubes.raw_cube import Found, picture

Declared = tuple[tuple[int, ...], np.dtype]

_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # the methods that NumPy writes

_HEADER_READERS = {  # version (3, 0) is only for structured types
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def npz_arrays(path: Path) -> dict[str, Declared]:
    """Shape and type of every array in a ``.npz``, without reading the numbers.

    Raises
    ------
    InputError
        If the header of an array does not match the number of bytes after it.
    """
    arrays = {}
    with zipfile.ZipFile(path) as archive:
        for info in archive.infolist():
            if info.filename.endswith(".npy"):
                name = info.filename.removesuffix(".npy")
                if info.compress_type not in _METHODS:
                    raise InputError(
                        str(path),
                        "must be stored or deflated, as NumPy does",
                        where=f"array {name!r}",
                        value=info.compress_type,
                        found=f"has compression method {info.compress_type}",
                        remedy="save it with numpy.savez",
                    )
                with archive.open(info) as stream:
                    arrays[name] = _declared(stream, info.file_size, path, f"array {name!r}")
    return arrays


def npz_store(path: Path) -> Store:
    """The arrays of a ``.npz``, without their numbers."""
    return array_store(path, "NPZ", npz_arrays, npz_array)


def npz_array(path: Path, name: str) -> Shaped[Array, "..."]:
    """The numbers of one array of a ``.npz``."""
    with zipfile.ZipFile(path) as archive, archive.open(f"{name}.npy") as stream:
        return np.lib.format.read_array(stream, allow_pickle=False)


def npy_cube(path: Path, shape: tuple[int, int] | None) -> Found:
    """The cube in the only array of a ``.npy``."""
    with reading(path, "NumPy"):
        array = npy_array(path)
    pixels, notes = picture(path, "the array", array, shape, by_columns=False)
    return Found(pixels=pixels, notes=notes)


def npy_array(path: Path) -> Shaped[Array, "..."]:
    """The array of real numbers in a ``.npy``, as a memory map.

    Raises
    ------
    InputError
        If the array has another type, or its header does not match the number of bytes after it.
    """
    with path.open("rb") as stream:
        _, dtype = _declared(stream, path.stat().st_size, path, "")
    if dtype.kind not in "fiu":
        raise InputError(
            str(path),
            "must hold real numbers",
            value=dtype.name,
            found=f"is of type {dtype.name}",
            remedy="save it as a plain array",
        )
    return np.lib.format.open_memmap(path, mode="r")


def _declared(stream: IO[bytes] | io.BufferedIOBase, size: int, path: Path, where: str) -> Declared:
    """Shape and type from the header at the start of ``stream``; objects have no shape."""
    version = np.lib.format.read_magic(stream)
    if version not in _HEADER_READERS:
        return (), np.dtype("O")
    shape, _, dtype = _HEADER_READERS[version](stream)
    if dtype.hasobject:
        return (), np.dtype("O")
    expected = stream.tell() + math.prod(shape) * dtype.itemsize
    if size != expected:
        raise InputError(
            str(path),
            f"must hold the {expected} bytes that its header describes",
            where=where,
            value=size,
            found=f"holds {size}",
            remedy="save it again, because it is truncated or damaged",
        )
    return shape, dtype
