"""colour-science 0.4 as the other code: CIELAB, CIELUV, sRGB."""

import colour
import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.color.spaces import LAB, LINEAR_SRGB, LUV, SRGB

LAMPS = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]
D65_WHITE = np.array([0.95047, 1.0, 1.08883])

physical = st.lists(st.floats(0.0, 1.5), min_size=3, max_size=3).map(np.array)
beyond = st.lists(st.floats(-0.5, 2.0), min_size=3, max_size=3).map(np.array)
lamps = st.sampled_from(["A", "D50", "D65", "E", "FL2", "FL11"])


def white_of(lamp):
    return colour.xy_to_XYZ(LAMPS[lamp])


@given(beyond, lamps)
def test_lab_is_that_of_colour_science_also_below_zero_and_above_white(xyz, lamp):
    theirs = colour.XYZ_to_Lab(xyz, LAMPS[lamp])
    assert LAB.from_xyz(xyz, white_of(lamp)) == pytest.approx(theirs, abs=1e-9)


@given(physical, lamps)
def test_luv_is_that_of_colour_science_for_all_light(xyz, lamp):
    if xyz.max() < 1e-100:
        xyz = np.zeros(3)  # the products of denormals are no test
    theirs = colour.XYZ_to_Luv(xyz, LAMPS[lamp])
    assert LUV.from_xyz(xyz, white_of(lamp)) == pytest.approx(theirs, abs=1e-9)


@given(physical, st.floats(0.0, 0.05), lamps)
def test_luv_is_that_of_colour_science_also_a_little_below_zero(xyz, below, lamp):
    noisy = xyz + np.array([0.1 - below, 0.05, -below])
    theirs = colour.XYZ_to_Luv(noisy, LAMPS[lamp])
    assert LUV.from_xyz(noisy, white_of(lamp)) == pytest.approx(theirs, abs=1e-9)


@given(beyond)
def test_linear_srgb_is_that_of_colour_science_unclipped(xyz):
    theirs = colour.XYZ_to_sRGB(
        xyz, LAMPS["D65"], chromatic_adaptation_transform=None, apply_cctf_encoding=False
    )
    # the matrix of IEC 61966-2-1 is printed to 4 digits
    assert LINEAR_SRGB.from_xyz(xyz, D65_WHITE) == pytest.approx(theirs, abs=4e-4)


@given(beyond, lamps)
def test_the_white_balance_of_srgb_is_that_of_colour_science(xyz, lamp):
    theirs = colour.XYZ_to_sRGB(
        xyz, LAMPS[lamp], chromatic_adaptation_transform="Bradford", apply_cctf_encoding=False
    )
    assert LINEAR_SRGB.from_xyz(xyz, white_of(lamp)) == pytest.approx(theirs, abs=2e-3)


@given(beyond, lamps)
def test_the_encoding_of_srgb_is_that_of_colour_science_below_zero_and_above_white(xyz, lamp):
    linear = LINEAR_SRGB.from_xyz(xyz, white_of(lamp))
    theirs = colour.models.eotf_inverse_sRGB(linear)
    assert SRGB.from_xyz(xyz, white_of(lamp)) == pytest.approx(theirs, abs=1e-12)
