"""Crosstalk: what raw SNR hides and color pays, and a tile of pixels that knows no matrix."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import given, strategies as st

import chromanoise as cn
from chromanoise.color import (
    LAB,
    chart_training,
    colored,
    kernel_matrix,
    lmmse,
    lmmse_over_light,
    noise_regularized,
    pareto,
)
from chromanoise.color.training import training_response
from chromanoise.io.matrix_files import read_crosstalk
from chromanoise.metrics import color_budget, lab_budget, snr_db
from chromanoise.metrics.budget import moved_share
from chromanoise.noise import Exposure, Readout, clipped_measurement, expected_electrons, with_noise
from chromanoise.sensor import (
    Crosstalk,
    Mosaic,
    bayer,
    crosstalk_of_kernel,
    crosstalk_of_share,
    mosaic_named,
    with_channel_names,
    with_crosstalk,
    with_pixel,
    without_crosstalk,
)
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import (
    analyzed,
    chart_noise,
    gray_noise,
    merits_of,
    operating_points_of,
    sensor_named,
    study_from_data,
)
from goodness import covariance_z
from outcomes import refused_input
from strategies import bell_qe, pixel_with, sensor_of

WHITE = flat_field(equal_energy(DEFAULT_GRID), level_lux=10.0)
EXPOSURE = Exposure(time_s=0.01125)
RGB = sensor_named("model-rgb-ircut", DEFAULT_GRID)
CROSSED = np.array([[0.9, 0.1, 0.0], [0.05, 0.85, 0.1], [0.0, 0.05, 0.9]])
MOSAICS = ("RG/GB", "RG/WB", "RWGW/WWWW/GWBW/WWWW", "RGB")
KERNEL = np.array([[0.01, 0.06, 0.02], [0.1, 0.6, 0.03], [0.0, 0.08, 0.04]])  # 6 % are lost


def sees(sensor):
    """Mean and covariance of the raw channels, and of X, Y, Z by the kernel matrix."""
    raw = with_noise(expected_electrons(WHITE, sensor, EXPOSURE), sensor, EXPOSURE)
    return raw, colored(raw, kernel_matrix(sensor, EXPOSURE))


def decibels(sensor):
    raw, color = sees(sensor)
    return np.array([float(snr_db(raw)["G"]), *(float(snr_db(color)[c]) for c in "YZ")])


def of_share(share, stage="light"):
    return replace(crosstalk_of_share(share, bayer(), RGB.names), stage=stage)


# numbers of the table


@pytest.mark.parametrize(
    ("share", "raw_g", "y", "z"),
    [
        (0.05, -0.05, -0.28, -0.63),
        (0.10, -0.11, -0.63, -1.36),
        (0.20, -0.22, -1.62, -3.23),
        (0.30, -0.34, -3.39, -6.08),
    ],
)
def test_raw_hides_bayer_crosstalk_and_color_pays(share, raw_g, y, z):
    lost = decibels(with_crosstalk(RGB, of_share(share))) - decibels(RGB)
    assert lost == pytest.approx([raw_g, y, z], abs=0.01)


def test_a_study_gives_the_same_table():
    asked = {"lux": 10.0, "time_ms": 11.25}
    plain = cn.analyze("model-rgb-ircut", **asked)
    crossed = cn.analyze("model-rgb-ircut", crosstalk=0.1, mosaic="bayer", **asked)
    (before,), (after,) = (found.to_dict()["sensors"] for found in (plain, crossed))
    green = [found["channels"][1]["snr_db"] for found in (before, after)]
    lost = [
        green[1] - green[0],
        *(after["color"]["snr_db"][c] - before["color"]["snr_db"][c] for c in "YZ"),
    ]
    assert lost == pytest.approx([-0.11, -0.63, -1.36], abs=0.01)


def test_the_curves_of_bayer_mix_as_neighbors_do():
    red, green, blue = RGB.qe.T
    share = 0.15
    crossed = with_crosstalk(RGB, of_share(share)).qe
    mixed = [
        (1 - share) * red + share * green,
        (1 - share) * green + share * (red + blue) / 2,
        (1 - share) * blue + share * green,
    ]
    assert crossed == pytest.approx(np.stack(mixed, axis=1), abs=1e-15)


@given(st.floats(0.0, 1.0), st.sampled_from(["bayer", "rgbw-2x2", "rgbw-4x4", "rgb-ir"]))
def test_neighbors_gain_what_a_pixel_loses(share, name):
    mosaic = mosaic_named(name)
    crossed = crosstalk_of_share(share, mosaic, mosaic.names)
    light = np.linspace(3.0, 9.0, len(mosaic.names))  # per pixel of each channel
    pixels = np.array(crossed.pixels)
    assert pixels @ (crossed.matrix @ light) == pytest.approx(pixels @ light, rel=1e-12)
    assert crossed.matrix.sum(axis=1) == pytest.approx(np.ones(len(mosaic.names)), abs=1e-12)


# nothing where there is none


@pytest.mark.parametrize("stage", ["light", "charge"])
@pytest.mark.parametrize("none", [of_share(0.0), Crosstalk(matrix=np.eye(3), pixels=(1, 1, 1))])
def test_crosstalk_of_nothing_changes_no_digit(none, stage):
    noisy = with_pixel(RGB, {"prnu": 0.01, "dsnu_e": 3.0, "dark_current_e_per_s": 50.0, "bits": 12})
    same = with_crosstalk(noisy, replace(none, stage=stage))
    np.testing.assert_array_equal(same.qe, noisy.qe)
    for one, other in zip(sees(noisy), sees(same), strict=True):
        np.testing.assert_array_equal(one.mean, other.mean)
        np.testing.assert_array_equal(one.covariance, other.covariance)
    matrix = kernel_matrix(noisy, EXPOSURE)
    for budget in (color_budget, lab_budget):
        coordinate = "Y" if budget is color_budget else "b*"
        plain = budget(WHITE, noisy, EXPOSURE, matrix, coordinate)
        crossed = budget(WHITE, same, EXPOSURE, matrix, coordinate)
        costs = {cost.cause: cost.cost_db for cost in crossed.costs}
        assert costs.pop("crosstalk") == pytest.approx(0.0, abs=1e-12)
        assert costs == pytest.approx({c.cause: c.cost_db for c in plain.costs}, abs=1e-12)


def test_the_sensor_before_crosstalk_comes_back():
    crossed = with_crosstalk(RGB, of_share(0.2))
    assert without_crosstalk(crossed).qe == pytest.approx(RGB.qe, abs=1e-14)
    assert without_crosstalk(RGB) is RGB


def test_the_kernel_matrix_unmixes_crosstalk_exactly():
    """The mean color is unchanged; only its noise grows."""
    _, plain = sees(RGB)
    _, crossed = sees(with_crosstalk(RGB, of_share(0.3)))
    assert crossed.mean == pytest.approx(plain.mean, rel=1e-9)
    assert (crossed.variance > plain.variance).all()


# photons one by one


def thrown(mosaic, names, mean_e, kernel, frames, seed):
    """Electrons of every pixel of a torus of pixels, (frames, rows, columns): one by one.

    Each electron of a pixel lands at an offset that is drawn for it alone, or nowhere.
    """
    tile = np.array(mosaic.pattern)
    repeat = [-(-3 // size) for size in tile.shape]  # at least 3 x 3, so that neighbors differ
    tile = np.tile(tile, repeat)
    height, width = tile.shape
    rng = np.random.default_rng(seed)
    mean = np.array([[mean_e[names.index(name)] for name in row] for row in tile])
    found = np.zeros((frames, height, width), dtype=np.int64)
    ways = np.array([(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1)])
    edges = np.cumsum(kernel.ravel())
    for start in range(0, frames, 2000):
        count = rng.poisson(mean, (min(2000, frames - start), height, width)).ravel()
        at = np.indices((count.size // mean.size, height, width)).reshape(3, -1)
        frame, y, x = np.repeat(at, count, axis=1)  # a column for each electron
        way = np.searchsorted(edges, rng.random(y.size), side="right")
        lands = way < len(ways)
        down, right = ways[way[lands]].T
        to = (start + frame[lands], (y[lands] + down) % height, (x[lands] + right) % width)
        np.add.at(found, to, 1)
    return tile, found


def cross_kernel(share):
    quarter = share / 4
    return np.array([[0, quarter, 0], [quarter, 1 - share, quarter], [0, quarter, 0]])


def scores_of_tile(tile, found, names, mean, covariance):
    """Errors of means, variances and of the covariance of neighbors, in standard errors."""
    frames = len(found)
    scores = []
    flat = found.reshape(frames, -1)
    whose = np.array([names.index(name) for name in tile.ravel()])
    average = flat.mean(axis=0)
    for i, m in enumerate(mean):
        own = flat[:, whose == i]
        of_frames = own.mean(axis=1)  # pixels of one frame share no electron, frames neither
        scores.append((of_frames.mean() - m) / (of_frames.std(ddof=1) / np.sqrt(frames)))
        squares = ((own - m) ** 2).mean(axis=1)
        scores.append((squares.mean() - covariance[i, i]) / (squares.std(ddof=1) / np.sqrt(frames)))
    away = flat - average
    right = np.roll(away.reshape(found.shape), -1, axis=2).reshape(frames, -1)
    beside = np.roll(whose.reshape(tile.shape), -1, axis=1).ravel()
    products = away * right * frames / (frames - 1)
    for i in range(len(names)):
        for j in range(len(names)):
            pairs = (whose == i) & (beside == j)
            if pairs.any():
                of_frames = products[:, pairs].mean(axis=1)
                error = of_frames.std(ddof=1) / np.sqrt(frames)
                scores.append((of_frames.mean() - covariance[i, j] * (i != j)) / error)
    return np.array(scores)


@pytest.mark.parametrize("share", [0.1, 0.3])
def test_photons_thrown_one_by_one_at_a_bayer_tile_follow_the_matrix(share):
    pure = sensor_of(bell_qe([600, 540, 450], [30] * 3, [0.5] * 3), names=("R", "G", "B"))
    pure = replace(pure, pixel=pixel_with(0.0))
    scene = flat_field(equal_energy(pure.grid), level_lux=0.15)
    crossed = with_crosstalk(pure, crosstalk_of_share(share, bayer(), pure.names))
    tile, found = thrown(
        bayer(), pure.names, expected_electrons(scene, pure, EXPOSURE), cross_kernel(share),
        20_000, 3,
    )  # fmt: skip
    raw = with_noise(expected_electrons(scene, crossed, EXPOSURE), crossed)
    scores = scores_of_tile(tile, found, pure.names, raw.mean, raw.covariance)
    assert raw.mean.min() > 8
    assert np.abs(scores).max() < 3


@pytest.mark.parametrize("text", MOSAICS)
def test_photons_thrown_by_a_lopsided_kernel_follow_the_matrix_of_any_mosaic(text):
    mosaic = mosaic_named(text) if "/" in text else Mosaic((tuple(text),))
    names = tuple(sorted(mosaic.names))
    mean_e = np.linspace(2.0, 11.0, len(names))
    tile, found = thrown(mosaic, names, mean_e, KERNEL, 3000, 9)
    mean = crosstalk_of_kernel(KERNEL, mosaic, names).matrix @ mean_e
    scores = []
    for i, name in enumerate(names):
        of_frames = found[:, tile == name].mean(axis=1)
        error = of_frames.std(ddof=1) / np.sqrt(len(found))
        scores.append((of_frames.mean() - mean[i]) / error)
    assert np.abs(scores).max() < 3


# after counting


def test_crosstalk_after_counting_correlates_readings_and_adds_readout_after():
    """Counts, dark counts and PRNU are coupled; read noise and rounding come after."""
    changes = {"prnu": 0.05, "dsnu_e": 3.0, "dark_current_e_per_s": 2000.0, "row_noise_e": 2.0}
    pure = with_pixel(RGB, {**changes, "gain_e_per_dn": 4.0, "read_noise_e": 6.0})
    counted = expected_electrons(WHITE, pure, EXPOSURE)
    sensor = with_crosstalk(pure, Crosstalk(matrix=CROSSED, pixels=(1, 1, 1), stage="charge"))
    raw, color = sees(sensor)
    rng, draws = np.random.default_rng(4), 200_000
    sensitivity = 1 + 0.05 * rng.standard_normal((draws, 3))
    inside = rng.poisson(counted * sensitivity + 2000 * 0.01125) - 2000 * 0.01125
    inside = inside + 3.0 * rng.standard_normal((draws, 3))
    read = inside @ CROSSED.T
    read += 6.0 * rng.standard_normal((draws, 3)) + 2.0 * rng.standard_normal((draws, 3))
    read = 4.0 * np.round(read / 4.0)
    assert covariance_z(read, raw.mean, raw.covariance) < 3.5
    assert (
        covariance_z(read @ kernel_matrix(sensor, EXPOSURE).matrix.T, color.mean, color.covariance)
        < 3.5
    )
    assert raw.covariance[0, 1] / np.sqrt(raw.variance[0] * raw.variance[1]) > 0.1


def test_crosstalk_after_counting_smooths_the_noise_that_the_matrix_then_amplifies():
    """Unmixing brings the counts of before back: only the readout is amplified."""
    pure = with_pixel(RGB, {"read_noise_e": 0.0})
    before, color = sees(pure)
    after, same = sees(with_crosstalk(pure, of_share(0.3, "charge")))
    assert (after.variance < before.variance)[1]  # green is the mean of many counts
    assert same.covariance == pytest.approx(color.covariance, rel=1e-9)


# trained matrices and figures of merit, where readings are correlated

DIM_LUX = 0.3
CHART = chart_training(equal_energy(DEFAULT_GRID))
COUPLED = Crosstalk(matrix=CROSSED, pixels=(1, 1, 1), stage="charge")
TRAINED = {
    "lmmse": lmmse,
    "noise regularized": partial(noise_regularized, weight=0.3),
    "lmmse over light": lambda *at, level_lux: lmmse_over_light(*at, np.array([level_lux]))[0],
    "pareto": lambda *at, level_lux: pareto(*at, np.array([2.0]), level_lux=level_lux).matrix[0],
}
each_trained = pytest.mark.parametrize("method", TRAINED.values(), ids=TRAINED.keys())


def trained(method, sensor):
    found = method(sensor, EXPOSURE, CHART, level_lux=DIM_LUX)
    return getattr(found, "matrix", found)


def test_lmmse_is_the_regression_of_a_million_draws_of_correlated_readings():
    sensor = with_crosstalk(with_pixel(RGB, {"read_noise_e": 2.0}), COUPLED)
    seen = training_response(CHART, with_pixel(RGB, {}), EXPOSURE, level_lux=DIM_LUX)
    rng, batches = np.random.default_rng(12), 50
    found = []
    for _ in range(batches):
        patch = rng.integers(0, len(seen.xyz), 20_000)
        read = rng.poisson(seen.electrons[patch]) @ CROSSED.T
        read = read + 2.0 * rng.standard_normal(read.shape)
        found.append(np.linalg.lstsq(read, seen.xyz[patch])[0].T)
    error = np.std(found, axis=0, ddof=1) / np.sqrt(batches)
    z = (np.mean(found, axis=0) - trained(lmmse, sensor)) / error
    assert np.abs(z).max() < 4


@given(
    st.lists(st.floats(0, 0.2), min_size=6, max_size=6),
    st.floats(0.01, 100),
    st.floats(0, 20),
)
def test_lmmse_errs_at_most_as_much_as_one_that_neglects_the_correlation(shares, lux, read):
    matrix = np.eye(3)
    matrix[~np.eye(3, dtype=bool)] = shares
    matrix[np.diag_indices(3)] = 1.0 - matrix.sum(axis=0) + 1.0
    mixing = Crosstalk(matrix=matrix, pixels=(1, 1, 1), stage="charge")
    sensor = with_crosstalk(with_pixel(RGB, {"read_noise_e": read}), mixing)
    seen = training_response(CHART, sensor, EXPOSURE, level_lux=lux)
    signal = seen.electrons.T @ seen.electrons / 24
    cross = seen.xyz.T @ seen.electrons / 24

    def error(color):
        return np.trace(color @ (signal + seen.noise_e2) @ color.T - 2 * color @ cross.T)

    neglecting = np.linalg.solve(signal + np.diag(np.diag(seen.noise_e2)), cross.T).T
    best = lmmse(sensor, EXPOSURE, CHART, level_lux=lux).matrix
    assert error(best) <= error(neglecting) + 1e-10 * np.trace(seen.xyz.T @ seen.xyz)


@each_trained
def test_a_trained_matrix_undoes_crosstalk_that_no_readout_follows(method):
    """X D X^T is the noise of the counts in other coordinates: C X is the matrix of the counts."""
    pure = with_pixel(RGB, {"read_noise_e": 0.0, "prnu": 0.02, "dsnu_e": 4.0})
    after = trained(method, with_crosstalk(pure, COUPLED))
    assert after @ CROSSED == pytest.approx(trained(method, pure), rel=1e-9)


@each_trained
def test_crosstalk_of_nothing_changes_no_trained_matrix(method):
    pure = with_pixel(RGB, {"read_noise_e": 3.0, "prnu": 0.02, "dsnu_e": 4.0})
    nothing = with_crosstalk(pure, replace(COUPLED, matrix=np.eye(3)))
    assert trained(method, nothing) == pytest.approx(trained(method, pure), rel=1e-12)


def test_figures_of_the_pareto_curve_are_those_of_the_counts_where_no_readout_follows():
    pure = with_pixel(RGB, {"read_noise_e": 0.0})
    curves = [
        pareto(sensor, EXPOSURE, CHART, np.array([0.1, 1.0, 9.0]), level_lux=DIM_LUX)
        for sensor in (pure, with_crosstalk(pure, COUPLED))
    ]
    for name in ("noise_rms", "snr_y_db", "color_error_rms"):
        before, after = (getattr(curve, name) for curve in curves)
        assert after == pytest.approx(before, rel=1e-9)


def merits(sensor):
    found = merits_of(analyzed(WHITE, sensor, EXPOSURE)).entries
    return {one.name: one.value for one in found}


def test_merits_of_color_are_those_of_the_counts_where_no_readout_follows():
    """The kernel matrix unmixes: color, its noise and its information are those of the counts."""
    pure = with_pixel(RGB, {"read_noise_e": 0.0})
    before, after = merits(pure), merits(with_crosstalk(pure, COUPLED))
    same = ("visual_noise", "snr10", "noise_speed_10", "information", "figure_of_merit")
    for name in same:
        assert after[name] == pytest.approx(before[name], rel=1e-9), name
    assert after["color_sensitivity"] is None


def test_the_tonal_range_of_a_coupled_reading_is_the_integral_over_its_own_noise():
    sensor = with_crosstalk(with_pixel(RGB, {"read_noise_e": 5.0}), COUPLED)
    top = expected_electrons(WHITE, sensor, EXPOSURE)
    light = np.linspace(0, 1, 200_001)[:, None]
    noise = np.sqrt(with_noise(light * top, sensor, EXPOSURE).variance)
    levels = np.trapezoid(1 / noise, dx=1 / 200_000, axis=0) * top
    found = merits(sensor)
    for name, count in zip("RGB", levels, strict=True):
        assert found[f"tonal_range_{name}"] == pytest.approx(np.log2(count), rel=1e-6)


# what cannot be


@pytest.fixture
def table(tmp_path):
    def written(text):
        path = tmp_path / "crosstalk.csv"
        path.write_text(text)
        return path

    return written


def test_a_column_that_makes_light_is_refused():
    matrix = np.array([[0.9, 0.1, 0.0], [0.2, 0.9, 0.0], [0.0, 0.0, 1.0]])
    with refused_input(subject="crosstalk matrix", value=pytest.approx(1.1)):
        Crosstalk(matrix=matrix, pixels=(1, 1, 1))
    # green has two pixels, so each of its neighbors may get more of it than it keeps per pixel
    assert Crosstalk(matrix=of_share(0.2).matrix, pixels=(1, 2, 1)).pixels == (1, 2, 1)
    with refused_input(subject="crosstalk matrix", value=pytest.approx(1.2)):
        Crosstalk(matrix=of_share(0.2).matrix, pixels=(1, 1, 1))


@pytest.mark.parametrize(
    ("kernel", "value"),
    [
        (np.full((2, 2), 0.1), (2, 2)),
        (np.full((3, 2), 0.1), (3, 2)),
        (np.array([[0.0, 0.2, 0.0], [0.2, 0.5, 0.2], [0.0, 0.2, 0.0]]), pytest.approx(1.3)),
    ],
)
def test_a_kernel_of_even_size_or_that_makes_light_is_refused(kernel, value):
    with refused_input(subject="crosstalk kernel", value=value):
        crosstalk_of_kernel(kernel, bayer(), RGB.names)


@pytest.mark.parametrize("bad", [np.array([[-0.1]]), np.array([[np.nan]])])
def test_a_kernel_or_matrix_with_negative_or_missing_shares_is_refused(bad):
    with refused_input(subject="crosstalk kernel"):
        crosstalk_of_kernel(bad, bayer(), RGB.names)
    with refused_input(subject="crosstalk matrix"):
        Crosstalk(matrix=bad, pixels=(1,))


def test_a_matrix_of_other_channels_or_a_second_one_is_refused():
    with refused_input(subject="crosstalk matrix", value=(2, 2)):
        Crosstalk(matrix=np.eye(2), pixels=(1, 1, 1))
    with refused_input(subject="the number of channels"):
        with_crosstalk(RGB, Crosstalk(matrix=np.eye(2), pixels=(1, 1)))
    with refused_input(subject="crosstalk", value=RGB.name):
        with_crosstalk(with_crosstalk(RGB, of_share(0.1)), of_share(0.1))


def test_a_share_beyond_all_light_or_a_mosaic_of_other_channels_is_refused():
    for share in (-0.1, 1.1, float("nan")):
        with refused_input(subject="crosstalk"):
            of_share(share)
    with refused_input(subject="mosaic", setting="mosaic"):
        crosstalk_of_share(0.1, mosaic_named("rgbw-2x2"), RGB.names)


def test_crosstalk_after_counting_that_cannot_be_inverted_is_refused():
    """Half of the light of Bayer's pixels: red and blue then get the same as green gives."""
    with refused_input(subject="crosstalk", setting="crosstalk_stage"):
        with_crosstalk(RGB, of_share(0.5, "charge"))


