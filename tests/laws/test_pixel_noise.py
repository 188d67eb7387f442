"""The whole pixel: every noise source in raw, color and budget, temporal and total."""

from copy import copy
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import chromanoise as cn
from chromanoise.base.properties import demand_properties
from chromanoise.color import (
    LAB,
    ElectronSource,
    colored,
    exact,
    first_order,
    kernel_matrix,
    noisy_color,
    propagate,
)
from chromanoise.geometry import contravariant
from chromanoise.imaging import acquired
from chromanoise.metrics import illuminance_for_snr, noise_speed, snr_db
from chromanoise.noise import (
    Exposure,
    Readout,
    expected_electrons,
    monte_carlo,
    noise_sources,
    saturating_exposure,
    sensor_moments,
    with_noise,
)
from chromanoise.sensor import (
    PAPER_PIXEL,
    PIXEL,
    Adc,
    Converter,
    Crosstalk,
    Mosaic,
    Pixel,
    bayer,
    crosstalk_of_share,
    with_crosstalk,
    with_pixel,
)
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import (
    SENSOR_NAMES,
    analyzed,
    color_budgets,
    color_snr_db,
    contravariant_budgets,
    lab_budgets,
    raw_snr_db,
    sensor_named,
)
from chromanoise.study.analysis import (
    noisy_color_at,
    stages_at,
    temporal_color_snr_db,
    temporal_raw_snr_db,
)
from goodness import moments_z
from noise_samples import noise_of
from outcomes import refused_input
from strategies import GRID, flat_cube, pixel_with, point_of, sensor_of, white_channel

LAMP = equal_energy(DEFAULT_GRID)
WHITE = flat_field(LAMP, level_lux=10.0)
EXPOSURE = Exposure(time_s=0.01)
AT = DEFAULT_GRID.wavelength_nm

ALL = {
    "dark_current_e_per_s": 4000.0,
    "dsnu_e": 6.0,
    "prnu": 0.012,
    "row_noise_e": 3.0,
    "gain_e_per_dn": 8.0,
}
"""A setting of the pixel per noise source beyond shot and read noise."""
ROWS = {
    "dark_current_e_per_s": "dark current",
    "dsnu_e": "DSNU",
    "prnu": "PRNU",
    "row_noise_e": "row noise",
    "gain_e_per_dn": "quantization",
}
"""Its row in the budget."""
SPATIAL = ("dsnu_e", "prnu")


def one_channel(**values):
    """A white channel of 50 %; with this exposure and light it collects some 10^4 electrons."""
    gain = values.pop("gain_e_per_dn", None)
    pixel = Pixel(**{"pitch_um": 10.0, "full_well_e": 1e6, "read_noise_e": 3.0, **values})
    return white_channel(pixel=pixel, converter=Converter(gain_e_per_dn=gain), name="white")


def camera(name="onyx-rgbw", stage=None, **changes):
    """A sensor of the catalog with a well that is never full, and crosstalk at ``stage``."""
    sensor = with_pixel(sensor_named(name, DEFAULT_GRID), {"full_well_e": 1e9, **changes})
    if stage is None or sensor.mosaic is None:
        return sensor
    mixed = crosstalk_of_share(0.08, sensor.mosaic, sensor.names)
    return with_crosstalk(sensor, replace(mixed, stage=stage))


def raw_of(sensor, exposure=EXPOSURE, **more):
    return with_noise(expected_electrons(WHITE, sensor, exposure), sensor, exposure, **more)


# numbers by hand


def test_the_variance_of_one_reading_is_the_sum_of_the_terms_of_emva_1288():
    # 5000 + 4 x 20 e-/s x .5 s + 3^2 + 1.5^2 + (1/12) 4^2 + 2^2 + (1 % of 5000)^2
    pixel = {"dark_current_e_per_s": 20.0, "temperature_c": 39.0, "dark_reference_c": 25.0}
    pixel |= {"dark_doubling_k": 7.0, "row_noise_e": 1.5, "dsnu_e": 2.0, "prnu": 0.01}
    sensor = one_channel(gain_e_per_dn=4.0, **pixel)
    mean = np.array([5000.0])
    temporal = 5000 + 40 + 9 + 2.25 + 16 / 12
    values = [
        float(with_noise(mean, sensor, Exposure(time_s=0.5), kind=kind).variance[0])
        for kind in ("temporal", "total")
    ]
    assert values == pytest.approx([temporal, temporal + 4 + 2500], rel=1e-14)


def test_only_a_number_that_is_none_by_default_may_be_none():
    for name in PIXEL:
        one = copy(PAPER_PIXEL)
        object.__setattr__(one, name, None)
        if name == "temperature_c":
            demand_properties(one)
        else:
            with refused_input(subject=name):
                demand_properties(one)


