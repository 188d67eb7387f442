"""A process of its own, in which libhdf5 opens a file that may be damaged.

On some damaged files libhdf5 (2.0.0) ends its process or never returns, which no ``except`` can
catch. So it runs here: this file is started as a script, imports nothing of this library, is asked
in JSON on stdin, and answers with a line of JSON, and perhaps the bytes of numbers, on stdout. It
ends itself when libhdf5 does not come back in time, even if nobody waits for it any more.
"""

import contextlib
import faulthandler
import importlib
import json
import math
import os
import sys
import zlib
from collections.abc import Iterator
from typing import Any

_LONGEST_ATTRIBUTE = 100_000
_PIECE_BYTES = 2**24
_PACKING_BYTES = 4096  # tables and checksums that compression may add to a chunk
_END = object()

DEFLATE, SHUFFLE = 1, 2  # as HDF5 numbers its filters
FAULT, NO_MEMORY = 3, 4  # exit codes; what the fault is stands on stderr


def main() -> None:
    """Answer the one question on stdin."""
    asked = json.load(sys.stdin)
    answers = {"arrays": _arrays, "place": _place, "numbers": _numbers}
    _keep_no_core()
    code = 0
    try:
        for answer in _in_time(answers[asked["what"]](asked), asked["limit_s"]):
            raw = answer if isinstance(answer, bytes) else json.dumps(answer).encode() + b"\n"
            sys.stdout.buffer.write(raw)
    except MemoryError:
        code = NO_MEMORY
    except Exception as error:  # libraries throw anything
        sys.stderr.write(str(error) or type(error).__name__)
        code = FAULT
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)  # at once: tidying up after a damaged file may crash or loop, too


def _keep_no_core() -> None:
    """A crash is expected here; its memory is of no use to anyone."""
    with contextlib.suppress(ImportError):  # Windows
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _in_time(answers: Iterator[Any], limit_s: float) -> Iterator[Any]:
    """The answers; None only says that a step came back. A step that does not ends the process."""
    while True:
        # A thread of its own in C: it acts even while libhdf5 loops and holds Python's lock.
        faulthandler.dump_traceback_later(limit_s, exit=True)
        try:
            answer = next(answers, _END)
        finally:
            faulthandler.cancel_dump_traceback_later()
        if answer is _END:
            return
        if answer is not None:
            yield answer


def _h5py() -> Any:
    return importlib.import_module("h5py")


def _opened(path: str) -> Any:
    return _h5py().File(path, "r")


# what the file holds


def _arrays(asked: dict[str, Any]) -> Iterator[dict[str, Any] | None]:
    with _opened(asked["path"]) as file:
        names = _names(file, asked["most"])
        yield None
        listed = []
        for name in names:
            listed.append(_array(name, file[name], asked["attributes"]))
            yield None
        yield {"attributes": _attributes(file.attrs, asked["attributes"]), "arrays": listed}


def _names(file: Any, most: int) -> list[str]:
    """Links out of the file, and links that go round, are not followed; at most one too many."""
    found: list[str] = []
    dataset_type = _h5py().Dataset

    def see(name: str, thing: Any) -> bool | None:
        if isinstance(thing, dataset_type) and thing.shape is not None:
            found.append(name)
        return True if len(found) > most else None

    file.visititems(see)
    return found


def _array(name: str, dataset: Any, kept: list[str]) -> dict[str, Any]:
    return {
        "name": name,
        "shape": [int(n) for n in dataset.shape],
        "dtype": _dtype(dataset),
        "axes": _axes(dataset),
        "attributes": _attributes(dataset.attrs, kept),
    }


def _dtype(dataset: Any) -> str:
    try:
        return str(dataset.dtype.str)
    except (TypeError, ValueError):  # types that NumPy does not have
        return "|O"


def _axes(dataset: Any) -> list[str]:
    """Names of the axes, by the lists of coordinates that NetCDF attaches to them, or by labels."""
    if not {"DIMENSION_LIST", "DIMENSION_LABELS"} & set(dataset.attrs):
        return []
    names = []
    for dimension in dataset.dims:
        scale = str(dimension[0].name).strip("/") if len(dimension) else ""
        names.append(scale or str(dimension.label))
    return names


