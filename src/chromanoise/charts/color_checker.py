"""Color error and noise of every ColorChecker patch."""

from collections.abc import Sequence
from functools import partial

from chromanoise.charts.charted_study import Look, Shown
from chromanoise.charts.description import Chart, Column, Panel, Swatches, Value, column
from chromanoise.charts.ellipses import Patches, hex_colors, patches_of, why_no_patches
from chromanoise.charts.numbers import decimal
from chromanoise.noise import conditions
from chromanoise.spectra import chart_title
from chromanoise.study import LOST_DELTA_E

_KEY = (
    "Strip: the true color. Bold: color error ΔE*ab without noise. n: noise of one pixel, ΔE*ab "
    "(CIE 1976); lost: no color information in one pixel, as its noise is above "
    f"{LOST_DELTA_E:g} ΔE*ab."
)


def drawn_chart(shown: Shown, look: Look) -> Chart:
    """True and measured color of each patch, with CIE 1976 color error and noise."""
    found = [patches_of(analysis) for analysis in shown.analyses]
    names = tuple(analysis.sensor.label for analysis in shown.analyses)
    why_not = [
        why_no_patches(analysis) if seen is None else ""
        for analysis, seen in zip(shown.analyses, found, strict=True)
    ]
    first = next((one for one in found if one is not None), None)
    marks: list[Swatches] = []
    columns: list[Column] = []
    parts = ["Color error and noise, both CIE 1976 differences."]
    if first is not None:
        marks.append(Swatches(colors=tuple(hex_colors(first.truth, first.true_white))))
        columns.append(column("patch", first.names))
    for i, (name, seen, reason) in enumerate(zip(names, found, why_not, strict=True)):
        parts.append(f"{reason}." if seen is None else _described(name, seen))
        marks.append(_swatches(name, i, seen))
        columns += _columns(name, seen, len(first.names)) if first else []
    chart = chart_title(shown.operating_points[0].chart)
    return Chart(
        title=f"Color error and noise of {chart} at {conditions(shown.operating_points)}",
        description=" ".join(parts),
        sensors=names,
        columns=tuple(columns)
        or (column(None, names, shown="sensor"), column(None, why_not, shown="why")),
        panels=(Panel(marks=tuple(marks)),) if first else (),
        notes=(_KEY,) if first else tuple(why_not),
    )


def _errors(seen: Patches) -> tuple[list[float], list[float]]:
    """Color error and noise of each patch. [Delta E*ab]"""
    assert seen.noise.delta_e is not None  # CIELAB has one
    return seen.color_error.tolist(), seen.noise.delta_e.tolist()


def _swatches(name: str, i: int, seen: Patches | None) -> Swatches:
    if seen is None:
        return Swatches(colors=(), sensor=i, name=name)
    errors, noises = _errors(seen)
    mean, spread = _short(sum(errors) / len(errors)), _noise(sum(noises) / len(noises))
    return Swatches(
        colors=tuple(hex_colors(seen.xyz.mean, seen.white)),
        sensor=i,
        name=f"{name}, mean {mean}, {spread}",
        texts=tuple(
            (_short(error), _noise(noise)) for error, noise in zip(errors, noises, strict=True)
        ),
    )


def _columns(name: str, seen: Patches | None, count: int) -> list[Column]:
    each: Sequence[Sequence[Value]] = _errors(seen) if seen else [[None] * count] * 2
    cell = partial(decimal, none="saturated")
    heads = [f"{name} {what} [Delta E*ab]" for what in ("color error", "noise of one pixel")]
    return [column(head, values, cell) for head, values in zip(heads, each, strict=True)]


def _short(value: float) -> str:
    """Three digits, to fit a cell; the table has all digits."""
    if value >= 999.5:
        return ">999"
    return decimal(value, 0 if value >= 99.95 else 1)


def _noise(value: float) -> str:
    return "lost" if value >= LOST_DELTA_E else f"n {_short(value)}"


def _described(name: str, seen: Patches) -> str:
    errors, noises = _errors(seen)
    worst, noisiest = max(errors), max(noises)
    lost = int(seen.is_lost.sum())
    gone = f" No color information in one pixel on {lost} of {len(errors)} patches." if lost else ""
    return (
        f"{name}: mean color error {decimal(float(seen.color_error.mean()))}, largest for "
        f"{seen.names[errors.index(worst)]} ({decimal(worst)}); most noise of one "
        f"pixel on {seen.names[noises.index(noisiest)]} ({decimal(noisiest)}).{gone}"
    )
