"""Pictures of a sensor whose crosstalk follows counting: drawn counts mix, then readout follows."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from chromanoise.color import colored, kernel_matrix
from chromanoise.imaging import DEMOSAICING, Work, acquired, developed, developed_color, rendered
from chromanoise.imaging.capture import CaptureSettings, camera_for
from chromanoise.noise import Exposure, expected_electrons, with_noise
from chromanoise.sensor import (
    Adc,
    Crosstalk,
    PixelOverrides,
    bayer,
    crosstalk_of_kernel,
    mosaic_named,
    with_crosstalk,
    with_pixel,
)
from chromanoise.spectra import DEFAULT_GRID, Cube, equal_energy, flat_field
from chromanoise.study import sensor_named
from outcomes import same_bits
from strategies import flat_cube, point_of

LAMP = equal_energy(DEFAULT_GRID)
EXPOSURE = Exposure(time_s=0.002)
in_use = partial(point_of, exposure=EXPOSURE)
AT = DEFAULT_GRID.wavelength_nm
NAMES = ("R", "G", "B")
KERNEL = np.array([[0.0, 0.08, 0.0], [0.1, 0.66, 0.04], [0.0, 0.06, 0.02]])  # 4 % are lost
FINE = Adc(bits=16, gain_e_per_dn=0.05, black_level_dn=2000)
NOISE = {"prnu": 0.05, "dsnu_e": 3.0, "dark_current_e_per_s": 20_000.0, "read_noise_e": 4.0}


def pure(**pixel):
    changes = {"full_well_e": 1e5, **pixel}
    return replace(with_pixel(sensor_named("model-rgb-ircut", DEFAULT_GRID), changes), mosaic=None)


def coupled(kernel=KERNEL, **pixel):
    mixing = replace(crosstalk_of_kernel(kernel, bayer(), NAMES), stage="charge")
    return with_crosstalk(pure(**pixel), mixing)


def flat(size, width=None):
    return flat_cube(AT, 0.5, height=size, width=width or size)


def seen_by(sensor):
    gray = flat_field(LAMP, level_lux=10.0, reflectance=0.5)
    return with_noise(expected_electrons(gray, sensor, EXPOSURE), sensor, EXPOSURE)


def codes_of(sensor, cube, **more):
    return acquired(cube, in_use(sensor), mosaic=bayer(), adc=FINE, seed=4, **more).codes


def test_readings_of_a_mosaic_have_the_covariance_of_mixed_counts():
    """Of a period of 4 x 4 pixels, whose mixing is written as one matrix."""
    side, batches = 4, 16
    tile = np.array([[0, 1], [1, 2]])
    channel = np.tile(tile, (2, 2)).ravel()
    mixing = np.zeros((16, 16))
    for y, x, dy, dx in np.ndindex(4, 4, 3, 3):
        mixing[4 * y + x, 4 * ((y - dy + 1) % 4) + (x - dx + 1) % 4] += KERNEL[dy, dx]
    inside = with_noise(
        seen_by(pure(**NOISE)).mean, pure(**{**NOISE, "read_noise_e": 0.0}), EXPOSURE
    ).variance
    expected = mixing @ np.diag(inside[channel]) @ mixing.T + (16.0 + 0.05**2 / 12) * np.eye(16)
    found, means = [], []
    for frame in range(batches):  # PRNU differs in each because the part of the picture does
        sensor = replace(coupled(**NOISE), name=f"camera {frame}")
        codes = codes_of(sensor, flat(128)).astype(float)
        electrons = (codes - 2000) * 0.05
        blocks = electrons.reshape(32, side, 32, side).transpose(0, 2, 1, 3)[1:-1, 1:-1]
        blocks = blocks.reshape(-1, 16)
        means.append(blocks.mean(axis=0))
        found.append(np.cov(blocks.T))
    own = mixing @ seen_by(pure(**NOISE)).mean[channel]
    inner = np.array([5, 6, 9, 10])  # all of their neighbors lie in the block
    for values, told in ((np.array(means), own), (np.array(found), expected)):
        mean, error = values.mean(axis=0), values.std(axis=0, ddof=1) / np.sqrt(batches)
        z = (mean - told) / error
        assert np.abs(z[np.ix_(*[inner] * told.ndim)]).max() < 5
    assert expected[5, 6] > 0.1 * expected[5, 5]  # neighbors are correlated


@pytest.mark.parametrize(
    ("source", "shared"),
    [
        ({"column_noise_e": 30.0}, True),
        ({"rtn_share": 0.2, "rtn_amplitude_e": 60.0}, False),
        ({"reset_capacitance_ff": 8.0}, False),
    ],
    ids=str,
)
def test_readings_have_what_the_readout_adds_after_crosstalk(source, shared):
    sensor, frames, side = coupled(**source), 6, 256
    codes = [codes_of(sensor, flat(side), frame=frame) for frame in range(frames)]
    electrons = 0.05 * (np.array(codes, dtype=float) - 2000)
    expected = seen_by(sensor).reading_variance + 0.05**2 / 12
    draws = frames * (side / 2 if shared else side**2 / 4)
    assert expected[0] > 2 * seen_by(coupled()).reading_variance[0]
    for (row, column), channel in (((0, 0), 0), ((0, 1), 1), ((1, 1), 2)):
        values = electrons[:, row::2, column::2]
        variance = ((values - seen_by(sensor).mean[channel]) ** 2).mean()
        assert variance == pytest.approx(expected[channel], rel=5 * np.sqrt(2 / draws))


def test_colors_have_the_covariance_of_readings_that_a_matrix_correlates():
    sensor = coupled(**NOISE)
    picture = rendered(flat(512), in_use(sensor), seed=9)
    color = colored(seen_by(sensor), kernel_matrix(sensor, EXPOSURE))
    scale = 0.5 / color.mean[1]  # Y = 1 for a white
    parts = picture.xyz.reshape(64, -1, 3).astype(float)
    for values, told in (
        (parts.mean(axis=1), color.mean * scale),
        (np.stack([np.cov(part.T) for part in parts]), color.covariance * scale**2),
    ):
        error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
        assert np.abs((values.mean(axis=0) - told) / error).max() < 4.5
    assert picture.mean_e == pytest.approx(seen_by(sensor).mean, rel=1e-4)


def test_a_kernel_that_moves_nothing_leaves_each_pixel_as_it_is():
    """Below .75 e- of read noise, counts and readout are drawn apart without crosstalk too."""
    noise = {**NOISE, "read_noise_e": 0.5, "row_noise_e": 2.0, "black_error_e": 3.0}
    same = coupled(np.array([[0.0, 0, 0], [0, 1.0, 0], [0, 0, 0]]), **noise)
    before, after = (codes_of(one, flat(64)).astype(int) for one in (pure(**noise), same))
    assert (np.abs(before - after) <= 1).mean() > 0.999  # rounding of the expected electrons
    one, two = (rendered(flat(64), in_use(each), seed=4).xyz for each in (pure(**noise), same))
    assert (np.abs(one - two) < 1e-4).mean() > 0.999


@pytest.mark.parametrize("pattern", ["RG/GB", "RGB/GBR"])
def test_without_noise_a_flat_picture_repeats_its_mosaic_up_to_its_edges(pattern):
    mosaic = mosaic_named(pattern)
    mixing = replace(crosstalk_of_kernel(KERNEL, mosaic, NAMES), stage="charge")
    sensor = with_crosstalk(pure(read_noise_e=0.0), mixing)
    found = acquired(flat(18), in_use(sensor), mosaic=mosaic, adc=FINE, noisy=False)
    assert found.mean_e == pytest.approx(seen_by(sensor).mean, rel=1e-5)
    np.testing.assert_array_equal(found.codes, np.tile(found.codes[6:12, 6:12], (3, 3)))


def test_the_electrons_of_one_bright_pixel_end_where_the_kernel_says():
    light = np.zeros((9, 9, AT.size), np.float32)
    light[4, 3] = 1.0
    cube = Cube(stored=light, scale=1.0, wavelength_nm=AT, source="one pixel")
    found = codes_of(coupled(read_noise_e=0.0), cube, noisy=False)
    here = found[3:6, 2:5] - 2000.0
    white = flat_field(LAMP, level_lux=10.0)
    green = expected_electrons(white, pure(), EXPOSURE)[1] / 0.05
    assert here == pytest.approx(green * KERNEL, abs=0.51)
    assert (found != 2000).sum() == (KERNEL > 0).sum()


@pytest.mark.parametrize("mosaic", ["bayer", "RGB/GBR"])
def test_codes_and_colors_are_the_same_for_any_threads_tiles_and_executor(mosaic):
    rng = np.random.default_rng(3)
    reflectance = rng.uniform(0, 1, (37, 23, AT.size))
    cube = Cube(stored=reflectance.astype(np.float32), scale=1.0, wavelength_nm=AT, source="random")
    pattern = mosaic_named(mosaic)
    mixing = replace(crosstalk_of_kernel(KERNEL, pattern, NAMES), stage="charge")
    point = in_use(with_crosstalk(pure(**NOISE, row_noise_e=2.0), mixing))
    with ThreadPoolExecutor(2) as pool:
        works = [
            Work(threads=1, tile_rows=37),
            Work(threads=2, tile_rows=1),
            Work(threads=1, tile_rows=5),
            Work(executor=pool, tile_rows=7),
        ]
        taken = [acquired(cube, point, mosaic=pattern, adc=FINE, work=work) for work in works]
        painted = [rendered(cube, point, work=work) for work in works]
    for code, color in zip(taken[1:], painted[1:], strict=True):
        assert same_bits(code, taken[0])
        np.testing.assert_array_equal(color.xyz, painted[0].xyz)


@pytest.mark.parametrize(("known", "raw"), [(True, True), (False, True), (False, False)])
def test_only_codes_of_a_matrix_without_neighbors_are_told_to_be_mixed_before_counting(known, raw):
    sensor = coupled()
    if not known:
        mixing = Crosstalk(matrix=sensor.crosstalk.matrix, pixels=(1, 2, 1), stage="charge")
        sensor = with_crosstalk(pure(), mixing)
    asked = CaptureSettings(
        mosaic=bayer(), raw=raw, demosaic=None, pixel=PixelOverrides(), seed=0, clip=False,
        beyond="refuse", bad_pixels="refuse", formats=None,
    )  # fmt: skip
    point = in_use(sensor)
    matrix = kernel_matrix(sensor, EXPOSURE)
    camera = camera_for(flat(8), point, matrix, asked)
    notes = [note for note in camera.operating_point.sensor.notes if "before counting" in note]
    assert len(notes) == (raw and not known)


@pytest.mark.parametrize("method", ["bilinear", "malvar"])
def test_the_noise_of_a_demosaicked_picture_is_that_of_its_counts_and_readout(method):
    sensor, matrix = coupled(**NOISE), kernel_matrix(coupled(), EXPOSURE)
    bank = DEMOSAICING[method](bayer(), in_use(sensor))
    gray = flat_field(LAMP, level_lux=10.0, reflectance=0.5)
    told = developed_color(gray, in_use(sensor), bank, FINE, matrix=matrix)
    white = matrix.matrix @ (2 * seen_by(sensor).mean)
    found = []
    for number in range(12):
        one = replace(sensor, name=f"camera {number}")
        raw = acquired(flat(128), in_use(one), mosaic=bayer(), adc=FINE, seed=number)
        xyz = developed(raw, bank, matrix=matrix).xyz[8:-8, 8:-8] * white[1]
        found.append([[np.cov(xyz[a::2, b::2].reshape(-1, 3).T) for b in (0, 1)] for a in (0, 1)])
    error = np.std(found, axis=0, ddof=1) / np.sqrt(12)
    expected = np.array([[each.covariance for each in row] for row in told])
    assert np.abs((np.mean(found, axis=0) - expected) / error).max() < 6  # Student's t of 12
