"""A characterized camera as the noise model of a sampler."""

from dataclasses import replace

import numpy as np
import pytest

import chromanoise as cn
from characterizations import BAYER, color, exact_plane
from chromanoise.apps.camera.measured_pixel import camera_noise
from outcomes import refused_input

UNKNOWN = ("full_well_e", "dark_current_e_per_s", "dsnu_e", "prnu", "column_noise_e")


def result(*, iso=100.0, **values):
    """Four planes of 5 e- of dark noise, of which 3 e- are row noise; nothing else is known."""
    usual = {"black_level_dn": 64.0, "row_noise_e": 3.0} | dict.fromkeys(UNKNOWN)
    planes = tuple(exact_plane(name, **usual | values) for name in ("R", "G1", "G2", "B"))
    return color(iso=iso, planes=planes)


def test_the_model_has_the_values_of_the_planes():
    camera = camera_noise([result(prnu=0.01, full_well_e=9000.0)])
    assert camera.names == ("R", "G1", "G2", "B")
    assert camera.mosaic == BAYER
    assert camera.top_code_dn == 4095
    assert (camera.gain_dn_per_e == 0.5).all()
    assert (camera.black_level_dn == 64).all()
    assert (camera.prnu, camera.full_well_e, camera.dsnu_e) == (0.01, 9000.0, 0.0)


def test_the_dark_variance_of_a_sample_is_that_of_the_measured_dark_noise():
    add_noise = cn.apps.training.sampler(camera_noise([result()]), quantize=False)
    assert add_noise(np.zeros((2, 2)), unit="electron").variance[0, 0] == pytest.approx(25.0)


def test_results_at_several_settings_are_interpolated():
    high = result(iso=400.0, gain_dn_per_e=2.0, dark_noise_e=13**0.5, row_noise_e=3.0)
    camera = camera_noise([result(), high])
    assert camera.at_iso(400).read_noise_e[0] == pytest.approx(2.0)
    middle = camera.at_iso(200)
    assert middle.read_noise_e[0] == pytest.approx((4 * 0.5 * 2 * 2.0) ** 0.5)


def test_each_setting_has_its_own_row_noise_and_dsnu_and_the_well_is_that_of_the_lowest():
    low = result(row_noise_e=1.22, dsnu_e=0.9, full_well_e=60_000.0)
    high = result(
        iso=6400.0, gain_dn_per_e=32.0, dark_noise_e=1.5, row_noise_e=0.32, dsnu_e=0.0,
        full_well_e=120.0,
    )  # fmt: skip
    for order in ([low, high], [high, low]):
        camera = camera_noise(order)
        for one, row_e, dsnu_e in ((low, 1.22, 0.9), (high, 0.32, 0.0)):
            at = camera.at_iso(one.iso)
            assert at.row_noise_e == pytest.approx(row_e, rel=1e-9)
            assert at.dsnu_e == pytest.approx(dsnu_e, abs=2e-3)
            dark_e = one.planes[0].dark_noise_e
            assert np.hypot(at.read_noise_e, at.row_noise_e) == pytest.approx(dark_e, rel=1e-9)
        assert camera.full_well_e == 60_000.0
    # in DN the logarithm is linear in that of the gain: at the middle the geometric mean
    middle = camera.at_iso((100 * 6400) ** 0.5)
    assert middle.row_noise_e == pytest.approx((1.22 * 0.5 * 0.32 * 32) ** 0.5 / 4.0)


def test_drawn_row_noise_is_that_of_the_setting():
    """By draws: the variance of the row means at ISO 6400."""
    high = result(iso=6400.0, gain_dn_per_e=32.0, dark_noise_e=1.0, row_noise_e=0.8)
    camera = camera_noise([result(row_noise_e=3.0), high])
    clean = np.zeros((256, 4000))
    add_noise = cn.apps.training.sampler(camera, quantize=False, seed=4)
    drawn = np.asarray(add_noise(clean, unit="electron", iso=6400).noisy)
    rows = drawn.mean(axis=1).var(ddof=1) - (1.0 - 0.64) / clean.shape[1]
    assert abs(rows / 0.64 - 1) < 5 * (2 / 255) ** 0.5


def test_missing_values_are_refused_by_name():
    with refused_input(subject="results"):
        camera_noise([])
    with refused_input(subject="iso", value=[100.0, 100.0]):
        camera_noise([result(), result()])
    with refused_input(subject="results", where="other"):
        camera_noise([result(), replace(result(iso=200.0), camera="Beta", source="other")])
    with refused_input(subject="dark_noise_e", where="plane R"):
        camera_noise([result(dark_noise_e=None)])
    with refused_input(subject="characterization of frames", setting="bits"):
        camera_noise([replace(result(), bits=None)])
