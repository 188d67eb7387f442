"""The built-in scenes have the statistics and the geometry that they declare."""

from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from chromanoise.noise import Exposure, expected_electrons
from chromanoise.spectra import (
    BUILTIN_CUBES,
    DEFAULT_GRID,
    SLANTED_EDGES,
    Scene,
    builtin_cube,
    color_axes,
    light,
    row_source,
)
from chromanoise.spectra.builtin_scenes import foliage_reflectances, occluding_discs, paint_behind
from chromanoise.study.resolve_names import resolve_illuminant, resolve_sensor

WAVELENGTH = DEFAULT_GRID.wavelength_nm
SYNTHETIC = BUILTIN_CUBES[1:]
SMALLEST, LARGEST = 2.0, 8.0


@cache
def stored(name):
    return pixels_of(builtin_cube(name))


def pixels_of(cube):
    return row_source(cube.stored).rows(0, cube.stored.shape[0])


def scene_of(reflectance, illuminant="E"):
    return Scene(illuminant=resolve_illuminant(illuminant), level_lux=10.0, reflectance=reflectance)


def xyz_of(reflectance, illuminant="E"):
    return light(scene_of(reflectance, illuminant), "quanta") @ color_axes(DEFAULT_GRID, "quanta")


def at(reflectance, wavelength_nm):
    return reflectance[..., wavelength_nm == WAVELENGTH][..., 0]


def sides_of(kind):
    """Means of the two flat regions of the vertical edge of this kind."""
    (edge,) = (e for e in SLANTED_EDGES if e.kind == kind and e.direction == "vertical")
    cube = stored("builtin:slanted-edges").astype(float)
    return np.stack([cube[region].mean(axis=(0, 1)) for region in edge.flat_regions])


# ---- all ----


@pytest.mark.parametrize("name", SYNTHETIC)
def test_a_synthetic_scene_is_a_reflectance_on_the_default_grid_and_says_that_it_is_synthetic(name):
    cube = builtin_cube(name)
    assert cube.stored.shape == (256, 256, DEFAULT_GRID.n)
    assert cube.stored.dtype == np.float32
    assert np.array_equal(cube.wavelength_nm, WAVELENGTH)
    assert 0.0 < stored(name).min() < 0.1
    assert 0.5 < stored(name).max() <= 1.0
    assert cube.source == name
    assert any("synthetic" in note for note in cube.notes)
    assert np.array_equal(pixels_of(cube), stored(name))  # the same each time


@pytest.mark.parametrize("name", ["builtin:dead-leaves", "builtin:foliage"])
def test_the_infrared_hardly_follows_the_luminance(name):
    # in the ColorChecker the correlation over its 24 patches is 0.5
    cube = stored(name)
    luminance = xyz_of(cube)[..., 1].ravel()
    infrared = cube[..., WAVELENGTH >= 750].mean(axis=-1).ravel()
    assert abs(np.corrcoef(luminance, infrared)[0, 1]) < 0.25
    assert infrared.std() > 0.05


# ---- dead leaves ----


@cache
def many_discs():
    found = [occluding_discs(128, (SMALLEST, LARGEST), seed=seed) for seed in range(20)]
    return [label for label, _ in found], [radii[label] for label, radii in found]


def z_of(samples, expected):
    return (np.mean(samples) - expected) / (np.std(samples, ddof=1) / np.sqrt(len(samples)))


@pytest.mark.parametrize("share", [0.25, 0.5, 0.75])
def test_the_radius_of_the_disc_at_a_pixel_is_uniform_in_its_logarithm(share):
    # the density of the radii, r^-3, times the area of a disc, r^2, is 1/r
    quantile = SMALLEST * (LARGEST / SMALLEST) ** share
    assert abs(z_of([(r < quantile).mean() for r in many_discs()[1]], share)) < 5


