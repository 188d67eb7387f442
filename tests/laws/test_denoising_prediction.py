"""Covariance and noise power spectrum after a linear method, against draws and impulses."""

import numpy as np
import pytest

from chromanoise.base.rng import stream
from chromanoise.imaging import (
    bilinear_filters,
    demosaicked,
    demosaicked_covariance,
    malvar_filters,
    noise_power_spectrum,
)
from chromanoise.imaging.demosaic import channel_tile
from chromanoise.imaging.denoising import (
    denoised_bank,
    denoised_covariance,
    denoised_noise_spectrum,
    filtered,
    linear_filters,
    packed,
    unpacked,
)
from chromanoise.noise import through
from chromanoise.sensor import bayer, rgbw_2x2
from noisy_planes import planes_of
from outcomes import refused_input
from strategies import raw_of

NAMES = ("wiener", "lmmse")
VARIANCE = np.array([300.0, 200.0, 160.0, 130.0])


def z_of(samples, predicted):
    """z of sample covariances (n k k) of independent parts against their common expectation."""
    error = samples.std(axis=0, ddof=1) / np.sqrt(len(samples))
    return np.abs(samples.mean(axis=0) - predicted) / error


def covariances(noise, size):
    """Covariance about 0 of the planes in each block of ``size`` x ``size`` pixels."""
    h, w, p = noise.shape
    blocks = noise[: h // size * size, : w // size * size]
    blocks = blocks.reshape(h // size, size, w // size, size, p).swapaxes(1, 2)
    flat = blocks.reshape(-1, size * size, p)
    return np.swapaxes(flat, 1, 2) @ flat / size**2


@pytest.mark.parametrize("name", NAMES)
def test_covariance_is_that_of_draws_also_through_a_color_matrix(name):
    made = linear_filters(planes_of(np.ones((1, 1, 4))), name)
    rng = stream(1)
    noise = rng.normal(size=(624, 624, 4)) * np.sqrt(VARIANCE)
    found = filtered(noise, made)[12:-12, 12:-12].astype(float)
    predicted = denoised_covariance(made, VARIANCE)
    assert z_of(covariances(found, 40), predicted).max() < 5
    matrix = rng.normal(size=(3, 4))
    raw = raw_of(np.ones(4), predicted, tuple("rgbw"))
    xyz = through(raw, matrix, names=("X", "Y", "Z"), kind="XYZ", unit="1")
    assert z_of(covariances(found @ matrix.T, 40), xyz.covariance).max() < 5


@pytest.mark.parametrize("name", NAMES)
def test_spectrum_is_the_mean_periodogram_of_draws(name):
    made = linear_filters(planes_of(np.ones((1, 1, 2))), name)
    rng, size, variance = stream(2), 32, VARIANCE[:2]
    periodograms = []
    for _ in range(250):
        # a torus: the mean over draws is the spectrum itself
        noise = rng.normal(size=(size, size, 2)) * np.sqrt(variance)
        found = filtered(np.pad(noise, ((12, 12), (12, 12), (0, 0)), mode="wrap"), made)
        waves = np.fft.fft2(found[12:-12, 12:-12].astype(float), axes=(0, 1)) / size
        periodograms.append((waves[..., :, None] * waves[..., None, :].conj()).real)
    predicted = denoised_noise_spectrum(made, variance, (size, size))
    assert z_of(np.stack(periodograms), predicted).max() < 5.5  # of 4096 numbers
    assert predicted.mean(axis=(0, 1)) == pytest.approx(denoised_covariance(made, variance))


@pytest.mark.parametrize("name", NAMES)
def test_spectrum_is_that_of_the_responses_to_impulses(name):
    made, size = linear_filters(planes_of(np.ones((1, 1, 3))), name), 33
    power = np.zeros((size, size, 3, 3))
    for plane in range(3):
        impulse = np.zeros((size, size, 3))
        impulse[16, 16, plane] = 1.0
        waves = np.fft.fft2(filtered(impulse, made).astype(float), axes=(0, 1))
        power += VARIANCE[plane] * (waves[..., :, None] * waves[..., None, :].conj()).real
    predicted = denoised_noise_spectrum(made, VARIANCE[:3], (size, size))
    assert np.abs(power - predicted).max() < 1e-5 * predicted.max()


BANKS = {
    "bilinear RGBW": bilinear_filters(rgbw_2x2()),
    "bilinear Bayer": bilinear_filters(bayer()),
    "Malvar": malvar_filters(bayer()),
}


def filters_for(bank, name):
    return linear_filters(planes_of(np.ones((1, 1, bank.kernels.shape[0] ** 2))), name)


@pytest.mark.parametrize("which", BANKS)
def test_filter_and_demosaicking_are_one_bank(which):
    bank = BANKS[which]
    made = filters_for(bank, "lmmse")
    tile = channel_tile(bank.mosaic, bank.names)
    raw = stream(3).uniform(50.0, 500.0, (90, 84)).astype(np.float32)
    planes, _ = packed(raw, tile)
    smooth = unpacked(filtered(planes, made), tile.shape, raw.shape)
    both = denoised_bank(made, bank)
    inner = slice(both.radius, -both.radius)
    found = demosaicked(raw.astype(float), both)[inner, inner]
    expected = demosaicked(smooth.astype(float), bank)[inner, inner]
    assert found == pytest.approx(expected, rel=1e-5)
    for channel in range(len(bank.names)):  # flat fields keep their color
        own = np.where(tile == channel, 7.0, 2.0)
        flat = np.tile(own, (30, 30))
        middle = demosaicked(flat, both)[30, 30]
        assert middle == pytest.approx(np.where(np.arange(len(bank.names)) == channel, 7.0, 2.0))


@pytest.mark.parametrize("name", NAMES)
def test_noise_of_a_mosaic_is_that_of_draws(name):
    bank = BANKS["bilinear Bayer"]
    made = filters_for(bank, name)
    both, tile = denoised_bank(made, bank), channel_tile(bank.mosaic, bank.names)
    variance = VARIANCE[:3]
    rng = stream(4)
    noise = rng.normal(size=(680, 680)) * np.sqrt(np.tile(variance[tile], (340, 340)))
    planes, _ = packed(noise.astype(np.float32), tile)
    smooth = unpacked(filtered(planes, made), tile.shape, noise.shape).astype(float)
    found = demosaicked(smooth, bank)[40:-40, 40:-40]
    predicted = demosaicked_covariance(both, variance)
    for a, b in np.ndindex(2, 2):
        assert z_of(covariances(found[a::2, b::2], 30), predicted[a, b]).max() < 5
    size = 2 * both.radius + 1
    spectrum = noise_power_spectrum(both, variance, (size, size))
    assert spectrum.mean(axis=(0, 1)) == pytest.approx(predicted.mean(axis=(0, 1)))


def test_bad_input_is_refused():
    made = linear_filters(planes_of(np.ones((1, 1, 2))), "wiener")
    with refused_input(subject="the number of planes"):
        denoised_covariance(made, np.ones(3))
    with refused_input(subject="variance_e2", value=-1.0):
        denoised_covariance(made, np.array([1.0, -1.0]))
    with refused_input(subject="shape", value=(8, 8)):
        denoised_noise_spectrum(made, np.ones(2), (8, 8))
    with refused_input(subject="the number of planes"):
        denoised_bank(made, BANKS["Malvar"])
