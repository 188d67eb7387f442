"""Sensors compared over the light level: the crossover is where a closed form puts it."""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.base import plain
from chromanoise.color import kernel_matrix
from chromanoise.noise import Exposure, expected_electrons, white_scene
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import (
    QUANTITIES,
    SWEEPS,
    MatrixMaker,
    band_sentence,
    color_matrices,
    compared,
    crossover_bands,
    crossover_sentence,
    crossovers,
    crossovers_or_reasons,
    matrix_makers,
    sensor_named,
    swept_values,
)
from chromanoise.study.sweeps import SNR_Y
from outcomes import refused_input
from strategies import pixel_with, point_of, white_channel

LAMP = equal_energy(DEFAULT_GRID)
EXPOSURE = Exposure(time_s=0.01)
LEVELS = np.geomspace(1e-3, 1e2, 26)
NM = DEFAULT_GRID.wavelength_nm


def kernel(operating_point):
    return kernel_matrix(operating_point.sensor, operating_point.exposure, "quanta")


def used(sensor, exposure=EXPOSURE, level_lux=1.0):
    return point_of(sensor, level_lux, exposure=exposure)


def used_of(*names, time_s, level_lux=1.0):
    sensors = [sensor_named(name, DEFAULT_GRID) for name in names]
    return [used(one, Exposure(time_s=time_s), level_lux) for one in sensors]


def one_channel(name, qe, read_noise_e, full_well_e=1e9):
    pixel = pixel_with(read_noise_e, full_well_e)
    return used(white_channel(qe, grid=DEFAULT_GRID, pixel=pixel, name=name))


def compare(*contestants, levels=LEVELS, **asked):
    makers = {"kernel": kernel}
    curves = compared(contestants, makers, levels, **asked)
    return curves, crossovers(contestants, makers, curves)


def electrons_per_lux(contestant):
    white = flat_field(LAMP, level_lux=1.0)
    return float(expected_electrons(white, contestant.sensor, contestant.exposure)[0])


def test_a_sensitive_noisy_pixel_overtakes_a_dull_silent_one_where_their_snr_is_equal():
    """a^2 E^2 / (a E + s^2) = b^2 E^2 / (b E + t^2), so E = (b^2 s^2 - a^2 t^2) / (a b (a - b))."""
    noisy, silent = one_channel("noisy", 0.8, 20.0), one_channel("silent", 0.4, 2.0)
    a, b = electrons_per_lux(noisy), electrons_per_lux(silent)
    expected = (b**2 * 20**2 - a**2 * 2**2) / (a * b * (a - b))
    _, (crossed,) = compare(noisy, silent)
    assert crossed.at == pytest.approx((expected,), rel=1e-8)
    assert crossed.better_first == "silent"
    sentence = crossover_sentence(crossed)
    assert f"below {expected:.3g} lx" in sentence
    assert sentence.startswith("With the kernel matrix, silent")


def test_the_order_in_which_sensors_are_named_changes_no_crossover():
    pair = one_channel("noisy", 0.8, 20.0), one_channel("silent", 0.4, 2.0)
    _, (forth,) = compare(*pair)
    _, (back,) = compare(*pair[::-1])
    assert forth.at == pytest.approx(back.at, rel=1e-8)
    assert forth.better_first == back.better_first


def test_a_better_pixel_in_everything_is_never_crossed():
    _, (crossed,) = compare(one_channel("good", 0.8, 2.0), one_channel("poor", 0.4, 20.0))
    assert crossed.at == ()
    assert crossed.better_first == "good"
    assert "at every illuminance" in crossover_sentence(crossed)


def test_levels_at_which_a_channel_is_saturated_have_no_snr():
    small = one_channel("small", 0.5, 2.0, full_well_e=1000.0)
    (curve,), _ = compare(small, levels=np.array([1e-3, 1e3]))
    assert np.isfinite(curve.value[0])
    assert np.isnan(curve.value[1])
    data = plain(curve)["value"]
    assert data[1] is None


def test_sensors_without_a_common_level_are_refused():
    small = one_channel("small", 0.5, 2.0, full_well_e=1.0)
    with refused_input(subject="small and large", value=(100.0, 1000.0)):
        compare(small, one_channel("large", 0.5, 2.0), levels=np.array([100.0, 1000.0]))


def test_a_pair_that_cannot_be_compared_does_not_silence_the_others():
    full = one_channel("full", 0.5, 2.0, full_well_e=1e-3)
    three = [full, one_channel("good", 0.8, 2.0), one_channel("poor", 0.4, 20.0)]
    makers = {"kernel": kernel}
    *apart, crossed = crossovers_or_reasons(three, makers, compared(three, makers, LEVELS))
    assert [(one.first, one.second) for one in apart] == [("full", "good"), ("full", "poor")]
    assert all("saturated" in one.why for one in apart)
    assert crossed.better_first == "good"


