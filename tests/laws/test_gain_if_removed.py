"""The gain of removing a cause is that of a sensor built without it; crosstalk has its sign."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import chromanoise as cn
from chromanoise.color import kernel_matrix
from chromanoise.metrics import Cost
from chromanoise.metrics.budget import color_budget, contravariant_budget, lab_budget
from chromanoise.noise import Exposure, noise_sources
from chromanoise.sensor import SOURCES, crosstalk_of_share, mosaic_named, with_crosstalk, with_pixel
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field, is_infrared
from chromanoise.study import (
    analyzed,
    color_budgets,
    contravariant_budgets,
    lab_budgets,
    sensor_named,
)
from dear import dear

LAMP = equal_energy(DEFAULT_GRID)
WHITE = flat_field(LAMP, level_lux=10.0)
EXPOSURE = Exposure(time_s=0.012)
MOSAICS = {"model-rgb": "bayer", "onyx-rgb-ircut": "bayer", "onyx-rgbw": "rgbw-2x2"}
STAGES = ("light", "charge")
NOISE = {
    "read noise": {"read_noise_e": 10.0},
    "dark current": {"dark_current_e_per_s": 3000.0},
    "quantization": {"bits": 10},
    "row noise": {"row_noise_e": 4.0},
    "column noise": {"column_noise_e": 5.0},
    "reset noise": {"reset_capacitance_ff": 0.5},
    "telegraph noise": {"rtn_share": 0.1, "rtn_amplitude_e": 30.0},
    "DSNU": {"dsnu_e": 6.0},
    "PRNU": {"prnu": 0.02},
}


def crossed(sensor, share, stage, mosaic=None):
    mixed = crosstalk_of_share(share, mosaic_named(mosaic or MOSAICS[sensor.name]), sensor.names)
    return with_crosstalk(sensor, replace(mixed, stage=stage))


def noisy(name, *without):
    given_settings = {}
    for cause, of_pixel in NOISE.items():
        given_settings |= of_pixel if cause not in without else {}
    if "read noise" in without:
        given_settings["read_noise_e"] = 0.0
    return with_pixel(sensor_named(name, DEFAULT_GRID), given_settings)


def budgets_of(sensor, level_lux=10.0):
    at = analyzed(flat_field(LAMP, level_lux=level_lux), sensor, EXPOSURE)
    found = (*color_budgets(at), *contravariant_budgets(at), *lab_budgets(at))
    return {one.coordinate: one for one in found if one}


def of_cause(budget, cause):
    return next(one for one in budget.costs if one.cause == cause)


# noise


@pytest.mark.parametrize(
    ("stage", "level_lux"), [("charge", 0.05), *dear((None, 0.05), ("light", 10.0))]
)
def test_the_gain_of_a_source_is_the_snr_of_a_sensor_built_without_it(stage, level_lux):
    def budgets_without(*causes):
        sensor = noisy("model-rgb", *causes)
        return budgets_of(crossed(sensor, 0.1, stage) if stage else sensor, level_lux)

    before = budgets_without()
    assert len(before) == 9
    for cause in NOISE:
        after = budgets_without(cause)
        for coordinate, budget in before.items():
            known = after[coordinate].snr_db - budget.snr_db
            found = of_cause(budget, cause)
            assert found.gain_if_removed_db == pytest.approx(known, abs=1e-9)
            assert found.gain_if_removed_db > 0
            assert found.cost_db > 0


def test_every_source_of_the_library_is_removed_here():
    named = {one.cause for one in SOURCES}
    assert named == {"shot noise", "crosstalk pattern", *NOISE}


def test_a_step_that_is_coarse_only_without_read_noise_is_rounded_exactly():
    """With 10 e- of read noise the step adds step^2 / 12; without it the step exceeds the noise."""
    pixel = {"full_well_e": 2000.0, "bits": 8, "dark_current_e_per_s": 300.0}
    now = with_pixel(sensor_named("model-rgb", DEFAULT_GRID), pixel)
    less = with_pixel(now, {"read_noise_e": 0.0})
    mean_e = analyzed(flat_field(LAMP, level_lux=0.05), now, EXPOSURE).raw.mean
    coarse = [noise_sources(one, EXPOSURE).rounding_is_coarse(mean_e).any() for one in (now, less)]
    assert coarse == [False, True]
    before, after = (budgets_of(one, 0.05) for one in (now, less))
    assert {"X", "Y", "Z", "L*", "a*", "b*"} <= before.keys() & after.keys()
    for coordinate in before.keys() & after.keys():
        known = after[coordinate].snr_db - before[coordinate].snr_db
        gain_db = of_cause(before[coordinate], "read noise").gain_if_removed_db
        assert gain_db == pytest.approx(known, abs=1e-9)


def test_without_read_noise_a_dark_channel_gains_the_decibels_of_its_share():
    """One channel of M electrons: 10 log10((M + 100) / M), here 3.01 dB for M = 100."""
    sensor = sensor_named("model-mono", DEFAULT_GRID)
    sensor = with_pixel(sensor, {"read_noise_e": 10.0})
    whole = float(analyzed(WHITE, sensor, EXPOSURE).raw.mean[0])
    budget = budgets_of(sensor, 10.0 * 100.0 / whole)["M^" + sensor.names[0]]
    gain_db = of_cause(budget, "read noise").gain_if_removed_db
    assert gain_db == pytest.approx(10 * np.log10(2), abs=1e-9)


# crosstalk


@settings(max_examples=6, deadline=None)
@given(
    st.sampled_from(sorted(MOSAICS)), st.floats(0.005, 0.3), st.sampled_from(STAGES),
    st.floats(0.0, 30.0), st.floats(0.0, 0.03), st.sampled_from([0.1, 10.0]),
)  # fmt: skip
def test_the_cost_of_crosstalk_is_the_change_of_the_snr(name, share, stage, read_e, prnu, lux):
    plain = with_pixel(sensor_named(name, DEFAULT_GRID), {"read_noise_e": read_e, "prnu": prnu})
    with_it, without = budgets_of(crossed(plain, share, stage), lux), budgets_of(plain, lux)
    assert with_it.keys() == without.keys()
    for coordinate, budget in with_it.items():
        known = without[coordinate].snr_db - budget.snr_db
        found = of_cause(budget, "crosstalk")
        assert found.gain_if_removed_db == pytest.approx(known, abs=1e-7)
        assert found.cost_db == pytest.approx(known, abs=1e-7)


@settings(max_examples=3, deadline=None)
@given(st.sampled_from(sorted(MOSAICS)), st.floats(0.005, 0.3), st.sampled_from(STAGES))
def test_all_other_rows_are_those_of_the_sensor_without_crosstalk(name, share, stage):
    plain = with_pixel(sensor_named(name, DEFAULT_GRID), {"prnu": 0.02, "dsnu_e": 6.0})
    with_it, without = budgets_of(crossed(plain, share, stage)), budgets_of(plain)
    for coordinate, budget in with_it.items():
        costs = {one.cause: one.cost_db for one in budget.costs if one.cause != "crosstalk"}
        known = {one.cause: one.cost_db for one in without[coordinate].costs}
        assert costs == pytest.approx(known, abs=1e-7)


@settings(max_examples=3, deadline=None)
@given(st.floats(0.01, 0.3), st.sampled_from(STAGES), st.floats(0.0, 0.03))
def test_crosstalk_and_its_pattern_together_cost_what_both_would_gain(share, stage, prnu):
    plain = with_pixel(sensor_named("onyx-rgbw", DEFAULT_GRID), {"prnu": prnu})
    with_it, without = budgets_of(crossed(plain, share, stage, "rgbw-4x4")), budgets_of(plain)
    assert with_it
    for coordinate, budget in with_it.items():
        mixing, pattern = (of_cause(budget, one) for one in ("crosstalk", "crosstalk pattern"))
        known = without[coordinate].snr_db - budget.snr_db
        assert mixing.gain_if_removed_db == pytest.approx(known, abs=1e-7)
        assert mixing.cost_db + pattern.cost_db == pytest.approx(known, abs=1e-7)
        assert pattern.gain_if_removed_db == pytest.approx(pattern.cost_db, abs=1e-9)
        assert pattern.cost_db > 0


@pytest.mark.parametrize(
    ("stage", "known_db"), [("light", [0.121, 1.203, 1.346]), ("charge", [0.002, 0.032, 0.040])]
)
def test_a_tenth_of_crosstalk_costs_the_model_sensor_these_decibels(stage, known_db):
    """Before, its row said 0.03, 0.23 and 0.27 dB, and after counting a gain."""
    found = budgets_of(crossed(sensor_named("model-rgb", DEFAULT_GRID), 0.1, stage))
    rows = [of_cause(found[name], "crosstalk") for name in "XYZ"]
    assert [one.cost_db for one in rows] == pytest.approx(known_db, abs=6e-4)
    assert [one.gain_if_removed_db for one in rows] == pytest.approx(known_db, abs=6e-4)


def test_a_coordinate_that_crosstalk_alone_makes_has_no_row_for_it():
    """A channel beyond the light of the lamp has only the electrons of its neighbors."""
    grid, at_nm = DEFAULT_GRID, DEFAULT_GRID.wavelength_nm
    plain = sensor_named("model-rgb", grid)
    qe = np.stack([plain.qe[:, 0], plain.qe[:, 1], np.where(at_nm > 800, 0.5, 0.0)], axis=1)
    mixed = crossed(replace(plain, qe=qe), 0.1, "light")
    lit = flat_field(equal_energy(grid), level_lux=10.0)
    lit = replace(lit, reflectance=np.where(at_nm < 700, 1.0, 0.0))
    frame = kernel_matrix(mixed, EXPOSURE).frame
    budget = contravariant_budget(lit, mixed, EXPOSURE, frame, "B")
    costs = {one.cause: one for one in budget.costs}
    assert "crosstalk" not in costs
    assert "without crosstalk M^B has no SNR" in costs["correlation"].reading
    total = sum(one.cost_db for one in budget.costs)
    assert budget.photons_db - total == pytest.approx(budget.snr_db, abs=1e-9)


# infrared, weights, correlation


@pytest.mark.parametrize("stage", [None, *STAGES])
@pytest.mark.parametrize("name", ["onyx-rgbw", "model-rgb"])
def test_the_gain_of_infrared_is_that_of_an_ideal_cut_with_the_same_matrix(name, stage):
    sensor = sensor_named(name, DEFAULT_GRID)
    sensor = sensor if stage is None else crossed(sensor, 0.05, stage)
    matrix = kernel_matrix(sensor, EXPOSURE)
    visible = ~is_infrared(DEFAULT_GRID)[:, None]
    behind = replace(sensor, qe=sensor.qe * visible)
    gray = flat_field(LAMP, level_lux=10.0, reflectance=0.18)
    for budget_of, scene, coordinates in (
        (color_budget, WHITE, "XYZ"), (lab_budget, gray, ("L*", "a*", "b*")),
    ):  # fmt: skip
        for coordinate in coordinates:
            now, cut = (
                budget_of(scene, one, EXPOSURE, matrix, coordinate) for one in (sensor, behind)
            )
            gain_db = of_cause(now, "infrared").gain_if_removed_db
            assert gain_db == pytest.approx(cut.snr_db - now.snr_db, abs=1e-9)
            assert abs(gain_db) > 0.1


def test_without_the_weights_of_a_color_the_bound_is_reached():
    for coordinate, budget in budgets_of(sensor_named("onyx-rgbw", DEFAULT_GRID)).items():
        gain_db = of_cause(budget, "weights").gain_if_removed_db
        rest_db = of_cause(budget, "rest").cost_db if coordinate in ("L*", "a*", "b*") else 0.0
        reached = budget.snr_db + rest_db + gain_db
        assert reached == pytest.approx(budget.optimal_linear_snr_db, abs=1e-9)


def test_without_unmixing_a_contravariant_coordinate_is_its_channel():
    at = analyzed(WHITE, sensor_named("onyx-rgbw", DEFAULT_GRID), EXPOSURE)
    raw_db = 20 * np.log10(at.raw.mean / np.sqrt(at.raw.variance))
    for budget, channel_db in zip(contravariant_budgets(at), raw_db, strict=True):
        gain_db = of_cause(budget, "correlation").gain_if_removed_db
        assert budget.snr_db + gain_db == pytest.approx(channel_db, abs=1e-9)


def test_the_rest_comes_last_and_filters_have_no_gain():
    for budget in budgets_of(sensor_named("onyx-rgbw", DEFAULT_GRID)).values():
        rest = of_cause(budget, "rest")
        assert rest.gain_if_removed_db == rest.cost_db
        assert of_cause(budget, "filters").gain_if_removed_db is None


def test_a_cause_without_effect_neither_costs_nor_gains():
    silent = with_pixel(sensor_named("onyx-rgb-ircut", DEFAULT_GRID), {"read_noise_e": 0.0})
    none = crossed(silent, 0.0, "charge")
    for budget in budgets_of(none).values():
        for cause in ("read noise", "crosstalk"):
            row = of_cause(budget, cause)
            assert (row.cost_db, row.gain_if_removed_db) == pytest.approx((0.0, 0.0), abs=1e-12)


# where they are written


def test_json_has_both_numbers_and_the_old_key():
    result = cn.analyze("onyx-rgbw", budget=True).to_dict()["sensors"][0]
    for kind in ("budget", "contravariant_budget", "lab_budget"):
        for budget in filter(None, result[kind]):
            for row in budget["costs"]:
                assert row["loss_db"] == row["cost_db"]
                assert (row["gain_if_removed_db"] is None) == (row["cause"] == "filters")


def test_the_old_attribute_of_a_cost_is_the_new_one_and_warns():
    row = Cost(cause="read noise", cost_db=1.5, gain_if_removed_db=2.0, reading="")
    with pytest.warns(FutureWarning, match="cost_db"):
        assert row.loss_db == 1.5


def test_a_notebook_shows_both_columns():
    budget = budgets_of(sensor_named("onyx-rgbw", DEFAULT_GRID))["Y"]
    shown = budget._repr_html_()
    row = of_cause(budget, "read noise")
    assert "gain if removed [dB]" in shown
    assert f"{row.gain_if_removed_db:+.2f}" in shown
    assert f"{-row.cost_db:+.2f}" in shown
