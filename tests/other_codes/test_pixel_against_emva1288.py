"""Total SNR, dynamic range and PRNU of the package emva1288 against the closed form of a pixel.

Its evaluation gets exact means and variances of our closed form, and its plot of the SNR is read
back from a stand-in for the axes: "Theoretical" is the temporal SNR of EMVA 1288, Release 4.0
Linear (2021), "Total SNR" has DSNU and PRNU. Its virtual camera is drawn as well.
"""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.metrics import light_for_snr, snr_db
from chromanoise.noise import Exposure, noise_sources, saturated, with_noise
from chromanoise.sensor import Converter, Pixel
from chromanoise.spectra import Grid
from strategies import white_channel

NEEDS = "needs the package emva1288"
plotting = pytest.importorskip("emva1288.process.plotting", reason=NEEDS)
results = pytest.importorskip("emva1288.process.results", reason=NEEDS)
virtual = pytest.importorskip("emva1288.camera.camera", reason=NEEDS)

QE, GAIN, TIME_S = 0.55, 0.25, 0.02
FULL_WELL_E = 20_000.0
EXPOSURE = Exposure(time_s=TIME_S)
GRID = Grid.uniform(400, 700, 10)
PHOTONS = np.linspace(400.0, FULL_WELL_E / QE, 60)
FRAMES = 16  # in its spatial part
PIXELS = [
    {"read_noise_e": 7.0, "prnu": 0.01, "dsnu_e": 3.0},
    {"read_noise_e": 2.0, "prnu": 0.004, "dsnu_e": 12.0, "dark_current_e_per_s": 500.0},
    {
        "read_noise_e": 5.0, "prnu": 0.03, "dsnu_e": 1.0, "row_noise_e": 4.0,
        "dark_current_e_per_s": 300.0, "temperature_c": 45.0, "dark_doubling_k": 8.0,
    },
]  # fmt: skip


@pytest.fixture(autouse=True)
def _numpy_1_name(monkeypatch):
    # emva1288 1.0.2 still calls np.asfarray, which numpy 2 has dropped
    monkeypatch.setattr(np, "asfarray", lambda a: np.asarray(a, dtype=float), raising=False)


def sensor_of(**values):
    pixel = Pixel(pitch_um=5.0, full_well_e=FULL_WELL_E, **values)
    converter = Converter(gain_e_per_dn=1 / GAIN)
    return white_channel(QE, grid=GRID, pixel=pixel, converter=converter, name="W")


def variance_e2(sensor, photons, kind):
    mean = QE * np.atleast_1d(photons)[:, None]
    return with_noise(mean, sensor, EXPOSURE, kind=kind).variance[:, 0]


def evaluated(sensor):
    """What its evaluation finds in exact means and variances of one exposure time."""
    same = np.ones(PHOTONS.size)
    middle = float(PHOTONS[30])
    dark_dn2, bright_dn2 = (
        GAIN**2 * np.array([variance_e2(sensor, at, kind)[0] for kind in ("temporal", "total")])
        for at in (0.0, middle)
    )
    temporal = {
        "texp": 1e9 * TIME_S * same,
        "u_p": PHOTONS,
        "u_y": GAIN * QE * PHOTONS + 64.0,
        "s2_y": GAIN**2 * variance_e2(sensor, PHOTONS, "temporal"),
        "u_ydark": 64.0 * same,
        "s2_ydark": dark_dn2[0] * same,
    }
    spatial = {"L": FRAMES, "L_dark": FRAMES, "avg_mean": GAIN * QE * middle, "avg_mean_dark": 0.0}
    for postfix, (of_frame, of_reading) in (("", bright_dn2), ("_dark", dark_dn2)):
        spatial["var_mean" + postfix] = of_frame
        spatial["avg_var" + postfix] = of_reading - of_frame + of_frame / FRAMES
    found = results.Results1288(
        {"temporal": temporal, "spatial": spatial}, pixel_area=25.0, index_u_ysat=PHOTONS.size - 1
    )
    found.id = 1
    return found


class Lines:
    """Axes that keep what is plotted, by its label."""

    def __init__(self):
        self.lines = {}

    def plot(self, x, y, *, label, **_):
        self.lines[label] = np.asarray(x), np.asarray(y)

    def axvline(self, *_, **__):
        pass

    set_ylim = axvline


def plotted(found):
    plot = object.__new__(plotting.PlotSNR)
    plot.ax, plot.max_ideal, plot.set_legend = Lines(), [], lambda ax: None
    plot.plot(found)
    return plot.ax.lines


@pytest.mark.parametrize("values", PIXELS, ids=str)
def test_its_total_and_temporal_snr_are_ours(values):
    """SNR(mu_p) = QE mu_p / sqrt(sigma_d^2 + sigma_q^2/K^2 + QE mu_p [+ DSNU^2 + PRNU^2 ...])."""
    sensor = sensor_of(**values)
    lines = plotted(evaluated(sensor))
    for label, kind in (("Theoretical", "temporal"), ("Total SNR", "total")):
        photons, theirs = lines[label]
        ours = QE * photons / np.sqrt(variance_e2(sensor, photons, kind))
        assert theirs == pytest.approx(ours, rel=1e-6)
    assert lines["Total SNR"][1][-1] < 0.99 * lines["Theoretical"][1][-1]