def test_a_budget_of_crosstalk_that_cannot_be_inverted_names_the_rows_that_hold_its_loss():
    sensor = with_crosstalk(RGB, of_share(0.5))
    budget = color_budget(WHITE, sensor, EXPOSURE, kernel_matrix(sensor, EXPOSURE))
    readings = {cost.cause: cost.reading for cost in budget.costs}
    assert "crosstalk" not in readings
    assert "crosstalk matrix is singular" in readings["correlation"]
    lost = sum(cost.cost_db for cost in budget.costs)
    assert budget.photons_db - lost == pytest.approx(budget.snr_db, abs=1e-9)


@given(st.floats(0, 1), st.lists(st.floats(1, 1e4), min_size=3, max_size=3))
def test_the_share_of_electrons_that_leave_is_not_the_net_change(share, electrons):
    """On Bayer all four neighbors have other channels; what they give in return is not offset."""
    assert moved_share(of_share(share), np.array(electrons)) == pytest.approx(share, abs=1e-12)


@pytest.mark.parametrize(
    "given_settings",
    [
        {"name": "model-mono", "crosstalk": 0.1, "subject": "crosstalk", "setting": "mosaic"},
        {"mosaic": "rgbw-2x2", "subject": "mosaic", "setting": "mosaic"},
        {"crosstalk_stage": "charge", "subject": "crosstalk_stage", "setting": "crosstalk"},
        {"crosstalk": 0.1, "mosaic": "rgbw-2x2", "subject": "mosaic"},
    ],
    ids=str,
)
def test_crosstalk_without_mosaic_and_a_mosaic_of_other_channels_are_refused(given_settings):
    settings = dict(given_settings)
    subject, setting = settings.pop("subject"), settings.pop("setting", None)
    name = settings.pop("name", "model-rgb-ircut")
    with refused_input(subject=subject, setting=setting):
        cn.analyze(name, **settings)


