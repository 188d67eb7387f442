"""Binned pixels: their closed form against sums of single pixels that are drawn one by one."""

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.base.rng import stream
from chromanoise.io.sensor_files import sensor_from_json, sensor_json
from chromanoise.noise import Exposure, noise_sources, sample_electrons, with_noise
from chromanoise.sensor import (
    Converter,
    Pixel,
    binned,
    quantization_step_e,
    with_binning,
    with_pixel,
)
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.study import sensor_named
from chromanoise.study.analysis import electrons_at
from outcomes import refused_input
from strategies import white_channel

DRAWS = 100_000
PIXEL = {
    "read_noise_e": 4.0,
    "dark_current_e_per_s": 600.0,
    "dsnu_e": 5.0,
    "prnu": 0.03,
    "row_noise_e": 3.0,
    "black_error_e": 2.0,
    "column_noise_e": 2.5,
    "reset_capacitance_ff": 0.1,
    "rtn_share": 0.1,
    "rtn_amplitude_e": 20.0,
}
RESET_E = 55.021 * (0.1 / 19.2 * 298.15 / 293.15) ** 0.5  # Nyquist: 19.2 fF at 20 C
STEP_E = 6.0
TIME_S = 0.01
BLOCKS = {2: (1, 2), 4: (2, 2), 6: (2, 3), 9: (3, 3)}  # rows and columns


def one_pixel(qe=0.5):
    """A sensor of one channel with every noise source."""
    pixel = Pixel(pitch_um=3.0, full_well_e=9000.0, **PIXEL)
    converter = Converter(bits=12, gain_e_per_dn=STEP_E)
    return white_channel(qe, grid=DEFAULT_GRID, pixel=pixel, converter=converter, name="one")


def drawn_sums(mean_e, n, mode, rng):
    """Sums of n pixels, each drawn by itself: light, charge, readings, rows of the block."""
    rows, columns = BLOCKS[n]
    shape = (DRAWS, rows, columns)
    gain = 1 + PIXEL["prnu"] * rng.standard_normal(shape)
    dark = PIXEL["dark_current_e_per_s"] * TIME_S
    charge = rng.poisson(mean_e * gain) + rng.poisson(dark, shape)
    charge = charge + PIXEL["dsnu_e"] * rng.standard_normal(shape)

    def read(charge, *shared):
        noise = np.hypot(PIXEL["read_noise_e"], RESET_E) * rng.standard_normal(charge.shape)
        level = 10.0 * rng.choice([-1, 0, 1], charge.shape, p=[0.05, 0.9, 0.05])
        return STEP_E * np.round((charge + noise + level + sum(shared)) / STEP_E)

    if mode == "charge":
        whole = charge.sum(axis=(1, 2))
        row = PIXEL["row_noise_e"] * rng.standard_normal(DRAWS)
        column = PIXEL["column_noise_e"] * rng.standard_normal(DRAWS)
        return read(whole, row, column) - n * dark + PIXEL["black_error_e"]
    row = PIXEL["row_noise_e"] * rng.standard_normal((DRAWS, rows, 1))
    column = PIXEL["column_noise_e"] * rng.standard_normal((DRAWS, 1, columns))
    each = read(charge, row, column) - dark + PIXEL["black_error_e"]
    return each.sum(axis=(1, 2))


@pytest.mark.parametrize("mode", ["charge", "digital"])
@pytest.mark.parametrize("n", BLOCKS)
@pytest.mark.parametrize("mean_e", [40.0, 700.0])
def test_mean_and_variance_are_those_of_sums_of_pixels_that_are_drawn_one_by_one(mean_e, n, mode):
    sensor = with_binning(one_pixel(), n, mode)
    sums = drawn_sums(mean_e, n, mode, stream(7, n))
    raw = with_noise(np.array([n * mean_e]), sensor, Exposure(time_s=TIME_S))
    variance = float(raw.covariance[0, 0])
    bias = noise_sources(sensor, Exposure(time_s=TIME_S)).black_error_e
    assert abs(sums.mean() - n * mean_e - bias) < 5 * np.sqrt(variance / DRAWS)
    fourth = ((sums - sums.mean()) ** 4).mean()
    assert abs(sums.var() - variance) < 5 * np.sqrt((fourth - variance**2) / DRAWS)


@pytest.mark.parametrize("mode", ["charge", "digital"])
def test_monte_carlo_of_a_binned_pixel_draws_from_the_same_distribution(mode):
    sensor, n, mean_e = with_binning(one_pixel(), 4, mode), 4, 150.0
    noise = noise_sources(sensor, Exposure(time_s=TIME_S))
    ours = sample_electrons(
        np.full((DRAWS, 1), n * mean_e), sensor.pixel, stream(3, 3), noise=noise
    )
    theirs = drawn_sums(mean_e, n, mode, stream(4, 4))
    assert abs(ours.mean() - theirs.mean()) < 5 * np.sqrt(2 * theirs.var() / DRAWS)
    assert abs(ours.var() / theirs.var() - 1) < 5 * np.sqrt(4 / DRAWS)