@pytest.mark.parametrize("prnu", [0.002, 0.01, 0.2])
def test_total_snr_tends_to_one_over_prnu_and_temporal_snr_does_not(prnu):
    sensor = one_channel(prnu=prnu, dsnu_e=5.0)
    limit = 20 * np.log10(1 / prnu)
    light = np.geomspace(1e2, 1e12, 40)[:, None]
    total = np.asarray(snr_db(with_noise(light, sensor))["W"])
    assert (np.diff(total) > 0).all()
    assert (total < limit).all()
    assert total[-1] == pytest.approx(limit, abs=1e-5)
    temporal = np.asarray(snr_db(with_noise(light, sensor, kind="temporal"))["W"])
    assert temporal[-1] == pytest.approx(120.0, abs=1e-6)  # 10 log10 of 10^12 electrons


def test_color_snr_is_capped_by_prnu_through_the_rows_of_the_matrix():
    """PHYSICS 5.1: mu / (PRNU |C mu| ...): C diag(mu^2) C^T is all that is left in bright light."""
    prnu = 0.01
    sensor = camera("onyx-rgb-ircut", prnu=prnu)
    mean = 1e9 * expected_electrons(WHITE, sensor, EXPOSURE)
    row = kernel_matrix(sensor, EXPOSURE).matrix[1]
    cap = 20 * np.log10(row @ mean / (prnu * np.sqrt(row**2 @ mean**2)))
    color = colored(with_noise(mean, sensor), kernel_matrix(sensor, EXPOSURE))
    assert float(snr_db(color)["Y"]) == pytest.approx(cap, abs=1e-4)
    assert cap < 40.0  # below the 40 dB of a raw channel: color pays more


# each source alone, and none


@pytest.mark.parametrize("setting", ALL)
def test_each_source_alone_raises_the_variance_of_raw_and_color(setting):
    plain, noisy = camera(), camera(**{setting: ALL[setting]})
    assert (raw_of(noisy).variance > raw_of(plain).variance).all()
    matrix = kernel_matrix(plain, EXPOSURE)
    assert (colored(raw_of(noisy), matrix).variance > colored(raw_of(plain), matrix).variance).all()
    temporal = raw_of(noisy, kind="temporal").variance
    if setting in SPATIAL:
        np.testing.assert_array_equal(temporal, raw_of(plain).variance)
    else:
        np.testing.assert_array_equal(temporal, raw_of(noisy).variance)


def everything(sensor):
    """All numbers of an analysis and its budgets, in one flat list."""
    found = analyzed(WHITE, sensor, EXPOSURE)
    gray = stages_at(found.point, found.matrix, reflectance=0.18)
    lab = propagate(
        noisy_color_at(gray, found.matrix.matrix @ found.expected_e), LAB, first_order
    ).measurement
    parts = [found.raw, found.temporal_raw, found.contravariant, found.color, lab]
    numbers = [each for part in parts for each in (part.mean, part.covariance)]
    budgets = (*color_budgets(found), *contravariant_budgets(found), *lab_budgets(found))
    for budget in budgets:
        numbers.append([] if budget is None else [budget.snr_db, budget.optimal_linear_snr_db])
        numbers.append([] if budget is None else [cost.cost_db for cost in budget.costs])
    causes = [[] if b is None else [c.cause for c in b.costs] for b in budgets]
    return np.concatenate([np.ravel(each) for each in numbers]), causes


OFF = {
    **dict.fromkeys(("dark_current_e_per_s", "dsnu_e", "prnu", "row_noise_e"), 0.0),
    "black_error_e": 0.0,
}


@pytest.mark.parametrize("name", ["onyx-rgbw", "model-rgb-ircut", "model-three-layer"])
def test_sources_that_are_off_change_no_digit_of_any_stage_and_add_no_row(name):
    plain = sensor_named(name, DEFAULT_GRID)
    off = replace(plain, pixel=replace(plain.pixel, **OFF), converter=Converter())
    numbers, causes = everything(plain)
    same, same_causes = everything(off)
    np.testing.assert_array_equal(numbers, same)
    assert causes == same_causes
    assert not {cause for each in causes for cause in each} & set(ROWS.values())


@pytest.mark.parametrize("setting", ALL)
def test_a_source_off_among_all_others_changes_no_digit(setting):
    others = {name: value for name, value in ALL.items() if name != setting}
    never = camera(**others)
    off = {"gain_e_per_dn": None} if setting == "gain_e_per_dn" else {setting: 0.0}
    numbers, causes = everything(never)
    same, same_causes = everything(with_pixel(camera(**ALL), off))
    np.testing.assert_array_equal(numbers, same)
    assert causes == same_causes


# budgets add up


MIXED = ("onyx-rgbw", "onyx-rgb-ircut", "model-rgbir")  # three and four channels, infrared or none


