"""Figure 8: a noisy color picture."""

from matplotlib.axes import Axes

from chromanoise._check import Array
from chromanoise._shapes import UInt8


def draw_picture(srgb: UInt8[Array, "h w 3"], ax: Axes, *, title: str = "") -> Axes:
    """Draw a picture without interpolation, which would smooth the noise.

    Parameters
    ----------
    srgb
        Encoded sRGB, 8 bits.
    ax
        Axes of matplotlib to draw on.
    title
        Text above the drawing.
    """
    ax.imshow(srgb, interpolation="none")
    ax.set_title(title)
    ax.set_axis_off()
    return ax
