"""Noise in CIELAB and CIELUV that a line of algebra, or one integral, can tell."""

import numpy as np
import pytest
from scipy import integrate, special, stats

from chromanoise.color import (
    FIRST_ORDER_TOLERANCE,
    LAB,
    LUV,
    SRGB,
    NoisyColor,
    cubature,
    first_order,
    gaussian_cubature,
    gaussian_expectation,
    propagate,
    relative_sd_error,
)
from strategies import xyz_of

D65 = np.array([0.95047, 1.0, 1.08883])
ONES = np.ones(3)


def noise_of(measurement, method, *, space=LAB, white=D65):
    return propagate(NoisyColor(xyz=measurement, white=white), space, method)


def first_order_error(measurement):
    rough, trusted = (noise_of(measurement, way).measurement for way in (first_order, cubature))
    return relative_sd_error(rough, trusted)


def gray(y, snr_y_db, white=D65, *, common=False):
    """A neutral with the same SNR in X, Y and Z, noise independent or common."""
    sd = y * white / 10 ** (snr_y_db / 20)
    return xyz_of(y * white, np.outer(sd, sd) if common else np.diag(sd**2))


def lightness(y):
    """CIE 015:2018 in its other form: 903.3 Y below 0.008856, both written as fractions."""
    return 24389 / 27 * y if y <= 216 / 24389 else 116 * y ** (1 / 3) - 16


def normal_moments(function, mean, sd):
    """Mean and standard deviation of a function of a normal variable, by adaptive quadrature."""
    kink = (216 / 24389 - mean) / sd

    def integral(of):
        def weighed(z):
            return stats.norm.pdf(z) * of(function(mean + sd * z))

        parts = [integrate.quad(weighed, a, b, epsabs=1e-12)[0] for a, b in ((-9, kink), (kink, 9))]
        return sum(parts)

    first = integral(lambda v: v)
    return first, np.sqrt(integral(lambda v: (v - first) ** 2))


@pytest.mark.parametrize("method", [first_order, cubature])
def test_sigma_of_lightness_is_a_third_of_lightness_plus_16_over_snr(method):
    # Y = 1/8: L* = 42, so 58 / (3 * 100) at 40 dB
    noise = noise_of(gray(0.125, 40.0), method)
    assert noise.sd[0] == pytest.approx(0.193333, rel=2e-4)


def test_the_bias_of_lightness_is_minus_a_ninth_of_it_over_snr_squared():
    # half the second derivative, -(2/9) 116 Y^(-5/3), times the variance: -58 / (9 * 100^2)
    noise = noise_of(gray(0.125, 40.0), cubature)
    assert noise.bias[0] == pytest.approx(-6.4444e-4, rel=5e-4)


def test_lognormal_luminance_has_these_moments_of_lightness():
    # median .18, sigma .3 of ln Y: the moments of a lognormal, E Y^t = exp(t m + t^2 s^2 / 2),
    # give 116 E Y^(1/3) - 16 = 49.824408 and the standard deviation 6.598931; the toe lies 10 sigma
    # below the median
    def powers(logs):
        found = LAB.from_xyz(np.exp(logs), ONES)[..., :1]
        return np.concatenate([found, found**2], axis=-1)

    first, second = gaussian_expectation(powers, np.log(np.full(3, 0.18)), np.diag([0, 0.09, 0]))
    assert first == pytest.approx(49.824408, abs=1e-6)
    assert np.sqrt(second - first**2) == pytest.approx(6.598931, abs=1e-6)


@pytest.mark.parametrize("snr_db", [30.0, 10.0, 5.0, 0.0])
def test_the_cubature_stays_right_in_the_dark(snr_db):
    sd = 0.18 / 10 ** (snr_db / 20)
    mean_exact, sd_exact = normal_moments(lightness, 0.18, sd)
    lab = noise_of(gray(0.18, snr_db), cubature).measurement
    assert lab.mean[0] == pytest.approx(mean_exact, abs=1e-3 * sd_exact)
    assert np.sqrt(lab.variance[0]) == pytest.approx(sd_exact, rel=1e-3)


@pytest.mark.parametrize(("snr_db", "error"), [(12.1, -0.05), (10.0, -0.104), (5.0, -0.425)])
def test_the_first_order_is_too_low_by_this_much(snr_db, error):
    # adaptive quadrature of one normal variable, as above
    _, exact = normal_moments(lightness, 0.18, 0.18 / 10 ** (snr_db / 20))
    by_hand = (lightness(0.18) + 16) / 3 / 10 ** (snr_db / 20) / exact - 1
    assert by_hand == pytest.approx(error, abs=1e-3)
    assert first_order_error(gray(0.18, snr_db))[0] == pytest.approx(error, abs=2e-3)


def test_where_the_first_order_fails_its_error_exceeds_the_tolerance():
    snrs = [20.0, 13.0, 11.0, 5.0]
    errors = [np.abs(first_order_error(gray(0.18, snr))).max() for snr in snrs]
    holds = [bool(error <= FIRST_ORDER_TOLERANCE) for error in errors]
    assert holds == [True, True, False, False]


