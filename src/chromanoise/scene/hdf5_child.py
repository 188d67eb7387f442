"""What libhdf5 reads of a file that may be damaged; called in the child process of `_sandbox`.

On some damaged files libhdf5 (2.0.0) ends its process or never returns.
"""

import math
import zlib
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Int64, Shaped

from chromanoise import _check
from chromanoise._check import Array, printable
from chromanoise.scene.faults import library
from chromanoise.scene.labeled import Labeled

_LONGEST_ATTRIBUTE = 100_000
_PACKING_BYTES = 4096  # tables and checksums that compression may add to a chunk

DEFLATE, SHUFFLE = 1, 2  # as HDF5 numbers its filters


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Place:
    """Where the numbers of one array are.

    Attributes
    ----------
    shape, dtype, chunks
        As the file declares them; ``chunks`` is None where the array is stored in one piece.
    offset
        Of the first number, if the bytes in the file are those of the NumPy array. [bytes]
    filters
        What the chunks went through, in that order; None if only libhdf5 can undo it.
    index
        Of each chunk the first byte in the file, the length in bytes, and which filters were left
        out; None where ``filters`` is.
    """

    shape: tuple[int, ...]
    dtype: np.dtype
    chunks: tuple[int, ...] | None
    offset: int | None = None
    filters: tuple[int, ...] | None = None
    index: Int64[Array, "chunks 3"] | None = None


@contextmanager
def opened(path: Path, name: str) -> Iterator[Any]:
    """The array ``name`` of an HDF5 file, as h5py has it."""
    with _file(path) as file:
        yield file[name]


def _file(path: Path) -> Any:
    return library("h5py", str(path)).File(path, "r")


# what the file holds


def stored_arrays(
    path: Path, kept: Collection[str], most: int
) -> tuple[dict[str, Labeled], Mapping[str, Any]]:
    """All arrays by their names, at most one more than ``most``; and the attributes of the file.

    Parameters
    ----------
    path
        The file. Links out of it, and links that go round, are not followed.
    kept
        The attributes that are read, by names in lower case.
    most
        How many arrays are expected.
    """
    with _file(path) as file:
        names: list[str] = []
        dataset_type = library("h5py", str(path)).Dataset

        def see(name: str, thing: Any) -> bool | None:
            if isinstance(thing, dataset_type) and thing.shape is not None:
                names.append(name)
            return True if len(names) > most else None

        file.visititems(see)
        arrays = {
            name: Labeled(
                shape=tuple(int(n) for n in dataset.shape),
                dtype=_dtype(dataset),
                axes=_axes(dataset),
                attributes=_attributes(dataset.attrs, kept),
            )
            for name, dataset in ((name, file[name]) for name in names)
        }
        return arrays, _attributes(file.attrs, kept)


def _dtype(dataset: Any) -> np.dtype:
    try:
        return np.dtype(dataset.dtype.str)
    except (TypeError, ValueError):  # types that NumPy does not have
        return np.dtype("O")


def _axes(dataset: Any) -> tuple[str, ...]:
    """Names of the axes, by the lists of coordinates that NetCDF attaches to them, or by labels."""
    if not {"DIMENSION_LIST", "DIMENSION_LABELS"} & set(dataset.attrs):
        return ()
    scales = (str(d[0].name).strip("/") if len(d) else "" for d in dataset.dims)
    return tuple(scale or str(d.label) for scale, d in zip(scales, dataset.dims, strict=True))


def _attributes(attributes: Any, kept: Collection[str]) -> dict[str, Any]:
    """Those that are understood, by names in lower case; a damaged one may claim any size."""
    shapes = {n: attributes.get_id(n).shape for n in list(attributes) if n.lower() in kept}
    return {
        name.lower(): _plain(attributes[name])
        for name, shape in shapes.items()
        if shape is not None and math.prod(shape) <= _LONGEST_ATTRIBUTE
    }


def _plain(value: Any) -> Any:
    """Texts, numbers and arrays of numbers; None for anything else."""
    array = np.asarray(value)
    if array.dtype.kind in "OSU" and array.size == 1:
        word = array.ravel()[0]
        text = word.decode("utf-8", "replace") if isinstance(word, bytes) else word
        return str(text) if isinstance(text, str) else None
    return array if array.dtype.kind in "biuf" else None


# where the numbers of one array are


def stored_place(path: Path, name: str) -> Place:
    """Where they are; what cannot be read without libhdf5 is tried here first.

    Raises
    ------
    InputError
        If they are not all in the file.
    ValueError
        If a compressed chunk is longer than it would be uncompressed.
    """
    with _file(path) as file:
        dataset = file[name]
        _refuse_incomplete(path, name, dataset)
        place = Place(
            shape=tuple(int(n) for n in dataset.shape),
            dtype=_dtype(dataset),
            chunks=dataset.chunks,
            offset=_offset(dataset),
        )
        if place.offset is not None:
            return place
        filters = _filters(dataset)
        index = None if filters is None else _index(dataset, filters, file.userblock_size)
        if index is None:
            _refuse_long_chunks(dataset)
            dataset[tuple(slice(0, n) for n in dataset.chunks or (1,) * dataset.ndim)]
            return place
        return replace(place, filters=filters, index=index)


