"""Effects of 1 nm and 1 % of each parameter of a sensor, allowances and tolerance budgets."""

import json
from dataclasses import replace

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.cli.entry import commands
from chromanoise.sensor import moved_curve
from outcomes import refused_input

DB_PER_PERCENT = 10 * np.log10(1.01)  # of a signal limited by shot noise
SENSOR = "onyx-rgb-ircut"
LIGHT = {"lux": 10.0, "time_ms": 30.0}


def slopes(result, objective):
    return {one.parameter.name: one.slope[objective] for one in result.effects}


def without_mosaic(name=SENSOR):
    return replace(cn.sensor_named(name), name="own", mosaic=None)


def snr_y_db(sensor=SENSOR, **settings):
    (snr,) = cn.analyze(sensor, **(LIGHT | settings)).color_snr_db().values()
    return snr["Y"]


def test_shot_limited_snr_grows_by_a_root_of_light_time_and_area():
    found = cn.sensitivity(SENSOR, objectives=["snr_y_db"], read_noise_e=0.0, **LIGHT)
    of = slopes(found, "snr_y_db")
    assert of["time_s"] == pytest.approx(DB_PER_PERCENT, rel=0.01)
    assert of["level_lux"] == pytest.approx(of["time_s"], rel=1e-6)
    assert of["pitch_um"] == pytest.approx(2 * of["time_s"], rel=1e-4)
    assert of["f_number"] == pytest.approx(-2 * of["time_s"], rel=1e-4)
    assert "read_noise_e" not in of


def test_more_qe_of_all_channels_is_more_time():
    names = ["snr_y_db", "total_delta_e", "mean_separation"]
    found = cn.sensitivity(SENSOR, objectives=names, **LIGHT)
    for name in names:
        of = slopes(found, name)
        gains = [slope for key, slope in of.items() if key.endswith(".gain")]
        assert len(gains) == 3
        assert sum(gains) == pytest.approx(of["time_s"], rel=1e-4)


def test_the_shifts_of_all_channels_are_the_shift_of_the_sensor():
    of = slopes(cn.sensitivity(SENSOR, objectives=["snr_y_db"], **LIGHT), "snr_y_db")
    shifted = snr_y_db(shift_nm=0.1) - snr_y_db(shift_nm=-0.1)
    total = sum(slope for key, slope in of.items() if key.endswith(".shift"))
    assert total == pytest.approx(shifted / 0.2, rel=2e-3)


@pytest.mark.parametrize(
    ("name", "unit", "low", "high"),
    [
        ("read_noise_e", "%", {"read_noise_e": 9.9}, {"read_noise_e": 10.1}),
        ("prnu", "%", {"prnu": 0.0099}, {"prnu": 0.0101}),
        ("crosstalk", "% points", {"crosstalk": 0.04}, {"crosstalk": 0.06}),
        ("ircut_nm", "nm", {"ircut_nm": 639.0}, {"ircut_nm": 641.0}),
        ("filter.edge", "nm", {"filter": "ircut-629/9"}, {"filter": "ircut-631/9"}),
    ],
)
def test_an_effect_is_the_difference_of_two_analyses(name, unit, low, high):
    base = {"read_noise_e": 10.0, "prnu": 0.01, "crosstalk": 0.05, "mosaic": "bayer"}
    base |= {"ircut_nm": 640.0, "filter": "ircut-630/9"}
    found = cn.sensitivity("onyx-rgb", objectives=["snr_y_db"], **base, **LIGHT)
    (effect,) = (one for one in found.effects if one.parameter.name == name)
    change = snr_y_db("onyx-rgb", **(base | high)) - snr_y_db("onyx-rgb", **(base | low))
    assert effect.parameter.unit == unit
    assert effect.slope["snr_y_db"] == pytest.approx(change / 2, rel=0.02)


def test_a_kept_matrix_turns_a_shift_into_more_color_error():
    shifts = []
    for keep in (False, True):
        found = cn.sensitivity(
            SENSOR, objectives=["delta_e"], matrix="least-squares", keep_matrix=keep, **LIGHT
        )
        shifts.append(abs(slopes(found, "delta_e")["R.shift"]))
        gain = slopes(found, "delta_e")["R.gain"]
        assert (gain == pytest.approx(0.0, abs=1e-9)) != keep
    assert shifts[1] != pytest.approx(shifts[0], rel=0.1)


def test_the_allowed_change_of_a_parameter_costs_the_loss():
    found = cn.sensitivity(
        SENSOR, objectives=["snr_y_db"], losses={"snr_y_db": 0.05}, f_number=1.8, **LIGHT
    )
    (effect,) = (one for one in found.effects if one.parameter.name == "f_number")
    percent = found.allowance(effect, "snr_y_db")
    lost = snr_y_db(f_number=1.8) - snr_y_db(f_number=1.8 * (1 + percent / 100))
    assert lost == pytest.approx(0.05, rel=0.01)
    together = [found.allowance(one, "snr_y_db", together=True) for one in found.effects]
    lost_each = [
        one.slope["snr_y_db"] * change
        for one, change in zip(found.effects, together, strict=True)
        if change is not None
    ]
    assert np.linalg.norm(lost_each) == pytest.approx(0.05)


