"""A design space makes sensors that are possible, from free, fixed and tied numbers."""

import math
import pickle
from dataclasses import replace
from typing import get_args

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from chromanoise.apps.design.parameters import Free, Parameter, noise_properties
from chromanoise.apps.design.space import LEAST_SHARE, Channel, DesignSpace, Filter
from chromanoise.sensor import (
    BinningMode,
    bayer,
    behind_ir_cut,
    binned,
    crosstalk_of_share,
    silicon_qe,
    with_crosstalk,
)
from chromanoise.spectra import Grid
from chromanoise.study import sensor_named
from outcomes import refused_input

GRID = Grid.uniform(400, 1050, 10)
BASE = sensor_named("model-mono", GRID)
CUT = Filter(model="ir-cut", numbers={"cutoff_nm": Free(low=600.0, high=900.0)})
LIBRARY = {"dark": np.full(GRID.n, 0.1), "light": np.linspace(0.0, 1.0, GRID.n)}


def bell(low_nm, high_nm, **numbers):
    own = {"center_nm": Free(low=low_nm, high=high_nm), "width_nm": Free(low=20.0, high=80.0)}
    return Filter(model="gaussian", numbers=own | numbers)


RGB = tuple(
    Channel(name=name, filter=bell(*bounds))
    for name, bounds in {"R": (560.0, 680.0), "G": (500.0, 580.0), "B": (420.0, 500.0)}.items()
)
ROUTER = {
    "efficiency": Free(low=0.5, high=1.0),
    "B_selectivity": Free(low=0.4, high=1.0),
    "G_selectivity": 0.7,
    "R_selectivity": Free(low=0.4, high=1.0),
    "crossing_1_nm": Free(low=480.0, high=520.0),
    "crossing_2_nm": 590.0,
}


def space_of(**fields):
    return DesignSpace(**({"base": BASE, "channels": RGB, "ir_cut": CUT} | fields))


SPACES = {
    "gaussian": space_of(),
    "everything": space_of(
        channels=(
            *RGB,
            Channel(name="D", filter=Filter(
                model="dye", numbers={"thickness": Free(low=0.5, high=2.0)}, curves=tuple(LIBRARY)
            )),
            Channel(name="W", base="W", ir_cut=Filter(
                model="ir-cut", numbers={"cutoff_nm": "ir_cut.cutoff_nm"}
            )),
        ),
        library=LIBRARY,
        silicon={"depth_um": Free(low=1.0, high=10.0)},
        pixel_shares="free",
        crosstalk=Free(low=0.0, high=0.3),
        time_ms=Free(low=1.0, high=100.0),
        noise_weight=Free(low=0.0, high=1.0),
        pixel={
            "read_noise_e": Free(low=1.0, high=20.0),
            "dark_current_e_per_s": Free(low=0.0, high=50.0),
            "prnu": Free(low=0.0, high=0.02),
        },
    ),
    "layers": space_of(
        channels=tuple(Channel(name=name) for name in "BGR"),
        structure="layers",
        layers={f"{name}_um": Free(low=0.2, high=3.0) for name in "BGR"},
    ),
    "router": space_of(
        channels=tuple(Channel(name=name) for name in "BGR"), structure="router", router=ROUTER
    ),
    "mosaic": space_of(mosaic=bayer(), crosstalk=Free(low=0.0, high=0.3)),
}  # fmt: skip


def rows(space, shares):
    low = np.array([one.low for one in space.parameters])
    high = np.array([one.high for one in space.parameters])
    return low + np.resize(np.asarray(shares), (2, low.size)) * (high - low)


spaces = st.sampled_from(sorted(SPACES)).map(SPACES.get)
anywhere = st.lists(st.floats(0.0, 1.0), min_size=1, max_size=40)


@given(spaces, anywhere)
def test_every_candidate_is_a_sensor_that_can_be(space, shares):
    values = rows(space, shares)
    candidates = space.candidates(values)
    qe = candidates.qe
    assert qe.shape == (2, GRID.n, len(space.names))
    assert ((qe >= 0) & (qe <= 1)).all()
    if space.structure != "mosaic":
        assert (qe.sum(axis=2) <= 1 + 1e-12).all()
    for row, curves in zip(values, qe, strict=True):
        if curves.max(axis=0).min() > 1e-9:
            np.testing.assert_allclose(space.sensor(row, name="one").qe, curves, rtol=1e-14)


def array_of(candidates, name):
    if name in noise_properties():
        return candidates.pixel.get(name)
    return getattr(candidates, name)


