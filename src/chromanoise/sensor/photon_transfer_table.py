"""The table of a photon transfer, and the results of its fit."""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.errors import InputError

_MOST_SAMPLES = 1e12
LEAST_DARK_DN2 = 0.24
"""EMVA 1288: a lower dark variance is mostly quantization. [DN^2]"""

SAME_TIME = 0.01
"""Share of an exposure time within which a dark has the time of a flat."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
            demand = _check.finite if signed else _check.non_negative
            values = demand(f"{name} of {self.source}", unit, values)
            _check.same_length("rows", dark=self.dark.size, **{name: values.size})
            what = f"|{name}|" if signed else name
            _check.within(f"largest {what} of {self.source}", unit, _largest(values), 0, most)
            object.__setattr__(self, name, _check.frozen(values))
        if self.samples is not None:
            _check.same_length("rows", mean_dn=self.mean_dn.size, samples=self.samples.size)
            bad = ~((self.samples >= 2) & (self.samples <= _MOST_SAMPLES))
            if bad.any():
                raise InputError(
                    self.source,
                    f"must be 2 to {_MOST_SAMPLES:g} in every row",
                    value=float(self.samples[bad][0]),
                    where="column 'samples'",
                )
            _check.freeze(self, "samples")
        count = len(set(self.mean_dn.round(9).tolist()))
        if count < 3:
            raise InputError(
                self.source,
                "must have at least 3 rows of different mean",
                value=count,
                found=f"has {count}",
            )
        _check.freeze(self, "dark")
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
    times = np.unique(table.time_ms[table.dark])
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TransferFit:
    """Results of a photon transfer with standard errors; ``None`` where the table has none.

    Attributes
    ----------
    source
        Of the table.
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
        _check.freeze(self, "fitted", "residual_z")
