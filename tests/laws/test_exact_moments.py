"""Laws of values that are held between bounds and rounded, and plain sums with scipy's laws."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy import stats

from chromanoise.base.errors import InputError
from chromanoise.noise import Readout, read_moments, with_noise
from chromanoise.noise.distribution import clipped_measurement
from chromanoise.noise.readout import expectation
from outcomes import refused_input
from strategies import pixel_with, white_channel

means = st.lists(st.floats(0.0, 3000.0), min_size=1, max_size=5).map(np.array)
noises = st.one_of(st.just(0.0), st.floats(0.05, 30.0))
steps = st.one_of(st.just(0.0), st.floats(0.1, 50.0))


@st.composite
def readouts(draw, steps=steps):
    black = draw(st.one_of(st.just(float("-inf")), st.floats(-50.0, 500.0)))
    above = max(black, 0.0)
    full = draw(st.one_of(st.just(float("inf")), st.floats(above + 1.0, above + 2000.0)))
    return Readout(black_e=black, full_well_e=full, step_e=draw(steps))


@given(means, noises)
def test_a_readout_without_bounds_and_steps_keeps_mean_and_variance(mean, noise):
    read = read_moments(mean, read_noise_e=noise, readout=Readout())
    assert (read.mean == mean).all()
    assert read.variance == pytest.approx(mean + noise**2, rel=1e-15)
    assert not read.bias.any()
    assert not read.black_share.any()
    assert not read.full_share.any()


@given(means, noises)
def test_bounds_that_can_just_be_reached_keep_mean_and_variance(mean, noise):
    # 8 sd away the sums are taken, and what they cut off is below 1e-13
    far = 8 * np.sqrt(mean.max() + noise**2) + 40
    readout = Readout(black_e=-8 * noise - 1e-3, full_well_e=mean.max() + far)
    read = read_moments(mean, read_noise_e=noise, readout=readout)
    assert read.mean == pytest.approx(mean, rel=1e-11, abs=1e-12)
    assert read.variance == pytest.approx(mean + noise**2, rel=1e-11, abs=1e-11)


def plain_moments(mean, noise, readout):
    """Mean, variance and shares at both bounds: a plain sum over counts and codes (or panels)."""
    counts = np.arange(int(mean + 12 * np.sqrt(mean)) + 40)
    weights = stats.poisson.pmf(counts, mean)
    weights /= weights.sum()
    counts = counts + readout.offset_e
    if readout.step_e:
        low, high = (counts[[0, -1]] + np.array([-12, 12]) * noise) / readout.step_e
        codes = np.arange(np.floor(low) - 1, np.ceil(high) + 2)
        edges = (codes[:-1] + 0.5) * readout.step_e
        above = np.stack([exceeding(edges - n, noise) for n in counts])
        share = -np.diff(above, axis=1, prepend=1.0, append=0.0)
        values = np.broadcast_to(codes * readout.step_e, share.shape)
    elif noise == 0:
        values, share = counts[:, None].astype(float), np.ones((counts.size, 1))
    else:
        bounds = np.array([readout.black_e, readout.full_well_e])
        cuts = np.clip((bounds - counts[:, None]) / noise, -9.0, 9.0)
        edges = np.linspace(-9.0, 9.0, 13) * np.ones((counts.size, 1))
        edges = np.sort(np.concatenate([edges, cuts], axis=1), axis=1)
        node, weight = np.polynomial.legendre.leggauss(20)
        half = np.diff(edges, axis=1)[..., None] / 2
        z = (edges[:, :-1, None] + half * (1 + node)).reshape(counts.size, -1)
        values = counts[:, None] + noise * z
        share = (half * weight).reshape(z.shape) * stats.norm.pdf(z)
    share = weights[:, None] * share
    held = np.clip(values, readout.black_e, readout.full_well_e)
    average = (share * held).sum()
    slack = 1e-9 * readout.step_e
    black = share[values < readout.black_e - slack].sum()
    full = share[values > readout.full_well_e + slack].sum()
    return average, (share * (held - average) ** 2).sum(), black, full


def exceeding(threshold, noise):
    """The probability of noise above a threshold; a value on it counts as above."""
    return stats.norm.sf(threshold / noise) if noise else (threshold <= 0).astype(float)


@settings(max_examples=40)
@given(
    st.floats(0.0, 60.0),
    noises,
    readouts(st.one_of(st.just(0.0), st.floats(0.5, 50.0))),
    st.one_of(st.just(0.0), st.floats(-20.0, 20.0)),
)
def test_moments_and_shares_are_those_of_a_plain_sum(mean, noise, readout, offset):
    readout = replace(readout, offset_e=offset)
    read = read_moments(np.array([mean]), read_noise_e=noise, readout=readout)
    found = read.mean[0], read.variance[0], read.black_share[0], read.full_share[0]
    average, variance, black, full = plain_moments(mean, noise, readout)
    assert found[0] == pytest.approx(average, rel=1e-10, abs=1e-10)
    assert found[1] == pytest.approx(variance, rel=1e-9, abs=1e-9)
    assert found[2:] == pytest.approx((black, full), rel=1e-9, abs=1e-12)
    assert read.bias[0] == read.mean[0] - mean


@given(noises, st.floats(10.0, 5000.0))
def test_a_saturated_channel_stops_scattering(noise, full):
    mean = full * np.array([1.0, 2.0, 10.0, 1e3, 1e12]) + 400.0 * np.arange(5)
    read = read_moments(mean, read_noise_e=noise, readout=Readout(full_well_e=full))
    assert (np.diff(read.variance) <= 0).all()
    assert (read.variance[-1], read.mean[-1], read.full_share[-1]) == (0.0, full, 1.0)


@given(means, noises, readouts())
def test_a_channel_does_not_depend_on_its_neighbors(mean, noise, readout):
    together = read_moments(np.stack([mean, mean[::-1]]), read_noise_e=noise, readout=readout)
    assert together.mean.shape == (2, mean.size)
    assert (together.mean[0] == together.mean[1, ::-1]).all()
    alone = read_moments(mean[:1], read_noise_e=noise, readout=readout)
    assert together.mean[0, :1] == pytest.approx(alone.mean, rel=1e-12, abs=1e-12)
    assert together.variance[0, :1] == pytest.approx(alone.variance, rel=1e-10, abs=1e-10)


@given(means, noises, st.floats(-5.0, 5.0), st.floats(-100.0, 100.0))
def test_a_straight_line_scales_the_mean_and_the_variance(mean, noise, slope, offset):
    seen = expectation(lambda x: slope * x + offset, mean, read_noise_e=noise)
    assert seen.mean == pytest.approx(slope * mean + offset, rel=1e-11, abs=1e-9)
    assert seen.variance == pytest.approx(slope**2 * (mean + noise**2), rel=1e-10, abs=1e-9)


@given(means, noises, readouts(st.just(0.0)))
def test_clipping_as_a_function_is_the_held_readout(mean, noise, readout):
    bounds = (readout.black_e, readout.full_well_e)
    kinks = tuple(bound for bound in bounds if np.isfinite(bound))
    seen = expectation(lambda x: np.clip(x, *bounds), mean, read_noise_e=noise, kinks_e=kinks)
    held = read_moments(mean, read_noise_e=noise, readout=readout)
    assert seen.mean == pytest.approx(held.mean, rel=1e-11, abs=1e-10)
    assert seen.variance == pytest.approx(held.variance, rel=1e-9, abs=1e-8)


@given(st.floats(0.0, 20_000.0))
def test_what_is_measured_without_bounds_is_eq_7(mean):
    sensor = white_channel(pixel=pixel_with(7.0))
    read, free = (
        clipped_measurement(np.array([[mean]]), sensor, Readout()),
        with_noise(np.array([[mean]]), sensor),
    )
    assert (read.mean == free.mean).all()
    assert read.covariance == pytest.approx(free.covariance, rel=1e-15)
    assert (read.kind, read.unit, read.names) == (free.kind, free.unit, free.names)


def test_a_measurement_in_the_dark_carries_the_held_variance_on_its_diagonal():
    # half-normal of sd 10: variance 100 (1/2 - 1/(2 pi)) = 34.0845
    read = clipped_measurement(
        np.zeros((2, 1)), white_channel(pixel=pixel_with(10.0)), Readout(black_e=0.0)
    )
    assert read.covariance.shape == (2, 1, 1)
    assert read.covariance[:, 0, 0] == pytest.approx(34.0845, abs=5e-5)


@pytest.mark.parametrize(
    "bounds",
    [
        {"black_e": 5.0, "full_well_e": 5.0},
        {"black_e": float("nan")},
        {"full_well_e": float("-inf")},
        {"black_e": float("inf")},
        {"step_e": -1.0},
        {"step_e": float("inf")},
    ],
)
def test_a_readout_without_room_for_values_is_refused(bounds):
    with pytest.raises(InputError):
        Readout(**bounds)


@pytest.mark.parametrize(
    ("mean", "readout", "subject", "value"),
    [
        (-1.0, Readout(), "mean_e", -1.0),
        (1e11, Readout(full_well_e=1e11), "mean_e", 1e11),
        (3.0, Readout(black_e=0.0, step_e=1e-6), "step_e", 1e-6),
    ],
)
def test_what_cannot_be_summed_is_refused(mean, readout, subject, value):
    with refused_input(subject=subject, value=value):
        read_moments(np.array([mean]), read_noise_e=2.0, readout=readout)


@pytest.mark.parametrize(
    ("function", "requirement"),
    [
        (lambda x: np.where(x < 0, np.nan, x), "finite"),
        (lambda x: x[:1], "one number per value"),
    ],
)
def test_a_function_that_leaves_a_value_open_is_refused(function, requirement):
    with refused_input(subject="function", requirement=requirement):
        expectation(function, np.array([1.0]), read_noise_e=2.0)
