"""Noise in curved spaces from the electrons: against sums, laws of Poisson numbers, and draws."""

from functools import partial

import numpy as np
import pytest
from hypothesis import example, given, strategies as st
from scipy import stats

from chromanoise.color import (
    LAB,
    LINEAR_SRGB,
    LUV,
    SPACES,
    SRGB,
    UNBOUNDED,
    ElectronSource,
    NoisyColor,
    chart_training,
    cubature,
    exact,
    first_order,
    kernel_matrix,
    lmmse,
    nir_diverse,
    noisy_color,
    propagate,
    relative_sd_error,
)
from chromanoise.color.spaces import linear_srgb
from chromanoise.noise import (
    Exposure,
    Readout,
    expected_electrons,
    poisson_gaussian_ppf,
    read_moments,
    read_values,
)
from chromanoise.sensor import PAPER_PIXEL, Sensor
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import analyzed, gray_noise, sensor_named
from noise_samples import noise_of
from outcomes import refused_input
from strategies import xyz_of

LAMP = equal_energy(DEFAULT_GRID)
EXPOSURE = Exposure(time_s=0.0119)
ONES = np.ones(3)
HELD = Readout(black_e=0.0, full_well_e=10_000.0)
NORMAL = stats.norm.ppf((np.arange(2**17) + 0.5) / 2**17)
MATRIX = np.array([[2.0, 1.0, 0.5], [0.6, 2.5, 0.2], [0.1, 0.3, 3.0]]) * 1e-3


def gray(electrons):
    """One channel that makes X = Y = Z = 0.18 of its expected electrons."""
    return np.full((3, 1), 0.18 / electrons)


def exact_noise(mean_e, matrix, white, *, read_noise_e, readout=UNBOUNDED, space=LAB, points=2**16):
    source = ElectronSource(
        mean_e=mean_e, matrix=matrix, noise=noise_of(read_noise_e=read_noise_e), readout=readout
    )
    return propagate(noisy_color(source, white), space, partial(exact, points=points))


def sd_of(noise):
    return noise.sd


@pytest.mark.parametrize(
    ("electrons", "read_noise_e", "mean", "sd"),
    [(10.0, 2.0, 48.2704, 9.2548), (10.0, 0.0, 48.7196, 7.1842), (100.0, 2.0, 49.4199, 2.2349)],
)
def test_poisson_and_read_noise_on_a_gray_of_18_percent(electrons, read_noise_e, mean, sd):
    # the exact sum over Poisson's law; docs/numbers.md
    noise = exact_noise(np.array([electrons]), gray(electrons), ONES, read_noise_e=read_noise_e)
    assert noise.measurement.mean[0] == pytest.approx(mean, abs=1e-3)
    assert sd_of(noise)[0] == pytest.approx(sd, abs=1e-3)
    assert noise.bias[0] == pytest.approx(mean - (116 * 0.18 ** (1 / 3) - 16), abs=1e-3)
    assert sd_of(noise)[1:] == pytest.approx([0, 0], abs=1e-10)


def test_darkness_held_at_black_is_half_a_normal_law():
    # in the toe L* = 24389/27 Y; half-normal: mean .39894, variance .34085; docs/numbers.md
    noise = exact_noise(
        np.zeros(1), np.full((3, 1), 1e-6), ONES, read_noise_e=1.0, readout=Readout(black_e=0.0)
    )
    assert noise.bias[0] == pytest.approx(24389 / 27 * 1e-6 * 0.39894, rel=1e-4)
    assert noise.measurement.variance[0] == pytest.approx(
        (24389 / 27 * 1e-6) ** 2 * 0.34085, rel=1e-4
    )


def test_what_is_always_held_at_full_well_is_the_color_of_full_well_and_still():
    noise = exact_noise(
        np.array([90_000.0]), np.full((3, 1), 1e-4 / 8), ONES, read_noise_e=10.0, readout=HELD
    )
    assert noise.measurement.mean == pytest.approx([42.0, 0.0, 0.0], abs=1e-9)  # Y = 1/8
    assert sd_of(noise) == pytest.approx(np.zeros(3), abs=1e-9)
    assert noise.delta_e == pytest.approx(116 * (1.125 ** (1 / 3) - 0.5), abs=1e-9)


