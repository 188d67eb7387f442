"""The ten figures of the paper.

Figures 3, 4, 6, 9 and 10 show two channels, the light and its uncertainty in their true plane. Each
of their panels is to scale: lengths and angles are those of the n-dimensional vectors. The arrows f
have another unit than the light and a common scale factor.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Polygon, Rectangle

from chromanoise.apps.paper.printed_numbers import RGB_12, RGBW_12, PaperStudy
from chromanoise.apps.paper.views import ChannelPlane, MagnifiedNoise, NoisyPlane, PaperPlanes
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
from chromanoise.sensor import Mosaic, Sensor, bayer, rgbw_sparse_4x4
from chromanoise.spectra import Spectra, cie_1931
from chromanoise.study import metric_of, raw_snr_db

_ORIGIN = np.zeros(2)
_AXIS: dict[str, Any] = {"linewidth": 0.9, "zorder": 2}
_COLOR_AXIS = _AXIS | {"color": INK, "linestyle": (0, (7, 2, 1.5, 2))}  # dashes of no channel
_DROP: dict[str, Any] = {"color": QUIET, "linewidth": 0.9, "linestyle": (0, (3, 2)), "zorder": 3}
_BAR: dict[str, Any] = {"linewidth": 5, "solid_capstyle": "butt", "alpha": 0.9, "zorder": 6}
_FOOT: dict[str, Any] = {"marker": "o", "markersize": 5.5, "zorder": 6}
_LABEL_PT = 9.0
_NO_NOISE = "to scale, without noise"
_HAT = r"$\hat{\mathbf{L}}$"

Vector = Float[Array, " 2"]


def draw_light_above_plane(plane: ChannelPlane, ax: Axes) -> Axes:
    """The plane of two channels seen edge-on, with the distance of the light from it."""
    tilt = np.radians(plane.light_tilt_deg)
    tip = plane.light_length * np.array([np.cos(tilt), np.sin(tilt)])
    foot = tip * [1.0, 0.0]
    _line(ax, [_ORIGIN, 1.3 * foot], color=QUIET, **_AXIS)
    _write(ax, 0.5 * foot, "plane of\n" + " and ".join(plane.channels), (0, -1), QUIET)
    _draw_drop(ax, tip, foot)
    _draw_arrow(ax, tip, INK)
    _draw_arrow(ax, foot, INK)
    _draw_angle(
        ax, foot, tip, f"{plane.light_tilt_deg:.1f}°", radius=0.5 * float(np.linalg.norm(foot))
    )
    _write(ax, tip, r"$\mathbf{L}$", tip, INK)
    _write(ax, foot, _HAT, (1, 1), INK)
    write_heading(ax, "Seen edge-on", f"L and its projection\n{_NO_NOISE}")
    return _fit_view(ax, tip, 1.3 * foot, margin=0.12)


def draw_measurement(plane: ChannelPlane, ax: Axes) -> Axes:
    """Figure 3: raw electrons as orthogonal projections of the light on the channels."""
    _draw_channels(plane, ax)
    _draw_channel_angle(plane, ax)
    _draw_light(plane, ax)
    for i, (name, side) in enumerate(zip(plane.channels, _outward(plane), strict=True)):
        color, foot = channel_color(name), plane.feet[i]
        _draw_drop(ax, plane.measured.mean, foot)
        _line(ax, [foot], color=color, **_FOOT)
        electrons = f"$M_{{{as_index(name)}}}$ = {plane.two.raw.mean[i]:.0f} e$^-$"
        _write(ax, foot, electrons, side, color, points=10)
    write_heading(ax, _source(plane), f"{_angle(plane)}\n{_time(plane)} · {_NO_NOISE}")
    return _fit_view(ax, plane.measured.mean, *_tips(plane))


def draw_contravariant(plane: ChannelPlane, ax: Axes) -> Axes:
    """Figure 4: contravariant coordinates, whose parallelogram closes at the measured light."""
    _draw_channels(plane, ax)
    _draw_channel_angle(plane, ax)
    for i, (name, side) in enumerate(zip(plane.channels, _outward(plane), strict=True)):
        part, color, index = plane.parts[i], channel_color(name), as_index(name)
        _draw_drop(ax, plane.measured.mean, part, square=False)
        _draw_arrow(ax, part, paled(color), width=3.2, zorder=4)
        _write(ax, part, rf"$M^{{{index}}}\,\mathbf{{f}}_{{{index}}}$", side, color, points=10)
    _draw_light(plane, ax)
    write_heading(ax, _source(plane), f"{_angle(plane)}\n{_time(plane)} · {_NO_NOISE}")
    return _fit_view(ax, plane.measured.mean, *_tips(plane), *plane.parts)


def draw_color_projection(plane: ChannelPlane, ax: Axes) -> Axes:
    """Figure 6: a color coordinate as the orthogonal projection of L^ on a color axis."""
    _draw_channels(plane, ax, beside=[plane.axis.direction])
    _draw_color_axis(plane, ax)
    _draw_drop(ax, plane.measured.mean, plane.axis.foot)
    _draw_light(plane, ax)
    _line(ax, [plane.axis.foot], color=INK, **_FOOT)
    value = rf"$\hat{{{plane.axis.name.upper()}}}$ = {plane.axis.color:.2f} lx"
    away = plane.axis.foot - plane.measured.mean
    _write(ax, plane.axis.foot, value, away, INK, points=10)
    facts = f"{_angle(plane)} · {_tilt(plane)}\n{_time(plane)} · {_NO_NOISE}"
    write_heading(ax, _source(plane), facts)
    return _fit_view(ax, plane.measured.mean, *_tips(plane), _axis_tip(plane))


def draw_uncertainty(
    plane: ChannelPlane, noise: MagnifiedNoise, ax: Axes, *, title: str = ""
) -> Axes:
    """Figure 9: the uncertainty of the measured light from the noise of two channels."""
    _draw_channels(plane, ax)
    _draw_channel_angle(plane, ax)
    _draw_noise(noise, ax)
    ax.add_patch(Polygon(noise.locus, closed=True, facecolor=FAINT, edgecolor="none", zorder=1))
    sides, directions = _outward(plane), _unit(plane.arrows)
    for i, name in enumerate(plane.channels):
        color, bar = channel_color(name), noise.feet_bars[i]
        for end, corner in zip(bar, _locus_sides(noise, i), strict=True):
            _draw_drop(ax, corner, end, square=False)
        _line(ax, bar, color=color, **_BAR)
        # the locus begins at the bar, so a label before it does not cover the noise
        _write(ax, bar[0], f"$M_{{{as_index(name)}}}$", sides[i] - directions[i], color, points=9)
    _draw_noisy_light(plane, ax)
    raw_snr = ", ".join(_decibels(*one) for one in raw_snr_db(plane.two).items())
    write_heading(
        ax,
        title + _source(plane),
        f"{_angle(plane)} · {_time(plane)} · raw SNR {raw_snr}\n"
        f"{_magnified(noise)} · {_decibels('spectral SNR', plane.two.spectral_snr_db)}",
    )
    return _fit_view(ax, *_tips(plane), *noise.outline, *noise.locus)


def draw_color_uncertainty(
    plane: ChannelPlane, noise: MagnifiedNoise, ax: Axes, *, title: str = ""
) -> Axes:
    """Figure 10: the uncertainty of the measured light, projected on a color axis."""
    beside = [plane.axis.direction]
    _draw_channels(plane, ax, beside=beside)
    _draw_color_axis(plane, ax)
    _draw_noise(noise, ax)
    for touch, end in zip(noise.axis_touch, noise.axis_bar, strict=True):
        _draw_drop(ax, touch, end, square=False)
    _line(ax, noise.axis_bar, color=INK, **_BAR)
    _draw_noisy_light(plane, ax, beside=beside)
    letter = plane.axis.name.upper()
    away = plane.axis.foot - plane.measured.mean
    _write(ax, plane.axis.foot, rf"$\hat{{{letter}}}$", away, INK, points=10)
    snr = _decibels(f"SNR$_{letter}$ of these two channels", plane.axis.color_snr_db)
    write_heading(
        ax,
        title + _source(plane),
        f"{_angle(plane)} · {_time(plane)} · {_tilt(plane)}\n{_magnified(noise)} · {snr}",
    )
    return _fit_view(ax, *_tips(plane), _axis_tip(plane), *noise.outline, *noise.axis_bar)


def _draw_channels(plane: ChannelPlane, ax: Axes, *, beside: Sequence[Vector] = ()) -> None:
    """Both channel axes with their letters, and the vectors f on them."""
    tips, arrows = _tips(plane), plane.arrows
    for i, name in enumerate(plane.channels):
        color = channel_color(name)
        _line(ax, [_ORIGIN, tips[i]], color=color, **_AXIS)
        _write(ax, tips[i], name, tips[i], color, points=4, fontweight="bold")
        _draw_arrow(ax, arrows[i], color)
        side = _open_side(arrows[i], [arrows[1 - i], plane.measured.mean, *beside])
        _write(ax, arrows[i], rf"$\mathbf{{f}}_{{{as_index(name)}}}$", side, color, points=5)


def _draw_channel_angle(plane: ChannelPlane, ax: Axes) -> None:
    radius = 0.6 * float(np.linalg.norm(plane.arrows, axis=1).min())
    (first, second), text = plane.arrows, f"{plane.angle_deg:.1f}°"
    _draw_angle(ax, first, second, text, radius=radius, avoid=plane.measured.mean)


def _draw_light(plane: ChannelPlane, ax: Axes) -> None:
    _draw_arrow(ax, plane.measured.mean, INK)
    _write(ax, plane.measured.mean, _HAT, plane.measured.mean, INK)


def _draw_noisy_light(plane: ChannelPlane, ax: Axes, *, beside: Sequence[Vector] = ()) -> None:
    """The measured light, thin and labeled along its shaft, because the noise is at its tip."""
    mean = plane.measured.mean
    _draw_arrow(ax, mean, INK, width=1.0)
    _write(ax, 0.6 * mean, _HAT, _open_side(mean, [*plane.arrows, *beside]), INK, points=5)


def _draw_color_axis(plane: ChannelPlane, ax: Axes) -> None:
    tip = _axis_tip(plane)
    _line(ax, [_ORIGIN, tip], **_COLOR_AXIS)
    _write(ax, tip, plane.axis.name, tip, INK, points=4, fontweight="bold")


def _draw_noise(noise: MagnifiedNoise, ax: Axes) -> None:
    """The sampled acquisitions as small dots, and the closed form as a line on top."""
    dots: dict[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 2.2}
    _line(ax, noise.cloud, color=QUIET, markeredgewidth=0, zorder=4, **dots)
    _line(ax, noise.outline, color=INK, linewidth=1.2, zorder=6)


def _tips(plane: ChannelPlane) -> Float[Array, "2 2"]:
    """Ends of the channel axes, beyond all marks on them."""
    on_axes = np.stack([plane.feet, plane.parts, plane.arrows])
    return 1.18 * np.linalg.norm(on_axes, axis=2).max(axis=0)[:, None] * _unit(plane.arrows)


def _axis_tip(plane: ChannelPlane) -> Vector:
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


def _decibels(what: str, value: float | None) -> str:
    return f"{what} undefined (saturated)" if value is None else f"{what} {value:.1f} dB"


def _locus_sides(noise: MagnifiedNoise, i: int) -> list[Vector]:
    """The far corner of the locus on each border of channel ``i``'s interval, low border first."""
    corners = ((1, 2), (0, 3)) if i == 0 else ((2, 3), (0, 1))
    return [
        max(noise.locus[list(own)], key=lambda point: float(np.linalg.norm(point - end)))
        for end, own in zip(noise.feet_bars[i], corners, strict=True)
    ]


