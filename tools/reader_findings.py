"""The tables of docs/findings.md on the light below which a sensor without IR-cut is better.

    python tools/reader_findings.py

prints them: for an eye by SNR of Y with the LMMSE matrix, for a machine by the median distance of
the 276 pairs of ColorChecker patches in raw values, and by the information of the raw values.
"""

from typing import Any, get_args

import numpy as np

import chromanoise as cn
from chromanoise.analysis import compared, matrix_makers
from chromanoise.analysis.comparison.quantities import QUANTITIES
from chromanoise.analysis.information import About, information_chain
from chromanoise.analysis.priors import PRIORS
from chromanoise.exposure import OperatingPoint

IR_CUT = "ircut-650"
SENSORS: dict[str, dict[str, Any]] = {
    "onyx-rgbw": {},
    "onyx-rgb": {},
    "model-rgb": {},
    "model-rgbw": {},
    "model-rgbwir": {},
    "model-rgbir": {},
    "model-cmy": {},
    "model-ryb": {},
    "model-rccb": {},
    "mt9v024-rgbw": {},
    "mt9m131": {"beyond": "zero"},
    "ar0132at-rgbw": {"beyond": "zero", "peak_qe": 0.6},
}
READERS = {
    "eye": ("snr-y", "lmmse"),
    "machine": ("separation", "kernel"),
    "machine, no brightness": ("separation-without-brightness", "kernel"),
}
LIGHTS = ("E", "A")
FIRST_LUX, LAST_LUX = 0.01, 10.0
LEVELS = 41


def both(name: str, light: str) -> tuple[list[OperatingPoint], np.ndarray]:
    """The sensor without and with the IR-cut at one time, and levels up to its saturation [lx]."""
    own = SENSORS[name]
    (without,) = cn.analyze(name, illuminant=light, lux=LAST_LUX, **own).points
    time_ms = 1e3 * without.exposure.time_s
    (behind,) = cn.analyze(
        name, illuminant=light, lux=LAST_LUX, time_ms=time_ms, filter=IR_CUT, **own
    ).points
    return [without, behind], np.geomspace(FIRST_LUX, LAST_LUX, LEVELS)


def lead(better: np.ndarray, levels: np.ndarray) -> str:
    """Where the sensor without IR-cut is better: at every level, at none, or below which."""
    if better.all():
        return "every level"
    if not better.any():
        return "none"
    turns = np.flatnonzero(better[1:] != better[:-1])
    at = np.sqrt(levels[turns] * levels[turns + 1])
    return ("below " if better[0] else "above ") + ", ".join(f"{one:.2g}" for one in at)


def compared_row(name: str, light: str) -> list[str]:
    """One cell per reader."""
    points, levels = both(name, light)
    cells = []
    for quantity, method in READERS.values():
        makers = matrix_makers([method], "quanta")
        curves = compared(points, makers, levels, quantity=QUANTITIES[quantity])
        without, behind = (np.asarray(curve.value) for curve in curves)
        cells.append(lead(without >= behind, levels))
    return cells


def information_row(name: str, about: About) -> list[str]:
    """One cell per prior: where the raw values without IR-cut hold more bits."""
    points, levels = both(name, "E")
    cells = []
    for prior in PRIORS:
        without, behind = (
            information_chain(
                point, prior=prior, level_lux=levels, information_about=about, clipped=False
            ).bits["electrons"]
            for point in points
        )
        cells.append(lead(without >= behind, levels))
    return cells


def main() -> None:
    """Print the tables as Markdown."""
    heads = [f"{reader}, {light}" for light in LIGHTS for reader in READERS]
    print("| sensor | " + " | ".join(heads) + " |")
    print("|---" * (1 + len(heads)) + "|")
    for name in SENSORS:
        cells = [cell for light in LIGHTS for cell in compared_row(name, light)]
        print("| " + " | ".join([name, *cells]) + " |", flush=True)
    print()
    print("| sensor | information about | " + " | ".join(PRIORS) + " |")
    print("|---" * (2 + len(PRIORS)) + "|")
    for name in SENSORS:
        for about in get_args(About):
            cells = information_row(name, about)
            print("| " + " | ".join([name, about, *cells]) + " |", flush=True)


if __name__ == "__main__":
    main()
