"""Numbers of light that do not depend on any sensor."""

import numpy as np
import pytest

from chromanoise.noise import Exposure, expected_electrons, exposure_factor
from chromanoise.sensor import PAPER_PIXEL
from chromanoise.spectra import (
    Grid,
    Spectra,
    cie_1931,
    equal_energy,
    flat_field,
    illuminant_from,
    photon_irradiance,
)
from strategies import GRID, white_channel

ONE_NM = Grid.uniform(400, 1050, 1)
TWELVE_MS = Exposure(time_s=0.012, f_number=1.8)


def test_one_lux_of_equal_energy_is_1_37017e_minus_5_watt_per_m2_and_nm():
    # 1 / (683.002 * 106.857): the area of y-bar, CIE 018:2019 (docs/numbers.md)
    assert equal_energy(ONE_NM).irradiance == pytest.approx(
        np.full(ONE_NM.n, 1.37017e-5), abs=5e-11
    )


def test_the_area_under_y_bar_is_106_857():
    # CIE 015:2018, table 5 (1 nm sums of x-bar, y-bar, z-bar: 106.865, 106.857, 106.892)
    sums = cie_1931(Grid.uniform(360, 830, 1)).values.sum(axis=0)
    assert sums == pytest.approx([106.865, 106.857, 106.892], abs=6e-4)


def test_one_lux_at_555_nm_is_4091_photons_per_second_and_square_micron():
    # lambda / (h c) / 683.002 lm/W = 4090.7 photons / (lux s um2); docs/numbers.md
    line = Spectra(
        wavelength_nm=np.array([554.0, 555.0, 556.0]),
        values=np.array([[0.0], [1.0], [0.0]]),
        names=("line",),
        quantity="power",
        unit="W",
        source="a line",
    )
    grid = Grid.uniform(550, 560, 1)
    drawn = illuminant_from(line, grid, name="555 nm", beyond="zero")
    assert photon_irradiance(drawn).sum() == pytest.approx(4090.7, abs=0.06)


@pytest.mark.parametrize(("stop_nm", "photons"), [(700, 11_419), (1050, 32_555)])
def test_photons_of_equal_energy_per_lux_second_and_square_micron(stop_nm, photons):
    # plain 1 nm sum, docs/numbers.md
    total = photon_irradiance(equal_energy(Grid.uniform(400, stop_nm, 1))).sum()
    assert total == pytest.approx(photons, abs=0.5)


def test_the_papers_exposure_puts_30144_photons_on_a_pixel():
    # Clouet et al. (CIC27, 2019), section 4: 10 lx, f/1.8, 10 um, 12 ms, reflectance 1
    scene = flat_field(equal_energy(ONE_NM), level_lux=10.0)
    every_photon = white_channel(1.0, grid=ONE_NM, pixel=PAPER_PIXEL)
    assert expected_electrons(scene, every_photon, TWELVE_MS)[0] == pytest.approx(30_144, abs=0.6)


def test_9900_electrons_are_a_mean_quantum_efficiency_of_0_328():
    scene = flat_field(equal_energy(ONE_NM), level_lux=10.0)
    third = white_channel(0.328, grid=ONE_NM, pixel=PAPER_PIXEL)
    assert expected_electrons(scene, third, TWELVE_MS)[0] == pytest.approx(9900, rel=0.0015)


def test_the_papers_pixel_is_10_um_with_10000_electrons_and_10_electrons_of_noise():
    # Clouet et al. (CIC27, 2019), section 4
    assert (PAPER_PIXEL.pitch_um, PAPER_PIXEL.full_well_e, PAPER_PIXEL.read_noise_e) == (
        10.0,
        10_000.0,
        10.0,
    )


def test_the_camera_equation_is_0_32_db_darker_at_f_1_8():
    # ISETCam: pi / (1 + 4 f#^2 (1 + |m|)^2) on radiance; at f/1.8: 1/13.96 beside 1/12.96
    distant = exposure_factor(TWELVE_MS, PAPER_PIXEL, 1.0)
    camera = exposure_factor(
        Exposure(time_s=0.012, f_number=1.8, magnification=0.0), PAPER_PIXEL, 1.0
    )
    assert 10 * np.log10(distant / camera) == pytest.approx(0.32, abs=0.005)


def test_a_one_to_one_macro_at_f_2_sees_a_65th_of_the_scene():
    # 1 + 4 * 2^2 * (1 + 1)^2 = 65, whichever side the image is counted from
    far = exposure_factor(Exposure(time_s=1.0, f_number=0.5), PAPER_PIXEL, 1.0)  # 1 / (4 / 4)
    for magnification in (1.0, -1.0):
        macro = Exposure(time_s=1.0, f_number=2.0, magnification=magnification)
        assert exposure_factor(macro, PAPER_PIXEL, 1.0) / far == pytest.approx(1 / 65, rel=1e-12)


def test_a_thinner_grid_sums_to_nearly_the_same_electrons():
    scene = flat_field(equal_energy(GRID), level_lux=10.0)
    fine = Grid.uniform(395.5, 704.5, 1)  # the same 310 nm that 31 samples of 10 nm stand for
    fine_scene = flat_field(equal_energy(fine), level_lux=10.0)
    coarse_e = expected_electrons(scene, white_channel(), TWELVE_MS)
    fine_e = expected_electrons(fine_scene, white_channel(grid=fine), TWELVE_MS)
    assert coarse_e == pytest.approx(fine_e, rel=1e-9)
