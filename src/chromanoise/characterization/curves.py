"""The curves of EMVA 1288 for one plane: photon transfer, SNR, linearity."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.characterization.linearity import linearity
from chromanoise.characterization.results import PlaneNoise
from chromanoise.sensor.noise_profile import ROUNDING_DN2

_POINTS = 120


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlaneCurves:
    """The curves of one plane against the light.

    Attributes
    ----------
    name
        Of the plane.
    signal_dn
        Mean above dark, of each level with light. [DN]
    variance_dn2, predicted_dn2
        Measured variance, and that of the linear model. [DN^2]
    shot_dn2, shot_se_dn2
        Variance above that in the dark, and its standard error. [DN^2]
    fitted
        Levels to which K was fitted.
    residual_z
        Variance minus prediction over its standard error. [1]
    snr
        Signal over the root of the variance. [1]
    model_signal_dn, model_shot_dn2, model_snr, ideal_snr
        The line with slope K, the SNR of the linear model, and that of shot noise alone, at
        logarithmically spaced signals. [DN], [DN^2], [1], [1]
    light, light_unit
        Photons per pixel or exposure time of each level; ``None`` if they are not known. [1], [ms]
    line_dn, deviation_percent
        The straight line of the mean over the light, and the deviation from it at the levels of
        the fit, NaN elsewhere; ``None`` without light or with fewer than 3 levels. [DN], [%]
    """

    name: str
    signal_dn: Float[Array, " m"]
    variance_dn2: Float[Array, " m"]
    predicted_dn2: Float[Array, " m"]
    shot_dn2: Float[Array, " m"]
    shot_se_dn2: Float[Array, " m"]
    fitted: Bool[Array, " m"]
    residual_z: Float[Array, " m"]
    snr: Float[Array, " m"]
    model_signal_dn: Float[Array, " k"]
    model_shot_dn2: Float[Array, " k"]
    model_snr: Float[Array, " k"]
    ideal_snr: Float[Array, " k"]
    light: Float[Array, " m"] | None
    light_unit: Literal["photons", "ms", ""]
    line_dn: Float[Array, " m"] | None
    deviation_percent: Float[Array, " m"] | None


def plane_curves(plane: PlaneNoise) -> PlaneCurves | None:
    """The curves of one plane; ``None`` if no level is brighter than the darks.

    Parameters
    ----------
    plane
        A plane.

    Notes
    -----
    EMVA Standard 1288, Release 4.0 Linear: SNR = signal / standard deviation (chapter 2); linearity
    is the deviation from a line that is fitted to the relative deviations, i.e. with the weights
    1 / signal^2, from 5 to 95 % of saturation (chapter 6).
    """
    black = plane.black_level_dn if plane.black_level_dn is not None else 0.0
    darks = [black if one.dark_mean_dn is None else one.dark_mean_dn for one in plane.levels]
    signals = np.array([one.mean_dn for one in plane.levels]) - np.array(darks)
    lit = [i for i in range(len(plane.levels)) if signals[i] > 0]
    if not lit:
        return None
    levels, signal = [plane.levels[i] for i in lit], signals[lit]
    gain, dark_dn2 = plane.gain_dn_per_e, _dark_dn2(plane)
    variance = np.array([one.variance_dn2 for one in levels])
    error = np.array([one.variance_se_dn2 for one in levels])
    predicted = np.array([one.predicted_variance_dn2 for one in levels])
    own_dark = np.array(
        [dark_dn2 if one.dark_variance_dn2 is None else one.dark_variance_dn2 for one in levels]
    )
    model = np.geomspace(signal.min() / 2, signal.max(), _POINTS)
    light, unit = _light(plane, lit)
    line, deviation = _linearity(plane, signal, light)
    residual = np.divide(variance - predicted, error, out=np.zeros_like(variance), where=error > 0)
    return PlaneCurves(
        name=plane.name,
        signal_dn=signal,
        variance_dn2=variance,
        predicted_dn2=predicted,
        shot_dn2=variance - own_dark,
        shot_se_dn2=error,
        fitted=np.array([one.fitted for one in levels], dtype=bool),
        residual_z=residual,
        snr=np.divide(
            signal, np.sqrt(variance), out=np.full_like(signal, np.nan), where=variance > 0
        ),
        model_signal_dn=model,
        model_shot_dn2=gain * model,
        model_snr=model / np.sqrt(gain * model + dark_dn2),
        ideal_snr=np.sqrt(model / gain),
        light=light,
        light_unit=unit,
        line_dn=line,
        deviation_percent=deviation,
    )


def _dark_dn2(plane: PlaneNoise) -> float:
    """Variance without light: of the dark noise, or that of the darkest level with darks."""
    if plane.dark_variance_dn2 is not None:
        return plane.dark_variance_dn2
    known = [one.dark_variance_dn2 for one in plane.levels if one.dark_variance_dn2 is not None]
    return known[0] if known else ROUNDING_DN2


def _light(
    plane: PlaneNoise, lit: list[int]
) -> tuple[Float[Array, " m"] | None, Literal["photons", "ms", ""]]:
    """Photons if every level has them, else times if they differ."""
    photons = [plane.levels[i].photons_per_pixel for i in lit]
    if all(one is not None for one in photons):
        return np.array(photons, dtype=float), "photons"
    times = [plane.levels[i].time_ms for i in lit]
    if all(one is not None for one in times) and len(set(times)) > 2:
        return np.array(times, dtype=float), "ms"
    return None, ""


def _linearity(
    plane: PlaneNoise, signal: Array, light: Array | None
) -> tuple[Float[Array, " m"] | None, Float[Array, " m"] | None]:
    if light is None:
        return None, None
    black = plane.black_level_dn if plane.black_level_dn is not None else 0.0
    top = None if plane.saturation_dn is None else plane.saturation_dn - black
    return linearity(signal, light, top) or (None, None)
