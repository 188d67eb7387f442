"""Sensors compared over the light level: the crossover is where a closed form puts it."""

import numpy as np
import pytest

from chromanoise._check import InputError
from chromanoise.color import kernel_matrix
from chromanoise.exposure import Exposure, expected_electrons
from chromanoise.scene import flat_field
from chromanoise.sensor import Pixel, Sensor, sensor_named
from chromanoise.spectra import DEFAULT_GRID, equal_energy
from chromanoise.study.comparison import (
    Contestant,
    compared,
    comparison_as_json,
    crossover_sentence,
    crossovers,
    luminance_snr_db,
)

LAMP = equal_energy(DEFAULT_GRID)
EXPOSURE = Exposure(time_s=0.01)
LEVELS = np.geomspace(1e-3, 1e2, 26)


def kernel(sensor, exposure, level_lux):
    return kernel_matrix(sensor, exposure, "quanta")


def one_channel(name, qe, read_noise_e, full_well_e=1e9):
    pixel = Pixel(pitch_um=10.0, full_well_e=full_well_e, read_noise_e=read_noise_e)
    sensor = Sensor(
        name=name,
        grid=DEFAULT_GRID,
        qe=np.full((DEFAULT_GRID.n, 1), qe),
        names=("W",),
        pixel=pixel,
    )
    return Contestant(sensor=sensor, exposure=EXPOSURE)


def compare(*contestants, levels=LEVELS):
    makers = {"kernel": kernel}
    curves = compared(contestants, makers, LAMP, levels)
    return curves, crossovers(contestants, makers, LAMP, curves)


def electrons_per_lux(contestant):
    white = flat_field(LAMP, level_lux=1.0)
    return float(expected_electrons(white, contestant.sensor, contestant.exposure)[0])


def test_a_sensitive_noisy_pixel_overtakes_a_dull_silent_one_where_their_snr_is_equal():
    """a^2 E^2 / (a E + s^2) = b^2 E^2 / (b E + t^2), so E = (b^2 s^2 - a^2 t^2) / (a b (a - b))."""
    noisy, silent = one_channel("noisy", 0.8, 20.0), one_channel("silent", 0.4, 2.0)
    a, b = electrons_per_lux(noisy), electrons_per_lux(silent)
    expected = (b**2 * 20**2 - a**2 * 2**2) / (a * b * (a - b))
    _, (crossed,) = compare(noisy, silent)
    assert crossed.level_lux == pytest.approx((expected,), rel=1e-8)
    assert crossed.better_in_the_dark == "silent"
    sentence = crossover_sentence(crossed)
    assert f"below {expected:.3g} lx" in sentence
    assert sentence.startswith("With the kernel matrix silent")


def test_the_order_in_which_sensors_are_named_changes_no_crossover():
    pair = one_channel("noisy", 0.8, 20.0), one_channel("silent", 0.4, 2.0)
    _, (forth,) = compare(*pair)
    _, (back,) = compare(*pair[::-1])
    assert forth.level_lux == pytest.approx(back.level_lux, rel=1e-8)
    assert forth.better_in_the_dark == back.better_in_the_dark


def test_a_better_pixel_in_everything_is_never_crossed():
    _, (crossed,) = compare(one_channel("good", 0.8, 2.0), one_channel("poor", 0.4, 20.0))
    assert crossed.level_lux == ()
    assert crossed.better_in_the_dark == "good"
    assert "at every level" in crossover_sentence(crossed)


def test_levels_at_which_a_channel_is_saturated_have_no_snr():
    small = one_channel("small", 0.5, 2.0, full_well_e=1000.0)
    (curve,), _ = compare(small, levels=np.array([1e-3, 1e3]))
    assert np.isfinite(curve.snr_y_db[0])
    assert np.isnan(curve.snr_y_db[1])
    told = comparison_as_json([curve], [])["curves"][0]["snr_y_db"]
    assert told[1] is None


def test_sensors_without_a_common_level_are_refused():
    small = one_channel("small", 0.5, 2.0, full_well_e=1.0)
    with pytest.raises(InputError, match="no light level"):
        compare(small, one_channel("large", 0.5, 2.0), levels=np.array([100.0, 1000.0]))


def test_each_pair_and_matrix_is_compared_once():
    three = [one_channel(n, q, 2.0) for n, q in (("a", 0.2), ("b", 0.3), ("c", 0.4))]
    makers = {"kernel": kernel, "again": kernel}
    curves = compared(three, makers, LAMP, LEVELS)
    pairs = [(c.first, c.second, c.matrix) for c in crossovers(three, makers, LAMP, curves)]
    assert len(curves) == 6
    assert pairs == [(a, b, m) for m in makers for a, b in (("a", "b"), ("a", "c"), ("b", "c"))]


def test_with_the_kernel_the_papers_sensor_without_ir_cut_never_wins_in_luminance():
    """Kernel: unmixing costs the same decibels at any level where shot noise rules."""
    contestants = [
        Contestant(sensor=sensor_named(n, DEFAULT_GRID), exposure=Exposure(time_s=0.0119))
        for n in ("onyx-rgbw", "onyx-rgb-ircut")
    ]
    curves, (crossed,) = compare(*contestants, levels=np.geomspace(0.01, 10, 13))
    assert crossed.level_lux == ()
    assert crossed.better_in_the_dark == "onyx-rgb-ircut"
    # Table 3 of the paper at 10 lx: 26.1 and 32.4 dB
    assert [c.snr_y_db[-1] for c in curves] == pytest.approx([26.1, 32.4], abs=0.3)
    assert luminance_snr_db(contestants[0], kernel, LAMP, 10.0) == pytest.approx(26.1, abs=0.3)
