"""The sampler of training data: its distribution, its variance, its switches, its order."""

import pickle
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from numba import vectorize
from scipy import stats
from scipy.special import ndtr

from chromanoise.apps.training import sampler
from chromanoise.apps.training.training_kernels import count_by_table, tail_scores
from chromanoise.apps.training.training_noise import counted_below_e
from chromanoise.apps.training.unprocessing import AddCameraNoise, NoisyDataset
from chromanoise.imaging.noise_draws import ALIASES, exponential_less_one, read_quantile_of_many
from chromanoise.sensor import CameraNoise, LogLinearNoise, ReadNoiseSum, bayer
from outcomes import refused_input

SUMS = vectorize(lambda mean, variance, z: read_quantile_of_many(mean, variance, z))
LESS_ONE = vectorize(lambda x: exponential_less_one(x))
PARTS = ("shot", "read", "dark", "prnu", "dsnu", "row", "column", "telegraph", "quantize", "clamp")
OFF = dict.fromkeys(PARTS, False)


def mono(*, gain=1.0, read_e=2.0, black=64.0, top=4095.0, **others):
    return CameraNoise(
        names=("W",),
        gain_dn_per_e=np.array([gain]),
        read_noise_e=np.array([read_e]),
        black_level_dn=np.array([black]),
        top_code_dn=top,
        **others,
    )


def color(**others):
    return CameraNoise(
        names=("R", "G", "B"),
        mosaic=bayer(),
        gain_dn_per_e=np.array([0.5, 1.0, 2.0]),
        read_noise_e=np.array([6.0, 3.0, 2.0]),
        black_level_dn=np.array([100.0, 200.0, 300.0]),
        top_code_dn=16383.0,
        **others,
    )


FULL = {
    "dark_current_e_per_s": 30.0,
    "dsnu_e": 3.0,
    "prnu": 0.02,
    "row_noise_e": 2.0,
    "column_noise_e": 1.5,
    "rtn_share": 0.2,
    "rtn_amplitude_e": 10.0,
}


# ---- distribution ----


def code_law(mean, *, gain, read_e, black, top):
    """Codes and their distribution function: a sum over counts, rounded and clipped."""
    reach = 9.5 * np.sqrt(mean + 1) + 20
    counts = np.arange(max(0, int(mean - reach)), int(mean + reach))
    share = stats.poisson.pmf(counts, mean)
    sd = gain * np.hypot(np.sqrt(mean), read_e) + 1
    low = min(top, max(0, int(black + gain * mean - 9 * sd)))
    codes = np.arange(low, min(top, int(black + gain * mean + 9 * sd + 40)) + 1)
    below = np.empty(codes.size)
    for i in range(0, codes.size, 256):
        edge = codes[i : i + 256, None] + 0.5 - black - gain * counts
        below[i : i + 256] = (share * ndtr(edge / (gain * read_e))).sum(axis=1)
    below[codes == top] = 1.0
    return codes, np.minimum(below, 1.0)


def randomized_p(found, codes, below, rng):
    """Kolmogorov test of a discrete law: each code is spread uniformly over its step."""
    at = np.searchsorted(codes, found)
    under = np.concatenate([[0.0], below])
    share = under[at] + rng.random(found.size) * (under[at + 1] - under[at])
    return stats.kstest(share, "uniform").pvalue


def codes_of(law, light, seed):
    sample = sampler(mono(**law), seed=seed)(light, unit="electron", item=seed)
    return np.rint(sample.noisy.astype(np.float64) * law["gain"] + law["black"]).astype(int)


def p_of_codes(codes, mean, law, rng):
    return randomized_p(codes.ravel(), *code_law(float(np.float32(mean)), **law), rng)


