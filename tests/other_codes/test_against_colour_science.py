"""colour-science 0.4 as the other code: encodings, adaptation, lamps, charts, XYZ."""

import colour
import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.color import (
    adapted_to_d65,
    balanced_cielab,
    cie1976_difference,
    ciede2000_difference,
    srgb_from_xyz,
)
from chromanoise.spectra import (
    DEFAULT_GRID,
    OBSERVERS,
    Grid,
    Scene,
    black_body,
    cie_1931,
    cie_a,
    cie_illuminant,
    color_axes,
    color_matching_functions,
    colorchecker,
    equal_energy,
    flat_field,
    illuminant_named,
    is_light_name,
    light,
)
from chromanoise.spectra.tables import packaged_table

D65 = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]
D65_WHITE = np.array([0.95047, 1.0, 1.08883])
THEIR_OBSERVERS = {
    "cie-1931-2": colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"],
    "cie-1964-10": colour.MSDS_CMFS["CIE 1964 10 Degree Standard Observer"],
    "cie-2015-2": colour.MSDS_CMFS["CIE 2015 2 Degree Standard Observer"],
    "cie-2015-10": colour.MSDS_CMFS["CIE 2015 10 Degree Standard Observer"],
}
CIE = Grid.uniform(360, 830, 1)
CIE_SHAPE = colour.SpectralShape(360, 830, 1)

tristimulus = st.lists(st.floats(0.0, 1.2), min_size=3, max_size=3).map(np.array)


def xyz_of(reflectance, lamp, grid):
    """X, Y, Z of reflectances (one per row), Y = 1 for white."""
    axes = color_axes(grid, "energy")
    scene = Scene(
        illuminant=lamp, level_lux=1.0, reflectance=np.vstack([np.ones(grid.n), reflectance])
    )
    xyz = light(scene, "energy") @ axes
    return xyz[1:] / xyz[0, 1]


@given(tristimulus)
def test_srgb_is_encoded_as_colour_science_does(xyz):
    theirs = colour.XYZ_to_sRGB(xyz, illuminant=D65, chromatic_adaptation_transform=None)
    # the matrix of IEC 61966-2-1 is printed to 4 digits
    assert srgb_from_xyz(xyz) == pytest.approx(np.clip(theirs, 0, 1), abs=2e-4)


@pytest.mark.parametrize(
    ("linear", "encoded"), [(0.0, 0.0), (0.0031308, 0.04045), (0.18, 0.46136), (1.0, 1.0)]
)
def test_the_gray_axis_of_srgb_follows_iec_61966(linear, encoded):
    assert srgb_from_xyz(linear * D65_WHITE) == pytest.approx(np.full(3, encoded), abs=3e-4)


@pytest.mark.parametrize(
    ("primary", "rgb"),
    [
        ([0.4124, 0.2126, 0.0193], [1, 0, 0]),
        ([0.3576, 0.7152, 0.1192], [0, 1, 0]),
        ([0.1805, 0.0722, 0.9505], [0, 0, 1]),
    ],
)
def test_the_primaries_of_srgb_are_those_of_iec_61966(primary, rgb):
    assert srgb_from_xyz(np.array(primary)) == pytest.approx(rgb, abs=2e-3)


@given(tristimulus, st.sampled_from(["A", "D50", "FL2", "FL11", "D75"]))
def test_bradford_adaptation_is_that_of_colour_science(xyz, lamp):
    xy = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"][lamp]
    white = colour.xy_to_XYZ(xy)
    theirs = colour.adaptation.chromatic_adaptation_VonKries(
        xyz, white, D65_WHITE, transform="Bradford"
    )
    assert adapted_to_d65(xyz, white) == pytest.approx(theirs, abs=1e-9)


@pytest.mark.parametrize("temperature_k", [1500.0, 2856.0, 6500.0, 15_000.0])
def test_a_black_body_is_that_of_colour_science(temperature_k):
    grid = Grid.uniform(400, 1050, 10)
    theirs = colour.sd_blackbody(temperature_k, colour.SpectralShape(400, 1050, 10)).values
    ours = black_body(grid, temperature_k).irradiance
    # c2 = 1.4388e-2 m K there (rounded), 1.438776877e-2 here
    assert ours / ours.sum() == pytest.approx(theirs / theirs.sum(), rel=5e-4)


