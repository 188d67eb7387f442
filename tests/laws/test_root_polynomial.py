"""Root polynomials: blind to exposure, least squares where nothing bends, and noise under a root.

The noise: by Jacobian, bias of second order, exact moments, and where the first order ends.
"""

from unittest.mock import ANY

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import stats
from scipy.special import gamma

from chromanoise.color import colored
from chromanoise.color.matrices import least_squares
from chromanoise.color.root_polynomials import (
    RootPolynomial,
    root_first_order_error,
    root_jacobian,
    root_polynomial,
    root_polynomial_bias,
    root_polynomial_color,
    root_polynomial_color_exact,
    rooted,
)
from chromanoise.color.training import Training, chart_training, training_response
from chromanoise.noise import with_noise
from chromanoise.spectra import equal_energy
from goodness import covariance_z
from outcomes import refused_input
from strategies import EXPOSURE, GRID, bell_qe, pixel_with, raw_of, sensor_of, sensors

LAMP = equal_energy(GRID)
CHART = chart_training(LAMP)
QE = bell_qe([450, 540, 610], [30, 35, 40], [0.5, 0.6, 0.7])
THREE = sensor_of(QE)
CHANNELS = THREE.names
LUX = 10.0


def seen_by(sensor=THREE):
    return training_response(CHART, sensor, EXPOSURE, level_lux=LUX)


def polynomial_of(matrix, p, degree=2):
    matrix = np.array(matrix, dtype=float)
    return RootPolynomial(
        matrix=matrix,
        channels=CHANNELS[:p],
        coordinates=tuple(f"y{i}" for i in range(len(matrix))),
        degree=degree,
        made_by="by hand",
        metric="quanta",
    )


ROOT = polynomial_of([[0.0, 0.0, 1.0]], 2)
TERMS = polynomial_of(np.eye(6), 3)
MIX = polynomial_of([[1.0, -0.5, 0.2, 1.5, -0.7, 0.3], [0.1, 0.9, 0.1, -0.4, 0.6, -0.8]], 3)


def sensor_with(read_noise_e, p=2):
    return sensor_of(QE[:, :p], pixel=pixel_with(read_noise_e))


def bias_of_root(mean, covariance):
    return float(root_polynomial_bias(raw_of(mean, covariance, ("a", "b")), ROOT)[0])


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


def test_fewer_reflectances_than_terms_are_refused():
    two = Training(
        illuminant=LAMP, reflectance=np.ones((2, GRID.n)), names=("a", "b"), source="two walls"
    )
    with refused_input(subject="training set two walls", value=2, setting="degree"):
        root_polynomial(THREE, EXPOSURE, two, level_lux=LUX)


# second order


@pytest.mark.parametrize(
    ("covariance", "bias"),
    [
        ([[100.0, 0.0], [0.0, 25.0]], -0.3125),  # -1/8 x 50 x (1/100 + 1/25)
        ([[100.0, 20.0], [20.0, 25.0]], -0.2125),  # and 1/4 x 50 x 20 / (100 x 25) more
        ([[200.0, 0.0], [0.0, 125.0]], -1.375),  # 10 e- of readout: -1/8 x 50 x (2/100 + 5/25)
    ],
)
def test_bias_of_a_root_of_100_and_25_electrons_by_hand(covariance, bias):
    assert bias_of_root([100.0, 25.0], covariance) == pytest.approx(bias, rel=1e-14)


@pytest.mark.parametrize("correlation", [-0.9, 0.0, 0.6])
def test_bias_is_that_of_lognormal_channels_whose_root_is_known(correlation):
    # E sqrt(XY) = sqrt(E X E Y) exp(-var(log X - log Y) / 8), exactly
    sigma, other = 0.02, 0.03
    logs = np.array([[sigma**2, correlation * sigma * other], [0.0, other**2]])
    logs[1, 0] = logs[0, 1]
    mean = np.array([300.0, 40.0])
    level = np.sqrt(mean.prod())
    exact = level * np.expm1(-(logs[0, 0] + logs[1, 1] - 2 * logs[0, 1]) / 8)
    found = bias_of_root(mean, np.outer(mean, mean) * np.expm1(logs))
    assert found == pytest.approx(exact, rel=1e-3)
    assert found != pytest.approx(exact, rel=1e-7)  # the next order is there


