"""Errors of whole pictures: color difference, S-CIELAB, PSNR, SSIM, false color, flats."""

import math
from inspect import unwrap

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.signal import fftconvolve

from chromanoise.color import cie1976_difference, ciede2000_difference, cielab, srgb_from_linear
from chromanoise.metrics import (
    false_color,
    flat_noise_sd,
    near_edges,
    picture_color_difference,
    picture_quality,
    psnr_db,
    scielab_difference,
    scielab_filtered,
    structural_similarity,
)
from chromanoise.metrics.fidelity import GAUSSIANS, OPPONENT_FROM_XYZ, scielab_shares
from outcomes import refused_input

D65 = np.array([0.95047, 1.0, 1.08883])
OPPONENT = np.array(OPPONENT_FROM_XYZ)
colors = st.lists(st.floats(0.02, 1.0), min_size=3, max_size=3).map(np.array)
resolutions = st.floats(1.0, 300.0)


def random_picture(seed, shape=(20, 24), sd=0.2):
    return np.random.default_rng(seed).normal(0.4, sd, (*shape, 3))


def uniform(color, shape=(12, 15)):
    return np.broadcast_to(color, (*shape, 3)).copy()


def checkerboard(first, second, side=32):
    odd = np.indices((side, side)).sum(axis=0) % 2
    return np.where(odd[..., None], first, second)


# --- S-CIELAB ---


@given(colors, colors, resolutions)
def test_scielab_of_uniform_pictures_is_their_cielab_difference(first, second, scale):
    seen = scielab_difference(uniform(first), uniform(second), D65, pixels_per_degree=scale)
    plain = cie1976_difference(cielab(first, D65), cielab(second, D65))
    assert seen == pytest.approx(np.full(seen.shape, plain), abs=1e-9)


@settings(max_examples=20)
@given(colors, colors, colors, colors)
def test_scielab_of_unresolved_checkerboards_is_the_difference_of_their_means(a, b, c, d):
    seen = scielab_difference(checkerboard(a, b), checkerboard(c, d), D65, pixels_per_degree=2000.0)
    means = cie1976_difference(cielab((a + b) / 2, D65), cielab((c + d) / 2, D65))
    assert seen == pytest.approx(np.full(seen.shape, means), abs=1e-3)


@given(st.integers(0, 10_000), resolutions)
@settings(max_examples=20)
def test_scielab_is_symmetric_in_its_pictures_and_in_reflections(seed, scale):
    one, other = random_picture(seed), random_picture(seed + 1)
    seen = scielab_difference(one, other, D65, pixels_per_degree=scale)
    swapped = scielab_difference(other, one, D65, pixels_per_degree=scale)
    turned = scielab_difference(one[::-1, ::-1], other[::-1, ::-1], D65, pixels_per_degree=scale)
    assert seen == pytest.approx(swapped, abs=1e-9)
    assert seen == pytest.approx(turned[::-1, ::-1], abs=1e-8)


@pytest.mark.parametrize("cycles_per_degree", [0.5, 2.0, 8.0, 16.0])
def test_a_grating_keeps_the_transform_of_the_gaussians_at_its_frequency(cycles_per_degree):
    scale, width = 320.0, 1280  # 4 degrees; the pixel is small beside every Gaussian
    phase = 2 * np.pi * cycles_per_degree * (np.arange(width) + 0.5) / scale
    planes = np.repeat(np.cos(phase)[None, :, None], 3, axis=2)
    seen = scielab_filtered(planes @ np.linalg.inv(OPPONENT).T, pixels_per_degree=scale)
    kept = (seen @ OPPONENT.T)[0, 0] / planes[0, 0]
    for plane, gaussians in enumerate(GAUSSIANS):
        weights, spreads = np.array(gaussians).T
        expected = weights @ np.exp(-((np.pi * spreads * cycles_per_degree) ** 2)) / weights.sum()
        assert kept[plane] == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("scale", [3.0, 7.5])
