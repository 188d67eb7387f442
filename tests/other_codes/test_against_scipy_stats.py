"""scipy.stats as the other code: the distribution that is sampled is Poisson plus normal."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import stats

from chromanoise.base.rng import stream
from chromanoise.geometry import ellipse_outline
from chromanoise.metrics import optimal_linear_snr_db
from chromanoise.noise import sample_electrons
from strategies import pixel_with, raw_of

DRAWS = 20_000


def drawn(mean_e, noise_e, seed):
    return sample_electrons(np.full(DRAWS, mean_e), pixel_with(noise_e), stream(seed))


@settings(max_examples=15)
@given(st.floats(0.1, 400.0), st.floats(0.5, 20.0), st.integers(0, 2**32))
def test_samples_follow_a_poisson_plus_a_normal(mean_e, noise_e, seed):
    counts = np.arange(int(stats.poisson.ppf(1e-12, mean_e)), int(stats.poisson.isf(1e-12, mean_e)))
    weights = stats.poisson.pmf(counts, mean_e)

    def cdf(x):
        return stats.norm.cdf((np.asarray(x)[:, None] - counts) / noise_e) @ weights

    sample = drawn(mean_e, noise_e, seed)[:2000]
    assert stats.kstest(sample, cdf).pvalue > 1e-6


def test_photons_without_read_noise_are_whole_and_poisson():
    sample = drawn(3.0, 0.0, seed=22)
    assert (sample == np.round(sample)).all()
    seen = np.bincount(sample.astype(int), minlength=12)[:12]
    expected = stats.poisson.pmf(np.arange(12), 3.0) * DRAWS
    seen, expected = np.append(seen[:11], DRAWS - seen[:11].sum()), expected
    expected[-1] = DRAWS - expected[:11].sum()
    assert stats.chisquare(seen, expected).pvalue > 1e-6


def test_read_noise_alone_is_normal():
    sample = drawn(0.0, 7.0, seed=23)
    assert stats.kstest(sample / 7.0, "norm").pvalue > 1e-6


def test_a_two_sigma_ellipse_holds_86_5_percent_of_a_normal_cloud():
    # chi-square with 2 degrees of freedom: 1 - exp(-2) = 0.8647
    covariance = np.array([[4.0, 1.5], [1.5, 1.0]])
    cloud = stats.multivariate_normal([1.0, -2.0], covariance, seed=7).rvs(DRAWS)
    outline = ellipse_outline(np.array([1.0, -2.0]), covariance, sigmas=2.0, points=361)

    # winding by angle: a point is inside where the outline is farther out in its direction
    def polar(points):
        away = points - np.array([1.0, -2.0])
        return np.arctan2(away[:, 1], away[:, 0]), np.hypot(away[:, 0], away[:, 1])

    angle, radius = polar(outline)
    order = np.argsort(angle)
    at, far = polar(cloud)
    inside = far < np.interp(at, angle[order], radius[order], period=2 * np.pi)
    assert inside.mean() == pytest.approx(0.8647, abs=5 * np.sqrt(0.8647 * 0.1353 / DRAWS))


def test_the_bound_is_the_mahalanobis_distance_of_the_signal_from_darkness():
    from scipy.spatial.distance import mahalanobis

    mean = np.array([100.0, 40.0, 250.0])
    covariance = np.array([[110.0, 5.0, -3.0], [5.0, 60.0, 8.0], [-3.0, 8.0, 300.0]])
    distance = mahalanobis(mean, np.zeros(3), np.linalg.inv(covariance))
    assert 10 ** (float(optimal_linear_snr_db(raw_of(mean, covariance))) / 20) == pytest.approx(
        distance, rel=1e-9
    )