def test_each_pair_and_matrix_is_compared_once():
    three = [one_channel(n, q, 2.0) for n, q in (("a", 0.2), ("b", 0.3), ("c", 0.4))]
    makers = {"kernel": kernel, "again": kernel}
    curves = compared(three, makers, LEVELS)
    pairs = [(c.first, c.second, c.matrix) for c in crossovers(three, makers, curves)]
    assert len(curves) == 6
    assert pairs == [(a, b, m) for m in makers for a, b in (("a", "b"), ("a", "c"), ("b", "c"))]


def test_with_the_kernel_the_papers_sensor_without_ir_cut_never_wins_in_luminance():
    """Kernel: unmixing costs the same decibels at any level where shot noise rules."""
    contestants = used_of("onyx-rgbw", "onyx-rgb-ircut", time_s=0.0119)
    curves, (crossed,) = compare(*contestants, levels=np.geomspace(0.01, 10, 13))
    assert crossed.at == ()
    assert crossed.better_first == "onyx-rgb-ircut"
    # Table 3 of the paper at 10 lx: 26.1 and 32.4 dB
    assert [c.value[-1] for c in curves] == pytest.approx([26.1, 32.4], abs=0.3)


(ONYX,) = used_of("onyx-rgbw", time_s=0.0119, level_lux=10.0)


def swept(name, first, last, *, quantity="snr-y", points=5, of=ONYX):
    sweep = SWEEPS[name]
    values = swept_values(sweep, first, last, points)
    (curve,) = compared([of], {"k": kernel}, values, sweep=sweep, quantity=QUANTITIES[quantity])
    return curve


def test_twice_the_time_is_twice_the_light():
    """Table 3 anchors the value; eq. 2 has time and illuminance as one factor."""
    over_time, over_light = swept("time-ms", 1.19, 11.9), swept("lux", 1.0, 10.0)
    assert over_time.value == pytest.approx(over_light.value, abs=1e-9)
    assert over_time.value[-1] == pytest.approx(26.1, abs=0.3)


def test_where_read_noise_rules_ten_times_of_it_cost_20_db():
    assert np.diff(swept("read-noise-e", 1e6, 1e8, points=3).value) == pytest.approx(-20, abs=1e-3)


def test_an_ir_cut_beyond_the_grid_changes_nothing():
    assert swept("ircut-nm", 1500, 2000).value == pytest.approx(26.0, abs=0.1)
    bound = swept("ircut-nm", 600, 1500, quantity="bound").value
    assert (np.diff(bound) >= 0).all()  # a cut takes electrons
    assert bound[-1] > bound[0] + 5


def test_a_redder_black_body_makes_more_electrons_per_lux():
    """Infrared carries no lux: 2000 K has more of it per lux than 6000 K."""
    bound = swept("kelvin", 2000, 6000, quantity="bound").value
    assert np.isnan(bound[0])  # saturated
    dim = replace(ONYX, level_lux=0.1)
    bound = swept("kelvin", 2000, 6000, quantity="bound", points=2, of=dim).value
    assert bound[0] > bound[1] + 6


def test_each_further_illuminator_adds_the_same_infrared_electrons():
    """50 mW per W of light E over 400-1050 nm, taken at 850 nm, by a trapezoid of its own."""
    infrared = SWEEPS["infrared"].at

    def electrons(ratio):
        at = infrared(ONYX, ratio)
        return expected_electrons(white_scene(at), at.sensor, at.exposure)

    first, second, third = electrons(0.0), electrons(0.05), electrons(0.1)
    assert third - second == pytest.approx(second - first, rel=1e-3)  # the eye sees a trace of it
    at_850 = ONYX.sensor.qe[NM == 850.0][0]
    e_photons = np.trapezoid(ONYX.sensor.qe * NM[:, None], NM, axis=0)
    expected = first * 0.05 * 650.0 * 850.0 * at_850 / e_photons
    assert second - first == pytest.approx(expected, rel=0.05)  # 20 nm wide, where the QE bends


def test_price_is_bound_minus_snr_of_y():
    bound, snr, price = (
        swept("lux", 1.0, 10.0, quantity=name).value for name in ("bound", "snr-y", "price")
    )
    assert price == pytest.approx(bound - snr, abs=1e-9)
    assert price[-1] == pytest.approx(17.9, abs=0.3)  # from the paper's Tables 2 and 3


