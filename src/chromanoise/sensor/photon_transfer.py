"""Photon transfer: gain, read noise, full well, QE and PRNU from the variance over the mean.

For a mean code x above the dark mean, the temporal variance exceeds the dark variance by K x, which
is shot noise. EMVA 1288 fits a straight line; a variance over the pixels of one picture also has
the term (PRNU x)^2.

EMVA Standard 1288, Release 4.0 Linear (2021), chapters 2 and 6; Janesick, Photon Transfer (SPIE,
2007).
"""

import numpy as np

from chromanoise.base import Array, InputError, dataclass
from chromanoise.sensor.camera_noise import ROUNDING_DN2
from chromanoise.sensor.changes import PixelSource
from chromanoise.sensor.photon_transfer_regression import (
    LEAST_DARK_DN2,
    Levels,
    PhotonTransfer,
    Regression,
    TransferFit,
    dark_mean_error2,
    levels_of,
    residuals_z,
    rounding_error2,
    straight_fit,
    variance_error2,
    weighted_fit,
)

__all__ = ["PhotonTransfer", "TransferFit", "photon_transfer_fit", "pixel_from_photon_transfer"]

_FIT_SHARE = 0.7  # of saturation: upper end of the gain fit in EMVA 1288
_NAMED_Z = 5.0  # rows farther from the fit are named in a note
_SCATTERED = 4.0  # of squared residuals per degree of freedom: twice the scatter expected
_CURVED_Z = 3.0  # a larger quadratic term is significant
_LEAST_GAIN = 1e-15  # smallest gain of any converter [DN/e-]
_IMPOSSIBLE_Z = 5.0  # standard errors above 1 beyond which the photons cannot be right
_FALLEN_Z = 5.0  # a fall by more standard errors of the difference is significant
_FALLEN = 0.05  # a fall by a larger share is significant if samples are unknown
_CLIPPED = 0.5  # a fall by a larger share is significant for any number of samples


