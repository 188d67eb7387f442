"""Noise-equivalent quanta of mosaics, against closed forms and against a reader of pictures."""

import numpy as np
import pytest
from scipy.stats import norm, rankdata

from chromanoise.imaging import (
    FilterBank,
    bilinear_filters,
    demosaicked,
    information_spectrum,
    lmmse_filters,
    malvar_filters,
    noise_equivalent_quanta,
    noise_power_spectrum,
    picture_power_spectrum,
    picture_prior,
)
from chromanoise.metrics import information_bits
from chromanoise.sensor import Mosaic, bayer, rgbw_2x2, rgbw_sparse_4x4
from outcomes import refused_input

COLORS = np.array(
    [
        [60.0, 50.0, 20.0, 130.0],
        [300.0, 100.0, 30.0, 400.0],
        [90.0, 250.0, 200.0, 500.0],
        [200.0, 220.0, 40.0, 450.0],
        [30.0, 40.0, 150.0, 220.0],
        [280.0, 300.0, 250.0, 800.0],
    ]
)
MEAN = np.array([160.0, 200.0, 100.0, 420.0])
VARIANCE = MEAN + 25.0


def prior_of(names, noise=25.0):
    p = len(names)
    return picture_prior(COLORS[:, :p], tuple(names), noise_e2=np.full(p, noise))


BANKS = {
    "bilinear Bayer": bilinear_filters(bayer(), ("R", "G", "B")),
    "Malvar": malvar_filters(bayer(), ("R", "G", "B")),
    "LMMSE Bayer": lmmse_filters(bayer(), prior_of("RGB")),
    "bilinear RGBW": bilinear_filters(rgbw_2x2(), ("R", "G", "B", "W")),
    "LMMSE RGBW": lmmse_filters(rgbw_2x2(), prior_of("RGBW")),
    "LMMSE sparse": lmmse_filters(rgbw_sparse_4x4(), prior_of("RGBW")),
}
every_bank = pytest.mark.parametrize("bank", BANKS.values(), ids=BANKS.keys())


def tile_of(bank):
    """Number of the channel at each place."""
    return np.array([[bank.names.index(c) for c in row] for row in bank.mosaic.pattern])


def raw_quanta(bank, mean, variance):
    """share M^2 / v on the diagonal: what counting every pixel gives."""
    tile = tile_of(bank)
    share = np.bincount(tile.ravel()) / tile.size
    return np.diag(share * mean**2 / variance)


def test_one_channel_has_the_classical_m2_mtf2_over_nps_which_any_filter_leaves_alone():
    """Shot noise and a triangle filter, MTF = (1 + cos)/2 each way: NEQ = M at all frequencies."""
    triangle = np.outer([0.25, 0.5, 0.25], [0.25, 0.5, 0.25])[None, None, None]
    bank = FilterBank(mosaic=Mosaic((("W",),)), names=("W",), kernels=triangle, made_by="triangle")
    n, m = 7, np.array([90.0])
    found = noise_equivalent_quanta(bank, m, m, (n, n))[..., 0, 0]
    mtf = np.outer(*[(1 + np.cos(2 * np.pi * np.fft.fftfreq(n))) / 2] * 2)
    nps = noise_power_spectrum(bank, m, (n, n))[..., 0, 0]
    np.testing.assert_allclose(found, m[0] ** 2 * mtf**2 / nps, rtol=1e-9)
    np.testing.assert_allclose(found, 90.0, rtol=1e-9)


EVEN = {name: bank for name, bank in BANKS.items() if name != "LMMSE sparse"}


@pytest.mark.parametrize("bank", EVEN.values(), ids=EVEN.keys())
def test_at_frequency_zero_the_quanta_are_those_of_the_raw_pixels(bank):
    """Filters of gain 1 that give every pixel of a channel the same total weight."""
    p = len(bank.names)
    found = noise_equivalent_quanta(bank, MEAN[:p], VARIANCE[:p], (24, 24))[0, 0]
    expected = raw_quanta(bank, MEAN[:p], VARIANCE[:p])
    np.testing.assert_allclose(found, expected, atol=1e-8)


@every_bank
def test_quanta_never_exceed_those_of_the_raw_mosaic_nor_grow_by_a_color_matrix(bank):
    p = len(bank.names)
    matrix = np.array([[0.5, 0.3, 0.2, 0.1], [0.2, 0.7, 0.1, 0.2], [0.0, 0.1, 0.9, 0.1]])[:, :p]
    raw = raw_quanta(bank, MEAN[:p], VARIANCE[:p])
    free, mixed = (
        noise_equivalent_quanta(bank, MEAN[:p], VARIANCE[:p], (20, 22), color)
        for color in (None, matrix)
    )
    np.testing.assert_allclose(free, np.swapaxes(free.conj(), -1, -2), atol=1e-8)
    for more, less in ((raw, free), (free, mixed)):
        assert np.linalg.eigvalsh(more - less).min() > -1e-8 * raw.max()
    if p == 3:
        np.testing.assert_allclose(free, mixed, atol=1e-7 * raw.max())


