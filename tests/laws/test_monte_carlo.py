"""Drawn acquisitions agree with the closed form, and know how well."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.base.rng import stream
from chromanoise.noise import clipped_at_well, monte_carlo, sample_electrons
from strategies import pixel_with

means = st.lists(st.floats(1.0, 5e4), min_size=3, max_size=3).map(np.array)
seeds = st.integers(0, 2**32)


@pytest.mark.parametrize(
    ("mean_e", "noise_e"),
    [(10_000.0, 10.0), (100.0, 0.0), (3.0, 0.0), (2.0, 1.0)],
    ids=["bright", "shot only", "skewed", "dark"],
)
def test_the_spread_of_200_repetitions_is_the_standard_error_that_each_tells(mean_e, noise_e):
    values, mean, snr, sd = [], [], [], []
    for seed in range(200):
        drawn = monte_carlo(
            np.array([mean_e]), pixel_with(noise_e), np.eye(1), draws=1000, seed=seed
        )
        values.append((drawn.mean_se[0], drawn.snr_se_db[0], drawn.sd_se[0]))
        sd.append(drawn.sd[0])
        mean.append(drawn.mean[0])
        snr.append(drawn.snr_db[0])
    mean_se, snr_se, sd_se = np.mean(values, axis=0)
    # a spread of 200 is itself known to 5 %: 25 % are 5 of its own standard errors
    assert np.std(mean, ddof=1) == pytest.approx(mean_se, rel=0.25)
    assert np.std(snr, ddof=1) == pytest.approx(snr_se, rel=0.25)
    assert np.std(sd, ddof=1) == pytest.approx(sd_se, rel=0.25)


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


@given(st.lists(st.floats(-100.0, 20_000.0), min_size=1, max_size=20).map(np.array))
def test_clipping_holds_between_black_and_full_well_and_tells_where(electrons):
    held, hit = clipped_at_well(electrons, pixel_with())
    for e, h, was_hit in zip(electrons, held, hit, strict=True):
        assert h == sorted([0.0, e, 10_000.0])[1]
        assert was_hit == (e < 0 or e > 10_000)
    again, hit_again = clipped_at_well(held, pixel_with())
    assert (again == held).all()
    assert not hit_again.any()