@pytest.mark.parametrize("read_noise_e", [0.0, 3.0])
@pytest.mark.parametrize("space", [LAB, LUV, SRGB])
def test_two_channels_of_one_weight_are_one_channel_of_their_sum(space, read_noise_e):
    # Poisson(3) + Poisson(4) is Poisson(7); normal variances add
    column = np.array([[0.02], [0.03], [0.01]])
    apart = exact_noise(
        np.array([3.0, 4.0]), np.hstack([column, column]), ONES, read_noise_e=read_noise_e,
        space=space,
    )  # fmt: skip
    together = exact_noise(
        np.array([7.0]), column, ONES, read_noise_e=2**0.5 * read_noise_e, space=space
    )
    sd = sd_of(together)
    shift = apart.measurement.mean - together.measurement.mean
    assert np.abs(shift / sd).max() < 1e-3
    assert sd_of(apart) / sd == pytest.approx(ONES, abs=2e-3)


@pytest.mark.parametrize("mean_e", [np.array([0.3, 5.0, 12.0]), np.array([9_950.0, 400.0, 1e4])])
@pytest.mark.parametrize("readout", [Readout(), HELD, Readout(black_e=0.0, step_e=7.0)])
def test_a_linear_space_knows_only_mean_and_variance_of_what_is_read(mean_e, readout):
    noise = exact_noise(mean_e, MATRIX, ONES, read_noise_e=10.0, readout=readout, space=LINEAR_SRGB)
    read = read_moments(mean_e, read_noise_e=10.0, readout=readout)
    whole = linear_srgb(MATRIX.T, ONES).T
    covariance = whole @ np.diag(read.variance) @ whole.T
    sd = np.sqrt(np.diag(covariance))
    assert np.abs((noise.measurement.mean - whole @ read.mean) / sd).max() < 2e-4
    assert np.abs((noise.measurement.covariance - covariance) / np.outer(sd, sd)).max() < 1e-3
    assert noise.chroma_sd is None
    assert noise.delta_e is None


@pytest.mark.parametrize("space", [LAB, LUV, SRGB])
def test_where_electrons_are_many_the_law_is_normal_and_the_cubature_agrees(space):
    mean_e = np.array([9e4, 6e4, 4e4])
    matrix = MATRIX / 1000
    variance = matrix @ np.diag(mean_e + 100.0) @ matrix.T
    xyz = xyz_of(matrix @ mean_e, variance, unit="lx")
    noise = exact_noise(mean_e, matrix, ONES, read_noise_e=10.0, space=space)
    seen = propagate(NoisyColor(xyz=xyz, white=ONES), space, cubature)
    off = relative_sd_error(seen.measurement, noise.measurement)
    assert off == pytest.approx(np.zeros(3), abs=1e-4)
    mean = noise.measurement.mean
    assert mean == pytest.approx(seen.measurement.mean, abs=1e-3 * sd_of(noise).max())
    if space is not SRGB:
        assert noise.bias == pytest.approx(seen.bias, abs=1e-5 * sd_of(noise).max())
        assert noise.chroma_sd == pytest.approx(seen.chroma_sd, rel=1e-3)
        assert noise.chroma_bias == pytest.approx(seen.chroma_bias, rel=2e-2)
        assert noise.delta_e == pytest.approx(seen.delta_e, rel=1e-3)


def test_the_order_of_channels_does_not_matter():
    mean_e, matrix = np.array([0.4, 3.0, 30.0, 8.0]), np.hstack([MATRIX, MATRIX[:, :1] / 2])
    one, other = (
        exact_noise(
            mean_e[o], matrix[:, o], 0.1 * ONES, read_noise_e=5.0, readout=HELD, points=2**15
        )
        for o in ([0, 1, 2, 3], [2, 0, 3, 1])
    )
    assert np.abs((one.measurement.mean - other.measurement.mean) / sd_of(one)).max() < 1e-3
    assert sd_of(other) / sd_of(one) == pytest.approx(ONES, abs=2e-3)
    assert other.delta_e == pytest.approx(one.delta_e, rel=1e-3)


def test_a_few_colors_at_once_are_each_as_if_alone():
    rows = np.array([[5.0, 6.0, 7.0], [50.0, 20.0, 10.0]])
    both = exact_noise(rows, MATRIX, ONES, read_noise_e=3.0, points=2**8)
    for i, row in enumerate(rows):
        alone = exact_noise(row, MATRIX, ONES, read_noise_e=3.0, points=2**8)
        assert both.measurement.covariance[i] == pytest.approx(
            alone.measurement.covariance, rel=1e-12
        )
        assert both.delta_e[i] == pytest.approx(float(alone.delta_e), rel=1e-12)


