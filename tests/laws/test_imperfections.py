"""What real pixels add: PRNU, DSNU, row noise and dark current."""

import numpy as np
import pytest

from chromanoise.imaging import acquired, rendered
from chromanoise.noise import Exposure
from chromanoise.sensor import Adc, Mosaic, bayer
from chromanoise.spectra import Cube, cie_a
from goodness import correlation_z
from outcomes import refused_input
from strategies import GRID, bell_qe, flat_cube, pixel_with, point_of, sensor_of, with_pixel_of

RED_ONLY = Mosaic((("R",),))


def used(channels=3, *, level_lux=10.0, read_noise_e=5.0, full_well_e=1e6):
    """A toy of this many channels, 20 ms in the light of a lamp."""
    qe = bell_qe(np.linspace(430, 670, channels), np.full(channels, 35.0), np.full(channels, 0.6))
    pixel = pixel_with(read_noise_e, full_well_e=full_well_e)
    sensor = sensor_of(qe, names=tuple("RGB"[:channels]), pixel=pixel)
    return point_of(sensor, level_lux, exposure=Exposure(time_s=0.02), illuminant=cie_a(GRID))


def varied_cube():
    rho = np.random.default_rng(1).uniform(0.02, 0.98, (7, 300, GRID.n)).astype(np.float32)
    return Cube(wavelength_nm=GRID.wavelength_nm, stored=rho, scale=1.0, source="a cube")


def imperfect(frame, *, noisy=False, read_noise_e=0.0, rho=0.5, **strengths):
    """Codes above black, a code for each electron, and the mean electrons of a gray."""
    cube = flat_cube(GRID.wavelength_nm, rho, height=200, width=200)
    picture = acquired(
        cube,
        with_pixel_of(used(1, read_noise_e=read_noise_e, level_lux=500.0), **strengths),
        mosaic=RED_ONLY,
        adc=Adc(bits=16, gain_e_per_dn=1.0, black_level_dn=1000),
        frame=frame,
        noisy=noisy,
    )
    return picture.codes.astype(float) - 1000, float(picture.mean_e[0])


def test_prnu_scales_with_the_light_and_stays_from_frame_to_frame():
    codes, mean = imperfect(0, prnu=0.02)
    again, _ = imperfect(1, prnu=0.02)
    assert (codes == again).all()
    assert codes.std() / mean == pytest.approx(0.02, rel=5 / np.sqrt(2 * codes.size))


def test_dsnu_adds_its_electrons_and_stays_from_frame_to_frame():
    codes, _ = imperfect(0, dsnu_e=50.0)
    assert (codes == imperfect(1, dsnu_e=50.0)[0]).all()
    assert codes.std() == pytest.approx(50.0, rel=5 / np.sqrt(2 * codes.size))


def test_row_noise_is_shared_by_a_row_and_new_in_each_frame():
    codes, _ = imperfect(0, row_noise_e=50.0)
    assert (codes == codes[:, :1]).all()
    assert codes[:, 0].std() == pytest.approx(50.0, rel=5 / np.sqrt(2 * len(codes)))
    assert not (codes == imperfect(1, row_noise_e=50.0)[0]).all()


@pytest.mark.parametrize("black_error_e", [-40.0, 25.0])
def test_a_black_level_error_moves_every_code_by_the_same_electrons(black_error_e):
    codes, _ = imperfect(0, black_error_e=black_error_e)
    assert (codes - imperfect(0)[0] == black_error_e).all()


@pytest.mark.parametrize("read_noise_e", [0.0, 5.0])
def test_dark_current_adds_noise_for_the_time_of_the_exposure_and_its_mean_is_taken_off(
    read_noise_e,
):
    codes, mean = imperfect(0, noisy=True, read_noise_e=read_noise_e, dark_current_e_per_s=1e5)
    variance = mean + 2000.0 + read_noise_e**2 + 1 / 12  # 100,000 e-/s for 20 ms
    assert codes.mean() - mean == pytest.approx(0.0, abs=5 * np.sqrt(variance / codes.size))
    assert codes.var() == pytest.approx(variance, rel=5 * np.sqrt(2 / codes.size))


