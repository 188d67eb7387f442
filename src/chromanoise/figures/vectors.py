"""Arrows, axes, dropped perpendiculars and labels: the pen of `figures.geometry`."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Polygon

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.figures.style import FAINT, QUIET, write_beside

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
