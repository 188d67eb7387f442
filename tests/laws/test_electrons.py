"""Expected electrons: linear in light, time and aperture, and blind to how one writes them."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.base.errors import InputError
from chromanoise.noise import (
    Exposure,
    band_weights,
    expected_electrons,
    measurement_vectors,
    saturated,
    saturating_exposure,
    time_to_saturation,
)
from chromanoise.sensor import Pixel, behind_filter, with_channels
from chromanoise.spectra import (
    DEFAULT_GRID,
    METRICS,
    Cube,
    Grid,
    Scene,
    cie_a,
    color_axes,
    equal_energy,
    flat_field,
    led,
    light,
)
from outcomes import refused_input
from strategies import EXPOSURE, GRID, reflectances, sensor_of, sensors, white_channel

A = cie_a(GRID)


def lit(rho, level_lux=10.0):
    return Scene(illuminant=A, level_lux=level_lux, reflectance=rho)


@given(sensors(), reflectances(), st.floats(0.1, 1e5), st.floats(1e-5, 10.0), st.floats(0.7, 32))
def test_electrons_grow_as_light_and_time_and_fall_as_the_f_number_squared(
    sensor, rho, lux, time_s, f_number
):
    one = expected_electrons(lit(rho, 1.0), sensor, Exposure(time_s=1.0, f_number=1.0))
    seen = expected_electrons(lit(rho, lux), sensor, Exposure(time_s=time_s, f_number=f_number))
    assert seen == pytest.approx(one * lux * time_s / f_number**2, rel=1e-12)


@given(sensors(), reflectances(), st.floats(0.5, 20.0))
def test_electrons_grow_as_the_area_of_the_pixel(sensor, rho, pitch_um):
    def with_pitch(pitch):
        pixel = Pixel(pitch_um=pitch, full_well_e=1e4, read_noise_e=1.0)
        return sensor_of(sensor.qe, pixel=pixel)

    one, seen = (
        expected_electrons(lit(rho), with_pitch(pitch), EXPOSURE) for pitch in (1.0, pitch_um)
    )
    assert seen == pytest.approx(one * pitch_um**2, rel=1e-12)


@given(sensors(), reflectances(), reflectances())
def test_the_order_of_filters_does_not_matter(sensor, first, second):
    one_way = behind_filter(behind_filter(sensor, first, name="1"), second, name="12")
    other_way = behind_filter(behind_filter(sensor, second, name="2"), first, name="21")
    white = lit(np.ones(GRID.n))
    seen = expected_electrons(white, one_way, EXPOSURE)
    assert seen == pytest.approx(expected_electrons(white, other_way, EXPOSURE), rel=1e-12)
    # a filter before the sensor is a filter before the scene
    colored_scene = lit(first * second)
    assert seen == pytest.approx(expected_electrons(colored_scene, sensor, EXPOSURE), rel=1e-12)


def test_a_filter_of_one_half_halves_the_electrons():
    white, sensor = lit(np.ones(GRID.n)), white_channel()
    grey = behind_filter(sensor, np.full(GRID.n, 0.5), name="grey", note="a grey filter")
    assert expected_electrons(white, grey, EXPOSURE) == pytest.approx(
        expected_electrons(white, sensor, EXPOSURE) / 2, rel=1e-15
    )
    assert grey.notes == ("a grey filter",)
    assert grey.pixel is sensor.pixel


@given(st.data(), sensors(min_channels=2), reflectances())
def test_chosen_channels_keep_their_electrons_in_the_chosen_order(data, sensor, rho):
    names = data.draw(st.lists(st.sampled_from(sensor.names), min_size=1, unique=True))
    all_e = dict(zip(sensor.names, expected_electrons(lit(rho), sensor, EXPOSURE), strict=True))
    chosen = expected_electrons(lit(rho), with_channels(sensor, names, name="few"), EXPOSURE)
    assert list(chosen) == pytest.approx([all_e[name] for name in names], rel=1e-12)


@given(sensors(), reflectances())
def test_both_metrics_tell_the_same_electrons_and_the_same_color(sensor, rho):
    scene = lit(rho)
    wanted_e = expected_electrons(scene, sensor, EXPOSURE)
    colors = []
    for metric in METRICS:
        seen_e = light(scene, metric) @ measurement_vectors(sensor, EXPOSURE, metric)
        assert seen_e == pytest.approx(wanted_e, rel=1e-12, abs=1e-12)
        colors.append(light(scene, metric) @ color_axes(GRID, metric))
    assert colors[0] == pytest.approx(colors[1], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("metric", METRICS)
def test_y_of_a_perfect_white_is_its_illuminance(metric):
    grid = Grid.uniform(360, 830, 1)  # where the CIE defines a lumen
    white = flat_field(cie_a(grid), level_lux=123.0)
    assert (light(white, metric) @ color_axes(grid, metric))[1] == pytest.approx(123.0, rel=1e-9)


@pytest.mark.parametrize("step_nm", [1, 5, 10])
@pytest.mark.parametrize("lamp", [equal_energy, cie_a])
def test_y_of_a_white_under_a_smooth_lamp_is_its_illuminance_on_any_grid(lamp, step_nm):
    grid = Grid.uniform(400, 700, step_nm)
    white = flat_field(lamp(grid), level_lux=100.0)
    assert (light(white, "energy") @ color_axes(grid, "energy"))[1] == pytest.approx(100, rel=2e-3)


@pytest.mark.parametrize(("peak_nm", "width_nm"), [(552, 1), (555, 1), (530, 5)])
def test_a_lamp_too_narrow_for_its_grid_is_refused_or_keeps_its_illuminance(peak_nm, width_nm):
    try:
        lamp = led(DEFAULT_GRID, float(peak_nm), float(width_nm))
    except InputError:
        return
    white = flat_field(lamp, level_lux=100.0)
    seen = light(white, "energy") @ color_axes(DEFAULT_GRID, "energy")
    assert seen[1] == pytest.approx(100.0, rel=0.01)


@given(sensors(), reflectances(), reflectances())
def test_a_picture_of_points_has_the_electrons_of_its_points(sensor, first, second):
    together = expected_electrons(lit(np.stack([[first], [second]])), sensor, EXPOSURE)
    assert together.shape == (2, 1, len(sensor.names))
    for i, rho in enumerate((first, second)):
        assert together[i, 0] == pytest.approx(
            expected_electrons(lit(rho), sensor, EXPOSURE), rel=1e-12, abs=1e-12
        )


@given(sensors(), reflectances(), st.floats(0.01, 1.0), st.floats(1.0, 22.0))
def test_time_to_saturation_brings_the_brightest_channel_to_its_share(sensor, rho, share, f_number):
    scene = lit(0.05 + 0.95 * rho)
    time_s = time_to_saturation(scene, sensor, f_number=f_number, share=share)
    seen = expected_electrons(scene, sensor, Exposure(time_s=time_s, f_number=f_number))
    assert seen.max() == pytest.approx(share * sensor.pixel.full_well_e, rel=1e-12)
    assert not saturated(seen, sensor).any()


def test_the_brightest_point_decides_the_time_to_saturation():
    sensor = white_channel()
    grey, white = np.full(GRID.n, 0.25), np.ones(GRID.n)
    both = time_to_saturation(lit(np.stack([grey, white])), sensor)
    assert both == pytest.approx(time_to_saturation(lit(white), sensor), rel=1e-12)
    assert both == pytest.approx(time_to_saturation(lit(grey), sensor) / 4, rel=1e-12)


def test_the_saturating_exposure_holds_its_time_and_aperture():
    scene, sensor = lit(np.ones(GRID.n)), white_channel()
    exposure = saturating_exposure(scene, sensor, f_number=2.8, share=0.5)
    assert exposure.time_s == time_to_saturation(scene, sensor, f_number=2.8, share=0.5)
    assert exposure.f_number == 2.8


def test_full_well_itself_is_not_saturated_and_one_electron_more_is():
    seen = np.array([9_999.0, 10_000.0, 10_001.0])
    assert list(saturated(seen, white_channel())) == [False, False, True]


@given(sensors(), st.floats(0.0, 0.4), st.floats(0.0, 0.5))
def test_a_cube_sampled_elsewhere_has_the_electrons_of_the_line_it_samples(sensor, low, rise):
    # a reflectance that is a straight line over wavelength loses nothing to interpolation
    def line(at_nm):
        return low + rise * (at_nm - 380.0) / 340.0

    bands = np.array([380.0, 433.0, 500.5, 641.0, 720.0])
    cube = Cube(wavelength_nm=bands, stored=line(bands)[None, None, :], source="a line")
    weights, notes = band_weights(cube, flat_field(A, level_lux=10.0), sensor, EXPOSURE)
    wanted = expected_electrons(lit(line(GRID.wavelength_nm)), sensor, EXPOSURE)
    assert line(bands) @ weights == pytest.approx(wanted, rel=1e-10)
    assert notes == ()


def test_stored_integers_are_scaled_to_reflectance():
    from chromanoise.spectra.scene import reflectance_rows

    cube = Cube(
        wavelength_nm=np.array([400.0, 700.0]),
        stored=np.array([[[0, 5000]], [[10_000, 2500]]], dtype=np.uint16),
        scale=1e-4,
        source="counts",
    )
    assert reflectance_rows(cube, 1, 2) == pytest.approx(np.array([[[1.0, 0.25]]]), rel=1e-12)


@pytest.mark.parametrize("f_number", [0.0, 0.1, 0.499, 2e6, float("nan")])
def test_no_lens_has_an_f_number_below_one_half(f_number):
    with refused_input(subject="f_number"):
        Exposure(time_s=1.0, f_number=f_number)
    assert Exposure(time_s=1.0, f_number=0.5).f_number == 0.5
