"""Figures 3, 4, 6, 9 and 10: two channels, the light and its uncertainty in their true plane.

Every panel is to scale: lengths and angles are those of the n-dimensional vectors. The arrows f
have another unit than the light and a common scale factor.

The ten figures of the paper.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Polygon, Rectangle

from chromanoise.apps.paper.printed_numbers import RGB_12, RGBW_12, PaperStudy
from chromanoise.apps.paper.views import ChannelPlane, MagnifiedNoise, PaperPlanes
from chromanoise.base import Array, Float, UInt8
from chromanoise.charts import (
    FAINT,
    INK,
    QUIET,
    as_index,
    channel_color,
    chromanoise_style,
    draw_flow,
    draw_picture,
    draw_sensitivities,
    framed_figure,
    paled,
    sensor_label,
    shade_nir,
    write_beside,
    write_heading,
)
from chromanoise.sensor import Mosaic, bayer, rgbw_sparse_4x4
from chromanoise.spectra import Spectra, cie_1931
from chromanoise.study import metric_of, raw_snr_db

_ORIGIN = np.zeros(2)
_AXIS_DASHES = (0, (7, 2, 1.5, 2))  # of a color axis; not used for channels or sensors
_NO_NOISE = "to scale, without noise"
_HAT = r"$\hat{\mathbf{L}}$"


def draw_light_above_plane(plane: ChannelPlane, ax: Axes) -> Axes:
    """The plane of two channels seen edge-on, with the distance of the light from it.

    Parameters
    ----------
    plane
        The plane of two channels, and what lies in it.
    ax
        Axes of matplotlib to draw on.
    """
    tilt = np.radians(plane.light_tilt_deg)
    tip = plane.light_length * np.array([np.cos(tilt), np.sin(tilt)])
    foot = tip * [1.0, 0.0]
    draw_axis(ax, 1.3 * foot, QUIET)
    write_at(ax, 0.5 * foot, "plane of\n" + " and ".join(plane.channels), (0, -1), QUIET)
    draw_drop(ax, tip, foot)
    draw_arrow(ax, _ORIGIN, tip, INK)
    draw_arrow(ax, _ORIGIN, foot, INK)
    draw_angle(
        ax, foot, tip, f"{plane.light_tilt_deg:.1f}°", radius=0.5 * float(np.linalg.norm(foot))
    )
    write_at(ax, tip, r"$\mathbf{L}$", tip, INK)
    write_at(ax, foot, _HAT, (1, 1), INK)
    write_heading(ax, "Seen edge-on", f"L and its projection\n{_NO_NOISE}")
    fit_view(ax, [_ORIGIN, tip, 1.3 * foot], margin=0.12)
    return ax


def draw_measurement(plane: ChannelPlane, ax: Axes) -> Axes:
    """Figure 3: raw electrons as orthogonal projections of the light on the channels.

    Parameters
    ----------
    plane
        The plane of two channels, and what lies in it.
    ax
        Axes of matplotlib to draw on.
    """
    _draw_channels(plane, ax)
    _draw_channel_angle(plane, ax)
    _draw_light(plane, ax)
    sides = _outward(plane)
    for i, name in enumerate(plane.channels):
        color = channel_color(name)
        draw_drop(ax, plane.measured.mean, plane.feet[i])
        draw_point(ax, plane.feet[i], color)
        electrons = f"$M_{{{as_index(name)}}}$ = {plane.two.raw.mean[i]:.0f} e$^-$"
        write_at(ax, plane.feet[i], electrons, sides[i], color, points=10)
    write_heading(ax, _source(plane), f"{_angle(plane)}\n{_time(plane)} · {_NO_NOISE}")
    fit_view(ax, [_ORIGIN, plane.measured.mean, *_tips(plane)])
    return ax


def draw_contravariant(plane: ChannelPlane, ax: Axes) -> Axes:
    """Figure 4: contravariant coordinates, whose parallelogram closes at the measured light.

    Parameters
    ----------
    plane
        The plane of two channels, and what lies in it.
    ax
        Axes of matplotlib to draw on.
    """
    _draw_channels(plane, ax)
    _draw_channel_angle(plane, ax)
    sides = _outward(plane)
    for i, name in enumerate(plane.channels):
        part, color = plane.parts[i], channel_color(name)
        draw_drop(ax, plane.measured.mean, part, square=False)
        draw_arrow(ax, _ORIGIN, part, paled(color), width=3.2, under=True)
        index = as_index(name)
        label = rf"$M^{{{index}}}\,\mathbf{{f}}_{{{index}}}$"
        write_at(ax, part, label, sides[i], color, points=10)
    _draw_light(plane, ax)
    write_heading(ax, _source(plane), f"{_angle(plane)}\n{_time(plane)} · {_NO_NOISE}")
    fit_view(ax, [_ORIGIN, plane.measured.mean, *_tips(plane), *plane.parts])
    return ax


def draw_color_projection(plane: ChannelPlane, ax: Axes) -> Axes:
    """Figure 6: a color coordinate as the orthogonal projection of L^ on a color axis.

    Parameters
    ----------
    plane
        The plane of two channels, and what lies in it.
    ax
        Axes of matplotlib to draw on.
    """
    _draw_channels(plane, ax, beside=[plane.axis.direction])
    _draw_color_axis(plane, ax)
    draw_drop(ax, plane.measured.mean, plane.axis.foot)
    _draw_light(plane, ax)
    draw_point(ax, plane.axis.foot, INK)
    value = rf"$\hat{{{plane.axis.name.upper()}}}$ = {plane.axis.color:.2f} lx"
    away = plane.axis.foot - plane.measured.mean
    write_at(ax, plane.axis.foot, value, away, INK, points=10)
    facts = f"{_angle(plane)} · {_tilt(plane)}\n{_time(plane)} · {_NO_NOISE}"
    write_heading(ax, _source(plane), facts)
    fit_view(ax, [_ORIGIN, plane.measured.mean, *_tips(plane), _axis_tip(plane)])
    return ax


def draw_uncertainty(
    plane: ChannelPlane, noise: MagnifiedNoise, ax: Axes, *, title: str = ""
) -> Axes:
    """Figure 9: the uncertainty of the measured light from the noise of two channels.

    Parameters
    ----------
    plane
        The plane of two channels, and what lies in it.
    noise
        Noise of the plane, magnified to be seen.
    ax
        Axes of matplotlib to draw on.
    title
        Text above the drawing.
    """
    _draw_channels(plane, ax)
    _draw_channel_angle(plane, ax)
    _draw_noise(noise, ax)
    draw_area(ax, noise.locus)
    sides, directions = _outward(plane), _unit(plane.arrows)
    for i, name in enumerate(plane.channels):
        color, bar = channel_color(name), noise.feet_bars[i]
        for end, corner in zip(bar, _locus_sides(noise, i), strict=True):
            draw_drop(ax, corner, end, square=False)
        draw_bar(ax, bar, color)
        # the locus begins at the bar, so a label before it does not cover the noise
        write_at(ax, bar[0], f"$M_{{{as_index(name)}}}$", sides[i] - directions[i], color, points=9)
    _draw_noisy_light(plane, ax, beside=[])
    write_heading(
        ax,
        title + _source(plane),
        f"{_angle(plane)} · {_time(plane)} · {_raw_snr(plane)}\n"
        f"{_magnified(noise)} · {_decibels('spectral SNR', plane.two.spectral_snr_db)}",
    )
    fit_view(ax, [_ORIGIN, *_tips(plane), *noise.outline, *noise.locus])
    return ax


def draw_color_uncertainty(
    plane: ChannelPlane, noise: MagnifiedNoise, ax: Axes, *, title: str = ""
) -> Axes:
    """Figure 10: the uncertainty of the measured light, projected on a color axis.

    Parameters
    ----------
    plane
        The plane of two channels, and what lies in it.
    noise
        Noise of the plane, magnified to be seen.
    ax
        Axes of matplotlib to draw on.
    title
        Text above the drawing.
    """
    beside = [plane.axis.direction]
    _draw_channels(plane, ax, beside=beside)
    _draw_color_axis(plane, ax)
    _draw_noise(noise, ax)
    for touch, end in zip(noise.axis_touch, noise.axis_bar, strict=True):
        draw_drop(ax, touch, end, square=False)
    draw_bar(ax, noise.axis_bar, INK)
    _draw_noisy_light(plane, ax, beside=beside)
    letter = plane.axis.name.upper()
    away = plane.axis.foot - plane.measured.mean
    write_at(ax, plane.axis.foot, rf"$\hat{{{letter}}}$", away, INK, points=10)
    snr = _decibels(f"SNR$_{letter}$ of these two channels", plane.axis.color_snr_db)
    write_heading(
        ax,
        title + _source(plane),
        f"{_angle(plane)} · {_time(plane)} · {_tilt(plane)}\n{_magnified(noise)} · {snr}",
    )
    fit_view(ax, [_ORIGIN, *_tips(plane), _axis_tip(plane), *noise.outline, *noise.axis_bar])
    return ax


def _draw_channels(
    plane: ChannelPlane, ax: Axes, *, beside: Sequence[Float[Array, " 2"]] = ()
) -> None:
    """Both channel axes with their letters, and the vectors f on them."""
    tips, arrows = _tips(plane), plane.arrows
    for i, name in enumerate(plane.channels):
        color = channel_color(name)
        draw_axis(ax, tips[i], color)
        write_at(ax, tips[i], name, tips[i], color, points=4, bold=True)
        draw_arrow(ax, _ORIGIN, arrows[i], color)
        side = open_side(arrows[i], [arrows[1 - i], plane.measured.mean, *beside])
        write_at(ax, arrows[i], rf"$\mathbf{{f}}_{{{as_index(name)}}}$", side, color, points=5)


def _draw_channel_angle(plane: ChannelPlane, ax: Axes) -> None:
    radius = 0.6 * float(np.linalg.norm(plane.arrows, axis=1).min())
    first, second = plane.arrows
    text = f"{plane.angle_deg:.1f}°"
    draw_angle(ax, first, second, text, radius=radius, avoid=plane.measured.mean)


def _draw_light(plane: ChannelPlane, ax: Axes) -> None:
    mean = plane.measured.mean
    draw_arrow(ax, _ORIGIN, mean, INK)
    write_at(ax, mean, _HAT, mean, INK)


def _draw_noisy_light(
    plane: ChannelPlane, ax: Axes, *, beside: Sequence[Float[Array, " 2"]]
) -> None:
    """The measured light, thin and labeled along its shaft, because the noise is at its tip."""
    mean = plane.measured.mean
    draw_arrow(ax, _ORIGIN, mean, INK, width=1.0)
    side = open_side(mean, [*plane.arrows, *beside])
    write_at(ax, 0.6 * mean, _HAT, side, INK, points=5)


def _draw_color_axis(plane: ChannelPlane, ax: Axes) -> None:
    tip = _axis_tip(plane)
    draw_axis(ax, tip, INK, dashes=_AXIS_DASHES)
    write_at(ax, tip, plane.axis.name, tip, INK, points=4, bold=True)


def _draw_noise(noise: MagnifiedNoise, ax: Axes) -> None:
    """The sampled acquisitions as small dots, and the closed form as a line on top."""
    ax.plot(*noise.cloud.T, ".", color=QUIET, markersize=2.2, markeredgewidth=0, zorder=4)
    ax.plot(*noise.outline.T, color=INK, linewidth=1.2, zorder=6)


def _tips(plane: ChannelPlane) -> Float[Array, "2 2"]:
    """Ends of the channel axes, beyond all marks on them."""
    on_axes = np.stack([plane.feet, plane.parts, plane.arrows])
    return 1.18 * np.linalg.norm(on_axes, axis=2).max(axis=0)[:, None] * _unit(plane.arrows)


def _axis_tip(plane: ChannelPlane) -> Float[Array, " 2"]:
    return 1.2 * float(np.linalg.norm(plane.measured.mean)) * plane.axis.direction


def _unit(vectors: Float[Array, "k 2"]) -> Float[Array, "k 2"]:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def _outward(plane: ChannelPlane) -> Float[Array, "2 2"]:
    """For each channel, the direction across its axis that leads away from the other channel."""
    first, second = _unit(plane.arrows)
    return _unit(np.stack([(first @ second) * first - second, (first @ second) * second - first]))


def _source(plane: ChannelPlane) -> str:
    """Label with the channels and the sensor."""
    label = sensor_label(plane.sensor_name, plane.two.sensor.origin)
    return f"{' and '.join(plane.channels)} of {label}"


def _angle(plane: ChannelPlane) -> str:
    first, second = plane.channels
    return f"{first}–{second} angle {plane.angle_deg:.1f}° ({metric_of([plane.two])})"


def _time(plane: ChannelPlane) -> str:
    return f"{1e3 * plane.two.exposure.time_s:.1f} ms"


def _magnified(noise: MagnifiedNoise) -> str:
    return f"noise magnified ×{noise.magnification:g}, ellipse at {noise.sigmas:g}σ"


def _tilt(plane: ChannelPlane) -> str:
    axis = plane.axis
    return (
        f"{axis.name} is {axis.tilt_deg:.1f}° out of the plane "
        f"({100 * axis.share:.0f} % of |{axis.name}|² in it)"
    )


def _raw_snr(plane: ChannelPlane) -> str:
    texts = (_decibels(name, value) for name, value in raw_snr_db(plane.two).items())
    return "raw SNR " + ", ".join(texts)


def _decibels(what: str, value: float | None) -> str:
    return f"{what} undefined (saturated)" if value is None else f"{what} {value:.1f} dB"


def _locus_sides(noise: MagnifiedNoise, i: int) -> Float[Array, "2 2"]:
    """The far corner of the locus on each border of channel ``i``'s interval, low border first."""
    low, high = ((1, 2), (0, 3)) if i == 0 else ((2, 3), (0, 1))
    borders = zip(noise.feet_bars[i], (low, high), strict=True)
    return np.stack([_farthest(noise.locus[list(corners)], end) for end, corners in borders])


