"""The curves of EMVA 1288 for a characterized camera, each on one axes with all planes."""

from collections.abc import Sequence
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from chromanoise.apps.camera.characterization import Characterization
from chromanoise.apps.camera.exports import color_of_plane
from chromanoise.apps.camera.planes import PlaneCurves, plane_curves
from chromanoise.charts import INK, QUIET, channel_color, chromanoise_style

_MARKERS = "os^Dv<>Ph*"
_SIZE_IN = (4.2, 3.2)  # small, so that its text is legible on a phone
_NOTICED_Z = 3.0
_LEAST_PERCENT = 0.2  # of the axis of deviations, so that rounding does not fill it
_SIGNAL = "signal above dark [DN]"
_LIGHT = {"photons": "photons per pixel", "ms": "exposure time [ms]"}


def draw_photon_transfer(curves: Sequence[PlaneCurves], ax: Axes) -> Axes:
    """Variance above dark over signal of each plane, with the line of its gain. [DN^2]

    Filled points were fitted; bars are standard errors.
    """
    for one in curves:
        bars: dict[str, Any] = {"fmt": "none", "ecolor": _color(one.name), "elinewidth": 0.8}
        ax.errorbar(one.signal_dn, one.shot_dn2, yerr=one.shot_se_dn2, **bars)
    ax.set(xlabel=_SIGNAL, ylabel="variance above dark [DN²]")
    points = [(one.signal_dn, one.shot_dn2) for one in curves]
    lines = [([0, one.model_signal_dn[-1]], [0, one.model_shot_dn2[-1]]) for one in curves]
    return _planes(curves, ax, points, lines, zero="xy")


def draw_snr(curves: Sequence[PlaneCurves], ax: Axes) -> Axes:
    """SNR over signal of each plane: measured, of the linear model, of shot noise alone. [dB]"""
    dashed: dict[str, Any] = {"color": QUIET, "lw": 0.9, "ls": (0, (5, 3))}
    for one in curves:
        ax.plot(one.model_signal_dn, 20 * np.log10(one.ideal_snr), **dashed)
    ax.plot([], [], label="shot noise only", **dashed)
    ax.set(xscale="log", xlabel=_SIGNAL, ylabel="SNR [dB]")
    points = [(one.signal_dn, 20 * np.log10(one.snr)) for one in curves]
    lines = [(one.model_signal_dn, 20 * np.log10(one.model_snr)) for one in curves]
    return _planes(curves, ax, points, lines)


def draw_linearity(curves: Sequence[PlaneCurves], ax: Axes) -> Axes:
    """Signal over light of each plane with light, with the fitted line. [DN]"""
    ax.set(xlabel=_light_label(curves), ylabel=_SIGNAL)
    points = [(one.light, one.signal_dn) for one in curves]
    return _planes(curves, ax, points, [(one.light, one.line_dn) for one in curves], zero="xy")


def draw_linearity_deviation(curves: Sequence[PlaneCurves], ax: Axes) -> Axes:
    """Deviation of the signal from the fitted line over light, from 5 to 95 % of saturation. [%]"""
    ax.axhline(0, color=QUIET, lw=0.8)
    points = [(one.light, one.deviation_percent) for one in curves]
    largest = [1.2 * float(np.nanmax(np.abs(y))) for _, y in points if y is not None]
    most = max([_LEAST_PERCENT, *largest])
    ax.set(xlabel=_light_label(curves), ylabel="deviation from the line [%]", ylim=(-most, most))
    return _planes(curves, ax, points, points, zero="x")


def draw_variance_residuals(curves: Sequence[PlaneCurves], ax: Axes) -> Axes:
    """Measured minus predicted variance over its standard error, over signal. [1]"""
    ax.axhspan(-_NOTICED_Z, _NOTICED_Z, color=QUIET, alpha=0.12, lw=0)
    ax.axhline(0, color=QUIET, lw=0.8)
    ax.set_yscale("symlog", linthresh=5, linscale=2)
    ax.set_yticks([-1000, -100, -10, -3, 0, 3, 10, 100, 1000], minor=False)
    ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    ax.set_yticks([], minor=True)
    points = [(one.signal_dn, one.residual_z) for one in curves]
    most = max([6.0, *(1.5 * float(np.abs(z).max()) for _, z in points)])
    ax.set(xlabel=_SIGNAL, ylabel="(measured − predicted) / error", ylim=(-most, most))
    return _planes(curves, ax, points, zero="x")


