"""How fast the closed form answers: against sampling, and for a whole chart over the light.

Ratios in one run, medians of 5.
"""

import time
from collections.abc import Callable
from statistics import median

import numpy as np

from chromanoise.apps.paper.printed_numbers import RGBW_12, paper_study
from chromanoise.color import chart_training, colored, kernel_matrix, lmmse_over_light, nir_diverse
from chromanoise.metrics import snr_db
from chromanoise.noise import Exposure, expected_electrons, monte_carlo, with_noise
from chromanoise.sensor import Sensor
from chromanoise.spectra import DEFAULT_GRID, Scene, colorchecker, equal_energy
from chromanoise.study import SENSOR_NAMES, sensor_named

DRAWS = 1_000_000
LEVELS_LUX = np.geomspace(0.01, 1000, 200)
SENSORS = SENSOR_NAMES[:9]


def seconds(work: Callable[[], object], times: int = 5) -> float:
    """Median wall time of ``work`` after one call to warm up."""
    work()
    taken = []
    for _ in range(times):
        start = time.perf_counter()
        work()
        taken.append(time.perf_counter() - start)
    return median(taken)


def chart_snr(sensors: list[Sensor]) -> list[np.ndarray]:
    """SNR of Y of 24 patches at 200 levels, with the kernel and with LMMSE."""
    lamp = equal_energy(DEFAULT_GRID)
    chart = Scene(illuminant=lamp, level_lux=1.0, reflectance=colorchecker(DEFAULT_GRID).values.T)
    training, exposure = nir_diverse(chart_training(lamp)), Exposure(time_s=0.0119)
    snr = []
    for sensor in sensors:
        per_lux = expected_electrons(chart, sensor, exposure)
        mean_e = LEVELS_LUX[:, None, None] * per_lux
        kernel = kernel_matrix(sensor, exposure)
        snr.append(np.asarray(snr_db(colored(with_noise(mean_e, sensor), kernel))["Y"]))
        rows = lmmse_over_light(sensor, exposure, training, LEVELS_LUX)[:, 1]
        variance = mean_e + sensor.pixel.read_noise_e**2
        signal = np.einsum("lp,lkp->lk", rows, mean_e)
        noise = np.sqrt(np.einsum("lp,lkp->lk", rows**2, variance))
        snr.append(20 * np.log10(np.abs(signal) / noise))
    return snr


column = paper_study().columns[RGBW_12]
closed = seconds(lambda: snr_db(colored(with_noise(column.raw.mean, column.sensor), column.matrix)))
sampled = seconds(
    lambda: monte_carlo(
        column.raw.mean, column.sensor.pixel, column.matrix.matrix, draws=DRAWS, seed=0
    )
)
print(f"SNR of X, Y, Z in closed form against {DRAWS} draws: {sampled / closed:.0f} x")
cameras = [sensor_named(name, DEFAULT_GRID) for name in SENSORS]
whole = seconds(lambda: chart_snr(cameras))
print(f"24 patches x {len(cameras)} sensors x 200 levels x 2 matrices: {whole:.2f} s")