def _farthest(points: Float[Array, "k 2"], start: Float[Array, " 2"]) -> Float[Array, " 2"]:
    return points[int(np.linalg.norm(points - start, axis=1).argmax())]


Dashes = str | tuple[float, tuple[float, ...]]

_LABEL_PT = 9.0


def draw_arrow(
    ax: Axes,
    start: Float[Array, " 2"],
    end: Float[Array, " 2"],
    color: str | tuple[float, ...],
    *,
    width: float = 1.8,
    under: bool = False,
) -> None:
    """A vector; ``under`` the other vectors where they share an axis."""
    ax.annotate(
        "",
        xy=tuple(end),
        xytext=tuple(start),
        arrowprops={
            "arrowstyle": "-|>,head_length=0.5,head_width=0.22",
            "color": color,
            "linewidth": width,
            "joinstyle": "miter",
            "shrinkA": 0,
            "shrinkB": 0,
            "mutation_scale": 8 + 3 * width,
        },
        zorder=4 if under else 5,
    )


def draw_axis(ax: Axes, tip: Float[Array, " 2"], color: str, *, dashes: Dashes = "solid") -> None:
    """A thin axis from the origin to ``tip``."""
    ax.plot(*_line(np.zeros(2), tip), color=color, linewidth=0.9, linestyle=dashes, zorder=2)