def draw_predicted_variance(curves: Sequence[PlaneCurves], ax: Axes) -> Axes:
    """Measured over predicted variance of each level, on logarithmic axes. [DN^2]"""
    every = np.concatenate([c.predicted_dn2[c.predicted_dn2 > 0] for c in curves])
    if every.size:
        ends = [float(every.min()), float(every.max())]
        ax.plot(ends, ends, color=QUIET, lw=0.9, label="equal")
    ax.set(xscale="log", yscale="log")
    ax.set(xlabel="predicted variance [DN²]", ylabel="measured variance [DN²]")
    return _planes(curves, ax, [(one.predicted_dn2, one.variance_dn2) for one in curves])


def draw_characterization(result: Characterization, ax: Axes) -> Axes:
    """The photon transfer of a characterization, with the camera in the title. [DN^2]"""
    ax.set_title(_text(result.to_table().title))
    return draw_photon_transfer(_curves(result), ax)


def characterization_figures(result: Characterization) -> dict[str, Figure]:
    """A figure of each kind of curve for which the result has data.

    Returns
    -------
    dict
        ``photon_transfer``, ``snr``, ``linearity``, ``linearity_deviation``,
        ``predicted_variance``, ``variance_residuals``; without light on the levels, no linearity.
    """
    curves = _curves(result)
    lit = [one for one in curves if one.light is not None]
    straight = [one for one in lit if one.deviation_percent is not None]
    drawn = (
        ("photon_transfer", draw_photon_transfer, curves),
        ("snr", draw_snr, curves),
        ("linearity", draw_linearity, lit),
        ("linearity_deviation", draw_linearity_deviation, straight),
        ("predicted_variance", draw_predicted_variance, curves),
        ("variance_residuals", draw_variance_residuals, curves),
    )
    figures = {}
    with chromanoise_style():
        for name, draw, shown in drawn:
            if shown:
                figure = Figure(figsize=_SIZE_IN, layout="constrained")
                draw(shown, figure.add_subplot())
                figures[name] = figure
    return figures


def _curves(result: Characterization) -> list[PlaneCurves]:
    return [one for plane in result.planes if (one := plane_curves(plane)) is not None]


_Line = tuple[Any, Any]
"""x and y of points or a line; ``None`` for y, or x, where a plane has none."""


def _planes(
    curves: Sequence[PlaneCurves],
    ax: Axes,
    points: Sequence[_Line],
    lines: Sequence[_Line] = (),
    *,
    zero: str = "",
) -> Axes:
    """Line and points of each plane, filled where the level was fitted; grid and legend.

    ``zero`` names the axes that begin at 0.
    """
    drawn = zip(curves, points, lines or [(None, None)] * len(curves), strict=True)
    for (curve, (x, y), line), marker in zip(drawn, cycle(_MARKERS), strict=False):
        color, at = _color(curve.name), curve.fitted
        if x is None or y is None:
            continue
        if all(one is not None for one in line):
            ax.plot(*line, color=color, lw=1)
        style: dict[str, Any] = {"linestyle": "none", "marker": marker, "markersize": 4.5}
        ax.plot(x[at], y[at], label=_text(curve.name), color=color, **style)
        ax.plot(x[~at], y[~at], color=color, markerfacecolor="none", **style)
    if "x" in zero:
        ax.set_xlim(left=0)
    if "y" in zero:
        ax.set_ylim(bottom=0)
    ax.set_axisbelow(True)
    ax.grid(visible=True, color=QUIET, alpha=0.25, linewidth=0.6)
    if len(curves) > 1 or len(ax.get_legend_handles_labels()[1]) > 1:
        ax.legend(fontsize=8, framealpha=0, handletextpad=0.4, ncols=1 + len(curves) // 6)
    return ax


def _light_label(curves: Sequence[PlaneCurves]) -> str:
    return _LIGHT[next((c.light_unit for c in curves if c.light_unit), "ms") or "ms"]


def _text(name: str) -> str:
    """A name as plain text: no formula, and not hidden from the legend."""
    return f" {name}".replace("$", r"\$") if name.startswith("_") else name.replace("$", r"\$")


def _color(name: str) -> str:
    color = color_of_plane(name)
    return INK if color == "mono" else channel_color(color)
