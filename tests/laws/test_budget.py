"""The budget of a color coordinate adds up, and charges nothing to a cause that changes nothing."""

from itertools import combinations
from math import factorial

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.apps.paper import paper_study
from chromanoise.apps.paper.printed_numbers import RGB_12, RGBW_12
from chromanoise.color import kernel_matrix
from chromanoise.metrics import optimal_linear_snr_db
from chromanoise.metrics.budget import CAUSES, color_budget, contravariant_budget, shapley_values
from chromanoise.noise import Exposure, expected_electrons, with_noise
from chromanoise.sensor import Pixel, Sensor, with_channels
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import sensor_named
from outcomes import refused_input

AT = DEFAULT_GRID.wavelength_nm
WHITE = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
PIXEL = Pixel(pitch_um=10.0, full_well_e=1e6, read_noise_e=10.0)
EXPOSURE = Exposure(time_s=0.012)


def sensor_of(*curves, pixel=PIXEL):
    names = tuple(f"c{i}" for i in range(len(curves)))
    return Sensor(name="toy", grid=DEFAULT_GRID, qe=np.stack(curves, 1), names=names, pixel=pixel)


def box(first_nm, last_nm, height=0.6):
    return np.where((first_nm <= AT) & (last_nm > AT), height, 0.0)


def budget_of(sensor, coordinate="Y", exposure=EXPOSURE, scene=WHITE):
    return color_budget(scene, sensor, exposure, kernel_matrix(sensor, exposure), coordinate)


def cost(budget, cause):
    return next(c.cost_db for c in budget.costs if c.cause == cause)


@given(
    st.floats(470, 520), st.floats(560, 620), st.floats(0.0, 0.3), st.floats(0, 30),
    st.sampled_from("XYZ"),
)  # fmt: skip
def test_the_costs_add_up_to_the_whole_loss(low, high, leak, read_noise_e, coordinate):
    pixel = Pixel(pitch_um=10.0, full_well_e=1e6, read_noise_e=read_noise_e)
    curves = (box(400, low), box(low, high), box(high, 1050), np.full(AT.size, 0.5))
    sensor = sensor_of(*(np.clip(c + leak, 0, 1) for c in curves), pixel=pixel)
    budget = budget_of(sensor, coordinate)
    if budget is None:
        return
    lost = budget.photons_db - budget.snr_db
    assert sum(c.cost_db for c in budget.costs) == pytest.approx(lost, abs=1e-9)
    assert [c.cause for c in budget.costs] == [*CAUSES, "rest"]


def test_it_begins_with_the_photons_on_all_pixels():
    # 131 plain samples: 10 lx * .012 s * 100 um2 / (4 * 1.8^2) * 1.37017e-5 * sum(lambda) / (h c)
    per_pixel = 10 * 0.012 * 100 / (4 * 1.8**2) * 1.37017e-5 * 5 * AT.sum() * 1e-9 * 1e-12
    photons = 3 * per_pixel / 1.98644586e-25
    budget = budget_of(sensor_of(box(400, 500), box(500, 600), box(600, 700)))
    assert budget.photons_db == pytest.approx(10 * np.log10(photons), abs=1e-4)


def test_stacked_channels_are_given_the_photons_of_one_pixel():
    # as above, behind a lamp of 131 equal powers, and once for the three layers together
    layers = sensor_named("model-three-layer", DEFAULT_GRID)
    photons = 10 * 0.012 * 100 / (4 * 1.8**2) * 1.37017e-5 * 5 * AT.sum() * 1e-21 / 1.98644586e-25
    assert budget_of(layers).photons_db == pytest.approx(10 * np.log10(photons), abs=1e-4)


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
    budgets = [budget_of(sensor, coordinate) for coordinate in "XYZ"]
    budgets += [contravariant_budget(WHITE, sensor, EXPOSURE, frame, c) for c in sensor.names]
    for budget in budgets:
        assert budget.optimal_linear_snr_db == pytest.approx(bound, abs=1e-9)


def test_channels_that_do_not_overlap_pay_nothing_for_correlation():
    budget = budget_of(sensor_of(box(400, 500), box(500, 600), box(600, 1050)))
    assert cost(budget, "correlation") == pytest.approx(0.0, abs=1e-9)
    overlapping = budget_of(sensor_of(box(400, 560), box(500, 640), box(560, 1050)))
    assert cost(overlapping, "correlation") > 0.5


def test_a_pixel_without_read_noise_pays_nothing_for_it():
    silent = Pixel(pitch_um=10.0, full_well_e=1e6, read_noise_e=0.0)
    curves = (box(400, 560), box(500, 640), box(560, 1050))
    assert cost(budget_of(sensor_of(*curves, pixel=silent)), "read noise") == 0
    assert cost(budget_of(sensor_of(*curves)), "read noise") > 0


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


@given(st.permutations("RGBW"))
def test_permuting_channels_changes_no_cost(order):
    sensor = sensor_named("onyx-rgbw", DEFAULT_GRID)
    mixed = with_channels(sensor, order, name="mixed")
    ours, theirs = budget_of(sensor), budget_of(mixed)
    for a, b in zip(ours.costs, theirs.costs, strict=True):
        assert a.cost_db == pytest.approx(b.cost_db, abs=1e-9)


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


def test_a_color_without_snr_has_no_budget():
    assert budget_of(sensor_of(box(850, 1050))) is None


def test_an_unknown_coordinate_is_refused():
    with refused_input(subject="coordinate", value="L"):
        budget_of(sensor_of(box(500, 600)), "L")


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


def test_a_circle_of_precedence_is_refused():
    with refused_input(subject="precedence", value=(("a", "b"), ("b", "a"))):
        shapley_values(lambda _: 0.0, "ab", [("a", "b"), ("b", "a")])


def test_contravariant_budgets_add_up_to_the_contravariant_snr():
    """For two channels at 60 degrees unmixing takes 6.9897 dB: (1 - cos t) / sqrt(1 + cos^2 t)."""
    first, second = box(400, 600), box(500, 700)  # equal norms, half of each shared
    lamp = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
    equal = 1.0 / AT  # the same photons at each wavelength, so that both see the same signal
    scene = type(lamp)(illuminant=lamp.illuminant, level_lux=10.0, reflectance=equal / equal.max())
    silent = Pixel(pitch_um=10.0, full_well_e=1e6, read_noise_e=0.0)
    sensor = sensor_of(first, second, pixel=silent)
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
