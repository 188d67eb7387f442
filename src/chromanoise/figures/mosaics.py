"""Figure 1: the mosaic of channels over the pixels."""

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from chromanoise.figures.style import INK, QUIET, channel_color
from chromanoise.sensor import Mosaic


def draw_mosaic(mosaic: Mosaic, ax: Axes, *, cells: int = 8, title: str = "") -> Axes:
    """``cells`` x ``cells`` pixels of the mosaic, each with its letter; one block is outlined.

    Parameters
    ----------
    mosaic
        Which channel each pixel has.
    ax
        Axes of matplotlib to draw on.
    cells
        Number of pixels on a side.
    title
        Text above the drawing.
    """
    pattern = mosaic.pattern
    height, width = len(pattern), len(pattern[0])
    for row in range(cells):
        for column in range(cells):
            _draw_cell(ax, row, column, pattern[row % height][column % width])
    ax.add_patch(Rectangle((0, 0), width, height, fill=False, edgecolor=INK, linewidth=2.6))
    ax.set(xlim=(-0.08, cells + 0.08), ylim=(cells + 0.08, -0.08), title=title)
    ax.set_aspect("equal")
    ax.set_axis_off()
    return ax


def _draw_cell(ax: Axes, row: int, column: int, name: str) -> None:
    white = name == "W"
    face = "white" if white else channel_color(name)
    ax.add_patch(Rectangle((column, row), 1, 1, facecolor=face, edgecolor=QUIET, linewidth=0.6))
    ax.text(
        column + 0.5,
        row + 0.5,
        name,
        ha="center",
        va="center_baseline",
        color=INK if white else "white",
        fontweight="bold",
        fontsize=11,
    )
