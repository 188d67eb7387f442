"""Each noise source of the list: closed form, distribution, all draws and the budget agree."""

from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

from chromanoise.apps.training.training_noise import sampler
from chromanoise.base.rng import stream
from chromanoise.color import LAB, ElectronSource, exact, noisy_color
from chromanoise.imaging import Work, acquired
from chromanoise.imaging.render import rendered_electrons
from chromanoise.metrics import snr_db
from chromanoise.noise import (
    Exposure,
    NoiseSources,
    Readout,
    few_electrons,
    monte_carlo,
    noise_sources,
    reading_distribution,
    sample_electrons,
    sensor_moments,
    with_noise,
)
from chromanoise.sensor import (
    EXTRA_NOISE,
    PIXEL,
    Adc,
    CameraNoise,
    Mosaic,
    Pixel,
    binned,
    with_pixel,
)
from chromanoise.sensor.noise_sources import FIXED, SOURCES
from chromanoise.spectra import DEFAULT_GRID, Grid, equal_energy, flat_field
from chromanoise.study import analyzed, color_budgets, sensor_named
from strategies import flat_cube, point_of, white_channel

TIME_S, STEP_E, BLACK_DN = 0.02, 0.25, 4000
GRID = Grid.uniform(500, 600, 10)
EXPOSURE = Exposure(time_s=TIME_S, f_number=8.0)
QUIET = Pixel(pitch_um=5, full_well_e=1e5, read_noise_e=0.5)
TELEGRAPH = replace(QUIET, rtn_share=0.01, rtn_amplitude_e=100.0)
AMOUNTS = {"rtn_share": 0.2, "rtn_amplitude_e": 30.0, "prnu": 0.15, "dark_current_e_per_s": 5000.0}
"""Enough for the source to be most of the noise; else a third of the slider's range."""
OF_PIXEL = [one.cause for one in SOURCES if one.drawn not in ("rounding", "place")]
SIDE, FRAMES = 192, 12


def amount(name):
    return AMOUNTS.get(name, PIXEL[name].slider[1] / 3)


def pixel_with_only(cause):
    """A pixel in which this source is the only one besides a little read noise."""
    source = next(one for one in SOURCES if one.cause == cause)
    names = [name for name in (*EXTRA_NOISE, "read_noise_e") if name != "black_error_e"]
    full = replace(QUIET, **{name: amount(name) for name in names})

    def value(pixel):
        return source.value(noise_sources(camera(pixel), EXPOSURE))

    needless = [name for name in names if value(replace(full, **{name: 0.0})) == value(full)]
    return replace(full, **{name: getattr(QUIET, name) for name in needless})


def camera(pixel, name="one"):
    return replace(white_channel(pixel=pixel, grid=GRID), name=name)


def point(pixel, name="one"):
    return point_of(camera(pixel, name), 2.0, exposure=EXPOSURE)


def flat(height=SIDE, width=SIDE):
    return flat_cube(GRID.wavelength_nm, 1.0, height=height, width=width)


def pictures(pixel, frames, *, new_sensor=True):
    """Electrons of raw pictures of a flat, of many sensors or of one, and what was expected."""
    adc = Adc(bits=16, gain_e_per_dn=STEP_E, black_level_dn=BLACK_DN)
    values = []
    for number in range(frames):
        one = point(pixel, f"sensor {number}" if new_sensor else "one")
        mosaic = Mosaic(((one.sensor.names[0],),))
        raw = acquired(flat(), one, mosaic=mosaic, adc=adc, frame=number, work=Work(threads=1))
        values.append(STEP_E * (raw.codes.astype(float) - BLACK_DN))
    return np.array(values), float(raw.mean_e[0])


def variance_is(found, expected, cause):
    """Within 5 standard errors: rows and columns have one variate each, others one per pixel."""
    shared = next(one.drawn for one in SOURCES if one.cause == cause) in ("row", "column")
    assert found == pytest.approx(expected, rel=0.01 + shared * 5 * np.sqrt(2.5 / (SIDE * FRAMES)))


def test_every_source_adds_to_the_coefficient_that_its_draw_has_and_one_draw_has_levels():
    draws = {"count": {"floor_e2", "slope_e"}, "gain": {"square"}, "place": {"square"}}
    assert all(one.term in draws.get(one.drawn, {"floor_e2"}) for one in SOURCES)
    assert [one.cause for one in SOURCES if one.drawn == "count"] == ["shot noise", "dark current"]
    assert sum(one.drawn == "levels" for one in SOURCES) == 1