def draw_drop(
    ax: Axes, start: Float[Array, " 2"], foot: Float[Array, " 2"], *, square: bool = True
) -> None:
    """A dashed helping line; ``square`` marks that it meets the axis through ``foot`` at 90°."""
    ax.plot(*_line(start, foot), color=QUIET, linewidth=0.9, linestyle=(0, (3, 2)), zorder=3)
    if square:
        size = 0.04 * np.linalg.norm(start)
        along, across = -size * _direction(foot), size * _direction(start - foot)
        corner = np.array([foot + along, foot + along + across, foot + across])
        ax.plot(*corner.T, color=QUIET, linewidth=0.9, zorder=3)


def draw_bar(ax: Axes, ends: Float[Array, "2 2"], color: str) -> None:
    """An interval on an axis."""
    ax.plot(*ends.T, color=color, linewidth=5, solid_capstyle="butt", alpha=0.9, zorder=6)


def draw_point(ax: Axes, point: Float[Array, " 2"], color: str) -> None:
    """A point of an axis: where a projection ends."""
    ax.plot(*point, "o", color=color, markersize=5.5, zorder=6)


def draw_area(ax: Axes, corners: Float[Array, "k 2"]) -> None:
    """A filled polygon in the palest gray, under all else."""
    ax.add_patch(Polygon(corners, closed=True, facecolor=FAINT, edgecolor="none", zorder=1))


