"""Color error of a chart without noise: zero for the eye itself, told for the others."""

import numpy as np
import pytest

from chromanoise.base.errors import InputError
from chromanoise.color import kernel_matrix
from chromanoise.metrics import chart_color_error
from chromanoise.noise import Exposure
from chromanoise.spectra import DEFAULT_GRID, Grid, cie_1931, cie_a, equal_energy
from chromanoise.study import sensor_named
from strategies import sensor_of, white_channel

EXPOSURE = Exposure(time_s=0.01)


def observer_as_sensor(mix):
    """Channels that are a mix of the color axes in photons: CMF h c / lambda."""
    axes = cie_1931(DEFAULT_GRID).values / DEFAULT_GRID.wavelength_nm[:, None]
    mixed = axes @ mix
    return sensor_of(0.9 * mixed / mixed.max(), grid=DEFAULT_GRID)


@pytest.mark.parametrize("mix", [np.eye(3), np.array([[2.0, 1, 0], [1, 3, 0], [0, 1, 1]])])
@pytest.mark.parametrize("lamp", [equal_energy, cie_a])
def test_a_sensor_that_is_the_observer_has_no_color_error(mix, lamp):
    sensor = observer_as_sensor(mix)
    matrix = kernel_matrix(sensor, EXPOSURE, "quanta")
    error = chart_color_error(sensor, matrix, EXPOSURE, lamp(DEFAULT_GRID))
    np.testing.assert_allclose(error, 0.0, atol=1e-9)


def test_color_error_does_not_depend_on_exposure():
    sensor = sensor_named("model-rgb-ircut", DEFAULT_GRID)
    errors = [
        chart_color_error(sensor, kernel_matrix(sensor, e, "quanta"), e, equal_energy(DEFAULT_GRID))
        for e in (EXPOSURE, Exposure(time_s=3.0, f_number=8.0))
    ]
    np.testing.assert_allclose(errors[0], errors[1], rtol=1e-9)


def test_near_infrared_without_ir_cut_turns_into_false_color():
    """The paper's text: without IR-cut, NIR components give false colors."""
    with_cut, without = (sensor_named(n, DEFAULT_GRID) for n in ("onyx-rgb-ircut", "onyx-rgb"))
    means = [
        chart_color_error(
            s, kernel_matrix(s, EXPOSURE, "quanta"), EXPOSURE, equal_energy(DEFAULT_GRID)
        ).mean()
        for s in (with_cut, without)
    ]
    assert means[1] > 1.5 * means[0]


def test_a_sensor_that_sees_only_infrared_has_no_color_to_be_wrong():
    infrared = np.where(DEFAULT_GRID.wavelength_nm > 850, 0.5, 0.0)[:, None]
    sensor = sensor_of(infrared, grid=DEFAULT_GRID)
    matrix = kernel_matrix(sensor, EXPOSURE, "quanta")
    assert chart_color_error(sensor, matrix, EXPOSURE, equal_energy(DEFAULT_GRID)) is None


def test_a_grid_beyond_the_measured_chart_is_refused():
    grid = Grid.uniform(380, 780, 5)
    sensor = white_channel(grid=grid)
    matrix = kernel_matrix(sensor, EXPOSURE, "quanta")
    with pytest.raises(InputError, match="400-1050 nm"):
        chart_color_error(sensor, matrix, EXPOSURE, equal_energy(grid))
