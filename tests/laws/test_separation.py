"""What an ideal reader tells apart: distances, and how often it names the right patch."""

from dataclasses import replace
from functools import cache
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.optimize import minimize_scalar
from scipy.stats import multivariate_normal, norm, poisson

import chromanoise as cn
from chromanoise.charts.machine_verdicts import machine_sentences
from chromanoise.metrics import (
    exact_separation_probability,
    gaussian_separation_probability,
    independent_coordinates,
    mahalanobis_distance,
    pair_distances,
    separation_probability,
)
from chromanoise.noise import (
    ReadingDistribution,
    Readout,
    few_electrons,
    reading_distribution,
    sensor_moments,
    through,
)
from chromanoise.spectra import PatchPairs, colorchecker
from chromanoise.study.reading_quality import (
    COLOR,
    COLOR_WITHOUT,
    RAW,
    RAW_WITHOUT,
    READINGS,
    contrast_detection_of,
    median_distances,
    raw_outcomes,
    separation_of,
)
from dear import dear_if
from noise_samples import noise_of
from outcomes import refused_input
from strategies import raw_of

ONE_PAIR = np.array([[0, 1]])
SHOT_ONLY = noise_of(read_noise_e=0.0)


def random_pair(rng, p, *, equal=False):
    """Two patches with random means and covariances."""
    roots = [rng.standard_normal((p, p)) + np.eye(p) for _ in range(2)]
    first, second = (root @ root.T + 0.1 * np.eye(p) for root in roots)
    mean = rng.uniform(1.0, 3.0, p)
    other = mean + rng.standard_normal(p)
    return raw_of(mean, first), raw_of(other, first if equal else second)


def correct_share_of_draws(first, second, count, rng):
    """Share of draws whose likelihood is larger for their own patch, and its standard error."""
    right = []
    for own, other in ((first, second), (second, first)):
        drawn = rng.multivariate_normal(own.mean, own.covariance, count)
        mine, theirs = (
            multivariate_normal.logpdf(drawn, one.mean, one.covariance) for one in (own, other)
        )
        right.append((mine > theirs).mean())
    share = float(np.mean(right))
    return share, np.sqrt(share * (1 - share) / (2 * count))


# distances


@settings(max_examples=40, deadline=None)
@given(st.integers(1, 16), st.integers(0, 2**32 - 1))
def test_no_invertible_matrix_changes_a_distance(p, seed):
    rng = np.random.default_rng(seed)
    first, second = random_pair(rng, p)
    turn, _ = np.linalg.qr(rng.standard_normal((p, p)))
    matrix = turn * rng.uniform(0.2, 5.0, p)
    for brightness in (True, False):
        raw, mixed = (
            mahalanobis_distance(*pair, brightness=brightness)
            for pair in (
                (first, second),
                tuple(
                    through(one, matrix, names=one.names, kind="mixed", unit="1")
                    for one in (first, second)
                ),
            )
        )
        assert mixed == pytest.approx(raw, rel=1e-10, abs=1e-7 if not brightness else 0)


def test_a_scale_per_channel_changes_no_digit_of_a_distance():
    first, second = random_pair(np.random.default_rng(3), 4)
    gains = np.diag([1e-6, 3.0, 1e5, 0.2])
    scaled = [through(one, gains, names=one.names, kind="raw", unit="1") for one in (first, second)]
    assert mahalanobis_distance(*scaled) == pytest.approx(
        mahalanobis_distance(first, second), rel=1e-12
    )


@settings(max_examples=30, deadline=None)
@given(st.integers(2, 6), st.integers(0, 2**32 - 1))
def test_without_brightness_the_reader_may_add_any_share_of_both_means(p, seed):
    first, second = random_pair(np.random.default_rng(seed), p)
    shape = np.linalg.inv((first.covariance + second.covariance) / 2)
    difference, both = first.mean - second.mean, first.mean + second.mean

    def squared(factor):
        moved = difference + factor * both
        return moved @ shape @ moved

    least = minimize_scalar(squared, tol=1e-12).fun
    found = mahalanobis_distance(first, second, brightness=False)
    assert found**2 == pytest.approx(least, rel=1e-6, abs=1e-9)


