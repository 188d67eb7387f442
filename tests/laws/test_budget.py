"""Budgets of X, Y, Z, of L*, a*, b* and of contravariant coordinates.

They add up, and charge nothing to a cause that changes nothing. The signal of a coordinate of
CIELAB is the faintest change, and its budget ends at 1 / sigma. The gain of a cause is what its
removal brings.
"""

import warnings
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import factorial

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from scipy.optimize import minimize

import chromanoise as cn
from chromanoise.apps.paper import paper_study
from chromanoise.apps.paper.printed_numbers import RGB_12, RGBW_12
from chromanoise.base import plain
from chromanoise.color import LAB, NoisyColor, colored, first_order, kernel_matrix, propagate
from chromanoise.metrics import (
    BudgetRequest,
    Cost,
    budget as budget_module,
    budgets_of,
    color_budget,
    contravariant_budget,
    faintest_change,
    lab_budget,
    optimal_linear_snr_db,
    shapley_values,
)
from chromanoise.metrics.budget import counting_snr_db
from chromanoise.metrics.snr_chain import CAUSES, Seen, rounded_share
from chromanoise.noise import Exposure, expected_electrons, noise_sources, with_noise
from chromanoise.sensor import (
    SOURCES,
    NoiseSource,
    Pixel,
    Sensor,
    crosstalk_of_share,
    mosaic_named,
    with_channels,
    with_crosstalk,
    with_pixel,
)
from chromanoise.spectra import (
    DEFAULT_GRID,
    Illuminant,
    Scene,
    cie_illuminant,
    color_axes,
    equal_energy,
    flat_field,
    is_infrared,
    light,
)
from chromanoise.study import (
    Outcome,
    analyzed,
    color_budgets,
    color_snr_db,
    contravariant_budgets,
    lab_budgets,
    missing_color_budgets,
    missing_lab_budgets,
    sensor_named,
)
from chromanoise.study.catalog import SENSOR_NAMES
from dear import dear
from outcomes import refused_input

AT = DEFAULT_GRID.wavelength_nm
LAMP = equal_energy(DEFAULT_GRID)
GRAY = flat_field(LAMP, level_lux=10.0, reflectance=0.18)
WHITE = flat_field(LAMP, level_lux=10.0)
EXPOSURE = Exposure(time_s=0.012)
COORDINATES = LAB.coordinates
EVERY = (*"XYZ", *COORDINATES)
PLAIN = {"pitch_um": 10.0, "full_well_e": 1e6, "read_noise_e": 10.0}
BANDS = ((400, 520), (480, 620), (580, 700))
GRAY_ROOT = 0.18 ** (1 / 3)


def sensor_of(*curves, read_noise_e=10.0):
    names = tuple(f"c{i}" for i in range(len(curves)))
    pixel = Pixel(pitch_um=10.0, full_well_e=1e6, read_noise_e=read_noise_e)
    return Sensor(name="toy", grid=DEFAULT_GRID, qe=np.stack(curves, 1), names=names, pixel=pixel)


def box(first_nm, last_nm, height=0.6):
    return np.where((first_nm <= AT) & (last_nm > AT), height, 0.0)


def eye_sensor():
    """Channels that are the observer's own curves: its kernel color is exact."""
    eye = color_axes(DEFAULT_GRID, "quanta")
    return sensor_of(*(0.9 * eye / eye.max()).T)


APART = (box(400, 490), box(490, 580), box(580, 690))
OVERLAPPING = (box(400, 560), box(470, 640), box(540, 690))


def budget_of(sensor, coordinate="Y", scene=GRAY, exposure=EXPOSURE):
    matrix = kernel_matrix(sensor, exposure)
    of = color_budget if coordinate in matrix.coordinates else lab_budget
    return of(scene, sensor, exposure, matrix, coordinate)


def of_cause(budget, cause):
    return next(one for one in budget.costs if one.cause == cause)


def cost(budget, cause):
    return of_cause(budget, cause).cost_db


def sigmas(sensor, scene=GRAY, exposure=EXPOSURE):
    """By the road of measurements: raw, XYZ, CIELAB."""
    matrix = kernel_matrix(sensor, exposure)
    raw = with_noise(expected_electrons(scene, sensor, exposure), sensor)
    bare = flat_field(scene.illuminant, level_lux=scene.level_lux)
    white = matrix.matrix @ expected_electrons(bare, sensor, exposure)
    color = NoisyColor(xyz=colored(raw, matrix), white=white)
    lab = propagate(color, LAB, first_order).measurement
    return dict(zip(COORDINATES, np.sqrt(lab.variance), strict=True))


