"""Quantities that can be compared: each is one number of an operating point and a matrix."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.analysis.color_space_noise import GRAY
from chromanoise.analysis.contrast_detection import best_channel_probability
from chromanoise.analysis.information import raw_information
from chromanoise.analysis.operating_point import Stages, electrons_at, noisy_color_at, stages_at
from chromanoise.analysis.separation import median_distances
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


def _patch_at(operating_point: OperatingPoint, matrix: ColorMatrix, **more: Any) -> Stages:
    """The stages of the patch that is analyzed, by default a perfect white."""
    if operating_point.patch is not None:
        more["reflectance"] = operating_point.patch_reflectance
    return stages_at(operating_point, matrix, **more)


def color_snr(operating_point: OperatingPoint, matrix: ColorMatrix, *, coordinate: str) -> float:
    """SNR of X, Y or Z of the patch, by default a perfect white; NaN where it has none. [dB]"""
    return float(_color_snr(_patch_at(operating_point, matrix), coordinate))


def color_snr_over_levels(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"],
    *,
    coordinate: str,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, " k"]:
    """`color_snr` at many light levels, the time being kept. [dB]

    Parameters
    ----------
    matrix
        Of all levels.
    level_lux
        Illuminances on the white, > 0. [lx]
    coordinate
        X, Y or Z.
    matrices
        One per level, in place of the numbers of ``matrix``. [lx/e-]
    """
    at = _patch_at(operating_point, matrix, level_lux=level_lux, lux_per_e=matrices)
    return _color_snr(at, coordinate)


def _color_snr(at: Stages, coordinate: str) -> Float[Array, "*lv"]:
    return at.color_snr_db[..., at.matrix.coordinates.index(coordinate)]


def is_saturated_over_levels(
    operating_point: OperatingPoint, level_lux: Float[Array, " k"]
) -> Bool[Array, " k"]:
    """Whether a channel is saturated on a perfect white, at many light levels, the time kept.

    Parameters
    ----------
    operating_point
        A sensor in use; its own light level is not used.
    level_lux
        Illuminance. [lx]
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