def _refuse_long_chunks(dataset: Any) -> None:
    """Refuse compressed chunks longer than uncompressed ones: libhdf5 inflates all of a chunk."""
    if dataset.chunks is None:
        return
    whole = math.prod(dataset.chunks) * dataset.dtype.itemsize
    longest = max((chunk.size for chunk in _chunks(dataset)), default=0)
    if longest > whole + whole // 8 + _PACKING_BYTES:
        raise ValueError(
            f"a compressed chunk has {longest} bytes, uncompressed it would have {whole}"
        )


def _chunks(dataset: Any) -> list[Any]:
    chunks: list[Any] = []
    dataset.id.chunk_iter(chunks.append)
    return chunks


def _refuse_incomplete(path: Path, name: str, dataset: Any) -> None:
    """HDF5 gives zeros for what a program that was stopped did not come to write."""
    if dataset.external or dataset.is_virtual:
        raise _check.InputError(
            f"{path}: the numbers of array {printable(name)!r} lie in other files, which are not "
            "read; store them in one file"
        )
    if dataset.chunks is None:
        needed = math.prod(dataset.shape) * dataset.dtype.itemsize
        absent = "its numbers were" if dataset.id.get_storage_size() < needed else ""
    else:
        per_axis = zip(dataset.shape, dataset.chunks, strict=True)
        parts = math.prod(-(-n // long) for n, long in per_axis)
        missing = parts - dataset.id.get_num_chunks()
        absent = f"{missing} of its {parts} chunks were" if missing > 0 else ""
    if absent:
        raise _check.InputError(
            f"{path}: array {printable(name)!r} is not complete, {absent} never written; save it "
            "again"
        )


def _offset(dataset: Any) -> int | None:
    offset = None if dataset.chunks else dataset.id.get_offset()
    return int(offset) if offset is not None and _lies_as_numpy_has_it(dataset) else None


def _lies_as_numpy_has_it(dataset: Any) -> bool:
    """Whether the bytes in the file are those of the NumPy type."""
    if dataset.dtype.kind not in "fiu":
        return False
    types = library("h5py.h5t", "HDF5 files")
    return bool(dataset.id.get_type().equal(types.py_create(dataset.dtype)))


def _filters(dataset: Any) -> tuple[int, ...] | None:
    """What chunks went through, in that order; None if only libhdf5 can undo it."""
    if dataset.chunks is None or not _lies_as_numpy_has_it(dataset):
        return None
    made = dataset.id.get_create_plist()
    filters = [made.get_filter(k) for k in range(made.get_nfilters())]
    known = all(
        kind == DEFLATE or (kind == SHUFFLE and values[:1] == (dataset.dtype.itemsize,))
        for kind, _, values, _ in filters
    )
    return tuple(int(kind) for kind, *_ in filters) if known else None


def _index(dataset: Any, filters: tuple[int, ...], before: int) -> Int64[Array, "chunks 3"] | None:
    """Per chunk first byte, length, and filters left out; None if the file cannot tell."""
    grid = [-(-n // long) for n, long in zip(dataset.shape, dataset.chunks, strict=True)]
    index = np.full((math.prod(grid), 3), -1, dtype=np.int64)
    for chunk in _chunks(dataset):
        at = [n // long for n, long in zip(chunk.chunk_offset, dataset.chunks, strict=True)]
        number = np.ravel_multi_index(at, grid)
        index[number] = chunk.byte_offset, chunk.size, chunk.filter_mask
    whole = math.prod(dataset.chunks) * dataset.dtype.itemsize
    if DEFLATE in filters and (index[:, 1] == whole).any():
        return None  # HDF5 may leave chunks at the edge as they are, and does not tell
    _, first = dataset.id.read_direct_chunk((0,) * dataset.ndim)
    for shift in (0, before):  # versions differ in where they count from
        with Path(dataset.file.filename).open("rb") as file:
            file.seek(index[0, 0] + shift)
            if file.read(len(first)) == first and len(first) == index[0, 1]:
                return index + np.array([shift, 0, 0])
    return None


# the numbers of one array


def stored_numbers(path: Path, name: str) -> Shaped[Array, "..."]:
    """All of them.

    Raises
    ------
    InputError
        If they are not all in the file.
    ValueError
        If a chunk is too long, or inflates to too few bytes: libhdf5 gives what lies in memory for
        the rest.
    """
    with _file(path) as file:
        dataset = file[name]
        _refuse_incomplete(path, name, dataset)
        _refuse_long_chunks(dataset)
        if DEFLATE in (_filters(dataset) or ()):
            _refuse_short_chunks(dataset)
        return np.asarray(dataset[...])


def _refuse_short_chunks(dataset: Any) -> None:
    whole = math.prod(dataset.chunks) * dataset.dtype.itemsize
    for chunk in _chunks(dataset):
        if chunk.filter_mask == 0 and chunk.size != whole:
            _, content = dataset.id.read_direct_chunk(chunk.chunk_offset)
            length = len(zlib.decompressobj().decompress(content, whole + 1))
            if length != whole:
                raise ValueError(f"a chunk holds {length} bytes instead of {whole}")