@st.composite
def lamps(draw):
    """A slope and a bump over the whole grid."""
    slope = draw(st.floats(-0.9, 0.9))
    center, height = draw(st.floats(420.0, 900.0)), draw(st.floats(0.0, 5.0))
    irradiance = 1 + slope * np.linspace(-1, 1, AT.size)
    irradiance = irradiance + height * np.exp(-0.5 * ((AT - center) / 40) ** 2)
    return Illuminant(name="drawn", grid=DEFAULT_GRID, irradiance=irradiance / irradiance.sum())


@given(
    lamps(), st.sampled_from(SENSOR_NAMES), st.sampled_from(COORDINATES), st.floats(0.05, 1.0),
    st.floats(-2.0, 3.0),
)  # fmt: skip
def test_the_costs_add_up_in_any_light(lamp, name, coordinate, reflectance, log_lux):
    scene = flat_field(lamp, level_lux=10**log_lux, reflectance=reflectance)
    sensor = sensor_named(name, DEFAULT_GRID)
    budget = budget_of(sensor, coordinate, scene)
    assume(budget is not None)
    lost = sum(c.cost_db for c in budget.costs)
    assert budget.photons_db - lost == pytest.approx(budget.snr_db, abs=1e-9)
    sigma = sigmas(sensor, scene)[coordinate]
    assert budget.snr_db == pytest.approx(-20 * np.log10(sigma), abs=1e-9)
    assert [c.cause for c in budget.costs] == [*CAUSES, "rest"]


def test_counting_the_light_itself_has_the_root_of_all_photons_as_its_snr():
    sensor = sensor_of(*APART)
    budget = color_budget(WHITE, sensor, EXPOSURE, kernel_matrix(sensor, EXPOSURE))
    # 131 plain samples: 10 lx * .012 s * 100 um2 / (4 * 1.8^2) * 1.37017e-5 * sum(lambda) / (h c)
    per_pixel = 10 * 0.012 * 100 / (4 * 1.8**2) * 1.37017e-5 * 5 * AT.sum() * 1e-9 * 1e-12
    photons = 3 * per_pixel / 1.98644586e-25
    shape = light(WHITE, "quanta")
    counted = counting_snr_db(shape, shape, photons / shape.sum())
    assert counted == pytest.approx(10 * np.log10(photons), abs=1e-9)
    assert counted == pytest.approx(budget.photons_db, abs=1e-4)


def test_the_faintest_change_of_a_sum_is_the_light_itself():
    lamp = np.array([3.0, 0.0, 1.0, 8.0])
    found = faintest_change(lamp, np.ones((4, 1)), np.array([12.0]))
    assert found == pytest.approx(lamp, abs=1e-12)


def test_no_other_change_of_the_same_color_is_fainter():
    """A minimizer that knows nothing of Lagrange ends at the same sum of dL^2 / L."""
    rng = np.random.default_rng(3)
    lamp, axes = rng.uniform(0.5, 2.0, 7), rng.uniform(0.0, 1.0, (7, 3))
    step = np.array([0.3, -0.2, 0.1])
    found = faintest_change(lamp, axes, step)
    assert axes.T @ found == pytest.approx(step, abs=1e-12)
    searched = minimize(
        lambda d: (d**2 / lamp).sum(),
        np.zeros(7),
        constraints={"type": "eq", "fun": lambda d: axes.T @ d - step},
        options={"ftol": 1e-14},
    )
    assert found == pytest.approx(searched.x, abs=1e-6)


def test_a_light_of_two_wavelengths_cannot_move_three_coordinates():
    lamp = np.where(np.isin(AT, (500.0, 600.0)), 1.0, 0.0)
    axes = color_axes(DEFAULT_GRID, "quanta")
    assert faintest_change(lamp, axes, np.ones(3)) is None
    assert faintest_change(lamp[lamp > 0], axes[lamp > 0], np.ones(3)) is None
    assert faintest_change(0 * lamp, axes, np.ones(3)) is None
    flat = np.isin(AT, (500.0, 600.0)).astype(float)
    scene = Scene(illuminant=LAMP, level_lux=10.0, reflectance=flat)
    assert budget_of(sensor_of(*APART), "a*", scene) is None


