# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Sums over the difference of two raw frames, by column and by row, in one pass."""

from typing import no_type_check

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Integer
from chromanoise.imaging.kernel_cache import kernel


@kernel()
@no_type_check
def _add_pair(a, b, tile_y, tile_x, total, sums, squares, rows):
    """total, sums, squares (tile_y, W): of a, of a - b, of its square; rows (H, tile_x)."""
    height, width = a.shape
    for y in range(height):
        phase = y % tile_y
        row_a, row_b = a[y], b[y]
        of_total, of_sums, of_squares = total[phase], sums[phase], squares[phase]
        for x in range(width):
            code = np.int64(row_a[x])
            difference = code - np.int64(row_b[x])
            of_total[x] += code
            of_sums[x] += difference
            of_squares[x] += difference * difference
        for first in range(tile_x):
            whole = np.int64(0)
            for x in range(first, width, tile_x):
                whole += np.int64(row_a[x]) - np.int64(row_b[x])
            rows[y, first] = whole


class PairSums:
    """Sums of the codes of a frame and of its difference from the next one.

    Attributes
    ----------
    total
        Sum of the codes over the rows of one phase of the tile, by column: (ty, W). [DN]
    sums, squares
        The same of the difference, and of its square. [DN], [DN^2]
    rows
        Sum of the difference over the columns of one phase, by row: (H, tx). [DN]
    """

    __slots__ = ("rows", "squares", "sums", "total")

    def __init__(
        self, a: Integer[Array, "h w"], b: Integer[Array, "h w"], tile: tuple[int, int]
    ) -> None:
        height, width = a.shape
        shape = (tile[0], width)
        self.total, self.sums, self.squares = (np.zeros(shape, np.int64) for _ in range(3))
        self.rows = np.zeros((height, tile[1]), np.int64)
        _add_pair(a, b, *tile, self.total, self.sums, self.squares, self.rows)
