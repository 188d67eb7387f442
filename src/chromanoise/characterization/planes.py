"""Results of one plane from its statistics, its photon transfer and its fixed patterns."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from chromanoise.characterization.lights import (
    DarkOf,
    Key,
    dark_of_levels,
    dark_samples,
    darks_of,
    key_of,
)
from chromanoise.characterization.linearity import linearity
from chromanoise.characterization.results import MEASURED, LevelNoise, PlaneNoise
from chromanoise.characterization.spatial import SpatialVariance
from chromanoise.characterization.statistics import PlaneSample, mean_shared
from chromanoise.io.frames.frame import FrameLevel, FrameSet
from chromanoise.sensor import TransferFit
from chromanoise.sensor.noise_profile import ROUNDING_DN2
from chromanoise.sensor.photon_transfer_table import LEAST_DARK_DN2

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
