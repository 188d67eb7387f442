"""Bits of the raw channels, against determinants and against draws with clipping and rounding."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.color import kernel_matrix
from chromanoise.color.training import shares
from chromanoise.metrics import information_bits
from chromanoise.noise import expected_electrons, mean_noise_covariance, with_noise
from chromanoise.sensor import Converter, Crosstalk, Pixel
from chromanoise.spectra import Grid, Scene, equal_energy
from chromanoise.study import PRIORS, information_chain
from chromanoise.study.color_matrices import training_named
from outcomes import refused_input
from strategies import mixes, point_of, sensor_of

NM = Grid.uniform(400, 1050, 10)
E = equal_energy(NM)
LEVELS = np.array([1000.0, 10.0, 0.1, 0.01])
NAMES = tuple(f"c{i}" for i in range(16))


def camera(p, *, read_noise_e=10.0, level_lux=10.0, **more):
    """p bells from 440 to 900 nm, 100 nm wide at least, so that neighbors overlap."""
    at, center = NM.wavelength_nm[:, None], np.linspace(440.0, 900.0, p)
    qe = 0.5 * np.exp(-0.5 * ((at - center) / max(50.0, 300.0 / p)) ** 2)
    pixel = Pixel(pitch_um=10.0, full_well_e=10_000.0, read_noise_e=read_noise_e)
    return point_of(sensor_of(qe, grid=NM, pixel=pixel, names=NAMES[:p], **more), level_lux)


def bits_of(signal, noise):
    """By determinants of the covariances of the output with and without the signal."""
    with_signal, without = (np.linalg.slogdet(s)[1] for s in (signal + noise, noise))
    return 0.5 * (with_signal - without) / np.log(2)


def random_covariance(p, seed, scale=1.0):
    root = np.random.default_rng(seed).normal(size=(p, p))
    return scale * (root @ root.T + 0.1 * np.eye(p))


# half log det


@given(st.integers(1, 16), st.integers(0, 2**31), st.floats(1e-3, 1e4))
def test_bits_are_half_the_log_of_the_ratio_of_determinants(p, seed, scale):
    signal, noise = random_covariance(p, seed, scale), random_covariance(p, seed + 1)
    assert information_bits(signal, noise) == pytest.approx(bits_of(signal, noise), rel=1e-9)


@given(st.data(), st.integers(1, 6), st.integers(0, 2**31))
def test_an_invertible_map_loses_nothing_and_no_map_gains(data, p, seed):
    signal, noise = random_covariance(p, seed, 30.0), random_covariance(p, seed + 1)
    all_bits = float(information_bits(signal, noise))
    mix = data.draw(mixes(p))
    assert float(information_bits(signal, noise, mix)) == pytest.approx(all_bits, abs=1e-10)
    scaled = np.diag(10.0 ** np.arange(-6.0, p - 6.0)) @ mix @ np.diag(10.0 ** -np.arange(0.0, p))
    assert float(information_bits(signal, noise, scaled)) == pytest.approx(all_bits, abs=1e-10)
    few = mix[: max(1, p - 1)]
    part = float(information_bits(signal, noise, few))
    assert part <= all_bits + 1e-12
    assert part == pytest.approx(bits_of(few @ signal @ few.T, few @ noise @ few.T), abs=1e-8)
    twice = np.concatenate([few, few[:1] + few[-1:], 0 * few[:1]])
    assert float(information_bits(signal, noise, twice)) == pytest.approx(part, abs=1e-10)


def test_signal_without_noise_has_infinite_information_and_neither_has_none():
    signal = np.diag([4.0, 0.0, 9.0])
    quiet_third = np.diag([1.0, 0.0, 0.0])
    assert information_bits(signal, quiet_third) == np.inf
    assert information_bits(signal, quiet_third, np.eye(3)[:2]) == pytest.approx(np.log2(5) / 2)
    # two readings with one noise: their difference is exact
    common = np.ones((2, 2))
    assert information_bits(1e8 * common, common) == pytest.approx(0.5 * np.log2(1 + 1e8))
    assert information_bits(np.diag([1e8, 1e8 + 1.0]), common) == np.inf
    assert information_bits(np.zeros((2, 2)), np.zeros((2, 2))) == 0


def test_leading_axes_are_computed_one_by_one():
    signals = np.array([random_covariance(3, seed) for seed in range(4)])
    noise = random_covariance(3, 9)
    found = information_bits(signals, noise)
    assert found == pytest.approx(np.array([bits_of(one, noise) for one in signals]), rel=1e-10)


@pytest.mark.parametrize(
    ("signal", "noise", "matrix", "fields"),
    [
        (np.diag([1.0, -1.0]), np.eye(2), None, {"subject": "diagonal of signal_covariance"}),
        (np.array([[1.0, 2.0], [2.0, 1.0]]), np.eye(2), None, {"subject": "signal_covariance"}),
        (np.eye(2), np.array([[1.0, 2.0], [2.0, 1.0]]), None, {"subject": "noise_covariance"}),
        (np.eye(2), np.full((2, 2), np.nan), None, {"subject": "noise_covariance"}),
        (np.eye(2), np.eye(2), np.full((1, 2), np.inf), {"subject": "matrix", "value": np.inf}),
    ],
)
def test_what_is_no_covariance_is_refused(signal, noise, matrix, fields):
    with refused_input(**fields):
        information_bits(signal, noise, matrix)


# the chain


def moments_of_draws(point, level, draws, seed, *, step_e=0.0):
    """Second moments of (u, x, c) by batches: signal, noisy electrons, clipped and rounded."""
    training = training_named("chart-nir", E)
    scene = Scene(illuminant=E, level_lux=level, reflectance=training.reflectance)
    electrons = expected_electrons(scene, point.sensor, point.exposure)
    bare = replace(point.sensor, converter=Converter())
    sd = np.sqrt(with_noise(electrons, bare, point.exposure).variance)
    rng, full = np.random.default_rng(seed), point.sensor.pixel.full_well_e
    batches = []
    for _ in range(BATCHES):
        k = rng.choice(len(electrons), draws // BATCHES, p=shares(training))
        x = electrons[k] + sd[k] * rng.standard_normal((k.size, sd.shape[1]))
        c = np.clip(step_e * np.round(x / step_e) if step_e else x, 0.0, full)
        ones = np.ones((k.size, 1))
        rows = np.concatenate([ones, electrons[k], x, c - full], axis=1)
        batches.append(rows.T @ rows / k.size)
    return np.array(batches)


def bits_of_moments(moments, p):
    """Gain of c on x by regression; the rest of c, and the noise through the gain, is noise."""
    s = moments[1:, 1:] - np.outer(moments[0, 1:], moments[0, 1:])
    u, x = slice(0, p), slice(p, 2 * p)
    c = 2 * p + np.flatnonzero(np.diagonal(s)[2 * p :] > 0)  # a constant reading tells nothing
    if not c.size:
        return 0.0
    gain = np.linalg.lstsq(s[x, x], s[x, c], rcond=None)[0].T
    noise = s[x, x] + s[u, u] - s[x, u] - s[u, x]
    rest = s[np.ix_(c, c)] - gain @ s[x, x] @ gain.T
    return bits_of(gain @ s[u, u] @ gain.T, gain @ noise @ gain.T + rest)


BATCHES, DRAWS = 20, 200_000


@pytest.mark.parametrize("p", [1, 3, 4, 16])
@pytest.mark.parametrize("level", LEVELS)
def test_bits_after_clipping_and_rounding_are_those_of_draws(level, p):
    """Jackknife over batches: value without bias, and its standard error."""
    step = 4.0
    point = camera(p, converter=Converter(gain_e_per_dn=step, bits=14))
    chain = information_chain(point, level_lux=np.array([level]))
    for name, rounding in (("clipping", 0.0), ("quantization", step)):
        batches = moments_of_draws(point, level, DRAWS, seed=p, step_e=rounding)
        mean = batches.mean(axis=0)
        left_out = (BATCHES * mean - batches) / (BATCHES - 1)
        each = np.array([bits_of_moments(one, p) for one in left_out])
        value = BATCHES * bits_of_moments(mean, p) - (BATCHES - 1) * each.mean()
        error = np.sqrt((BATCHES - 1) * each.var())
        assert abs(value - chain.bits[name][0]) <= 3 * error, (name, value, error)


def test_a_bright_picture_that_clips_nowhere_loses_nothing_by_clipping():
    """Dark patches are far above black; a Gaussian with the prior's moments would lose bits."""
    chain = information_chain(camera(3, level_lux=10.0, read_noise_e=1.0))
    assert float(chain.steps[1].lost_bits) < 1e-6
    assert float(chain.bits["electrons"]) > 5


