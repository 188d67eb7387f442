"""Heat maps of a quantity over two parameters."""

from collections.abc import Sequence
from itertools import cycle, islice
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, TwoSlopeNorm
from matplotlib.patches import Patch
from matplotlib.ticker import LogFormatter

from chromanoise import _palette
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis.comparison.maps import QuantityMap, best_of
from chromanoise.figures.style import FAINT, INK, legend_beside

_LETTERS = 72  # of a line of the title
_VALUES = LinearSegmentedColormap.from_list("values", _palette.VALUES)
_DIFFERENCES = LinearSegmentedColormap.from_list("differences", _palette.DIFFERENCES)


def draw_maps(maps: Sequence[QuantityMap], ax: Axes, *, title: str = "") -> Axes:
    """A heat map over two parameters, with the matrix of the first map.

    Of one sensor, the quantity. Of two, the first minus the second, with the line where they are
    equal. Of more, the best sensor, a color each. Gray: no value, as where a channel is saturated.

    Parameters
    ----------
    maps
        From `chromanoise.analysis.comparison.maps.mapped`.
    ax
        To draw on.
    title
        Title, which should name the operating point.
    """
    mine = [one for one in maps if one.matrix == maps[0].matrix]
    first = mine[0]
    ax.set_facecolor(FAINT)
    if len(mine) == 1:
        what = f"{first.label}, {first.matrix}"
        _draw_values(first, first.value, ax, label=f"[{first.quantity.unit}]", cmap=_VALUES)
    elif len(mine) == 2:
        what = f"{first.label} minus {mine[1].label}, {first.matrix}; line: equal"
        _draw_difference(first, first.value - mine[1].value, ax)
    else:
        better = "highest" if first.quantity.more_is_better else "lowest"
        what = f"sensor with the {better} {first.quantity.what}, {first.matrix}"
        _draw_best(mine, ax)
    _frame(first, ax)
    lines = [fill(text, _LETTERS, break_on_hyphens=False) for text in (title, what) if text]
    ax.set_title("\n".join(lines), loc="left", fontsize=9, fontweight="normal")
    return ax


def _draw_values(
    one: QuantityMap, values: Float[Array, "j k"], ax: Axes, *, label: str, **how: Any
) -> None:
    mesh = _draw_cells(one, np.ma.masked_invalid(values), ax, **how)
    ax.figure.colorbar(mesh, ax=ax, label=label)


def _draw_cells(one: QuantityMap, values: Any, ax: Axes, **how: Any) -> QuadMesh:
    mesh = ax.pcolormesh(one.at, one.second_at, values, shading="nearest", **how)
    mesh.set_rasterized(True)
    return mesh


def _draw_difference(one: QuantityMap, values: Float[Array, "j k"], ax: Axes) -> None:
    known = values[np.isfinite(values)]
    reach = float(np.abs(known).max(initial=0.0)) or 1.0
    norm = TwoSlopeNorm(0.0, vmin=-reach, vmax=reach)
    label = f"difference [{one.quantity.unit}]"
    _draw_values(one, values, ax, label=label, cmap=_DIFFERENCES, norm=norm)
    if known.size and known.min() < 0 < known.max() and min(values.shape) > 1:
        ax.contour(one.at, one.second_at, np.ma.masked_invalid(values), [0.0], colors=INK)


def _draw_best(maps: Sequence[QuantityMap], ax: Axes) -> None:
    best = best_of(maps)
    colors = [light for light, _ in islice(cycle(_palette.SENSORS), len(maps))]
    how = {"cmap": ListedColormap(colors), "vmin": -0.5, "vmax": len(maps) - 0.5}
    _draw_cells(maps[0], np.ma.masked_less(best, 0), ax, **how)
    winners = [i for i in range(len(maps)) if (best == i).any()]
    patches = [Patch(color=colors[i], label=maps[i].label) for i in winners]
    legend_beside(ax, fontsize=8, handles=patches)


def _frame(one: QuantityMap, ax: Axes) -> None:
    if one.sweep.logarithmic:
        ax.set_xscale("log")
    if one.second.logarithmic:
        ax.set_yscale("log")
    for axis, sweep in ((ax.xaxis, one.sweep), (ax.yaxis, one.second)):
        if sweep.logarithmic:
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(LogFormatter(minor_thresholds=(1.0, 0.5)))
    ax.set_xlabel(f"{one.sweep.what} [{one.sweep.unit}]")
    ax.set_ylabel(f"{one.second.what} [{one.second.unit}]")
