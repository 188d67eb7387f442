"""From electrons to color: matrices (eq. 6), XYZ with covariance (eq. 5), spaces, sRGB."""

from chromanoise.color.fitted import (
    ParetoCurve,
    least_squares,
    lmmse,
    noise_regularized,
    pareto,
    ridge,
    white_preserving,
)
from chromanoise.color.matrices import ColorMatrix, colored, kernel_matrix
from chromanoise.color.noise_gain import bounded_psi, noise_gain, white_normalized
from chromanoise.color.picture import adapted_to_d65, srgb_from_xyz
from chromanoise.color.training import Training, chart_training, nir_diverse, smooth_training

__all__ = [
    "ColorMatrix",
    "ParetoCurve",
    "Training",
    "adapted_to_d65",
    "bounded_psi",
    "chart_training",
    "colored",
    "kernel_matrix",
    "least_squares",
    "lmmse",
    "nir_diverse",
    "noise_gain",
    "noise_regularized",
    "pareto",
    "ridge",
    "smooth_training",
    "srgb_from_xyz",
    "white_normalized",
    "white_preserving",
]
