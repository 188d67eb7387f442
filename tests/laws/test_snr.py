"""How SNR scales, what bounds it, and what one channel cannot lose."""

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from hypothesis.extra.numpy import arrays

from chromanoise.color import colored, kernel_matrix
from chromanoise.metrics import color_snr_loss_db, optimal_linear_snr_db, snr_db
from chromanoise.noise import Exposure, expected_electrons, raw_covariance, through, with_noise
from chromanoise.spectra import METRICS, equal_energy, flat_field
from strategies import GRID, bell_qe, pixel_with, raw_of, sensor_of, sensors

metrics = st.sampled_from(METRICS)
electrons = st.floats(1.0, 1e6)


def white_raw(sensor, exposure):
    scene = flat_field(equal_energy(GRID), level_lux=10.0)
    return with_noise(expected_electrons(scene, sensor, exposure), sensor)


def channel_db(mean_e, read_noise_e):
    mean = np.array([mean_e])
    raw = raw_of(mean, raw_covariance(mean, read_noise_e=read_noise_e), names=("W",))
    return float(snr_db(raw)["W"])


@given(st.floats(1.0, 1e9))
def test_shot_limited_snr_gains_10_db_per_decade_of_light(mean_e):
    assert channel_db(10 * mean_e, 0.0) - channel_db(mean_e, 0.0) == pytest.approx(10.0, abs=1e-9)


@given(st.floats(1e-6, 1e-3))
def test_read_limited_snr_gains_20_db_per_decade_of_light(mean_e):
    # 1e-2 electrons of light beside 100 e- of read noise: shot noise is a millionth of it
    gain = channel_db(10 * mean_e, 100.0) - channel_db(mean_e, 100.0)
    assert gain == pytest.approx(20.0, abs=1e-5)


@given(electrons, st.floats(0.0, 100.0), st.floats(1.01, 100.0))
def test_more_light_never_lowers_and_more_read_noise_never_raises_snr(mean_e, noise_e, factor):
    assert channel_db(factor * mean_e, noise_e) > channel_db(mean_e, noise_e)
    assert channel_db(mean_e, factor * (noise_e + 0.1)) < channel_db(mean_e, noise_e)


def test_no_light_is_minus_infinity_and_no_noise_is_infinity():
    raw = raw_of([0.0, 5.0], np.diag([4.0, 0.0]), names=("dark", "quiet"))
    seen = snr_db(raw)
    assert float(seen["dark"]) == float("-inf")
    assert float(seen["quiet"]) == float("inf")


def test_the_sign_of_a_mean_does_not_change_its_snr():
    raw = raw_of([-100.0, 100.0], np.eye(2), names=("a", "b"))
    assert {name: float(db) for name, db in snr_db(raw).items()} == {"a": 40.0, "b": 40.0}


@given(arrays(float, (4,), elements=electrons), st.floats(0.1, 50.0), st.data())
def test_no_linear_readout_beats_the_bound(mean, noise_e, data):
    raw = raw_of(mean, raw_covariance(mean, read_noise_e=noise_e))
    weights = data.draw(arrays(float, (1, 4), elements=st.floats(-1.0, 1.0)))
    assume(np.abs(weights).max() > 1e-3)
    readout = through(raw, weights, names=("Y",), kind="readout", unit="e-")
    assert float(snr_db(readout)["Y"]) <= float(optimal_linear_snr_db(raw)) + 1e-9
    assert float(color_snr_loss_db(raw, readout)) >= -1e-9


@given(arrays(float, (4,), elements=electrons), st.floats(0.0, 50.0))
def test_the_readout_weighted_by_signal_over_noise_reaches_the_bound(mean, noise_e):
    raw = raw_of(mean, raw_covariance(mean, read_noise_e=noise_e))
    best = (mean / (mean + noise_e**2))[None, :]
    readout = through(raw, best, names=("Y",), kind="readout", unit="e-")
    assert float(snr_db(readout)["Y"]) == pytest.approx(float(optimal_linear_snr_db(raw)), abs=1e-9)
    assert float(color_snr_loss_db(raw, readout)) == pytest.approx(0.0, abs=1e-9)


