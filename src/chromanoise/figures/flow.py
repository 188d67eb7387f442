"""Figure 2: the stages from scene to color, with the numbers of one analysis."""

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyBboxPatch

from chromanoise.analysis import Analysis, color_snr_db, contravariant_snr_db, metric_of, raw_snr_db
from chromanoise.figures.style import INK, QUIET, channel_color, sensor_label

_STAGES = (  # name, symbol, equation, what its numbers are
    ("Scene", r"$\mathbf{L}$", "light", "one flat patch"),
    ("Exposure", r"$\mathbf{M}=\mathbf{F}^T\mathbf{L}$", "eq. 1–2", "electrons"),
    ("Noise", r"$\mathrm{var}=M+\sigma_{rn}^2$", "eq. 7", "raw SNR"),
    (
        "Spectrum",
        r"$\hat{\mathbf{L}}=\mathbf{F}(\mathbf{F}^T\mathbf{F})^{-1}\mathbf{M}$",
        "eq. 3–4",
        "contravariant SNR",
    ),
    ("Color", r"$\mathbf{H}^T\hat{\mathbf{L}}$", "eq. 5", "XYZ, and its SNR"),
)
_PITCH, _BOX = 1.0, 0.80
_TOP, _BOX_HEIGHT, _ROW = 0.0, 0.62, 0.19


def draw_flow(analysis: Analysis, ax: Axes, *, rows: int = 4) -> Axes:
    """Draw scene, exposure, noise, spectrum and color in a row, with their numbers below.

    Parameters
    ----------
    analysis
        Results of one sensor.
    ax
        Axes of matplotlib to draw on.
    rows
        Number of rows for channels, so that panels of different sensors have equal height.
    """
    for i, stage in enumerate(_STAGES):
        _draw_stage(ax, i, stage)
    for i in range(len(_STAGES) - 1):
        _draw_step(ax, i)
    _write_scene(analysis, ax)
    electrons = [f"{mean:.0f} e$^-$" for mean in analysis.raw.mean]
    ratios = (raw_snr_db(analysis), contravariant_snr_db(analysis))
    columns = [electrons, *(list(map(_decibels, one.values())) for one in ratios)]
    for column, texts in enumerate(columns, start=1):
        _write_column(ax, column, analysis.sensor.names, texts, channel_color)
    _write_column(ax, 4, analysis.color.names, _color(analysis), lambda _: INK)
    exposure = analysis.exposure
    label = sensor_label(analysis.sensor.name, analysis.sensor.origin)
    ax.set_title(
        f"{label} at {1e3 * exposure.time_s:.1f} ms, f/{exposure.f_number:g}; "
        f"{metric_of([analysis])}"
    )
    last = (len(_STAGES) - 1) * _PITCH + _BOX
    ax.set(xlim=(-0.02, last + 0.02), ylim=(_BOX_HEIGHT + (rows + 1.4) * _ROW, -0.03))
    ax.set_axis_off()
    return ax


def _draw_stage(ax: Axes, i: int, stage: tuple[str, str, str, str]) -> None:
    name, symbol, equation, note = stage
    left, middle = i * _PITCH, i * _PITCH + _BOX / 2
    box = FancyBboxPatch(
        (left, _TOP),
        _BOX,
        _BOX_HEIGHT,
        boxstyle="round,pad=0,rounding_size=0.06",
        facecolor="#F4F4F4",
        edgecolor=QUIET,
        linewidth=0.8,
    )
    ax.add_patch(box)
    ax.text(middle, 0.14, name, ha="center", va="center", fontweight="bold")
    ax.text(middle, 0.33, symbol, ha="center", va="center", fontsize=8)
    ax.text(middle, 0.50, equation, ha="center", va="center", color=QUIET, fontsize=8)
    ax.text(left, _row_at(0), note, ha="left", va="center", color=QUIET, fontsize=8)


def _draw_step(ax: Axes, i: int) -> None:
    start = i * _PITCH + _BOX
    ax.annotate(
        "",
        xy=((i + 1) * _PITCH - 0.02, _BOX_HEIGHT / 2),
        xytext=(start + 0.02, _BOX_HEIGHT / 2),
        arrowprops={"arrowstyle": "-|>", "color": INK, "shrinkA": 0, "shrinkB": 0},
    )


def _write_scene(analysis: Analysis, ax: Axes) -> None:
    scene = analysis.scene
    lines = (
        f"{scene.level_lux:g} lx",
        f"illuminant {scene.illuminant.name}",
        _reflectance(analysis),
    )
    for row, line in enumerate(lines, start=1):
        ax.text(0, _row_at(row), line, va="center")


def _reflectance(analysis: Analysis) -> str:
    rho = analysis.scene.reflectance
    low, high = float(np.min(rho)), float(np.max(rho))
    return f"reflectance {low:g}" + ("" if low == high else f"–{high:g}")


def _write_column(
    ax: Axes, i: int, names: tuple[str, ...], texts: list[str], color: Callable[[str], str]
) -> None:
    for row, (name, text) in enumerate(zip(names, texts, strict=True), start=1):
        at = _row_at(row)
        ax.text(i * _PITCH, at, name, va="center", color=color(name), fontweight="bold")
        weight = "bold" if name == "Y" else "normal"  # the number that the paper is about
        ax.text(i * _PITCH + _BOX, at, text, ha="right", va="center", fontweight=weight)


def _row_at(row: int) -> float:
    return _BOX_HEIGHT + (row + 0.8) * _ROW


def _color(analysis: Analysis) -> list[str]:
    ratios = color_snr_db(analysis)
    return [
        f"{value:.1f} lx,  {_decibels(ratios[name])}"
        for name, value in zip(analysis.color.names, analysis.color.mean, strict=True)
    ]


def _decibels(value: float | None) -> str:
    return "undefined" if value is None else f"{value:.1f} dB"