def stages_of(sensor):
    """SNR of each coordinate by the road of measurements, and its budget."""
    found = analyzed(WHITE, sensor, EXPOSURE)
    white = found.matrix.matrix @ found.expected_e
    gray = stages_at(found.point, found.matrix, reflectance=0.18)
    lab = propagate(noisy_color_at(gray, white), LAB, first_order).measurement
    raw = found.raw
    yield from zip(color_budgets(found), np.array(list(snr_db(found.color).values())), strict=True)
    unmixed = np.array(list(snr_db(contravariant(raw, found.matrix.frame)).values()))
    yield from zip(contravariant_budgets(found), unmixed, strict=True)
    yield from zip(lab_budgets(found), -10 * np.log10(lab.variance), strict=True)


def assert_adds_up(sensor, causes):
    """Every budget of a sensor, where infrared that counts as signal is the rest in X, Y, Z."""
    budgets = 0
    for budget, own_db in stages_of(sensor):
        if budget is None:
            continue
        budgets += 1
        lost = sum(cost.cost_db for cost in budget.costs)
        assert budget.photons_db - lost == pytest.approx(budget.snr_db, abs=1e-9)
        assert budget.snr_db == pytest.approx(float(own_db), abs=1e-9)
        assert causes <= {cost.cause for cost in budget.costs}
        assert len(budget.costs) == len({cost.cause for cost in budget.costs})
    return budgets


@pytest.mark.parametrize(
    ("name", "stage"),
    [(name, None) for name in SENSOR_NAMES]
    + [(name, stage) for name in MIXED for stage in ("light", "charge")],
)
def test_the_costs_of_all_causes_at_once_add_up_in_every_coordinate(name, stage):
    sensor = camera(name, stage, **ALL)
    crossed = {"crosstalk"} if sensor.crosstalk is not None else set()
    channels = len(sensor.names)
    expected = 3 + channels + (1 if channels == 1 else 3)
    assert assert_adds_up(sensor, set(ROWS.values()) | crossed) >= expected - 1


@settings(max_examples=12)
@given(
    st.dictionaries(st.sampled_from(list(ALL)), st.floats(0.01, 4.0), max_size=5),
    st.sampled_from([None, "light", "charge"]),
    st.sampled_from(MIXED),
)
def test_the_costs_of_any_causes_add_up(strengths, stage, name):
    changes = {setting: ALL[setting] * factor for setting, factor in strengths.items()}
    rows = {ROWS[setting] for setting in changes}
    assert assert_adds_up(camera(name, stage, **changes), rows) > 6


def test_a_single_source_costs_what_it_takes_from_a_single_channel():
    """One channel: only filters precede a source, so its loss has a closed form by hand.

    With all others off, half of the loss of two sources of one size is that of each.
    """
    sensor = with_pixel(camera("model-mono"), {"read_noise_e": 0.0, "prnu": 0.05})
    mean = expected_electrons(WHITE, sensor, EXPOSURE)[0]
    budget = contravariant_budgets(analyzed(WHITE, sensor, EXPOSURE))[0]
    costs = {cost.cause: cost.cost_db for cost in budget.costs}
    assert costs["PRNU"] == pytest.approx(10 * np.log10(1 + 0.05**2 * mean), abs=1e-9)
    twins = with_pixel(camera("model-mono"), {"read_noise_e": 20.0, "dsnu_e": 20.0})
    budget = contravariant_budgets(analyzed(WHITE, twins, EXPOSURE))[0]
    costs = {cost.cause: cost.cost_db for cost in budget.costs}
    half = 5 * np.log10(1 + 800 / mean)
    assert (costs["read noise"], costs["DSNU"]) == pytest.approx((half, half), abs=1e-9)


# temporal and total


@pytest.mark.parametrize("stage", [None, "light", "charge"])
def test_temporal_snr_is_that_of_the_sensor_without_prnu_and_dsnu(stage):
    noisy = analyzed(WHITE, camera(stage=stage, **ALL), EXPOSURE)
    calm = {name: value for name, value in ALL.items() if name not in SPATIAL}
    without = analyzed(WHITE, camera(stage=stage, **calm), EXPOSURE)
    assert temporal_raw_snr_db(noisy) == temporal_raw_snr_db(without)
    assert temporal_color_snr_db(noisy) == temporal_color_snr_db(without)
    for name, total in color_snr_db(noisy).items():
        assert total < temporal_color_snr_db(noisy)[name] - 0.01


def test_a_clipped_readout_has_a_temporal_snr_without_prnu_and_dsnu_too():
    full = Readout(black_e=0.0, full_well_e=1e9)
    noisy = analyzed(WHITE, camera(**ALL), EXPOSURE, readout=full)
    calm = {name: value for name, value in ALL.items() if name not in SPATIAL}
    without = analyzed(WHITE, camera(**calm), EXPOSURE, readout=full)
    assert temporal_raw_snr_db(noisy) == raw_snr_db(without)