@given(
    st.lists(st.floats(1.0, 1e4), min_size=3, max_size=3),
    st.lists(st.floats(-1.0, 1.0), min_size=9, max_size=9),
)
def test_bias_is_the_mean_of_second_differences_along_the_noise(mean, spread):
    # E f(m + R z) - f(m) = 1/2 sum of second derivatives along the columns of R
    mean = np.array(mean)
    directions = mean[:, None] * np.array(spread).reshape(3, 3)
    found = root_polynomial_bias(raw_of(mean, directions @ directions.T, CHANNELS), TERMS)
    step, here = 1e-3, rooted(mean)
    bends = [rooted(mean + step * d) - 2 * here + rooted(mean - step * d) for d in directions.T]
    expected = sum(bends) / (2 * step**2)
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-6 * mean.max())


@given(st.lists(st.floats(1e-2, 1e5), min_size=3, max_size=3), st.floats(0.0, 1.0))
def test_light_that_flickers_alike_in_all_channels_makes_no_bias(mean, flicker):
    mean = np.array(mean)
    raw = raw_of(mean, flicker**2 * np.outer(mean, mean), CHANNELS)
    np.testing.assert_allclose(root_polynomial_bias(raw, MIX), 0.0, atol=1e-12 * mean.max())


def test_linear_terms_have_no_bias():
    linear = polynomial_of([[1.0, 2.0]], 2, degree=1)
    raw = raw_of([[0.0, 3.0], [5.0, 6.0]], np.broadcast_to(np.eye(2), (2, 2, 2)), ("a", "b"))
    assert (root_polynomial_bias(raw, linear) == 0).all()


# exact moments


@pytest.mark.parametrize("s", [0.5, 2.0, 30.0])
def test_two_dark_channels_show_the_half_moments_of_their_read_noise(s):
    # E max(Z, 0)^k = 2^(k/2) Gamma((k + 1)/2) / (2 sqrt(pi)): .411 and .610 for k = 1/2 and 3/2
    half, three_halves = (
        2 ** (k / 2) * gamma((k + 1) / 2) / (2 * np.sqrt(np.pi)) for k in (0.5, 1.5)
    )
    assert half**2 == pytest.approx(0.168994, abs=1e-6)
    terms = polynomial_of(np.eye(3), 2)
    found = root_polynomial_color_exact(np.zeros(2), terms, read_noise_e=s)
    np.testing.assert_allclose(found.mean, [0.0, 0.0, s * half**2], rtol=1e-10, atol=1e-12)
    variance = s**2 * (1 / (2 * np.pi) - half**4)
    shared = s**2 * three_halves * half
    expected = [[s**2, 0.0, shared], [0.0, s**2, shared], [shared, shared, variance]]
    np.testing.assert_allclose(found.covariance, expected, rtol=1e-10, atol=1e-12)


def test_roots_of_poisson_electrons_are_those_of_a_double_sum():
    mean = np.array([3.0, 7.0])
    n = np.arange(60)
    weight = np.outer(stats.poisson.pmf(n, mean[0]), stats.poisson.pmf(n, mean[1]))
    terms = np.stack([*np.broadcast_arrays(n[:, None], n), np.sqrt(np.outer(n, n))])
    expected = (weight * terms).sum(axis=(1, 2))
    away = terms - expected[:, None, None]
    found = root_polynomial_color_exact(mean, polynomial_of(np.eye(3), 2), read_noise_e=0.0)
    np.testing.assert_allclose(found.mean, expected, rtol=1e-12)
    np.testing.assert_allclose(
        found.covariance, np.einsum("ij,aij,bij->ab", weight, away, away), rtol=1e-10, atol=1e-12
    )


@pytest.mark.parametrize("mean", [[0.0, 0.3, 5.0], [2.0, 2.0, 2.0], [40.0, 0.5, 300.0]])
@pytest.mark.parametrize("model", [TERMS, MIX])
def test_exact_color_and_covariance_are_those_of_draws_in_the_dark(mean, model):
    s, draws, rng = 2.0, 200_000, np.random.default_rng(11)
    raw = rng.poisson(mean, (draws, 3)) + s * rng.standard_normal((draws, 3))
    held = np.maximum(raw, 0.0)
    terms = np.concatenate([raw, rooted(held)[:, 3:]], axis=1)
    found = root_polynomial_color_exact(np.array(mean), model, read_noise_e=s)
    assert covariance_z(terms @ model.matrix.T, found.mean, found.covariance) < 5