def test_a_mosaic_without_crosstalk_changes_no_number():
    (plain,), (with_mosaic,) = (
        cn.analyze("model-rgb-ircut", **settings).analyses for settings in ({}, {"mosaic": "bayer"})
    )
    np.testing.assert_array_equal(with_mosaic.raw.covariance, plain.raw.covariance)
    assert with_mosaic.sensor.mosaic.pattern == (("R", "G"), ("G", "B"))


@pytest.mark.parametrize(
    ("text", "pattern"),
    [
        ("RY/YB", (("Red", "Yellow"), ("Yellow", "Blue"))),
        ("Red Yellow; Yellow Blue", (("Red", "Yellow"), ("Yellow", "Blue"))),
        ("Red Yellow/Yellow Blue", (("Red", "Yellow"), ("Yellow", "Blue"))),
        ("ry;yb", (("Red", "Yellow"), ("Yellow", "Blue"))),
    ],
)
def test_letters_of_a_mosaic_are_the_channels_whose_names_begin_with_them(text, pattern):
    named = with_channel_names(mosaic_named(text), ("Red", "Yellow", "Blue"))
    assert named.pattern == pattern


def test_a_letter_that_is_a_channel_or_begins_two_names_stays_as_it_is():
    assert with_channel_names(mosaic_named("RG/GB"), ("R", "Red", "G", "B")) == bayer()
    ambiguous = with_channel_names(mosaic_named("RG/GB"), ("Red", "Redder", "Green", "Blue"))
    assert ambiguous.names == ("R", "Green", "Blue")


