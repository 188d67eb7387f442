"""Stabilized planes have unit noise and an unbiased inverse; baselines remove noise of flats."""

import sys

import numpy as np
import pytest

from chromanoise.base.rng import stream
from chromanoise.imaging.denoising import DENOISING, denoised_planes, stabilized, unstabilized
from chromanoise.imaging.denoising.methods import BASELINES
from noisy_planes import planes_with
from outcomes import refused_input

DRAWS = 40_000
LAWS = [(1.0, 1.0, 0.0), (10.0, 1.0, 0.0), (3.0, 1.0, 0.02), (1.0, 1.0, 0.05), (4.0, 3.0, 0.0)]
"""Read noise, slope and PRNU."""


def planes_of(values_e, *, read_noise_e, slope_e=1.0, **more):
    return planes_with(values_e, floor_e2=read_noise_e**2, slope_e=slope_e, **more)


def flat(mean_e, read_noise_e, slope_e, prnu, shape=(1, DRAWS)):
    """One plane of independent draws at one mean: pixels of different sensitivity."""
    rng = stream(3, int(mean_e), int(read_noise_e))
    light = mean_e * (1 + prnu * rng.standard_normal(shape))
    counts = slope_e * rng.poisson(np.maximum(light, 0) / slope_e)
    values = counts + read_noise_e * rng.standard_normal(shape)
    return planes_of(values[..., None], read_noise_e=read_noise_e, slope_e=slope_e, prnu=prnu)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("mean_e", [10, 100, 5000])
def test_stabilized_noise_has_unit_variance(law, mean_e):
    sd = stabilized(flat(mean_e, *law)).std()
    assert abs(sd - 1) < 0.025 + 5 / np.sqrt(2 * DRAWS)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("mean_e", [0, 1, 3, 30, 390, 410, 5000])
def test_the_inverse_of_the_mean_of_stabilized_values_is_the_mean(law, mean_e):
    planes = flat(mean_e, *law)
    stable = stabilized(planes)
    back = unstabilized(stable.mean(axis=(0, 1), keepdims=True), planes)[0, 0, 0]
    error = planes.values_e.std() / np.sqrt(DRAWS)
    # PRNU moves no mean either: the mean of the light is mean_e
    assert abs(back - mean_e) < 5 * error + 1e-4 * mean_e + 1e-3


def test_the_inverse_is_unbiased_where_prnu_is_the_largest_noise():
    planes = flat(390, 3.0, 1.0, 0.2)
    back = unstabilized(stabilized(planes).mean(axis=(0, 1), keepdims=True), planes)[0, 0, 0]
    assert abs(back - 390) < 5 * planes.values_e.std() / np.sqrt(DRAWS)


@pytest.mark.parametrize("read_noise_e", [0.0, 2.0])
def test_the_inverse_is_that_of_makitalo_and_foi(read_noise_e):
    """Their closed form (IEEE Trans. Image Process. 20 (2011) 2697, 22 (2013) 91)."""
    planes = planes_of(np.zeros((1, 1, 1)), read_noise_e=read_noise_e)
    d = np.linspace(5.0, 60.0, 50)
    root = np.sqrt(1.5)
    closed = d**2 / 4 + root / (4 * d) - 11 / (8 * d**2) + 5 * root / (8 * d**3) - 1 / 8
    zero = 2 * np.sqrt(3 / 8 + read_noise_e**2)
    ours = unstabilized((d - zero)[None, :, None], planes)[0, :, 0]
    np.testing.assert_allclose(ours, closed - read_noise_e**2, atol=0.03)


def test_values_of_one_law_do_not_depend_on_the_others():
    several = planes_of(np.linspace(-5, 900, 24).reshape(2, 4, 3), read_noise_e=3.0, prnu=0.01)
    alone = planes_of(several.values_e[..., 1:2], read_noise_e=3.0, prnu=0.01)
    np.testing.assert_array_equal(stabilized(several)[..., 1:2], stabilized(alone))


def test_a_plane_whose_noise_vanishes_in_the_dark_is_refused():
    planes = planes_of(np.ones((2, 2, 1)), read_noise_e=0.0, slope_e=0.0, prnu=0.1)
    with refused_input(subject="noise of plane R", value=0.0):
        stabilized(planes)


@pytest.mark.parametrize("method", [m for m in BASELINES if m.name != "none"], ids=lambda m: m.name)
@pytest.mark.parametrize("read_noise_e", [1.0, 10.0])
def test_baselines_remove_noise_of_a_flat_and_keep_its_mean(method, read_noise_e):
    mean_e = np.array([40.0, 90.0, 200.0])
    rng = stream(5)
    noisy = rng.poisson(mean_e, (32, 32, 3)) + read_noise_e * rng.standard_normal((32, 32, 3))
    prior_e2 = np.outer(mean_e, mean_e) / 4 + np.diag(mean_e)
    planes = planes_of(noisy, read_noise_e=read_noise_e, prior_e2=prior_e2, prior_mean_e=mean_e)
    clean = denoised_planes(planes, method)
    noise = np.sqrt(planes.variance_e2(mean_e))
    assert clean.dtype == np.float32
    assert (clean.std(axis=(0, 1)) < 0.4 * noise).all()
    assert (np.abs(clean.mean(axis=(0, 1)) - mean_e) < 0.1 * noise).all()


@pytest.mark.parametrize("method", BASELINES, ids=lambda m: m.name)
def test_a_strong_edge_stays_where_it_is(method):
    mean_e = np.broadcast_to(
        np.where(np.arange(32) < 13, 100.0, 4000.0)[:, None, None], (32, 32, 2)
    )
    noisy = stream(7).poisson(mean_e) + 3.0 * stream(8).standard_normal((32, 32, 2))
    planes = planes_of(noisy, read_noise_e=3.0, prior_mean_e=np.full(2, 2000.0))
    away = denoised_planes(planes, method) - mean_e
    noise = np.sqrt(planes.variance_e2(mean_e))
    assert np.sqrt(np.mean((away / noise) ** 2)) < 1.1


@pytest.mark.parametrize("name", [m.name for m in BASELINES if m.name != "none"])
def test_a_picture_that_a_package_cannot_process_is_refused(name):
    side = 11 if name.startswith("bm3d") else 1
    planes = planes_of(np.ones((side, 64, 2)), read_noise_e=1.0)
    with refused_input(subject="picture", value=(side, 64)):
        denoised_planes(planes, DENOISING[name])


@pytest.mark.parametrize(
    ("name", "module"), [("bm3d", "bm3d"), ("opencv", "cv2"), ("wavelets", "pywt")]
)
def test_an_absent_package_is_refused_with_the_extra_that_holds_it(monkeypatch, name, module):
    monkeypatch.setitem(sys.modules, module, None)
    planes = planes_of(np.ones((16, 16, 1)), read_noise_e=1.0)
    with refused_input(subject="denoise", value=name) as error:
        denoised_planes(planes, DENOISING[name])
    assert "chromanoise[denoise]" in str(error.value)
