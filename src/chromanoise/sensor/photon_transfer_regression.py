"""The data, the least-squares fits and the results of photon transfer, with their errors.

A level is measured above its dark. The sampling errors of each level and of each dark measurement
are propagated through the fit, so that levels with the same dark measurement have correlated
errors.
"""

from dataclasses import replace

import numpy as np

from chromanoise.base import Array, Bool, Float, InputError, check, dataclass, matrix_rank, pinv
from chromanoise.sensor.camera_noise import ROUNDING_DN2

_MOST_SAMPLES = 1e12
LEAST_DARK_DN2 = 0.24
"""EMVA 1288: a lower dark variance is mostly quantization. [DN^2]"""

SAME_TIME = 0.01
"""Share of an exposure time within which a dark has the time of a flat."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PhotonTransfer:
    """Mean and variance of codes at several light levels.

    Attributes
    ----------
    mean_dn
        Mean code, black level included. [DN]
    variance_dn2
        Its variance: temporal (half the variance of the difference of two pictures) or spatial.
        [DN^2]
    dark
        Which rows were taken without light.
    samples
        Number of pixels of each variance; ``None`` if not known. [1]
    source
        Where the numbers come from.
    spatial
        Whether the variances are over the pixels of one picture, so that they contain PRNU.
    time_ms
        Exposure time of each row: a lit row is then evaluated with the dark rows of its time,
        within 1 %. [ms]
    dark_mean_dn, dark_variance_dn2
        Dark mean and variance of each row, instead of dark rows. [DN], [DN^2]
    photons
        Mean number of photons on a pixel, for each row. [1]
    mean_se_dn
        Standard error of the mean of each row; ``None`` to compute it from variance and samples.
        Row noise makes it larger. [DN]
    notes
        Remarks for readers of the result.

    Raises
    ------
    InputError
        If values are not finite, a variance is negative, there are fewer than 3 rows of different
        mean, or no dark row has the exposure time of a lit row.
    """

    mean_dn: Float[Array, " m"]
    variance_dn2: Float[Array, " m"]
    dark: Bool[Array, " m"]
    samples: Float[Array, " m"] | None = None
    source: str = "photon transfer"
    spatial: bool = False
    time_ms: Float[Array, " m"] | None = None
    dark_mean_dn: Float[Array, " m"] | None = None
    dark_variance_dn2: Float[Array, " m"] | None = None
    photons: Float[Array, " m"] | None = None
    mean_se_dn: Float[Array, " m"] | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name, unit, most in _COLUMNS:
            values = getattr(self, name)
            if values is None:
                continue
            signed = name in ("mean_dn", "dark_mean_dn")
            demand = check.finite if signed else check.non_negative
            values = demand(f"{name} of {self.source}", unit, values)
            check.same_length("rows", dark=self.dark.size, **{name: values.size})
            what = f"|{name}|" if signed else name
            check.within(f"largest {what} of {self.source}", unit, _largest(values), 0, most)
            check.keep(self, **{name: values})
        if self.samples is not None:
            check.same_length("rows", mean_dn=self.mean_dn.size, samples=self.samples.size)
            bad = ~((self.samples >= 2) & (self.samples <= _MOST_SAMPLES))
            if bad.any():
                raise InputError(
                    self.source,
                    f"must be 2 to {_MOST_SAMPLES:g} in every row",
                    value=float(self.samples[bad][0]),
                    where="column 'samples'",
                )
            check.freeze(self, "samples")
        count = len(set(self.mean_dn.round(9).tolist()))
        if count < 3:
            raise InputError(
                self.source,
                "must have at least 3 rows of different mean",
                value=count,
                found=f"has {count}",
            )
        check.freeze(self, "dark")
        _refuse_odd_darks(self)


_COLUMNS = (
    ("mean_dn", "DN", 1e9),
    ("variance_dn2", "DN^2", 1e18),
    ("dark_mean_dn", "DN", 1e9),
    ("dark_variance_dn2", "DN^2", 1e18),
    ("time_ms", "ms", 1e12),
    ("photons", "1", 1e15),
    ("mean_se_dn", "DN", 1e9),
)


def nearest(times: Array, at: Array) -> Array:
    """Which of the ascending times lies nearest to each of others."""
    return np.searchsorted((times[1:] + times[:-1]) / 2, at)


def _largest(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))


def _refuse_odd_darks(table: PhotonTransfer) -> None:
    """Refuse dark values that are given twice, incompletely, or not for every exposure time."""
    if table.dark.all():
        raise InputError(
            table.source, "must have rows with light for a gain", found="all rows are dark"
        )
    columns = table.dark_mean_dn is not None, table.dark_variance_dn2 is not None
    if columns[0] != columns[1]:
        missing = "dark_mean_dn" if columns[1] else "dark_variance_dn2"
        raise InputError(
            table.source,
            "must have both columns, dark_mean_dn and dark_variance_dn2",
            found=f"has no {missing}",
        )
    if columns[0] and table.dark.any():
        raise InputError(
            table.source,
            "must have either dark rows or the columns dark_mean_dn and dark_variance_dn2",
            found="has both",
            remedy="keep one of the two",
        )
    if table.time_ms is None or not table.dark.any():
        return
    times = np.sort(table.time_ms[table.dark])
    off = np.abs(times[nearest(times, table.time_ms)] - table.time_ms)
    alone = off > SAME_TIME * table.time_ms
    if alone.any():
        time_ms = float(table.time_ms[alone][0])
        raise InputError(
            table.source,
            "must have a dark row for the time of each lit row",
            value=time_ms,
            found=f"has none of {time_ms:g} ms, the time of the lit row of mean "
            f"{table.mean_dn[alone][0]:g} DN",
            where="column 'time_ms'",
            remedy=("measure one", "omit the column if the dark does not depend on the time"),
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class TransferFit:
    """Results of a photon transfer with standard errors; ``None`` where the table has none.

    Attributes
    ----------
    gain_dn_per_e, gain_se
        The gain K. If the bend is significant, the error includes in quadrature the difference
        between K and the slope at low light. [DN/e-]
    low_light_gain_dn_per_e, low_light_gain_se
        Slope of the variance in the dark, from a fit with a quadratic term. [DN/e-]
    high_light_gain_dn_per_e, high_light_gain_se
        The same at 70 % of saturation, or at the brightest row if saturation is unknown. [DN/e-]
    bend_z
        Quadratic term divided by its standard error; the bend is significant above 3.
    read_noise_e, read_noise_se
        Without quantization; an upper limit, without error, if quantization dominates. [e-]
    dark_current_e_per_s, dark_current_se
        From dark means at three or more exposure times. [e-/s]
    prnu, prnu_se
        From spatial variances; ``None`` if they do not bend upward. [1]
    qe, qe_se
        Electrons per photon, if the table has photons. [e-/photon]
    black_dn
        Code without light at exposure time 0, from dark rows or the caller. [DN]
    saturation_dn, full_well_e
        Mean code at the largest variance, if the variance falls above it, and its electrons.
        [DN], [e-]
    saturation_capacity_e
        mu_e.sat of EMVA 1288: QE times the photons of the row with the largest variance, above
        which codes are clipped; without photons, ``full_well_e``. [e-]
    fitted
        Which rows the line was fitted to; dark rows define its origin.
    residual_z
        Variance minus fit, divided by its standard error, per row; 0 for dark rows.
    chi2_per_row
        Squared residuals per degree of freedom: about 1 where the samples are known. [1]
    notes
        Remarks on anomalies in the table.
    """

    source: str
    gain_dn_per_e: float
    gain_se: float
    low_light_gain_dn_per_e: float | None
    low_light_gain_se: float | None
    high_light_gain_dn_per_e: float | None
    high_light_gain_se: float | None
    bend_z: float | None
    read_noise_e: float | None
    read_noise_se: float | None
    dark_current_e_per_s: float | None
    dark_current_se: float | None
    prnu: float | None
    prnu_se: float | None
    qe: float | None
    qe_se: float | None
    black_dn: float | None
    saturation_dn: float | None
    full_well_e: float | None
    saturation_capacity_e: float | None
    fitted: Bool[Array, " m"]
    residual_z: Float[Array, " m"]
    chi2_per_row: float
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        check.freeze(self, "fitted", "residual_z")


_ROUNDS = 20  # iterations of the weights, which converge in about five
_LEAST_SHARE = 1e-9  # smallest variance, relative to the largest: keeps weights finite
_LARGEST_SLOPE = 1e15  # [DN] larger than of any converter: then the means do not differ
_UNKNOWN_SAMPLES = 1e4  # used for an unknown number; the scatter about the fit sets the scale


@dataclass(frozen=True, kw_only=True, eq=False)
class Darks:
    """The dark measurements of a table.

    Attributes
    ----------
    mean_dn, variance_dn2
        Of each dark measurement. [DN], [DN^2]
    samples
        Number of pixels of each; ``None`` if not known. [1]
    time_ms
        Exposure time of each; ``None`` if not known. [ms]
    mean_se_dn
        Standard error of each mean; ``None`` to compute it from variance and samples. [DN]
    """

    mean_dn: Array
    variance_dn2: Array
    samples: Array | None
    time_ms: Array | None
    mean_se_dn: Array | None = None

    def at_no_time(self) -> tuple[Array, Array | None]:
        """Weights that give the dark value at exposure time 0, and weights of its slope per ms.

        From a straight line over at least three times (EMVA 1288, section 6.6); otherwise the dark
        measurement of the shortest time, or the first one, and no slope.
        """
        n = self.mean_dn.size
        if self.time_ms is None or len({*self.time_ms.tolist()}) < 3:
            return self.at_shortest_time(), None
        intercept, slope = pinv(
            "the dark rows of a photon transfer", np.stack([np.ones(n), self.time_ms], axis=1)
        )
        return intercept, slope

    def at_shortest_time(self) -> Array:
        """Weights that give the dark of the shortest time, or the first one."""
        first = 0 if self.time_ms is None else int(np.argmin(self.time_ms))
        return np.eye(self.mean_dn.size)[first]


@dataclass(frozen=True, kw_only=True, eq=False)
class Levels:
    """The lit rows of a table, above their dark.

    Attributes
    ----------
    x, y
        Mean and variance above the dark; without dark measurements, the mean above the black
        level and the variance itself. [DN], [DN^2]
    samples
        Number of pixels of each; ``None`` if not known. [1]
    frames
        2 for the difference of two pictures (temporal), 1 for one picture (spatial).
    darks
        ``None`` if the table has none; the line then has an intercept.
    dark_of
        Index of the dark measurement of each level.
    black_known
        Whether ``x`` is above a known black level.
    """

    x: Array
    y: Array
    samples: Array | None
    frames: int
    darks: Darks | None
    dark_of: Array
    black_known: bool

    def __len__(self) -> int:
        return self.x.size

    def of(self, rows: Array) -> "Levels":
        """The selected levels."""
        return replace(
            self,
            x=self.x[rows],
            y=self.y[rows],
            samples=None if self.samples is None else self.samples[rows],
            dark_of=self.dark_of[rows],
        )

    def powers(self, bend: bool) -> Array:
        """Columns of the model: an intercept if no dark is known, x, and x^2 for a bend."""
        first = 1 if self.darks is not None else 0
        return self.x[:, None] ** np.arange(first, 3 if bend else 2)

    @property
    def slope_at(self) -> int:
        """Index of the coefficient that is the slope."""
        return 0 if self.darks is not None else 1


def levels_of(table: PhotonTransfer, black_dn: float | None) -> Levels:
    """The lit rows, each above its own dark."""
    found, lit = _darks(table), ~table.dark
    base: float | Array
    floor: float | Array
    if found is None:
        lowest = float(table.mean_dn.min())
        base = lowest if black_dn is None else check.not_negative("black_dn", "DN", black_dn)
        if base > lowest:
            raise InputError(
                "black_dn",
                f"must be at most {lowest:g} DN, the lowest mean of {table.source}",
                value=base,
                remedy="give the code without light",
            )
        darks, dark_of, floor = None, np.zeros(table.dark.size, dtype=int), 0.0
    else:
        darks, dark_of = found
        base, floor = darks.mean_dn[dark_of], darks.variance_dn2[dark_of]
        if black_dn is not None:
            raise InputError(
                "black_dn",
                f"must be omitted where {table.source} has dark rows",
                value=black_dn,
                found=f"{black_dn:g} is given besides the {darks.mean_dn[0]:g} DN of those rows",
                remedy="omit it",
            )
    return Levels(
        x=table.mean_dn[lit] - base,
        y=table.variance_dn2[lit] - floor,
        samples=None if table.samples is None else table.samples[lit],
        frames=1 if table.spatial else 2,
        darks=darks,
        dark_of=dark_of,
        black_known=darks is not None or black_dn is not None,
    )


def _darks(table: PhotonTransfer) -> tuple[Darks, Array] | None:
    """The dark measurements, and the index of that of each lit row; `None` if there are none.

    Dark rows of one exposure time are averaged; without exposure times, all are. A pair of values
    that repeats in the columns of darks counts as one measurement.
    """
    lit, samples, time = ~table.dark, table.samples, table.time_ms
    if table.dark_mean_dn is not None and table.dark_variance_dn2 is not None:
        no_time = np.zeros(lit.size) if time is None else time
        keys = np.stack([table.dark_mean_dn, table.dark_variance_dn2, no_time], axis=1)
        _, first, dark_of = np.unique(keys, axis=0, return_index=True, return_inverse=True)
        return Darks(
            mean_dn=table.dark_mean_dn[first],
            variance_dn2=table.dark_variance_dn2[first],
            samples=None if samples is None else samples[first],
            time_ms=None if time is None else time[first],
        ), dark_of.reshape(-1)
    if not table.dark.any():
        return None
    at = np.zeros(lit.size) if time is None else time
    times, dark_at = np.unique(at[table.dark], return_inverse=True)
    count = np.bincount(dark_at)
    mean, variance = (
        np.bincount(dark_at, weights=of[table.dark]) / count
        for of in (table.mean_dn, table.variance_dn2)
    )
    return Darks(
        mean_dn=mean,
        variance_dn2=variance,
        samples=None if samples is None else np.bincount(dark_at, weights=samples[table.dark]),
        time_ms=None if time is None else times,
        mean_se_dn=None
        if table.mean_se_dn is None
        else np.sqrt(np.bincount(dark_at, weights=table.mean_se_dn[table.dark] ** 2)) / count,
    ), nearest(times, at[lit])


@dataclass(frozen=True, kw_only=True, eq=False)
class Regression:
    """A fit that is linear in the measured values.

    Attributes
    ----------
    values, covariance
        Coefficients, and their covariance from sampling.
    dark_lever
        Minus the derivative of each coefficient with respect to the variance of each dark.
    error2
        Squared error of each level's variance. [DN^4]
    spread
        Factor of all squared errors: 1 where the samples are known, else from the scatter.
    chi2_per_row
        Squared residuals per degree of freedom, before ``spread``.
    """

    values: Array
    covariance: Array
    dark_lever: Array
    error2: Array
    spread: float
    chi2_per_row: float

    @property
    def errors(self) -> Array:
        """Standard errors of the coefficients."""
        return np.sqrt(np.diag(self.covariance))

    def combined(self, weights: Array) -> tuple[float, float]:
        """A weighted sum of the coefficients and its standard error."""
        return float(weights @ self.values), float(np.sqrt(weights @ self.covariance @ weights))


def weighted_fit(levels: Levels, *, bend: bool) -> Regression | None:
    """Weighted least squares; ``None`` where the levels do not determine the coefficients.

    The weights come from the fit itself: weights from noisy variances would bias it downward.
    """
    dark, design = _dark_variance(levels), levels.powers(bend)
    least = _LEAST_SHARE * max(float((levels.y + dark).max()), 1.0)
    expected = np.maximum(levels.y + dark, least)
    values = np.zeros(design.shape[1])
    lever: Array = np.empty(0)
    for _ in range(_ROUNDS):
        found = _lever(design, 1 / np.sqrt(_level_error2(levels, expected, values)))
        if found is None or not abs(float(found[levels.slope_at] @ levels.y)) < _LARGEST_SLOPE:
            return None
        before, lever, values = values, found, found @ levels.y
        if np.array_equal(values, before):
            break
        expected = np.maximum(design @ values + dark, least)
    error2 = _level_error2(levels, expected, values)
    free = len(levels) - values.size
    slope = float(values[levels.slope_at])
    dark_error2 = _dark_error2(levels, slope) + _dark_rounding_error2(levels)
    z2 = (levels.y - design @ values) ** 2 / (error2 + dark_error2[levels.dark_of])
    chi2 = float(z2.sum()) / free if free else 1.0
    spread = 1.0 if levels.samples is not None else chi2
    return _regression(levels, lever, error2, slope, spread=spread, chi2=chi2)


def straight_fit(levels: Levels, judged: Regression) -> Regression | None:
    """The line through the origin of EMVA 1288, by unweighted least squares.

    Parameters
    ----------
    levels
        The lit rows above their dark values.
    judged
        Another fit, from which the errors of the levels are taken.
    """
    lever = _lever(levels.powers(bend=False), np.ones(len(levels)))
    if lever is None:
        return None
    slope = float(lever[0] @ levels.y)
    return _regression(
        levels, lever, judged.error2, slope, spread=judged.spread, chi2=judged.chi2_per_row
    )


def residuals_z(levels: Levels, fit: Regression) -> Array:
    """Variance minus fit, divided by its standard error, for all levels, fitted or not."""
    model = levels.powers(bend=fit.values.size > levels.slope_at + 1) @ fit.values
    dark, slope = _dark_variance(levels), float(fit.values[levels.slope_at])
    expected = np.maximum(model + dark, 1e-3 * (levels.y + dark))
    error2 = _level_error2(levels, expected, fit.values)
    dark_error2 = _dark_error2(levels, slope) + _dark_rounding_error2(levels)
    error2 = fit.spread * (error2 + dark_error2[levels.dark_of])
    return np.divide(levels.y - model, np.sqrt(error2), out=np.zeros(len(levels)), where=error2 > 0)


def variance_error2(variance: Array, samples: Array | None) -> Array:
    """Squared sampling error of a variance of Gaussian values. [DN^4]"""
    n = np.full(variance.shape, _UNKNOWN_SAMPLES) if samples is None else samples
    return np.asarray(2 * variance**2 / (n - 1))


def rounding_error2(variance_dn2: Array) -> Array:
    """Squared error of the variance of rounded codes beyond 1/12, whatever the mean is. [DN^4]

    Of a normal value of standard deviation s codes, the term (4 s^2 + 1/pi^2) exp(-2 pi^2 s^2)
    times the cosine of the mean: Widrow & Kollar, Quantization Noise (2008), chapter 4.
    """
    return 0.5 * _rounding_dn2(variance_dn2) ** 2


def _rounding_dn2(variance_dn2: Array) -> Array:
    fading = np.exp(-2 * np.pi**2 * variance_dn2)
    return np.asarray((4 * variance_dn2 + 1 / np.pi**2) * fading)


def _measured_rounding_error2(measured_dn2: Array) -> Array:
    """`rounding_error2` of a measured variance, for the smallest true one that may give it."""
    least = measured = np.maximum(measured_dn2 - ROUNDING_DN2, 0.0)
    for _ in range(_ROUNDS):
        before, least = least, np.maximum(measured - _rounding_dn2(least), 0.0)
        if np.array_equal(least, before):
            break
    return rounding_error2(least)


def mean_error2(variance: Array, samples: Array | None, frames: int) -> Array:
    """Squared sampling error of a mean over ``frames`` pictures. [DN^2]"""
    n = np.full(variance.shape, _UNKNOWN_SAMPLES) if samples is None else samples
    return np.asarray(variance / (frames * n))


def dark_mean_error2(darks: Darks, frames: int) -> Array:
    """Squared error of each dark mean, as measured or from sampling. [DN^2]"""
    if darks.mean_se_dn is not None:
        return np.asarray(darks.mean_se_dn**2)
    return mean_error2(darks.variance_dn2, darks.samples, frames)


def _dark_variance(levels: Levels) -> Array:
    """Dark variance of each level, 0 if not known."""
    if levels.darks is None:
        return np.zeros(len(levels))
    return np.asarray(levels.darks.variance_dn2[levels.dark_of])


def _level_error2(levels: Levels, expected: Array, values: Array) -> Array:
    """Squared error of variance - slope mean; the fourth cumulant of Poisson cancels in it."""
    dark = _dark_variance(levels)
    if levels.darks is None and levels.black_known:
        dark = np.full(len(levels), max(float(values[0]), 0.0))
    own = mean_error2(dark, levels.samples, levels.frames)
    sampling = variance_error2(expected, levels.samples)
    rounding = _measured_rounding_error2(expected)
    return sampling + rounding + values[levels.slope_at] ** 2 * own


def _dark_error2(levels: Levels, slope: float) -> Array:
    if levels.darks is None:
        return np.zeros(1)
    variance, n = levels.darks.variance_dn2, levels.darks.samples
    return variance_error2(variance, n) + slope**2 * dark_mean_error2(levels.darks, levels.frames)


def _dark_rounding_error2(levels: Levels) -> Array:
    """Squared error of the dark variances by rounding: one for all, which have the same mean."""
    if levels.darks is None:
        return np.zeros(1)
    lowest = levels.darks.variance_dn2.min(keepdims=True)
    return np.repeat(_measured_rounding_error2(lowest), levels.darks.variance_dn2.size)


def _lever(design: Array, root_weights: Array) -> Array | None:
    """The matrix from values to coefficients; ``None`` if these are not determined."""
    scale = np.abs(design).max(axis=0)
    if not (scale > 0).all():
        return None
    weighted = design / scale * (root_weights / root_weights.max())[:, None]
    if matrix_rank("a fit of a photon transfer", weighted) < design.shape[1]:
        return None
    return np.asarray(
        pinv("a fit of a photon transfer", weighted)
        * (root_weights / root_weights.max())
        / scale[:, None]
    )


def _regression(
    levels: Levels, lever: Array, error2: Array, slope: float, *, spread: float, chi2: float
) -> Regression:
    dark_error2 = _dark_error2(levels, slope)
    dark_lever = np.stack(
        [np.bincount(levels.dark_of, weights=row, minlength=dark_error2.size) for row in lever]
    )
    covariance = (lever * error2) @ lever.T + (dark_lever * dark_error2) @ dark_lever.T
    common = dark_lever.sum(axis=1)
    covariance += _dark_rounding_error2(levels)[0] * np.outer(common, common)
    return Regression(
        values=lever @ levels.y,
        covariance=spread * covariance,
        dark_lever=dark_lever,
        error2=error2,
        spread=spread,
        chi2_per_row=chi2,
    )
