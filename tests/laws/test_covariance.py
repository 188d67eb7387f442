"""Covariances: symmetric, never negative, and they compose."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from chromanoise.noise import raw_covariance, through
from strategies import raw_of

entries = st.floats(-10.0, 10.0)
electrons = st.floats(0.0, 1e5)


def mixed(measurement, matrix):
    names = tuple(f"y{i}" for i in range(matrix.shape[0]))
    return through(measurement, matrix, names=names, kind="mixed", unit="1")


@given(arrays(float, (3,), elements=electrons), st.floats(0.0, 100.0))
def test_raw_noise_is_independent_between_channels(mean, read_noise):
    covariance = raw_covariance(mean, read_noise_e=read_noise)
    off_diagonal = covariance[~np.eye(3, dtype=bool)]
    assert (off_diagonal == 0).all()


def test_shot_and_read_noise_add_their_variances():
    # 3-4-5: 9 electrons of light and 4 electrons of read noise make a standard deviation of 5
    assert raw_covariance(np.array([9.0]), read_noise_e=4.0) == pytest.approx(
        np.array([[25.0]]), rel=1e-15
    )


@given(arrays(float, (3,), elements=electrons), arrays(float, (4, 3), elements=entries))
def test_a_propagated_covariance_is_symmetric_and_never_negative(mean, matrix):
    seen = mixed(raw_of(mean, raw_covariance(mean, read_noise_e=3.0)), matrix).covariance
    assert (seen == seen.T).all()
    assert np.linalg.eigvalsh(seen).min() >= -1e-10 * max(1.0, np.abs(seen).max())


@given(
    arrays(float, (3,), elements=electrons),
    arrays(float, (4, 3), elements=entries),
    arrays(float, (2, 4), elements=entries),
)
def test_two_matrices_in_a_row_are_their_product(mean, first, second):
    raw = raw_of(mean, raw_covariance(mean, read_noise_e=3.0))
    step_by_step, at_once = mixed(mixed(raw, first), second), mixed(raw, second @ first)
    size = 1.0 + np.abs(at_once.covariance).max()
    scale = 1e5 * 1e4 * 1e-9
    assert step_by_step.covariance == pytest.approx(at_once.covariance, abs=1e-9 * size + scale)
    assert step_by_step.mean == pytest.approx(at_once.mean, abs=scale)


@given(
    arrays(float, (3,), elements=electrons),
    arrays(float, (3,), elements=entries),
    arrays(float, (3,), elements=entries),
)
def test_the_variance_of_a_weighted_sum_is_the_sum_of_the_squared_weights(mean, w, v):
    # independent channels: var(w.x) = sum w_i^2 var_i, cov(w.x, v.x) = sum w_i v_i var_i
    raw = raw_of(mean, raw_covariance(mean, read_noise_e=2.0))
    seen = mixed(raw, np.stack([w, v]))
    variance = [mean[i] + 4.0 for i in range(3)]
    assert seen.variance[0] == pytest.approx(
        sum(w[i] * w[i] * variance[i] for i in range(3)), rel=1e-12
    )
    assert seen.covariance[0, 1] == pytest.approx(
        sum(w[i] * v[i] * variance[i] for i in range(3)), rel=1e-9, abs=1e-6
    )


@given(arrays(float, (2, 5, 3), elements=electrons), arrays(float, (2, 3), elements=entries))
def test_a_picture_is_propagated_as_its_points_are(mean, matrix):
    picture = mixed(raw_of(mean, raw_covariance(mean, read_noise_e=3.0)), matrix)
    point = mixed(raw_of(mean[1, 4], raw_covariance(mean[1, 4], read_noise_e=3.0)), matrix)
    assert picture.mean[1, 4] == pytest.approx(point.mean, rel=1e-12, abs=1e-9)
    assert picture.covariance[1, 4] == pytest.approx(point.covariance, rel=1e-12, abs=1e-9)
    assert picture.variance.shape == (2, 5, 2)


def test_a_measurement_cannot_be_changed_after_it_was_made():
    raw = raw_of([1.0, 2.0], np.eye(2))
    with pytest.raises(ValueError, match="read-only"):
        raw.mean[0] = 5.0
    with pytest.raises(ValueError, match="read-only"):
        raw.covariance[0, 0] = 5.0
