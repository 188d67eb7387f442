"""The tables of docs/findings.md on the light below which a sensor without IR-cut is better.

    python tools/reader_findings.py

prints them: for an eye by SNR of Y with the LMMSE matrix, for a machine by the median distance of
the 276 pairs of ColorChecker patches in raw values, and by the information of the raw values.
"""

from typing import Any

import numpy as np
from chromanoise.analysis.information import information_chain

import chromanoise as cn
from chromanoise.analysis.priors import PRIORS

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
FIRST_LUX = 0.01
LEVELS = 41


def time_and_light(name: str, light: str, **own: Any) -> tuple[float, float]:
    """One time [ms] for both sensors, and the level at which the brighter one is full [lx]."""
    result = cn.analyze(name, illuminant=light, lux=10.0, **own)
    return float(result.to_dict()["sensors"][0]["time_ms"]), 10.0


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
    own = SENSORS[name]
    time_ms, last = time_and_light(name, light, **own)
    cells = []
    for quantity, matrix in READERS.values():
        curves = []
        for extra in ({}, {"filter": IR_CUT}):
            found = cn.compare(
                name, quantity=quantity, matrix=matrix, vary="lux", first=FIRST_LUX, last=last,
                points=LEVELS, illuminant=light, time_ms=time_ms, **own, **extra,
            )  # fmt: skip
            (curve,) = found.curves
            curves.append((np.asarray(curve.at), np.asarray(curve.value)))
        (levels, without), (_, behind) = curves
        cells.append(lead(without >= behind, levels))
    return cells


def information_row(name: str, light: str, about: str) -> list[str]:
    """One cell per prior: where the raw values without IR-cut hold more bits."""
    own = SENSORS[name]
    time_ms, last = time_and_light(name, light, **own)
    levels = np.geomspace(FIRST_LUX, last, LEVELS)
    points = [
        cn.analyze(name, illuminant=light, lux=10.0, time_ms=time_ms, **own, **extra).points[0]
        for extra in ({}, {"filter": IR_CUT})
    ]
    cells = []
    for prior in PRIORS:
        without, behind = (
            information_chain(
                point, prior=prior, level_lux=levels, information_about=about, clipped=False
            )
            .steps[0]
            .bits
            for point in points
        )
        cells.append(lead(np.asarray(without >= behind), levels))
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
        for about in ("spectrum", "visible"):
            cells = information_row(name, "E", about)
            print("| " + " | ".join([name, about, *cells]) + " |", flush=True)


if __name__ == "__main__":
    main()