# dark current


@given(st.floats(3.0, 30.0), st.floats(-40.0, 90.0), st.floats(0.1, 1e4))
def test_dark_current_doubles_each_doubling_temperature(doubling_k, celsius, current):
    pixel = replace(
        pixel_with(),
        dark_current_e_per_s=current,
        dark_reference_c=celsius,
        dark_doubling_k=doubling_k,
    )
    assert pixel.dark_electrons_e(time_s=2.0) == pytest.approx(2 * current, rel=1e-14)
    for doublings in (-2, 1, 3):
        warm = replace(pixel, temperature_c=celsius + doublings * doubling_k)
        assert warm.dark_electrons_e(time_s=2.0) == pytest.approx(
            2 * current * 2.0**doublings, rel=1e-12
        )


def test_dark_electrons_add_their_shot_noise_for_the_time_of_the_exposure():
    sensor = one_channel(dark_current_e_per_s=300.0)
    floor = [
        float(with_noise(np.zeros(1), sensor, Exposure(time_s=t)).variance[0]) for t in (1.0, 2.0)
    ]
    assert floor == pytest.approx([309.0, 609.0])
    assert with_noise(np.zeros(1), sensor, Exposure(time_s=1.0)).mean[0] == 0.0  # subtracted
    with refused_input(subject="exposure"):
        with_noise(np.zeros(1), sensor)


@pytest.mark.parametrize(("share", "lost"), [(0.05, False), (0.15, True)])
def test_dark_electrons_fill_the_well_too(share, lost):
    """90 % of it is light."""
    light = expected_electrons(WHITE, camera("model-mono"), EXPOSURE)[0]
    well = light / 0.9
    sensor = camera("model-mono", full_well_e=well, dark_current_e_per_s=share * well / 0.01)
    found = analyzed(WHITE, sensor, EXPOSURE)
    assert bool(found.saturated[0]) == lost
    assert (raw_snr_db(found)["W"] is None) == lost
    assert (temporal_raw_snr_db(found)["W"] is None) == lost
    assert (color_snr_db(found)["Y"] is None) == lost


@given(st.floats(0.0, 1e6), st.floats(0.05, 1.0))
def test_light_and_dark_electrons_together_fill_the_share_of_a_solved_time(current, share):
    sensor = camera(full_well_e=1e4, dark_current_e_per_s=current)
    exposure = saturating_exposure(WHITE, sensor, share=share)
    light = expected_electrons(WHITE, sensor, exposure).max()
    dark = current * exposure.time_s
    assert light + dark == pytest.approx(share * 1e4, rel=1e-12)


def test_a_study_solves_its_time_with_the_dark_electrons():
    (found,) = cn.analyze(
        "model-mono", lux=0.5, dark_current_e_per_s=800.0, temperature_c=32.0
    ).to_dict()["sensors"]  # 7 K above 25 C: 1600 e-/s
    full_well_e = sensor_named("model-mono", DEFAULT_GRID).pixel.full_well_e
    filled = found["channels"][0]["mean_e"] + 1.6 * found["time_ms"]
    assert filled == pytest.approx(0.99 * full_well_e, rel=1e-9)


# light that a sensor needs


@pytest.mark.parametrize("stage", [None, "light", "charge"])
def test_the_illuminance_for_an_snr_reaches_it_with_all_sources(stage):
    sensor = camera("onyx-rgb-ircut", stage, **(ALL | {"prnu": 0.004}))
    matrix = kernel_matrix(sensor, EXPOSURE)
    lux = illuminance_for_snr(sensor, LAMP, EXPOSURE, matrix, snr=10.0, reflectance=0.18)
    gray = flat_field(LAMP, level_lux=lux, reflectance=0.18)
    raw = with_noise(expected_electrons(gray, sensor, EXPOSURE), sensor, EXPOSURE)
    assert float(snr_db(colored(raw, matrix))["Y"]) == pytest.approx(20.0, abs=1e-9)


@pytest.mark.parametrize("stage", [None, "light", "charge"])
def test_the_noise_speed_is_that_of_the_light_at_which_gray_reaches_the_snr(stage):
    """ISO 12232 in steps: RGB of gray 1, D = Y with weighted R - Y and B - Y, all by C S C^T."""
    sensor = camera("onyx-rgb-ircut", stage, **(ALL | {"prnu": 0.004, "dark_current_e_per_s": 0.0}))
    rgb = np.linalg.inv([[0.9, 0.1, 0.0], [0.05, 0.9, 0.05], [0.0, 0.1, 0.9]])
    speed = noise_speed(sensor, LAMP, rgb, snr=10.0)
    lit = flat_field(LAMP, level_lux=10.0 / speed)
    mean = expected_electrons(lit, sensor, Exposure(time_s=1.0, f_number=0.5))
    balanced = rgb / (rgb @ mean)[:, None]
    color = balanced @ with_noise(mean, sensor).covariance @ balanced.T
    y = np.array([0.2125, 0.7154, 0.0721])
    red, blue = np.array([1, 0, 0]) - y, np.array([0, 0, 1]) - y
    variance = y @ color @ y + 0.279 * red @ color @ red + 0.088 * blue @ color @ blue
    assert variance == pytest.approx(0.01, rel=1e-9)