def test_illuminant_a_is_the_table_of_colour_science():
    theirs = colour.SDS_ILLUMINANTS["A"].copy().align(colour.SpectralShape(400, 780, 5)).values
    ours = cie_a(Grid.uniform(400, 780, 5)).irradiance
    assert ours / ours[32] == pytest.approx(theirs / theirs[32], rel=2e-5)


@pytest.mark.parametrize("name", ["D65", "FL11", "LED-B3"])
def test_a_tabulated_lamp_keeps_its_shape(name):
    grid = Grid.uniform(400, 780, 5)
    theirs = colour.SDS_ILLUMINANTS[name][grid.wavelength_nm]
    ours = cie_illuminant(name, grid).irradiance
    assert ours / ours.sum() == pytest.approx(theirs / theirs.sum(), rel=1e-9)


def test_every_observer_is_the_table_of_colour_science_to_the_last_digit():
    assert list(OBSERVERS) == list(THEIR_OBSERVERS)
    for name, theirs in THEIR_OBSERVERS.items():
        table = packaged_table(OBSERVERS[name])
        assert table.names == ("x", "y", "z")
        assert np.array_equal(table.wavelength_nm, theirs.wavelengths)
        assert np.array_equal(table.values, theirs.values)


@pytest.mark.parametrize("name", OBSERVERS)
def test_an_observer_is_zero_outside_of_its_table(name):
    theirs = THEIR_OBSERVERS[name]
    wide = Grid.uniform(350, 850, 1)
    functions = color_matching_functions(wide, name).values
    inside = np.isin(wide.wavelength_nm, theirs.wavelengths)
    assert functions[inside] == pytest.approx(theirs.values, abs=1e-12)
    assert not functions[~inside].any()


def test_the_default_observer_is_cie_1931():
    assert np.array_equal(cie_1931(CIE).values, color_matching_functions(CIE).values)
    assert cie_1931(CIE).values == pytest.approx(THEIR_OBSERVERS["cie-1931-2"].values, abs=1e-12)


@pytest.mark.parametrize("lamp", ["A", "D65", "E"])
@pytest.mark.parametrize("name", OBSERVERS)
def test_the_white_points_of_every_observer_are_those_of_colour_science(name, lamp):
    first = int(THEIR_OBSERVERS[name].shape.start)
    grid = Grid.uniform(first, 780, 5)
    ours = equal_energy(grid) if lamp == "E" else illuminant_named(lamp, grid)
    xyz = light(flat_field(ours, level_lux=1.0), "energy") @ color_axes(grid, "energy", name)
    shape = colour.SpectralShape(first, 780, 5)
    theirs = colour.colorimetry.sd_to_XYZ_integration(
        colour.SDS_ILLUMINANTS[lamp].copy().align(shape), THEIR_OBSERVERS[name], shape=shape
    )
    assert xyz / xyz[1] == pytest.approx(theirs / theirs[1], rel=2e-6)  # A is printed to 6 digits


@pytest.mark.parametrize(
    "table", ["cie_daylight", "cie_lamps", "cie_d60", "cie_b", "iso_7589", "iso_7589_printer"]
)
def test_packaged_lights_are_those_of_colour_science_to_the_last_digit(table):
    packaged = packaged_table(table)
    for name, power in zip(packaged.names, packaged.values.T, strict=True):
        theirs = colour.SDS_ILLUMINANTS[name]
        assert np.array_equal(packaged.wavelength_nm, theirs.wavelengths)
        assert np.array_equal(power, theirs.values)


@pytest.mark.parametrize(
    ("table", "theirs"),
    [("nikon-d5100-npl", "Nikon 5100 (NPL)"), ("sigma-sd-merrill", "Sigma SDMerill (NPL)")],
)
def test_packaged_cameras_are_those_of_colour_science_to_the_last_digit(table, theirs):
    measured = colour.MSDS_CAMERA_SENSITIVITIES[theirs]
    assert np.array_equal(packaged_table(table).wavelength_nm, measured.wavelengths)
    assert np.array_equal(packaged_table(table).values, measured.values)


