# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Exact sums over raw frames: of differences, and of what a high-pass filter leaves.

All sums of codes are integers, so their order changes no digit.
"""

from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise._check import Array
from chromanoise._shapes import Integer
from chromanoise.imaging.kernel_cache import kernel


@njit(inline="always")
@no_type_check
def _row_sums(row_a, row_b, first, step):
    """Sums over every ``step``-th column: of a, of a - b, of its square."""
    total = whole = square = np.int64(0)
    for i in range(row_a.size // step):
        code = np.int64(row_a[i * step + first])
        difference = code - np.int64(row_b[i * step + first])
        total += code
        whole += difference
        square += difference * difference
    return total, whole, square


@kernel()
@no_type_check
def _add_pair(a, b, first_row, tile_y, tile_x, totals, squares, columns, rows):
    """totals, squares (tile_y, tile_x), columns (tile_y, W), rows (H, tile_x): see `PairSums`.

    The steps of common mosaics are constants, so that the loops vectorize.
    """
    for y in range(a.shape[0]):
        phase = (first_row + y) % tile_y
        row_a, row_b, by_column = a[y], b[y], columns[phase]
        for x in range(row_a.size):
            by_column[x] += np.int64(row_a[x]) - np.int64(row_b[x])
        for first in range(tile_x):
            if tile_x == 1:
                total, whole, square = _row_sums(row_a, row_b, 0, 1)
            elif tile_x == 2:
                total, whole, square = _row_sums(row_a, row_b, first, 2)
            elif tile_x == 4:
                total, whole, square = _row_sums(row_a, row_b, first, 4)
            elif tile_x == 6:
                total, whole, square = _row_sums(row_a, row_b, first, 6)
            else:
                total, whole, square = _row_sums(row_a, row_b, first, tile_x)
            totals[phase, first] += total
            squares[phase, first] += square
            rows[first_row + y, first] = whole


class PairSums:
    """Sums of the codes of a frame and of its difference from the next one.

    Attributes
    ----------
    totals
        Sum of the codes of each plane: (ty, tx). [DN]
    squares
        Sum of the squares of the difference: (ty, tx). [DN^2]
    columns
        Sum of the difference over the rows of one phase of the tile, by column: (ty, W). [DN]
    rows
        Sum of the difference over the columns of one phase, by row: (H, tx). [DN]
    """

    __slots__ = ("columns", "rows", "squares", "totals")

    def __init__(self, shape: tuple[int, int], tile: tuple[int, int]) -> None:
        self.totals, self.squares = (np.zeros(tile, np.int64) for _ in range(2))
        self.columns = np.zeros((tile[0], shape[1]), np.int64)
        self.rows = np.zeros((shape[0], tile[1]), np.int64)

    def add(self, a: Integer[Array, "n w"], b: Integer[Array, "n w"], first_row: int) -> None:
        """Add the rows from ``first_row`` on.

        Parameters
        ----------
        a, b
            Rows of a frame and of the next one. [DN]
        first_row
            Number of the first of these rows in the frame.
        """
        tile = self.totals.shape
        sums = (self.totals, self.squares, self.columns, self.rows)
        _add_pair(a, b, first_row, *tile, *sums)


@kernel()
@no_type_check
def add_plane(rows, first, step, total):
    """Add every ``step``-th value from ``first`` on of rows (n, w) to ``total`` (n, m)."""
    for y in range(total.shape[0]):
        row, into = rows[y], total[y]
        if step == 1:
            for i in range(into.size):
                into[i] += row[i]
        elif step == 2:
            for i in range(into.size):
                into[i] += row[2 * i + first]
        else:
            for i in range(into.size):
                into[i] += row[i * step + first]


@kernel(error_model="numpy")
@no_type_check
def difference_rests(a, b):
    """Difference of integers (p, m, n) without the means of its rows and columns (f4)."""
    planes, rows, columns = a.shape
    rests, by_row = np.empty(a.shape, np.float32), np.empty(rows)
    for p in range(planes):
        by_column = np.zeros(columns, np.int64)
        for y in range(rows):
            row_a, row_b = a[p, y], b[p, y]
            total = np.int64(0)
            for x in range(columns):
                difference = np.int64(row_a[x]) - np.int64(row_b[x])
                by_column[x] += difference
                total += difference
            by_row[y] = total / columns
        of_columns = by_column / rows - by_column.sum() / (rows * columns)
        for y in range(rows):
            row_a, row_b, rest = a[p, y], b[p, y], rests[p, y]
            for x in range(columns):
                difference = np.float64(np.int64(row_a[x]) - np.int64(row_b[x]))
                rest[x] = (difference - by_row[y]) - of_columns[x]
    return rests


@kernel(error_model="numpy")
@no_type_check
def product_sum(u, v, down, right):
    """Sum of u[y, x] v[y + down, x + right] (f4) over all places that both have, by columns."""
    rows, columns = u.shape[0] - down, u.shape[1] - right
    sums = np.zeros(columns)
    for y in range(rows):
        row_u, row_v = u[y], v[y + down][right:]
        for x in range(columns):
            sums[x] += np.float64(row_u[x]) * np.float64(row_v[x])
    return sums.sum()


_WIDE, _WIDER = 7, 11
SMOOTHED = _WIDE + _WIDER + 1
"""Number of rows and columns of the smoothing of EMVA 1288: 7 and 11 wide, a binomial of 3. [px]"""
_WEIGHT = float((4 * _WIDE * _WIDER) ** 2)  # all weights of the smoothing together


@kernel()
@no_type_check
def _add_high_passed(image, sums, squares):
    """Add, by column, the high-passed image times its `_WEIGHT`, and the square of that."""
    height, width = image.shape
    inner, border = width - SMOOTHED + 1, SMOOTHED // 2
    wide, wider = np.zeros(width, np.int64), np.zeros(width, np.int64)
    before, last = np.zeros((_WIDER, width), np.int64), np.zeros((3, width), np.int64)
    down, along = np.empty(width, np.int64), np.empty(width, np.int64)
    along_wider, zeros = np.empty(width, np.int64), np.zeros(width, image.dtype)
    for y in range(height):  # running sums down the columns
        row, gone = image[y], image[y - _WIDE] if y >= _WIDE else zeros
        older, newest = before[y % _WIDER], last[y % 3]
        for x in range(width):
            value = wide[x] + (np.int64(row[x]) - np.int64(gone[x]))
            wide[x] = value
            wider[x] += value - older[x]
            older[x] = value
            newest[x] = wider[x]
        if y < SMOOTHED - 1:
            continue
        middle, oldest = last[(y - 1) % 3], last[(y - 2) % 3]
        for x in range(width):
            down[x] = newest[x] + 2 * middle[x] + oldest[x]
        _running_sums(down, _WIDE, along)
        _running_sums(along, _WIDER, along_wider)
        center = image[y - border]
        for x in range(inner):
            smooth = along_wider[x] + 2 * along_wider[x + 1] + along_wider[x + 2]
            high = _WEIGHT * np.float64(center[x + border]) - np.float64(smooth)
            sums[x] += high
            squares[x] += high * high


@njit(inline="always")
@no_type_check
def _running_sums(values, wide, found):
    """Sums of ``wide`` values from each place on, where so many follow."""
    total = np.int64(0)
    for x in range(wide - 1):
        total += values[x]
    for x in range(values.size - wide + 1):
        total += values[x + wide - 1]
        found[x] = total
        total -= values[x]


def high_passed_variance(image: Integer[Array, "h w"]) -> tuple[float, tuple[int, int]]:
    """Variance of an image minus its smoothed copy, without the borders; its rows and columns.

    Parameters
    ----------
    image
        Integers below 2^36; at least `SMOOTHED` rows and columns.

    Notes
    -----
    The smoothing is that of EMVA 1288, release 4.0, by running sums. Sums of integers below 2^53
    are exact in float64.
    """
    inner = (image.shape[0] - SMOOTHED + 1, image.shape[1] - SMOOTHED + 1)
    sums, squares = np.zeros(inner[1]), np.zeros(inner[1])
    _add_high_passed(np.ascontiguousarray(image), sums, squares)
    count = inner[0] * inner[1]
    variance = (squares.sum() - sums.sum() ** 2 / count) / (count - 1)
    return max(float(variance), 0.0) / _WEIGHT**2, inner


@kernel()
@no_type_check
def _add_counts(image, least, counts):
    for y in range(image.shape[0]):
        for value in image[y]:
            counts[np.int64(value) - least] += 1


_MOST_BINS = 1 << 22


def value_counts(
    image: Integer[Array, "h w"],
) -> tuple[Integer[Array, "values"], Integer[Array, "values"]]:
    """The different values of an image, in increasing order, and how many pixels have each.

    Parameters
    ----------
    image
        Integers.
    """
    least = int(image.min())
    bins = int(image.max()) - least + 1
    if bins > _MOST_BINS:
        return np.unique(image, return_counts=True)
    counts = np.zeros(bins, np.int64)
    _add_counts(image, least, counts)
    found = np.flatnonzero(counts)
    return found + least, counts[found]
