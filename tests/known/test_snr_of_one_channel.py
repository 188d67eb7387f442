"""Decibels that can be worked out with a pocket calculator."""

import numpy as np
import pytest

from chromanoise.metrics import optimal_linear_snr_db, snr_db
from chromanoise.noise import raw_covariance
from strategies import raw_of


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
