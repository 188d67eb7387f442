"""What holds for any sensor's frame: dual basis, projection, mixes, rank."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.color import colored, kernel_matrix
from chromanoise.geometry import (
    angles_to_axes_deg,
    contravariant,
    dual_frame,
    nearest_mix,
    reconstructed_light,
    spectral_snr,
    variance_inflation,
)
from chromanoise.metrics import snr_db
from chromanoise.noise import expected_electrons, measurement_vectors, through, with_noise
from chromanoise.spectra import METRICS, Scene, color_axes, equal_energy, light
from strategies import EXPOSURE, GRID, bell_qe, mixes, raw_of, reflectances, sensor_of, sensors

metrics = st.sampled_from(METRICS)


def frame_of(sensor, metric="quanta"):
    return dual_frame(
        measurement_vectors(sensor, EXPOSURE, metric), names=sensor.names, metric=metric
    )


def white_raw(sensor):
    scene = Scene(illuminant=equal_energy(GRID), level_lux=20.0, reflectance=np.ones(GRID.n))
    return with_noise(expected_electrons(scene, sensor, EXPOSURE), sensor)


@given(sensors(), metrics)
def test_the_dual_basis_is_the_inverse_of_the_basis(sensor, metric):
    frame = frame_of(sensor, metric)
    p = len(sensor.names)
    assert frame.dual.T @ frame.basis == pytest.approx(np.eye(p), abs=1e-9)
    assert frame.rank == p


@given(sensors(), metrics)
def test_the_dual_basis_lies_in_the_span_of_the_basis(sensor, metric):
    frame = frame_of(sensor, metric)
    coordinates, *_ = np.linalg.lstsq(frame.basis, frame.dual, rcond=None)
    assert frame.basis @ coordinates == pytest.approx(
        frame.dual, abs=1e-9 * np.abs(frame.dual).max()
    )


def test_the_dual_of_a_skew_pair_stands_upright_on_its_partner():
    # f_a = (2, 0), f_b = (1, 1): f^a = (1/2, -1/2), f^b = (0, 1), by hand
    frame = dual_frame(np.array([[2.0, 1.0], [0.0, 1.0]]), names=("a", "b"), metric="quanta")
    assert frame.dual == pytest.approx(np.array([[0.5, 0.0], [-0.5, 1.0]]), abs=1e-14)


@given(sensors(), metrics)
def test_seeing_and_rebuilding_is_a_symmetric_idempotent_projector(sensor, metric):
    frame = frame_of(sensor, metric)
    seen_and_rebuilt = reconstructed_light(frame, frame.basis)  # row i: from light at i alone
    assert seen_and_rebuilt == pytest.approx(seen_and_rebuilt.T, abs=1e-9)
    assert seen_and_rebuilt @ seen_and_rebuilt == pytest.approx(seen_and_rebuilt, abs=1e-9)
    assert np.trace(seen_and_rebuilt) == pytest.approx(frame.rank, abs=1e-9)


@given(st.data(), sensors(min_channels=2), metrics)
def test_mixing_the_channels_with_their_noise_changes_nothing_that_is_seen(data, sensor, metric):
    raw, frame = white_raw(sensor), frame_of(sensor, metric)
    mix = data.draw(mixes(len(sensor.names)))
    mixed_raw = through(raw, mix, names=raw.names, kind="raw", unit="e-")
    mixed = dual_frame(frame.basis @ mix.T, names=sensor.names, metric=metric)

    light_seen = reconstructed_light(frame, raw.mean)
    assert reconstructed_light(mixed, mixed_raw.mean) == pytest.approx(
        light_seen, abs=1e-7 * np.abs(light_seen).max()
    )
    assert spectral_snr(mixed_raw, mixed) == pytest.approx(spectral_snr(raw, frame), rel=1e-7)

    axes = color_axes(GRID, metric)
    xyz = through(raw, axes.T @ frame.dual, names=("X", "Y", "Z"), kind="XYZ", unit="lx")
    again = through(mixed_raw, axes.T @ mixed.dual, names=("X", "Y", "Z"), kind="XYZ", unit="lx")
    assert again.mean == pytest.approx(xyz.mean, abs=1e-7 * np.abs(xyz.mean).max())
    assert again.covariance == pytest.approx(
        xyz.covariance, abs=1e-7 * np.abs(xyz.covariance).max()
    )
    assert snr_db(again)["Y"] == pytest.approx(float(snr_db(xyz)["Y"]), abs=1e-6)


@given(st.data(), sensors(min_channels=2), metrics)
def test_permuting_the_channels_permutes_the_results(data, sensor, metric):
    p = len(sensor.names)
    order = list(data.draw(st.permutations(range(p))))
    shuffled = sensor_of(
        sensor.qe[:, order], pixel=sensor.pixel, names=tuple(sensor.names[i] for i in order)
    )
    frame, again = frame_of(sensor, metric), frame_of(shuffled, metric)
    assert variance_inflation(again) == pytest.approx(variance_inflation(frame)[order], rel=1e-8)
    axes = color_axes(GRID, metric)
    assert angles_to_axes_deg(again, axes) == pytest.approx(
        angles_to_axes_deg(frame, axes)[order], rel=1e-9
    )
    before = snr_db(contravariant(white_raw(sensor), frame))
    after = snr_db(contravariant(white_raw(shuffled), again))
    for name in sensor.names:
        assert float(after[name]) == pytest.approx(float(before[name]), abs=1e-5)
    matrix = kernel_matrix(sensor, EXPOSURE, metric).matrix
    assert kernel_matrix(shuffled, EXPOSURE, metric).matrix == pytest.approx(
        matrix[:, order], abs=1e-9 * np.abs(matrix).max()
    )
    assert colored(white_raw(shuffled), kernel_matrix(shuffled, EXPOSURE, metric)).covariance == (
        pytest.approx(
            colored(white_raw(sensor), kernel_matrix(sensor, EXPOSURE, metric)).covariance,
            rel=1e-7,
        )
    )


@given(st.data(), sensors(), metrics)
def test_the_kernel_is_exact_for_light_made_of_the_channels_themselves(data, sensor, metric):
    p = len(sensor.names)
    amounts = np.array([data.draw(st.floats(0.1, 1.0)) for _ in range(p)])
    f = measurement_vectors(sensor, EXPOSURE, metric)
    lamp = equal_energy(GRID)
    per_reflectance = light(
        Scene(illuminant=lamp, level_lux=10.0, reflectance=np.ones(GRID.n)), metric
    )
    wanted = f @ (amounts / np.linalg.norm(f, axis=0))
    rho = wanted / per_reflectance / (wanted / per_reflectance).max()
    scene = Scene(illuminant=lamp, level_lux=10.0, reflectance=rho)
    raw = with_noise(expected_electrons(scene, sensor, EXPOSURE), sensor)
    true_xyz = light(scene, metric) @ color_axes(GRID, metric)
    seen = colored(raw, kernel_matrix(sensor, EXPOSURE, metric))
    assert seen.mean == pytest.approx(true_xyz, rel=1e-8)


@given(sensors(min_channels=2))
def test_energy_and_quanta_do_not_share_a_kernel(sensor):
    kernels = [kernel_matrix(sensor, EXPOSURE, metric).matrix for metric in ("energy", "quanta")]
    assert not np.allclose(*kernels, rtol=1e-3)


@given(sensors(min_channels=2), st.lists(st.floats(1e-3, 1e3), min_size=4, max_size=4))
def test_gain_changes_neither_contravariant_snr_nor_vif_nor_condition(sensor, gains):
    g = np.diag(gains[: len(sensor.names)])
    raw, frame = white_raw(sensor), frame_of(sensor)
    amplified = through(raw, g, names=raw.names, kind="raw", unit="DN")
    again = dual_frame(frame.basis @ g, names=frame.names, metric=frame.metric)
    before, after = (
        snr_db(contravariant(raw, frame)),
        snr_db(contravariant(amplified, again)),
    )
    for name in raw.names:
        assert float(after[name]) == pytest.approx(float(before[name]), abs=1e-5)
    assert variance_inflation(again) == pytest.approx(variance_inflation(frame), rel=1e-9)
    assert again.condition == pytest.approx(frame.condition, rel=1e-9)


@given(sensors(min_channels=2), metrics)
def test_variance_inflates_by_the_angle_to_the_span_of_the_others(sensor, metric):
    frame = frame_of(sensor, metric)
    for i, vif in enumerate(variance_inflation(frame)):
        others, _ = np.linalg.qr(np.delete(frame.basis, i, axis=1))
        f = frame.basis[:, i] / np.linalg.norm(frame.basis[:, i])
        off_span = f - others @ (others.T @ f)
        assert vif == pytest.approx(1 / (off_span @ off_span), rel=1e-7)


@given(sensors(min_channels=2))
def test_the_nearest_mix_is_the_channel_of_largest_vif(sensor):
    frame = frame_of(sensor)
    vif, mix = variance_inflation(frame), nearest_mix(frame)
    assert mix is not None
    assert vif[sensor.names.index(mix.channel)] == pytest.approx(vif.max(), rel=1e-9)
    assert 1 / np.sin(np.radians(mix.angle_deg)) ** 2 == pytest.approx(vif.max(), rel=1e-7)
    assert mix.explained == pytest.approx(1 - 1 / vif.max(), rel=1e-7)


RGB = bell_qe([450, 540, 620], [25, 35, 30], [0.6, 0.7, 0.8])


def with_a_planted_mix(weights, defect):
    """A fourth channel that is the given mix of RGB, plus a little of something else."""
    bump = bell_qe([500], [6], [defect])
    return sensor_of(np.hstack([RGB, RGB @ np.array(weights)[:, None] + bump]))


@pytest.mark.parametrize("defect", [0.0, 1e-9, 1e-6, 1e-4])
def test_a_planted_mix_is_found_again_with_its_weights(defect):
    mix = nearest_mix(frame_of(with_a_planted_mix([0.2, 0.5, 0.3], defect)))
    assert mix is not None
    planted = {"a": 0.2, "b": 0.5, "c": 0.3}
    # any of the four may be named; solved for d, the mix must be the planted one
    if mix.channel != "d":
        share = mix.weights["d"]
        found = {k: -w / share for k, w in mix.weights.items() if k != "d"}
        found[mix.channel] = 1 / share
    else:
        found = mix.weights
    assert found == pytest.approx(planted, abs=20 * defect + 1e-9)
    assert mix.angle_deg < 60 * defect + 1e-6


def test_a_copied_channel_costs_rank_and_no_number_is_lost():
    qe = np.hstack([RGB, RGB[:, :1] * 0.5])
    sensor = sensor_of(qe)
    frame = frame_of(sensor)
    assert frame.rank == 3
    assert frame.condition == float("inf")
    vif = variance_inflation(frame)
    assert list(np.isinf(vif)) == [True, False, False, True]  # only a and its copy d
    assert vif[1:3] == pytest.approx(variance_inflation(frame_of(sensor_of(RGB)))[1:3], rel=1e-8)
    assert np.isfinite(kernel_matrix(sensor, EXPOSURE).matrix).all()


def test_a_copied_channel_leaves_the_rebuilt_light_as_it_was():
    sensor, single = sensor_of(np.hstack([RGB, RGB[:, :1] * 0.5])), sensor_of(RGB)
    seen = reconstructed_light(frame_of(sensor), white_raw(sensor).mean)
    assert seen == pytest.approx(
        reconstructed_light(frame_of(single), white_raw(single).mean), rel=1e-8, abs=1e-12
    )


def test_more_channels_than_wavelengths_is_an_answer_too():
    frame = dual_frame(
        np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]), names=("a", "b", "c"), metric="quanta"
    )
    assert frame.rank == 2
    assert np.isinf(variance_inflation(frame)).all()
    assert nearest_mix(frame) is not None


def test_one_channel_is_a_mix_of_nothing():
    frame = frame_of(sensor_of(RGB[:, :1]))
    assert nearest_mix(frame) is None
    assert variance_inflation(frame) == pytest.approx([1.0], rel=1e-12)


def test_two_copies_beside_two_near_copies_are_told_apart():
    # a and b are the same; c and d stand 3e-10 apart: the frame counts 3 independent channels
    near = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 1.0], [0.0, 6e-10]])
    copies = np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    frame = dual_frame(np.hstack([copies, near]), names=("a", "b", "c", "d"), metric="quanta")
    vif = variance_inflation(frame)
    assert list(np.isinf(vif)) == [True, True, frame.rank < 3, frame.rank < 3]


@given(sensors(), reflectances())
def test_a_picture_of_points_is_rebuilt_point_by_point(sensor, rho):
    frame = frame_of(sensor)
    points = np.stack([rho, 1 - rho, np.ones(GRID.n)]).reshape(3, 1, GRID.n) @ frame.basis
    seen = reconstructed_light(frame, points)
    for i in range(3):
        assert seen[i, 0] == pytest.approx(
            reconstructed_light(frame, points[i, 0]), abs=1e-9 * (1 + np.abs(seen).max())
        )


@given(sensors(min_channels=2))
def test_contravariant_means_of_a_picture_are_those_of_its_points(sensor):
    raw, frame = white_raw(sensor), frame_of(sensor)
    two = raw_of(
        np.stack([raw.mean, 2 * raw.mean]),
        np.stack([raw.covariance, 3 * raw.covariance]),
        names=raw.names,
    )
    seen, single = contravariant(two, frame), contravariant(raw, frame)
    assert seen.mean[1] == pytest.approx(2 * single.mean, rel=1e-9)
    assert seen.covariance[1] == pytest.approx(3 * single.covariance, rel=1e-9)
