"""A ColorChecker as a cube."""

import numpy as np

from chromanoise.scene.cube import Cube
from chromanoise.spectra import DEFAULT_GRID, colorchecker

PATCH_PX, GAP_PX = 64, 12
_GAP_REFLECTANCE = 0.04


def patch_corners() -> tuple[tuple[int, int], ...]:
    """Row and column of the upper left pixel of each patch, in the order of the chart."""
    pitch = PATCH_PX + GAP_PX
    return tuple((GAP_PX + (k // 6) * pitch, GAP_PX + (k % 6) * pitch) for k in range(24))


def checker_cube() -> Cube:
    """A ColorChecker with reflectances up to 1050 nm: 4 x 6 patches on a dark background."""
    chart = colorchecker(DEFAULT_GRID)
    pitch = PATCH_PX + GAP_PX
    shape = (4 * pitch + GAP_PX, 6 * pitch + GAP_PX, DEFAULT_GRID.n)
    stored = np.full(shape, _GAP_REFLECTANCE, dtype=np.float32)
    for (top, left), patch in zip(patch_corners(), chart.values.T, strict=True):
        stored[top : top + PATCH_PX, left : left + PATCH_PX] = patch
    return Cube(
        wavelength_nm=DEFAULT_GRID.wavelength_nm,
        stored=stored,
        source="builtin:checker",
        notes=chart.notes,
    )
