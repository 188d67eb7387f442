"""Total color error: bias and noise of the ColorChecker together."""

import gc
import tracemalloc
from dataclasses import replace

import colour
import numpy as np
import pytest

import chromanoise as cn
from chromanoise.base.rng import stream
from chromanoise.color import scene_xyz
from chromanoise.metrics import viewed_covariance
from chromanoise.spectra import DEFAULT_GRID, Scene, Spectra, colorchecker
from chromanoise.study import (
    Viewing,
    lost_colors,
    mean_total_error,
    total_error_as_viewed,
    total_errors,
)
from chromanoise.study.analysis import electrons_at
from chromanoise.study.color_noise import PLANE, total_errors_of

DRAWS = 20_000


def outcome(name, **settings):
    (one,) = cn.analyze(name, **settings).outcomes
    return one.analysis


def lab_of(xyz, white):
    return colour.XYZ_to_Lab(xyz / white, np.array([1.0, 1.0]) / 3)


@pytest.mark.parametrize("sensor", ["onyx-rgb-ircut", "onyx-rgbw"])
def test_the_total_error_is_the_root_mean_square_distance_of_draws_to_the_true_color(sensor):
    analysis = outcome(sensor, lux=300.0, time_ms=12.0 / 30, prnu=0.01)
    point, matrix = analysis.point, analysis.matrix.matrix
    chart = colorchecker(point.sensor.grid).values.T
    scene = Scene(illuminant=point.illuminant, level_lux=point.level_lux, reflectance=chart)
    white = Scene(
        illuminant=point.illuminant, level_lux=point.level_lux, reflectance=np.ones(chart.shape[1])
    )
    true = lab_of(scene_xyz(scene), scene_xyz(white))
    own_white = matrix @ electrons_at(point)
    rng = stream(3, 1)
    mean = electrons_at(point, reflectance=chart)
    gain = 1 + 0.01 * rng.standard_normal((DRAWS, *mean.shape))
    drawn = rng.poisson(mean * gain) + 10.0 * rng.standard_normal(gain.shape)
    lab = lab_of(drawn @ matrix.T, own_white)
    square = ((lab - true) ** 2).sum(axis=-1)
    expected, error = square.mean(axis=0), square.std(axis=0) / np.sqrt(DRAWS)
    own = total_errors(point, analysis.matrix)
    bright = mean.min(axis=-1) > 30  # below, counts are not normal
    z = (own.total**2 - expected) / error
    assert bright.sum() >= 20
    assert (np.abs(z[bright]) < 5).all()
    np.testing.assert_allclose(own.total**2, own.bias**2 + own.noise**2, rtol=1e-12)


def test_with_much_light_the_total_error_is_the_color_error_without_noise():
    names = {"lux": 1e4, "time_ms": 1000.0, "full_well_e": 1e12}
    analysis = outcome("onyx-rgb-ircut", **names)
    assert mean_total_error(analysis) == pytest.approx(10.312, abs=0.01)  # `color_error_mean`


def test_a_black_level_error_adds_to_the_total_error_and_not_to_the_noise():
    plain, wrong = (outcome("onyx-rgb-ircut", lux=10, black_error_e=b) for b in (0.0, 100.0))
    before, after = (total_errors(one.point, one.matrix) for one in (plain, wrong))
    assert after.bias[-1] > before.bias[-1] + 2  # the black patch, which is tinted
    assert after.noise.mean() == pytest.approx(before.noise.mean(), rel=0.2)
    assert cn.analyze("onyx-rgb-ircut", lux=10, black_error_e=100.0).color_snr_db() == (
        cn.analyze("onyx-rgb-ircut", lux=10).color_snr_db()
    )


