"""Figures of merit against colour-science and scipy."""

import colour
import numpy as np
import pytest
from hypothesis import given
from scipy.linalg import subspace_angles
from scipy.optimize import minimize

from chromanoise.metrics.accuracy import metamerism
from chromanoise.metrics.filter_merit import principal_angles_deg, vora_value
from chromanoise.metrics.visual_noise import visual_noise_of_picture, visual_noise_of_white
from strategies import GRID, sensors

SHAPE = colour.SpectralShape(400, 700, 5)
OBSERVER = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
EYE = OBSERVER.copy().align(SHAPE).values
WHITE = np.array([1 / 3, 1 / 3])  # chromaticity of X = Y = Z


@given(sensors())
def test_principal_angles_are_those_of_scipy(sensor):
    eye = OBSERVER.copy().align(colour.SpectralShape(400, 700, 10)).values
    theirs = np.degrees(subspace_angles(sensor.qe, eye))[::-1]
    assert GRID.n == eye.shape[0]
    assert principal_angles_deg(sensor.qe, eye) == pytest.approx(theirs, abs=1e-7)
    assert vora_value(sensor.qe, eye) == pytest.approx(
        (np.cos(np.radians(theirs)) ** 2).sum() / 3, abs=1e-10
    )


def camera_patches(name):
    filters = colour.MSDS_CAMERA_SENSITIVITIES[name].copy().align(SHAPE).values
    lamp = colour.SDS_ILLUMINANTS["D55"].copy().align(SHAPE).values
    chart = list(colour.SDS_COLOURCHECKERS["ISO 17321-1"].values())[:18]
    return filters, lamp, np.array([sd.copy().align(SHAPE).values for sd in chart])


@pytest.mark.parametrize("name", ["Nikon 5100 (NPL)", "Sigma SDMerill (NPL)"])
def test_color_errors_behind_the_metamerism_index_are_those_of_colour_science(name):
    filters, lamp, patches = camera_patches(name)
    seen = metamerism(filters, EYE, lamp, patches)
    raw = (patches * lamp) @ filters / (lamp @ filters)
    truth = (patches * lamp) @ EYE / (lamp @ EYE)
    lab = [colour.XYZ_to_Lab(xyz, WHITE) for xyz in (raw @ seen.matrix.T, truth)]
    theirs = colour.difference.delta_E_CIE1976(*lab)
    assert seen.color_error == pytest.approx(theirs, abs=1e-6)
    assert seen.index == pytest.approx(100 - 5.5 * theirs.mean(), abs=1e-6)


@pytest.mark.parametrize("name", ["Nikon 5100 (NPL)", "Sigma SDMerill (NPL)"])
def test_a_search_without_gradients_finds_no_better_matrix(name):
    filters, lamp, patches = camera_patches(name)
    seen = metamerism(filters, EYE, lamp, patches)
    raw = (patches * lamp) @ filters / (lamp @ filters)
    truth = colour.XYZ_to_Lab((patches * lamp) @ EYE / (lamp @ EYE), WHITE)

    def mean_error(entries):
        lab = colour.XYZ_to_Lab(raw @ entries.reshape(3, 3).T, WHITE)
        return np.linalg.norm(lab - truth, axis=-1).mean()

    best = min(
        minimize(
            mean_error,
            start,
            method="Nelder-Mead",
            options={"adaptive": True, "maxfev": 1500, "fatol": 1e-9, "xatol": 1e-9},
        ).fun
        for start in (seen.matrix.ravel(), 1.02 * seen.matrix.ravel())
    )
    assert seen.color_error.mean() < best + 1e-4


def test_visual_noise_through_cieluv_of_colour_science_agrees_with_its_jacobian():
    mean = np.array([0.2, 0.2, 0.2])

    def luv(xyz):
        return colour.XYZ_to_Luv(xyz, WHITE)

    step = 1e-6
    jacobian = np.column_stack(
        [(luv(mean + step * e) - luv(mean - step * e)) / (2 * step) for e in np.eye(3)]
    )
    covariance = np.diag([1e-6, 2e-6, 3e-6])
    closed = visual_noise_of_white(covariance, jacobian, pixels_per_degree=40.0)
    noise = np.random.default_rng(8).normal(size=(256, 256, 3)) * np.sqrt(np.diag(covariance))
    seen = visual_noise_of_picture(mean + noise, luv, pixels_per_degree=40.0)
    # 65 536 pixels, of which the eye's filter leaves a few thousand independent: 2 % is 3 sigma
    assert seen.sigma_luv == pytest.approx(closed.sigma_luv, rel=0.03)