def test_lightness_by_counting_is_below_that_of_a_reader_who_knows_the_lights_shape():
    """dL = 3 L / (L* + 16) moves L* alone, by one, at sqrt(p N); another change is fainter still.

    By 1.4 dB where all light is visible: the ends of y-bar tell little of what photons are there.
    """
    sensor = eye_sensor()
    visible = Scene(illuminant=LAMP, level_lux=10.0, reflectance=0.18 * (AT <= 690))
    matrix = kernel_matrix(sensor, EXPOSURE)
    whole = color_budget(visible, sensor, EXPOSURE, matrix)
    white = matrix.matrix @ expected_electrons(WHITE, sensor, EXPOSURE)
    seen = matrix.matrix @ expected_electrons(visible, sensor, EXPOSURE)
    known = whole.photons_db + 20 * np.log10(3 / (116 * np.cbrt(seen[1] / white[1])))
    assert known - 2 < budget_of(sensor, "L*", visible).photons_db < known


@pytest.mark.parametrize("name", ["onyx-rgbw", "onyx-rgb-ircut", "model-three-layer"])
def test_one_unit_of_lightness_ends_at_the_luminance_snr(name):
    """sigma_L* = (L* + 16) / (3 SNR_Y) where L* is a cube root."""
    sensor = sensor_named(name, DEFAULT_GRID)
    y = color_budget(GRAY, sensor, EXPOSURE, kernel_matrix(sensor, EXPOSURE), "Y")
    ends = y.snr_db + 20 * np.log10(3 / (116 * GRAY_ROOT))
    assert budget_of(sensor, "L*").snr_db == pytest.approx(ends, abs=1e-9)


@pytest.mark.parametrize(
    ("coordinate", "factor", "pair"), [("a*", 500, (0, 1)), ("b*", 200, (1, 2))]
)
def test_opponent_noise_of_a_gray_is_that_of_the_difference_of_two_ratios(coordinate, factor, pair):
    """a* = 500 (x^(1/3) - y^(1/3)), so sigma = 500/3 * .18^(1/3) * sd(dX/X - dY/Y) of a gray."""
    sensor = sensor_of(*OVERLAPPING)
    rows = kernel_matrix(sensor, EXPOSURE).matrix
    electrons = expected_electrons(GRAY, sensor, EXPOSURE)
    first, second = (rows[i] / (rows[i] @ electrons) for i in pair)
    sd = np.sqrt(((first - second) ** 2 * (electrons + 100)).sum())
    sigma = factor / 3 * GRAY_ROOT * sd
    assert budget_of(sensor, coordinate).snr_db == pytest.approx(-20 * np.log10(sigma), abs=1e-9)


@pytest.mark.parametrize("coordinate", EVERY)
def test_channels_that_do_not_overlap_pay_nothing_for_correlation(coordinate):
    apart = budget_of(sensor_of(*APART), coordinate)
    assert cost(apart, "correlation") == pytest.approx(0.0, abs=1e-9)
    overlapping = budget_of(sensor_of(*OVERLAPPING), coordinate)
    assert abs(cost(overlapping, "correlation")) > 0.5


@pytest.mark.parametrize("coordinate", EVERY)
def test_a_pixel_without_read_noise_pays_nothing_for_it(coordinate):
    silent = budget_of(sensor_of(*OVERLAPPING, read_noise_e=0.0), coordinate)
    assert cost(silent, "read noise") == 0
    assert cost(budget_of(sensor_of(*OVERLAPPING), coordinate), "read noise") > 0


@pytest.mark.parametrize("coordinate", COORDINATES)
def test_only_a_sensor_open_to_the_infrared_pays_for_it(coordinate):
    blind = budget_of(sensor_named("onyx-rgb-ircut", DEFAULT_GRID), coordinate)
    assert cost(blind, "infrared") == pytest.approx(0.0, abs=0.01)
    open_to_it = budget_of(sensor_named("onyx-rgbw", DEFAULT_GRID), coordinate)
    assert cost(open_to_it, "infrared") > 1


@pytest.mark.parametrize("coordinate", COORDINATES)
def test_a_channel_of_infrared_alone_costs_no_color(coordinate):
    """It brings a pixel of photons that color cannot use, and neither signal nor noise."""
    three = budget_of(sensor_of(*APART), coordinate)
    four = budget_of(sensor_of(*APART, box(850, 1050)), coordinate)
    assert four.snr_db == pytest.approx(three.snr_db, abs=1e-9)
    pixel_more = 10 * np.log10(4 / 3)
    assert four.photons_db - three.photons_db == pytest.approx(pixel_more, abs=1e-9)
    for cause in ("weights", "correlation", "infrared", "rest"):
        assert cost(four, cause) == pytest.approx(cost(three, cause), abs=1e-9)
    assert cost(four, "filters") - cost(three, "filters") == pytest.approx(pixel_more, abs=1e-9)


