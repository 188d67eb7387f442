"""Lamps against their published chromaticities and totals."""

from pathlib import Path

import colour
import numpy as np
import pytest

from chromanoise.spectra import (
    DEFAULT_GRID,
    Grid,
    astm_g173,
    black_body,
    cie_1931,
    cie_a,
    cie_illuminant,
    color_axes,
    equal_energy,
    flat_field,
    illuminant_named,
    led,
    light,
)
from chromanoise.spectra.tables import packaged_table

CIE = Grid.uniform(360, 830, 1)
G173_CSV = Path(__file__).parents[3] / "shared" / "data" / "illuminants" / "ASTMG173.csv"


def chromaticity(illuminant):
    xyz = light(flat_field(illuminant, level_lux=1.0), "energy") @ color_axes(
        illuminant.grid, "energy"
    )
    return xyz[:2] / xyz.sum()


def test_equal_energy_lies_in_the_middle_of_the_color_triangle():
    # CIE 015:2018: x = y = 0.33333 for E; the 1 nm tables give 0.33331, 0.33329
    assert chromaticity(equal_energy(CIE)) == pytest.approx([1 / 3, 1 / 3], abs=5e-5)


def test_illuminant_a_has_its_published_chromaticity():
    # CIE 015:2018, table T.3: x = 0.44757, y = 0.40745
    assert chromaticity(cie_a(CIE)) == pytest.approx([0.44757, 0.40745], abs=1.5e-5)


def test_illuminant_a_triples_its_power_from_400_to_560_to_780_nm():
    # CIE 015:2018, table T.1: relative powers 14.708, 100 and 241.675
    a = cie_a(Grid.uniform(400, 780, 20)).irradiance
    assert a[[0, 19]] / a[8] * 100 == pytest.approx([14.708, 241.675], abs=6e-4)


def test_d65_has_its_published_white_point():
    # CIE 015:2018, table T.3: x = 0.31272, y = 0.32903, as carried by colour-science
    published = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]
    seen = chromaticity(cie_illuminant("D65", CIE, beyond="zero"))
    assert seen == pytest.approx(published, abs=3e-5)


@pytest.mark.parametrize("name", ["D50", "D65", "FL2", "FL11", "LED-B3", "A"])
def test_a_tabulated_illuminant_has_the_chromaticity_colour_science_prints_for_it(name):
    published = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"][name]
    seen = chromaticity(illuminant_named(name, CIE, beyond="zero"))
    assert seen == pytest.approx(published, abs=6e-4)  # 5 nm sums there, 1 nm here


def test_a_black_body_of_5778_k_peaks_at_501_5_nm():
    # Wien's displacement law: 2897.77 um K / 5778 K
    grid = Grid.uniform(450, 550, 0.5)
    peak = grid.wavelength_nm[np.argmax(black_body(grid, 5778.0).irradiance)]
    assert peak == pytest.approx(501.5, abs=0.5)


def test_a_black_body_is_redder_than_blue_by_plancks_ratio():
    # c2 / (lambda T) = 11.194965 at 450 nm and 7.750360 at 650 nm, c2 = 1.4387769e-2 m K:
    # (450/650)^5 (e^11.194965 - 1) / (e^7.750360 - 1) = 4.9848
    grid = Grid.uniform(450, 650, 200)
    blue, red = black_body(grid, 2856.0).irradiance
    assert red / blue == pytest.approx(4.9848, abs=1e-4)


@pytest.mark.parametrize("name", ["E", "A", "5000K", "D65", "FL2"])
def test_every_illuminant_gives_one_lux(name):
    # a lux is 1/683.002 of the y-bar-weighted power (CIE 018:2019); integrated at 1 nm
    drawn = illuminant_named(name, CIE, beyond="zero")
    y_bar = cie_1931(CIE).values[:, 1]
    assert 683.002 * (y_bar * drawn.irradiance).sum() == pytest.approx(1.0, rel=1e-9)


def test_a_diode_by_ohnos_model_is_0_92_of_its_width_at_half_maximum():
    # (g + 2 g^5) / 3 = 1/2 at g = 0.8087, where |l - peak| = 0.4608 widths
    # (Ohno, Opt. Eng. 44 (2005) 111302, eq. 1)
    grid = Grid.uniform(450, 550, 0.1)
    power = led(grid, 500.0, 20.0).irradiance
    above = grid.wavelength_nm[power >= power.max() / 2]
    assert above[-1] - above[0] == pytest.approx(2 * 0.4608 * 20, abs=0.11)
    assert above.mean() == pytest.approx(500.0, abs=0.05)


def sun():
    wavelength, total = np.loadtxt(G173_CSV, delimiter=",", skiprows=2, usecols=(0, 2)).T
    return wavelength, total


def between(low, high, wavelength, values):
    inside = (wavelength >= low) & (wavelength <= high)
    return float(np.trapezoid(values[inside], wavelength[inside]))


needs_g173 = pytest.mark.skipif(
    not G173_CSV.exists(), reason="the original ASTM G173 table is not beside this checkout"
)


@needs_g173
def test_the_packaged_sun_keeps_the_power_of_astm_g173():
    table = packaged_table("astm_g173_global")
    wavelength, total = sun()
    bins = (table.wavelength_nm >= 400) & (table.wavelength_nm <= 1050)
    packaged = table.values[bins, 0].sum() * 5.0  # means over 5 nm, centered
    assert packaged == pytest.approx(between(397.5, 1052.5, wavelength, total), rel=1e-3)


@needs_g173
def test_one_lux_of_sun_carries_the_power_of_astm_g173():
    wavelength, total = sun()
    y_bar = np.interp(wavelength, CIE.wavelength_nm, cie_1931(CIE).values[:, 1], left=0, right=0)
    lux = 683.002 * between(360, 830, wavelength, y_bar * total)
    drawn = astm_g173(DEFAULT_GRID).irradiance.sum() * 5.0
    assert drawn == pytest.approx(between(397.5, 1052.5, wavelength, total) / lux, rel=1.5e-3)
    assert lux == pytest.approx(109_900, rel=0.01)  # an air mass of 1.5: 110 klx


def test_the_sun_has_its_oxygen_band_at_760_nm():
    # the A band halves the 5 nm means around 762 nm (ASTM G173-03)
    sun_now = astm_g173(DEFAULT_GRID).irradiance
    at = DEFAULT_GRID.wavelength_nm
    assert sun_now[at == 760] < 0.75 * sun_now[at == 750]