def test_drawn_sensors_have_the_spread_of_first_order_and_the_same_shares():
    draws = 600
    found = cn.sensitivity(
        without_mosaic(),
        objectives=["snr_y_db", "delta_e"],
        tolerance_nm=1.0,
        tolerance_percent=1.0,
        draws=draws,
        seed=5,
        **LIGHT,
    )
    for name in ("snr_y_db", "delta_e"):
        total, drawn = found.spread.total[name], found.spread.drawn[name]
        assert abs(drawn / total - 1) * np.sqrt(2 * draws) < 5
        assert found.spread.explained[name] > 0.98
        share = (found.spread.contribution[name] / total) ** 2
        assert share.sum() == pytest.approx(1.0)
        assert np.abs(found.spread.drawn_share[name] - share).max() < 5 / np.sqrt(draws)


def test_no_tolerance_applies_to_exposure_and_light():
    found = cn.sensitivity(SENSOR, objectives=["snr_y_db"], tolerance_percent=5.0, **LIGHT)
    contribution = dict(
        zip(
            [one.parameter.name for one in found.effects],
            found.spread.contribution["snr_y_db"],
            strict=True,
        )
    )
    assert [contribution[name] for name in ("time_s", "f_number", "level_lux")] == [0, 0, 0]
    assert contribution["R.shift"] == 0.0  # no tolerance in nm
    assert contribution["read_noise_e"] > 0


def test_parameters_are_ordered_by_their_effect_on_the_first_objective():
    for name in ("vora", "mean_separation"):
        found = cn.sensitivity(SENSOR, objectives=[name, "snr_y_db"], **LIGHT)
        size = [abs(one.slope[name]) for one in found.effects]
        assert size == sorted(size, reverse=True)


def test_a_saturated_channel_leaves_the_objectives_that_do_not_need_it():
    found = cn.sensitivity(SENSOR, objectives=["snr_y_db", "vora"], time_ms=500.0)
    assert found.value["snr_y_db"] is None
    assert slopes(found, "snr_y_db")["G.shift"] is None
    assert slopes(found, "vora")["G.shift"] != 0
    with refused_input(subject="objectives", value=("snr_y_db",)):
        cn.sensitivity(SENSOR, objectives=["snr_y_db"], time_ms=500.0)


def test_at_full_well_the_effect_is_that_of_less_light():
    found = cn.sensitivity(SENSOR, objectives=["snr_y_db"], saturate=1.0)
    assert slopes(found, "snr_y_db")["level_lux"] == pytest.approx(DB_PER_PERCENT, rel=0.03)


def test_at_the_end_of_its_range_a_parameter_changes_to_the_other_side():
    low, high = (
        slopes(cn.sensitivity(SENSOR, objectives=["snr_y_db"], prnu=prnu, **LIGHT), "snr_y_db")
        for prnu in (0.199, 0.2)
    )
    assert high["prnu"] == pytest.approx(low["prnu"], rel=0.02)


@pytest.mark.parametrize(
    ("settings", "subject"),
    [
        ({"objectives": ["snr"]}, "objectives"),
        ({"objectives": []}, "objectives"),
        ({"draws": 100}, "draws"),
        ({"draws": 3, "tolerance_nm": 1.0}, "draws"),
        ({"tolerance_nm": -1.0}, "tolerance_nm"),
        ({"tolerance_nm": 0.0}, "tolerance_nm"),
        ({"losses": {"smi": 1.0}}, "losses"),
        ({"losses": {"vora": -1.0}}, "loss of vora"),
        ({"clip": True}, "clip"),
    ],
)
def test_what_cannot_be_computed_is_refused(settings, subject):
    with refused_input(subject=subject):
        cn.sensitivity(SENSOR, **settings)


def test_the_command_writes_what_the_function_returns(tmp_path):
    target = tmp_path / "s.json"
    words = ["--lux", "10", "--time-ms", "30", "--loss", "snr_y_db=0.1", "--tolerance-nm", "2"]
    words += ["--draws", "20", "--objectives", "snr_y_db,delta_e", "--json", str(target)]
    commands.main(["sensitivity", SENSOR, *words], standalone_mode=False)
    wanted = cn.sensitivity(
        SENSOR,
        objectives=["snr_y_db", "delta_e"],
        losses={"snr_y_db": 0.1},
        tolerance_nm=2.0,
        draws=20,
        **LIGHT,
    )
    assert json.loads(target.read_text()) == wanted.to_dict()


def test_the_figure_draws_the_effects():
    found = cn.sensitivity(SENSOR, objectives=["snr_y_db", "vora"], **LIGHT)
    widths = [bar.get_width() for bar in found.plot().patches]
    assert widths == [one.slope["snr_y_db"] for one in found.effects[: len(widths)]]


def test_a_stretched_curve_keeps_its_centroid_and_its_width_grows():
    nm = np.arange(400.0, 701.0, 1.0)
    bell = np.exp(-0.5 * ((nm - 550.0) / 20.0) ** 2)

    def moments(curve):
        center = nm @ curve / curve.sum()
        return center, np.sqrt((nm - center) ** 2 @ curve / curve.sum())

    center, width = moments(moved_curve(nm, bell, shift_nm=3.0, width_share=0.1))
    assert center == pytest.approx(553.0, abs=1e-6)
    assert width == pytest.approx(22.0, rel=1e-3)
