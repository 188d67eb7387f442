"""Every linear stage in closed form against Monte Carlo, for many sensors, dark and bright."""

import numpy as np
import pytest

from chromanoise.color import chart_training, kernel_matrix, lmmse, nir_diverse
from chromanoise.noise import (
    Exposure,
    Readout,
    clipped_measurement,
    expected_electrons,
    monte_carlo,
    with_noise,
)
from chromanoise.sensor import PAPER_PIXEL, Sensor
from chromanoise.spectra import DEFAULT_GRID, equal_energy, flat_field
from chromanoise.study import sensor_named

LAMP = equal_energy(DEFAULT_GRID)
AT = DEFAULT_GRID.wavelength_nm
LEVELS_LUX = (1000.0, 10.0, 0.1, 0.01)
EXPOSURE = Exposure(time_s=0.0119)
_HALF_HELD_E = 10_050.0  # just above the full well of 10,000: two thirds of the draws are held


def bands(count):
    centers = np.linspace(430, 1000, count)
    curves = [0.5 * np.exp(-(((AT - c) / (900 / count)) ** 2)) for c in centers]
    return toy(f"bands-{count}", curves)


def toy(name, curves):
    names = tuple(f"c{i}" for i in range(len(curves)))
    return Sensor(
        name=name, grid=DEFAULT_GRID, qe=np.stack(curves, 1), names=names, pixel=PAPER_PIXEL
    )


def deficient():
    curves = sensor_named("model-rgb-ircut", DEFAULT_GRID).qe.T
    return toy("deficient", [*curves, curves.mean(axis=0)])


NAMED = (
    "model-mono", "onyx-rgb-ircut", "onyx-rgbw", "model-cmy-ircut", "model-rgbir",
    "model-three-layer", "model-rgbwir",
)  # fmt: skip
SENSORS = [*(sensor_named(n, DEFAULT_GRID) for n in NAMED), bands(8), bands(16), deficient()]


def deviations(sensor, level_lux, clip, draws):
    """z of mean and standard deviation: raw, contravariant, kernel XYZ and LMMSE XYZ."""
    mean_e = expected_electrons(flat_field(LAMP, level_lux=level_lux), sensor, EXPOSURE)
    if clip and mean_e.max() > _HALF_HELD_E:  # further up every readout is the full well itself
        level_lux *= _HALF_HELD_E / mean_e.max()
        mean_e = mean_e * (_HALF_HELD_E / mean_e.max())
    kernel = kernel_matrix(sensor, EXPOSURE)
    training = nir_diverse(chart_training(LAMP))
    wiener = lmmse(sensor, EXPOSURE, training, level_lux=level_lux)
    rows = np.vstack([np.eye(mean_e.size), kernel.frame.inverse_gram, kernel.matrix, wiener.matrix])
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    full = Readout(black_e=0.0, full_well_e=sensor.pixel.full_well_e)
    raw = clipped_measurement(mean_e, sensor, full) if clip else with_noise(mean_e, sensor)
    mean, sd = rows @ raw.mean, np.sqrt(np.einsum("qp,p,qp->q", rows, raw.variance, rows))
    drawn = monte_carlo(mean_e, sensor.pixel, rows, draws=draws, seed=11, clip=clip)
    moves = sd > 1e-9 * np.abs(rows @ np.full(mean_e.size, sensor.pixel.full_well_e))
    return np.concatenate(
        [
            ((drawn.mean - mean) / drawn.mean_se)[moves],
            ((drawn.sd - sd) / drawn.sd_se)[moves],
        ]
    )


CASES = [(s, level) for s in SENSORS for level in LEVELS_LUX]
IDS = [f"{s.name}-{level:g}lx" for s, level in CASES]


@pytest.mark.parametrize("clip", [False, True], ids=["unclipped", "clipped"])
@pytest.mark.parametrize(("sensor", "level_lux"), CASES, ids=IDS)
def test_closed_form_agrees_with_sampling(sensor, level_lux, clip):
    assert np.abs(deviations(sensor, level_lux, clip, 5_000)).max() < 5


@pytest.mark.evidence
@pytest.mark.parametrize("clip", [False, True], ids=["unclipped", "clipped"])
@pytest.mark.parametrize(("sensor", "level_lux"), CASES, ids=IDS)
def test_closed_form_agrees_with_ten_million_draws(sensor, level_lux, clip):
    assert np.abs(deviations(sensor, level_lux, clip, 10_000_000)).max() < 5
