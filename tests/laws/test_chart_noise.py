"""The chart: color error and noise of every patch, side by side."""

from functools import cache

import numpy as np
import pytest

from chromanoise.base.rng import stream
from chromanoise.color import kernel_matrix
from chromanoise.noise import Exposure, expected_electrons, sample_electrons
from chromanoise.spectra import DEFAULT_GRID, Scene, colorchecker, equal_energy, flat_field
from chromanoise.study import analyzed, chart_noise, matrix_makers, mean_color_error, sensor_named
from strategies import point_of

LAMP = equal_energy(DEFAULT_GRID)
DRAWS = 20_000


@cache
def seen(name="onyx-rgb-ircut", level_lux=10.0, time_s=0.0119):
    white = flat_field(LAMP, level_lux=level_lux)
    return analyzed(white, sensor_named(name, DEFAULT_GRID), Exposure(time_s=time_s))


@cache
def charted():
    return chart_noise(seen())


def test_patches_drawn_and_taken_to_lab_scatter_as_predicted():
    """CIELAB by colour-science's own function, noise by drawing: another road to both."""
    import colour

    analysis = seen()
    chart = charted()
    rho = colorchecker(DEFAULT_GRID).values.T
    scene = Scene(illuminant=LAMP, level_lux=10.0, reflectance=rho)
    electrons = expected_electrons(scene, analysis.sensor, analysis.exposure)
    drawn = sample_electrons(
        np.broadcast_to(electrons, (DRAWS, *electrons.shape)), analysis.sensor.pixel, stream(5)
    )
    xyz = drawn @ analysis.matrix.matrix.T / analysis.color.mean
    light_patches = xyz.min(axis=(0, 2)) > 0.01  # where every draw is on the cube-root branch
    assert light_patches.sum() > 15
    lab = colour.XYZ_to_Lab(xyz[:, light_patches], np.array([1 / 3, 1 / 3]))
    sd = chart.noise.sd[light_patches]
    excess = lab.std(axis=0, ddof=1) / sd - 1
    assert np.abs(excess).max() < 5 / np.sqrt(2 * DRAWS) * 1.3  # tails: not quite normal


def test_an_error_free_patch_exists_only_where_sensor_and_eye_agree():
    """White balance makes the neutral patches right within a few Delta E; colors are not."""
    chart = charted()
    neutral = chart.color_error[18:]
    assert neutral.max() < 4 < chart.color_error.max()
    assert chart.ciede2000.mean() < chart.color_error.mean()


def test_the_mean_of_the_chart_is_the_color_error_of_the_analysis():
    analysis = seen()
    assert charted().color_error.mean() == pytest.approx(mean_color_error(analysis))


def test_less_light_is_more_noise_on_every_patch():
    bright, dim = charted(), chart_noise(seen(level_lux=1.0))
    assert (dim.noise.delta_e > bright.noise.delta_e).all()
    assert dim.color_error == pytest.approx(bright.color_error)


def test_a_saturated_sensor_has_no_chart():
    assert chart_noise(seen(level_lux=1e4)) is None


def test_another_matrix_changes_color_and_leaves_raw_alone():
    sensor, exposure = sensor_named("onyx-rgbw", DEFAULT_GRID), Exposure(time_s=0.0119)
    white = flat_field(LAMP, level_lux=1.0)
    (maker,) = matrix_makers(["lmmse"], "quanta").values()
    kernel = analyzed(white, sensor, exposure)
    matrix = maker(point_of(sensor, 1.0, exposure=exposure))
    trained = analyzed(white, sensor, exposure, matrix=matrix)
    assert kernel.matrix.matrix == pytest.approx(kernel_matrix(sensor, exposure).matrix)
    assert trained.raw.covariance == pytest.approx(kernel.raw.covariance)
    assert trained.color_snr_loss_db < kernel.color_snr_loss_db - 2
