"""SNRx where the matrix adapts to the light: one matrix per level, from saturation down."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.color import ColorMatrix, chart_training, colored, kernel_matrix, lmmse
from chromanoise.metrics.speed import illuminance_for_snr, illuminance_for_snr_adapted
from chromanoise.noise import expected_electrons, with_noise
from chromanoise.spectra import equal_energy, flat_field
from outcomes import refused_input
from strategies import EXPOSURE, GRID, pixel_with, rgb_sensor, sensor_of, sensors, white_channel

LAMP = equal_energy(GRID)
CHART = chart_training(LAMP)


def lmmse_at(sensor):
    return lambda lux: lmmse(sensor, EXPOSURE, CHART, level_lux=lux)


def gray(sensor, lux, reflectance=0.18):
    scene = flat_field(LAMP, level_lux=lux, reflectance=reflectance)
    return with_noise(expected_electrons(scene, sensor, EXPOSURE), sensor)


def snr_of(sensor, lux, matrix_at, coordinate="Y"):
    color = colored(gray(sensor, lux), matrix_at(lux))
    i = color.names.index(coordinate)
    return color.mean[i] / np.sqrt(color.variance[i])


@given(sensors(), st.floats(0.05, 40.0), st.sampled_from("XYZ"))
def test_one_matrix_at_all_levels_gives_the_snrx_of_that_matrix(sensor, snr, coordinate):
    matrix = kernel_matrix(sensor, EXPOSURE)
    asked = {"snr": snr, "coordinate": coordinate}
    fixed = illuminance_for_snr(sensor, LAMP, EXPOSURE, matrix, **asked)
    found = illuminance_for_snr_adapted(sensor, LAMP, EXPOSURE, lambda lux: matrix, **asked)
    if fixed is None:
        assert found is None
    else:
        assert found == pytest.approx(fixed, rel=1e-9)


@pytest.mark.parametrize("read_noise_e", [0.0, 3.0, 30.0])
@pytest.mark.parametrize(("snr", "coordinate"), [(10.0, "Y"), (1.0, "Y"), (0.1, "Y"), (10.0, "Z")])
def test_at_the_level_of_snr_x_the_color_by_lmmse_has_that_snr(read_noise_e, snr, coordinate):
    sensor = rgb_sensor(read_noise_e, 1e5)
    at = lmmse_at(sensor)
    lux = illuminance_for_snr_adapted(sensor, LAMP, EXPOSURE, at, snr=snr, coordinate=coordinate)
    assert snr_of(sensor, lux, at, coordinate) == pytest.approx(snr, rel=1e-9)
    for brighter in (1.001, 1.1, 3.0):
        assert snr_of(sensor, brighter * lux, at, coordinate) > snr
    assert snr_of(sensor, lux / 1.001, at, coordinate) < snr


@pytest.mark.parametrize("power", [-3.0, 0.0, 1.0])
def test_one_channel_needs_100_electrons_however_its_gain_follows_the_light(power):
    sensor = white_channel(pixel=pixel_with(0.0))
    matrix = kernel_matrix(sensor, EXPOSURE)
    lux = illuminance_for_snr_adapted(
        sensor, LAMP, EXPOSURE, lambda lux: replace(matrix, matrix=matrix.matrix * lux**power)
    )
    assert gray(sensor, lux).mean[0] == pytest.approx(100.0, rel=1e-12)


# matrices that lose the SNR again


def blind_between(low_lux, high_lux):
    """A sensor of two like channels, and a matrix whose channels cancel between two levels."""
    qe = np.full((GRID.n, 2), 0.5)
    sensor = sensor_of(qe, pixel=pixel_with(0.0, 1e5))
    kernel = kernel_matrix(sensor, EXPOSURE)
    rows = np.array([[1.0, 1.0]] * 3)

    def matrix_at(lux) -> ColorMatrix:
        blind = low_lux < lux < high_lux
        return replace(kernel, matrix=rows * ([1.0, -1.0] if blind else [1.0, 1.0]))

    return sensor, matrix_at


def lux_for(sensor, electrons):
    return electrons / float(gray(sensor, 1.0).mean[0])


def test_snr_that_is_lost_and_won_again_counts_from_the_last_time():
    sensor, _ = blind_between(0.0, 0.0)
    # two channels reach SNR 10 at 50 e- each; the matrix is blind from 200 to 800 e-
    low, high = lux_for(sensor, 200.0), lux_for(sensor, 800.0)
    sensor, matrix_at = blind_between(low, high)
    found = illuminance_for_snr_adapted(sensor, LAMP, EXPOSURE, matrix_at)
    assert found == pytest.approx(high, rel=1e-12)
    assert found >= high  # on the side that sees
    sensor, seeing = blind_between(0.0, 0.0)
    always = illuminance_for_snr_adapted(sensor, LAMP, EXPOSURE, seeing)
    assert gray(sensor, always).mean == pytest.approx([50.0, 50.0], rel=1e-9)


def test_snr_that_is_lost_at_the_brightest_level_is_not_kept():
    sensor, _ = blind_between(0.0, 0.0)
    sensor, matrix_at = blind_between(lux_for(sensor, 200.0), np.inf)
    assert illuminance_for_snr_adapted(sensor, LAMP, EXPOSURE, matrix_at) is None


def test_a_short_dip_is_seen_with_steps_that_are_shorter():
    sensor, _ = blind_between(0.0, 0.0)
    low, high = lux_for(sensor, 400.0), lux_for(sensor, 420.0)  # 1/47 of a decade
    sensor, matrix_at = blind_between(low, high)
    found = illuminance_for_snr_adapted(sensor, LAMP, EXPOSURE, matrix_at, steps_per_decade=100)
    assert found == pytest.approx(high, rel=1e-12)


# never


def test_no_level_is_enough_where_full_well_comes_first():
    sensor = white_channel(pixel=pixel_with(0.0, full_well_e=50.0))  # SNR 10 takes 100
    at = lmmse_at(sensor)
    assert illuminance_for_snr_adapted(sensor, LAMP, EXPOSURE, at) is None
    lux = illuminance_for_snr_adapted(sensor, LAMP, EXPOSURE, at, snr=7.0)
    assert gray(sensor, lux).mean[0] == pytest.approx(49.0, rel=1e-9)


def test_a_sensor_that_sees_nothing_reaches_no_snr():
    blind = sensor_of(np.zeros((GRID.n, 1)), names=("W",))
    seeing = kernel_matrix(white_channel(), EXPOSURE)
    assert illuminance_for_snr_adapted(blind, LAMP, EXPOSURE, lambda lux: seeing) is None


@pytest.mark.parametrize(
    ("asked", "subject"),
    [
        ({"snr": 0.0}, "snr"),
        ({"coordinate": "L"}, "coordinate"),
        ({"reflectance": 0.0}, "reflectance"),
        ({"steps_per_decade": 0}, "steps_per_decade"),
    ],
)
def test_what_cannot_be_asked_of_a_speed_is_refused(asked, subject):
    sensor = rgb_sensor(3.0, 1e5)
    with refused_input(subject=subject):
        illuminance_for_snr_adapted(sensor, LAMP, EXPOSURE, lmmse_at(sensor), **asked)


def test_a_matrix_of_other_channels_is_refused():
    sensor = rgb_sensor(3.0, 1e5)
    swapped = kernel_matrix(replace(sensor, names=("c", "b", "a")), EXPOSURE)
    with refused_input(value={"sensor": ("a", "b", "c"), "matrix": ("c", "b", "a")}):
        illuminance_for_snr_adapted(sensor, LAMP, EXPOSURE, lambda lux: swapped)
