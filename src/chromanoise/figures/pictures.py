"""Figure 8: what a noisy color picture looks like."""

from matplotlib.axes import Axes

from chromanoise._check import Array
from chromanoise._shapes import UInt8


def draw_picture(srgb: UInt8[Array, "h w 3"], ax: Axes, *, title: str = "") -> Axes:
    """A picture, pixel for pixel: no smoothing, which would take away the noise that it shows.

    Parameters
    ----------
    srgb
        Encoded sRGB, 8 bits.
    """
    ax.imshow(srgb, interpolation="none")
    ax.set_title(title)
    ax.set_axis_off()
    return ax
