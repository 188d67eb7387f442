# mypy: disable-error-code="no-untyped-def,no-untyped-call,misc"
"""Conversion of a run of pixels between interleaved channels and separate channel arrays.

Unsigned indices need no check for negative values, so the loops compile to shuffles of whole
vectors; with a loop over channels each number would be moved separately.
"""

from typing import no_type_check

import numpy as np

from chromanoise.imaging.kernel_cache import kernel

_1, _2, _3, _4 = np.uintp(1), np.uintp(2), np.uintp(3), np.uintp(4)


@kernel(error_model="numpy")
@no_type_check
def four_apart(pixels, a, b, c, d):
    """Pixels (4 n,), four numbers each, to four arrays (n,)."""
    for i in range(a.size):
        j = _4 * np.uintp(i)
        a[i] = pixels[j]
        b[i] = pixels[j + _1]
        c[i] = pixels[j + _2]
        d[i] = pixels[j + _3]


@kernel(error_model="numpy")
@no_type_check
def four_together(a, b, c, d, pixels):
    """Four arrays (n,) to pixels (4 n,), four numbers each."""
    for i in range(a.size):
        j = _4 * np.uintp(i)
        pixels[j] = a[i]
        pixels[j + _1] = b[i]
        pixels[j + _2] = c[i]
        pixels[j + _3] = d[i]


@kernel(error_model="numpy")
@no_type_check
def three_together(a, b, c, pixels):
    """Three arrays (n,) to pixels (3 n,), three numbers each."""
    for i in range(a.size):
        j = _3 * np.uintp(i)
        pixels[j] = a[i]
        pixels[j + _1] = b[i]
        pixels[j + _2] = c[i]
