# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Eq. 5 for a run of pixels: electrons to XYZ and to sRGB codes, one channel after the other.

Functions without annotations are compiled, serial, and release the GIL.
"""

from typing import no_type_check

import numpy as np

from chromanoise.imaging.blocks import RUN
from chromanoise.imaging.kernel_cache import kernel
from chromanoise.imaging.layout import three_together
from chromanoise.imaging.simd import fused

ENCODED = 16384
"""Number of entries in the table of sRGB codes."""

_F = np.float32
_ZERO, _ONE, _HALF = _F(0.0), _F(1.0), _F(0.5)


@kernel(error_model="numpy")
@no_type_check
def colors_of_run(electrons, n, p, matrices, table, colors, entry, xyz, srgb):
    """Eq. 5 for a run, channel after channel; sRGB codes are looked up.

    colors f4 and entry i4 have room for three values of each pixel.
    """
    _products(electrons, n, p, matrices[:3], colors)
    three_together(colors[:n], colors[n : 2 * n], colors[2 * n : 3 * n], xyz.reshape(-1))
    _products(electrons, n, p, matrices[3:], colors)
    _entries(colors[: 3 * n], entry[: 3 * n])
    _codes(table, entry[:n], entry[n : 2 * n], entry[2 * n : 3 * n], srgb)


@kernel(error_model="numpy")
@no_type_check
def _products(electrons, n, p, rows, colors):
    """Three rows of a matrix times the channels: colors (3 * n,), one color after the other."""
    odd = p % 2
    for k in range(3):
        color, row = colors[k * n : (k + 1) * n], rows[k]
        if odd:
            _weighted(electrons[:n], row[0], color)
        else:
            _weighted_pair(electrons[:n], electrons[n : 2 * n], row[0], row[1], color)
        for c in range(2 - odd, p, 2):
            here, next_one = electrons[c * n : (c + 1) * n], electrons[(c + 1) * n : (c + 2) * n]
            _add_weighted_pair(here, next_one, row[c], row[c + 1], color)


@kernel(error_model="numpy")
@no_type_check
def _weighted(values, weight, out):
    for i in range(out.size):
        out[i] = values[i] * weight


@kernel(error_model="numpy")
@no_type_check
def _weighted_pair(values, others, weight, other, out):
    for i in range(out.size):
        out[i] = fused(others[i], other, values[i] * weight)


@kernel(error_model="numpy")
@no_type_check
def _add_weighted_pair(values, others, weight, other, out):
    for i in range(out.size):
        out[i] = fused(others[i], other, fused(values[i], weight, out[i]))


@kernel(error_model="numpy")
@no_type_check
def _codes(table, first, second, third, srgb):
    for i in range(first.size):
        srgb[i, 0] = table[np.uint32(first[i])]
        srgb[i, 1] = table[np.uint32(second[i])]
        srgb[i, 2] = table[np.uint32(third[i])]


@kernel(error_model="numpy")
@no_type_check
def color_of_electrons(electrons, matrices, table, xyz, srgb):
    """Eq. 5 for rows of electrons (rows, columns, p): xyz and srgb as `color_rows`."""
    rows, columns, p = electrons.shape
    run = np.empty(RUN * p, np.float32)
    colors, entry = np.empty(3 * RUN, np.float32), np.empty(3 * RUN, np.int32)
    for row in range(rows):
        for first in range(0, columns, RUN):
            n = min(RUN, columns - first)
            for i in range(n):
                for c in range(p):
                    run[c * n + i] = electrons[row, first + i, c]
            colors_of_run(
                run, n, p, matrices, table, colors, entry, xyz[row, first:], srgb[row, first:]
            )


@kernel(error_model="numpy")
@no_type_check
def _entries(screen, entry):
    """Where in the table of codes a linear value stands; held to 0 .. 1."""
    for i in range(screen.size):
        within = screen[i] if screen[i] > _ZERO else _ZERO  # also for NaN
        within = within if within < _ONE else _ONE
        entry[i] = np.int32(within * _F(ENCODED - 1) + _HALF)
