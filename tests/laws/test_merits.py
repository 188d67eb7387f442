"""Figures of merit of a sensor in use: known values, other roads, and reasons where none exists."""

import json
from dataclasses import replace
from math import gamma

import colour
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from chromanoise.base import plain
from chromanoise.base.errors import InputError
from chromanoise.color import chart_training, cielab, colored, lmmse
from chromanoise.imaging import bilinear_filters, demosaicked
from chromanoise.metrics import matrix_report, visual_noise_of_picture
from chromanoise.noise import expected_electrons, saturating_exposure, with_noise
from chromanoise.sensor import Mosaic, bayer, crosstalk_of_share, with_crosstalk, with_pixel
from chromanoise.spectra import (
    DEFAULT_GRID,
    Grid,
    Scene,
    color_axes,
    colorchecker,
    equal_energy,
    flat_field,
    illuminant_named,
)
from chromanoise.spectra.curves import photons_per_unit
from chromanoise.study import (
    MatrixResult,
    Merit,
    Viewing,
    analyzed,
    electrons_at,
    matrix_makers,
    merits_of,
    noise_weights,
    pareto_of,
    sensor_named,
    white_snr_db,
)
from outcomes import refused_input
from strategies import (
    EXPOSURE,
    GRID,
    RGB,
    bell_qe,
    pixel_with,
    point_of,
    rgb_sensor,
    sensor_of,
    sensors,
    white_channel,
)

LAMP = equal_energy(GRID)


def merits_at(sensor, *, exposure=EXPOSURE, lux=10.0, metric="quanta", method="kernel", **more):
    maker = matrix_makers([method], metric, prior="chart")[method]
    matrix = maker(point_of(sensor, lux, exposure=exposure))
    white = flat_field(equal_energy(sensor.grid), level_lux=lux)
    analysis = analyzed(white, sensor, exposure, metric, matrix=matrix)
    return merits_of(analysis, maker=maker, **more)


def values(merits):
    return {entry.name: entry.value for entry in merits.entries}


def filled(sensor, share, lux=10.0):
    white = flat_field(equal_energy(sensor.grid), level_lux=lux)
    return saturating_exposure(white, sensor, share=share)


# filters


def camera(name):
    """A camera of the NPL, as colour-science carries it, as a sensor with quantum efficiencies."""
    grid = Grid.uniform(400, 700, 5)
    shape = colour.SpectralShape(400, 700, 5)
    per_watt = colour.MSDS_CAMERA_SENSITIVITIES[name].copy().align(shape).values
    per_photon = per_watt / photons_per_unit(grid, "energy")[:, None]
    qe = 0.5 * np.maximum(per_photon, 0.0) / per_photon.max()
    return sensor_of(qe, grid=grid, names=("R", "G", "B"))


# docs/numbers.md, computed from the curves of Darrodi et al., JOSA A 32 (2015)


@pytest.mark.parametrize(
    ("name", "q", "vora", "smi"),
    [
        ("Nikon 5100 (NPL)", [0.8818, 0.9725, 0.9062], 0.92987, 90.82),
        ("Sigma SDMerill (NPL)", [0.7935, 0.8784, 0.8878], 0.81041, 81.27),
    ],
)
def test_a_measured_camera_has_its_printed_q_vora_value_and_smi(name, q, vora, smi):
    result = values(merits_at(camera(name), metric="energy"))
    assert [result[f"neugebauer_q_{c}"] for c in "RGB"] == pytest.approx(q, abs=5e-5)
    assert result["vora_value"] == pytest.approx(vora, abs=1e-4)  # no curve below 0 here
    assert result["smi"] == pytest.approx(smi, abs=0.02)


def test_a_measured_camera_has_its_printed_angles():
    result = values(merits_at(camera("Nikon 5100 (NPL)"), metric="energy"))
    angles = [result[f"principal_angle_{i}"] for i in (1, 2, 3)]
    assert angles == pytest.approx([3.63, 13.65, 22.84], abs=5e-3)


def test_a_sensor_that_is_the_eye_reaches_the_best_of_every_filter_merit():
    axes = color_axes(DEFAULT_GRID, "quanta")
    eye = sensor_of(0.9 * axes / axes.max(), grid=DEFAULT_GRID, pixel=pixel_with(0.0, 1e9))
    result = values(merits_at(eye, exposure=filled(eye, 0.9)))
    assert [result[f"neugebauer_q_{c}"] for c in "abc"] == pytest.approx([1.0] * 3, abs=1e-12)
    assert result["vora_value"] == pytest.approx(1.0, abs=1e-12)
    assert [result[f"principal_angle_{i}"] for i in (1, 2, 3)] == pytest.approx([0.0] * 3, abs=1e-6)
    assert result["smi"] == pytest.approx(100.0, abs=1e-3)
    assert result["smi_lamp"] == pytest.approx(100.0, abs=1e-3)
    assert result["figure_of_merit"] == pytest.approx(1.0, abs=1e-5)  # 1e9 e- at the white


