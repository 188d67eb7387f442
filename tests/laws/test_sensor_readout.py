"""Converter, imperfections, mosaics by name: what they promise, and what they refuse."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

from chromanoise.sensor import (
    MOSAIC_NAMES,
    PAPER_PIXEL,
    Adc,
    Mosaic,
    adc_to_full_well,
    bayer,
    extra_noise,
    mosaic_named,
    rgbw_sparse_4x4,
    shot_and_read_only,
)
from outcomes import refused_input
from strategies import pixel_with

BITS = st.integers(8, 16)


@given(BITS, st.floats(100.0, 1e6), st.integers(0, 254))
def test_the_top_code_of_a_fitted_converter_is_full_well(bits, full_well_e, black_level_dn):
    adc = adc_to_full_well(
        pixel_with(full_well_e=full_well_e), bits=bits, black_level_dn=black_level_dn
    )
    electrons = (adc.top_code - adc.black_level_dn) * adc.gain_e_per_dn
    assert electrons == pytest.approx(full_well_e, rel=1e-14)
    assert adc.black_level_dn == black_level_dn


@pytest.mark.parametrize(("bits", "top"), [(8, 255), (10, 1023), (12, 4095), (14, 16383)])
def test_the_top_code_is_the_one_that_data_sheets_print(bits, top):
    assert Adc(bits=bits, gain_e_per_dn=1.0).top_code == top
    codes = {8: np.uint8}.get(bits, np.uint16)
    assert Adc(bits=bits, gain_e_per_dn=1.0).top_code <= np.iinfo(codes).max


def test_sixteen_bits_fill_an_unsigned_short():
    assert Adc(bits=16, gain_e_per_dn=1.0).top_code == np.iinfo(np.uint16).max


@given(BITS, st.integers(0, 100))
def test_one_bit_more_halves_the_gain_but_for_the_code_zero(bits, black_level_dn):
    """With 2^n - 1 steps, n + 1 bits have twice the steps and one more."""
    assume(bits < 16)
    pixel = pixel_with(full_well_e=10_000.0)
    coarse = adc_to_full_well(pixel, bits=bits)
    fine = adc_to_full_well(pixel, bits=bits + 1)
    steps = 10_000.0 / fine.gain_e_per_dn
    assert 10_000.0 / coarse.gain_e_per_dn == pytest.approx((steps - 1) / 2)
    raised = adc_to_full_well(pixel, bits=bits, black_level_dn=black_level_dn)
    assert raised.gain_e_per_dn >= coarse.gain_e_per_dn


def test_a_twelve_bit_converter_without_more_words_starts_at_code_zero():
    adc = adc_to_full_well(pixel_with(full_well_e=8190.0))
    assert (adc.bits, adc.black_level_dn, adc.gain_e_per_dn) == (12, 0, 2.0)


@pytest.mark.parametrize("bits", [-1, 0, 7, 17, 64, 2000])
def test_a_converter_has_8_to_16_bits(bits):
    with refused_input(subject="bits", value=bits):
        Adc(bits=bits, gain_e_per_dn=1.0)
    with refused_input(subject="bits", value=bits):
        adc_to_full_well(pixel_with(), bits=bits)


@pytest.mark.parametrize("gain", [0.0, -1.0, np.nan, np.inf])
def test_a_gain_that_is_no_gain_is_refused_by_name(gain):
    with refused_input(subject="gain_e_per_dn", requirement=r"\[e-/DN\]"):
        Adc(bits=12, gain_e_per_dn=gain)


@pytest.mark.parametrize("black_level_dn", [-1, 255, 256, 70_000])
def test_a_black_level_leaves_at_least_one_code_for_light(black_level_dn):
    with refused_input(subject="black_level_dn", value=black_level_dn):
        Adc(bits=8, gain_e_per_dn=1.0, black_level_dn=black_level_dn)
    with refused_input(subject="black_level_dn", value=black_level_dn):
        adc_to_full_well(pixel_with(), bits=8, black_level_dn=black_level_dn)


def test_a_black_level_just_below_the_top_leaves_full_well_to_one_code():
    adc = adc_to_full_well(pixel_with(full_well_e=700.0), bits=8, black_level_dn=254)
    assert adc.gain_e_per_dn == 700.0


def test_the_papers_pixel_has_no_imperfections():
    assert extra_noise(PAPER_PIXEL) == {}
    assert shot_and_read_only(replace(PAPER_PIXEL, prnu=0.01, dsnu_e=2.0)) == PAPER_PIXEL


def share(mosaic, name):
    flat = [entry for row in mosaic.pattern for entry in row]
    return flat.count(name) / len(flat)


def test_half_of_a_bayer_array_is_green():
    """Bayer, US 3,971,065: luminance-sensitive elements at every other place, diagonally."""
    mosaic = mosaic_named("bayer")
    assert share(mosaic, "G") == 0.5
    assert share(mosaic, "R") == share(mosaic, "B") == 0.25
    assert mosaic.pattern[0][1] == mosaic.pattern[1][0] == "G"


def test_three_quarters_of_the_sparse_array_are_white():
    mosaic = mosaic_named("rgbw-4x4")
    assert share(mosaic, "W") == 0.75
    assert share(mosaic, "G") == 2 * share(mosaic, "R") == 2 * share(mosaic, "B") == 0.125
    assert mosaic == rgbw_sparse_4x4()


@pytest.mark.parametrize("name", MOSAIC_NAMES)
def test_a_named_mosaic_is_also_its_own_rows(name):
    mosaic = mosaic_named(name)
    assert mosaic_named(" / ".join(" ".join(row) for row in mosaic.pattern)) == mosaic


@given(
    st.lists(
        st.lists(st.sampled_from(["R", "G", "B", "IR", "c900"]), min_size=2, max_size=2),
        min_size=1,
        max_size=3,
    )
)
def test_rows_with_spaces_are_read_channel_by_channel(rows):
    assert mosaic_named("/".join(" ".join(row) for row in rows)) == Mosaic(
        tuple(tuple(row) for row in rows)
    )


def test_rows_without_spaces_are_read_letter_by_letter():
    assert mosaic_named("RG/GB") == bayer()
    assert mosaic_named("W").pattern == (("W",),)
    assert mosaic_named("RGW/GBW/WWR").names == ("R", "G", "W", "B")


@pytest.mark.parametrize(
    ("text", "named"),
    [("bayr", "bayer"), ("rgbw-4x5", "rgbw-4x4"), ("xyzzyx", "rgbw-2x2")],
)
def test_what_is_no_mosaic_is_refused_with_the_nearest(text, named):
    with refused_input(subject="mosaic", value=text) as refusal:
        mosaic_named(text)
    assert named in refusal.value.remedy[0]


@pytest.mark.parametrize(
    ("text", "value"),
    [("RG//GB", "RG//GB"), ("/RG", "/RG"), ("", ""), ("RG/B", (2, 1)), ("R G/IR", (2, 1))],
)
def test_a_mosaic_with_an_empty_row_or_rows_of_different_lengths_is_refused(text, value):
    with refused_input(subject="mosaic", value=value):
        mosaic_named(text)


@pytest.mark.parametrize("pattern", [(), ((),)])
def test_a_mosaic_of_nothing_is_refused(pattern):
    with refused_input(subject="mosaic", value=pattern):
        Mosaic(pattern)
