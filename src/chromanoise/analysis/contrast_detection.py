"""Contrast detection of two grays by one pixel, and the light at which it is reliable."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis.analysis import Analysis
from chromanoise.analysis.operating_point import electrons_at, stages_at
from chromanoise.analysis.undefined import defined
from chromanoise.color import ColorMatrix
from chromanoise.exposure import OperatingPoint
from chromanoise.metrics import contrast_detection_probability, exact_contrast_detection_probability
from chromanoise.noise import (
    after_counting,
    channel_distribution,
    few_electrons,
    noise_sources,
    saturated,
    signal_limit_e,
    with_noise,
)

BRIGHT, DARK = 0.18, 0.12
"""Reflectances of the two grays: Weber contrast 0.5."""
TOLERANCE = 0.5
"""The contrast of two readings must be within 50 % of that of the scene."""
TARGET = 0.9
"""Probability at which a contrast counts as detected reliably."""

_MANY_E = 200.0  # of each channel, from which on Y is Gaussian
_LEAST_E = 1e-3  # of the bright gray, where the search for a level starts
_LEVELS = 61
_HALVINGS = 30


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContrastDetection:
    """Probability that one pixel shows the contrast of two grays within the tolerance.

    Attributes
    ----------
    channels
        Per raw channel, without clipping: from the exact distribution of few electrons
        (`few_electrons`), unless crosstalk after counting correlates the channels; else for
        Gaussian noise.
    luminance
        Of Y after the color matrix, for Gaussian noise; NaN where a channel has fewer than
        200 electrons of a gray, or Y is not above 0.
    level_lux
        Least illuminance from which on the best raw channel reaches `TARGET`, the time kept; NaN
        if it does not before a channel saturates. [lx]
    """

    channels: dict[str, float]
    luminance: float
    level_lux: float


def contrast_detection_of(analysis: Analysis) -> ContrastDetection | None:
    """Contrast detection at the operating point of an analysis; ``None`` where a gray saturates.

    Parameters
    ----------
    analysis
        With sensor, exposure, light and matrix.
    """
    point = analysis.point
    if saturated(_grays(point)[0], point.sensor, point.exposure).any():
        return None
    channels = _channel_probabilities(point, 1.0)
    return ContrastDetection(
        channels=dict(zip(point.sensor.names, map(float, channels), strict=True)),
        luminance=_of_luminance(analysis),
        level_lux=_least_level(point),
    )


def best_channel_probability(point: OperatingPoint, matrix: ColorMatrix) -> float:
    """Contrast detection of the best raw channel; NaN where a gray saturates."""
    if saturated(_grays(point)[0], point.sensor, point.exposure).any():
        return float("nan")
    return float(_channel_probabilities(point, 1.0).max())


def _grays(point: OperatingPoint) -> Float[Array, "2 p"]:
    """Expected electrons of the bright and of the dark gray. [e-]"""
    return np.multiply.outer(np.array([BRIGHT, DARK]), electrons_at(point))


def _channel_probabilities(point: OperatingPoint, times: float) -> Float[Array, " p"]:
    """Of each channel, with ``times`` the light of the point."""
    mean = times * _grays(point)
    sd = np.sqrt(with_noise(mean, point.sensor, point.exposure).variance)
    found = np.zeros(mean.shape[1])
    noise = noise_sources(point.sensor, point.exposure)
    few = few_electrons(mean, noise).all(axis=0)
    if after_counting(point.sensor.crosstalk) is not None:
        few = np.zeros_like(few)
    seen = mean[1] > 0
    many = seen & ~few
    if many.any():
        (bright, dark), (bright_sd, dark_sd) = mean[:, many], sd[:, many]
        found[many] = contrast_detection_probability(
            bright, dark, bright_sd=bright_sd, dark_sd=dark_sd, tolerance=TOLERANCE
        )
    for i in np.flatnonzero(seen & few):
        readings = channel_distribution(mean, int(i), noise)
        found[i] = exact_contrast_detection_probability(readings, mean[:, i], tolerance=TOLERANCE)
    return found


def _of_luminance(analysis: Analysis) -> float:
    gray = np.full((analysis.point.illuminant.grid.n,), 1.0)
    reflectance = np.multiply.outer(np.array([BRIGHT, DARK]), gray)
    color = stages_at(analysis.point, analysis.matrix, reflectance=reflectance).color
    at = color.names.index("Y")
    mean, sd = color.mean[:, [at]], np.sqrt(color.variance[:, [at]])
    if not (_grays(analysis.point) >= _MANY_E).all():
        return float("nan")
    if not (mean > 0).all() or not (sd > 0).all():
        return float("nan")
    found = contrast_detection_probability(
        mean[0], mean[1], bright_sd=sd[0], dark_sd=sd[1], tolerance=TOLERANCE
    )
    return float(found[0])


def _least_level(point: OperatingPoint) -> float:
    """Illuminance above which every level up to saturation reaches the target. [lx]"""
    most_e = float(_grays(point)[0].max())
    limit_e = signal_limit_e(point.sensor, point.exposure)
    if not 0 < most_e < np.inf or limit_e <= _LEAST_E:
        return float("nan")

    def reached(times: float) -> bool:
        return bool(_channel_probabilities(point, times).max() >= TARGET)

    steps = np.geomspace(_LEAST_E / most_e, limit_e / most_e, _LEVELS)
    if not reached(steps[-1]):
        return float("nan")
    at = _LEVELS - 1
    while at > 0 and reached(steps[at - 1]):
        at -= 1
    if at == 0:
        return float(steps[0] * point.level_lux)
    low, high = np.log(steps[at - 1]), np.log(steps[at])
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        low, high = (low, middle) if reached(np.exp(middle)) else (middle, high)
    return float(np.exp(high) * point.level_lux)


def contrast_detection_as_json(found: ContrastDetection | None) -> dict[str, Any] | None:
    """Plain data with the terms of the test; ``None`` where a gray saturates a channel."""
    if found is None:
        return None
    return {
        "bright_reflectance": BRIGHT,
        "dark_reflectance": DARK,
        "contrast": "weber",
        "tolerance": TOLERANCE,
        "channels": found.channels,
        "luminance": defined(found.luminance),
        "target": TARGET,
        "target_lux": defined(found.level_lux),
    }
