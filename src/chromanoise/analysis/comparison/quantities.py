"""Quantities that can be compared: each is one number of an operating point and a matrix."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.analysis.color_space_noise import GRAY
from chromanoise.analysis.contrast_detection import best_channel_probability
from chromanoise.analysis.information import raw_information
from chromanoise.analysis.operating_point import Stages, electrons_at, noisy_color_at, stages_at
from chromanoise.analysis.separation import COLOR, COLOR_WITHOUT, RAW, RAW_WITHOUT, median_distances
from chromanoise.analysis.total_error import total_errors
from chromanoise.color import LAB, ColorMatrix, cubature, propagate
from chromanoise.exposure import OperatingPoint
from chromanoise.metrics import chart_color_error
from chromanoise.metrics.accuracy import mean_chart_errors
from chromanoise.noise import saturated, signal_limit_e


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One number of an operating point.

    Attributes
    ----------
    name
        Its name in options and studies.
    what
        In words, unit not included.
    unit
        Of the number.
    more_is_better
        Whether the higher value is the better one.
    of
        The number; NaN where it is not defined: a channel is saturated, a color is no signal.
    over_levels
        The same for many light levels [lx] at once, as `color_snr_over_levels`; ``None`` where
        there is no such function.
    of_raw
        Whether it is one of raw values, which neither a color matrix nor its color error concerns.
    """

    name: str
    what: str
    unit: str
    more_is_better: bool
    of: Callable[[OperatingPoint, ColorMatrix], float]
    over_levels: Callable[..., Array] | None = None
    of_raw: bool = False


_Function = TypeVar("_Function", bound=Callable[..., Array | float])
QUANTITIES: dict[str, Quantity] = {}
"""The quantities by which sensors are compared, by name: `_quantity` enters one."""


def _quantity(
    name: str,
    what: str,
    unit: str,
    *,
    more_is_better: bool = True,
    over_levels: bool = True,
    of_raw: bool = False,
) -> Callable[[_Function], _Function]:
    """A decorator that enters a function as a quantity.

    With ``over_levels``, it takes many light levels [lx] after the matrix, and ``matrices``, one
    per level [lx/e-], in place of that; without them it gives the number of the operating point.
    """

    def entered(function: _Function) -> _Function:
        QUANTITIES[name] = Quantity(
            name=name,
            what=what,
            unit=unit,
            more_is_better=more_is_better,
            of=lambda point, matrix: float(function(point, matrix)),
            over_levels=function if over_levels else None,  # type: ignore[arg-type]
            of_raw=of_raw,
        )
        return function

    return entered


def _of_patch(
    of: Callable[[Stages], Array],
    point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"] | None = None,
    *,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, "*lv"]:
    """A number of the stages of the patch that is analyzed, by default a perfect white."""
    reflectance = 1.0 if point.patch is None else point.patch_reflectance
    at = stages_at(point, matrix, level_lux=level_lux, reflectance=reflectance, lux_per_e=matrices)
    return np.asarray(of(at))


def _color_snr_db(at: Stages, coordinate: str) -> Float[Array, "*lv"]:
    return at.color_snr_db[..., at.matrix.coordinates.index(coordinate)]


def _color_snr_loss_db(at: Stages) -> Float[Array, "*lv"]:
    return np.asarray(at.optimal_linear_snr_db - _color_snr_db(at, "Y"))


for _axis in ("Y", "X", "Z"):
    _snr = partial(_of_patch, partial(_color_snr_db, coordinate=_axis))
    _quantity(f"snr-{_axis.lower()}", f"SNR of {_axis} of a white", "dB")(_snr)
SNR_Y = QUANTITIES["snr-y"]
_quantity("bound", "SNR of the best linear readout of a white", "dB")(
    partial(_of_patch, lambda at: at.optimal_linear_snr_db)
)
_quantity("price", "color SNR loss of a white", "dB", more_is_better=False)(
    partial(_of_patch, _color_snr_loss_db)
)
_color_difference = partial(_quantity, unit="Delta E*ab", more_is_better=False, over_levels=False)


