"""Results of one plane: noise, linearity error, and the curves of EMVA 1288.

They follow from the plane's statistics, its photon transfer and its fixed patterns. The linearity
error is the deviation of the mean from a straight line over the light, as EMVA 1288 defines it. The
curves are photon transfer, SNR and linearity.
"""

import math
from collections.abc import Iterator, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np

from chromanoise.apps.camera.characterization import (
    MEASURED,
    LevelNoise,
    PlaneNoise,
    dynamic_range_db,
    threshold_e,
)
from chromanoise.apps.camera.lights import PlaneLights
from chromanoise.apps.camera.statistics import PlaneSample, SpatialVariance, mean_shared
from chromanoise.base import Array, Bool, Float, dataclass
from chromanoise.io.frames import FrameLevel
from chromanoise.sensor import ROUNDING_DN2, TransferFit

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
    if len({*light[used].tolist()}) < 3:
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


class _Value(NamedTuple):
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
    return _Value(value, math.hypot(max(high - value, value - low) / 3, value * relative_se))


@dataclass(frozen=True, kw_only=True)
class FixedNoise:
    """What averaged frames show of one plane.

    Attributes
    ----------
    flat
        Spatial variance of the flats at half of saturation.
    dark, dark_filtered
        Of their darks, without and with the high-pass filter; ``None`` without darks.
    dark_alone
        Of the darks after subtraction of the temporal noise of these darks only.
    hot
        Number of hot pixels.
    """

    flat: SpatialVariance
    dark: SpatialVariance | None = None
    dark_filtered: SpatialVariance | None = None
    dark_alone: SpatialVariance | None = None
    hot: int | None = None


def plane_noise(own: PlaneLights, fit: TransferFit, fixed: FixedNoise, name: str) -> PlaneNoise:
    """All results of one plane.

    Parameters
    ----------
    fit
        The photon transfer, whose rows are the levels from dark to bright, then the darks.
    """
    gain, relative = fit.gain_dn_per_e, fit.gain_se / fit.gain_dn_per_e
    prnu = dsnu = row = column = current = _Value()
    if fixed.dark is not None and fixed.dark_filtered is not None:
        prnu = _root(
            fixed.flat.variance_dn2 - fixed.dark_filtered.variance_dn2,
            math.hypot(fixed.flat.se_dn2, fixed.dark_filtered.se_dn2),
            fixed.flat.signal_dn(fixed.dark_filtered),
            0.0,
        )
    if not own.hidden:
        current = _Value(fit.dark_current_e_per_s, fit.dark_current_se)
        if fixed.dark is not None:
            dsnu = _root(fixed.dark.variance_dn2, fixed.dark.se_dn2, gain, relative)
        if own.darks:
            row, column = (
                _root(*mean_shared(own.darks, which), gain, relative) for which in ("row", "column")
            )
    transfer = _Transfer.of(own, fit)
    pixel = {
        "full_well_e": _full_well(transfer, fit),
        "dsnu_e": dsnu,
        "prnu": prnu,
        "row_noise_e": row,
        "column_noise_e": column,
        "dark_current_e_per_s": current,
    }
    alone = fixed.dark_alone if dsnu.value is not None else None
    return plane_of_fit(
        fit,
        **{name: one.value for name, one in pixel.items()},
        **{f"{name}_se": one.se for name, one in pixel.items()},
        name=name,
        black_level_dn_se=_black_level(own, fit, (dsnu.value or 0.0) * gain),
        linearity_error_percent=_linearity_error(transfer, fit),
        dsnu_of_own_frames_e=None
        if alone is None
        else math.sqrt(max(alone.variance_dn2, 0.0)) / gain,
        hot_pixels=fixed.hot,
        levels=tuple(transfer.noises(fit)),
    )


