"""Moments near black and full well that are known from a table, a theorem or a draw."""

import math

import numpy as np
import pytest

from chromanoise.noise import Readout, monte_carlo, read_moments
from chromanoise.noise.readout import coded_moments, expectation
from strategies import pixel_with

MEANS = np.array([0.0, 0.5, 3.0, 30.0, 9_900.0, 10_000.0, 12_000.0])


def lightness(electrons_of_white):
    """CIELAB L* of a Y that is measured, its linear toe extended to negative Y (CIE 015:2018)."""

    def of(electrons):
        y = electrons / electrons_of_white
        root = np.cbrt(np.maximum(y, 0.0))
        return np.where(y > 216 / 24389, 116 * root - 16, 24389 / 27 * y)

    return of


@pytest.mark.parametrize("read_noise_e", [0.3, 1.0, 10.0])
def test_zero_signal_held_at_black_reads_0_39894_of_the_noise(read_noise_e):
    # half-normal: 1 / sqrt(2 pi) = 0.398942; mean square 1/2 (docs/numbers.md)
    held = read_moments(
        np.array([0.0]), read_noise_e=read_noise_e, readout=Readout(black_e=0.0, full_well_e=1e4)
    )
    assert held.mean[0] == pytest.approx(0.398942 * read_noise_e, rel=2e-6)
    assert held.bias[0] == held.mean[0]
    assert held.variance[0] + held.mean[0] ** 2 == pytest.approx(read_noise_e**2 / 2, rel=1e-12)
    assert held.black_share[0] == 0.5


def test_anscombe_of_4_electrons_has_mean_4_062173_and_sd_0_999377():
    # 2 sqrt(n + 3/8): F. J. Anscombe, Biometrika 35 (1948) 246; the sum of 40 terms by hand
    terms = [
        (math.exp(-4) * 4.0**n / math.factorial(n), 2 * math.sqrt(n + 0.375)) for n in range(40)
    ]
    by_hand = sum(p * g for p, g in terms)
    seen = expectation(lambda n: 2 * np.sqrt(n + 0.375), np.array([4.0]), read_noise_e=0.0)
    assert seen.mean[0] == pytest.approx(4.062173, abs=5e-7)
    assert seen.mean[0] == pytest.approx(by_hand, rel=1e-13)
    assert math.sqrt(seen.variance[0]) == pytest.approx(0.999377, abs=5e-7)


@pytest.mark.parametrize(
    ("mean_e", "read_noise_e", "mean", "sd"),
    [
        (10.0, 2.0, 48.2704, 9.2548),
        (10.0, 0.0, 48.7196, 7.1842),
        (100.0, 2.0, 49.4199, 2.2349),
    ],
)
def test_lightness_of_a_noisy_18_percent_grey(mean_e, read_noise_e, mean, sd):
    # exact sums, docs/numbers.md; without noise L* is 49.4961
    white = mean_e / 0.18
    seen = expectation(
        lightness(white),
        np.array([mean_e]),
        read_noise_e=read_noise_e,
        kinks_e=(216 / 24389 * white,),
    )
    assert seen.mean[0] == pytest.approx(mean, abs=5e-5)
    assert math.sqrt(seen.variance[0]) == pytest.approx(sd, abs=5e-5)


def test_a_bend_that_is_not_told_moves_lightness_by_less_than_1e_5():
    white = 10 / 0.18
    values, untold = (
        expectation(lightness(white), np.array([10.0]), read_noise_e=2.0, kinks_e=kinks)
        for kinks in ((216 / 24389 * white,), ())
    )
    assert untold.mean == pytest.approx(values.mean, abs=1e-5)
    assert untold.variance == pytest.approx(values.variance, abs=1e-3)


def test_at_99_percent_of_full_well_15_9_percent_are_held_there():
    # the normal limit (docs/numbers.md; Tobin 1958 for the moments): 1 - Phi(1) = 0.158655,
    # E min(Z, 1) = -0.083315, variance 0.751088, with sd 100. The skewness g = 0.0099 moves them
    # by g/6 times, at Z = 1: 0 (share), -phi(1) (mean), and 2.2e-3 of the variance
    held = read_moments(
        np.array([9_900.0]), read_noise_e=10.0, readout=Readout(black_e=0.0, full_well_e=1e4)
    )
    assert held.full_share[0] == pytest.approx(0.158655, abs=5e-6)
    assert held.bias[0] == pytest.approx(-8.3315 - 100 * 0.0099 / 6 * 0.241971, abs=2e-3)
    assert held.variance[0] == pytest.approx(7510.88, rel=3e-3)
    assert held.black_share[0] == 0.0


