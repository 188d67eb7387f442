"""Raw frames in NumPy's files: NPY and NPZ; pickled data are never loaded."""

import math
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from chromanoise._check import Array, printable
from chromanoise._shapes import Integer
from chromanoise.errors import InputError
from chromanoise.io.cubes.bounds import refuse_impossible
from chromanoise.io.cubes.errors import reading, reading_rows
from chromanoise.io.cubes.npz import npy_array, npz_arrays
from chromanoise.io.frames.frame import RawFrame
from chromanoise.io.frames.stored import StoredPlane, refuse_shape, whole_codes

_MOST_ARRAYS = 20_000
_HEADERS = {
    (1, 0): np.lib.format.read_array_header_1_0,
    (2, 0): np.lib.format.read_array_header_2_0,
}


def npy_frames(path: Path) -> tuple[RawFrame, ...]:
    """The frame in a ``.npy``, or the stack of frames; each is read in place.

    Raises
    ------
    InputError
        If the file is damaged, or holds no array of 2 or 3 dimensions.
    """
    with reading(path, "NumPy"):
        array = npy_array(path)
    refuse_shape(path, "", array.shape)
    size, offset = path.stat().st_size, int(array.offset)  # type: ignore[attr-defined]
    shape = (int(array.shape[-2]), int(array.shape[-1]))
    step = math.prod(shape) * array.dtype.itemsize
    if array.ndim == 2:
        columns = not array.flags.c_contiguous
        read = StoredPlane(
            path=path,
            size=size,
            offset=offset,
            stored=array.dtype,
            shape=shape,
            by_columns=columns,
        )
        return (RawFrame(path=path, shape=shape, read=read),)
    if not array.flags.c_contiguous:
        raise InputError(
            str(path),
            "must store a stack frame by frame",
            found="is in Fortran order",
            remedy="save numpy.ascontiguousarray(stack)",
        )
    return tuple(
        RawFrame(
            path=path,
            shape=shape,
            index=i,
            read=StoredPlane(
                path=path, size=size, offset=offset + i * step, stored=array.dtype, shape=shape
            ),
        )
        for i in range(array.shape[0])
    )


def npz_frames(path: Path) -> tuple[RawFrame, ...]:
    """The frames of all arrays in a ``.npz``; `RawFrame.part` is the name of the array.

    Raises
    ------
    InputError
        If the file is damaged, or an array has not 2 or 3 dimensions.
    """
    with reading(path, "NPZ"):
        arrays = npz_arrays(path)
    if not 0 < len(arrays) <= _MOST_ARRAYS:
        raise InputError(
            str(path),
            f"must hold 1 to {_MOST_ARRAYS} arrays",
            value=len(arrays),
            found=f"holds {len(arrays)}",
        )
    frames = []
    for name, (shape, dtype) in arrays.items():
        where = f"array {printable(name)!r}"
        refuse_shape(path, where, shape)
        refuse_impossible(path, name, shape[-2:], dtype)
        for i in range(shape[0]) if len(shape) == 3 else (None,):
            read = _Member(path=path, name=name, index=i, shape=shape, stored=dtype)
            sides = (shape[-2], shape[-1])
            frames.append(RawFrame(path=path, shape=sides, part=name, index=i, read=read))
    return tuple(frames)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Member:
    """Reads a frame of an array in a ``.npz``; a compressed stack is unpacked up to it."""

    path: Path
    name: str
    index: int | None
    shape: tuple[int, ...]
    stored: np.dtype

    def __call__(self) -> Integer[Array, "h w"]:
        with (
            reading_rows(self.path, "NPZ"),
            zipfile.ZipFile(self.path) as archive,
            archive.open(f"{self.name}.npy") as stream,
        ):
            shape, by_columns, dtype = _HEADERS[np.lib.format.read_magic(stream)](stream)
            if (shape, dtype) != (self.shape, self.stored):
                raise InputError(
                    str(self.path), "must not change while it is read", where=f"array {self.name!r}"
                )
            sides = shape[-2:]
            if by_columns and len(shape) == 3:
                raise InputError(
                    str(self.path),
                    "must store a stack frame by frame",
                    where=f"array {self.name!r}",
                    found="is in Fortran order",
                    remedy="save numpy.ascontiguousarray(stack)",
                )
            count = math.prod(sides) * dtype.itemsize
            stream.seek((self.index or 0) * count, 1)
            content = stream.read(count)
            if len(content) != count:
                raise InputError(str(self.path), "is truncated", where=f"array {self.name!r}")
            values = np.frombuffer(content, dtype)
            codes = values.reshape(sides[::-1]).T if by_columns else values.reshape(sides)
        return whole_codes(str(self.path), codes)
