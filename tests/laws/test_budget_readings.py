"""What a budget says in words, counted by hand on a toy sensor of three channels.

Five wavelengths, no light at 750 nm, and an exposure with k = 1 in eq. 2, so that electrons are QE
times photons:

====== ====== ==== ==== ==== ================================
nm     light  b    g    r    color-matching functions x, y, z
====== ====== ==== ==== ==== ================================
450    200    .4             .3362, .0380, 1.7721
550    200         .4        .4334, .9950, .0087
650    300              .3   .2835, .1070, .0000
750
850    100    .3   .3   .4
====== ====== ==== ==== ==== ================================

All channels have length .5, and their cosines are .36 (b and g), .48 (b and r) and .48 (g and r).
"""

import numpy as np
import pytest

from chromanoise.color import kernel_matrix
from chromanoise.metrics import lab_budget
from chromanoise.metrics.budget import color_budget, contravariant_budget
from chromanoise.noise import Exposure
from chromanoise.sensor import Pixel, Sensor
from chromanoise.spectra import Grid, Illuminant, flat_field

GRID = Grid.uniform(450, 850, 100)
PHOTONS = np.array([200.0, 200.0, 300.0, 0.0, 100.0])
REFLECTANCE = 0.125  # the cube root is 1/2
EXPOSURE = Exposure(time_s=0.01, f_number=0.5)  # k = .01 s * 1 um2 * 100 nm / (4 * .5^2) = 1
QE = np.array([[0.4, 0, 0], [0, 0.4, 0], [0, 0, 0.3], [0, 0, 0], [0.3, 0.3, 0.4]])
READ_NOISE_E = 10.0

# CIE 1931, 450, 550 and 650 nm, as printed at 5 nm (CIE 015:2018, table 1); 0 from 831 nm on
EYE = np.array([[0.3362, 0.0380, 1.7721], [0.4334, 0.9950, 0.0087], [0.2835, 0.1070, 0.0]])
SEEN_NM = np.array([450.0, 550.0, 650.0])

# counted: .4 * 200 + .3 * 100, the same, .3 * 300 + .4 * 100; beyond 700 nm 30, 30 and 40
ELECTRONS = np.array([110.0, 110.0, 130.0])
VISIBLE_E = np.array([80.0, 80.0, 90.0])
VARIANCE = np.array([210.0, 210.0, 230.0])

# cofactors of the matrix of cosines over its determinant .575488: 1 - .48^2 = .7696,
# .48^2 - .36 = -.1296, .36 * .48 - .48 = -.3072, 1 - .36^2 = .8704
UNMIXING = (
    np.array([[0.7696, -0.1296, -0.3072], [-0.1296, 0.7696, -0.3072], [-0.3072, -0.3072, 0.8704]])
    / 0.575488
)


def toy(**more):
    pixel = Pixel(pitch_um=1.0, full_well_e=1e4, read_noise_e=READ_NOISE_E)
    return Sensor(name="toy", grid=GRID, qe=QE, names=("b", "g", "r"), pixel=pixel, **more)


def gray():
    at_m = GRID.wavelength_nm * 1e-9
    joule = 6.62607015e-34 * 299_792_458.0 / at_m
    lamp = Illuminant(name="toy", grid=GRID, irradiance=PHOTONS / REFLECTANCE * joule * 1e12)
    return flat_field(lamp, level_lux=1.0, reflectance=REFLECTANCE)


SENSOR, GRAY = toy(), gray()
MATRIX = kernel_matrix(SENSOR, EXPOSURE)


def readings(budget):
    return {cost.cause: cost.reading for cost in budget.costs}


def loss(budget, cause):
    return next(cost.cost_db for cost in budget.costs if cost.cause == cause)


def weights_by_hand():
    """h.f / |f|^2 per channel and color: only one wavelength that the eye sees in each."""
    return np.diag([0.4, 0.4, 0.3]) @ (EYE / SEEN_NM[:, None]) / 0.25


