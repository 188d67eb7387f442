"""Figures 3, 4, 6, 9 and 10: two channels, the light and its uncertainty in their true plane.

Every panel is to scale: lengths and angles are those of the n-dimensional vectors. The arrows
f are in another unit than the light and share one factor of their own.
"""

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes

from chromanoise.figures.style import INK, QUIET, channel_color, sensor_label, write_heading
from chromanoise.figures.vectors import (
    draw_angle,
    draw_area,
    draw_arrow,
    draw_axis,
    draw_bar,
    draw_drop,
    draw_point,
    fit_view,
    write_at,
)
from chromanoise.study.views import ChannelPlane, MagnifiedNoise

Array = np.ndarray

_ORIGIN = np.zeros(2)
_AXIS_DASHES = (0, (7, 2, 1.5, 2))  # of a color axis: no channel and no sensor has it
_NO_NOISE = "to scale, without noise"


def draw_light_above_plane(plane: ChannelPlane, ax: Axes) -> Axes:
    """The plane of two channels seen edge-on: how far the light stands above it."""
    tilt = np.radians(plane.light_tilt_deg)
    tip = plane.light_length * np.array([np.cos(tilt), np.sin(tilt)])
    foot = tip * [1.0, 0.0]
    draw_axis(ax, np.array([1.25 * foot[0], 0.0]), QUIET)
    write_at(ax, foot / 2, "plane of\n" + " and ".join(plane.channels), (0, -1), QUIET, points=16)
    draw_drop(ax, tip, foot)
    draw_arrow(ax, _ORIGIN, tip, INK)
    draw_arrow(ax, _ORIGIN, foot, INK)
    draw_angle(ax, foot, tip, f"{plane.light_tilt_deg:.1f}°")
    write_at(ax, tip, r"$\mathbf{L}$", tip, INK)
    write_at(ax, foot, r"$\hat{\mathbf{L}}$", (1, 1), INK)
    write_heading(ax, "Seen edge-on", _NO_NOISE)
    fit_view(ax, [_ORIGIN, tip, foot * 1.25], margin=0.16)
    return ax


def draw_measurement(plane: ChannelPlane, ax: Axes) -> Axes:
    """Figure 3: raw electrons as orthogonal projections of the light on the channels."""
    _draw_channels(plane, ax)
    _draw_light(plane, ax)
    draw_angle(ax, *plane.arrows, f"{plane.angle_deg:.1f}°")
    sides = _outward(plane)
    for i, name in enumerate(plane.channels):
        draw_drop(ax, plane.measured.mean, plane.feet[i])
        draw_point(ax, plane.feet[i], channel_color(name))
        electrons = f"$M_{{{name}}}$ = {plane.two.raw.mean[i]:.0f} e$^-$"
        write_at(ax, plane.feet[i], electrons, sides[i], channel_color(name), points=14)
    write_heading(ax, f"Covariant coordinates: {_source(plane)}", _facts(plane, _NO_NOISE))
    fit_view(ax, [_ORIGIN, plane.measured.mean, *_tips(plane)])
    return ax


def draw_contravariant(plane: ChannelPlane, ax: Axes) -> Axes:
    """Figure 4: contravariant coordinates, whose parallelogram closes at the measured light."""
    _draw_channels(plane, ax)
    draw_angle(ax, *plane.arrows, f"{plane.angle_deg:.1f}°")
    sides = _outward(plane)
    for i, name in enumerate(plane.channels):
        part, color = plane.parts[i], channel_color(name)
        draw_drop(ax, plane.measured.mean, part, square=False)
        draw_arrow(ax, _ORIGIN, part, color, wide=True)
        label = rf"$M^{{{name}}}\,\mathbf{{f}}_{{{name}}}$"
        write_at(ax, part, label, sides[i], color, points=14)
    _draw_light(plane, ax)
    write_heading(ax, f"Contravariant coordinates: {_source(plane)}", _facts(plane, _NO_NOISE))
    fit_view(ax, [_ORIGIN, plane.measured.mean, *_tips(plane), *plane.parts])
    return ax


def draw_color_projection(plane: ChannelPlane, ax: Axes) -> Axes:
    """Figure 6: a color coordinate as the orthogonal projection of L^ on a color axis."""
    _draw_channels(plane, ax)
    _draw_color_axis(plane, ax)
    draw_drop(ax, plane.measured.mean, plane.axis.foot)
    _draw_light(plane, ax)
    draw_point(ax, plane.axis.foot, INK)
    letter = plane.axis.name.upper()
    value = rf"$\hat{{{letter}}}$ = {plane.axis.color:.2f} lx"
    away = plane.axis.foot - plane.measured.mean
    write_at(ax, plane.axis.foot, value, away, INK, points=16)
    write_heading(
        ax, f"Projection on {plane.axis.name}: {_source(plane)}",
        _facts(plane, _NO_NOISE) + "\n" + _tilt(plane),
    )
    fit_view(ax, [_ORIGIN, plane.measured.mean, *_tips(plane), _axis_tip(plane)])
    return ax


def draw_uncertainty(
    plane: ChannelPlane, noise: MagnifiedNoise, ax: Axes, *, title: str = ""
) -> Axes:
    """Figure 9: the zone of the measured light that the noise of two channels leaves open."""
    _draw_channels(plane, ax)
    _draw_noise(noise, ax)
    sides = _outward(plane)
    for i, name in enumerate(plane.channels):
        color = channel_color(name)
        for end, corner in zip(noise.feet_bars[i], _locus_sides(noise, i), strict=True):
            draw_drop(ax, corner, end, square=False)
        draw_bar(ax, noise.feet_bars[i], color)
        write_at(ax, plane.feet[i], f"$M_{{{name}}}$", sides[i], color, points=14)
    _draw_light(plane, ax, arrow_only=True)
    draw_angle(ax, *plane.arrows, f"{plane.angle_deg:.1f}°")
    snr = _decibels(r"SNR of $\hat{\mathbf{L}}$", _spectral_snr_db(plane))
    write_heading(
        ax, f"{title}{_source(plane)}", f"{_facts(plane, _magnified(noise))} · {snr}"
    )
    fit_view(ax, [_ORIGIN, *_tips(plane), *noise.outline, *noise.locus])
    return ax


def draw_color_uncertainty(
    plane: ChannelPlane, noise: MagnifiedNoise, ax: Axes, *, title: str = ""
) -> Axes:
    """Figure 10: the uncertainty of the measured light, projected on a color axis."""
    _draw_channels(plane, ax)
    _draw_color_axis(plane, ax)
    _draw_noise(noise, ax)
    for end in noise.axis_bar:
        draw_drop(ax, _touching(noise.outline, end), end, square=False)
    draw_bar(ax, noise.axis_bar, INK)
    _draw_light(plane, ax, arrow_only=True)
    letter = plane.axis.name.upper()
    away = plane.axis.foot - plane.measured.mean
    write_at(ax, plane.axis.foot, rf"$\hat{{{letter}}}$", away, INK, points=16)
    snr = _decibels(f"SNR$_{letter}$ of these two channels", plane.axis.color_snr_db)
    write_heading(
        ax, f"{title}{_source(plane)}",
        f"{_facts(plane, _magnified(noise))}\n{_tilt(plane)} · {snr}",
    )
    fit_view(ax, [_ORIGIN, *_tips(plane), _axis_tip(plane), *noise.outline, *noise.axis_bar])
    return ax
