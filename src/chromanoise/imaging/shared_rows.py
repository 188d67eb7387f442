"""Rows that several processes of one machine fill in place: memory that all of them map.

Sending a picture back costs as much as making it: it is packed, copied through sockets and
unpacked, each time into fresh memory.
"""

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import numpy as np
from jaxtyping import Shaped

from chromanoise._check import Array, InputError

Kind = tuple[tuple[int, ...], type[np.generic]]
"""Shape and type of an array, its first axis the rows."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SharedRows:
    """An array of rows in memory; another process takes it along as a name.

    Attributes
    ----------
    path
        Where other processes of this machine open the memory.
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
            If it is not there.
        """
        try:
            return np.asarray(np.memmap(self.path, self.dtype, "r+", shape=self.shape))
        except OSError:
            raise InputError(
                f"a worker cannot open {self.path}, where the rows are to be filled; set "
                "same_machine only where all workers are processes of this machine"
            ) from None


@contextmanager
def shared_rows(*kinds: Kind) -> Iterator[tuple[SharedRows, ...] | None]:
    """Memory for these arrays, which ends with this process; arrays that are mapped by then stay.

    ``None`` where the system cannot share memory by name, or has not room enough for these.
    """
    with ExitStack() as stack:
        try:
            shared = tuple(_reserved(stack, shape, np.dtype(kind)) for shape, kind in kinds)
        except (OSError, AttributeError):  # no room; no Linux
            shared = None
        yield shared


def _reserved(stack: ExitStack, shape: tuple[int, ...], dtype: np.dtype) -> SharedRows:
    memory = os.memfd_create("chromanoise")
    stack.callback(os.close, memory)
    # reserved now: whoever writes into memory that is not there is ended without a word
    os.posix_fallocate(memory, 0, int(np.prod(shape)) * dtype.itemsize)
    return SharedRows(path=f"/proc/{os.getpid()}/fd/{memory}", shape=shape, dtype=dtype)