def test_patches_that_differ_in_brightness_alone_are_one_patch_without_it():
    mean, noise = np.array([30.0, 50.0, 20.0]), np.diag([4.0, 5.0, 6.0])
    for p in (1, 2, 3):
        own = noise[:p, :p]
        first, second = raw_of(mean[:p], own), raw_of(0.3 * mean[:p], own)
        assert mahalanobis_distance(first, second) > 9
        assert mahalanobis_distance(first, second, brightness=False) == 0.0  # no rounding is left


def test_many_pairs_have_the_distances_of_each():
    rng = np.random.default_rng(5)
    root = rng.standard_normal((2, 5, 3, 3))
    covariance = root @ np.swapaxes(root, -1, -2) + np.eye(3)
    patches = raw_of(rng.uniform(1, 9, (2, 5, 3)), covariance)
    pairs = np.array(list(combinations(range(5), 2)))
    for brightness in (True, False):
        found = pair_distances(patches, pairs, brightness=brightness)
        assert found.shape == (2, 10)
        for level, (at, (i, j)) in product(range(2), enumerate(pairs)):
            one, other = (
                raw_of(patches.mean[level, k], patches.covariance[level, k]) for k in (i, j)
            )
            expected = mahalanobis_distance(one, other, brightness=brightness)
            assert found[level, at] == pytest.approx(float(expected), rel=1e-12)


def test_a_difference_without_noise_is_endless_and_no_difference_is_none():
    sure = np.diag([0.0, 1.0])
    first = raw_of([1.0, 1.0], sure)
    assert mahalanobis_distance(first, raw_of([2.0, 1.0], sure)) == np.inf
    assert mahalanobis_distance(first, raw_of([1.0, 1.0], sure)) == 0.0


def test_a_matrix_of_dependent_rows_keeps_what_its_rows_span():
    first, second = random_pair(np.random.default_rng(8), 4)
    rows = np.array([[1.0, 0, 2, 1], [0, 1, 1, 0], [1, 1, 3, 1]])  # the last is the sum
    distances = [
        mahalanobis_distance(*(independent_coordinates(one, m) for one in (first, second)))
        for m in (rows, rows[:2])
    ]
    assert distances[0] == pytest.approx(distances[1], rel=1e-12)
    assert distances[0] <= mahalanobis_distance(first, second)


def test_two_measurements_in_other_coordinates_have_no_distance():
    with refused_input(subject="coordinates"):
        mahalanobis_distance(
            raw_of([1.0], [[1.0]]),
            raw_of([1.0], [[1.0]], ("x",)),
        )


# probabilities


@pytest.mark.parametrize("p", [1, 2, 3, 8, 16])
def test_equal_covariances_give_the_normal_distribution_of_half_the_distance(p):
    first, second = random_pair(np.random.default_rng(p), p, equal=True)
    expected = norm.cdf(mahalanobis_distance(first, second) / 2)
    assert gaussian_separation_probability(first, second) == pytest.approx(expected, abs=1e-9)
    found = separation_probability(mahalanobis_distance(first, second))
    assert found == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("variance", [0.04, 0.9, 1.0001, 3.0, 100.0])
@pytest.mark.parametrize("shift", [0.0, 0.5, 4.0])
def test_in_one_channel_it_is_the_larger_of_both_densities(variance, shift):
    width = 40 * max(1.0, np.sqrt(variance))
    at = np.linspace(-width, width + shift, 2_000_001)
    larger = np.maximum(norm.pdf(at), norm.pdf(at, shift, np.sqrt(variance)))
    expected = larger.sum() * (at[1] - at[0]) / 2
    found = gaussian_separation_probability(raw_of([0.0], [[1.0]]), raw_of([shift], [[variance]]))
    assert found == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("p", [2, 3, 4, 16])
