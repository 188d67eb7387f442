"""Read noise: drawn by itself where electrons are few or it is weak, else with them as one sum."""

from math import comb

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import stats
from scipy.special import ndtri

import reference_noise as reference
from chromanoise.imaging.blocks import READOUT
from chromanoise.imaging.sampling import noisy_electrons
from goodness import chi_square_score, correlation_z, kolmogorov_p_at, scores_of_moments

APART = [(0.0, 2.0), (1.0, 2.0), (19.9, 0.75), (100.0, 0.7)]  # mean and read noise in electrons
TOGETHER = [(20.0, 0.75), (20.0, 3.0), (30.0, 1.0), (100.0, 0.75), (1e3, 20.0), (1e4, 2.0)]


def drawn(mean_e, *, read_noise_e, side=512, seed=11, frame=0):
    mean = np.full((side, side, 4), mean_e, dtype=np.float32)
    return noisy_electrons(mean, read_noise_e=read_noise_e, seed=seed, frame=frame)


@pytest.mark.parametrize(("mean", "noise"), APART)
def test_read_noise_drawn_by_itself_is_normal_and_added_to_whole_electrons(mean, noise):
    quiet, noisy = drawn(mean, read_noise_e=0.0), drawn(mean, read_noise_e=noise)
    added = (noisy.astype(np.float64) - quiet) / noise
    assert stats.kstest(added.ravel(), "norm").pvalue > 6e-7  # |z| < 5
    fourth = (np.mean(added**4) - 3) / np.sqrt(96 / added.size)  # 105 - 3^2
    assert np.abs(fourth) < 5
    assert np.abs(added).max() > 4.5


@pytest.mark.parametrize(("mean", "noise"), APART[1:])
def test_shot_noise_says_nothing_of_read_noise_drawn_by_itself(mean, noise):
    quiet = drawn(mean, read_noise_e=0.0)
    added = drawn(mean, read_noise_e=noise) - quiet
    assert np.abs(correlation_z(quiet - mean, added)) < 5


def test_read_noise_of_a_dark_picture_is_the_quantile_of_its_word():
    shape = (100, 200, 10)
    noise = noisy_electrons(np.zeros(shape, np.float32), read_noise_e=1.0, seed=8)
    share = (reference.words_for(READOUT, shape, seed=8) + 0.5) / 2**32
    np.testing.assert_allclose(noise, ndtri(share), rtol=5e-7, atol=5e-7)


def possible(mean):
    """Numbers of electrons that a Poisson variate may have."""
    return np.arange(mean + 12 * np.sqrt(mean) + 60)


def chance_below(x, mean, noise):
    """Of a Poisson variate plus a normal one: the chance of each number of electrons in turn."""
    electrons = possible(mean)
    chance = stats.poisson.pmf(electrons, mean)
    return np.array([(chance * stats.norm.cdf((one - electrons) / noise)).sum() for one in x])


def moments_of_sum(mean, noise):
    """About the mean, orders 0 to 8, from those of both terms."""
    electrons = possible(mean)
    chance = stats.poisson.pmf(electrons, mean)
    shot = [(chance * (electrons - mean) ** k).sum() for k in range(9)]
    read = [noise**k * float(stats.norm.moment(k)) if k else 1.0 for k in range(9)]
    return [sum(comb(k, j) * shot[j] * read[k - j] for j in range(k + 1)) for k in range(9)]


def law_scores(drawn_e, mean, noise):
    """Chi-square, the chance by Kolmogorov, and four moments of draws of a sum."""
    mean, noise = float(np.float32(mean)), float(np.float32(noise))
    edges = mean + np.sqrt(mean + noise**2) * np.linspace(-4, 4, 321)
    law = chance_below(edges, mean, noise)
    values = np.concatenate([np.asarray(some, np.float64).ravel() for some in drawn_e])
    found = np.histogram(values, np.concatenate([[-np.inf], edges, [np.inf]]))[0]
    moments = [float(np.mean((values - mean) ** k)) for k in range(5)]
    return (
        chi_square_score(found, np.diff(np.concatenate([[0.0], law, [1.0]]))),
        kolmogorov_p_at(np.cumsum(found)[:-1], law, values.size),
        scores_of_moments(moments, moments_of_sum(mean, noise), values.size),
    )


def assert_sum(drawn_e, mean, noise):
    chi, kolmogorov_p, moments = law_scores(drawn_e, mean, noise)
    assert chi < 5
    assert kolmogorov_p > 6e-7  # |z| < 5
    assert np.abs(moments).max() < 5


@pytest.mark.parametrize(("mean", "noise"), TOGETHER)
def test_one_word_draws_a_poisson_variate_plus_a_normal_one(mean, noise):
    assert_sum([drawn(mean, read_noise_e=noise)], mean, noise)


@pytest.mark.parametrize(
    "fake",
    [
        lambda rng, size: rng.normal(30.0, np.sqrt(31.0), size),  # no skewness
        lambda rng, size: rng.poisson(30.0, size) + rng.normal(0.0, 1.1, size),
        lambda rng, size: rng.poisson(30.0, size) + rng.uniform(-(3**0.5), 3**0.5, size),
    ],
    ids=["a Gaussian", "a tenth more read noise", "uniform read noise"],
)
def test_another_law_would_be_noticed(fake):
    drawn_e = fake(np.random.default_rng(0), 8 * 512**2)
    chi, kolmogorov_p, moments = law_scores([drawn_e], 30.0, 1.0)
    assert chi > 5 or kolmogorov_p < 6e-7 or np.abs(moments).max() > 5


@given(st.floats(20.0, 1e5), st.floats(1e-6, 1e3), st.floats(0.75, 100.0), st.integers(0, 99))
def test_from_20_electrons_on_more_light_never_gives_a_lower_reading(mean, more, noise, frame):
    low, high = (
        drawn(level, read_noise_e=noise, side=16, frame=frame)
        for level in (mean, mean * (1 + more) + 1e-3)
    )
    assert (high >= low).all()
    bright = drawn(1e6, read_noise_e=noise, side=16, frame=frame)
    assert bright.min() > 9e5  # anchored: of 10^6 they stray by some 10^3


@pytest.mark.parametrize("noise", [0.75, 5.0])
def test_where_the_two_ways_meet_the_law_is_the_same(noise):
    below, above = np.nextafter(np.float32(20), np.float32(0)), 20.0
    for mean in (below, above):
        assert_sum([drawn(mean, read_noise_e=noise)], mean, noise)


@pytest.mark.evidence
@pytest.mark.parametrize(("mean", "noise"), TOGETHER)
def test_a_hundred_million_draws_are_a_poisson_variate_plus_a_normal_one(mean, noise):
    frames = (drawn(mean, read_noise_e=noise, side=1024, seed=21, frame=f) for f in range(24))
    assert_sum(frames, mean, noise)