def test_the_own_error_tells_how_far_fewer_points_are_off():
    mean_e = np.array([4.0, 9.0, 6.0])
    few = exact_noise(mean_e, MATRIX, 0.1 * ONES, read_noise_e=2.0, points=2**8)
    many = exact_noise(mean_e, MATRIX, 0.1 * ONES, read_noise_e=2.0)
    assert np.abs((few.measurement.mean - many.measurement.mean) / few.mean_error).max() < 5
    assert np.abs((sd_of(few) - sd_of(many)) / few.sd_error).max() < 5
    assert (many.sd_error < 0.2 * few.sd_error).all()
    assert (many.sd_error < 1e-3 * sd_of(many)).all()


@pytest.mark.parametrize("mean_e", [0.05, 0.5, 4.0, 60.0, 9_900.0, 2e5])
@pytest.mark.parametrize("read_noise_e", [0.0, 0.02, 0.3, 1.0, 10.0])
@pytest.mark.parametrize("readout", [Readout(), Readout(black_e=0.0, full_well_e=9_950.0)])
def test_the_law_of_what_is_read_has_its_moments(mean_e, read_noise_e, readout):
    read = read_values(poisson_gaussian_ppf(NORMAL, mean_e, read_noise_e=read_noise_e), readout)
    known = read_moments(np.array([mean_e]), read_noise_e=read_noise_e, readout=readout)
    sd = np.sqrt(known.variance[0])
    assert read.mean() == pytest.approx(known.mean[0], abs=5e-5 * sd + 1e-9)
    assert read.std() == pytest.approx(sd, rel=2e-4, abs=1e-9)


@pytest.mark.parametrize(("mean_e", "read_noise_e"), [(6.0, 2.0), (400.0, 3.0), (1e5, 20.0)])
def test_its_third_central_moment_is_that_of_poisson(mean_e, read_noise_e):
    read = poisson_gaussian_ppf(NORMAL, mean_e, read_noise_e=read_noise_e)
    third = ((read - mean_e) ** 3).mean() / (mean_e + read_noise_e**2) ** 1.5
    assert third == pytest.approx(mean_e / (mean_e + read_noise_e**2) ** 1.5, abs=2e-4)


@pytest.mark.parametrize("mean_e", [0.2, 3.0, 250.0, 20_000.0])
def test_without_read_noise_it_is_the_quantile_of_poisson(mean_e):
    share = np.linspace(1e-6, 1 - 1e-6, 1999)
    found = poisson_gaussian_ppf(stats.norm.ppf(share), mean_e, read_noise_e=0.0)
    assert np.array_equal(found, stats.poisson.ppf(share, mean_e))


@given(st.floats(0, 1e3), st.floats(0, 50))
@example(0.0, 2.225e-309)
def test_what_is_read_rises_with_the_normal_variable(mean_e, read_noise_e):
    read = poisson_gaussian_ppf(np.linspace(-6, 6, 401), mean_e, read_noise_e=read_noise_e)
    assert (np.diff(read) >= 0).all()


def test_without_light_it_is_the_read_noise_itself():
    z = np.linspace(-5, 5, 101)
    assert poisson_gaussian_ppf(z, 0.0, read_noise_e=7.0) == pytest.approx(7 * z, abs=1e-3)


@pytest.mark.parametrize(
    ("change", "fields"),
    [
        ({"mean_e": np.array([1.0, -1.0, 1.0])}, {"subject": "mean_e", "value": -1.0}),
        ({"points": 1000}, {"subject": "points", "value": 1000}),
        ({"points": 2**22}, {"subject": "points", "value": 2**22}),
        ({"white": np.zeros(3)}, {"subject": "white", "value": [0.0, 0.0, 0.0]}),
        ({"read_noise_e": -1.0}, {"subject": "read_noise_e", "value": -1.0}),
    ],
)
def test_what_cannot_be_averaged_is_refused(change, fields):
    asked = {"mean_e": ONES, "matrix": MATRIX, "white": ONES, "read_noise_e": 1.0} | change
    with refused_input(**fields):
        exact_noise(**asked)


