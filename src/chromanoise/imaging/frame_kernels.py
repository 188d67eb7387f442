# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Loops of `frame_sums`, compiled by `stored_kernels`: pointers to contiguous arrays, and sizes.

All sums of codes are integers, so their order changes no digit. Codes of 16 bits are added in 32
bits wherever these sums cannot overflow, which is twice as fast as in 64.
"""

from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise.imaging.frame_sums import SMOOTHED, WEIGHT, WIDE, WIDER

_CHUNK = 512  # values: their sum has 32 bits, and that of their squares, if below the next number
_LARGE = 2048


@njit(inline="always")
@no_type_check
def _sums(a, b, at, step, count):
    """Sums of every ``step``-th value from ``at`` on: of a, of a - b, of its square."""
    total = whole = square = np.int64(0)
    for i in range(count):
        code = np.int64(a[at + i * step])
        difference = code - np.int64(b[at + i * step])
        total += code
        whole += difference
        square += difference * difference
    return total, whole, square


@njit(inline="always")
@no_type_check
def _sums_32(a, b, at, step, count):
    """As `_sums` of codes of 16 bits, in chunks that are added in 32 bits."""
    total = whole = square = np.int64(0)
    for start in range(0, count, _CHUNK):
        first, values = at + start * step, min(_CHUNK, count - start)
        code_sum = square_sum = bits = np.uint32(0)
        whole_sum = np.int32(0)
        for i in range(values):
            code = np.int32(a[first + i * step])
            difference = np.int32(code - np.int32(b[first + i * step]))
            size = np.uint32(abs(difference))
            code_sum = np.uint32(code_sum + np.uint32(code))
            whole_sum = np.int32(whole_sum + difference)
            square_sum = np.uint32(square_sum + np.uint32(size * size))
            bits = np.uint32(bits | size)
        if bits >= _LARGE:
            square += _sums(a, b, first, step, values)[2]
        else:
            square += np.int64(square_sum)
        total += np.int64(code_sum)
        whole += np.int64(whole_sum)
    return total, whole, square


@no_type_check
def add_pair(
    a, b, height, width, first_row, bits, tile_y, tile_x, totals, squares, columns, rows
):
    """totals, squares (tile_y, tile_x), columns (tile_y, width), rows (height, tile_x).

    The steps of common mosaics are constants, so that the loops vectorize.
    """
    for y in range(height):
        at, phase = y * width, (first_row + y) % tile_y
        into = phase * width
        for x in range(width):
            columns[into + x] += np.int64(a[at + x]) - np.int64(b[at + x])
        for first in range(tile_x):
            if bits == 16 and tile_x == 1:
                total, whole, square = _sums_32(a, b, at, 1, width)
            elif bits == 16 and tile_x == 2:
                total, whole, square = _sums_32(a, b, at + first, 2, width // 2)
            elif bits == 16 and tile_x == 4:
                total, whole, square = _sums_32(a, b, at + first, 4, width // 4)
            elif bits == 16 and tile_x == 6:
                total, whole, square = _sums_32(a, b, at + first, 6, width // 6)
            else:
                total, whole, square = _sums(a, b, at + first, tile_x, width // tile_x)
            totals[phase * tile_x + first] += total
            squares[phase * tile_x + first] += square
            rows[y * tile_x + first] = whole


@no_type_check
def add_plane(rows, first, step, total, height, width, stored):
    """Add every ``step``-th value from ``first`` on of rows (height, stored) to ``total``."""
    for y in range(height):
        at, into = y * stored + first, y * width
        if step == 1:
            for i in range(width):
                total[into + i] += rows[at + i]
        elif step == 2:
            for i in range(width):
                total[into + i] += rows[at + 2 * i]
        else:
            for i in range(width):
                total[into + i] += rows[at + i * step]


@no_type_check
def difference_rests(a, b, planes, rows, columns, rests, by_row, by_column, of_columns):
    """Difference of integers (p, m, n) without the means of its rows and columns (f4)."""
    for p in range(planes):
        for x in range(columns):
            by_column[x] = 0
        for y in range(rows):
            at = (p * rows + y) * columns
            total = np.int64(0)
            for x in range(columns):
                difference = np.int64(a[at + x]) - np.int64(b[at + x])
                by_column[x] += difference
                total += difference
            by_row[y] = total / columns
        whole = np.int64(0)
        for x in range(columns):
            whole += by_column[x]
        mean = whole / (rows * columns)
        for x in range(columns):
            of_columns[x] = by_column[x] / rows - mean
        for y in range(rows):
            at, of_row = (p * rows + y) * columns, by_row[y]
            for x in range(columns):
                difference = np.float64(np.int64(a[at + x]) - np.int64(b[at + x]))
                rests[at + x] = np.float32((difference - of_row) - of_columns[x])


@no_type_check
def add_products(u, v, rows, columns, down, right, sums):
    """Add u[y, x] v[y + down, x + right] (f4) over all places that both have, by columns."""
    for y in range(rows - down):
        at, other = y * columns, (y + down) * columns + right
        for x in range(columns - right):
            sums[x] += np.float64(u[at + x]) * np.float64(v[other + x])


@no_type_check
def add_high_passed(image, height, width, sums, squares, before, last, wide, wider, down, along):
    """Add, by column, the high-passed image times its weight, and the square of that.

    Zeros of int64: ``before`` (11, width), ``last`` (3, width), ``wide``, ``wider``, ``down``
    (width), ``along`` (2, width).
    """
    inner, border = width - SMOOTHED + 1, SMOOTHED // 2
    for y in range(height):  # running sums down the columns
        row, older, newest = y * width, y % WIDER * width, y % 3 * width
        for x in range(width):
            value = wide[x] + np.int64(image[row + x])
            if y >= WIDE:
                value -= np.int64(image[row - WIDE * width + x])
            wide[x] = value
            sum_wider = wider[x] + value - before[older + x]
            before[older + x] = value
            wider[x] = sum_wider
            last[newest + x] = sum_wider
        if y < SMOOTHED - 1:
            continue
        middle, oldest = (y - 1) % 3 * width, (y - 2) % 3 * width
        for x in range(width):
            down[x] = last[newest + x] + 2 * last[middle + x] + last[oldest + x]
        _running_sums(down, 0, width, WIDE, along, 0)
        _running_sums(along, 0, width - WIDE + 1, WIDER, along, width)
        center = (y - border) * width + border
        for x in range(inner):
            at = width + x
            smooth = along[at] + 2 * along[at + 1] + along[at + 2]
            high = WEIGHT * np.float64(image[center + x]) - np.float64(smooth)
            sums[x] += high
            squares[x] += high * high


@njit(inline="always")
@no_type_check
def _running_sums(values, at, count, wide, found, to):
    """Sums of ``wide`` values from each place on, where so many follow."""
    total = np.int64(0)
    for x in range(wide - 1):
        total += values[at + x]
    for x in range(count - wide + 1):
        total += values[at + x + wide - 1]
        found[to + x] = total
        total -= values[at + x]


@no_type_check
def add_counts(image, pixels, least, counts):
    """Add how many values of the image are ``least``, ``least + 1`` ... to ``counts``."""
    for i in range(pixels):
        counts[np.int64(image[i]) - least] += 1