@given(st.permutations("RGBW"), st.sampled_from(EVERY))
def test_permuting_channels_changes_no_cost(order, coordinate):
    sensor = sensor_named("onyx-rgbw", DEFAULT_GRID)
    mixed = with_channels(sensor, order, name="mixed")
    ours, theirs = budget_of(sensor, coordinate), budget_of(mixed, coordinate)
    for a, b in zip(ours.costs, theirs.costs, strict=True):
        assert a.cost_db == pytest.approx(b.cost_db, abs=1e-9)


@given(st.floats(0.01, 100.0), st.sampled_from(COORDINATES))
def test_more_time_lifts_a_pixel_without_read_noise_from_start_to_end(times, coordinate):
    sensor = sensor_of(*OVERLAPPING, read_noise_e=0.0)
    short, long = (
        budget_of(sensor, coordinate, exposure=Exposure(time_s=0.012 * t)) for t in (1.0, times)
    )
    lifted = 10 * np.log10(times)
    assert long.photons_db - short.photons_db == pytest.approx(lifted, abs=1e-9)
    assert long.snr_db - short.snr_db == pytest.approx(lifted, abs=1e-9)
    for a, b in zip(short.costs, long.costs, strict=True):
        assert a.cost_db == pytest.approx(b.cost_db, abs=1e-9)


@given(st.sampled_from(SENSOR_NAMES), st.sampled_from(COORDINATES))
def test_nothing_that_the_channels_tell_beats_their_best_readout_nor_that_all_photons(
    name, coordinate
):
    budget = budget_of(sensor_named(name, DEFAULT_GRID), coordinate)
    assume(budget is not None)
    assert budget.photons_db > budget.optimal_linear_snr_db
    without_rest = budget.snr_db + cost(budget, "rest")  # the matrix's own gain taken out
    assert budget.optimal_linear_snr_db >= without_rest - 1e-9


def test_a_sensor_that_sees_one_unit_as_one_leaves_no_rest():
    for coordinate in COORDINATES:
        budget = budget_of(eye_sensor(), coordinate)
        assert cost(budget, "rest") == pytest.approx(0.0, abs=1e-9)
        assert budget.costs[-1].reading == f"one unit of {coordinate} comes out as 1.00"


def test_one_channel_has_lightness_but_no_hue():
    sensor = sensor_of(box(400, 690))
    assert [budget_of(sensor, c) is None for c in COORDINATES] == [False, True, True]


def test_a_saturated_sensor_says_so_and_a_missing_coordinate_is_named():
    mono = analyzed(WHITE, sensor_named("model-mono", DEFAULT_GRID), EXPOSURE)
    assert "saturated" in missing_lab_budgets(mono, lab_budgets(mono))
    assert lab_budgets(mono) == (None, None, None)
    short = analyzed(WHITE, mono.sensor, Exposure(time_s=0.002))
    result = lab_budgets(short)
    assert [b is None for b in result] == [False, True, True]
    assert "no budget of a*, b*" in missing_lab_budgets(short, result)
    written = plain(Outcome(analysis=short, asked=("budget",)))
    assert [b is None for b in written["lab_budget"]] == [False, True, True]
    rgb = analyzed(WHITE, sensor_named("onyx-rgb-ircut", DEFAULT_GRID), EXPOSURE)
    assert missing_lab_budgets(rgb, lab_budgets(rgb)) is None


@pytest.mark.parametrize(("more", "scene"), [({}, GRAY), ({"reflectance": 1.0}, WHITE)])
def test_the_budgets_of_a_study_are_of_an_18_percent_gray_in_the_light_of_its_white(more, scene):
    sensor = sensor_named("onyx-rgbw", DEFAULT_GRID)
    study = analyzed(WHITE, sensor, EXPOSURE if not more else Exposure(time_s=0.005))
    measured = sigmas(sensor, scene, study.exposure)
    result = lab_budgets(study, **more)
    assert [b.coordinate for b in result] == list(COORDINATES)
    for budget in result:
        sigma = measured[budget.coordinate]
        assert budget.snr_db == pytest.approx(-20 * np.log10(sigma), abs=1e-9)


@pytest.mark.parametrize("coordinate", ["Y", "L*"])
def test_a_sensor_that_sees_no_color_has_no_budget(coordinate):
    assert budget_of(sensor_of(box(850, 1050)), coordinate) is None


@pytest.mark.parametrize(("of", "coordinate"), [(color_budget, "L"), (lab_budget, "Y")])
def test_an_unknown_coordinate_is_refused(of, coordinate):
    sensor = sensor_of(*APART)
    with refused_input(subject="coordinate", value=coordinate):
        of(GRAY, sensor, EXPOSURE, kernel_matrix(sensor, EXPOSURE), coordinate)