def test_four_pixels_that_are_binned_have_the_light_and_the_well_of_four():
    settings = {"time_ms": 3.0, "prnu": 0.0}
    (one,) = cn.analyze("model-rgb", **settings).outcomes
    (four,) = cn.analyze("model-rgb", binning=4, **settings).outcomes
    light = electrons_at(four.analysis.point) / electrons_at(one.analysis.point)
    np.testing.assert_allclose(light, 4.0, rtol=1e-12)
    assert four.analysis.sensor.pixel.full_well_e == 40_000.0
    assert any("4 pixels binned (charge)" in note for note in four.analysis.sensor.notes)


def snr_of(**settings):
    (one,) = cn.analyze("model-rgb-ircut", budget=True, **settings).to_dict()["sensors"]
    raw = [channel["snr_db"] for channel in one["channels"]]
    return np.array([*raw, one["color"]["snr_db"]["Y"]])


def test_with_shot_noise_alone_both_modes_gain_10_log_n_db():
    settings = {"time_ms": 2.0, "read_noise_e": 0.0}
    one = snr_of(**settings)
    for mode in ("charge", "digital"):
        four = snr_of(binning=4, binning_mode=mode, **settings)
        np.testing.assert_allclose(four - one, 10 * np.log10(4), atol=1e-9)


def test_with_read_noise_alone_charge_gains_20_log_n_db_and_digital_half_of_it():
    settings = {"time_ms": 1e-3, "read_noise_e": 1e4}
    one = snr_of(**settings)
    charge = snr_of(binning=4, binning_mode="charge", **settings)
    digital = snr_of(binning=4, binning_mode="digital", **settings)
    np.testing.assert_allclose(charge - one, 20 * np.log10(4), atol=1e-4)
    np.testing.assert_allclose(digital - one, 10 * np.log10(4), atol=1e-4)


def test_prnu_and_dsnu_of_independent_pixels_average():
    settings = {"time_ms": 1e8, "prnu": 0.02, "full_well_e": 1e13}
    bright = snr_of(**settings)
    for mode in ("charge", "digital"):
        four = snr_of(binning=4, binning_mode=mode, **settings)
        np.testing.assert_allclose(four[:3] - bright[:3], 20 * np.log10(2), atol=1e-3)
    pixel = binned(one_pixel().pixel, 9, "charge")
    assert pixel.dsnu_e == pytest.approx(15.0)  # 9 times the signal: a third of it, relatively


def test_a_binning_of_one_changes_no_digit():
    settings = {"time_ms": 2.0, "prnu": 0.01, "bits": 10, "budget": True, "row_noise_e": 1.0}
    plain = cn.analyze("onyx-rgbw", **settings).to_dict()
    one = cn.analyze("onyx-rgbw", binning=1, **settings).to_dict()
    for result in (plain, one):
        result.pop("study", None), result.pop("hash", None)
    assert one["sensors"] == plain["sensors"]


def test_a_swept_read_noise_is_that_of_one_reading():
    settings = {"time_ms": 2.0, "binning": 4, "binning_mode": "digital"}
    swept = cn.compare(
        "model-rgb-ircut", vary="read-noise-e", first=5.0, last=20.0, points=3, **settings
    ).to_dict()
    (curve,) = swept["curves"]
    at_20 = snr_of(read_noise_e=20.0, **settings)[-1]
    assert curve["value"][-1] == pytest.approx(at_20, abs=1e-9)


def test_quantization_of_a_sum_of_four_readings_has_four_times_the_variance_of_one():
    for converter in (Converter(bits=10), Converter(gain_e_per_dn=3.0)):
        pixel = Pixel(pitch_um=3.0, full_well_e=9000.0, read_noise_e=2.0)
        one = quantization_step_e(converter, pixel)
        digital = quantization_step_e(converter, binned(pixel, 4, "digital"))
        assert digital**2 == pytest.approx(4 * one**2)
    charge = quantization_step_e(Converter(bits=10), binned(pixel, 4, "charge"))
    assert charge == pytest.approx(4 * 9000.0 / 1023)  # the top code is the full well of the sum


def test_values_of_a_pixel_given_to_a_binned_sensor_are_those_of_one_pixel():
    sensor = with_pixel(with_binning(one_pixel(), 4, "digital"), {"read_noise_e": 7.0})
    direct = with_binning(with_pixel(one_pixel(), {"read_noise_e": 7.0}), 4, "digital")
    assert sensor.pixel == direct.pixel


def test_the_json_of_a_binned_sensor_keeps_its_pixel():
    sensor = with_binning(sensor_named("model-rgb", DEFAULT_GRID), 9, "digital")
    assert sensor_from_json(sensor_json(sensor)).pixel == sensor.pixel


@pytest.mark.parametrize("n", [0, -1, 10_001, 10**9, True])
def test_a_number_of_pixels_that_is_none_is_refused(n):
    with refused_input(subject="binning"):
        binned(one_pixel().pixel, n)


def test_a_sensor_is_binned_once():
    with refused_input(subject="binning"):
        with_binning(with_binning(one_pixel(), 4), 4)


def test_an_unknown_mode_is_refused():
    with refused_input(subject="binning_mode"):
        cn.analyze("model-rgb", binning=4, binning_mode="average")


@pytest.mark.parametrize("n", [0, 2.5, 10**9])
def test_a_setting_that_is_no_number_of_pixels_is_refused(n):
    with refused_input(subject="binning"):
        cn.analyze("model-rgb", binning=n)
