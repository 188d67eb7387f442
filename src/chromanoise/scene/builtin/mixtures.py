"""Cubes of mixtures of a few reflectances, curves for these, and shapes that hide each other."""

from collections.abc import Callable

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Integer
from chromanoise.scene.cube import Cube
from chromanoise.spectra import DEFAULT_GRID

_DECIMALS = 6  # rounding hides the last bits, which depend on the BLAS kernel


def logistic(center_nm: float, width_nm: float) -> Float[Array, " n"]:
    """A step from 0 to 1 on the default grid: 1 / (1 + exp(-(wavelength - center) / width))."""
    return 1.0 / (1.0 + np.exp(-(DEFAULT_GRID.wavelength_nm - center_nm) / width_nm))


def gaussian(center_nm: float, sd_nm: float) -> Float[Array, " n"]:
    """A bump of height 1 on the default grid, with the standard deviation ``sd_nm``."""
    return np.exp(-0.5 * ((DEFAULT_GRID.wavelength_nm - center_nm) / sd_nm) ** 2)


def pixel_means(
    values: Float[Array, "labels k"], label: Integer[Array, "sh sw"], *, subpixels: int
) -> Float[Array, "h w k"]:
    """Mean of ``values[label]`` over the ``subpixels`` x ``subpixels`` samples of each pixel."""
    first = [label[i::subpixels, j::subpixels] for i in range(subpixels) for j in range(subpixels)]
    return sum(values[one] for one in first) / np.float32(subpixels**2)


def mixed_cube(
    shares: Float[Array, "h w k"],
    reflectances: Float[Array, "k n"],
    *,
    source: str,
    notes: tuple[str, ...],
) -> Cube:
    """The cube on the default grid whose pixels are ``shares @ reflectances``.

    Parameters
    ----------
    shares
        Share of each reflectance in each pixel, times the gain of the pixel.
    reflectances
        Reflectances on the default grid.
    source, notes
        As in `Cube`.

    Returns
    -------
    Cube
        Its values are float32, rounded to 6 decimals, so they are the same on all machines.
    """
    mixed = shares.astype(np.float64) @ reflectances
    np.round(mixed, _DECIMALS, out=mixed)
    return Cube(
        wavelength_nm=DEFAULT_GRID.wavelength_nm,
        stored=mixed.astype(np.float32),
        source=source,
        notes=notes,
    )


Inside = Callable[[int, Float[Array, "h 1"], Float[Array, "1 w"]], Bool[Array, "h w"]]
"""Whether the points at (down, right) from the center of a shape are inside it."""


def paint_behind(
    label: Integer[Array, "h w"],
    center: Float[Array, "k 2"],
    reach: Float[Array, " k"],
    inside: Inside,
    *,
    first: int = 0,
) -> None:
    """Paint shapes in place, each behind all earlier ones.

    Parameters
    ----------
    label
        Number of the shape seen by each sample; negative where none is seen yet.
    center
        Row and column of the centers; sample (i, j) is at (i, j).
    reach
        Largest distance of a point of each shape from its center, in samples.
    inside
        Returns whether points are inside shape ``k``.
    first
        The number of the first of these shapes.

    Notes
    -----
    Painting from front to back until nothing is left uncovered samples the stationary dead leaves
    model exactly: Kendall & Thonnes, "Perfect simulation in stochastic geometry", Pattern
    Recognition 32 (1999) 1569.
    """
    low = np.maximum(np.ceil(center - reach[:, None]), 0).astype(int)
    high = np.minimum(np.floor(center + reach[:, None]) + 1, label.shape).astype(int)
    for k in np.flatnonzero((low < high).all(axis=1)):
        (top, left), (bottom, right) = low[k], high[k]
        window = label[top:bottom, left:right]
        free = window < 0
        if not free.any():
            continue
        down = np.arange(top, bottom)[:, None] - center[k, 0]
        across = np.arange(left, right)[None, :] - center[k, 1]
        window[free & inside(int(k), down, across)] = first + k
