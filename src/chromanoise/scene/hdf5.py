"""HDF5 files: NetCDF-4, MATLAB 7.3, CEA-LETI's ReDFISh, and what other programs write.

Nothing outside the file is ever read: links to other files are not followed, and arrays whose
numbers lie in other files are refused. What a file holds is found out by a process of its own, for
libhdf5 crashes or loops on some damaged files.
"""

import json
import math
import os
import subprocess
import sys
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array, printable
from chromanoise._shapes import Int64, Shaped, UInt8
from chromanoise.scene import hdf5_child
from chromanoise.scene.faults import IN_PLACE, library, reading, reading_rows
from chromanoise.scene.file_rows import FileRows, refuse_other_rows
from chromanoise.scene.hdf5_chunks import ChunkRows
from chromanoise.scene.labeled import Axes, Labeled, Store
from chromanoise.scene.rows import RowSource, block
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
_LIMIT_S = 20.0  # how long libhdf5 may be busy with one array, or one part of it


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Hdf5Rows:
    """Rows of an array that only libhdf5 can decode.

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
    kind = _kind(matlab)
    library("h5py", f"{path}: {kind} files")
    with reading(path, kind):
        told, _ = _asked(path, "arrays", attributes=sorted(_READ), most=_MOST_ARRAYS)
        if len(told["arrays"]) > _MOST_ARRAYS:
            raise _check.InputError(f"{path}: holds more than {_MOST_ARRAYS} arrays")
        arrays = {
            str(array["name"]): _labeled(array, matlab)
            for array in told["arrays"]
            if not array["name"].startswith("#")  # what MATLAB keeps for itself
        }
        top = dict(told["attributes"])
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


def _kind(matlab: bool) -> str:
    return "MATLAB 7.3" if matlab else "HDF5"


def _labeled(told: dict[str, Any], matlab: bool) -> Labeled:
    attributes = told["attributes"]
    shape = tuple(told["shape"])
    dtype = np.dtype(told["dtype"])
    if not matlab:
        return Labeled(shape=shape, dtype=dtype, axes=tuple(told["axes"]), attributes=attributes)
    word = str(attributes.get("matlab_class", "double"))
    if word not in _MATLAB_NUMBERS or "matlab_sparse" in attributes:
        dtype = np.dtype("?") if word == "logical" else np.dtype("O")
    shape = (0,) if "matlab_empty" in attributes else shape[::-1]
    return Labeled(shape=shape, dtype=dtype, attributes=attributes)


def _numbers(path: Path, matlab: bool, name: str) -> Shaped[Array, "..."]:
    with reading(path, _kind(matlab)):
        place, content = _asked(path, "numbers", name=name)
        _refuse_incomplete(path, name, place)
        numbers = np.frombuffer(content, np.dtype(place["dtype"])).reshape(place["shape"])
    return numbers.T if matlab else numbers


def _source(path: Path, matlab: bool, name: str, axes: Axes) -> RowSource:
    """What lies plainly in the file, or went through zlib, is read without libhdf5."""
    with reading(path, _kind(matlab)):
        place, content = _asked(path, "place", name=name)
        _refuse_incomplete(path, name, place)
        stored, sizes = np.dtype(place["dtype"]), place["shape"]
        row, column, band = (2 - axis for axis in axes) if matlab else axes
        shape = sizes[row], sizes[column], sizes[band]
        chunks, offset = place["chunks"], place["offset"]
    if offset is not None and offset + math.prod(sizes) * stored.itemsize <= path.stat().st_size:
        steps = sizes[1] * sizes[2] * stored.itemsize, sizes[2] * stored.itemsize, stored.itemsize
        strides = steps[row], steps[column], steps[band]
        return FileRows(path=path, offset=offset, stored=stored, shape=shape, strides=strides)
    bands = range(shape[2])
    if place.get("filters") is not None:
        return _chunk_rows(path, place, content, (row, column, band), bands)
    return Hdf5Rows(
        path=path,
        name=name,
        axes=(row, column, band),
        shape=shape,
        bands=bands,
        stored=stored,
        chunk_rows=min(int(chunks[row]), shape[0]) if chunks else 1,
    )


def _chunk_rows(
    path: Path, place: dict[str, Any], content: bytes, axes: Axes, bands: range
) -> ChunkRows:
    with reading(path, "HDF5"):
        first, second, third = place["shape"]
        long, wide, deep = place["chunks"]
        return ChunkRows(
            path=path,
            index=_inside(np.frombuffer(content, np.int64).reshape(-1, 3), path),
            filters=tuple(place["filters"]),
            sizes=(first, second, third),
            chunk=(long, wide, deep),
            axes=axes,
            bands=bands,
            stored=np.dtype(place["dtype"]),
        )


def _inside(index: Int64[Array, "chunks 3"], path: Path) -> Int64[Array, "chunks 3"]:
    """The index, refused if a chunk lies beyond the end of the file."""
    beyond = (index[:, :2] < 0).any(axis=1) | (index[:, 0] > path.stat().st_size - index[:, 1])
    if beyond.any():
        raise ValueError(f"{int(beyond.sum())} of {len(index)} chunks lie beyond its end")
    return index


def _refuse_incomplete(path: Path, name: str, place: dict[str, Any]) -> None:
    """HDF5 gives zeros for what a program that was stopped did not come to write."""
    if place["elsewhere"]:
        raise _check.InputError(
            f"{path}: the numbers of array {printable(name)!r} lie in other files, which are not "
            "read; store them in one file"
        )
    if place["missing"] > 0:
        chunks = f"{place['missing']} of its {place['parts']} chunks were"
        told = "its numbers were" if place["chunks"] is None else chunks
        raise _check.InputError(
            f"{path}: array {printable(name)!r} is not complete, {told} never written; save it "
            "again"
        )


# the process that asks libhdf5


def _asked(path: Path, what: str, **more: Any) -> tuple[dict[str, Any], bytes]:
    """The answer of the other process, and the bytes that follow it."""
    question = {"what": what, "path": str(path.absolute()), "limit_s": _LIMIT_S, **more}
    paths = os.pathsep.join(entry for entry in sys.path if entry)
    done = subprocess.run(
        [_python(path), "-P", "-W", "ignore", hdf5_child.__file__],
        input=json.dumps(question).encode(),
        capture_output=True,
        check=False,
        env={**os.environ, "PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1"},
    )
    if done.returncode:
        raise _fault(done.returncode, done.stderr)
    line, _, content = done.stdout.partition(b"\n")
    return json.loads(line), content


def _fault(code: int, told: bytes) -> Exception:
    """What became of the other process."""
    if code == hdf5_child.NO_MEMORY:
        return MemoryError()
    if code == hdf5_child.FAULT:
        return ValueError(told.decode("utf-8", "replace"))
    if told.startswith(b"Timeout ("):
        return ValueError(f"libhdf5 does not come back within {_LIMIT_S:g} s")
    return ValueError(f"libhdf5 crashes, exit code {code}")


def _python(path: Path) -> str:
    if sys.executable and not getattr(sys, "frozen", False):
        return sys.executable
    raise _check.InputError(
        f"{path}: HDF5 is read by a second Python, which this program cannot start; {IN_PLACE}"
    )
