"""The ten figures of the paper."""

from collections.abc import Callable, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from chromanoise._check import Array
from chromanoise._shapes import UInt8
from chromanoise.figures.flow import draw_flow
from chromanoise.figures.geometry import (
    draw_color_projection,
    draw_color_uncertainty,
    draw_contravariant,
    draw_light_above_plane,
    draw_measurement,
    draw_uncertainty,
)
from chromanoise.figures.results import draw_picture
from chromanoise.figures.sensitivities import draw_sensitivities
from chromanoise.figures.style import (
    INK,
    QUIET,
    channel_color,
    chromanoise_style,
    framed_figure,
    sensor_label,
    shade_nir,
    write_beside,
)
from chromanoise.paper.planes import PaperPlanes
from chromanoise.paper.study import RGB_12, RGBW_12, PaperStudy
from chromanoise.paper.views import ChannelPlane, MagnifiedNoise
from chromanoise.sensor import Mosaic, bayer, rgbw_sparse_4x4
from chromanoise.spectra import Spectra, cie_1931

CAPTIONS = {
    "figure-01-mosaics": (
        "Mosaics of a classical RGB sensor (Bayer) and of a sparse RGBW sensor for low light, "
        "drawn from the library's mosaics; the outlined block tiles the sensor."
    ),
    "figure-02-flow": (
        "The way from scene to color with the computed numbers of each stage, for both sensors "
        "at the same exposure: the RGBW sensor is ahead in raw and behind in color."
    ),
    "figure-03-measurement": (
        "Measurement of the light by two channels, drawn to scale from computed data: the light L "
        "stands above their plane (left), and its orthogonal projections on their axes are the "
        "raw electrons (right); the arrows f share one factor, as they are in another unit."
    ),
    "figure-04-contravariant": (
        "Contravariant coordinates of the same light, drawn to scale from computed data: the "
        "multiples of the two channels that add up to the measured light."
    ),
    "figure-05-observer": (
        "The color-matching functions that are the color axes, drawn from the CIE's table: they "
        "are zero in most of the range in which silicon answers."
    ),
    "figure-06-projection": (
        "Projection of the measured light on the color axis y, itself projected into the plane "
        "of the two channels, drawn to scale from computed data."
    ),
    "figure-07-sensitivities": (
        "Quantum efficiencies of both sensors, drawn from the library's reconstruction of the "
        "paper's curves, which is consistent with its printed figures but not a measurement."
    ),
    "figure-08-pictures": (
        "The same scene, computed with noise for the RGB sensor with IR-cut (left) and for the "
        "RGBW sensor without (right)."
    ),
    "figure-09-correlation": (
        "Uncertainty of the measured light (closed form as line, samples as dots) between the "
        "intervals of two channels (gray), drawn from computed data for the widest pair of the "
        "one sensor and the narrowest pair of the other, each sensor at its own saturation."
    ),
    "figure-10-color-axis": (
        "Uncertainty of Y^ as the projection of the same uncertainty on the color axis y, drawn "
        "from computed data for green and red of RGBW, far from y, and of RGB behind the IR-cut, "
        "near it, each sensor at its own saturation."
    ),
}
"""One sentence for each figure, by its key."""

_WIDTH_IN, _SIDE_IN = 6.4, 0.15
_HEADING_IN = 0.68  # room for a title and two lines of facts
_TITLE_IN = 0.32
_TALLEST_IN = 3.3


def paper_figures(
    study: PaperStudy,
    planes: PaperPlanes,
    pictures: tuple[UInt8[Array, "h w 3"], UInt8[Array, "h w 3"]] | None = None,
) -> dict[str, Figure]:
    """The figures of the paper, drawn from computed data.

    Parameters
    ----------
    study
        `chromanoise.paper.paper_study`.
    planes
        `chromanoise.paper.paper_planes`.
    pictures
        8-bit sRGB of the RGB sensor and of the RGBW sensor; without them Figure 8 is omitted.

    Returns
    -------
    figures
        By the keys of `CAPTIONS`, in the paper's order.
    """
    with chromanoise_style():
        plane = planes.measurement
        figures = {
            "figure-01-mosaics": _mosaics(),
            "figure-02-flow": _flow(study),
            "figure-03-measurement": _measurement(plane),
            "figure-04-contravariant": _alone(draw_contravariant, plane),
            "figure-05-observer": _observer(study),
            "figure-06-projection": _alone(draw_color_projection, plane),
            "figure-07-sensitivities": _sensitivities(study),
        }
        if pictures is not None:
            figures["figure-08-pictures"] = _pictures(study, pictures)
        figures["figure-09-correlation"] = _uncertainties(
            draw_uncertainty, planes.correlation, ("Weakly correlated: ", "Highly correlated: ")
        )
        figures["figure-10-color-axis"] = _uncertainties(
            draw_color_uncertainty, planes.color_axis, ("Far from y: ", "Near y: ")
        )
    return figures


def _mosaics() -> Figure:
    figure = Figure()
    left, right = figure.subplots(1, 2)
    draw_mosaic(bayer(), left, title="RGB with IR-cut (Bayer)")
    draw_mosaic(rgbw_sparse_4x4(), right, title="RGBW without IR-cut (sparse)")
    _side_by_side(figure, [left, right], height_in=3.0, heading_in=_TITLE_IN)
    return figure