def test_a_study_takes_the_letters_of_a_mosaic_for_channels_with_long_names(tmp_path):
    """The same electrons as with the names written out; a letter of no channel is refused."""
    curves = np.where(np.arange(400, 1055, 5)[:, None] // 100 == np.array([6, 5, 4]), 0.5, 0.01)
    rows = "\n".join(
        ",".join(map(str, (nm, *row)))
        for nm, row in zip(range(400, 1055, 5), curves.tolist(), strict=True)
    )
    path = tmp_path / "ryb.csv"
    path.write_text(f"wavelength_nm,Red,Yellow,Blue\n{rows}\n")
    pixel = {"pitch_um": 3.0, "full_well_e": 1e4, "read_noise_e": 2.0}
    electrons = [
        cn.analyze(str(path), crosstalk=0.1, mosaic=text, **pixel).analyses[0].raw.mean
        for text in ("RY/YB", "Red Yellow; Yellow Blue")
    ]
    assert np.array_equal(*electrons)
    with refused_input(subject="mosaic", setting="mosaic"):
        cn.analyze(str(path), crosstalk=0.1, mosaic="RG/GB", **pixel)


def test_a_mosaic_without_crosstalk_counts_in_figures_of_merit():
    """Visual noise after bilinear demosaicing: three quarters of white pixels, or one of four."""
    found = {
        mosaic: cn.analyze("onyx-rgbw", mosaic=mosaic, merit=True).outcomes[0].merits.entries
        for mosaic in ("rgbw-4x4", "rgbw-2x2")
    }
    noise = {
        mosaic: next(one.value for one in entries if "bilinear" in one.what)
        for mosaic, entries in found.items()
    }
    assert noise["rgbw-4x4"] != pytest.approx(noise["rgbw-2x2"], rel=0.05)
    plain = [
        next(one.value for one in entries if "all channels" in one.what)
        for entries in found.values()
    ]
    assert plain[0] == plain[1]


def test_a_picture_of_the_sensors_mosaic_has_the_mosaic_given_without_crosstalk():
    study = study_from_data(
        {
            "sensors": [{"name": "onyx-rgbw", "mosaic": "GR/WB"}],
            "pictures": [{"cube": "checker", "mosaic": "sensor"}],
        },
        source="",
    )
    (point,) = operating_points_of(study)
    assert point.sensor.mosaic == mosaic_named("GR/WB")


@pytest.mark.parametrize(
    ("text", "requirement"),
    [
        (",R,G,W\nR,0.9,0.1,0\nG,0.1,0.9,0\nW,0,0,1\n", "must have columns for the channels"),
        ("R,G,B\n0.9,0.1,0\n0.1,0.9\n0,0,1\n", "must have 3 rows of 3 numbers"),
        ("R,G,B\n0.9,0.1,0\n0.1,0.9,0\n", "must have 3 rows of 3 numbers"),
        (",R,G,B\nR,0.9,0.1,0\nG,0.1,much,0\nB,0,0,1\n", "must hold numbers"),
        ("0.1,0.8,0.1\n0.1,0.8\n0.1,0.8,0.1\n", "must have rows of equal length"),
        ("", "must hold a table of numbers"),
        ("# nothing\n", "must hold a table of numbers"),
        ("once upon a time\n", "must have 4 rows of 4 numbers"),
    ],
)
def test_a_file_that_is_no_table_of_the_channels_is_refused(table, text, requirement):
    path = table(text)
    with refused_input(subject=str(path), requirement=requirement):
        read_crosstalk(path, RGB.names, bayer())


def test_a_missing_file_a_folder_and_bytes_are_refused(tmp_path, table):
    for path in (tmp_path / "none.csv", tmp_path):
        with refused_input(subject=str(path)):
            read_crosstalk(path, RGB.names, None)
    path = table("")
    path.write_bytes(b"\xff\xfe\x00R")
    with refused_input(subject=str(path)):
        read_crosstalk(path, RGB.names, None)


def test_a_kernel_in_a_file_needs_a_mosaic(table):
    path = table("0,0.025,0\n0.025,0.9,0.025\n0,0.025,0\n")
    with refused_input(subject=str(path), setting="mosaic"):
        read_crosstalk(path, RGB.names, None)
    found = read_crosstalk(path, RGB.names, bayer())
    assert found.matrix == pytest.approx(of_share(0.1).matrix, abs=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        ",R,G,B\nR,0.9,0.1,0\nG,0.05,0.85,0.1\nB,0,0.05,0.9\n",
        "B;R;G\nB;0.9;0;0.05\nG;0.1;0.05;0.85\nR;0;0.9;0.1\n",
        "# of a data sheet\nR G B\n0.9 0.1 0\n0.05 0.85 0.1\n0 0.05 0.9\n",
    ],
)
def test_a_matrix_in_a_file_names_its_rows_and_columns_in_any_order(table, text):
    found = read_crosstalk(table(text), RGB.names, None)
    np.testing.assert_array_equal(found.matrix, CROSSED)


def test_clipping_and_exact_distributions_refuse_channels_that_crosstalk_correlates():
    """They are computed channel by channel; the wrong covariance would be printed."""
    sensor = with_crosstalk(RGB, of_share(0.1, "charge"))
    found = analyzed(WHITE, sensor, EXPOSURE)
    held = Readout(black_e=0.0, full_well_e=sensor.pixel.full_well_e)
    asked = {"subject": "crosstalk_stage", "value": "charge", "setting": "crosstalk_stage"}
    with refused_input(**asked):
        analyzed(WHITE, sensor, EXPOSURE, readout=held)
    with refused_input(**asked):
        clipped_measurement(found.expected_e, sensor, held)
    with refused_input(**asked):
        gray_noise(found, LAB)
    with refused_input(**asked):
        chart_noise(found)
    before = with_crosstalk(RGB, of_share(0.1))
    assert gray_noise(analyzed(WHITE, before, EXPOSURE, readout=held), LAB) is not None