def test_the_blur_is_a_convolution_of_the_picture_continued_by_mirrors(scale):
    picture = random_picture(3, (14, 11))
    reach, fine = int(5 * 4.336 * scale), 9  # sub-samples of a pixel along each axis
    at = np.arange(-reach, reach + 1)[:, None] + (np.arange(fine) - (fine - 1) / 2) / fine
    mirrored = np.pad(picture @ OPPONENT.T, ((reach, reach), (reach, reach), (0, 0)), "symmetric")
    planes = []
    for plane, gaussians in zip(np.moveaxis(mirrored, -1, 0), GAUSSIANS, strict=True):
        kernel = 0.0
        for weight, spread in gaussians:
            line = np.exp(-((at / (spread * scale)) ** 2)).mean(axis=1)
            kernel = kernel + weight * np.outer(line, line) / line.sum() ** 2
        planes.append(fftconvolve(plane, kernel / kernel.sum(), mode="valid"))
    expected = np.stack(planes, axis=-1) @ np.linalg.inv(OPPONENT).T
    assert scielab_filtered(picture, pixels_per_degree=scale) == pytest.approx(expected, abs=2e-3)


def test_the_share_of_independent_noise_that_passes_is_the_product_sum_of_two_impulse_answers():
    impulse = np.zeros((129, 129, 3))
    impulse[64, 64] = 1.0
    seen = scielab_filtered(impulse @ np.linalg.inv(OPPONENT).T, pixels_per_degree=3.0) @ OPPONENT.T
    expected = np.einsum("hwi,hwj->ij", seen, seen)
    assert scielab_shares(3.0) == pytest.approx(expected, rel=1e-6)


def test_the_weights_are_those_of_the_authors_code_divided_by_their_sums():
    printed = [(1.00327, 0.114416, -0.117686), (0.616725, 0.383275), (0.567885, 0.432115)]
    for gaussians, normalized in zip(GAUSSIANS, printed, strict=True):
        weights = np.array(gaussians)[:, 0]
        assert weights / weights.sum() == pytest.approx(normalized, abs=4e-4)


def test_the_spreads_agree_with_the_full_widths_at_half_maximum_of_the_authors_code():
    printed = [(0.05, 0.225, 7.0), (0.0685, 0.826), (0.0920, 0.6451)]
    for gaussians, full_widths in zip(GAUSSIANS, printed, strict=True):
        spreads = np.array(gaussians)[:, 1]
        assert np.array(full_widths) / np.sqrt(4 * np.log(2)) == pytest.approx(spreads, rel=0.07)


def test_the_inverse_of_the_opponent_matrix_is_that_of_the_authors_code():
    printed = [
        [0.97959616, -1.53471570, 0.44459764],
        [1.18897791, 0.76435496, 0.13512575],
        [1.23183331, 1.16315926, 2.07840759],
    ]
    assert np.linalg.inv(OPPONENT) == pytest.approx(np.array(printed), abs=1e-7)
    luminance, *chromatic = OPPONENT @ D65
    assert np.abs(chromatic).max() < 0.1 * luminance


def test_noise_of_fine_grain_is_seen_less_the_farther_the_picture_is():
    still = uniform(0.4 * D65, (96, 96))
    noisy = still + np.random.default_rng(5).normal(0, 0.02, still.shape)
    seen = [
        scielab_difference(noisy, still, D65, pixels_per_degree=scale).mean()
        for scale in (10.0, 30.0, 60.0, 120.0)
    ]
    assert seen == sorted(seen, reverse=True)
    assert seen[-1] < 0.3 * picture_color_difference(noisy, still, D65).mean()


def test_scielab_takes_another_color_difference():
    one, other = uniform(0.3 * D65), uniform(np.array([0.3, 0.25, 0.2]))
    seen = scielab_difference(
        one, other, D65, pixels_per_degree=60.0, difference=ciede2000_difference
    )
    assert seen == pytest.approx(picture_color_difference(one, other, D65), abs=1e-9)


# --- PSNR and SSIM ---


@given(st.floats(1e-3, 0.9), st.floats(0.5, 300.0))
def test_a_constant_error_of_a_share_of_the_peak_has_that_psnr(share, peak):
    reference = np.random.default_rng(0).uniform(0, peak, (5, 7, 3))
    found = psnr_db(reference + share * peak, reference, peak=peak)
    assert found == pytest.approx(-20 * math.log10(share), abs=1e-6)