@settings(max_examples=10)
@given(spaces, st.lists(st.floats(0.05, 0.95), min_size=20, max_size=20))
def test_the_complex_step_gives_the_slope_of_every_array_of_the_candidates(space, shares):
    values = rows(space, shares)[:1]
    fields = ("qe", "time_s", "pixel_share", "noise_weight", *noise_properties())
    for i, parameter in enumerate(space.parameters):
        if parameter.choices:
            continue
        along = np.eye(len(space.parameters))[i]
        h = 1e-4 * parameter.span
        exact = space.candidates(values + 1e-30j * along)
        up, down, up_2, down_2 = (
            space.candidates(values + factor * h * along) for factor in (1, -1, 2, -2)
        )
        for name in fields:
            if array_of(exact, name) is None:
                continue
            slope = array_of(exact, name).imag / 1e-30
            one, two = (
                (array_of(a, name) - array_of(b, name)) / (2 * f * h)
                for a, b, f in ((up, down, 1), (up_2, down_2, 2))
            )
            size = np.abs(slope).max()
            difference = (4 * one - two) / 3
            np.testing.assert_allclose(slope, difference, rtol=0, atol=1e-6 * size + 1e-9)


@given(spaces, anywhere)
def test_a_candidate_does_not_depend_on_those_beside_it(space, shares):
    values = np.repeat(rows(space, shares), 80, axis=0)
    np.testing.assert_array_equal(space.curves(values)[77:83], space.curves(values[77:83]))


def test_a_gaussian_on_silicon_behind_an_ir_cut_is_their_product():
    values = np.array([[600.0, 40.0, 540.0, 30.0, 460.0, 20.0, 650.0]])
    qe = SPACES["gaussian"].curves(values)[0]
    at = int(np.searchsorted(GRID.wavelength_nm, 650))
    silicon = silicon_qe(GRID, depth_um=4.0)[at]
    bells = [math.exp(-0.5 * (d / w) ** 2) for d, w in ((50, 40), (110, 30), (190, 20))]
    np.testing.assert_allclose(qe[at], [0.5 * silicon * one for one in bells], rtol=1e-12)


def test_tied_numbers_move_together():
    tied = replace(RGB[1], filter=bell(500.0, 580.0, width_nm="R.width_nm"))
    space = space_of(channels=(RGB[0], tied, RGB[2]))
    assert "G.width_nm" not in [one.name for one in space.parameters]
    values = rows(space, [0.1, 0.9, 0.4])
    np.testing.assert_array_equal(
        space.number("G.width_nm", values), space.number("R.width_nm", values)
    )


def test_a_sensor_of_the_catalog_of_which_only_the_ir_cut_is_searched_keeps_its_curves():
    onyx = sensor_named("onyx-rgb", GRID)
    space = DesignSpace(
        base=onyx,
        channels=tuple(Channel(name=name, base=name) for name in onyx.names),
        ir_cut=CUT,
        mosaic=onyx.mosaic,
    )
    made = space.sensor(np.array([680.0]), name="cut")
    np.testing.assert_allclose(made.qe, behind_ir_cut(onyx, 680.0).qe, rtol=1e-13)
    assert [one.name for one in space.parameters] == ["ir_cut.cutoff_nm"]
    assert made.mosaic == onyx.mosaic
    assert set(onyx.notes) <= set(made.notes)


def test_crosstalk_in_a_mosaic_is_that_of_the_library():
    space = SPACES["mosaic"]
    pure, mixed = (rows(space, [0.5])[0] for _ in range(2))
    pure[-1], mixed[-1] = 0.0, 0.2
    plain = replace(space.sensor(pure, name="plain"), crosstalk=None)
    expected = with_crosstalk(plain, crosstalk_of_share(0.2, bayer(), ("R", "G", "B")))
    got = space.sensor(mixed, name="mixed")
    np.testing.assert_allclose(got.qe, expected.qe, rtol=1e-12)
    np.testing.assert_array_equal(got.crosstalk.matrix, expected.crosstalk.matrix)


@given(anywhere)
def test_crosstalk_without_a_mosaic_loses_no_light(shares):
    space = SPACES["everything"]
    values = rows(space, shares)
    at = [one.name for one in space.parameters].index("crosstalk.share")
    pure = values.copy()
    pure[:, at] = 0.0
    weight = space.shares(values)[:, None, :]
    total, before = ((space.curves(one) * weight).sum(axis=2) for one in (values, pure))
    np.testing.assert_allclose(total, before, rtol=1e-12)


@given(st.lists(st.floats(0.001, 1.0), min_size=5, max_size=5))
def test_any_shares_of_the_pixels_can_be_reached(parts):
    wanted = LEAST_SHARE + (1 - 5 * LEAST_SHARE) * np.array(parts) / sum(parts)
    space = SPACES["everything"]
    values = rows(space, [0.5])[:1]
    names = [one.name for one in space.parameters]
    spread = (wanted - LEAST_SHARE) / (1 - 5 * LEAST_SHARE)
    for i, name in enumerate(space.names[:-1]):
        values[0, names.index(f"{name}.share_of_rest")] = spread[i] / spread[i:].sum()
    got = space.candidates(values).pixel_share
    np.testing.assert_allclose(got[0], wanted, rtol=1e-12)
    assert got.sum() == pytest.approx(1.0, abs=1e-14)