def test_infrared_costs_metamerism_in_the_lamp_but_not_in_the_standards_range():
    visible = sensor_named("model-rgb-ircut", DEFAULT_GRID)
    beyond = (DEFAULT_GRID.wavelength_nm > 780.0)[:, None]
    leaking = replace(visible, qe=np.where(beyond, 0.3, visible.qe))
    tight, leaky = values(merits_at(visible)), values(merits_at(leaking))
    assert leaky["smi"] == pytest.approx(tight["smi"], abs=1e-6)
    assert leaky["smi_lamp"] < tight["smi_lamp"] - 20.0


# merits under a prior


def chart_electrons(sensor, lux=10.0):
    patches = colorchecker(sensor.grid).values.T
    scene = Scene(illuminant=equal_energy(sensor.grid), level_lux=lux, reflectance=patches)
    return expected_electrons(scene, sensor, EXPOSURE)


def test_information_of_one_channel_is_that_of_a_gaussian_channel():
    sensor = white_channel(pixel=pixel_with(7.0))
    electrons = chart_electrons(sensor)
    snr = np.var(electrons) / (electrons.mean() + 49.0)  # Shannon 1948
    assert values(merits_at(sensor))["information"] == pytest.approx(0.5 * np.log2(1.0 + snr))


def test_the_noise_of_the_chart_is_the_mean_over_its_patches_also_with_prnu():
    sensor = with_pixel(white_channel(pixel=pixel_with(7.0)), {"prnu": 0.1})
    electrons = chart_electrons(sensor)
    noise = np.mean(electrons + 49.0 + (0.1 * electrons) ** 2)
    bits = 0.5 * np.log2(1.0 + np.var(electrons) / noise)
    assert values(merits_at(sensor))["information"] == pytest.approx(bits)


@pytest.mark.parametrize("read_noise_e", [0.0, 30.0])
def test_the_figure_of_merit_is_what_the_lmmse_matrix_of_the_chart_leaves(read_noise_e):
    sensor = rgb_sensor(read_noise_e)
    training = chart_training(LAMP)
    matrix = lmmse(sensor, EXPOSURE, training, level_lux=10.0).matrix
    electrons = chart_electrons(sensor)
    axes = color_axes(GRID, "energy")
    light = 10.0 * LAMP.irradiance
    xyz, white = colorchecker(GRID).values.T * light @ axes, light @ axes
    # slopes of CIELAB by finite differences, errors and noise patch by patch
    steps = 1e-5 * white
    jacobian = np.stack(
        [
            (cielab(xyz + step, white) - cielab(xyz - step, white)) / (2 * step.max())
            for step in np.diag(steps)
        ],
        axis=-1,
    )
    weight = np.mean([j.T @ j for j in jacobian], axis=0)
    missed = electrons @ matrix.T - xyz
    noise = matrix @ np.diag(electrons.mean(axis=0) + read_noise_e**2) @ matrix.T
    left = np.mean([m @ weight @ m for m in missed]) + np.trace(weight @ noise)
    wanted = np.mean([c @ weight @ c for c in xyz])
    found = values(merits_at(sensor, lux=10.0))["figure_of_merit"]
    assert found == pytest.approx(1.0 - left / wanted, abs=1e-8)


@settings(max_examples=2, deadline=None)
@given(sensors(min_channels=2), st.floats(0.1, 5.0))
def test_what_is_asked_of_light_does_not_depend_on_the_metric(sensor, lux):
    quanta, energy = (
        values(merits_at(sensor, lux=lux, metric=metric, method="least-squares"))
        for metric in ("quanta", "energy")
    )
    for name in ("figure_of_merit", "information", "snr10", "smi", "smi_lamp", "visual_noise"):
        if quanta[name] is None:
            assert energy[name] is None
        else:
            assert energy[name] == pytest.approx(quanta[name], rel=1e-5)


# speed


def test_one_channel_without_readout_reaches_snr_10_at_100_electrons():
    sensor = white_channel(pixel=pixel_with(0.0))
    lux = values(merits_at(sensor))["snr10"]
    gray = flat_field(LAMP, level_lux=lux, reflectance=0.18)
    assert expected_electrons(gray, sensor, EXPOSURE) == pytest.approx([100.0], rel=1e-12)


