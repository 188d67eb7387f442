"""Candidates per second of a design: compiled blocks against numpy's batched einsum, in one run.

    python benchmarks/design.py

66 wavelengths, 4 channels, the 24 patches of the ColorChecker, mean CIEDE2000 and SNR of Y with
the kernel matrix, float64. Rounds alternate; the table has the medians and their ratios. Time on
one thread is processor time, which other jobs change less. numpy works in parts that fit the cache,
spread over as many threads: once with einsum as it is, once with ``optimize=True``, by BLAS.
"""

import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from chromanoise.apps.design.evaluation import DesignScene, Objectives, SceneArrays, scene_arrays
from chromanoise.apps.design.parameters import Candidates
from chromanoise.noise import Exposure, OperatingPoint
from chromanoise.spectra import Grid, equal_energy
from chromanoise.study import sensor_named

GRID = Grid.uniform(400, 1050, 10)
MANY, FILTERS, ROUNDS, AT_ONCE = 16_384, 200, 5, 256
OBJECTIVES = ("ciede2000", "snr_y_db")
READ_NOISE_E = 10.0


def bells(rng: np.random.Generator, count: int) -> np.ndarray:
    """Curves of ``count`` sensors with a blue, a green, a red and a broad channel (m, 4, n)."""
    low, high = np.array([[440, 520, 590, 500], [480, 560, 640, 600]])
    center = rng.uniform(low, high, (count, 4))[..., None]
    width = (rng.uniform(25, 45, (count, 4)) * [1, 1, 1, 3])[..., None]
    return 0.5 * np.exp(-0.5 * ((GRID.wavelength_nm - center) / width) ** 2)


