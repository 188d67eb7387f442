"""Zarr folders, format 2 and 3.

The content of a folder is checked before the zarr package reads it: a format-2 filter may name
``pickle``, which can run arbitrary code, and a link may point outside of the folder.
"""

import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.base import Array, Shaped, json_file, optional_package, printable, regular_file
from chromanoise.io.cubes.found_cube import MOST_INFLATED, Notes, memory_bytes, reading
from chromanoise.io.cubes.labeled import Axes, Labeled, Store, StoredRows
from chromanoise.io.source_files import refused
from chromanoise.spectra import RowSource

_HEADERS = (".zarray", "zarr.json")
_CODECS = frozenset({
    "blosc", "zlib", "gzip", "bz2", "lzma", "lz4", "zstd", "delta", "shuffle",
    "fixedscaleoffset", "quantize", "bitround", "astype", "crc32", "crc32c", "adler32",
    "fletcher32", "jenkins_lookup3", "packbits", "bytes", "transpose", "sharding_indexed",
})  # fmt: skip
_LARGEST_HEADER_BYTES = 16 * 2**20
_MOST_ARRAYS = 10_000
_TEXTS = (*_HEADERS, ".zgroup", ".zattrs", ".zmetadata")
_PACKING_BYTES = 2**20  # index of a shard, tables and checksums


def is_zarr(path: Path) -> bool:
    """Whether a folder is a Zarr array or group."""
    return any((path / name).is_file() for name in (*_HEADERS, ".zgroup"))


def zarr_store(path: Path) -> Store:
    """The arrays of a Zarr folder, without their numbers.

    Raises
    ------
    InputError
        If zarr is not installed, or the folder has unsafe or unreadable content.
    """
    optional_package("zarr", f"{path}: Zarr folders", extra="cubes")
    arrays: dict[str, Labeled] = {}
    with reading(path, "Zarr"):
        size = 0
        for folder, names, bytes_within in _folders(path):
            size += bytes_within
            if set(_HEADERS) & set(names):
                name = folder.relative_to(path).as_posix().removeprefix(".")
                array = _vetted(path, folder, name)
                if array is not None:
                    arrays[name] = array
            if len(arrays) > _MOST_ARRAYS:
                raise refused(path, f"must hold at most {_MOST_ARRAYS} arrays", found="holds more")
        top = _attributes(path, _header(path))
    return Store(
        path=path,
        kind="Zarr",
        bytes=size,
        arrays=arrays,
        numbers=partial(_numbers, path),
        source=partial(_source, path, arrays),
        notes=partial(_absent_chunks, path),
        attributes=top,
    )


def _folders(path: Path) -> Iterator[tuple[Path, list[str], int]]:
    """Every folder with the names and the size of its files; a link raises an error."""
    for folder, inner, names in os.walk(path):
        entries = list(os.scandir(folder))
        linked = next((e.path for e in entries if e.is_symlink()), None)
        if linked is not None:
            need = "must not be a link, because a link in a Zarr folder could lead out of it"
            raise refused(linked, need, found=None, remedy="copy the files themselves")
        for entry in entries:
            regular_file(Path(entry), folder=True)
        inner.sort()
        yield Path(folder), names, sum(e.stat().st_size for e in entries if e.is_file())


def _header(folder: Path) -> Mapping[str, Any]:
    for name in (*_HEADERS, ".zgroup"):
        if (folder / name).is_file():
            return _json(folder / name)
    return {}


def _json(path: Path) -> Mapping[str, Any]:
    data = json_file(path, most_bytes=_LARGEST_HEADER_BYTES, any_number=True)
    if not isinstance(data, dict):
        raise refused(path, "is not a Zarr header", remedy="save the cube again")
    return data


def _attributes(folder: Path, header: Mapping[str, Any]) -> Mapping[str, Any]:
    data = header.get("attributes", {})
    if (folder / ".zattrs").is_file():
        data = _json(folder / ".zattrs")
    return {k.lower(): v for k, v in data.items()} if isinstance(data, dict) else {}


def _vetted(path: Path, folder: Path, name: str) -> Labeled | None:
    """The header of one array, if all its codecs are allowed; None for a group."""
    header = _header(folder)
    if header.get("node_type", "array") != "array":
        return None
    for codec in _codecs(header):
        if codec not in _CODECS:
            need = "must be packed with a trusted codec"
            found = f"is packed with {printable(codec)!r}"
            where = f"array {printable(name)!r}"
            remedy = "store it with blosc, zstd or gzip"
            raise refused(path, need, printable(codec), found, where=where, remedy=remedy)
    array = _opened(path, name)
    attributes = dict(_attributes(folder, header))
    axes = header.get("dimension_names") or attributes.pop("_array_dimensions", None) or ()
    if not isinstance(axes, list) or len(axes) != len(array.shape):
        axes = [""] * len(array.shape)
    return Labeled(
        shape=tuple(int(n) for n in array.shape),
        dtype=np.dtype(array.dtype),
        axes=tuple(str(axis or "") for axis in axes),
        attributes=attributes,
    )


def _codecs(header: Any) -> Iterator[str]:
    """Names of all codecs of the chunks, also inside shards; an invalid entry also gets a name."""
    version_2 = [header.get("compressor"), *(header.get("filters") or [])]
    for codec in [c for c in version_2 if c is not None]:
        yield str(codec.get("id", "nothing")) if isinstance(codec, dict) else "nothing"
    waiting = list(header.get("codecs") or [])
    while waiting:
        codec = waiting.pop()
        named = codec.get("name") if isinstance(codec, dict) else codec
        yield str(named).removeprefix("numcodecs.")
        inner = codec.get("configuration") if isinstance(codec, dict) else None
        if isinstance(inner, dict):
            waiting += inner.get("codecs") or []
            waiting += inner.get("index_codecs") or []