def test_ciede2000_is_that_of_colour_science():
    random = np.random.default_rng(3)
    first, second = random.uniform([0, -90, -90], [100, 90, 90], (2, 4000, 3))
    near = first + random.normal(scale=0.5, size=first.shape)
    gray = first * [1, 0, 0]
    for one, other in ((first, second), (first, near), (first, gray), (gray, gray)):
        theirs = colour.difference.delta_E_CIE2000(one, other)
        assert ciede2000_difference(one, other) == pytest.approx(theirs, rel=1e-9, abs=1e-9)


def test_every_tabulated_lamp_of_colour_science_is_known_by_its_name():
    assert all(is_light_name(name) for name in colour.SDS_ILLUMINANTS)


def test_lab_and_its_differences_are_those_of_colour_science_to_the_last_digit():
    random = np.random.default_rng(5)
    xyz = random.uniform(-0.1, 1.2, (5, 400, 3))
    xyz[0, :200] *= 0.02  # on the linear toe
    theirs = colour.XYZ_to_Lab(xyz, np.array([1 / 3, 1 / 3]))
    ours = balanced_cielab(xyz)
    assert np.array_equal(ours, theirs)
    difference = colour.difference.delta_E_CIE1976(np.broadcast_to(theirs[0], theirs.shape), theirs)
    assert np.array_equal(cie1976_difference(ours[0], ours), difference)


@pytest.mark.parametrize("lamp", ["A", "D65"])
def test_xyz_of_measured_reflectances_are_those_of_colour_science(lamp):
    chart = colour.SDS_COLOURCHECKERS["BabelColor Average"]
    illuminant = colour.SDS_ILLUMINANTS[lamp].copy()
    illuminant = illuminant.interpolate(
        colour.SpectralShape(int(illuminant.shape.start), int(illuminant.shape.end), 1),
        interpolator=colour.LinearInterpolator,
    ).align(CIE_SHAPE, extrapolator_kwargs={"method": "Constant", "left": 0, "right": 0})
    ours_lamp = illuminant_named(lamp, CIE, beyond="zero")
    for patch in ("dark skin", "green", "white 9.5 (.05 D)"):
        sd = chart[patch].copy().align(CIE_SHAPE)
        theirs = (
            colour.sd_to_XYZ(sd, THEIR_OBSERVERS["cie-1931-2"], illuminant, method="Integration")
            / 100
        )
        ours = xyz_of(sd.values, ours_lamp, CIE)[0]
        assert ours == pytest.approx(theirs, abs=1e-4)  # A: a 5 nm table there


def test_the_packaged_chart_is_a_colorchecker_within_a_color_difference_of_3():
    # to the BabelColor average under D65: 2.7 in CIEDE2000, 4.6 in CIE 1976, since it reads dark
    grid = Grid.uniform(400, 700, 10)
    lamp = cie_illuminant("D65", grid)
    ours = colorchecker(grid)
    babel = colour.SDS_COLOURCHECKERS["BabelColor Average"]
    theirs = np.array([sd[grid.wavelength_nm] for sd in babel.values()])
    lab = [
        colour.XYZ_to_Lab(xyz_of(reflectance, lamp, grid), D65)
        for reflectance in (ours.values.T, theirs)
    ]
    assert colour.difference.delta_E_CIE2000(*lab).mean() == pytest.approx(2.7, abs=0.05)
    assert colour.difference.delta_E_CIE1976(*lab).mean() == pytest.approx(4.6, abs=0.05)
    # each patch is nearest to its own name: no two are exchanged
    every_pair = np.linalg.norm(lab[0][:, None] - lab[1][None], axis=-1)
    assert list(every_pair.argmin(axis=1)) == list(range(24))


def test_the_packaged_chart_names_its_patches_in_the_order_of_colour_science():
    babel = list(colour.SDS_COLOURCHECKERS["BabelColor Average"])
    for ours, theirs in zip(colorchecker(DEFAULT_GRID).names[:18], babel, strict=False):
        assert ours.split()[-1] == theirs.split()[-1]


def test_the_patches_of_iso_17321_are_those_of_colour_science():
    table = packaged_table("iso_17321")
    patches = colour.SDS_COLOURCHECKERS["ISO 17321-1"]
    assert table.names == tuple(patches)
    for values, patch in zip(table.values.T, patches.values(), strict=True):
        assert (table.wavelength_nm == patch.wavelengths).all()
        assert (values == patch.values).all()
