"""Noise of a sensor on a mid-gray in a color space.

Color error and noise of every patch of a chart, measured by one sensor.

The SNR budgets of all coordinates of an analysis.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import ClassVar

import numpy as np

from chromanoise.base import Array, Bool, Float, JsonKey, JsonKeys, check
from chromanoise.color import (
    FIRST_ORDER_TOLERANCE,
    LAB,
    UNBOUNDED,
    ColorNoise,
    Space,
    cubature,
    exact,
    first_order,
    propagate,
    relative_sd_error,
)
from chromanoise.metrics import (
    Budget,
    chart_ciede2000,
    chart_color_error,
    color_budget,
    contravariant_budget,
    lab_budget,
    signal_snr_db,
)
from chromanoise.noise import Readout, demand_independent_channels
from chromanoise.spectra import chart_on, flat_field
from chromanoise.study.analysis import (
    Analysis,
    color_snr_db,
    noisy_color_at,
    of_white,
    stages_at,
)

GRAY = 0.18
"""Reflectance of the gray card."""
_AXES = ("exact.measurement.names",)


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

    KEYS: ClassVar[JsonKeys] = (
        JsonKey("space", "exact.measurement.kind"),
        "reflectance",
        JsonKey("mean", "exact.measurement.mean", by=_AXES),
        JsonKey("sd", "exact.sd", by=_AXES),
        JsonKey("sd_own_error", "exact.sd_error", by=_AXES),
        JsonKey("sd_first_order", "first_order.sd", by=_AXES),
        JsonKey("sd_normal_law", "normal.sd", by=_AXES),
        JsonKey("bias", "exact.bias", by=_AXES),
        JsonKey("chroma_sd", "exact.chroma_sd"),
        JsonKey("delta_e_mean", "exact.delta_e"),
        "first_order_holds",
        JsonKey("normal_law_holds", "normal_holds"),
    )

    reflectance: float
    exact: ColorNoise
    first_order: ColorNoise
    normal: ColorNoise
    first_order_error: Float[Array, " 3"]
    normal_error: Float[Array, " 3"]
    first_order_holds: bool
    normal_holds: bool

    def __post_init__(self) -> None:
        check.freeze(self, "first_order_error", "normal_error")


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


def _holds(error: Float[Array, " 3"]) -> bool:
    return bool((np.abs(error) <= FIRST_ORDER_TOLERANCE).all())


_POINTS = 2**13  # per patch: standard deviations are accurate to 0.05 %


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ChartNoise:
    """Color error and noise of each patch, with the light and exposure of an analysis.

    Attributes
    ----------
    names
        Names of the patches.
    color_error, ciede2000
        Color errors without noise, CIE 1976 and CIEDE2000. [Delta E]
    snr_y_db
        SNR of Y; NaN where Y has no signal. [dB]
    noise
        Noise in CIELAB, relative to the sensor's own white, from the exact Poisson-Gaussian
        distribution.
    first_order_holds
        Whether every first-order standard deviation is within 5 % of the exact one.
    """

    names: tuple[str, ...]
    color_error: Float[Array, " k"]
    ciede2000: Float[Array, " k"]
    snr_y_db: Float[Array, " k"]
    noise: ColorNoise
    first_order_holds: Bool[Array, " k"]

    def __post_init__(self) -> None:
        check.freeze(self, "color_error", "ciede2000", "snr_y_db", "first_order_holds")


def chart_noise(analysis: Analysis, *, readout: Readout = UNBOUNDED) -> ChartNoise | None:
    """Color error and noise of the chart under the light of the analysis.

    ``None`` where a channel is saturated on the white, or X, Y or Z of the white is not above 0.

    Parameters
    ----------
    analysis
        The analysis, with its chart; ``None`` there is the ColorChecker.
    readout
        Clipping and rounding of the values; none by default.

    Raises
    ------
    InputError
        If the grid extends beyond 400-1050 nm, the range of the chart's data, or crosstalk after
        counting correlates the channels.
    """
    sensor, exposure, matrix = analysis.sensor, analysis.exposure, analysis.matrix
    lamp, white = analysis.scene.illuminant, of_white(analysis)
    errors = chart_color_error(sensor, matrix, exposure, lamp, analysis.chart)
    newer = chart_ciede2000(sensor, matrix, exposure, lamp, analysis.chart)
    no_color = None in color_snr_db(white).values()
    if no_color or errors is None or newer is None:
        return None
    demand_independent_channels(sensor)
    chart = chart_on(sensor.grid, analysis.chart)
    at = stages_at(analysis.point, matrix, reflectance=chart.values.T, readout=readout)
    color = noisy_color_at(at, matrix.matrix @ white.expected_e)
    noise = propagate(color, LAB, partial(exact, points=_POINTS))
    rough = propagate(color, LAB, first_order)
    error = np.abs(relative_sd_error(rough.measurement, noise.measurement))
    return ChartNoise(
        names=chart.names,
        color_error=errors,
        ciede2000=newer,
        snr_y_db=np.where(
            at.one_code.any(axis=-1), np.nan, signal_snr_db(at.color, at.truth_xyz)[:, 1]
        ),
        noise=noise,
        first_order_holds=(error <= FIRST_ORDER_TOLERANCE).all(axis=-1),
    )


CHART_KEYS: JsonKeys = (
    JsonKey("patch", "names"),
    *("color_error", "ciede2000", "snr_y_db"),
    JsonKey("sd", "noise.sd", by=("noise.measurement.names",)),
    JsonKey("chroma_sd", "noise.chroma_sd"),
    JsonKey("noise_delta_e", "noise.delta_e"),
    "first_order_holds",
)
"""Of one patch; a chart is the list of its patches."""


_CONTRAVARIANT = "M^"


@lru_cache(maxsize=64)  # verdict and waterfall chart use the same budget
def coordinate_budget(
    analysis: Analysis, coordinate: str, *, reflectance: float = GRAY
) -> Budget | None:
    """The budget of X, Y, Z, of a contravariant coordinate as M^R, or of L*, a*, b* of a gray.

    ``None`` where a channel is saturated, or the coordinate has no SNR or no budget, and for a
    clipped analysis, as a budget follows eq. 7.

    Parameters
    ----------
    analysis
        The analysis of a perfect white.
    coordinate
        Its name; ``None`` is returned for a coordinate that the sensor does not have.
    reflectance
        Of the gray, for L*, a* and b*. [1]
    """
    if analysis.without_snr.any() or analysis.readout is not None:
        return None
    light, sensor, exposure = analysis.scene, analysis.sensor, analysis.exposure
    snr = color_snr_db(analysis)
    if coordinate in snr:
        if snr[coordinate] is None:
            return None
        return color_budget(light, sensor, exposure, analysis.matrix, coordinate)
    if coordinate in LAB.coordinates:
        if None in color_snr_db(of_white(analysis)).values():
            return None
        gray = flat_field(light.illuminant, level_lux=light.level_lux, reflectance=reflectance)
        return lab_budget(gray, sensor, exposure, analysis.matrix, coordinate)
    channel = coordinate.removeprefix(_CONTRAVARIANT)
    if channel not in sensor.names:
        return None
    return contravariant_budget(light, sensor, exposure, analysis.matrix.frame, channel)


def color_budgets(analysis: Analysis) -> tuple[Budget | None, ...]:
    """SNR budgets of X, Y and Z; ``None`` where a channel is saturated or there is no SNR.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    return tuple(coordinate_budget(analysis, name) for name in analysis.color.names)


