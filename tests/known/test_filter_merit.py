"""Printed and hand-derived figures of merit of filters, and the one formula that holds them all."""

import colour
import numpy as np
import pytest

from chromanoise.color import kernel_matrix
from chromanoise.metrics.accuracy import metamerism
from chromanoise.metrics.filter_merit import (
    best_readout,
    figure_of_merit,
    filter_quality,
    perceptual_weight,
    principal_angles_deg,
    readout_error,
    second_moment,
    vora_value,
)
from chromanoise.noise import measurement_vectors
from chromanoise.spectra import color_axes
from strategies import EXPOSURE, GRID, bell_qe, sensor_of

SHAPE = colour.SpectralShape(400, 700, 5)
NIKON, MERRILL = "Nikon 5100 (NPL)", "Sigma SDMerill (NPL)"
EYE = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(SHAPE).values


def camera(name):
    """Per unit of radiant power, 400-700 nm @5, resampled by colour-science (Sprague)."""
    return colour.MSDS_CAMERA_SENSITIVITIES[name].copy().align(SHAPE).values


def chart_of(name):
    patches = list(colour.SDS_COLOURCHECKERS[name].values())[:18]
    return np.array([sd.copy().align(SHAPE).values for sd in patches])


def d55():
    return colour.SDS_ILLUMINANTS["D55"].copy().align(SHAPE).values


def plain(filters, eye, *, light=None, noise=None):
    """K and D, the identity and nothing where not given."""
    n, p = filters.shape
    return {
        "light_moment": np.eye(n) if light is None else light,
        "noise_covariance": np.zeros((p, p)) if noise is None else noise,
    }


@pytest.fixture(scope="module")
def lights():
    """200 correlated lights on GRID."""
    rng = np.random.default_rng(5)
    return np.abs(np.cumsum(rng.normal(size=(200, GRID.n)), axis=1)) + 0.1


FILTERS = bell_qe([610.0, 540.0, 455.0], [40.0, 45.0, 30.0], [0.5, 0.6, 0.4])
AXES = color_axes(GRID, "quanta") / color_axes(GRID, "quanta").max()


# docs/numbers.md, computed for this project from the curves of Darrodi et al., JOSA A 32 (2015)


@pytest.mark.parametrize(("name", "index"), [(NIKON, 90.82), (MERRILL, 81.27)])
def test_metamerism_index_of_measured_cameras(name, index):
    # D55, the 18 colors that ISO 17321-1 shares with Ohta's chart; white not held
    seen = metamerism(camera(name), EYE, d55(), chart_of("ISO 17321-1"))
    assert seen.index == pytest.approx(index, abs=5e-3)


def test_a_camera_that_mixes_the_eyes_axes_has_index_100():
    mixed = EYE @ np.array([[1.0, 0.3, 0.1], [0.2, 1.0, 0.3], [0.0, 0.1, 1.0]])
    assert metamerism(mixed, EYE, d55(), chart_of("ISO 17321-1")).index == pytest.approx(
        100, abs=1e-6
    )


# by hand


def test_a_filter_tilted_out_of_the_eyes_plane_is_judged_by_its_angle():
    eye = np.eye(4)[:, :2]
    tilt = np.radians(20.0)
    filters = np.column_stack([np.eye(4)[:, 0], np.cos(tilt) * np.eye(4)[:, 1]])
    filters[2, 1] = np.sin(tilt)
    assert filter_quality(7.0 * filters, eye) == pytest.approx([1.0, np.cos(tilt) ** 2])
    assert principal_angles_deg(filters, eye) == pytest.approx([0.0, 20.0], abs=1e-12)
    assert vora_value(filters, eye) == pytest.approx((1.0 + np.cos(tilt) ** 2) / 2.0)


def test_an_angle_of_a_millionth_of_a_degree_is_told_to_six_digits():
    eye, small = np.eye(3)[:, :1], np.radians(1e-6)
    tilted = np.array([[np.cos(small)], [np.sin(small)], [0.0]])
    assert principal_angles_deg(tilted, eye) == pytest.approx([1e-6], rel=1e-6)


def test_a_white_channel_that_repeats_the_others_adds_nothing_to_the_vora_value():
    more = np.column_stack([FILTERS, FILTERS.sum(axis=1)])
    assert vora_value(more, AXES) == pytest.approx(vora_value(FILTERS, AXES), rel=1e-12)


# one figure of merit holds most


