"""True and measured colors of the patches of a chart, with noise."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis.analysis import Analysis, color_snr_db, of_white
from chromanoise.analysis.operating_point import noisy_color_at, stages_at
from chromanoise.charts.charted_study import saturation_sentence
from chromanoise.color import (
    LAB,
    ColorNoise,
    NoisyColor,
    Space,
    SpaceMoments,
    adapted_to_d65,
    cubature,
    gaussian_cubature,
    propagate,
    srgb_from_xyz,
)
from chromanoise.metrics import chart_color_error
from chromanoise.noise import Measurement
from chromanoise.spectra import chart_on


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Patches:
    """Color and noise of each patch, with the light and exposure of an analysis.

    Attributes
    ----------
    names
        Names of the patches.
    truth, xyz
        X, Y, Z for the observer, and measured by the sensor with covariance. [lx]
    true_white, white
        The same for a perfect white. [lx]
    color_error
        Color error without noise. [Delta E*ab]
    noise
        Noise in CIELAB, relative to the sensor's own white, for normally distributed noise.
    """

    names: tuple[str, ...]
    truth: Float[Array, "k 3"]
    true_white: Float[Array, " 3"]
    xyz: Measurement
    white: Float[Array, " 3"]
    color_error: Float[Array, " k"]
    noise: ColorNoise

    def __post_init__(self) -> None:
        _check.freeze(self, "truth", "true_white", "white", "color_error")


def quick_cubature(color: NoisyColor, space: Space) -> SpaceMoments:
    """The cubature with 384 points; its error is below 3e-3 of a standard deviation."""
    return cubature(color, space, rule=gaussian_cubature(radii=6, latitudes=4, longitudes=8))


@lru_cache(maxsize=8)
def patches_of(analysis: Analysis) -> Patches | None:
    """The patches for an analysis, cached; ``None`` where X, Y or Z of white is not above 0.

    The noise is averaged over the Gaussian by 384 points per patch, with errors below 3e-3 of a
    standard deviation. The exact distribution (`chromanoise.analysis.chart_noise`) takes seconds,
    and differs where a patch has only about ten electrons.
    """
    sensor, exposure, matrix = analysis.sensor, analysis.exposure, analysis.matrix
    lamp, white = analysis.scene.illuminant, of_white(analysis)
    errors = chart_color_error(sensor, matrix, exposure, lamp, analysis.chart)
    if errors is None or None in color_snr_db(white).values():
        return None
    chart = chart_on(sensor.grid, analysis.chart)
    at = stages_at(analysis.point, matrix, reflectance=chart.values.T, readout=analysis.readout)
    color = noisy_color_at(at, matrix.matrix @ white.expected_e)
    return Patches(
        names=chart.names,
        truth=at.truth_xyz,
        true_white=white.truth_xyz,
        xyz=color.xyz,
        white=color.white,
        color_error=errors,
        noise=propagate(color, LAB, quick_cubature),
    )


def why_no_patches(analysis: Analysis) -> str:
    """Why the chart of a sensor cannot be shown."""
    return saturation_sentence(analysis) or (
        f"{analysis.sensor.label}: the matrix gives no valid XYZ of the white under this light, so "
        "its chart has no colors; use another matrix or another light"
    )


def hex_colors(xyz: Float[Array, "k 3"], white: Float[Array, " 3"]) -> list[str]:
    """Hexadecimal sRGB codes of colors, with out-of-gamut colors clipped.

    Parameters
    ----------
    xyz, white
        Colors and white in the same unit; the white is adapted to that of the screen.

    Examples
    --------
    >>> hex_colors(np.array([[0.5, 0.5, 0.5], [0.0, 0.0, 0.0]]), np.full(3, 0.5))
    ['#ffffff', '#000000']
    """
    relative = adapted_to_d65(xyz / white[1], white / white[1])
    codes = np.rint(255 * srgb_from_xyz(relative)).astype(int)
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in codes.tolist()]