def test_noise_speed_of_one_channel_counts_photons_per_lux_second():
    """32,555 photons per lx s um^2 of equal energy 400-1050 nm (docs/numbers.md) on 100 um^2."""
    sensor = white_channel(0.5, grid=Grid.uniform(400, 1050, 1), pixel=pixel_with(0.0))
    result = values(merits_at(sensor))
    per_lux_second = 32_555 * 100 * 0.5
    assert result["noise_speed_10"] == pytest.approx(10 * per_lux_second / 10**2, rel=1e-4)
    assert result["noise_speed_40"] == pytest.approx(10 * per_lux_second / 40**2, rel=1e-4)


def test_the_adapting_matrix_has_snr_10_at_the_light_for_which_it_is_made():
    sensor = rgb_sensor()
    lux = values(merits_at(sensor, method="lmmse"))["snr10_adapted"]
    maker = matrix_makers(["lmmse"], "quanta", prior="chart")["lmmse"]
    gray = flat_field(LAMP, level_lux=lux, reflectance=0.18)
    raw = with_noise(expected_electrons(gray, sensor, EXPOSURE), sensor)
    color = colored(raw, maker(point_of(sensor, lux)))
    assert color.mean[1] / np.sqrt(color.variance[1]) == pytest.approx(10.0, rel=1e-9)


@pytest.mark.parametrize("method", ["kernel", "least-squares", "ridge=0.01"])
def test_a_matrix_that_does_not_adapt_has_no_adapted_speed(method):
    result = merits_at(rgb_sensor(), method=method)
    (adapted,) = (entry for entry in result.entries if entry.name == "snr10_adapted")
    assert adapted.value is None
    assert "does not adapt" in adapted.missing


# levels


@pytest.mark.parametrize("share", [1.0, 3.0])
def test_tonal_range_of_a_full_well_of_10000_electrons_is_7_4998_bits(share):
    sensor = white_channel(pixel=pixel_with(10.0, 10_000.0))
    exposure = filled(sensor, 1.0)
    longer = replace(exposure, time_s=share * exposure.time_s)  # held at full well
    assert values(merits_at(sensor, exposure=longer))["tonal_range_W"] == pytest.approx(
        7.4998, abs=5e-5
    )


@pytest.mark.parametrize("bits", [8, 10, 14])
def test_levels_are_no_finer_than_the_codes(bits):
    """DxOMark: the integral of 1 over the larger of step and noise, here as a sum."""
    sensor = with_pixel(white_channel(pixel=pixel_with(2.0, 10_000.0)), {"bits": bits})
    step = 10_000.0 / (2**bits - 1)
    middle = np.linspace(0.0, 10_000.0, 400_001)[:-1] + 0.0125
    sigma = np.sqrt(middle + 4.0 + step**2 / 12)
    levels = np.sum(0.025 / np.maximum(step, sigma))
    found = values(merits_at(sensor, exposure=filled(sensor, 1.0)))["tonal_range_W"]
    assert found == pytest.approx(np.log2(levels), rel=1e-6)


def test_color_sensitivity_of_three_channels_of_64_electrons_is_12_bits():
    sensor = sensor_of(np.repeat(RGB[:, :1], 3, axis=1), pixel=pixel_with(0.0, 64.0))
    result = values(merits_at(sensor, exposure=filled(sensor, 1.0)))
    assert result["color_sensitivity"] == pytest.approx(12.0, rel=1e-12)  # 3 log2(2 sqrt 64)


# visual noise


def test_visual_noise_of_one_channel_is_the_area_under_the_luminance_csf():
    """sigma_L* = 116/3 Y^(1/3) / SNR, and int 2 pi f CSF^2 df by the gamma function."""
    sensor = white_channel(pixel=pixel_with(5.0, 1e6))
    seen = Viewing(pixel_pitch_mm=0.25, distance_mm=1800.0)
    result = values(merits_at(sensor, viewing=seen))["visual_noise"]
    per_degree = 2 * 1800.0 * np.tan(np.radians(0.5)) / 0.25
    area = 2 * np.pi * (75.0 / 34.05) ** 2 * gamma(3.6) / 0.4**3.6 / per_degree**2
    gray_e = 0.18 * expected_electrons(flat_field(LAMP, level_lux=10.0), sensor, EXPOSURE)[0]
    sigma = 116.0 / 3.0 * 0.18 ** (1 / 3) * np.sqrt(gray_e + 25.0) / gray_e
    assert result == pytest.approx(sigma * np.sqrt(area), rel=3e-3)


