"""Laws of the figures of merit; each has its known values in tests/known."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st

from chromanoise.color import kernel_matrix
from chromanoise.metrics.accuracy import metamerism, sensor_metamerism
from chromanoise.metrics.filter_merit import (
    best_readout,
    figure_of_merit,
    filter_quality,
    principal_angles_deg,
    readout_error,
    second_moment,
    vora_value,
)
from chromanoise.metrics.snr import (
    color_sensitivity_bits,
    information_bits,
    tonal_levels,
    tonal_range_bits,
)
from chromanoise.metrics.speed import (
    NoiseSpeedModel,
    illuminance_for_snr,
    light_for_snr,
    noise_speed,
)
from chromanoise.metrics.visual_noise import (
    ISO_15739_2017,
    contrast_sensitivity,
    frequencies_cpd,
    visual_noise_from_spectrum,
    visual_noise_of_picture,
    visual_noise_of_white,
)
from chromanoise.spectra import Grid, color_axes, equal_energy
from outcomes import refused_input
from strategies import EXPOSURE, GRID, RGB, bell_qe, mixes, pixel_with, sensor_of, sensors

AXES = color_axes(GRID, "quanta") / color_axes(GRID, "quanta").max()
LAMP = equal_energy(GRID)
LIGHTS = np.abs(np.cumsum(np.random.default_rng(1).normal(size=(40, GRID.n)), axis=1)) + 0.1
PRIOR = second_moment(LIGHTS)
noises = st.floats(1e-3, 10.0)
# CIELUV answers unlike to X, Y and Z; any invertible Jacobian will do for a law
JACOBIAN = np.array([[0.0, 90.0, 0.0], [200.0, -190.0, 10.0], [0.0, 110.0, -100.0]])
XYZ_COVARIANCE = 1e-4 * np.array([[2.0, 1.0, 0.3], [1.0, 1.5, 0.4], [0.3, 0.4, 3.0]])


# filters


@given(st.data())
def test_the_space_of_the_sensor_does_not_care_how_its_channels_are_mixed(data):
    sensor = data.draw(sensors(min_channels=2))
    mix = data.draw(mixes(len(sensor.names)))
    mixed = sensor.qe @ mix.T
    assert vora_value(mixed, AXES) == pytest.approx(vora_value(sensor.qe, AXES), abs=1e-9)
    assert principal_angles_deg(mixed, AXES) == pytest.approx(
        principal_angles_deg(sensor.qe, AXES), abs=1e-6
    )


@given(sensors(), mixes(3))
def test_q_does_not_care_how_the_eyes_axes_are_mixed(sensor, mix):
    assert filter_quality(sensor.qe, AXES @ mix.T) == pytest.approx(
        filter_quality(sensor.qe, AXES), abs=1e-9
    )


@given(sensors(max_channels=3), st.floats(420.0, 680.0))
def test_a_further_channel_never_lowers_vora_value_merit_or_information(sensor, center):
    more = np.column_stack([sensor.qe, bell_qe([center], [25.0], [0.7])])
    p = len(sensor.names)
    noise = np.diag(np.linspace(0.5, 2.0, p + 1))
    assert vora_value(more, AXES) >= vora_value(sensor.qe, AXES) - 1e-9
    few, many = (
        (
            figure_of_merit(f, AXES, light_moment=PRIOR, noise_covariance=d, weight=np.eye(3)),
            float(information_bits(f.T @ PRIOR @ f, d)),
        )
        for f, d in ((sensor.qe, noise[:p, :p]), (more, noise))
    )
    assert many[0] >= few[0] - 1e-12
    assert many[1] >= few[1] - 1e-12


@given(sensors(), noises, st.integers(0, 1000))
def test_no_other_matrix_has_a_smaller_error_than_the_best_readout(sensor, noise, seed):
    p = len(sensor.names)
    given_ = {"light_moment": PRIOR, "noise_covariance": noise * np.eye(p)}
    best = best_readout(sensor.qe, AXES, **given_)
    other = best + 0.1 * np.random.default_rng(seed).normal(size=best.shape)

    def error(b):
        miss = AXES - sensor.qe @ b.T
        return miss.T @ PRIOR @ miss + noise * b @ b.T

    assert error(best) == pytest.approx(readout_error(sensor.qe, AXES, **given_), abs=1e-9)
    assert np.trace(error(other)) >= np.trace(error(best)) - 1e-9


@given(st.data(), noises)
def test_merit_and_information_are_unchanged_when_channels_mix_with_their_covariance(data, noise):
    sensor = data.draw(sensors(min_channels=2))
    p = len(sensor.names)
    mix = data.draw(mixes(p))
    d = noise * np.diag(np.arange(1.0, p + 1.0))
    for f, cov in ((sensor.qe, d), (sensor.qe @ mix.T, mix @ d @ mix.T)):
        merit = figure_of_merit(
            f, AXES, light_moment=PRIOR, noise_covariance=0.5 * (cov + cov.T), weight=np.eye(3)
        )
        bits = float(information_bits(f.T @ PRIOR @ f, cov))
        if cov is d:
            first = (merit, bits)
    assert (merit, bits) == pytest.approx(first, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize(
    ("filters", "light", "noise", "weight", "fields"),
    [
        (np.zeros((GRID.n, 1)), PRIOR, np.eye(1), np.eye(3), {"subject": "filter 0 (from 0)"}),
        (RGB, -PRIOR, np.eye(3), np.eye(3), {"subject": "light_moment"}),
        (
            RGB,
            PRIOR,
            np.triu(np.ones((3, 3))),
            np.eye(3),
            {"subject": "noise_covariance", "value": 1.0},
        ),
        (RGB, PRIOR, np.eye(3), np.zeros((3, 3)), {"subject": "tr(W A^T K A)", "value": 0.0}),
    ],
)
def test_a_merit_without_meaning_is_refused(filters, light, noise, weight, fields):
    with refused_input(**fields):
        figure_of_merit(filters, AXES, light_moment=light, noise_covariance=noise, weight=weight)


# metamerism


@settings(max_examples=6)
@given(mixes(3))
def test_the_metamerism_index_does_not_care_how_channels_are_mixed(mix):
    patches = np.clip(LIGHTS[:18] / LIGHTS[:18].max(), 0.02, 1.0)
    lamp = np.ones(GRID.n)
    assume((lamp @ RGB @ mix.T > 0.1).all())  # white balance divides by it
    plain, mixed = (metamerism(f, AXES, lamp, patches).index for f in (RGB, RGB @ mix.T))
    assert mixed == pytest.approx(plain, abs=0.01)


def test_infrared_beyond_the_standards_patches_does_not_change_the_index():
    short, wide = Grid.uniform(400, 780, 5), Grid.uniform(400, 1000, 5)
    qe = np.exp(-0.5 * ((wide.wavelength_nm[:, None] - [600.0, 540.0, 460.0]) / 45.0) ** 2)
    qe[wide.wavelength_nm > 790] = 0.3
    inside = wide.wavelength_nm <= 780
    indices = [
        sensor_metamerism(sensor_of(values, grid=grid)).index
        for values, grid in ((qe, wide), (qe[inside], short))
    ]
    assert indices[0] == pytest.approx(indices[1], abs=1e-9)
    infrared = Grid.uniform(800, 820, 10)
    with refused_input(subject="grid of toy", value=infrared):
        sensor_metamerism(sensor_of(np.full((3, 1), 0.5), grid=infrared))


# speed


@given(st.lists(st.floats(0.1, 100.0), min_size=3, max_size=3), st.floats(0.5, 50.0), mixes(3))
def test_more_read_noise_never_needs_less_light(signal, read_noise, mix):
    few, many = (
        light_for_snr(np.array(signal), mix[0], snr=10, read_noise_e=s)
        for s in (read_noise, 2 * read_noise)
    )
    assert many >= few


@given(st.lists(st.floats(0.1, 100.0), min_size=3, max_size=3), st.floats(-5.0, 5.0))
def test_the_scale_of_a_row_changes_no_snr(signal, power):
    row = np.array([1.2, -0.3, 0.4])
    levels = [
        light_for_snr(np.array([signal]), scale * row, snr=10, read_noise_e=3.0)
        for scale in (1.0, 10.0**power)
    ]
    assert levels[0] == pytest.approx(levels[1], rel=1e-10)


def test_no_light_is_enough_for_a_color_that_comes_out_negative():
    row = np.array([-1.0, 0.2])
    assert np.isinf(light_for_snr(np.array([5.0, 1.0]), row, snr=3, read_noise_e=1.0))


@given(sensors(min_channels=3, max_channels=3), st.floats(0.2, 5.0))
def test_noise_speed_does_not_care_for_white_balance_gains(sensor, gain):
    unmixed = np.eye(3) + 0.1
    gains = np.array([gain, 1.0, 1.0 / gain])[:, None]
    sensor = sensor_of(sensor.qe, pixel=pixel_with(3.0, 1e9))
    assert noise_speed(sensor, LAMP, gains * unmixed) == pytest.approx(
        noise_speed(sensor, LAMP, unmixed), rel=1e-10
    )


def test_speed_asked_of_the_wrong_thing_is_refused():
    sensor = sensor_of(RGB)
    matrix = kernel_matrix(sensor, EXPOSURE)
    with refused_input(subject="coordinate", value="L"):
        illuminance_for_snr(sensor, LAMP, EXPOSURE, matrix, coordinate="L")
    with refused_input(value={"sensor": ("c", "b", "a"), "matrix": ("a", "b", "c")}):
        illuminance_for_snr(sensor_of(RGB, names=("c", "b", "a")), LAMP, EXPOSURE, matrix)
    with refused_input(subject="snr", value=0.0):
        illuminance_for_snr(sensor, LAMP, EXPOSURE, matrix, snr=0.0)
    with refused_input(subject="rgb_matrix"):
        noise_speed(sensor, LAMP, -np.eye(3))
    with refused_input(subject="luminance_weights", value=3.0):
        NoiseSpeedModel(
            edition="x", luminance_weights=(1.0, 1.0, 1.0), red_weight=0.0, blue_weight=0.0
        )


# tonal range and information


@given(st.floats(1.0, 1e6), st.floats(0.0, 100.0), st.floats(0.0, 100.0))
def test_levels_grow_with_the_well_and_fall_with_noise_and_step(top, read_noise, step):
    def levels(factor_top, more_noise, more_step):
        return float(
            tonal_levels(
                np.array(top * factor_top),
                read_noise_e=read_noise + more_noise,
                step_e=step + more_step,
            )
        )

    here = levels(1.0, 0.0, 0.0)
    assert levels(1.5, 0.0, 0.0) >= here
    assert levels(1.0, 1.0, 0.0) <= here * (1 + 1e-12)
    assert levels(1.0, 0.0, 1.0) <= here * (1 + 1e-12)


@given(st.lists(st.floats(1.0, 1e5), min_size=1, max_size=4), st.floats(0.0, 50.0))
def test_color_sensitivity_of_a_picture_is_that_of_each_pixel(top, read_noise):
    picture = np.array([[top, top[::-1]]])
    bits = color_sensitivity_bits(picture, read_noise_e=read_noise)
    one = sum(float(tonal_range_bits(np.array(t), read_noise_e=read_noise)) for t in top)
    assert bits == pytest.approx(np.full((1, 2), one), rel=1e-10)


def test_a_signal_of_0_has_no_tonal_range():
    with refused_input(subject="top_e", value=0.0):
        tonal_range_bits(np.array(0.0), read_noise_e=1.0)


# visual noise


def linear_luv(xyz):
    return xyz @ JACOBIAN.T


def test_a_picture_of_white_noise_has_the_visual_noise_of_its_covariance():
    rng = np.random.default_rng(2)
    root = np.linalg.cholesky(XYZ_COVARIANCE)
    closed = visual_noise_of_white(XYZ_COVARIANCE, JACOBIAN, pixels_per_degree=40.0)
    variances = np.array(
        [
            visual_noise_of_picture(
                0.18 + rng.normal(size=(64, 64, 3)) @ root.T, linear_luv, pixels_per_degree=40.0
            ).sigma_luv
            ** 2
            for _ in range(60)
        ]
    )
    # the plane of 64 x 64 lacks its mean, and the closed form takes 256 x 256
    z = (variances.mean(axis=0) - closed.sigma_luv**2) / (variances.std(axis=0) / np.sqrt(60))
    assert (np.abs(z) < 5).all()


def test_a_sine_passes_with_the_contrast_sensitivity_of_its_frequency():
    # 8 periods in 64 pixels at 32 pixels per degree: 4 cycles per degree, luminance only
    x = np.arange(64)
    wave = 0.01 * np.sin(2 * np.pi * 8 * x / 64)
    gray = np.full((64, 64, 3), 0.2) + wave[None, :, None]
    seen = visual_noise_of_picture(gray, linear_luv, pixels_per_degree=32.0)
    # X = Y = Z: no ripple in C1 and C2, so each of X, Y, Z ripples by 3.0002
    assert seen.sigma_luv == pytest.approx(
        3.0002 * 0.01 / np.sqrt(2) * np.abs(JACOBIAN.sum(axis=1)), rel=1e-4
    )


def test_the_spectrum_of_a_picture_gives_the_visual_noise_of_that_picture():
    rng = np.random.default_rng(4)
    xyz = 0.3 + 0.01 * np.cumsum(rng.normal(size=(32, 48, 3)), axis=1)
    amplitude = np.fft.fft2(xyz, axes=(0, 1))
    spectrum = (amplitude[..., :, None] * amplitude[..., None, :].conj()).real / (32 * 48)
    closed = visual_noise_from_spectrum(spectrum, JACOBIAN, pixels_per_degree=30.0)
    seen = visual_noise_of_picture(xyz, linear_luv, pixels_per_degree=30.0)
    assert closed.sigma_luv == pytest.approx(seen.sigma_luv, rel=1e-10)
    assert closed.total == pytest.approx(seen.total, rel=1e-10)


@given(st.floats(0.1, 10.0))
def test_visual_noise_grows_as_the_noise(scale):
    few, many = (
        visual_noise_of_white(c, JACOBIAN, pixels_per_degree=40.0, samples=32)
        for c in (XYZ_COVARIANCE, scale**2 * XYZ_COVARIANCE)
    )
    assert many.total == pytest.approx(scale * few.total, rel=1e-9)


def test_pixels_too_fine_to_see_make_no_visual_noise():
    totals = [
        visual_noise_of_white(XYZ_COVARIANCE, JACOBIAN, pixels_per_degree=d).total
        for d in (30.0, 300.0, 1500.0)
    ]
    assert totals[0] > 5 * totals[1] > 10 * totals[2]


def test_the_total_weighs_luminance_red_and_blue_as_the_edition_says():
    seen = visual_noise_of_white(XYZ_COVARIANCE, JACOBIAN, pixels_per_degree=40.0, samples=32)
    lightness, red, blue = seen.sigma_luv
    assert seen.total == pytest.approx(lightness + 0.852 * red + 0.323 * blue, rel=1e-12)
    assert seen.edition == ISO_15739_2017.edition == "ISO 15739:2017"


def test_a_flat_picture_has_no_visual_noise():
    flat = np.full((16, 16, 3), 0.4)
    assert visual_noise_of_picture(flat, linear_luv, pixels_per_degree=40.0).total < 1e-12
    assert (contrast_sensitivity(frequencies_cpd((4, 4), pixels_per_degree=40.0)) > 0)[1:].all()


def test_a_visual_noise_model_without_meaning_is_refused():
    with refused_input(subject=f"K of luminance of {ISO_15739_2017.edition}", value=0.0):
        replace(ISO_15739_2017, luminance=(75.0, 0.2, 0.8, 0.0))
    with refused_input(subject=f"opponent_from_xyz of {ISO_15739_2017.edition}", value=(3, 3)):
        replace(
            ISO_15739_2017, opponent_from_xyz=((1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
        )
    with refused_input(subject="pixels_per_degree", value=0.0):
        frequencies_cpd((4, 4), pixels_per_degree=0.0)
