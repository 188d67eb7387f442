"""Filters that can be made: within 0 to 1, analytic, and as optics has known them."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

from chromanoise.sensor import ir_cut, resin_filter, silicon_qe
from chromanoise.sensor.filter_models import (
    FILTER_MODELS,
    SILICON_NUMBERS,
    alternating_stack,
    cauchy_index,
    router_collection,
    router_shares,
    thin_film_stack,
)
from chromanoise.sensor.filters import (
    beer_lambert,
    dual_band_filter,
    dye_of_bands,
    fabry_perot_filter,
    gaussian_filter,
    layered_silicon_qe,
    long_pass,
    raised_cosine_filter,
)
from chromanoise.sensor.sensor import dye_transmittances
from chromanoise.spectra import Grid
from chromanoise.study import sensor_named
from outcomes import refused_input

GRID = Grid.uniform(400, 1050, 10)
FINE = Grid.uniform(400, 700, 0.01)
NM = GRID.wavelength_nm
RANGES = {"nm": (1.0, 1200.0), "um": (0.01, 20.0), "um^2": (0.0, 0.02), "1": (0.0, 4.0)}


@st.composite
def filters(draw):
    """A model with numbers anywhere within what is possible, and the name of one of them."""
    name = draw(st.sampled_from(sorted(FILTER_MODELS)))
    model = FILTER_MODELS[name]
    films = range(1, draw(st.integers(1, 5)) + 1)
    first = model.numbers_for(())
    known = model.numbers_for(key.replace("_1", f"_{i}") for key in first for i in films)
    numbers = {
        key: draw(st.floats(max(one.least, low), min(one.most, high)))
        for key, one in known.items()
        for low, high in [RANGES[one.unit]]
    }
    return name, numbers, draw(st.sampled_from(sorted(numbers)))


@given(filters())
def test_a_filter_transmits_between_nothing_and_all(case):
    name, numbers, _ = case
    transmittance = FILTER_MODELS[name].of(GRID, numbers)
    assert transmittance.shape == (GRID.n,)
    assert ((transmittance >= 0) & (transmittance <= 1 + 1e-15)).all()


@given(filters(), st.floats(0.5, 1.0))
def test_filters_of_many_candidates_are_those_of_each(case, factor):
    name, numbers, key = case
    other = numbers | {key: numbers[key] * factor}
    number = FILTER_MODELS[name].numbers_for(numbers)[key]
    assume(other[key] >= number.least)
    both = {one: np.array([numbers[one], other[one]]) for one in numbers}
    each = [FILTER_MODELS[name].of(GRID, one) for one in (numbers, other)]
    np.testing.assert_allclose(FILTER_MODELS[name].of(GRID, both), each, rtol=1e-12, atol=1e-300)


TYPICAL = {
    "gaussian": {
        "center_nm": 540.0, "width_nm": 60.0, "peak": 0.9, "floor": 0.02, "infrared_leak": 0.8,
        "leak_nm": 800.0,
    },
    "raised-cosine": {
        "center_nm": 545.0, "fwhm_nm": 117.0, "peak": 0.9, "floor": 0.02, "infrared_leak": 0.8,
        "leak_nm": 800.0,
    },
    "resin": {
        "low_nm": 490.0, "band_width_nm": 100.0, "gap_nm": 200.0, "edge_nm": 12.0, "peak": 0.9,
        "leak": 0.95, "floor": 0.02,
    },
    "dye-bands": {
        "thickness": 1.2, "band_1_nm": 440.0, "width_1_nm": 40.0, "density_1": 1.5,
        "band_2_nm": 640.0, "width_2_nm": 50.0, "density_2": 2.0,
    },
    "fabry-perot": {"center_nm": 560.0, "reflectance": 0.6, "order": 2.0, "peak": 0.95},
    "thin-film": {
        "index_high": 2.3, "dispersion_high_um2": 0.02, "index_low": 1.46,
        "dispersion_low_um2": 0.003, "index_in": 1.1, "index_out": 1.52, "thickness_1_nm": 60.0,
        "thickness_2_nm": 95.0, "thickness_3_nm": 110.0, "thickness_4_nm": 90.0,
    },
    "ir-cut": {"cutoff_nm": 655.0, "width_nm": 8.0},
    "long-pass": {"cuton_nm": 720.0, "width_nm": 8.0},
    "dual-band": {
        "cutoff_nm": 655.0, "band_nm": 850.0, "band_width_nm": 60.0, "width_nm": 8.0,
        "band_peak": 0.9,
    },
}  # fmt: skip


def slopes(function, numbers, key):
    """Derivative by the complex step, and by central differences with Richardson's step."""
    step = 1e-3 * max(abs(numbers[key]), 1e-2)

    def central(h):
        up, down = (function(numbers | {key: numbers[key] + s * h}) for s in (1, -1))
        return (up - down) / (2 * h)

    complex_ = function(numbers | {key: numbers[key] + 1e-30j}).imag / 1e-30
    return complex_, (4 * central(step / 2) - central(step)) / 3


