"""Results to matplotlib Axes: the ten figures of the paper, those of a study, and the main
chart of each result.

The folder ``draw`` holds the drawing modules of page and report: the same results to SVG.
"""

from chromanoise.figures.budget import draw_budget
from chromanoise.figures.characterization import (
    characterization_figures,
    draw_characterization,
    draw_linearity,
    draw_linearity_deviation,
    draw_photon_transfer,
    draw_predicted_variance,
    draw_snr,
    draw_variance_residuals,
)
from chromanoise.figures.comparison import draw_color_errors, draw_comparison
from chromanoise.figures.ellipses import draw_ellipses
from chromanoise.figures.flow import draw_flow
from chromanoise.figures.front import draw_front, draw_sensitivity, front_figure
from chromanoise.figures.geometry import (
    draw_color_projection,
    draw_color_uncertainty,
    draw_contravariant,
    draw_light_above_plane,
    draw_measurement,
    draw_uncertainty,
)
from chromanoise.figures.maps import draw_maps
from chromanoise.figures.paper import CAPTIONS, draw_mosaic, draw_observer, paper_figures
from chromanoise.figures.pareto import draw_pareto
from chromanoise.figures.results import (
    draw_analyses,
    draw_capture,
    draw_matrices,
    draw_panels,
    draw_picture,
)
from chromanoise.figures.sensitivities import draw_sensitivities
from chromanoise.figures.study import map_figures, study_figures
from chromanoise.figures.style import channel_color, chromanoise_style, sensor_lines
from chromanoise.figures.writing import write_figures

__all__ = [
    "CAPTIONS",
    "channel_color",
    "characterization_figures",
    "chromanoise_style",
    "draw_analyses",
    "draw_budget",
    "draw_capture",
    "draw_characterization",
    "draw_color_errors",
    "draw_color_projection",
    "draw_color_uncertainty",
    "draw_comparison",
    "draw_contravariant",
    "draw_ellipses",
    "draw_flow",
    "draw_front",
    "draw_light_above_plane",
    "draw_linearity",
    "draw_linearity_deviation",
    "draw_maps",
    "draw_matrices",
    "draw_measurement",
    "draw_mosaic",
    "draw_observer",
    "draw_panels",
    "draw_pareto",
    "draw_photon_transfer",
    "draw_picture",
    "draw_predicted_variance",
    "draw_sensitivities",
    "draw_sensitivity",
    "draw_snr",
    "draw_uncertainty",
    "draw_variance_residuals",
    "front_figure",
    "map_figures",
    "paper_figures",
    "sensor_lines",
    "study_figures",
    "write_figures",
]
