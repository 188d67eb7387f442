"""Printed white points of the observers, and what another observer leaves as it is."""

import numpy as np
import pytest

from chromanoise.base.errors import errors_in
from chromanoise.color import kernel_matrix, scene_xyz
from chromanoise.noise import Exposure, conditions
from chromanoise.spectra import (
    DEFAULT_GRID,
    OBSERVERS,
    Grid,
    cie_a,
    cie_illuminant,
    color_axes,
    equal_energy,
    flat_field,
    light,
)
from chromanoise.study import analyzed, sensor_named
from outcomes import refused_input
from strategies import point_of

CIE = Grid.uniform(360, 830, 1)
EXPOSURE = Exposure(time_s=0.005, f_number=1.8)
SENSOR = sensor_named("model-rgb-ircut", DEFAULT_GRID)
WHITE = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)


def white_point(lamp, observer):
    xyz = light(flat_field(lamp, level_lux=1.0), "energy") @ color_axes(CIE, "energy", observer)
    return 100 * xyz / xyz[1]


def test_the_white_points_of_cie_1964_are_the_printed_ones():
    # ASTM E308-18, Table 5, as CIE 15:2018 to two digits
    d65 = cie_illuminant("D65", CIE, beyond="hold")
    assert white_point(cie_a(CIE), "cie-1964-10") == pytest.approx(
        [111.144, 100.0, 35.200], abs=1e-3
    )
    assert white_point(d65, "cie-1964-10") == pytest.approx([94.811, 100.0, 107.304], abs=2e-3)


@pytest.mark.parametrize("observer", ["cie-2015-2", "cie-2015-10"])
def test_equal_energy_is_neutral_for_cie_2015(observer):
    # CIE 170-2:2015 scales x, y and z to equal areas
    assert white_point(equal_energy(CIE), observer) == pytest.approx([100.0] * 3, abs=1e-4)


@pytest.mark.parametrize(("observer", "share"), [("cie-1931-2", 1.0), ("cie-1964-10", 1.09176)])
def test_a_lux_is_defined_by_cie_1931_only(observer, share):
    # areas of y-bar over 360-830 nm: 106.857 and 116.662, whose ratio is 1.09176
    lit = flat_field(equal_energy(CIE), level_lux=100.0)
    assert scene_xyz(lit, "energy", observer)[1] == pytest.approx(100 * share, rel=1e-5)


@pytest.mark.parametrize("observer", OBSERVERS)
def test_the_observer_changes_nothing_before_the_color(observer):
    own = analyzed(WHITE, SENSOR, EXPOSURE, observer=observer)
    usual = analyzed(WHITE, SENSOR, EXPOSURE)
    for stage in ("raw", "contravariant"):
        for part in ("mean", "covariance"):
            np.testing.assert_array_equal(
                getattr(getattr(own, stage), part), getattr(getattr(usual, stage), part)
            )
    np.testing.assert_array_equal(own.between_deg, usual.between_deg)
    assert own.point.observer == own.matrix.observer == observer


def test_the_operating_point_names_an_observer_other_than_cie_1931():
    point = point_of(SENSOR, exposure=EXPOSURE)
    assert conditions([point]) == "10 lx (illuminant E, 5 ms, f/1.8)"
    own = analyzed(WHITE, SENSOR, EXPOSURE, observer="cie-1964-10").point
    assert conditions([own]) == "10 lx (illuminant E, 5 ms, f/1.8, observer cie-1964-10)"


@pytest.mark.parametrize(
    "call",
    [
        lambda name: color_axes(CIE, "energy", name),
        lambda name: kernel_matrix(SENSOR, EXPOSURE, "quanta", name),
        lambda name: scene_xyz(WHITE, "quanta", name),
    ],
)
def test_an_unknown_observer_is_refused_with_near_names(call):
    with refused_input(subject="observer", value="cie-1964") as caught:
        call("cie-1964")
    (error,) = errors_in(caught.value)
    assert "cie-1964-10" in str(error)
