"""Noise ellipses of ColorChecker patches: true and measured colors in planes of color spaces.

The ellipses are drawn at two standard deviations.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from chromanoise.base import Array, Bool, Float, check, dataclass, eigvalsh, kept
from chromanoise.charts.charted_study import Look, Shown, saturation_sentence
from chromanoise.charts.description import Axis, Chart, Column, Ellipses, Panel, Value, column
from chromanoise.charts.numbers import decimal
from chromanoise.color import (
    LAB,
    XYY,
    ColorNoise,
    NoisyColor,
    Space,
    SpaceMoments,
    adapted_to_d65,
    cielab,
    cubature,
    gaussian_cubature,
    propagate,
    srgb_from_xyz,
    xyy,
)
from chromanoise.geometry import ellipse_half_axes
from chromanoise.metrics import chart_color_error
from chromanoise.noise import Measurement, conditions, through
from chromanoise.spectra import chart_on, chart_title
from chromanoise.study import (
    LOST_DELTA_E,
    Analysis,
    color_snr_db,
    noisy_color_at,
    of_white,
    stages_at,
)


@dataclass(frozen=True, kw_only=True, eq=False)
class Patches:
    """Color and noise of each patch, with the light and exposure of an analysis.

    Attributes
    ----------
    names
        Names of the patches.
    truth, xyz
        X, Y, Z for the observer, and measured by the sensor with covariance. [lx]
    true_white, white
        The same for a perfect white. [lx]
    color_error
        Color error without noise. [Delta E*ab]
    noise
        Noise in CIELAB, relative to the sensor's own white, for normally distributed noise.
    """

    names: tuple[str, ...]
    truth: Float[Array, "k 3"]
    true_white: Float[Array, " 3"]
    xyz: Measurement
    white: Float[Array, " 3"]
    color_error: Float[Array, " k"]
    noise: ColorNoise

    def __post_init__(self) -> None:
        check.freeze(self, "truth", "true_white", "white", "color_error")

    @property
    def is_lost(self) -> Bool[Array, " k"]:
        """Whether the noise of one pixel hides the color of the patch."""
        assert self.noise.delta_e is not None  # CIELAB has one
        return np.asarray(self.noise.delta_e >= LOST_DELTA_E)


def quick_cubature(color: NoisyColor, space: Space) -> SpaceMoments:
    """The cubature with 384 points; its error is below 3e-3 of a standard deviation."""
    return cubature(color, space, rule=gaussian_cubature(radii=6, latitudes=4, longitudes=8))


@kept  # chart and ellipses draw the same ones
def patches_of(analysis: Analysis) -> Patches | None:
    """The patches for an analysis, cached; ``None`` where X, Y or Z of white is not above 0.

    The noise is averaged over the Gaussian by 384 points per patch, with errors below 3e-3 of a
    standard deviation. The exact distribution (`chromanoise.study.chart_noise`) takes seconds,
    and differs where a patch has only about ten electrons.
    """
    sensor, exposure, matrix = analysis.sensor, analysis.exposure, analysis.matrix
    lamp, white = analysis.scene.illuminant, of_white(analysis)
    errors = chart_color_error(sensor, matrix, exposure, lamp, analysis.chart)
    if errors is None or None in color_snr_db(white).values():
        return None
    chart = chart_on(sensor.grid, analysis.chart)
    at = stages_at(analysis.point, matrix, reflectance=chart.values.T, readout=analysis.readout)
    color = noisy_color_at(at, matrix.matrix @ white.expected_e)
    return Patches(
        names=chart.names,
        truth=at.truth_xyz,
        true_white=white.truth_xyz,
        xyz=color.xyz,
        white=color.white,
        color_error=errors,
        noise=propagate(color, LAB, quick_cubature),
    )


def why_no_patches(analysis: Analysis) -> str:
    """Why the chart of a sensor cannot be shown."""
    return saturation_sentence(analysis) or (
        f"{analysis.sensor.label}: the matrix gives no valid XYZ of the white under this light, so "
        "its chart has no colors; use another matrix or another light"
    )


def hex_colors(xyz: Float[Array, "k 3"], white: Float[Array, " 3"]) -> list[str]:
    """Hexadecimal sRGB codes of colors, with out-of-gamut colors clipped.

    Parameters
    ----------
    xyz, white
        Colors and white in the same unit; the white is adapted to that of the screen.

    Examples
    --------
    >>> hex_colors(np.array([[0.5, 0.5, 0.5], [0.0, 0.0, 0.0]]), np.full(3, 0.5))
    ['#ffffff', '#000000']
    """
    relative = adapted_to_d65(xyz / white[1], white / white[1])
    codes = np.rint(255 * srgb_from_xyz(relative)).astype(int)
    return [f"#{r:02x}{g:02x}{b:02x}" for r, g, b in codes.tolist()]


SIGMAS = 2.0
_NAMES = {"ab": ("a*", "b*"), "xy": ("x", "y")}
_SHOWN_DECIMALS = {"ab": 1, "xy": 4}
_MOST_WHOLE, _MOST_LARGER = 3, 4.0
_NONE = 1e-9  # of the plane's unit: a spread below it is rounding
_KEY = (
    "Cross: the true color. Line: from it to the color that is measured. "
    f"Ellipse: {SIGMAS:g} standard deviations of the noise."
)


def drawn_ellipses(shown: Shown, look: Look) -> Chart:
    """True color, mean, half axes and reach, per patch and sensor."""
    return ellipses_of(shown.analyses, look.plane)


def ellipses_of(analyses: Sequence[Analysis], plane: str) -> Chart:
    """The chart ``ellipses`` of some analyses under one light."""
    points = [one.point for one in analyses]
    sensors = [_sensor(analysis, plane) for analysis in analyses]
    across, up = _NAMES[plane]
    low, high = _window([one for one in sensors if one.colors])
    x, y = (Axis(label=_NAMES[plane][k], low=low[k], high=high[k], exact=True) for k in (0, 1))
    panels, first = [], 0
    for i, one in enumerate(sensors):
        last = first + len(one.rows)
        ellipses = Ellipses(
            truth=(2, 3),
            center=(4, 5),
            half_axes=(6, 7, 8, 9),
            reach=10,
            first=first,
            last=last,
            colors=one.colors,
        )
        panels.append(
            Panel(
                x=x,
                y=y,
                marks=(ellipses,) if one.colors else (),
                sensor=i,
                equal=True,
                remark="larger than the panel" if _is_larger(one, low, high) else one.lost,
                absence=one.why_not,
            )
        )
        first = last
    rows = [row for one in sensors for row in one.rows]
    drawn = any(one.colors for one in sensors)
    return Chart(
        title=f"Noise of {chart_title(points[0].chart)} in {across} and {up}, "
        f"{SIGMAS:g} standard deviations, at {conditions(points)}",
        description=_description(sensors, plane),
        sensors=tuple(one.name for one in sensors),
        columns=_columns(rows, plane),
        panels=tuple(panels) if drawn else (),
        whole_rows=True,
        notes=(_KEY,) if drawn else tuple(one.why_not for one in sensors),
        without_numbers=tuple(i for i, row in enumerate(rows) if row[2] is None),
    )


def _columns(rows: Sequence[Sequence[Value]], plane: str) -> tuple[Column, ...]:
    across, up = _NAMES[plane]
    heads = ["sensor", "patch"]
    for what in ("true", "measured", "conjugate half axis 1", "conjugate half axis 2"):
        heads += [f"{what} {across}", f"{what} {up}"]
    number = partial(decimal, digits=_SHOWN_DECIMALS[plane])
    texts = [str, str, *[number] * 4, *[None] * 4, number]
    heads.append(f"reach of {SIGMAS:g} sigma")
    values = zip(*rows, strict=True)
    return tuple(column(*each) for each in zip(heads, values, texts, strict=True))


@dataclass(frozen=True, kw_only=True)
class _Drawn:
    """The rows of one sensor; a row with the reason, and no colors, where it has none."""

    name: str
    rows: tuple[tuple[Value, ...], ...]
    colors: tuple[str, ...] = ()
    why_not: str = ""
    lost: str = ""


def _window(sensors: Sequence[_Drawn]) -> tuple[list[float], list[float]]:
    """Lowest and highest coordinates of the panels.

    They hold all ellipses of up to three sensors. Of more, they omit what is more than four times
    as large as the ellipses of the median sensor, or small ellipses would be dots.
    """
    if not sensors:
        return [0.0, 0.0], [1.0, 1.0]
    boxes = np.array([_box(sensor) for sensor in sensors])
    sizes = np.ptp(boxes, axis=1).max(axis=1)
    usual = float(np.quantile(sizes, 0.5, method="lower"))
    small = boxes[sizes <= _MOST_LARGER * usual] if len(boxes) > _MOST_WHOLE else boxes
    return small[:, 0].min(axis=0).tolist(), small[:, 1].max(axis=0).tolist()


def _box(sensor: _Drawn) -> Float[Array, "2 2"]:
    """Lowest and highest coordinates of true colors and of ellipses of one sensor."""
    values = np.array([row[2:10] for row in sensor.rows], dtype=float).reshape(-1, 4, 2)
    truth, center, right, up = values.transpose(1, 0, 2)
    reach = np.hypot(right, up)  # of conjugate half axes, along each coordinate
    low, high = np.minimum(truth, center - reach), np.maximum(truth, center + reach)
    return np.stack([low.min(axis=0), high.max(axis=0)])


def _is_larger(sensor: _Drawn, low: Sequence[float], high: Sequence[float]) -> bool:
    if not sensor.colors:
        return False
    lowest, highest = _box(sensor)
    return bool((lowest < low).any() or (highest > high).any())


def in_plane(
    seen: Patches, plane: str
) -> tuple[Float[Array, "k 2"], Float[Array, "k 2"], Float[Array, "k 2 2"]]:
    """Truth, mean and covariance of each patch in the plane, averaged over the Gaussian.

    In ``ab`` truth and measurement are relative to their own white. In ``xy`` the sensor's X, Y, Z
    are scaled so that its white equals that of the light.

    Parameters
    ----------
    seen
        The chart measured by one sensor, ``k`` patches.
    plane
        ``ab`` of CIELAB (CIE 15:2018), or ``xy`` of the CIE chromaticities.
    """
    if plane == "ab":
        noise = seen.noise.measurement
        truth = cielab(seen.truth, seen.true_white)[:, 1:]
        return truth, noise.mean[:, 1:], noise.covariance[:, 1:, 1:]
    color = NoisyColor(xyz=_balanced(seen), white=seen.true_white)
    noise = propagate(color, XYY, quick_cubature).measurement
    truth = xyy(seen.truth, seen.true_white)[:, :2]
    return truth, noise.mean[:, :2], noise.covariance[:, :2, :2]


def _balanced(seen: Patches) -> Measurement:
    gains = np.diag(seen.true_white / seen.white)
    return through(seen.xyz, gains, names=seen.xyz.names, kind="XYZ", unit="lx")


def _sensor(analysis: Analysis, plane: str) -> _Drawn:
    seen, name = patches_of(analysis), analysis.sensor.label
    if seen is None:
        return _not_drawn(name, why_no_patches(analysis))
    if seen.is_lost.all():
        return _not_drawn(
            name, f"{name}: no color information in one pixel at this level: all patches are lost"
        )
    truth, center, covariance = in_plane(seen, plane)
    # an ellipse that is a line or a point is drawn all the same
    half_axes = ellipse_half_axes(covariance + _NONE**2 * np.eye(2), sigmas=SIGMAS)
    reach = SIGMAS * np.sqrt(
        eigvalsh("covariance of a patch", covariance)[:, -1].clip(min=0.0)
    )  # of the covariance itself
    numbers = np.column_stack([truth, center, half_axes.reshape(-1, 4), reach]).tolist()
    colors = hex_colors(seen.truth, seen.true_white)
    kept, lost = np.flatnonzero(~seen.is_lost).tolist(), int(seen.is_lost.sum())
    return _Drawn(
        name=name,
        rows=tuple((name, seen.names[k], *numbers[k]) for k in kept),
        colors=tuple(colors[k] for k in kept),
        lost=f"{lost} of {lost + len(kept)} patches are lost in the noise" if lost else "",
    )


def _not_drawn(name: str, why_not: str) -> _Drawn:
    return _Drawn(name=name, rows=((name, why_not, *[None] * 9),), why_not=why_not)


def _description(sensors: Sequence[_Drawn], plane: str) -> str:
    count = max(len(sensor.colors) for sensor in sensors)
    parts = [f"{SIGMAS:g}-sigma ellipses of {count} patches, both axes to the same scale."]
    for sensor in sensors:
        if not sensor.colors:
            parts.append(f"{sensor.why_not}.")
            continue
        _, patch, *_, reach = max(sensor.rows, key=lambda row: float(row[-1] or 0.0))
        parts.append(
            f"{sensor.name}: the largest ellipse is that of {patch}, reaching "
            f"{decimal(float(reach or 0.0), 3 if plane == 'xy' else 1)} from its center."
        )
    return " ".join(parts)
