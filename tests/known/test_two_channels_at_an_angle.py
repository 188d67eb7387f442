"""Two channels in a plane: everything about them follows from one angle."""

import numpy as np
import pytest

from chromanoise.geometry import (
    angles_between_deg,
    contravariant,
    dual_frame,
    nearest_mix,
    spectral_snr,
    variance_inflation,
)
from chromanoise.metrics import snr_db
from strategies import raw_of

RAW_DB = 40.0


def pair(angle_deg, gains=(1.0, 1.0)):
    t = np.radians(angle_deg)
    plane = np.array([[1.0, np.cos(t)], [0.0, np.sin(t)]]) * np.array(gains)
    return dual_frame(plane, names=("a", "b"), metric="quanta")


def shot_limited():
    """10 000 e- in both, nothing but shot noise: 40 dB."""
    return raw_of(np.full(2, 1e4), 1e4 * np.eye(2), names=("a", "b"))


@pytest.mark.parametrize(
    ("angle_deg", "loss_db"), [(90, 0.0), (60, -6.9897), (30, -19.8899), (10, -39.3119)]
)
def test_contravariant_snr_falls_with_the_angle_between_the_channels(angle_deg, loss_db):
    # (1 - cos t) / sqrt(1 + cos^2 t), docs/numbers.md
    seen = snr_db(contravariant(shot_limited(), pair(angle_deg)))
    for name in ("a", "b"):
        assert float(seen[name]) - RAW_DB == pytest.approx(loss_db, abs=5e-5)


def test_the_contravariant_coordinate_of_a_pair_at_60_degrees():
    # G = [1 1/2; 1/2 1], so G^-1 = [4 -2; -2 4] / 3; mean 2/3 of 1e4; variance 20/9 of 1e4
    seen = contravariant(shot_limited(), pair(60))
    assert seen.mean == pytest.approx(np.full(2, 2e4 / 3), rel=1e-12)
    assert seen.covariance == pytest.approx(
        1e4 / 9 * np.array([[20.0, -16.0], [-16.0, 20.0]]), rel=1e-12
    )


@pytest.mark.parametrize(("angle_deg", "loss_db"), [(90, 0.0), (60, -3.0103), (10, -18.1838)])
def test_spectral_snr_falls_by_the_root_of_one_minus_the_cosine(angle_deg, loss_db):
    # mu^T G^-1 mu / tr(G^-1 D) = (mu^2 / v) (1 - cos t) for equal means mu and variances v
    seen = 20 * np.log10(spectral_snr(shot_limited(), pair(angle_deg)))
    assert float(seen) - RAW_DB == pytest.approx(loss_db, abs=1e-4)


@pytest.mark.parametrize(("angle_deg", "vif"), [(90, 1.0), (45, 2.0), (30, 4.0), (10, 33.1634)])
def test_variance_inflates_by_the_inverse_square_of_the_sine(angle_deg, vif):
    assert variance_inflation(pair(angle_deg, gains=(3.0, 0.01))) == pytest.approx(
        np.full(2, vif), rel=1e-5
    )


@pytest.mark.parametrize("angle_deg", [1e-4, 0.5, 10.0, 60.0, 90.0, 179.0])
def test_the_angle_comes_back_whatever_the_gains(angle_deg):
    seen = angles_between_deg(pair(angle_deg, gains=(1e-9, 1e6)))
    assert seen == pytest.approx(np.array([[0.0, angle_deg], [angle_deg, 0.0]]), rel=1e-9)


def test_cos_squared_of_50_7_and_18_1_degrees_are_40_1_and_90_3_percent():
    # the share of |y|^2 within reach of Table 5's green channels (docs/numbers.md)
    for angle_deg, share in ((50.7, 0.401), (18.1, 0.903)):
        mix = nearest_mix(pair(angle_deg))
        assert mix is not None
        assert mix.angle_deg == pytest.approx(angle_deg, rel=1e-9)
        assert mix.explained == pytest.approx(share, abs=6e-4)


@pytest.mark.parametrize(("angle_deg", "condition"), [(90, 1.0), (60, 1.7320508), (10, 11.430052)])
def test_the_condition_of_a_pair_is_the_cotangent_of_half_its_angle(angle_deg, condition):
    # singular values sqrt(1 +- cos t)
    assert pair(angle_deg, gains=(1e-6, 1.0)).condition == pytest.approx(condition, rel=1e-7)


@pytest.mark.parametrize(("angle_deg", "factor"), [(90, 1.0), (30, 4.0), (10, 33.1634)])
def test_the_own_noise_of_a_channel_is_multiplied_by_its_vif(angle_deg, factor):
    only_a = raw_of(np.full(2, 1e4), np.diag([1e4, 0.0]), names=("a", "b"))
    sd = np.sqrt(contravariant(only_a, pair(angle_deg)).covariance[0, 0])
    assert sd / 100 == pytest.approx(factor, rel=1e-5)