def best_snr(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """SNR of the best linear readout of a perfect white, whatever the matrix. [dB]"""
    return float(_patch_at(operating_point, matrix).optimal_linear_snr_db)


def best_snr_over_levels(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"],
    *,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, " k"]:
    """`best_snr` at many light levels; parameters as `color_snr_over_levels`. [dB]"""
    return _patch_at(operating_point, matrix, level_lux=level_lux).optimal_linear_snr_db


def color_loss(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """SNR of the best linear readout minus SNR of Y. [dB]"""
    at = _patch_at(operating_point, matrix)
    return float(at.optimal_linear_snr_db - _color_snr(at, "Y"))


def color_loss_over_levels(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"],
    *,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, " k"]:
    """`color_loss` at many light levels; parameters as `color_snr_over_levels`. [dB]"""
    at = _patch_at(operating_point, matrix, level_lux=level_lux, lux_per_e=matrices)
    return at.optimal_linear_snr_db - _color_snr(at, "Y")


def median_distance(operating_point: OperatingPoint, matrix: ColorMatrix, *, reading: str) -> float:
    """Median D_M of the pairs of patches; NaN where a patch saturates a channel. [1]"""
    return float(median_distances(operating_point, matrix, reading))


def median_distance_over_levels(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"],
    *,
    reading: str,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, " k"]:
    """`median_distance` at many light levels; parameters as `color_snr_over_levels`. [1]"""
    return median_distances(
        operating_point, matrix, reading, level_lux=level_lux, lux_per_e=matrices
    )


def information(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """`raw_information` of the default prior; NaN where a white saturates a channel. [bit]"""
    return (
        float("nan") if is_saturated(operating_point) else float(raw_information(operating_point))
    )


def information_over_levels(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"],
    *,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, " k"]:
    """`information` at many light levels; parameters as `color_snr_over_levels`. [bit]"""
    full = is_saturated_over_levels(operating_point, level_lux)
    return np.where(full, np.nan, raw_information(operating_point, level_lux))


def color_error(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """Mean over the chart, without noise. [Delta E*ab]

    NaN where X, Y or Z of the white is not above 0.
    """
    error = chart_color_error(
        operating_point.sensor,
        matrix,
        operating_point.exposure,
        operating_point.illuminant,
        operating_point.chart,
    )
    return float("nan") if error is None else float(error.mean())


def total_error(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """Bias and noise together, mean over the chart; NaN without a color. [Delta E*ab]"""
    error = total_errors(operating_point, matrix)
    return float("nan") if error is None else float(error.total.mean())


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


def gray_delta_e(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """Mean color difference that noise makes on an 18 % gray. [Delta E*ab]"""
    if is_saturated(operating_point):
        return float("nan")
    white = matrix.matrix @ electrons_at(operating_point)
    if not (white > 0).all():
        return float("nan")
    gray = noisy_color_at(stages_at(operating_point, matrix, reflectance=GRAY), white)
    difference = propagate(gray, LAB, cubature).delta_e
    assert difference is not None  # CIELAB has one
    return float(difference)


def is_saturated(operating_point: OperatingPoint) -> bool:
    """Whether a channel is saturated on a perfect white."""
    sensor, exposure = operating_point.sensor, operating_point.exposure
    return bool(saturated(electrons_at(operating_point), sensor, exposure).any())


def _snr(name: str, coordinate: str) -> Quantity:
    return Quantity(
        name=name,
        what=f"SNR of {coordinate} of a white",
        unit="dB",
        more_is_better=True,
        of=partial(color_snr, coordinate=coordinate),
        over_levels=partial(color_snr_over_levels, coordinate=coordinate),
    )


def _separation(name: str, reading: str) -> Quantity:
    where = "after the color matrix" if reading.startswith("color") else "in raw values"
    terms = ", without brightness" if reading.endswith("brightness") else ""
    return Quantity(
        name=name,
        what=f"median distance of patches {where}{terms}",
        unit="1",
        more_is_better=True,
        of=partial(median_distance, reading=reading),
        over_levels=partial(median_distance_over_levels, reading=reading),
        of_raw=reading.startswith("raw"),
    )


QUANTITIES: Mapping[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        _snr("snr-y", "Y"),
        _snr("snr-x", "X"),
        _snr("snr-z", "Z"),
        Quantity(
            name="bound",
            what="SNR of the best linear readout of a white",
            unit="dB",
            more_is_better=True,
            of=best_snr,
            over_levels=best_snr_over_levels,
        ),
        Quantity(
            name="price",
            what="color SNR loss of a white",
            unit="dB",
            more_is_better=False,
            of=color_loss,
            over_levels=color_loss_over_levels,
        ),
        Quantity(
            name="delta-e",
            what="mean color difference by noise on an 18 % gray",
            unit="Delta E*ab",
            more_is_better=False,
            of=gray_delta_e,
        ),
        Quantity(
            name="color-error",
            what="mean color error of the chart without noise",
            unit="Delta E*ab",
            more_is_better=False,
            of=color_error,
        ),
        Quantity(
            name="total-error",
            what="mean color error of the chart with noise",
            unit="Delta E*ab",
            more_is_better=False,
            of=total_error,
        ),
        _separation("separation", "raw"),
        _separation("separation-without-brightness", "raw_without_brightness"),
        _separation("color-separation", "color"),
        _separation("color-separation-without-brightness", "color_without_brightness"),
        Quantity(
            name="cdp",
            what="contrast detection probability of the best raw channel",
            unit="1",
            more_is_better=True,
            of=best_channel_probability,
            of_raw=True,
        ),
        Quantity(
            name="information",
            what="information of raw values about the spectrum",
            unit="bit",
            more_is_better=True,
            of=information,
            over_levels=information_over_levels,
            of_raw=True,
        ),
    )
}
"""The quantities by which sensors are compared, by name."""
SNR_Y = QUANTITIES["snr-y"]
