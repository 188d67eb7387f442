"""scipy.stats and scipy.integrate as the other code for held, rounded Poisson plus normal."""

from itertools import pairwise

import numpy as np
import pytest
from scipy import integrate, stats

from chromanoise.noise import Readout, read_moments
from chromanoise.noise.readout import expectation


def survival(mean_e, noise_e):
    """P(x > t) of Poisson plus normal, by scipy's distributions."""
    counts = np.arange(int(mean_e + 12 * np.sqrt(mean_e)) + 40)
    weights = stats.poisson.pmf(counts, mean_e)
    weights /= weights.sum()  # scipy's own rounding, 2e-14
    return lambda t: float(stats.norm.sf((t - counts) / noise_e) @ weights)


@pytest.mark.parametrize(
    ("mean_e", "noise_e", "black", "full"),
    [
        (0.2, 1.5, 0.0, 20.0),
        (4.0, 2.0, 0.0, 5.0),
        (12.0, 0.3, 2.5, 9.5),
        (150.0, 4.0, 100.0, 160.0),
        (40.0, 3.0, 70.0, 90.0),
    ],
)
def test_moments_of_held_values_are_integrals_of_the_survival_function(
    mean_e, noise_e, black, full
):
    # E y = a + int P(x > t) dt, E (y - a)^2 = int 2 (t - a) P(x > t) dt over the range
    tail = survival(mean_e, noise_e)
    cuts = np.arange(np.floor(black) + 1, full)

    def integral(f):
        edges = np.unique([black, *cuts, full])
        return sum(integrate.quad(f, *pair, epsabs=1e-14)[0] for pair in pairwise(edges))

    first = integral(tail)
    second = integral(lambda t: 2 * (t - black) * tail(t))
    held = read_moments(
        np.array([mean_e]), read_noise_e=noise_e, readout=Readout(black_e=black, full_well_e=full)
    )
    assert held.mean[0] - black == pytest.approx(first, rel=1e-10, abs=1e-12)
    assert held.variance[0] == pytest.approx(second - first**2, rel=1e-9, abs=1e-12)
    assert held.full_share[0] == pytest.approx(tail(full), rel=1e-10)
    assert held.black_share[0] == pytest.approx(1 - tail(black), rel=1e-9, abs=1e-13)


@pytest.mark.parametrize("bounds", [(0.0, 25.0), (-3.0, 2.0), (8.0, 9.0), (-30.0, -20.0)])
def test_the_dark_held_between_bounds_is_scipys_truncated_normal_with_two_spikes(bounds):
    sd = 6.0
    black, full = bounds
    inner = stats.truncnorm(black / sd, full / sd, scale=sd)
    low, high = stats.norm.cdf(black, scale=sd), stats.norm.sf(full, scale=sd)
    inside = 1 - low - high
    mean = low * black + high * full + inside * inner.mean()
    variance = (
        low * (black - mean) ** 2
        + high * (full - mean) ** 2
        + inside * (inner.var() + (inner.mean() - mean) ** 2)
    )
    held = read_moments(
        np.zeros(1), read_noise_e=sd, readout=Readout(black_e=black, full_well_e=full)
    )
    assert held.mean[0] == pytest.approx(mean, rel=1e-10)
    assert held.variance[0] == pytest.approx(variance, rel=1e-8)


@pytest.mark.parametrize("mean_e", [0.3, 7.0, 980.0, 1000.0, 1.2e6])
@pytest.mark.parametrize("share_of_mean", [0.9, 1.0, 1.05])
def test_electrons_alone_held_at_full_well_are_scipys_poisson_tail(mean_e, share_of_mean):
    # sum n p(n) to b is M P(N < b): E min(N, b) = M P(N <= b - 1) + b P(N > b) with whole b
    full = float(np.ceil(mean_e * share_of_mean))
    mean = mean_e * stats.poisson.cdf(full - 1, mean_e) + full * stats.poisson.sf(full, mean_e)
    held = read_moments(np.array([mean_e]), read_noise_e=0.0, readout=Readout(full_well_e=full))
    assert held.mean[0] == pytest.approx(mean, rel=1e-11)
    assert held.full_share[0] == pytest.approx(stats.poisson.sf(full, mean_e), rel=1e-9, abs=1e-17)


@pytest.mark.parametrize("step", [0.5, 1.0, 3.0, 8.0])
@pytest.mark.parametrize(("mean_e", "noise_e"), [(1.0, 0.2), (6.0, 2.0), (60.0, 5.0)])
def test_codes_are_taken_with_scipys_probability_between_their_thresholds(mean_e, noise_e, step):
    black, full = -2 * step, 20 * step
    tail = survival(mean_e, noise_e)
    codes = np.arange(-2, 21)
    thresholds = [tail((k - 0.5) * step) for k in codes[1:]]
    share = -np.diff([1.0, *thresholds, 0.0])
    mean = share @ (codes * step)
    read = read_moments(
        np.array([mean_e]),
        read_noise_e=noise_e,
        readout=Readout(black_e=black, full_well_e=full, step_e=step),
    )
    assert read.mean[0] == pytest.approx(mean, rel=1e-11)
    assert read.variance[0] == pytest.approx(share @ (codes * step - mean) ** 2, rel=1e-9)
    assert read.full_share[0] == pytest.approx(tail(full + step / 2), rel=1e-9, abs=1e-15)
    assert read.black_share[0] == pytest.approx(1 - tail(black - step / 2), rel=1e-9, abs=1e-13)


@pytest.mark.parametrize("mean_e", [1e-9, 0.3, 12.0, 31.9, 500.0, 3e6])
def test_the_probability_of_a_count_is_scipys(mean_e):
    for count in {0.0, 1.0, 31.0, 32.0, float(np.floor(mean_e)), np.ceil(mean_e + np.sqrt(mean_e))}:
        at = expectation(lambda n, c=count: (n == c) * 1.0, np.array([mean_e]), read_noise_e=0.0)
        # scipy's own rounding: n log M of 4e7 keeps nine digits
        assert at.mean[0] == pytest.approx(stats.poisson.pmf(count, mean_e), rel=1e-8, abs=1e-17)


def test_a_smooth_function_has_the_mean_and_variance_of_scipys_quadrature():
    counts = np.arange(60)
    weights = stats.poisson.pmf(counts, 9.0)

    def mean_of(g):
        return sum(
            w * stats.norm.expect(g, loc=n, scale=1.7) for n, w in zip(counts, weights, strict=True)
        )

    seen = expectation(np.arctan, np.array([9.0]), read_noise_e=1.7)
    mean = mean_of(np.arctan)
    assert seen.mean[0] == pytest.approx(mean, rel=1e-9)
    assert seen.variance[0] == pytest.approx(
        mean_of(lambda x: (np.arctan(x) - mean) ** 2), rel=1e-7
    )
