"""Laws of every observer: exact kernels, an eye as a sensor, budgets, figures of merit."""

from dataclasses import replace

import colour
import numpy as np
import pytest
from hypothesis import given, strategies as st

import chromanoise as cn
from chromanoise.charts import drawing
from chromanoise.charts.charted_study import shown
from chromanoise.charts.vectors import color_frame
from chromanoise.color import kernel_matrix, least_squares, nir_diverse, scene_xyz
from chromanoise.color.training import training_response
from chromanoise.geometry import angles_to_axes_deg
from chromanoise.metrics import chart_color_error, matrix_report
from chromanoise.noise import Exposure, measurement_vectors, white_scene
from chromanoise.spectra import (
    DEFAULT_GRID,
    METRICS,
    OBSERVERS,
    cie_a,
    color_axes,
    color_matching_functions,
    equal_energy,
    flat_field,
)
from chromanoise.study import (
    analyzed,
    color_budgets,
    diagnosis,
    lab_budgets,
    matrix_makers,
    merits_of,
    sensor_named,
)
from chromanoise.study.color_matrices import training_named
from chromanoise.study.sweeps import QUANTITIES, color_error, color_errors
from strategies import EXPOSURE, GRID, point_of, sensor_of, sensors

OTHERS = [name for name in OBSERVERS if name != "cie-1931-2"]
TABLES = {
    "cie-1931-2": "CIE 1931 2 Degree Standard Observer",
    "cie-1964-10": "CIE 1964 10 Degree Standard Observer",
    "cie-2015-2": "CIE 2015 2 Degree Standard Observer",
    "cie-2015-10": "CIE 2015 10 Degree Standard Observer",
}
LAMP = equal_energy(DEFAULT_GRID)
EYE_EXPOSURE = Exposure(time_s=1e-4, f_number=1.8)
each_observer = pytest.mark.parametrize("observer", OBSERVERS)


def axes_by_hand(grid, metric, observer):
    """H from the table of colour-science: K_m dl cmf, times h c / lambda for photons."""
    functions = colour.MSDS_CMFS[TABLES[observer]]
    seen = np.zeros((grid.n, 3))
    inside = (grid.wavelength_nm >= functions.wavelengths[0]) & (
        grid.wavelength_nm <= functions.wavelengths[-1]
    )
    seen[inside] = functions[grid.wavelength_nm[inside]]
    axes = 683.002 * grid.step_nm * seen
    if metric == "quanta":  # of photons s-1 um-2 nm-1
        axes *= 6.62607015e-34 * 299792458 / (1e-9 * grid.wavelength_nm[:, None]) * 1e12
    return axes


def eye(observer, grid=DEFAULT_GRID):
    """A sensor with the functions of an observer, which are per energy."""
    per_photon = color_matching_functions(grid, observer).values / grid.wavelength_nm[:, None]
    qe = 0.9 * per_photon / per_photon.max()
    return sensor_of(qe, grid=grid, names=("l", "m", "s"), name="eye")


@given(sensors(), st.sampled_from(list(OBSERVERS)), st.sampled_from(METRICS), st.data())
def test_the_kernel_is_exact_on_the_span_of_the_channels(sensor, observer, metric, data):
    basis = measurement_vectors(sensor, EXPOSURE, metric)
    mix = np.array(
        data.draw(st.lists(st.floats(-1.0, 1.0), min_size=basis.shape[1], max_size=basis.shape[1]))
    )
    spectrum = basis @ mix
    matrix = kernel_matrix(sensor, EXPOSURE, metric, observer)
    seen, true = (
        matrix.matrix @ (basis.T @ spectrum),
        axes_by_hand(sensor.grid, metric, observer).T @ spectrum,
    )
    scale = np.abs(axes_by_hand(sensor.grid, metric, observer)).T @ np.abs(basis).sum(axis=1)
    np.testing.assert_allclose(seen / scale, true / scale, atol=1e-9)