def _attributes(attributes: Any, kept: list[str]) -> dict[str, Any]:
    """Those that are understood, by names in lower case."""
    return {
        name.lower(): _plain(attributes[name])
        for name in list(attributes)
        if name.lower() in kept and _is_short(attributes.get_id(name).shape)
    }


def _is_short(shape: tuple[int, ...] | None) -> bool:
    """Whether an attribute is small enough to be read: a damaged one may claim any size."""
    return shape is not None and math.prod(shape) <= _LONGEST_ATTRIBUTE


def _plain(value: Any) -> Any:
    """What JSON can say: texts, numbers and lists of numbers; null for anything else."""
    import numpy as np

    array = np.asarray(value)
    if array.dtype.kind in "OSU" and array.size == 1:
        word = array.ravel()[0]
        text = word.decode("utf-8", "replace") if isinstance(word, bytes) else word
        return str(text) if isinstance(text, str) else None
    if array.dtype.kind == "f":
        with np.errstate(all="ignore"):
            return array.astype(np.float64).tolist()
    return array.tolist() if array.dtype.kind in "biu" else None


# where the numbers of one array are


def _place(asked: dict[str, Any]) -> Iterator[dict[str, Any] | bytes | None]:
    """And the index of its chunks; what cannot be read without libhdf5 is tried here first."""
    with _opened(asked["path"]) as file:
        dataset = file[asked["name"]]
        place = _storage(dataset)
        yield None
        if place["elsewhere"] or place["missing"] or place["offset"] is not None:
            yield place
            return
        filters = _filters(dataset)
        index = None if filters is None else _index(dataset, filters, file.userblock_size)
        yield None
        if index is None:
            _refuse_long_chunks(dataset)
            dataset[tuple(slice(0, n) for n in dataset.chunks or (1,) * dataset.ndim)]
        yield place | {"filters": None if index is None else filters}
        yield b"" if index is None else index.tobytes()


def _refuse_long_chunks(dataset: Any) -> None:
    """Refuse compressed chunks longer than uncompressed ones: libhdf5 inflates all of a chunk.

    Raises
    ------
    ValueError
        If there is one.
    """
    if dataset.chunks is None:
        return
    whole = math.prod(dataset.chunks) * dataset.dtype.itemsize
    lengths = []
    dataset.id.chunk_iter(lambda chunk: lengths.append(chunk.size))
    if max(lengths, default=0) > whole + whole // 8 + _PACKING_BYTES:
        raise ValueError(
            f"a compressed chunk has {max(lengths)} bytes, uncompressed it would have {whole}"
        )


def _storage(dataset: Any) -> dict[str, Any]:
    chunks, elsewhere = dataset.chunks, bool(dataset.external or dataset.is_virtual)
    place = {
        "shape": [int(n) for n in dataset.shape],
        "dtype": _dtype(dataset),
        "elsewhere": elsewhere,
        "chunks": None if chunks is None else [int(n) for n in chunks],
    }
    if elsewhere:
        return place
    offset = dataset.id.get_offset()
    plain = offset is not None and dataset.chunks is None and _lies_as_numpy_has_it(dataset)
    return place | _missing(dataset) | {"offset": int(offset) if plain else None}


