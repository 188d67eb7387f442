"""The objectives of a design against a second evaluation in plain numpy, from the equations.

Only tables are shared: wavelengths, color-matching functions, reflectances and the light. No
function of the physics of the library is used.
"""

import numpy as np
import pytest

from chromanoise.apps.design.evaluation import DesignScene, Objectives
from chromanoise.apps.design.parameters import Candidates
from chromanoise.noise import Exposure
from chromanoise.spectra import DEFAULT_GRID, Grid, cie_1931, colorchecker, illuminant_named
from chromanoise.study import sensor_named
from chromanoise.study.color_matrices import training_named
from strategies import point_of

H, C = 6.62607015e-34, 299792458.0  # SI, exact
KM = 683.002
OBJECTIVES = (
    *("snr_y_db", "noise_delta_e", "total_delta_e", "delta_e", "vora"),
    *("least_separation", "mean_separation", "infrared_share"),
)
FULL = 10_000.0


def random_curves(count, channels, seed):
    """Bells of random place, width and height, some with an infrared leak."""
    draw = np.random.default_rng(seed)
    nm = DEFAULT_GRID.wavelength_nm[None, :, None]
    center, width, peak, leak = (
        draw.uniform(*ends, (count, 1, channels))
        for ends in ((430, 650), (20, 70), (0.3, 0.7), (0, 0.2))
    )
    bell = peak * np.exp(-0.5 * ((nm - center) / width) ** 2)
    return bell + leak / (1 + np.exp(-(nm - 780.0) / 15.0)) * (1 - bell)


def lab(xyz, white):
    """CIE 1976 with its linear toe, and its derivative (k 3 3)."""
    t = xyz / white
    toe = t <= (6 / 29) ** 3
    f = np.where(toe, t / (3 * (6 / 29) ** 2) + 4 / 29, np.cbrt(np.where(toe, 1.0, t)))
    slope = np.where(toe, 1 / (3 * (6 / 29) ** 2), np.where(toe, 1.0, t) ** (-2 / 3) / 3) / white
    rows = np.array([[0, 116, 0], [500, -500, 0], [0, 200, -200]], dtype=float)
    value = f @ rows.T - [16, 0, 0]
    return value, rows[None] * slope[:, None, :]


def twin(qe, *, lux, time_s, f_number, pitch_um, read_e, lmmse=None):
    """Every objective of one sensor by the equations."""
    nm = DEFAULT_GRID.wavelength_nm
    step_nm = nm[1] - nm[0]
    cmf = cie_1931(DEFAULT_GRID).values
    lux_of_one = KM * cie_1931(Grid.uniform(360, 830, 1)).values[:, 1].sum()
    power = np.full(nm.size, 1 / lux_of_one)  # illuminant E at 1 lx: 1.37017e-5 W m-2 nm-1
    photons = lux * power * nm * 1e-9 / (H * C)  # per s m2 nm
    area_m2 = (pitch_um * 1e-6) ** 2
    k = time_s * area_m2 * step_nm / (4 * f_number**2)
    rho = colorchecker(DEFAULT_GRID).values
    patches = np.column_stack([np.ones(nm.size), rho])
    mean = (k * photons[:, None] * patches).T @ qe  # white first
    variance = mean + read_e**2
    truth = KM * step_nm * lux * (power[:, None] * patches).T @ cmf
    # eq. 6 in photons: XYZ per photon is the CMF times the energy of a photon
    axes = KM * step_nm * cmf * (H * C / (nm * 1e-9))[:, None]
    f = k * qe
    if lmmse is None:
        matrix = axes.T @ f @ np.linalg.inv(f.T @ f)
    else:
        weight, spectra = lmmse
        e = (k * photons[:, None] * spectra).T @ qe
        xyz = KM * step_nm * lux * (power[:, None] * spectra).T @ cmf
        second = (e.T * weight) @ e + np.diag(weight @ e + read_e**2)
        matrix = np.linalg.solve(second, (e.T * weight) @ xyz).T
    seen = mean @ matrix.T
    noise = np.einsum("ij,kj,lj->kil", matrix, variance, matrix)
    snr_y_db = 20 * np.log10(seen[0, 1] / np.sqrt(noise[0, 1, 1]))
    value, slope = lab(seen[1:], seen[0])
    true, _ = lab(truth[1:], truth[0])
    spread = np.einsum("kij,kjl,kil->k", slope, noise[1:], slope)
    bias = np.linalg.norm(value - true, axis=1)
    q1, _ = np.linalg.qr(axes)
    q2, _ = np.linalg.qr(qe)
    first, second_ = np.triu_indices(24, 1)
    d = mean[1:][first] - mean[1:][second_]
    between = (variance[1:][first] + variance[1:][second_]) / 2
    distance = np.sqrt((d**2 / between).sum(axis=1))
    infrared = (photons[nm > 700] @ qe[nm > 700]) / (photons @ qe)
    color = 1.0 if (seen[0] > 0).all() else np.inf  # a white without a color has no CIELAB
    return {
        "snr_y_db": snr_y_db,
        "noise_delta_e": color * np.sqrt(spread.mean()),
        "total_delta_e": color * np.sqrt((bias**2 + spread).mean()),
        "delta_e": color * bias.mean(),
        "vora": np.linalg.norm(q1.T @ q2) ** 2 / 3,
        "least_separation": distance.min(),
        "mean_separation": distance.mean(),
        "infrared_share": infrared.max(),
    }


@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("matrix", ["kernel", "lmmse"])
@pytest.mark.parametrize("lux", [0.3, 10.0])
def test_objectives_agree_with_the_equations_in_plain_numpy(channels, matrix, lux):
    curves = random_curves(5, channels, seed=channels)
    settings = {"f_number": 2.0, "time_s": 0.006}
    light = illuminant_named("E")
    sensor = sensor_named("model-mono")
    point = point_of(sensor, lux, exposure=Exposure(**settings), illuminant=light)
    scene = DesignScene(point=point, matrix=matrix)
    found = Objectives(scenes=(scene,), objectives=OBJECTIVES).values(Candidates(qe=curves))
    pixel = point.sensor.pixel
    training = None
    if matrix == "lmmse":
        made = training_named(scene.prior, light, point.observer)
        weights = np.ones(len(made.names)) if made.weights is None else made.weights
        training = (weights / weights.sum(), made.reflectance.T)
    for row, qe in zip(found, curves, strict=True):
        wanted = twin(
            qe,
            lux=lux,
            pitch_um=pixel.pitch_um,
            read_e=pixel.read_noise_e,
            lmmse=training,
            **settings,
        )
        assert dict(zip(OBJECTIVES, row, strict=True)) == pytest.approx(wanted, rel=1e-9)