def test_the_exact_method_refuses_a_color_whose_electrons_are_not_known():
    xyz = xyz_of(ONES, np.eye(3), unit="lx")
    with refused_input(subject="source of the noisy color"):
        propagate(NoisyColor(xyz=xyz, white=ONES), LAB, exact)


@pytest.mark.parametrize("method", [first_order, cubature, exact])
def test_the_bias_of_every_method_is_that_against_the_color_of_the_expected_electrons(method):
    # always at full well: Y = 1/8 is read, where Y = 9/8 is expected; no noise is left
    source = ElectronSource(
        mean_e=np.array([90_000.0]), matrix=np.full((3, 1), 1e-4 / 8),
        noise=noise_of(read_noise_e=10.0),
        readout=HELD,
    )  # fmt: skip
    noise = propagate(noisy_color(source, ONES), LAB, method)
    lost = 116 * (1.125 ** (1 / 3) - 0.5)
    assert noise.measurement.mean == pytest.approx([42.0, 0.0, 0.0], abs=1e-9)
    assert noise.bias == pytest.approx([-lost, 0.0, 0.0], abs=1e-9)
    assert noise.delta_e == pytest.approx(lost, abs=1e-9)
    assert noise.chroma_sd == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("method", [first_order, cubature])
def test_the_color_difference_of_clipped_values_is_that_of_the_moved_mean(method):
    # half-normal at black, .39894 and .34085 of 1 e-: in the toe L* is 903.3 Y; as a normal of
    # that mean and variance, E|x| = m (2 Phi(m/s) - 1) + 2 s phi(m/s)
    source = ElectronSource(
        mean_e=np.zeros(1), matrix=np.full((3, 1), 1e-6), noise=noise_of(read_noise_e=1.0),
        readout=Readout(black_e=0.0),
    )  # fmt: skip
    m, s = 0.3989423, 0.3408451**0.5
    length = m * (2 * stats.norm.cdf(m / s) - 1) + 2 * s * stats.norm.pdf(m / s)
    noise = propagate(noisy_color(source, ONES), LAB, method)
    assert noise.delta_e == pytest.approx(24389 / 27 * 1e-6 * length, rel=1e-2)


def toy(name, curves):
    names = tuple(f"c{i}" for i in range(len(curves)))
    return Sensor(
        name=name, grid=DEFAULT_GRID, qe=np.stack(curves, 1), names=names, pixel=PAPER_PIXEL
    )


def bands(count):
    at, centers = DEFAULT_GRID.wavelength_nm, np.linspace(430, 1000, count)
    curves = [0.5 * np.exp(-(((at - c) / (900 / count)) ** 2)) for c in centers]
    return toy(f"bands-{count}", curves)


def deficient():
    curves = sensor_named("model-rgb-ircut", DEFAULT_GRID).qe.T
    return toy("deficient", [*curves, curves.mean(axis=0)])


NAMED = (
    "model-mono", "onyx-rgb-ircut", "onyx-rgbw", "model-cmy-ircut", "model-rgbir",
    "model-three-layer", "model-rgbwir",
)  # fmt: skip
SENSORS = [*(sensor_named(n, DEFAULT_GRID) for n in NAMED), bands(8), bands(16), deficient()]
CASES = [(sensor, level_lux) for sensor in SENSORS for level_lux in (1000.0, 10.0, 0.1, 0.01)]
IDS = [f"{sensor.name}-{level_lux:g}lx" for sensor, level_lux in CASES]


@pytest.mark.parametrize("method", [first_order, cubature])
def test_only_the_exact_method_reports_an_error_of_its_own(method):
    source = ElectronSource(mean_e=ONES, matrix=MATRIX, noise=noise_of(read_noise_e=1.0))
    noise = propagate(noisy_color(source, ONES), LAB, method)
    assert noise.mean_error is None
    assert noise.sd_error is None


def test_in_the_dark_the_gray_of_a_sensor_says_that_its_noise_is_not_normal():
    sensor = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    values = []
    for level_lux in (100.0, 0.3):
        analysis = analyzed(flat_field(LAMP, level_lux=level_lux), sensor, Exposure(time_s=0.001))
        values.append(gray_noise(analysis, LAB, readout=HELD))
    assert [noise.normal_holds for noise in values] == [True, False]
    assert [noise.first_order_holds for noise in values] == [True, False]


