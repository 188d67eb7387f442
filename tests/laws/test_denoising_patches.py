"""Laws of the denoising method `patches`: exact without noise, strips, flats, any planes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from chromanoise.imaging.denoising import denoised_planes
from chromanoise.imaging.denoising.patches import PATCHES, patches_estimate
from chromanoise.imaging.shared_rows import Work
from chromanoise.sensor import VarianceLaw
from noisy_planes import planes_with


def planes_of(values, *, floor=100.0, slope=1.0, prnu=0.0, mean=100.0):
    """Planes with one noise model; the prior is that of planes which vary together."""
    count = values.shape[-1]
    prior = {
        "prior_e2": mean**2 * (0.9 + 0.1 * np.eye(count)),
        "prior_mean_e": np.full(count, mean),
    }
    return planes_with(values, floor_e2=floor, slope_e=slope, prnu=prnu, **prior)


def scene(height, width, count):
    """Bright and dark bars of different colors, a disk, and a slope. [e-]"""
    y, x = np.mgrid[:height, :width]
    bars = np.where((x // 7) % 2 == 0, 400.0, 150.0)
    disk = np.where((y - height / 2) ** 2 + (x - width / 2) ** 2 < (height / 4) ** 2, 2.0, 1.0)
    return np.stack([bars * disk ** (i % 3) + 0.5 * y for i in range(count)], axis=-1)


def noisy(clean, *, floor=100.0, slope=1.0, prnu=0.0, seed=0):
    random = np.random.default_rng(seed)
    variance = floor + slope * clean + (prnu * clean) ** 2
    return clean + np.sqrt(variance) * random.normal(size=clean.shape)


def rms(values):
    return math.sqrt(np.mean(np.square(values, dtype=np.float64)))


@pytest.mark.parametrize(("tile_rows", "width"), [(96, 16), (264, 33)])  # of 3 and of 4 levels
def test_strips_equal_the_whole(tile_rows, width):
    clean = scene(531, width, 2)
    model = {"floor": 20.0, "slope": 1.0, "prnu": 0.01}
    planes = planes_of(noisy(clean, **model), **model)
    whole = patches_estimate(planes)
    strips = denoised_planes(planes, PATCHES, work=Work(threads=2, tile_rows=tile_rows))
    np.testing.assert_array_equal(strips, whole)


def test_noise_free_values_return_where_the_noise_is_tiny():
    clean = scene(48, 50, 3)
    estimate = patches_estimate(planes_of(clean, floor=1e-4, slope=1e-6))
    assert np.abs(estimate / clean - 1.0).max() < 1e-3


def test_noise_free_values_keep_their_detail():
    clean = scene(64, 64, 3)
    assert rms(patches_estimate(planes_of(clean)) - clean) < 0.1 * rms(noisy(clean) - clean)


@pytest.mark.parametrize(("count", "mean", "least_db"), [(1, 3.0, 29.0), (4, 100.0, 27.0)])
def test_flats_lose_their_noise(count, mean, least_db):
    clean = np.full((72, 72, count), mean)
    planes = planes_of(noisy(clean), mean=mean)
    gain = rms(planes.values_e - clean) / rms(patches_estimate(planes) - clean)
    assert 20.0 * math.log10(gain) > least_db


def test_structure_is_estimated_better_than_by_the_best_mean_of_neighbors():
    clean = scene(64, 64, 3)
    planes = planes_of(noisy(clean))
    padded = np.pad(planes.values_e, ((1, 1), (1, 1), (0, 0)), mode="edge")
    center = padded[1:-1, 1:-1]
    cross = padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:]
    least = min(rms((center + w * cross) / (1.0 + 4.0 * w) - clean) for w in np.linspace(0, 1, 21))
    assert rms(patches_estimate(planes) - clean) < 0.4 * least


def test_planes_without_noise_return_unchanged_and_help_no_other():
    clean = scene(24, 24, 3)
    planes = planes_of(noisy(clean))
    keep = np.array([1.0, 0.0, 1.0])
    some = replace(planes, law=VarianceLaw(floor_e2=100.0 * keep, slope_e=keep))
    estimate = patches_estimate(some)
    np.testing.assert_array_equal(estimate[..., 1], planes.values_e[..., 1])
    other = planes.values_e.copy()
    other[..., 1] = 0.0
    np.testing.assert_array_equal(
        patches_estimate(replace(some, values_e=other))[..., ::2], estimate[..., ::2]
    )


def test_the_unit_of_the_values_does_not_matter():
    clean = scene(40, 40, 2)
    planes = planes_of(noisy(clean, prnu=0.01), prnu=0.01)
    scaled = replace(
        planes,
        values_e=planes.values_e * np.float32(4.0),
        law=VarianceLaw(floor_e2=1600.0, slope_e=4.0, square=0.01**2),
        prior_e2=planes.prior_e2 * 16.0,
        prior_mean_e=planes.prior_mean_e * 4.0,
    )
    np.testing.assert_allclose(patches_estimate(scaled), 4.0 * patches_estimate(planes), rtol=1e-3)


@settings(max_examples=30)
@given(
    shape=st.tuples(st.integers(1, 21), st.integers(1, 21), st.sampled_from([1, 2, 4, 9, 16])),
    floor=st.sampled_from([0.0, 1e-20, 1.0, 100.0, 1e8]),
    slope=st.sampled_from([0.0, 1e-6, 1.0, 50.0]),
    prnu=st.sampled_from([0.0, 1e-6, 0.01, 1.0]),
    level=st.sampled_from([-1e4, 0.0, 1e-3, 30.0, 1e6]),
    amplitude=st.sampled_from([0.0, 1.0, 1e5]),
    seed=st.integers(0, 99),
)
def test_any_planes_give_finite_values(shape, floor, slope, prnu, level, amplitude, seed):
    values = level + amplitude * np.random.default_rng(seed).normal(size=shape)
    estimate = patches_estimate(planes_of(values, floor=floor, slope=slope, prnu=prnu))
    assert estimate.shape == shape
    assert np.isfinite(estimate).all()
    slack = 1e-3 * np.abs(values).max() + 1e-6
    assert np.abs(estimate).max() <= 3.0 * np.abs(values).max() + slack
