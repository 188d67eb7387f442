"""From electrons to color: matrices (eq. 6), XYZ with covariance (eq. 5), sRGB."""

from chromanoise.color.matrices import ColorMatrix, colored, kernel_matrix
from chromanoise.color.picture import adapted_to_d65, srgb_from_xyz

__all__ = ["ColorMatrix", "adapted_to_d65", "colored", "kernel_matrix", "srgb_from_xyz"]