@every_bank
def test_quanta_are_transfer_over_noise_spectrum_by_the_response_to_waves(bank):
    """T by demosaicking waves in one channel; W from its own function: symmetric filters."""
    p, (ty, tx) = len(bank.names), bank.kernels.shape[:2]
    n, margin = 24, 12
    fy, fx = 3, 2
    y, x = np.mgrid[-margin : n + margin, -margin : n + margin]
    wave = np.exp(2j * np.pi * (fy * y + fx * x) / n)
    channel = tile_of(bank)[y % ty, x % tx]
    assert margin % ty == margin % tx == 0
    transfer = np.empty((p, p), dtype=complex)
    for d in range(p):
        raw = wave * (channel == d)
        out = demosaicked(raw.real, bank) + 1j * demosaicked(raw.imag, bank)
        inner = slice(margin, -margin)
        transfer[:, d] = (out * wave.conj()[..., None])[inner, inner].mean(axis=(0, 1))
    found = noise_equivalent_quanta(bank, MEAN[:p], VARIANCE[:p], (n, n))[fy, fx]
    spectrum = full_noise_spectrum(bank, VARIANCE[:p], (fy / n, fx / n))
    signal = transfer * MEAN[:p]
    np.testing.assert_allclose(
        found, signal.conj().T @ np.linalg.solve(spectrum, signal), rtol=1e-7, atol=1e-7
    )


def full_noise_spectrum(bank, variance, frequency):
    """By the correlation of the outputs at all pairs of pixels of a period, quadrature included."""
    (ty, tx), r = bank.kernels.shape[:2], bank.radius
    p, side = len(bank.names), bank.kernels.shape[-1]
    tile = tile_of(bank)
    weights = {}  # of raw pixel (y, x) in the outputs, as waves
    for a, b in np.ndindex(ty, tx):
        for i, j in np.ndindex(side, side):
            y, x = a + i - r, b + j - r
            wave = np.exp(-2j * np.pi * (frequency[0] * (a - y) + frequency[1] * (b - x)))
            at = (y % ty, x % tx)
            weights[at] = weights.get(at, 0) + wave * bank.kernels[a, b, :, i, j]
    total = np.zeros((p, p), dtype=complex)
    for (y, x), weight in weights.items():
        total += variance[tile[y, x]] * np.outer(weight, weight.conj()) / (ty * tx)
    return total