def _flow(study: PaperStudy) -> Figure:
    figure = framed_figure(8.8, 5.1)
    top, bottom = figure.subplots(2, 1)
    draw_flow(study.columns[RGBW_12], top)
    draw_flow(study.columns[RGB_12], bottom)
    return figure


def _measurement(plane: ChannelPlane) -> Figure:
    figure = Figure()
    edge_on, above = figure.subplots(1, 2)
    draw_light_above_plane(plane, edge_on)
    draw_measurement(plane, above)
    _side_by_side(figure, [edge_on, above], height_in=_TALLEST_IN, heading_in=_HEADING_IN)
    return figure


def _alone(draw: Callable[[ChannelPlane, Axes], Axes], plane: ChannelPlane) -> Figure:
    figure = Figure()
    _stack(figure, [draw(plane, figure.add_subplot())])
    return figure


def _observer(study: PaperStudy) -> Figure:
    figure = framed_figure(6.4, 3.5)
    draw_observer(cie_1931(study.scene.illuminant.grid), figure.add_subplot())
    return figure


def _sensitivities(study: PaperStudy) -> Figure:
    figure = framed_figure(6.4, 5.6)
    top, bottom = figure.subplots(2, 1, sharex=True)
    sensors = [study.columns[column].sensor for column in (RGBW_12, RGB_12)]
    highest = 1.15 * max(float(sensor.qe.max()) for sensor in sensors)
    draw_sensitivities(sensors[0], top, top=highest)
    draw_sensitivities(sensors[1], bottom, top=highest)
    top.set_xlabel("")
    return figure


def _pictures(
    study: PaperStudy, pictures: tuple[UInt8[Array, "h w 3"], UInt8[Array, "h w 3"]]
) -> Figure:
    figure = Figure()
    panels = list(figure.subplots(1, 2))
    for picture, column, ax in zip(pictures, (RGB_12, RGBW_12), panels, strict=True):
        sensor = study.columns[column].sensor
        draw_picture(picture, ax, title=sensor_label(sensor.name, sensor.origin))
    height, width = pictures[0].shape[:2]
    _side_by_side(figure, panels, height_in=4.0 * height / width, heading_in=_TITLE_IN)
    return figure


def _uncertainties(
    draw: Callable[..., Axes],
    pairs: Sequence[tuple[ChannelPlane, MagnifiedNoise]],
    titles: Sequence[str],
) -> Figure:
    figure = Figure()
    panels = [
        draw(plane, noise, figure.add_subplot(2, 1, i), title=title)
        for i, ((plane, noise), title) in enumerate(zip(pairs, titles, strict=True), 1)
    ]
    _stack(figure, panels)
    return figure


def _side_by_side(
    figure: Figure, panels: Sequence[Axes], *, height_in: float, heading_in: float
) -> None:
    """One panel beside the other, equally tall: the figure grows as wide as they need."""
    spans = [_span(ax) for ax in panels]
    widths = [height_in * width / height for width, height in spans]
    total_in = max(sum(widths) + _SIDE_IN * (len(panels) + 1), _WIDTH_IN)
    tall_in = height_in + heading_in + _SIDE_IN
    figure.set_size_inches(total_in, tall_in)
    left = _SIDE_IN
    for ax, width in zip(panels, widths, strict=True):
        ax.set_position(
            (left / total_in, _SIDE_IN / tall_in, width / total_in, height_in / tall_in)
        )
        left += width + _SIDE_IN


def _stack(figure: Figure, panels: Sequence[Axes]) -> None:
    """One panel over the other in one scale: the figure grows as tall as they need."""
    left = min(ax.get_xlim()[0] for ax in panels)
    right = max(ax.get_xlim()[1] for ax in panels)
    inside_in = _WIDTH_IN - 2 * _SIDE_IN
    tallest = max(_span(ax)[1] for ax in panels)
    inch = min(inside_in / (right - left), _TALLEST_IN / tallest)
    slack = (inside_in / inch - (right - left)) / 2
    heights = [inch * _span(ax)[1] for ax in panels]
    total = sum(heights) + (_HEADING_IN + _SIDE_IN) * len(panels)
    figure.set_size_inches(_WIDTH_IN, total)
    top = total
    for ax, height in zip(panels, heights, strict=True):
        top -= _HEADING_IN + height
        ax.set_xlim(left - slack, right + slack)
        ax.set_position((_SIDE_IN / _WIDTH_IN, top / total, inside_in / _WIDTH_IN, height / total))
        top -= _SIDE_IN


def _span(ax: Axes) -> tuple[float, float]:
    """Width and height of what is shown, in data units."""
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    return abs(right - left), abs(top - bottom)


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
        at, look = (wavelength_nm[peak], curve[peak]), {"ha": "center", "fontsize": 12}
        write_beside(ax, rf"$\overline{{{name}}}$", at, (0, 4), color=color, **look)
    shade_nir(ax, wavelength_nm[-1])
    ax.set(
        xlim=(wavelength_nm[0], wavelength_nm[-1]),
        ylim=(0, 1.12 * observer.values.max()),
        xlabel="wavelength [nm]",
        ylabel="tristimulus value [1]",
        title=observer.source,
    )
    return ax
