"""HDF5 files: NetCDF-4, MATLAB 7.3, CEA-LETI's ReDFISh, and what other programs write.

Nothing outside the file is ever read: links to other files are not followed, and arrays whose
numbers lie in other files are refused.
"""

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Shaped, UInt8

from chromanoise import _check
from chromanoise._check import Array
from chromanoise.scene.arrays import printable
from chromanoise.scene.faults import library, reading, reading_rows
from chromanoise.scene.file_rows import FileRows, refuse_other_rows
from chromanoise.scene.labeled import Axes, Labeled, Store
from chromanoise.scene.rows import RowSource, block

ENDINGS = (".h5", ".hdf5", ".hdf", ".he5", ".nc", ".nc4", ".cdf")
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_STARTS = (0, 512, 1024, 2048)  # where the signature may stand: after a block of the user's
_MATLAB_NUMBERS = frozenset({
    "double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64",
    "uint64",
})  # fmt: skip
_READ = frozenset({
    "units", "long_name", "standard_name", "description", "scale_factor", "add_offset",
    "_fillvalue", "missing_value", "valid_range", "valid_min", "valid_max", "wavelength",
    "wavelengths", "wavelength_nm", "wavelengths_nm", "wavelength_units", "matlab_class",
    "matlab_sparse", "matlab_empty",
})  # fmt: skip
_MOST_ARRAYS = 10_000
_LONGEST_ATTRIBUTE = 100_000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hdf5Rows:
    """Rows of an array that is stored in chunks.

    Attributes
    ----------
    path, name
        The file and the array in it.
    axes
        Which of its axes are rows, columns, bands.
    shape
        Rows, columns, bands.
    bands
        Which of the stored bands, in which order.
    stored
        Type of the numbers in the file.
    chunk_rows
        Rows that are stored together.
    """

    path: Path
    name: str
    axes: Axes
    shape: tuple[int, int, int]
    bands: range
    stored: np.dtype
    chunk_rows: int

    @property
    def dtype(self) -> np.dtype:
        """Of what ``rows`` gives; in the byte order of this machine."""
        return self.stored.newbyteorder("=")

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, with the strides in which they are stored."""
        refuse_other_rows(str(self.path), self.shape, start, stop)
        h5py = library("h5py", str(self.path))
        with reading_rows(self.path, "HDF5"), h5py.File(self.path, "r") as file:
            read = block(file[self.name], self.axes, start, stop, self.bands)
        if read.shape != (stop - start, *self.shape[1:]):
            raise _check.InputError(f"{self.path}: was changed while it was being read")
        return read.astype(self.dtype, copy=False)

    def scratch_bytes(self, rows: int) -> int:
        """How large ``into`` must be for so many rows; 0 if it is not used. [bytes]"""
        return 0

    def with_bands(self, keep: slice) -> "Hdf5Rows":
        """The same with some of the bands; nothing is read."""
        bands = self.bands[keep]
        return replace(self, bands=bands, shape=(*self.shape[:2], len(bands)))


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
    h5py = library("h5py", f"{path}: {kind} files")
    arrays: dict[str, Labeled] = {}
    with reading(path, kind), h5py.File(path, "r") as file:
        for name, dataset in _datasets(file, h5py, path):
            arrays[name] = _labeled(dataset, matlab)
        top = _attributes(file.attrs)
    return Store(
        path=path,
        kind=kind,
        bytes=path.stat().st_size,
        arrays=arrays,
        numbers=partial(_numbers, path, matlab),
        source=partial(_source, path, matlab),
        attributes=top,
        matlab=matlab,
    )


def _datasets(file: Any, h5py: Any, path: Path) -> list[tuple[str, Any]]:
    """All arrays of the file; links out of it, and links that go round, are not followed."""
    found: list[tuple[str, Any]] = []

    def see(name: str, thing: Any) -> None:
        if isinstance(thing, h5py.Dataset) and thing.shape is not None and not _inner(name):
            found.append((name, thing))
        if len(found) > _MOST_ARRAYS:
            raise _check.InputError(f"{path}: holds more than {_MOST_ARRAYS} arrays")

    file.visititems(see)
    return found


def _inner(name: str) -> bool:
    """What MATLAB keeps for itself."""
    return name.startswith("#")


def _labeled(dataset: Any, matlab: bool) -> Labeled:
    attributes = _attributes(dataset.attrs)
    shape = tuple(int(n) for n in dataset.shape)
    dtype = _dtype(dataset)
    if not matlab:
        return Labeled(shape=shape, dtype=dtype, axes=_axes(dataset), attributes=attributes)
    told = str(attributes.get("matlab_class", "double"))
    if told not in _MATLAB_NUMBERS or "matlab_sparse" in attributes:
        dtype = np.dtype("?") if told == "logical" else np.dtype("O")
    shape = (0,) if "matlab_empty" in attributes else shape[::-1]
    return Labeled(shape=shape, dtype=dtype, attributes=attributes)


def _dtype(dataset: Any) -> np.dtype:
    try:
        return np.dtype(dataset.dtype)
    except (TypeError, ValueError):  # types that NumPy does not have
        return np.dtype("O")


def _axes(dataset: Any) -> tuple[str, ...]:
    """Names of the axes, by the lists of coordinates that NetCDF attaches to them, or by labels."""
    if not {"DIMENSION_LIST", "DIMENSION_LABELS"} & set(dataset.attrs):
        return ()
    names = []
    for dimension in dataset.dims:
        scale = str(dimension[0].name).strip("/") if len(dimension) else ""
        names.append(scale or str(dimension.label))
    return tuple(names)


def _attributes(attributes: Any) -> Mapping[str, Any]:
    """Those that are understood, by names in lower case; texts as such."""
    kept = {}
    for name in list(attributes):
        if name.lower() in _READ and _is_short(attributes.get_id(name).shape):
            kept[name.lower()] = _plain(attributes[name])
    return kept


def _is_short(shape: tuple[int, ...] | None) -> bool:
    """Whether an attribute is small enough to be read: a damaged one may claim any size."""
    return shape is not None and math.prod(shape) <= _LONGEST_ATTRIBUTE


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray) and value.dtype.kind in "OSU" and value.size == 1:
        value = value.ravel()[0]
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


@contextmanager
def _dataset(path: Path, name: str, matlab: bool) -> Iterator[Any]:
    """One array, opened; refused if its numbers are elsewhere or were never written."""
    kind = "MATLAB 7.3" if matlab else "HDF5"
    h5py = library("h5py", str(path))
    with reading(path, kind), h5py.File(path, "r") as file:
        dataset = file[name]
        if dataset.external or dataset.is_virtual:
            raise _check.InputError(
                f"{path}: the numbers of array {printable(name)!r} lie in other files, which are "
                "not read; store them in one file"
            )
        _refuse_never_written(path, name, dataset)
        yield dataset


def _refuse_never_written(path: Path, name: str, dataset: Any) -> None:
    """HDF5 gives zeros for what a program that was stopped did not come to write."""
    if dataset.chunks is None:
        absent = dataset.id.get_storage_size() < math.prod(dataset.shape) * dataset.dtype.itemsize
        told = "its numbers were"
    else:
        per_axis = zip(dataset.shape, dataset.chunks, strict=True)
        whole = math.prod(-(-n // chunk) for n, chunk in per_axis)
        missing = whole - dataset.id.get_num_chunks()
        absent, told = missing > 0, f"{missing} of its {whole} chunks were"
    if absent:
        raise _check.InputError(
            f"{path}: array {printable(name)!r} is not complete, {told} never written; save it "
            "again"
        )


def _numbers(path: Path, matlab: bool, name: str) -> Shaped[Array, "..."]:
    with _dataset(path, name, matlab) as dataset:
        numbers = np.asarray(dataset[()])
    return numbers.T if matlab else numbers


def _source(path: Path, matlab: bool, name: str, axes: Axes) -> RowSource:
    """Chunks by h5py; what lies plainly in the file is read without it."""
    with _dataset(path, name, matlab) as dataset:
        stored, sizes = dataset.dtype, tuple(int(n) for n in dataset.shape)
        inside = tuple(2 - axis for axis in axes) if matlab else axes
        row, column, band = inside
        shape = sizes[row], sizes[column], sizes[band]
        chunks, offset = dataset.chunks, dataset.id.get_offset()
        plain = offset is not None and _lies_as_numpy_has_it(dataset)
    if plain and offset + math.prod(sizes) * stored.itemsize <= path.stat().st_size:
        steps = sizes[1] * sizes[2] * stored.itemsize, sizes[2] * stored.itemsize, stored.itemsize
        strides = steps[row], steps[column], steps[band]
        return FileRows(path=path, offset=offset, stored=stored, shape=shape, strides=strides)
    return Hdf5Rows(
        path=path,
        name=name,
        axes=(row, column, band),
        shape=shape,
        bands=range(shape[2]),
        stored=stored,
        chunk_rows=min(int(chunks[row]), shape[0]) if chunks else 1,
    )


def _lies_as_numpy_has_it(dataset: Any) -> bool:
    """Whether the bytes in the file are those of the NumPy type."""
    h5py = library("h5py", "the file")
    if dataset.chunks is not None or dataset.dtype.kind not in "fiu":
        return False
    return bool(dataset.id.get_type().equal(h5py.h5t.py_create(dataset.dtype)))