@pytest.mark.parametrize("metric", METRICS)
@each_observer
def test_the_angles_to_the_axes_are_those_to_the_table(observer, metric):
    sensor = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    white = flat_field(LAMP, level_lux=10.0)
    analysis = analyzed(white, sensor, EYE_EXPOSURE, metric, observer=observer)
    channels = sensor.qe * (DEFAULT_GRID.wavelength_nm[:, None] if metric == "energy" else 1.0)
    axes = axes_by_hand(DEFAULT_GRID, metric, observer)
    cosines = (channels / np.linalg.norm(channels, axis=0)).T @ (
        axes / np.linalg.norm(axes, axis=0)
    )
    by_hand = np.degrees(np.arccos(cosines))
    np.testing.assert_allclose(analysis.to_axes_deg, by_hand, atol=1e-5)
    frame = color_frame(color_axes(DEFAULT_GRID, metric, observer))
    np.testing.assert_allclose(frame @ (frame.T @ axes), axes, atol=1e-9 * axes.max())
    shown = angles_to_axes_deg(analysis.matrix.frame, axes)
    np.testing.assert_allclose(analysis.to_axes_deg, shown, atol=1e-6)


@each_observer
def test_a_sensor_with_the_functions_of_an_observer_has_no_color_error_for_it(observer):
    sensor = eye(observer)
    for name in ("kernel", "least-squares"):
        (maker,) = matrix_makers([name], "quanta").values()
        for lamp in (LAMP, cie_a(DEFAULT_GRID)):
            own = maker(point_of(sensor, exposure=EYE_EXPOSURE, illuminant=lamp, observer=observer))
            error = chart_color_error(sensor, own, EYE_EXPOSURE, lamp)
            assert own.observer == observer
            assert error.max() == pytest.approx(0.0, abs=1e-7)


@each_observer
def test_and_has_a_color_error_for_every_other_observer(observer):
    sensor = eye(observer)
    for other in set(OBSERVERS) - {observer}:
        matrix = kernel_matrix(sensor, EYE_EXPOSURE, "quanta", other)
        assert chart_color_error(sensor, matrix, EYE_EXPOSURE, cie_a(DEFAULT_GRID)).max() > 0.3


@each_observer
def test_the_filters_of_an_eye_are_perfect_for_its_own_observer_only(observer):
    white = flat_field(LAMP, level_lux=10.0)
    values = {}
    for of in OBSERVERS:
        found = merits_of(analyzed(white, eye(observer), EYE_EXPOSURE, observer=of))
        assert found.observer == of
        values[of] = {entry.name: entry.value for entry in found.entries}
    assert values[observer]["vora_value"] == pytest.approx(1.0, abs=1e-12)
    assert values[observer]["neugebauer_q_m"] == pytest.approx(1.0, abs=1e-12)
    for other in set(OBSERVERS) - {observer}:
        assert values[other]["vora_value"] < 0.9999
        # ISO 17321-1 defines the SMI for CIE 1931
        for name in ("smi", "smi_lamp"):
            assert values[other][name] == values[observer][name]


@each_observer
def test_a_training_set_has_the_colors_of_its_observer(observer):
    training = training_named("chart", LAMP, observer)
    assert training.observer == nir_diverse(training).observer == observer
    sensor = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    seen = training_response(training, sensor, EYE_EXPOSURE, level_lux=7.0)
    by_hand = (
        7.0
        * (training.reflectance * LAMP.irradiance)
        @ axes_by_hand(DEFAULT_GRID, "energy", observer)
    )
    np.testing.assert_allclose(seen.xyz, by_hand, rtol=1e-9)
    assert seen.observer == observer


@pytest.mark.parametrize("method", ["white-preserving", "bounded-psi=100", "ridge=0"])
@each_observer
def test_a_fitted_matrix_is_for_the_observer_of_its_point(observer, method):
    (maker,) = matrix_makers([method], "quanta").values()
    point = point_of(eye(observer), exposure=EYE_EXPOSURE, observer=observer)
    matrix = maker(point)
    np.testing.assert_allclose(
        matrix.matrix @ (measurement_vectors(point.sensor, EYE_EXPOSURE, "quanta").T),
        axes_by_hand(DEFAULT_GRID, "quanta", observer).T,
        atol=1e-7 * axes_by_hand(DEFAULT_GRID, "quanta", observer).max(),
    )
    assert matrix.observer == observer


@pytest.mark.parametrize("observer", OTHERS)
def test_many_levels_at_once_give_the_colors_of_each_level(observer):
    sensor = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    point = point_of(sensor, exposure=EYE_EXPOSURE, observer=observer)
    (maker,) = matrix_makers(["lmmse"], "quanta").values()
    levels = np.array([0.3, 3.0, 30.0])
    matrices = maker.over_levels(point, levels)
    one_by_one = [maker(replace(point, level_lux=lux)) for lux in levels.tolist()]
    np.testing.assert_allclose(matrices, [one.matrix for one in one_by_one], rtol=1e-9)
    errors = [color_error(point, one) for one in one_by_one]
    np.testing.assert_allclose(color_errors(point, matrices), errors, rtol=1e-9)
    snr = QUANTITIES["snr-x"]
    together = snr.over_levels(point, one_by_one[0], levels, matrices=matrices)
    alone = [
        snr.of(replace(point, level_lux=lux), one)
        for lux, one in zip(levels.tolist(), one_by_one, strict=True)
    ]
    np.testing.assert_allclose(together, alone, rtol=1e-9)


