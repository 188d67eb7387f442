"""emva1288, the reference code of the camera standard: photons, photon transfer, thresholds.

Its analysis is fed with our exact moments, which it must turn back into what was put in, and with
our draws, which it must turn back within their own scatter.
"""

import numpy as np
import pytest

from chromanoise.base.rng import stream
from chromanoise.base.units import photons_per_joule
from chromanoise.metrics import light_for_snr, snr_db
from chromanoise.noise import (
    Exposure,
    Readout,
    expected_electrons,
    read_moments,
    sample_electrons,
    with_noise,
)
from chromanoise.sensor import Converter, Pixel, Sensor
from chromanoise.sensor.photon_transfer import photon_transfer_fit
from chromanoise.sensor.photon_transfer_regression import PhotonTransfer
from chromanoise.spectra import Grid, Illuminant, equal_energy, flat_field
from chromanoise.study import analyzed as of_white, pipeline_noise
from strategies import white_channel

NEEDS = "needs the package emva1288"
camera = pytest.importorskip("emva1288.camera.routines", reason=NEEDS)
virtual = pytest.importorskip("emva1288.camera.camera", reason=NEEDS)
points = pytest.importorskip("emva1288.camera.points_generator", reason=NEEDS)
data = pytest.importorskip("emva1288.process.data", reason=NEEDS)
results = pytest.importorskip("emva1288.process.results", reason=NEEDS)
routines = pytest.importorskip("emva1288.process.routines", reason=NEEDS)

GAIN = 0.5  # DN/e-
QE = 0.6
NOISE_E = 4.0
FULL_WELL_E = 10_000.0
OFFSET_DN = 50.0
PIXEL = Pixel(pitch_um=10.0, full_well_e=FULL_WELL_E, read_noise_e=NOISE_E)
STEP_E = 1.0 / GAIN
PHOTONS = np.linspace(350.0, 17_500.0, 50)  # 17,500 x 0.6 = 10,500 e-: beyond full well
SIDE = 64
REPEATS = 10


@pytest.fixture(autouse=True)
def _numpy_1_name(monkeypatch):
    # emva1288 1.0.2 still calls np.asfarray, which numpy 2 has dropped
    monkeypatch.setattr(np, "asfarray", lambda a: np.asarray(a, dtype=float), raising=False)


def analyzed(temporal):
    return results.Results1288({"temporal": temporal, "spatial": {}}, pixel_area=100.0)


def exact_photon_transfer():
    """Mean and variance in DN as our closed forms give them, at each photon count."""
    readout = Readout(full_well_e=FULL_WELL_E, step_e=STEP_E)
    bright = read_moments(QE * PHOTONS[:, None], read_noise_e=NOISE_E, readout=readout)
    dark = read_moments(np.zeros(1), read_noise_e=NOISE_E, readout=readout)
    same = np.ones(PHOTONS.size)
    return {
        "texp": 1e6 * same,
        "u_p": PHOTONS,
        "u_y": GAIN * bright.mean[:, 0] + OFFSET_DN,
        "s2_y": GAIN**2 * bright.variance[:, 0],
        "u_ydark": (GAIN * dark.mean[0] + OFFSET_DN) * same,
        "s2_ydark": GAIN**2 * dark.variance[0] * same,
    }


def picture(photons, *name):
    mean_e = np.full((SIDE * SIDE, 1), QE * photons)
    electrons = sample_electrons(mean_e, PIXEL, stream(1288, *name))
    held = np.minimum(electrons, FULL_WELL_E)
    return np.rint(GAIN * held + OFFSET_DN).astype(np.int64).reshape(SIDE, SIDE)


def drawn_photon_transfer(repeat):
    """Two pictures per photon count, summed by emva1288's own routines."""
    levels = (0.0, *PHOTONS)
    sums = {}
    for i, photons in enumerate(levels):
        pair = routines.get_int_imgs([picture(photons, repeat, i, n) for n in (0, 1)])
        sums[photons] = {
            "sum": float(pair["sum"].sum()),
            "pvar": float(pair["pvar"].sum()),
            "dmean": pair["dmean"],
        }
    dark, bright = (
        routines.get_int_imgs([picture(photons, repeat, 999, n) for n in (0, 1)])
        for photons in (0.0, PHOTONS[25])
    )
    return data.Data1288(
        {
            "width": SIDE,
            "height": SIDE,
            "temporal": {1e6: sums},
            "spatial": {1e6: {0.0: dark, PHOTONS[25]: bright}},
        }
    ).data["temporal"]