@pytest.mark.parametrize(
    ("name", "key"), [(name, key) for name, numbers in TYPICAL.items() for key in numbers]
)
def test_the_complex_step_gives_the_slope_of_every_number_of_every_filter(name, key):
    exact, difference = slopes(lambda n: FILTER_MODELS[name].of(GRID, n), TYPICAL[name], key)
    np.testing.assert_allclose(exact, difference, rtol=0, atol=1e-6 * np.abs(exact).max())
    assert np.abs(exact).max() > 0


def test_the_typical_filters_are_all_models():
    assert set(TYPICAL) == set(FILTER_MODELS)


@pytest.mark.parametrize("key", sorted(SILICON_NUMBERS))
def test_the_complex_step_gives_the_slope_of_silicon(key):
    numbers = {"depth_um": 4.0, "dead_layer_um": 0.05, "reflectance": 0.1}
    exact, difference = slopes(lambda n: silicon_qe(GRID, **n), numbers, key)
    np.testing.assert_allclose(exact, difference, rtol=0, atol=1e-6 * np.abs(exact).max())


def test_the_slope_of_a_gaussian_is_that_of_calculus():
    exact = gaussian_filter(GRID, center_nm=540 + 1e-30j, width_nm=60.0, peak=0.9).imag / 1e-30
    at_600 = int(np.searchsorted(NM, 600))
    assert exact[at_600] == pytest.approx(0.9 * math.exp(-0.5) / 60.0, rel=1e-12)


def test_the_slope_of_silicon_at_its_depth_is_that_of_beer_and_lambert():
    # 850 nm: 535/cm, so that d/dz (1 - exp(-a z)) = a exp(-a z), per um
    exact = silicon_qe(GRID, depth_um=4 + 1e-30j, dead_layer_um=0.0, reflectance=0.0).imag / 1e-30
    at_850 = int(np.searchsorted(NM, 850))
    assert exact[at_850] == pytest.approx(0.0535 * math.exp(-0.214), rel=1e-9)


def width_at_half(curve):
    above = FINE.wavelength_nm[curve >= curve.max() / 2]
    return above[-1] - above[0]


@given(st.floats(10.0, 60.0))
def test_the_full_width_of_a_gaussian_is_2_3548_standard_deviations(width_nm):
    curve = gaussian_filter(FINE, center_nm=550.0, width_nm=width_nm)
    assert width_at_half(curve) == pytest.approx(2.354820045 * width_nm, abs=0.03)


@given(st.floats(10.0, 140.0))
def test_the_full_width_of_a_raised_cosine_is_half_of_its_base(fwhm_nm):
    curve = raised_cosine_filter(FINE, center_nm=550.0, fwhm_nm=fwhm_nm)
    passes = FINE.wavelength_nm[curve > 0]
    assert width_at_half(curve) == pytest.approx(fwhm_nm, abs=0.03)
    assert passes[-1] - passes[0] == pytest.approx(2 * fwhm_nm, abs=0.05)