@_color_difference("delta-e", "mean color difference by noise on an 18 % gray")
def gray_delta_e(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """NaN where a channel is saturated, or X, Y or Z of the white is not above 0."""
    white = matrix.matrix @ electrons_at(operating_point)
    if is_saturated(operating_point) or not (white > 0).all():
        return float("nan")
    gray = noisy_color_at(stages_at(operating_point, matrix, reflectance=GRAY), white)
    difference = propagate(gray, LAB, cubature).delta_e
    assert difference is not None  # CIELAB has one
    return float(difference)


@_color_difference("color-error", "mean color error of the chart without noise")
def color_error(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """NaN where X, Y or Z of the white is not above 0."""
    error = chart_color_error(
        operating_point.sensor,
        matrix,
        operating_point.exposure,
        operating_point.illuminant,
        operating_point.chart,
    )
    return float("nan") if error is None else float(error.mean())


def color_errors(
    operating_point: OperatingPoint, matrices: Float[Array, "k c p"]
) -> Float[Array, " k"]:
    """`color_error` of many matrices of one sensor and time. [Delta E*ab]"""
    return mean_chart_errors(
        operating_point.sensor,
        matrices,
        operating_point.exposure,
        operating_point.illuminant,
        operating_point.observer,
        operating_point.chart,
    )


@_color_difference("total-error", "mean color error of the chart with noise")
def total_error(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """Bias and noise together; NaN without a color."""
    error = total_errors(operating_point, matrix)
    return float("nan") if error is None else float(error.total.mean())


def _median_distance(
    point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"] | None = None,
    *,
    reading: str,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, "*lv"]:
    return median_distances(point, matrix, reading, level_lux=level_lux, lux_per_e=matrices)


for _reading in (RAW, RAW_WITHOUT, COLOR, COLOR_WITHOUT):
    _is_raw, _without = _reading in (RAW, RAW_WITHOUT), _reading in (RAW_WITHOUT, COLOR_WITHOUT)
    _quantity(
        f"{'' if _is_raw else 'color-'}separation{'-without-brightness' if _without else ''}",
        f"median distance of patches {'in raw values' if _is_raw else 'after the color matrix'}"
        f"{', without brightness' if _without else ''}",
        "1",
        of_raw=_is_raw,
    )(partial(_median_distance, reading=_reading))
_quantity(
    "cdp",
    "contrast detection probability of the best raw channel",
    "1",
    over_levels=False,
    of_raw=True,
)(best_channel_probability)


@_quantity("information", "information of raw values about the spectrum", "bit", of_raw=True)
def information(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"] | None = None,
    *,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, "*lv"]:
    """`raw_information` of the default prior; NaN where a white saturates a channel. [bit]"""
    full = is_saturated(operating_point, level_lux)
    return np.where(full, np.nan, raw_information(operating_point, level_lux))


def is_saturated(
    operating_point: OperatingPoint, level_lux: Float[Array, " k"] | None = None
) -> Bool[Array, "*lv"]:
    """Whether a channel is saturated on a perfect white.

    Parameters
    ----------
    operating_point
        A sensor in use.
    level_lux
        Illuminances, the time being kept; ``None`` for that of the operating point. [lx]
    """
    electrons = electrons_at(operating_point, level_lux=level_lux)
    sensor, exposure = operating_point.sensor, operating_point.exposure
    return np.asarray(saturated(electrons, sensor, exposure).any(axis=-1))


def fullest_level_lux(operating_point: OperatingPoint) -> float | None:
    """Highest illuminance at which a perfect white saturates no channel, at a fixed time. [lx]

    ``None`` where no channel receives light. Electrons are linear in light, so it is the white
    level over the electrons per lux of the most sensitive channel.
    """
    most = float(electrons_at(operating_point, level_lux=np.ones(1)).max())
    left_e = signal_limit_e(operating_point.sensor, operating_point.exposure)
    return max(left_e, 0.0) / most if most > 0 else None
