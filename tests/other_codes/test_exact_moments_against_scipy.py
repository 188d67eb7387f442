"""scipy.stats and scipy.integrate as the other code for held, rounded Poisson plus normal."""

import numpy as np
import pytest
from scipy import stats

from chromanoise.noise import Readout, read_moments
from chromanoise.noise.readout import expectation


@pytest.mark.parametrize("mean_e", [0.3, 7.0, 980.0, 1000.0, 1.2e6])
@pytest.mark.parametrize("share_of_mean", [0.9, 1.0, 1.05])
def test_electrons_alone_held_at_full_well_are_scipys_poisson_tail(mean_e, share_of_mean):
    # sum n p(n) to b is M P(N < b): E min(N, b) = M P(N <= b - 1) + b P(N > b) with whole b
    full = float(np.ceil(mean_e * share_of_mean))
    mean = mean_e * stats.poisson.cdf(full - 1, mean_e) + full * stats.poisson.sf(full, mean_e)
    held = read_moments(np.array([mean_e]), read_noise_e=0.0, readout=Readout(full_well_e=full))
    assert held.mean[0] == pytest.approx(mean, rel=1e-11)
    assert held.full_share[0] == pytest.approx(stats.poisson.sf(full, mean_e), rel=1e-9, abs=1e-17)


@pytest.mark.parametrize("mean_e", [1e-9, 0.3, 12.0, 31.9, 500.0, 3e6])
def test_the_probability_of_a_count_is_scipys(mean_e):
    for count in {0.0, 1.0, 31.0, 32.0, float(np.floor(mean_e)), np.ceil(mean_e + np.sqrt(mean_e))}:
        at = expectation(lambda n, c=count: (n == c) * 1.0, np.array([mean_e]), read_noise_e=0.0)
        # scipy's own rounding: n log M of 4e7 keeps nine digits
        assert at.mean[0] == pytest.approx(stats.poisson.pmf(count, mean_e), rel=1e-8, abs=1e-17)


@pytest.mark.evidence
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
