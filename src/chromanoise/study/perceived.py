"""What the eye makes of a sensor's noise on the mid-grey of the photographers."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.color import (
    FIRST_ORDER_TOLERANCE,
    UNBOUNDED,
    ExactNoise,
    Space,
    colored,
    exact_noise,
    sd_error,
    through_space,
    through_space_sampled,
)
from chromanoise.exposure import expected_electrons
from chromanoise.noise import Measurement, Readout, measured
from chromanoise.scene import flat_field
from chromanoise.study.analysis import Analysis, color_snr_db

GREY = 0.18
"""Reflectance of the grey card."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GreyNoise:
    """Noise of a grey by three routes.

    Attributes
    ----------
    reflectance
        Of the grey.
    exact
        From the electrons: the one to read.
    first_order, normal
        Mean and covariance by J S J^T, and by cubature over X, Y and Z taken as normal.
    first_order_error, normal_error
        Standard deviation of those two over the exact one, minus 1.
    first_order_holds, normal_holds
        Whether that is within 5 % for every coordinate.
    """

    reflectance: float
    exact: ExactNoise
    first_order: Measurement
    normal: Measurement
    first_order_error: Float[Array, " 3"]
    normal_error: Float[Array, " 3"]
    first_order_holds: bool
    normal_holds: bool

    def __post_init__(self) -> None:
        _check.freeze(self, "first_order_error", "normal_error")


def grey_noise(
    analysis: Analysis,
    space: Space,
    *,
    reflectance: float = GREY,
    readout: Readout | None = None,
) -> GreyNoise | None:
    """Noise of a grey under the analysis' light and exposure, relative to its perfect white.

    ``None`` where a channel is saturated on the white or the white is no color.

    Parameters
    ----------
    analysis
        Of a perfect white.
    space
        E.g. `chromanoise.color.LAB`.
    reflectance
        Of the grey. [1]
    readout
        What holds and rounds the values; ``None`` for none. The white stays that of the electrons.
    """
    sensor, exposure, light = analysis.sensor, analysis.exposure, analysis.scene
    white = analysis.matrix.matrix @ expected_electrons(light, sensor, exposure)
    if None in color_snr_db(analysis).values():
        return None
    scene = flat_field(light.illuminant, level_lux=light.level_lux, reflectance=reflectance)
    electrons = expected_electrons(scene, sensor, exposure)
    held = readout or UNBOUNDED
    xyz = colored(measured(electrons, sensor, held), analysis.matrix)
    first_order = through_space(xyz, space, white)
    normal = through_space_sampled(xyz, space, white)
    exact = exact_noise(
        electrons,
        analysis.matrix.matrix,
        white,
        read_noise_e=sensor.pixel.read_noise_e,
        readout=held,
        space=space,
    )
    first_order_error = sd_error(first_order, exact.noisy)
    normal_error = sd_error(normal, exact.noisy)
    return GreyNoise(
        reflectance=reflectance,
        exact=exact,
        first_order=first_order,
        normal=normal,
        first_order_error=first_order_error,
        normal_error=normal_error,
        first_order_holds=_holds(first_order_error),
        normal_holds=_holds(normal_error),
    )


def grey_noise_as_json(noise: GreyNoise | None) -> dict[str, Any] | None:
    """Standard deviations and bias per coordinate, chroma, mean color difference."""
    if noise is None:
        return None
    exact = noise.exact
    names = exact.noisy.names
    return {
        "space": exact.space,
        "reflectance": noise.reflectance,
        "mean": _named(names, exact.noisy.mean),
        "sd": _named(names, exact.noisy.variance**0.5),
        "sd_own_error": _named(names, exact.sd_error),
        "sd_first_order": _named(names, noise.first_order.variance**0.5),
        "sd_normal_law": _named(names, noise.normal.variance**0.5),
        "bias": _named(names, exact.bias),
        "chroma_sd": None if exact.chroma_sd is None else float(exact.chroma_sd),
        "delta_e_mean": None if exact.delta_e is None else float(exact.delta_e),
        "first_order_holds": noise.first_order_holds,
        "normal_law_holds": noise.normal_holds,
    }


def _holds(error: Float[Array, " 3"]) -> bool:
    return bool((np.abs(error) <= FIRST_ORDER_TOLERANCE).all())


def _named(names: tuple[str, ...], values: Any) -> dict[str, float]:
    return {name: float(value) for name, value in zip(names, values, strict=True)}
