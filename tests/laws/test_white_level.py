"""The largest signal: full well, or the top code of the converter if that is lower."""

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.noise import (
    Exposure,
    clipping_readout,
    saturated,
    sensor_moments,
    time_to_saturation,
)
from chromanoise.sensor import (
    Converter,
    Pixel,
    adc_of,
    quantization_step_e,
    white_level_e,
    with_binning,
    with_pixel,
)
from chromanoise.spectra import equal_energy, flat_field
from noise_samples import noise_of
from outcomes import refused_input
from strategies import GRID, pixel_with, white_channel

TEN_BITS = {"bits": 10, "gain_e_per_dn": 1.0}  # codes end at 1023 e-, full well at 10000


def ten_bit_sensor(**more):
    return with_pixel(white_channel(), TEN_BITS | more)


def test_the_exposure_time_fills_the_code_range_where_it_ends_below_full_well():
    scene, sensor = flat_field(equal_energy(GRID), level_lux=10.0), ten_bit_sensor()
    full = time_to_saturation(scene, white_channel(), share=1.0)
    assert time_to_saturation(scene, sensor, share=1.0) == pytest.approx(full * 1023 / 10_000)


def test_dark_electrons_fill_the_well_and_leave_the_code_range():
    sensor = ten_bit_sensor(dark_current_e_per_s=1e5)
    assert white_level_e(sensor, dark_e=1000.0) == 1023
    assert white_level_e(sensor, dark_e=9500.0) == 500
    exposure = Exposure(time_s=0.095)  # 9500 dark electrons
    assert list(saturated(np.array([499.0, 501.0]), sensor, exposure)) == [False, True]


def test_a_channel_above_the_top_code_is_saturated_and_one_at_it_is_not():
    assert list(saturated(np.array([1023.0, 1024.0]), ten_bit_sensor())) == [False, True]


def test_clipped_moments_at_the_top_code_are_those_of_drawn_and_clipped_codes():
    rng = np.random.default_rng(7)
    draws = 400_000
    sensor = ten_bit_sensor(read_noise_e=4.0)
    electrons = rng.poisson(1010.0, draws) + 4.0 * rng.standard_normal(draws)
    codes = np.clip(np.round(electrons), 0, 1023)
    noise = noise_of(read_noise_e=4.0, step_e=1.0)
    found = sensor_moments(np.array([1010.0]), noise, clipping_readout(sensor))
    assert found.mean[0] == pytest.approx(codes.mean(), abs=5 * codes.std() / draws**0.5)
    assert found.variance[0] == pytest.approx(codes.var(), rel=5 * (2 / draws) ** 0.5)
    assert found.full_share[0] == pytest.approx((np.round(electrons) > 1023).mean(), abs=0.004)


def test_sums_of_codes_end_at_as_many_top_codes_and_sums_of_charge_at_one():
    four = with_binning(ten_bit_sensor(), 4, "digital")
    assert white_level_e(four) == 4 * 1023
    assert white_level_e(with_binning(ten_bit_sensor(), 4, "charge")) == 1023


def test_a_gain_without_bits_has_the_same_step_in_closed_form_and_in_pictures():
    pixel, known = pixel_with(), Converter(gain_e_per_dn=2.0)
    adc = adc_of(known, pixel)
    assert adc.gain_e_per_dn == quantization_step_e(known, pixel) == 2.0
    assert (adc.top_code - 1) // 2 < pixel.full_well_e / 2.0 <= adc.top_code  # 13 bits: 8191


def test_a_gain_that_16_bits_cannot_hold_asks_for_the_bits():
    with refused_input(subject="bits", setting="bits"):
        adc_of(Converter(gain_e_per_dn=0.1), Pixel(pitch_um=1, full_well_e=1e4, read_noise_e=0))


def test_a_full_well_below_one_code_is_refused():
    with refused_input(subject="gain_e_per_dn", value=1e9):
        with_pixel(white_channel(), {"gain_e_per_dn": 1e9})


def test_analyses_say_that_the_top_code_ends_the_signal():
    (found,) = cn.analyze("model-rgb-ircut", bits=10, gain_dn_per_e=1.0).analyses
    assert found.expected_e.max() == pytest.approx(0.99 * 1023)
    (full,) = cn.analyze("model-rgb-ircut", bits=10, gain_dn_per_e=1.0, time_ms=20.0).analyses
    assert full.saturated.all()
