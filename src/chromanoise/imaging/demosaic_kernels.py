# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Linear demosaicing of a block of rows, compiled.

The columns of the tile are separated first, so that each filter is applied along contiguous memory.
Each sum adds its pixels in the order of the filter's rows for any block of rows, so results are
bit-identical for any blocks and threads. Functions without annotations are compiled, serial, and
release the GIL.
"""

from dataclasses import dataclass
from typing import no_type_check

import numpy as np

from chromanoise.base import Array, Float32, Int, Num
from chromanoise.imaging.demosaic import FilterBank, border_pixels
from chromanoise.imaging.kernel_cache import kernel


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Taps:
    """The nonzero weights of a filter bank as one list.

    Attributes
    ----------
    starts
        Index of the first tap of each filter, and the end of the last filter.
    rows, columns
        Position of each tap in the window, from its upper left corner.
    weights
        Weight of each tap.
    radius
        Radius of the filters. [pixels]
    """

    starts: Int[Array, "ty tx p1"]
    rows: Int[Array, " taps"]
    columns: Int[Array, " taps"]
    weights: Float32[Array, " taps"]
    radius: int


def taps_of(bank: FilterBank) -> Taps:
    """The filter bank in the form that the kernel uses.

    Examples
    --------
    >>> from chromanoise.imaging.demosaic import bilinear_filters
    >>> from chromanoise.sensor import bayer
    >>> taps_of(bilinear_filters(bayer(), ("R", "G", "B"))).starts[0, 0]  # 1 + 4 + 4 pixels
    array([0, 1, 5, 9])
    """
    count = (bank.kernels != 0).sum(axis=(-2, -1))
    ends = np.cumsum(count).reshape(count.shape)
    starts = np.concatenate([ends[..., :1] - count[..., :1], ends], axis=-1)
    at = np.argwhere(bank.kernels != 0)
    return Taps(
        starts=starts.astype(np.int64),
        rows=at[:, 3].copy(),
        columns=at[:, 4].copy(),
        weights=bank.kernels[bank.kernels != 0].astype(np.float32),
        radius=bank.radius,
    )


def surrounded_rows(
    raw: Num[Array, "h w"], bank: FilterBank, start: int, stop: int
) -> Float32[Array, "rows w2"]:
    """Rows ``start`` to ``stop`` of a raw image, padded by the radius of the filters.

    The values are electrons or codes; float32 represents both.

    Raises
    ------
    InputError
        If the image is smaller than one tile of the mosaic.

    Examples
    --------
    >>> from chromanoise.imaging.demosaic import bilinear_filters
    >>> from chromanoise.sensor import bayer
    >>> surrounded_rows(np.array([[1.0, 2.0], [3.0, 4.0]]), bilinear_filters(bayer()), 1, 2)
    array([[2., 1., 2., 1.],
           [4., 3., 4., 3.],
           [2., 1., 2., 1.]], dtype=float32)
    """
    rows, columns = border_pixels(raw.shape, bank)
    return raw[rows[start : stop + 2 * bank.radius], columns].astype(np.float32)


def demosaicked_rows(
    surrounded: Float32[Array, "rows2 w2"], taps: Taps, first_row: int
) -> Float32[Array, "rows w p"]:
    """All channels of a block of rows, float32. [e-]

    Parameters
    ----------
    surrounded
        Result of `surrounded_rows`. [e-]
    taps
        Result of `taps_of`.
    first_row
        Row of the image at which the block starts; it determines the position in the tile.

    Examples
    --------
    >>> from chromanoise.imaging.demosaic import bilinear_filters
    >>> from chromanoise.sensor import bayer
    >>> bank, raw = bilinear_filters(bayer()), np.array([[10.0, 20.0], [20.0, 30.0]])
    >>> demosaicked_rows(surrounded_rows(raw, bank, 1, 2), taps_of(bank), 1)[0, 1]
    array([10., 20., 30.], dtype=float32)
    """
    rows, columns = (n - 2 * taps.radius for n in surrounded.shape)
    out = np.empty((rows, columns, taps.starts.shape[2] - 1), np.float32)
    demosaic_block(surrounded, taps.starts, taps.rows, taps.columns, taps.weights, first_row, out)
    return out


@kernel(error_model="numpy")
@no_type_check
def demosaic_block(surrounded, starts, tap_rows, tap_columns, weights, first_row, out):
    """Fill ``out`` (rows, columns, p) from the rows with their surroundings, both float32."""
    ty, tx = starts.shape[0], starts.shape[1]
    rows, columns, p = out.shape
    apart = _apart(surrounded, tx)
    sums = np.empty(columns // tx + 1, np.float32)
    for row in range(rows):
        for b in range(min(tx, columns)):
            count = (columns - b + tx - 1) // tx
            for c in range(p):
                first = starts[(first_row + row) % ty, b, c]
                last = starts[(first_row + row) % ty, b, c + 1]
                _sum_taps(apart, row, b, first, last, tap_rows, tap_columns, weights, sums, count)
                for i in range(count):
                    out[row, b + i * tx, c] = sums[i]


@kernel(error_model="numpy")
@no_type_check
def _apart(surrounded, tx):
    """Each row with the columns of one place of the tile together: (rows, tx, columns / tx)."""
    rows, columns = surrounded.shape
    apart = np.zeros((rows, tx, (columns + tx - 1) // tx), np.float32)
    for row in range(rows):
        for x in range(columns):
            apart[row, x % tx, x // tx] = surrounded[row, x]
    return apart


@kernel(error_model="numpy")
@no_type_check
def _sum_taps(apart, row, b, first, last, tap_rows, tap_columns, weights, sums, count):
    """One filter along a row, four taps a time: each sum still takes them one by one."""
    tx = apart.shape[1]
    for i in range(count):
        sums[i] = np.float32(0.0)
    t = first
    while t + 4 <= last:
        x0, x1 = b + tap_columns[t], b + tap_columns[t + 1]
        x2, x3 = b + tap_columns[t + 2], b + tap_columns[t + 3]
        row0 = apart[row + tap_rows[t], x0 % tx, x0 // tx :]
        row1 = apart[row + tap_rows[t + 1], x1 % tx, x1 // tx :]
        row2 = apart[row + tap_rows[t + 2], x2 % tx, x2 // tx :]
        row3 = apart[row + tap_rows[t + 3], x3 % tx, x3 // tx :]
        w0, w1, w2, w3 = weights[t], weights[t + 1], weights[t + 2], weights[t + 3]
        for i in range(count):
            total = sums[i] + w0 * row0[i]
            total = total + w1 * row1[i]
            total = total + w2 * row2[i]
            sums[i] = total + w3 * row3[i]
        t += 4
    while t < last:
        x0 = b + tap_columns[t]
        row0 = apart[row + tap_rows[t], x0 % tx, x0 // tx :]
        w0 = weights[t]
        for i in range(count):
            sums[i] = sums[i] + w0 * row0[i]
        t += 1
