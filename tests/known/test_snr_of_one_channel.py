"""Decibels that can be worked out with a pocket calculator."""

import numpy as np
import pytest

from chromanoise.metrics import optimal_linear_snr_db, snr_db
from chromanoise.noise import monte_carlo, raw_covariance
from strategies import pixel_with, raw_of


def raw(mean_e, read_noise_e=10.0):
    mean = np.array([mean_e])
    return raw_of(mean, raw_covariance(mean, read_noise_e=read_noise_e), names=("W",))


@pytest.mark.parametrize(
    ("mean_e", "db"),
    [
        (10_000.0, 39.9568),  # 20 log10(10000 / sqrt(10100)); the paper's Table 5 prints 39.95
        (9_900.0, 39.9127),  # 20 log10(9900 / sqrt(10000)); Table 2, W: 39.9
    ],
)
def test_snr_near_full_well_with_10_electrons_of_read_noise(mean_e, db):
    assert float(snr_db(raw(mean_e))["W"]) == pytest.approx(db, abs=5e-5)


def test_snr_is_1_at_10_5125_electrons():
    # the root of M^2 = M + 100: (1 + sqrt(401)) / 2 (EMVA 1288's absolute sensitivity threshold)
    assert float(snr_db(raw(10.5125))["W"]) == pytest.approx(0.0, abs=1e-4)


def test_equal_channels_bound_the_readout_by_the_square_root_of_their_number():
    four = raw_of(np.full(4, 100.0), 100.0 * np.eye(4))
    assert float(optimal_linear_snr_db(four)) == pytest.approx(20.0 + 6.0206, abs=1e-4)


def test_5000_draws_know_an_snr_to_0_087_db():
    # (20 / ln 10) / sqrt(2 N): the paper's own error bar (docs/numbers.md)
    drawn = monte_carlo(np.array([1e6]), pixel_with(), np.eye(1), draws=5000, seed=1)
    # beside it stands the error of the mean, 1e-3 of it, and of the kurtosis, 2 %
    assert drawn.snr_se_db[0] == pytest.approx(0.0869, rel=0.06)


def test_clipping_at_full_well_hits_15_9_percent_at_99_percent_of_it():
    # sd is exactly sqrt(9900 + 100) = 100 e-, so full well lies 1 sigma up: 1 - Phi(1) = 0.1587
    draws = 100_000
    drawn = monte_carlo(
        np.array([9_900.0]), pixel_with(), np.eye(1), draws=draws, seed=2, clip=True
    )
    # the Poisson's skewness (0.0099) and lattice move it by less than 3e-4
    error = np.sqrt(0.1587 * 0.8413 / draws)
    assert abs(drawn.clipped_share[0] - 0.1587) < 5 * error + 3e-4


def test_a_normal_signal_censored_at_one_sigma_keeps_these_moments():
    # partial integration: E min(Z, 1) = Phi(-1) - phi(1) = -0.083315, and its variance is
    # 1 - phi(1) - 0.083315^2 = 0.751088 (Tobin, Econometrica 26 (1958) 24: the censored normal)
    draws = 100_000
    drawn = monte_carlo(
        np.array([9_900.0]), pixel_with(), np.eye(1), draws=draws, seed=3, clip=True
    )
    assert abs(drawn.mean[0] - (9_900.0 - 8.3315)) < 5 * drawn.mean_se[0]
    assert drawn.sd[0] == pytest.approx(100 * np.sqrt(0.751088), rel=0.012)
