"""Rows that several processes of one machine write to shared memory.

Sending an image between processes takes as long as computing it: it is packed, copied through
sockets and unpacked, each time into new memory. Workers do not map the shared memory: they write a
few rows at a time, as to a file, which avoids a page fault for every page.
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
    """An array of rows in shared memory, initially 0; pickling it sends only its name.

    Attributes
    ----------
    path
        Path at which other processes of this machine open the memory.
    memory
        Identity of the memory, because the path may refer to other memory later.
    shape, dtype
        Shape and type of the array.
    """

    path: str
    memory: tuple[int, int]
    shape: tuple[int, ...]
    dtype: np.dtype

    def mapped(self) -> Shaped[Array, "rows ..."]:
        """The array; it shows the rows that any process writes."""
        return np.asarray(np.memmap(self.path, self.dtype, "r+", shape=self.shape))

    def put(self, first: int, rows: Shaped[Array, "some ..."]) -> None:
        """Write contiguous rows into the array, starting at row ``first``.

        Raises
        ------
        InputError
            If the memory no longer exists, or has no space for the rows.
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
        """The memory as a file; its identity is checked because the path may be reused."""
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
    """Memory for these arrays, which is freed with this context; mapped arrays stay valid.

    ``None`` if the system cannot share memory by name, or has too little memory.
    """
    with ExitStack() as stack:
        try:
            shared = tuple(_reserved(stack, shape, np.dtype(kind)) for shape, kind in kinds)
        except (OSError, AttributeError):  # too large, or not Linux
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
