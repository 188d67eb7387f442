"""Deviation of the mean from a straight line over the light, as EMVA 1288 defines it.

Results of one plane from its statistics, its photon transfer and its fixed patterns.

The curves of EMVA 1288 for one plane: photon transfer, SNR, linearity.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from chromanoise.apps.camera.characterization import MEASURED, LevelNoise, PlaneNoise
from chromanoise.apps.camera.lights import (
    DarkOf,
    Key,
    dark_of_levels,
    dark_samples,
    darks_of,
    key_of,
)
from chromanoise.apps.camera.statistics import PlaneSample, SpatialVariance, mean_shared
from chromanoise.base import Array, Bool, Float
from chromanoise.io.frames import FrameLevel, FrameSet
from chromanoise.sensor import LEAST_DARK_DN2, ROUNDING_DN2, TransferFit

_LOWEST, _HIGHEST = 0.05, 0.95  # of saturation, between which the line is fitted


def linearity(
    signal_dn: Float[Array, " m"], light: Float[Array, " m"], saturation_dn: float | None
) -> tuple[Float[Array, " m"], Float[Array, " m"]] | None:
    """The line and the deviation from it; ``None`` with fewer than three levels of light.

    Parameters
    ----------
    signal_dn
        Mean above dark. [DN]
    light
        Photons, or exposure times. [1] or [ms]
    saturation_dn
        Mean above dark at saturation; ``None`` where no level is saturated. [DN]

    Returns
    -------
    tuple
        The line [DN], and the deviation [%], NaN outside 5 to 95 % of saturation.

    Notes
    -----
    EMVA Standard 1288, release 4.0 Linear, chapter 6: least squares of the relative deviations,
    with the weights 1 / signal^2. Without saturation, up to the brightest level.
    """
    top = float(signal_dn.max()) / _HIGHEST if saturation_dn is None else saturation_dn
    used = (signal_dn >= _LOWEST * top) & (signal_dn <= _HIGHEST * top * (1 + 1e-9))
    if np.unique(light[used]).size < 3:
        return None
    weight, at = 1 / signal_dn[used] ** 2, light[used]
    center = (weight @ at) / weight.sum()
    mean = (weight @ signal_dn[used]) / weight.sum()
    offset = at - center
    slope = (weight * offset) @ (signal_dn[used] - mean) / (weight @ offset**2)
    line = mean + slope * (light - center)
    deviation = np.full_like(signal_dn, np.nan)
    deviation[used] = 100 * (signal_dn[used] - line[used]) / line[used]
    return line, deviation


_PLATEAU = 0.1  # of the largest variance above dark, below which a level is saturated
_LEAST_SIGNAL_E = 0.5  # added to the dark noise: EMVA 1288, eq. of the absolute threshold


@dataclass(frozen=True, slots=True, kw_only=True)
class _Value:
    """A number and its standard error."""

    value: float | None = None
    se: float | None = None


def _root(variance: float, se: float, scale: float, relative_se: float) -> _Value:
    """Root of a variance over a scale; 0 where the variance is negative by chance.

    The error is a third of the way from the root to the farther root of variance +- 3 se: far above
    se it is se / (2 root), and at 0, where that fails, the root of se / 3. So a true value
    within 3 standard errors of the variance is within 3 errors of the root, and the root is
    above 3 errors exactly if the variance is above 3 standard errors.
    """
    found = max(variance, 0.0)
    value, low, high = (
        math.sqrt(max(one, 0.0)) / scale for one in (found, found - 3 * se, found + 3 * se)
    )
    return _Value(
        value=value, se=math.hypot(max(high - value, value - low) / 3, value * relative_se)
    )


def plane_noise(
    frames: FrameSet,
    lit: Sequence[FrameLevel],
    own: Mapping[Key, PlaneSample],
    fit: TransferFit,
    *,
    name: str,
    flat: SpatialVariance,
    dark: SpatialVariance | None,
    dark_alone: SpatialVariance | None,
    dark_filtered: SpatialVariance | None,
    hot: int | None,
) -> PlaneNoise:
    """All results of one plane.

    Parameters
    ----------
    frames, lit
        All frames, and the levels with flats from dark to bright.
    own
        Statistics of the plane by the names of the frames.
    fit
        The photon transfer, whose rows are the levels ``lit``, then the darks.
    name
        Of the plane.
    flat, dark, dark_filtered
        Spatial variances of its flats, and of the darks without and with the high-pass filter.
    dark_alone
        Spatial variance of the darks after subtraction of the temporal noise of these darks only.
    hot
        Number of hot pixels.
    """
    gain, relative = fit.gain_dn_per_e, fit.gain_se / fit.gain_dn_per_e
    dark_of = _dark_of(frames, own, fit)
    prnu = dsnu = _Value()
    hidden = hidden_by_rounding(frames, own)
    if dark is not None and dark_filtered is not None:
        dsnu = _Value() if hidden else _root(dark.variance_dn2, dark.se_dn2, gain, relative)
        prnu = _root(
            flat.variance_dn2 - dark_filtered.variance_dn2,
            math.hypot(flat.se_dn2, dark_filtered.se_dn2),
            flat.signal_dn(dark_filtered),
            0.0,
        )
    row, column = (
        _Value() if hidden else _shared(own, frames, which, gain, relative)
        for which in ("row", "column")
    )
    full = _full_well(lit, own, fit, dark_of)
    pixel = {"full_well_e": full, "dsnu_e": dsnu, "prnu": prnu}
    pixel |= {"row_noise_e": row, "column_noise_e": column}
    if hidden:
        pixel["dark_current_e_per_s"] = _Value()
    return plane_of_fit(
        fit,
        **{name: one.value for name, one in pixel.items()},
        **{f"{name}_se": one.se for name, one in pixel.items()},
        name=name,
        black_level_dn_se=_black_level(
            own, frames, fit, 0.0 if dsnu.value is None else dsnu.value * gain
        ),
        linearity_error_percent=_linearity_error(lit, own, fit, dark_of),
        dsnu_of_own_frames_e=None
        if dark_alone is None or dsnu.value is None
        else math.sqrt(max(dark_alone.variance_dn2, 0.0)) / gain,
        hot_pixels=hot,
        levels=_levels(lit, own, fit, dark_of, dark=bool(darks_of(frames))),
    )


def plane_of_fit(fit: TransferFit, **values: Any) -> PlaneNoise:
    """The results of a plane: those of its photon transfer, and others.

    Parameters
    ----------
    fit
        The photon transfer.
    values
        Other fields of `PlaneNoise`, also in place of those of the fit.
    """
    own = ("gain_dn_per_e", "saturation_dn", "saturation_capacity_e", "qe", "qe_se", "bend_z")
    of_fit: dict[str, Any] = {name: getattr(fit, name, None) for name in (*own, *MEASURED)}
    of_fit |= {
        "gain_dn_per_e_se": fit.gain_se,
        "dark_noise_e": fit.read_noise_e,
        "dark_noise_e_se": fit.read_noise_se,
        "black_level_dn": fit.black_dn,
        "dynamic_range_db": dynamic_range_db(
            fit.saturation_capacity_e, threshold_e(fit.gain_dn_per_e, fit.read_noise_e)
        ),
        "dark_current_e_per_s_se": fit.dark_current_se,
        "prnu_se": fit.prnu_se,
        "fit": fit,
    }
    return PlaneNoise(**of_fit | values)


def _dark_of(frames: FrameSet, own: Mapping[Key, PlaneSample], fit: TransferFit) -> DarkOf:
    """As `dark_of_levels`; without darks, the stated black level and the noise of the fit."""
    if darks_of(frames) or fit.black_dn is None:
        return dark_of_levels(frames, own)
    base = fit.black_dn, (fit.gain_dn_per_e * (fit.read_noise_e or 0.0)) ** 2 + ROUNDING_DN2
    return lambda _level: base


def threshold_e(gain_dn_per_e: float, dark_noise_e: float | None) -> float | None:
    """The absolute sensitivity threshold; ``None`` without dark noise. [e-]

    Parameters
    ----------
    gain_dn_per_e
        The gain K. [DN/e-]
    dark_noise_e
        Temporal dark noise, rounding not included. [e-]

    Notes
    -----
    EMVA Standard 1288, release 4.0 Linear: sqrt(sigma_d^2 + 1 / (12 K^2)) + 1/2.
    """
    if dark_noise_e is None:
        return None
    return math.sqrt(dark_noise_e**2 + ROUNDING_DN2 / gain_dn_per_e**2) + _LEAST_SIGNAL_E


def dynamic_range_db(capacity_e: float | None, least_e: float | None) -> float | None:
    """20 log10 of the saturation capacity over `threshold_e`; ``None`` if one is unknown. [dB]

    Parameters
    ----------
    capacity_e, least_e
        Of a plane. [e-]

    Notes
    -----
    EMVA Standard 1288, release 4.0 Linear: mu_e.sat / mu_e.min.
    """
    return 20 * math.log10(capacity_e / least_e) if capacity_e and least_e else None


def hidden_by_rounding(frames: FrameSet, own: Mapping[Key, PlaneSample]) -> bool:
    """Whether the dark noise is so low that rounding hides small effects in the dark.

    EMVA 1288, release 4.0: a dark variance below 0.24 DN^2 is mostly quantization.
    """
    darks = dark_samples(frames, own)
    return bool(darks) and min(one.variance_dn2 for one in darks) < LEAST_DARK_DN2


def _shared(
    own: Mapping[Key, PlaneSample], frames: FrameSet, which: str, gain: float, relative: float
) -> _Value:
    """Noise that all pixels of a row, or of a column, share in the dark, from all darks."""
    samples = dark_samples(frames, own)
    if not samples:
        return _Value()
    return _root(*mean_shared(samples, which), gain, relative)


def _black_level(
    own: Mapping[Key, PlaneSample], frames: FrameSet, fit: TransferFit, dsnu_dn: float
) -> float | None:
    """Standard error of the mean code without light at exposure time 0. [DN]"""
    groups = {key: level.time_ms for key, level in darks_of(frames).items()}
    if fit.black_dn is None or not groups:
        return None
    variances = np.array([own[key].mean_variance_dn2 for key in groups])
    pixels = next(iter(own.values())).pixels
    noise_dn2 = min(own[key].variance_dn2 for key in groups) + dsnu_dn**2
    weights = np.full(variances.size, 1 / variances.size)
    known = [time for time in groups.values() if time is not None]
    if len(known) == variances.size and len(set(known)) > 1:
        times = np.array(known)
        weights = (times == times.min()) / (times == times.min()).sum()
        if len(set(known)) > 2:
            away = times - times.mean()
            weights = 1 / times.size - times.mean() * away / float(away @ away)
    rounding = 0.5 * (math.exp(-2 * math.pi**2 * noise_dn2) / math.pi) ** 2
    return math.sqrt(float(weights**2 @ variances) + dsnu_dn**2 / pixels + rounding)


def _full_well(
    lit: Sequence[FrameLevel],
    own: Mapping[Key, PlaneSample],
    fit: TransferFit,
    dark_of: DarkOf,
) -> _Value:
    """Electrons at which codes saturate. [e-]

    Above saturation the variance collapses and the mean stays constant: that mean is used. Without
    such a level, it is the mean at the largest variance, known to within the next level.
    """
    if fit.full_well_e is None or fit.saturation_dn is None:
        return _Value()
    gain, relative = fit.gain_dn_per_e, fit.gain_se / fit.gain_dn_per_e
    samples = [own[key_of(level.flats)] for level in lit]
    shot = [one.variance_dn2 - dark_of(level)[1] for level, one in zip(lit, samples, strict=True)]
    at = [one.mean_dn - dark_of(level)[0] for level, one in zip(lit, samples, strict=True)]
    flat = [
        i
        for i, one in enumerate(samples)
        if shot[i] < _PLATEAU * max(shot) and one.mean_dn > fit.saturation_dn
    ]
    if flat:
        brightest = max(flat, key=lambda i: samples[i].mean_dn)
        black = dark_of(lit[0])[0] if fit.black_dn is None else fit.black_dn
        value = (samples[brightest].mean_dn - black) / gain  # dark electrons fill the well too
        return _Value(value=value, se=value * relative)
    k = int(np.argmin([abs(one.mean_dn - fit.saturation_dn) for one in samples]))
    spacing = (at[min(k + 1, len(at) - 1)] - at[max(k - 1, 0)]) / gain
    value = fit.full_well_e
    return _Value(value=value, se=math.hypot(value * relative, spacing / math.sqrt(12)))


def _linearity_error(
    lit: Sequence[FrameLevel],
    own: Mapping[Key, PlaneSample],
    fit: TransferFit,
    dark_of: DarkOf,
) -> float | None:
    """Largest deviation from a line by relative least squares, 5 to 95 % of saturation. [%]

    Against photons where they are given, else against the exposure time.
    """
    light = [level.photons_per_pixel for level in lit]
    if None in light:
        light = [level.time_ms for level in lit]
    if None in light or len(set(light)) < 3:
        return None
    signal = np.array([own[key_of(level.flats)].mean_dn - dark_of(level)[0] for level in lit])
    top = None if fit.saturation_dn is None else fit.saturation_dn - dark_of(lit[-1])[0]
    found = linearity(signal, np.array(light, float), top)
    return None if found is None else float(np.nanmax(np.abs(found[1])))


def _levels(
    lit: Sequence[FrameLevel],
    own: Mapping[Key, PlaneSample],
    fit: TransferFit,
    dark_of: DarkOf,
    *,
    dark: bool,
) -> tuple[LevelNoise, ...]:
    noises = []
    for i, level in enumerate(lit):
        sample, (dark_mean, dark_variance) = own[key_of(level.flats)], dark_of(level)
        predicted = fit.gain_dn_per_e * (sample.mean_dn - dark_mean) + dark_variance
        noises.append(
            LevelNoise(
                name=level.name,
                frames=len(level.flats),
                time_ms=level.time_ms,
                photons_per_pixel=level.photons_per_pixel,
                mean_dn=sample.mean_dn,
                variance_dn2=sample.variance_dn2,
                variance_se_dn2=sample.variance_dn2 * math.sqrt(2 / (sample.samples - 1)),
                predicted_variance_dn2=predicted,
                dark_mean_dn=dark_mean if dark else None,
                dark_variance_dn2=dark_variance if dark else None,
                fitted=bool(fit.fitted[i]),
                clipped_share=sample.top_share,
                correlation_right=sample.correlation_right,
                correlation_down=sample.correlation_down,
                drift_z=sample.drift_z,
            )
        )
    return tuple(noises)


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