def photon_transfer_fit(table: PhotonTransfer, *, black_dn: float | None = None) -> TransferFit:
    """Gain, read noise, full well, QE and PRNU, as EMVA 1288 evaluates a photon transfer.

    Parameters
    ----------
    table
        Mean and variance at several lights.
    black_dn
        Code without light, if the table has no dark rows; if ``None``, the read noise of such a
        table is unknown. [DN]

    Raises
    ------
    InputError
        If fewer than 3 rows, the dark included, lie below 70 % of saturation, the variance does
        not grow, or the photons are too few for the electrons.

    Notes
    -----
    EMVA 1288, Release 4.0 Linear, chapter 6: K is the slope of variance minus dark variance over
    mean minus dark mean, by least squares without weights, through the origin, from 0 to 70 % of
    saturation. sigma_d^2 = (dark variance - 1/12) / K^2; a dark variance below 0.24 DN^2 is mostly
    quantization, and 0.24 gives an upper limit. With dark rows at three or more exposure times the
    dark variance is extrapolated to time 0. Saturation is the maximum of the variance; the full
    well is the mean there minus the dark mean, divided by K. QE is the slope of the mean over the
    photons, divided by K. For a table without dark rows, a weighted line with an intercept is
    fitted.

    A second, weighted fit has a quadratic term. For temporal variances a significant term is a
    bend: the slopes at both ends are reported beside K, and the difference between K and the slope
    at low light enters the error of K. For spatial variances a significant positive term is PRNU^2,
    and K is the slope of this fit in the dark.

    A variance v of n samples has the standard error v sqrt(2 / (n - 1)); the error
    of the measured mean adds K^2 times the dark variance divided by the number of pixels read, with
    the fourth cumulant of the Poisson distribution included. Without the number of samples the
    scatter about the fit sets the scale.

    Examples
    --------
    >>> x = np.array([0.0, 100.0, 200.0, 400.0])
    >>> fit = photon_transfer_fit(PhotonTransfer(
    ...     mean_dn=64 + x, variance_dn2=4 + 1 / 12 + 0.5 * x, dark=x == 0, samples=0 * x + 1e4))
    >>> round(fit.gain_dn_per_e, 6), round(fit.read_noise_e, 6)
    (0.5, 4.0)
    """
    levels, lit, full = (
        levels_of(table, black_dn),
        np.flatnonzero(~table.dark),
        _saturated_row(table),
    )
    saturation = None if full is None else float(table.mean_dn[lit[full]])
    top = np.inf if full is None else _FIT_SHARE * levels.x[full]
    low = np.asarray(levels.x <= top)
    _demand_three(table.source, levels, low, saturation)
    curves = _curves(levels.of(low), table, float(levels.x[low].max() if full is None else top))
    notes = curves.notes(spatial=table.spatial)
    read, read_se = _read_noise(levels, curves, notes)
    current, current_se = _dark_current(levels, curves, notes)
    photons = None if table.photons is None else table.photons[lit[low]]
    qe, qe_se = _quantum_efficiency(levels.of(low), photons, curves, table.source, notes)
    prnu, prnu_se = _prnu(curves)
    well = None if full is None or not levels.black_known else float(levels.x[full]) / curves.gain
    if full is None:
        notes.append(
            "the variance of the brightest rows does not fall by more than its error, so the full "
            "well is unknown"
        )
    residual_z, fitted = np.zeros(table.dark.size), np.zeros(table.dark.size, dtype=bool)
    residual_z[lit], fitted[lit] = residuals_z(levels, curves.best), low
    chi2 = 1.0 if table.samples is None else curves.best.chi2_per_row
    notes += _oddities(table, residual_z, fitted, chi2)
    return TransferFit(
        source=table.source,
        gain_dn_per_e=curves.gain,
        gain_se=curves.gain_se,
        low_light_gain_dn_per_e=curves.low[0],
        low_light_gain_se=curves.low[1],
        high_light_gain_dn_per_e=curves.high[0],
        high_light_gain_se=curves.high[1],
        bend_z=curves.bend_z,
        read_noise_e=read,
        read_noise_se=read_se,
        dark_current_e_per_s=current,
        dark_current_se=current_se,
        prnu=prnu,
        prnu_se=prnu_se,
        qe=qe,
        qe_se=qe_se,
        black_dn=black_dn
        if levels.darks is None
        else float(levels.darks.at_no_time()[0] @ levels.darks.mean_dn),
        saturation_dn=saturation,
        full_well_e=well,
        saturation_capacity_e=well
        if table.photons is None or well is None or qe is None
        else qe * float(table.photons[lit][full]),
        fitted=fitted,
        residual_z=residual_z,
        chi2_per_row=chi2,
        notes=(*table.notes, *(f"{table.source}: {note}" for note in notes)),
    )


def pixel_from_photon_transfer(fit: TransferFit) -> PixelSource:
    """The pixel values that a photon transfer gives."""
    notes = [
        f"{what} {value:.4g} +- {error:.2g} {unit}"
        for what, value, error, unit in (
            ("read noise", fit.read_noise_e, fit.read_noise_se, "e-"),
            ("dark current", fit.dark_current_e_per_s, fit.dark_current_se, "e-/s"),
            ("PRNU", fit.prnu, fit.prnu_se, "of the signal"),
            ("QE", fit.qe, fit.qe_se, "e-/photon"),
        )
        if value is not None and error is not None
    ]
    black, current = fit.black_dn, fit.dark_current_e_per_s
    whole = None if black is None or round(black) < 0 else round(black)
    if black is not None and whole is None:
        notes.append(f"the black level of {black:.6g} DN is below 0 and not used")
    elif black is not None and whole != black:
        notes.append(f"black level of {black:.6g} DN rounded to {whole}")
    possible = fit.qe is None or fit.qe <= 1
    if not possible:
        notes.append("a QE above 1 is not used")
    gain = f"{fit.source}: K = {fit.gain_dn_per_e:.4g} +- {fit.gain_se:.2g} DN/e-"
    return PixelSource(
        source=fit.source,
        full_well_e=fit.full_well_e,
        read_noise_e=fit.read_noise_e,
        gain_e_per_dn=1 / fit.gain_dn_per_e,
        black_level_dn=whole,
        prnu=fit.prnu,
        dark_current_e_per_s=None if current is None else max(current, 0.0),
        qe=fit.qe if possible else None,
        notes=(gain, *fit.notes, *(f"{fit.source}: {note}" for note in notes)),
    )