def _line(ax: Axes, points: Sequence[Vector] | Float[Array, "k 2"], **look: Any) -> None:
    ax.plot(*np.transpose(points), **look)


def _draw_arrow(
    ax: Axes, tip: Vector, color: str | tuple[float, ...], *, width: float = 1.8, zorder: float = 5
) -> None:
    """A vector from the origin."""
    look = {
        "arrowstyle": "-|>,head_length=0.5,head_width=0.22",
        "color": color,
        "linewidth": width,
        "joinstyle": "miter",
        "shrinkA": 0,
        "shrinkB": 0,
        "mutation_scale": 8 + 3 * width,
    }
    ax.annotate("", xy=tuple(tip), xytext=(0, 0), arrowprops=look, zorder=zorder)


def _draw_drop(ax: Axes, start: Vector, foot: Vector, *, square: bool = True) -> None:
    """A dashed helping line; ``square`` marks that it meets the axis through ``foot`` at 90°."""
    _line(ax, [start, foot], **_DROP)
    if square:
        size = 0.04 * np.linalg.norm(start)
        along, across = -size * _direction(foot), size * _direction(start - foot)
        corner = [foot + along, foot + along + across, foot + across]
        _line(ax, corner, **_DROP | {"linestyle": "solid"})


def _draw_angle(
    ax: Axes,
    first: Vector,
    second: Vector,
    text: str,
    *,
    radius: float,
    avoid: Vector | None = None,
) -> None:
    """The arc from one vector to another, and its angle beside it, clear of the line ``avoid``."""
    start, end = _bearing(first), _bearing(second)
    arc = Arc((0, 0), 2 * radius, 2 * radius, theta1=start, theta2=end, color=QUIET, zorder=3)
    ax.add_patch(arc)
    stops = [start, end]
    if avoid is not None and start < _bearing(avoid) < end:
        stops.insert(1, _bearing(avoid))
    _, low, high = max((b - a, a, b) for a, b in pairwise(stops))
    middle = np.radians((low + high) / 2)
    toward = np.array([np.cos(middle), np.sin(middle)])
    _write(ax, radius * toward, text, toward, QUIET, points=4)