def test_temporal_sources_are_those_of_the_temporal_variance():
    pixel = replace(QUIET, dsnu_e=3.0, prnu=0.1, row_noise_e=2.0)
    noise = noise_sources(camera(pixel), EXPOSURE)
    parts = noise.temporal.by_source(np.array([40.0])).values()
    assert sum(parts)[0] == pytest.approx(40 + 0.5**2 + 2.0**2)
    assert not replace(noise, pixel=replace(QUIET, dsnu_e=3.0)).temporal.beyond_shot_and_read


@pytest.mark.parametrize("cause", OF_PIXEL)
def test_raw_pictures_have_the_variance_of_the_closed_form(cause):
    pixel = pixel_with_only(cause)
    values, mean_e = pictures(pixel, FRAMES)
    expected = with_noise(np.array([mean_e]), camera(pixel), EXPOSURE).variance[0]
    variance_is(((values - mean_e) ** 2).mean(), expected + STEP_E**2 / 12, cause)


@pytest.mark.parametrize("cause", OF_PIXEL)
def test_frames_of_one_sensor_differ_by_the_temporal_noise(cause):
    pixel = pixel_with_only(cause)
    values, mean_e = pictures(pixel, FRAMES, new_sensor=False)
    law = noise_sources(camera(pixel), EXPOSURE).law("temporal")
    temporal = values.var(axis=0, ddof=1).mean()
    variance_is(temporal, law.variance_e2(mean_e) + STEP_E**2 / 12, cause)
    if next(one.drawn for one in SOURCES if one.cause == cause) in FIXED:
        spatial = values.mean(axis=0).var() - temporal / FRAMES
        expected = noise_sources(camera(pixel), EXPOSURE).law("spatial").variance_e2(mean_e)
        assert spatial == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("cause", OF_PIXEL)
def test_color_pictures_have_the_variance_of_the_closed_form(cause):
    pixel = pixel_with_only(cause)
    values = []
    for number in range(FRAMES):
        one = point(pixel, f"sensor {number}")
        picture = rendered_electrons(flat(), one, work=Work(threads=1))
        values.append(picture.values_e[..., 0].astype(float))
    mean_e = float(picture.mean_e[0])
    expected = with_noise(np.array([mean_e]), camera(pixel), EXPOSURE).variance[0]
    variance_is(((np.array(values) - mean_e) ** 2).mean(), expected, cause)


@pytest.mark.parametrize("cause", OF_PIXEL)
def test_pictures_without_shot_and_read_noise_have_all_other_sources(cause):
    pixel, values, adc = pixel_with_only(cause), [], Adc(bits=16, gain_e_per_dn=STEP_E)
    for number in range(FRAMES):
        one = point(pixel, f"sensor {number}")
        color = rendered_electrons(flat(), one, noisy=False, work=Work(threads=1))
        raw = acquired(
            flat(), one, mosaic=Mosaic(((one.sensor.names[0],),)), noisy=False,
            adc=replace(adc, black_level_dn=BLACK_DN), work=Work(threads=1),
        )  # fmt: skip
        values.append((color.values_e[..., 0], STEP_E * (raw.codes.astype(float) - BLACK_DN)))
    mean_e, away = float(color.mean_e[0]), np.array(values) - color.mean_e[0]
    parts = noise_sources(camera(pixel), EXPOSURE).by_source(np.array([mean_e]))
    left_out = ("shot noise", "read noise", "dark current")
    expected = sum(part[0] for name, part in parts.items() if name not in left_out)
    for found, rounding_e2 in zip((away**2).mean(axis=(0, 2, 3)), (0, STEP_E**2 / 12), strict=True):
        if expected:
            variance_is(found, expected + rounding_e2, cause)
        assert expected or found <= STEP_E**2 / 4


def test_color_pictures_of_summed_readings_have_a_telegraph_level_for_each():
    pixel = binned(replace(TELEGRAPH, read_noise_e=5.0), 16, "digital")
    pictures = [rendered_electrons(flat(), point(pixel), frame=i) for i in range(FRAMES)]
    away = np.array([one.values_e[..., 0] for one in pictures]) - pictures[0].mean_e[0]
    noise = NoiseSources(pixel=pixel)
    found = reading_distribution(pictures[0].mean_e, noise)
    kurtosis = found.probability[0] @ (found.values_e - pictures[0].mean_e[0]) ** 4
    variance = noise.variance_e2(pictures[0].mean_e)[0]
    assert (away**2).mean() == pytest.approx(variance, rel=0.02)
    assert (away**4).mean() == pytest.approx(kurtosis, rel=0.05)


