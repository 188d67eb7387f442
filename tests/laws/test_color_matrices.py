"""Fitted color matrices: what each one promises, for any sensor."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.optimize import minimize

from chromanoise.color import colored
from chromanoise.color.matrices import (
    bounded_psi,
    kernel,
    least_squares,
    lmmse,
    lmmse_over_light,
    noise_gain,
    noise_regularized,
    pareto,
    ridge,
    white_normalized,
    white_preserving,
)
from chromanoise.color.training import (
    Training,
    chart_training,
    light_second_moment,
    nir_diverse,
    smooth_training,
    training_response,
)
from chromanoise.metrics import chart_color_error, snr_db
from chromanoise.metrics.accuracy import effective_filters, matrix_report
from chromanoise.noise import Exposure, measurement_vectors, with_noise
from chromanoise.sensor import PAPER_PIXEL, Sensor, with_channels
from chromanoise.spectra import DEFAULT_GRID, cie_1931, cie_a, color_axes, equal_energy
from chromanoise.study import sensor_named
from outcomes import refused_input
from strategies import EXPOSURE, GRID, bell_qe, sensor_of, sensors

LAMP = equal_energy(GRID)
PRIOR = smooth_training(LAMP)
CHART = chart_training(LAMP)
THREE = sensor_of(bell_qe([450, 540, 610], [30, 35, 40], [0.5, 0.6, 0.7]))
LUX = 10.0

METHODS = {
    "kernel": kernel,
    "least squares": least_squares,
    "white-preserving": white_preserving,
    "lmmse": lmmse,
    "ridge": partial(ridge, strength=1e-3),
    "noise weighted": partial(noise_regularized, weight=0.3),
    "bounded psi": partial(bounded_psi, limit=2.5),
}
each_method = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS.keys())


def fit(method, sensor=THREE, training=CHART, level_lux=LUX, **more):
    return method(sensor, EXPOSURE, training, level_lux=level_lux, **more).matrix


def seen_by(sensor=THREE, training=CHART, level_lux=LUX):
    return training_response(training, sensor, EXPOSURE, level_lux=level_lux)


def expected_squared_error(matrix, sensor, training, level_lux):
    """E|C S - XYZ|^2 with noise, from the n x n second moment of light."""
    K = light_second_moment(training, level_lux=level_lux)
    F, H = measurement_vectors(sensor, EXPOSURE, "quanta"), color_axes(GRID, "quanta")
    missed = H - F @ matrix.T
    noise = seen_by(sensor, training, level_lux).noise_e2
    return np.trace(missed.T @ K @ missed) + np.trace(matrix @ noise @ matrix.T)


def observer_sensor(grid=GRID):
    """Channels that are a mix of the color axes: nothing stands between it and exact color."""
    axes = cie_1931(grid).values / grid.wavelength_nm[:, None]
    mixed = axes @ np.array([[2.0, 1, 0], [1, 3, 0], [0, 1, 1]])
    return Sensor(
        name="eye", grid=grid, qe=0.9 * mixed / mixed.max(), names=("a", "b", "c"),
        pixel=PAPER_PIXEL,
    )  # fmt: skip


@given(sensors(), st.lists(st.floats(-1, 1), min_size=4, max_size=4))
def test_the_kernel_is_exact_on_light_that_the_channels_span(sensor, amounts):
    F, H = measurement_vectors(sensor, EXPOSURE, "quanta"), color_axes(GRID, "quanta")
    span = F @ np.array(amounts)[: F.shape[1]]
    size = float((np.linalg.norm(H, axis=0) * np.linalg.norm(span)).max())
    np.testing.assert_allclose(fit(kernel, sensor) @ F.T @ span, H.T @ span, atol=1e-9 * size)


@given(sensors())
def test_least_squares_is_the_wiener_filter_without_noise(sensor):
    K = light_second_moment(PRIOR, level_lux=LUX)
    F, H = measurement_vectors(sensor, EXPOSURE, "quanta"), color_axes(GRID, "quanta")
    wiener = np.linalg.solve(F.T @ K @ F, F.T @ K @ H).T
    for matrix in (
        fit(least_squares, sensor, PRIOR),
        fit(noise_regularized, sensor, PRIOR, weight=0.0),
        fit(lmmse, sensor, PRIOR, level_lux=1e14),
    ):
        np.testing.assert_allclose(matrix, wiener, rtol=1e-7, atol=1e-8 * np.abs(wiener).max())


@given(sensors(), st.floats(1e-3, 1e3))
def test_lmmse_is_the_wiener_filter_of_light_in_either_metric(sensor, level_lux):
    noise = seen_by(sensor, PRIOR, level_lux).noise_e2
    for metric in ("quanta", "energy"):
        K = light_second_moment(PRIOR, level_lux=level_lux, metric=metric)
        F, H = measurement_vectors(sensor, EXPOSURE, metric), color_axes(GRID, metric)
        wiener = np.linalg.solve(F.T @ K @ F + noise, F.T @ K @ H).T
        matrix = fit(lmmse, sensor, PRIOR, level_lux, metric=metric)
        np.testing.assert_allclose(matrix, wiener, rtol=1e-7, atol=1e-9 * np.abs(wiener).max())


@given(sensors(), st.floats(1e-2, 1e3))
def test_under_its_own_prior_lmmse_errs_least(sensor, level_lux):
    def error(method):
        matrix = fit(method, sensor, PRIOR, level_lux)
        return expected_squared_error(matrix, sensor, PRIOR, level_lux)

    best = error(lmmse)
    for method in (kernel, least_squares, white_preserving, METHODS["ridge"]):
        assert best <= error(method) * (1 + 1e-9)


@given(sensors(min_channels=2), st.floats(1e-2, 1e3))
def test_one_more_channel_never_makes_lmmse_err_more(sensor, level_lux):
    fewer = with_channels(sensor, sensor.names[:-1], name="fewer")
    errors = [
        expected_squared_error(fit(lmmse, s, PRIOR, level_lux), s, PRIOR, level_lux)
        for s in (fewer, sensor)
    ]
    assert errors[1] <= errors[0] * (1 + 1e-9)


@given(sensors())
def test_white_preserving_is_exact_on_the_white_and_solves_its_lagrange_equations(sensor):
    seen, p = seen_by(sensor), len(sensor.names)
    matrix = fit(white_preserving, sensor)
    np.testing.assert_allclose(matrix @ seen.white_e, seen.white_xyz, rtol=1e-10)
    relative = seen.electrons / seen.white_e  # well-scaled, so that the KKT system can be solved
    kkt = np.zeros((p + 1, p + 1))
    kkt[:p, :p], kkt[:p, p], kkt[p, :p] = relative.T @ relative, 1.0, 1.0
    answer = np.vstack([relative.T @ seen.xyz, seen.white_xyz])
    expected = np.linalg.solve(kkt, answer)[:p].T / seen.white_e
    np.testing.assert_allclose(matrix, expected, rtol=1e-6, atol=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("method", [kernel, least_squares, white_preserving])
def test_on_the_eyes_own_channels_every_exact_method_gives_the_same_exact_matrix(method):
    eye = observer_sensor()
    seen, matrix = seen_by(eye), fit(method, eye)
    np.testing.assert_allclose(matrix, fit(least_squares, eye), rtol=1e-9, atol=1e-14)
    np.testing.assert_allclose(seen.electrons @ matrix.T, seen.xyz, rtol=1e-9)


def test_ridge_goes_from_least_squares_to_nothing():
    free = fit(least_squares)
    np.testing.assert_allclose(fit(ridge, strength=0.0), free, rtol=1e-10)
    np.testing.assert_allclose(fit(ridge, strength=1e-12), free, rtol=1e-6)
    norms = [np.linalg.norm(fit(ridge, strength=10.0**k)) for k in range(-12, 13, 3)]
    assert np.all(np.diff(norms) < 0)
    assert norms[-1] < 1e-11 * norms[0]


@given(sensors(), st.floats(0.1, 1e3))
def test_color_error_rises_as_noise_falls_and_the_weight_is_the_slope(sensor, level_lux):
    weights = np.logspace(-3, 3, 61)
    curve = pareto(sensor, EXPOSURE, CHART, weights, level_lux=level_lux)
    error, noise = curve.color_error_rms**2, curve.noise_rms**2
    # rounding: the error of an exact fit has digits only down to eps of the light
    scale = (seen_by(sensor, level_lux=level_lux).xyz ** 2).sum(axis=1).mean()
    rises, falls = np.diff(error), -np.diff(noise)
    assert np.all(rises >= -1e-12 * scale)
    assert np.all(falls >= -1e-12 * noise[:-1])
    # d error / d noise = -w, and the chord of a convex curve lies between its end slopes
    assert np.all(rises >= weights[:-1] * falls * (1 - 1e-6) - 1e-12 * scale)
    assert np.all(rises <= weights[1:] * falls * (1 + 1e-6) + 1e-12 * scale)


def test_the_pareto_curve_is_made_of_the_matrices_that_each_weight_gives():
    weights = np.array([0.0, 0.01, 1.0, 100.0])
    curve = pareto(THREE, EXPOSURE, CHART, weights, level_lux=0.3)
    seen = seen_by(level_lux=0.3)
    for i, weight in enumerate(weights):
        made = noise_regularized(THREE, EXPOSURE, CHART, level_lux=0.3, weight=weight)
        np.testing.assert_allclose(curve.matrix[i], made.matrix, rtol=1e-9)
        white = snr_db(colored(with_noise(seen.white_e, THREE), made))
        assert curve.snr_y_db[i] == pytest.approx(float(white["Y"]), abs=1e-9)
        # the chart of merit.chart_color_error is the same 24 patches
        patches = chart_color_error(THREE, made, EXPOSURE, LAMP)
        assert curve.delta_e[i] == pytest.approx(patches.mean(), rel=1e-9)
    np.testing.assert_allclose(curve.matrix[2], fit(lmmse, level_lux=0.3), rtol=1e-9)


@pytest.mark.parametrize("limit", [0.5, 1.5, 2.2, 2.5])
def test_bounded_psi_is_the_constrained_minimum_that_a_general_solver_finds(limit):
    seen = seen_by()
    relative, target = seen.electrons / seen.white_e, seen.xyz / seen.white_xyz

    def loss(n):
        return (seen.white_xyz**2 * (relative @ n.reshape(3, 3).T - target) ** 2).sum() / 24

    own = white_normalized(fit(bounded_psi, limit=limit), seen.white_e, seen.white_xyz)
    assert noise_gain(own) == pytest.approx(limit, abs=1e-6)
    room = {"type": "ineq", "fun": lambda n: limit - noise_gain(n.reshape(3, 3))}
    start = 0.1 * limit * np.eye(3).ravel()
    theirs = minimize(
        loss, start, method="SLSQP", constraints=[room], options={"maxiter": 500, "ftol": 1e-13}
    )
    assert loss(own.ravel()) <= theirs.fun * (1 + 1e-6)
    np.testing.assert_allclose(own.ravel(), theirs.x, atol=2e-3)


def test_bounded_psi_is_least_squares_where_the_limit_is_slack():
    free, seen = fit(least_squares), seen_by()
    psi = noise_gain(white_normalized(free, seen.white_e, seen.white_xyz))
    np.testing.assert_array_equal(fit(bounded_psi, limit=psi * (1 + 1e-9)), free)
    np.testing.assert_allclose(fit(bounded_psi, limit=psi * (1 - 1e-7)), free, rtol=1e-4)


@given(sensors(min_channels=2), st.floats(0.05, 20.0))
def test_bounded_psi_obeys_its_limit_for_any_sensor(sensor, limit):
    seen = seen_by(sensor)
    bounded = fit(bounded_psi, sensor, limit=limit)
    psi = noise_gain(white_normalized(bounded, seen.white_e, seen.white_xyz))
    assert psi <= limit * (1 + 1e-12)
    free = noise_gain(white_normalized(fit(least_squares, sensor), seen.white_e, seen.white_xyz))
    assert psi == pytest.approx(min(limit, free), abs=1e-6)


@each_method
def test_permuting_the_channels_permutes_the_columns(method):
    order = ("c", "a", "b")
    columns = [THREE.names.index(name) for name in order]
    turned = fit(method, with_channels(THREE, order, name="turned"))
    np.testing.assert_allclose(turned, fit(method)[:, columns], rtol=1e-8)


@each_method
def test_the_metric_decides_the_kernel_alone(method):
    pair = [fit(method, metric=metric) for metric in ("quanta", "energy")]
    same = np.allclose(*pair, rtol=1e-9, atol=0)
    assert same == (method is not kernel)


def test_lmmse_becomes_least_squares_in_bright_light_and_lets_go_in_the_dark():
    seen = seen_by(level_lux=1.0)
    gains = [
        noise_gain(white_normalized(fit(lmmse, level_lux=lux), seen.white_e, seen.white_xyz))
        for lux in (1e-3, 1e-2, 1e-1, 1.0, 10.0, 100.0, 1e9)
    ]
    assert np.all(np.diff(gains) > 0)
    assert gains[0] < 1e-3 * gains[-1]
    np.testing.assert_allclose(fit(lmmse, level_lux=1e12), fit(least_squares), rtol=1e-8)


def test_near_infrared_metamers_teach_a_matrix_that_infrared_has_no_color():
    sensor, lamp = sensor_named("onyx-rgbw", DEFAULT_GRID), equal_energy(DEFAULT_GRID)
    exposure, chart = Exposure(time_s=0.012), chart_training(lamp)
    reports = [
        matrix_report(
            least_squares(sensor, exposure, training, level_lux=LUX),
            sensor,
            exposure,
            lamp,
            level_lux=LUX,
        )
        for training in (chart, nir_diverse(chart))
    ]
    for coordinate in "XYZ":
        alone, taught = (abs(report.nir_color[coordinate]) for report in reports)
        assert taught < alone / 3
        assert taught < 0.015


def test_near_infrared_metamers_keep_the_visible_and_their_color():
    lamp = cie_a(DEFAULT_GRID)
    chart = chart_training(lamp)
    diverse = nir_diverse(replace(chart, weights=np.arange(1.0, 25.0)), levels=(0.1, 0.9))
    visible = DEFAULT_GRID.wavelength_nm <= 700
    assert len(diverse.names) == 5 * 24
    for i in range(5):
        rows = diverse.reflectance[24 * i : 24 * (i + 1)]
        np.testing.assert_array_equal(rows[:, visible], chart.reflectance[:, visible])
        np.testing.assert_array_equal(diverse.weights[24 * i : 24 * (i + 1)], np.arange(1.0, 25.0))
    ends = np.unique(diverse.reflectance[24:, -1].round(12))
    np.testing.assert_array_equal(ends, [0.1, 0.9])
    sensor = sensor_named("onyx-rgbw", DEFAULT_GRID)
    seen = training_response(diverse, sensor, EXPOSURE, level_lux=1.0)
    moved = seen.xyz.reshape(5, 24, 3) - seen.xyz[:24]
    assert np.abs(moved).max() < 0.005 * seen.white_xyz.max()


@pytest.mark.parametrize("width_nm", [20.0, 50.0, 120.0])
def test_the_smooth_set_has_exactly_the_moments_of_its_prior(width_nm):
    prior = smooth_training(equal_energy(DEFAULT_GRID), mean=0.4, sd=0.05, width_nm=width_nm)
    covariance = np.cov(prior.reflectance.T, bias=True)
    np.testing.assert_allclose(prior.reflectance.mean(axis=0), 0.4, rtol=1e-12)
    steps = np.arange(0, 131, 10)
    expected = 0.0025 * np.exp(-((5.0 * steps) ** 2) / (2 * width_nm**2))
    np.testing.assert_allclose(covariance[0, steps], expected, atol=1e-13)
    np.testing.assert_allclose(np.diag(covariance), 0.0025, rtol=1e-9)


def test_weights_count_as_repetitions():
    twice = Training(
        illuminant=LAMP,
        reflectance=np.vstack([CHART.reflectance, CHART.reflectance[:5]]),
        names=tuple(f"patch {i}" for i in range(29)),
        source="with repetitions",
    )
    weighted = replace(CHART, weights=np.where(np.arange(24) < 5, 2.0, 1.0))
    for method in METHODS.values():
        np.testing.assert_allclose(
            fit(method, training=twice), fit(method, training=weighted), rtol=1e-8
        )


@each_method
def test_a_channel_that_stands_twice_is_an_answer_and_shares_alike(method):
    twins = sensor_of(THREE.qe[:, [0, 1, 2, 2]])
    made = method(twins, EXPOSURE, CHART, level_lux=LUX)
    assert made.frame.rank == 3
    np.testing.assert_allclose(made.matrix[:, 2], made.matrix[:, 3], rtol=1e-6)
    if method in (kernel, least_squares, white_preserving):
        split = fit(method) / np.array([1, 1, 2])
        np.testing.assert_allclose(made.matrix, split[:, [0, 1, 2, 2]], rtol=1e-6)


def test_a_channel_that_stands_twice_leaves_a_nearly_slack_bound_on_psi_alone():
    twins, seen = sensor_of(THREE.qe[:, [0, 1, 2, 2]]), seen_by()
    white_e = seen.white_e[[0, 1, 2, 2]]
    free = fit(least_squares, twins)
    psi = noise_gain(white_normalized(free, white_e, seen.white_xyz))
    np.testing.assert_allclose(fit(bounded_psi, twins, limit=psi * (1 - 1e-9)), free, rtol=1e-5)


@each_method
@pytest.mark.parametrize("channels", [1, 2])
def test_fewer_channels_than_colors_are_fitted_as_well_as_they_can(method, channels):
    few = sensor_of(THREE.qe[:, :channels])
    assert fit(method, few).shape == (3, channels)


@pytest.mark.parametrize("metric", ["quanta", "energy"])
def test_the_effective_filters_of_an_exact_matrix_are_the_color_axes(metric):
    eye = observer_sensor()
    filters = effective_filters(
        kernel(eye, EXPOSURE, CHART, level_lux=LUX, metric=metric), eye, EXPOSURE
    )
    axes = color_axes(GRID, metric)
    np.testing.assert_allclose(filters, axes, atol=1e-9 * axes.max())


def test_the_report_on_the_eye_itself_finds_no_error_and_no_infrared():
    eye, lamp = observer_sensor(DEFAULT_GRID), equal_energy(DEFAULT_GRID)
    matrix = kernel(eye, EXPOSURE, chart_training(lamp), level_lux=LUX)
    report = matrix_report(matrix, eye, EXPOSURE, lamp, level_lux=LUX)
    assert report.color_error_max == pytest.approx(0.0, abs=1e-9)
    assert 0 < report.nir_color["Y"] < 0.001  # y-bar is not zero beyond 700 nm
    assert report.psi >= np.sqrt(3) - 1e-9  # a row that sums to 1 has a norm of at least 3^-1/2
    y = color_axes(DEFAULT_GRID, "quanta")[:, 1]  # 61 of the grid's wavelengths end at 700 nm
    assert report.nir_norm["Y"] == pytest.approx(np.linalg.norm(y[61:]) / np.linalg.norm(y[:61]))


def test_a_saturated_channel_leaves_the_matrix_without_an_snr():
    eye, lamp = observer_sensor(DEFAULT_GRID), equal_energy(DEFAULT_GRID)
    matrix = kernel(eye, EXPOSURE, chart_training(lamp), level_lux=LUX)
    assert matrix_report(matrix, eye, EXPOSURE, lamp, level_lux=1e4).snr_db is None


def test_a_matrix_that_gives_no_color_is_reported_without_one():
    eye, lamp = observer_sensor(DEFAULT_GRID), equal_energy(DEFAULT_GRID)
    matrix = kernel(eye, EXPOSURE, chart_training(lamp), level_lux=LUX)
    grey = replace(matrix, matrix=matrix.matrix * np.array([[0.0], [1.0], [0.0]]))
    report = matrix_report(grey, eye, EXPOSURE, lamp, level_lux=LUX)
    assert report.color_error_mean is None
    assert report.nir_color is None
    assert report.condition == np.inf


SMOOTH = "smoothness prior of mean 0.9 and sd 0.2"


@pytest.mark.parametrize(
    ("call", "fields"),
    [
        (lambda: nir_diverse(CHART), {"subject": "grid of the training set"}),
        (lambda: smooth_training(LAMP, mean=0.9, sd=0.2), {"subject": SMOOTH}),
        (lambda: fit(ridge, strength=-1.0), {"subject": "strength of ridge", "value": -1.0}),
        (lambda: fit(noise_regularized, weight=-1.0), {"value": -1.0}),
        (lambda: fit(bounded_psi, limit=0.0), {"value": 0.0}),
        (lambda: pareto(THREE, EXPOSURE, CHART, np.array([-1.0]), level_lux=1.0), {"value": -1.0}),
        (lambda: fit(lmmse, training=chart_training(equal_energy(DEFAULT_GRID))), {}),
        (lambda: replace(CHART, weights=np.zeros(24)), {"value": 0.0}),
        (
            lambda: replace(CHART, reflectance=CHART.reflectance[:3]),
            {"subject": "the number of reflectances"},
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_fitted_is_refused_with_a_reason(call, fields):
    with refused_input(**fields):
        call()


def test_lmmse_over_many_levels_is_lmmse_at_each_of_them():
    sensor = sensor_named("onyx-rgbw", DEFAULT_GRID)
    lamp = equal_energy(DEFAULT_GRID)
    training, exposure = nir_diverse(chart_training(lamp)), Exposure(time_s=0.0119)
    levels = np.array([0.01, 0.3, 10.0, 1e4])
    together = lmmse_over_light(sensor, exposure, training, levels)
    for level, matrix in zip(levels, together, strict=True):
        alone = lmmse(sensor, exposure, training, level_lux=float(level)).matrix
        np.testing.assert_allclose(matrix, alone, rtol=1e-7, atol=1e-12 * np.abs(alone).max())