# of X, Y, Z and contravariant coordinates


@given(
    st.floats(470, 520), st.floats(560, 620), st.floats(0.0, 0.3), st.floats(0, 30),
    st.sampled_from("XYZ"),
)  # fmt: skip
def test_the_costs_add_up_to_the_whole_loss(low, high, leak, read_noise_e, coordinate):
    curves = (box(400, low), box(low, high), box(high, 1050), np.full(AT.size, 0.5))
    sensor = sensor_of(*(np.clip(c + leak, 0, 1) for c in curves), read_noise_e=read_noise_e)
    budget = budget_of(sensor, coordinate)
    if budget is None:
        return
    lost = budget.photons_db - budget.snr_db
    assert sum(c.cost_db for c in budget.costs) == pytest.approx(lost, abs=1e-9)
    assert [c.cause for c in budget.costs] == [*CAUSES, "rest"]


@pytest.mark.parametrize("name", ["onyx-rgbw", "onyx-rgb-ircut", "model-three-layer"])
def test_the_bound_of_every_coordinate_is_that_of_the_raw_channels(name):
    """SNR^2 of a linear readout is at most the sum of the squared raw SNRs, read noise included."""
    sensor = sensor_named(name, DEFAULT_GRID)
    electrons = expected_electrons(WHITE, sensor, EXPOSURE)
    bound = 10 * np.log10(sum(e**2 / (e + sensor.pixel.read_noise_e**2) for e in electrons))
    assert bound == pytest.approx(
        float(optimal_linear_snr_db(with_noise(electrons, sensor))), abs=1e-9
    )
    frame = kernel_matrix(sensor, EXPOSURE).frame
    budgets = [budget_of(sensor, coordinate, WHITE) for coordinate in "XYZ"]
    budgets += [contravariant_budget(WHITE, sensor, EXPOSURE, frame, c) for c in sensor.names]
    for budget in budgets:
        assert budget.optimal_linear_snr_db == pytest.approx(bound, abs=1e-9)


def test_read_noise_costs_half_the_decibels_of_its_share_where_it_dominates():
    """One channel of M electrons: shot only 10 log M, with readout 20 log M - 10 log(M + s^2)."""
    sensor = sensor_of(box(500, 600))
    dark = Exposure(time_s=1e-5)
    budget = budget_of(sensor, exposure=dark)
    electrons = 10 ** (budget.optimal_linear_snr_db / 10)  # M^2 / (M + 100)
    mean = (electrons + np.sqrt(electrons**2 + 400 * electrons)) / 2
    assert cost(budget, "read noise") == pytest.approx(10 * np.log10(1 + 100 / mean), abs=1e-9)


def test_a_sensor_blind_beyond_700_nm_pays_nothing_for_infrared():
    budget = budget_of(sensor_of(box(400, 560), box(500, 640), box(560, 700)))
    assert cost(budget, "infrared") == pytest.approx(0.0, abs=1e-9)
    assert cost(budget, "rest") == pytest.approx(0.0, abs=1e-9)


def test_one_channel_pays_for_its_filter_and_its_readout_only():
    budget = budget_of(sensor_of(box(500, 600)))
    assert cost(budget, "weights") == pytest.approx(0.0, abs=1e-9)
    assert cost(budget, "correlation") == pytest.approx(0.0, abs=1e-9)


def test_the_paper_finds_correlation_the_most_critical_when_the_ir_cut_goes():
    """The paper's conclusion: the effect of the correlation seems to be the most critical."""
    study = paper_study()
    bare, cut = (
        color_budget(a.scene, a.sensor, a.exposure, a.matrix)
        for a in (study.columns[RGBW_12], study.columns[RGB_12])
    )
    growth = {cause: cost(bare, cause) - cost(cut, cause) for cause in CAUSES if cause != "filters"}
    assert max(growth, key=growth.get) == "correlation"
    assert growth["infrared"] > 1


games = st.lists(st.floats(-50, 50), min_size=16, max_size=16)
PLAYERS = "abcd"
SETS = [frozenset(g) for size in range(5) for g in combinations(PLAYERS, size)]


@given(games)
def test_shares_are_those_of_the_sum_over_subsets(worths):
    """Shapley's own formula: sum over S of |S|! (n - |S| - 1)! / n! (v(S + i) - v(S))."""
    value = dict(zip(SETS, worths, strict=True))
    shares = shapley_values(value.__getitem__, PLAYERS)
    for player in PLAYERS:
        others = [s for s in SETS if player not in s]
        expected = sum(
            factorial(len(s)) * factorial(3 - len(s)) / factorial(4)
            * (value[s | {player}] - value[s])
            for s in others
        )  # fmt: skip
        assert shares[player] == pytest.approx(expected, abs=1e-9)


