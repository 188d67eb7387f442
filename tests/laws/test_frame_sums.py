"""Sums over frames: those of numpy and scipy, in blocks or whole, on any number of threads."""

import math
import os
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import convolve1d, uniform_filter1d

from chromanoise.apps.camera import characterized, light_sample, statistics
from chromanoise.apps.camera.statistics import fixed_patterns
from chromanoise.imaging.frame_sums import SMOOTHED, PairSums, PatternSums
from chromanoise.io.frames import FrameLevel, FrameSet, RawFrame, frames_in
from outcomes import refused_input
from processes import printed


def codes(shape, seed=0, high=4096, kind=np.uint16):
    return np.random.default_rng(seed).integers(0, high, shape).astype(kind)


def frame(values, name="f"):
    return RawFrame(path=Path(name), shape=values.shape, read=lambda: values)


def stored(folder, *pictures):
    for i, values in enumerate(pictures):
        np.save(folder / f"{i}.npy", values)
    return [frames_in(folder / f"{i}.npy")[0] for i in range(len(pictures))]


@pytest.mark.parametrize("tile", [(1, 1), (2, 2), (4, 4), (6, 6), (2, 3)])
@pytest.mark.parametrize(("kind", "high"), [(np.uint16, 65536), (np.int32, 2**31 - 1)])
def test_sums_of_a_pair_are_those_of_numpy(tile, kind, high):
    if kind == np.int32:
        high //= 64
    a, b = (codes((24, 36), seed, high, kind) for seed in (1, 2))
    sums = PairSums(a.shape, tile)
    sums.add(a[:11], b[:11], 0)  # a block may end within a period of the mosaic
    sums.add(a[11:], b[11:], 11)
    difference = a.astype(np.int64) - b
    for y in range(tile[0]):
        np.testing.assert_array_equal(sums.columns[y], difference[y :: tile[0]].sum(axis=0))
        for x in range(tile[1]):
            plane = difference[y :: tile[0], x :: tile[1]]
            assert sums.totals[y, x] == a[y :: tile[0], x :: tile[1]].sum(dtype=np.int64)
            assert sums.squares[y, x] == (plane**2).sum()
            np.testing.assert_array_equal(sums.rows[y :: tile[0], x], plane.sum(axis=1))


