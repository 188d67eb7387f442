"""Slanted edges: MTF and rise distance of edges whose blur is known in closed form."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.optimize import brentq
from scipy.stats import norm

from chromanoise.metrics import EdgeLine, edge_line, slanted_edge_response
from outcomes import refused_input

slants = st.floats(2.0, 25.0) | st.floats(-25.0, -2.0)
sds = st.floats(0.7, 2.0)


def distances(slope, height=64, width=72, offset=0.3):
    y, x = np.mgrid[:height, :width]
    across = x - (width - 1) / 2 - offset - slope * (y - (height - 1) / 2)
    return across / np.hypot(1.0, slope)


def sampled_edge(sd, angle_deg, **more):
    """An edge blurred by a Gaussian, at ideal points."""
    return norm.cdf(distances(np.tan(np.radians(angle_deg)), **more) / sd)


def pixel_edge(sd, angle_deg, **more):
    """The same, averaged over square pixels: second differences of its second integral."""
    angle = np.radians(angle_deg)
    at, a, b = distances(np.tan(angle), **more), np.cos(angle) / 2, np.sin(angle) / 2

    def integral(t):
        u = t / sd
        return sd**2 * ((u * u + 1) / 2 * norm.cdf(u) + u / 2 * norm.pdf(u))

    corners = integral(at + a + b) + integral(at - a - b)
    return (corners - integral(at + a - b) - integral(at - a + b)) / (4 * a * b)


def pixel_mtf(frequency, sd, angle_deg):
    angle = np.radians(angle_deg)
    aperture = np.sinc(frequency * np.cos(angle)) * np.sinc(frequency * np.sin(angle))
    return np.exp(-2 * (np.pi * sd * frequency) ** 2) * aperture


@settings(max_examples=25)
@given(sds, slants)
def test_a_gaussian_edge_at_ideal_points_has_its_mtf50_and_rise(sd, angle):
    found = slanted_edge_response(sampled_edge(sd, angle))
    assert found.mtf50_cy_px == pytest.approx(np.sqrt(np.log(2) / 2) / np.pi / sd, rel=0.01)
    # the bins of 1/4 px lengthen the rise
    assert found.rise_px == pytest.approx(2 * norm.ppf(0.9) * sd, rel=0.03)
    assert found.rise_px > 2 * norm.ppf(0.9) * sd * 0.999
    assert found.line.angle_deg == pytest.approx(angle, abs=0.02)
    assert found.line.position_px == pytest.approx(35.5 + 0.3, abs=2e-3)


@settings(max_examples=25)
@given(sds, slants)
def test_square_pixels_add_their_own_aperture(sd, angle):
    found = slanted_edge_response(pixel_edge(sd, angle))
    expected = brentq(lambda f: pixel_mtf(f, sd, angle) - 0.5, 1e-3, 1.0)
    assert found.mtf50_cy_px == pytest.approx(expected, rel=0.01)


def test_the_whole_mtf_is_that_of_the_blur_and_the_pixel():
    found = slanted_edge_response(pixel_edge(0.4, 5.0))
    expected = pixel_mtf(found.frequency_cy_px, 0.4, 5.0)
    assert found.mtf == pytest.approx(np.abs(expected), abs=0.012)
    assert found.frequency_cy_px[[0, -1]] == pytest.approx([0.0, 1.0], abs=0.01)


@pytest.mark.parametrize("ratio", [1 / 4, 1 / 6, 1 / 10])
def test_slopes_that_repeat_the_same_phases_are_as_exact(ratio):
    found = slanted_edge_response(pixel_edge(0.8, np.degrees(np.arctan(ratio))))
    expected = brentq(lambda f: pixel_mtf(f, 0.8, np.degrees(np.arctan(ratio))) - 0.5, 1e-3, 1.0)
    assert found.mtf50_cy_px == pytest.approx(expected, rel=0.004)


@given(st.floats(0.05, 50.0), st.floats(-5.0, 5.0), st.booleans(), st.booleans(), st.booleans())
@settings(max_examples=20)
def test_sharpness_is_independent_of_level_contrast_direction_and_orientation(
    step, level, falls, turned, flipped
):
    edge = pixel_edge(0.9, 6.0)
    seen = level * step + step * (1 - edge if falls else edge)
    seen = seen.T if turned else seen
    seen = seen[::-1] if flipped else seen
    one, other = slanted_edge_response(edge), slanted_edge_response(seen)
    assert other.mtf50_cy_px == pytest.approx(one.mtf50_cy_px, rel=1e-6)
    assert other.rise_px == pytest.approx(one.rise_px, rel=1e-6)
    assert other.step == pytest.approx(step * one.step, rel=1e-6)
    assert other.line.horizontal == turned


def test_an_edge_without_blur_is_limited_by_the_pixel_only():
    found = slanted_edge_response(pixel_edge(1e-3, 5.0))
    expected = brentq(lambda f: pixel_mtf(f, 0.0, 5.0) - 0.5, 1e-3, 1.0)
    assert found.mtf50_cy_px == pytest.approx(expected, rel=0.01)


def test_a_step_at_ideal_points_never_falls_to_one_half():
    assert slanted_edge_response(sampled_edge(1e-6, 5.0)).mtf50_cy_px is None


def test_sharpening_raises_the_mtf_above_one():
    edge = pixel_edge(1.0, 5.0)
    sharpened = edge + 1.5 * (edge - pixel_edge(2.0, 5.0))
    found, plain = slanted_edge_response(sharpened), slanted_edge_response(edge)
    assert found.mtf.max() > 1.1
    assert found.mtf50_cy_px > plain.mtf50_cy_px
    assert found.rise_px < plain.rise_px


@pytest.mark.parametrize("noise_sd", [0.02, 0.1])
def test_noise_spreads_the_mtf50_around_that_of_the_edge(noise_sd):
    edge = pixel_edge(0.8, 5.0)
    still, rng = slanted_edge_response(edge), np.random.default_rng(7)
    noisy = [
        slanted_edge_response(edge + rng.normal(0, noise_sd, edge.shape), line=still.line)
        for _ in range(30)
    ]
    mtf50 = np.array([one.mtf50_cy_px for one in noisy])
    assert mtf50.mean() == pytest.approx(still.mtf50_cy_px, rel=0.04)
    assert 0 < mtf50.std() < 1.5 * noise_sd * still.mtf50_cy_px
    ratio = np.mean([one.step_to_noise for one in noisy])
    assert ratio == pytest.approx(1 / noise_sd, rel=0.1)


def test_rows_without_the_edge_do_not_move_the_line():
    covered = pixel_edge(0.8, 5.0)
    covered[10:20] = 0.5
    line = edge_line(covered)
    assert line.angle_deg == pytest.approx(5.0, abs=0.02)
    assert line.position_px == pytest.approx(35.8, abs=2e-3)


def test_a_given_line_takes_the_place_of_the_fit():
    edge = pixel_edge(0.8, 5.0)
    line = edge_line(edge)
    assert slanted_edge_response(edge, line=line).mtf50_cy_px == pytest.approx(
        slanted_edge_response(edge).mtf50_cy_px, rel=1e-12
    )
    wrong = EdgeLine(position_px=line.position_px, slope=line.slope + 0.1)
    assert slanted_edge_response(edge, line=wrong).mtf50_cy_px < 0.9 * (
        slanted_edge_response(edge).mtf50_cy_px
    )


# --- refusals ---

NOISE = np.random.default_rng(11).normal(0.5, 0.1, (64, 64))
LINE = EdgeLine(position_px=31.5, slope=0.1)


@pytest.mark.parametrize(
    "flat", [np.zeros((32, 32)), np.full((32, 32), 0.7), np.full((32, 32), -1e9), NOISE]
)
@pytest.mark.parametrize("line", [None, LINE])
def test_a_region_without_contrast_is_refused(flat, line):
    if line is not None and len(flat) == 32:
        line = EdgeLine(position_px=15.5, slope=0.1)
    with refused_input(subject="region"):
        slanted_edge_response(flat, line=line)


def test_rounding_errors_of_a_constant_region_are_no_edge():
    rng = np.random.default_rng(1)
    for height, width in rng.integers(20, 80, (100, 2)):
        line = EdgeLine(position_px=width / 2 - 0.3, slope=0.05)
        with refused_input(subject="region"):
            slanted_edge_response(np.full((height, width), rng.uniform(-1, 1)), line=line)


@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_an_edge_along_the_pixels_is_refused(angle):
    with refused_input(subject="region", requirement="crosses at least 1 px"):
        edge_line(sampled_edge(0.8, angle))


@pytest.mark.parametrize("shape", [(15, 40), (40, 15)])
def test_a_small_region_is_refused(shape):
    with refused_input(subject="region", value=shape):
        slanted_edge_response(np.ones(shape))


def test_an_edge_at_the_border_of_the_region_is_refused():
    line = EdgeLine(position_px=2.0, slope=0.05)
    with refused_input(subject="region", requirement="either side"):
        slanted_edge_response(pixel_edge(0.8, 5.0), line=line)
    with refused_input(subject="reach_px"):
        slanted_edge_response(pixel_edge(0.8, 5.0), reach_px=3.0)


def test_a_number_that_is_not_finite_is_refused():
    region = pixel_edge(0.8, 5.0)
    region[5, 5] = np.inf
    with refused_input(subject="region", requirement="finite"):
        slanted_edge_response(region)


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.floats(0.0, 1.0))
def test_no_result_is_ever_not_a_number(seed, contrast):
    noise = np.random.default_rng(seed).normal(0, 0.3, (64, 72))
    try:
        found = slanted_edge_response(contrast * pixel_edge(0.8, 5.0) + noise)
    except ValueError:
        return
    assert np.isfinite(found.mtf).all()
    assert found.rise_px > 0
    assert found.mtf50_cy_px is None or 0 < found.mtf50_cy_px <= 1