@given(games)
def test_a_full_precedence_is_a_plain_chain(worths):
    value = dict(zip(SETS, worths, strict=True))
    chain = [("a", "b"), ("b", "c"), ("c", "d")]
    shares = shapley_values(value.__getitem__, PLAYERS, chain)
    steps = [frozenset(PLAYERS[:i]) for i in range(5)]
    for i, player in enumerate(PLAYERS):
        assert shares[player] == pytest.approx(value[steps[i + 1]] - value[steps[i]], abs=1e-9)


def test_a_game_without_players_has_no_shares():
    assert shapley_values(lambda _: 0.0, ()) == {}


def test_a_circle_of_precedence_is_refused():
    with refused_input(subject="precedence", value=(("a", "b"), ("b", "a"))):
        shapley_values(lambda _: 0.0, "ab", [("a", "b"), ("b", "a")])


def test_contravariant_budgets_add_up_to_the_contravariant_snr():
    """For two channels at 60 degrees unmixing takes 6.9897 dB: (1 - cos t) / sqrt(1 + cos^2 t)."""
    first, second = box(400, 600), box(500, 700)  # equal norms, half of each shared
    equal = 1.0 / AT  # the same photons at each wavelength, so that both see the same signal
    scene = Scene(illuminant=LAMP, level_lux=10.0, reflectance=equal / equal.max())
    sensor = sensor_of(first, second, read_noise_e=0.0)
    frame = kernel_matrix(sensor, EXPOSURE).frame
    for name in sensor.names:
        budget = contravariant_budget(scene, sensor, EXPOSURE, frame, name)
        assert cost(budget, "correlation") == pytest.approx(6.9897, abs=1e-4)
        assert cost(budget, "weights") == pytest.approx(10 * np.log10(2), abs=1e-9)
        lost = sum(c.cost_db for c in budget.costs)
        assert budget.photons_db - lost == pytest.approx(budget.snr_db, abs=1e-9)
        assert cost(budget, "rest") == 0


def test_a_copy_of_a_channel_has_no_contravariant_budget():
    sensor = sensor_of(box(400, 500), box(500, 600), box(500, 600))
    frame = kernel_matrix(sensor, EXPOSURE).frame
    values = [contravariant_budget(WHITE, sensor, EXPOSURE, frame, n) for n in sensor.names]
    assert values[0] is not None
    assert values[1:] == [None, None]


def leaking(leak):
    """A sensor whose red and blue let infrared through."""
    infrared = leak * box(700, 1050)
    return sensor_of(
        0.6 * box(560, 640) + infrared, 0.6 * box(480, 600), 0.5 * box(470, 520) + infrared
    )


def test_a_matrix_that_reverses_a_coordinate_leaves_it_without_a_budget():
    sensor = sensor_of(*(0.5 * box(*one) for one in BANDS))
    matrix = kernel_matrix(sensor, EXPOSURE)
    swapped = replace(matrix, matrix=matrix.matrix[[1, 0, 2]])  # a* ~ X - Y
    given = (GRAY, sensor, EXPOSURE, swapped)
    found = {name: lab_budget(*given, name) for name in COORDINATES}
    assert [name for name, one in found.items() if one is None] == ["a*"]
    request = BudgetRequest(
        scene=GRAY, sensor=sensor, exposure=EXPOSURE, matrix=swapped, coordinates=COORDINATES
    )
    (together,) = budgets_of([request])
    assert list(together) == ["L*", "b*"]
    for name, one in together.items():
        assert np.abs(fields_of(one) - fields_of(found[name])).max() < 1e-12
        assert [cost.reading for cost in one.costs] == [cost.reading for cost in found[name].costs]


@pytest.mark.parametrize("mean_e", [3.0, 45.0, 120.0])
def test_coarse_rounding_multiplies_a_change_by_the_slope_of_the_rounded_mean(mean_e):
    """The slope by differences of fourth order, from two steps (Richardson 1911)."""
    noise = noise_sources(with_pixel(sensor_of(*APART), {"bits": 8, "full_well_e": 2e4}))
    seen = Seen(signal_e=np.ones((1, 1)), noise_e=np.full((1, 1), mean_e), is_change=True)

    def slope(step_e):
        ends = np.array([mean_e - step_e, mean_e + step_e])
        return float(np.diff(ends + noise.rounded(ends)[0])[0] / (2 * step_e))

    wanted = (4 * slope(0.05) - slope(0.1)) / 3
    assert rounded_share(seen, noise)[0, 0] == pytest.approx(wanted, rel=1e-5)


