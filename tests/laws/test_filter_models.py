"""Models of silicon, resins and IR-cut behave as the materials do."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from chromanoise.sensor import ir_cut, resin_filter, silicon_qe
from chromanoise.spectra import DEFAULT_GRID, Grid
from chromanoise.study import SENSOR_NAMES, sensor_named
from outcomes import refused_input

FINE = Grid.uniform(400, 1050, 1)


@given(st.floats(0.5, 20.0), st.floats(1.01, 10.0))
def test_deeper_silicon_collects_more_at_every_wavelength(depth_um, factor):
    shallow = silicon_qe(DEFAULT_GRID, depth_um=depth_um)
    deep = silicon_qe(DEFAULT_GRID, depth_um=factor * depth_um)
    assert (deep >= shallow).all()
    assert deep[-1] > shallow[-1]  # at 1050 nm silicon is nearly transparent


def test_silicon_is_not_continued_beyond_its_table():
    with refused_input(subject="grid", value=Grid.uniform(350, 700, 5)):
        silicon_qe(Grid.uniform(350, 700, 5), depth_um=4.0)


def test_half_the_light_passes_an_ir_cut_at_its_edge_and_none_far_beyond():
    cut = ir_cut(FINE, edge_nm=650.0, width_nm=8.0)
    assert cut[250] == pytest.approx(0.5)
    assert cut[0] == pytest.approx(1.0, abs=1e-12)
    assert cut[-1] == pytest.approx(0.0, abs=1e-12)
    assert (np.diff(cut) <= 0).all()


@given(st.floats(420, 560), st.floats(40, 150), st.floats(20, 200))
def test_a_resin_passes_its_band_blocks_beside_it_and_leaks_the_infrared(low, width, gap):
    high = low + width
    leak = min(high + gap + 120, 950)
    curve = resin_filter(
        FINE, low_nm=low, high_nm=high, leak_nm=leak, edge_nm=4.0, peak=0.9, leak=0.95, floor=0.02
    )
    at = FINE.wavelength_nm
    assert ((curve >= 0) & (curve <= 1)).all()
    assert curve[np.abs(at - (low + high) / 2).argmin()] == pytest.approx(0.9, abs=0.02)
    assert curve[np.abs(at - (high + leak) / 2).argmin()] < 0.1
    assert curve[-1] > 0.9


def test_no_catalog_sensor_exceeds_one_electron_per_photon():
    for name in SENSOR_NAMES:
        qe = sensor_named(name, DEFAULT_GRID).qe
        assert qe.max() <= 1
        assert qe.min() >= 0


def test_every_mosaic_shows_every_channel_of_its_sensor():
    for name in SENSOR_NAMES:
        sensor = sensor_named(name, DEFAULT_GRID)
        assert sensor.name == name
        if sensor.mosaic is not None:
            assert set(sensor.mosaic.names) == set(sensor.names)


def test_stacked_layers_together_collect_what_one_deep_diode_does():
    layers = sensor_named("model-three-layer", DEFAULT_GRID).qe.sum(axis=1)
    one = silicon_qe(DEFAULT_GRID, depth_um=4.0, dead_layer_um=0.0) * ir_cut(DEFAULT_GRID)
    np.testing.assert_allclose(layers, one, rtol=1e-12)


def test_deeper_layers_see_longer_waves():
    sensor = sensor_named("model-three-layer", DEFAULT_GRID)
    at = DEFAULT_GRID.wavelength_nm
    means = [np.average(at, weights=column) for column in sensor.qe.T]
    assert sensor.names == ("B", "G", "R")
    assert means == sorted(means)


def test_opening_a_filter_set_or_its_ir_cut_never_loses_electrons():
    narrow, wide = (sensor_named(n, DEFAULT_GRID).qe for n in ("model-rgb-ircut", "model-rgb"))
    assert (wide >= narrow).all()
    rgb, ryb = (sensor_named(n, DEFAULT_GRID) for n in ("model-rgb-ircut", "model-ryb-ircut"))
    assert ryb.qe[:, 1].sum() > rgb.qe[:, 1].sum()
