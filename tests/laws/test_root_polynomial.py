"""Root polynomials: blind to exposure, least squares where nothing bends, noise by Jacobian."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.color import colored
from chromanoise.color.matrices import least_squares
from chromanoise.color.root_polynomials import (
    root_jacobian,
    root_polynomial,
    root_polynomial_color,
    rooted,
)
from chromanoise.color.training import Training, chart_training, training_response
from chromanoise.noise import with_noise
from chromanoise.spectra import equal_energy
from outcomes import refused_input
from strategies import EXPOSURE, GRID, bell_qe, raw_of, sensor_of, sensors

LAMP = equal_energy(GRID)
CHART = chart_training(LAMP)
THREE = sensor_of(bell_qe([450, 540, 610], [30, 35, 40], [0.5, 0.6, 0.7]))
LUX = 10.0


def seen_by(sensor=THREE):
    return training_response(CHART, sensor, EXPOSURE, level_lux=LUX)


@given(st.lists(st.floats(1e-3, 1e4), min_size=1, max_size=5), st.floats(1e-3, 1e3))
def test_roots_scale_with_exposure(electrons, gain):
    mean = np.array(electrons)
    np.testing.assert_allclose(rooted(gain * mean), gain * rooted(mean), rtol=1e-12)


def test_scaling_the_raw_scales_the_color_of_a_root_polynomial_and_bends_nothing():
    model = root_polynomial(THREE, EXPOSURE, CHART, level_lux=LUX)
    seen = seen_by()
    once, more = (
        root_polynomial_color(with_noise(g * seen.electrons, THREE), model).mean for g in (1, 37)
    )
    np.testing.assert_allclose(more, 37 * once, rtol=1e-10)
    brighter = root_polynomial(THREE, EXPOSURE, CHART, level_lux=1000 * LUX)
    np.testing.assert_allclose(brighter.matrix, model.matrix, rtol=1e-6)


@given(sensors())
def test_a_root_polynomial_of_linear_terms_is_least_squares_with_its_noise(sensor):
    model = root_polynomial(sensor, EXPOSURE, CHART, level_lux=LUX, degree=1)
    linear = least_squares(sensor, EXPOSURE, CHART, level_lux=LUX)
    raw = with_noise(seen_by(sensor).electrons, sensor)
    own, theirs = root_polynomial_color(raw, model), colored(raw, linear)
    np.testing.assert_allclose(model.matrix, linear.matrix, rtol=1e-12)
    np.testing.assert_allclose(own.covariance, theirs.covariance, rtol=1e-10, atol=1e-12)


@given(st.lists(st.floats(1.0, 1e4), min_size=1, max_size=4))
def test_the_jacobian_of_the_roots_is_their_central_difference(electrons):
    mean = np.array(electrons)
    jacobian = root_jacobian(mean)
    for i, step in enumerate(1e-4 * np.diag(mean)):
        slope = (rooted(mean + step) - rooted(mean - step)) / (2 * step[i])
        np.testing.assert_allclose(jacobian[:, i], slope, rtol=1e-7, atol=1e-9)


def test_noise_of_a_root_polynomial_is_that_of_draws_where_noise_is_small():
    model = root_polynomial(THREE, EXPOSURE, CHART, level_lux=LUX)
    mean = np.array([4e6, 5e6, 3e6])
    predicted = root_polynomial_color(raw_of(mean, np.diag(mean), THREE.names), model)
    draws, rng = 20_000, np.random.default_rng(7)
    raw = mean + np.sqrt(mean) * rng.standard_normal((draws, 3))
    seen = np.var(rooted(raw) @ model.matrix.T, axis=0, ddof=1)
    z = (seen / predicted.variance - 1) / np.sqrt(2 / (draws - 1))
    assert np.abs(z).max() < 5


def test_more_terms_never_fit_the_training_set_worse():
    seen = seen_by()
    errors = []
    for degree in (1, 2):
        model = root_polynomial(THREE, EXPOSURE, CHART, level_lux=LUX, degree=degree)
        color = rooted(seen.electrons, degree=degree) @ model.matrix.T
        errors.append(((color - seen.xyz) ** 2).sum())
    assert errors[1] < errors[0]


@pytest.mark.parametrize(
    ("call", "fields"),
    [
        (lambda: rooted(np.array([1.0, -1.0])), {"subject": "raw_mean", "value": -1.0}),
        (lambda: rooted(np.array([1.0]), degree=3), {"subject": "degree", "value": 3}),
        (lambda: root_jacobian(np.array([1.0, 0.0])), {"subject": "raw_mean", "value": 0.0}),
    ],
)
def test_what_has_no_root_or_no_slope_is_refused(call, fields):
    with refused_input(**fields):
        call()


def test_fewer_reflectances_than_terms_are_refused():
    two = Training(
        illuminant=LAMP, reflectance=np.ones((2, GRID.n)), names=("a", "b"), source="two walls"
    )
    with refused_input(subject="training set two walls", value=2, setting="degree"):
        root_polynomial(THREE, EXPOSURE, two, level_lux=LUX)