def test_the_starts_of_the_shares_are_equal():
    space = space_of(pixel_shares="free")
    start = [one.start if one.start is not None else one.low for one in space.parameters]
    np.testing.assert_allclose(space.shares(np.array([start])), 1 / 3, rtol=1e-14)


def test_a_library_is_searched_by_the_index_of_its_curves():
    filter_ = Filter(model="dye", curves=("dark", "light"))
    space = DesignSpace(
        base=BASE, channels=(Channel(name="D", base="W", filter=filter_),), library=LIBRARY
    )
    assert [one.choices for one in space.parameters] == [("dark", "light")]
    curves = space.curves(np.array([[0.0], [0.4], [1.0]]))[:, :, 0]
    white = BASE.qe[:, 0]
    np.testing.assert_allclose(
        curves, [white * LIBRARY[name] for name in ("dark", "dark", "light")], rtol=1e-12
    )
    assert "light" in space.sensor(np.array([1.0]), name="one").notes[0]


@pytest.mark.parametrize(
    ("shares", "pattern"),
    [
        ("equal", (("R", "G"), ("G", "B"))),
        ((0.5, 0.25, 0.25), (("G", "R"), ("R", "B"))),
        ((0.6, 0.2, 0.2), None),
    ],
)
def test_a_mosaic_is_made_where_the_shares_are_quarters(shares, pattern):
    space = space_of(pixel_shares=shares)
    mosaic = space.sensor(rows(space, [0.5])[0], name="one").mosaic
    assert (mosaic.pattern if mosaic else None) == pattern


def test_a_sensor_has_the_noise_that_was_chosen_with_it():
    space = SPACES["everything"]
    values = rows(space, [0.5])
    sensor, candidates = space.sensor(values[0], name="one"), space.candidates(values)
    assert sensor.pixel.read_noise_e == candidates.pixel["read_noise_e"][0] == 10.5
    assert sensor.pixel.dark_current_e_per_s == 25.0
    assert sensor.pixel.prnu == candidates.pixel["prnu"][0] == 0.01
    assert candidates.time_s[0] == pytest.approx(0.0505)
    assert sensor.origin == "model"


@pytest.mark.parametrize("mode", get_args(BinningMode))
def test_binned_pixels_are_searched_with_the_noise_that_their_sensor_has(mode):
    base = replace(BASE, pixel=binned(BASE.pixel, 16, mode))
    space = space_of(base=base, pixel=dict.fromkeys(noise_properties(), 0.02))
    values = rows(space, [0.5])
    pixel = space.sensor(values[0], name="one").pixel
    for name, amount in space.candidates(values).pixel.items():
        assert amount[0] == getattr(pixel, name) > 0
    assert pixel.dsnu_e == pytest.approx(4 * 0.02)