def test_the_psnr_of_equal_pictures_is_infinite():
    assert psnr_db(np.ones((2, 2)), np.ones((2, 2))) == math.inf


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_the_ssim_of_uniform_pictures_is_its_luminance_term(first, second):
    found = structural_similarity(np.full((12, 13), first), np.full((12, 13), second))
    assert found == pytest.approx(
        (2 * first * second + 1e-4) / (first**2 + second**2 + 1e-4), rel=1e-6
    )


# --- false color and flats ---


def step_picture(shape=(24, 24)):
    picture = uniform(0.2 * D65, shape)
    picture[:, 12:] = 0.6 * D65
    return picture


@given(st.floats(1.0, 6.0))
def test_the_pixels_near_a_step_are_a_band_of_its_width_and_twice_the_radius(radius):
    near = near_edges(cielab(step_picture(), D65), radius_px=radius)
    assert (near == near[0]).all()
    # central differences see the step from its two neighboring columns
    assert np.flatnonzero(near[0]).tolist() == list(
        range(11 - math.floor(radius), 13 + math.floor(radius))
    )


def test_color_moved_across_an_edge_is_false_color_near_it_and_nowhere_else():
    reference, picture = step_picture(), step_picture()
    picture[:, 11] *= np.array([1.1, 1.0, 0.9])
    found = false_color(picture, reference, D65, radius_px=2.0)
    # f(1.1 t) - f(t) = (1.1^(1/3) - 1) t^(1/3) for t = 0.2, in one of 6 columns
    root = 0.2 ** (1 / 3)
    error = math.hypot(500 * (1.1 ** (1 / 3) - 1) * root, 200 * (1 - 0.9 ** (1 / 3)) * root)
    assert found.near_edges == pytest.approx(error / 6, rel=1e-9)
    assert found.elsewhere == pytest.approx(0.0, abs=1e-9)
    assert found.edge_share == pytest.approx(6 / 24)


@given(st.floats(0.3, 1.5))
def test_an_error_of_lightness_alone_is_no_false_color(factor):
    found = false_color(factor * step_picture(), step_picture(), D65)
    assert found.near_edges == pytest.approx(0.0, abs=1e-9)


def test_the_noise_of_flats_is_that_drawn_whatever_their_means():
    rng = np.random.default_rng(8)
    sd = np.array([0.5, 2.0, 7.0])
    regions = np.repeat(np.arange(4), 5_000).reshape(100, 200)  # 0 is no flat
    means = np.array([[1e4, 0, 0], [1, 2, 3], [50, 60, 70], [-9, 0, 9]])[regions]
    noise = rng.normal(0.0, sd, (100, 200, 3))
    noise[regions == 0] *= 1000
    found = flat_noise_sd(means + noise, regions)
    assert np.all(np.abs(found / sd - 1) < 5 / math.sqrt(2 * 15_000))
    one = flat_noise_sd(means + noise, regions == 2)
    assert one == pytest.approx(np.std((means + noise)[regions == 2], axis=0, ddof=1))


# --- all together ---


def test_the_quality_of_a_picture_has_the_values_of_its_parts():
    reference = step_picture()
    picture = reference + np.random.default_rng(2).normal(0, 0.05, reference.shape)
    found = picture_quality(picture, reference, D65, pixels_per_degree=30.0)
    pixel = picture_color_difference(picture, reference, D65)
    seen = scielab_difference(picture, reference, D65, pixels_per_degree=30.0)
    assert (found.ciede2000_mean, found.scielab_mean) == pytest.approx((pixel.mean(), seen.mean()))
    assert np.mean(pixel <= found.ciede2000_p95) == pytest.approx(0.95, abs=0.01)
    assert np.mean(seen <= found.scielab_p95) == pytest.approx(0.95, abs=0.01)
    assert found.false_color == false_color(picture, reference, D65)