def test_dark_electrons_leave_less_of_the_well():
    cube = flat_cube(GRID.wavelength_nm, 1.0, height=20, width=20)
    operating_point = used(1, level_lux=1e7, full_well_e=5000.0)
    warm = with_pixel_of(operating_point, dark_current_e_per_s=100_000.0)  # 2,000 e- in 20 ms
    adc = Adc(bits=16, gain_e_per_dn=1.0, black_level_dn=1000)
    raw = acquired(cube, warm, mosaic=RED_ONLY, adc=adc)
    assert (raw.codes == 1000 + 5000 - 2000).all()
    assert raw.above_full_well == pytest.approx([1.0])
    with refused_input(value=5000.0):
        hot = with_pixel_of(operating_point, dark_current_e_per_s=250_000.0)
        acquired(cube, hot, mosaic=RED_ONLY)


@pytest.mark.parametrize(
    ("flaw", "other"),
    [
        ({"prnu": 0.05}, {}),
        ({"dsnu_e": 50.0}, {}),
        ({"prnu": 0.05}, {"dsnu_e": 50.0}),
        ({"row_noise_e": 50.0}, {"dsnu_e": 50.0}),
        ({"row_noise_e": 50.0}, {"prnu": 0.05}),
    ],
    ids=str,
)
def test_one_imperfection_says_nothing_of_another_or_of_the_light(flaw, other):
    clean, _ = imperfect(0, noisy=not other)
    beside = imperfect(0, noisy=not other, **other)[0] if other else clean
    alone = imperfect(0, **flaw)[0]
    pairs = [(alone, beside)]
    if "row_noise_e" in flaw:  # what a row shares is counted like the pixels of the first row
        pairs = [(alone[:, 0], beside[0]), (alone[:, 0], beside[:, 0])]
    for pair in pairs:
        assert np.abs(correlation_z(*(part - part.mean() for part in pair))) < 5


def test_a_clipped_picture_is_held_at_what_dark_electrons_leave_of_the_well():
    warm = with_pixel_of(used(full_well_e=1600.0), dark_current_e_per_s=10_000.0)
    less = used(full_well_e=1400.0)  # 200 dark electrons in 20 ms
    asked = {"noisy": False, "clip": True}
    held = rendered(varied_cube(), warm, **asked)
    assert 0.1 < held.above_full_well[1] < 0.9
    np.testing.assert_array_equal(held.xyz, rendered(varied_cube(), less, **asked).xyz)


def test_an_unclipped_picture_is_not_refused_for_its_well():
    dark = with_pixel_of(used(full_well_e=600.0), dark_current_e_per_s=1e6)
    seen = rendered(varied_cube(), dark)
    assert (seen.above_full_well == 1).all()
    with refused_input(value=pytest.approx(20_000.0)):
        rendered(varied_cube(), dark, clip=True)


def test_codes_without_light_scatter_as_told_for_them():
    flaws = {"dark_current_e_per_s": 1e5, "dsnu_e": 30.0, "row_noise_e": 10.0}
    codes = np.stack(
        [imperfect(frame, noisy=True, read_noise_e=20.0, rho=0.0, **flaws)[0] for frame in range(3)]
    )
    # a row's noise is drawn 600 times, the dark signal 40,000 times, the rest 120,000 times
    error = np.sqrt(2 * (2400.0**2 / 120_000 + 900.0**2 / 40_000 + 100.0**2 / 600))
    assert codes.var() == pytest.approx(400 + 2000 + 900 + 100 + 1 / 12, abs=5 * error)


def test_a_picture_with_dark_current_has_the_colors_of_one_without():
    cube, operating_point = varied_cube(), used()
    asked = {"noisy": False, "seed": 3}
    plain = rendered(cube, operating_point, **asked)
    warm = rendered(cube, with_pixel_of(operating_point, dark_current_e_per_s=1e4), **asked)
    assert warm.xyz == pytest.approx(plain.xyz, rel=1e-4, abs=1e-5)


def test_options_that_are_switched_on_leave_the_shot_noise_as_it_was():
    cube, operating_point = varied_cube(), used()
    plain = acquired(cube, operating_point, mosaic=bayer(), seed=3)
    shifted = acquired(cube, with_pixel_of(operating_point, dsnu_e=1e-9), mosaic=bayer(), seed=3)
    assert np.abs(plain.codes.astype(int) - shifted.codes).max() <= 1
