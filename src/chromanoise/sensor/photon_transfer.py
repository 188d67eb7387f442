"""Photon transfer: gain, read noise, PRNU and full well from the variance over the mean.

Of codes above black, x, the variance is sigma^2 + K x + (PRNU x)^2: readout, shot noise, pattern.
The last term is there where the variance is taken over the pixels of one picture; that of the
difference of two pictures has none.

EMVA Standard 1288, Release 4.0 Linear (2021), chapters 2 and 6; Janesick, Photon Transfer (SPIE,
2007).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from chromanoise import _check
from chromanoise._check import Array, InputError
from chromanoise._linalg import inv, lstsq
from chromanoise.sensor.adc import Adc
from chromanoise.sensor.imperfections import Imperfections
from chromanoise.sensor.noise_profile import ROUNDING_DN2
from chromanoise.sensor.pixel_source import PixelSource

_FIT_SHARE = 0.7  # of saturation: where EMVA 1288 ends its fit of the gain
_FALLEN = 0.5  # of the largest variance: below, the codes are held
_TOLD_Z = 5.0  # a row that lies further off is named
_SCATTERED = 4.0  # of squared residuals per degree of freedom: twice the scatter expected
_CURVED_Z = 3.0  # a curvature beyond is taken for real
_MOST_SAMPLES = 1e12
_ROUNDS = 20  # of weights; they settle in about five


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PhotonTransfer:
    """Mean and variance of codes at several lights.

    Attributes
    ----------
    mean_dn
        Mean code, black level included. [DN]
    variance_dn2
        Its variance: of one picture over its pixels, or half that of a difference of two. [DN^2]
    dark
        Which rows were taken without light.
    samples
        Pixels behind each variance; ``None`` where not known. [1]
    source
        Where the numbers come from.

    Raises
    ------
    InputError
        If values are not finite, a variance is not above 0, or there are fewer than 3 rows.
    """

    mean_dn: Float[Array, " m"]
    variance_dn2: Float[Array, " m"]
    dark: Bool[Array, " m"]
    samples: Float[Array, " m"] | None = None
    source: str = "photon transfer"

    def __post_init__(self) -> None:
        mean = _check.finite(f"mean_dn of {self.source}", "DN", self.mean_dn)
        variance = _check.non_negative(f"variance_dn2 of {self.source}", "DN^2", self.variance_dn2)
        _check.same_length("rows", mean=mean.size, variance=variance.size, dark=self.dark.size)
        if self.samples is not None:
            _check.same_length("rows", mean=mean.size, samples=self.samples.size)
            if not ((self.samples >= 2) & (self.samples <= _MOST_SAMPLES)).all():
                raise InputError(
                    f"{self.source}: a variance needs at least 2 samples in every row, and at most "
                    f"{_MOST_SAMPLES:g}"
                )
            _check.freeze(self, "samples")
        _check.within(f"largest |mean_dn| of {self.source}", "DN", _largest(mean), 0, 1e9)
        _check.within(f"largest variance_dn2 of {self.source}", "DN^2", _largest(variance), 0, 1e18)
        if np.unique(mean.round(9)).size < 3:
            raise InputError(
                f"{self.source}: a photon transfer needs at least 3 rows of different mean, "
                f"but has {np.unique(mean.round(9)).size}"
            )
        object.__setattr__(self, "mean_dn", _check.frozen(mean))
        object.__setattr__(self, "variance_dn2", _check.frozen(variance))
        _check.freeze(self, "dark")


def _largest(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TransferFit:
    """What a photon transfer tells, with standard errors; ``None`` where it does not tell.

    Attributes
    ----------
    source
        Of the table.
    gain_dn_per_e, gain_se
        The gain K. [DN/e-]
    read_noise_e, read_noise_se
        Without rounding to codes. [e-]
    prnu, prnu_se
        ``None`` where the variance does not bend up. [1]
    black_dn
        Code of no light, where a dark row or the caller told it. [DN]
    saturation_dn, full_well_e
        Mean code of the largest variance, where it falls behind, and its electrons. [DN], [e-]
    fitted
        Which rows were fitted.
    residual_z
        Variance minus fit over its standard error, per row.
    chi2_per_row
        Squared residuals per degree of freedom: about 1 where the samples are known. [1]
    notes
        What was found odd.
    """

    source: str
    gain_dn_per_e: float
    gain_se: float
    read_noise_e: float | None
    read_noise_se: float | None
    prnu: float | None
    prnu_se: float | None
    black_dn: float | None
    saturation_dn: float | None
    full_well_e: float | None
    fitted: Bool[Array, " m"]
    residual_z: Float[Array, " m"]
    chi2_per_row: float
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        _check.freeze(self, "fitted", "residual_z")


def photon_transfer_fit(table: PhotonTransfer, *, black_dn: float | None = None) -> TransferFit:
    """Gain, read noise, PRNU and full well, by weighted least squares.

    Parameters
    ----------
    table
        Mean and variance at several lights.
    black_dn
        Code of no light, where no dark row tells it; without, the read noise stays unknown. [DN]

    Raises
    ------
    InputError
        If fewer than 3 rows lie below 70 % of saturation, or the variance does not grow.

    Notes
    -----
    A variance v of n samples has the standard error v sqrt(2 / (n - 1)); that the mean is measured
    too adds K^2 sigma^2 / n once the fourth cumulant of Poisson's law is counted. Weights come from
    the fit itself, for those from noisy variances would pull it down. Without the number of samples
    the scatter about the fit gives the scale. Rows above 70 % of saturation are left out (EMVA
    1288). The bend is kept where it is over three standard errors.

    Examples
    --------
    >>> x = np.array([0.0, 100.0, 200.0, 400.0])
    >>> fit = photon_transfer_fit(PhotonTransfer(
    ...     mean_dn=64 + x, variance_dn2=4 + 1 / 12 + 0.5 * x, dark=x == 0, samples=0 * x + 1e4))
    >>> round(fit.gain_dn_per_e, 6), round(fit.read_noise_e, 6)
    (0.5, 4.0)
    """
    black = _black(table, black_dn)
    saturation = _saturation_dn(table)
    base = black if black is not None else float(table.mean_dn.min())
    x = table.mean_dn - base
    fitted = np.ones(x.size, dtype=bool)
    if saturation is not None:
        fitted = np.asarray(x <= _FIT_SHARE * (saturation - base))
    if np.unique(x[fitted]).size < 3:
        raise InputError(
            f"{table.source}: only {np.unique(x[fitted]).size} rows lie below 70 % of saturation "
            f"({saturation:g} DN); a fit needs 3, so measure with less light"
        )
    line = _curve(x, table, fitted, terms=2, dark_known=black is not None)
    curve = line
    if np.unique(x[fitted]).size > 3:
        bent = _curve(x, table, fitted, terms=3, dark_known=black is not None)
        bend = abs(bent.values[2])
        by_rounding = 1e-6 * abs(bent.values[1]) / x[fitted].max()
        if bend > max(_CURVED_Z * bent.errors[2], by_rounding):
            curve = bent
    return _fit(table, curve, x=x, fitted=fitted, black=black, saturation=saturation)


def pixel_from_photon_transfer(fit: TransferFit, *, bits: int | None = None) -> PixelSource:
    """The pixel that a photon transfer tells of.

    Parameters
    ----------
    fit
        `photon_transfer_fit`.
    bits
        Of the converter, where they are known.

    Raises
    ------
    InputError
        If bits and black level are those of no converter.
    """
    gain = 1 / fit.gain_dn_per_e
    notes = [
        f"{fit.source}: K = {fit.gain_dn_per_e:.4g} +- {fit.gain_se:.2g} DN/e-",
        *fit.notes,
    ]
    if fit.read_noise_e is not None and fit.read_noise_se is not None:
        notes.append(
            f"{fit.source}: read noise {fit.read_noise_e:.4g} +- {fit.read_noise_se:.2g} e-"
        )
    adc = None
    if bits is not None and fit.black_dn is not None:
        black = round(fit.black_dn)
        adc = Adc(bits=bits, gain_e_per_dn=gain, black_level_dn=black)
        if black != fit.black_dn:
            notes.append(f"{fit.source}: black level of {fit.black_dn:.6g} DN rounded to {black}")
    return PixelSource(
        source=fit.source,
        full_well_e=fit.full_well_e,
        read_noise_e=fit.read_noise_e,
        gain_e_per_dn=gain,
        adc=adc,
        imperfections=Imperfections(prnu=fit.prnu or 0.0),
        notes=tuple(notes),
    )


def _black(table: PhotonTransfer, given: float | None) -> float | None:
    rows = table.mean_dn[table.dark]
    if given is None:
        return float(rows.mean()) if rows.size else None
    if rows.size:
        raise InputError(
            f"{table.source}: the dark rows tell a black level of {rows.mean():g} DN, but "
            f"{given:g} is given too; leave it out"
        )
    black = _check.not_negative("black_dn", "DN", given)
    if black > float(table.mean_dn.min()):
        raise InputError(
            f"{table.source}: black_dn is {black:g}, above the lowest mean of "
            f"{table.mean_dn.min():g} DN; give the code of no light"
        )
    return black


def _saturation_dn(table: PhotonTransfer) -> float | None:
    """Mean of the largest variance, if brighter rows fall to less than half of it."""
    top = int(np.argmax(table.variance_dn2))
    peak = float(table.variance_dn2[top])
    brighter = table.variance_dn2[table.mean_dn > table.mean_dn[top]]
    if brighter.size and float(brighter.min()) < _FALLEN * peak:
        return float(table.mean_dn[top])
    return None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Polynomial:
    """Coefficients of 1, x, x^2 with their covariance, and all rows' residuals over their error."""

    values: Array
    covariance: Array
    residual_z: Array
    chi2_per_row: float

    @property
    def errors(self) -> Array:
        return np.sqrt(np.diag(self.covariance))


