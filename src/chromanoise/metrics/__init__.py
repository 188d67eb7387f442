"""Metrics: SNR, optimal linear SNR, loss, budgets, color error, filter quality, speed, bits.

Of pictures: color difference, S-CIELAB, PSNR, SSIM, edge sharpness, false color, noise on flats.
"""

from typing import TYPE_CHECKING

from chromanoise.base.lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.metrics.accuracy import (
        MatrixReport as MatrixReport,
        Metamerism as Metamerism,
        balanced_charts as balanced_charts,
        balanced_truth as balanced_truth,
        chart_ciede2000 as chart_ciede2000,
        chart_color_error as chart_color_error,
        chart_lab as chart_lab,
        effective_filters as effective_filters,
        matrix_report as matrix_report,
        mean_chart_errors,
        metamerism as metamerism,
        sensor_metamerism as sensor_metamerism,
        truth_lab,
    )
    from chromanoise.metrics.budget import (
        CONTRAVARIANT,
        Budget as Budget,
        BudgetRequest as BudgetRequest,
        Cost as Cost,
        budgets_of as budgets_of,
        color_budget as color_budget,
        contravariant_budget as contravariant_budget,
        faintest_change as faintest_change,
        lab_budget as lab_budget,
        without_infrared,
    )
    from chromanoise.metrics.distinguishable_colors import (
        distinguishable_colors_bits as distinguishable_colors_bits,
    )
    from chromanoise.metrics.fidelity import (
        OPPONENT_FROM_XYZ,
        EdgeLine as EdgeLine,
        EdgeResponse as EdgeResponse,
        FalseColor as FalseColor,
        LabDifference as LabDifference,
        PictureQuality as PictureQuality,
        edge_line as edge_line,
        false_color as false_color,
        flat_noise_sd as flat_noise_sd,
        near_edges as near_edges,
        picture_color_difference as picture_color_difference,
        picture_quality as picture_quality,
        psnr_db as psnr_db,
        scielab_difference as scielab_difference,
        scielab_filtered as scielab_filtered,
        scielab_shares,
        slanted_edge_response as slanted_edge_response,
        structural_similarity as structural_similarity,
    )
    from chromanoise.metrics.filter_merit import (
        best_readout as best_readout,
        figure_of_merit as figure_of_merit,
        filter_quality as filter_quality,
        perceptual_weight as perceptual_weight,
        principal_angles_deg as principal_angles_deg,
        readout_error as readout_error,
        second_moment as second_moment,
        vora_value as vora_value,
    )
    from chromanoise.metrics.separation import (
        contrast_detection_probability as contrast_detection_probability,
        exact_contrast_detection_probability as exact_contrast_detection_probability,
        exact_separation_probability as exact_separation_probability,
        gaussian_pair_probabilities as gaussian_pair_probabilities,
        gaussian_separation_probability as gaussian_separation_probability,
        independent_coordinates as independent_coordinates,
        mahalanobis_distance as mahalanobis_distance,
        pair_distances as pair_distances,
        separation_probability as separation_probability,
    )
    from chromanoise.metrics.shapley import shapley_values as shapley_values
    from chromanoise.metrics.snr import (
        LEAST_COLOR,
        color_sensitivity_bits as color_sensitivity_bits,
        color_snr_loss_db as color_snr_loss_db,
        information_bits as information_bits,
        optimal_linear_snr_db as optimal_linear_snr_db,
        signal_snr_db as signal_snr_db,
        snr_db as snr_db,
        tonal_levels as tonal_levels,
        tonal_range_bits as tonal_range_bits,
    )
    from chromanoise.metrics.snr_chain import CORRELATION, FILTERS, INFRARED, REST, WEIGHTS
    from chromanoise.metrics.speed import (
        ISO_12232_2019 as ISO_12232_2019,
        NoiseSpeedModel as NoiseSpeedModel,
        illuminance_for_snr as illuminance_for_snr,
        illuminance_for_snr_adapted as illuminance_for_snr_adapted,
        light_for_snr as light_for_snr,
        noise_speed as noise_speed,
    )
    from chromanoise.metrics.visual_noise import (
        ISO_15739_2017 as ISO_15739_2017,
        VisualNoise as VisualNoise,
        VisualNoiseModel as VisualNoiseModel,
        contrast_sensitivity as contrast_sensitivity,
        pixels_per_degree as pixels_per_degree,
        viewed_covariance as viewed_covariance,
        visual_noise_from_spectrum as visual_noise_from_spectrum,
        visual_noise_of_picture as visual_noise_of_picture,
        visual_noise_of_white as visual_noise_of_white,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
