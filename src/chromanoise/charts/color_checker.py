"""Color error and noise of every ColorChecker patch."""

from functools import partial
from typing import Any

from chromanoise.charts.charted_study import Look, Shown
from chromanoise.charts.ellipses import Patches, hex_colors, patches_of, why_no_patches
from chromanoise.charts.numbers import decimal, text_table
from chromanoise.noise import conditions
from chromanoise.spectra import chart_title
from chromanoise.study import Analysis


def drawn_chart(shown: Shown, look: Look) -> dict[str, Any]:
    """True and measured color of each patch, with CIE 1976 color error and noise."""
    found = [patches_of(analysis) for analysis in shown.analyses]
    seen = next((one for one in found if one is not None), None)
    patches = [] if seen is None else _true_patches(seen)
    sensors = [_sensor(*pair) for pair in zip(shown.analyses, found, strict=True)]
    where = conditions(shown.operating_points)
    chart = chart_title(shown.operating_points[0].chart)
    record: dict[str, Any] = {
        "title": f"Color error and noise of {chart} at {where}",
        "description": _description(patches, sensors),
        "patches": patches,
        "unit": "Delta E*ab",
        "sensors": sensors,
    }
    cell = partial(decimal, none="saturated")
    return record | {"table": text_table("chart", record, str, cell)}


def _true_patches(seen: Patches) -> list[dict[str, str]]:
    colors = hex_colors(seen.truth, seen.true_white)
    return [{"name": name, "srgb": color} for name, color in zip(seen.names, colors, strict=True)]


def _sensor(analysis: Analysis, seen: Patches | None) -> dict[str, Any]:
    name = analysis.sensor.label
    if seen is None:
        none: dict[str, Any] = {"mean_delta_e": None, "mean_noise": None, "patches": []}
        return {"name": name, **none, "means": "", "why_not": why_no_patches(analysis)}
    colors = hex_colors(seen.xyz.mean, seen.white)
    noise = seen.noise.delta_e
    assert noise is not None  # CIELAB has one
    mean, mean_noise = float(seen.color_error.mean()), float(noise.mean())
    return {
        "name": name,
        "mean_delta_e": mean,
        "mean_noise": mean_noise,
        "means": f"{_short(mean)}, n {_short(mean_noise)}",
        "patches": [
            {
                "srgb": color,
                "delta_e": error,
                "noise": spread,
                "text": [_short(error), _short_noise(spread)],
            }
            for color, error, spread in zip(
                colors, seen.color_error.tolist(), noise.tolist(), strict=True
            )
        ],
        "why_not": None,
    }


def _short(value: float) -> str:
    """Three digits, to fit a cell; the table has all digits."""
    if value >= 999.5:
        return ">999"
    return decimal(value, 0 if value >= 99.95 else 1)


def _short_noise(value: float) -> str:
    return "n>999" if value >= 999.5 else f"n {_short(value)}"


def _description(patches: list[dict[str, str]], sensors: list[dict[str, Any]]) -> str:
    parts = ["Color error and noise, both CIE 1976 differences."]
    names = [patch["name"] for patch in patches]
    for sensor in sensors:
        if not sensor["patches"]:
            parts.append(f"{sensor['why_not']}.")
            continue
        errors = [patch["delta_e"] for patch in sensor["patches"]]
        noises = [patch["noise"] for patch in sensor["patches"]]
        worst, noisiest = max(errors), max(noises)
        parts.append(
            f"{sensor['name']}: mean color error {decimal(sensor['mean_delta_e'])}, largest for "
            f"{names[errors.index(worst)]} ({decimal(worst)}); most noise on "
            f"{names[noises.index(noisiest)]} ({decimal(noisiest)})."
        )
    return " ".join(parts)
