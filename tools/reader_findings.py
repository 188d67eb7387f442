"""The tables of docs/reader_findings.md on the light below which a sensor without IR-cut is better.

    python tools/reader_findings.py

prints them: for an eye by SNR of Y with the LMMSE matrix, for a machine by the distances of the 276
pairs of ColorChecker patches in raw values (median and worst pair, at the same exposure time and at
the time at which each sensor reaches full well, with the probability of a right decision), and by
the information of the raw values.
"""

from typing import Any, get_args

import numpy as np

import chromanoise as cn
from chromanoise.noise import OperatingPoint
from chromanoise.study import compared, matrix_makers
from chromanoise.study.color_matrices import PRIORS
from chromanoise.study.reading_quality import (
    RAW,
    About,
    Separation,
    information_chain,
    separation_of,
)
from chromanoise.study.sweeps import QUANTITIES

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
    "machine, median": ("separation", "kernel"),
    "machine, median, no brightness": ("separation-without-brightness", "kernel"),
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


def separations(name: str, light: str, lux: float) -> tuple[Separation, Separation, Separation]:
    """Without IR-cut; with it at the same time; with it at the longer time at which it is full."""
    own: dict[str, Any] = {"illuminant": light, **SENSORS[name]}
    (bare,) = cn.analyze(name, lux=LAST_LUX, **own).points
    (cut,) = cn.analyze(name, lux=LAST_LUX, filter=IR_CUT, **own).points
    found = []
    cases: tuple[tuple[dict[str, Any], OperatingPoint], ...]
    cases = (({}, bare), ({"filter": IR_CUT}, bare), ({"filter": IR_CUT}, cut))
    for more, full in cases:
        time_ms = 1e3 * full.exposure.time_s
        (analysis,) = cn.analyze(name, lux=lux, time_ms=time_ms, **own, **more).analyses
        separation = separation_of(analysis)
        assert separation is not None  # nothing is full below 10 lx
        found.append(separation)
    without, one_time, own_time = found
    return without, one_time, own_time


def pair_rows(name: str, light: str) -> list[list[str]]:
    """Rows of the median and the worst pair: D_M at 10 lx, then probabilities of a right answer."""
    at_10 = [one.distance[RAW] for one in separations(name, light, LAST_LUX)]
    shares = [f"{100 * np.mean(other > at_10[0]):.0f} %" for other in at_10[1:]]
    right = [
        [one.probability[RAW] for one in separations(name, light, lux)[:2]]
        for lux in (1, 0.1, 0.01)
    ]
    rows = []
    for pair, statistic in (("median", np.median), ("worst", np.min)):
        found = [f"{statistic(one):#.3g}" for one in at_10]
        probabilities = [", ".join(f"{statistic(one):.2f}" for one in level) for level in right]
        rows.append(
            [name, pair, *found, *(shares if pair == "median" else ["", ""]), *probabilities]
        )
    return rows


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
    for light in LIGHTS:
        print(f"\nilluminant {light}\n")
        cut = ("D_M with IR-cut", "pairs better with IR-cut")
        times = ("same time", "longer time")
        heads = ["D_M without IR-cut", *(f"{head}, {time}" for head in cut for time in times)]
        heads += [f"correct at {lux} lx: without, with" for lux in ("1", "0.1", "0.01")]
        print("| sensor | pair | " + " | ".join(heads) + " |")
        print("|---" * (2 + len(heads)) + "|")
        for name in SENSORS:
            for row in pair_rows(name, light):
                print("| " + " | ".join(row) + " |", flush=True)
    print()
    print("| sensor | information about | " + " | ".join(PRIORS) + " |")
    print("|---" * (2 + len(PRIORS)) + "|")
    for name in SENSORS:
        for about in get_args(About):
            cells = information_row(name, about)
            print("| " + " | ".join([name, about, *cells]) + " |", flush=True)


if __name__ == "__main__":
    main()