@contextmanager
def _opened_for_rows(path: Path, name: str) -> Iterator[Any]:
    yield _opened(path, name)


def _opened(path: Path, name: str) -> Any:
    zarr = optional_package("zarr", str(path), extra="cubes")
    guard_codecs()
    store = zarr.storage.LocalStore(path, read_only=True)
    return zarr.open_array(store=store, path=name, mode="r")


def _numbers(path: Path, name: str) -> Shaped[Array, "..."]:
    return np.asarray(_checked(path, name)[...])


def _source(path: Path, arrays: Mapping[str, Labeled], name: str, axes: Axes) -> RowSource:
    array = _checked(path, name)
    sizes = arrays[name].shape
    return StoredRows(
        path=path,
        kind="Zarr",
        opened=partial(_opened_for_rows, path, name),
        sizes=sizes,
        axes=axes,
        bands=range(sizes[axes[2]]),
        stored=arrays[name].dtype,
        chunk_rows=min(int((array.shards or array.chunks)[axes[0]]), sizes[axes[0]]),
    )


def _absent_chunks(path: Path, name: str) -> Notes:
    """A note on missing chunks; Zarr omits chunks that contain only the fill value."""
    with reading(path, "Zarr"):
        array = _opened(path, name)
        whole, there = int(array.nchunks), int(array.nchunks_initialized)
        filled = array.fill_value
    if there == 0:
        where = f"array {printable(name)!r}"
        raise refused(path, "must have chunks", 0, "has none", where=where, remedy="save it again")
    if whole > there * MOST_INFLATED:
        need = f"must have the {whole} chunks that it declares"
        found = f"has only {there}"
        remedy = "save it again, because it is damaged or not complete"
        raise refused(path, need, there, found, where=f"array {printable(name)!r}", remedy=remedy)
    if there < whole:
        return (f"{whole - there} of {whole} chunks are absent and read as {filled}",)
    return ()


def _checked(path: Path, name: str) -> Any:
    """The array; an error if chunks exceed the memory or are larger than their numbers."""
    with reading(path, "Zarr"):
        array = _opened(path, name)
        size = math.prod(array.shards or array.chunks) * array.dtype.itemsize
        longest = max(
            (f.stat().st_size for f in (path / name).rglob("*") if f.name not in _TEXTS), default=0
        )
    if size > memory_bytes() // 2:
        need = "chunks must fit into half the memory of this machine"
        found = f"each needs {size / 2**30:.1f} GiB"
        where = f"array {printable(name)!r}"
        raise refused(path, need, size, found, where=where, remedy="store it with smaller chunks")
    if longest > size + size // 8 + _PACKING_BYTES:
        need = f"chunks must not be larger than unpacked ({size} bytes)"
        found = f"one has {longest} bytes"
        remedy = "save it again, because it is damaged"
        raise refused(path, need, longest, found, where=f"array {printable(name)!r}", remedy=remedy)
    return array


_HARMLESS_BYTES = 64 * 2**20
_BLOSC_HEADER_BYTES = 16  # the last four are the length of the chunk
_ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
_ZSTD_BLOCK_BYTES = 2**17


@cache
def guard_codecs() -> None:
    """Make numcodecs reject chunks that are shorter than declared or inflate to too many bytes.

    numcodecs (0.16) reads beyond the end of a Blosc chunk that declares a greater length, which
    crashes the process, and allocates as much memory as a Zstandard frame declares.
    """
    for codec, look in (("blosc.Blosc", _refuse_short_blosc), ("zstd.Zstd", _refuse_large_zstd)):
        module, _, name = codec.partition(".")
        kind = getattr(
            optional_package(f"numcodecs.{module}", "chunks of Zarr folders", extra="cubes"), name
        )
        kind.decode = _looked_at(kind.decode, look)


def _looked_at(unpack: Any, look: Any) -> Any:
    def decode(codec: Any, buf: Any, out: Any = None) -> Any:
        look(memoryview(buf).cast("B"))
        return unpack(codec, buf, out)

    return decode


def _refuse_short_blosc(given: memoryview) -> None:
    declared = int.from_bytes(given[_BLOSC_HEADER_BYTES - 4 : _BLOSC_HEADER_BYTES], "little")
    if given.nbytes < _BLOSC_HEADER_BYTES or declared > given.nbytes:
        raise ValueError(f"a chunk has {given.nbytes} bytes, but declares {declared}")


def _refuse_large_zstd(given: memoryview) -> None:
    size = _zstd_bytes(given)
    if size > max(_HARMLESS_BYTES, given.nbytes * MOST_INFLATED):
        raise ValueError(f"a chunk of {given.nbytes} bytes unpacks to {size / 2**20:.0f} MiB")


def _zstd_bytes(given: memoryview) -> int:
    """Unpacked size that a frame declares, or the most that its blocks allow (RFC 8878). [bytes]"""
    if bytes(given[:4]) != _ZSTD_MAGIC or given.nbytes < 5:
        return 0  # numcodecs rejects it
    descriptor = given[4]
    single = descriptor >> 5 & 1
    at = 6 - single + (0, 1, 2, 4)[descriptor & 3]
    length = (single, 2, 4, 8)[descriptor >> 6]
    if length:
        return int.from_bytes(given[at : at + length], "little")
    blocks = 0
    while at + 3 <= given.nbytes:
        header = int.from_bytes(given[at : at + 3], "little")
        repeats = header >> 1 & 3 == 1
        at += 3 + (1 if repeats else header >> 3)
        blocks += 1
        if header & 1:
            break
    return blocks * _ZSTD_BLOCK_BYTES