def test_without_light_clipping_at_black_leaves_pi_over_2_pi_minus_2_of_the_bits():
    """g = 1/2 of the signal, (1 - 1/pi)/2 of the variance: 1/4 over 0.34085 of SNR^2, 73.35 %."""
    chain = information_chain(camera(1, level_lux=1e-5))
    ratio = float(chain.bits["clipping"]) / float(chain.bits["electrons"])
    assert ratio == pytest.approx(np.pi / (2 * np.pi - 2), rel=3e-4)


@given(
    st.integers(1, 5),
    st.floats(-3.0, 3.0),
    st.floats(0.0, 60.0),
    st.floats(0.0, 300.0),
    st.sampled_from(sorted(PRIORS)),
    st.sampled_from(["spectrum", "visible"]),
)
def test_information_never_rises_along_the_chain(p, log_lux, read_noise, step, prior, about):
    converter = Converter(gain_e_per_dn=step, bits=14) if step > 1e-3 else Converter()
    point = camera(p, read_noise_e=read_noise, converter=converter)
    matrix = kernel_matrix(point.sensor, point.exposure)
    chain = information_chain(
        point,
        matrix,
        prior=prior,
        level_lux=np.array([10.0**log_lux]),
        information_about=about,
    )
    names = [step.name for step in chain.steps]
    assert names == ["electrons", "clipping", "quantization", "white balance", "color matrix"]
    for one in chain.steps:
        assert one.bits >= 0
        assert one.lost_bits >= -1e-10
    assert chain.steps[3].lost_bits == pytest.approx(0.0, abs=1e-10)
    if p <= 3:
        assert chain.steps[4].lost_bits == pytest.approx(0.0, abs=1e-10)