def plane_of_fit(fit: TransferFit, **values: Any) -> PlaneNoise:
    """The results of a plane: those of its photon transfer, and others.

    Parameters
    ----------
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


@dataclass(frozen=True, kw_only=True, eq=False)
class _Transfer:
    """The levels with light, from dark to bright, with mean and variance of each in the dark.

    Attributes
    ----------
    dark
        Mean and variance without light: [DN], [DN^2].
    measured
        Whether they are of darks.
    """

    levels: Sequence[FrameLevel]
    samples: Sequence[PlaneSample]
    dark: Float[Array, "m 2"]
    measured: bool

    @classmethod
    def of(cls, own: PlaneLights, fit: TransferFit) -> "_Transfer":
        """Without darks, in the dark are the stated black level and the noise of the fit."""
        levels = own.lights.lit
        dark = [own.dark_of(level) for level in levels]
        if not own.darks and fit.black_dn is not None:
            noise_dn = fit.gain_dn_per_e * (fit.read_noise_e or 0.0)
            dark = [(fit.black_dn, noise_dn**2 + ROUNDING_DN2)] * len(levels)
        samples = [own.of(level.flats) for level in levels]
        return cls(levels=levels, samples=samples, dark=np.array(dark), measured=bool(own.darks))

    @property
    def signal_dn(self) -> Float[Array, " m"]:
        """Mean above dark. [DN]"""
        return np.array([one.mean_dn for one in self.samples]) - self.dark[:, 0]

    def noises(self, fit: TransferFit) -> Iterator[LevelNoise]:
        """The noise of each level."""
        rows = zip(self.levels, self.samples, self.dark.tolist(), fit.fitted.tolist(), strict=False)
        for level, sample, dark, fitted in rows:
            yield level_noise(
                level.name,
                sample.mean_dn,
                sample.variance_dn2,
                sample.samples,
                (dark[0], dark[1]),
                fit.gain_dn_per_e,
                dark_measured=self.measured,
                frames=len(level.flats),
                time_ms=level.time_ms,
                photons_per_pixel=level.photons_per_pixel,
                fitted=fitted,
                clipped_share=sample.top_share,
                correlation_right=sample.correlation_right,
                correlation_down=sample.correlation_down,
                drift_z=sample.drift_z,
            )


def level_noise(
    name: str,
    mean_dn: float,
    variance_dn2: float,
    samples: float | None,
    dark: tuple[float, float],
    gain_dn_per_e: float,
    *,
    dark_measured: bool,
    **values: Any,
) -> LevelNoise:
    """The noise of a level, with its error and what the linear model predicts.

    Parameters
    ----------
    mean_dn, variance_dn2, samples
        Mean and temporal variance, and number of samples; ``None`` if not known. [DN], [DN^2], [1]
    dark
        Mean and variance without light. [DN], [DN^2]
    dark_measured
        Whether they are of darks.
    values
        Other fields of `LevelNoise`.
    """
    black_dn, floor_dn2 = dark
    error_dn2 = 0.0 if samples is None else variance_dn2 * math.sqrt(2 / (samples - 1))
    return LevelNoise(
        name=name,
        mean_dn=mean_dn,
        variance_dn2=variance_dn2,
        variance_se_dn2=error_dn2,
        predicted_variance_dn2=gain_dn_per_e * (mean_dn - black_dn) + floor_dn2,
        dark_mean_dn=black_dn if dark_measured else None,
        dark_variance_dn2=floor_dn2 if dark_measured else None,
        **values,
    )


def _black_level(own: PlaneLights, fit: TransferFit, dsnu_dn: float) -> float | None:
    """Standard error of the mean code without light at exposure time 0. [DN]"""
    if fit.black_dn is None or not own.darks:
        return None
    times = np.array([level.time_ms for level in own.lights.darks.values()], dtype=float)
    weights = np.full(times.size, 1 / times.size)
    if np.isfinite(times).all() and len({*times.tolist()}) > 1:
        weights = (times == times.min()) / (times == times.min()).sum()
        if len({*times.tolist()}) > 2:
            away = times - times.mean()
            weights = 1 / times.size - times.mean() * away / float(away @ away)
    noise_dn2 = min(one.variance_dn2 for one in own.darks) + dsnu_dn**2
    rounding = 0.5 * (math.exp(-2 * math.pi**2 * noise_dn2) / math.pi) ** 2
    variances = np.array([one.mean_variance_dn2 for one in own.darks])
    patterns = dsnu_dn**2 / own.darks[0].pixels
    return math.sqrt(float(weights**2 @ variances) + patterns + rounding)


def _full_well(transfer: _Transfer, fit: TransferFit) -> _Value:
    """Electrons at which codes saturate. [e-]

    Above saturation the variance collapses and the mean stays constant: that mean is used. Without
    such a level, it is the mean at the largest variance, known to within the next level.
    """
    if fit.full_well_e is None or fit.saturation_dn is None:
        return _Value()
    gain, relative = fit.gain_dn_per_e, fit.gain_se / fit.gain_dn_per_e
    mean = np.array([one.mean_dn for one in transfer.samples])
    shot = np.array([one.variance_dn2 for one in transfer.samples]) - transfer.dark[:, 1]
    flat = (shot < _PLATEAU * shot.max()) & (mean > fit.saturation_dn)
    if flat.any():
        black = transfer.dark[0, 0] if fit.black_dn is None else fit.black_dn
        value = float(mean[flat].max() - black) / gain  # dark electrons fill the well too
        return _Value(value, value * relative)
    k, at = int(np.abs(mean - fit.saturation_dn).argmin()), transfer.signal_dn
    spacing = float(at[min(k + 1, at.size - 1)] - at[max(k - 1, 0)]) / gain
    value = fit.full_well_e
    return _Value(value, math.hypot(value * relative, spacing / math.sqrt(12)))


def _linearity_error(transfer: _Transfer, fit: TransferFit) -> float | None:
    """Largest deviation from a line by relative least squares, 5 to 95 % of saturation. [%]

    Against photons where they are given, else against the exposure time.
    """
    light = [level.photons_per_pixel for level in transfer.levels]
    if None in light:
        light = [level.time_ms for level in transfer.levels]
    if None in light:
        return None
    top = None if fit.saturation_dn is None else fit.saturation_dn - float(transfer.dark[-1, 0])
    found = linearity(transfer.signal_dn, np.array(light, float), top)
    return None if found is None else float(np.nanmax(np.abs(found[1])))


_POINTS = 120


@dataclass(frozen=True, kw_only=True, eq=False)
class PlaneCurves:
    """The curves of one plane against the light.

    Attributes
    ----------
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

    Notes
    -----
    EMVA Standard 1288, Release 4.0 Linear: SNR = signal / standard deviation (chapter 2); linearity
    is the deviation from a line that is fitted to the relative deviations, i.e. with the weights
    1 / signal^2, from 5 to 95 % of saturation (chapter 6).
    """
    black = plane.black_level_dn or 0.0
    darks = [black if one.dark_mean_dn is None else one.dark_mean_dn for one in plane.levels]
    signals = np.array([one.mean_dn for one in plane.levels]) - np.array(darks)
    if not (signals > 0).any():
        return None
    levels = [one for one, signal in zip(plane.levels, signals, strict=True) if signal > 0]

    def column(name: str) -> Array:
        return np.array([getattr(one, name) for one in levels], dtype=float)

    signal, gain, dark_dn2 = signals[signals > 0], plane.gain_dn_per_e, _dark_dn2(plane)
    variance, error = column("variance_dn2"), column("variance_se_dn2")
    predicted, own_dark = column("predicted_variance_dn2"), column("dark_variance_dn2")
    model = np.geomspace(signal.min() / 2, signal.max(), _POINTS)
    photons, times = column("photons_per_pixel"), column("time_ms")
    light: Array | None = None
    unit: Literal["photons", "ms", ""] = ""
    if np.isfinite(photons).all():
        light, unit = photons, "photons"
    elif np.isfinite(times).all() and len({*times.tolist()}) > 2:
        light, unit = times, "ms"
    top = None if plane.saturation_dn is None else plane.saturation_dn - black
    straight = None if light is None else linearity(signal, light, top)
    line, deviation = straight or (None, None)
    with np.errstate(divide="ignore", invalid="ignore"):
        snr = np.where(variance > 0, signal / np.sqrt(variance), np.nan)
        residual_z = np.where(error > 0, (variance - predicted) / error, 0.0)
    return PlaneCurves(
        name=plane.name,
        signal_dn=signal,
        variance_dn2=variance,
        predicted_dn2=predicted,
        shot_dn2=variance - np.where(np.isnan(own_dark), dark_dn2, own_dark),
        shot_se_dn2=error,
        fitted=np.array([one.fitted for one in levels], dtype=bool),
        residual_z=residual_z,
        snr=snr,
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