# black level


def test_a_wrong_black_level_shifts_the_color_and_adds_no_noise():
    right, wrong = camera("onyx-rgb-ircut"), camera("onyx-rgb-ircut", black_error_e=-7.0)
    np.testing.assert_array_equal(raw_of(right).covariance, raw_of(wrong).covariance)
    points = [analyzed(WHITE, sensor, EXPOSURE) for sensor in (right, wrong)]
    shadows = [stages_at(each.point, each.matrix, reflectance=0.02) for each in points]
    white = points[0].matrix.matrix @ points[0].expected_e
    colors = [noisy_color_at(shadow, white).xyz.mean for shadow in shadows]
    bias = points[0].matrix.matrix @ np.full(3, -7.0)
    assert colors[1] - colors[0] == pytest.approx(bias, rel=1e-12)
    lab = [LAB.from_xyz(color, white) for color in colors]
    assert np.hypot(*(lab[1] - lab[0])[1:]) > 0.1  # a colored shadow


# against draws


def bands(count):
    centers = np.linspace(430, 900, count)
    curves = [0.5 * np.exp(-(((AT - c) / (900 / count)) ** 2)) for c in centers]
    names = tuple(f"c{i}" for i in range(count))
    pixel, name = pixel_with(4.0, full_well_e=1e9), f"bands-{count}"
    return sensor_of(np.stack(curves, 1), grid=DEFAULT_GRID, pixel=pixel, names=names, name=name)


def drawn_sensors():
    """40 sensors with 1 to 16 channels, each with another pixel; a third with crosstalk."""
    rng = np.random.default_rng(1288)
    plain = [sensor_named(name, DEFAULT_GRID) for name in SENSOR_NAMES[:15]]
    plain += [bands(count) for count in range(1, 17)]
    plain += [bands(count) for count in (1, 2, 3, 3, 4, 5, 6, 12, 16)]
    sensors = []
    for i, sensor in enumerate(plain):
        read = rng.uniform(1.0, 12.0)
        pixel = {
            "full_well_e": 1e9,
            "read_noise_e": read,
            "gain_e_per_dn": rng.uniform(0.1, 1.0) * read,  # so that rounding adds step^2 / 12
            "dark_current_e_per_s": 10 ** rng.uniform(1, 4),
            "temperature_c": rng.uniform(10, 40),
            "dsnu_e": rng.uniform(0.5, 8.0),
            "prnu": 10 ** rng.uniform(-3, -1),
            "row_noise_e": rng.uniform(0.1, 3.0),
        }
        noisy = replace(with_pixel(sensor, pixel), name=f"{i}-{sensor.name}")
        if i % 3 and len(sensor.names) > 1:
            p = len(sensor.names)
            ring = 0.85 * np.eye(p) + 0.1 * np.roll(np.eye(p), 1, 0) + 0.05 * np.eye(p)[::-1]
            mixing = Crosstalk(matrix=ring, pixels=(1,) * p, stage=("light", "charge")[i % 3 - 1])
            noisy = with_crosstalk(noisy, mixing)
        sensors.append(noisy)
    return sensors


DRAWN = drawn_sensors()


def electrons_and_rows(sensor, number):
    """The light spans five decades over the sensors."""
    scene = flat_field(LAMP, level_lux=10 ** (-2 + number % 6))
    mean_e = expected_electrons(scene, sensor, EXPOSURE)
    kernel = kernel_matrix(sensor, EXPOSURE)
    rows = np.vstack([np.eye(mean_e.size), kernel.matrix])
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    return mean_e, rows


def plain_readings(mean_e, sensor, draws, rng):
    """The model of PHYSICS 5.1 and 5.2, written down anew, without the mean dark signal."""
    pixel, step = sensor.pixel, sensor.converter.gain_e_per_dn
    warmth = 2 ** ((pixel.temperature_c - 25.0) / 7.0)
    dark = pixel.dark_current_e_per_s * warmth * EXPOSURE.time_s
    coupled = sensor.crosstalk is not None and sensor.crosstalk.stage == "charge"
    coupling = sensor.crosstalk.matrix if coupled else np.eye(mean_e.size)
    counted = np.linalg.solve(coupling, mean_e)
    shape = (draws, mean_e.size)
    electrons = rng.poisson(counted * (1 + pixel.prnu * rng.standard_normal(shape)))
    electrons = electrons + rng.poisson(dark, shape) - dark
    electrons = (electrons + pixel.dsnu_e * rng.standard_normal(shape)) @ coupling.T
    noise = np.hypot(pixel.read_noise_e, pixel.row_noise_e)
    electrons += noise * rng.standard_normal(shape)
    return step * np.round(electrons / step)