def test_unequal_covariances_agree_with_draws(p):
    rng = np.random.default_rng(100 + p)
    first, second = random_pair(rng, p)
    share, error = correct_share_of_draws(first, second, 200_000, rng)
    assert abs(gaussian_separation_probability(first, second) - share) < 4 * error


def test_counts_of_zero_and_one_electron_are_told_apart_by_the_zeros():
    counts = reading_distribution(np.array([0.0, 1.0]), SHOT_ONLY)
    expected = 1 - np.exp(-1.0) / 2  # errs on half of the zeros of the second
    assert exact_separation_probability([counts], ONE_PAIR) == pytest.approx(expected, abs=1e-6)


def test_counts_in_three_channels_agree_with_all_their_combinations():
    means = np.array([[0.5, 2.0, 1.0], [1.5, 1.0, 1.1]])
    shares = [poisson.pmf(np.arange(25), means[:, [k]]) for k in range(3)]
    p, q = (np.einsum("i,j,k->ijk", *(one[i] for one in shares)) for i in range(2))
    channels = [reading_distribution(means[:, k], SHOT_ONLY) for k in range(3)]
    found = exact_separation_probability(channels, ONE_PAIR)
    assert found == pytest.approx(np.maximum(p, q).sum() / 2, abs=1e-5)


@pytest.mark.parametrize("p", [1, 3, 4, 16])
@pytest.mark.parametrize("level_e", [0.003, 0.03, 3.0, 150.0])
def test_few_electrons_with_read_noise_agree_with_draws(p, level_e):
    rng = np.random.default_rng(int(1e4 * level_e) + p)
    means = level_e * rng.uniform(0.3, 1.0, (2, p))
    noise = noise_of(read_noise_e=0.4, dark_e=0.2, step_e=1.0)
    channels = [reading_distribution(means[:, k], noise) for k in range(p)]
    found = float(exact_separation_probability(channels, ONE_PAIR)[0])
    count, right = 100_000, 0.0
    for own in range(2):
        ratio = np.zeros(count)
        for k in range(p):
            drawn = rng.poisson(means[own, k] + 0.2, count) + 0.4 * rng.standard_normal(count)
            code = np.floor(drawn + 0.5)
            values, at = np.unique(code, return_inverse=True)
            n = np.arange(0, int(level_e + 12 * np.sqrt(level_e + 1) + 20))
            up, down = (norm.cdf(values[:, None] + edge - n, scale=0.4) for edge in (0.5, -0.5))
            logs = [
                np.log((up - down) @ poisson.pmf(n, means[i, k] + 0.2) + 1e-300) for i in range(2)
            ]
            ratio += (logs[own] - logs[1 - own])[at]
        right += ((ratio > 1e-9).mean() + 0.5 * (np.abs(ratio) <= 1e-9).mean()) / 2
    error = np.sqrt(max(right * (1 - right), 1e-5) / (2 * count))
    assert abs(found - right) < 4 * error


def test_many_electrons_are_gaussian():
    means = np.array([[400.0, 900.0], [430.0, 880.0]])
    noise = noise_of(read_noise_e=3.0)
    channels = [reading_distribution(means[:, k], noise) for k in range(2)]
    one, other = (raw_of(mean, np.diag(mean + 9.0)) for mean in means)
    assert exact_separation_probability(channels, ONE_PAIR) == pytest.approx(
        float(gaussian_separation_probability(one, other)), abs=1e-3
    )