def by_einsum(qe: np.ndarray, of: SceneArrays, threads: int, blas: bool) -> np.ndarray:
    """The same two objectives (m, 2) in numpy, in parts that fit the cache."""
    parts = np.array_split(qe, max(1, len(qe) // AT_ONCE))
    if threads == 1:
        return np.concatenate([_einsum(part, of, blas) for part in parts])
    with ThreadPoolExecutor(threads) as pool:
        return np.concatenate(list(pool.map(lambda part: _einsum(part, of, blas), parts)))


def _einsum(qe: np.ndarray, of: SceneArrays, blas: bool) -> np.ndarray:
    f = qe * of.basis[:, None]
    seen = np.einsum("kn,mnp->mkp", np.vstack([of.white_e, of.chart_e]), qe, optimize=blas)
    gram = np.einsum("mnp,mnq->mpq", f, f, optimize=blas)
    cross = np.einsum("nc,mnp->mcp", of.axes, f, optimize=blas)
    matrix = np.swapaxes(np.linalg.solve(gram, np.swapaxes(cross, 1, 2)), 1, 2)
    xyz = np.einsum("mcp,mkp->mkc", matrix, seen, optimize=blas)
    noise = np.einsum("mp,mp->m", matrix[:, 1] ** 2, seen[:, 0] + READ_NOISE_E**2)
    snr_db = 10 * np.log10(xyz[:, 0, 1] ** 2 / noise)
    lab = _lab(xyz[:, 1:] / xyz[:, :1])
    return np.stack([_ciede2000(of.chart_lab, lab).mean(axis=-1), snr_db], axis=1)


def _lab(t: np.ndarray) -> np.ndarray:
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t * (841 / 108) + 4 / 29)
    x, y, z = f[..., 0], f[..., 1], f[..., 2]
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def _ciede2000(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    (l1, a1, b1), (l2, a2, b2) = np.moveaxis(first, -1, 0), np.moveaxis(second, -1, 0)
    seven = ((np.hypot(a1, b1) + np.hypot(a2, b2)) / 2) ** 7
    stretch = 1.5 - 0.5 * np.sqrt(seven / (seven + 25.0**7))
    a1, a2 = a1 * stretch, a2 * stretch
    c1, c2 = np.hypot(a1, b1), np.hypot(a2, b2)
    h1, h2 = np.arctan2(b1, a1) % (2 * np.pi), np.arctan2(b2, a2) % (2 * np.pi)
    apart = h2 - h1
    apart -= 2 * np.pi * np.rint(apart / (2 * np.pi))
    hue = (h1 + apart / 2) % (2 * np.pi)
    chroma, lightness = (c1 + c2) / 2, ((l1 + l2) / 2 - 50) ** 2
    t = (
        1 - 0.17 * np.cos(hue - np.pi / 6) + 0.24 * np.cos(2 * hue)
        + 0.32 * np.cos(3 * hue + np.pi / 30) - 0.2 * np.cos(4 * hue - 0.35 * np.pi)
    )  # fmt: skip
    turn = np.pi / 3 * np.exp(-(((np.degrees(hue) - 275) / 25) ** 2))
    seven = chroma**7
    rotation = -2 * np.sqrt(seven / (seven + 25.0**7)) * np.sin(turn)
    dl = (l2 - l1) / (1 + 0.015 * lightness / np.sqrt(20 + lightness))
    dc = (c2 - c1) / (1 + 0.045 * chroma)
    dh = 2 * np.sqrt(c1 * c2) * np.sin(apart / 2) / (1 + 0.015 * chroma * t)
    return np.sqrt(np.maximum(dl**2 + dc**2 + dh**2 + rotation * dc * dh, 0))


def medians(
    works: dict[str, Callable[[], object]], clock: Callable[[], float]
) -> dict[str, tuple[float, float]]:
    """Median and least time of each in alternating rounds. [us per candidate]"""
    found: dict[str, list[float]] = {name: [] for name in works}
    for _ in range(ROUNDS + 1):  # the first warms up
        for name, work in works.items():
            start = clock()
            work()
            found[name].append(1e6 * (clock() - start) / MANY)
    return {name: (float(np.median(t[1:])), min(t[1:])) for name, t in found.items()}


def main() -> None:
    """Print a table for one and for two threads."""
    rng = np.random.default_rng(1)
    qe = np.moveaxis(bells(rng, MANY), 1, 2)
    library = bells(rng, FILTERS // 4).reshape(FILTERS, GRID.n).T
    choices = 4 * rng.integers(0, FILTERS // 4, (MANY, 4)) + np.arange(4)
    point = OperatingPoint(
        sensor=sensor_named("onyx-rgbw", GRID),
        exposure=Exposure(time_s=0.002),
        illuminant=equal_energy(GRID),
        level_lux=10.0,
    )
    scene = DesignScene(point=point)
    arrays = scene_arrays(scene)
    plain = np.ascontiguousarray(qe)
    print("| threads | work | us per candidate, median | least | of einsum | of BLAS |")
    print("|---|---|---|---|---|---|")
    for threads, clock in ((1, time.process_time), (2, time.perf_counter)):
        evaluator = Objectives(scenes=(scene,), objectives=OBJECTIVES, threads=threads)
        found = evaluator.values(Candidates(qe=qe[:500]))
        np.testing.assert_allclose(by_einsum(plain[:500], arrays, threads, True), found, rtol=1e-6)
        works: dict[str, Callable[[], object]] = {
            "numpy's batched einsum": lambda n=threads: by_einsum(plain, arrays, n, False),
            "the same by BLAS": lambda n=threads: by_einsum(plain, arrays, n, True),
            "candidates": lambda e=evaluator: e.values(Candidates(qe=qe)),
            "choices from a library": lambda e=evaluator: e.values_of_choices(choices, library),
        }
        times = medians(works, clock)
        einsum_us, blas_us = (times[name][0] for name in list(times)[:2])
        for name, (median, least) in times.items():
            ratios = f"{einsum_us / median:.1f} times | {blas_us / median:.1f} times"
            print(f"| {threads} | {name} | {median:.2f} | {least:.2f} | {ratios} |")
    print(f"\nLoad average {os.getloadavg()[0]:.1f}.")


if __name__ == "__main__":
    main()
