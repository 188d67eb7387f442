"""Metrics: SNR, optimal linear SNR, loss, budgets, color error, filter quality, speed, bits.

Of pictures: color difference, S-CIELAB, PSNR, SSIM, edge sharpness, false color, noise on flats.
"""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names
from chromanoise.metrics.accuracy import chart_ciede2000 as chart_ciede2000
from chromanoise.metrics.accuracy import chart_color_error as chart_color_error
from chromanoise.metrics.accuracy import chart_lab as chart_lab
from chromanoise.metrics.budget import Budget as Budget
from chromanoise.metrics.budget import Cost as Cost
from chromanoise.metrics.budget import color_budget as color_budget
from chromanoise.metrics.budget import contravariant_budget as contravariant_budget
from chromanoise.metrics.budget import faintest_change as faintest_change
from chromanoise.metrics.budget import lab_budget as lab_budget
from chromanoise.metrics.contrast_detection import (
    contrast_detection_probability as contrast_detection_probability,
)
from chromanoise.metrics.contrast_detection import (
    exact_contrast_detection_probability as exact_contrast_detection_probability,
)
from chromanoise.metrics.filters import best_readout as best_readout
from chromanoise.metrics.filters import figure_of_merit as figure_of_merit
from chromanoise.metrics.filters import filter_quality as filter_quality
from chromanoise.metrics.filters import perceptual_weight as perceptual_weight
from chromanoise.metrics.filters import principal_angles_deg as principal_angles_deg
from chromanoise.metrics.filters import readout_error as readout_error
from chromanoise.metrics.filters import second_moment as second_moment
from chromanoise.metrics.filters import vora_value as vora_value
from chromanoise.metrics.information import information_bits as information_bits
from chromanoise.metrics.matrix_report import MatrixReport as MatrixReport
from chromanoise.metrics.matrix_report import effective_filters as effective_filters
from chromanoise.metrics.matrix_report import matrix_report as matrix_report
from chromanoise.metrics.separation import (
    exact_separation_probability as exact_separation_probability,
)
from chromanoise.metrics.separation import (
    gaussian_pair_probabilities as gaussian_pair_probabilities,
)
from chromanoise.metrics.separation import (
    gaussian_separation_probability as gaussian_separation_probability,
)
from chromanoise.metrics.separation import independent_coordinates as independent_coordinates
from chromanoise.metrics.separation import mahalanobis_distance as mahalanobis_distance
from chromanoise.metrics.separation import pair_distances as pair_distances
from chromanoise.metrics.separation import separation_probability as separation_probability
from chromanoise.metrics.shapley import shapley_values as shapley_values
from chromanoise.metrics.smi import Metamerism as Metamerism
from chromanoise.metrics.smi import metamerism as metamerism
from chromanoise.metrics.smi import sensor_metamerism as sensor_metamerism
from chromanoise.metrics.snr import color_snr_loss_db as color_snr_loss_db
from chromanoise.metrics.snr import optimal_linear_snr_db as optimal_linear_snr_db
from chromanoise.metrics.snr import signal_snr_db as signal_snr_db
from chromanoise.metrics.snr import snr_db as snr_db
from chromanoise.metrics.speed import ISO_12232_2019 as ISO_12232_2019
from chromanoise.metrics.speed import NoiseSpeedModel as NoiseSpeedModel
from chromanoise.metrics.speed import illuminance_for_snr as illuminance_for_snr
from chromanoise.metrics.speed import illuminance_for_snr_adapted as illuminance_for_snr_adapted
from chromanoise.metrics.speed import light_for_snr as light_for_snr
from chromanoise.metrics.speed import noise_speed as noise_speed
from chromanoise.metrics.tonal import color_sensitivity_bits as color_sensitivity_bits
from chromanoise.metrics.tonal import tonal_levels as tonal_levels
from chromanoise.metrics.tonal import tonal_range_bits as tonal_range_bits
from chromanoise.metrics.visual_noise import ISO_15739_2017 as ISO_15739_2017
from chromanoise.metrics.visual_noise import VisualNoise as VisualNoise
from chromanoise.metrics.visual_noise import VisualNoiseModel as VisualNoiseModel
from chromanoise.metrics.visual_noise import contrast_sensitivity as contrast_sensitivity
from chromanoise.metrics.visual_noise import pixels_per_degree as pixels_per_degree
from chromanoise.metrics.visual_noise import (
    visual_noise_from_spectrum as visual_noise_from_spectrum,
)
from chromanoise.metrics.visual_noise import visual_noise_of_picture as visual_noise_of_picture
from chromanoise.metrics.visual_noise import visual_noise_of_white as visual_noise_of_white

if TYPE_CHECKING:
    from chromanoise.metrics.edge_response import EdgeLine as EdgeLine
    from chromanoise.metrics.edge_response import EdgeResponse as EdgeResponse
    from chromanoise.metrics.edge_response import edge_line as edge_line
    from chromanoise.metrics.edge_response import slanted_edge_response as slanted_edge_response
    from chromanoise.metrics.pictures import FalseColor as FalseColor
    from chromanoise.metrics.pictures import LabDifference as LabDifference
    from chromanoise.metrics.pictures import PictureQuality as PictureQuality
    from chromanoise.metrics.pictures import false_color as false_color
    from chromanoise.metrics.pictures import flat_noise_sd as flat_noise_sd
    from chromanoise.metrics.pictures import near_edges as near_edges
    from chromanoise.metrics.pictures import picture_color_difference as picture_color_difference
    from chromanoise.metrics.pictures import picture_quality as picture_quality
    from chromanoise.metrics.pictures import psnr_db as psnr_db
    from chromanoise.metrics.pictures import scielab_difference as scielab_difference
    from chromanoise.metrics.pictures import scielab_filtered as scielab_filtered
    from chromanoise.metrics.pictures import structural_similarity as structural_similarity

__getattr__, __dir__ = lazy_names(__name__)