@pytest.mark.parametrize("values", PIXELS, ids=str)
def test_its_prnu_and_dsnu_and_dark_noise_are_those_put_in(values):
    found = evaluated(sensor_of(**values))
    pixel = sensor_of(**values).pixel
    temporal_e2 = (
        pixel.read_noise_e**2 + pixel.row_noise_e**2 + pixel.dark_electrons_e(time_s=TIME_S)
    )
    assert pytest.approx(100 * pixel.prnu, rel=1e-6) == found.PRNU1288
    assert pytest.approx(pixel.dsnu_e, rel=1e-6) == found.DSNU1288
    assert found.sigma_d == pytest.approx(np.sqrt(temporal_e2), rel=1e-6)
    assert pytest.approx(GAIN, rel=1e-6) == found.K
    assert pytest.approx(100 * QE, rel=1e-6) == found.QE


@pytest.mark.parametrize("values", PIXELS, ids=str)
def test_the_limit_of_our_total_snr_is_one_over_its_prnu(values):
    found = evaluated(sensor_of(**values))
    bright = with_noise(np.array([1e13]), sensor_of(**values), EXPOSURE)
    assert 10 ** (float(snr_db(bright)["W"]) / 20) == pytest.approx(100 / found.PRNU1288, rel=1e-6)


@pytest.mark.parametrize("values", PIXELS, ids=str)
def test_its_dynamic_range_is_ours(values):
    """DR = mu_p.sat / mu_p.min with mu_p.min = (sigma_y.dark / K + 1/2) / QE.

    The standard's threshold is where SNR is 1 but for 1/(8 sigma) electrons at most.
    """
    sensor = sensor_of(**values)
    found = evaluated(sensor)
    dark_e = np.sqrt(variance_e2(sensor, 0.0, "temporal")[0])
    ours = PHOTONS[-1] / ((dark_e + 0.5) / QE)
    assert pytest.approx(ours, rel=1e-6) == found.DR
    threshold = light_for_snr(np.array([QE]), np.array([1.0]), snr=1, read_noise_e=dark_e)
    assert 0 < QE * (float(threshold) - found.u_p_min) <= 1 / (8 * dark_e)
    assert found.u_e_sat == pytest.approx(FULL_WELL_E, rel=1e-6)
    filled = np.array([FULL_WELL_E]) - sensor.pixel.dark_electrons_e(time_s=TIME_S)
    assert not saturated(filled, sensor, EXPOSURE).any()
    assert saturated(filled + 1, sensor, EXPOSURE).all()


# its virtual camera

SIDE = 300


@pytest.mark.parametrize("celsius", [30.0, 46.0])
@pytest.mark.parametrize("share", [0.0, 0.3])
def test_pictures_of_its_virtual_camera_scatter_as_the_closed_form_tells(celsius, share):
    """Dark current that doubles each 8 K above 30 C, PRNU and DSNU images, its own gain.

    It adds a uniform number before it rounds: two times 1/12 DN^2 in place of one.
    """
    rng = np.random.default_rng(12)
    prnu, dsnu_e, read_e, current = 0.02, 6.0, 5.0, 3000.0
    camera = virtual.Camera(
        width=SIDE, height=SIDE, bit_depth=14, K=0.5, K_min=0.5, K_max=0.5, K_steps=1, seed=4,
        temperature=celsius, temperature_ref=30.0, temperature_doubling=8.0,
        dark_current_ref=current, dark_signal_0=100.0, sigma2_dark_0=read_e**2, u_esat=1e6,
        exposure=100_000_000,
        dsnu=dsnu_e * rng.standard_normal((SIDE, SIDE)),
        prnu=1 + prnu * rng.standard_normal((SIDE, SIDE)),
    )  # fmt: skip
    radiance = share * camera.get_radiance_for(mean=6000.0) if share else 0.0
    pictures = np.stack([camera.grab(radiance).astype(float) for _ in range(8)])
    unit = camera._prnu
    camera._prnu = np.ones_like(unit)
    mean_e = float(np.mean(camera._u_e(radiance))) if share else 0.0
    sensor = sensor_of(
        read_noise_e=read_e,
        prnu=prnu,
        dsnu_e=dsnu_e,
        dark_current_e_per_s=current,
        dark_reference_c=30.0,
        dark_doubling_k=8.0,
        temperature_c=celsius,
    )
    sensor = replace(sensor, converter=Converter(gain_e_per_dn=2.0))
    exposure = Exposure(time_s=0.1)
    noise = noise_sources(sensor, exposure)
    assert noise.dark_e == pytest.approx(camera._u_therm())
    values = {
        kind: 1 / 12
        + 0.25 * float(with_noise(np.array([mean_e]), sensor, exposure, kind=kind).variance[0])
        for kind in ("temporal", "total")
    }
    temporal = pictures.var(axis=0, ddof=1).mean()
    pixels, frames = SIDE**2, len(pictures)
    error = values["temporal"] * np.sqrt(2 / (pixels * (frames - 1)))
    assert abs(temporal - values["temporal"]) < 5 * error
    spatial = values["total"] - values["temporal"]
    total = ((pictures - pictures.mean()) ** 2).mean()
    error = np.sqrt(
        2 * spatial**2 / pixels + (2 * values["temporal"] ** 2 + 4 * spatial * values["temporal"])
        / pictures.size
    )  # fmt: skip
    assert abs(total - values["total"]) < 5 * error
    mean_error = np.sqrt(spatial / pixels + values["temporal"] / pictures.size)
    assert abs(pictures.mean() - 0.5 * (mean_e + noise.dark_e + 100.0)) < 5 * mean_error
