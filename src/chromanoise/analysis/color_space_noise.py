"""Noise of a sensor on a mid-gray in a color space."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.analysis.analysis import Analysis, color_snr_db, of_white
from chromanoise.analysis.operating_point import noisy_color_at, stages_at
from chromanoise.analysis.undefined import named, plain
from chromanoise.color import (
    FIRST_ORDER_TOLERANCE,
    ColorNoise,
    Space,
    cubature,
    exact,
    first_order,
    propagate,
    relative_sd_error,
)
from chromanoise.noise import Readout, demand_independent_channels

GRAY = 0.18
"""Reflectance of the gray card."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class GrayNoise:
    """Noise of a gray, computed by three methods.

    Attributes
    ----------
    reflectance
        Of the gray.
    exact
        From the exact Poisson-Gaussian distribution: the reference.
    first_order, normal
        By J S J^T, and by cubature over X, Y and Z, assumed jointly normal.
    first_order_error, normal_error
        Standard deviation of each of these two over the exact one, minus 1.
    first_order_holds, normal_holds
        Whether that error is within 5 % for every coordinate.
    """

    reflectance: float
    exact: ColorNoise
    first_order: ColorNoise
    normal: ColorNoise
    first_order_error: Float[Array, " 3"]
    normal_error: Float[Array, " 3"]
    first_order_holds: bool
    normal_holds: bool

    def __post_init__(self) -> None:
        _check.freeze(self, "first_order_error", "normal_error")


def gray_noise(
    analysis: Analysis,
    space: Space,
    *,
    reflectance: float = GRAY,
    readout: Readout | None = None,
) -> GrayNoise | None:
    """Noise of a gray with the light and exposure of the analysis, relative to a perfect white.

    ``None`` where a channel is saturated on the white, or X, Y or Z of the white is not above 0.

    Parameters
    ----------
    analysis
        The analysis of a perfect white.
    space
        E.g. `chromanoise.color.LAB`.
    reflectance
        Of the gray. [1]
    readout
        Clipping and rounding of the values; ``None`` for none. The white is never clipped.

    Raises
    ------
    InputError
        If crosstalk after counting correlates the channels.
    """
    white = of_white(analysis)
    if None in color_snr_db(white).values():
        return None
    demand_independent_channels(analysis.sensor)
    gray = stages_at(analysis.point, analysis.matrix, reflectance=reflectance, readout=readout)
    color = noisy_color_at(gray, analysis.matrix.matrix @ white.expected_e)
    trusted, rough, normal = (
        propagate(color, space, method) for method in (exact, first_order, cubature)
    )
    first_order_error, normal_error = (
        relative_sd_error(one.measurement, trusted.measurement) for one in (rough, normal)
    )
    return GrayNoise(
        reflectance=reflectance,
        exact=trusted,
        first_order=rough,
        normal=normal,
        first_order_error=first_order_error,
        normal_error=normal_error,
        first_order_holds=_holds(first_order_error),
        normal_holds=_holds(normal_error),
    )


def gray_noise_as_json(noise: GrayNoise | None) -> dict[str, Any] | None:
    """Standard deviations and bias per coordinate, chroma, mean color difference.

    Parameters
    ----------
    noise
        Noise of a gray in a color space; ``None`` where it is undefined.
    """
    if noise is None:
        return None
    found = noise.exact
    names = found.measurement.names
    assert found.sd_error is not None  # the exact method always reports it
    return {
        "space": found.measurement.kind,
        "reflectance": noise.reflectance,
        "mean": named(names, found.measurement.mean),
        "sd": named(names, found.sd),
        "sd_own_error": named(names, found.sd_error),
        "sd_first_order": named(names, noise.first_order.sd),
        "sd_normal_law": named(names, noise.normal.sd),
        "bias": named(names, found.bias),
        "chroma_sd": plain(found.chroma_sd),
        "delta_e_mean": plain(found.delta_e),
        "first_order_holds": noise.first_order_holds,
        "normal_law_holds": noise.normal_holds,
    }


def _holds(error: Float[Array, " 3"]) -> bool:
    return bool((np.abs(error) <= FIRST_ORDER_TOLERANCE).all())