def test_the_leak_of_a_dye_opens_the_infrared_only():
    shut, open_ = (
        gaussian_filter(GRID, center_nm=540.0, width_nm=30.0, infrared_leak=leak)
        for leak in (0.0, 0.95)
    )
    np.testing.assert_allclose(open_[NM < 500], shut[NM < 500], atol=1e-5)
    assert shut[-1] < 1e-12
    assert open_[-1] == pytest.approx(0.95, abs=1e-4)
    wide = gaussian_filter(GRID, center_nm=1050.0, width_nm=1e6, peak=0.9, infrared_leak=0.8)
    assert wide[-1] == pytest.approx(1 - 0.1 * 0.2, abs=1e-4)  # what the band stops, leaks


@given(st.floats(0.2, 0.95), st.integers(3, 8))
def test_a_cavity_has_airys_finesse_and_free_spectral_range(reflectance, order):
    # in wavenumbers: peaks 1/(2L) apart, each 1/(2L)/finesse wide
    length_nm = 2000.0
    grid = Grid.uniform(400, 1400, 0.02)
    curve = fabry_perot_filter(
        grid, center_nm=2 * length_nm / order, reflectance=reflectance, order=float(order)
    )
    wavenumber = 1 / grid.wavelength_nm
    middle = (curve[1:-1] > curve[:-2]) & (curve[1:-1] >= curve[2:])
    peaks = wavenumber[1:-1][middle]
    np.testing.assert_allclose(-np.diff(peaks), 1 / (2 * length_nm), rtol=3e-3)
    assert curve.min() == pytest.approx(((1 - reflectance) / (1 + reflectance)) ** 2, rel=1e-4)
    if reflectance > 0.5:
        finesse = math.pi * math.sqrt(reflectance) / (1 - reflectance)
        one = np.abs(wavenumber - peaks[len(peaks) // 2]) < 1 / (4 * length_nm)
        half = wavenumber[one & (curve >= 0.5)]
        exact = 2 / math.pi * math.asin(math.pi / 2 / finesse) / (2 * length_nm)
        assert half[0] - half[-1] == pytest.approx(exact, rel=0.02)


@given(st.lists(st.floats(0.0, 1.0), min_size=2, max_size=6), st.floats(0.0, 3.0))
def test_thickness_multiplies_the_density_of_a_dye(transmittance, thickness):
    measured = np.array(transmittance)
    with np.errstate(divide="ignore"):
        density = -np.log10(measured)
    got = beer_lambert(measured, thickness)
    want = np.where(measured > 0, 10.0 ** -(thickness * np.where(measured > 0, density, 0)), 0)
    np.testing.assert_allclose(got, want, rtol=1e-12)


def test_a_dye_of_twice_the_thickness_is_two_dyes_behind_each_other():
    one, two = (
        dye_of_bands(GRID, band_nm=[450, 640], width_nm=[40, 50], density=[1, 2], thickness=t)
        for t in (1.0, 2.0)
    )
    np.testing.assert_allclose(two, one * one, rtol=1e-13)
    np.testing.assert_allclose(two, beer_lambert(one, 2.0), rtol=1e-12)
    assert one[int(np.searchsorted(NM, 640))] == pytest.approx(0.01, rel=1e-4)
    assert one[-1] == pytest.approx(1.0, abs=1e-12)  # transparent in the infrared


def test_a_dual_band_filter_is_an_ir_cut_and_a_window():
    dual = dual_band_filter(GRID, cutoff_nm=650.0, band_nm=850.0, band_width_nm=60.0, width_nm=4.0)
    np.testing.assert_allclose(dual[NM < 700], ir_cut(GRID, edge_nm=650.0, width_nm=4.0)[NM < 700])
    assert dual[int(np.searchsorted(NM, 850))] == pytest.approx(1.0, abs=2e-3)
    assert dual[[int(np.searchsorted(NM, at)) for at in (820, 880)]] == pytest.approx(0.5, abs=1e-3)
    assert dual[-1] < 1e-9


def test_a_long_pass_and_an_ir_cut_at_one_edge_share_the_light():
    both = long_pass(GRID, cuton_nm=700.0, width_nm=20.0) + ir_cut(
        GRID, edge_nm=700.0, width_nm=20.0
    )
    np.testing.assert_allclose(both, 1.0, rtol=1e-14)


def test_a_resin_of_many_candidates_refuses_the_first_whose_edges_are_not_in_order():
    with refused_input(value=(600.0, 590.0, 790.0)):
        resin_filter(GRID, low_nm=np.array([490.0, 600.0]), high_nm=590.0, leak_nm=790.0)


@pytest.mark.parametrize("pairs", [1, 3, 6])
def test_a_quarter_wave_mirror_has_the_reflectance_of_the_textbook(pairs):
    # Born & Wolf 1.6.5: R of N pairs, high first: (n0 - ns (nh/nl)^2N)^2 / (n0 + ns (nh/nl)^2N)^2
    high, low, substrate = 2.3, 1.38, 1.52
    quarter = [550 / 4 / n for n in (high, low)] * pairs
    mirror = alternating_stack(
        Grid.uniform(500, 600, 50), thickness_nm=quarter, index_high=high, index_low=low
    )
    ratio = substrate * (high / low) ** (2 * pairs)
    assert 1 - mirror[1] == pytest.approx(((1 - ratio) / (1 + ratio)) ** 2, rel=1e-12)


@given(st.lists(st.floats(0.0, 400.0), min_size=1, max_size=8), st.floats(1.0, 3.0))
def test_a_stack_transmits_as_much_from_the_other_side(thickness, index_out):
    index = [cauchy_index(GRID, 1.4 + 0.2 * (i % 4), 0.01) for i in range(len(thickness))]
    front = thin_film_stack(GRID, thickness_nm=thickness, index=index, index_out=index_out)
    back = thin_film_stack(
        GRID, thickness_nm=thickness[::-1], index=index[::-1], index_in=index_out, index_out=1.0
    )
    np.testing.assert_allclose(front, back, rtol=1e-9)


@given(
    st.lists(st.floats(0.0, 1.0), min_size=2, max_size=6),
    st.floats(0.0, 1.0),
    st.floats(1.0, 80.0),
)
def test_a_router_gives_all_light_that_it_collects_and_no_more(selectivity, efficiency, edge_nm):
    crossing = np.linspace(450, 900, len(selectivity) - 1)
    shares = router_shares(
        GRID,
        collection=router_collection(selectivity, efficiency),
        crossing_nm=crossing.tolist(),
        edge_nm=edge_nm,
    )
    assert (shares >= 0).all()
    np.testing.assert_allclose(shares.sum(axis=1), efficiency, rtol=1e-12, atol=1e-300)


def test_a_router_that_gives_more_than_it_has_is_refused():
    with refused_input(subject="collection", value=1.2):
        router_shares(GRID, collection=np.array([[0.6, 0.3], [0.6, 0.3]]), crossing_nm=[550.0])


def test_layers_of_many_candidates_are_those_of_each():
    first, second = np.array([0.4, 0.5]), np.array([1.2, 1.9])
    both = layered_silicon_qe(GRID, (first, second))
    each = [layered_silicon_qe(GRID, ends) for ends in zip(first, second, strict=True)]
    np.testing.assert_allclose(both, each, rtol=1e-14)
    with refused_input(subject="ends_um"):
        layered_silicon_qe(GRID, (1.2, 0.4))


def test_the_dyes_of_a_model_are_its_resins_and_a_ratio_above_1_is_scaled_with_a_note():
    sensor = sensor_named("model-rgbw", GRID)
    dyes = dye_transmittances(sensor)
    green = resin_filter(GRID, low_nm=490, high_nm=590, leak_nm=790)
    np.testing.assert_allclose(dyes.values[:, 1], green, rtol=1e-12)
    assert dyes.notes == sensor.notes
    sheet = sensor_named("mt9v024-rgbw", GRID)  # its G exceeds its W
    real = dye_transmittances(sheet)
    assert real.values.max() == 1.0
    assert "no filter transmits more than all light" in real.notes[-1]
    ratio = sheet.qe[:, :2] / sheet.qe[:, 3:]
    np.testing.assert_allclose(real.values[:, 1] / real.values[:, 0], ratio[:, 1] / ratio[:, 0])
    with refused_input(subject="dyes of model-mono"):
        dye_transmittances(sensor_named("model-mono", GRID))
