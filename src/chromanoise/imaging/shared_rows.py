"""Rows that several processes of one machine put into the same memory.

Sending a picture back costs as much as making it: it is packed, copied through sockets and
unpacked, each time into fresh memory. Nor is the memory mapped where it is filled: to write a few
rows at a time, as into a file, spares the worker a fault for every page.
"""

import errno
import math
import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import (
    Shaped,
)
from chromanoise.errors import (
    InputError,
    Setting,
)

Kind = tuple[tuple[int, ...], type[np.generic]]
"""Shape and type of an array, its first axis the rows."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SharedRows:
    """An array of rows in memory, 0 at first; another process takes it along as a name.

    Attributes
    ----------
    path
        Where other processes of this machine open the memory.
    memory
        Which memory it is: what is found there later may be another.
    shape, dtype
        Of the array.
    """

    path: str
    memory: tuple[int, int]
    shape: tuple[int, ...]
    dtype: np.dtype

    def mapped(self) -> Shaped[Array, "rows ..."]:
        """The array; what any process puts into it shows."""
        return np.asarray(np.memmap(self.path, self.dtype, "r+", shape=self.shape))

    def put(self, first: int, rows: Shaped[Array, "some ..."]) -> None:
        """Put rows where they belong, the first of them at ``first``; they lie together in memory.

        Raises
        ------
        InputError
            If the memory is not there any more, or there is no room for them.
        """
        at, left = first * rows[:1].nbytes, rows.data.cast("B")
        memory = self._opened()
        try:
            while left:
                written = os.pwrite(memory, left, at)
                at, left = at + written, left[written:]
        except OSError as error:
            raise InputError(
                "the picture",
                f"cannot be kept in memory ({error})",
                remedy="make a part of it at a time",
            ) from None
        finally:
            os.close(memory)

    def _opened(self) -> int:
        """The memory as a file; a picture that was given up may have left its name to another."""
        try:
            memory = os.open(self.path, os.O_WRONLY)
        except OSError:
            raise InputError(
                self.path,
                "must be open to every worker, as where all are processes of this machine",
                found="cannot be opened",
                remedy=Setting("same_machine", (False,)),
            ) from None
        if _identity(memory) != self.memory:
            os.close(memory)
            raise InputError("the picture", "was abandoned while a worker made rows of it")
        return memory


def _identity(memory: int) -> tuple[int, int]:
    status = os.fstat(memory)
    return status.st_dev, status.st_ino


@contextmanager
def shared_rows(*kinds: Kind) -> Iterator[tuple[SharedRows, ...] | None]:
    """Memory for these arrays, which ends with this process; arrays that are mapped by then stay.

    ``None`` where the system cannot share memory by name, or has not so much of it.
    """
    with ExitStack() as stack:
        try:
            shared = tuple(_reserved(stack, shape, np.dtype(kind)) for shape, kind in kinds)
        except (OSError, AttributeError):  # too large; no Linux
            shared = None
        yield shared


def _reserved(stack: ExitStack, shape: tuple[int, ...], dtype: np.dtype) -> SharedRows:
    size_bytes = math.prod(shape) * dtype.itemsize
    if size_bytes > os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"):
        raise OSError(errno.ENOMEM, f"{size_bytes} bytes are more than this machine's memory")
    memory = os.memfd_create("chromanoise")
    stack.callback(os.close, memory)
    os.truncate(memory, size_bytes)
    path = f"/proc/{os.getpid()}/fd/{memory}"
    return SharedRows(path=path, memory=_identity(memory), shape=shape, dtype=dtype)
