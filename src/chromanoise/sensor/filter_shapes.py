"""Transmittances of filters that can be made, as pure functions of the grid and few numbers.

Each number may be one, or one per candidate (m,); the result has the shape (n,) or (m, n). All are
analytic functions of their numbers, so that complex numbers give exact derivatives by the complex
step. Each transmittance is a mean or a product of values within 0 to 1, with weights within 0 to 1.
"""

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Inexact
from chromanoise.sensor.filters import LEAST_LENGTH_NM, Number, logistic, per_candidate
from chromanoise.spectra import Grid

LEAK_EDGE_NM = 24.0
"""Logistic scale with which a dye becomes transparent again, as that of `resin_filter`. [nm]"""


def gaussian_filter(
    grid: Grid,
    *,
    center_nm: Number,
    width_nm: Number,
    peak: Number = 1.0,
    floor: Number = 0.0,
    infrared_leak: Number = 0.0,
    leak_nm: Number = 800.0,
) -> Inexact[Array, "*m n"]:
    """Transmittance of a passband with the shape of a Gaussian, with the infrared leak of a dye.

    Parameters
    ----------
    center_nm
        Wavelength of the peak. [nm]
    width_nm
        Standard deviation; the full width at half maximum is 2.3548 times as much. [nm]
    peak, floor
        Transmittance at the peak and far from it. [1]
    infrared_leak
        Share of the light that the band stops and that passes in the infrared. [1]
    leak_nm
        Wavelength above which it passes. [nm]

    Raises
    ------
    InputError
        If a transmittance is not 0 to 1, or a length is not positive.

    Examples
    --------
    >>> green = gaussian_filter(Grid.uniform(500, 600, 50), center_nm=550, width_nm=50, peak=0.8)
    >>> green.round(3)                                      # exp(-1/2) = 0.607 on both sides
    array([0.485, 0.8  , 0.485])
    """
    center = per_candidate("center_nm", "nm", center_nm)
    width = per_candidate("width_nm", "nm", width_nm, least=LEAST_LENGTH_NM)
    away = (grid.wavelength_nm - center) / width
    return _leaking(grid, np.exp(-0.5 * away * away), peak, floor, infrared_leak, leak_nm)


def _leaking(
    grid: Grid,
    shape: Inexact[Array, "*m n"],
    peak: Number,
    floor: Number,
    infrared_leak: Number,
    leak_nm: Number,
) -> Inexact[Array, "*m n"]:
    """A passband of a shape within 0 to 1, between floor and peak, with its infrared leak."""
    bottom = per_candidate("floor", "1", floor, most=1.0)
    band = bottom + (per_candidate("peak", "1", peak, most=1.0) - bottom) * shape
    leak = per_candidate("infrared_leak", "1", infrared_leak, most=1.0)
    if not leak.any():
        return band
    start = per_candidate("leak_nm", "nm", leak_nm)
    return band + (1.0 - band) * leak * logistic(grid.wavelength_nm, start, LEAK_EDGE_NM)
