"""Tables and picture of denoising in docs: ``python tools/denoising_findings.py BENCH.json [PNG]``.

BENCH.json is the result of ``chromanoise denoise-bench --json BENCH.json``. Printed are SNR of Y of
a flat white before and after denoising, errors of the pictures of the paper's two sensors, and the
sharpness of edges. PNG shows the two sensors at three light levels, before and after.
"""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from chromanoise.apps.denoising_benchmark.benchmark import benchmark_camera, denoising_benchmark
from chromanoise.base.check import Array
from chromanoise.imaging import noisy_electrons
from chromanoise.imaging.denoising import DENOISING, denoised_electrons
from chromanoise.noise import expected_electrons, noise_sources, white_scene

OPEN, CUT = "onyx-rgbw", "onyx-rgb-ircut"
METHODS = ("none", "lmmse", "guided", "aggregate")
SIDE_PX = 256
CROP_PX = 200
MARGIN_PX = 32  # windows at the border hold fewer pixels

Cells = dict[tuple[str, str, float, str], dict[str, Any]]


def main(path: str) -> None:
    """Print all tables."""
    cells: Cells = {
        (cell["scene"], cell["sensor"], cell["lux"], cell["method"]): cell
        for cell in json.loads(Path(path).read_text("utf-8"))["cells"]
    }
    print("SNR of Y of a flat white [dB]\n")
    print("| lux | sensor | " + " | ".join(METHODS) + " |")
    print("|---:|---|" + "---:|" * len(METHODS))
    for lux in (10.0, 1.0, 0.1):
        for name in (OPEN, CUT):
            values = [f"{white_snr_db(name, lux, method):.1f}" for method in METHODS]
            print(f"| {lux:g} | {name} | " + " | ".join(values) + " |")
    for field, digits in (
        ("snr_y_db", 1),
        ("ciede2000_mean", 2),
        ("scielab_mean", 2),
        ("true_ciede2000_mean", 2),
    ):
        print(f"\n{field}\n\n{picture_table(cells, field, digits)}")
    print(f"\nedges: rise [px] (MTF50 [cycles/px])\n\n{edge_table(cells)}")


def white_snr_db(name: str, lux: float, method: str) -> float:
    """SNR of Y over a flat white after a method. [dB]"""
    camera = benchmark_camera(name, level_lux=lux)
    point = camera.point
    mean_e = expected_electrons(white_scene(point), point.sensor, point.exposure)
    flat = np.broadcast_to(mean_e, (SIDE_PX, SIDE_PX, mean_e.size)).astype(np.float32)
    noise = noise_sources(point.sensor, point.exposure)
    noisy = noisy_electrons(flat, read_noise_e=noise.pixel.read_noise_e, seed=1)
    values = denoised_electrons(noisy, point, DENOISING[method])
    inside: Array = values[MARGIN_PX:-MARGIN_PX, MARGIN_PX:-MARGIN_PX].astype(np.float64)
    y = inside @ camera.matrix.matrix[1]
    error = y - float(camera.matrix.matrix[1] @ mean_e)
    return float(20 * np.log10(y.mean() / np.sqrt(np.square(error).mean())))


def picture_table(cells: Cells, field: str, digits: int) -> str:
    """A value of both sensors for each scene and light, before and after denoising."""
    lines = [
        "| scene | lux | " + " | ".join(f"{n}, {m}" for m in METHODS for n in (OPEN, CUT)) + " |",
        "|---|---:|" + "---:|" * 2 * len(METHODS),
    ]
    for scene in dict.fromkeys(key[0] for key in cells):
        for lux in sorted({key[2] for key in cells}, reverse=True):
            values = [
                f"{cells[scene, name, lux, method][field]:.{digits}f}"
                for method in METHODS
                for name in (OPEN, CUT)
            ]
            lines.append(
                f"| {scene.removeprefix('builtin:')} | {lux:g} | " + " | ".join(values) + " |"
            )
    return "\n".join(lines)


def edge_table(cells: Cells) -> str:
    """Rise distance and MTF50 of the slanted edges, before and after denoising."""
    lines = [
        "| edge | lux | "
        + " | ".join(f"{n}, {m}" for m in METHODS[1:] for n in (OPEN, CUT))
        + " |",
        "|---|---:|" + "---:|" * 2 * (len(METHODS) - 1),
    ]
    scene = "builtin:slanted-edges"
    some = next(cell for key, cell in cells.items() if key[0] == scene)
    for edge in some["edges"]:
        for lux in sorted({key[2] for key in cells}, reverse=True):
            texts = []
            for method in METHODS[1:]:
                for name in (OPEN, CUT):
                    found = cells[scene, name, lux, method]["edges"][edge]
                    texts.append("–" if found is None else _sharpness(found))
            lines.append(f"| {edge} | {lux:g} | " + " | ".join(texts) + " |")
    return "\n".join(lines)


def _sharpness(edge: dict[str, float | None]) -> str:
    mtf50 = edge["mtf50_cy_px"]
    return f"{edge['rise_px']:.2f} ({'–' if mtf50 is None else f'{mtf50:.2f}'})"


def draw(path: str) -> None:
    """The pictures of both sensors at three light levels, before and after denoising."""
    import matplotlib.pyplot as plt

    shown, levels = ("none", "aggregate"), (10.0, 1.0, 0.1)
    cells = {
        (cell.sensor, cell.lux, cell.method): cell
        for cell in denoising_benchmark(
            ["builtin:foliage"], [OPEN, CUT], levels, shown, crop_px=CROP_PX
        )
    }
    figure, axes = plt.subplots(
        len(levels), 4, figsize=(9.6, 7.6), layout="constrained", squeeze=False
    )
    for row, lux in enumerate(levels):
        for column, (name, method) in enumerate((n, m) for n in (CUT, OPEN) for m in shown):
            cell, axis = cells[name, lux, method], axes[row, column]
            axis.imshow(cell.srgb, interpolation="nearest")
            axis.set(xticks=[], yticks=[])
            if row == 0:
                axis.set_title(f"{name}\n{'noisy' if method == 'none' else method}", fontsize=10)
            if column == 0:
                axis.set_ylabel(f"{lux:g} lx", fontsize=10)
            axis.set_xlabel(
                f"Y {cell.snr_y_db:.1f} dB, CIEDE2000 {cell.quality.ciede2000_mean:.1f}", fontsize=8
            )
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main(sys.argv[1])
    if len(sys.argv) > 2:
        draw(sys.argv[2])
