"""How often the contrast of two noisy readings is that of the scene, within a tolerance."""

import numpy as np
import pytest
from scipy.stats import poisson

import chromanoise as cn
from chromanoise.metrics import contrast_detection_probability, exact_contrast_detection_probability
from chromanoise.noise import reading_distribution
from chromanoise.study.reading_quality import (
    BRIGHT,
    DARK,
    TARGET,
    TOLERANCE,
    best_channel_probability,
    contrast_detection_of,
)
from noise_samples import noise_of
from outcomes import refused_input

PATCHES = [  # bright and dark electrons, noise
    (2.0, 1.0, noise_of(read_noise_e=0.0)),
    (20.0, 12.0, noise_of(read_noise_e=2.0)),
    (0.5, 0.2, noise_of(read_noise_e=0.3)),
    (180.0, 120.0, noise_of(read_noise_e=5.0, prnu=0.02, step_e=1.0)),
    (8.0, 3.0, noise_of(read_noise_e=0.5, step_e=2.0)),
]


def drawn(mean_e, noise, count, rng):
    values = rng.poisson(mean_e, count).astype(float)
    values += np.sqrt(noise.added_variance_e2(np.array([mean_e]))) * rng.standard_normal(count)
    return noise.step_e * np.floor(values / noise.step_e + 0.5) if noise.step_e else values


def contrast_of(bright, dark, kind):
    return (bright - dark) / (dark if kind == "weber" else bright + dark)


@pytest.mark.parametrize("kind", ["weber", "michelson"])
@pytest.mark.parametrize("tolerance", [0.2, 0.5, 1.5])
@pytest.mark.parametrize(("bright", "dark", "noise"), PATCHES)
def test_the_exact_probability_agrees_with_draws(bright, dark, noise, kind, tolerance):
    rng, count = np.random.default_rng(7), 200_000
    high, low = (drawn(mean, noise, count, rng) for mean in (bright, dark))
    true = contrast_of(bright, dark, kind)
    defined = (low > 0) & (high + low > 0)
    found = contrast_of(high[defined], low[defined], kind)
    share = (np.abs(found - true) <= tolerance * true * (1 + 1e-9)).sum() / count
    means = np.array([bright, dark])
    exact = exact_contrast_detection_probability(
        reading_distribution(means, noise), means, tolerance=tolerance, contrast=kind
    )
    assert abs(exact - share) < 4 * np.sqrt(max(share * (1 - share), 1e-5) / count)


def test_counts_agree_with_a_sum_over_all_their_combinations():
    means = np.array([6.0, 4.0])
    n = np.arange(60)
    together = np.outer(poisson.pmf(n, 6.0), poisson.pmf(n, 4.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        contrast = (n[:, None] - n) / n
    inside = (n > 0) & (np.abs(contrast - 0.5) <= 0.25 + 1e-12)
    found = exact_contrast_detection_probability(
        reading_distribution(means, noise_of(read_noise_e=0.0)), means
    )
    assert found == pytest.approx(together[inside].sum(), abs=1e-12)


@pytest.mark.parametrize("kind", ["weber", "michelson"])
def test_many_electrons_are_gaussian(kind):
    means, noise = np.array([1800.0, 1200.0]), noise_of(read_noise_e=30.0)
    exact = exact_contrast_detection_probability(
        reading_distribution(means, noise), means, contrast=kind
    )
    sd = np.sqrt(noise.variance_e2(means))
    found = contrast_detection_probability(
        means[:1], means[1:], bright_sd=sd[:1], dark_sd=sd[1:], contrast=kind
    )
    assert found == pytest.approx(exact, abs=1e-3)


def test_the_order_of_the_patches_does_not_matter():
    bright, dark, sd, other = (np.array([one]) for one in (30.0, 20.0, 4.0, 3.0))
    found = contrast_detection_probability(bright, dark, bright_sd=sd, dark_sd=other)
    assert found == contrast_detection_probability(dark, bright, bright_sd=other, dark_sd=sd)


def test_equal_patches_and_a_tolerance_of_zero_are_refused():
    one, two = np.array([10.0]), np.array([20.0])
    with refused_input(subject="the two patches"):
        contrast_detection_probability(one, one, bright_sd=one, dark_sd=one)
    with refused_input(subject="tolerance", value=0.0):
        contrast_detection_probability(two, one, bright_sd=one, dark_sd=one, tolerance=0.0)


def test_a_dark_reading_below_zero_is_not_detected():
    rng, count = np.random.default_rng(5), 400_000
    high, low = (mean + 10.0 * rng.standard_normal(count) for mean in (2.0, 1.0))
    share = ((low > 0) & (np.abs(high / low - 2.0) <= 0.5)).mean()
    sd = np.array([10.0])
    found = contrast_detection_probability(
        np.array([2.0]), np.array([1.0]), bright_sd=sd, dark_sd=sd
    )
    assert abs(found[0] - share) < 4 * np.sqrt(share / count)


def test_patches_without_noise_are_refused():
    one, two, none = np.array([10.0]), np.array([20.0]), np.zeros(1)
    for sd in ({"bright_sd": none, "dark_sd": one}, {"bright_sd": one, "dark_sd": none}):
        with refused_input(subject="bright_sd, dark_sd", value=0.0):
            contrast_detection_probability(two, one, **sd)


def analyzed(**more):
    settings = {"lux": 5.0, "time_ms": 12.0, "reader": "machine", **more}
    return cn.analyze("onyx-rgb-ircut", **settings).analyses[0]


def test_the_channels_of_a_sensor_agree_with_draws():
    one = analyzed(lux=0.5)
    electrons, rng, count = one.expected_e, np.random.default_rng(11), 200_000
    noise = noise_of(read_noise_e=one.sensor.pixel.read_noise_e)
    for mean, found in zip(electrons, contrast_detection_of(one).channels.values(), strict=True):
        high, low = (drawn(share * mean, noise, count, rng) for share in (BRIGHT, DARK))
        true = BRIGHT / DARK - 1
        share = ((low > 0) & (np.abs(high / low - 1 - true) <= TOLERANCE * true)).mean()
        assert abs(found - share) < 4 * np.sqrt(share * (1 - share) / count)


def test_at_the_least_level_the_best_channel_reaches_the_target():
    level = contrast_detection_of(analyzed()).level_lux
    at, below = (analyzed(lux=factor * level) for factor in (1.0, 0.98))
    assert max(contrast_detection_of(at).channels.values()) == pytest.approx(TARGET, abs=1e-3)
    assert best_channel_probability(at.point, at.matrix) == pytest.approx(TARGET, abs=1e-3)
    assert best_channel_probability(below.point, below.matrix) < TARGET


def test_a_fixed_pattern_may_keep_the_target_out_of_reach():
    assert np.isnan(contrast_detection_of(analyzed(prnu=0.2)).level_lux)


def test_saturated_grays_have_no_contrast():
    assert contrast_detection_of(analyzed(lux=1000.0)) is None
