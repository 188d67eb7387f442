"""Shapes that occlude each other, painted from front to back."""

from collections.abc import Callable

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Integer

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