def _open_side(direction: Vector, others: Sequence[Vector]) -> Vector:
    """The direction across a line, to the side where no other line is near."""
    left = np.array([-direction[1], direction[0]])
    turns = [(_bearing(other) - _bearing(direction) + 180) % 360 - 180 for other in others]
    room_left = min((turn for turn in turns if turn > 0), default=180.0)
    room_right = min((-turn for turn in turns if turn <= 0), default=180.0)
    return left if room_left > room_right else -left


def _write(
    ax: Axes,
    point: Vector,
    text: str,
    away: Sequence[float] | Vector,
    color: str,
    *,
    points: float = 7,
    **look: Any,
) -> None:
    """``text`` some points away from ``point``, on the side that ``away`` points to."""
    x, y = _direction(np.asarray(away, dtype=float))
    look |= {"ha": _side(x, "left", "right"), "va": _side(y, "bottom", "top"), "color": color}
    by = (points * x, points * y)
    write_beside(ax, text, point.tolist(), by, fontsize=_LABEL_PT, zorder=7, **look)


def _fit_view(ax: Axes, *points: Vector, margin: float = 0.11) -> Axes:
    """Show the origin and all points to scale, with room for their labels, and no frame."""
    low, high = np.min([_ORIGIN, *points], axis=0), np.max([_ORIGIN, *points], axis=0)
    room = margin * (high - low).max()
    ax.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room))
    ax.set_aspect("equal")
    ax.set_axis_off()
    return ax