def test_levels_at_once_are_the_levels_one_by_one():
    point = camera(4, converter=Converter(gain_e_per_dn=3.0, bits=14))
    all_at_once = information_chain(point, level_lux=LEVELS)
    for i, level in enumerate(LEVELS):
        alone = information_chain(replace(point, level_lux=level))
        for step, single in zip(all_at_once.steps, alone.steps, strict=True):
            assert step.bits[i] == pytest.approx(float(single.bits), rel=1e-9, abs=1e-12)


def test_two_equal_channels_are_one_with_twice_the_electrons_and_the_noise():
    """Their sum has signal 2 u and noise variance 2 v: 1/2 log2(1 + 2 var u / v)."""
    one = camera(1)
    twin = replace(
        one, sensor=sensor_of(np.repeat(one.sensor.qe, 2, 1), grid=NM, pixel=one.sensor.pixel)
    )
    first = float(information_chain(one, clipped=False).bits["electrons"])
    both = float(information_chain(twin, clipped=False).bits["electrons"])
    assert 4.0**both - 1 == pytest.approx(2 * (4.0**first - 1), rel=1e-9)


def test_infrared_that_visible_light_does_not_predict_is_noise():
    """One channel sees both: u = v + w; of v it knows the regression on v, the rest is noise."""
    point = camera(1, level_lux=10.0)
    training = training_named("chart-nir", E)
    scene = Scene(illuminant=E, level_lux=10.0, reflectance=training.reflectance)
    dark = replace(scene, reflectance=np.where(NM.wavelength_nm > 700, 0.0, training.reflectance))
    wide = replace(point, sensor=replace(point.sensor, qe=np.full((NM.n, 1), 0.2)))
    u, v = (expected_electrons(s, wide.sensor, wide.exposure)[:, 0] for s in (scene, dark))
    correlation = np.corrcoef(u, v)[0, 1]
    noise = u.mean() + 100.0
    # a Gaussian v and the reading: -1/2 log2(1 - correlation^2)
    read = correlation**2 * u.var() / (u.var() + noise)
    expected = -0.5 * np.log2(1 - read)
    found = information_chain(wide, information_about="visible", clipped=False)
    assert float(found.bits["electrons"]) == pytest.approx(expected, rel=1e-9)
    more = information_chain(wide, clipped=False)
    assert float(more.bits["electrons"]) > 1.5 * expected