def _missing(dataset: Any) -> dict[str, int]:
    """How many of how many parts were never written: HDF5 would give zeros for them."""
    if dataset.chunks is None:
        needed = math.prod(dataset.shape) * dataset.dtype.itemsize
        return {"missing": int(dataset.id.get_storage_size() < needed), "parts": 1}
    per_axis = zip(dataset.shape, dataset.chunks, strict=True)
    parts = math.prod(-(-n // chunk) for n, chunk in per_axis)
    return {"missing": int(parts - dataset.id.get_num_chunks()), "parts": int(parts)}


def _lies_as_numpy_has_it(dataset: Any) -> bool:
    """Whether the bytes in the file are those of the NumPy type."""
    if dataset.dtype.kind not in "fiu":
        return False
    return bool(dataset.id.get_type().equal(_h5py().h5t.py_create(dataset.dtype)))


def _filters(dataset: Any) -> list[int] | None:
    """What chunks went through, in that order; None if only libhdf5 can undo it."""
    if dataset.chunks is None or not _lies_as_numpy_has_it(dataset):
        return None
    made = dataset.id.get_create_plist()
    filters = [made.get_filter(k) for k in range(made.get_nfilters())]
    known = all(
        kind == DEFLATE or (kind == SHUFFLE and values[:1] == (dataset.dtype.itemsize,))
        for kind, _, values, _ in filters
    )
    return [int(kind) for kind, *_ in filters] if known else None


def _index(dataset: Any, filters: list[int], before: int) -> Any:
    """Per chunk first byte, length, and filters left out; None if the file cannot tell."""
    import numpy as np

    grid = [-(-n // long) for n, long in zip(dataset.shape, dataset.chunks, strict=True)]
    index = np.full((math.prod(grid), 3), -1, dtype=np.int64)

    def see(chunk: Any) -> None:
        at = [n // long for n, long in zip(chunk.chunk_offset, dataset.chunks, strict=True)]
        number = np.ravel_multi_index(at, grid)
        index[number] = chunk.byte_offset, chunk.size, chunk.filter_mask

    dataset.id.chunk_iter(see)
    whole = math.prod(dataset.chunks) * dataset.dtype.itemsize
    if DEFLATE in filters and (index[:, 1] == whole).any():
        return None  # HDF5 may leave chunks at the edge as they are, and does not tell
    _, first = dataset.id.read_direct_chunk((0,) * dataset.ndim)
    for shift in (0, before):  # versions differ in where they count from
        with open(dataset.file.filename, "rb") as file:  # noqa: PTH123 - a script of few imports
            file.seek(index[0, 0] + shift)
            if file.read(len(first)) == first and len(first) == index[0, 1]:
                return index + np.array([shift, 0, 0])
    return None


# the numbers of one array


def _numbers(asked: dict[str, Any]) -> Iterator[dict[str, Any] | bytes | None]:
    """First where they are, then their bytes in the order of C, unless they are not all there."""
    with _opened(asked["path"]) as file:
        dataset = file[asked["name"]]
        place = _storage(dataset)
        yield place
        if place["elsewhere"] or place["missing"]:
            return
        yield from _chunks_are_whole(dataset)
        for part in _parts(dataset):
            yield dataset[part].tobytes()


def _chunks_are_whole(dataset: Any) -> Iterator[None]:
    """Refuse chunks that inflate to too few bytes: libhdf5 gives what lies in memory for the rest.

    Raises
    ------
    ValueError
        If there is one.
    """
    if DEFLATE not in (_filters(dataset) or []):
        return
    whole = math.prod(dataset.chunks) * dataset.dtype.itemsize
    deflated: list[tuple[int, ...]] = []

    def see(chunk: Any) -> None:
        if chunk.filter_mask == 0 and chunk.size != whole:
            deflated.append(tuple(chunk.chunk_offset))

    dataset.id.chunk_iter(see)
    for at in deflated:
        _, content = dataset.id.read_direct_chunk(at)
        length = len(zlib.decompressobj().decompress(content, whole + 1))
        if length != whole:
            raise ValueError(f"a chunk holds {length} bytes instead of {whole}")
        yield None


def _parts(dataset: Any) -> Iterator[Any]:
    """Slices of the first axis, each read in little time."""
    if not dataset.shape:
        yield ()
        return
    row_bytes = max(math.prod(dataset.shape[1:]) * dataset.dtype.itemsize, 1)
    whole = dataset.chunks[0] if dataset.chunks else 1  # rows that are decoded together
    step = max(_PIECE_BYTES // row_bytes // whole, 1) * whole
    for start in range(0, dataset.shape[0], step):
        yield slice(start, start + step)


if __name__ == "__main__":
    main()
