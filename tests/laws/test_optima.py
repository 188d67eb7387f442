"""The value of a sweep at which a sensor is best, and the best cell of a map."""

import numpy as np
import pytest

import chromanoise as cn

PAIR = ("onyx-rgb", "onyx-rgbw")


def test_an_optimum_inside_the_range_is_refined_between_its_neighbors():
    coarse, fine = (
        cn.compare(
            *PAIR, vary="ircut-nm", first=550.0, last=750.0, points=n, quantity="color-error"
        )
        for n in (9, 401)
    )
    for one, near, curve in zip(coarse.optima, fine.optima, coarse.curves, strict=True):
        assert one.place == "inside"
        assert one.low < one.at < one.high
        assert one.high - one.low == pytest.approx(50.0)
        assert one.value <= np.nanmin(curve.value) + 1e-12
        assert one.value == pytest.approx(near.value, rel=1e-3)
        assert one.at == pytest.approx(near.at, abs=1.0)


def test_a_monotone_curve_is_best_at_an_end():
    (found,) = cn.compare("onyx-rgb", vary="read-noise-e", first=1.0, last=20.0, points=5).optima
    assert (found.place, found.at, found.low, found.high) == ("first", 1.0, 1.0, 1.0)
    (found,) = cn.compare("onyx-rgb", vary="lux", first=0.1, last=5.0, points=5).optima
    assert (found.place, found.at) == ("last", pytest.approx(5.0))
    (found,) = cn.compare("onyx-rgb", vary="lux", first=0.1, last=1000.0, points=5).optima
    assert (found.place, found.at) == ("saturation", pytest.approx(10.0))


def test_a_quantity_that_does_not_vary_is_best_everywhere():
    result = cn.compare(
        "onyx-rgb", vary="lux", first=0.1, last=5.0, points=5, quantity="color-error"
    )
    assert result.optima[0].place == "everywhere"
    assert "is lowest at every illuminance for onyx-rgb (" in result.shown_sentences[0]


def test_the_optimum_is_the_first_sentence_and_in_the_json():
    result = cn.compare(*PAIR, vary="ircut-nm", first=550.0, last=750.0, points=9)
    assert all(name in result.shown_sentences[0] for name in PAIR)
    data = result.to_dict()["optima"]
    assert [one["sensor"] for one in data] == [*PAIR]
    assert {"at", "value", "low", "high", "place"} <= {*data[0]}


def test_the_best_cell_of_a_map_has_the_best_value():
    result = cn.compare_map(*PAIR, first=0.1, last=10.0, points=4, second_points=3)
    for one, of in zip(result.optima, result.maps, strict=True):
        assert one.value == np.nanmax(of.value)
        (j,), (k,) = np.nonzero(of.second_at == one.second_at), np.nonzero(of.at == one.at)
        assert of.value[j[0], k[0]] == one.value
    assert result.to_dict()["optima"][0]["value"] == result.optima[0].value
    assert all(name in result.shown_sentences[0] for name in PAIR)
