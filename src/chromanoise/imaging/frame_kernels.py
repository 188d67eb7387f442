# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Loops of `frame_sums`, compiled by `stored_kernel`: pointers to contiguous arrays, and sizes.

All sums of codes are integers, so their order changes no digit. Codes of 16 bits are added in 32
bits wherever these sums cannot overflow, which is twice as fast as in 64.
"""

from typing import no_type_check

import numpy as np
from numba import njit

from chromanoise.imaging.frame_sums import SMOOTHED, WEIGHT, WIDE, WIDER

_CHUNK = 512  # values whose sum has 32 bits
_LARGE = 2048  # differences below it: the sum of 512 squares has 32 bits


@no_type_check
def add_pair(a, b, height, width, first_row, tile_y, tile_x, totals, squares, columns, rows):
    """totals, squares (tile_y, tile_x), columns (tile_y, width), rows (height, tile_x)."""
    for y in range(height):
        at, phase = y * width, (first_row + y) % tile_y
        for first in range(tile_x):
            total = whole = square = np.int64(0)
            for x in range(first, width, tile_x):
                code = np.int64(a[at + x])
                difference = code - np.int64(b[at + x])
                columns[phase * width + x] += difference
                total += code
                whole += difference
                square += difference * difference
            totals[phase * tile_x + first] += total
            squares[phase * tile_x + first] += square
            rows[y * tile_x + first] += whole


@njit(inline="always")
@no_type_check
def _differences(word_a, word_b):
    """Codes of a in the halves of a word, and their differences from those of b, in 32 bits."""
    low, high = np.int32(word_a & np.uint32(0xFFFF)), np.int32(word_a >> np.uint32(16))
    low_b, high_b = np.int32(word_b & np.uint32(0xFFFF)), np.int32(word_b >> np.uint32(16))
    return low, high, np.int32(low - low_b), np.int32(high - high_b)


@njit(inline="always")
@no_type_check
def _add_words(a, b, at, step, count, even, odd, into, sums):
    """Add the sums over every ``step``-th word from ``at`` on to ``sums``, and to the columns."""
    for start in range(0, count, _CHUNK):
        codes_low = codes_high = squares_low = squares_high = bits = np.uint32(0)
        whole_low = whole_high = np.int32(0)
        first, to, words = at + start * step, into + start * step, min(_CHUNK, count - start)
        for i in range(words):
            x = i * step
            code_low, code_high, low, high = _differences(a[first + x], b[first + x])
            even[to + x] = np.int32(even[to + x] + low)
            odd[to + x] = np.int32(odd[to + x] + high)
            codes_low = np.uint32(codes_low + np.uint32(code_low))
            codes_high = np.uint32(codes_high + np.uint32(code_high))
            whole_low, whole_high = np.int32(whole_low + low), np.int32(whole_high + high)
            squares_low = np.uint32(squares_low + np.uint32(np.int32(low * low)))
            squares_high = np.uint32(squares_high + np.uint32(np.int32(high * high)))
            sizes = (low ^ (low >> np.int32(31))) | (high ^ (high >> np.int32(31)))
            bits = np.uint32(bits | np.uint32(sizes))
        if bits >= _LARGE - 1:
            large_low = large_high = np.int64(0)
            for i in range(words):
                _, _, low, high = _differences(a[first + i * step], b[first + i * step])
                large_low += np.int64(low) * np.int64(low)
                large_high += np.int64(high) * np.int64(high)
            sums[4] += large_low
            sums[5] += large_high
        else:
            sums[4] += np.int64(squares_low)
            sums[5] += np.int64(squares_high)
        sums[0] += np.int64(codes_low)
        sums[1] += np.int64(codes_high)
        sums[2] += np.int64(whole_low)
        sums[3] += np.int64(whole_high)


@no_type_check
def add_word_pair(
    a, b, height, words, first_row, tile_y, tile_x, totals, squares, columns, rows, even, odd, sums
):
    """As `add_pair`; each word of 32 bits holds the codes of two columns, the first one low.

    ``tile_x`` is 1, 2, 4 or 6; even, odd (tile_y, words): zeros of int32; sums (6).
    """
    second = min(tile_x - 1, 1)
    for y in range(height):
        at, phase = y * words, (first_row + y) % tile_y
        for pair in range((tile_x + 1) // 2):
            for i in range(6):
                sums[i] = 0
            into = phase * words + pair
            if tile_x <= 2:
                _add_words(a, b, at, 1, words, even, odd, into, sums)
            elif tile_x == 4:
                _add_words(a, b, at + pair, 2, words // 2, even, odd, into, sums)
            else:
                _add_words(a, b, at + pair, 3, words // 3, even, odd, into, sums)
            for half in range(2):
                plane = 2 * pair + half * second
                totals[phase * tile_x + plane] += sums[half]
                rows[y * tile_x + plane] += sums[2 + half]
                squares[phase * tile_x + plane] += sums[4 + half]
    for i in range(tile_y * words):
        columns[2 * i] += np.int64(even[i])
        columns[2 * i + 1] += np.int64(odd[i])
        even[i] = odd[i] = 0


@no_type_check
def add_plane(codes, first, step, total, height, width, stored):
    """Add every ``step``-th value from ``first`` on, of rows ``stored`` apart, to ``total``."""
    for y in range(height):
        at, into = y * stored + first, y * width
        if step == 1:
            for i in range(width):
                total[into + i] += codes[at + i]
        elif step == 2:
            for i in range(width):
                total[into + i] += codes[at + 2 * i]
        else:
            for i in range(width):
                total[into + i] += codes[at + i * step]


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
def add_products(rests, planes, rows, columns, products, right, down):
    """Sums of products of rests (planes, rows, columns; f4) over the rows, by column.

    products (planes, planes, columns): of two planes, the second not after the first; right
    (planes, columns - 1), down (planes, columns): of neighbors in a plane.
    """
    size = rows * columns
    for i in range(planes):
        for j in range(i + 1):
            into = (i * planes + j) * columns
            for y in range(0, size, columns):
                _add_products(rests, i * size + y, j * size + y, columns, products, into)
        for at in range(i * size, (i + 1) * size, columns):
            _add_products(rests, at, at + 1, columns - 1, right, i * (columns - 1))
        for at in range(i * size, (i + 1) * size - columns, columns):
            _add_products(rests, at, at + columns, columns, down, i * columns)


@njit(inline="always")
@no_type_check
def _add_products(values, at, other, count, sums, into):
    for x in range(count):
        sums[into + x] += np.float64(values[at + x]) * np.float64(values[other + x])


@no_type_check
def add_high_passed(
    image, first, height, width, sums, squares, before, last, wide, wider, down, along
):
    """Add, by column, the high-passed image times its weight, and the square of that.

    ``image``: the 9 rows before the row number ``first``, and ``height`` rows from it on. Zeros of
    int64: ``before`` (11, width), ``last`` (3, width), ``wide``, ``wider``, ``down`` (width),
    ``along`` (2, width).
    """
    inner, border = width - SMOOTHED + 1, SMOOTHED // 2
    for y in range(first, first + height):  # running sums down the columns
        row, older, newest = (y - first + border) * width, y % WIDER * width, y % 3 * width
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
        for x in range(width - WIDE + 1):
            total = np.int64(0)
            for i in range(WIDE):
                total += down[x + i]
            along[x] = total
        for x in range(inner + 2):
            total = np.int64(0)
            for i in range(WIDER):
                total += along[x + i]
            down[x] = total
        center = row - border * width + border
        for x in range(inner):
            smooth = down[x] + 2 * down[x + 1] + down[x + 2]
            high = WEIGHT * np.float64(image[center + x]) - np.float64(smooth)
            sums[x] += high
            squares[x] += high * high


@no_type_check
def add_counts(image, height, width, first, last, border, least, counts, bins):
    """Add histograms that start at ``least`` to ``counts`` (2, bins): of border pixels, of others.

    Border pixels are outside the rows ``first`` to ``last``, or within ``border`` columns of an
    end.
    """
    for y in range(height):
        at, left = y * width, width
        if first <= y < last:
            left = border
        for x in range(left):
            counts[np.int64(image[at + x]) - least] += 1
        for x in range(left, width - border):
            counts[bins + np.int64(image[at + x]) - least] += 1
        for x in range(max(left, width - border), width):
            counts[np.int64(image[at + x]) - least] += 1
