"""The lit rows of a photon transfer, above their dark values."""

from dataclasses import dataclass, replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._linalg import pinv
from chromanoise.errors import InputError
from chromanoise.sensor.photon_transfer_table import PhotonTransfer, nearest


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
        if self.time_ms is None or np.unique(self.time_ms).size < 3:
            return self.at_shortest_time(), None
        intercept, slope = pinv(
            "the dark rows of a photon transfer", np.stack([np.ones(n), self.time_ms], axis=1)
        )
        return intercept, slope

    def at_shortest_time(self) -> Array:
        """Weights that give the dark of the shortest time, or the first one."""
        first = 0 if self.time_ms is None else int(np.argmin(self.time_ms))
        return np.eye(self.mean_dn.size)[first]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
    found = _darks(table)
    if found is None:
        lowest = float(table.mean_dn.min())
        base = lowest if black_dn is None else _check.not_negative("black_dn", "DN", black_dn)
        if base > lowest:
            raise InputError(
                "black_dn",
                f"must be at most {lowest:g} DN, the lowest mean of {table.source}",
                value=base,
                remedy="give the code without light",
            )
        return Levels(
            x=table.mean_dn - base,
            y=table.variance_dn2,
            samples=table.samples,
            frames=1 if table.spatial else 2,
            darks=None,
            dark_of=np.zeros(table.dark.size, dtype=int),
            black_known=black_dn is not None,
        )
    darks, dark_of = found
    if black_dn is not None:
        raise InputError(
            "black_dn",
            f"must be omitted where {table.source} has dark rows",
            value=black_dn,
            found=f"{black_dn:g} is given besides the {darks.mean_dn[0]:g} DN of those rows",
            remedy="omit it",
        )
    lit = ~table.dark
    return Levels(
        x=table.mean_dn[lit] - darks.mean_dn[dark_of],
        y=table.variance_dn2[lit] - darks.variance_dn2[dark_of],
        samples=None if table.samples is None else table.samples[lit],
        frames=1 if table.spatial else 2,
        darks=darks,
        dark_of=dark_of,
        black_known=True,
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
