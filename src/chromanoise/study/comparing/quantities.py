"""What can be asked of a situation with a color matrix, as one number."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.color import LAB, ColorMatrix, colored, perceived_noise, scene_xyz
from chromanoise.exposure import Situation, expected_electrons, white_scene
from chromanoise.merit import bound_db, chart_color_error, signal_snr_db
from chromanoise.merit.accuracy import mean_chart_errors
from chromanoise.noise import Measurement, saturated, with_noise
from chromanoise.scene import Scene, flat_field
from chromanoise.study.perceived import GREY


@dataclass(frozen=True, slots=True, kw_only=True)
class Quantity:
    """One number of a situation.

    Attributes
    ----------
    name
        As a person asks for it.
    what
        In words, unit not included.
    unit
        Of the number.
    more_is_better
        What winning means.
    of
        The number; NaN where it is not defined: a channel is saturated, a color is no signal.
    over_levels
        The same for many light levels [lx] at once, as `color_snr_over_levels`; ``None`` where it
        is asked one by one.
    """

    name: str
    what: str
    unit: str
    more_is_better: bool
    of: Callable[[Situation, ColorMatrix], float]
    over_levels: Callable[..., Array] | None = None


def color_snr(situation: Situation, matrix: ColorMatrix, *, coordinate: str) -> float:
    """SNR of X, Y or Z of a perfect white; NaN where it has none. [dB]"""
    electrons = _white_electrons(situation)
    if electrons is None:
        return float("nan")
    color = colored(with_noise(electrons, situation.sensor), matrix)
    i = matrix.coordinates.index(coordinate)
    return float(signal_snr_db(color, scene_xyz(white_scene(situation), matrix.metric))[i])


def color_snr_over_levels(
    situation: Situation,
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
    flat = np.ones(situation.illuminant.grid.n)
    white = Scene(
        illuminant=situation.illuminant, level_lux=1.0, reflectance=level_lux[:, None] * flat
    )
    electrons = expected_electrons(white, situation.sensor, situation.exposure)
    full = saturated(electrons, situation.sensor.pixel).any(axis=-1)
    raw = with_noise(electrons, situation.sensor)
    color = colored(raw, matrix) if matrices is None else _colored_each(raw, matrix, matrices)
    decibels = signal_snr_db(color, scene_xyz(white, matrix.metric))
    return np.where(full, np.nan, decibels[:, matrix.coordinates.index(coordinate)])


def _colored_each(
    raw: Measurement, matrix: ColorMatrix, matrices: Float[Array, "k c p"]
) -> Measurement:
    return Measurement(
        mean=(matrices @ raw.mean[..., None])[..., 0],
        covariance=matrices @ raw.covariance @ np.swapaxes(matrices, -1, -2),
        names=matrix.coordinates,
        kind="".join(matrix.coordinates),
        unit="lx",
        metric=matrix.metric,
    )


def is_saturated_over_levels(
    situation: Situation, level_lux: Float[Array, " k"]
) -> Bool[Array, " k"]:
    """Whether a channel is saturated on a perfect white, at many light levels, the time kept.

    Parameters
    ----------
    situation
        A sensor in use; its own light level is not asked.
    level_lux
        Illuminance. [lx]
    """
    full = saturated(level_lux[:, None] * _electrons_of_a_lux(situation), situation.sensor.pixel)
    return np.asarray(full.any(axis=-1))


def fullest_level_lux(situation: Situation) -> float | None:
    """Up to which illuminance on a perfect white no channel is saturated, the time kept. [lx]

    ``None`` where no channel sees the light. Electrons are linear in light, so it is the full
    well over the electrons of one lux in the channel that gets most.
    """
    most = float(_electrons_of_a_lux(situation).max())
    return situation.sensor.pixel.full_well_e / most if most > 0 else None


def _electrons_of_a_lux(situation: Situation) -> np.ndarray:
    white = flat_field(situation.illuminant, level_lux=1.0)
    return expected_electrons(white, situation.sensor, situation.exposure)


def raw_bound(situation: Situation, matrix: ColorMatrix) -> float:
    """SNR of the best linear readout of a perfect white, whatever the matrix. [dB]"""
    electrons = _white_electrons(situation)
    if electrons is None:
        return float("nan")
    return float(bound_db(with_noise(electrons, situation.sensor)))


def price(situation: Situation, matrix: ColorMatrix) -> float:
    """How far SNR of Y stays below the best linear readout. [dB]"""
    return raw_bound(situation, matrix) - color_snr(situation, matrix, coordinate="Y")


def color_error(situation: Situation, matrix: ColorMatrix) -> float:
    """Mean over the ColorChecker, without noise; NaN where the white is no color. [Delta E*ab]"""
    error = chart_color_error(situation.sensor, matrix, situation.exposure, situation.illuminant)
    return float("nan") if error is None else float(error.mean())


def color_errors(situation: Situation, matrices: Float[Array, "k c p"]) -> Float[Array, " k"]:
    """`color_error` of many matrices of one sensor and time. [Delta E*ab]"""
    return mean_chart_errors(situation.sensor, matrices, situation.exposure, situation.illuminant)


def grey_delta_e(situation: Situation, matrix: ColorMatrix) -> float:
    """Mean color difference that noise makes on an 18 % grey. [Delta E*ab]"""
    electrons = _white_electrons(situation)
    if electrons is None:
        return float("nan")
    white = matrix.matrix @ electrons
    if not (white > 0).all():
        return float("nan")
    grey = flat_field(situation.illuminant, level_lux=situation.level_lux, reflectance=GREY)
    raw = with_noise(
        expected_electrons(grey, situation.sensor, situation.exposure), situation.sensor
    )
    return float(perceived_noise(colored(raw, matrix), white, space=LAB).delta_e)


def is_saturated(situation: Situation) -> bool:
    """Whether a channel is saturated on a perfect white."""
    return _white_electrons(situation) is None


def _white_electrons(situation: Situation) -> np.ndarray | None:
    """Of a perfect white; ``None`` where a channel is saturated. [e-]"""
    electrons = expected_electrons(white_scene(situation), situation.sensor, situation.exposure)
    return None if saturated(electrons, situation.sensor.pixel).any() else electrons


def _snr(name: str, coordinate: str) -> Quantity:
    return Quantity(
        name=name,
        what=f"SNR of {coordinate} of a white",
        unit="dB",
        more_is_better=True,
        of=partial(color_snr, coordinate=coordinate),
        over_levels=partial(color_snr_over_levels, coordinate=coordinate),
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
            of=raw_bound,
        ),
        Quantity(
            name="price",
            what="price of color of a white",
            unit="dB",
            more_is_better=False,
            of=price,
        ),
        Quantity(
            name="delta-e",
            what="mean color difference by noise on an 18 % grey",
            unit="Delta E*ab",
            more_is_better=False,
            of=grey_delta_e,
        ),
        Quantity(
            name="color-error",
            what="mean color error of the chart without noise",
            unit="Delta E*ab",
            more_is_better=False,
            of=color_error,
        ),
    )
}
SNR_Y = QUANTITIES["snr-y"]
