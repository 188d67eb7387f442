"""Levels and patches as leading axes give what each level and patch gives alone."""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.color import kernel_matrix
from chromanoise.noise import (
    Exposure,
    Readout,
    conditions,
    expected_electrons,
    light_and_exposure,
    read_moments,
    white_scene,
)
from chromanoise.spectra import DEFAULT_GRID, Scene, colorchecker, equal_energy
from chromanoise.study import analyzed, coordinate_budget, electrons_at, sensor_named, stages_at
from chromanoise.study.sweeps import QUANTITIES
from outcomes import refused_input
from strategies import point_of

LAMP = equal_energy(DEFAULT_GRID)
SENSOR = sensor_named("onyx-rgbw", DEFAULT_GRID)
POINT = point_of(SENSOR, exposure=Exposure(time_s=0.012))
MATRIX = kernel_matrix(SENSOR, POINT.exposure)
LEVELS = np.array([0.1, 3.0, 40.0])
PATCHES = colorchecker(DEFAULT_GRID).values.T[[0, 18, 23]]


def test_each_level_and_patch_is_analyzed_as_if_alone():
    at = stages_at(POINT, MATRIX, level_lux=LEVELS, reflectance=PATCHES)
    assert at.expected_e.shape == (3, 3, 4)
    for i, level in enumerate(LEVELS):
        for k, patch in enumerate(PATCHES):
            scene = Scene(illuminant=LAMP, level_lux=level, reflectance=patch)
            one = analyzed(scene, SENSOR, POINT.exposure)
            for name in ("raw", "contravariant", "color"):
                ours, alone = getattr(at, name), getattr(one, name)
                assert ours.mean[i, k] == pytest.approx(alone.mean, rel=1e-12)
                assert ours.covariance[i, k] == pytest.approx(alone.covariance, rel=1e-12)
            assert at.saturated[i, k].tolist() == one.saturated.tolist()
            assert at.truth_xyz[i, k] == pytest.approx(one.truth_xyz, rel=1e-12)


def test_electrons_of_a_level_are_those_of_the_scene_at_that_level():
    found = electrons_at(POINT, level_lux=LEVELS)
    for electrons, level in zip(found, LEVELS, strict=True):
        white = white_scene(replace(POINT, level_lux=level))
        alone = expected_electrons(white, SENSOR, POINT.exposure)
        assert electrons == pytest.approx(alone, rel=1e-12)


def test_one_matrix_per_level_is_that_matrix_at_that_level():
    scales = np.array([1.0, 2.0, 0.5])
    matrices = scales[:, None, None] * MATRIX.matrix
    plain = stages_at(POINT, MATRIX, level_lux=LEVELS, reflectance=PATCHES).color
    each = stages_at(POINT, MATRIX, level_lux=LEVELS, reflectance=PATCHES, lux_per_e=matrices).color
    assert each.mean == pytest.approx(scales[:, None, None] * plain.mean, rel=1e-12)
    assert each.covariance == pytest.approx(
        scales[:, None, None, None] ** 2 * plain.covariance, rel=1e-12
    )


def test_a_readout_gives_the_exact_moments_and_the_shares_that_it_clips():
    readout = Readout(black_e=0.0, full_well_e=SENSOR.pixel.full_well_e)
    at = stages_at(POINT, MATRIX, level_lux=LEVELS, readout=readout)
    known = read_moments(at.expected_e, read_noise_e=SENSOR.pixel.read_noise_e, readout=readout)
    np.testing.assert_array_equal(at.raw.mean, known.mean)
    np.testing.assert_array_equal(at.raw.variance, known.variance)
    np.testing.assert_array_equal(at.clipping.black_share, known.black_share)
    assert stages_at(POINT, MATRIX).clipping is None


@pytest.mark.parametrize("name", [name for name, q in QUANTITIES.items() if q.over_levels])
def test_a_quantity_over_levels_is_that_quantity_at_each_level(name):
    quantity, levels = QUANTITIES[name], np.array([0.1, 3.0, 500.0])
    together = quantity.over_levels(POINT, MATRIX, levels)
    alone = [quantity.of(replace(POINT, level_lux=level), MATRIX) for level in levels]
    assert np.isnan(together[-1])  # saturated
    assert together == pytest.approx(np.array(alone), rel=1e-12, nan_ok=True)


def test_a_negative_level_and_matrices_without_levels_are_refused():
    with refused_input(subject="level_lux", value=-1.0):
        stages_at(POINT, MATRIX, level_lux=np.array([1.0, -1.0]))
    with refused_input(value={"level_lux": 0, "lux_per_e": 2}):
        stages_at(POINT, MATRIX, lux_per_e=np.zeros((2, 3, 4)))


def test_a_coordinate_that_the_sensor_does_not_have_has_no_budget():
    analysis = analyzed(white_scene(POINT), SENSOR, POINT.exposure)
    assert coordinate_budget(analysis, "M^none") is None
    assert coordinate_budget(analysis, "M^G").coordinate == "M^G"


def test_a_saturated_analysis_has_no_snr_of_any_kind():
    long = Exposure(time_s=1.0)
    analysis = analyzed(white_scene(POINT), SENSOR, long)
    assert analysis.saturated.any()
    assert np.isnan(stages_at(replace(POINT, exposure=long), MATRIX).optimal_linear_snr_db)
    assert analysis.spectral_snr_db is None
    assert analysis.optimal_linear_snr_db is None
    assert analysis.color_snr_loss_db is None


def test_the_conditions_of_sensors_name_level_light_times_and_aperture():
    def at(time_s, name):
        exposure, sensor = Exposure(time_s=time_s), replace(SENSOR, name=name)
        return replace(POINT, exposure=exposure, sensor=sensor, level_lux=2e-4)

    same = [at(0.012, "a"), at(0.012, "b")]
    assert conditions(same) == "2·10⁻⁴ lx (illuminant E, 12 ms, f/1.8)"
    assert light_and_exposure([at(0.012, "a"), at(15.0, "b")]) == (
        "illuminant E, 12 ms (a), 15 s (b), f/1.8"
    )
    many = [at(0.001 * i, f"s{i}") for i in (3, 1, 2, 4)]
    assert light_and_exposure(many) == "illuminant E, 1 ms to 4 ms, f/1.8"
