# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Counts per row for the summary of an image: expected electrons, and pixels above full well.

Sums are float64 and split into many partial sums, because additions to one sum depend on each
other. Partial sums restart with every tile of a row, so results are bit-identical for any choice of
blocks and threads.
"""

from typing import no_type_check

import numpy as np

from chromanoise.imaging.kernel_cache import kernel

STRANDS = 64
"""At most, if the columns of a mosaic do not repeat later."""

_ZERO = np.float32(0.0)


@kernel(error_model="numpy")
@no_type_check
def strands_for(period):
    """Strands of a row whose channels repeat after ``period`` pixels: a whole number of periods."""
    return np.empty(max(STRANDS // period, 1) * period)


@kernel(error_model="numpy")
@no_type_check
def total_means(mean, strands):
    """Sum of the means of one channel."""
    _fill_strands(mean, strands)
    total = 0.0
    for k in range(min(strands.size, mean.size)):
        total += strands[k]
    return total


@kernel(error_model="numpy")
@no_type_check
def count_means(mean, channel, strands, counts):
    """Add the means of pixels to those of the channel over each: counts (3, p)."""
    _fill_strands(mean, strands)
    for k in range(min(strands.size, mean.size)):
        counts[0, channel[k]] += strands[k]


@kernel(error_model="numpy")
@no_type_check
def _fill_strands(mean, strands):
    """Strand k: the sum of values k, k + size, k + 2 size ..."""
    for k in range(strands.size):
        strands[k] = 0.0
    for first in range(0, mean.size, strands.size):
        here = mean[first : first + strands.size]
        for k in range(here.size):
            strands[k] += here[k]


@kernel(error_model="numpy")
@no_type_check
def _count_above(electrons, most_e):
    """How many exceed full well; counted in 32 bits, as wide as the electrons, to vectorize."""
    above = np.int32(0)
    for i in range(electrons.size):
        above = np.int32(above + np.int32(electrons[i] > most_e))
    return above


@kernel(error_model="numpy")
@no_type_check
def hold_at_well(electrons, n, p, well, counts):
    """Count what lies above full well, and clip it to 0 and full well."""
    most_e, held = well
    for c in range(p):
        counts[1, c] += _count_above(electrons[c * n : (c + 1) * n], most_e)
    if held:
        for j in range(n * p):
            electrons[j] = min(max(electrons[j], _ZERO), most_e)
