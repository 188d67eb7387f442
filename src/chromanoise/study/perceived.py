"""What the eye makes of a sensor's noise on the mid-grey of the photographers."""

from typing import Any

from chromanoise.color import PerceivedNoise, Space, colored, perceived_noise
from chromanoise.exposure import expected_electrons
from chromanoise.noise import with_noise
from chromanoise.scene import flat_field
from chromanoise.study.analysis import Analysis

GREY = 0.18
"""Reflectance of the grey card."""


def grey_noise(
    analysis: Analysis, space: Space, *, reflectance: float = GREY
) -> PerceivedNoise | None:
    """Noise of a grey under the analysis' light and exposure, relative to its perfect white.

    ``None`` where a channel is saturated on the white or the white is no color.

    Parameters
    ----------
    analysis
        Of a perfect white.
    space
        E.g. `chromanoise.color.LAB`.
    reflectance
        Of the grey.
    """
    white = analysis.color.mean
    if analysis.saturated.any() or not (white > 0).all():
        return None
    scene = flat_field(
        analysis.scene.illuminant, level_lux=analysis.scene.level_lux, reflectance=reflectance
    )
    electrons = expected_electrons(scene, analysis.sensor, analysis.exposure)
    xyz = colored(with_noise(electrons, analysis.sensor), analysis.matrix)
    return perceived_noise(xyz, white, space=space)


def grey_noise_as_json(noise: PerceivedNoise | None) -> dict[str, Any] | None:
    """Standard deviations and bias per coordinate, chroma, mean color difference."""
    if noise is None:
        return None
    names = noise.first_order.names
    return {
        "space": noise.space,
        "reflectance": GREY,
        "mean": _named(names, noise.second_route.mean),
        "sd": _named(names, noise.second_route.variance**0.5),
        "sd_first_order": _named(names, noise.first_order.variance**0.5),
        "bias": _named(names, noise.bias),
        "chroma_sd": float(noise.chroma_sd),
        "delta_e_mean": float(noise.delta_e),
        "first_order_holds": bool(noise.first_order_holds),
    }


def _named(names: tuple[str, ...], values: Any) -> dict[str, float]:
    return {name: float(value) for name, value in zip(names, values, strict=True)}
