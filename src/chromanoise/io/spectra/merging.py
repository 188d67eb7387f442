"""Resample curves with different wavelengths to a common list of wavelengths."""

from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError, Setting
from chromanoise.io.spectra.parsed import Column, Unit, has
from chromanoise.spectra.curves import Beyond

_WIDE, _WIDE_NM = 2.5, 5.0
_MOST_VALUES = 4_000_000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sorted:
    """One curve at increasing wavelengths.

    Attributes
    ----------
    name
        The name of the curve.
    wavelength_nm
        Increasing wavelengths. [nm]
    values
        The values, in the unit of the file.
    unsorted
        Whether the rows of the file are not in increasing order.
    merged
        The number of points that were merged with others at the same wavelength.
    conflicts_nm
        Wavelengths at which merged points have different values. [nm]
    """

    name: str
    wavelength_nm: Float[Array, " m"]
    values: Float[Array, " m"]
    unsorted: bool
    merged: int
    conflicts_nm: tuple[float, ...]

    def __post_init__(self) -> None:
        _check.same_length("points", at=self.wavelength_nm.size, values=self.values.size)
        _check.freeze(self, "wavelength_nm", "values")


def in_nm(wavelength: Float[Array, " m"], unit: Unit) -> Float[Array, " m"]:
    """Convert wavelengths in a unit, or wavenumbers in 1/cm, without sorting. [nm]

    Examples
    --------
    >>> in_nm(np.array([0.4]), "um"), in_nm(np.array([5500.0]), "angstrom")
    (array([400.]), array([550.]))
    >>> in_nm(np.array([20000.0]), "1/cm")
    array([500.])
    """
    if unit == "nm":
        return wavelength
    if unit == "1/cm":
        return np.round(1e7 / wavelength, 9)
    # 0.4 * 1000 is not always 400
    return np.round(wavelength * 1000 if unit == "um" else wavelength / 10, 9)


def sorted_points(column: Column, unit: Unit, source: str) -> Sorted:
    """Sort a curve by wavelength, and merge repeated wavelengths to their mean.

    Raises
    ------
    InputError
        If fewer than two wavelengths remain.

    Examples
    --------
    >>> column = Column(name="R", unit="", wavelength=np.array([0.5, 0.4, 0.5]),
    ...                 values=np.array([3.0, 1.0, 5.0]))
    >>> sorted_points(column, "um", "a file").values
    array([1., 4.])
    """
    at = in_nm(column.wavelength, unit)
    order = np.argsort(at, kind="stable")
    rising, values = at[order], column.values[order]
    distinct, first, count = np.unique(rising, return_index=True, return_counts=True)
    if distinct.size < 2:
        where = f"curve {column.name!r}"
        raise has(source, "must have at least 2 wavelengths", distinct.size, where=where)
    spread = np.maximum.reduceat(values, first) - np.minimum.reduceat(values, first)
    means = np.where(spread > 0, np.add.reduceat(values, first) / count, values[first])
    return Sorted(
        name=column.name,
        wavelength_nm=distinct,
        values=means,
        unsorted=bool((np.diff(at) < 0).any() and not (np.diff(at) < 0).all()),
        merged=int(at.size - distinct.size),
        conflicts_nm=tuple(float(w) for w in distinct[spread > 0]),
    )


def on_common(
    points: list[Sorted], beyond: Beyond, source: str
) -> tuple[tuple[Float[Array, " m"], Float[Array, "m k"]], tuple[str, ...]]:
    """Interpolate all curves linearly to the union of their wavelengths.

    A curve that ends before the others is extrapolated by ``zero`` or ``hold``; with ``refuse``,
    all curves are cut to their common range.
    """
    at = np.unique(np.concatenate([p.wavelength_nm for p in points]))
    if at.size * len(points) > _MOST_VALUES:
        raise InputError(
            source,
            f"must have at most {_MOST_VALUES} values",
            value=at.size * len(points),
            found=f"has {len(points)} curves at {at.size} wavelengths",
        )
    starts = [float(p.wavelength_nm[0]) for p in points]
    ends = [float(p.wavelength_nm[-1]) for p in points]
    low, high = max(starts), min(ends)
    notes: tuple[str, ...] = ()
    if min(starts) < low or high < max(ends):
        shared = f"the curves share {low:g}-{high:g} nm of {min(starts):g}-{max(ends):g} nm"
        if beyond == "refuse":
            at = at[(at >= low) & (at <= high)]
            notes = (f"{shared}: cut to what they share (beyond zero or hold keeps the rest)",)
        else:
            notes = (f"{shared}: {beyond} beyond each curve's own end",)
    if at.size < 2:
        raise InputError(
            source,
            "curves must share at least 2 wavelengths",
            value=at.size,
            found=f"share {at.size}",
            remedy=Setting("beyond", ("zero", "hold")),
        )
    side = 0.0 if beyond == "zero" else None
    values = [np.interp(at, p.wavelength_nm, p.values, left=side, right=side) for p in points]
    return (at, np.stack(values, axis=1)), notes


def step_nm(wavelength_nm: Float[Array, " m"]) -> float | None:
    """The distance between neighbors; None if it varies by more than 0.1 %. [nm]

    Examples
    --------
    >>> step_nm(np.array([400.0, 405.0, 410.0])), step_nm(np.array([400.0, 405.0, 420.0]))
    (5.0, None)
    """
    steps = np.diff(wavelength_nm)
    middle = float(np.median(steps))
    return middle if np.abs(steps - middle).max() <= 1e-3 * middle else None


def gaps_nm(wavelength_nm: Float[Array, " m"]) -> tuple[tuple[float, float], ...]:
    """Start and end of steps wider than 2.5 times the usual step and wider than 5 nm. [nm]

    Examples
    --------
    >>> gaps_nm(np.array([400.0, 410.0, 420.0, 430.0, 500.0]))
    ((430.0, 500.0),)
    """
    steps = np.diff(wavelength_nm)
    wide = np.flatnonzero(steps > max(_WIDE * float(np.median(steps)), _WIDE_NM))
    return tuple((float(wavelength_nm[i]), float(wavelength_nm[i + 1])) for i in wide)