def test_monte_carlo_held_between_black_and_full_well_agrees_in_mean_variance_and_share():
    # 50 batches of 20,000 acquisitions; their own scatter is the error bar
    batches = [
        monte_carlo(MEANS, pixel_with(), np.eye(7), draws=20_000, seed=seed, clip=True)
        for seed in range(50)
    ]
    exact = read_moments(
        MEANS, read_noise_e=10.0, readout=Readout(black_e=0.0, full_well_e=10_000.0)
    )
    for drawn, known in [
        (np.array([batch.mean for batch in batches]), exact.mean),
        (np.array([batch.sd for batch in batches]) ** 2, exact.variance),
        (
            np.array([batch.clipped_share for batch in batches]),
            exact.black_share + exact.full_share,
        ),
    ]:
        error = drawn.std(axis=0, ddof=1) / math.sqrt(len(batches))
        # at 12,000 e- every draw is held, and at 9,900 e- and beyond none is black: no error at all
        z = (drawn.mean(axis=0) - known) / np.where(error > 0, error, 1e-9)
        assert np.abs(z).max() < 5


@pytest.mark.parametrize("noise_per_step", [1.4, 1.5, 3.0, 100.0])
def test_rounding_wide_noise_adds_a_twelfth_of_the_squared_step(noise_per_step):
    # Sheppard's correction, exact but for exp(-2 pi^2 (s/q)^2); EMVA 1288 R4.0 Linear, eq. 13
    step = 0.7
    noise = noise_per_step * step
    read = read_moments(np.array([37.3]), read_noise_e=noise, readout=Readout(step_e=step))
    assert read.mean[0] == pytest.approx(37.3, rel=1e-12)
    assert read.variance[0] == pytest.approx(37.3 + noise**2 + step**2 / 12, rel=1e-12)
    summed = coded_moments(
        np.array([37.0]), read_noise_e=noise, black_e=-1e9, full_well_e=1e9, step_e=step
    )
    assert summed[1, 0] == pytest.approx(noise**2 + step**2 / 12, rel=1e-12)


@pytest.mark.parametrize(
    ("mean_e", "noise", "step"),
    [(3.0, 0.8, 2.0), (0.4, 0.3, 1.0), (5.0, 1.0, 7.0), (0.4, 1.0, 1.3)],
)
def test_the_bias_of_coarse_rounding_is_widrows_fourier_series(mean_e, noise, step):
    # x - Q(x) = (q/pi) sum (-1)^(k+1) sin(2 pi k x / q) / k; its mean is the imaginary part of the
    # characteristic function of Poisson plus normal (Widrow & Kollar, Quantization Noise, 2008)
    k = np.arange(1, 60)
    u = 2 * np.pi * k / step
    characteristic = np.exp(mean_e * (np.exp(1j * u) - 1) - (noise * u) ** 2 / 2)
    bias = step / np.pi * np.sum((-1.0) ** k / k * characteristic.imag)
    read = read_moments(np.array([mean_e]), read_noise_e=noise, readout=Readout(step_e=step))
    assert read.bias[0] == pytest.approx(bias, abs=1e-12)


def test_whole_electrons_rounded_to_pairs_lose_their_odd_ones():
    # step 2, a tie goes up: n -> n + 1 for odd n, whose share is (1 - exp(-2 M)) / 2
    read = read_moments(np.array([1.0]), read_noise_e=0.0, readout=Readout(step_e=2.0))
    assert read.bias[0] == pytest.approx((1 - math.exp(-2)) / 2, rel=1e-13)


def test_a_code_six_sigma_away_is_taken_with_its_own_small_probability():
    # 1 - Phi(6.5) = erfc(6.5 / sqrt 2) / 2, by the C library
    tail = math.erfc(6.5 / math.sqrt(2)) / 2
    readout = Readout(black_e=-6.0, full_well_e=6.0, step_e=1.0)
    read = read_moments(np.array([0.0]), read_noise_e=1.0, readout=readout)
    assert read.full_share[0] == pytest.approx(tail, rel=1e-12, abs=0)
    assert read.full_share[0] == pytest.approx(read.black_share[0], rel=1e-12, abs=0)


@pytest.mark.parametrize("mean_e", [3.0, 40.0, 1e6, 2.5e8])
def test_neighboring_counts_stand_to_each_other_as_the_mean_to_the_count(mean_e):
    # p(n) / p(n - 1) = M / n, to the last digits even for many electrons
    count = math.floor(mean_e + math.sqrt(mean_e))
    here, before = (
        expectation(lambda n, c=c: (n == c) * 1.0, np.array([mean_e]), read_noise_e=0.0).mean[0]
        for c in (count, count - 1)
    )
    assert here / before == pytest.approx(mean_e / count, rel=3e-12)


def test_a_one_bit_pixel_reads_1_minus_exp_minus_m():
    # E. R. Fossum's quanta image sensor: any photon saturates; P(N >= 1) = 1 - exp(-M), and the
    # variance of a coin; Fossum, IEEE J. Electron Devices Soc. 1 (2013) 166, eq. 2
    mean = np.array([0.01, 0.7, 3.0])
    read = read_moments(mean, read_noise_e=0.0, readout=Readout(black_e=0.0, full_well_e=1.0))
    assert read.mean == pytest.approx(-np.expm1(-mean), rel=1e-12)
    assert read.variance == pytest.approx(-np.expm1(-mean) * np.exp(-mean), rel=1e-12)
