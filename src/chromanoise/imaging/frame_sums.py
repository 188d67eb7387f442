"""Exact sums over raw frames: of differences, and of what a high-pass filter leaves.

All sums of codes are integers, so their order changes no digit. The kernels are loaded without
numba, because its start takes longer than the sums over 100 frames.
"""

import sys

import numpy as np

from chromanoise.base import Array, Float, Integer
from chromanoise.imaging.kernel_cache import stored_kernel

_KERNELS = "chromanoise.imaging.frame_kernels"
_add_pair = stored_kernel(_KERNELS, "add_pair")
_add_word_pair = stored_kernel(_KERNELS, "add_word_pair")
_add_plane = stored_kernel(_KERNELS, "add_plane")
_difference_rests = stored_kernel(_KERNELS, "difference_rests")
_add_products = stored_kernel(_KERNELS, "add_products")
_add_high_passed = stored_kernel(_KERNELS, "add_high_passed")
_add_counts = stored_kernel(_KERNELS, "add_counts")

_MOST_ROWS = 1 << 15  # of codes of 16 bits, whose sums have 32 bits
_LOW_FIRST = sys.byteorder == "little"


def _codes(block: Integer[Array, "..."]) -> Integer[Array, "..."]:
    """Contiguous codes of one of the two types for which the kernels are compiled."""
    return np.ascontiguousarray(block, np.uint16 if block.dtype == np.uint16 else np.int64)


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
        self.totals = np.zeros(tile, np.int64)
        self.squares: Array = np.zeros(tile, np.int64)
        self.columns: Array = np.zeros((tile[0], shape[1]), np.int64)
        self.rows: Array = np.zeros((shape[0], tile[1]), np.int64)

    def add(self, a: Integer[Array, "n w"], b: Integer[Array, "n w"], first_row: int) -> None:
        """Add the rows from ``first_row`` on.

        Parameters
        ----------
        a, b
            Rows of a frame and of the next one. [DN]
        first_row
            Number of the first of these rows in the frame.
        """
        kind = np.result_type(a, b)
        a, b = (_codes(block.astype(kind, copy=False)) for block in (a, b))
        for start in range(0, a.shape[0], _MOST_ROWS):
            part = slice(start, start + _MOST_ROWS)
            self._add(a[part], b[part], first_row + start)

    def _add(self, a: Integer[Array, "n w"], b: Integer[Array, "n w"], first_row: int) -> None:
        tile, (height, width) = self.totals.shape, a.shape
        rows = self.rows[first_row : first_row + height]
        sums = (self.totals, self.squares)
        if not (a.dtype == np.uint16 and width % 2 == 0 and tile[1] in (1, 2, 4, 6) and _LOW_FIRST):
            _add_pair(a, b, height, width, first_row, *tile, *sums, self.columns, rows)
            return
        of_columns = [np.zeros((tile[0], width // 2), np.int32) for _ in range(2)]
        pair = (one.view(np.uint32) for one in (a, b))
        _add_word_pair(
            *pair,
            height,
            width // 2,
            first_row,
            *tile,
            *sums,
            *of_columns,
            rows,
            np.zeros(6, np.int64),
        )
        for half, part in enumerate(of_columns):
            self.columns[:, half::2] += part


SIGNAL_BINS = 2048
"""Steps of the signal by which `ScaledPairSums` sorts pixels: below the shot noise of 10^6 e-."""


class ScaledPairSums(PairSums):
    """`PairSums` of the difference g a - h b, with its own factors g and h for each plane.

    Attributes
    ----------
    factors
        g and h: (2, ty, tx). [1]
    counts, sums
        Number of pixels and sum of their differences, by the mean of the two codes in
        `SIGNAL_BINS` equal steps from 0 to ``top``, and beyond: (ty, tx, bins). [1], [DN]
    """

    __slots__ = ("counts", "factors", "sums", "top")

    def __init__(
        self,
        shape: tuple[int, int],
        tile: tuple[int, int],
        factors: Float[Array, "2 ty tx"],
        top: int,
    ) -> None:
        super().__init__(shape, tile)
        self.factors, self.top = factors, max(top, 1)
        self.counts: Array = np.zeros((*tile, SIGNAL_BINS + 1), np.int64)
        self.sums: Array = np.zeros((*tile, SIGNAL_BINS + 1))
        self.squares = np.zeros(self.squares.shape)
        self.columns, self.rows = np.zeros(self.columns.shape), np.zeros(self.rows.shape)

    def add(self, a: Integer[Array, "n w"], b: Integer[Array, "n w"], first_row: int) -> None:
        """As `PairSums.add`; ``first_row`` is that of a whole period of the tile."""
        height, width = self.totals.shape
        for y in range(height):
            for x in range(width):
                (g, h), one, other = (
                    self.factors[:, y, x],
                    a[y::height, x::width],
                    b[y::height, x::width],
                )
                difference = g * one - h * other
                both = one.astype(np.int64) + other
                bins = np.clip(both * SIGNAL_BINS // (2 * self.top), 0, SIGNAL_BINS).ravel()
                self.counts[y, x] += np.bincount(bins, minlength=SIGNAL_BINS + 1)
                self.sums[y, x] += np.bincount(
                    bins, weights=difference.ravel(), minlength=SIGNAL_BINS + 1
                )
                self.totals[y, x] += int(one.sum(dtype=np.int64))
                self.squares[y, x] += np.vdot(difference, difference)
                self.columns[y, x::width] += difference.sum(axis=0)
                self.rows[first_row + y : first_row + a.shape[0] : height, x] = difference.sum(
                    axis=1
                )


def add_plane(rows: Integer[Array, "n w"], first: int, step: int, total: Array) -> None:
    """Add every ``step``-th value from ``first`` on of rows to ``total`` (n, m).

    Parameters
    ----------
    rows
        Codes; (n, w). [DN]
    first, step
        The first column, and the distance of the columns. [px]
    total
        Changed in place. [DN]
    """
    rows = _codes(rows)
    _add_plane(rows, first, step, total, *total.shape, rows.shape[1])


def difference_rests(
    a: Integer[Array, "p m n"], b: Integer[Array, "p m n"]
) -> Float[Array, "p m n"]:
    """Difference of integers without the means of its rows and columns (float32). [DN]

    Parameters
    ----------
    a, b
        Codes. [DN]
    """
    kind = np.result_type(a, b)
    a, b = (_codes(part.astype(kind, copy=False)) for part in (a, b))
    rests = np.empty(a.shape, np.float32)
    scratch = (np.empty(a.shape[1]), np.empty(a.shape[2], np.int64), np.empty(a.shape[2]))
    _difference_rests(a, b, *a.shape, rests, *scratch)
    return rests


def product_sum(u: Float[Array, "m n"], v: Float[Array, "m n"], down: int, right: int) -> float:
    """Sum of u[y, x] v[y + down, x + right] over all places that both have, by columns.

    Parameters
    ----------
    u, v
        In float32.
    down, right
        At least 0. [px]
    """
    sums = np.zeros(u.shape[1] - right)
    _add_products(u, v, *u.shape, down, right, sums)
    return float(sums.sum())


WIDE, WIDER = 7, 11
SMOOTHED = WIDE + WIDER + 1
"""Number of rows and columns of the smoothing of EMVA 1288: 7 and 11 wide, a binomial of 3. [px]"""
WEIGHT = float((4 * WIDE * WIDER) ** 2)  # all weights of the smoothing together


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
    scratch = [np.zeros((rows, image.shape[1]), np.int64) for rows in (WIDER, 3, 1, 1, 1, 2)]
    _add_high_passed(np.ascontiguousarray(image), *image.shape, sums, squares, *scratch)
    count = inner[0] * inner[1]
    variance = (squares.sum() - sums.sum() ** 2 / count) / (count - 1)
    return max(float(variance), 0.0) / WEIGHT**2, inner


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
    _add_counts(np.ascontiguousarray(image), image.size, least, counts)
    found = np.flatnonzero(counts)
    return found + least, counts[found]