def draw_angle(
    ax: Axes,
    first: Float[Array, " 2"],
    second: Float[Array, " 2"],
    text: str,
    *,
    radius: float,
    avoid: Float[Array, " 2"] | None = None,
) -> None:
    """The arc from one vector to another, and its angle beside it, clear of the line ``avoid``."""
    start, end = _bearing(first), _bearing(second)
    ax.add_patch(
        Arc((0, 0), 2 * radius, 2 * radius, theta1=start, theta2=end, color=QUIET, zorder=3)
    )
    stops = [start, end]
    if avoid is not None and start < _bearing(avoid) < end:
        stops.insert(1, _bearing(avoid))
    _, low, high = max((b - a, a, b) for a, b in pairwise(stops))
    middle = np.radians((low + high) / 2)
    toward = np.array([np.cos(middle), np.sin(middle)])
    write_at(ax, radius * toward, text, toward, QUIET, points=4)


def open_side(
    direction: Float[Array, " 2"], others: Sequence[Float[Array, " 2"]]
) -> Float[Array, " 2"]:
    """The direction across a line, to the side where no other line is near."""
    left = np.array([-direction[1], direction[0]])
    turns = [(_bearing(other) - _bearing(direction) + 180) % 360 - 180 for other in others]
    room_left = min((turn for turn in turns if turn > 0), default=180.0)
    room_right = min((-turn for turn in turns if turn <= 0), default=180.0)
    return left if room_left > room_right else -left