@pytest.mark.parametrize("p", [1, 2, 16])
@pytest.mark.parametrize("distance", [0.0, 0.002, 0.05, 1.0, 6.0])
def test_tables_of_normal_distributions_have_the_closed_form_of_the_whole_distance(p, distance):
    at = np.linspace(-14.0, 14.0, 4001)
    table = norm.pdf(at - np.array([[0.0], [distance / np.sqrt(p)]]))
    table /= table.sum(axis=1, keepdims=True)
    one = ReadingDistribution(values_e=at, probability=table, width_e=at[1] - at[0])
    found = exact_separation_probability([one] * p, ONE_PAIR)
    assert found == pytest.approx(norm.cdf(distance / 2), abs=1e-6)


def test_an_endless_distance_is_always_right_and_a_negative_one_is_refused():
    assert separation_probability(np.array([np.inf])) == 1.0
    with refused_input(subject="distance"):
        separation_probability(np.array([-1.0]))
    with refused_input(subject="distance"):
        separation_probability(np.array([np.nan]))


# the distribution of one reading

NOISES = [
    SHOT_ONLY,
    noise_of(read_noise_e=0.2),
    noise_of(read_noise_e=5.0, dark_e=3.0, prnu=0.05, black_error_e=1.5),
    noise_of(read_noise_e=0.7, step_e=2.5, dsnu_e=0.3),
]
READOUTS = [Readout(), Readout(black_e=0.0, full_well_e=31.0)]


@pytest.mark.parametrize("noise", NOISES)
@pytest.mark.parametrize("readout", READOUTS)
def test_a_distribution_has_the_mean_and_variance_of_the_exact_moments(noise, readout):
    means = np.array([0.0, 0.4, 7.0, 33.0])
    found = reading_distribution(means, noise, readout)
    moments = sensor_moments(means, noise, readout)
    mean = found.probability @ found.values_e
    variance = found.probability @ found.values_e**2 - mean**2
    assert mean == pytest.approx(moments.mean, rel=2e-3, abs=2e-3)
    assert variance == pytest.approx(moments.variance, rel=2e-3, abs=2e-3)


def test_a_distribution_of_many_electrons_is_refused():
    with refused_input(subject="mean_e", value=3000.0):
        reading_distribution(np.array([3000.0]), SHOT_ONLY)


def test_a_distribution_of_great_noise_is_refused_and_not_needed():
    noise = noise_of(read_noise_e=1e6)
    assert not few_electrons(np.array([1.0]), noise).any()
    with refused_input(subject="noise"):
        reading_distribution(np.array([1.0]), noise)


def test_few_electrons_include_those_of_the_dark():
    mean = np.array([0.0, 950.0, 1001.0])
    assert few_electrons(mean, SHOT_ONLY).tolist() == [True, True, False]
    assert few_electrons(mean, noise_of(read_noise_e=1.0, dark_e=60.0)).tolist() == [
        True,
        False,
        False,
    ]


def test_readings_with_very_little_read_noise_are_as_good_as_counts():
    means = np.array([3.0, 5.0])
    found = [
        exact_separation_probability([reading_distribution(means, noise)], ONE_PAIR)
        for noise in (noise_of(read_noise_e=0.002), SHOT_ONLY)
    ]
    assert found[0] == pytest.approx(found[1], abs=1e-6)
    assert reading_distribution(means, noise_of(read_noise_e=0.002)).values_e.size < 20_000


# sensors


@cache
def analyzed(*sensors, **more):
    return cn.analyze(*sensors, **{"lux": 10.0, "time_ms": 12.0, **more})


MEDIANS = {  # computed by plain numpy; there 56.95 of the first is printed as 57.0
    10.0: (("56.9", "28.0", "12.0"), ("7.7", "8.9", "6.0")),
    1.0: (("15.6", "5.9", "3.2"), ("2.04", "1.79", "1.6")),
    0.3: (("6.8", "2.1", "1.3"), ("0.85", "0.62", "0.64")),
}