def test_exact_color_of_a_picture_is_that_of_its_pixels():
    picture = np.array([[[1.0, 2.0, 3.0], [0.0, 5.0, 80.0]]])
    whole = root_polynomial_color_exact(picture, MIX, read_noise_e=1.0)
    for index in ((0, 0), (0, 1)):
        alone = root_polynomial_color_exact(picture[index], MIX, read_noise_e=1.0)
        np.testing.assert_allclose(whole.mean[index], alone.mean, rtol=1e-12)
        np.testing.assert_allclose(whole.covariance[index], alone.covariance, rtol=1e-10)


@pytest.mark.parametrize("read_noise_e", [0.0, 3.0])
def test_in_bright_light_the_exact_color_is_the_first_order_with_its_bias(read_noise_e):
    mean = np.array([4e5, 1e5, 2e5])
    raw = with_noise(mean, sensor_with(read_noise_e, 3))
    first = root_polynomial_color(raw, TERMS)
    exact = root_polynomial_color_exact(mean, TERMS, read_noise_e=read_noise_e)
    bias = root_polynomial_bias(raw, TERMS)
    assert (bias[3:] < -0.2).all()
    np.testing.assert_allclose(exact.mean - first.mean, bias, rtol=1e-4, atol=1e-8)
    np.testing.assert_allclose(exact.covariance, first.covariance, rtol=1e-5, atol=1.0)


# where the first order ends


def test_first_order_of_a_root_of_5_electrons_is_off_as_a_double_sum_tells():
    # first order: (m + m) / 4 of variance
    n = np.arange(60)
    weight = np.outer(*[stats.poisson.pmf(n, 5.0)] * 2)
    roots = np.sqrt(np.outer(n, n))
    exact = (weight * roots**2).sum() - (weight * roots).sum() ** 2
    found = root_first_order_error(np.full(2, 5.0), ROOT, sensor_with(0.0))
    assert float(found[0]) == pytest.approx(np.sqrt(2.5 / exact) - 1, rel=1e-9)


@pytest.mark.parametrize(("read_noise_e", "electrons"), [(0.0, 5.1), (2.0, 10.4), (10.0, 37.4)])
def test_first_order_is_5_percent_low_at_so_many_electrons_in_each_of_two_channels(
    read_noise_e, electrons
):
    levels = np.array([electrons - 0.2, electrons + 0.2])[:, None] * np.ones(2)
    error = root_first_order_error(levels, ROOT, sensor_with(read_noise_e))[:, 0]
    assert error[0] < -0.05 < error[1] < 0


def test_first_order_has_no_answer_where_a_channel_under_a_root_is_dark():
    error = root_first_order_error(np.array([[0.0, 9.0], [1e6, 1e6]]), ROOT, sensor_with(1.0))
    assert np.isposinf(error[0]).all()
    assert np.abs(error[1]).max() < 1e-5


def test_first_order_is_exact_for_linear_terms_light_or_not():
    linear = polynomial_of([[1.0, 2.0]], 2, degree=1)
    levels = np.array([[0.0, 0.0], [0.0, 4.0], [3.0, 4.0]])
    for read_noise_e in (0.0, 2.0):
        error = root_first_order_error(levels, linear, sensor_with(read_noise_e))
        np.testing.assert_allclose(error, 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("call", "subject", "value"),
    [
        (lambda: rooted(np.array([1.0, -1.0])), "raw_mean", -1.0),
        (lambda: rooted(np.array([1.0]), degree=3), "degree", 3),
        (lambda: root_jacobian(np.array([1.0, 0.0])), "raw_mean", 0.0),
        (lambda: bias_of_root([1.0, 0.0], np.eye(2)), "raw_mean", ANY),
        (lambda: root_polynomial_bias(raw_of([1.0, 2.0], np.eye(2)), ROOT), "color", ANY),
        (
            lambda: root_polynomial_color_exact(np.ones(3), ROOT, read_noise_e=1.0),
            "the number of channels",
            ANY,
        ),
        (lambda: root_polynomial_color_exact(-np.ones(2), ROOT, read_noise_e=1.0), "mean_e", ANY),
        (
            lambda: root_polynomial_color_exact(np.ones(2), ROOT, read_noise_e=-1.0),
            "read_noise_e",
            ANY,
        ),
        (lambda: root_first_order_error(-np.ones(2), ROOT, sensor_with(1.0)), "mean_e", ANY),
        (
            lambda: root_first_order_error(np.ones(3), ROOT, sensor_with(1.0, 3)),
            "the number of channels",
            ANY,
        ),
    ],
)
def test_what_is_no_raw_of_the_root_polynomial_is_refused(call, subject, value):
    with refused_input(subject=subject, value=value):
        call()