def write_at(
    ax: Axes,
    point: Float[Array, " 2"],
    text: str,
    away: Sequence[float] | Float[Array, " 2"],
    color: str,
    *,
    points: float = 7,
    bold: bool = False,
) -> None:
    """``text`` some points away from ``point``, on the side that ``away`` points to."""
    x, y = _direction(np.asarray(away, dtype=float))
    sides = {"ha": _side(x, "left", "right"), "va": _side(y, "bottom", "top")}
    look = {"color": color, "fontweight": "bold" if bold else "normal"}
    by = (points * x, points * y)
    write_beside(ax, text, point.tolist(), by, fontsize=_LABEL_PT, zorder=7, **sides, **look)


def fit_view(ax: Axes, points: Sequence[Float[Array, " 2"]], *, margin: float = 0.11) -> None:
    """Show all ``points`` to scale, with room for their labels, and no frame."""
    low, high = np.min(points, axis=0), np.max(points, axis=0)
    room = margin * (high - low).max()
    ax.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room))
    ax.set_aspect("equal")
    ax.set_axis_off()


def _direction(vector: Float[Array, " 2"]) -> Float[Array, " 2"]:
    """The vector at length 1; one without length has no direction and stays as it is."""
    return vector / (np.linalg.norm(vector) or 1.0)


def _bearing(vector: Float[Array, " 2"]) -> float:
    """Angle from the first coordinate, counterclockwise. [deg]"""
    return float(np.degrees(np.arctan2(vector[1], vector[0])))


def _line(start: Float[Array, " 2"], end: Float[Array, " 2"]) -> Float[Array, "2 2"]:
    """Abscissas and ordinates of a straight line."""
    return np.array([start, end]).T


def _side(component: float, positive: str, negative: str) -> str:
    """Alignment of a text that lies to the ``positive`` or ``negative`` side of its point."""
    if abs(component) < 0.5:
        return "center"
    return positive if component > 0 else negative


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
        `chromanoise.apps.paper.paper_study`.
    planes
        `chromanoise.apps.paper.paper_planes`.
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
