"""What the whole pixel costs: all noise sources and crosstalk, against shot and read noise alone.

24 patches, 9 sensors, 200 levels and 2 matrices. The two are timed in turn in one run, so that the
load of the machine falls on both; medians.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from statistics import median

import numpy as np

from chromanoise.color import chart_training, kernel_matrix, lmmse_over_light, nir_diverse
from chromanoise.noise import Exposure, OperatingPoint
from chromanoise.sensor import Sensor, crosstalk_of_share, with_crosstalk, with_pixel
from chromanoise.spectra import DEFAULT_GRID, colorchecker, equal_energy
from chromanoise.study import SENSOR_NAMES, sensor_named
from chromanoise.study.analysis import stages_at

LEVELS_LUX = np.geomspace(0.01, 1000, 200)
LAMP = equal_energy(DEFAULT_GRID)
CHART = colorchecker(DEFAULT_GRID).values.T
EXPOSURE = Exposure(time_s=0.0119)
ROUNDS = 9
WHOLE = {
    "dark_current_e_per_s": 100.0,
    "temperature_c": 40.0,
    "dsnu_e": 2.0,
    "prnu": 0.01,
    "row_noise_e": 1.0,
    "bits": 12,
}


def whole(sensor: Sensor, stage: str = "light") -> Sensor:
    """The sensor with every noise source, and with crosstalk where it has a mosaic."""
    noisy = with_pixel(sensor, WHOLE)
    if sensor.mosaic is None:
        return noisy
    mixing = crosstalk_of_share(0.1, sensor.mosaic, sensor.names)
    return with_crosstalk(noisy, replace(mixing, stage=stage))


def chart_snr_db(sensors: list[Sensor]) -> list[np.ndarray]:
    """SNR of X, Y and Z of 24 patches at 200 levels, with the kernel and with LMMSE."""
    training = nir_diverse(chart_training(LAMP))
    found = []
    for sensor in sensors:
        point = OperatingPoint(sensor=sensor, exposure=EXPOSURE, illuminant=LAMP, level_lux=1.0)
        kernel = kernel_matrix(sensor, EXPOSURE)
        rows = lmmse_over_light(sensor, EXPOSURE, training, LEVELS_LUX)
        for lux_per_e in (None, rows):
            stages = stages_at(
                point, kernel, level_lux=LEVELS_LUX, reflectance=CHART, lux_per_e=lux_per_e
            )
            found.append(stages.color_snr_db)
    return found


def seconds(work: Callable[[], object]) -> float:
    """Wall time of ``work``."""
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def main() -> None:
    """Print the median times and their ratios."""
    plain = [sensor_named(name, DEFAULT_GRID) for name in SENSOR_NAMES[:9]]
    cases = {
        "shot and read noise": plain,
        "whole pixel": [whole(sensor) for sensor in plain],
        "whole pixel, crosstalk after counting": [whole(sensor, "charge") for sensor in plain],
    }
    taken: dict[str, list[float]] = {name: [] for name in cases}
    for sensors in cases.values():
        chart_snr_db(sensors)
    for _ in range(ROUNDS):
        for name, sensors in cases.items():
            taken[name].append(seconds(lambda sensors=sensors: chart_snr_db(sensors)))
    base = taken["shot and read noise"]
    print(f"24 patches x {len(plain)} sensors x {LEVELS_LUX.size} levels x 2 matrices")
    for name, times in taken.items():
        ratio = median(t / b for t, b in zip(times, base, strict=True))
        print(f"{name}: {median(times):.3f} s, {ratio:.2f} times")


if __name__ == "__main__":
    main()
