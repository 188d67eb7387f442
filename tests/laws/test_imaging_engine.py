"""The compiled way of a cube against plain numpy, bit by bit where bits are promised."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from chromanoise.color import kernel_matrix
from chromanoise.imaging import (
    Work,
    acquired,
    bilinear_filters,
    developed,
    developed_color,
    electrons_of_cube,
    gradient_corrected_filters,
    lmmse_filters,
    noisy_electrons,
    picture_prior,
    rendered,
)
from chromanoise.imaging.blocks import flattened
from chromanoise.imaging.plans import draw_of
from chromanoise.noise import (
    Exposure,
    Readout,
    band_weights,
    expected_electrons,
    read_moments,
    white_scene,
)
from chromanoise.sensor import Adc, Mosaic, adc_to_full_well, bayer, rgbw_sparse_4x4
from chromanoise.spectra import Cube, cie_a, flat_field
from chromanoise.spectra.scene_rows import PaletteRows
from outcomes import refused_input, same_bits
from strategies import GRID, bell_qe, flat_cube, pixel_with, point_of, sensor_of, with_pixel_of

LAMP = cie_a(GRID)


def sensor_with(channels, read_noise_e=5.0, full_well_e=1e6):
    centers = np.linspace(430, 670, channels)
    qe = bell_qe(centers, np.full(channels, 35.0), np.full(channels, 0.6))
    names = tuple("RGBWCMYKVO"[:channels])
    return sensor_of(
        qe, names=names, pixel=pixel_with(read_noise_e, full_well_e=full_well_e), name="toy"
    )


def used(channels=3, time_s=0.02, level_lux=10.0, **pixel):
    sensor = sensor_with(channels, **pixel)
    return point_of(sensor, level_lux, exposure=Exposure(time_s=time_s), illuminant=LAMP)


def stored(height=7, width=300, dtype=np.float32):
    rho = np.random.default_rng(1).uniform(0.02, 0.98, (height, width, GRID.n))
    if np.issubdtype(dtype, np.integer):
        return np.round(rho * 10_000).astype(dtype), 1e-4
    return rho.astype(dtype), 1.0


LAYOUTS = {
    "bands together": lambda x: np.ascontiguousarray(x),
    "pixels of a row together": lambda x: np.ascontiguousarray(x.transpose(0, 2, 1)).transpose(
        0, 2, 1
    ),
    "pixels of a band together": lambda x: np.ascontiguousarray(x.transpose(2, 0, 1)).transpose(
        1, 2, 0
    ),
    "every second of more bands": lambda x: np.repeat(x, 2, axis=2)[:, :, ::2],
    "bands backwards": lambda x: np.ascontiguousarray(x[:, :, ::-1])[:, :, ::-1],
    "other byte order": lambda x: x.astype(x.dtype.newbyteorder()),
    "part of the columns": lambda x: np.concatenate([x, x], axis=1)[:, : x.shape[1]],
}


def cube_of(array, scale=1.0):
    return Cube(wavelength_nm=GRID.wavelength_nm, stored=array, scale=scale, source="a cube")


both_orders = pytest.mark.parametrize("layout", ["bands together", "pixels of a band together"])


def white_e(operating_point):
    """Electrons of a perfect white."""
    white = white_scene(operating_point)
    return expected_electrons(white, operating_point.sensor, operating_point.exposure)


def electrons_by_numpy(cube, operating_point):
    weights, _ = band_weights(
        cube, white_scene(operating_point), operating_point.sensor, operating_point.exposure
    )
    return np.asarray(cube.stored, dtype=np.float64) @ (weights * cube.scale)


@pytest.mark.evidence
@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("channels", [1, 3, 5, 8])
def test_electrons_are_those_of_a_product_in_float64_however_the_cube_lies(layout, channels):
    array, scale = stored()
    operating_point = used(channels)
    cube = cube_of(LAYOUTS[layout](array), scale)
    expected = electrons_by_numpy(cube_of(array, scale), operating_point)
    assert electrons_of_cube(cube, operating_point) == pytest.approx(expected, rel=2e-6)


@pytest.mark.parametrize(
    "dtype",
    ["u2", "i8", "f2", "f4", "f8"]  # the first read of a type compiles for seconds
    + [pytest.param(rare, marks=pytest.mark.evidence) for rare in ("u1", "i1", "i2", "i4", "u4")],
)
def test_numbers_of_every_type_are_read_as_they_are(dtype):
    array, scale = stored(dtype=np.dtype("f8"))
    if np.dtype(dtype).kind in "iu":
        scale = 1 / 120
        array = np.round(array * 120)
    array = array.astype(dtype)
    operating_point = used()
    expected = electrons_by_numpy(cube_of(array, scale), operating_point)
    for name in ("bands together", "pixels of a band together"):
        cube = cube_of(LAYOUTS[name](array), scale)
        assert electrons_of_cube(cube, operating_point) == pytest.approx(expected, rel=2e-6)


@pytest.mark.parametrize("channels", [3, 4, 5])
def test_the_color_picture_is_its_noisy_electrons_times_the_matrix(channels):
    cube, operating_point = cube_of(stored()[0]), used(channels)
    matrix = kernel_matrix(operating_point.sensor, operating_point.exposure)
    picture = rendered(cube, operating_point, seed=11, frame=3)
    noisy = noisy_electrons(
        electrons_of_cube(cube, operating_point),
        read_noise_e=operating_point.sensor.pixel.read_noise_e,
        seed=int(draw_of(operating_point, seed=11).key),
        frame=3,
    ).astype(float)
    white = matrix.matrix @ white_e(operating_point)
    expected = noisy @ (matrix.matrix / white[1]).T
    assert picture.xyz == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())


def test_the_picture_without_noise_is_the_float64_picture():
    cube, operating_point = cube_of(stored()[0]), used()
    matrix = kernel_matrix(operating_point.sensor, operating_point.exposure).matrix
    white = matrix @ white_e(operating_point)
    expected = electrons_by_numpy(cube, operating_point) @ (matrix / white[1]).T
    assert rendered(cube, operating_point, noisy=False).xyz == pytest.approx(expected, abs=3e-6)


TILES = {
    "bayer": bayer(),
    "three by two": Mosaic((("R", "G", "B"), ("B", "R", "R"))),
    "odd": Mosaic((("R", "G", "B", "G", "R"),)),
    "seven channels": Mosaic((tuple("RGBWC"), tuple("MYRGB"))),
}


@pytest.mark.parametrize("tile", TILES)
@both_orders
def test_each_pixel_of_the_mosaic_has_the_noise_that_its_channel_has_there(tile, layout):
    """Bit by bit: numpy picks the channel from the full picture and converts."""
    cube = cube_of(LAYOUTS[layout](stored()[0]))
    channels = 7 if tile == "seven channels" else 3
    operating_point, mosaic = used(channels, full_well_e=1800.0), TILES[tile]
    adc = Adc(bits=10, gain_e_per_dn=2.6, black_level_dn=64)
    raw = acquired(cube, operating_point, mosaic=mosaic, adc=adc, seed=5, frame=1)
    noisy = noisy_electrons(
        electrons_of_cube(cube, operating_point),
        read_noise_e=operating_point.sensor.pixel.read_noise_e,
        seed=int(draw_of(operating_point, seed=5).key),
        frame=1,
    )
    names = operating_point.sensor.names
    pattern = np.array([[names.index(name) for name in row] for row in mosaic.pattern])
    height, width, _ = noisy.shape
    over = np.tile(pattern, (height, width))[:height, :width]
    own = np.take_along_axis(noisy, over[..., None], axis=2)[..., 0]
    scaled = np.minimum(own, np.float32(1800)) * np.float32(1 / 2.6) + np.float32(64)
    expected = np.clip(np.floor(scaled + np.float32(0.5)), 0, 1023)
    assert (raw.codes == expected).all()
    full = 64 + round(1800 / 2.6)
    for c in range(channels):  # held values tell nothing of noise
        assert (raw.codes[over == c] < full).any()
    above = [(own > 1800)[over == c].mean() for c in range(channels)]
    assert raw.above_full_well == pytest.approx(above)


@pytest.mark.parametrize(("tile_rows", "threads"), [(1, 1), (3, 2), (1000, 4)])
def test_neither_tiles_nor_threads_change_a_bit_of_the_mosaic(tile_rows, threads):
    cube, operating_point = cube_of(stored(40)[0]), used()
    more = {"dark_current_e_per_s": 100.0, "dsnu_e": 3.0, "prnu": 0.01, "row_noise_e": 2.0}
    operating_point = with_pixel_of(operating_point, **more)
    asked = {"mosaic": bayer(), "seed": 2}
    whole = acquired(cube, operating_point, **asked)
    tiled = acquired(
        cube, operating_point, **asked, work=Work(tile_rows=tile_rows, threads=threads)
    )
    assert same_bits(whole, tiled)


def test_the_top_code_is_the_largest_that_the_bits_hold_and_nothing_wraps():
    cube = flat_cube(GRID.wavelength_nm, 1.0, height=20, width=20)
    for bits in (8, 12, 16):
        operating_point = used(1, level_lux=1e7, full_well_e=5000.0)
        adc = adc_to_full_well(operating_point.sensor.pixel, bits=bits)
        raw = acquired(cube, operating_point, mosaic=Mosaic((("R",),)), adc=adc)
        assert (raw.codes == 2**bits - 1).all()
        assert raw.above_full_well == pytest.approx([1.0])


@pytest.mark.parametrize("level_lux", [0.02, 1.0, 30.0])
def test_codes_of_a_flat_field_scatter_as_the_exact_moments_say(level_lux):
    """From the dark, where black holds, to full well, where the top code does."""
    operating_point = used(1, level_lux=level_lux, full_well_e=2000.0)
    adc = adc_to_full_well(operating_point.sensor.pixel, bits=8)
    cube = flat_cube(GRID.wavelength_nm, 0.8, height=300, width=300)
    raw = acquired(cube, operating_point, mosaic=Mosaic((("R",),)), adc=adc, seed=4)
    moments = read_moments(
        np.array([raw.mean_e[0]]),
        read_noise_e=5.0,
        readout=Readout(black_e=0.0, full_well_e=2000.0, step_e=adc.gain_e_per_dn),
    )
    electrons = raw.codes.astype(float).ravel() * adc.gain_e_per_dn
    count = electrons.size
    mean, variance = float(moments.mean[0]), float(moments.variance[0])
    spread = electrons - electrons.mean()
    se_variance = np.sqrt(max((spread**4).mean() - (spread**2).mean() ** 2, 1e-12) / count)
    assert abs(electrons.mean() - mean) < 5 * np.sqrt(variance / count) + 1e-4
    assert abs((spread**2).mean() - variance) < 5 * se_variance + 1e-4


@pytest.mark.parametrize("value", [np.nan, -0.1, 3.0, np.inf])
@both_orders
@pytest.mark.parametrize("make", [rendered, acquired, electrons_of_cube])
def test_a_number_that_is_no_reflectance_is_refused_with_its_place(value, layout, make):
    array, _ = stored()
    array[5, 299, -1] = value
    cube = cube_of(LAYOUTS[layout](array))
    more = {"mosaic": bayer()} if make is acquired else {}
    with refused_input(subject=cube.source) as caught:
        make(cube, used(), **more)
    assert caught.value.where.startswith("row 5, column 299 ")
    assert caught.value.value == pytest.approx(value, nan_ok=True)


@pytest.mark.parametrize(("named", "value"), [("seed", -1), ("seed", 1 << 32), ("frame", -1)])
def test_numbers_that_make_no_sense_are_refused(named, value):
    with refused_input(subject=named, value=value):
        rendered(cube_of(stored(2)[0]), used(), **{named: value})


@pytest.mark.parametrize("named", ["threads", "tile_rows"])
def test_work_for_nobody_or_on_nothing_is_refused(named):
    with refused_input(subject=named, value=0):
        Work(**{named: 0})


def test_a_sensor_without_a_mosaic_asks_for_one():
    with refused_input(subject="mosaic", setting="mosaic"):
        acquired(cube_of(stored(2)[0]), used())


def test_progress_tells_every_row_once():
    rows = []
    rendered(cube_of(stored(40)[0]), used(), work=Work(tile_rows=7, progress=rows.append))
    assert sum(rows) == 40


@pytest.mark.parametrize("made", ["bilinear", "gradient", "lmmse"])
@pytest.mark.parametrize("tile", ["bayer", "sparse"])
def test_noise_of_the_developed_picture_is_what_the_closed_form_predicts(made, tile):
    """A flat field through mosaic, converter, demosaicing and matrix, place by place."""
    channels, mosaic = (3, bayer()) if tile == "bayer" else (4, rgbw_sparse_4x4())
    operating_point = used(channels, level_lux=10.0)
    names = operating_point.sensor.names
    scene = flat_field(LAMP, level_lux=10.0, reflectance=0.5)
    electrons = expected_electrons(scene, operating_point.sensor, operating_point.exposure)
    prior = picture_prior(
        np.outer([0.2, 0.5, 0.9], electrons) * np.linspace(0.7, 1.3, channels) ** [[1], [0], [-1]],
        names,
        noise_e2=electrons + 25.0,
    )
    bank = {
        "bilinear": lambda: bilinear_filters(mosaic, names),
        "gradient": lambda: gradient_corrected_filters(mosaic, names, prior),
        "lmmse": lambda: lmmse_filters(mosaic, prior),
    }[made]()
    adc = Adc(bits=16, gain_e_per_dn=3.0, black_level_dn=500)
    cube = flat_cube(GRID.wavelength_nm, 0.5, height=240, width=240)
    raw = acquired(cube, operating_point, mosaic=mosaic, adc=adc, seed=6)
    picture = developed(raw, bank)
    matrix = kernel_matrix(operating_point.sensor, operating_point.exposure).matrix
    white = float((matrix @ white_e(operating_point))[1])
    predicted = developed_color(scene, operating_point, bank, adc)
    longest = max(mosaic.shape)
    step = (2 * bank.radius // longest + 1) * longest  # so far apart, no two share a raw pixel
    for i, j in np.ndindex(mosaic.shape):
        pixels = picture.xyz[i::step, j::step].reshape(-1, 3).astype(float) * white
        exact, count = predicted[i][j], len(pixels)
        z_mean = (pixels.mean(axis=0) - exact.mean) / np.sqrt(exact.variance / count)
        ratio = pixels.var(axis=0, ddof=1) / exact.variance
        # the mirrored border repeats pixels, which costs a little of the independence
        assert np.abs(z_mean).max() < 5
        assert np.abs(ratio - 1).max() < 5 * np.sqrt(2 / count) + 0.05


@pytest.mark.parametrize("own", [{}, {"gain_e_per_dn": 3.0}, {"bits": 8}])
def test_the_rounding_of_codes_counts_once_also_if_the_sensor_has_its_own_converter(own):
    """Steps below the noise of 20 e-: M + 20^2 + q^2 / 12, through bilinear weights."""
    point = with_pixel_of(used(3, level_lux=10.0), read_noise_e=20.0, **own)
    names = point.sensor.names
    scene = flat_field(LAMP, level_lux=10.0, reflectance=0.5)
    adc = Adc(bits=12, gain_e_per_dn=10.0)
    bank = bilinear_filters(bayer(), names)
    matrix = kernel_matrix(point.sensor, point.exposure)
    electrons = expected_electrons(scene, point.sensor, point.exposure)
    place = developed_color(scene, point, bank, adc, matrix=matrix)[0][0]
    raw_e2 = electrons + 20.0**2 + 10.0**2 / 12
    weights = bank.kernels[0, 0]  # of the neighbors of each channel, which are independent
    noise_e2 = np.array([(k**2).sum() for k in weights]) * raw_e2
    expected = np.einsum("ci,i,ci->c", matrix.matrix, noise_e2, matrix.matrix)
    assert place.variance == pytest.approx(expected, rel=1e-12)


def test_a_processor_pool_makes_the_same_bits():
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        for cube in (cube_of(stored(40)[0]), of_few_spectra()[0]):
            here, there = (
                acquired(cube, used(), mosaic=bayer(), seed=2, work=work)
                for work in (Work(), Work(executor=pool, tile_rows=6))
            )
            assert same_bits(here, there)


def test_filters_of_another_mosaic_are_refused():
    operating_point = used()
    raw = acquired(cube_of(stored(8)[0]), operating_point, mosaic=bayer())
    other = Mosaic((("G", "R"), ("B", "G")))
    with refused_input(subject="filters", value=other.pattern):
        developed(raw, bilinear_filters(other, operating_point.sensor.names))


ODD_LAYOUTS = LAYOUTS | {
    "rows backwards": lambda x: np.ascontiguousarray(x[::-1])[::-1],
    "bands apart, columns backwards": lambda x: np.ascontiguousarray(
        x.transpose(2, 0, 1)[:, :, ::-1]
    ).transpose(1, 2, 0)[:, ::-1],
    "every second column": lambda x: np.repeat(x, 2, axis=1)[:, ::2],
}


@pytest.mark.parametrize("layout", ODD_LAYOUTS)
@pytest.mark.parametrize("width", [1, 37])
def test_no_bit_depends_on_blocks_however_the_cube_lies(layout, width):
    operating_point = used()
    cube = cube_of(ODD_LAYOUTS[layout](stored(23, width)[0]))
    whole = electrons_of_cube(cube, operating_point)
    for tile_rows in (1, 2, 5):
        tiled = electrons_of_cube(cube, operating_point, work=Work(tile_rows=tile_rows, threads=2))
        assert (tiled == whole).all()


@both_orders
@pytest.mark.parametrize(("height", "width"), [(9, 1500), (2, 4101)])
def test_rows_that_share_a_tile_and_rows_of_several_tiles_are_like_any_other(height, width, layout):
    operating_point, mosaic = used(5), TILES["odd"]
    cube = cube_of(LAYOUTS[layout](stored(height, width)[0]))
    expected = electrons_by_numpy(cube, operating_point)
    assert electrons_of_cube(cube, operating_point) == pytest.approx(expected, rel=2e-6)
    operating_point = with_pixel_of(operating_point, row_noise_e=4.0, prnu=0.01)
    asked = {"seed": 3}
    row_by_row = Work(tile_rows=1, threads=1)
    for make in (rendered, partial(acquired, mosaic=mosaic)):
        whole, rows = (make(cube, operating_point, work=w, **asked) for w in (Work(), row_by_row))
        assert whole.mean_e == pytest.approx(rows.mean_e, rel=1e-12)
        assert same_bits(replace(whole, mean_e=rows.mean_e), rows)
        if make is rendered:
            assert whole.mean_e == pytest.approx(expected.mean(axis=(0, 1)), rel=1e-6)


def spread_of(**strengths):
    """Electrons of three channels at every pixel, told by their own matrix: X is R ..."""
    operating_point = used(3, level_lux=100.0, read_noise_e=0.0)
    matrix = replace(
        kernel_matrix(operating_point.sensor, operating_point.exposure), matrix=np.eye(3)
    )
    cube = flat_cube(GRID.wavelength_nm, 0.5, height=150, width=150)
    picture = rendered(
        cube,
        with_pixel_of(operating_point, **strengths),
        matrix=matrix,
        noisy=False,
    )
    return picture.xyz.astype(float) * white_e(operating_point)[1], picture.mean_e


@pytest.mark.parametrize("strengths", [{"prnu": 0.02}, {"dsnu_e": 30.0}])
def test_pixels_of_a_picture_differ_in_each_channel_for_itself(strengths):
    electrons, mean = spread_of(**strengths)
    pixels = electrons.reshape(-1, 3)
    expected = mean * strengths["prnu"] if "prnu" in strengths else np.full(3, 30.0)
    assert pixels.std(axis=0) == pytest.approx(expected, rel=5 / np.sqrt(2 * len(pixels)))
    others = np.corrcoef(pixels.T)[np.triu_indices(3, 1)]
    assert np.abs(others).max() < 5 / np.sqrt(len(pixels))


def test_the_channels_of_a_picture_share_the_noise_of_their_row():
    electrons, _ = spread_of(row_noise_e=40.0)
    rows = electrons - electrons.mean(axis=(0, 1))
    assert np.abs(rows - rows[:, :1, :1]).max() < 1e-2
    assert rows[:, 0, 0].std() == pytest.approx(40.0, rel=5 / np.sqrt(2 * 150))


@both_orders
@pytest.mark.parametrize("make", [rendered, acquired])
def test_bad_pixels_are_taken_as_black_and_counted_where_that_is_asked(layout, make):
    array, _ = stored()
    broken = array.copy()
    broken[2, 5, 3], broken[2, 5, 4], broken[6, 7, 0] = np.nan, -1.0, 9.0
    mended = array.copy()
    mended[2, 5, 3:5], mended[6, 7, 0] = 0.0, 0.0
    more = {"mosaic": bayer()} if make is acquired else {}
    got, expected = (
        make(cube_of(LAYOUTS[layout](cube)), used(), bad_pixels="zero", seed=1, **more)
        for cube in (broken, mended)
    )
    assert same_bits(got, expected)
    assert any("2 pixels held what is no reflectance" in note for note in got.notes)
    assert not any("no reflectance" in note for note in expected.notes)


def of_few_spectra(value=0.5):
    """A cube that has an index for each pixel, and the same with all its numbers."""
    spectra = stored(1, 40)[0][0]
    spectra[7, 3] = value
    index = np.random.default_rng(2).integers(0, 40, (9, 300))
    return cube_of(PaletteRows(palette=spectra, index=index)), cube_of(spectra[index])


@pytest.mark.parametrize(
    ("make", "channels", "more"),
    [
        (rendered, 3, {"clip": True}),
        (rendered, 4, {"seed": 1}),
        (rendered, 5, {"noisy": False, "work": Work(threads=2, tile_rows=4)}),
        (rendered, 3, {"work": Work(threads=2, tile_rows=4)}),
        (acquired, 3, {"mosaic": bayer(), "seed": 2}),
        (electrons_of_cube, 1, {}),
        (electrons_of_cube, 5, {}),
    ],
)
def test_a_scene_of_few_spectra_has_the_bits_of_its_pixels(make, channels, more):
    few, whole = (make(cube, used(channels), **more) for cube in of_few_spectra())
    assert same_bits(few, whole)
    assert make is electrons_of_cube or few.notes == whole.notes


def test_a_scene_of_few_spectra_is_refused_or_mended_like_its_pixels():
    where = []
    for cube in of_few_spectra(np.nan):
        with refused_input(subject=cube.source) as caught:
            rendered(cube, used())
        where.append(caught.value.where)
    assert where[0] == where[1]
    few, whole = (rendered(cube, used(), bad_pixels="zero") for cube in of_few_spectra(np.nan))
    assert same_bits(few, whole)
    assert few.notes == whole.notes
    assert "no reflectance" in few.notes[-1]


@pytest.mark.parametrize("width", [1, 3, 4])
def test_a_bad_pixel_gives_no_electrons_and_its_neighbors_give_theirs(width):
    """A picture as wide as counts have columns is still a picture."""
    broken, mended = stored(width=width)[0], stored(width=width)[0]
    broken[2, 0, 3], mended[2, 0, 3] = np.nan, 0.0
    got = electrons_of_cube(cube_of(broken), used(), bad_pixels="zero")
    assert (got == electrons_of_cube(cube_of(mended), used())).all()


@pytest.mark.parametrize("columns", [1, 7, 40])
@pytest.mark.parametrize("bands", [1, 5])
def test_a_view_is_read_as_it_lies(columns, bands):
    """A part of the bands of a part of the pixels: what lies between belongs to others."""
    whole = np.arange(4 * 50 * 9, dtype=np.float32).reshape(4, 50, 9)
    view = whole[1:3, 2 : 2 + columns, 3 : 3 + bands]
    for planar in (False, True):
        flat, (result, row, pixel, band) = flattened(view, planar=planar)
        assert result == bands
        read = [
            [[flat[r * row + c * pixel + b * band] for b in range(bands)] for c in range(columns)]
            for r in range(2)
        ]
        assert (np.array(read) == view).all()


def test_more_light_than_can_be_counted_is_refused():
    cube = flat_cube(GRID.wavelength_nm, 0.5, height=2, width=2)
    bright = with_pixel_of(used(3, 1e12, 1e15), pitch_um=1e6, full_well_e=1e12)
    with refused_input(subject="electrons per number of a flat cube"):
        rendered(cube, bright)
