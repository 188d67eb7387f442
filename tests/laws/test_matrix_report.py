"""The report on a color matrix against cases done by hand, in a light that is far from flat."""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.color import kernel_matrix
from chromanoise.metrics import matrix_report
from chromanoise.noise import Exposure, expected_electrons
from chromanoise.spectra import DEFAULT_GRID, black_body, cie_1931, equal_energy, flat_field, light
from chromanoise.study import sensor_named
from strategies import sensor_of, white_channel

AT = DEFAULT_GRID.wavelength_nm
BEYOND = AT > 700
LAMP = black_body(DEFAULT_GRID, 3000.0)  # 61 wavelengths up to 700 nm, 70 beyond, ever brighter
EXPOSURE = Exposure(time_s=0.002)
LUX = 10.0
RGBW = sensor_named("onyx-rgbw", DEFAULT_GRID)


def report_of(matrix, sensor, lamp=LAMP):
    return matrix_report(matrix, sensor, EXPOSURE, lamp, level_lux=LUX)


def planck_photons(nm, kelvin):
    """Planck's law in photons, up to a factor."""
    return nm**-4.0 / np.expm1(1.438776877e7 / (nm * kelvin))


def white_of(sensor, lamp=LAMP):
    """Electrons of the white, and its X, Y, Z from plain sums over powers."""
    electrons = expected_electrons(flat_field(lamp, level_lux=LUX), sensor, EXPOSURE)
    return electrons, LUX * 683.002 * 5 * lamp.irradiance @ cie_1931(DEFAULT_GRID).values


def box(first_nm, last_nm, height):
    return np.where((first_nm <= AT) & (last_nm > AT), height, 0.0)


@pytest.fixture(scope="module")
def uneven():
    """Three boxes whose electrons in this light differ by more than twenty."""
    curves = (box(400, 480, 0.1), box(480, 600, 0.6), box(600, 1050, 0.8))
    return sensor_of(np.stack(curves, 1), grid=DEFAULT_GRID)


@pytest.mark.parametrize(
    ("normalized", "condition", "psi"),
    [
        # symmetric, eigenvalues 3, 1 and 1; rows of length sqrt(5), sqrt(5) and 1
        ([[2, -1, 0], [-1, 2, 0], [0, 0, 1]], 3.0, 2 * np.sqrt(5) + 1),
        # orthogonal rows of length 3, 6 and 1.5
        ([[2, 2, 1], [-4, 2, 4], [0.5, -1, 1]], 4.0, 10.5),
        (np.eye(3), 1.0, 3.0),
    ],
)
def test_condition_and_psi_are_those_of_the_matrix_from_balanced_raw_to_balanced_color(
    uneven, normalized, condition, psi
):
    white_e, white_xyz = white_of(uneven)
    assert white_e.max() > 20 * white_e.min()
    raw_to_color = white_xyz[:, None] * np.array(normalized) / white_e
    matrix = replace(kernel_matrix(uneven, EXPOSURE), matrix=raw_to_color)
    report = report_of(matrix, uneven)
    assert report.condition == pytest.approx(condition, rel=1e-9)
    assert report.psi == pytest.approx(psi, rel=1e-9)


@pytest.mark.parametrize("kelvin", [2000.0, 3000.0, 6500.0])
def test_a_gray_channel_makes_as_much_infrared_color_as_the_lamp_has_infrared_photons(kelvin):
    white = white_channel(grid=DEFAULT_GRID)
    photons = planck_photons(AT, kelvin)
    ratio = photons[BEYOND].sum() / photons[~BEYOND].sum()
    report = report_of(kernel_matrix(white, EXPOSURE), white, black_body(DEFAULT_GRID, kelvin))
    assert report.nir_color == pytest.approx(dict.fromkeys("XYZ", ratio), rel=1e-6)


def test_infrared_color_follows_the_lamp_and_the_norm_of_the_filters_does_not():
    """A gray channel has 70 wavelengths beyond 700 nm for 61 of the visible in any light."""
    white = white_channel(grid=DEFAULT_GRID)
    matrix = kernel_matrix(white, EXPOSURE)
    warm, flat = (report_of(matrix, white, lamp) for lamp in (LAMP, equal_energy(DEFAULT_GRID)))
    for report in (warm, flat):
        assert report.nir_norm == pytest.approx(dict.fromkeys("XYZ", np.sqrt(70 / 61)), rel=1e-9)
    # equal power has photons ~ wavelength: 61 wavelengths around 550 nm, 70 around 877.5
    assert flat.nir_color["Y"] == pytest.approx(70 * 877.5 / (61 * 550), rel=1e-9)
    assert warm.nir_color["Y"] > 2 * flat.nir_color["Y"]


@pytest.mark.parametrize("metric", ["quanta", "energy"])
@pytest.mark.parametrize("lamp", [LAMP, equal_energy(DEFAULT_GRID)], ids=["3000 K", "E"])
def test_infrared_color_is_that_of_two_whites_behind_filters(lamp, metric):
    """One passes all beyond 700 nm, the other all up to it; the ratio has its sign."""
    matrix = kernel_matrix(RGBW, EXPOSURE, metric)
    white = flat_field(lamp, level_lux=LUX)
    infrared, visible = (
        matrix.matrix @ expected_electrons(replace(white, reflectance=part), RGBW, EXPOSURE)
        for part in (1.0 * BEYOND, 1.0 * ~BEYOND)
    )
    report = report_of(matrix, RGBW, lamp)
    for i, coordinate in enumerate("XYZ"):
        assert report.nir_color[coordinate] == pytest.approx(infrared[i] / visible[i], rel=1e-9)


def test_the_planck_photons_of_this_page_are_those_of_the_lamp():
    photons = light(flat_field(LAMP, level_lux=LUX), "quanta")
    own = planck_photons(AT, 3000.0)
    np.testing.assert_allclose(photons / photons[31], own / own[31], rtol=1e-6)
