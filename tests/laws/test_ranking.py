"""Many sensors: ranks, ties, and who leads where."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import chromanoise as cn
from chromanoise.analysis import (
    QUANTITIES,
    color_snr_db,
    compared,
    crossovers,
    matrix_makers,
)
from chromanoise.analysis.comparison.ranking import (
    leading_crossovers,
    leads,
    ranked,
    ranking,
)
from chromanoise.exposure import Exposure, OperatingPoint
from chromanoise.sensor import Pixel, Sensor
from chromanoise.spectra import DEFAULT_GRID, equal_energy

LAMP = equal_energy(DEFAULT_GRID)
LEVELS = np.geomspace(1e-4, 1e1, 26)
BOUND = QUANTITIES["bound"]
FIVE = ("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "onyx-rgbw-ircut", "model-rgb-ircut")


def one_channel(name, qe, read_noise_e, full_well_e=1e9):
    sensor = Sensor(
        name=name,
        grid=DEFAULT_GRID,
        qe=np.full((DEFAULT_GRID.n, 1), qe),
        names=("W",),
        pixel=Pixel(pitch_um=10.0, full_well_e=full_well_e, read_noise_e=read_noise_e),
    )
    return OperatingPoint(
        sensor=sensor, exposure=Exposure(time_s=0.01), illuminant=LAMP, level_lux=1.0
    )


def swept(*points):
    makers = matrix_makers(["kernel"], "quanta")
    curves = compared(points, makers, LEVELS, quantity=BOUND)
    return curves, crossovers(points, makers, curves)


# sensitive and noisy, dull and silent, and one between: each leads at some light
THREE = (
    one_channel("silent", 0.05, 0.1),
    one_channel("middle", 0.2, 4.0),
    one_channel("noisy", 0.8, 60.0),
)
POOR = one_channel("poor", 0.04, 200.0)


@given(st.lists(st.floats(-50, 50) | st.just(float("nan")), min_size=1, max_size=12))
def test_a_rank_is_one_plus_the_number_of_better_sensors(values):
    found = [(str(i), str(i), value) for i, value in enumerate(values)]
    for one in ranked(found, matrix="kernel", more_is_better=True):
        own = values[int(one.sensor)]
        if np.isnan(own):
            assert (one.rank, one.value, one.tied) == (None, None, False)
            continue
        apart = [other - own for other in values if not np.isnan(other)]
        if all(abs(d) > 2e-9 or d == 0 for d in apart):  # no chain of near ties
            better = sum(d > 0 for d in apart)
            assert better + 1 == one.rank
            assert one.tied == (sum(d == 0 for d in apart) > 1)


def test_the_lowest_error_is_the_best_and_the_order_of_the_sensors_does_not_matter():
    found = [("a", "a", 3.0), ("b", "b", 1.0), ("c", "c", 2.0)]
    for order in (found, found[::-1]):
        ranks = ranked(order, matrix="kernel", more_is_better=False)
        assert [one.sensor for one in ranks] == ["b", "c", "a"]


def test_the_ranking_of_a_comparison_is_that_of_the_analysis_at_the_operating_point():
    snr = {one.sensor.name: color_snr_db(one)["Y"] for one in cn.analyze(*FIVE, lux=3.0).analyses}
    result = cn.compare(*FIVE, lux=3.0, points=3)
    assert [one.sensor for one in result.ranking] == sorted(snr, key=snr.get, reverse=True)
    for one in result.to_dict()["ranking"]:
        assert one["value"] == pytest.approx(snr[one["sensor"]], abs=1e-9)
    data = cn.analyze(*FIVE, lux=3.0).to_dict()["ranking"]
    assert [one["sensor"] for one in data] == [one.sensor for one in result.ranking]


def test_two_equal_sensors_share_a_rank():
    twin = replace(THREE[0], sensor=replace(THREE[0].sensor, name="twin"))
    ranks = ranking([*THREE[:2], twin], matrix_makers(["kernel"], "quanta"), BOUND)
    assert sorted((one.sensor, one.rank, one.tied) for one in ranks if one.tied) == [
        ("silent", 1 + (ranks[0].sensor == "middle"), True),
        ("twin", 1 + (ranks[0].sensor == "middle"), True),
    ]


def test_the_leaders_follow_one_another_at_the_closed_form_crossings_of_their_snr():
    """a^2 E^2 / (a E + s^2) = b^2 E^2 / (b E + t^2): E = (b^2 s^2 - a^2 t^2) / (a b (a - b))."""
    curves, crossed = swept(*THREE)
    found = leads(curves, crossed)
    assert [one.sensor for one in found] == ["silent", "middle", "noisy"]
    assert (found[0].first, found[-1].last) == (LEVELS[0], LEVELS[-1])
    unit = float(
        cn.exposure.expected_electrons(
            cn.exposure.white_scene(one_channel("one", 1.0, 0.0)),
            one_channel("one", 1.0, 0.0).sensor,
            Exposure(time_s=0.01),
        )[0]
    )
    for one, other in itertools.pairwise(found):
        (a, s), (b, t) = (
            next(
                (float(p.sensor.qe[0, 0]), p.sensor.pixel.read_noise_e)
                for p in THREE
                if p.sensor.name == name
            )
            for name in (other.sensor, one.sensor)
        )
        expected = (b**2 * s**2 - a**2 * t**2) / (a * b * (a - b)) / unit
        assert one.last == other.first == pytest.approx(expected, rel=1e-8)


def test_a_sensor_that_never_leads_adds_no_crossover_that_matters():
    curves, crossed = swept(*THREE, POOR)
    found = leads(curves, crossed)
    assert [one.sensor for one in found] == ["silent", "middle", "noisy"]
    matter = leading_crossovers(found, crossed)
    assert {(one.first, one.second) for one in matter} == {
        ("silent", "middle"),
        ("middle", "noisy"),
    }
    assert len(crossed) == 6


def test_a_leader_that_saturates_hands_over_without_a_crossover():
    good = one_channel("good", 0.8, 1.0, full_well_e=20_000.0)
    poor = one_channel("poor", 0.4, 50.0)
    curves, crossed = swept(good, poor)
    found = leads(curves, crossed)
    assert [one.sensor for one in found] == ["good", "poor"]
    assert found[0].last < found[1].first
    assert leading_crossovers(found, crossed) == ()


def test_at_every_value_of_the_sweep_the_leader_has_the_best_value():
    result = cn.compare(*FIVE, matrices=["lmmse"], points=25)
    for i, at in enumerate(result.curves[0].at.tolist()):
        values = {one.sensor: one.value[i] for one in result.curves if np.isfinite(one.value[i])}
        best = {one.sensor for one in result.leads if one.first <= at <= one.last}
        assert max(values, key=values.get, default=None) in (best or {None})
