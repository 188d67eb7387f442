"""Colors that noise tells apart: printed numbers, and what no reader can change."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.color import kernel_matrix
from chromanoise.metrics import color_sensitivity_bits, distinguishable_colors_bits
from chromanoise.noise import Exposure, expected_electrons
from chromanoise.spectra import DEFAULT_GRID, Scene, illuminant_named
from chromanoise.study import sensor_named
from outcomes import refused_input

RGB = np.array([[19.0, 30.6, 1951.4], [46.5, 893.6, 1006.3], [717.2, 788.7, 402.6]])
RGBW = np.array(
    [[19.0, 30.6, 2398.9], [46.5, 893.6, 1062.6], [717.2, 788.7, 421.6], [851.5, 1385.7, 3299.5]]
)
numbers = st.floats(0.1, 1.0)


@st.composite
def blocks(draw, channels):
    rows = [[draw(st.floats(0.0, 50.0)) for _ in range(3)] for _ in range(channels)]
    return np.array(rows) + 2e3 * np.eye(channels, 3) + 20.0


@pytest.mark.parametrize(
    ("blocks_e", "bits"),
    [(RGB / 10, 8.834), (RGB, 15.590), (RGBW / 10, 9.701), (RGBW, 16.282)],
)
def test_the_colors_of_the_papers_sensors_are_those_of_monte_carlo(blocks_e, bits):
    """Integrals by 10^6 draws: 15.587 and 15.589 +- 0.0013 (RGB), 16.279 and 16.281 +- 0.0015."""
    assert distinguishable_colors_bits(blocks_e, read_noise_e=10.0) == pytest.approx(
        bits, abs=1.5e-3
    )


@pytest.mark.parametrize(("level_lux", "bits"), [(1.0, 8.010), (10.0, 14.451)])
def test_the_kernel_matrix_of_the_papers_rgbw_tells_fewer_colors_apart(level_lux, bits):
    sensor, lamp = sensor_named("onyx-rgbw"), illuminant_named("E")
    at = DEFAULT_GRID.wavelength_nm
    edges = ((400, 485), (490, 575), (580, 700))
    squares = np.array([(first <= at) & (at <= last) for first, last in edges], dtype=float)
    exposure = Exposure(time_s=0.012)
    scene = Scene(illuminant=lamp, level_lux=level_lux, reflectance=squares)
    blocks_e = expected_electrons(scene, sensor, exposure).T
    assert blocks_e == pytest.approx(RGBW * level_lux / 10, rel=0.02)
    matrix = kernel_matrix(sensor, exposure, "quanta").matrix
    found = distinguishable_colors_bits(blocks_e, read_noise_e=10.0, matrix=matrix)
    assert found == pytest.approx(bits, abs=0.01)


def test_without_read_noise_the_levels_of_a_channel_are_two_roots_of_its_electrons():
    """int dx N / (N x)^(1/2) = 2 N^(1/2), where the density is infinite at black."""
    one = distinguishable_colors_bits(np.diag([1e4, 1e4, 1e4]), read_noise_e=0.0)
    assert one == pytest.approx(3 * np.log2(2 * 100), abs=1e-9)


@given(blocks(3), st.lists(st.floats(-1, 1), min_size=9, max_size=9), st.floats(1, 30))
def test_no_matrix_of_three_channels_changes_the_number_of_colors(blocks_e, entries, noise_e):
    matrix = np.reshape(entries, (3, 3)) + 4 * np.eye(3)
    # with a fourth channel without light, so that the matrix is not left out
    dark = np.vstack([blocks_e, np.zeros(3)])
    reader = np.column_stack([matrix, np.zeros(3)])
    found = distinguishable_colors_bits(dark, matrix=reader, read_noise_e=noise_e)
    plain = distinguishable_colors_bits(blocks_e, read_noise_e=noise_e)
    assert found == pytest.approx(plain, abs=1e-9)


@given(blocks(4), st.lists(st.floats(-1, 1), min_size=12, max_size=12), st.floats(1, 30))
def test_no_matrix_of_four_channels_tells_more_colors_apart_than_the_best_reader(
    blocks_e, entries, noise_e
):
    matrix = np.reshape(entries, (3, 4)) + 4 * np.eye(3, 4)
    told = {"read_noise_e": noise_e}
    best = distinguishable_colors_bits(blocks_e, **told)
    assert distinguishable_colors_bits(blocks_e, matrix=matrix, **told) <= best + 1e-9
    assert distinguishable_colors_bits(blocks_e[:3], **told) <= best + 1e-9


@given(blocks(3))
def test_without_read_noise_four_times_the_light_is_one_bit_per_block(blocks_e):
    once, four = (
        distinguishable_colors_bits(factor * blocks_e, read_noise_e=0.0) for factor in (1.0, 4.0)
    )
    assert four - once == pytest.approx(3.0, abs=1e-9)


def test_the_colors_of_channels_that_see_one_block_each_are_the_raw_cube():
    tops = np.array([1e4, 5e3, 2e3])
    assert distinguishable_colors_bits(np.diag(tops), read_noise_e=10.0) == pytest.approx(
        float(color_sensitivity_bits(tops, read_noise_e=10.0)), abs=1e-4
    )


def test_filters_change_the_colors_and_not_the_cube():
    """22.4995 bits for 10,000 e- and 10 e- in three channels, whatever the filters are."""
    broad = np.full((3, 3), 2e3) + 4e3 * np.eye(3)
    top = broad.sum(axis=1)
    cube = float(color_sensitivity_bits(top, read_noise_e=10.0))
    apart = distinguishable_colors_bits(np.diag(top), read_noise_e=10.0)
    assert cube == pytest.approx(apart, abs=1e-3)
    assert distinguishable_colors_bits(broad, read_noise_e=10.0) < apart - 1
    full = float(color_sensitivity_bits(np.full(3, 1e4), read_noise_e=10.0))
    assert full == pytest.approx(22.4995, abs=1e-4)


def test_dependent_blocks_tell_no_colors_apart():
    assert distinguishable_colors_bits(np.full((3, 3), 100.0), read_noise_e=1.0) == -np.inf
    silent = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, 0.0]])
    assert distinguishable_colors_bits(silent, read_noise_e=1.0) == -np.inf


@pytest.mark.parametrize(
    ("wrong", "subject"),
    [
        ({"blocks_e": -RGB}, "blocks_e"),
        ({"blocks_e": RGB[:2]}, "blocks_e"),
        ({"blocks_e": RGB * np.array([[1], [1], [0]]), "read_noise_e": 0.0}, "blocks_e"),
        ({"read_noise_e": -1.0}, "read_noise_e"),
        ({"matrix": np.ones((2, 3))}, "matrix"),
        ({"blocks_e": np.ones((9, 6))}, "blocks_e"),
        ({"blocks_e": np.ones((3, 0))}, "blocks_e"),
    ],
)
def test_what_is_no_gamut_is_refused(wrong, subject):
    arguments = {"blocks_e": RGB, "read_noise_e": 10.0} | wrong
    with refused_input(subject=subject):
        distinguishable_colors_bits(**arguments)