def test_channels_of_a_color_picture_have_column_offsets_of_their_own():
    sensor = with_pixel(sensor_named("onyx-rgb-ircut", DEFAULT_GRID), {"column_noise_e": 300.0})
    one = point_of(sensor, 2.0, exposure=EXPOSURE)
    cube = flat_cube(DEFAULT_GRID.wavelength_nm, 1.0, height=16, width=2000)
    columns = rendered_electrons(cube, one, work=Work(threads=1)).values_e.mean(axis=0)
    correlation = np.corrcoef(columns.T)
    assert abs(correlation[np.triu_indices(3, 1)]).max() < 5 / np.sqrt(2000)
    assert columns.std(axis=0) == pytest.approx([300.0] * 3, rel=5 / np.sqrt(2 * 2000))


@pytest.mark.parametrize("cause", OF_PIXEL)
def test_training_data_have_the_variance_of_the_closed_form(cause):
    pixel = pixel_with_only(cause)
    noise = CameraNoise.from_sensor(camera(pixel))
    add_noise = sampler(noise, quantize=False, clamp=False, seed=3)
    clean = np.full((SIDE, SIDE), 40.0)
    samples = [
        add_noise(clean, unit="electron", item=i, pattern=i, time_s=TIME_S) for i in range(FRAMES)
    ]
    found = np.mean([((one.noisy - 40.0) ** 2).mean() for one in samples])
    expected = with_noise(np.array([40.0]), camera(pixel), EXPOSURE).variance[0]
    assert float(samples[0].variance.mean()) == pytest.approx(expected, rel=1e-5)
    variance_is(found, expected, cause)