def line_at(wavelength_nm, grid):
    """All light in one step of the grid. [W m-2 nm-1 lx-1]"""
    power = np.where(grid.wavelength_nm == wavelength_nm, 1e-3, 0.0)
    return Illuminant(name="line", grid=grid, irradiance=power)


# photons


def test_photons_per_pixel_are_50_34_area_time_wavelength_irradiance():
    # EMVA Standard 1288, Release 4.0 Linear (2021): 50.34 A[um2] t[ms] lambda[um] E[uW/cm2]
    joule = 1e-12 * 1e-3 * 1e-2  # 1 um2, 1 ms, 1 uW/cm2
    photons = joule * photons_per_joule(np.array([1000.0]))[0]
    assert photons == pytest.approx(50.34, abs=5e-3)
    assert photons == pytest.approx(50.3412, abs=5e-5)


@pytest.mark.parametrize("wavelength_nm", [420.0, 550.0, 700.0])
@pytest.mark.parametrize("f_number", [1.8, 8.0])
def test_photons_behind_a_lens_are_those_of_its_camera(wavelength_nm, f_number):
    grid = Grid.uniform(400, 700, 10)
    counter = white_channel(1.0, grid=grid, pixel=PIXEL)
    exposure = Exposure(time_s=0.02, f_number=f_number, magnification=0.0)
    lamp = line_at(wavelength_nm, grid)
    own = expected_electrons(flat_field(lamp, level_lux=7.0), counter, exposure)[0]
    # it takes a radiance per meter of wavelength, over a band as wide as the wavelength itself
    scene_w_m2 = 7.0 * 1e-3 * grid.step_nm
    radiance = scene_w_m2 / np.pi / (wavelength_nm * 1e-9)
    theirs = camera.get_photons(0.02 * 1e9, radiance, 100.0, wavelength_nm, f_number)
    rounded = (6.63e-34 * 3.00e8) / (6.62607015e-34 * 299_792_458.0)  # its h and c
    assert own == pytest.approx(theirs * rounded, rel=1e-12)


# photon transfer of the closed forms


def test_its_analysis_of_our_exact_moments_gives_back_gain_efficiency_and_read_noise():
    found = analyzed(exact_photon_transfer())
    gain, percent, sigma = found.K, found.QE, found.sigma_d  # sigma without rounding, step^2 / 12
    assert (gain, percent, sigma) == pytest.approx((GAIN, 100 * QE, NOISE_E), rel=1e-9)


def test_its_saturation_lies_within_4_sigma_below_our_full_well():
    # it takes the photon count of the largest variance, on our grid of 210 e-
    found = analyzed(exact_photon_transfer())
    assert FULL_WELL_E - 4 * np.sqrt(FULL_WELL_E) < found.u_e_sat < FULL_WELL_E
    full = with_noise(np.array([found.u_e_sat]), single_channel(0.0))
    assert found.SNR_max_dB() == pytest.approx(float(snr_db(full)["W"]), abs=1e-9)


def test_its_threshold_is_our_snr_1_but_for_the_term_that_the_standard_leaves_out():
    # mu_e = 1/2 + sqrt(sigma^2 + 1/4); the standard writes 1/2 + sigma, less by up to 1/(8 sigma)
    found = analyzed(exact_photon_transfer())
    sigma = np.sqrt(NOISE_E**2 + STEP_E**2 / 12)
    own = float(light_for_snr(np.array([QE]), np.array([1.0]), snr=1, read_noise_e=sigma))
    assert 0.99 / (8 * sigma) < QE * (own - found.u_p_min) < 1 / (8 * sigma)
    dynamic_range = found.DR
    assert dynamic_range == pytest.approx(found.u_p_sat / own, rel=1e-2)


# photon transfer of its own virtual camera


def test_its_threshold_and_dynamic_range_are_those_of_an_iso():
    grid, converter = Grid.uniform(400, 1050, 5), Converter(bits=13, gain_e_per_dn=STEP_E)
    sensor = white_channel(QE, grid=grid, names=("G",), pixel=PIXEL, converter=converter)
    lamp = equal_energy(sensor.grid)
    analysis = of_white(flat_field(lamp, level_lux=1.0), sensor, Exposure(time_s=0.002))
    (iso,) = pipeline_noise(analysis).iso
    found = analyzed(exact_photon_transfer())
    assert FULL_WELL_E / 10 ** (iso.emva_dynamic_range_db[0] / 20) == pytest.approx(
        found.sigma_y_dark / GAIN + 0.5, rel=1e-6
    )
    at_full_well = FULL_WELL_E / (QE * found.u_p_sat) * found.DR  # its saturation is a bit lower
    fitted = found.K / GAIN * found.QE / (100 * QE)  # its gain and efficiency are fits
    assert 10 ** (iso.emva_dynamic_range_db[0] / 20) == pytest.approx(
        at_full_well / fitted, rel=1e-3
    )


