"""From electrons to color: matrices (eq. 6), XYZ with covariance (eq. 5), spaces, sRGB."""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.color.color_moments import (
        Cubature as Cubature,
        cubature as cubature,
        exact as exact,
        exact_where_needed as exact_where_needed,
        first_order as first_order,
        gaussian_cubature as gaussian_cubature,
        gaussian_expectation as gaussian_expectation,
        mean_ciede2000 as mean_ciede2000,
        normal_fails as normal_fails,
    )
    from chromanoise.color.matrices import (
        XYZ,
        ColorMatrix as ColorMatrix,
        ParetoCurve as ParetoCurve,
        bounded_psi as bounded_psi,
        colored as colored,
        kernel as kernel,
        kernel_matrix as kernel_matrix,
        least_squares as least_squares,
        lmmse as lmmse,
        lmmse_over_light as lmmse_over_light,
        noise_gain as noise_gain,
        noise_regularized as noise_regularized,
        pareto as pareto,
        penalized_matrix,
        ridge as ridge,
        scene_xyz as scene_xyz,
        training_color_error as training_color_error,
        white_normalized as white_normalized,
        white_preserving as white_preserving,
    )
    from chromanoise.color.noise_aware_matrices import (
        NoiseAwareFamily as NoiseAwareFamily,
        noise_aware as noise_aware,
        noise_aware_over_light as noise_aware_over_light,
    )
    from chromanoise.color.noise_in_spaces import (
        FIRST_ORDER_TOLERANCE as FIRST_ORDER_TOLERANCE,
        UNBOUNDED as UNBOUNDED,
        ColorNoise as ColorNoise,
        ElectronSource as ElectronSource,
        Method as Method,
        NoisyColor as NoisyColor,
        SpaceMoments as SpaceMoments,
        noisy_color as noisy_color,
        propagate as propagate,
        relative_sd_error as relative_sd_error,
    )
    from chromanoise.color.pipeline import (
        LUMA_WEIGHTS as LUMA_WEIGHTS,
        RGB,
        TONES as TONES,
        LumaStandard,
        ToneCurve as ToneCurve,
        black_subtracted as black_subtracted,
        checked_gains as checked_gains,
        encoded as encoded,
        encoded_space as encoded_space,
        gains_covariance as gains_covariance,
        gray_gains as gray_gains,
        luma_chroma as luma_chroma,
        luma_chroma_matrix as luma_chroma_matrix,
        matrix_for_balanced as matrix_for_balanced,
        reference_channel as reference_channel,
        rendered_lab_space as rendered_lab_space,
        rendering_matrix as rendering_matrix,
        saturation_matrix as saturation_matrix,
        tone_curve as tone_curve,
        white_balanced as white_balanced,
        with_exposure_gain as with_exposure_gain,
        with_saturation as with_saturation,
    )
    from chromanoise.color.root_polynomials import (
        RootPolynomial as RootPolynomial,
        root_first_order_error as root_first_order_error,
        root_jacobian as root_jacobian,
        root_polynomial as root_polynomial,
        root_polynomial_bias as root_polynomial_bias,
        root_polynomial_color as root_polynomial_color,
        root_polynomial_color_exact as root_polynomial_color_exact,
    )
    from chromanoise.color.spaces import (
        D65_WHITE,
        LAB as LAB,
        LAB_FROM_CUBE_ROOTS,
        LINEAR_SRGB as LINEAR_SRGB,
        LUV as LUV,
        SPACES as SPACES,
        SRGB as SRGB,
        XYY as XYY,
        Space as Space,
        adapted_to_d65 as adapted_to_d65,
        balanced_cielab as balanced_cielab,
        cie1976_difference as cie1976_difference,
        ciede2000_difference as ciede2000_difference,
        cielab as cielab,
        cieluv as cieluv,
        cube_root_slope,
        encoded_srgb as encoded_srgb,
        linear_srgb as linear_srgb,
        srgb_from_linear as srgb_from_linear,
        srgb_from_xyz as srgb_from_xyz,
        xyy as xyy,
    )
    from chromanoise.color.training import (
        Training as Training,
        TrainingResponse as TrainingResponse,
        chart_training as chart_training,
        light_second_moment as light_second_moment,
        nir_diverse as nir_diverse,
        shares,
        smooth_training as smooth_training,
        training_response as training_response,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