@pytest.mark.parametrize("space", [LAB, LUV])
@pytest.mark.parametrize("white", [D65, np.array([1.0985, 1.0, 0.3558])])
@pytest.mark.parametrize("snr_db", [40.0, 10.0, 0.0])
def test_noise_common_to_x_y_z_leaves_the_color_of_a_neutral_still(space, white, snr_db):
    neutral = gray(0.18, snr_db, white, common=True)
    rough, noise = (
        noise_of(neutral, method, space=space, white=white) for method in (first_order, cubature)
    )
    assert rough.sd[1:] == pytest.approx([0, 0], abs=1e-12)
    assert noise.sd[1:] == pytest.approx([0, 0], abs=1e-11)
    assert noise.chroma_sd == pytest.approx(0, abs=1e-11)
    # what is left is lightness, and its mean deviation
    first_sd = (lightness(0.18) + 16) / 3 / 10 ** (snr_db / 20)
    assert rough.delta_e == pytest.approx(np.sqrt(2 / np.pi) * first_sd, rel=1e-9)


def test_equal_noise_in_l_a_b_makes_a_maxwell_color_difference_and_a_rayleigh_chroma():
    # of three normals of sd s the length has mean 2 sqrt(2/pi) s = 1.595769 s; of two, the mean
    # sqrt(pi/2) s = 1.253314 s and the sd sqrt(2 - pi/2) s = 0.655136 s
    s = 1e-3
    rows = np.linalg.inv(np.array([[0, 116.0, 0], [500, -500, 0], [0, 200, -200]]) * 4 / 3)
    noisy = xyz_of(np.full(3, 0.125), s**2 * rows @ rows.T)
    rough, noise = (noise_of(noisy, method, white=ONES) for method in (first_order, cubature))
    assert noise.sd == pytest.approx([s, s, s], rel=1e-6)
    assert noise.delta_e == pytest.approx(1.595769 * s, rel=1e-5)
    assert noise.chroma_bias == pytest.approx(1.253314 * s, rel=3e-4)
    assert noise.chroma_sd == pytest.approx(0.655136 * s, rel=1e-3)
    assert rough.chroma_sd == pytest.approx(s, rel=1e-6)
    assert rough.delta_e == pytest.approx(1.5957691216 * s, rel=1e-9)


def test_noise_in_two_directions_makes_an_elliptic_color_difference():
    # E sqrt(a^2 x^2 + b^2 y^2) = sqrt(2 / pi) a E(1 - b^2 / a^2) with the complete elliptic
    # integral; X has more noise, but in its toe Z shows more: 200 * 841/108 against 500 / 3
    noisy = xyz_of(np.array([1.0, 0.2, 0.004]), np.diag([1.01e-6, 0.0, 1e-6]) ** 2)
    a, b = 200 * 841 / 108 * 1e-6, 500 / 3 * 1.01e-6
    expected = np.sqrt(2 / np.pi) * a * special.ellipe(1 - (b / a) ** 2)
    assert noise_of(noisy, cubature, white=ONES).delta_e == pytest.approx(expected, rel=2e-5)
    assert noise_of(noisy, first_order, white=ONES).delta_e == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("method", [first_order, cubature])
def test_in_the_toe_noise_is_903_3_times_that_of_y_and_unbiased(method):
    noise = noise_of(xyz_of(-0.2 * ONES, 1e-4 * np.eye(3)), method, white=ONES)
    lab = noise.measurement
    assert lab.mean[0] == pytest.approx(-180.659, abs=1e-3)  # 24389 / 27 * -0.2
    assert np.sqrt(lab.variance[0]) == pytest.approx(9.03296, abs=1e-5)


@pytest.mark.parametrize("method", [first_order, cubature])
def test_in_the_toe_of_srgb_common_noise_grows_12_92_fold(method):
    noise = noise_of(gray(-0.1, 20.0, common=True), method, space=SRGB)
    assert noise.sd == pytest.approx(np.full(3, 0.1292), rel=3e-4)


def test_where_noise_hides_the_light_cieluv_bends_its_pole_into_a_line():
    # X = .25, Y = -.01: d = X + 15 Y = .1 and a = |X| + 15 |Y| = .4, so d stands for 1/d as
    # d / (a^2 / 4) = 2.5: u' = 2.5, v' = -.225 beside 4/19 and 9/19 of the white; L* = -9.03296
    luv = LUV.from_xyz(np.array([0.25, -0.01, 0.0]), ONES)
    assert luv == pytest.approx([-9.03296, -268.850, 82.0455], rel=1e-5)


def test_the_cubature_knows_the_moments_of_a_normal_variable():
    rule = gaussian_cubature()
    x, y, z = rule.points.T
    values = [x**2, y**4, x**2 * z**2, x**6, x * y, x**3 * z, z**5, np.abs(x)]
    found = [float(rule.weights @ value) for value in values]
    assert found == pytest.approx([1, 3, 1, 15, 0, 0, 0, 0.797884561], abs=1e-9)
    assert rule.weights @ np.linalg.norm(rule.points, axis=1) == pytest.approx(1.595769, abs=1e-6)