def test_discs_with_their_center_outside_the_picture_are_seen_as_often_as_they_must():
    small = [occluding_discs(4, (SMALLEST, 4 * LARGEST), seed=seed) for seed in range(300)]
    median = np.sqrt(SMALLEST * 4 * LARGEST)
    assert abs(z_of([radii[label[1, 2]] < median for label, radii in small], 0.5)) < 5


def test_a_shape_is_painted_behind_all_earlier_ones():
    label = np.full((1, 6), -1)
    center, reach = np.array([[0.0, 1.0], [0.0, 3.0]]), np.array([1.5, 2.0])
    paint_behind(label, center, reach, lambda k, down, right: abs(down + right) <= reach[k])
    assert label.tolist() == [[0, 0, 0, 1, 1, 1]]
    paint_behind(label, center, reach, lambda k, down, right: down + right < 9, first=2)
    assert label.tolist() == [[0, 0, 0, 1, 1, 1]]


def test_the_radii_have_the_density_r_to_the_minus_3():
    _, radii = occluding_discs(64, (SMALLEST, LARGEST), seed=3)
    # P(r > 2 r_min) = (1/4 - 1/16) / (1 - 1/16), by integration
    assert (radii > 2 * SMALLEST).mean() == pytest.approx(0.2, abs=5 * 0.4 / np.sqrt(radii.size))
    assert SMALLEST <= radii.min() < radii.max() <= LARGEST


@pytest.mark.parametrize("lag", [1, 3, 8])
def test_two_pixels_are_on_one_disc_as_often_as_the_dead_leaves_model_says(lag):
    # B / (2 - B), B the mean overlap of a disc with itself moved by the lag, over its mean area:
    # Bordenave, Gousseau & Roueff, Adv. Appl. Probab. 38 (2006) 31; here B by a fine grid of discs
    radii = np.linspace(SMALLEST, LARGEST, 4001)
    half = np.minimum(lag / (2 * radii), 1.0)
    overlap = 2 * radii**2 * (np.arccos(half) - half * np.sqrt(1 - half**2))
    b = np.trapezoid(radii**-3 * overlap, radii) / (np.pi * np.log(LARGEST / SMALLEST))
    same = [(label[:, lag:] == label[:, :-lag]).mean() for label in many_discs()[0]]
    assert abs(z_of(same, b / (2 - b))) < 5


@pytest.mark.parametrize("band_nm", [450, 550, 650, 850])
def test_the_power_spectrum_of_the_dead_leaves_falls_about_as_the_inverse_square(band_nm):
    band = at(stored("builtin:dead-leaves"), band_nm).astype(float)
    window = np.hanning(256)[:, None] * np.hanning(256)
    power = np.abs(np.fft.fft2((band - band.mean()) * window)) ** 2
    frequency = np.hypot(np.fft.fftfreq(256)[:, None], np.fft.fftfreq(256))
    edges = np.geomspace(4 / 256, 0.25, 9)
    rings = [power[(frequency >= a) & (frequency < b)].mean() for a, b in pairwise(edges)]
    slope = np.polyfit(np.log(edges[:-1]), np.log(rings), 1)[0]
    assert -2.3 < slope < -1.5


# ---- slanted edges ----


@pytest.mark.parametrize("edge", SLANTED_EDGES, ids=lambda edge: f"{edge.kind} {edge.direction}")
def test_the_edge_found_in_the_pixels_is_where_it_is_declared(edge):
    cell = at(stored("builtin:slanted-edges"), 800 if edge.kind == "infrared" else 600)[edge.cell]
    cell = cell.astype(float)
    first, second = cell[0, 0], cell[-1, -1]
    share = (cell - first) / (second - first)
    if edge.direction == "horizontal":
        share = share.T
    row, column = edge.center_px
    across, along = (column, row) if edge.direction == "vertical" else (row, column)
    start = edge.columns[0] if edge.direction == "vertical" else edge.rows[0]
    begin = edge.rows[0] if edge.direction == "vertical" else edge.columns[0]
    # the part of a line of pixels before the edge is as long as its first side
    found = start - 0.5 + (1.0 - share).sum(axis=1)
    lines = begin + np.arange(len(share))
    slope, offset = np.polyfit(lines - along, found, 1)
    assert np.degrees(np.arctan(-slope)) == pytest.approx(5.0, abs=1e-3)
    assert offset == pytest.approx(across, abs=1e-3)
    assert found == pytest.approx(across + slope * (lines - along), abs=1e-3)  # exact areas


