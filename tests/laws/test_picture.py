"""A picture is many points: same physics, independent noise, one seed."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from chromanoise.color import adapted_to_d65, colored, kernel_matrix, srgb_from_xyz
from chromanoise.imaging import Work, rendered
from chromanoise.metrics import snr_db
from chromanoise.noise import Exposure, expected_electrons, with_noise
from chromanoise.spectra import (
    BUILTIN_CUBES,
    Cube,
    builtin_cube,
    cie_a,
    flat_cube,
    flat_field,
    reflectance_rows,
)
from outcomes import same_bits
from strategies import GRID, bell_qe, pixel_with, point_of, sensor_of

LAMP = cie_a(GRID)
RGB = bell_qe([450, 540, 610], [30, 45, 40], [0.6, 0.7, 0.6])
SENSOR = sensor_of(RGB, pixel=pixel_with(5.0, full_well_e=1e6), name="toy rgb")
EXPOSURE = Exposure(time_s=0.02)
LUX = 10.0


def picture_of(cube, sensor=SENSOR, **more):
    return rendered(cube, used(sensor), **more)


def used(sensor=SENSOR, exposure=EXPOSURE):
    return point_of(sensor, LUX, exposure=exposure, illuminant=LAMP)


def grey(reflectance=0.5, height=40, width=50):
    return flat_cube(GRID.wavelength_nm, reflectance, height=height, width=width)


def varied(height=12, width=9):
    ramp = np.linspace(0.05, 0.95, height * width * GRID.n)
    return Cube(
        wavelength_nm=GRID.wavelength_nm,
        stored=ramp.reshape(height, width, GRID.n),
        source="a ramp",
    )


@settings(max_examples=8)
@given(st.floats(0.05, 1.0), st.integers(0, 10_000), st.sampled_from(["energy", "quanta"]))
def test_a_cube_of_equal_pixels_gives_the_result_of_its_point(reflectance, seed, metric):
    matrix = kernel_matrix(SENSOR, EXPOSURE, metric)
    picture = picture_of(grey(reflectance), seed=seed, matrix=matrix)
    scene = flat_field(LAMP, level_lux=LUX, reflectance=reflectance)
    raw = with_noise(expected_electrons(scene, SENSOR, EXPOSURE), SENSOR)
    color = colored(raw, matrix)
    assert picture.mean_e == pytest.approx(raw.mean, rel=1e-6)

    pixels = picture.xyz.reshape(-1, 3).astype(float)
    count = len(pixels)
    # Y of the picture is relative to a perfect white, so a grey of rho has Y = rho
    assert abs(pixels[:, 1].mean() - reflectance) < 5 * pixels[:, 1].std() / np.sqrt(count)
    exact = snr_db(color)
    for i, name in enumerate(("X", "Y", "Z")):
        drawn_db = 20 * np.log10(abs(pixels[:, i].mean()) / pixels[:, i].std(ddof=1))
        # (20 / ln 10) sqrt(1 / (2 N) + 1 / (N SNR^2))
        snr = 10 ** (float(exact[name]) / 20)
        se_db = 8.6859 * np.sqrt(1 / (2 * count) + 1 / (count * snr**2))
        assert abs(drawn_db - float(exact[name])) < 5 * se_db


def test_colors_of_a_flat_picture_covary_as_the_closed_form_says():
    picture = picture_of(grey(0.5, 60, 60), seed=3)
    scene = flat_field(LAMP, level_lux=LUX, reflectance=0.5)
    raw = with_noise(expected_electrons(scene, SENSOR, EXPOSURE), SENSOR)
    exact = colored(raw, kernel_matrix(SENSOR, EXPOSURE)).covariance
    drawn = np.cov(picture.xyz.reshape(-1, 3).astype(float).T)

    def correlations(covariance):
        sd = np.sqrt(np.diagonal(covariance))
        return covariance / np.outer(sd, sd)

    r = correlations(exact)
    # Fisher: the standard error of r is (1 - r^2) / sqrt(N)
    assert (np.abs(correlations(drawn) - r) <= 5 * (1 - r**2) / 60 + 1e-9).all()


@pytest.mark.parametrize("clip", [False, True])
def test_the_same_seed_gives_the_same_picture_and_another_seed_another(clip):
    first, again, other = (picture_of(varied(), seed=seed, clip=clip) for seed in (5, 5, 6))
    assert same_bits(first, again)
    assert not (first.xyz == other.xyz).any()


@pytest.mark.parametrize(("tile_rows", "threads"), [(1, 1), (5, 2), (1000, 3)])
def test_neither_tiles_nor_threads_change_a_bit_of_the_picture(tile_rows, threads):
    whole = picture_of(varied(), seed=1)
    tiled = picture_of(varied(), seed=1, work=Work(tile_rows=tile_rows, threads=threads))
    assert same_bits(tiled, whole)


def test_noise_of_neighbouring_rows_and_columns_is_independent():
    y = picture_of(grey(0.5, 60, 60), seed=8).xyz[..., 1].astype(float)
    for one, other in ((y[:-1], y[1:]), (y[:, :-1], y[:, 1:])):
        r = np.corrcoef(one.ravel(), other.ravel())[0, 1]
        assert abs(r) < 5 / 60


def test_a_perfect_white_without_noise_is_white():
    # 1e9 electrons: 90 dB
    bright = Exposure(time_s=2e4)
    picture = rendered(grey(1.0, 4, 4), used(exposure=bright))
    assert picture.white[1] == pytest.approx(1.0, abs=1e-12)
    assert picture.xyz == pytest.approx(np.broadcast_to(picture.white, (4, 4, 3)), rel=1e-3)
    assert (picture.srgb >= 254).all()


def test_a_black_cube_is_black_on_average():
    # nothing but read noise, which is as often below zero as above
    picture = picture_of(grey(0.0))
    assert picture.mean_e == pytest.approx(np.zeros(3), abs=0)
    y = picture.xyz[..., 1].astype(float)
    assert abs(y.mean()) < 5 * y.std() / np.sqrt(y.size)
    assert y.min() < 0 < y.max()


def test_middle_grey_is_encoded_as_118():
    # 18 % grey is 118 (of 255) in sRGB: 1.055 * .18^(1/2.4) - .055 = 0.4614
    picture = rendered(grey(0.18, 4, 4), used(exposure=Exposure(time_s=2e4)))
    assert np.abs(picture.srgb.astype(int) - 118).max() <= 1


def test_electrons_above_full_well_are_counted_and_held_only_when_asked():
    # full well at the mean of channel a: half of its pixels are above, all or none of b's and c's
    fullest = expected_electrons(flat_field(LAMP, level_lux=LUX), SENSOR, EXPOSURE)
    sensor = sensor_of(RGB, pixel=pixel_with(5.0, full_well_e=float(fullest[0])))
    free, held = (picture_of(grey(1.0), sensor=sensor, clip=clip) for clip in (False, True))
    assert (free.above_full_well == held.above_full_well).all()
    assert free.above_full_well[0] == pytest.approx(0.5, abs=5 * 0.5 / np.sqrt(2000) + 0.01)
    assert list(free.above_full_well[1:]) == [1.0, 1.0]  # illuminant A: little blue
    assert held.xyz[..., 1].mean() < free.xyz[..., 1].mean()
    assert (free.clipped, held.clipped) == (False, True)


def test_what_was_assumed_beyond_the_cube_is_told_with_the_picture():
    short = flat_cube(np.array([420.0, 700.0]), 0.5, height=2, width=2)
    picture = picture_of(short, beyond="hold")
    assert any("hold" in note and "420" in note for note in picture.notes)
    whole = picture_of(grey(0.5, 2, 2))
    assert picture.xyz == pytest.approx(whole.xyz, rel=1e-5)


def test_the_builtin_chart_holds_the_reflectances_of_a_colorchecker_on_a_dark_card():
    # white 0.82 (SOURCES.toml) to black 0.03 of the bottom row; every patch many equal pixels
    cube = builtin_cube(BUILTIN_CUBES[0])
    assert cube.wavelength_nm[[0, -1]] == pytest.approx([400.0, 1050.0])
    at_550 = int(np.argmin(np.abs(cube.wavelength_nm - 550)))
    green = reflectance_rows(cube, 0, cube.stored.shape[0])[..., at_550]
    found, counts = np.unique(green.round(6), return_counts=True)
    assert len(found) >= 23  # 24 patches and the card; two may share a value
    assert counts.min() > 50
    bottom = green[int(green.shape[0] * 0.87)]
    assert bottom.max() == pytest.approx(0.82, abs=0.02)
    assert bottom.max() == green.max()


@given(st.floats(0.0, 1.0))
def test_a_grey_stays_grey_under_any_lamp(rho):
    white = np.array([1.0985, 1.0, 0.3558])  # illuminant A
    encoded = srgb_from_xyz(adapted_to_d65(rho * white, white))
    assert np.ptp(encoded) < 2e-3
    assert ((encoded >= 0) & (encoded <= 1)).all()


@given(st.lists(st.floats(-1.0, 3.0), min_size=3, max_size=3).map(np.array))
def test_adapting_d65_to_d65_changes_nothing(xyz):
    assert adapted_to_d65(xyz, np.array([0.95047, 1.0, 1.08883])) == pytest.approx(xyz, abs=1e-12)


@given(st.lists(st.floats(-1.0, 3.0), min_size=3, max_size=3).map(np.array))
def test_encoded_colors_stay_within_0_and_1(xyz):
    encoded = srgb_from_xyz(xyz)
    assert ((encoded >= 0) & (encoded <= 1)).all()
