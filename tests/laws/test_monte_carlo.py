"""Drawn acquisitions agree with the closed form, and know how well."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from chromanoise.base.rng import stream
from chromanoise.color import colored, kernel_matrix
from chromanoise.metrics import snr_db
from chromanoise.noise import (
    clipped_at_well,
    expected_electrons,
    monte_carlo,
    raw_covariance,
    sample_electrons,
    with_noise,
)
from chromanoise.spectra import equal_energy, flat_field
from strategies import EXPOSURE, GRID, bell_qe, pixel_with, raw_of, sensor_of

means = st.lists(st.floats(1.0, 5e4), min_size=3, max_size=3).map(np.array)
seeds = st.integers(0, 2**32)


@given(means, st.floats(0.0, 30.0), seeds)
def test_drawn_channels_agree_with_the_closed_form(mean, noise_e, seed):
    drawn = monte_carlo(mean, pixel_with(noise_e), np.eye(3), draws=4000, seed=seed)
    exact = raw_of(mean, raw_covariance(mean, read_noise_e=noise_e))
    z = (drawn.mean - mean) / drawn.mean_se
    assert np.abs(z).max() < 5
    z_db = (drawn.snr_db - np.array(list(snr_db(exact).values()))) / drawn.snr_se_db
    assert np.abs(z_db).max() < 5
    assert (drawn.clipped_share == 0).all()


@settings(max_examples=10)
@given(seeds, st.floats(0.0, 40.0), st.sampled_from(["energy", "quanta"]))
def test_drawn_colors_agree_with_the_closed_form(seed, noise_e, metric):
    sensor = sensor_of(
        bell_qe([450, 540, 620], [30, 45, 40], [0.6, 0.7, 0.8]), pixel=pixel_with(noise_e)
    )
    scene = flat_field(equal_energy(GRID), level_lux=10.0)
    raw = with_noise(expected_electrons(scene, sensor, EXPOSURE), sensor)
    matrix = kernel_matrix(sensor, EXPOSURE, metric)
    exact = colored(raw, matrix)
    drawn = monte_carlo(raw.mean, sensor.pixel, matrix.matrix, draws=4000, seed=seed)
    assert (np.abs(drawn.mean - exact.mean) / drawn.mean_se).max() < 5
    exact_db = np.array([float(snr_db(exact)[name]) for name in ("X", "Y", "Z")])
    assert (np.abs(drawn.snr_db - exact_db) / drawn.snr_se_db).max() < 5


@pytest.mark.parametrize(
    ("mean_e", "noise_e"),
    [(10_000.0, 10.0), (100.0, 0.0), (3.0, 0.0), (2.0, 1.0)],
    ids=["bright", "shot only", "skewed", "dark"],
)
def test_the_spread_of_200_repetitions_is_the_standard_error_that_each_tells(mean_e, noise_e):
    values, mean, snr = [], [], []
    for seed in range(200):
        drawn = monte_carlo(
            np.array([mean_e]), pixel_with(noise_e), np.eye(1), draws=1000, seed=seed
        )
        values.append((drawn.mean_se[0], drawn.snr_se_db[0]))
        mean.append(drawn.mean[0])
        snr.append(drawn.snr_db[0])
    mean_se, snr_se = np.mean(values, axis=0)
    # a spread of 200 is itself known to 5 %: 25 % are 5 of its own standard errors
    assert np.std(mean, ddof=1) == pytest.approx(mean_se, rel=0.25)
    assert np.std(snr, ddof=1) == pytest.approx(snr_se, rel=0.25)


def test_the_standard_error_of_a_skewed_signal_counts_its_skewness():
    # Poisson, mean m: log(mean / sd) has a variance of (1/m + (2 + 1/m)/4 - 1/m) / N, which is
    # (2 + 1/m) / (4 N); for m = 1/2 it is 1/N: 8.6859 / sqrt(N) dB
    draws = 60_000
    drawn = monte_carlo(np.array([0.5]), pixel_with(0.0), np.eye(1), draws=draws, seed=4)
    assert drawn.snr_se_db[0] == pytest.approx(8.6859 / np.sqrt(draws), rel=0.05)


@given(means, seeds)
def test_the_same_seed_draws_the_same_numbers(mean, seed):
    first, again = (
        monte_carlo(mean, pixel_with(), np.eye(3), draws=50, seed=seed) for _ in range(2)
    )
    assert (first.mean == again.mean).all()
    assert (first.sd == again.sd).all()
    other = monte_carlo(mean, pixel_with(), np.eye(3), draws=50, seed=seed + 1)
    assert not (first.mean == other.mean).any()


def test_another_name_draws_other_numbers():
    drawn = [
        monte_carlo(np.array([1e4]), pixel_with(), np.eye(1), draws=50, seed=0, name=name).mean[0]
        for name in [(), (0,), (1,), (0, 0)]
    ]
    assert len(set(drawn)) == 4


@given(st.integers(0, 2**63), st.lists(st.integers(0, 2**31), max_size=3))
def test_streams_of_other_names_share_no_numbers(seed, name):
    one, again = stream(seed, *name).random(8), stream(seed, *name).random(8)
    assert (one == again).all()
    for other in ([*name, 0], [*name, 1], [7, *name, 3]):
        assert not np.isin(stream(seed, *other).random(8), one).any()


def test_noise_of_different_channels_is_independent():
    rng = stream(11)
    drawn = sample_electrons(np.broadcast_to([500.0, 500.0], (20_000, 2)), pixel_with(), rng)
    correlation = np.corrcoef(drawn.T)[0, 1]
    assert abs(correlation) < 5 / np.sqrt(20_000)


def test_draws_go_on_beyond_a_block_of_streams():
    draws = 70_000  # more than one block
    drawn = monte_carlo(np.array([400.0]), pixel_with(0.0), np.eye(1), draws=draws, seed=5)
    assert drawn.draws == draws
    assert drawn.mean_se[0] == pytest.approx(20.0 / np.sqrt(draws), rel=0.02)
    assert abs(drawn.mean[0] - 400.0) < 5 * drawn.mean_se[0]
    assert drawn.sd[0] == pytest.approx(20.0, rel=5 / np.sqrt(2 * draws))


@given(st.floats(9_000.0, 11_000.0), seeds)
def test_clipping_lowers_a_mean_near_full_well_and_flatters_its_snr(mean_e, seed):
    draw = {"draws": 2000, "seed": seed}
    free = monte_carlo(np.array([mean_e]), pixel_with(), np.eye(1), **draw)
    held = monte_carlo(np.array([mean_e]), pixel_with(), np.eye(1), clip=True, **draw)
    assert held.mean[0] <= free.mean[0]
    assert held.sd[0] <= free.sd[0]
    if held.clipped_share[0] > 0:
        assert held.mean[0] < free.mean[0]
    else:
        assert held.snr_db[0] == free.snr_db[0]


@given(st.lists(st.floats(-100.0, 20_000.0), min_size=1, max_size=20).map(np.array))
def test_clipping_holds_between_black_and_full_well_and_tells_where(electrons):
    held, hit = clipped_at_well(electrons, pixel_with())
    for e, h, was_hit in zip(electrons, held, hit, strict=True):
        assert h == sorted([0.0, e, 10_000.0])[1]
        assert was_hit == (e < 0 or e > 10_000)
    again, hit_again = clipped_at_well(held, pixel_with())
    assert (again == held).all()
    assert not hit_again.any()


def test_clipping_at_black_lifts_the_mean_of_no_light_by_0_39894_of_the_read_noise():
    # E max(Z, 0) = 1 / sqrt(2 pi) (docs/numbers.md)
    drawn = monte_carlo(
        np.array([0.0]), pixel_with(10.0), np.eye(1), draws=40_000, seed=6, clip=True
    )
    assert abs(drawn.mean[0] - 3.9894) < 5 * drawn.mean_se[0]
    assert drawn.clipped_share[0] == pytest.approx(0.5, abs=5 * 0.5 / 200)
