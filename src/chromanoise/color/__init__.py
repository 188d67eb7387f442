"""From electrons to color: matrices (eq. 6), XYZ with covariance (eq. 5), spaces, sRGB."""

from chromanoise.color.chromaticity import XYY, xyy
from chromanoise.color.cubatures import (
    Cubature,
    cubature,
    gaussian_cubature,
    gaussian_expectation,
    mean_ciede2000,
)
from chromanoise.color.differences import (
    balanced_cielab,
    cie1976_difference,
)
from chromanoise.color.exact import (
    exact,
)
from chromanoise.color.first_order import (
    first_order,
)
from chromanoise.color.exact_moments import (
    exact,
)
from chromanoise.color.fitted import (
    ParetoCurve,
    kernel,
    least_squares,
    lmmse,
    lmmse_over_light,
    noise_regularized,
    pareto,
    ridge,
    training_color_error,
    white_preserving,
)
from chromanoise.color.linearized import first_order
from chromanoise.color.matrices import ColorMatrix, colored, kernel_matrix, scene_xyz
from chromanoise.color.noise_gain import bounded_psi, noise_gain, white_normalized
from chromanoise.color.noisy_colors import UNBOUNDED, ElectronSource, NoisyColor, noisy_color
from chromanoise.color.picture import adapted_to_d65, srgb_from_linear, srgb_from_xyz
from chromanoise.color.propagation import (
    FIRST_ORDER_TOLERANCE,
    ColorNoise,
    Method,
    SpaceMoments,
    propagate,
    relative_sd_error,
)
from chromanoise.color.root_polynomial import (
    RootPolynomial,
    root_first_order_error,
    root_jacobian,
    root_polynomial,
    root_polynomial_bias,
    root_polynomial_color,
    root_polynomial_color_exact,
)
from chromanoise.color.spaces import (
    LAB,
    LINEAR_SRGB,
    LUV,
    SPACES,
    SRGB,
    Space,
    cielab,
    cieluv,
    encoded_srgb,
    linear_srgb,
)
from chromanoise.color.training import (
    Training,
    TrainingResponse,
    chart_training,
    light_second_moment,
    nir_diverse,
    smooth_training,
    training_response,
)

__all__ = [
    "FIRST_ORDER_TOLERANCE",
    "LAB",
    "LINEAR_SRGB",
    "LUV",
    "SPACES",
    "SRGB",
    "UNBOUNDED",
    "XYY",
    "ColorMatrix",
    "ColorNoise",
    "Cubature",
    "ElectronSource",
    "Method",
    "NoisyColor",
    "ParetoCurve",
    "RootPolynomial",
    "Space",
    "SpaceMoments",
    "Training",
    "TrainingResponse",
    "adapted_to_d65",
    "balanced_cielab",
    "bounded_psi",
    "chart_training",
    "cie1976_difference",
    "cielab",
    "cieluv",
    "colored",
    "cubature",
    "encoded_srgb",
    "exact",
    "first_order",
    "gaussian_cubature",
    "gaussian_expectation",
    "kernel",
    "kernel_matrix",
    "least_squares",
    "light_second_moment",
    "linear_srgb",
    "lmmse",
    "lmmse_over_light",
    "mean_ciede2000",
    "nir_diverse",
    "noise_gain",
    "noise_regularized",
    "noisy_color",
    "pareto",
    "propagate",
    "relative_sd_error",
    "ridge",
    "root_first_order_error",
    "root_jacobian",
    "root_polynomial",
    "root_polynomial_bias",
    "root_polynomial_color",
    "root_polynomial_color_exact",
    "scene_xyz",
    "smooth_training",
    "srgb_from_linear",
    "srgb_from_xyz",
    "training_color_error",
    "training_response",
    "white_normalized",
    "white_preserving",
    "xyy",
]