@pytest.mark.parametrize("lux", dear_if(lambda lux: lux != 1.0, MEDIANS))
def test_the_medians_of_276_pairs_are_those_that_were_printed(lux):
    four, three = map(separation_of, analyzed("onyx-rgbw", "onyx-rgb-ircut", lux=lux).analyses)
    for (raw, color), printed in zip(
        ((RAW, COLOR), (RAW_WITHOUT, COLOR_WITHOUT)), MEDIANS[lux], strict=True
    ):
        found = (four.median_distance(raw), three.median_distance(raw), four.median_distance(color))
        for median, text in zip(found, printed, strict=True):
            assert f"{median:.{len(text.partition('.')[2])}f}" == text


def test_the_worst_pair_has_the_least_distance_in_raw_values():
    (one,) = analyzed("onyx-rgbw").analyses
    found = separation_of(one)
    assert (found.distance[RAW] >= found.distance[RAW][found.worst]).all()


@pytest.mark.parametrize("lux", [10.0, 0.1, pytest.param(0.01, marks=pytest.mark.evidence)])
@pytest.mark.parametrize("chosen", [slice(None), slice(0, 275)])  # an even and an odd count
def test_median_and_worst_pair_are_those_of_all_pairs(lux, chosen):
    """With brightness and without, distance and probability, from all pairs by sorting."""
    (analysis,) = analyzed("onyx-rgbw", lux=lux).analyses
    pairs = separation_of(analysis).pairs
    pairs = PatchPairs(patches=pairs.patches, indices=pairs.indices[chosen])
    analysis = replace(analysis, pairs=pairs)
    every = separation_of(analysis)
    for reading, outcome in raw_outcomes(analysis).items():
        distances, probabilities = every.distance[reading], every.probability[reading]
        by_distance = sorted(zip(distances, probabilities, pairs.names, strict=True))
        count = len(by_distance)
        middle = by_distance[(count - 1) // 2 : count // 2 + 1]
        assert outcome.median.distance == pytest.approx(every.median_distance(reading), rel=1e-12)
        expected = np.mean([probability for _, probability, _ in middle])
        assert outcome.median.probability == pytest.approx(expected, abs=1e-9)
        distance, probability, names = by_distance[0]
        assert outcome.worst.names == names
        assert outcome.worst.distance == pytest.approx(distance, rel=1e-12)
        assert outcome.worst.probability == pytest.approx(probability, abs=1e-9)
        assert outcome.worst.near_chance == (probability < 0.6)


def test_the_verdict_for_a_machine_names_the_winner_of_the_median_and_of_the_worst_pair():
    """At 10 lx the sensor without IR-cut wins the median, the other one the worst pair."""
    analyses = analyzed("onyx-rgbw", "onyx-rgb-ircut", lux=10.0).analyses
    four, three = map(separation_of, analyses)
    assert four.median_distance(RAW) > three.median_distance(RAW)
    assert four.distance[RAW].min() < three.distance[RAW].min()
    with_brightness, _ = machine_sentences(analyses)
    median, worst = with_brightness.split("; ")
    assert "median pair onyx-rgbw is better" in median
    assert f"{four.median_distance(RAW):#.3g} (" in median
    assert "worst pair onyx-rgb-ircut is better" in worst
    assert f"{three.distance[RAW].min():#.3g} (" in worst
    assert " / ".join(four.pairs.names[four.worst]) in worst
    assert f"{100 * four.probability[RAW].min():.0f} % classified correctly" in worst


def test_of_three_sensors_the_winner_for_a_machine_is_best_and_not_better():
    names = ("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb")
    text = " ".join(machine_sentences(analyzed(*names, lux=10.0).analyses))
    assert " is best, " in text
    assert "better" not in text


def test_no_sensor_leads_where_all_decide_nearly_by_chance():
    analyses = analyzed("onyx-rgbw", "onyx-rgb-ircut", lux=0.01).analyses
    best = max(separation_of(one).median_probability(RAW) for one in analyses)
    assert 0.54 < best < 0.57
    for sentence in machine_sentences(analyses):
        for part in sentence.split("; "):
            assert "nearly chance" in part
            assert "better" not in part


def test_three_channels_lose_nothing_in_three_colors_and_four_do():
    four, three = analyzed("onyx-rgbw", "onyx-rgb-ircut").analyses
    same, less = separation_of(three), separation_of(four)
    for with_or_without in ((RAW, COLOR), (RAW_WITHOUT, COLOR_WITHOUT)):
        raw, color = (same.distance[name] for name in with_or_without)
        assert color == pytest.approx(raw, rel=1e-10)
        raw, color = (less.distance[name] for name in with_or_without)
        assert (color <= raw * (1 + 1e-12)).all()
        assert np.median(color) < 0.9 * np.median(raw)


def test_many_levels_have_the_medians_of_each():
    (one,) = analyzed("onyx-rgbw").analyses
    levels = np.array([0.5, 10.0])
    alone = [separation_of(analyzed("onyx-rgbw", lux=lux).analyses[0]) for lux in levels]
    for reading in READINGS:
        found = median_distances(one.point, one.matrix, reading, level_lux=levels)
        medians = [each.median_distance(reading) for each in alone]
        assert found == pytest.approx(medians, rel=1e-10)


@pytest.mark.parametrize("lux", [1e-9, 1e-3, 0.1])
def test_no_matrix_adds_evidence_where_counts_are_not_gaussian(lux):
    (four,) = analyzed("onyx-rgbw", lux=lux, read_noise_e=0.0).analyses
    found = separation_of(four).probability
    assert (found[COLOR] <= found[RAW]).all()


def test_a_read_noise_that_hides_everything_leaves_chance():
    (blind,) = analyzed("onyx-rgbw", lux=0.1, read_noise_e=1e6).analyses
    found = separation_of(blind)
    assert found.median_probability(RAW) == pytest.approx(0.5, abs=1e-5)
    assert max(contrast_detection_of(blind).channels.values()) < 0.05


def test_prnu_lowers_every_distance_in_raw_values():
    (clean,), (spread,) = analyzed("onyx-rgbw").analyses, analyzed("onyx-rgbw", prnu=0.03).analyses
    assert (separation_of(spread).distance[RAW] < separation_of(clean).distance[RAW]).all()


def test_crosstalk_after_counting_that_can_be_undone_changes_no_distance_of_shot_noise():
    settings = {"mosaic": "bayer", "crosstalk": 0.1, "read_noise_e": 0.0, "time_ms": 2.0}
    plain, mixed = (
        analyzed("model-rgb-ircut", **more).analyses[0]
        for more in (
            {"read_noise_e": 0.0, "time_ms": 2.0},
            {**settings, "crosstalk_stage": "charge"},
        )
    )
    found = [separation_of(one).distance[RAW] for one in (plain, mixed)]
    assert found[1] == pytest.approx(found[0], rel=1e-9)


def test_near_black_the_probability_is_that_of_counts():
    dim, bright = (analyzed("onyx-rgb-ircut", lux=lux).analyses[0] for lux in (0.02, 10.0))
    found = separation_of(dim)
    assert 0.5 < found.median_probability(RAW) < 0.55
    gap = np.abs(found.probability[RAW] - separation_probability(found.distance[RAW]))
    assert gap.max() > 1e-4  # counts are not Gaussian
    at = separation_of(bright)
    assert at.probability[RAW] == pytest.approx(separation_probability(at.distance[RAW]), abs=0.02)


def test_a_saturated_patch_has_no_separation():
    (full,) = analyzed("onyx-rgbw", lux=200.0).analyses
    assert separation_of(full) is None
    assert np.isnan(median_distances(full.point, full.matrix, RAW))


def test_pairs_need_two_patches():
    chart = colorchecker(cn.analyze("onyx-rgbw").points[0].illuminant.grid)
    with refused_input(subject="pairs"):
        PatchPairs(patches=chart, indices=np.zeros((0, 2), dtype=int))
    with refused_input(subject="pairs", value=24):
        PatchPairs(patches=chart, indices=np.array([[0, 24]]))
