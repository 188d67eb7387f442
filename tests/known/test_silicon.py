"""Silicon against Green & Keevers, Prog. Photovolt. 3 (1995) 189-192 (300 K)."""

import numpy as np
import pytest

from chromanoise.sensor import silicon_qe
from chromanoise.spectra import Grid

SPOTS = {500: 1.11e4, 800: 850.0, 1000: 64.0}  # [1/cm]


def bare(grid, depth_um):
    """Nothing reflected, nothing lost at the surface: what depth alone absorbs."""
    return silicon_qe(grid, depth_um=depth_um, dead_layer_um=0.0, reflectance=0.0)


@pytest.mark.parametrize(("wavelength_nm", "per_cm"), SPOTS.items())
def test_a_layer_as_deep_as_the_absorption_length_takes_63_2_percent(wavelength_nm, per_cm):
    # 1 - 1/e of the photons within 1/alpha: 0.901 um, 11.8 um, 156 um
    grid = Grid.uniform(wavelength_nm, wavelength_nm + 10, 10)
    assert bare(grid, 1e4 / per_cm)[0] == pytest.approx(0.632121, rel=1e-5)


def test_three_microns_of_silicon_see_96_percent_of_green_and_2_percent_at_1_um():
    # 1 - exp(-1.11e4 * 3e-4) = 0.9642; 1 - exp(-64 * 3e-4) = 0.0190
    seen = bare(Grid.uniform(500, 1000, 500), 3.0)
    assert seen == pytest.approx([0.9642, 0.0190], abs=1e-4)


def test_half_the_light_lost_at_the_surface_is_half_the_electrons():
    grid = Grid.uniform(400, 1050, 10)
    mirrored = silicon_qe(grid, depth_um=4.0, dead_layer_um=0.0, reflectance=0.5)
    assert mirrored == pytest.approx(bare(grid, 4.0) / 2, rel=1e-12)


def test_a_dead_layer_steals_what_a_layer_of_its_depth_absorbs():
    # dead then live = the deeper photodiode less the shallow one
    grid = Grid.uniform(400, 1050, 10)
    live = silicon_qe(grid, depth_um=3.0, dead_layer_um=0.5, reflectance=0.0)
    assert live == pytest.approx(bare(grid, 3.5) - bare(grid, 0.5), abs=1e-12)


def test_between_two_tabulated_wavelengths_absorption_is_their_geometric_mean():
    # interpolated in its logarithm: 0.1 um is thin enough at 1000-1010 nm to be linear in alpha
    at = bare(Grid.uniform(1000, 1010, 5), 0.1)
    assert at[1] == pytest.approx(np.sqrt(at[0] * at[2]), rel=1e-4)
