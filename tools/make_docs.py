"""Draw the pictures of README and docs anew from the library's own numbers."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from chromanoise.analysis import compared, crossover_sentence, crossovers, matrix_makers
from chromanoise.exposure import OperatingPoint
from chromanoise.figures import chromanoise_style, draw_color_errors, draw_comparison
from chromanoise.imaging import write_png
from chromanoise.paper import PaperStudy, paper_study
from chromanoise.paper.pictures import paper_pictures
from chromanoise.paper.study import RGB_12, RGBW_12
from chromanoise.spectra import DEFAULT_GRID, equal_energy

PICTURES = Path(__file__).parent.parent / "docs" / "pictures"
GAP_PX = 16
LEVELS_LUX = np.geomspace(0.01, 30, 71)


def main() -> None:
    """Write ``two-sensors.png`` and ``crossover.png`` under ``docs/pictures``."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    study = paper_study()
    write_two_sensors(study)
    write_crossover(study)


def write_two_sensors(study: PaperStudy) -> None:
    """RGB behind an IR-cut beside RGBW without, at the same light and time."""
    rgb, rgbw = paper_pictures(study)
    gap = np.full((rgb.srgb.shape[0], GAP_PX, 3), 255, dtype=np.uint8)
    write_png(PICTURES / "two-sensors.png", np.hstack([rgb.srgb, gap, rgbw.srgb]))


def write_crossover(study: PaperStudy) -> None:
    """Both sensors over the light level, with the kernel and with LMMSE."""
    lamp = equal_energy(DEFAULT_GRID)
    contestants = [
        OperatingPoint(
            sensor=study.columns[name].sensor,
            exposure=study.columns[name].exposure,
            illuminant=lamp,
            level_lux=10.0,
        )
        for name in (RGBW_12, RGB_12)
    ]
    makers = matrix_makers(["kernel", "lmmse"], "quanta")
    curves = compared(contestants, makers, LEVELS_LUX)
    crossed = crossovers(contestants, makers, curves)
    with chromanoise_style():
        figure = Figure(figsize=(7.5, 6.5), layout="constrained")
        above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
        draw_comparison(curves, above, crossovers=crossed).set_xlabel("")
        draw_color_errors(curves, below)
        figure.savefig(PICTURES / "crossover.png", dpi=110)
    for crossover in crossed:
        print(crossover_sentence(crossover))


if __name__ == "__main__":
    main()