@pytest.mark.parametrize("cause", OF_PIXEL)
def test_monte_carlo_and_the_exact_moments_have_the_variance_of_the_closed_form(cause):
    pixel = pixel_with_only(cause)
    noise, mean = noise_sources(camera(pixel), EXPOSURE), np.array([40.0])
    expected = with_noise(mean, camera(pixel), EXPOSURE).variance[0]
    estimate = monte_carlo(mean, pixel, np.eye(1), draws=40_000, seed=5, noise=noise)
    assert estimate.sd[0] ** 2 == pytest.approx(expected, rel=0.06)
    assert sensor_moments(mean, noise, Readout()).variance[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("cause", OF_PIXEL)
def test_the_distribution_has_the_moments_of_the_draws(cause):
    pixel = pixel_with_only(cause)
    noise, mean = noise_sources(camera(pixel), EXPOSURE), np.array([12.0])
    assert few_electrons(mean, noise)[0]
    found = reading_distribution(mean, noise)
    drawn = sample_electrons(np.full(400_000, 12.0), pixel, stream(7), noise=noise)
    share, at = found.probability[0], found.values_e
    first = share @ at
    assert first == pytest.approx(12.0, abs=0.01)
    second = share @ (at - first) ** 2
    assert second == pytest.approx(noise.variance_e2(mean)[0], rel=2e-3)
    fourth = share @ (at - first) ** 4 / second**2
    drawn_fourth = ((drawn - drawn.mean()) ** 4).mean() / drawn.var() ** 2
    if cause != "PRNU":  # whose product with the count is taken as normal
        assert drawn_fourth == pytest.approx(fourth, rel=0.05)


@pytest.mark.parametrize("cause", OF_PIXEL)
def test_the_budget_ends_at_the_snr_of_the_table_and_names_the_source(cause):
    own = pixel_with_only(cause)
    changes = {name: getattr(own, name) for name in EXTRA_NOISE}
    sensor = with_pixel(sensor_named("onyx-rgb-ircut", DEFAULT_GRID), changes)
    scene = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
    found = analyzed(scene, sensor, Exposure(time_s=TIME_S))
    for budget, in_table in zip(color_budgets(found), snr_db(found.color).values(), strict=True):
        losses = {cost.cause: cost.cost_db for cost in budget.costs}
        assert abs(losses["rest"]) < 0.01  # the color error of the matrix
        assert budget.snr_db == pytest.approx(in_table, abs=1e-9)
        assert cause == "shot noise" or losses[cause] > 0


def test_a_coarse_step_is_seen_beside_a_few_telegraph_pixels():
    pixel = replace(QUIET, rtn_share=0.02, rtn_amplitude_e=100.0)
    noise = replace(noise_sources(camera(pixel), EXPOSURE), step_e=6.0)
    bias, variance = noise.rounded(np.array([1.0]))
    drawn = sample_electrons(np.full(400_000, 1.0), pixel, stream(11), noise=noise)
    assert 1.0 + bias[0] == pytest.approx(drawn.mean(), abs=5 * drawn.std() / 400_000**0.5)
    assert variance[0] == pytest.approx(drawn.var(), rel=0.05)


@pytest.mark.parametrize(
    ("pixel", "step_e"),
    [
        (TELEGRAPH, 0.0),
        (TELEGRAPH, 4.0),
        (binned(replace(TELEGRAPH, rtn_share=0.2), 16, "digital"), 0.0),
    ],
)
def test_exact_moments_of_a_color_have_the_levels_of_telegraph_noise(pixel, step_e):
    noise = NoiseSources(pixel=pixel, step_e=step_e)
    source = ElectronSource(mean_e=np.array([10.0]), matrix=np.full((3, 1), 0.02), noise=noise)
    found = exact(noisy_color(source, np.ones(3)), LAB)
    drawn_e = sample_electrons(np.full(1_000_000, 10.0), pixel, stream(2), noise=noise)
    drawn = LAB.from_xyz(np.outer(drawn_e, [0.02] * 3), np.ones(3))[:, 0]
    kurtosis = ((drawn - drawn.mean()) ** 4).mean() / drawn.var() ** 2
    sd_se = np.hypot(drawn.std() * np.sqrt((kurtosis - 1) / 4 / drawn.size), found.sd_error[0])
    assert abs(np.sqrt(found.covariance[0, 0]) - drawn.std()) < 5 * sd_se
    mean_se = np.hypot(drawn.std() / drawn.size**0.5, found.mean_error[0])
    noiseless = LAB.from_xyz(np.full((1, 3), 0.2), np.ones(3))[0, 0]
    assert abs(found.bias[0] + noiseless - drawn.mean()) < 5 * mean_se


@pytest.mark.parametrize("readings", [1, 4, 16])
def test_each_of_several_readings_has_its_own_telegraph_level(readings):
    pixel = binned(replace(TELEGRAPH, read_noise_e=5.0), readings, "digital")
    noise, mean = NoiseSources(pixel=pixel), np.array([10.0])
    # fourth cumulants of independent variables add: of a level s a^4 - 3 (s a^2)^2, of a count M
    share, away_e = 0.01, 50.0
    of_levels = readings * (share * away_e**4 - 3 * (share * away_e**2) ** 2)
    variance = readings * (5.0**2 + share * away_e**2) + 10.0
    kurtosis = 3 + (of_levels + 10.0) / variance**2
    found = reading_distribution(mean, noise)
    first = found.probability[0] @ found.values_e
    second, fourth = (found.probability[0] @ (found.values_e - first) ** k for k in (2, 4))
    assert second == pytest.approx(variance, rel=1e-9)
    assert fourth / second**2 == pytest.approx(kurtosis, rel=1e-9)
    drawn = sample_electrons(np.full(1_000_000, 10.0), pixel, stream(8), noise=noise)
    assert drawn.var() == pytest.approx(variance, rel=5 * np.sqrt((kurtosis - 1) / drawn.size))
    assert ((drawn - 10.0) ** 4).mean() / variance**2 == pytest.approx(kurtosis, rel=0.03)


def test_a_table_of_wide_telegraph_levels_takes_no_longer_than_that_of_narrow_ones():
    def cells(amplitude_e):
        pixel = replace(TELEGRAPH, rtn_amplitude_e=amplitude_e)
        with counted_products() as products:
            reading_distribution(np.array([10.0]), NoiseSources(pixel=pixel))
        return sum(products)

    assert cells(5000.0) < 1.01 * cells(50.0)


@contextmanager
def counted_products():
    """The number of products of each convolution."""
    found, own = [], np.convolve

    def counted(one, other):
        found.append(one.size * other.size)
        return own(one, other)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(np, "convolve", counted)
        yield found


@pytest.mark.parametrize(("share", "is_one"), [(5e-4, True), (0.01, False)])
def test_one_code_is_that_of_more_than_999_of_1000_readings(share, is_one):
    pixel = replace(QUIET, read_noise_e=1.0, rtn_share=share, rtn_amplitude_e=2000.0)
    noise, mean = NoiseSources(pixel=pixel, step_e=100.0), np.array([5.0])
    drawn = sample_electrons(np.full(100_000, 5.0), pixel, stream(4), noise=noise)
    assert ((drawn == 0).mean() > 0.999) == is_one
    assert noise.gives_one_code(mean)[0] == is_one