def test_without_prior_or_noise_the_merit_is_the_vora_value():
    for name in (NIKON, MERRILL):
        filters = camera(name)
        weight = np.linalg.inv(EYE.T @ EYE)
        merit = figure_of_merit(filters, EYE, weight=weight, **plain(filters, EYE))
        angles = np.radians(principal_angles_deg(filters, EYE))
        assert merit == pytest.approx(np.mean(np.cos(angles) ** 2), abs=1e-10)
        assert merit == pytest.approx(vora_value(filters, EYE), abs=1e-10)


def test_with_one_filter_as_target_and_the_eye_as_filters_the_merit_is_q():
    for name in (NIKON, MERRILL):
        for filter_, q in zip(camera(name).T, filter_quality(camera(name), EYE), strict=True):
            target = filter_[:, None]
            merit = figure_of_merit(EYE, target, weight=np.eye(1), **plain(EYE, target))
            residual = np.linalg.lstsq(EYE, target, rcond=None)[1][0]
            assert merit == pytest.approx(1.0 - residual / (filter_ @ filter_), abs=1e-10)
            assert merit == pytest.approx(q, abs=1e-10)


def test_without_prior_or_noise_the_readout_is_the_kernel_matrix():
    for metric in ("quanta", "energy"):
        sensor = sensor_of(FILTERS)
        kernel = kernel_matrix(sensor, EXPOSURE, metric).matrix
        basis, axes = measurement_vectors(sensor, EXPOSURE, metric), color_axes(GRID, metric)
        readout = best_readout(basis, axes, **plain(basis, axes))
        assert readout == pytest.approx(kernel, rel=1e-10, abs=1e-10 * np.abs(kernel).max())


def test_the_readout_tends_to_the_kernel_as_the_noise_dies():
    kernel = best_readout(FILTERS, AXES, **plain(FILTERS, AXES))
    for noise in (1e-12, 1e-14):
        seen = best_readout(FILTERS, AXES, **plain(FILTERS, AXES, noise=noise * np.eye(3)))
        assert np.abs(seen - kernel).max() < 10 * noise * np.abs(kernel).max()


def test_white_noise_makes_the_readout_a_ridge_regression():
    # ridge by its other definition: least squares with s times the identity as further rows
    s = 0.3
    rows = np.vstack([FILTERS, s * np.eye(3)])
    ridge = np.linalg.lstsq(rows, np.vstack([AXES, np.zeros((3, 3))]), rcond=None)[0].T
    readout = best_readout(FILTERS, AXES, **plain(FILTERS, AXES, noise=s**2 * np.eye(3)))
    assert readout == pytest.approx(ridge, abs=1e-10)


def test_moments_from_data_give_the_error_summed_over_samples(lights):
    # Sharma & Trussell (1997): perceptual error, here each pair of a Jacobian and a light in turn
    jacobians = np.random.default_rng(6).normal(size=(7, 3, 3))
    noise = np.diag([0.5, 0.3, 0.8])
    given = plain(FILTERS, AXES, light=second_moment(lights), noise=noise)
    readout = best_readout(FILTERS, AXES, **given)
    wanted = total = 0.0
    for j in jacobians:
        errors = (lights @ AXES - lights @ FILTERS @ readout.T) @ j.T
        from_noise = (j @ readout) * np.sqrt(np.diag(noise))
        total += (errors**2).sum(axis=1).mean() + (from_noise**2).sum()
        wanted += ((lights @ AXES @ j.T) ** 2).sum(axis=1).mean()
    merit = figure_of_merit(FILTERS, AXES, weight=perceptual_weight(jacobians), **given)
    assert merit == pytest.approx(1.0 - total / wanted, abs=1e-10)


def test_the_error_left_is_that_of_the_readout_on_the_samples(lights):
    given = plain(FILTERS, AXES, light=second_moment(lights))
    errors = lights @ AXES - lights @ FILTERS @ best_readout(FILTERS, AXES, **given).T
    assert readout_error(FILTERS, AXES, **given) == pytest.approx(
        errors.T @ errors / len(lights), abs=1e-10
    )


def test_shot_noise_lowers_the_merit_of_one_channel_as_snr_does():
    # one line of light, one channel: FOM = SNR^2 / (1 + SNR^2), SNR^2 = M with shot noise only
    one = np.eye(1)
    for electrons in (0.1, 10.0, 1000.0):
        merit = figure_of_merit(
            electrons * one, one, light_moment=one, noise_covariance=electrons * one, weight=one
        )
        assert merit == pytest.approx(electrons / (1.0 + electrons), abs=1e-12)