def test_a_sensor_that_sees_no_infrared_knows_as_much_of_the_visible_as_of_the_spectrum():
    point = camera(3)
    visible = np.where(NM.wavelength_nm[:, None] > 700, 0.0, point.sensor.qe)
    blind = replace(point, sensor=replace(point.sensor, qe=visible))
    each = [
        information_chain(blind, information_about=about, level_lux=LEVELS).bits["quantization"]
        for about in ("spectrum", "visible")
    ]
    np.testing.assert_allclose(each[0], each[1], rtol=1e-8)


def test_crosstalk_after_counting_keeps_information_but_for_the_read_noise():
    """Without noise added at the readout, mixing the counted charge is invertible."""
    mixing = np.array([[0.8, 0.1, 0.0], [0.2, 0.8, 0.2], [0.0, 0.1, 0.8]])
    for read_noise, lossless in ((0.0, True), (10.0, False)):
        plain = camera(3, read_noise_e=read_noise)
        mixed = replace(
            plain.sensor,
            qe=plain.sensor.qe @ mixing.T,
            crosstalk=Crosstalk(matrix=mixing, pixels=(1,) * len(mixing), stage="charge"),
        )
        before, after = (
            float(information_chain(one, clipped=False).bits["electrons"])
            for one in (plain, replace(plain, sensor=mixed))
        )
        assert (after == pytest.approx(before, abs=1e-8)) == lossless
        assert after < before + 1e-8
    with refused_input(subject="crosstalk_stage", setting="crosstalk_stage"):
        information_chain(replace(plain, sensor=mixed))


def test_mean_noise_of_a_set_is_the_mean_of_the_noise_of_its_lights():
    """With PRNU, which is not linear in the light, and with crosstalk after counting."""
    mixing = np.array([[0.9, 0.2], [0.1, 0.7]])
    pixel = Pixel(pitch_um=10.0, full_well_e=1e4, read_noise_e=3.0, prnu=0.05)
    sensor = sensor_of(
        np.full((NM.n, 2), 0.3),
        grid=NM,
        pixel=pixel,
        crosstalk=Crosstalk(matrix=mixing, pixels=(1,) * len(mixing), stage="charge"),
    )
    electrons = np.array([[[50.0, 40.0], [900.0, 800.0]], [[5.0, 4.0], [90.0, 80.0]]])
    share = np.array([0.3, 0.7])
    each = with_noise(electrons, sensor).covariance
    np.testing.assert_allclose(
        mean_noise_covariance(electrons, share, sensor),
        np.einsum("k,lkij->lij", share, each),
        rtol=1e-12,
    )


def test_a_matrix_of_other_channels_is_refused():
    point = camera(2)
    with refused_input(subject="color matrix"):
        information_chain(point, kernel_matrix(camera(3).sensor, point.exposure))