def plain_scores(sensor, number, draws, chunk=100_000):
    """z of mean, variance and covariance of raw, and of mean and variance of X, Y, Z."""
    mean_e, rows = electrons_and_rows(sensor, number)
    result = with_noise(mean_e, sensor, EXPOSURE)
    expected = rows @ result.mean
    covariance = rows @ result.covariance @ rows.T
    rng = np.random.default_rng(7000 + number)
    q = len(rows)
    sums, squares = np.zeros((2, q)), np.zeros((2, q, q))
    for start in range(0, draws, chunk):
        count = min(chunk, draws - start)
        away = plain_readings(mean_e, sensor, count, rng) @ rows.T - expected
        sums += away.sum(axis=0), (away**2).sum(axis=0)
        squares += away.T @ away, (away**2).T @ away**2
    mean_z = sums[0] / draws / np.sqrt(np.diag(covariance) / draws)
    second, fourth = squares / draws
    error = np.sqrt((fourth - second**2) / draws)
    return np.concatenate([mean_z, ((second - covariance) / error).ravel()])


def estimated_scores(sensor, number, draws):
    """The same by `monte_carlo` with all noise sources of the pixel: mean and deviation."""
    mean_e, rows = electrons_and_rows(sensor, number)
    result = with_noise(mean_e, sensor, EXPOSURE)
    noise = noise_sources(sensor, EXPOSURE)
    drawn = monte_carlo(mean_e, sensor.pixel, rows, draws=draws, seed=number, noise=noise)
    sd = np.sqrt(np.einsum("qp,pr,qr->q", rows, result.covariance, rows))
    return np.concatenate(
        [(drawn.mean - rows @ result.mean) / drawn.mean_se, (drawn.sd - sd) / drawn.sd_se]
    )


NUMBERED = [pytest.param(s, i, id=s.name) for i, s in enumerate(DRAWN)]
INDEPENDENT = [
    case for case in NUMBERED
    if case.values[0].crosstalk is None or case.values[0].crosstalk.stage == "light"
]  # fmt: skip


def test_there_are_forty_sensors_with_one_to_sixteen_channels():
    counts = [len(sensor.names) for sensor in DRAWN]
    assert len(DRAWN) == 40
    assert (min(counts), max(counts)) == (1, 16)
    stages = [sensor.crosstalk and sensor.crosstalk.stage for sensor in DRAWN]
    assert min(stages.count(stage) for stage in (None, "light", "charge")) > 9


TEN_MILLION = pytest.param(10_000_000, marks=pytest.mark.evidence)


@pytest.mark.parametrize("draws", [20_000, TEN_MILLION])
@pytest.mark.parametrize(("sensor", "number"), NUMBERED)
def test_the_closed_form_agrees_with_plain_draws_of_the_whole_pixel(sensor, number, draws):
    assert np.abs(plain_scores(sensor, number, draws)).max() < 5


@pytest.mark.parametrize("draws", [10_000, TEN_MILLION])
@pytest.mark.parametrize(("sensor", "number"), INDEPENDENT)
def test_the_closed_form_agrees_with_monte_carlo_of_the_whole_pixel(sensor, number, draws):
    assert np.abs(estimated_scores(sensor, number, draws)).max() < 5


# exact moments


HELD = {
    "clipped at full well": (4900.0, Readout(black_e=0.0, full_well_e=6000.0)),
    "clipped at black": (8.0, Readout(black_e=0.0, full_well_e=6000.0)),
    "kept below black": (8.0, Readout(black_e=-40.0, full_well_e=6000.0)),
    "free": (500.0, Readout()),
}
FLAWED = noise_of(
    read_noise_e=9.0, dark_e=1000.0, step_e=7.0, row_noise_e=2.0, dsnu_e=6.0, prnu=0.01
)


def read_by_hand(mean, noise, readout, draws, seed, *, shape=()):
    """A well holds light and dark electrons; the mean dark is subtracted, then codes are made."""
    rng, shape = np.random.default_rng(seed), (draws, *shape)
    sensitivity = 1 + noise.pixel.prnu * rng.standard_normal(shape)
    electrons = rng.poisson(mean * sensitivity + noise.dark_e).astype(float)
    for sd in (noise.pixel.read_noise_e, noise.pixel.row_noise_e, noise.pixel.dsnu_e):
        electrons += sd * rng.standard_normal(shape)
    subtracted = noise.dark_e - noise.black_error_e
    read, most = electrons - subtracted, readout.full_well_e - subtracted
    if noise.step_e:
        read = noise.step_e * np.round(read / noise.step_e)
    clipped = (read < readout.black_e).mean(), (read > most).mean()
    return np.clip(read, readout.black_e, most), clipped