def test_a_coordinate_that_is_infrared_alone_has_no_budget_and_a_sentence_says_why():
    lamp = cie_illuminant("A", DEFAULT_GRID)
    for leak, missing in ((0.1, ()), (0.4, ("Z",))):
        at = analyzed(flat_field(lamp, level_lux=10.0), leaking(leak), EXPOSURE)
        budgets = color_budgets(at)
        assert tuple(n for n, one in zip("XYZ", budgets, strict=True) if one is None) == missing
        assert color_snr_db(at)["Z"] is not None
        said = missing_color_budgets(at, budgets)
        assert (said is None) == (not missing)
        assert said is None or "no budget of Z," in said


# of many sensors at once


def fields_of(budget):
    costs = [
        (one.cost_db, -1e3 if one.gain_if_removed_db is None else one.gain_if_removed_db)
        for one in budget.costs
    ]
    ends = (budget.photons_db, budget.optimal_linear_snr_db, budget.snr_db)
    return np.array([*ends, *np.ravel(costs)])


@dataclass(frozen=True, kw_only=True)
class Flickering(Pixel):
    """A pixel of a class of one's own, whose noise is no part of its comparison."""

    flicker_e: float = field(default=0.0, compare=False)
    own_noise = (
        NoiseSource(
            cause="flicker noise", drawn="reading", term="floor_e2",
            value=lambda of: of.pixel.flicker_e**2,
        ),
    )  # fmt: skip


def test_budgets_of_many_sensors_at_once_are_those_of_each_alone(monkeypatch):
    """Of one pixel and of several, coarse and fine steps, crosstalk of both stages, dead channels.

    Most sensors have equal noise, and are evaluated in several parts.
    """
    monkeypatch.setattr(budget_module, "_VALUES_PER_CHUNK", 1_000)
    rng = np.random.default_rng(3)
    sensors = [
        sensor_of(*(0.1 + 0.8 * rng.random((3, 1)) * np.array([box(*one) for one in BANDS])))
        for _ in range(28)
    ]
    sensors[7] = sensor_of(box(400, 500), box(500, 600), box(500, 600))  # no M^c1
    sensors[20] = with_pixel(sensors[20], {"read_noise_e": 2.0})
    coarse = {"bits": 8, "full_well_e": 2e4}  # coarse for some of the sensors
    hidden = coarse | {"read_noise_e": 60.0}  # coarse without read noise only
    sensors += [
        *(with_pixel(one, coarse) for one in sensors[8:12]),
        *(with_pixel(one, hidden) for one in sensors[12:16]),
        *(
            replace(sensors[17], pixel=Flickering(**PLAIN, flicker_e=flicker_e))
            for flicker_e in (6.0, 20.0)
        ),
        *(crossed(sensors[18], share, "charge", "c0 c1/c1 c2") for share in (0.1, 0.2)),
        noisy("onyx-rgbw"),
        sensor_of(*(0.5 * box(*one) for one in (*BANDS, (400, 700)))),
        *(crossed(noisy(name), 0.1, stage) for name in MOSAICS for stage in ("light", "charge")),
    ]
    lamp = cie_illuminant("A", DEFAULT_GRID)
    bright = flat_field(lamp, level_lux=10.0, reflectance=0.18)
    lit = [*((GRAY, one) for one in sensors), *((bright, leaking(one)) for one in (0.1, 0.4))]
    requests = [
        BudgetRequest(
            scene=scene,
            sensor=one,
            exposure=EXPOSURE,
            matrix=kernel_matrix(one, EXPOSURE),
            coordinates=(*EVERY, *(f"M^{name}" for name in one.names)),
        )
        for scene, one in lit
    ]
    together = budgets_of(requests)
    for request, found in zip(requests, together, strict=True):
        (alone,) = budgets_of([request])
        assert found.keys() == alone.keys()
        for name, budget in found.items():
            assert np.abs(fields_of(budget) - fields_of(alone[name])).max() < 1e-13
            assert [one.reading for one in budget.costs] == [
                one.reading for one in alone[name].costs
            ]
    assert [name for name in requests[7].coordinates if name not in together[7]] == [
        *("M^c1", "M^c2")
    ]


