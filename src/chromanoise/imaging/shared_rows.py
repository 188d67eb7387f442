"""Rows that several processes of one machine fill in place: a file in memory that all of them map.

Sending a picture back costs as much as making it: it is packed, copied through sockets and
unpacked, each time into fresh memory.
"""

import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Shaped

from chromanoise._check import Array, InputError

_IN_MEMORY = Path("/dev/shm")
_SPARE = 1.25  # a file beyond the memory ends the process that writes it, so some must be left

Kind = tuple[tuple[int, ...], type[np.generic]]
"""Shape and type of an array, its first axis the rows."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SharedRows:
    """An array of rows in a file that lives in memory; another process takes it along as a name.

    Attributes
    ----------
    path
        Of the file.
    shape, dtype
        Of the array.
    """

    path: str
    shape: tuple[int, ...]
    dtype: np.dtype

    def mapped(self) -> Shaped[Array, "rows ..."]:
        """The array; what is written into it, all processes see.

        Raises
        ------
        InputError
            If this machine has no such file.
        """
        try:
            return np.asarray(np.memmap(self.path, self.dtype, "r+", shape=self.shape))
        except FileNotFoundError:
            raise InputError(
                f"a worker does not find {self.path}, where the rows are to be filled; set "
                "same_machine only where all workers are processes of this machine"
            ) from None


@contextmanager
def shared_rows(*kinds: Kind) -> Iterator[tuple[SharedRows, ...] | None]:
    """Files for these arrays, gone at the end; arrays that are mapped by then stay.

    ``None`` where the machine keeps no files in memory, or has not room enough for these.
    """
    sizes = [int(np.prod(shape)) * np.dtype(kind).itemsize for shape, kind in kinds]
    if not _has_room(sum(sizes)) or 0 in sizes:
        yield None
        return
    with tempfile.TemporaryDirectory(prefix="chromanoise-", dir=_IN_MEMORY) as folder:
        made = []
        for number, (size, (shape, kind)) in enumerate(zip(sizes, kinds, strict=True)):
            path = Path(folder) / str(number)
            path.touch()
            os.truncate(path, size)
            made.append(SharedRows(path=str(path), shape=shape, dtype=np.dtype(kind)))
        yield tuple(made)


def _has_room(size_bytes: int) -> bool:
    return _IN_MEMORY.is_dir() and shutil.disk_usage(_IN_MEMORY).free > _SPARE * size_bytes