def contravariant_budgets(analysis: Analysis) -> tuple[Budget | None, ...]:
    """SNR budget of each contravariant coordinate; ``None`` where it has no SNR.

    Parameters
    ----------
    analysis
        Results of one sensor.
    """
    names = analysis.sensor.names
    return tuple(coordinate_budget(analysis, f"{_CONTRAVARIANT}{name}") for name in names)


def lab_budgets(analysis: Analysis, *, reflectance: float = GRAY) -> tuple[Budget | None, ...]:
    """SNR budgets of one unit of L*, a* and b* of a gray, starting from all photons.

    ``None`` where a channel is saturated on the white, or a coordinate has no budget.

    Parameters
    ----------
    analysis
        The analysis of a perfect white; the gray is under the same light.
    reflectance
        Of the gray. [1]
    """
    return tuple(
        coordinate_budget(analysis, name, reflectance=reflectance) for name in LAB.coordinates
    )


def missing_lab_budgets(analysis: Analysis, budgets: Sequence[Budget | None]) -> str | None:
    """The reason why `lab_budgets` lacks a coordinate; ``None`` where none is missing.

    Parameters
    ----------
    analysis
        Results of one sensor.
    budgets
        Budgets of L*, a* and b*; ``None`` where a budget is undefined.
    """
    name = analysis.sensor.label
    if analysis.saturated.any():
        return f"{name}: a channel is saturated on the white, so L*, a* and b* have no budget"
    if analysis.one_code.any():
        return f"{name}: a channel gives one code on the white, so L*, a* and b* have no budget"
    found = zip(LAB.coordinates, budgets, strict=True)
    missing = [coordinate for coordinate, budget in found if budget is None]
    if not missing:
        return None
    return (
        f"{name}: no budget of {', '.join(missing)}, because sensor and matrix do not respond to a "
        "change of it; use another matrix, or more channels"
    )