def p_of_setting(number, draws, largest_mean=5000, *, series=16):
    rng = np.random.default_rng([series, number])
    mean = float(np.exp(rng.uniform(np.log(0.05), np.log(largest_mean))))
    law = {
        "gain": float(np.exp(rng.uniform(np.log(0.1), np.log(8)))),
        "read_e": float(np.exp(rng.uniform(np.log(0.2), np.log(15)))),
        "black": float(rng.choice([0, 16, 64, 512])),
    }
    middle = law["black"] + law["gain"] * mean
    law["top"] = int(rng.choice([4095, max(law["black"] + 20, middle + 10), 65535]))
    side = int(np.sqrt(draws))
    light = np.full((side, draws // side), mean)
    return p_of_codes(codes_of(law, light, number), mean, law, rng)


def test_codes_follow_the_exact_rounded_clipped_law():
    chances = np.array([p_of_setting(number, 40_000, 200) for number in range(20)])
    assert chances.min() > 1e-3
    assert stats.kstest(chances, "uniform").pvalue > 1e-3


@pytest.mark.evidence
@pytest.mark.parametrize("series", [16, 17])
def test_a_million_codes_follow_the_exact_law_in_each_of_200_settings(series):
    """Of the exact law itself 1 % of the settings have p < 0.01: 2 of 200, more than 7 never."""
    chances = np.array([p_of_setting(number, 1_000_000, series=series) for number in range(200)])
    print(f"p > 0.01 in {np.mean(chances > 0.01):.1%}, least {chances.min():.2g}")
    assert (chances <= 0.01).sum() <= stats.binom.isf(1e-3, 200, 0.01)
    assert stats.kstest(chances, "uniform").pvalue > 1e-3


@pytest.mark.parametrize("read_e", [0.75, 0.9, 1.0, 1.3, 1.5, 1.8, 2.0, 2.3, 2.6, 2.66, 3.0, 6.0])
def test_the_sum_of_electrons_and_read_noise_has_the_exact_chances(read_e):
    least, variance, z = counted_below_e(read_e), np.float32(read_e**2), np.linspace(-5.5, 5.5, 400)
    for mean in least + np.array([0.0, 0.02, 0.1, 0.5, 1.0, 2.0, 4.0, 7.0, 12.0, 20.0]):
        arguments = np.float32(mean), variance, z.astype(np.float32)
        found = SUMS(*arguments).astype(np.float64)
        counts = np.arange(int(mean + 12 * np.sqrt(mean) + 40))
        edges = (found[:, None] - counts) / read_e
        chance = ndtr(edges) @ stats.poisson.pmf(counts, float(arguments[0]))
        assert abs(chance - ndtr(z)).max() < 5.5e-6


def test_the_table_of_counts_has_the_chances_of_poisson_to_a_unit_of_the_word():
    for cell, row in enumerate(ALIASES.view(np.uint32).reshape(-1, 64).astype(np.int64)):
        own = row >> 6
        chance = (own + np.bincount(row & 63, (1 << 26) - own, minlength=64)) / 2.0**32
        wanted = stats.poisson.pmf(np.arange(64), cell / 2)
        assert chance == pytest.approx(wanted, abs=2e-9)


def counts_of(mean, words):
    room = np.empty((3, words.size), np.float32)
    means, electrons = np.full(words.size, mean, np.float32), np.full(words.size, -1, np.float32)
    scratch = room[0].view(np.int32), room[1], room[2]
    count_by_table(means, np.float32(20), words, words.size, scratch, electrons)
    return electrons.astype(int)


@pytest.mark.parametrize("mean", [0.0, 1e-3, 0.3, 0.4999, 0.5, 2.7, 9.25, 15.9, 19.99])
def test_counts_of_evenly_spaced_words_are_poisson(mean):
    words = (np.arange(1 << 20, dtype=np.uint64) * 4096 + 2048).astype(np.uint32)
    found = np.bincount(counts_of(mean, words), minlength=80)
    wanted = stats.poisson.pmf(np.arange(found.size), mean)
    assert found / words.size == pytest.approx(wanted, abs=64 * 3 / words.size)
    assert found[0] == words.size or mean > 0


def test_lanes_that_are_not_low_keep_what_they_had():
    assert (counts_of(20.0, np.arange(100, dtype=np.uint32)) == -1).all()


def test_the_exponential_less_one_is_that_of_numpy():
    x = np.linspace(-20, 20, 100_001).astype(np.float32)
    assert LESS_ONE(x) == pytest.approx(np.expm1(x.astype(np.float64)), rel=2e-7, abs=0)


@pytest.mark.parametrize("shape", [-0.4, -0.1, -2e-5, 0.0, 2e-5, 0.14, 0.8])
def test_tails_are_the_quantiles_of_tukey_lambda_within_a_millionth(shape):
    words = np.random.default_rng(1).integers(0, 1 << 32, 20_000, dtype=np.uint32)
    words[:4] = 0, (1 << 32) - 1, (1 << 31) - 1, 1 << 31
    found, logs = np.empty((2, words.size), np.float32)
    tail_scores(words, words.size, np.float32(shape), found, logs)
    law = stats.tukeylambda(float(np.float32(shape)))
    wanted = law.ppf((words + 0.5) / 2.0**32)
    assert (np.abs(found - wanted) < 1e-6 * np.maximum(law.std(), np.abs(wanted))).all()


@pytest.mark.parametrize("read_e", [3.0, 0.5])
@pytest.mark.parametrize("mean", [0.0, 0.4, 3.0, 15.0])
def test_codes_of_few_electrons_follow_the_exact_law(mean, read_e):
    law = {"gain": 1.7, "read_e": read_e, "black": 64.0, "top": 4095}
    found = codes_of(law, np.full((400, 500), mean), seed=3)
    assert p_of_codes(found, mean, law, np.random.default_rng(0)) > 1e-3


@pytest.mark.parametrize("read_e", [1.0, 0.5])
@pytest.mark.parametrize("every", [2, 40])
def test_low_values_among_high_ones_follow_the_exact_law(every, read_e):
    law = {"gain": 1.7, "read_e": read_e, "black": 64.0, "top": 4095}
    light = np.full((1000, 4000), 90.0)
    light[:, ::every] = 6.3
    found, rng = codes_of(law, light, seed=3), np.random.default_rng(0)
    for values, mean in ((found[:, ::every], 6.3), (found[:, 1::every], 90.0)):
        assert p_of_codes(values.ravel()[:400_000], mean, law, rng) > 1e-3


@pytest.mark.parametrize("shape", [-0.25, -0.1, 0.0, 0.14, 0.5])
def test_read_noise_with_tails_is_tukey_lambda_of_the_stated_variance(shape):
    camera = mono(read_e=3.0, tail_lambda=(shape,))
    add_noise = sampler(camera, **(OFF | {"read": True}), seed=4)
    noise = add_noise(np.full((400, 500), 50.0), unit="electron").noisy.ravel() - 50.0
    scale = 3.0 / np.sqrt(stats.tukeylambda.var(shape))
    law = stats.tukeylambda(shape, scale=scale).cdf
    assert stats.kstest(noise.astype(np.float64), law).pvalue > 1e-3
    spread = np.sqrt((stats.tukeylambda.stats(max(shape, -0.2), moments="k") + 2) / noise.size)
    assert abs(noise.var() / 9.0 - 1) < 5 * max(spread, 0.004)


@pytest.mark.parametrize("read_e", [0.3, 1.5, 6.0])
@pytest.mark.parametrize("black", [64.0, 511.7])
def test_the_mean_of_a_dark_frame_is_the_black_level(read_e, black):
    camera = mono(gain=0.8, read_e=read_e, black=black, dark_current_e_per_s=40.0)
    add_noise = sampler(camera, seed=2)
    frame = add_noise(np.zeros((1500, 2000)), unit="electron", time_s=0.5)
    mean_dn = frame.noisy.mean(dtype=np.float64) * 0.8
    assert abs(mean_dn) < 0.01 + 4 * np.sqrt(frame.variance[0, 0] * 0.64 / 3e6)


def test_the_mean_of_a_dark_frame_without_dark_electrons_is_within_a_hundredth_of_a_code():
    add_noise = sampler(mono(read_e=2.0), seed=2)
    frame = add_noise(np.full((1500, 2000), 64.0), unit="dn")
    assert abs(frame.noisy.mean(dtype=np.float64) - 64.0) < 0.01
    assert (frame.noisy == np.rint(frame.noisy)).all()


# ---- variance ----


def moments_over(add_noise, clean, frames, **how):
    """Mean and variance of each pixel over frames and sensors, and the stated variance."""
    found = [add_noise(clean, item=i, pattern=i, **how) for i in range(frames)]
    values = np.stack([one.noisy for one in found]).astype(np.float64)
    return values.mean(axis=0), values.var(axis=0, ddof=1), found[0].variance


@pytest.mark.parametrize("unit", ["electron", "white", "dn"])
def test_the_variance_is_that_of_the_samples_for_each_channel(unit):
    camera = color(**FULL)
    light = np.tile(np.repeat([50.0, 700.0], 200), (2, 1))
    channel = np.tile([[0, 1], [1, 2]], (1, 200))
    gain, black = camera.gain_dn_per_e[channel], camera.black_level_dn[channel]
    clean = {
        "electron": light,
        "dn": light * gain + black,
        "white": light * gain / (16383.0 - black),
    }[unit]
    add_noise = sampler(camera, seed=9)
    mean, variance, result = moments_over(add_noise, clean, 400, unit=unit, time_s=1.0)
    groups = channel * 2 + (light > 100)
    for group in range(6):
        here = groups == group
        count = 400 * here.sum()
        assert abs(variance[here].mean() / result[here].mean() - 1) < 5 * np.sqrt(2 / count) + 0.02
        scatter = np.sqrt(result[here].mean() / 400)  # row noise is shared, so counted per frame
        assert abs((mean - clean)[here].mean()) < 5 * scatter


def test_exact_moments_are_those_of_clipped_and_rounded_samples():
    camera = mono(gain=0.7, read_e=1.2, black=1.0, top=19.0, prnu=0.03, dsnu_e=0.5)
    add_noise = sampler(camera, seed=5)
    clean = np.repeat([0.0, 3.0, 24.0], 200)[None, :]
    exact = add_noise.exact_moments(clean, unit="electron")
    mean, variance, _ = moments_over(add_noise, clean, 500, unit="electron")
    for i in (0, 200, 400):
        here = slice(i, i + 200)
        sd = np.sqrt(exact.variance[0, i])
        assert abs(mean[0, here].mean() - exact.mean[0, i]) < 5 * sd / np.sqrt(1e5)
        assert abs(variance[0, here].mean() / exact.variance[0, i] - 1) < 0.03
    assert exact.black_share[0, 0] > 0.01
    assert exact.full_share[0, 400] > 0.2


def test_exact_moments_without_clipping_have_the_stated_variance():
    add_noise = sampler(color(**FULL), clamp=False)
    clean = np.full((2, 2), 300.0)
    how = {"unit": "white", "time_s": 2.0}
    exact = add_noise.exact_moments(clean / 16383, **how)
    result = add_noise(clean / 16383, **how).variance
    np.testing.assert_allclose(exact.variance, result, rtol=1e-5)
    np.testing.assert_allclose(exact.mean, clean / 16383, rtol=1e-6)


# ---- switches ----


@pytest.mark.parametrize(
    ("part", "expected"),
    [
        ("shot", 400.0),
        ("read", 9.0),
        ("dark", 60.0),
        ("prnu", (0.02 * 400) ** 2),
        ("dsnu", 9.0),
        ("row", 4.0),
        ("column", 2.25),
        ("telegraph", 0.2 * 5.0**2),
        ("quantize", 1 / 12 / 1.0),
    ],
)
def test_each_switch_removes_its_own_part_of_the_variance(part, expected):
    camera = mono(read_e=3.0, **FULL)
    clean = np.full((1, 1), 400.0)
    how = {"unit": "electron", "time_s": 2.0}
    all_on = sampler(camera)(clean, **how).variance[0, 0]
    without = sampler(camera, **{part: False})(clean, **how).variance[0, 0]
    assert all_on - without == pytest.approx(expected, abs=1e-3)


def test_without_any_part_the_picture_stays_as_it_is():
    clean = np.random.default_rng(1).uniform(0, 900, (6, 8)).astype(np.float32)
    sample = sampler(color(**FULL), **OFF)(clean, unit="electron")
    np.testing.assert_allclose(sample.noisy, clean, rtol=1e-6)
    assert not sample.variance.any()


@pytest.mark.parametrize("part", ["read", "dark", "prnu", "dsnu", "row", "column", "telegraph"])
def test_one_part_alone_has_its_own_variance(part):
    camera = mono(read_e=3.0, **FULL)
    add_noise = sampler(camera, **(OFF | {part: True}), seed=8)
    sample = add_noise(np.full((800, 900), 400.0), unit="electron", time_s=2.0)
    draws, kurtosis = (
        {"row": 800, "column": 900}.get(part, 720_000),
        5 if part == "telegraph" else 3,
    )
    error = 5 * ((kurtosis - 1) / draws) ** 0.5
    assert sample.noisy.var() / sample.variance[0, 0] == pytest.approx(1, abs=error)
    if part in ("row", "column"):
        assert not np.ptp(sample.noisy, axis=1 if part == "row" else 0).any()


def test_channels_of_a_pixel_share_the_offset_of_their_row_and_have_own_column_offsets():
    camera, clean = color(row_noise_e=4.0, column_noise_e=3.0), np.full((900, 1000, 3), 100.0)
    parts = [sampler(camera, **(OFF | {part: True})) for part in ("row", "column")]
    rows, columns = (one(clean, unit="electron").noisy.astype(float) - 100 for one in parts)
    assert not np.ptp(rows, axis=(1, 2)).any()
    assert not np.ptp(columns, axis=0).any()
    correlation = np.corrcoef(columns[0].T)
    assert np.abs(correlation[np.triu_indices(3, 1)]).max() < 5 / 1000**0.5


def test_switching_a_source_leaves_the_words_of_the_others():
    """So that two data sets differ in one source only."""
    clean = np.full((30, 40), 5.0)
    how = {"unit": "electron", "time_s": 0.0}
    plain = {"quantize": False, "clamp": False}
    both = sampler(mono(read_e=3.0, **FULL), **plain)(clean, **how).noisy
    no_row = sampler(mono(read_e=3.0, **FULL), row=False, **plain)(clean, **how).noisy
    difference = both - no_row
    np.testing.assert_allclose(difference, difference[:, :1] * np.ones((1, 40)), atol=1e-5)
    assert difference.std() > 0.5


def test_clamped_codes_end_at_zero_and_at_the_full_well():
    camera = mono(read_e=30.0, black=10.0, top=4095.0, full_well_e=1000.0)
    clean = np.array([[0.0, 1000.0]]) * np.ones((400, 1))
    sample = sampler(camera)(clean, unit="electron")
    assert sample.noisy.min() == -10.0
    assert sample.noisy.max() == 1000.0
    free = sampler(camera, clamp=False)(clean, unit="electron")
    assert free.noisy.min() < -20
    assert free.noisy.max() > 1020


# ---- seeds and order ----


def _noisy_bytes(job):
    add_noise, clean, item = job
    return add_noise(clean, unit="electron", item=item, time_s=0.1).noisy.tobytes()


def test_the_bits_do_not_depend_on_workers_order_or_threads():
    clean = np.random.default_rng(2).uniform(0, 300, (500, 700)).astype(np.float32)
    add_noise = sampler(color(**FULL), seed=11, threads=1)
    jobs = [(add_noise, clean, item) for item in (5, 1, 9, 3)]
    alone = [_noisy_bytes(job) for job in jobs]
    threaded = sampler(color(**FULL), seed=11, threads=3)
    assert [_noisy_bytes((threaded, clean, item)) for item in (5, 1, 9, 3)] == alone
    with ThreadPoolExecutor(3) as pool:
        assert list(pool.map(_noisy_bytes, jobs[::-1])) == alone[::-1]
    with ProcessPoolExecutor(2) as pool:
        assert list(pool.map(_noisy_bytes, jobs)) == alone
    assert len(set(alone)) == 4


def test_items_and_seeds_are_independent_and_the_fixed_pattern_is_not():
    camera = mono(read_e=1.0, prnu=0.05)
    clean = np.full((200, 300), 1000.0)
    add_noise = sampler(camera, seed=1)

    def correlation(one, other):
        return np.corrcoef(one.noisy.ravel(), other.noisy.ravel())[0, 1]

    first = add_noise(clean, unit="electron", item=0)
    expected = (0.05 * 1000) ** 2 / ((0.05 * 1000) ** 2 + 1001)
    same = correlation(first, add_noise(clean, unit="electron", item=1))
    assert same == pytest.approx(expected, abs=0.02)
    other_sensor = add_noise(clean, unit="electron", item=0, pattern=1)
    no_pattern = sampler(camera, seed=1, prnu=False)
    for item in (1, 2**32, 2**47):
        pair = [no_pattern(clean, unit="electron", item=i) for i in (0, item)]
        assert abs(correlation(*pair)) < 5 / np.sqrt(60_000)
    seeded = sampler(camera, seed=2**63, prnu=False)(clean, unit="electron")
    assert abs(correlation(no_pattern(clean, unit="electron"), seeded)) < 5 / np.sqrt(60_000)
    assert correlation(first, other_sensor) < 0.5  # the same shot noise, another pattern


def test_a_crop_has_the_mosaic_and_the_fixed_pattern_of_its_place():
    camera = color(prnu=0.05, dsnu_e=4.0)
    pattern = sampler(camera, **(OFF | {"prnu": True, "dsnu": True}))
    clean = np.full((20, 30), 500.0)
    whole = pattern(clean, unit="dn")
    crop = pattern(clean[3:11, 5:20], unit="dn", origin=(3, 5))
    np.testing.assert_array_equal(crop.noisy, whole.noisy[3:11, 5:20])
    np.testing.assert_array_equal(crop.variance, whole.variance[3:11, 5:20])


def test_a_sampler_survives_pickling():
    add_noise = sampler(color(**FULL), seed=3)
    clean = np.full((4, 6), 20.0)
    add_noise(clean, unit="electron", time_s=1.0)
    again = pickle.loads(pickle.dumps(add_noise))
    one, other = (f(clean, unit="electron", time_s=1.0).noisy for f in (add_noise, again))
    np.testing.assert_array_equal(one, other)


def test_channels_last_pictures_have_the_noise_of_their_channel():
    camera = color()
    clean = np.full((200, 300, 3), 100.0)
    sample = sampler(camera)(clean, unit="electron")
    result = 100.0 + np.array([36.0, 9.0, 4.0]) + 1 / 12 / np.array([0.25, 1.0, 4.0])
    np.testing.assert_allclose(sample.variance[0, 0], result, rtol=1e-6)
    np.testing.assert_allclose(sample.noisy.var(axis=(0, 1)), result, rtol=5 * (2 / 60_000) ** 0.5)


# ---- ISO ----


def test_the_gain_follows_the_iso_and_read_noise_its_law():
    camera = mono(gain=0.5, iso=100, read_noise_law=ReadNoiseSum(after_gain_dn=3, before_gain_e=2))
    add_noise = sampler(camera, shot=False, quantize=False)
    sample = add_noise(np.full((1, 1), 50.0), unit="electron", iso=650)
    assert sample.camera.gain_dn_per_e[0] == pytest.approx(3.25)
    assert sample.variance[0, 0] == pytest.approx((3 / 3.25) ** 2 + 4)


def test_items_draw_the_logarithm_of_the_gain_uniformly():
    law = LogLinearNoise(slope=1.0, bias=0.0)
    camera = mono(gain=1.0, read_noise_law=law, gain_range_dn_per_e=(0.5, 8.0))
    add_noise = sampler(camera)
    clean = np.zeros((1, 1))
    drawn = [add_noise(clean, unit="electron", item=i).camera.gain_dn_per_e[0] for i in range(300)]
    share = (np.log(drawn) - np.log(0.5)) / np.log(16)
    assert stats.kstest(share, "uniform").pvalue > 1e-3


# ---- refusals ----


def refused_call(camera=None, clean=None, *, switches=None, **how):
    add_noise = sampler(camera or mono(), **(switches or {}))
    add_noise(np.zeros((2, 2)) if clean is None else clean, **({"unit": "electron"} | how))


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
def test_a_clean_value_below_black_is_named(bad):
    clean = np.ones((3, 4))
    clean[1, 2] = bad
    with refused_input(subject="clean") as caught:
        refused_call(clean=clean)
    assert "index (1, 2)" in str(caught.value)
    assert caught.value.value == bad or np.isnan(bad)


def test_a_clean_code_below_black_is_refused():
    with refused_input(subject="clean", value=63.0):
        refused_call(clean=np.full((2, 2), 63.0), unit="dn")


def test_bad_calls_name_the_parameter():
    with refused_input(subject="item", value=-1):
        refused_call(item=-1)
    with refused_input(subject="item", value=2**48):
        refused_call(item=2**48)
    with refused_input(subject="pattern", value=2**32):
        refused_call(pattern=2**32)
    with refused_input(subject="origin", value=-2):
        refused_call(origin=(0, -2))
    with refused_input(subject="time_s", setting="time_s"):
        refused_call(mono(dark_current_e_per_s=1.0))
    with refused_input(subject="iso", value=200):
        refused_call(iso=200)
    with refused_input(subject="iso", remedy=("give read_noise_law, e.g. of read_noise_sum",)):
        refused_call(mono(iso=100), iso=200)
    with refused_input(subject="clean", value=(2, 2, 2)):
        refused_call(clean=np.zeros((2, 2, 2)))
    with refused_input(subject="clean", value=(4, 4)):
        refused_call(replace(color(), mosaic=None), clean=np.zeros((4, 4)))
    with refused_input(subject="seed", value=-1):
        sampler(mono(), seed=-1)
    with refused_input(subject="exact_moments"):
        sampler(mono(tail_lambda=(0.1,))).exact_moments(np.zeros((1, 1)), unit="electron")
    with refused_input(subject="time_s", value=2000.0):
        refused_call(mono(full_well_e=900.0, dark_current_e_per_s=1000.0), time_s=2.0)


def test_telegraph_noise_is_switched_off_by_the_old_keyword_too_with_a_warning():
    camera = mono(rtn_share=0.5, rtn_amplitude_e=40.0)
    with pytest.warns(FutureWarning, match="levels is now telegraph"):
        old = sampler(camera, levels=False)
    assert old == sampler(camera, telegraph=False)
    clean = np.full((4, 4), 100.0)
    lit = [one(clean, unit="electron").variance[0, 0] for one in (sampler(camera), old)]
    assert lit[0] - lit[1] == pytest.approx(0.5 * 20.0**2, rel=1e-6)


# ---- PyTorch ----


def test_without_pytorch_a_sentence_says_how_to_install_it(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "torch", None)
    noise = sampler(mono())
    for make in (lambda: NoisyDataset([np.zeros((2, 2))], noise, unit="dn"),
                 lambda: AddCameraNoise(sampler(mono()), unit="dn")):  # fmt: skip
        with refused_input(subject="a data set of PyTorch") as caught:
            make()
        assert "chromanoise[torch]" in str(caught.value)


@pytest.mark.parametrize("workers", [0, 2])
def test_a_data_set_gives_the_same_tensors_with_any_number_of_workers(workers):
    torch = pytest.importorskip("torch", reason="PyTorch, an extra, is not installed")
    pictures = [np.full((8, 10), 20.0 * (i + 1), np.float32) for i in range(5)]
    add_noise = sampler(color(), seed=6)
    data = NoisyDataset(pictures, add_noise, unit="electron", repeats=2)
    loader = torch.utils.data.DataLoader(data, batch_size=5, num_workers=workers)
    noisy, clean, variance = (torch.cat(parts) for parts in zip(*loader, strict=True))
    assert noisy.shape == clean.shape == variance.shape == (10, 8, 10)
    for i in range(10):
        expected = add_noise(pictures[i % 5], unit="electron", item=i)
        np.testing.assert_array_equal(noisy[i].numpy(), expected.noisy)
        np.testing.assert_array_equal(variance[i].numpy(), expected.variance)
        np.testing.assert_array_equal(clean[i].numpy(), expected.clean)


def test_the_transform_takes_channels_first():
    torch = pytest.importorskip("torch", reason="PyTorch, an extra, is not installed")
    add_noise = sampler(color(), seed=6)
    transform = AddCameraNoise(add_noise, unit="electron")
    noisy, variance = transform(torch.full((3, 4, 5), 100.0))
    expected = add_noise(np.full((4, 5, 3), 100.0), unit="electron")
    np.testing.assert_array_equal(noisy.numpy(), np.moveaxis(expected.noisy, -1, 0))
    np.testing.assert_array_equal(variance.numpy(), np.moveaxis(expected.variance, -1, 0))
    assert not torch.equal(noisy, transform(torch.full((3, 4, 5), 100.0))[0])
