"""The noise of the imaging engine: which bits, which law, and what it does not depend on.

``reference_noise`` is the same arithmetic in plain numpy; scipy's distributions judge both.
"""

import os
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import stats

import reference_noise as reference
from chromanoise.imaging.sampling import noisy_electrons
from goodness import chi_square_score, correlation_z, kolmogorov_p_at, scores_of_moments
from outcomes import refused_input

MEANS = (0.0, 0.1, 1.0, 5.0, 10.0, 30.0, 100.0, 1000.0, 10_000.0)
SIDE = 512  # 2^20 draws of one mean: four channels


def drawn(mean_e, *, side=SIDE, read_noise_e=0.0, seed=11, **place):
    mean = np.full((side, side, 4), mean_e, dtype=np.float32)
    return noisy_electrons(mean, read_noise_e=read_noise_e, seed=seed, **place)


def any_means(shape, seed=0):
    """Means of all sizes side by side, 0 and the change of method at 20 e- among them."""
    rng = np.random.default_rng(seed)
    mean = 10.0 ** rng.uniform(-3, 6, shape)
    mean[::3] = rng.uniform(0, 30, mean[::3].shape)
    mean[1::7] = 0.0
    mean[2::7] = 20.0
    return mean.astype(np.float32)


def test_the_words_are_those_published_with_philox():
    # kat_vectors of Random123, philox4x32 with 10 rounds (Salmon et al., SC11, 2011)
    digits_of_pi = (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344), (0xA4093822, 0x299F31D0)
    ones = (0xFFFFFFFF,) * 4, (0xFFFFFFFF,) * 2
    known = [
        (((0,) * 4, (0,) * 2), (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
        (ones, (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD)),
        (digits_of_pi, (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1)),
    ]
    from numba import njit

    from chromanoise.imaging.noise_draws import philox4x32

    words_of_counter = njit(lambda *words: philox4x32(*words))

    for (counter, key), words in known:
        compiled = words_of_counter(*(np.uint64(word) for word in (*counter, *key)))
        assert tuple(map(int, compiled)) == words
        assert tuple(map(int, reference.philox4x32(counter, key))) == words


@pytest.mark.parametrize("channels", [1, 2, 3, 4, 7])
@pytest.mark.parametrize(
    "place",
    [
        {},
        {"frame": 2**32 - 1, "first_row": 5, "first_column": 3, "width": 2**36},
    ],
    ids=["whole", "tile"],
)
def test_compiled_noise_has_the_bits_of_plain_numpy(channels, place):
    mean = any_means((61, 47, channels))
    for noise, seed in ((0.0, 0), (2.5, 2**64 - 1), (0.5, 3)):
        ours = noisy_electrons(mean, read_noise_e=noise, seed=seed, **place)
        plain = reference.noisy_electrons(mean, read_noise_e=noise, seed=seed, **place)
        np.testing.assert_array_equal(ours.view(np.uint32), plain.view(np.uint32))


def test_more_channels_than_a_block_has_lanes_have_the_same_bits():
    mean = any_means((3, 2, 1501))
    ours = noisy_electrons(mean, read_noise_e=1.0, seed=4)
    np.testing.assert_array_equal(ours, reference.noisy_electrons(mean, read_noise_e=1.0, seed=4))


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_no_choice_of_threads_or_chunks_changes_a_bit(channels):
    mean = any_means((257, 509, channels))  # several chunks
    plain = reference.noisy_electrons(mean, read_noise_e=3.0, seed=9)
    for threads in (1, 2, 13, None):
        ours = noisy_electrons(mean, read_noise_e=3.0, seed=9, threads=threads)
        np.testing.assert_array_equal(ours, plain)


@given(
    top=st.integers(0, 38),
    left=st.integers(0, 29),
    height=st.integers(1, 40),
    width=st.integers(1, 30),
)
def test_a_tile_is_a_piece_of_the_picture(top, left, height, width):
    mean = any_means((40, 31, 3))
    whole = noisy_electrons(mean, read_noise_e=3.0, seed=9)
    here = (slice(top, top + height), slice(left, left + width))
    tile = noisy_electrons(
        mean[here], read_noise_e=3.0, seed=9, first_row=top, first_column=left, width=31
    )
    np.testing.assert_array_equal(tile, whole[here])


def test_doubles_strides_and_fortran_order_give_the_same_bits():
    mean = any_means((10, 12, 4))
    plain = noisy_electrons(mean, read_noise_e=1.0, seed=1)
    for same in (mean.astype(np.float64), np.asfortranarray(mean), np.repeat(mean, 2, 1)[:, ::2]):
        np.testing.assert_array_equal(noisy_electrons(same, read_noise_e=1.0, seed=1), plain)


def counted(mean, *, side=SIDE, seed=11, frames=1):
    """How often each number of electrons is drawn: all that the law of whole numbers can tell."""
    counts = np.zeros(0, dtype=np.int64)
    for frame in range(frames):
        electrons = drawn(mean, side=side, seed=seed, frame=frame).ravel()
        assert (electrons == np.floor(electrons)).all()
        more = np.bincount(electrons.astype(np.int64), minlength=counts.size)
        more[: counts.size] += counts
        counts = more
    return counts


def chi_square_z(counts, mean):
    """Of cells of at least 30."""
    wide = max(1, int(np.sqrt(mean) / 40))
    edges = np.arange(0, counts.size, wide)
    share = np.diff(stats.poisson.cdf(edges, mean), prepend=0.0)
    kept = np.flatnonzero(share > 30 / counts.sum())
    edges = edges[kept[0] : kept[-1]]
    share = np.diff(np.concatenate([[0.0], stats.poisson.cdf(edges, mean), [1.0]]))
    upto = np.cumsum(counts)
    found = np.diff(np.concatenate([[0], upto[edges], [upto[-1]]]))
    return chi_square_score(found, share)


def kolmogorov_p(counts, mean):
    """For whole numbers the true one is larger still."""
    law = stats.poisson.cdf(np.arange(counts.size), mean)
    return kolmogorov_p_at(np.cumsum(counts)[:-1], law[:-1], counts.sum())


def moment_scores(counts, mean):
    """z of the first four moments about the known mean, scaled by the known moments to order 8."""
    n = np.arange(max(counts.size, stats.poisson.ppf(1 - 1e-15, mean)) + 50)
    share, away = stats.poisson.pmf(n, mean), n - mean
    moment = [float((share * away**k).sum()) for k in range(9)]
    total = counts.sum()
    found = [float((counts * away[: counts.size] ** k).sum() / total) for k in range(5)]
    return scores_of_moments(found, moment, total)


@pytest.mark.parametrize("mean", MEANS[1:])
@pytest.mark.parametrize(
    "draws",
    [{}, pytest.param({"side": 1024, "seed": 21, "frames": 24}, marks=pytest.mark.evidence)],
    ids=["a million", "a hundred million"],
)
def test_electrons_are_poisson_by_chi_square_kolmogorov_and_four_moments(draws, mean):
    counts, mean = counted(mean, **draws), float(np.float32(mean))
    assert chi_square_z(counts, mean) < 5
    assert kolmogorov_p(counts, mean) > 6e-7  # |z| < 5
    assert np.abs(moment_scores(counts, mean)).max() < 5


def test_a_gaussian_of_the_same_variance_would_be_noticed():
    fake = np.round(100 + 10 * np.random.default_rng(0).standard_normal(4 * SIDE**2))
    counts = np.bincount(fake.astype(np.int64))
    assert chi_square_z(counts, 100.0) > 20
    assert kolmogorov_p(counts, 100.0) < 1e-9
    assert np.abs(moment_scores(counts, 100.0)).max() > 20


def test_no_light_and_no_read_noise_give_no_electrons():
    assert not drawn(0.0).any()


def lag_pairs(frames):
    """Values that must know nothing of each other, from a burst (frame, h, w, p)."""
    yield frames[:, :, 1:], frames[:, :, :-1]
    yield frames[:, 1:], frames[:, :-1]
    yield frames[..., 1:], frames[..., :-1]
    yield frames[..., 2:], frames[..., :-2]
    yield frames[1:], frames[:-1]


@pytest.mark.parametrize("mean", [1.0, 1000.0])
def test_neighbors_channels_frames_and_seeds_are_not_correlated(mean):
    def burst(seed):
        return np.stack([drawn(mean, side=256, seed=seed, frame=f) for f in range(4)]) - mean

    one, other = burst(5), burst(6)
    for first, second in [*lag_pairs(one), (one, other), (one, burst(5 + 2**32))]:
        assert np.abs(correlation_z(first, second)) < 5
        squares = [part**2 - np.mean(part**2) for part in (first, second)]
        assert np.abs(correlation_z(*squares)) < 5


def test_electrons_are_the_quantile_of_the_word_but_for_one_in_ten_thousand():
    rng = np.random.default_rng(3)
    mean = rng.uniform(0, 40, (100, 200, 10)).astype(np.float32)
    mean[50:] = 10.0 ** rng.uniform(1.3, 4.5, (50, 200, 10))
    electrons = noisy_electrons(mean, read_noise_e=0.0, seed=8)
    share = (reference.light_words(mean.shape, seed=8) + 0.5) / 2**32
    away = electrons - stats.poisson.ppf(share, mean.astype(np.float64))
    assert np.abs(away).max() <= 1
    assert np.mean(away != 0) <= 1e-4
    assert not away[mean < 20].any()


@given(st.floats(0.0, 1e5), st.floats(1e-6, 1e3), st.integers(0, 1000))
def test_more_light_never_gives_fewer_electrons(mean, more, frame):
    def at(level):
        return drawn(level, side=16, frame=frame)

    low, high = at(mean), at(mean * (1 + more) + 1e-3)
    # where the two methods meet at 20 e- they may differ by one
    assert (high >= low - (mean < 20)).all()
    assert (high >= low).all() or mean < 20 <= mean * (1 + more) + 1e-3
    assert at(1e5).min() > at(100.0).max() > 100  # anchored: 100 e- stray by some 10


@pytest.mark.parametrize(
    ("changed", "fields"),
    [
        ({"mean_e": np.full((2, 2, 2), -1.0)}, {"subject": "mean_e", "value": -1.0}),
        ({"mean_e": np.array([[[1.0], [np.nan]]])}, {"subject": "mean_e"}),
        ({"mean_e": np.array([[[1e39]]])}, {"subject": "mean_e", "value": np.inf}),
        ({"read_noise_e": -1.0}, {"subject": "read_noise_e", "value": -1.0}),
        ({"read_noise_e": np.nan}, {"subject": "read_noise_e"}),
        ({"seed": -1}, {"subject": "seed", "value": -1}),
        ({"seed": 2**64}, {"subject": "seed", "value": 2**64}),
        ({"frame": 2**32}, {"subject": "frame", "value": 2**32}),
        ({"width": 1}, {"subject": "width", "value": 1}),
        ({"first_row": -1}, {"subject": "width"}),
        ({"first_row": 2**47, "width": 4}, {"remedy": ("give its parts seeds of their own",)}),
        ({"mean_e": np.empty((2, 2, 0))}, {"subject": "mean_e", "value": 0}),
        ({"threads": 0}, {"subject": "threads", "value": 0}),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_one_sentence(changed, fields):
    arguments = {"mean_e": np.ones((2, 2, 2)), "read_noise_e": 1.0, "seed": 0} | changed
    with refused_input(**fields):
        noisy_electrons(arguments.pop("mean_e"), **arguments)


def test_an_empty_picture_stays_empty():
    assert noisy_electrons(np.empty((0, 5, 3)), read_noise_e=1.0, seed=0).shape == (0, 5, 3)


def test_the_compiler_is_not_loaded_before_noise_is_drawn():
    script = "import chromanoise.imaging.sampling, sys; sys.exit('numba' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", script], env=dict(os.environ)).returncode == 0