def test_a_sensor_without_any_snr_for_a_coordinate_has_no_gain_and_no_warning():
    """An IR-cut leaves nothing of a channel that sees only infrared; coarse steps leave no SNR."""
    infrared = sensor_of(box(400, 650), box(750, 1050))
    coarse = with_pixel(
        sensor_named("model-rgb"), {"bits": 8, "full_well_e": 2e4, "read_noise_e": 17.6}
    )
    for sensor, lux in ((infrared, 10.0), (coarse, 0.051)):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            found = every_budget(sensor, lux)
        for budget in found.values():
            for one in budget.costs:
                assert one.gain_if_removed_db is None or np.isfinite(one.gain_if_removed_db)


def test_a_scene_of_several_points_is_refused():
    sensor = sensor_of(*APART)
    scene = Scene(illuminant=LAMP, level_lux=10.0, reflectance=np.ones((2, AT.size)))
    with refused_input(subject="scene of a budget", value=(2,)):
        color_budget(scene, sensor, EXPOSURE, kernel_matrix(sensor, EXPOSURE))


@pytest.mark.parametrize(
    ("coordinates", "value"), [(("Y", "y"), "y"), (("M^none",), "M^none"), (("L",), "L")]
)
def test_a_request_of_an_unknown_coordinate_is_refused(coordinates, value):
    sensor = sensor_of(*APART)
    with refused_input(subject="coordinate", value=value):
        BudgetRequest(
            scene=GRAY,
            sensor=sensor,
            exposure=EXPOSURE,
            matrix=kernel_matrix(sensor, EXPOSURE),
            coordinates=coordinates,
        )


# gains of causes that are removed


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


def every_budget(sensor, level_lux=10.0):
    at = analyzed(flat_field(LAMP, level_lux=level_lux), sensor, EXPOSURE)
    found = (*color_budgets(at), *contravariant_budgets(at), *lab_budgets(at))
    return {one.coordinate: one for one in found if one}


# noise


@pytest.mark.parametrize(
    ("stage", "level_lux"), [("charge", 0.05), *dear((None, 0.05), ("light", 10.0))]
)
def test_the_gain_of_a_source_is_the_snr_of_a_sensor_built_without_it(stage, level_lux):
    def budgets_without(*causes):
        sensor = noisy("model-rgb", *causes)
        return every_budget(crossed(sensor, 0.1, stage) if stage else sensor, level_lux)

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
    before, after = (every_budget(one, 0.05) for one in (now, less))
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
    budget = every_budget(sensor, 10.0 * 100.0 / whole)["M^" + sensor.names[0]]
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
    with_it, without = every_budget(crossed(plain, share, stage), lux), every_budget(plain, lux)
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
    with_it, without = every_budget(crossed(plain, share, stage)), every_budget(plain)
    for coordinate, budget in with_it.items():
        costs = {one.cause: one.cost_db for one in budget.costs if one.cause != "crosstalk"}
        known = {one.cause: one.cost_db for one in without[coordinate].costs}
        assert costs == pytest.approx(known, abs=1e-7)


@settings(max_examples=3, deadline=None)
@given(st.floats(0.01, 0.3), st.sampled_from(STAGES), st.floats(0.0, 0.03))
def test_crosstalk_and_its_pattern_together_cost_what_both_would_gain(share, stage, prnu):
    plain = with_pixel(sensor_named("onyx-rgbw", DEFAULT_GRID), {"prnu": prnu})
    with_it, without = every_budget(crossed(plain, share, stage, "rgbw-4x4")), every_budget(plain)
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
    found = every_budget(crossed(sensor_named("model-rgb", DEFAULT_GRID), 0.1, stage))
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
    for coordinate, budget in every_budget(sensor_named("onyx-rgbw", DEFAULT_GRID)).items():
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
    for budget in every_budget(sensor_named("onyx-rgbw", DEFAULT_GRID)).values():
        rest = of_cause(budget, "rest")
        assert rest.gain_if_removed_db == rest.cost_db
        assert of_cause(budget, "filters").gain_if_removed_db is None


def test_a_cause_without_effect_neither_costs_nor_gains():
    silent = with_pixel(sensor_named("onyx-rgb-ircut", DEFAULT_GRID), {"read_noise_e": 0.0})
    none = crossed(silent, 0.0, "charge")
    for budget in every_budget(none).values():
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
    budget = every_budget(sensor_named("onyx-rgbw", DEFAULT_GRID))["Y"]
    shown = budget._repr_html_()
    row = of_cause(budget, "read noise")
    assert "gain if removed [dB]" in shown
    assert f"{row.gain_if_removed_db:+.2f}" in shown
    assert f"{-row.cost_db:+.2f}" in shown