def _direction(vector: Vector) -> Vector:
    """The vector at length 1; one without length has no direction and stays as it is."""
    return vector / (np.linalg.norm(vector) or 1.0)


def _bearing(vector: Vector) -> float:
    """Angle from the first coordinate, counterclockwise. [deg]"""
    return float(np.degrees(np.arctan2(vector[1], vector[0])))


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
    pictures
        8-bit sRGB of the RGB sensor and of the RGBW sensor; without them Figure 8 is omitted.

    Returns
    -------
    figures
        By the keys of `CAPTIONS`, in the paper's order.
    """
    plane, correlated = planes.measurement, ("Weakly correlated: ", "Highly correlated: ")
    sensors = {column: study.columns[column].sensor for column in (RGBW_12, RGB_12)}
    with chromanoise_style():
        return {
            "figure-01-mosaics": _side_by_side(
                [
                    partial(draw_mosaic, bayer(), title="RGB with IR-cut (Bayer)"),
                    partial(draw_mosaic, rgbw_sparse_4x4(), title="RGBW without IR-cut (sparse)"),
                ],
                height_in=3.0,
                heading_in=_TITLE_IN,
            ),
            "figure-02-flow": _framed(
                8.8, 5.1, [partial(draw_flow, study.columns[one]) for one in sensors]
            ),
            "figure-03-measurement": _side_by_side(
                [partial(draw_light_above_plane, plane), partial(draw_measurement, plane)],
                height_in=_TALLEST_IN,
                heading_in=_HEADING_IN,
            ),
            "figure-04-contravariant": _stack([partial(draw_contravariant, plane)]),
            "figure-05-observer": _framed(
                6.4, 3.5, [partial(draw_observer, cie_1931(study.scene.illuminant.grid))]
            ),
            "figure-06-projection": _stack([partial(draw_color_projection, plane)]),
            "figure-07-sensitivities": _sensitivities([*sensors.values()]),
            **({} if pictures is None else {"figure-08-pictures": _pictures(sensors, pictures)}),
            "figure-09-correlation": _stack(
                _titled(draw_uncertainty, planes.correlation, correlated)
            ),
            "figure-10-color-axis": _stack(
                _titled(draw_color_uncertainty, planes.color_axis, ("Far from y: ", "Near y: "))
            ),
        }


Draw = Callable[..., Axes]
"""Draws on the axes given as ``ax``."""


def _titled(draw: Draw, planes: Sequence[NoisyPlane], titles: Sequence[str]) -> list[Draw]:
    """One panel for each plane with its noise."""
    pairs = zip(planes, titles, strict=True)
    return [partial(draw, *noisy, title=title) for noisy, title in pairs]


def _framed(width_in: float, height_in: float, draws: Sequence[Draw], **shared: Any) -> Figure:
    """Panels over each other in a figure of a fixed size."""
    figure = framed_figure(width_in, height_in)
    panels = figure.subplots(len(draws), 1, squeeze=False, **shared).ravel()
    for draw, ax in zip(draws, panels, strict=True):
        draw(ax=ax)
    return figure


def _sensitivities(sensors: Sequence[Sensor]) -> Figure:
    highest = 1.15 * max(float(sensor.qe.max()) for sensor in sensors)
    draws = [partial(draw_sensitivities, sensor, top=highest) for sensor in sensors]
    figure = _framed(6.4, 5.6, draws, sharex=True)
    figure.axes[0].set_xlabel("")
    return figure


def _pictures(
    sensors: Mapping[str, Sensor], pictures: tuple[UInt8[Array, "h w 3"], UInt8[Array, "h w 3"]]
) -> Figure:
    shown = [sensors[column] for column in (RGB_12, RGBW_12)]
    draws = [
        partial(draw_picture, picture, title=sensor_label(sensor.name, sensor.origin))
        for picture, sensor in zip(pictures, shown, strict=True)
    ]
    height, width = pictures[0].shape[:2]
    return _side_by_side(draws, height_in=4.0 * height / width, heading_in=_TITLE_IN)


def _side_by_side(draws: Sequence[Draw], *, height_in: float, heading_in: float) -> Figure:
    """One panel beside the other, equally tall: the figure grows as wide as they need."""
    figure = Figure()
    axes = figure.subplots(1, len(draws))
    panels = [draw(ax=ax) for draw, ax in zip(draws, axes, strict=True)]
    widths = [height_in * width / height for width, height in map(_span, panels)]
    total_in = max(sum(widths) + _SIDE_IN * (len(panels) + 1), _WIDTH_IN)
    tall_in = height_in + heading_in + _SIDE_IN
    figure.set_size_inches(total_in, tall_in)
    left = _SIDE_IN
    for ax, width in zip(panels, widths, strict=True):
        ax.set_position(
            (left / total_in, _SIDE_IN / tall_in, width / total_in, height_in / tall_in)
        )
        left += width + _SIDE_IN
    return figure


def _stack(draws: Sequence[Draw]) -> Figure:
    """One panel over the other in one scale: the figure grows as tall as they need."""
    figure = Figure()
    panels = [draw(ax=figure.add_subplot(len(draws), 1, i)) for i, draw in enumerate(draws, 1)]
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
    return figure


def _span(ax: Axes) -> tuple[float, float]:
    """Width and height of what is shown, in data units."""
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    return abs(right - left), abs(top - bottom)


def draw_mosaic(mosaic: Mosaic, ax: Axes, *, cells: int = 8, title: str = "") -> Axes:
    """``cells`` x ``cells`` pixels of the mosaic, each with its letter; one block is outlined.

    Parameters
    ----------
    cells
        Number of pixels on a side.
    """
    (height, width), pattern = mosaic.shape, mosaic.pattern
    for row in range(cells):
        for column in range(cells):
            name = pattern[row % height][column % width]
            face, ink = ("white", INK) if name == "W" else (channel_color(name), "white")
            look: dict[str, Any] = {"facecolor": face, "edgecolor": QUIET, "linewidth": 0.6}
            ax.add_patch(Rectangle((column, row), 1, 1, **look))
            centered: dict[str, Any] = {"ha": "center", "va": "center_baseline"}
            letter: dict[str, Any] = {"color": ink, "fontweight": "bold", "fontsize": 11}
            ax.text(column + 0.5, row + 0.5, name, **centered, **letter)
    ax.add_patch(Rectangle((0, 0), width, height, fill=False, edgecolor=INK, linewidth=2.6))
    ax.set(xlim=(-0.08, cells + 0.08), ylim=(cells + 0.08, -0.08), title=title)
    ax.set_aspect("equal")
    ax.set_axis_off()
    return ax


_LOOKS = {
    "x": (channel_color("R"), (0, (6, 2))),
    "y": (channel_color("G"), "solid"),
    "z": (channel_color("B"), (0, (2, 1.2))),
}


def draw_observer(observer: Spectra, ax: Axes) -> Axes:
    """The color-matching functions x, y, z over wavelength, each with its letter at its peak."""
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
