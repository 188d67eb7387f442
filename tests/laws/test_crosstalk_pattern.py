"""The fixed pattern of crosstalk in mosaics in which pixels of one channel have other neighbors.

The mosaics here are tiled, convolved and counted by plain numpy, without the program.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from chromanoise.color import LAB, ElectronSource, exact, kernel_matrix, noisy_color, propagate
from chromanoise.imaging import DEMOSAICING, acquired, developed, developed_color
from chromanoise.metrics import illuminance_for_snr
from chromanoise.noise import (
    Exposure,
    channel_distribution,
    expected_electrons,
    few_electrons,
    mean_noise_covariance,
    monte_carlo,
    noise_sources,
    sensor_moments,
    with_noise,
)
from chromanoise.noise.readout import Readout
from chromanoise.noise.variance import CrosstalkPattern, crosstalk_pattern
from chromanoise.sensor import (
    Adc,
    Crosstalk,
    Mosaic,
    crosstalk_of_kernel,
    crosstalk_of_share,
    mosaic_named,
    with_crosstalk,
    with_pixel,
)
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import analyzed, diagnosis, raw_snr_db, sensor_named
from chromanoise.study.analysis import temporal_raw_snr_db
from chromanoise.study.camera_pipeline import pipeline_noise
from chromanoise.study.color_noise import color_budgets, contravariant_budgets, lab_budgets
from noise_samples import noise_of
from strategies import flat_cube, point_of

LAMP = equal_energy(DEFAULT_GRID)
WHITE = flat_field(LAMP, level_lux=10.0)
EXPOSURE = Exposure(time_s=0.012)
CAUSE = "crosstalk pattern"
SENSORS = {"bayer": "model-rgb-ircut", "rgbw-2x2": "model-rgbw-ircut", "rgbw-4x4": "onyx-rgbw"}
STAGES = ("light", "charge")
NOISE = {"prnu": 0.02, "dsnu_e": 5.0, "read_noise_e": 8.0, "dark_current_e_per_s": 5000.0}
LOPSIDED = np.array([[0.0, 0.08, 0.0], [0.1, 0.66, 0.04], [0.0, 0.06, 0.02]])


def cross(share):
    quarter = share / 4
    return np.array([[0, quarter, 0], [quarter, 1 - share, quarter], [0, quarter, 0]])


def pure(mosaic, **pixel):
    sensor = with_pixel(sensor_named(SENSORS[mosaic], DEFAULT_GRID), {"full_well_e": 1e5, **pixel})
    return replace(sensor, mosaic=mosaic_named(mosaic))


def crossed(mosaic="rgbw-4x4", stage="light", kernel=None, **pixel):
    sensor, kernel = pure(mosaic, **pixel), cross(0.1) if kernel is None else kernel
    mixing = crosstalk_of_kernel(kernel, sensor.mosaic, sensor.names)
    return with_crosstalk(sensor, replace(mixing, stage=stage))


def read(sensor, light=1.0, **more):
    return with_noise(light * expected_electrons(WHITE, sensor, EXPOSURE), sensor, EXPOSURE, **more)


def mixed(values, kernel):
    """Each pixel of a torus of pixels receives the shares of its neighbors."""
    found = np.zeros_like(values, dtype=float)
    for (dy, dx), share in np.ndenumerate(kernel):
        shift = (dy - kernel.shape[0] // 2, dx - kernel.shape[1] // 2)
        found += share * np.roll(values, shift, axis=(-2, -1))
    return found


def tiled(mosaic, names, side):
    """Index of the channel of each pixel."""
    tile = np.array([[names.index(name) for name in row] for row in mosaic.pattern])
    return np.tile(tile, (side // tile.shape[0], side // tile.shape[1]))


def assert_variances_follow(found, expected):
    """One variance per batch and channel; batches are independent."""
    error = found.std(axis=0, ddof=1) / np.sqrt(len(found))
    assert np.abs((found.mean(axis=0) - expected) / error).max() < 5


# a closed form by hand


@pytest.mark.parametrize(("share", "percent"), [(0.1, 1.12), (0.2, 2.28)])
def test_white_of_a_sparse_mosaic_has_three_kinds_of_neighbors(share, percent):
    """RWGW/WWWW/GWBW/WWWW: of 12 W, 4 are between R and G, 4 between G and B, 4 among W."""
    r, g, b, w = expected_electrons(WHITE, pure("rgbw-4x4"), EXPOSURE)
    q = share / 4
    means = np.array([w + q * (r + g - 2 * w), w + q * (g + b - 2 * w), w])
    for stage in STAGES:
        sensor = crossed(stage=stage, kernel=cross(share))
        total, temporal = read(sensor), read(sensor, kind="temporal")
        assert total.mean[3] == pytest.approx(means.mean(), rel=1e-12)
        assert (total.variance - temporal.variance)[3] == pytest.approx(means.var(), rel=1e-9)
        assert (total.variance - temporal.variance)[:3] == pytest.approx(np.zeros(3), abs=1e-9)
    assert 100 * means.std() / means.mean() == pytest.approx(percent, abs=0.01)


@pytest.mark.parametrize("stage", STAGES)
def test_where_the_mean_neighborhood_gives_35_76_db_a_counted_mosaic_has_less_than_33_4(stage):
    pure = sensor_named("model-rgbw-ircut", DEFAULT_GRID)
    mixing = crosstalk_of_share(0.1, mosaic_named("rgbw-4x4"), pure.names)
    sensor = with_crosstalk(pure, replace(mixing, stage=stage))
    of_means = replace(sensor, crosstalk=replace(sensor.crosstalk, places=None))
    lights = np.geomspace(0.1, 1.0, 2001)[:, None]
    before = read(of_means, lights)
    decibels = 20 * np.log10(before.mean / np.sqrt(before.variance))[:, 3]
    light = np.interp(35.76, decibels, lights[:, 0])
    channel = tiled(mosaic_named("rgbw-4x4"), pure.names, 512)
    mean = light * expected_electrons(WHITE, pure, EXPOSURE)[channel]
    rng, kernel = np.random.default_rng(5), cross(0.1)
    counts = mixed(mean, kernel) if stage == "light" else rng.poisson(mean)
    counts = rng.poisson(counts) if stage == "light" else mixed(counts, kernel)
    white = (counts + 10.0 * rng.standard_normal(channel.shape))[channel == 3]
    counted = 20 * np.log10(white.mean() / white.std())
    raw = read(sensor, light)
    assert counted == pytest.approx(20 * np.log10(raw.mean / np.sqrt(raw.variance))[3], abs=0.05)
    assert counted < 33.4


# laws for any kernel and mosaic


@st.composite
def kernels(draw):
    shares = np.array(
        draw(st.lists(st.sampled_from([0.0, 0.01, 0.03, 0.05]), min_size=9, max_size=9))
    )
    kernel = shares.reshape(3, 3)
    kernel[1, 1] = 0.6
    return kernel


@st.composite
def mosaics(draw):
    rows, columns = draw(st.integers(1, 4)), draw(st.integers(1, 4))
    letters = [[draw(st.sampled_from("RGB")) for _ in range(columns)] for _ in range(rows)]
    return Mosaic(tuple(map(tuple, letters)))


@given(mosaics(), kernels(), st.sampled_from(STAGES), st.floats(0.0, 0.2))
def test_places_have_the_former_mean_and_vary_only_if_their_neighborhoods_do(
    mosaic, kernel, stage, prnu
):
    names = tuple(sorted(mosaic.names))
    channel = tiled(mosaic, names, 12)
    crosstalk = replace(crosstalk_of_kernel(kernel, mosaic, names), stage=stage)
    before = np.array([900.0, 350.0, 120.0])[: len(names)]
    seen = mixed(before[channel], kernel)
    shares = np.stack([mixed((channel == c) * 1.0, kernel) for c in range(len(names))], axis=-1)
    of_channels = [shares[channel == c] for c in range(len(names))]
    equal = all(np.abs(own - own[0]).max() < 1e-12 for own in of_channels)
    pattern = crosstalk_pattern(crosstalk)
    assert (pattern is None) == equal
    assert crosstalk.matrix == pytest.approx(np.array([own.mean(axis=0) for own in of_channels]))
    noise = noise_of(read_noise_e=0.0, prnu=prnu, pattern=pattern)
    mean = crosstalk.matrix @ before
    sources = noise.by_source(mean if stage == "light" else before)
    variance = np.array([seen[channel == c].var() for c in range(len(names))])
    assert sources[CAUSE] == pytest.approx(variance, abs=1e-9, rel=1e-9)
    if stage == "light":
        squares = np.array([(seen[channel == c] ** 2).mean() for c in range(len(names))])
        assert sources["PRNU"] == pytest.approx(prnu**2 * squares, rel=1e-9)


def test_a_matrix_alone_or_one_that_cannot_be_inverted_has_no_known_pattern():
    mixing = crosstalk_of_share(0.1, mosaic_named("rgbw-4x4"), ("R", "G", "B", "W"))
    alone = Crosstalk(matrix=mixing.matrix, pixels=mixing.pixels)
    assert crosstalk_pattern(mixing) is not None
    assert crosstalk_pattern(alone) is None
    assert crosstalk_pattern(None) is None
    lost = analyzed(WHITE, crossed(kernel=cross(0.75)), EXPOSURE)
    assert noise_sources(lost.sensor, EXPOSURE).pattern is None
    assert any("pattern" in note for note in diagnosis(lost))


@pytest.mark.parametrize("mosaic", ["bayer", "rgbw-2x2"])
@pytest.mark.parametrize("stage", STAGES)
def test_equal_neighborhoods_have_the_covariance_of_their_mean(mosaic, stage):
    sensor = crossed(mosaic, stage, cross(0.15), **NOISE)
    of_means = replace(sensor, crosstalk=replace(sensor.crosstalk, places=None))
    np.testing.assert_array_equal(read(sensor).covariance, read(of_means).covariance)
    less = read(of_means).variance - read(sensor).variance
    assert (less > 0).all() if stage == "charge" else not less.any()


# draws by plain numpy


@pytest.mark.parametrize("kernel", [cross(0.1), cross(0.2), LOPSIDED], ids=["10", "20", "lopsided"])
@pytest.mark.parametrize("mosaic", SENSORS)
@pytest.mark.parametrize("stage", STAGES)
def test_a_counted_mosaic_has_the_variance_of_one_reading(mosaic, stage, kernel):
    sensor, before = crossed(mosaic, stage, kernel, **NOISE), pure(mosaic)
    channel = tiled(sensor.mosaic, sensor.names, 128)
    light = expected_electrons(WHITE, before, EXPOSURE)[channel]
    dark = 5000.0 * 0.012
    rng, found = np.random.default_rng(7), []
    for _ in range(24):
        gain = 1 + 0.02 * rng.standard_normal(channel.shape)
        if stage == "light":
            counts = rng.poisson(mixed(light, kernel) * gain + dark) - dark
            counts = counts + 5.0 * rng.standard_normal(channel.shape)
        else:
            counts = rng.poisson(light * gain + dark) - dark
            counts = mixed(counts + 5.0 * rng.standard_normal(channel.shape), kernel)
        values = counts + 8.0 * rng.standard_normal(channel.shape)
        found.append([values[channel == c].var() for c in range(len(sensor.names))])
    assert_variances_follow(np.array(found), read(sensor).variance)


@pytest.mark.parametrize("mosaic", SENSORS)
@pytest.mark.parametrize("stage", STAGES)
def test_raw_codes_of_a_flat_have_the_variance_of_the_analysis(mosaic, stage):
    adc = Adc(bits=16, gain_e_per_dn=0.5, black_level_dn=2000)
    sensor = crossed(mosaic, stage, cross(0.2), gain_e_per_dn=0.5, **NOISE)
    channel, found, means = tiled(sensor.mosaic, sensor.names, 128), [], []
    for number in range(16):
        one = point_of(replace(sensor, name=f"camera {number}"), exposure=EXPOSURE)
        raw = acquired(
            flat_cube(DEFAULT_GRID.wavelength_nm, 1.0, height=128, width=128), one, adc=adc
        )
        values = 0.5 * (raw.codes.astype(float) - 2000)
        found.append([values[channel == c].var() for c in range(len(sensor.names))])
        means.append(raw.mean_e)
    assert_variances_follow(np.array(found), read(sensor).variance)
    assert np.mean(means, axis=0) == pytest.approx(read(sensor).mean, rel=1e-4)


@pytest.mark.parametrize("stage", STAGES)
def test_demosaiced_pictures_have_the_means_and_the_noise_of_their_places(stage):
    sensor = crossed("rgbw-4x4", stage, cross(0.2), **NOISE)
    mosaic, matrix = sensor.mosaic, kernel_matrix(sensor, EXPOSURE)
    bank = DEMOSAICING["bilinear"](mosaic, point_of(sensor, exposure=EXPOSURE))
    adc = Adc(bits=16, gain_e_per_dn=0.5, black_level_dn=2000)
    told = developed_color(WHITE, point_of(sensor, exposure=EXPOSURE), bank, adc, matrix=matrix)
    white = (matrix.matrix @ read(sensor).mean)[1]
    means, variances = [], []
    for number in range(12):
        one = point_of(replace(sensor, name=f"camera {number}"), exposure=EXPOSURE)
        flat = flat_cube(DEFAULT_GRID.wavelength_nm, 1.0, height=128, width=128)
        raw = acquired(flat, one, adc=adc, seed=number)
        xyz = developed(raw, bank, matrix=matrix).xyz[8:-8, 8:-8].astype(float) * white
        places = xyz.reshape(28, 4, 28, 4, 3).transpose(1, 3, 0, 2, 4).reshape(4, 4, -1, 3)
        means.append(places.mean(axis=2))
        variances.append(places.var(axis=2))
    expected = np.array([[one.mean for one in row] for row in told])
    assert_variances_follow(np.array(means), expected)
    assert_variances_follow(np.array(variances), np.array([[o.variance for o in r] for r in told]))
    assert np.ptp(expected[..., 1]) > 0.01 * expected[..., 1].mean()


# the other ways to the same noise


@pytest.mark.parametrize("stage", STAGES)
def test_the_mean_noise_of_a_set_of_lights_contains_the_pattern_of_each(stage):
    sensor = crossed("rgbw-4x4", stage, **NOISE)
    lights = np.array([0.2, 0.7, 1.3])[:, None] * expected_electrons(WHITE, sensor, EXPOSURE)
    lights = lights * np.array([[1.0, 0.9, 1.1, 1.0], [1, 1, 1, 1], [0.9, 1.0, 1.0, 1.0]])
    share, factor = np.array([0.5, 0.3, 0.2]), np.array([0.1, 1.0, 3.0])
    each = np.stack([with_noise(f * lights, sensor, EXPOSURE).covariance for f in factor])
    mean = np.einsum("k,fkij->fij", share, each)
    found = mean_noise_covariance(lights, share, sensor, EXPOSURE, light=factor)
    assert found == pytest.approx(mean, rel=1e-10, abs=1e-6)


def test_monte_carlo_draws_a_place_of_the_mosaic():
    sensor = crossed("rgbw-4x4", "light", cross(0.2), **NOISE)
    raw = read(sensor)
    found = monte_carlo(
        raw.mean, sensor.pixel, np.eye(4), draws=200_000, seed=3,
        noise=noise_sources(sensor, EXPOSURE),
    )  # fmt: skip
    assert np.abs((found.sd - np.sqrt(raw.variance)) / found.sd_se).max() < 5
    assert np.abs((found.mean - raw.mean) / found.mean_se).max() < 5


def test_few_electrons_have_the_distribution_of_the_places_together():
    sensor = crossed("rgbw-4x4", "light", cross(0.2), read_noise_e=0.0)
    noise = noise_sources(sensor, EXPOSURE)
    mean = read(sensor).mean * np.array([[0.002], [0.004]])
    assert few_electrons(mean, noise).all()
    r, g, b, w = 0.002 * expected_electrons(WHITE, pure("rgbw-4x4"), EXPOSURE)
    places = [w + 0.05 * (r + g - 2 * w), w + 0.05 * (g + b - 2 * w), w]
    rng = np.random.default_rng(2)
    drawn = rng.poisson(np.repeat(places, 100_000))
    counts = channel_distribution(mean, 3, noise)
    values = counts.values_e.round().astype(int)
    found = np.bincount(drawn, minlength=values.max() + 1)[values[values >= 0]]
    expected = drawn.size * counts.probability[0][values >= 0]
    often = expected > 20
    z = (found[often] - expected[often]) / np.sqrt(expected[often])
    assert np.abs(z).max() < 5
    assert (counts.probability[0] @ counts.values_e) == pytest.approx(mean[0, 3], rel=1e-6)


def test_a_sum_of_readings_has_a_table_only_where_the_rounding_of_every_place_is_fine():
    shares, channel = np.array([[0.0, 0.1], [0.0, -0.1], [0.0, 0.0]]), np.array([0, 0, 1])
    pattern = CrosstalkPattern(shares=shares, channel=channel, counted=True)
    mean = np.full((1, 2), 300.0)
    counts = []
    for step_e in np.geomspace(1.0, 40.0, 60):
        noise = noise_of(read_noise_e=1.0, step_e=step_e, readings=4, pattern=pattern)
        few = np.flatnonzero(few_electrons(mean, noise)[0])
        counts += [channel_distribution(mean, int(i), noise) for i in few]
        coarse = not few_electrons(mean, noise).any()
    assert 0 < len(counts) < 120
    assert coarse


@pytest.mark.parametrize(("light", "lowest"), [(0.02, 0.0), (1.0, 0.97)])
def test_the_exact_noise_of_a_color_is_that_of_readings_at_the_places(light, lowest):
    sensor = crossed("rgbw-4x4", "light", cross(0.2), read_noise_e=3.0)
    noise, rng = noise_sources(sensor, EXPOSURE), np.random.default_rng(3)
    mean = light * expected_electrons(WHITE, sensor, EXPOSURE)
    places = [noise.pattern.means_e(mean, i) for i in range(4)]
    assert max(np.ptp(each) for each in places) > 3 * light
    matrix = np.eye(3, 4)[:, [3, 1, 2, 0]] / mean[3]
    bounds = Readout(black_e=lowest * mean[3])  # clips a part of the places only
    white = np.ones(3)
    source = ElectronSource(mean_e=mean, matrix=matrix, noise=noise, readout=bounds)
    found = propagate(noisy_color(source, white), LAB, exact)
    count = 400_000
    chosen = np.column_stack([rng.choice(each, count) for each in places])
    raw = rng.poisson(chosen) + 3.0 * rng.standard_normal(chosen.shape)
    drawn = LAB.from_xyz(np.maximum(raw, bounds.black_e) @ matrix.T, white)
    away = drawn - LAB.from_xyz((mean @ matrix.T)[None], white)
    error = drawn.std(axis=0) / np.sqrt(count)
    assert (np.abs(away.mean(axis=0) - found.bias) < 5 * error + 1e-3 * found.sd + 1e-8).all()
    moves = found.sd > 1e-6  # clipped channels may leave a coordinate still
    drawn, sd = drawn[:, moves], found.sd[moves]
    fourth = ((drawn - drawn.mean(axis=0)) ** 4).mean(axis=0) / drawn.var(axis=0) ** 2
    of_sd = np.sqrt((fourth - 1) / count) / 2
    assert (np.abs(drawn.std(axis=0) / sd - 1) < 5 * of_sd + 1e-3).all()


def test_the_exact_moments_of_an_unclipped_reading_contain_the_pattern():
    sensor = crossed("rgbw-4x4", "light", cross(0.2), **NOISE)
    noise = noise_sources(sensor, EXPOSURE)
    found = sensor_moments(read(sensor).mean, noise, Readout())
    assert found.variance == pytest.approx(read(sensor).variance, rel=1e-9)


@pytest.mark.parametrize("stage", STAGES)
def test_the_light_for_an_snr_has_that_snr(stage):
    sensor = crossed("rgbw-4x4", stage, cross(0.05), full_well_e=1e7, prnu=0.01)
    matrix = kernel_matrix(sensor, EXPOSURE)
    level = illuminance_for_snr(sensor, LAMP, EXPOSURE, matrix, reflectance=1.0)
    raw = read(sensor, level / 10.0)
    row = matrix.matrix[1]
    assert row @ raw.mean / np.sqrt(row @ raw.covariance @ row) == pytest.approx(10.0, rel=1e-9)


@settings(max_examples=10)
@given(st.floats(0.01, 0.3), st.sampled_from(STAGES), st.floats(0.0, 0.05))
def test_the_budget_has_the_pattern_as_a_cause_and_adds_up(share, stage, prnu):
    for mosaic, known in (("rgbw-4x4", True), ("bayer", False)):
        sensor = crossed(mosaic, stage, cross(share), full_well_e=1e6, prnu=prnu)
        at = analyzed(WHITE, sensor, EXPOSURE)
        budgets = [*color_budgets(at), *contravariant_budgets(at), *lab_budgets(at)]
        assert any(budgets)
        for budget in filter(None, budgets):
            costs = {cost.cause: cost.cost_db for cost in budget.costs}
            assert (CAUSE in costs) == known
            lost = sum(costs.values())
            assert budget.photons_db - lost == pytest.approx(budget.snr_db, abs=1e-12)
            assert costs.get(CAUSE, 1.0) > 0


def test_the_noise_profile_of_a_raw_file_leaves_the_pattern_out():
    """Its variance is linear in the light; before counting the slope is that of electrons."""
    at = analyzed(WHITE, crossed("rgbw-4x4", "light", cross(0.2), **NOISE), EXPOSURE)
    step = pipeline_noise(at).iso[0]
    assert step.noise_profile[:, 0] * step.white_level_e == pytest.approx(np.ones(4), rel=1e-9)


def test_a_burst_does_not_average_the_pattern():
    at = analyzed(WHITE, crossed("rgbw-4x4", "light", cross(0.2)), EXPOSURE)
    total, temporal = raw_snr_db(at), temporal_raw_snr_db(at)
    assert temporal["W"] - total["W"] > 5
    assert {name: temporal[name] for name in "RGB"} == {name: total[name] for name in "RGB"}
    assert any("W" in note and "neighbors" in note for note in diagnosis(at))