class Reader:
    """The linear reader of demosaicked pictures of n x n pixels with the template of the theory."""

    def __init__(self, bank, signal):
        """``signal``: relative change of the light of each channel, [n n p]."""
        self.bank, self.n, (ty, tx) = bank, len(signal), bank.kernels.shape[:2]
        p, n = len(bank.names), self.n
        self.margin = -(-bank.radius // (ty * tx)) * ty * tx
        channel = np.tile(tile_of(bank), (n // ty, n // tx))
        self.mean = MEAN[channel]
        self.change = self.mean * np.take_along_axis(signal, channel[..., None], axis=2)[..., 0]
        waves = np.fft.fft2(signal, axes=(0, 1))
        quanta = noise_equivalent_quanta(bank, MEAN[:p], MEAN[:p], (n, n))
        self.d = np.sqrt(np.einsum("hwc,hwcd,hwd->", waves.conj(), quanta, waves).real) / n
        output = 0.0  # at the frequencies of the signal: the mean over all starts of the tile
        for a, b in np.ndindex(ty, tx):
            moved = np.roll(signal * MEAN[:p], (a, b), (0, 1))
            raw = np.take_along_axis(moved, channel[..., None], axis=2)[..., 0]
            output = output + np.roll(self.out(raw[None])[0], (-a, -b), (0, 1)) / (ty * tx)
        seen, template = np.fft.fft2(output, axes=(0, 1)), np.zeros((n, n, p), dtype=complex)
        for i, j in np.argwhere(np.abs(waves).max(axis=-1) > 1e-9 * np.abs(waves).max()):
            frequency = np.fft.fftfreq(n)[i], np.fft.fftfreq(n)[j]
            noise = full_noise_spectrum(bank, MEAN[:p], frequency)
            template[i, j] = np.linalg.lstsq(noise, seen[i, j], rcond=1e-12)[0]
        self.template = np.fft.ifft2(template, axes=(0, 1)).real
        self.weights = self.scores(np.eye(n * n).reshape(n * n, n, n)).reshape(n, n)

    def out(self, raw):
        """Demosaicked pictures that continue periodically."""
        n, margin = self.n, self.margin
        around = np.pad(raw, [(0, 0), (margin, margin), (margin, margin)], mode="wrap")
        side = n + 2 * margin
        full = demosaicked(around.reshape(-1, side), self.bank).reshape(len(raw), side, side, -1)
        return full[:, margin : margin + n, margin : margin + n]

    def scores(self, raw):
        return np.tensordot(self.out(raw), self.template, axes=3)


def whole_tiles(n, color, waves=(0, 0)):
    """A cosine over the whole field, in the channels with these contrasts."""
    y, x = np.mgrid[:n, :n]
    wave = np.cos(2 * np.pi * (waves[0] * y + waves[1] * x) / n)
    return wave[..., None] * np.array(color)


PICTURES = 10_000


@pytest.mark.parametrize("name", ["bilinear Bayer", "Malvar", "LMMSE RGBW"])
@pytest.mark.parametrize("waves", [(0, 0), (1, 2)])
def test_a_linear_reader_of_drawn_pictures_has_the_roc_area_of_the_quanta(name, waves):
    bank = BANKS[name]
    p, n = len(bank.names), 12
    contrast = 0.018 if waves == (0, 0) else 0.028
    signal = whole_tiles(n, contrast * np.array([1.0, 0.6, -0.8, 0.5])[:p], waves)
    reader = Reader(bank, signal)
    rng = np.random.default_rng(5)
    dark, lit = (
        rng.poisson(reader.mean + present * reader.change, (PICTURES, n, n)).astype(float)
        for present in (0, 1)
    )
    scores = [np.tensordot(raw, reader.weights, axes=2) for raw in (dark, lit)]
    np.testing.assert_allclose(reader.scores(lit[:100]), scores[1][:100], rtol=1e-9)
    above = rankdata(np.concatenate(scores))[PICTURES:].sum() - PICTURES * (PICTURES + 1) / 2
    area, expected = above / PICTURES**2, norm.cdf(reader.d / np.sqrt(2))
    assert 0.85 < expected < 0.99
    assert area == pytest.approx(expected, rel=5e-3)


# information


def test_information_of_one_channel_without_filters_is_that_of_a_pixel_at_each_frequency():
    alone = bilinear_filters(Mosaic((("W",),)))
    quanta = noise_equivalent_quanta(alone, MEAN[:1], VARIANCE[:1], (4, 6))
    power = np.linspace(0.0, 0.5, 24).reshape(4, 6, 1, 1)
    each = [information_bits(MEAN[0] ** 2 * s, VARIANCE[:1, None]) for s in power.reshape(-1, 1, 1)]
    found = information_spectrum(quanta, power)
    np.testing.assert_allclose(found.ravel(), np.array(each), rtol=1e-9)


@every_bank
def test_information_of_pictures_is_a_determinant_and_below_that_of_the_raw_mosaic(bank):
    p = len(bank.names)
    power = picture_power_spectrum(prior_of(bank.names), MEAN[:p], (20, 20))
    quanta = noise_equivalent_quanta(bank, MEAN[:p], VARIANCE[:p], (20, 20))
    found = information_spectrum(quanta, power)
    logs = np.linalg.slogdet(np.eye(p) + power @ quanta)[1]
    np.testing.assert_allclose(found, 0.5 * logs / np.log(2), atol=1e-9)
    raw = np.broadcast_to(raw_quanta(bank, MEAN[:p], VARIANCE[:p]).astype(complex), quanta.shape)
    assert (found <= information_spectrum(raw, power) + 1e-9).all()
    at_zero = information_spectrum(raw, power)[0, 0]
    if bank is BANKS["LMMSE sparse"]:  # pixels of one channel have unequal total weights
        assert 0.99 * at_zero < found[0, 0] < 0.998 * at_zero
    else:
        assert found[0, 0] == pytest.approx(at_zero, rel=1e-9)


def test_pictures_have_the_correlation_of_the_prior():
    """Back from the spectrum: C rho^r relative to the mean; a plane of 256 wraps nothing."""
    prior = prior_of("RGB")
    power = picture_power_spectrum(prior, MEAN[:3], (256, 256))
    correlation = np.fft.ifft2(power, axes=(0, 1)).real
    expected = prior.covariance_e2 / np.outer(MEAN[:3], MEAN[:3])
    np.testing.assert_allclose(correlation[0, 0], expected, rtol=1e-9)
    for distance in (1, 3, 10):
        np.testing.assert_allclose(correlation[0, distance], expected * 0.95**distance, rtol=0.02)


@pytest.mark.parametrize(
    ("call", "fields"),
    [
        (lambda b, e: noise_equivalent_quanta(b, e, 0 * e, (8, 8)), {"value": 0.0}),
        (lambda b, e: noise_equivalent_quanta(b, -e, e, (8, 8)), {"subject": "mean_e"}),
        (lambda b, e: noise_equivalent_quanta(b, e, e, (2, 8)), {"subject": "shape"}),
        (
            lambda b, e: noise_equivalent_quanta(b, e, e, (8, 8), np.full((1, 3), np.nan)),
            {"subject": "matrix"},
        ),
        (
            lambda b, e: information_spectrum(
                noise_equivalent_quanta(b, e, e, (8, 8)), np.full((8, 8, 3, 3), -1.0)
            ),
            {"subject": "power"},
        ),
        (lambda b, e: picture_power_spectrum(prior_of("RGB"), 0 * e, (8, 8)), {"value": 0.0}),
    ],
)
def test_what_has_no_quanta_is_refused(call, fields):
    with refused_input(**fields):
        call(BANKS["bilinear Bayer"], MEAN[:3])