def test_where_less_is_better_the_lower_curve_leads():
    pair = [one_channel("noisy", 0.4, 20.0), one_channel("quiet", 0.8, 2.0)]
    makers = {"kernel": kernel}
    price = QUANTITIES["price"]
    curves = compared(pair, makers, LEVELS, quantity=price)
    assert curves[0].value == pytest.approx(0.0, abs=1e-9)  # one channel pays no price
    error = QUANTITIES["color-error"]
    sensors = used_of("onyx-rgbw", "onyx-rgb-ircut", time_s=0.001)
    curves = compared(sensors, makers, LEVELS[:3], quantity=error)
    (crossed,) = crossovers(sensors, makers, curves)
    assert curves[0].value[0] > curves[1].value[0]
    assert crossed.better_first == "onyx-rgb-ircut"


def test_three_segments_are_told_in_their_order():
    sensors = used_of("onyx-rgbw", "onyx-rgb", time_s=0.0119, level_lux=10.0)
    sweep, makers = SWEEPS["ircut-nm"], matrix_makers(["lmmse"], "quanta")
    curves = compared(sensors, makers, swept_values(sweep, 600, 1000, 21), sweep=sweep)
    (crossed,) = crossovers(sensors, makers, curves)
    low, high = crossed.at
    sentence = crossover_sentence(crossed)
    assert f"below {low:.4g} nm" in sentence
    assert f"onyx-rgb from {low:.4g} to {high:.4g}, onyx-rgbw above" in sentence


def test_the_band_over_priors_spans_the_crossovers_of_each():
    sensors = used_of("onyx-rgbw", "onyx-rgb-ircut", time_s=0.01194)
    levels = np.geomspace(0.05, 5, 9)
    (band,) = crossover_bands(sensors, ["kernel", "lmmse"], levels, priors=["chart-nir", "chart"])
    alone = []
    for prior in ("chart-nir", "chart"):
        makers = matrix_makers(["lmmse"], "quanta", prior=prior)
        (crossed,) = crossovers(sensors, makers, compared(sensors, makers, levels))
        alone += crossed.at
    assert band.span == (min(alone), max(alone))
    assert f"between {min(alone):.3g} and {max(alone):.3g} lx" in band_sentence(band)


@pytest.mark.parametrize(
    ("name", "fields"),
    [
        ("ridge", {"subject": "matrix", "value": "ridge"}),
        ("kernel=1", {"subject": "matrix", "value": "kernel=1"}),
        ("ridge=x", {"subject": "matrix 'ridge=x'", "value": "x"}),
    ],
)
def test_a_matrix_without_its_parameter_is_refused(name, fields):
    with refused_input(**fields):
        matrix_makers([name], "quanta")


@pytest.mark.parametrize("name", ["kernel", "least-squares", "lmmse"])
def test_levels_are_computed_at_once_whether_or_not_matrices_are_cached(name, monkeypatch):
    uncached = color_matrices._of_any_light.__wrapped__
    monkeypatch.setattr(color_matrices, "_of_any_light", uncached)
    point, maker = one_channel("one", 0.5, 2.0), matrix_makers([name], "quanta")[name]
    asked = []
    quantity = replace(SNR_Y, of=lambda *of: asked.append(of) or SNR_Y.of(*of))
    (together,) = compared([point], {name: maker}, LEVELS, quantity=quantity)
    assert not asked
    # a function of one's own is asked at each level, for the same values
    (single,) = compared([point], {name: lambda at: maker(at)}, LEVELS, quantity=quantity)
    assert [of[0].level_lux for of in asked] == LEVELS.tolist()
    assert together.value == pytest.approx(single.value, rel=1e-9)
    assert together.color_error == pytest.approx(single.color_error, rel=1e-9)


@pytest.mark.parametrize("name", ["kernel", "ridge=0.01", "lmmse", "noise-regularized=2"])
def test_matrices_over_levels_are_those_of_each_level_or_one_for_all(name):
    (maker,) = matrix_makers([name], "quanta").values()
    assert isinstance(maker, MatrixMaker)
    assert hash(maker) == hash(matrix_makers([name], "quanta")[name])
    point = used(sensor_named("onyx-rgb"))
    each = [maker(replace(point, level_lux=lux)).matrix for lux in (0.1, 10.0)]
    together = maker.over_levels(point, np.array([0.1, 10.0]))
    if together is None:
        assert each[0].tolist() == each[1].tolist()
    else:
        assert each[0].tolist() != each[1].tolist()
        assert together == pytest.approx(np.array(each), rel=1e-9)


def test_all_curves_are_asked_at_one_value_before_the_next():
    """An estimate of the time from the first values then holds for slow and fast curves alike."""
    asked, done = [], []

    def maker(name):
        def made(at):
            asked.append((at.level_lux, at.sensor.name, name))
            return kernel(at)

        return made

    makers = {name: maker(name) for name in ("slow", "fast")}
    compared([ONYX, one_channel("W", 0.5, 2.0)], makers, LEVELS[:3], progress=done.append)
    levels = [level for level, *_ in asked]
    assert levels == sorted(levels)
    assert len(set(asked)) == len(asked) == sum(done) == 12
