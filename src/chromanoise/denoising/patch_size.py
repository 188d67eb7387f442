"""Size of the patches, for `patches` and its kernels."""

SIDE = 4
"""Rows and columns of a patch. [pixels]"""
PLACES = SIDE * SIDE