@pytest.mark.parametrize("black_error_e", [0.0, -15.0])
@pytest.mark.parametrize("case", HELD)
def test_exact_moments_of_the_whole_pixel_agree_with_draws(case, black_error_e):
    mean, readout = HELD[case]
    noise = replace(FLAWED, pixel=replace(FLAWED.pixel, black_error_e=black_error_e))
    read, clipped = read_by_hand(mean, noise, readout, 200_000, 31)
    found = sensor_moments(np.array([mean]), noise, readout)
    assert moments_z(read, found.mean[0], found.variance[0]) < 5
    assert found.bias[0] == pytest.approx(found.mean[0] - mean, abs=1e-9)
    values = float(found.black_share[0]), float(found.full_share[0])
    for seen, share in zip(clipped, values, strict=True):
        assert abs(seen - share) <= 5 * np.sqrt(share * (1 - share) / read.size) + 1e-4


@pytest.mark.parametrize("case", ["clipped at full well", "clipped at black"])
def test_monte_carlo_clips_where_the_exact_moments_do(case):
    """The well holds the dark electrons too: it is full 1000 e- of light earlier."""
    mean, readout = HELD[case]
    pixel = pixel_with(9.0, full_well_e=readout.full_well_e)
    drawn = monte_carlo(
        np.array([mean]), pixel, np.eye(1), draws=100_000, seed=5, noise=FLAWED, clip=True
    )
    found = sensor_moments(np.array([mean]), FLAWED, readout)
    assert abs(drawn.mean[0] - found.mean[0]) < 5 * drawn.mean_se[0]
    assert abs(drawn.sd[0] - np.sqrt(found.variance[0])) < 5 * drawn.sd_se[0]
    clipped = float(found.black_share[0] + found.full_share[0])
    assert clipped > 0.1
    assert abs(drawn.clipped_share[0] - clipped) < 5 * np.sqrt(clipped * (1 - clipped) / 100_000)


def test_without_bounds_the_exact_moments_are_the_closed_form():
    sensor = one_channel(**ALL)
    mean = np.array([0.0, 30.0, 4000.0])[:, None]
    found = sensor_moments(mean, noise_sources(sensor, EXPOSURE), Readout())
    result = with_noise(mean, sensor, EXPOSURE)
    assert found.mean == pytest.approx(result.mean, abs=2e-4)
    assert found.variance == pytest.approx(result.variance, rel=1e-3)  # 8 e- steps of 3 e- noise


# exact noise in CIELAB


@pytest.mark.parametrize(("prnu", "dark_e", "black_error_e"), [(0.03, 0.0, 0.0), (0.02, 60.0, 4.0)])
@pytest.mark.parametrize("level", [0.02, 1.0])
def test_exact_noise_in_cielab_of_the_whole_pixel_agrees_with_draws(
    level, prnu, dark_e, black_error_e
):
    """Gray of 18 %, down to some ten electrons; nothing is negative often enough to matter."""
    sensor = sensor_named("model-rgb-ircut", DEFAULT_GRID)
    matrix = kernel_matrix(sensor, EXPOSURE).matrix
    white_e = expected_electrons(flat_field(LAMP, level_lux=100 * level), sensor, EXPOSURE)
    noise = noise_of(
        read_noise_e=2.0, dark_e=dark_e, prnu=prnu, dsnu_e=1.0, black_error_e=black_error_e
    )
    source = ElectronSource(mean_e=0.18 * white_e, matrix=matrix, noise=noise)
    white = matrix @ white_e
    found = propagate(noisy_color(source, white), LAB, exact)
    read, _ = read_by_hand(0.18 * white_e, noise, Readout(), 200_000, 17, shape=(3,))
    lab = LAB.from_xyz(read @ matrix.T, white)
    deviation = (lab - lab.mean(axis=0)) ** 2
    errors = [each.std(axis=0) / np.sqrt(len(lab)) for each in (lab, deviation)]
    z_mean = (lab.mean(axis=0) - found.measurement.mean) / errors[0]
    z_variance = (deviation.mean(axis=0) - found.sd**2) / np.hypot(
        errors[1], 2 * found.sd * found.sd_error
    )
    assert np.abs(z_mean).max() < 5
    assert np.abs(z_variance).max() < 5


# pictures


SIDE, FRAMES, GAIN, BLACK_DN = 160, 6, 2.0, 500
PICTURE = {
    "dark_current_e_per_s": 20_000.0,  # 200 e- in 10 ms
    "dsnu_e": 25.0,
    "prnu": 0.015,
    "row_noise_e": 12.0,
    "read_noise_e": 8.0,
    "full_well_e": 1e6,
}


