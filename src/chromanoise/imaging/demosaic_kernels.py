# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Linear demosaicing of a block of rows, compiled.

The columns of the tile are separated first, so that each filter is applied along contiguous memory.
Each sum adds its pixels in the order of the filter's rows for any block of rows, so results are
bit-identical for any blocks and threads. Functions without annotations are compiled, serial, and
release the GIL.
"""

from typing import no_type_check

import numpy as np

from chromanoise.imaging.kernel_cache import inner, kernel


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


@inner
@no_type_check
def _apart(surrounded, tx):
    """Each row with the columns of one place of the tile together: (rows, tx, columns / tx)."""
    rows, columns = surrounded.shape
    apart = np.zeros((rows, tx, (columns + tx - 1) // tx), np.float32)
    for row in range(rows):
        for x in range(columns):
            apart[row, x % tx, x // tx] = surrounded[row, x]
    return apart


@inner
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