@each_observer
def test_budgets_add_up_for_every_observer(observer):
    result = cn.analyze("onyx-rgb-ircut", "onyx-rgbw", observer=observer)
    for analysis in result.analyses:
        known = [one for one in (*color_budgets(analysis), *lab_budgets(analysis)) if one]
        assert len(known) >= 5
        for budget in known:
            losses = sum(cost.cost_db for cost in budget.costs)
            assert budget.photons_db - losses == pytest.approx(budget.snr_db, abs=1e-9)


def test_the_snr_of_x_follows_the_observer():
    # X of 1964 is an own combination of channels: by hand from m = H^T F G^-1 and D = diag(M + s^2)
    sensor = sensor_named("model-rgb-ircut", DEFAULT_GRID)
    (result,) = cn.analyze(
        "model-rgb-ircut", time_ms=5.0, observer="cie-1964-10", illuminant="A"
    ).analyses
    basis = measurement_vectors(sensor, result.exposure, "quanta")
    axes = axes_by_hand(DEFAULT_GRID, "quanta", "cie-1964-10")
    weights = np.linalg.solve(basis.T @ basis, basis.T @ axes).T
    mean = result.expected_e
    variance = mean + sensor.pixel.read_noise_e**2
    expected = 20 * np.log10(weights @ mean / np.sqrt(weights**2 @ variance))
    from_result = [result.color.mean[i] / np.sqrt(result.color.variance[i]) for i in range(3)]
    np.testing.assert_allclose(20 * np.log10(from_result), expected, atol=1e-9)


@each_observer
def test_the_report_on_an_eye_has_the_white_of_its_observer(observer):
    sensor, white = eye(observer), flat_field(LAMP, level_lux=10.0)
    matrix = kernel_matrix(sensor, EYE_EXPOSURE, "quanta", observer)
    report = matrix_report(matrix, sensor, EYE_EXPOSURE, LAMP, level_lux=10.0)
    analysis = analyzed(white, sensor, EYE_EXPOSURE, matrix=matrix)
    assert report.color_error_max == pytest.approx(0.0, abs=1e-7)
    np.testing.assert_allclose(analysis.color.mean, analysis.truth_xyz, rtol=1e-9)
    np.testing.assert_allclose(
        analysis.truth_xyz, scene_xyz(white_scene(analysis.point), "energy", observer), rtol=1e-9
    )


def test_a_result_for_another_observer_has_a_note_and_one_for_cie_1931_has_none():
    white, sensor = (
        flat_field(equal_energy(GRID), level_lux=10.0),
        sensor_of(eye("cie-1931-2", GRID).qe),
    )
    usual = diagnosis(analyzed(white, sensor, EYE_EXPOSURE))
    other = diagnosis(analyzed(white, sensor, EYE_EXPOSURE, observer="cie-2015-10"))
    assert not any("observer" in note for note in usual)
    assert sum("cie-2015-10" in note for note in other) == 1


@pytest.mark.parametrize("observer", OTHERS)
def test_a_noise_aware_matrix_lies_on_the_trade_off_of_its_observer(observer):
    study = {"sensors": [{"name": "model-rgb-ircut"}], "observer": observer}
    every = drawing("pareto", shown(cn.study_from_data(study))).columns
    middle = [one.values[len(one.values) // 2] for one in every]
    study |= {"matrices": [f"noise-aware={middle[1]!r}"]}
    now = [one.values[-1] for one in drawing("pareto", shown(cn.study_from_data(study))).columns]
    assert now[2:] == pytest.approx(middle[2:], rel=1e-9)


def test_a_fit_does_not_mix_observers():
    sensor = sensor_named("onyx-rgb-ircut", DEFAULT_GRID)
    made = {
        name: least_squares(
            sensor, EYE_EXPOSURE, training_named("chart", LAMP, name), level_lux=10.0
        )
        for name in OBSERVERS
    }
    for name, matrix in made.items():
        assert matrix.observer == name
    first = made["cie-1931-2"].matrix
    assert all(np.abs(made[name].matrix / first - 1).max() > 0.01 for name in OTHERS)
