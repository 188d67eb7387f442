"""Noise-aware matrices, trade-offs, and sensors compared at equal color error."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import chromanoise as cn
from chromanoise.base import InputError
from chromanoise.charts import shown
from chromanoise.charts.sensor_table import ranking
from chromanoise.color import NoiseAwareFamily, noise_aware, training_response, white_preserving
from chromanoise.color.spaces import D65_WHITE, LAB, LUV
from chromanoise.color.training import chart_training, smooth_training
from chromanoise.metrics import mean_chart_errors, scielab_filtered
from chromanoise.metrics.visual_noise import visual_noise_of_picture
from chromanoise.noise import Exposure
from chromanoise.sensor import Converter, Pixel, with_channels
from chromanoise.spectra import DEFAULT_GRID, Grid, Spectra, cie_illuminant, equal_energy
from chromanoise.study import (
    HARDLY_SEEN_DELTA_E,
    Viewing,
    electrons_at,
    equal_color,
    mean_color_error,
    noise_as_viewed,
    sensor_named,
    study_from_data,
    trade_off,
    training_named,
)
from chromanoise.study.color_noise import noise_beyond_first_order
from chromanoise.study.trade_offs import FEW_CHANNELS, NO_CHART, SATURATED, _along_light
from strategies import EXPOSURE, GRID, bell_qe, point_of, sensor_of, sensors

LAMP = equal_energy(GRID)
SMOOTH = smooth_training(LAMP)
WEIGHTS = np.array([0.0, 1e-3, 1.0, 30.0, np.inf])
PAIR = ("onyx-rgbw", "onyx-rgb-ircut")
SENSORS = (
    "onyx-rgb",
    "onyx-rgb-ircut",
    "onyx-rgbw-ircut",
    "model-cmy",
    "model-mono",
    "model-rgbir",
)


def paper_point(sensor, level_lux=10.0, time_s=11.94e-3):
    sensor = sensor_named(sensor, DEFAULT_GRID) if isinstance(sensor, str) else sensor
    return point_of(sensor, level_lux, exposure=Exposure(time_s=time_s))


def quiet_and_strong(read_noise_e):
    """One sensor with 0.5 e- of read noise; one with more, and four times the light."""
    base = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    quiet = replace(base, name="quiet", qe=base.qe / 4, pixel=replace(base.pixel, read_noise_e=0.5))
    pixel = replace(base.pixel, read_noise_e=read_noise_e)
    return [paper_point(one) for one in (quiet, replace(base, name="strong", pixel=pixel))]


def turns_over_light(found):
    return [one for one in found.turns if one.over == "light [lx]"]


def family_at(point, prior):
    training = training_named(prior, point.illuminant)
    return NoiseAwareFamily(point.sensor, point.exposure, training, level_lux=point.level_lux)


def drawn_gray(point, matrix, side, rng):
    """X, Y, Z of a picture of an 18 % gray, over those of the white."""
    white_e, read_e = electrons_at(point), point.sensor.pixel.read_noise_e
    shape = (side, side, white_e.size)
    raw = rng.poisson(0.18 * white_e, shape) + read_e * rng.normal(size=shape)
    return raw @ matrix.T / (matrix @ white_e)


def noise_of_picture(xyz):
    return visual_noise_of_picture(
        xyz,
        lambda one: LUV.from_xyz(one, np.ones(3)),
        pixels_per_degree=Viewing().pixels_per_degree,
    ).total


def xyz_costs(matrices, seen):
    """Squared color error and noise variance of X, Y, Z, over the training set."""
    missed = seen.electrons @ np.swapaxes(matrices, -1, -2) - seen.xyz
    bias = np.einsum("k,qkc->q", seen.share, missed**2)
    return bias, np.einsum("qcp,pr,qcr->q", matrices, seen.noise_e2, matrices)


# the family


@given(sensors(min_channels=2))
def test_every_noise_aware_matrix_keeps_the_white(sensor):
    family = NoiseAwareFamily(sensor, EXPOSURE, SMOOTH, level_lux=1.0)
    seen = training_response(SMOOTH, sensor, EXPOSURE, level_lux=1.0)
    for matrix in family.matrices(WEIGHTS):
        assert matrix @ seen.white_e == pytest.approx(seen.white_xyz, rel=1e-9)


@given(sensors(min_channels=3, max_channels=4))
def test_without_weight_it_is_the_white_preserving_least_squares(sensor):
    ours = noise_aware(sensor, EXPOSURE, SMOOTH, level_lux=1.0, weight=0.0).matrix
    theirs = white_preserving(sensor, EXPOSURE, SMOOTH, level_lux=1.0).matrix
    seen = training_response(SMOOTH, sensor, EXPOSURE, level_lux=1.0)
    errors = [xyz_costs(one[None], seen)[0][0] for one in (ours, theirs)]
    assert errors[0] == pytest.approx(errors[1], rel=1e-6, abs=1e-18 * (seen.xyz**2).sum())


@given(sensors(min_channels=2), st.floats(1e-3, 1e3), st.integers(0, 2**32 - 1))
def test_no_other_matrix_that_keeps_the_white_has_less_error_plus_weighted_noise(
    sensor, weight, seed
):
    family = NoiseAwareFamily(sensor, EXPOSURE, SMOOTH, level_lux=1.0)
    seen = training_response(SMOOTH, sensor, EXPOSURE, level_lux=1.0)
    best = family.matrices(np.array([weight]))
    step = np.random.default_rng(seed).normal(size=best.shape)
    step -= (step @ seen.white_e)[..., None] * seen.white_e / (seen.white_e @ seen.white_e)
    size = 1e-3 * np.abs(best).max() / np.abs(step).max()
    own, moved = (
        float(bias[0] + weight * noise[0])
        for bias, noise in (xyz_costs(best, seen), xyz_costs(best + size * step, seen))
    )
    assert own <= moved * (1 + 1e-9)


@given(sensors(min_channels=2))
def test_more_weight_means_more_color_error_and_less_noise_in_xyz(sensor):
    family = NoiseAwareFamily(sensor, EXPOSURE, SMOOTH, level_lux=1.0)
    seen = training_response(SMOOTH, sensor, EXPOSURE, level_lux=1.0)
    bias, noise = xyz_costs(family.matrices(family.weights()), seen)
    size = bias.max() + noise.max()
    assert (np.diff(bias) >= -1e-9 * size).all()
    assert (np.diff(noise) <= 1e-9 * size).all()


def test_the_matrix_of_least_noise_is_the_one_printed_for_read_noise_alone():
    # the limit of (13.5) for D65 on 400-1050 nm at 5 nm: noise without light

    grid = Grid.uniform(400, 1050, 5)
    lamp = cie_illuminant("D65", grid, beyond="hold")
    sensor = replace(
        sensor_named("onyx-rgb-ircut", grid),
        pixel=Pixel(pitch_um=10, full_well_e=1e6, read_noise_e=3.0),
    )
    training = chart_training(lamp)
    family = NoiseAwareFamily(sensor, EXPOSURE, training, level_lux=1e-9)
    seen = training_response(training, sensor, EXPOSURE, level_lux=1e-9)
    gray = family.matrices(np.array([np.inf]))[0] * seen.white_e / seen.white_xyz[:, None]
    assert gray == pytest.approx(np.tile([0.275624, 0.343794, 0.380582], (3, 1)), abs=1e-6)


# trade-offs and the comparison


def test_the_noise_of_a_trade_off_is_that_of_a_drawn_picture_of_the_gray():
    point = paper_point("onyx-rgb-ircut", level_lux=100.0, time_s=1e-3)
    trade = trade_off(point)
    k = int(np.argmin(trade.color_error))
    rng = np.random.default_rng(5)
    matrix = trade.matrices[k]
    totals = [noise_of_picture(drawn_gray(point, matrix, 256, rng)) for _ in range(6)]
    assert trade.visual_noise[k] == pytest.approx(np.mean(totals), rel=0.03)


def test_the_color_error_of_a_trade_off_is_that_of_its_matrices():
    point = paper_point("onyx-rgbw")
    trade = trade_off(point)
    others = mean_chart_errors(point.sensor, trade.matrices, point.exposure, point.illuminant)
    assert trade.color_error == pytest.approx(others, rel=1e-9)


@pytest.mark.parametrize("color_error", [11.0, 14.0, 25.0])
def test_between_two_weights_the_least_noise_is_that_of_a_finer_grid(color_error):
    point = paper_point("onyx-rgb-ircut", level_lux=1.0)
    trade = trade_off(point)
    place = trade.place(color_error)
    fine = np.geomspace(1e-4, 1e4, 4001)
    matrices = family_at(point, "chart-nir").matrices(fine)
    errors = mean_chart_errors(point.sensor, matrices, point.exposure, point.illuminant)
    last = np.flatnonzero(errors <= color_error)[-1]
    white_e = electrons_at(point)
    noise = noise_as_viewed(white_e, point.sensor, point.exposure, matrices[last], Viewing())
    assert trade.noise_at(place) == pytest.approx(noise, rel=2e-3)
    assert trade.weight_at(place) == pytest.approx(fine[last], rel=2e-2)


def test_of_the_papers_pair_the_sensor_with_ir_cut_has_less_noise_at_equal_color_error():
    # PHYSICS-2 section 16: the paper's verdict stands at equal color error
    for level_lux in (0.1, 1.0, 10.0):
        found = equal_color([paper_point(name, level_lux) for name in PAIR])
        assert (found.standings[0].sensor, found.is_tie) == ("onyx-rgb-ircut", False)
        assert found.at_color_error == max(one.least_color_error for one in found.trade_offs)


def test_the_winner_of_random_pairs_is_that_of_drawn_pictures():
    rng = np.random.default_rng(3)
    agreed = compared = 0
    for _ in range(25):
        points = [
            point_of(
                sensor_of(
                    bell_qe(
                        np.array([450, 540, 610]) + rng.normal(0, 12, 3),
                        rng.uniform(25, 50, 3),
                        rng.uniform(0.3, 0.7, 3),
                    ),
                    pixel=Pixel(
                        pitch_um=3.0, full_well_e=1e5, read_noise_e=float(rng.uniform(1, 6))
                    ),
                    name=name,
                ),
                float(10 ** rng.uniform(1.5, 3)),
                exposure=Exposure(time_s=0.01),
            )
            for name in ("one", "other")
        ]
        points[1] = replace(points[1], level_lux=points[0].level_lux)
        found = equal_color(points, prior="smooth-50", turns=False)
        if found.margin_db < max(0.3, found.tie_db):  # 0.3 dB: sampling error of a picture
            continue
        weights, totals = {one.sensor: one.weight for one in found.standings}, {}
        for point in points:
            label = point.sensor.label
            (matrix,) = family_at(point, "smooth-50").matrices(np.array([weights[label]]))
            totals[label] = noise_of_picture(drawn_gray(point, matrix, 96, rng))
        compared += 1
        agreed += min(totals, key=totals.get) == found.standings[0].sensor
    assert compared > 8
    assert agreed >= compared - 1


def test_a_third_sensor_that_is_first_beyond_first_order_makes_a_tie():
    # the second is behind by every measure, the third only to first order
    names = ("model-rgb", "model-ryb", "onyx-rgbw-ircut")
    points = [one.point for one in cn.analyze(*names, lux=1.0, time_ms=5.0).analyses]
    found = equal_color(points, turns=False)
    best, second, third = (
        next(one for one in found.trade_offs if one.point.sensor.label == standing.sensor)
        for standing in found.standings
    )
    visual, again, less = (
        one.noise_beyond_first_order_at(one.place(found.at_color_error)).visual
        for one in (best, second, third)
    )
    assert less < visual < again
    assert found.is_tie


def test_no_other_order_is_told_that_is_not_one_beyond_first_order():
    names = ("onyx-rgb-ircut", "model-ryb")
    points = [one.point for one in cn.analyze(*names, lux=10.0, time_ms=5.0).analyses]
    assert turns_over_light(equal_color(points)) == []
    there = [trade_off(replace(one, level_lux=0.3)) for one in points]
    places = [one.place(max(two.least_color_error for two in there)) for one in there]
    first_order = [one.noise_at(at) for one, at in zip(there, places, strict=True)]
    beyond = [
        one.noise_beyond_first_order_at(at).visual for one, at in zip(there, places, strict=True)
    ]
    assert (first_order[0] > first_order[1], beyond[0] < beyond[1]) == (True, True)


@pytest.mark.parametrize(("level_lux", "within"), [(20.0, 0.02), (3.0, 0.03), (1.0, 0.04)])
def test_noise_beyond_first_order_is_that_of_a_drawn_gray(level_lux, within):
    point = paper_point("onyx-rgb-ircut", level_lux)
    sensor, white_e = point.sensor, electrons_at(point)
    matrix = trade_off(point).matrices[0]
    drawn = drawn_gray(point, matrix, 512, np.random.default_rng(8))
    per_degree = Viewing().pixels_per_degree
    seen = scielab_filtered(drawn * D65_WHITE, pixels_per_degree=per_degree) / D65_WHITE
    lab = LAB.from_xyz(seen, np.ones(3))
    distance = np.linalg.norm(lab - lab.mean(axis=(0, 1)), axis=-1).mean()
    expected = (noise_of_picture(drawn), distance)
    found = noise_beyond_first_order(white_e, sensor, point.exposure, matrix, Viewing())
    assert found == pytest.approx(expected, rel=within)
    if level_lux == 1.0:  # and first order is not
        first = noise_as_viewed(white_e, sensor, point.exposure, matrix, Viewing())
        assert first < 0.8 * expected[0]


@given(st.floats(0.25, 4.0))
def test_a_common_gain_of_all_channels_with_the_electrons_kept_changes_nothing(gain):
    point = paper_point("onyx-rgb-ircut", level_lux=1.0)
    qe = point.sensor.qe * gain / 4
    weaker = replace(
        point,
        sensor=replace(point.sensor, qe=qe),
        exposure=Exposure(time_s=point.exposure.time_s * 4 / gain),
    )
    one, other = trade_off(point), trade_off(weaker)
    assert other.visual_noise == pytest.approx(one.visual_noise, rel=1e-7)
    assert other.color_error == pytest.approx(one.color_error, rel=1e-9)


@given(st.integers(0, 2**32 - 1))
def test_one_more_channel_never_raises_the_least_total_error_in_xyz(seed):
    rng = np.random.default_rng(seed)
    qe = bell_qe(rng.uniform(430, 640, 4), rng.uniform(20, 60, 4), rng.uniform(0.1, 0.8, 4))
    names = ("a", "b", "c", "d")
    four = sensor_of(qe, names=names)
    three = with_channels(four, names[:3], name="three")
    totals = []
    for sensor in (three, four):
        seen = training_response(SMOOTH, sensor, EXPOSURE, level_lux=1.0)
        best = noise_aware(sensor, EXPOSURE, SMOOTH, level_lux=1.0, weight=1.0).matrix
        bias, noise = xyz_costs(best[None], seen)
        totals.append(float(bias[0] + noise[0]))
    assert totals[1] <= totals[0] * (1 + 1e-9)


def test_a_sensor_against_itself_is_a_tie_and_no_winner():
    twin = replace(sensor_named("onyx-rgb-ircut", DEFAULT_GRID), name="twin")
    verdict = cn.analyze("onyx-rgb-ircut", twin, lux=1.0, time_ms=10.0).verdict
    assert verdict.winner is None
    assert verdict.margin_db == 0.0


@pytest.mark.parametrize("number", range(4))
def test_one_more_channel_never_has_more_noise_at_equal_color_error(number):
    rng = np.random.default_rng(number)
    point = paper_point("onyx-rgb-ircut", level_lux=1.0, time_s=5e-3)
    three = point.sensor
    ripple = 1 + 0.1 * np.sin(DEFAULT_GRID.wavelength_nm / rng.uniform(8, 40))
    qe = np.column_stack([three.qe, three.qe[:, rng.integers(3)] * ripple / 1.1])
    four = replace(point, sensor=replace(three, qe=qe, names=(*three.names, "fourth"), name="4"))
    fewer, more = trade_off(point), trade_off(four)
    for error in np.linspace(fewer.least_color_error, fewer.color_error.max(), 7):
        noises = [one.noise_at(one.place(error)) for one in (fewer, more)]
        assert noises[1] <= noises[0] * (1 + 1e-9)


def test_a_channel_that_does_not_help_is_not_used():
    found = cn.analyze("mt9v024-rgb", "mt9v024-rgbw", lux=5, time_ms=5).verdict.at_equal_color
    assert {one.channels for one in found.standings} == {("R", "G", "B")}
    assert found.is_tie


def test_sensors_that_cannot_be_compared_are_left_out_with_the_reason():
    result = cn.analyze(*PAIR, "model-mono", lux=1.0, time_ms=10.0)
    compared = result.to_dict()["verdict"]["sensors"]
    assert [one["name"] for one in compared] == ["onyx-rgb-ircut", "onyx-rgbw"]
    (left_out,) = result.verdict.at_equal_color.left_out
    assert (left_out.sensor, left_out.why) == ("model-mono", FEW_CHANNELS)
    full = cn.analyze(*PAIR, "onyx-rgb", lux=10, time_ms=17, patch=0.18).verdict
    assert ("onyx-rgbw", SATURATED) in [
        (one.sensor, one.why) for one in full.at_equal_color.left_out
    ]
    grays = Spectra(
        wavelength_nm=DEFAULT_GRID.wavelength_nm,
        values=np.tile([0.1, 0.4, 0.8], (DEFAULT_GRID.n, 1)),
        names=("dark", "middle", "light"),
        source="grays",
        quantity="reflectance",
        unit="1",
    )
    points = [replace(paper_point(name), chart=grays) for name in PAIR]
    assert {one.why for one in equal_color(points).left_out} == {NO_CHART}


def test_points_in_other_light_are_refused():
    with pytest.raises(InputError, match="must have one light"):
        equal_color([paper_point("onyx-rgbw", 1.0), paper_point("onyx-rgb-ircut", 10.0)])


def test_two_sensors_of_one_label_keep_their_own_numbers():
    rgbw, rgb = (replace(sensor_named(name, DEFAULT_GRID), shown_as="X") for name in PAIR)
    found = equal_color([paper_point(one) for one in (rgbw, rgb)], turns=False)
    apart = equal_color([paper_point(name) for name in PAIR], turns=False)
    assert found.margin_db == pytest.approx(apart.margin_db)
    assert [one.visual_noise for one in found.standings] == [
        one.visual_noise for one in apart.standings
    ]


def test_the_order_turns_where_read_noise_gives_way_to_shot_noise():
    points = quiet_and_strong(40.0)
    (turn,) = turns_over_light(equal_color(points))
    assert turn.winner == "strong"
    near = [
        equal_color([replace(one, level_lux=turn.first * f) for one in points], turns=False)
        for f in (0.5, 1.0, 2.0)
    ]
    assert [one.standings[0].sensor for one in near[::2]] == ["quiet", "strong"]
    assert near[1].margin_db < 1.0


def test_where_color_is_lost_in_the_noise_of_all_there_is_no_turn():
    # far in the dark the sensor without IR-cut has less noise, but no sensor shows colors there
    points = quiet_and_strong(6.0)
    dark = equal_color([replace(one, level_lux=0.1) for one in points], turns=False)
    assert (dark.standings[0].sensor, dark.winner) == ("quiet", None)
    assert turns_over_light(equal_color(points)) == []


def test_the_compared_color_error_is_the_least_of_a_named_sensor_and_unused_channels_are_told():
    found = cn.analyze("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", lux=3).verdict
    limiting = found.at_equal_color.limiting
    assert limiting.least_color_error == found.at_color_error
    first = found.sentences[0]
    assert f"the least of {limiting.sensor};" in first
    for one in found.at_equal_color.standings:
        left_out = set(sensor_named(one.name, DEFAULT_GRID).names) - set(one.channels)
        named = one is found.at_equal_color.standings[0]
        assert (f"{one.sensor} (without" in first) == bool(left_out and named)


def test_a_tie_and_a_lead_below_it_are_no_turn():
    base = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    almost = replace(base, name="almost", qe=base.qe * [1.002, 0.999, 1.001])
    found = equal_color([paper_point(one) for one in (base, almost)])
    assert found.is_tie
    assert found.turns == ()
    assert found.winner is None


def test_in_deep_dark_the_color_of_each_sensor_is_lost_and_there_is_no_winner():
    dark = cn.analyze(*PAIR, lux=0.01, time_ms=11.94).verdict
    light = cn.analyze(*PAIR, lux=10.0, time_ms=11.94).verdict
    assert [one.is_lost for one in dark.at_equal_color.standings] == [True, True]
    assert dark.winner is None
    assert not any(one.is_lost for one in light.at_equal_color.standings)


@settings(max_examples=4)
@given(
    level_lux=st.sampled_from([0.1, 10.0]),
    names=st.sets(st.sampled_from(SENSORS), min_size=1, max_size=3),
)
def test_no_number_of_a_sensor_depends_on_its_neighbors(level_lux, names):
    data = {
        "light": {"level_lux": level_lux},
        "exposure": {"time_ms": 1.0},
    }

    def rows(*sensors):
        parts = [{"name": one} for one in sensors]
        table = ranking(shown(study_from_data({"sensors": parts, **data}, source="")).analyses)
        keys = [one["key"] for one in table["columns"]]
        return {row["name"]: dict(zip(keys, row["values"], strict=True)) for row in table["rows"]}

    alone = rows("onyx-rgbw")["onyx-rgbw"]
    among = rows("onyx-rgbw", *sorted(names - {"onyx-rgbw"}))["onyx-rgbw"]
    assert {key: among[key] for key in alone if key != "rank"} == {
        key: value for key, value in alone.items() if key != "rank"
    }


def test_the_json_of_two_sensors_has_the_verdict_and_that_of_one_has_none():
    data = cn.analyze(*PAIR, lux=10.0, time_ms=11.94).to_dict()["verdict"]
    assert {"winner", "margin_db", "at_color_error", "reader", "sentences"} <= set(data)
    assert data["winner"] == "onyx-rgb-ircut"
    assert data["reader"] == "eye"
    assert "verdict" not in cn.analyze("onyx-rgbw", lux=10.0).to_dict()


@pytest.mark.parametrize("level_lux", [0.1, 10.0])
def test_the_raw_snr_of_the_gray_is_that_of_independent_channels(level_lux):
    verdict = cn.analyze(*PAIR, "onyx-rgb", lux=level_lux, time_ms=11.94).verdict
    first, *others = verdict.at_equal_color.standings
    for one in (first, *others):
        point = paper_point(one.name, level_lux=level_lux)
        used = [point.sensor.names.index(name) for name in one.channels]
        gray_e = 0.18 * electrons_at(point)[used]  # independent channels: squares of SNRs add
        snr = np.sqrt((gray_e**2 / (gray_e + point.sensor.pixel.read_noise_e**2)).sum())
        assert one.gray_snr_db == pytest.approx(20 * np.log10(snr))
    rgbw = next(one for one in others if one.name == "onyx-rgbw")
    assert rgbw.gray_snr_db > first.gray_snr_db  # the paper: the better raw signal ...
    assert rgbw.lost_in_matrix_db > 10.0  # ... and the noisier color


@pytest.mark.parametrize("gain", [0.25, 0.5])
def test_of_a_darker_twin_all_noise_is_in_the_raw_signal(gain):
    pixel = Pixel(pitch_um=10, full_well_e=1e4, read_noise_e=0.0)
    bright = replace(sensor_named("onyx-rgb-ircut", DEFAULT_GRID), pixel=pixel)
    dark = replace(bright, name="dark", qe=gain * bright.qe)
    first, second = cn.analyze(bright, dark, lux=3.0, time_ms=10.0).verdict.at_equal_color.standings
    assert (first.name, second.name) == (bright.name, "dark")
    assert first.gray_snr_db - second.gray_snr_db == pytest.approx(-10 * np.log10(gain))
    assert second.lost_in_matrix_db == pytest.approx(0.0, abs=0.01)


def test_a_channel_that_no_matrix_uses_is_no_reason():
    verdict = cn.analyze("mt9v024-rgb", "mt9v024-rgbw", lux=10.0).verdict
    first, second = verdict.at_equal_color.standings
    assert first.channels == second.channels
    assert first.gray_snr_db == pytest.approx(second.gray_snr_db)
    assert second.lost_in_matrix_db == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("gain_e_per_dn", [20.0, 40.0, 200.0])
def test_a_sensor_is_not_compared_where_the_steps_of_its_converter_hide_its_noise(gain_e_per_dn):
    fine = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    fine = replace(fine, pixel=replace(fine.pixel, read_noise_e=1.0))
    steps = Converter(bits=8, gain_e_per_dn=gain_e_per_dn)
    coarse = replace(fine, name="coarse", converter=steps)
    found = cn.analyze(fine, coarse, lux=0.2, time_ms=5.0).verdict
    assert [one.name for one in found.at_equal_color.left_out] == ["coarse"]
    assert found.winner is None
    bright = cn.analyze(fine, coarse, lux=10.0, time_ms=20.0).verdict
    if gain_e_per_dn < 100:
        assert not bright.at_equal_color.left_out
        assert bright.winner != "coarse"


def test_three_equal_channels_are_an_answer_and_no_warning():
    at = DEFAULT_GRID.wavelength_nm[:, None]
    qe = 0.5 * np.exp(-0.5 * ((at - 650.0) / 40.0) ** 2) * np.ones((1, 3))
    equal = replace(sensor_named("onyx-rgb", DEFAULT_GRID), name="equal", qe=qe)
    found = cn.analyze(equal, "onyx-rgb", lux=10.0).verdict
    assert [one.name for one in found.at_equal_color.left_out] == ["equal"]


def test_a_sensor_that_reaches_no_color_error_of_the_others_is_not_compared():
    at = DEFAULT_GRID.wavelength_nm[:, None]
    qe = 0.4 * np.exp(-0.5 * ((at - np.array([850.0, 900.0, 950.0])) / 30.0) ** 2)
    infrared = replace(sensor_named("onyx-rgb", DEFAULT_GRID), name="infrared", qe=qe)
    trio = ("onyx-rgb-ircut", "onyx-rgb", infrared)
    found = cn.analyze(*trio, lux=10.0, time_ms=5.0).verdict.at_equal_color
    assert [one.name for one in found.left_out] == ["infrared"]
    assert found.errors[0] < found.errors[1]
    assert np.isfinite(found.tie_db)
    assert all(one.color_error <= found.at_color_error * (1 + 1e-9) for one in found.standings)


def test_a_matrix_without_a_valid_y_changes_no_verdict_at_equal_color(tmp_path):
    path = tmp_path / "negative.csv"
    path.write_text("-1,0,0\n0,-1,0\n0,0,-1\n", encoding="utf-8")
    pair = ("onyx-rgb", "onyx-rgb-ircut")
    result = cn.analyze(*pair, lux=10.0, matrix=str(path)).verdict
    assert result.winner == "onyx-rgb-ircut"
    assert result.told[0].about == "winner"
    assert sum("no valid Y" in one for one in result.sentences) == 2


@pytest.mark.parametrize("names", [PAIR, ("onyx-rgb-ircut", "onyx-rgbw-ircut")])
def test_the_verdict_names_who_has_the_least_error_and_noise_together_or_all_who_are_near(names):
    verdict = cn.analyze(*names, lux=10.0, time_ms=11.94).verdict
    (told,) = [one.text for one in verdict.told if one.about == "total"]
    totals = {one.name: one.least_total_error for one in verdict.at_equal_color.standings}
    near = {
        name for name, one in totals.items() if one < min(totals.values()) + HARDLY_SEEN_DELTA_E
    }
    before = told.partition("ΔE*ab")[0].replace(",", " ").split()
    assert {name for name in names if name in before} == near


@pytest.mark.parametrize(("matrix", "is_below"), [("least-squares", True), ("kernel", False)])
def test_a_matrix_with_less_color_error_than_all_that_are_compared_is_told(matrix, is_below):
    pair = ("onyx-rgb-ircut", "onyx-rgbw-ircut")
    result = cn.analyze(*pair, lux=10.0, matrix=matrix)
    least = [one.least_color_error for one in result.verdict.at_equal_color.standings]
    own = [mean_color_error(one) for one in result.analyses]
    assert (min(own) < min(least) - 0.05) == is_below
    told = [one for one in result.verdict.sentences if "less than with every noise-aware" in one]
    assert bool(told) == is_below


def test_for_a_machine_the_winner_is_that_of_the_median_pair():
    verdict = cn.analyze(*PAIR, lux=10.0, time_ms=11.94, reader="machine").verdict
    assert (verdict.winner, verdict.at_color_error) == ("onyx-rgbw", None)
    assert verdict.margin_db > 3.0
    twin = replace(sensor_named("onyx-rgbw", DEFAULT_GRID), name="twin")
    assert cn.analyze("onyx-rgbw", twin, lux=10.0, reader="machine").verdict.winner is None


def test_the_trade_offs_of_several_light_levels_are_those_of_each_alone():
    point = paper_point("onyx-rgbw", level_lux=1.0)
    levels = (0.01, 1.0, 8.0, 1e4)
    *together, full = _along_light(point, levels, "chart-nir", Viewing(), 4)
    assert full == SATURATED
    for level, one in zip(levels, together, strict=False):
        (alone,) = _along_light(point, (level,), "chart-nir", Viewing(), 4)
        assert one.point.level_lux == level
        for name in ("weights", "matrices", "color_error", "visual_noise", "snr_y_db"):
            np.testing.assert_allclose(getattr(one, name), getattr(alone, name), rtol=1e-9)