def _demand_three(source: str, levels: Levels, low: Array, saturation: float | None) -> None:
    at = levels.x[low] if levels.darks is None else np.append(levels.x[low], 0.0)
    count = len(set(at.round(9).tolist()))
    if count < 3 and saturation is not None:
        raise InputError(
            source,
            "must have at least 3 rows of different mean, the dark included, below 70 % of "
            f"saturation ({saturation:g} DN)",
            value=count,
            found=f"has {count}",
            remedy="measure with less light",
        )
    if count < 3:
        raise _undetermined(source)


def _undetermined(source: str) -> InputError:
    return InputError(
        source,
        "must have at least 3 rows of different mean, the dark included",
        found="its means differ too little for a slope",
    )


_Measured = tuple[float | None, float | None]
"""A value and its standard error."""
_UNKNOWN: _Measured = (None, None)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Curves:
    """The line, the quadratic fit if there is one, and the gain of the one that applies.

    Attributes
    ----------
    best
        The quadratic fit if its bend is significant, else the line.
    gain_fit, gain, gain_se
        The fit of the gain, the gain, and its error with the misfit of a bend. [DN/e-]
    bend_z
        Quadratic term over its standard error.
    pattern
        Whether the bend is that of PRNU.
    low, high
        Slopes at both ends of the fit. [DN/e-]
    """

    best: Regression
    gain_fit: Regression
    gain: float
    gain_se: float
    bend_z: float | None
    significant: bool
    pattern: bool
    low: _Measured = _UNKNOWN
    high: _Measured = _UNKNOWN

    def notes(self, *, spatial: bool) -> list[str]:
        """A sentence on a significant bend."""
        (low, low_se), (high, high_se) = self.low, self.high
        if not self.significant or low is None or high is None:
            return []
        hint = (
            "; if the variance is over the pixels of one picture, name its column "
            "spatial_variance_dn2"
        )
        return [
            f"the variance bends {'up' if high > low else 'down'} (z = {self.bend_z:+.1f}): its "
            f"slope is {low:.4g} +- {low_se:.2g} DN/e- at low light and {high:.4g} +- "
            f"{high_se:.2g} DN/e- at the end of the fit; the error of K includes its difference "
            f"from the slope at low light{hint if high > low and not spatial else ''}"
        ]


def _curves(levels: Levels, table: PhotonTransfer, high_x: float) -> _Curves:
    """The fits to levels up to ``high_x`` above dark. [DN]"""
    slope, largest = levels.slope_at, float(np.abs(levels.x).max())
    line = weighted_fit(levels, bend=False)
    if line is None:
        raise _undetermined(table.source)
    bent, z = None, None
    if len({*levels.x.tolist()}) > slope + 2:
        bent = weighted_fit(levels, bend=True)
    if bent is not None:
        curvature, error = float(bent.values[-1]), float(bent.errors[-1])
        by_rounding = 1e-6 * abs(float(bent.values[slope])) / largest
        error = max(error, by_rounding / _CURVED_Z)
        z = curvature / error if error else 0.0
    significant = z is not None and abs(z) > _CURVED_Z
    best = bent if significant and bent is not None else line
    pattern = table.spatial and significant and float(best.values[-1]) > 0
    own = best if pattern else line
    if levels.darks is not None and not pattern:
        own = straight_fit(levels, best) or line
    gain, error = float(own.values[slope]), float(own.errors[slope])
    if gain <= _LEAST_GAIN:
        raise InputError(
            table.source,
            "must have a variance that grows with the mean",
            value=gain,
            found=f"the slope is {gain:g} DN",
            remedy="check that the columns are mean and variance, and that the light was changed",
        )
    slopes = {}
    if bent is not None and not pattern:
        weights = np.eye(bent.values.size)[slope]
        slopes["low"] = bent.combined(weights)
        slopes["high"] = bent.combined(weights + 2 * high_x * np.eye(weights.size)[-1])
        error = float(np.hypot(error, abs(gain - slopes["low"][0]) if significant else 0.0))
    return _Curves(
        best=best,
        gain_fit=own,
        gain=gain,
        gain_se=error,
        bend_z=z,
        significant=significant,
        pattern=pattern,
        **slopes,
    )


