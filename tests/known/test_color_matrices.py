"""Color matrices against printed numbers, cases done by hand, and colour-science."""

import colour
import numpy as np
import pytest

from chromanoise.color import colored, kernel_matrix
from chromanoise.color.matrices import least_squares, lmmse, noise_gain, white_normalized
from chromanoise.color.root_polynomials import root_polynomial, root_polynomial_color
from chromanoise.color.training import Training, chart_training, training_response
from chromanoise.metrics.accuracy import matrix_report
from chromanoise.noise import Exposure, expected_electrons, with_noise
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field, photon_irradiance
from chromanoise.study import sensor_named
from strategies import EXPOSURE, GRID, bell_qe, sensor_of, white_channel

PAPER_EXPOSURE = Exposure(time_s=0.012, f_number=1.8)

# Adams & Pillman, "Digital camera image processing pipeline", in Lukac (ed.), Computational
# Photography (CRC, 2010); decimal points restored as in docs/numbers.md.
KODAK = {
    "RGB": (4.733, [[1.558, -0.531, -0.027], [-0.078, 1.477, -0.399], [0.039, -0.508, 1.469]]),
    "RPB": (8.497, [[2.000, -1.373, 0.373], [-1.062, 3.384, -1.322], [0.412, -1.248, 1.836]]),
    "CMY": (8.900, [[-2.554, 2.021, 1.533], [0.941, -1.512, 1.571], [1.201, 1.783, -1.984]]),
}


@pytest.mark.parametrize("filters", KODAK)
def test_psi_of_the_three_filter_sets_is_as_recomputed_from_print(filters):
    printed, matrix = KODAK[filters]
    assert noise_gain(np.array(matrix)) == pytest.approx(printed, abs=6e-4)


@pytest.mark.parametrize("filters", KODAK)
def test_the_normalized_matrix_forgets_the_gains_of_channels_and_coordinates(filters):
    # Kodak's matrices take white-balanced channels to white-balanced color: rows sum to 1
    matrix, gains, white = np.array(KODAK[filters][1]), np.array([3.0, 0.2, 90.0]), np.full(3, 7.0)
    back = white_normalized(white[:, None] * matrix / gains, gains, white)
    np.testing.assert_allclose(back, matrix, rtol=1e-14)
    np.testing.assert_allclose(back.sum(axis=1), 1.0, atol=2e-3)


def test_lmmse_of_one_channel_and_one_reflectance_shrinks_by_signal_over_signal_plus_noise():
    # eq. 7 with 100 e-: variance 100 + 10^2, so C M = Y * 100^2 / (100^2 + 200) = Y / 1.02
    sensor, lamp = white_channel(), equal_energy(GRID)
    lux = 100.0 / expected_electrons(flat_field(lamp, level_lux=1.0), sensor, EXPOSURE)[0]
    grey = Training(
        illuminant=lamp, reflectance=np.ones((1, GRID.n)), names=("white",), source="a white wall"
    )
    gain = lmmse(sensor, EXPOSURE, grey, level_lux=lux).matrix[:, 0] * 100.0
    target = training_response(grey, sensor, EXPOSURE, level_lux=lux).xyz[0]
    np.testing.assert_allclose(gain, target / 1.02, rtol=1e-12)


@pytest.mark.parametrize("metric", ["quanta", "energy"])
def test_least_squares_on_single_wavelengths_of_equal_strength_is_the_kernel(metric):
    """K = identity and D = 0 reduce the Wiener filter to eq. 6, in the metric of K."""
    lamp, sensor = equal_energy(GRID), sensor_of(bell_qe([450, 540, 610], [30] * 3, [0.5] * 3))
    amount = photon_irradiance(lamp) if metric == "quanta" else lamp.irradiance
    lines = Training(
        illuminant=lamp,
        reflectance=np.diag(amount.min() / amount),
        names=tuple(f"{at:g} nm" for at in GRID.wavelength_nm),
        source="single wavelengths",
    )
    fitted = least_squares(sensor, EXPOSURE, lines, level_lux=10.0, metric=metric)
    exact = kernel_matrix(sensor, EXPOSURE, metric)
    np.testing.assert_allclose(fitted.matrix, exact.matrix, rtol=1e-10)


@pytest.mark.parametrize(("sensor", "printed"), [("onyx-rgbw", 26.1), ("onyx-rgb-ircut", 32.4)])
def test_the_report_on_the_kernel_has_the_luminance_snr_of_table_3(sensor, printed):
    onyx = sensor_named(sensor, DEFAULT_GRID)
    matrix, lamp = kernel_matrix(onyx, PAPER_EXPOSURE), equal_energy(DEFAULT_GRID)
    report = matrix_report(matrix, onyx, PAPER_EXPOSURE, lamp, level_lux=10.0)
    assert report.snr_db["Y"] == pytest.approx(printed, abs=0.15)


def test_least_squares_and_root_polynomial_agree_with_colour_science():
    sensor, lamp = sensor_named("onyx-rgb-ircut", DEFAULT_GRID), equal_energy(DEFAULT_GRID)
    chart = chart_training(lamp)
    seen = training_response(chart, sensor, PAPER_EXPOSURE, level_lux=10.0)
    raw = with_noise(seen.electrons, sensor)
    linear = least_squares(sensor, PAPER_EXPOSURE, chart, level_lux=10.0)
    theirs = colour.characterisation.matrix_colour_correction_Cheung2004(
        seen.electrons, seen.xyz, terms=3
    )
    np.testing.assert_allclose(linear.matrix, theirs, rtol=1e-9)
    curved = root_polynomial(sensor, PAPER_EXPOSURE, chart, level_lux=10.0)
    corrected = colour.characterisation.colour_correction_Finlayson2015(
        seen.electrons, seen.electrons, seen.xyz, degree=2, root_polynomial_expansion=True
    )
    np.testing.assert_allclose(root_polynomial_color(raw, curved).mean, corrected, rtol=1e-9)
    assert np.abs(corrected - colored(raw, linear).mean).max() > 0.01  # they are not the same