def test_crosstalk_after_counting_is_undone_where_the_readout_adds_no_noise():
    plain = rgb_sensor(0.0, 1e9, mosaic=bayer(), names=("R", "G", "B"))
    mixing = replace(crosstalk_of_share(0.2, bayer(), plain.names), stage="charge")
    coupled = merits_at(with_crosstalk(plain, mixing))
    names = ("visual_noise", "figure_of_merit", "information")
    found, expected = values(coupled), values(merits_at(plain))
    assert [found[name] for name in names] == pytest.approx([expected[name] for name in names])
    missing = {entry.name: entry.missing for entry in coupled.entries}
    assert "crosstalk" in missing["color_sensitivity"]


def test_a_mosaic_of_one_channel_leaves_its_visual_noise_alone():
    alone = replace(white_channel(), mosaic=Mosaic((("W",),)))
    result = values(merits_at(alone))
    assert result["visual_noise_bilinear"] == pytest.approx(
        result["visual_noise"],
        rel=1e-6,  # u* and v* of one channel are roots of rounding
    )


def test_visual_noise_of_a_bayer_mosaic_is_that_of_simulated_pictures():
    sensor = rgb_sensor(0.0, 1e9, mosaic=bayer(), names=("R", "G", "B"))
    exposure = filled(sensor, 0.5)
    predicted = values(merits_at(sensor, exposure=exposure))["visual_noise_bilinear"]
    lamp_white = flat_field(LAMP, level_lux=10.0)
    white_e = expected_electrons(lamp_white, sensor, exposure)
    matrix = analyzed(lamp_white, sensor, exposure).matrix.matrix
    bank = bilinear_filters(sensor.mosaic, sensor.names)
    tile = np.array([[0, 1], [1, 2]])
    gray_e = 0.18 * white_e[np.tile(tile, (64, 64))]
    white = matrix @ white_e
    d = 15 + 1 + 3  # u'v' of X = Y = Z: 4/19, 9/19

    def luv(xyz):
        x, y, z = np.moveaxis(xyz, -1, 0)
        lightness = 116 * np.cbrt(y) - 16
        whole = x + 15 * y + 3 * z
        return np.stack(
            [
                lightness,
                13 * lightness * (4 * x / whole - 4 / d),
                13 * lightness * (9 * y / whole - 9 / d),
            ],
            axis=-1,
        )

    rng = np.random.default_rng(11)
    found = []
    for _ in range(12):
        raw = gray_e + np.sqrt(gray_e) * rng.normal(size=gray_e.shape)
        xyz = demosaicked(raw, bank) @ matrix.T / white
        found.append(visual_noise_of_picture(xyz, luv, pixels_per_degree=41.8879).total)
    error = np.std(found, ddof=1) / np.sqrt(len(found))
    assert abs(np.mean(found) - predicted) / error < 5
    assert error < 0.01 * predicted


# what is not defined


def test_a_white_that_fills_a_channel_hides_what_follows_eq_7_and_says_why():
    sensor = rgb_sensor(mosaic=bayer(), names=("R", "G", "B"))
    exposure = filled(sensor, 1.0)
    result = merits_at(sensor, exposure=replace(exposure, time_s=4 * exposure.time_s))
    hidden = {entry.name for entry in result.entries if "saturated" in entry.missing}
    assert hidden == {"figure_of_merit", "information", "visual_noise", "visual_noise_bilinear"}
    assert values(result)["vora_value"] is not None


def test_a_matrix_whose_white_is_no_color_has_no_visual_noise_and_no_speed():
    red_only = sensor_of(bell_qe([620.0, 660.0], [10.0, 10.0], [0.5, 0.5]), grid=GRID)
    analysis = analyzed(flat_field(LAMP, level_lux=10.0), red_only, EXPOSURE)
    negative = replace(analysis.matrix, matrix=analysis.matrix.matrix * [[1], [1], [-1]])
    result = merits_of(replace(analysis, matrix=negative))
    lost = {
        entry.name for entry in result.entries if entry.missing.startswith("Z of a perfect white")
    }
    assert lost == {"noise_speed_10", "noise_speed_40", "visual_noise"}
    # not the one through a mosaic: that there is none is told first


def test_a_lamp_without_blue_has_no_color_in_cielab():
    sensor = rgb_sensor()
    lamp = illuminant_named("LED660", GRID)
    result = merits_of(analyzed(flat_field(lamp, level_lux=10.0), sensor, EXPOSURE))
    for entry in result.entries:
        assert (entry.value is None) == bool(entry.missing)


