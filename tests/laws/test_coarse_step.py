"""A step of the converter that exceeds the noise: exact rounding, in every number that follows."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import stats

import chromanoise as cn
from chromanoise.noise import (
    Exposure,
    Readout,
    few_electrons,
    monte_carlo,
    noise_sources,
    reading_distribution,
    sample_electrons,
    sensor_moments,
    with_noise,
)
from chromanoise.noise.variance import crosstalk_pattern
from chromanoise.sensor import (
    PAPER_PIXEL,
    Crosstalk,
    crosstalk_of_kernel,
    mosaic_named,
    with_binning,
    with_crosstalk,
    with_pixel,
)
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import (
    analyzed,
    color_budgets,
    color_snr_db,
    contravariant_budgets,
    contravariant_snr_db,
    diagnosis,
    lab_budgets,
    raw_snr_db,
    sensor_named,
)
from chromanoise.study.reading_quality import BRIGHT, DARK, TOLERANCE, contrast_detection_of
from dear import dear
from goodness import moments_z
from noise_samples import noise_of
from outcomes import refused_input

LAMP = equal_energy(DEFAULT_GRID)
EXPOSURE = Exposure(time_s=0.012)
EIGHT_BITS = {"bits": 8, "read_noise_e": 3.0, "full_well_e": 10_000.0}  # 39.2 e- per code
LOW_GAIN = {"bits": 12, "gain_e_per_dn": 100 / 3, "read_noise_e": 3.0}
WHOLE = {"dark_current_e_per_s": 400.0, "dsnu_e": 1.0, "row_noise_e": 1.0, "black_error_e": 2.0}


def seen(level_lux, **pixel):
    sensor = with_pixel(sensor_named("model-rgb-ircut", DEFAULT_GRID), pixel)
    return analyzed(flat_field(LAMP, level_lux=level_lux), sensor, EXPOSURE)


def drawn_e(analysis, count=400_000, seed=5):
    """Plain draws of the readings, minus the error of the black level, which is no signal."""
    noise = noise_sources(analysis.sensor, analysis.exposure)
    rng, mean = np.random.default_rng(seed), analysis.expected_e
    read = rng.poisson(mean + noise.dark_e, (count, mean.size)) - noise.dark_e
    for sd in (noise.pixel.read_noise_e, noise.pixel.row_noise_e, noise.pixel.dsnu_e):
        read = read + sd * rng.standard_normal(read.shape)
    step, black = noise.step_e, noise.black_error_e
    return step * np.floor((read + black) / step + 0.5) - black


CASES = [
    (0.1, EIGHT_BITS),
    (0.5, EIGHT_BITS),
    (0.5, LOW_GAIN),
    (0.3, EIGHT_BITS | WHOLE),
    (2.0, LOW_GAIN | WHOLE),
]


@pytest.mark.parametrize(("level_lux", "pixel"), CASES)
def test_raw_and_color_have_the_mean_and_noise_of_plain_draws(level_lux, pixel):
    analysis = seen(level_lux, **pixel)
    read, matrix = drawn_e(analysis), analysis.matrix.matrix
    assert moments_z(read, analysis.raw.mean, analysis.raw.variance) < 5
    assert moments_z(read @ matrix.T, analysis.color.mean, analysis.color.variance) < 5
    snr = 20 * np.log10(read.mean(axis=0) / read.std(axis=0))
    assert list(raw_snr_db(analysis).values()) == pytest.approx(snr, abs=0.2)


@pytest.mark.parametrize(("level_lux", "pixel"), CASES)
def test_monte_carlo_has_the_same_mean_and_noise(level_lux, pixel):
    analysis = seen(level_lux, **pixel)
    noise = noise_sources(analysis.sensor, EXPOSURE)
    found = monte_carlo(
        analysis.expected_e, analysis.sensor.pixel, np.eye(3), draws=100_000, seed=3, noise=noise
    )
    mean = analysis.raw.mean + noise.black_error_e
    assert np.abs((found.mean - mean) / found.mean_se).max() < 5
    assert np.abs((found.sd - np.sqrt(analysis.raw.variance)) / found.sd_se).max() < 5


def summed(mean, dark, sd, step, black):
    n = np.arange(int(mean + dark + 12 * np.sqrt(mean + dark) + 40))
    k = np.arange(-int(12 * sd / step) - 60, int((n[-1] + 12 * sd) / step) + 60)
    at = n[:, None] - dark + black
    edges = [stats.norm.cdf(((k + side) * step - at) / sd) for side in (-0.5, 0.5)]
    share = stats.poisson.pmf(n, mean + dark) @ (edges[1] - edges[0])
    center = share @ (k * step)
    return center - mean - black, share @ (k * step - center) ** 2


@given(
    mean=st.floats(0.0, 400.0),
    dark=st.floats(0.0, 5.0),
    sd=st.floats(0.2, 20.0),
    steps_per_sd=st.floats(0.2, 6.0),
    black=st.floats(-20.0, 20.0),
)
def test_rounding_is_exact_and_no_digit_jumps_where_step_squared_over_12_takes_over(
    mean, dark, sd, steps_per_sd, black
):
    step = np.sqrt(mean + dark + sd**2) / steps_per_sd
    noise = noise_of(read_noise_e=sd, dark_e=dark, step_e=step, black_error_e=black)
    means = np.array([mean])
    bias, variance = noise.rounded(means)
    known = summed(mean, dark, sd, step, black)
    coarse = bool(noise.rounding_is_coarse(means)[0])
    close = 1e-9 if coarse else 2e-6
    assert bias[0] == pytest.approx(known[0], abs=close * np.sqrt(known[1]) + 1e-9)
    assert variance[0] == pytest.approx(known[1], rel=close, abs=1e-9)
    if not coarse:
        assert variance[0] == noise.variance_e2(means)[0]
        assert bias[0] == 0
    assert coarse or step < 1.3 * np.sqrt(mean + dark + sd**2)


@pytest.mark.parametrize("sd", [1.0, 3.0, 10.0])
def test_many_fine_steps_keep_the_linear_model_to_the_last_digit(sd):
    noise = noise_of(read_noise_e=sd, step_e=0.8 * sd, dsnu_e=0.3, prnu=0.01)
    mean = np.geomspace(1e-3, 1e5, 40)
    bias, variance = noise.rounded(mean)
    assert not bias.any()
    assert (variance == noise.variance_e2(mean)).all()


def test_one_code_has_no_snr_and_a_note_with_step_and_noise():
    analysis = seen(0.01, **EIGHT_BITS)
    assert (drawn_e(analysis, 20_000) == 0).mean() > 0.999
    assert analysis.one_code.all()
    for ratios in (raw_snr_db, color_snr_db, contravariant_snr_db):
        assert set(ratios(analysis).values()) == {None}
    assert analysis.optimal_linear_snr_db is analysis.spectral_snr_db is None
    assert color_budgets(analysis) == (None,) * 3
    (note,) = [one for one in diagnosis(analysis) if "step" in one]
    assert "39.2 e-" in note
    assert "same code" in note


@pytest.mark.parametrize(
    ("pixel", "noted"),
    [(EIGHT_BITS, True), (EIGHT_BITS | {"bits": 12}, False), ({"read_noise_e": 3.0}, False)],
)
def test_a_note_names_the_codes_of_a_step_above_the_noise(pixel, noted):
    notes = [one for one in diagnosis(seen(0.1, **pixel)) if "exceeds the noise" in one]
    assert len(notes) == noted
    assert all(" codes" in one and "39.2 e-" in one for one in notes)


@pytest.mark.parametrize(("level_lux", "pixel"), [*CASES[::4], *dear(*CASES[1:4])])
def test_the_causes_of_a_budget_add_up_to_the_snr_of_the_rounded_readings(level_lux, pixel):
    analysis = seen(level_lux, **pixel)
    found = color_budgets(analysis) + contravariant_budgets(analysis) + lab_budgets(analysis)
    for budget in found:
        if budget is not None:
            total = budget.photons_db - sum(cost.cost_db for cost in budget.costs)
            assert total == pytest.approx(budget.snr_db, abs=1e-9)
    known = color_snr_db(analysis) | {
        f"M^{name}": value for name, value in contravariant_snr_db(analysis).items()
    }
    named = {budget.coordinate: budget for budget in found if budget is not None}
    assert {"X", "Y", "Z"} < set(named)
    for name, value in known.items():
        if name in named:
            assert named[name].snr_db == pytest.approx(value, abs=1e-9)
            rest = named[name].costs[-1].cost_db
            assert rest == pytest.approx(0.0, abs=0.1)  # infrared of a sensor with IR-cut


def test_clipping_that_clips_nothing_changes_no_number():
    settings = {"lux": 1.0, "time_ms": 12.0, "bits": 12, "gain_dn_per_e": 0.03, "read_noise_e": 3.0}
    plain, clipped = (
        cn.analyze("model-rgb-ircut", clip=clip, **settings) for clip in (False, True)
    )
    for one, other in zip(plain.analyses, clipped.analyses, strict=True):
        assert one.raw.mean == pytest.approx(other.raw.mean, rel=1e-12)
        assert one.raw.variance == pytest.approx(other.raw.variance, rel=1e-12)


def test_summed_readings_are_each_rounded():
    sensor = with_pixel(sensor_named("model-mono", DEFAULT_GRID), EIGHT_BITS)
    four = with_binning(sensor, 4, "digital")
    mean, step, rng = 90.0, 10_000 / 255, np.random.default_rng(1)
    read = rng.poisson(mean / 4, (300_000, 4)) + 3.0 * rng.standard_normal((300_000, 4))
    values = (step * np.floor(read / step + 0.5)).sum(axis=1)
    found = with_noise(np.array([mean]), four, EXPOSURE)
    assert moments_z(values[:, None], found.mean, found.variance) < 5


@pytest.mark.parametrize("lowest", [-np.inf, 0.0])
def test_each_of_summed_readings_is_rounded_and_clipped_in_exact_moments_and_draws(lowest):
    n, step, light, dark, read, rng = 4, 9.0, 3.0, 2.0, 3.5, np.random.default_rng(2)
    electrons = rng.poisson(light + dark, (400_000, n)) - dark
    electrons = electrons + read * rng.standard_normal(electrons.shape)
    values = np.maximum(step * np.floor(electrons / step + 0.5), lowest).sum(axis=1)
    four = noise_of(read_noise_e=2 * read, dark_e=n * dark, step_e=2 * step, readings=n)
    mean = np.array([n * light])
    found = sensor_moments(mean, four, Readout(black_e=lowest))
    assert moments_z(values[:, None], found.mean, found.variance) < 5
    assert not few_electrons(mean, four).any()  # a table of one reading is not that of the sum
    with refused_input(subject="noise"):
        reading_distribution(mean, four)
    if lowest < 0:
        drawn = sample_electrons(np.full((400_000, 1), n * light), PAPER_PIXEL, rng, noise=four)
        assert moments_z(drawn, found.mean, found.variance) < 5


def test_contrast_is_detected_as_often_as_in_rounded_draws():
    analysis = seen(16.0, **EIGHT_BITS | {"bits": 8, "full_well_e": 60_000.0})  # 235 e- per code
    noise = noise_sources(analysis.sensor, EXPOSURE)
    true, count, rng = BRIGHT / DARK - 1, 300_000, np.random.default_rng(2)
    detected = contrast_detection_of(analysis).channels.values()
    for mean, share in zip(analysis.expected_e, detected, strict=True):
        high, low = (
            noise.step_e
            * np.floor(
                (rng.poisson(rho * mean, count) + 3.0 * rng.normal(size=count)) / noise.step_e + 0.5
            )
            for rho in (BRIGHT, DARK)
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            off = np.abs(high / low - 1 - true)
        drawn = ((low > 0) & (off <= TOLERANCE * true * (1 + 1e-9))).mean()
        assert abs(share - drawn) < 5 * np.sqrt(max(drawn * (1 - drawn), 1e-5) / count)


def test_correlated_readings_keep_the_linear_model_with_a_note():
    sensor = with_pixel(sensor_named("model-rgb-ircut", DEFAULT_GRID), EIGHT_BITS)
    mixed = with_crosstalk(
        sensor, Crosstalk(matrix=0.85 * np.eye(3) + 0.05, stage="charge", pixels=(1, 1, 1))
    )
    analysis = analyzed(flat_field(LAMP, level_lux=0.1), mixed, EXPOSURE)
    (note,) = [one for one in diagnosis(analysis) if "exceeds the noise" in one]
    assert "step^2 / 12" in note


def test_the_dynamic_range_of_few_bits_stays_finite():
    noise = with_noise(np.zeros(1), replace(one_white(), converter=EIGHT), EXPOSURE, linear=True)
    assert noise.variance[0] == pytest.approx(9.0 + 40.0**2 / 12)


def one_white():
    return with_pixel(sensor_named("model-mono", DEFAULT_GRID), {"read_noise_e": 3.0})


EIGHT = cn.sensor.Converter(bits=8, gain_e_per_dn=40.0)


@pytest.mark.parametrize(
    ("light", "step", "full"), [(9000.0, 600.0, np.inf), (9500.0, 0.0, 9800.0)]
)
def test_places_with_different_neighbors_are_each_rounded_and_clipped(light, step, full):
    kernel = np.array([[0, 0.05, 0], [0.05, 0.8, 0.05], [0, 0.05, 0]])
    crosstalk = crosstalk_of_kernel(kernel, mosaic_named("rgbw-4x4"), ("R", "G", "B", "W"))
    pattern, rng = crosstalk_pattern(crosstalk), np.random.default_rng(3)
    mean, sources = light * np.array([0.35, 0.6, 0.4, 1.0]), {"read_noise_e": 3.0, "step_e": step}
    places = pattern.means_e(mean, 3)
    values = rng.poisson(rng.choice(places, 400_000)) + 3.0 * rng.standard_normal(400_000)
    values = step * np.floor(values / step + 0.5) if step else values
    noise = noise_of(**sources, pattern=pattern)
    found = sensor_moments(mean, noise, Readout(full_well_e=full))
    assert moments_z(np.minimum(values, full)[:, None], found.mean[3], found.variance[3]) < 5
    if full == np.inf:
        bias, variance = noise.rounded(mean)
        assert moments_z(values[:, None], mean[3] + bias[3], variance[3]) < 5
