"""sRGB pictures to linear raw and back."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.apps.training.unprocessing import (
    Rendering,
    draw_rendering,
    linear_from_srgb,
    process,
    unprocess,
)
from chromanoise.base.rng import stream
from chromanoise.imaging import bilinear_filters
from chromanoise.sensor import Mosaic, bayer
from outcomes import refused_input

MATRIX = np.array([[1.6, -0.4, -0.2], [-0.3, 1.5, -0.2], [0.0, -0.5, 1.5]])
PLAIN = {"srgb_curve": False, "tone_curve": False}


def test_the_srgb_curve_has_the_printed_values():
    """IEC 61966-2-1: code 128 of 255 is 0.2158605 linear, and the line ends at 0.04045."""
    found = linear_from_srgb(np.array([128 / 255, 0.04045]))
    np.testing.assert_allclose(found, [0.2158605, 0.0031308], rtol=2e-5)


def test_gains_and_matrix_act_on_camera_values_before_the_curves():
    look = Rendering(red_gain=2.0, blue_gain=4.0, camera_to_srgb=MATRIX, **PLAIN)
    raw = np.array([[[0.1, 0.2, 0.05]]])
    expected = MATRIX @ [0.2, 0.2, 0.2]
    np.testing.assert_allclose(process(raw, look)[0, 0], expected)
    np.testing.assert_allclose(unprocess(expected[None, None], look), raw)


def test_the_tone_curve_is_the_smooth_step():
    look = Rendering(srgb_curve=False)
    np.testing.assert_allclose(process(np.full((1, 1, 3), 0.25), look), 0.15625)
    np.testing.assert_allclose(unprocess(np.full((1, 1, 3), 0.15625), look), 0.25)


@given(seed=st.integers(0, 1000), level=st.floats(0.02, 0.6))
def test_a_picture_comes_back_from_its_raw_values(seed, level):
    look = draw_rendering(stream(seed), camera_to_srgb=MATRIX)
    srgb = np.full((2, 3, 3), level) * np.array([1.0, 0.95, 1.05])
    np.testing.assert_allclose(process(unprocess(srgb, look), look), srgb, atol=1e-9)


def test_a_flat_picture_comes_back_from_its_mosaic():
    look = Rendering(red_gain=2.0, blue_gain=1.6)
    srgb = np.full((6, 8, 3), [0.3, 0.4, 0.5])
    raw = unprocess(srgb, look, mosaic=bayer())
    assert raw.shape == (6, 8)
    back = process(raw, look, demosaicing=bilinear_filters(bayer(), ("R", "G", "B")))
    np.testing.assert_allclose(back, srgb, atol=1e-9)


def test_a_mosaic_with_two_greens_measures_green_twice():
    srgb = np.full((2, 2, 3), [0.2, 0.4, 0.6])
    raw = unprocess(srgb, Rendering(**PLAIN), mosaic=Mosaic((("R", "G1"), ("G2", "B"))))
    np.testing.assert_allclose(raw, [[0.2, 0.4], [0.4, 0.6]])


def test_white_stays_white_and_raw_values_stay_within_the_range():
    look = Rendering(red_gain=2.2, blue_gain=1.7, brightness=1.3)
    np.testing.assert_allclose(unprocess(np.ones((1, 1, 3)), look), 1.0)
    pictures = np.random.default_rng(0).uniform(0, 1, (50, 50, 3))
    look = Rendering(camera_to_srgb=MATRIX, brightness=0.5)
    raw = unprocess(pictures, look)
    assert raw.min() >= 0
    assert raw.max() <= 1


def test_drawn_renderings_are_in_the_published_ranges_and_differ():
    looks = [draw_rendering(stream(i)) for i in range(100)]
    assert all(1.9 <= one.red_gain <= 2.4 and 1.5 <= one.blue_gain <= 1.9 for one in looks)
    assert np.mean([1 / one.brightness for one in looks]) == pytest.approx(0.8, abs=0.05)


def test_bad_pictures_are_refused_by_name():
    look = Rendering()
    with refused_input(subject="srgb", value=128.0):
        unprocess(np.full((2, 2, 3), 128.0), look)
    with refused_input(subject="demosaicing"):
        process(np.zeros((4, 4)), look)
    with refused_input(subject="raw"):
        process(np.full((2, 2, 3), np.nan), look)
    with refused_input(subject="mosaic channel", value="W"):
        unprocess(np.zeros((2, 2, 3)), look, mosaic=Mosaic((("R", "G"), ("B", "W"))))
    with refused_input(subject="brightness", value=0.0):
        Rendering(brightness=0.0)
    with refused_input(subject="camera_to_srgb"):
        Rendering(camera_to_srgb=np.zeros((3, 3)))
