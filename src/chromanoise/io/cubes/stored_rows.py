"""Rows of arrays that a library decodes on demand."""

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Shaped, UInt8
from chromanoise.errors import InputError
from chromanoise.io.cubes.errors import reading_rows
from chromanoise.io.cubes.labeled import Axes
from chromanoise.scene.file_rows import refuse_other_rows
from chromanoise.scene.rows import block


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StoredRows:
    """Rows of one array in a file or folder of arrays.

    Attributes
    ----------
    path, kind
        The file or folder, and the common name of its format.
    opened
        Opens the array for each block of rows. It can be pickled, so that another process can take
        the source.
    axes
        The axes of the array that are rows, columns and bands.
    shape
        Numbers of rows, columns and bands.
    bands
        The selected stored bands, in order.
    stored
        Type of the numbers.
    chunk_rows
        The number of rows per stored chunk.
    """

    path: Path
    kind: str
    opened: Callable[[], AbstractContextManager[Any]]
    axes: Axes
    shape: tuple[int, int, int]
    bands: range
    stored: np.dtype
    chunk_rows: int

    @property
    def dtype(self) -> np.dtype:
        """Type of the numbers from ``rows``, in the byte order of this machine."""
        return self.stored.newbyteorder("=")

    def rows(
        self, start: int, stop: int, *, into: UInt8[Array, " bytes"] | None = None
    ) -> Shaped[Array, "rows w m"]:
        """The rows ``start`` to ``stop``, with the strides in which they are stored."""
        refuse_other_rows(str(self.path), self.shape, start, stop)
        with reading_rows(self.path, self.kind), self.opened() as array:
            read = block(array, self.axes, start, stop, self.bands)
        if read.shape != (stop - start, *self.shape[1:]):
            raise InputError(
                str(self.path),
                "must not change while it is being read",
                value=read.shape,
                found="was changed",
                remedy="read it again when no program writes to it",
            )
        return read.astype(self.dtype, copy=False)

    def scratch_bytes(self, rows: int) -> int:
        """The size that ``into`` needs for this number of rows; 0 if it is not used. [bytes]"""
        return 0

    def with_bands(self, keep: slice) -> "StoredRows":
        """The same rows with a selection of bands; nothing is read."""
        bands = self.bands[keep]
        return replace(self, bands=bands, shape=(*self.shape[:2], len(bands)))
