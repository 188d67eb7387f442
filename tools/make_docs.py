"""Draw the pictures of README and docs anew from the library's own numbers."""

from pathlib import Path

import numpy as np

from chromanoise.imaging import write_png
from chromanoise.study import paper_study
from chromanoise.study.pictures import paper_pictures

PICTURES = Path(__file__).parent.parent / "docs" / "pictures"
GAP_PX = 16


def main() -> None:
    """Write ``docs/pictures/two-sensors.png``: RGB behind an IR-cut, RGBW without."""
    rgb, rgbw = paper_pictures(paper_study())
    gap = np.full((rgb.srgb.shape[0], GAP_PX, 3), 255, dtype=np.uint8)
    PICTURES.mkdir(parents=True, exist_ok=True)
    write_png(PICTURES / "two-sensors.png", np.hstack([rgb.srgb, gap, rgbw.srgb]))


if __name__ == "__main__":
    main()