def _curve(
    x: Array, table: PhotonTransfer, fitted: Array, *, terms: int, dark_known: bool
) -> _Polynomial:
    scale, what = float(x[fitted].max()), f"photon transfer of {table.source}"
    powers = (x[:, None] / scale) ** np.arange(terms)
    samples = table.samples if table.samples is not None else np.full(x.size, np.inf)
    known = table.samples is not None
    n = samples if known else np.full(x.size, 1e4)
    variance = table.variance_dn2
    expected = np.maximum(variance, 1e-9 * max(float(variance.max()), 1e-12))
    values = np.zeros(terms)
    error2 = np.ones(x.size)
    for _ in range(_ROUNDS):
        slope, dark = values[1] / scale, max(values[0], 0.0) if dark_known else 0.0
        error2 = 2 * expected**2 / (n - 1) + slope**2 * dark / n
        root = 1 / np.sqrt(error2[fitted])
        values = lstsq(what, powers[fitted] * root[:, None], variance[fitted] * root)[0]
        expected = np.maximum(powers @ values, 1e-3 * expected)
    z = (variance - powers @ values) / np.sqrt(error2)
    free = int(fitted.sum()) - terms
    chi2 = float((z[fitted] ** 2).sum()) / free
    spread = 1.0 if known else chi2
    normal = powers[fitted].T @ (powers[fitted] / error2[fitted, None])
    unscale = scale ** -np.arange(terms, dtype=float)
    covariance = spread * inv(what, normal) * np.outer(unscale, unscale)
    if not known:
        z = z / np.sqrt(spread) if spread > 0 else 0 * z
        chi2 = 1.0
    return _Polynomial(
        values=values * unscale, covariance=covariance, residual_z=z, chi2_per_row=chi2
    )


