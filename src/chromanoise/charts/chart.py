"""The ColorChecker: color error and noise of every patch, never one alone."""

from typing import Any

from chromanoise.analysis.stages import Analysis
from chromanoise.charts.patches import Patches, hex_colors, patches_of, why_no_patches
from chromanoise.charts.shown import Look, Shown


def drawn_chart(shown: Shown, look: Look) -> dict[str, Any]:
    """Each patch as it is and as each sensor makes it, with error and noise as CIE 1976."""
    found = [patches_of(analysis) for analysis in shown.analyses]
    seen = next((one for one in found if one is not None), None)
    return {
        "patches": [] if seen is None else _true_patches(seen),
        "unit": "Delta E*ab",
        "sensors": [_sensor(*pair) for pair in zip(shown.analyses, found, strict=True)],
    }


def _true_patches(seen: Patches) -> list[dict[str, str]]:
    colors = hex_colors(seen.truth, seen.true_white)
    return [{"name": name, "srgb": color} for name, color in zip(seen.names, colors, strict=True)]


def _sensor(analysis: Analysis, seen: Patches | None) -> dict[str, Any]:
    name = analysis.sensor.name
    if seen is None:
        told: dict[str, Any] = {"mean_delta_e": None, "mean_noise": None, "patches": []}
        return {"name": name, **told, "why_not": why_no_patches(analysis)}
    colors = hex_colors(seen.xyz.mean, seen.white)
    noise = seen.noise.delta_e
    assert noise is not None  # CIELAB has one
    return {
        "name": name,
        "mean_delta_e": float(seen.color_error.mean()),
        "mean_noise": float(noise.mean()),
        "patches": [
            {"srgb": color, "delta_e": error, "noise": spread}
            for color, error, spread in zip(
                colors, seen.color_error.tolist(), noise.tolist(), strict=True
            )
        ],
        "why_not": None,
    }