REFUSED = {
    "bounds the wrong way round": (
        {"ir_cut": Filter(model="ir-cut", numbers={"cutoff_nm": Free(low=900.0, high=600.0)})},
        {"subject": "bounds of ir_cut.cutoff_nm", "value": (900.0, 600.0)},
    ),
    "a bound that is no number": (
        {"ir_cut": Filter(model="ir-cut", numbers={"cutoff_nm": Free(low=math.nan, high=600.0)})},
        {"subject": "ir_cut.cutoff_nm"},
    ),
    "an unknown filter": (
        {"ir_cut": Filter(model="ircut")},
        {"subject": "filter of ir_cut", "value": "ircut"},
    ),
    "a number of the pixel that is no noise": (
        {"pixel": {"full_well_e": Free(low=1.0, high=9.0)}},
        {"subject": "number of the pixel", "value": "full_well_e"},
    ),
    "an unknown number": (
        {"ir_cut": Filter(model="ir-cut", numbers={"cut_off_nm": 650.0})},
        {"subject": "number of ir_cut", "value": "cut_off_nm"},
    ),
    "a number that is missing": (
        {"ir_cut": Filter(model="ir-cut")},
        {"subject": "ir_cut.cutoff_nm"},
    ),
    "a tie to nothing": (
        {"ir_cut": Filter(model="ir-cut", numbers={"cutoff_nm": "R.centre_nm"})},
        {"subject": "ir_cut.cutoff_nm", "value": "R.centre_nm"},
    ),
    "a tie to itself": (
        {"ir_cut": Filter(model="ir-cut", numbers={"cutoff_nm": "ir_cut.cutoff_nm"})},
        {"subject": "ir_cut.cutoff_nm", "value": "ir_cut.cutoff_nm"},
    ),
    "a tie in a circle": (
        {
            "ir_cut": Filter(
                model="ir-cut",
                numbers={"cutoff_nm": "ir_cut.width_nm", "width_nm": "ir_cut.cutoff_nm"},
            )
        },
        {"subject": "ir_cut.width_nm", "value": "ir_cut.cutoff_nm"},
    ),
    "a tie to another unit": (
        {"ir_cut": Filter(model="ir-cut", numbers={"cutoff_nm": "silicon.depth_um"})},
        {"subject": "ir_cut.cutoff_nm", "value": "silicon.depth_um"},
    ),
    "nothing free": (
        {"channels": (Channel(name="W"),), "ir_cut": None},
        {"subject": "design"},
    ),
    "a peak above 1": (
        {"channels": (Channel(name="R", filter=bell(500.0, 600.0, peak=1.2)),)},
        {"subject": "R.peak", "value": 1.2},
    ),
    "a bound of a peak above 1": (
        {"ir_cut": bell(500.0, 600.0, peak=Free(low=0.5, high=90.0))},
        {"subject": "ir_cut.peak", "value": 90.0},
    ),
    "a start outside the bounds": (
        {"ir_cut": Filter(
            model="ir-cut", numbers={"cutoff_nm": Free(low=600.0, high=700.0, start=500.0)}
        )},
        {"subject": "start of ir_cut.cutoff_nm", "value": 500.0},
    ),
    "a channel that sees nothing": (
        {"channels": (Channel(name="N", filter=bell(100.0, 200.0, width_nm=5.0)),)},
        {"subject": "channel N"},
    ),
    "a channel twice": ({"channels": (RGB[0], RGB[0])}, {"subject": "channels", "value": "R"}),
    "no channel": ({"channels": ()}, {"subject": "number of channels", "value": 0}),
    "17 channels": (
        {"channels": tuple(Channel(name=f"c{i}") for i in range(17))},
        {"subject": "number of channels", "value": 17},
    ),
    "a channel that the base does not have": (
        {"channels": (Channel(name="R", base="R"),)},
        {"subject": "R.base", "value": "R"},
    ),
    "a curve that the library does not have": (
        {"channels": (Channel(name="D", filter=Filter(model="dye", curves=("red",))),)},
        {"subject": "curve of D", "value": "red"},
    ),
    "a dye without a curve": (
        {"channels": (Channel(name="D", filter=Filter(model="dye")),)},
        {"subject": "curves of D"},
    ),
    "a curve for a model": (
        {"ir_cut": replace(CUT, curves=("dark",))},
        {"subject": "curves of ir_cut"},
    ),
    "shares that are not all of the pixels": (
        {"pixel_shares": (0.5, 0.25, 0.2)},
        {"subject": "pixel_shares", "value": 0.95},
    ),
    "shares of layers": (
        {"structure": "layers", "layers": {f"{c}_um": 1.0 for c in "RGB"}, "pixel_shares": "free"},
        {"subject": "pixel_shares"},
    ),
    "a mosaic of other channels": (
        {"mosaic": bayer(), "channels": RGB[:2]},
        {"subject": "mosaic"},
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", sorted(REFUSED))
def test_a_design_that_cannot_be_is_refused_by_what_is_wrong(case):
    fields, expected = REFUSED[case]
    with refused_input(**expected):
        space_of(**fields)


@given(spaces, anywhere)
def test_a_space_computes_the_same_in_another_process(space, shares):
    values = rows(space, shares)
    sent = pickle.loads(pickle.dumps(space))
    np.testing.assert_array_equal(sent.curves(values), space.curves(values))


def test_values_of_another_space_are_refused():
    with refused_input(subject="values", value=(2, 3)):
        SPACES["gaussian"].curves(np.zeros((2, 3)))


def test_a_value_that_is_not_possible_is_refused():
    values = rows(SPACES["gaussian"], [0.5])
    values[0, 1] = -5.0
    with refused_input(subject="width_nm", value=-5.0):
        SPACES["gaussian"].curves(values)


def test_a_member_without_qe_in_a_channel_is_refused():
    space = space_of(channels=(Channel(name="N", filter=bell(100.0, 500.0, width_nm=5.0)),))
    with refused_input(subject="QE of dark", where="channel N"):
        space.sensor(np.array([100.0, 650.0]), name="dark")


def test_a_parameter_refuses_a_negative_tolerance():
    with refused_input(subject="tolerance of x", value=-1.0):
        Parameter(name="x", unit="1", low=0.0, high=1.0, tolerance=-1.0)