@settings(max_examples=6, deadline=None)
@given(sensors(), st.floats(1e-3, 1e4))
def test_every_merit_has_a_finite_value_or_a_reason_and_goes_into_json(sensor, lux):
    data = plain(merits_at(sensor, lux=lux))
    json.dumps(data, allow_nan=False)
    for name, entry in data["values"].items():
        assert (entry["value"] is None) != (entry["missing"] is None), name
        assert entry["source"]


@pytest.mark.parametrize(("value", "missing"), [(None, ""), (1.0, "why"), (np.inf, "")])
def test_a_merit_without_value_and_reason_is_refused(value, missing):
    with pytest.raises(InputError):
        Merit(name="m", what="m", unit="1", value=value, source="s", missing=missing)


# the Pareto curve


@settings(max_examples=20, deadline=None)
@given(sensors(min_channels=2), st.floats(0.01, 100.0))
def test_along_the_curve_color_error_grows_and_noise_falls(sensor, lux):
    curve = pareto_of(point_of(sensor, lux), noise_weights(1e-3, 1e3), prior="chart")
    slack = 1e-9 * curve.color_error_rms.max()
    assert (np.diff(curve.color_error_rms) >= -slack).all()
    assert (np.diff(curve.noise_rms) <= 1e-9 * curve.noise_rms.max()).all()


def test_at_weight_1_the_curve_has_the_lmmse_matrix():
    sensor = rgb_sensor()
    curve = pareto_of(point_of(sensor, 1.0), noise_weights(0.01, 100.0, points=3), prior="chart")
    ours = lmmse(sensor, EXPOSURE, chart_training(LAMP), level_lux=1.0)
    assert curve.matrix[1] == pytest.approx(ours.matrix, rel=1e-9)


def with_curve(sensor, exposure, weights):
    """The LMMSE matrix of a sensor with its curve."""
    point = point_of(sensor, exposure=exposure)
    matrix = matrix_makers(["lmmse"], "quanta", prior="chart")["lmmse"](point)
    return MatrixResult(
        point=point,
        matrix=matrix,
        report=matrix_report(matrix, sensor, exposure, LAMP, level_lux=10.0),
        white_e=electrons_at(point),
        pareto=pareto_of(point, weights, prior="chart"),
    )


def test_a_saturated_white_has_no_snr_along_the_curve():
    sensor = rgb_sensor()
    exposure = filled(sensor, 1.0)
    twice = replace(exposure, time_s=2 * exposure.time_s)
    result = with_curve(sensor, twice, noise_weights(0.1, 10.0, points=3))
    assert white_snr_db(result.pareto, result.report) == (None, None, None)
    data = result.to_dict()
    assert [point["snr_y_db"] for point in data["pareto"]] == [None] * 3
    assert data["report"]["snr_db"] is None


def test_the_matrix_in_json_is_on_the_curve_in_json_at_its_weight():
    data = with_curve(rgb_sensor(), EXPOSURE, noise_weights(0.01, 100.0, points=3)).to_dict()
    json.dumps(data, allow_nan=False)
    at_1 = data["pareto"][1]
    assert at_1["weight"] == pytest.approx(1.0)
    assert np.array(at_1["lux_per_e"]) == pytest.approx(np.array(data["matrix"]["lux_per_e"]))
    assert at_1["snr_y_db"] == pytest.approx(data["report"]["snr_db"]["Y"], abs=1e-9)


@pytest.mark.parametrize(
    ("asked", "fields"),
    [
        ((0.0, 1.0, 3), {"subject": "weight of the noise", "value": 0.0}),
        ((1.0, 1.0, 3), {"subject": "weights of the noise", "value": (1.0, 1.0)}),
        ((1.0, 10.0, 1), {"subject": "points", "value": 1}),
        ((float("nan"), 1.0, 3), {"subject": "weight of the noise"}),
    ],
)
def test_weights_that_make_no_curve_are_refused(asked, fields):
    first, last, points = asked
    with refused_input(**fields):
        noise_weights(first, last, points=points)


def test_a_prior_that_nobody_named_is_refused():
    with refused_input(subject="prior", value="charts"):
        pareto_of(point_of(rgb_sensor()), noise_weights(0.1, 1.0), prior="charts")


def test_a_viewing_from_nowhere_is_refused():
    with refused_input(subject="distance_mm", value=0.0):
        Viewing(distance_mm=0.0)
