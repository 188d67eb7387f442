"""Raw dumps: the codes of one frame, row by row, without a header."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from chromanoise._inputs import regular_file
from chromanoise.errors import InputError
from chromanoise.io.frames.frame import RawFrame
from chromanoise.io.frames.stored import StoredPlane, refuse_shape

DUMP_ENDINGS = (".raw", ".bin")
"""Endings of files whose size and type of codes must be given."""
DUMP_TYPES: Mapping[str, str] = {"uint8": "u1", "uint16": "<u2", "uint16-be": ">u2"}
"""Types of the codes by name: 8 bits, 16 bits little-endian, 16 bits big-endian."""


def dumped_frame(path: Path, shape: tuple[int, int], stored: str = "uint16") -> RawFrame:
    """The frame of a raw dump, which is read in place.

    Parameters
    ----------
    path
        A file that holds the codes and nothing else.
    shape
        Rows and columns. [px]
    stored
        A name of `DUMP_TYPES`.

    Raises
    ------
    InputError
        If the file has another number of bytes.
    """
    dtype = np.dtype(DUMP_TYPES[stored])
    size = regular_file(path).st_size
    refuse_shape(path, "", shape)
    wanted = shape[0] * shape[1] * dtype.itemsize
    if size != wanted:
        raise InputError(
            str(path),
            f"must have {wanted} bytes for {shape[0]} rows and {shape[1]} columns of {stored}",
            value=size,
            found=f"has {size}",
            remedy="give its rows, columns and type",
        )
    plane = StoredPlane(path=path, size=size, offset=0, stored=dtype, shape=shape)
    return RawFrame(path=path, shape=shape, read=plane)
