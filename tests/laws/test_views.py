"""What the plane of two channels shows is what stands in the space of n wavelengths."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.apps.paper import paper_study
from chromanoise.apps.paper.printed_numbers import RGB_59, RGBW_12
from chromanoise.apps.paper.views import (
    channel_plane,
    fitting_magnification,
    magnified_noise,
    narrowest_pair,
    widest_pair,
)
from chromanoise.noise import measurement_vectors
from chromanoise.sensor import with_channels
from chromanoise.spectra import METRICS, Scene, color_axes, equal_energy, flat_field, light
from chromanoise.study import analyzed
from outcomes import refused_input
from strategies import EXPOSURE, GRID, bell_qe, sensor_of, sensors

metrics = st.sampled_from(METRICS)
pairs_of_channels = sensors(min_channels=2, max_channels=2)


@pytest.fixture(scope="module")
def study():
    return paper_study()


def analysis_of(sensor, metric="quanta"):
    scene = flat_field(equal_energy(sensor.grid), level_lux=20.0)
    return analyzed(scene, sensor, EXPOSURE, metric)


def plane_of(sensor, metric="quanta", **more):
    analysis = analysis_of(sensor, metric)
    return channel_plane(analysis, analysis.sensor.names[:2], draws=10, **more)


def space_of(sensor, metric):
    """F and L, in the space of n wavelengths."""
    scene = flat_field(equal_energy(sensor.grid), level_lux=20.0)
    return measurement_vectors(sensor, EXPOSURE, metric), light(scene, metric)


def boxes(first, second):
    """Two channels that answer alike within their wavelengths and not at all outside."""
    at = GRID.wavelength_nm
    return sensor_of(
        np.stack([0.5 * ((at >= low) & (at < high)) for low, high in (first, second)], axis=1)
    )


def test_two_channels_that_share_half_of_their_light_stand_at_60_degrees():
    assert plane_of(boxes((420, 520), (470, 570))).angle_deg == pytest.approx(60.0, abs=1e-9)


def test_channels_that_share_no_light_have_equal_covariant_and_contravariant_components():
    plane = plane_of(boxes((420, 520), (560, 620)))
    assert plane.angle_deg == pytest.approx(90.0, abs=1e-9)
    np.testing.assert_allclose(plane.parts, plane.feet, rtol=1e-9, atol=1e-9 * plane.feet.max())


@given(pairs_of_channels, metrics)
def test_the_drawn_angle_is_the_angle_in_n_dimensions(sensor, metric):
    plane = plane_of(sensor, metric)
    f, _ = space_of(sensor, metric)
    in_space = np.degrees(
        np.arccos(f[:, 0] @ f[:, 1] / np.linalg.norm(f[:, 0]) / np.linalg.norm(f[:, 1]))
    )
    first, second = plane.arrows
    drawn = np.degrees(np.arctan2(second[1], second[0]) - np.arctan2(first[1], first[0]))
    assert drawn == pytest.approx(in_space, abs=1e-5)
    assert plane.angle_deg == pytest.approx(in_space, abs=1e-5)


@given(pairs_of_channels, metrics)
def test_the_contravariant_parts_add_up_to_the_least_squares_light(sensor, metric):
    plane = plane_of(sensor, metric)
    f, true_light = space_of(sensor, metric)
    nearest = f @ np.linalg.lstsq(f, true_light, rcond=None)[0]
    scale = np.linalg.norm(nearest)
    np.testing.assert_allclose(
        plane.view.axes @ plane.parts.sum(axis=0), nearest, atol=1e-9 * scale
    )
    np.testing.assert_allclose(plane.view.axes @ plane.measured.mean, nearest, atol=1e-9 * scale)


@given(pairs_of_channels, metrics)
def test_what_the_measured_light_misses_is_orthogonal_to_both_channels(sensor, metric):
    plane = plane_of(sensor, metric)
    f, true_light = space_of(sensor, metric)
    missed = true_light - plane.view.axes @ plane.measured.mean
    np.testing.assert_allclose(f.T @ missed / (f.T @ true_light), 0.0, atol=1e-9)
    sine = np.linalg.norm(missed) / np.linalg.norm(true_light)
    assert np.sin(np.radians(plane.light_tilt_deg)) == pytest.approx(sine)
    assert plane.light_length == pytest.approx(np.linalg.norm(true_light))


@given(pairs_of_channels, metrics)
def test_the_light_falls_on_the_feet_at_right_angles_and_they_read_the_electrons(sensor, metric):
    plane = plane_of(sensor, metric)
    f, true_light = space_of(sensor, metric)
    for i, foot in enumerate(plane.feet @ plane.view.axes.T):
        scale = np.linalg.norm(f[:, i]) * np.linalg.norm(true_light)
        assert f[:, i] @ (true_light - foot) == pytest.approx(0.0, abs=1e-9 * scale)
        assert f[:, i] @ foot == pytest.approx(plane.two.raw.mean[i])


@given(pairs_of_channels, metrics, st.sampled_from("xyz"))
def test_the_foot_on_a_color_axis_reads_the_color_of_the_measured_light(sensor, metric, axis):
    plane = plane_of(sensor, metric, axis=axis)
    h = color_axes(sensor.grid, metric)[:, "xyz".index(axis)]
    color = h @ (plane.view.axes @ plane.measured.mean)
    scale = np.linalg.norm(h) * np.linalg.norm(plane.measured.mean)
    read = plane.axis.length * (plane.axis.foot @ plane.axis.direction)
    assert read == pytest.approx(color, abs=1e-9 * scale)
    assert plane.axis.color == pytest.approx(color, abs=1e-9 * scale)


@given(pairs_of_channels, metrics)
def test_the_share_of_the_color_axis_is_what_the_channels_explain_of_it(sensor, metric):
    plane = plane_of(sensor, metric)
    f, _ = space_of(sensor, metric)
    y = color_axes(sensor.grid, metric)[:, 1]
    unexplained = y - f @ np.linalg.lstsq(f, y, rcond=None)[0]
    explained = 1 - (unexplained @ unexplained) / (y @ y)
    assert plane.axis.share == pytest.approx(explained, abs=1e-9)
    assert np.cos(np.radians(plane.axis.tilt_deg)) ** 2 == pytest.approx(explained, abs=1e-9)


@given(pairs_of_channels, metrics)
def test_the_ellipse_touches_the_four_sides_of_the_zone_between_the_channels(sensor, metric):
    plane = plane_of(sensor, metric)
    noise = magnified_noise(plane, 3.0)
    raw = plane.two.raw
    half = 3.0 * noise.sigmas * np.sqrt(raw.mean + sensor.pixel.read_noise_e**2)
    for outline, tolerance in ((noise.outline, 1e-3), (noise.locus, 1e-6)):
        read = outline @ plane.view.vectors
        np.testing.assert_allclose(read.max(axis=0) - raw.mean, half, rtol=tolerance)
        np.testing.assert_allclose(raw.mean - read.min(axis=0), half, rtol=tolerance)
    on_axes = np.einsum("kec,ck->ke", noise.feet_bars, plane.view.vectors)
    np.testing.assert_allclose(on_axes, raw.mean[:, None] + np.outer(half, [-1, 1]), rtol=1e-6)


@given(pairs_of_channels, metrics)
def test_the_interval_on_the_color_axis_is_the_shadow_of_the_ellipse(sensor, metric):
    plane = plane_of(sensor, metric)
    noise = magnified_noise(plane, 3.0)
    toward = plane.axis.direction
    shadow = noise.outline @ toward
    ends, touches = noise.axis_bar @ toward, noise.axis_touch @ toward
    width = np.ptp(ends)
    np.testing.assert_allclose(ends, [shadow.min(), shadow.max()], atol=1e-3 * width)
    np.testing.assert_allclose(ends, touches, atol=1e-9 * np.abs(ends).max())
    # and it is as wide as the variance of the color, propagated without the plane, says
    sd = np.sqrt(plane.two.color.variance[1])
    assert width * plane.axis.length == pytest.approx(3.0 * 2 * noise.sigmas * sd, rel=1e-6)


def test_the_snr_of_the_color_axis_is_its_mean_over_its_interval(study):
    plane = channel_plane(study.columns[RGB_59], ("G", "R"))
    noise = magnified_noise(plane, 1.0)
    sd = np.linalg.norm(np.diff(noise.axis_bar, axis=0)) / (2 * noise.sigmas)
    result = 20 * np.log10(np.linalg.norm(plane.axis.foot) / sd)
    assert plane.axis.color_snr_db == pytest.approx(result, abs=1e-9)


@pytest.mark.parametrize("column", [RGBW_12, RGB_59])
def test_the_2_sigma_ellipse_holds_86_percent_of_the_acquisitions(study, column):
    draws = 100_000
    plane = channel_plane(study.columns[column], ("R", "G"), draws=draws, seed=5)
    noise = magnified_noise(plane, 20.0)
    center = noise.outline[:-1].mean(axis=0)
    # a point lies within if the ray through it leaves the ellipse beyond it
    bearing = np.unwrap(np.arctan2(*(noise.outline - center).T[::-1]))
    radius = np.linalg.norm(noise.outline - center, axis=1)
    at = np.arctan2(*(noise.cloud - center).T[::-1])
    order = np.argsort(bearing)
    edge = np.interp(at, bearing[order], radius[order], period=2 * np.pi)
    inside = np.mean(np.linalg.norm(noise.cloud - center, axis=1) < edge)
    expected = 1 - np.exp(-2.0)
    assert abs(inside - expected) < 5 * np.sqrt(expected * (1 - expected) / draws)


def test_the_same_seed_draws_the_same_cloud_and_another_seed_another(study):
    first, again, other = (
        channel_plane(study.columns[RGB_59], ("R", "G"), seed=seed).cloud for seed in (1, 1, 2)
    )
    assert first.shape == (400, 2)
    np.testing.assert_array_equal(first, again)
    assert not np.isclose(first, other).all(axis=1).any()


def test_magnification_moves_every_acquisition_away_from_the_mean_in_proportion(study):
    plane = channel_plane(study.columns[RGB_59], ("R", "G"))
    once, often = magnified_noise(plane, 1.0), magnified_noise(plane, 20.0)
    np.testing.assert_allclose(once.cloud, plane.cloud)
    for part in ("cloud", "outline", "locus"):
        far, near = (getattr(n, part) - plane.measured.mean for n in (often, once))
        np.testing.assert_allclose(far, 20 * near, atol=1e-9 * np.abs(far).max())


@pytest.mark.parametrize("time_s", [1e-7, 1e-3, 0.01])
def test_the_fitting_magnification_is_round_and_makes_the_ellipse_a_quarter_of_the_light(time_s):
    exposure = type(EXPOSURE)(time_s=time_s, f_number=1.8)
    scene = flat_field(equal_energy(GRID), level_lux=20.0)
    sensor = sensor_of(bell_qe((480.0, 560.0), (40.0, 40.0), (0.5, 0.5)))
    plane = channel_plane(analyzed(scene, sensor, exposure), sensor.names)
    times = fitting_magnification(plane)
    assert float(f"{times:e}".split("e")[0]) in (1.0, 2.0, 5.0)
    outline = magnified_noise(plane, times).outline - plane.measured.mean
    diameter = 2 * np.linalg.norm(outline, axis=1).max() / np.linalg.norm(plane.measured.mean)
    assert times >= 1  # noise is never drawn smaller than it is
    # and the steps of 1, 2, 5, 10 are at most a factor 2.5 apart
    assert times == 1 or 0.25 / np.sqrt(2.5) <= diameter <= 0.25 * np.sqrt(2.5)


def test_the_widest_and_the_narrowest_pair_enclose_all_angles(study):
    analysis = study.columns[RGBW_12]
    angles = analysis.between_deg[np.triu_indices(4, k=1)]
    widest, narrowest = (
        channel_plane(analysis, f(analysis)) for f in (widest_pair, narrowest_pair)
    )
    assert widest.angle_deg == pytest.approx(angles.max(), abs=1e-9)
    assert narrowest.angle_deg == pytest.approx(angles.min(), abs=1e-9)


def test_a_plane_is_that_of_the_sensor_that_has_these_two_channels_only(study):
    whole = study.columns[RGBW_12]
    alone = with_channels(whole.sensor, ("G", "W"), name="alone")
    two = analyzed(whole.scene, alone, whole.exposure)
    plane = channel_plane(whole, ("G", "W"))
    assert plane.channels == ("G", "W")
    assert plane.axis.color == pytest.approx(two.color.mean[1])


def test_channels_that_span_no_plane_are_refused():
    bell = bell_qe((500.0,), (40.0,), (0.9,))
    with refused_input(subject="channels a and b"):
        plane_of(sensor_of(np.hstack([bell, 0.5 * bell])))


def test_a_channel_that_sees_nothing_is_refused():
    sensor = boxes((420, 480), (560, 620))
    dark = np.where(GRID.wavelength_nm < 500, 1.0, 0.0)
    scene = Scene(illuminant=equal_energy(GRID), level_lux=20.0, reflectance=dark)
    with refused_input(subject="channel b", value=0.0):
        channel_plane(analyzed(scene, sensor, EXPOSURE), ("a", "b"))


def test_unknown_channels_and_axes_are_refused(study):
    with refused_input(subject="channel of onyx-rgb-ircut", value="W"):
        channel_plane(study.columns[RGB_59], ("R", "W"))
    with refused_input(subject="axis", value="u"):
        channel_plane(study.columns[RGB_59], ("R", "G"), axis="u")