@pytest.mark.parametrize("edge", SLANTED_EDGES, ids=lambda edge: f"{edge.kind} {edge.direction}")
def test_the_flat_regions_are_flat_large_and_on_their_own_sides(edge):
    cube = stored("builtin:slanted-edges")
    distance = np.full(cube.shape[:2], np.nan)
    distance[edge.cell] = edge.distance_px
    first, second = edge.flat_regions
    for region, sign in ((first, -1), (second, 1)):
        assert np.ptp(cube[region], axis=(0, 1)).max() == 0.0
        assert distance[region].size >= 900
        assert (sign * distance[region]).min() > 8
    assert not np.array_equal(cube[first][0, 0], cube[second][0, 0])


def test_the_luminance_edge_has_the_contrast_4_to_1():
    dark, bright = xyz_of(sides_of("luminance"))[:, 1]
    assert bright / dark == pytest.approx(4.0, rel=1e-5)


def test_the_color_edge_has_equal_luminance_and_infrared_but_another_hue():
    sides = sides_of("color")
    red, green = xyz_of(sides)
    assert red[1] == pytest.approx(green[1], rel=1e-5)
    assert red[0] / green[0] > 2
    assert at(sides, 800)[0] == pytest.approx(at(sides, 800)[1], abs=1e-4)


@pytest.mark.parametrize(("illuminant", "tolerance"), [("E", 1e-6), ("6500K", 2e-4), ("A", 6e-4)])
def test_the_infrared_edge_has_equal_xyz_on_both_sides_but_other_electrons(illuminant, tolerance):
    sides = sides_of("infrared")
    first, second = xyz_of(sides, illuminant)
    assert second == pytest.approx(first, rel=tolerance)
    scene = scene_of(sides, illuminant)
    one, other = expected_electrons(scene, resolve_sensor("onyx-rgbw"), Exposure(time_s=0.012))
    assert (other > 1.2 * one).all()
    assert np.abs(np.diff(sides, axis=0))[0, WAVELENGTH <= 680].max() < 1e-3


# ---- foliage ----


def test_leaves_have_a_red_edge_and_black_cotton_is_bright_in_the_infrared():
    curves = foliage_reflectances()
    assert at(curves["leaf"], 550) > at(curves["leaf"], 670)  # green
    steepest = {n: WAVELENGTH[np.diff(curves[n]).argmax()] for n in ("leaf", "young leaf")}
    assert 690 <= steepest["young leaf"] < steepest["leaf"] <= 730
    assert at(curves["black cotton"], 550) < at(curves["soil"], 550)
    assert at(curves["black cotton"], 850) > at(curves["leaf"], 850) > 2 * at(curves["soil"], 850)


@pytest.mark.parametrize("material", ["leaf", "young leaf", "dry leaf", "black cotton", "skin"])
def test_the_foliage_shows_its_materials(material):
    # the ratio of two bands does not depend on the illumination
    assert seen_in_foliage(material).mean() > 0.05


def test_the_leaves_are_darker_toward_the_last_corner():
    infrared = at(stored("builtin:foliage"), 850)
    leaves = seen_in_foliage("leaf")
    from_first = np.add.outer(np.arange(256), np.arange(256))
    bright, dark = leaves & (from_first < 200), leaves & (from_first > 312)
    assert np.median(infrared[bright]) > 1.4 * np.median(infrared[dark])


def seen_in_foliage(material):
    cube = stored("builtin:foliage").astype(float)
    curve = foliage_reflectances()[material]
    ratio = at(cube, 850) / at(cube, 650) / (at(curve, 850) / at(curve, 650))
    return np.abs(ratio - 1.0) < 1e-3
