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


def _codes(*blocks: Integer[Array, "..."]) -> list[Integer[Array, "..."]]:
    """Contiguous codes of one of the two types for which the kernels are compiled."""
    kind = np.uint16 if all(block.dtype == np.uint16 for block in blocks) else np.int64
    return [np.ascontiguousarray(block, kind) for block in blocks]


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

    __slots__ = ("_scratch", "columns", "rows", "squares", "totals")

    def __init__(self, shape: tuple[int, int], tile: tuple[int, int]) -> None:
        self.totals = np.zeros(tile, np.int64)
        self.squares: Array = np.zeros(tile, np.int64)
        self.columns: Array = np.zeros((tile[0], shape[1]), np.int64)
        self.rows: Array = np.zeros((shape[0], tile[1]), np.int64)
        narrow = (np.zeros((tile[0], shape[1] // 2), np.int32) for _ in range(2))
        self._scratch = (*narrow, np.zeros(6, np.int64))

    def add(self, a: Integer[Array, "n w"], b: Integer[Array, "n w"], first_row: int) -> None:
        """Add the rows from ``first_row`` on.

        Parameters
        ----------
        a, b
            Rows of a frame and of the next one. [DN]
        first_row
            Number of the first of these rows in the frame.
        """
        a, b = _codes(a, b)
        for start in range(0, a.shape[0], _MOST_ROWS):
            part = slice(start, start + _MOST_ROWS)
            self._add(a[part], b[part], first_row + start)

    def _add(self, a: Integer[Array, "n w"], b: Integer[Array, "n w"], first_row: int) -> None:
        tile, (height, width) = self.totals.shape, a.shape
        rows = self.rows[first_row : first_row + height]
        sums = (self.totals, self.squares, self.columns, rows)
        if a.dtype == np.uint16 and width % 2 == 0 and tile[1] in (1, 2, 4, 6) and _LOW_FIRST:
            a, b = a.view(np.uint32), b.view(np.uint32)
            _add_word_pair(a, b, height, width // 2, first_row, *tile, *sums, *self._scratch)
        else:
            _add_pair(a, b, height, width, first_row, *tile, *sums)


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


def add_plane(
    block: Integer[Array, "n w"], number: int, tile: tuple[int, int], total: Array
) -> None:
    """Add a plane of whole periods of the mosaic to ``total``, from its first row on.

    Parameters
    ----------
    block
        Rows of a frame. [DN]
    number
        Of the plane, in the order of the pixels of a period.
    total
        Changed in place. [DN]
    """
    (block,) = _codes(block)
    (y, x), stored = divmod(number, tile[1]), block.shape[1]
    _add_plane(block, y * stored + x, tile[1], total, *total.shape, tile[0] * stored)


def difference_rests(
    a: Integer[Array, "p m n"], b: Integer[Array, "p m n"]
) -> Float[Array, "p m n"]:
    """Difference of integers without the means of its rows and columns (float32). [DN]

    Parameters
    ----------
    a, b
        Codes. [DN]
    """
    a, b = _codes(a, b)
    rests = np.empty(a.shape, np.float32)
    scratch = (np.empty(a.shape[1]), np.empty(a.shape[2], np.int64), np.empty(a.shape[2]))
    _difference_rests(a, b, *a.shape, rests, *scratch)
    return rests


def neighbor_products(
    rests: Float[Array, "p m n"],
) -> tuple[Float[Array, "p p"], Float[Array, " p"], Float[Array, " p"]]:
    """Sums of products of each pair of planes, and of neighbors in rows and in columns.

    Parameters
    ----------
    rests
        In float32.
    """
    planes, _, columns = rests.shape
    sums = [np.zeros((planes, planes, columns)), np.zeros((planes, columns - 1))]
    sums += [np.zeros((planes, columns))]
    _add_products(rests, *rests.shape, *sums)
    products, right, down = (one.sum(axis=-1) for one in sums)
    return np.tril(products) + np.tril(products, -1).T, right, down


WIDE, WIDER = 7, 11
SMOOTHED = WIDE + WIDER + 1
"""Number of rows and columns of the smoothing of EMVA 1288: 7 and 11 wide, a binomial of 3. [px]"""
WEIGHT = float((4 * WIDE * WIDER) ** 2)  # all weights of the smoothing together


_MOST_BINS = 1 << 22
_MOST_TABLES = 16  # of blocks, before they are merged


class PatternSums:
    """Histogram and high-passed variance of a picture that is read in blocks of rows.

    Parameters
    ----------
    shape
        Rows and columns of the picture. [px]
    kind
        Type of its integers, which are below 2^36.
    border
        Rows and columns at each side that are not in the inner part: half of `SMOOTHED` for a
        picture that is high-passed; else 0.
    """

    def __init__(self, shape: tuple[int, int], kind: np.dtype, border: int) -> None:
        self._shape, self._border, self._first = shape, border, 0
        self._rows: Array = np.zeros((border, shape[1]), kind)
        self._counts: list[Array] = []
        self._sums = np.zeros((2, shape[1] - 2 * border))
        self._scratch = [np.zeros((rows, shape[1]), np.int64) for rows in (WIDER, 3, 1, 1, 1, 1)]

    def zeros(self, rows: int) -> Integer[Array, "rows w"]:
        """The next rows of the picture, in which the caller sums frames before `add`."""
        before = self._rows[len(self._rows) - self._border :]
        self._rows = np.zeros((self._border + rows, self._shape[1]), before.dtype)
        self._rows[: self._border] = before
        return self._rows[self._border :]

    def add(self) -> None:
        """Add the rows that `zeros` returned."""
        border, first, rows = self._border, self._first, self._rows[self._border :]
        if border:
            where = (self._first, *rows.shape)
            _add_high_passed(self._rows, *where, *self._sums, *self._scratch)
        self._first += len(rows)
        least = int(rows.min())
        bins = int(rows.max()) - least + 1
        if bins > _MOST_BINS:
            values, places = np.unique(rows, return_inverse=True)
            rows, least, bins = places.reshape(rows.shape), 0, values.size
        else:
            values = np.arange(least, least + bins)
        counts = np.zeros((2, bins), np.int64)
        inner = (border - first, self._shape[0] - border - first)
        _add_counts(rows, *rows.shape, *inner, border, least, counts, bins)
        counts[0] += counts[1]
        self._counts.append(np.vstack([values, counts])[:, counts[0] > 0])
        if len(self._counts) == _MOST_TABLES:
            self._counts = [self.counts]

    @property
    def counts(self) -> Integer[Array, "3 values"]:
        """The different values in increasing order; how many pixels, and inner ones, have each."""
        found, *counts = np.hstack(self._counts)
        values, places = np.unique(found, return_inverse=True)
        every = (np.bincount(places, own).astype(np.int64) for own in counts)
        return np.stack([values, *every])

    @property
    def high_passed(self) -> tuple[float, tuple[int, int]]:
        """Variance of the picture minus its smoothed copy, without the borders; rows and columns.

        Notes
        -----
        The smoothing is that of EMVA 1288, release 4.0, by running sums. Sums of integers below
        2^53 are exact in float64.
        """
        inner = (self._shape[0] - 2 * self._border, self._shape[1] - 2 * self._border)
        count, (total, squares) = inner[0] * inner[1], self._sums.sum(axis=1)
        variance = (squares - total**2 / count) / (count - 1)
        return max(float(variance), 0.0) / WEIGHT**2, inner
