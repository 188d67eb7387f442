"""Sensors on equal terms: one time, one filling, or the same photons."""

import numpy as np
import pytest

from chromanoise.noise import (
    equal_exposure,
    equal_light,
    equal_saturation,
    expected_electrons,
    exposure_factor,
)
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import SENSOR_NAMES, sensor_named
from outcomes import refused_input
from strategies import sensor_of

WHITE = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
SENSORS = [sensor_named(name, DEFAULT_GRID) for name in SENSOR_NAMES]


def filling(sensor, exposure):
    return expected_electrons(WHITE, sensor, exposure).max() / sensor.pixel.full_well_e


def test_the_papers_12_ms_fill_the_most_sensitive_sensor_and_no_other():
    rgbw, rgb = (sensor_named(n, DEFAULT_GRID) for n in ("onyx-rgbw", "onyx-rgb-ircut"))
    first, second = equal_exposure(WHITE, [rgbw, rgb])
    assert first == second
    assert first.time_s == pytest.approx(0.012, abs=0.0003)
    assert filling(rgbw, first) == pytest.approx(0.99)
    assert filling(rgb, second) < 0.5


def test_at_equal_saturation_each_most_sensitive_channel_is_filled_alike():
    for sensor, exposure in zip(SENSORS, equal_saturation(WHITE, SENSORS, share=0.5), strict=True):
        assert filling(sensor, exposure) == pytest.approx(0.5)


def test_at_equal_light_four_channels_have_three_quarters_of_the_time_of_three():
    """And a stack of three on one pixel has three times theirs; nobody overflows."""
    names = ("model-rgb-ircut", "model-rgbw-ircut", "model-three-layer")
    sensors = [sensor_named(name, DEFAULT_GRID) for name in names]
    three, four, stack = equal_light(WHITE, sensors)
    assert four.time_s / three.time_s == pytest.approx(3 / 4)
    assert stack.time_s / three.time_s == pytest.approx(3)
    fillings = [filling(s, e) for s, e in zip(sensors, (three, four, stack), strict=True)]
    assert max(fillings) == pytest.approx(0.99)


def test_at_equal_light_every_set_of_channels_gets_the_same_photons():
    exposures = equal_light(WHITE, SENSORS)
    areas = [1 if s.stacked else len(s.names) for s in SENSORS]
    photons = [
        exposure_factor(e, s.pixel, 1.0) * n
        for e, s, n in zip(exposures, SENSORS, areas, strict=True)
    ]
    assert np.ptp(photons) < 1e-12 * photons[0]


def test_a_stack_that_makes_two_electrons_of_a_photon_is_refused():
    with refused_input(value=1.2, requirement="at most 1"):
        sensor_of(np.full((DEFAULT_GRID.n, 2), 0.6), grid=DEFAULT_GRID, stacked=True)
