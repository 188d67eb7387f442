"""Which sensor has the least visual noise at equal color error, over a sweep."""

from dataclasses import replace

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.base import InputError
from chromanoise.noise import Exposure
from chromanoise.spectra import DEFAULT_GRID
from chromanoise.study import SWEEPS, equal_color, equal_color_ranges, range_sentences, sensor_named
from chromanoise.study.trade_offs import SATURATED
from strategies import point_of

THREE = ("onyx-rgbw", "onyx-rgb", "onyx-rgb-ircut")
LEVELS_LUX = np.geomspace(0.3, 300.0, 9)


def points_of(*sensors):
    return [point_of(one, exposure=Exposure(time_s=11.94e-3)) for one in sensors]


@pytest.fixture(scope="module")
def quiet_and_strong():
    """One sensor has 0.5 e- of read noise; the other has 40 e- and four times the light."""
    base = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    quiet = replace(base, name="quiet", qe=base.qe / 4, pixel=replace(base.pixel, read_noise_e=0.5))
    strong = replace(base, name="strong", pixel=replace(base.pixel, read_noise_e=40.0))
    return points_of(quiet, strong)


def test_ranges_change_where_the_verdict_turns_and_end_with_saturation(quiet_and_strong):
    (turn,) = (one for one in equal_color(quiet_and_strong).turns if one.over == "light [lx]")
    ranges = equal_color_ranges(quiet_and_strong, SWEEPS["lux"], LEVELS_LUX)
    assert [one.winner for one in ranges if one.outcome == "leads"] == ["quiet", "strong"]
    quiet, strong = (one for one in ranges if one.outcome == "leads")
    assert quiet.last < turn.first <= strong.first
    assert (ranges[-1].outcome, ranges[-1].last) == ("not compared", LEVELS_LUX[-1])
    assert {one.why for one in ranges[-1].left_out} == {SATURATED}
    assert ranges[-1].margin_db is ranges[-1].at_color_error is None


def test_in_the_dark_the_margin_is_the_ratio_of_read_noise_to_light(quiet_and_strong):
    # read noise dominates: 40 e- with four times the light, against 0.5 e-
    (only,) = equal_color_ranges(quiet_and_strong, SWEEPS["lux"], np.array([1e-4, 2e-4]))
    assert (only.outcome, only.winner) == ("lost", None)
    assert only.margin_db == pytest.approx(2 * (20 * np.log10(40 / 0.5 / 4),), abs=0.1)


def test_twins_never_lead():
    base = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    twins = points_of(base, replace(base, name="twin"))
    (tie,) = equal_color_ranges(twins, SWEEPS["lux"], LEVELS_LUX[:3])
    assert (tie.outcome, tie.winner, tie.sensor) == ("tie", None, None)
    assert (tie.first, tie.last) == tuple(LEVELS_LUX[[0, 2]])


def test_a_range_compares_the_same_sensors_at_all_of_its_values():
    three = points_of(*(sensor_named(one, DEFAULT_GRID) for one in THREE))
    ranges = equal_color_ranges(three, SWEEPS["lux"], np.geomspace(0.5, 32.0, 9))
    first, second = (one for one in ranges if one.winner == "onyx-rgb-ircut")
    assert (first.left_out, [one.name for one in second.left_out]) == ((), ["onyx-rgbw"])
    assert first.margin_db[1] < second.margin_db[0]  # the second sensor is another one
    sentences = range_sentences(ranges)
    assert [sentence.count("onyx-rgbw (") for sentence in sentences[:2]] == [0, 1]
    assert sum("not compared from" in one or "fewer than" in one for one in sentences) == 0


@pytest.mark.parametrize("at", [[2.0, 1.0], [0.0, 1.0], [1.0, np.nan]])
def test_values_that_do_not_increase_or_cannot_be_are_refused(quiet_and_strong, at):
    with pytest.raises(InputError):
        equal_color_ranges(quiet_and_strong, SWEEPS["lux"], np.array(at))


def test_raw_values_and_a_sensor_alone_have_no_color_to_compare():
    pair, over = ("onyx-rgb", "onyx-rgb-ircut"), {"first": 1.0, "last": 2.0, "points": 3}
    alone = cn.compare("onyx-rgb", **over)
    raw = cn.compare(*pair, quantity="information", **over)
    assert alone.equal_color == raw.equal_color == ()
    color = cn.compare(*pair, **over).equal_color
    assert [(one.winner, one.first, one.last) for one in color] == [("onyx-rgb-ircut", 1.0, 2.0)]