def _read_noise(levels: Levels, curves: _Curves, notes: list[str]) -> _Measured:
    """Root of the dark variance minus rounding, divided by the gain; error by the delta method."""
    gain, gain_se, fit, limited = curves.gain, curves.gain_se, curves.gain_fit, False
    if not levels.black_known:
        notes.append(
            "no dark row and no black level, so the read noise is unknown and K is the slope above "
            "the lowest mean"
        )
        return _UNKNOWN
    if levels.darks is None:
        variance, error2, common = float(fit.values[0]), fit.covariance[0, 0], fit.covariance[0, 1]
    else:
        weights, _ = levels.darks.at_no_time()
        dark_dn2 = levels.darks.variance_dn2
        if weights @ dark_dn2 < LEAST_DARK_DN2 <= dark_dn2.max():
            notes.append(
                f"the dark variance at exposure time 0 would be {weights @ dark_dn2:.3g} DN^2, so "
                "the read noise is that of the dark of the shortest time, its dark current "
                "included: an upper limit"
            )
            weights = levels.darks.at_shortest_time()
            limited = True
        error2s = fit.spread * variance_error2(dark_dn2, levels.darks.samples)
        variance = float(weights @ dark_dn2)
        error2, common = weights**2 @ error2s, -(fit.dark_lever[0] * weights) @ error2s
    dark = variance - ROUNDING_DN2
    highest = variance + _CURVED_Z * float(np.sqrt(error2))
    if levels.darks is None and variance < LEAST_DARK_DN2 < highest:
        limit = float(np.sqrt(highest - ROUNDING_DN2)) / gain
        notes.append(
            f"the variance at the black level is {variance:.3g} +- {np.sqrt(error2):.2g} DN^2, "
            f"extrapolated from the rows with light, so the read noise of {limit:.3g} e- is an "
            "upper limit"
        )
        return limit, None
    if variance < LEAST_DARK_DN2:
        limit = float(np.sqrt(LEAST_DARK_DN2 - ROUNDING_DN2)) / gain
        notes.append(
            f"the dark variance of {variance:.3g} DN^2 is mostly quantization (below "
            f"{LEAST_DARK_DN2} DN^2), so the read noise of {limit:.3g} e- is an upper limit"
        )
        return limit, None
    error2 += float(rounding_error2(np.array([dark]))[0])
    relative2 = error2 / (2 * dark) ** 2 + (gain_se / gain) ** 2 - common / (dark * gain)
    read = float(np.sqrt(dark)) / gain
    return read, None if limited else read * float(np.sqrt(max(relative2, 0.0)))


def _dark_current(levels: Levels, curves: _Curves, notes: list[str]) -> _Measured:
    """Slope of the dark means over the exposure time, divided by the gain."""
    slope = None if levels.darks is None else levels.darks.at_no_time()[1]
    if levels.darks is None or slope is None:
        return _UNKNOWN
    per_s = 1e3 / curves.gain
    errors2 = curves.gain_fit.spread * dark_mean_error2(levels.darks, levels.frames)
    current = float(slope @ levels.darks.mean_dn) * per_s
    error = float(np.sqrt(slope**2 @ errors2)) * per_s
    if current < -_CURVED_Z * error:
        notes.append(
            f"the dark mean falls with the exposure time ({current:.4g} +- {error:.2g} e-/s), so "
            "the dark current is unknown"
        )
        return _UNKNOWN
    if current < 0:
        notes.append(
            f"the dark current of {current:.4g} +- {error:.2g} e-/s is negative, but not "
            "significantly"
        )
    return current, float(np.hypot(error, current * curves.gain_se / curves.gain))


def _prnu(curves: _Curves) -> _Measured:
    """PRNU, the root of the quadratic term, if spatial variances bend upward."""
    if not curves.pattern:
        return _UNKNOWN
    root = float(np.sqrt(curves.best.values[-1]))
    return root, float(curves.best.errors[-1]) / (2 * root)


