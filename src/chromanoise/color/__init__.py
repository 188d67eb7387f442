"""From electrons to color: matrices (eq. 6), XYZ with covariance (eq. 5), spaces, sRGB."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names
from chromanoise.color.cubatures import Cubature as Cubature
from chromanoise.color.cubatures import cubature as cubature
from chromanoise.color.cubatures import gaussian_cubature as gaussian_cubature
from chromanoise.color.cubatures import gaussian_expectation as gaussian_expectation
from chromanoise.color.cubatures import mean_ciede2000 as mean_ciede2000
from chromanoise.color.differences import balanced_cielab as balanced_cielab
from chromanoise.color.differences import cie1976_difference as cie1976_difference
from chromanoise.color.differences import ciede2000_difference as ciede2000_difference
from chromanoise.color.exact_moments import exact as exact
from chromanoise.color.exact_moments import exact_where_needed as exact_where_needed
from chromanoise.color.exact_moments import normal_fails as normal_fails
from chromanoise.color.fitted import ParetoCurve as ParetoCurve
from chromanoise.color.fitted import kernel as kernel
from chromanoise.color.fitted import least_squares as least_squares
from chromanoise.color.fitted import lmmse as lmmse
from chromanoise.color.fitted import lmmse_over_light as lmmse_over_light
from chromanoise.color.fitted import noise_regularized as noise_regularized
from chromanoise.color.fitted import pareto as pareto
from chromanoise.color.fitted import ridge as ridge
from chromanoise.color.fitted import training_color_error as training_color_error
from chromanoise.color.fitted import white_preserving as white_preserving
from chromanoise.color.linearized import first_order as first_order
from chromanoise.color.matrices import ColorMatrix as ColorMatrix
from chromanoise.color.matrices import colored as colored
from chromanoise.color.matrices import kernel_matrix as kernel_matrix
from chromanoise.color.matrices import scene_xyz as scene_xyz
from chromanoise.color.noise_gain import bounded_psi as bounded_psi
from chromanoise.color.noise_gain import noise_gain as noise_gain
from chromanoise.color.noise_gain import white_normalized as white_normalized
from chromanoise.color.noisy_colors import UNBOUNDED as UNBOUNDED
from chromanoise.color.noisy_colors import ElectronSource as ElectronSource
from chromanoise.color.noisy_colors import NoisyColor as NoisyColor
from chromanoise.color.noisy_colors import noisy_color as noisy_color
from chromanoise.color.picture import adapted_to_d65 as adapted_to_d65
from chromanoise.color.picture import srgb_from_linear as srgb_from_linear
from chromanoise.color.picture import srgb_from_xyz as srgb_from_xyz
from chromanoise.color.pipeline import LUMA_WEIGHTS as LUMA_WEIGHTS
from chromanoise.color.pipeline import TONES as TONES
from chromanoise.color.pipeline import ToneCurve as ToneCurve
from chromanoise.color.pipeline import black_subtracted as black_subtracted
from chromanoise.color.pipeline import checked_gains as checked_gains
from chromanoise.color.pipeline import encoded as encoded
from chromanoise.color.pipeline import encoded_space as encoded_space
from chromanoise.color.pipeline import gains_covariance as gains_covariance
from chromanoise.color.pipeline import gray_gains as gray_gains
from chromanoise.color.pipeline import luma_chroma as luma_chroma
from chromanoise.color.pipeline import luma_chroma_matrix as luma_chroma_matrix
from chromanoise.color.pipeline import matrix_for_balanced as matrix_for_balanced
from chromanoise.color.pipeline import reference_channel as reference_channel
from chromanoise.color.pipeline import rendered_lab_space as rendered_lab_space
from chromanoise.color.pipeline import rendering_matrix as rendering_matrix
from chromanoise.color.pipeline import saturation_matrix as saturation_matrix
from chromanoise.color.pipeline import tone_curve as tone_curve
from chromanoise.color.pipeline import white_balanced as white_balanced
from chromanoise.color.pipeline import with_exposure_gain as with_exposure_gain
from chromanoise.color.pipeline import with_saturation as with_saturation
from chromanoise.color.propagation import FIRST_ORDER_TOLERANCE as FIRST_ORDER_TOLERANCE
from chromanoise.color.propagation import ColorNoise as ColorNoise
from chromanoise.color.propagation import Method as Method
from chromanoise.color.propagation import SpaceMoments as SpaceMoments
from chromanoise.color.propagation import propagate as propagate
from chromanoise.color.propagation import relative_sd_error as relative_sd_error
from chromanoise.color.spaces import LAB as LAB
from chromanoise.color.spaces import LINEAR_SRGB as LINEAR_SRGB
from chromanoise.color.spaces import LUV as LUV
from chromanoise.color.spaces import SPACES as SPACES
from chromanoise.color.spaces import SRGB as SRGB
from chromanoise.color.spaces import XYY as XYY
from chromanoise.color.spaces import Space as Space
from chromanoise.color.spaces import cielab as cielab
from chromanoise.color.spaces import cieluv as cieluv
from chromanoise.color.spaces import encoded_srgb as encoded_srgb
from chromanoise.color.spaces import linear_srgb as linear_srgb
from chromanoise.color.spaces import xyy as xyy
from chromanoise.color.training import Training as Training
from chromanoise.color.training import TrainingResponse as TrainingResponse
from chromanoise.color.training import chart_training as chart_training
from chromanoise.color.training import light_second_moment as light_second_moment
from chromanoise.color.training import nir_diverse as nir_diverse
from chromanoise.color.training import smooth_training as smooth_training
from chromanoise.color.training import training_response as training_response

if TYPE_CHECKING:
    from chromanoise.color.root_polynomial_matrix import RootPolynomial as RootPolynomial
    from chromanoise.color.root_polynomial_matrix import (
        root_first_order_error as root_first_order_error,
    )
    from chromanoise.color.root_polynomial_matrix import root_jacobian as root_jacobian
    from chromanoise.color.root_polynomial_matrix import root_polynomial as root_polynomial
    from chromanoise.color.root_polynomial_matrix import (
        root_polynomial_bias as root_polynomial_bias,
    )
    from chromanoise.color.root_polynomial_matrix import (
        root_polynomial_color as root_polynomial_color,
    )
    from chromanoise.color.root_polynomial_matrix import (
        root_polynomial_color_exact as root_polynomial_color_exact,
    )

__getattr__, __dir__ = lazy_names(__name__)
