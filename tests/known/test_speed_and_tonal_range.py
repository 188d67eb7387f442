"""Levels of light and counts of levels that can be worked out by hand or by quadrature."""

import numpy as np
import pytest
from scipy.integrate import dblquad, quad

from chromanoise.color import colored, kernel_matrix
from chromanoise.metrics import snr_db
from chromanoise.metrics.snr import (
    color_sensitivity_bits,
    information_bits,
    tonal_levels,
    tonal_range_bits,
)
from chromanoise.metrics.speed import (
    ISO_12232_2019,
    NoiseSpeedModel,
    illuminance_for_snr,
    light_for_snr,
    noise_speed,
)
from chromanoise.metrics.visual_noise import contrast_sensitivity, pixels_per_degree
from chromanoise.noise import Exposure, expected_electrons, with_noise
from chromanoise.sensor import Pixel
from chromanoise.spectra import equal_energy, flat_field
from strategies import (
    EXPOSURE,
    GRID,
    RGB,
    pixel_with,
    rgb_sensor,
    sensor_of,
    white_channel,
)

LAMP = equal_energy(GRID)


# SNR10


@pytest.mark.parametrize(("read_noise_e", "electrons"), [(0.0, 100.0), (10.0, 161.803398875)])
def test_one_channel_needs_100_electrons_for_an_snr_of_10_without_readout(read_noise_e, electrons):
    # M / sqrt(M + s^2) = 10; with s = 10 the root is 100 times the golden section
    level = light_for_snr(np.array([2.0]), np.array([3.0]), snr=10, read_noise_e=read_noise_e)
    assert 2.0 * level == pytest.approx(electrons, rel=1e-11)


def test_snr_1_with_10_electrons_of_read_noise_takes_10_and_a_half_electrons():
    # docs/numbers.md: SNR = 1 at 10.5125 e-
    level = light_for_snr(np.array([1.0]), np.array([1.0]), snr=1, read_noise_e=10.0)
    assert float(level) == pytest.approx(10.5125, abs=5e-5)


@pytest.mark.parametrize("read_noise_e", [0.0, 2.0, 50.0])
@pytest.mark.parametrize("coordinate", ["X", "Y", "Z"])
@pytest.mark.parametrize("snr", [0.1, 1.0, 10.0, 40.0])
def test_at_the_level_of_snr_x_the_color_has_that_snr(read_noise_e, coordinate, snr):
    sensor = rgb_sensor(read_noise_e, 1e6)
    matrix = kernel_matrix(sensor, EXPOSURE)
    lux = illuminance_for_snr(sensor, LAMP, EXPOSURE, matrix, snr=snr, coordinate=coordinate)
    scene = flat_field(LAMP, level_lux=lux, reflectance=0.18)
    color = colored(with_noise(expected_electrons(scene, sensor, EXPOSURE), sensor), matrix)
    i = "XYZ".index(coordinate)
    assert color.mean[i] / np.sqrt(color.variance[i]) == pytest.approx(snr, rel=1e-9)
    assert snr_db(color)[coordinate] == pytest.approx(20 * np.log10(snr), abs=1e-8)


def test_twice_the_time_halves_the_illuminance_that_snr10_takes():
    sensor = rgb_sensor(3.0, 1e6)
    levels = []
    for time_s in (0.01, 0.02):
        exposure = Exposure(time_s=time_s, f_number=1.8)
        levels.append(illuminance_for_snr(sensor, LAMP, exposure, kernel_matrix(sensor, exposure)))
    assert levels[0] == pytest.approx(2 * levels[1], rel=1e-12)


def test_no_illuminance_is_enough_where_full_well_comes_first():
    # 50 electrons of full well: SNR 10 would take 100
    sensor = white_channel(pixel=Pixel(pitch_um=10.0, full_well_e=50.0, read_noise_e=0.0))
    matrix = kernel_matrix(sensor, EXPOSURE)
    assert illuminance_for_snr(sensor, LAMP, EXPOSURE, matrix) is None
    assert illuminance_for_snr(sensor, LAMP, EXPOSURE, matrix, snr=7.0) is not None
    assert noise_speed(sensor, LAMP, np.ones((3, 1))) is None


def test_a_row_that_cancels_never_reaches_any_snr():
    level = light_for_snr(np.array([5.0, 5.0]), np.array([1.0, -1.0]), snr=10, read_noise_e=1.0)
    assert np.isposinf(level)


# ISO 12232


@pytest.mark.parametrize("snr", [10.0, 40.0])
def test_a_monochrome_sensor_without_readout_has_speed_10_over_snr_squared_electrons(snr):
    # H carries snr^2 electrons; 1 lx s at f/0.5 is what 4 lx put on the focal plane at f/1
    sensor = white_channel(pixel=pixel_with(0.0, 1e6))
    per_scene_lux = expected_electrons(
        flat_field(LAMP, level_lux=1.0), sensor, Exposure(time_s=1.0, f_number=1.0)
    )[0]
    per_lxs = 4.0 * per_scene_lux
    speed = noise_speed(sensor, LAMP, np.ones((3, 1)), snr=snr)
    assert speed == pytest.approx(10.0 * per_lxs / snr**2, rel=1e-12)