def test_the_six_readings_of_luminance_are_those_counted_by_hand():
    assert readings(color_budget(GRAY, SENSOR, EXPOSURE, MATRIX, "Y")) == {
        "filters": "15 % of the photons become electrons",  # 350 of 800 on each of 3 pixels
        # 100 e-^2 of (210 + 210 + 230) / 3
        "read noise": "46.2 % of the mean noise variance is readout",
        # y / lambda: weights ~ .0338, .7236, .0494, times sqrt(210), sqrt(210), sqrt(230)
        # .489, 10.49, .749; best 110 / sqrt(210), the same, 130 / sqrt(230)
        # 7.59, 7.59, 8.57; cos = 89.7 / (10.52 * 13.74) = .621
        "weights": "this color needs a channel mix 52 deg from the lowest-noise one",
        # .8704 / .575488 = 1.512; eigenvalues of the cosines 1.8823, .64 and .4777: root of 3.94
        "correlation": "unmixing multiplies r's own noise by 1.5 (VIF), condition 2.0, "
        "metric quanta",
        "infrared": "29 % of the electrons come from beyond 700 nm",  # 100 of 350
        # unmixed ~ -.0830, .5373, -.1897: 110, 110, 130 e- make 25.3, and 30, 30, 40 make 6.04
        "rest": "23.9 % of Y is infrared that the matrix lets through",
    }


@pytest.mark.parametrize("coordinate", "XYZ")
def test_the_share_of_infrared_is_what_the_unmixed_weights_make_of_its_electrons(coordinate):
    row = UNMIXING @ weights_by_hand()[:, "XYZ".index(coordinate)]
    share = 1 - (row @ VISIBLE_E) / (row @ ELECTRONS)
    result = readings(color_budget(GRAY, SENSOR, EXPOSURE, MATRIX, coordinate))["rest"]
    assert result == f"{100 * share:.1f} % of {coordinate} is infrared that the matrix lets through"


def test_the_angle_of_the_weights_is_what_they_cost_without_infrared_and_unmixing():
    """cos psi = SNR of the channels weighted one by one over the bound."""
    for i, coordinate in enumerate("XYZ"):
        own = weights_by_hand()[:, i]
        snr = own @ ELECTRONS / np.sqrt(own**2 @ VARIANCE)
        psi = np.degrees(np.arccos(snr / np.sqrt((ELECTRONS**2 / VARIANCE).sum())))
        result = readings(color_budget(GRAY, SENSOR, EXPOSURE, MATRIX, coordinate))["weights"]
        assert f" {psi:.0f} deg from the lowest-noise one" in result


def test_a_contravariant_budget_tells_the_channel_that_stands_alone():
    result = readings(contravariant_budget(GRAY, SENSOR, EXPOSURE, MATRIX.frame, "g"))
    assert result == {
        "filters": "15 % of the photons become electrons",
        "read noise": "46.2 % of the mean noise variance is readout",
        "weights": "g alone, of all 3 channels",
        "correlation": "unmixing multiplies r's own noise by 1.5 (VIF), condition 2.0, "
        "metric quanta",
        "rest": "nothing is left",
    }


def test_stacked_channels_share_the_photons_of_one_pixel():
    """800 photons instead of 2400, so that 350 electrons are 44 % of them."""
    apart = color_budget(GRAY, SENSOR, EXPOSURE, MATRIX, "Y")
    one_pixel = toy(stacked=True)
    stacked = color_budget(GRAY, one_pixel, EXPOSURE, kernel_matrix(one_pixel, EXPOSURE), "Y")
    assert apart.photons_db == pytest.approx(10 * np.log10(2400), abs=1e-9)
    assert stacked.photons_db == pytest.approx(10 * np.log10(800), abs=1e-9)
    assert readings(stacked)["filters"] == "44 % of the photons become electrons"
    assert stacked.snr_db == pytest.approx(apart.snr_db, abs=1e-9)
    saved = loss(apart, "filters") - loss(stacked, "filters")
    assert saved == pytest.approx(10 * np.log10(3), abs=1e-9)