def test_where_a_matrix_loses_the_colors_the_weight_that_loses_least_is_named():
    dark = outcome("onyx-rgbw", lux=0.05, time_ms=12.0)
    lost = lost_colors(dark.point, dark.matrix)
    named = outcome("onyx-rgbw", lux=0.05, time_ms=12.0, matrix=f"noise-aware={lost.weight!r}")
    assert mean_total_error(named) < mean_total_error(dark)
    (again,) = total_error_as_viewed(dark.point, named.matrix.matrix[None], Viewing())
    assert again == pytest.approx(lost.least_total_error, rel=1e-9)
    bright = outcome("onyx-rgbw", lux=10)
    assert lost_colors(bright.point, bright.matrix) is None


def test_total_errors_of_many_sensors_are_those_of_each():
    names = ("onyx-rgb-ircut", "onyx-rgbw", "mt9v024-rgb", "onyx-rgbw-ircut")
    levels_lux = (10, 100, 3, 0.3)
    some = [outcome(a, lux=b, time_ms=12) for a, b in zip(names, levels_lux, strict=True)]
    found = total_errors_of(some)
    assert [one is None for one in found] == [False, True, False, False]
    for one, own in zip(some, found, strict=True):
        alone = total_errors(one.point, one.matrix)
        if own is not None:
            np.testing.assert_allclose(own.total, alone.total, rtol=1e-12)
            np.testing.assert_allclose(own.bias, alone.bias, rtol=1e-10)
    assert total_errors_of(some[2:])[0] is found[2]


def test_the_total_error_as_viewed_counts_the_variance_by_numerical_derivatives():
    one = outcome("onyx-rgbw", lux=3)
    point, matrix = one.point, one.matrix.matrix
    matrices = np.stack([matrix, matrix * [[1.0], [1.1], [0.9]] + 1e-6])
    chart = colorchecker(point.sensor.grid).values.T
    light = {"illuminant": point.illuminant, "level_lux": point.level_lux}
    full = np.ones(chart.shape[1])
    true, true_white = (scene_xyz(Scene(**light, reflectance=rho)) for rho in (chart, full))
    patches, white = electrons_at(point, reflectance=chart), electrons_at(point)
    for each, own in zip(matrices, total_error_as_viewed(point, matrices, Viewing()), strict=True):
        seen, balanced = patches @ each.T / (each @ white), each / (each @ white)[:, None]
        covariance = [balanced @ np.diag(e + 100.0) @ balanced.T for e in patches]  # 10 e- read
        viewed = viewed_covariance(
            np.array(covariance), pixels_per_degree=Viewing().pixels_per_degree, samples=PLANE
        )
        step = 1e-6 * np.eye(3)[:, None]
        slope = (lab_of(seen + step, 1.0) - lab_of(seen - step, 1.0)) / 2e-6  # xyz, patch, lab
        variance = np.einsum("ipc,pij,jpc->p", slope, viewed, slope)
        error = np.linalg.norm(lab_of(seen, 1.0) - lab_of(true, true_white), axis=-1)
        assert own == pytest.approx(np.sqrt(error**2 + variance).mean(), rel=1e-7)


def test_a_saturated_sensor_has_no_total_error():
    analysis = outcome("onyx-rgbw", lux=10, time_ms=12.0)
    point = replace(analysis.point, level_lux=100.0)
    assert total_errors(point, analysis.matrix) is None


def test_what_an_analysis_keeps_does_not_grow_with_its_chart():
    grid = DEFAULT_GRID
    many = Spectra(
        wavelength_nm=grid.wavelength_nm,
        values=np.linspace(0.1, 0.9, 2000) * np.ones((grid.n, 1)),
        names=tuple(map(str, range(2000))),
        quantity="reflectance",
        unit="1",
        source="grays",
    )
    analyses = [replace(outcome("onyx-rgb-ircut", lux=lux), chart=many) for lux in (1, 2, 3)]
    mean_total_error(analyses[0])
    gc.collect()
    tracemalloc.start()
    mean_total_error(analyses[1])
    gc.collect()
    held, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert held < 500_000  # bytes: errors and colors; spectra of the patches would take 2,000,000
