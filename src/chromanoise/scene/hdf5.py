"""HDF5 files: NetCDF-4, MATLAB 7.3, CEA-LETI's ReDFISh, and what other programs write.

Nothing outside the file is ever read: links to other files are not followed, and arrays whose
numbers lie in other files are refused. What a file holds is found out by a process of its own, for
libhdf5 crashes or loops on some damaged files.
"""

import math
from functools import partial
from pathlib import Path

import numpy as np
from jaxtyping import Int64, Shaped

from chromanoise import _check, _sandbox
from chromanoise._check import Array
from chromanoise.scene.faults import reading, refuse_absent_library
from chromanoise.scene.file_rows import FileRows
from chromanoise.scene.hdf5_child import (
    Place,
    opened,
    stored_arrays,
    stored_numbers,
    stored_place,
)
from chromanoise.scene.hdf5_chunks import ChunkRows
from chromanoise.scene.labeled import Axes, Labeled, Store
from chromanoise.scene.rows import RowSource
from chromanoise.scene.stored_rows import StoredRows
from chromanoise.spectra.files.wavelength_lists import SPECTRAL_NAMES

ENDINGS = (".h5", ".hdf5", ".hdf", ".he5", ".nc", ".nc4", ".cdf")
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_STARTS = (0, 512, 1024, 2048)  # where the signature may stand: after a block of the user's
_MATLAB_NUMBERS = frozenset({
    "double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64",
    "uint64",
})  # fmt: skip
_READ = frozenset({
    "units", "long_name", "standard_name", "description", "scale_factor", "add_offset",
    "_fillvalue", "missing_value", "valid_range", "valid_min", "valid_max", "wavelength_units",
    "matlab_class", "matlab_sparse", "matlab_empty",
}) | SPECTRAL_NAMES  # fmt: skip
_MOST_ARRAYS = 10_000
_LISTING_S = 60.0  # for so many arrays
_SLOWEST_BYTES_PER_S = 1e7  # of reading and unpacking


def is_hdf5(path: Path) -> bool:
    """Whether the file bears the signature of HDF5, or calls itself MATLAB 7.3."""
    with path.open("rb") as file:
        start = file.read(_STARTS[-1] + len(_SIGNATURE))
    told = {b"IM": b"\x00\x02", b"MI": b"\x02\x00"}.get(start[126:128])
    return told == start[124:126] or any(start.startswith(_SIGNATURE, at) for at in _STARTS)


def hdf5_store(path: Path, *, matlab: bool = False) -> Store:
    """The arrays of an HDF5 file, numbers unread.

    Raises
    ------
    InputError
        If h5py is not installed, or the file is damaged.
    """
    kind = "MATLAB 7.3" if matlab else "HDF5"
    refuse_absent_library("h5py", f"{path}: {kind} files")
    with reading(path, kind):
        listed, attributes = _sandbox.sandboxed(
            stored_arrays, path, _READ, _MOST_ARRAYS, path=path, limit_s=_LISTING_S
        )
    if len(listed) > _MOST_ARRAYS:
        raise _check.InputError(f"{path}: holds more than {_MOST_ARRAYS} arrays")
    arrays = {
        name: _by_matlab(array) if matlab else array
        for name, array in listed.items()
        if not name.startswith("#")  # what MATLAB keeps for itself
    }
    return Store(
        path=path,
        kind=kind,
        bytes=path.stat().st_size,
        arrays=arrays,
        numbers=partial(_numbers, path, kind, arrays),
        source=partial(_source, path, kind, matlab),
        attributes=attributes,
        matlab=matlab,
    )


def _by_matlab(stored: Labeled) -> Labeled:
    word = str(stored.attributes.get("matlab_class", "double"))
    dtype = stored.dtype
    if word not in _MATLAB_NUMBERS or "matlab_sparse" in stored.attributes:
        dtype = np.dtype("?") if word == "logical" else np.dtype("O")
    shape = (0,) if "matlab_empty" in stored.attributes else stored.shape[::-1]
    return Labeled(shape=shape, dtype=dtype, attributes=stored.attributes)


def _numbers(path: Path, kind: str, arrays: dict[str, Labeled], name: str) -> Shaped[Array, "..."]:
    shape = arrays[name].shape
    size = math.prod(shape) * arrays[name].dtype.itemsize
    with reading(path, kind):
        numbers = _sandbox.sandboxed(
            stored_numbers,
            path,
            name,
            path=path,
            limit_s=_sandbox.LIMIT_S + size / _SLOWEST_BYTES_PER_S,
            memory_bytes=_sandbox.MEMORY_BYTES + 2 * size,
        )
    return numbers.T if kind != "HDF5" else numbers


def _source(path: Path, kind: str, matlab: bool, name: str, axes: Axes) -> RowSource:
    """What lies plainly in the file, or went through zlib, is read without libhdf5."""
    with reading(path, kind):
        place: Place = _sandbox.sandboxed(stored_place, path, name, path=path)
    sizes, size = place.shape, place.dtype.itemsize
    row, column, band = (2 - axis for axis in axes) if matlab else axes
    shape = sizes[row], sizes[column], sizes[band]
    offset = place.offset
    if offset is not None and offset + math.prod(sizes) * size <= path.stat().st_size:
        steps = sizes[1] * sizes[2] * size, sizes[2] * size, size
        strides = steps[row], steps[column], steps[band]
        return FileRows(path=path, offset=offset, stored=place.dtype, shape=shape, strides=strides)
    bands = range(shape[2])
    if place.index is not None and place.filters is not None and place.chunks is not None:
        with reading(path, kind):
            return ChunkRows(
                path=path,
                index=_inside(place.index, path),
                filters=place.filters,
                sizes=(sizes[0], sizes[1], sizes[2]),
                chunk=(place.chunks[0], place.chunks[1], place.chunks[2]),
                axes=(row, column, band),
                bands=bands,
                stored=place.dtype,
            )
    return StoredRows(
        path=path,
        name=name,
        kind="HDF5",
        opened=opened,
        axes=(row, column, band),
        shape=shape,
        bands=bands,
        stored=place.dtype,
        chunk_rows=min(place.chunks[row], shape[0]) if place.chunks else 1,
    )


def _inside(index: Int64[Array, "chunks 3"], path: Path) -> Int64[Array, "chunks 3"]:
    """The index, refused if a chunk lies beyond the end of the file."""
    beyond = (index[:, :2] < 0).any(axis=1) | (index[:, 0] > path.stat().st_size - index[:, 1])
    if beyond.any():
        raise ValueError(f"{int(beyond.sum())} of {len(index)} chunks lie beyond its end")
    return index