def drawn_moments(mean_e, read_noise_e, readout, ways, draws, seed):
    """Mean and sd of every coordinate of every (matrix, white, space), each with its error."""
    rng = np.random.default_rng(seed)
    sums = [np.zeros((4, 3)) for _ in ways]
    stills = [space.from_xyz(matrix @ mean_e, white) for matrix, white, space in ways]
    for start in range(0, draws, 250_000):
        count = min(250_000, draws - start)
        raw = rng.poisson(mean_e, (count, mean_e.size))
        raw = raw + read_noise_e * rng.standard_normal(raw.shape)
        raw = np.clip(raw, readout.black_e, readout.full_well_e)
        for total, still, (matrix, white, space) in zip(sums, stills, ways, strict=True):
            away = space.from_xyz(raw @ matrix.T, white) - still
            square = away * away
            total += [part.sum(axis=0) for part in (away, square, square * away, square * square)]
    return [moments_with_error(total / draws, draws) for total in sums]


def moments_with_error(powers, draws):
    a, b, c, d = powers
    variance = b - a**2
    fourth = d - 4 * a * c + 6 * a**2 * b - 3 * a**4
    sd = np.sqrt(np.maximum(variance, 0))
    kurtosis = fourth / np.where(variance > 0, variance, 1) ** 2
    return a, sd, sd / np.sqrt(draws), sd * np.sqrt(np.maximum(kurtosis - 1, 0) / (4 * draws))


def matrices_and_whites(sensor, level_lux, mean_e):
    """Kernel and LMMSE, where the perfect white has a color; the gray is 18 % of it."""
    training = nir_diverse(chart_training(LAMP))
    for made in (
        kernel_matrix(sensor, EXPOSURE),
        lmmse(sensor, EXPOSURE, training, level_lux=level_lux),
    ):
        white = made.matrix @ mean_e / 0.18
        if (white > 0).all():
            yield made.matrix, white


def deviations(sensor, level_lux, readout, draws, points):
    """z of bias and standard deviation in every space by every matrix, and the two own errors."""
    scene = flat_field(LAMP, level_lux=level_lux, reflectance=0.18)
    mean_e = expected_electrons(scene, sensor, EXPOSURE)
    if mean_e.max() > 10_050:  # further up every readout is the full well itself
        level_lux, mean_e = level_lux * 10_050 / mean_e.max(), mean_e * 10_050 / mean_e.max()
    read_noise_e = sensor.pixel.read_noise_e
    ways = [
        (matrix, white, space)
        for matrix, white in matrices_and_whites(sensor, level_lux, mean_e)
        for space in SPACES.values()
    ]
    found = []
    drawn = drawn_moments(mean_e, read_noise_e, readout, ways, draws, seed=11)
    for (matrix, white, space), (shift, sd, shift_se, sd_se) in zip(ways, drawn, strict=True):
        ours = exact_noise(
            mean_e, matrix, white, read_noise_e=read_noise_e, readout=readout, space=space,
            points=points,
        )  # fmt: skip
        moves = sd > 1e-9 * (1 + np.abs(ours.noiseless).max())
        z_mean = (shift - ours.bias)[moves] / np.hypot(shift_se, ours.mean_error)[moves]
        z_sd = (sd - sd_of(ours))[moves] / np.hypot(sd_se, ours.sd_error)[moves]
        own = np.maximum(ours.mean_error / sd_of(ours), ours.sd_error / sd_of(ours))[moves]
        found.append(np.concatenate([z_mean, z_sd, own]).reshape(3, -1))
    return np.concatenate(found, axis=1)


BOTH = pytest.mark.parametrize("readout", [Readout(), HELD], ids=["unclipped", "clipped"])


@BOTH
@pytest.mark.parametrize("which", [0, 1, 2, 8, 9], ids=lambda i: SENSORS[i].name)
def test_noise_from_the_electrons_agrees_with_sampling(which, readout):
    z_mean, z_sd, _ = deviations(SENSORS[which], 0.1, readout, 60_000, 2**12)
    assert max(np.abs(z_mean).max(), np.abs(z_sd).max()) < 5


@pytest.mark.evidence
@BOTH
@pytest.mark.parametrize(("sensor", "level_lux"), CASES, ids=IDS)
def test_noise_from_the_electrons_agrees_with_ten_million_draws(sensor, level_lux, readout):
    z_mean, z_sd, own = deviations(sensor, level_lux, readout, 10_000_000, 2**17)
    assert max(np.abs(z_mean).max(), np.abs(z_sd).max()) < 5
    assert own.max() < 5e-3