@pytest.mark.parametrize("size", [2047, 2048, 2897, 4095, 65535])
@pytest.mark.parametrize("tile", [(1, 1), (2, 2), (4, 4), (6, 6)])
def test_squares_of_large_differences_do_not_overflow(size, tile):
    low, high = (np.full((12, 6144), value, np.uint16) for value in (0, size))
    for a, b in ((low, high), (high, low)):
        sums = PairSums(a.shape, tile)
        sums.add(a, b, 0)
        assert set(sums.squares.ravel().tolist()) == {a.size // math.prod(tile) * size**2}


def test_rows_beyond_2_to_the_15_do_not_overflow_their_sums():
    a = np.full((70_000, 2), 65535, np.uint16)
    sums = PairSums(a.shape, (1, 1))
    sums.add(a, np.zeros_like(a), 0)
    assert sums.columns.tolist() == [[70_000 * 65535] * 2]
    assert sums.totals.tolist() == [[140_000 * 65535]]


@pytest.mark.evidence
@pytest.mark.skipif(sys.platform != "linux", reason="object code is kept on Linux")
def test_sums_over_frames_need_no_numba_until_a_kept_kernel_is_damaged(tmp_path):
    script = (
        "import sys, numpy as np\n"
        "from chromanoise.imaging.frame_sums import PairSums\n"
        "a = np.arange(64, dtype=np.uint16).reshape(8, 8)\n"
        "sums = PairSums((8, 8), (2, 2))\n"
        "sums.add(a, a[::-1].copy(), 0)\n"
        "print(int(sums.squares.sum()), 'numba' in sys.modules)"
    )
    squares = 8 * sum((8 * (7 - 2 * row)) ** 2 for row in range(8))
    for is_compiled in (True, False, True):
        found = printed(script, NUMBA_CACHE_DIR=str(tmp_path))
        assert found.split() == [str(squares), str(is_compiled)]
        (kept,) = tmp_path.rglob("*.o")
        if not is_compiled:
            kept.write_bytes(kept.read_bytes()[:-100])


@pytest.mark.parametrize("tile", [(1, 1), (2, 2)])
def test_blocks_of_rows_give_the_statistics_of_whole_frames(tmp_path, monkeypatch, tile):
    pictures = [codes((90, 64), seed) for seed in range(3)]
    whole = light_sample([frame(one) for one in pictures], tile)
    monkeypatch.setattr(statistics, "_BLOCK_PIXELS", 64 * 14)
    found = light_sample(stored(tmp_path, *pictures), tile)
    assert found.planes == whole.planes
    np.testing.assert_array_equal(found.covariance_dn2, whole.covariance_dn2)


@pytest.mark.parametrize("kind", ["<u2", ">u2", "u1", "i4"])
def test_blocks_of_rows_are_the_frame_in_turn(tmp_path, kind):
    values = codes((50, 20), high=200, kind=np.int32)
    (one,) = stored(tmp_path, values.astype(kind))
    for read in (one, frame(values)):
        blocks = [block.copy() for block in read.blocks(12)]
        assert [len(block) for block in blocks] == [12, 12, 12, 12, 2]
        np.testing.assert_array_equal(np.concatenate(blocks), values)
    assert one.has_rows
    assert not frame(values).has_rows


@pytest.mark.parametrize("rows", [10, 60])
def test_a_file_that_shrinks_between_blocks_is_refused(tmp_path, rows):
    (one,) = stored(tmp_path, codes((60, 2000)))
    blocks = one.blocks(rows // 2)
    next(blocks)
    os.truncate(tmp_path / "0.npy", 60 * 2000)
    with refused_input(subject=str(tmp_path / "0.npy")):
        list(blocks)
    with refused_input(subject=str(tmp_path / "0.npy")):
        list(one.blocks(rows))
    with refused_input(subject=str(tmp_path / "0.npy")):
        one.codes()


def test_many_frames_of_one_light_need_few_open_files(tmp_path, monkeypatch):
    pictures = [codes((16, 16), seed) for seed in range(5)]
    in_turn = light_sample(stored(tmp_path, *pictures), (2, 2))
    monkeypatch.setattr(statistics, "_MOST_OPEN", 4)
    assert light_sample(stored(tmp_path, *pictures), (2, 2)).planes == in_turn.planes


def sums_of(image, border=0, rows=11):
    """The sums of a picture that comes in blocks of rows."""
    sums = PatternSums(image.shape, image.dtype, border)
    for start in range(0, len(image), rows):
        block = image[start : start + rows]
        sums.zeros(len(block))[...] = block
        sums.add()
    return sums


@pytest.mark.parametrize("tile", [(1, 1), (2, 2), (2, 3)])
@pytest.mark.parametrize("kind", [np.uint16, np.int32])
def test_patterns_are_those_of_the_sum_of_the_frames_of_each_plane(
    tmp_path, monkeypatch, tile, kind
):
    pictures = [codes((140, 210), seed, 65536, kind) for seed in range(5)]
    whole = np.sum(pictures, axis=0, dtype=np.int64)
    planes = [whole[y :: tile[0], x :: tile[1]] for y in range(tile[0]) for x in range(tile[1])]
    for pixels in (210 * 22, 10**6):
        monkeypatch.setattr(statistics, "_BLOCK_PIXELS", pixels)
        found = fixed_patterns(stored(tmp_path, *pictures), tile, range(len(planes)))
        for i, plane in enumerate(planes):
            assert (found[i].frames, found[i].shape) == (5, plane.shape)
            values, counts = np.unique(plane, return_counts=True)
            np.testing.assert_array_equal(found[i].values, values)
            np.testing.assert_array_equal(found[i].counts, counts)
            moments = found[i].whole
            assert moments == pytest.approx((plane.mean(), plane.var(ddof=1)), rel=1e-12)
            inner = plane[9:-9, 9:-9]
            assert found[i].inner == pytest.approx((inner.mean(), inner.var(ddof=1)), rel=1e-12)
            assert found[i].high_passed == sums_of(plane, SMOOTHED // 2, len(plane)).high_passed


def test_a_small_picture_is_not_high_passed(tmp_path):
    (found,) = fixed_patterns(stored(tmp_path, codes((63, 64))), (1, 1), [0]).values()
    assert found.high_passed is None
    assert found.inner == found.whole


@pytest.mark.parametrize("shape", [(64, 64), (70, 131)])
@pytest.mark.parametrize("rows", [5, 32, 70])
def test_the_high_pass_is_that_of_scipy(shape, rows):
    image = codes(shape, high=30_000, kind=np.int32)
    smooth = image.astype(np.float64)
    for axis in (0, 1):
        for width in (7, 11):
            smooth = uniform_filter1d(smooth, width, axis=axis)
        smooth = convolve1d(smooth, [0.25, 0.5, 0.25], axis=axis)
    inner = (image - smooth)[9:-9, 9:-9]
    variance, sides = sums_of(image, SMOOTHED // 2, rows).high_passed
    assert sides == inner.shape
    assert variance == pytest.approx(inner.var(ddof=1), rel=1e-12)


@pytest.mark.parametrize("high", [3, 100_000, 2**36])
@pytest.mark.parametrize("border", [0, 9])
def test_values_are_counted_as_numpy_counts_them(high, border):
    image = codes((30, 40), high=high, kind=np.int64) - 1
    values, counts, inner = sums_of(image, border).counts
    for one, true in zip((values, counts), np.unique(image, return_counts=True), strict=True):
        np.testing.assert_array_equal(one, true)
    inside = image[border : 30 - border, border : 40 - border]
    for one, true in zip((values, inner), np.unique(inside, return_counts=True), strict=True):
        np.testing.assert_array_equal(one[inner > 0], true)


def levels(number):
    rng = np.random.default_rng(8)
    means = 100 + 200.0 * np.arange(number)
    flats = [
        [frame(rng.poisson(mean, (40, 50)).astype(np.uint16), f"{i}{k}.npy") for k in "ab"]
        for i, mean in enumerate(means)
    ]
    named = (FrameLevel(name=str(i), flats=tuple(pair)) for i, pair in enumerate(flats))
    return FrameSet(source="frames", levels=tuple(named))


def test_results_do_not_depend_on_the_number_of_threads(monkeypatch):
    frames, found, done = levels(6), [], []
    for cores in (1, 5):
        monkeypatch.setattr(os, "cpu_count", lambda cores=cores: cores)
        found.append(characterized(frames, progress=lambda *now: done.append(now)))
    assert found[0].planes[0].levels == found[1].planes[0].levels
    assert found[0].planes[0].gain_dn_per_e == found[1].planes[0].gain_dn_per_e
    assert done == [(i, 12) for i in range(0, 13, 2)] * 2


def test_the_first_bad_light_is_named_whichever_thread_finds_it(monkeypatch):
    monkeypatch.setattr(os, "cpu_count", lambda: 4)
    frames = levels(6)
    for i in (2, 3):
        a, b = frames.levels[i].flats
        object.__setattr__(b, "read", lambda a=a: a.codes() // 2)
    with refused_input(subject="2a.npy"):
        characterized(frames)