def test_color_noise_enters_the_speed_with_the_weights_of_the_standard():
    # the definition, by covariance algebra at the exposure that the speed tells
    sensor = rgb_sensor(4.0, 1e6)
    matrix = np.array([[1.9, -0.7, -0.1], [-0.4, 1.8, -0.3], [0.0, -0.6, 1.7]])
    h = 10.0 / noise_speed(sensor, LAMP, matrix, snr=10.0)
    scene = flat_field(LAMP, level_lux=4 * h)  # 4 f#^2 = 4 at f/1
    raw = with_noise(expected_electrons(scene, sensor, Exposure(time_s=1.0, f_number=1.0)), sensor)
    balanced = matrix / (matrix @ raw.mean)[:, None]
    rgb = balanced @ raw.covariance @ balanced.T
    y = np.array([0.2125, 0.7154, 0.0721])
    red_y, blue_y = np.array([1, 0, 0]) - y, np.array([0, 0, 1]) - y
    variance = y @ rgb @ y + 0.279 * red_y @ rgb @ red_y + 0.088 * blue_y @ rgb @ blue_y
    assert 1.0 / np.sqrt(variance) == pytest.approx(10.0, rel=1e-9)
    assert ISO_12232_2019.edition == "ISO 12232:2019"


def test_without_weight_on_color_the_speed_is_that_of_luminance_alone():
    only_y = NoiseSpeedModel(
        edition="luminance", luminance_weights=(0.0, 1.0, 0.0), red_weight=0.0, blue_weight=0.0
    )
    sensor = rgb_sensor(5.0, 1e6)
    green = sensor_of(RGB[:, 1:2], pixel=sensor.pixel)
    assert noise_speed(sensor, LAMP, np.eye(3), model=only_y) == pytest.approx(
        noise_speed(green, LAMP, np.ones((3, 1)), model=only_y), rel=1e-12
    )


# tonal range


def test_tonal_range_of_10_000_electrons_with_10_of_read_noise():
    # docs/numbers.md: 2 (sqrt(10100) - 10) = 180.9975 levels, 7.4998 bits
    top = np.array(10_000.0)
    assert float(tonal_levels(top, read_noise_e=10.0)) == pytest.approx(180.9975, abs=5e-5)
    assert float(tonal_range_bits(top, read_noise_e=10.0)) == pytest.approx(7.4998, abs=5e-5)


@pytest.mark.parametrize("read_noise_e", [0.0, 2.0, 10.0, 500.0])
@pytest.mark.parametrize("step_e", [0.0, 5.0, 20.0, 400.0])
def test_levels_are_the_integral_of_one_over_noise_or_step(read_noise_e, step_e):
    def one_over(root):  # over the root of the signal, so that a noise of 0 at 0 can be summed
        return 2.0 * root / max(step_e, np.sqrt(root**2 + read_noise_e**2))

    bend = np.sqrt(np.clip(step_e**2 - read_noise_e**2, 1e-12, 10_000.0))
    expected = quad(one_over, 0, bend)[0] + quad(one_over, bend, 100.0)[0]
    levels = tonal_levels(np.array(10_000.0), read_noise_e=read_noise_e, step_e=step_e)
    assert float(levels) == pytest.approx(expected, rel=1e-6)


def test_color_sensitivity_is_blind_to_an_invertible_matrix():
    # distinguishable colors counted in the mixed space: the box is a sheared parallelogram
    top, s, mix = np.array([100.0, 60.0]), 3.0, np.array([[2.0, 0.0], [1.5, 0.5]])

    def density(v, u):
        raw = np.linalg.solve(mix, [u, v])
        return 1.0 / np.sqrt(np.linalg.det(mix @ np.diag(raw + s**2) @ mix.T))

    colors = dblquad(
        density,
        0,
        2 * top[0],
        lambda u: 0.75 * u,
        lambda u: 0.75 * u + 0.5 * top[1],
        epsrel=1e-6,
    )[0]
    assert float(color_sensitivity_bits(top, read_noise_e=s)) == pytest.approx(
        np.log2(colors), abs=1e-5
    )


# information


def test_one_channel_tells_half_the_log_of_its_signal_to_noise_plus_one():
    # signal variance 24, noise 8: 1/2 log2(1 + 3) = 1 bit
    result = information_bits(np.array([[24.0]]), np.array([[8.0]]))
    assert float(result) == pytest.approx(1.0, abs=1e-14)


def test_information_is_the_entropy_that_the_light_loses_once_seen():
    # h(light) - h(light | electrons), the posterior covariance by inverting its precision
    rng = np.random.default_rng(3)
    f, root = rng.normal(size=(6, 3)), rng.normal(size=(6, 6))
    k, d = root @ root.T + np.eye(6), np.diag([0.5, 2.0, 7.0])
    posterior = np.linalg.inv(np.linalg.inv(k) + f @ np.linalg.inv(d) @ f.T)
    lost = 0.5 * (np.linalg.slogdet(k)[1] - np.linalg.slogdet(posterior)[1]) / np.log(2)
    result = information_bits(f.T @ k @ f, d)
    assert float(result) == pytest.approx(lost, rel=1e-10)


# the eye's filters


def test_luminance_contrast_sensitivity_peaks_at_4_cycles_per_degree_with_3_0002():
    at = np.linspace(0.0, 60.0, 60_001)
    curve = contrast_sensitivity(at)[:, 0]
    assert at[curve.argmax()] == pytest.approx(4.0, abs=1e-3)
    assert curve.max() == pytest.approx(3.0002, abs=5e-5)


def test_color_contrast_sensitivity_only_falls_from_3_at_no_frequency():
    at = np.linspace(0.0, 60.0, 601)
    curves = contrast_sensitivity(at)[:, 1:]
    assert curves[0] == pytest.approx([3.0, 3.0], abs=5e-3)
    assert (np.diff(curves, axis=0) <= 0).all()


def test_a_finger_at_arms_length_is_a_degree():
    # 1 cm at 57.29 cm is one degree: 10 pixels of 1 mm
    assert pixels_per_degree(distance_mm=572.9, pixel_pitch_mm=1.0) == pytest.approx(10, abs=1e-3)