def _fit(
    table: PhotonTransfer,
    curve: _Polynomial,
    *,
    x: Array,
    fitted: Array,
    black: float | None,
    saturation: float | None,
) -> TransferFit:
    gain, gain_se = float(curve.values[1]), float(curve.errors[1])
    if not gain > 0:
        raise InputError(
            f"{table.source}: the variance does not grow with the mean (slope {gain:g} DN); are "
            "the columns mean and variance, and was the light changed?"
        )
    notes: list[str] = []
    read, read_se = _read_noise(curve, table.source, notes, black_known=black is not None)
    prnu, prnu_se = _prnu(curve, table.source, notes)
    if saturation is None:
        notes.append(f"{table.source}: the variance never falls, so the full well is unknown")
    well = None if saturation is None or black is None else (saturation - black) / gain
    notes += _oddities(table, curve, fitted)
    return TransferFit(
        source=table.source,
        gain_dn_per_e=gain,
        gain_se=gain_se,
        read_noise_e=read,
        read_noise_se=read_se,
        prnu=prnu,
        prnu_se=prnu_se,
        black_dn=black,
        saturation_dn=saturation,
        full_well_e=well,
        fitted=fitted,
        residual_z=curve.residual_z,
        chi2_per_row=curve.chi2_per_row,
        notes=tuple(notes),
    )


def _oddities(table: PhotonTransfer, curve: _Polynomial, fitted: Array) -> list[str]:
    """Rows far off the fit, and scatter beyond what so many samples have."""
    odd = np.flatnonzero(fitted & (np.abs(curve.residual_z) > _TOLD_Z))
    notes = [
        f"{table.source}: the row of mean {table.mean_dn[i]:g} DN lies "
        f"{curve.residual_z[i]:+.1f} standard errors off the fit"
        for i in odd[:5]
    ]
    if curve.chi2_per_row > _SCATTERED:
        notes.append(
            f"{table.source}: rows scatter {np.sqrt(curve.chi2_per_row):.2g} times as far as their "
            "samples let expect, so standard errors are too small; did light or gain change?"
        )
    return notes


def _read_noise(
    curve: _Polynomial, source: str, notes: list[str], *, black_known: bool
) -> tuple[float | None, float | None]:
    """Square root of the dark variance less rounding, over the gain; error by the delta method."""
    if not black_known:
        notes.append(
            f"{source}: no dark row and no black level, so the read noise is unknown and K is the "
            "slope at the lowest mean"
        )
        return None, None
    dark, gain = float(curve.values[0]) - ROUNDING_DN2, float(curve.values[1])
    if dark <= 0:
        notes.append(
            f"{source}: the variance at black is {curve.values[0]:.3g} DN^2, not more than "
            f"rounding makes ({ROUNDING_DN2:.3g}), so the read noise is not resolved"
        )
        return None, None
    slope = np.array([1 / (2 * dark), -1 / gain])
    read = np.sqrt(dark) / gain
    return float(read), float(read * np.sqrt(slope @ curve.covariance[:2, :2] @ slope))


def _prnu(curve: _Polynomial, source: str, notes: list[str]) -> tuple[float | None, float | None]:
    if curve.values.size < 3:
        return None, None
    bend, error = float(curve.values[2]), float(curve.errors[2])
    if bend < 0:
        notes.append(
            f"{source}: the variance bends down ({bend:.3g} +- {error:.2g} per DN); codes are "
            "held, or the response is not linear, and the gain holds for little light only"
        )
        return None, None
    return float(np.sqrt(bend)), error / (2 * float(np.sqrt(bend)))