# Of a gray on the cube-root branch, with f = (1/8)^(1/3) = 1/2 and relative changes of the sensor's
# own color: dL* = 116/3 f dY/Y, da* = 500/3 f (dX/X - dY/Y), db* = 200/3 f (dY/Y - dZ/Z).
# So one unit of a coordinate, with the two others still, is:
RELATIVE_CHANGE = {
    "L*": np.array([1.0, 1.0, 1.0]) * 3 / 58,
    "a*": np.array([0.012, 0.0, 0.0]),
    "b*": np.array([0.0, 0.0, -0.03]),
}
SLOPE = {
    "L*": np.array([0.0, 58 / 3, 0.0]),
    "a*": np.array([250 / 3, -250 / 3, 0.0]),
    "b*": np.array([0.0, 100 / 3, -100 / 3]),
}


@pytest.fixture(scope="module", params=RELATIVE_CHANGE)
def counted(request):
    """Coordinate, the change in photons, the electrons it makes, and the weights of its row.

    Three wavelengths are lit and seen by the eye, so three coordinates leave no choice of change;
    at 850 nm the eye is blind, and a change there would only be easier to see.
    """
    eye = EYE / SEEN_NM[:, None]
    rows = UNMIXING @ weights_by_hand()
    color = ELECTRONS @ rows
    step = RELATIVE_CHANGE[request.param] * color
    change = np.linalg.solve(eye.T, step)
    slope = SLOPE[request.param] / color
    return request.param, change, np.array([0.4, 0.4, 0.3]) * change, slope


def test_the_readings_of_lightness_and_hue_are_those_counted_by_hand(counted):
    coordinate, change, electrons, slope = counted
    result = readings(lab_budget(GRAY, SENSOR, EXPOSURE, MATRIX, coordinate))
    gain = electrons @ (UNMIXING @ weights_by_hand() @ slope)
    assert result["rest"] == f"one unit of {coordinate} comes out as {gain:.2f}"
    # a reader that counts each photon against a colorimeter with exact color-matching functions
    counting = (change**2 / PHOTONS[:3]).sum()  # SNR^2 on one pixel
    scatter = ((EYE / SEEN_NM[:, None] @ slope) ** 2 * PHOTONS[:3]).sum()  # sigma^2 on one pixel
    own = weights_by_hand() @ slope
    best = electrons / np.sqrt(VARIANCE)
    cosine = electrons @ own / np.sqrt((own**2 @ VARIANCE) * (best @ best))
    assert result["weights"] == (
        f"this color needs a channel mix {np.degrees(np.arccos(cosine)):.0f} deg from the "
        f"lowest-noise one; a perfect colorimeter pays {10 * np.log10(counting * scatter):.1f} dB"
    )
    assert result["filters"] == "15 % of the photons become electrons"
    assert result["read noise"] == "46.2 % of the mean noise variance is readout"
    assert (
        result["correlation"]
        == "unmixing multiplies r's own noise by 1.5 (VIF), condition 2.0, metric quanta"
    )
    assert result["infrared"] == "29 % of the electrons come from beyond 700 nm"


def test_the_bound_of_lightness_and_hue_has_the_noise_of_infrared_and_readout(counted):
    coordinate, change, electrons, _ = counted
    budget = lab_budget(GRAY, SENSOR, EXPOSURE, MATRIX, coordinate)
    counting = 3 * (change**2 / PHOTONS[:3]).sum()
    assert budget.photons_db == pytest.approx(10 * np.log10(counting), abs=2e-2)
    squares = (electrons**2 / VARIANCE).sum()
    assert budget.optimal_linear_snr_db == pytest.approx(10 * np.log10(squares), abs=2e-2)