@given(st.floats(0.01, 0.95), st.floats(0.5, 200.0))
def test_the_quality_is_of_encoded_srgb_and_independent_of_the_unit(level, unit):
    gray = uniform(level * unit * D65)
    found = picture_quality(gray, uniform(unit * D65), unit * D65, pixels_per_degree=60.0)
    encoded = float(srgb_from_linear(np.array(level)))
    # the printed matrix of IEC 61966-2-1 maps its white to 1 within 3e-4
    assert found.psnr_db == pytest.approx(-20 * math.log10(1 - encoded), abs=0.2)
    assert found.ssim == pytest.approx((2 * encoded + 1e-4) / (encoded**2 + 1 + 1e-4), rel=1e-3)
    assert found.false_color is None


def test_what_a_display_clips_is_no_error_of_psnr_but_of_color():
    bright = uniform(1.5 * D65)
    found = picture_quality(bright, uniform(1.2 * D65), D65, pixels_per_degree=60.0)
    assert found.psnr_db == math.inf
    assert found.ssim == pytest.approx(1.0)
    assert found.ciede2000_mean > 1


def test_single_precision_gives_the_result_of_double_precision():
    reference = step_picture().astype(np.float32)
    picture = (reference + np.random.default_rng(2).normal(0, 0.05, reference.shape)).astype("f4")
    assert picture_quality(picture, reference, D65, pixels_per_degree=30.0) == picture_quality(
        picture.astype(float), reference.astype(float), D65, pixels_per_degree=30.0
    )


# --- refusals ---


def test_a_number_that_is_not_finite_is_refused():
    bad = step_picture()
    bad[3, 4, 1] = np.nan
    for call in (
        lambda: picture_color_difference(bad, step_picture(), D65),
        lambda: scielab_difference(step_picture(), bad, D65, pixels_per_degree=60.0),
        lambda: psnr_db(bad, step_picture()),
        lambda: structural_similarity(bad[..., 1], bad[..., 1]),
        lambda: false_color(bad, step_picture(), D65),
        lambda: flat_noise_sd(bad, np.ones((24, 24), dtype=int)),
    ):
        with refused_input(requirement="finite"):
            call()


@pytest.mark.parametrize("scale", [0.0, -1.0, np.nan, 1e6])
def test_a_resolution_out_of_range_is_refused(scale):
    with refused_input(subject="pixels_per_degree"):
        scielab_filtered(step_picture(), pixels_per_degree=scale)


def test_pictures_of_other_shapes_are_refused():
    picture = step_picture()
    other = picture[:-1]
    for call in (
        lambda: unwrap(picture_color_difference)(picture, other, D65),
        lambda: unwrap(psnr_db)(picture, other),
    ):
        with refused_input(subject="reference", value=other.shape):
            call()
    with refused_input(subject="picture", value=(24, 24, 2)):
        unwrap(picture_color_difference)(picture[..., :2], picture[..., :2], D65)
    with refused_input(subject="xyz", value=(24, 24)):
        unwrap(scielab_filtered)(picture[..., 0], pixels_per_degree=60.0)
    with refused_input(subject="lab", value=(1, 24, 3)):
        near_edges(picture[:1])
    with refused_input(subject="regions", value=(24, 23)):
        unwrap(flat_noise_sd)(picture, np.ones((24, 23), dtype=int))


def test_what_has_no_white_no_window_no_edge_or_a_flat_of_one_pixel_is_refused():
    one = np.ones((12, 15), dtype=int)
    one[0, 0] = 2
    for subject, call in (
        ("white", lambda: picture_color_difference(*2 * [step_picture()], np.array([1.0, 0, 1]))),
        ("picture", lambda: structural_similarity(*2 * [np.ones((10, 30))])),
        ("reference", lambda: false_color(uniform(D65), uniform(D65), D65)),
        ("regions", lambda: flat_noise_sd(uniform(D65), one)),
    ):
        with refused_input(subject=subject):
            call()


@pytest.mark.parametrize("regions", [np.zeros((12, 15), dtype=int), np.eye(12, 15, 3) * 0.5])
def test_regions_without_flats_or_of_fractions_are_refused(regions):
    with refused_input(subject="regions"):
        flat_noise_sd(uniform(D65), regions)