@given(arrays(float, (3,), elements=electrons), st.floats(0.0, 50.0))
def test_powers_of_the_channels_add_up_to_that_of_the_bound(mean, noise_e):
    raw = raw_of(mean, raw_covariance(mean, read_noise_e=noise_e))
    powers = [10 ** (float(db) / 10) for db in snr_db(raw).values()]
    assert 10 ** (float(optimal_linear_snr_db(raw)) / 10) == pytest.approx(sum(powers), rel=1e-9)


@given(arrays(float, (3,), elements=electrons), arrays(float, (3, 3), elements=st.floats(-1, 1)))
def test_the_bound_does_not_care_in_which_coordinates_it_is_asked(mean, mix):
    matrix = mix + 4 * np.eye(3)
    raw = raw_of(mean, raw_covariance(mean, read_noise_e=2.0))
    mixed = through(raw, matrix, names=raw.names, kind="raw", unit="e-")
    assert float(optimal_linear_snr_db(mixed)) == pytest.approx(
        float(optimal_linear_snr_db(raw)), abs=1e-7
    )


def test_correlated_noise_is_cancelled_by_the_bound():
    # two channels that share all but 1 e-^2 of their noise: their difference (2 e-) has a
    # variance of 2, D^-1 of [[100, 99], [99, 100]] is [[100, -99], [-99, 100]] / 199;
    # mu = (3, 1): (900 + 100 - 594) / 199 = 2.0402
    raw = raw_of([3.0, 1.0], [[100.0, 99.0], [99.0, 100.0]])
    assert 10 ** (float(optimal_linear_snr_db(raw)) / 10) == pytest.approx(406 / 199, rel=1e-9)


def test_a_dark_and_silent_channel_adds_nothing_to_the_bound():
    raw = raw_of([100.0, 0.0], np.diag([100.0, 0.0]))
    assert float(optimal_linear_snr_db(raw)) == pytest.approx(20.0, abs=1e-9)


@given(sensors(min_channels=2), metrics, st.floats(1e-4, 1.0))
def test_the_price_of_color_is_never_negative(sensor, metric, time_s):
    exposure = Exposure(time_s=time_s)
    raw = white_raw(sensor, exposure)
    assert (
        float(color_snr_loss_db(raw, colored(raw, kernel_matrix(sensor, exposure, metric))))
        >= -1e-9
    )


@given(sensors(max_channels=1), metrics, st.floats(1e-4, 1.0))
def test_one_channel_keeps_its_snr_in_luminance_whatever_its_angle(sensor, metric, time_s):
    # docs/numbers.md: Y^ = const x M, so Table 5's loss is no effect of the angle
    exposure = Exposure(time_s=time_s)
    raw = white_raw(sensor, exposure)
    color = colored(raw, kernel_matrix(sensor, exposure, metric))
    wanted = float(snr_db(raw)["a"])
    for name in ("X", "Y", "Z"):
        assert float(snr_db(color)[name]) == pytest.approx(wanted, abs=1e-9)
    assert float(color_snr_loss_db(raw, color)) == pytest.approx(0.0, abs=1e-9)


@given(sensors(min_channels=2), metrics)
def test_exposure_leaves_the_color_of_a_scene_alone(sensor, metric):
    seen = []
    for time_s in (0.001, 0.1):
        exposure = Exposure(time_s=time_s)
        raw = white_raw(sensor, exposure)
        seen.append(colored(raw, kernel_matrix(sensor, exposure, metric)).mean)
    assert seen[1] == pytest.approx(seen[0], rel=1e-9)


def test_without_read_noise_ten_times_the_time_is_10_db_of_every_color():
    sensor = sensor_of(
        bell_qe([450, 540, 620], [25, 35, 30], [0.6, 0.7, 0.8]), pixel=pixel_with(0.0)
    )
    short, long = (
        snr_db(colored(white_raw(sensor, exposure), kernel_matrix(sensor, exposure)))
        for exposure in (Exposure(time_s=0.001), Exposure(time_s=0.01))
    )
    for name in ("X", "Y", "Z"):
        assert float(long[name] - short[name]) == pytest.approx(10.0, abs=1e-9)
