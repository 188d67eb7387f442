"""HDF5 files: NetCDF-4, MATLAB 7.3, CEA-LETI's ReDFISh, and files of other programs.

Only the file itself is read: links to other files are not followed, and arrays with external data
raise an error. libhdf5 (2.0.0) crashes or loops on some damaged files, so a file is first opened in
the child process of `chromanoise.base.sandbox`. Uncompressed numbers, and numbers compressed with
zlib, are then read without libhdf5, which returns uninitialized memory for a chunk that inflates to
too few bytes, and reads one chunk at a time. Here an incomplete chunk raises an error, and several
threads can read.
"""

import itertools
import math
import os
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from chromanoise.base import (
    Array,
    Int64,
    Shaped,
    check,
    dataclass,
    optional_package,
    printable,
    refuse_absent_package,
    sandbox,
)
from chromanoise.io.cubes.found_cube import memory_bytes, packed_rows, reading
from chromanoise.io.cubes.labeled import Axes, Labeled, Store, StoredRows
from chromanoise.io.source_files import refused
from chromanoise.io.spectra.declared import SPECTRAL_NAMES
from chromanoise.spectra import RowSource

DEFLATE, SHUFFLE = 1, 2  # HDF5 filter numbers


@dataclass(frozen=True, kw_only=True, eq=False)
class Chunks:
    """An array whose chunks are uncompressed, shuffled or deflated; it supports slicing.

    Attributes
    ----------
    index
        Of each chunk the first byte in the file, the length in bytes, and which filters were left
        out (bit k: the k-th); chunks in the order of C.
    filters
        HDF5 numbers of the filters, in the order in which they were applied on writing.
    shape, chunk
        Length of each axis, of the array and of a chunk.
    dtype
        Type of the numbers in the file.
    """

    path: Path
    index: Int64[Array, "chunks 3"]
    filters: tuple[int, ...]
    shape: tuple[int, ...]
    chunk: tuple[int, ...]
    dtype: np.dtype

    def __post_init__(self) -> None:
        check.same_length("chunks", index=len(self.index), grid=math.prod(self.grid))
        check.freeze(self, "index")

    @property
    def grid(self) -> tuple[int, ...]:
        """The number of chunks along each axis."""
        return _grid(self.shape, self.chunk)

    def __getitem__(self, key: Any) -> Shaped[Array, "..."]:
        """Part of the array, from all chunks that overlap it.

        Parameters
        ----------
        key
            A slice for each axis, which goes up; or ``...`` for the whole array.
        """
        key = (slice(None),) * len(self.shape) if key is ... else key
        wanted = [range(n)[part] for part, n in zip(key, self.shape, strict=True)]
        spans = [range(one[0], one[-1] + 1) for one in wanted]
        result = np.empty([len(span) for span in spans], self.dtype.newbyteorder("="))
        touched = [
            range(span[0] // long, span[-1] // long + 1)
            for span, long in zip(spans, self.chunk, strict=True)
        ]
        with self.path.open("rb", buffering=0) as file:
            for at in itertools.product(*touched):
                overlaps = [
                    _overlap(k * long, long, span)
                    for k, long, span in zip(at, self.chunk, spans, strict=True)
                ]
                numbers = _chunk(self, file, int(np.ravel_multi_index(at, self.grid)))
                result[tuple(to for _, to in overlaps)] = numbers[tuple(of for of, _ in overlaps)]
        return result[tuple(slice(None, None, one.step) for one in wanted)]


def _grid(shape: tuple[int, ...], chunk: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(-(-n // long) for n, long in zip(shape, chunk, strict=True))


def _overlap(first: int, long: int, span: range) -> tuple[slice, slice]:
    """The overlap of a chunk and the requested part: slices of the chunk and of the result."""
    start, stop = max(first, span.start), min(first + long, span.stop)
    return slice(start - first, stop - first), slice(start - span.start, stop - span.start)


def _chunk(source: Chunks, file: BinaryIO, number: int) -> Shaped[Array, "a b c"]:
    first, length, left_out = (int(n) for n in source.index[number])
    file.seek(first)
    content = file.read(length)
    needed = math.prod(source.chunk) * source.dtype.itemsize
    for k, kind in reversed(list(enumerate(source.filters))):
        if left_out >> k & 1:
            continue
        if kind == DEFLATE:
            content = zlib.decompressobj().decompress(content, needed + 1)
        elif kind == SHUFFLE and len(content) == needed:
            content = _in_order(content, source.dtype.itemsize)
    if len(content) != needed:
        raise ValueError(f"chunk {number} holds {len(content)} bytes instead of {needed}")
    return np.frombuffer(content, dtype=source.dtype).reshape(source.chunk)


def _in_order(content: bytes, size: int) -> bytes:
    """Undo the shuffle filter, which stores all first bytes, then all second bytes, ..."""
    return np.frombuffer(content, np.uint8).reshape(size, -1).T.tobytes()


ENDINGS = (".h5", ".hdf5", ".hdf", ".he5", ".nc", ".nc4", ".cdf")
_SIGNATURE = b"\x89HDF\r\n\x1a\n"
_STARTS = (0, 512, 1024, 2048)  # possible offsets of the signature, after a user block
_MATLAB_NUMBERS = frozenset({
    "double", "single", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64",
    "uint64",
})  # fmt: skip
_READ = frozenset({
    "units", "long_name", "standard_name", "description", "scale_factor", "add_offset",
    "_fillvalue", "missing_value", "valid_range", "valid_min", "valid_max", "wavelength_units",
    "matlab_class", "matlab_sparse", "matlab_empty",
}) | SPECTRAL_NAMES  # fmt: skip
_MOST_ARRAYS, _MOST_THINGS, _DEEPEST = 10_000, 100_000, 64
_LONGEST_ATTRIBUTE = 100_000
_PACKING_BYTES = 4096  # tables and checksums that compression may add to a chunk
_LIMIT_S = 60.0  # for so many arrays, or chunks
_SLOWEST_BYTES_PER_S = 1e7  # of reading and unpacking


def is_hdf5(path: Path) -> bool:
    """Whether the file has the signature of HDF5 or of MATLAB 7.3."""
    with path.open("rb") as file:
        start = file.read(_STARTS[-1] + len(_SIGNATURE))
    version = {b"IM": b"\x00\x02", b"MI": b"\x02\x00"}.get(start[126:128])
    return version == start[124:126] or any(start.startswith(_SIGNATURE, at) for at in _STARTS)


def hdf5_store(path: Path, *, matlab: bool = False) -> Store:
    """The arrays of an HDF5 file, without their numbers.

    Raises
    ------
    InputError
        If h5py is not installed, or the file is damaged.
    """
    kind = "MATLAB 7.3" if matlab else "HDF5"
    if not is_hdf5(path):
        need = "must be an HDF5 file, as NetCDF-4 is"
        remedy = ("convert it (nccopy -k nc4)", "save it again")
        raise refused(path, need, found="is in another format", remedy=remedy)
    refuse_absent_package("h5py", f"{path}: {kind} files", extra="cubes")
    with reading(path, kind):
        listed, attributes = sandbox.sandboxed(_listed, path, path=path, limit_s=_LIMIT_S)
    if len(listed) > _MOST_ARRAYS:
        raise refused(path, f"must hold at most {_MOST_ARRAYS} arrays", found="holds more")
    arrays = {
        name: _by_matlab(array) if matlab else array
        for name, array in listed.items()
        if not name.startswith("#")  # MATLAB's internal data
    }

    def numbers(name: str) -> Shaped[Array, "..."]:
        size = math.prod(arrays[name].shape) * arrays[name].dtype.itemsize
        read = sandbox.sandboxed(
            _numbers,
            path,
            name,
            path=path,
            limit_s=_LIMIT_S + size / _SLOWEST_BYTES_PER_S,
            memory_bytes=sandbox.MEMORY_BYTES + 2 * size,
        )
        return read.T if matlab else read

    def source(name: str, axes: Axes) -> RowSource:
        row, column, band = (2 - axis for axis in axes) if matlab else axes
        with reading(path, kind):
            return sandbox.sandboxed(
                _source,
                path,
                name,
                (row, column, band),
                path=path,
                limit_s=_LIMIT_S,
                memory_bytes=memory_bytes(),  # chunks may be large, and many
            )

    return Store(
        path=path,
        kind=kind,
        bytes=path.stat().st_size,
        arrays=arrays,
        numbers=numbers,
        source=source,
        attributes=attributes,
        by_columns=matlab,
        bands_last=matlab,
    )


def _by_matlab(stored: Labeled) -> Labeled:
    word = str(stored.attributes.get("matlab_class", "double"))
    dtype = stored.dtype
    if word not in _MATLAB_NUMBERS or "matlab_sparse" in stored.attributes:
        dtype = np.dtype("?") if word == "logical" else np.dtype("O")
    shape = (0,) if "matlab_empty" in stored.attributes else stored.shape[::-1]
    return Labeled(shape=shape, dtype=dtype, attributes=stored.attributes)


@contextmanager
def _opened(path: Path, name: str) -> Iterator[Any]:
    with _file(path) as file:
        yield file[name]


def _file(path: Path) -> Any:
    return optional_package("h5py", str(path), extra="cubes").File(path, "r")


# in the child process: the content of the file


def _listed(path: Path) -> tuple[dict[str, Labeled], Mapping[str, Any]]:
    """All arrays by name, at most one more than allowed, and the attributes of the file.

    Links to other files and cyclic links are not followed.
    """
    with _file(path) as file:
        names: list[str] = []
        seen = itertools.count(1)
        dataset_type = optional_package("h5py", str(path), extra="cubes").Dataset

        def see(name: str | bytes, thing: Any) -> bool | None:
            depth = os.fsencode(name).count(b"/")
            if depth > _DEEPEST or next(seen) > _MOST_THINGS:  # each is looked up from the root
                raise refused(
                    path,
                    f"must hold at most {_MOST_THINGS} groups and arrays, nested at most "
                    f"{_DEEPEST} deep",
                    found="holds more of them, or deeper ones",
                    remedy="save the cube in a separate file",
                )
            if isinstance(thing, dataset_type) and thing.shape is not None:
                if isinstance(name, bytes):  # h5py cannot decode it
                    shown = name.decode("utf-8", "backslashreplace")
                    need = "must have arrays with names in UTF-8"
                    remedy = "save it again, because it is damaged"
                    raise refused(path, need, shown, f"has one named {shown[:80]}", remedy=remedy)
                names.append(name)
            return True if len(names) > _MOST_ARRAYS else None

        file.visititems(see)
        arrays = {
            name: Labeled(
                shape=tuple(int(n) for n in dataset.shape),
                dtype=_dtype(dataset),
                axes=_axes(dataset),
                attributes=_attributes(dataset.attrs),
            )
            for name, dataset in ((name, file[name]) for name in names)
        }
        return arrays, _attributes(file.attrs)


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


def _attributes(attributes: Any) -> dict[str, Any]:
    """The supported attributes, by names in lower case, except those that declare a huge size."""
    shapes = {n: attributes.get_id(n).shape for n in list(attributes) if n.lower() in _READ}
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


# in the child process: the numbers of one array


def _source(path: Path, name: str, axes: Axes) -> RowSource:
    """The rows of an array; one that needs libhdf5 is tested here first."""
    with _file(path) as file:
        dataset = file[name]
        _refuse_incomplete(path, name, dataset)
        sizes, stored, chunk = tuple(map(int, dataset.shape)), _dtype(dataset), dataset.chunks
        size, end = stored.itemsize, path.stat().st_size
        offset = dataset.id.get_offset() if chunk is None else None
        plain = offset is not None and _lies_as_numpy_has_it(dataset)
        if offset is not None and plain and offset + math.prod(sizes) * size <= end:
            return packed_rows(path, offset, stored, sizes, axes)
        array = _without_libhdf5(path, file, dataset)
        if array is None:
            dataset[tuple(slice(0, n) for n in chunk or (1,) * dataset.ndim)]
        return StoredRows(
            path=path,
            kind="HDF5",
            opened=partial(nullcontext, array) if array else partial(_opened, path, name),
            sizes=sizes,
            axes=axes,
            bands=range(sizes[axes[2]]),
            stored=stored,
            chunk_rows=min(chunk[axes[0]], sizes[axes[0]]) if chunk else 1,
        )


def _numbers(path: Path, name: str) -> Shaped[Array, "..."]:
    """All of them."""
    with _file(path) as file:
        dataset = file[name]
        _refuse_incomplete(path, name, dataset)
        return np.asarray((_without_libhdf5(path, file, dataset) or dataset)[...])


def _without_libhdf5(path: Path, file: Any, dataset: Any) -> Chunks | None:
    """The array, if its chunks can be read so: h5py fills short ones with what lies in memory."""
    filters = _filters(dataset)
    index = None if filters is None else _index(dataset, filters, file.userblock_size)
    if filters is None or index is None:
        _refuse_long_chunks(dataset)
        return None
    beyond = (index[:, :2] < 0).any(axis=1) | (index[:, 0] > path.stat().st_size - index[:, 1])
    if beyond.any():
        raise ValueError(f"{int(beyond.sum())} of {len(index)} chunks lie beyond its end")
    return Chunks(
        path=path,
        index=index,
        filters=filters,
        shape=dataset.shape,
        chunk=dataset.chunks,
        dtype=_dtype(dataset),
    )


def _refuse_incomplete(path: Path, name: str, dataset: Any) -> None:
    """HDF5 gives zeros for what a program that was stopped did not come to write."""
    if dataset.external or dataset.is_virtual:
        need = "must hold its numbers itself, because other files are not read"
        found = "they are in other files"
        where = f"array {printable(name)!r}"
        raise refused(path, need, found=found, where=where, remedy="store them in one file")
    if dataset.chunks is None:
        needed = math.prod(dataset.shape) * dataset.dtype.itemsize
        stored: Any = dataset.id.get_storage_size()
        absent = "its numbers were" if stored < needed else ""
    else:
        parts = math.prod(_grid(dataset.shape, dataset.chunks))
        stored = dataset.id.get_num_chunks()
        missing = parts - stored
        absent = f"{missing} of its {parts} chunks were" if missing > 0 else ""
    if absent:
        found = f"{absent} never written"
        where = f"array {printable(name)!r}"
        raise refused(path, "must be complete", stored, found, where=where, remedy="save it again")


def _refuse_long_chunks(dataset: Any) -> None:
    """Refuse compressed chunks longer than uncompressed ones: libhdf5 inflates all of a chunk."""
    if dataset.chunks is None:
        return
    whole = _chunk_bytes(dataset)
    longest = max((chunk.size for chunk in _chunks(dataset)), default=0)
    if longest > whole + whole // 8 + _PACKING_BYTES:
        raise ValueError(
            f"a compressed chunk has {longest} bytes, uncompressed it would have {whole}"
        )


def _chunks(dataset: Any) -> list[Any]:
    chunks: list[Any] = []
    dataset.id.chunk_iter(chunks.append)
    return chunks


def _chunk_bytes(dataset: Any) -> int:
    """Size of an uncompressed chunk. [bytes]"""
    return int(math.prod(dataset.chunks) * dataset.dtype.itemsize)


def _lies_as_numpy_has_it(dataset: Any) -> bool:
    """Whether the bytes in the file are those of the NumPy type."""
    if dataset.dtype.kind not in "fiu":
        return False
    types = optional_package("h5py.h5t", "HDF5 files", extra="cubes")
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
    grid = _grid(dataset.shape, dataset.chunks)
    index = np.full((math.prod(grid), 3), -1, dtype=np.int64)
    for chunk in _chunks(dataset):
        at = [n // long for n, long in zip(chunk.chunk_offset, dataset.chunks, strict=True)]
        number = np.ravel_multi_index(at, grid)
        index[number] = chunk.byte_offset, chunk.size, chunk.filter_mask
    if DEFLATE in filters and (index[:, 1] == _chunk_bytes(dataset)).any():
        return None  # HDF5 may leave chunks at the edge as they are, and does not tell
    _, first = dataset.id.read_direct_chunk((0,) * dataset.ndim)
    for shift in (0, before):  # versions differ in where they count from
        with Path(dataset.file.filename).open("rb") as file:
            file.seek(index[0, 0] + shift)
            if file.read(len(first)) == first and len(first) == index[0, 1]:
                return index + np.array([shift, 0, 0])
    return None