def reference_run(exposure_ns, *, gain, bits, seed=1):
    """Mean and variance of two pictures per point that its camera takes at its own test points.

    Over exposure times, each with its dark, or over photons at one time.
    """
    own = virtual.Camera(width=80, height=60, K=gain, bit_depth=bits, seed=seed)
    own.exposure = own.exposure_min
    asked = points.PointsGenerator(own, exposure_fixed=exposure_ns, steps=40).points["temporal"]
    sums = {}
    for time_ns, radiances in asked.items():
        own.exposure, sums[time_ns] = time_ns, {}
        for radiance in radiances:
            pair = routines.get_int_imgs([own.grab(radiance).astype(np.int64) for _ in (0, 1)])
            sums[time_ns][float(np.mean(own.get_photons(radiance)))] = {
                "sum": float(pair["sum"].sum()),
                "pvar": float(pair["pvar"].sum()),
                "dmean": pair["dmean"],
            }
    reader = object.__new__(data.Data1288)  # without its spatial pictures
    reader.pixels = 80 * 60
    return reader._get_temporal(sums)


@pytest.mark.parametrize("exposure_ns", [None, 1_000_000])
@pytest.mark.parametrize(("gain", "bits"), [(0.1, 8), (0.5, 12)])
def test_the_evaluation_of_a_reference_run_equals_that_of_emva1288(exposure_ns, gain, bits):
    run = reference_run(exposure_ns, gain=gain, bits=bits)
    same = run["u_y"].size
    ours = photon_transfer_fit(
        PhotonTransfer(
            mean_dn=run["u_y"],
            variance_dn2=run["s2_y"],
            dark=np.zeros(same, dtype=bool),
            samples=np.full(same, 80.0 * 60),
            time_ms=1e-6 * run["texp"],
            dark_mean_dn=run["u_ydark"],
            dark_variance_dn2=run["s2_ydark"],
        )
    )
    theirs = analyzed(run)
    assert ours.gain_dn_per_e == pytest.approx(theirs.K, rel=1e-3)
    assert ours.read_noise_e == pytest.approx(theirs.sigma_d, rel=1e-3)
    # it takes response times photons at saturation, where clipping has begun; ours is the mean
    assert ours.full_well_e == pytest.approx(theirs.u_e_sat, rel=5e-3)
    assert ours.saturation_dn == run["u_y"][theirs.index_u_ysat]
    assert abs(ours.gain_dn_per_e - gain) < 5 * ours.gain_se + 0.01 * gain  # its gain is rounded


# photon transfer of draws


def test_its_analysis_of_our_draws_gives_back_gain_efficiency_and_read_noise():
    found = [analyzed(drawn_photon_transfer(repeat)) for repeat in range(REPEATS)]
    for name, put_in in (("K", GAIN), ("QE", 100 * QE), ("sigma_d", NOISE_E)):
        values = np.array([getattr(each, name) for each in found])
        error = values.std(ddof=1) / np.sqrt(REPEATS)
        assert error < 0.005 * put_in
        assert abs(values.mean() - put_in) < 5 * error, name


def test_snr_of_its_pictures_is_ours_at_every_photon_count_below_saturation():
    temporal = drawn_photon_transfer(REPEATS)
    mean_e = QE * PHOTONS
    below = mean_e < FULL_WELL_E - 6 * np.sqrt(FULL_WELL_E)
    signal = temporal["u_y"] - temporal["u_ydark"]
    seen = 20 * np.log10(signal[below] / np.sqrt(temporal["s2_y"][below]))
    raw = with_noise(
        QE * PHOTONS[below, None], single_channel(np.sqrt(NOISE_E**2 + STEP_E**2 / 12))
    )
    # a variance from the difference of two pictures of n pixels: relative error sqrt(2 / n)
    error_db = 20 / np.log(10) / np.sqrt(2 * SIDE**2)
    assert np.abs((seen - snr_db(raw)["W"]) / error_db).max() < 5


def single_channel(read_noise_e):
    grid = Grid.uniform(400, 700, 10)
    pixel = Pixel(pitch_um=10.0, full_well_e=FULL_WELL_E, read_noise_e=read_noise_e)
    return Sensor(name="W", grid=grid, qe=np.full((grid.n, 1), QE), names=("W",), pixel=pixel)
