"""Figure 5: the color-matching functions."""

from matplotlib.axes import Axes

from chromanoise.figures.style import channel_color, shade_nir
from chromanoise.spectra import Spectra

_LOOKS = {
    "x": (channel_color("R"), (0, (6, 2))),
    "y": (channel_color("G"), "solid"),
    "z": (channel_color("B"), (0, (2, 1.2))),
}


def draw_observer(observer: Spectra, ax: Axes) -> Axes:
    """The color-matching functions x, y, z over wavelength, each with its letter at its peak.

    Parameters
    ----------
    observer
        The observer of the colors.
    ax
        Axes of matplotlib to draw on.
    """
    wavelength_nm = observer.wavelength_nm
    for name, curve in zip(observer.names, observer.values.T, strict=True):
        color, dashes = _LOOKS[name]
        ax.plot(wavelength_nm, curve, color=color, linestyle=dashes)
        peak = int(curve.argmax())
        ax.annotate(
            rf"$\overline{{{name}}}$",
            (wavelength_nm[peak], curve[peak]),
            xytext=(0, 4),
            textcoords="offset points",
            ha="center",
            color=color,
            fontsize=12,
        )
    shade_nir(ax, wavelength_nm[-1])
    ax.set(
        xlim=(wavelength_nm[0], wavelength_nm[-1]),
        ylim=(0, 1.12 * observer.values.max()),
        xlabel="wavelength [nm]",
        ylabel="tristimulus value [1]",
        title=observer.source,
    )
    return ax