def _oddities(
    table: PhotonTransfer, residual_z: Array, fitted: Array, chi2_per_row: float
) -> list[str]:
    """Notes on rows far from the fit, and on scatter larger than the samples explain."""
    notes = [
        f"the row of mean {table.mean_dn[i]:g} DN is {residual_z[i]:+.1f} standard errors off the "
        "fit"
        for i in np.flatnonzero(fitted & (np.abs(residual_z) > _NAMED_Z))[:5]
    ]
    if chi2_per_row > _SCATTERED:
        notes.append(
            f"rows scatter {np.sqrt(chi2_per_row):.2g} times as far as their samples explain, so "
            "standard errors are too small; did light or gain change?"
        )
    return notes


def _saturated_row(table: PhotonTransfer) -> int | None:
    """Index of the lit row of largest variance; ``None`` if the variance does not fall above it.

    Rows are scanned from the brightest down to the first maximum that exceeds the next two rows,
    as in the reference code of EMVA 1288. A difference counts only if it is larger than sampling
    explains; otherwise the scatter of a table that ends early would be taken for saturation.
    """
    lit = ~table.dark
    light = (table.mean_dn if table.photons is None else table.photons)[lit]
    order = np.argsort(light, kind="stable")
    variance = table.variance_dn2[lit][order]
    samples = None if table.samples is None else table.samples[lit][order]
    best, low = variance.size - 1, _fallen(variance, samples, int(np.argmax(variance)))
    for i in range(variance.size - 1, -1, -1):
        if variance[i] >= variance[best]:
            best = i
        elif variance[max(i - 1, 0)] < variance[best] and not low[best]:
            break
    return int(order[best]) if _fallen(variance, samples, best)[best + 1 :].any() else None


def _fallen(variance: Array, samples: Array | None, top: int) -> Array:
    """Which variances lie below that of the row ``top`` by more than sampling explains."""
    if samples is None:
        return np.asarray(variance[top] - variance > _FALLEN * variance[top])
    error2 = variance_error2(variance, samples)
    scatter = _FALLEN_Z * np.sqrt(error2 + error2[top])
    return np.asarray(variance[top] - variance > np.minimum(scatter, _CLIPPED * variance[top]))


def _quantum_efficiency(
    levels: Levels, photons: Array | None, curves: _Curves, source: str, notes: list[str]
) -> _Measured:
    """QE = responsivity / gain; the error of the responsivity is from the scatter of its fit."""
    if photons is None or not levels.black_known:
        return _UNKNOWN
    if not photons.max() > 0:
        raise InputError(
            source,
            "must be > 0 in a lit row",
            value=0.0,
            found="is 0 in all of them",
            where="column 'photons'",
            remedy="omit the column",
        )
    response, error = _slope_through_origin(photons, levels.x)
    qe, relative = response / curves.gain, curves.gain_se / curves.gain
    qe_se = abs(qe) * float(np.hypot(error / response, relative)) if response else error
    if not 0 <= qe <= 1 + _IMPOSSIBLE_Z * qe_se:
        raise InputError(
            source,
            "must give a quantum efficiency of 0 to 1 [e-/photon]",
            value=qe,
            found=f"gives {qe:.4g} +- {qe_se:.2g}",
            where="column 'photons'",
            remedy=("give the mean photons per pixel and exposure", "omit the column"),
        )
    if qe > 1:
        notes.append(
            f"the QE of {qe:.4g} is above 1, which is not possible, but by less than "
            f"{_IMPOSSIBLE_Z:g} standard errors ({qe_se:.2g} each)"
        )
    return qe, qe_se


def _slope_through_origin(x: Array, y: Array) -> tuple[float, float]:
    """Slope of y = a x by unweighted least squares; its error from the scatter about the line."""
    slope = float(x @ y) / float(x @ x)
    scatter = (x * (y - slope * x)) ** 2
    return slope, float(np.sqrt(scatter.sum() * x.size / max(x.size - 1, 1))) / float(x @ x)