@pytest.mark.parametrize("stage", ["temporal", "total"])
def test_flat_fields_with_all_sources_scatter_as_the_closed_form_tells(stage):
    """Variance and mean of codes over pixels and frames, against K^2 times that of `with_noise`.

    A row shares its offset, and a pixel its sensitivity and dark signal over the frames; the
    standard error of the variance counts each as often as it is drawn.
    """
    sensor = with_pixel(one_channel(), PICTURE)
    sensor = replace(sensor, converter=Converter(bits=16, gain_e_per_dn=GAIN))
    point = point_of(sensor, 30.0)
    adc = Adc(bits=16, gain_e_per_dn=GAIN, black_level_dn=BLACK_DN)
    cube = flat_cube(GRID.wavelength_nm, 0.5, height=SIDE, width=SIDE)
    pictures = [
        acquired(cube, point, mosaic=Mosaic((("W",),)), adc=adc, frame=frame, seed=3)
        for frame in range(FRAMES)
    ]
    codes = np.stack([picture.codes.astype(float) for picture in pictures])
    mean_e = expected_electrons(
        flat_field(equal_energy(GRID), level_lux=30.0, reflectance=0.5), sensor, EXPOSURE
    )
    told_dn2 = float(with_noise(mean_e, sensor, EXPOSURE, kind=stage).variance[0]) / GAIN**2
    told_mean = float(mean_e[0]) / GAIN + BLACK_DN
    row = (12.0 / GAIN) ** 2
    fixed = ((0.015 * float(mean_e[0])) ** 2 + 25.0**2) / GAIN**2
    temporal = told_dn2 - row - (fixed if stage == "total" else 0.0)
    pixels, rows = SIDE**2, SIDE * FRAMES
    mean_error = np.sqrt(fixed / pixels + temporal / codes.size + row / rows)
    assert abs(codes.mean() - told_mean) < 5 * mean_error
    if stage == "temporal":
        found = codes.var(axis=0, ddof=1).mean()
        error = np.sqrt(2 * (temporal**2 / (FRAMES - 1) / pixels + row**2 / (rows - SIDE)))
    else:
        found = ((codes - told_mean) ** 2).mean()
        error = np.sqrt(2 * (fixed**2 / pixels + temporal**2 / codes.size + row**2 / rows))
        error = np.hypot(error, np.sqrt(4 * fixed * temporal / codes.size))
    assert error < 0.02 * told_dn2
    assert abs(found - told_dn2) < 5 * error


# what cannot be


def test_a_temperature_without_dark_current_is_refused():
    with refused_input(subject="temperature_c", value=40.0):
        with_pixel(camera(), {"temperature_c": 40.0})
    with refused_input(subject="temperature_c", value=40.0):
        cn.analyze("model-rgb-ircut", temperature_c=40.0)


def test_the_picture_of_a_mosaic_takes_crosstalk_into_its_means():
    """Flat light: each pixel collects what the mixed curves tell."""
    sensor = with_crosstalk(
        sensor_named("model-rgb-ircut", DEFAULT_GRID),
        crosstalk_of_share(0.2, bayer(), ("R", "G", "B")),
    )
    point = point_of(sensor)
    cube = flat_cube(AT, 0.4, height=16, width=16)
    found = acquired(cube, point, mosaic=bayer(), noisy=False).mean_e
    expected = expected_electrons(
        flat_field(LAMP, level_lux=10.0, reflectance=0.4), sensor, EXPOSURE
    )
    assert found == pytest.approx(expected, rel=1e-5)


def test_sources_of_a_negative_size_are_refused():
    for name in ("read_noise_e", "dark_e", "step_e", "row_noise_e", "dsnu_e", "prnu"):
        with refused_input(subject=name):
            noise_of(**{"read_noise_e": 1.0, name: -1.0})


def test_noise_of_negative_light_is_refused():
    with refused_input(subject="mean_e"):
        noise_sources(camera(prnu=0.01), EXPOSURE).variance_e2(np.array([-1.0, 2.0]))


def test_a_sweep_over_light_saturates_where_light_and_dark_electrons_fill_the_well():
    hot = {"time_ms": 11.0, "dark_current_e_per_s": 2e5, "lux": 10}  # 2,200 e- in 11 ms
    own = cn.compare("onyx-rgb-ircut", vary="lux", first=1.0, last=100.0, points=200, **hot)
    (curve,) = own.curves
    point = cn.analyze("onyx-rgb-ircut", **hot).points[0]
    electrons = cn.noise.expected_electrons(
        cn.noise.white_scene(point), point.sensor, point.exposure
    )
    full_lux = 10 * (10_000.0 - 2_200.0) / electrons.max()
    np.testing.assert_array_equal(curve.saturated, curve.at > full_lux)
    assert curve.saturated.any()
    assert not curve.saturated.all()
