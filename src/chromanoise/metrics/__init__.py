"""Metrics: SNR, optimal linear SNR, loss, budgets, color error, filter quality, speed, bits.

Of pictures: color difference, S-CIELAB, PSNR, SSIM, edge sharpness, false color, noise on flats.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names
from chromanoise.metrics.accuracy import chart_ciede2000, chart_color_error, chart_lab
from chromanoise.metrics.budget import (
    Budget,
    Cost,
    color_budget,
    contravariant_budget,
    faintest_change,
    lab_budget,
)
from chromanoise.metrics.contrast_detection import (
    contrast_detection_probability,
    exact_contrast_detection_probability,
)
from chromanoise.metrics.filters import (
    best_readout,
    figure_of_merit,
    filter_quality,
    perceptual_weight,
    principal_angles_deg,
    readout_error,
    second_moment,
    vora_value,
)
from chromanoise.metrics.information import information_bits
from chromanoise.metrics.matrix_report import MatrixReport, effective_filters, matrix_report
from chromanoise.metrics.separation import (
    exact_separation_probability,
    gaussian_pair_probabilities,
    gaussian_separation_probability,
    independent_coordinates,
    mahalanobis_distance,
    pair_distances,
    separation_probability,
)
from chromanoise.metrics.shapley import shapley_values
from chromanoise.metrics.smi import Metamerism, metamerism, sensor_metamerism
from chromanoise.metrics.snr import color_snr_loss_db, optimal_linear_snr_db, signal_snr_db, snr_db
from chromanoise.metrics.speed import (
    ISO_12232_2019,
    NoiseSpeedModel,
    illuminance_for_snr,
    illuminance_for_snr_adapted,
    light_for_snr,
    noise_speed,
)
from chromanoise.metrics.tonal import color_sensitivity_bits, tonal_levels, tonal_range_bits
from chromanoise.metrics.visual_noise import (
    ISO_15739_2017,
    VisualNoise,
    VisualNoiseModel,
    contrast_sensitivity,
    pixels_per_degree,
    visual_noise_from_spectrum,
    visual_noise_of_picture,
    visual_noise_of_white,
)

if TYPE_CHECKING:
    from chromanoise.metrics.edge_response import (
        EdgeLine,
        EdgeResponse,
        edge_line,
        slanted_edge_response,
    )
    from chromanoise.metrics.pictures import (
        FalseColor,
        LabDifference,
        PictureQuality,
        false_color,
        flat_noise_sd,
        near_edges,
        picture_color_difference,
        picture_quality,
        psnr_db,
        scielab_difference,
        scielab_filtered,
        structural_similarity,
    )

__all__ = [
    "ISO_12232_2019",
    "ISO_15739_2017",
    "Budget",
    "Cost",
    "EdgeLine",
    "EdgeResponse",
    "FalseColor",
    "LabDifference",
    "MatrixReport",
    "Metamerism",
    "NoiseSpeedModel",
    "PictureQuality",
    "VisualNoise",
    "VisualNoiseModel",
    "best_readout",
    "chart_ciede2000",
    "chart_color_error",
    "chart_lab",
    "color_budget",
    "color_sensitivity_bits",
    "color_snr_loss_db",
    "contrast_detection_probability",
    "contrast_sensitivity",
    "contravariant_budget",
    "edge_line",
    "effective_filters",
    "exact_contrast_detection_probability",
    "exact_separation_probability",
    "faintest_change",
    "false_color",
    "figure_of_merit",
    "filter_quality",
    "flat_noise_sd",
    "gaussian_pair_probabilities",
    "gaussian_separation_probability",
    "illuminance_for_snr",
    "illuminance_for_snr_adapted",
    "independent_coordinates",
    "information_bits",
    "lab_budget",
    "light_for_snr",
    "mahalanobis_distance",
    "matrix_report",
    "metamerism",
    "near_edges",
    "noise_speed",
    "optimal_linear_snr_db",
    "pair_distances",
    "perceptual_weight",
    "picture_color_difference",
    "picture_quality",
    "pixels_per_degree",
    "principal_angles_deg",
    "psnr_db",
    "readout_error",
    "scielab_difference",
    "scielab_filtered",
    "second_moment",
    "sensor_metamerism",
    "separation_probability",
    "shapley_values",
    "signal_snr_db",
    "slanted_edge_response",
    "snr_db",
    "structural_similarity",
    "tonal_levels",
    "tonal_range_bits",
    "visual_noise_from_spectrum",
    "visual_noise_of_picture",
    "visual_noise_of_white",
    "vora_value",
]
__getattr__, __dir__ = lazy_names(__name__)
