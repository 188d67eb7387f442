"""Linear denoising: flat fields, the color matrix, the least error, strips."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.signal import fftconvolve

from chromanoise.base.rng import stream
from chromanoise.imaging import Work
from chromanoise.imaging.denoising import (
    LMMSE,
    WIENER,
    LinearFilter,
    denoised_planes,
    filtered,
    linear_filters,
    packed,
)
from chromanoise.sensor import VarianceLaw
from noisy_planes import planes_of
from outcomes import refused_input

METHODS = {"wiener": WIENER, "lmmse": LMMSE}


def draw_scene(planes, shape, rng, *, correlation=0.95):
    """A Gaussian scene with the covariance prior_e2 rho^r, by the spectrum on a larger torus."""
    size = 256
    away = np.minimum(np.arange(size), size - np.arange(size))
    spectrum = np.fft.fft2(correlation ** np.hypot(away[:, None], away)).real
    white = rng.standard_normal((len(planes.names), size, size))
    correlated = np.fft.ifft2(np.sqrt(spectrum.clip(0)) * np.fft.fft2(white)).real
    root = np.linalg.cholesky(planes.prior_e2)
    scene = np.einsum("ab,bhw->hwa", root, correlated) + planes.prior_mean_e
    return scene[: shape[0], : shape[1]]


@pytest.mark.parametrize("name", METHODS)
@settings(max_examples=10)
@given(mean=st.lists(st.floats(0.5, 5000), min_size=2, max_size=4), light=st.floats(0.01, 1e4))
def test_a_flat_field_of_any_color_comes_back(name, mean, light):
    flat = np.broadcast_to(np.array(mean), (7, 9, len(mean)))
    planes = planes_of(flat, light=light)
    assert METHODS[name].denoise(planes) == pytest.approx(planes.values_e, abs=2e-6 * max(mean))


def test_a_filter_for_all_planes_commutes_with_a_color_matrix():
    rng = stream(1)
    values, matrix = rng.normal(100.0, 30.0, (40, 50, 4)), rng.normal(size=(4, 4))
    wiener = linear_filters(planes_of(values), "wiener")
    before = filtered((values @ matrix.T).astype(np.float32), wiener)
    after = filtered(values.astype(np.float32), wiener) @ matrix.T
    assert np.abs(before - after).max() < 1e-6 * np.abs(values).max()


@pytest.mark.parametrize("kernel_of", [lambda k: k, lambda k: np.outer(k[12], k[12])])
def test_separable_terms_are_the_two_dimensional_convolution(kernel_of):
    rng = stream(2)
    values = rng.normal(100.0, 30.0, (60, 70, 2))
    made = linear_filters(planes_of(values), "lmmse")
    kernels = np.stack([kernel_of(kernel) for kernel in made.kernels])
    parts = values @ made.to_components.T
    smooth = np.stack(
        [fftconvolve(parts[..., i], kernels[i], mode="valid") for i in range(2)], axis=-1
    )
    found = filtered(values, replace(made, kernels=kernels))[12:-12, 12:-12]
    assert found == pytest.approx(smooth @ made.from_components.T, rel=1e-5)


def test_a_kernel_approaches_the_wiener_filter_of_the_spectrum():
    planes = planes_of(np.ones((1, 1, 1)))
    kernel = linear_filters(planes, "wiener").kernels[0]
    size = 512
    away = np.minimum(np.arange(size), size - np.arange(size))
    signal = planes.prior_e2[0, 0] * np.fft.fft2(0.95 ** np.hypot(away[:, None], away)).real
    wiener = signal / (signal + planes.noise_unit_e[0] ** 2)
    wide = np.zeros((size, size))
    wide[:25, :25] = kernel
    gain = np.abs(np.fft.fft2(wide))
    assert np.abs(gain - wiener).max() < 0.02


@pytest.mark.parametrize(("light", "likeness"), [(3.0, 0.9), (30.0, 0.99), (300.0, 0.8)])
def test_lmmse_has_the_least_error_on_scenes_of_its_prior(light, likeness):
    rng = stream(3)
    planes = planes_of(np.ones((1, 1, 4)), light=light, likeness=likeness)
    found = {"none": 0.0, "wiener": 0.0, "lmmse": 0.0}
    for _ in range(3):
        scene = draw_scene(planes, (120, 130), rng)
        noisy = scene + rng.normal(size=scene.shape) * planes.noise_unit_e
        results = {
            name: filtered(noisy, linear_filters(planes, name)) for name in ("wiener", "lmmse")
        }
        for name, result in (results | {"none": noisy}).items():
            error = (result - scene)[12:-12, 12:-12] / planes.noise_unit_e
            found[name] += float((error**2).mean())
    assert found["lmmse"] < found["wiener"] < found["none"]


@pytest.mark.parametrize("name", METHODS)
def test_planes_of_little_noise_come_back(name):
    values = stream(4).uniform(50.0, 5000.0, (20, 30, 3))
    planes = replace(planes_of(values), law=VarianceLaw(floor_e2=1e-6, slope_e=1e-9))
    assert METHODS[name].denoise(planes) == pytest.approx(planes.values_e, rel=1e-3)


@pytest.mark.parametrize("name", METHODS)
def test_strips_have_the_bits_of_the_whole(name):
    planes = planes_of(stream(5).normal(100.0, 30.0, (131, 37, 4)))
    whole = METHODS[name].denoise(planes)
    for rows, threads in ((1, 2), (17, 1), (64, 2)):
        work = Work(threads=threads, tile_rows=rows)
        assert (denoised_planes(planes, METHODS[name], work=work) == whole).all()


def test_components_are_uncorrelated_in_signal_and_noise():
    law = VarianceLaw(floor_e2=np.array([1.0, 10.0, 100.0, 1000.0]), slope_e=1.0, square=1e-4)
    planes = replace(planes_of(np.ones((1, 1, 4))), law=law)
    made = linear_filters(planes, "lmmse")
    noise = made.to_components @ np.diag(planes.noise_unit_e**2) @ made.to_components.T
    signal = made.to_components @ planes.prior_e2 @ made.to_components.T
    assert noise == pytest.approx(np.eye(4), abs=1e-12)
    assert signal == pytest.approx(np.diag(np.diag(signal)), abs=1e-12)
    assert made.from_components @ made.to_components == pytest.approx(np.eye(4), abs=1e-12)


def test_color_below_the_noise_is_kept_only_in_coarse_structure():
    planes = planes_of(np.ones((1, 1, 2)), light=10.0, likeness=0.99)
    made = linear_filters(planes, "lmmse")
    taps = made.kernels[:, 12, 12]
    assert taps[0] > 3 * taps[1]
    assert taps[1] == pytest.approx(1 / 625, rel=0.2)  # nearly the mean of 25 x 25 pixels


def test_bad_filters_are_refused():
    one = np.eye(1)
    skew = np.zeros((1, 3, 3))
    skew[0, 0, 1] = 1.0
    for kernels in (skew, np.full((1, 2, 2), 0.25)):
        with refused_input(subject="kernels"):
            LinearFilter(to_components=one, kernels=kernels, from_components=one)
    with refused_input(subject="linear method", value="winer"):
        linear_filters(planes_of(np.ones((1, 1, 1))), "winer")
    mean = LinearFilter(to_components=one, kernels=np.ones((1, 1, 1)), from_components=one)
    with refused_input(subject="the number of planes"):
        filtered(np.ones((2, 2, 2)), mean)


def test_values_that_are_not_finite_and_mosaics_below_a_tile_are_refused():
    values = np.ones((3, 4, 2))
    values[1, 2, 0] = np.nan
    with refused_input(subject="values_e"):
        planes_of(values)
    with refused_input(subject="picture", value=(4, 3)):
        packed(np.ones((4, 3), np.float32), np.arange(16).reshape(4, 4))
