"""Time of the median distances of 276 pairs of patches: 9 sensors, 200 light levels.

    python benchmarks/separation.py

prints the least of five processor times per reading, for which less than a second is the target.
"""

import time

import numpy as np

import chromanoise as cn
from chromanoise.study import Analysis
from chromanoise.study.reading_quality import READINGS, median_distances

SENSORS = (
    "onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "onyx-rgbw-ircut", "model-rgb-ircut",
    "model-cmy-ircut", "model-rgbir", "model-rgbw", "model-rgb",
)  # fmt: skip
LEVELS_LUX = np.geomspace(0.1, 20.0, 200)
ROUNDS = 5


def seconds(reading: str, analyses: tuple[Analysis, ...]) -> float:
    """Processor time for all sensors and levels. [s]"""
    start = time.process_time()
    for one in analyses:
        median_distances(one.point, one.matrix, reading, level_lux=LEVELS_LUX)
    return time.process_time() - start


def main() -> None:
    """Print one row per reading."""
    analyses = cn.analyze(*SENSORS, lux=10, time_ms=5).analyses
    print("| reading | 276 pairs, 9 sensors, 200 levels |")
    print("|---|---|")
    for reading in READINGS:
        least = min(seconds(reading, analyses) for _ in range(ROUNDS))
        print(f"| {reading.replace('_', ' ')} | {least:.2f} s |")


if __name__ == "__main__":
    main()
