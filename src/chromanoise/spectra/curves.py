"""The wavelength grid, spectral curves resampled onto it, and the unit of spectra as vectors.

The unit is that of radiant power or of photons. Eq. 5 applies color-matching functions, which are
defined for radiant power, to the spectrum of eq. 4. Two consistent choices exist. They give
different dual bases, kernels and contravariant coordinates, so every result records which one was
used:

========== ============================ ==================== =======================
metric     light L                      sensor f             color axes H
========== ============================ ==================== =======================
``energy`` [W m-2 nm-1]                 k QE lambda / (h c)  K_m CMF
``quanta`` [photons s-1 um-2 nm-1]      k QE                 K_m CMF h c / lambda
========== ============================ ==================== =======================

Both metrics give the same number of electrons F^T L and the same illuminance H^T L.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Literal, get_args

import numpy as np

from chromanoise.base import (
    UM2_PER_M2,
    Array,
    Bool,
    Float,
    InputError,
    Remedy,
    Setting,
    check,
    dataclass,
    photons_per_joule,
    with_short_repr,
)


@dataclass(frozen=True)
class Grid:
    """``n`` equidistant wavelengths, both ends included.

    Attributes
    ----------
    start_nm, stop_nm
        First and last wavelength. [nm]
    step_nm
        Distance between neighboring wavelengths: the paper's delta-lambda. [nm]

    Raises
    ------
    InputError
        If a number is not positive, or the step does not divide the range.

    Examples
    --------
    >>> grid = Grid.uniform(400, 1050, 5)
    >>> grid.n, grid.wavelength_nm[:3]
    (131, array([400., 405., 410.]))
    """

    start_nm: float
    stop_nm: float
    step_nm: float

    def __post_init__(self) -> None:
        for name in ("start_nm", "stop_nm", "step_nm"):
            object.__setattr__(
                self, name, check.positive(f"Grid.{name}", "nm", getattr(self, name))
            )
        steps = (self.stop_nm - self.start_nm) / self.step_nm
        if steps < 1 or abs(steps - round(steps)) > 1e-9:
            raise InputError(
                "Grid",
                f"must go up from {self.start_nm:g} to {self.stop_nm:g} nm in whole steps",
                value=(self.start_nm, self.stop_nm, self.step_nm),
                found=f"a step of {self.step_nm:g} nm fits {steps:g} times",
            )

    @classmethod
    def uniform(cls, start_nm: float, stop_nm: float, step_nm: float) -> "Grid":
        """Make the grid from ``start_nm`` to ``stop_nm``.

        Parameters
        ----------
        start_nm, stop_nm, step_nm
            First wavelength, last wavelength and step. [nm]

        Returns
        -------
        Grid
            Both ends included.

        Raises
        ------
        InputError
            If the step does not divide the range.
        """
        return cls(float(start_nm), float(stop_nm), float(step_nm))

    @property
    def n(self) -> int:
        """Number of wavelengths."""
        return round((self.stop_nm - self.start_nm) / self.step_nm) + 1

    @property
    def wavelength_nm(self) -> Float[Array, " n"]:
        """The wavelengths. [nm]"""
        return self.start_nm + self.step_nm * np.arange(self.n)

    def __str__(self) -> str:
        return f"{self.start_nm:g}-{self.stop_nm:g} nm @{self.step_nm:g}"


DEFAULT_GRID = Grid.uniform(400, 1050, 5)
"""The paper's range, where silicon is sensitive. Eq. 2 sums over these 131 wavelengths."""


Beyond = Literal["refuse", "zero", "hold"]
"""How a curve is extrapolated: refuse with an error, use zero, or hold the last value."""

SMALL_NEGATIVES = Setting("negatives", ("zero",))
"""The setting that sets small negative values of a file to 0."""
SMALL_SHARE = 0.01
"""Size of negative values that may be set to 0, over the highest value of their curve."""
"""Sets small negative values, which digitizing or dark readings can cause, to 0."""

_SLACK_NM = 1e-6  # wavelengths read from text may miss the grid's end by rounding


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Spectra:
    """``k`` curves sampled at ``m`` increasing wavelengths, equidistant or not.

    Attributes
    ----------
    wavelength_nm
        The wavelengths of the samples. [nm]
    values
        One column per curve, in ``unit``.
    names
        One name per curve.
    quantity
        The quantity of the curves, e.g. "QE" or "reflectance"; used in messages.
    unit
        The unit of ``values``; "1" for a ratio.
    source
        The origin of the numbers.
    notes
        How the numbers were processed, e.g. how they were extrapolated.

    Raises
    ------
    InputError
        If wavelengths do not increase, a value is not finite, or the shapes do not match.
    """

    wavelength_nm: Float[Array, " m"]
    values: Float[Array, "m k"]
    names: tuple[str, ...]
    quantity: str
    unit: str
    source: str
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = f"{self.quantity} of {self.source}"
        wavelength = check.increasing(f"wavelength_nm of {where}", "nm", self.wavelength_nm)
        values = check.finite(where, self.unit, self.values)
        if values.ndim != 2:
            raise InputError(where, "must be (wavelengths, curves)", value=values.shape)
        check.same_length("wavelengths", wavelength_nm=wavelength.size, values=values.shape[0])
        check.same_length("curves", names=len(self.names), values=values.shape[1])
        check.keep(self, wavelength_nm=wavelength, values=values)
        object.__setattr__(self, "names", check.distinct(f"names of {where}", self.names))


def interpolation_matrix(
    wavelength_nm: Float[Array, " m"], grid: Grid, *, beyond: Beyond, what: str
) -> tuple[Float[Array, "n m"], tuple[str, ...]]:
    """The linear interpolation from ``m`` samples to the grid, and notes on extrapolation.

    Parameters
    ----------
    wavelength_nm
        The wavelengths of the samples, increasing. [nm]
    beyond
        Outside the samples: ``refuse`` with an error, use ``zero``, or ``hold`` the last value.
    what
        The name of the curve in error messages.

    Returns
    -------
    matrix
        ``matrix @ values`` gives the values on the grid. No weight is negative, so the result
        cannot overshoot.
    notes
        One sentence if the curve was extrapolated, else empty.

    Raises
    ------
    InputError
        If the curve does not cover the grid and ``beyond`` is ``refuse``, or if the two do not
        overlap.

    Examples
    --------
    >>> matrix, notes = interpolation_matrix(
    ...     np.array([400.0, 410.0]), Grid.uniform(400, 410, 5), beyond="refuse", what="a line")
    >>> matrix @ np.array([1.0, 3.0])
    array([1., 2., 3.])
    """
    check.one_of("beyond", beyond, get_args(Beyond))
    known = np.asarray(wavelength_nm, dtype=np.float64)
    wanted = grid.wavelength_nm
    ends, covers = (float(known[0]), float(known[-1])), f"{known[0]:g}-{known[-1]:g} nm"
    if known[0] > wanted[-1] or known[-1] < wanted[0]:
        remedy = "check that its wavelengths are in nm"
        found = f"covers {covers}"
        raise InputError(what, f"must meet the grid {grid}", value=ends, found=found, remedy=remedy)
    short = (wanted < known[0] - _SLACK_NM) | (wanted > known[-1] + _SLACK_NM)
    notes: tuple[str, ...] = ()
    if short.any():
        if beyond == "refuse":
            raise InputError(
                what,
                f"must cover the grid {grid}",
                value=ends,
                found=f"covers {covers}; {_spans(wanted, short)} nm are missing",
                remedy=(
                    Setting("beyond", ("zero", "hold")),
                    "use a measurement that covers the grid",
                ),
            )
        notes = (f"{what}: {beyond} beyond {covers}",)
    held = known.size <= _FEW
    matrix = (_held_interpolation if held else _interpolation)(known.tobytes(), grid)
    if notes and beyond == "zero":
        matrix = np.where(short[:, None], 0.0, matrix)
    return matrix, notes


def _interpolation(wavelength_nm: bytes, grid: Grid) -> Float[Array, "n m"]:
    known, wanted = np.frombuffer(wavelength_nm), grid.wavelength_nm
    at = np.clip(wanted, known[0], known[-1])
    right = np.clip(np.searchsorted(known, at, side="left"), 1, known.size - 1)
    share = (at - known[right - 1]) / (known[right] - known[right - 1])
    matrix = np.zeros((wanted.size, known.size))
    rows = np.arange(wanted.size)
    matrix[rows, right - 1] = 1.0 - share
    matrix[rows, right] += share
    matrix.flags.writeable = False
    return matrix


_held_interpolation = lru_cache(maxsize=16)(_interpolation)  # many files have the same wavelengths
_FEW = 500  # wavelengths of a table whose interpolation is held


def is_extrapolation_note(note: str) -> bool:
    """Whether a note of `interpolation_matrix` says how a curve is extrapolated."""
    return any(f": {one} beyond " in note for one in get_args(Beyond))


def means_on_grid(spectra: Spectra, grid: Grid, *, beyond: Beyond = "refuse") -> Spectra:
    """Resample like `on_grid`, but average a table that is finer than the grid over grid cells.

    Averaging ensures that a spectral line or a narrow band between two grid points is not lost.
    A cell extends half a step to each side, or less where the table ends. Linear curves keep
    their values.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    beyond
        Values outside the range of the data: refuse, zero or hold.
    """
    sampled = on_grid(spectra, grid, beyond=beyond)
    known, at = spectra.wavelength_nm, grid.wavelength_nm
    steps = np.diff(known)
    if steps.min() >= grid.step_nm or np.median(steps) >= grid.step_nm:  # imports numpy.ma
        return sampled
    half = np.clip(np.minimum(at - known[0], known[-1] - at), 0.0, grid.step_nm / 2)
    wide = half > 1e-3 * grid.step_nm
    edges = np.concatenate([at - half, at + half])
    nodes = np.union1d(known, np.clip(edges, known[0], known[-1]))
    values = np.empty_like(sampled.values)
    for k, curve in enumerate(spectra.values.T):
        value = np.interp(nodes, known, curve)
        area = np.concatenate([[0.0], np.cumsum((value[1:] + value[:-1]) / 2 * np.diff(nodes))])
        within = np.interp(at + half, nodes, area) - np.interp(at - half, nodes, area)
        values[:, k] = np.where(wide, within / np.where(wide, 2 * half, 1.0), sampled.values[:, k])
    return replace(sampled, values=values)


def shifted(spectra: Spectra, shift_nm: float) -> Spectra:
    """The curves at other wavelengths; ``source`` names the shift.

    Parameters
    ----------
    shift_nm
        Added to their wavelengths, positive towards red; 0 returns the curves themselves. [nm]
    """
    if shift_nm == 0:
        return spectra
    return replace(
        spectra,
        wavelength_nm=spectra.wavelength_nm + shift_nm,
        source=f"{spectra.source} shifted by {shift_nm:+g} nm",
    )


def used_on_grid(
    wavelength_nm: Float[Array, " m"], grid: Grid, *, from_nm: float | None = None
) -> Bool[Array, " m"]:
    """A mask of the points of a curve that `means_on_grid` uses; the others are ignored.

    Parameters
    ----------
    wavelength_nm
        The wavelengths of the curve, increasing. [nm]
    grid
        The target grid: points in its cells are used, and the next one beyond each end.
    from_nm
        The start of the integration, if it lies below the grid. [nm]

    Examples
    --------
    >>> used_on_grid(np.array([300.0, 390.0, 400.0, 402.0, 500.0]), Grid.uniform(401, 403, 1))
    array([False, False,  True,  True,  True])
    """
    low, high = grid.wavelength_nm[[0, -1]] + np.array([-0.5, 0.5]) * grid.step_nm
    low = min(low, low if from_nm is None else from_nm)
    first = np.searchsorted(wavelength_nm, low, side="right") - 1
    last = np.searchsorted(wavelength_nm, high, side="left")
    rows = np.arange(wavelength_nm.size)
    return np.asarray((rows >= first) & (rows <= last))


def _spans(wavelength_nm: Float[Array, " n"], chosen: Bool[Array, " n"]) -> str:
    """The ranges of the chosen wavelengths, which lie at the two ends."""
    at = np.flatnonzero(chosen)
    runs = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1)
    return " and ".join(f"{wavelength_nm[r[0]]:g}-{wavelength_nm[r[-1]]:g}" for r in runs)


def refuse_outside(
    spectra: Spectra,
    *,
    low: float = 0.0,
    high: float = np.inf,
    remedy: Remedy | Sequence[Remedy] = (),
    used: Bool[Array, " m"] | None = None,
) -> None:
    """Raise an error if any value lies outside ``low`` to ``high``; it names the first such value.

    Parameters
    ----------
    low, high
        The allowed range, in the unit of the curves.
    remedy
        What the user can do about it.
    used
        Mask of the wavelengths to check, from `used_on_grid`; ``None`` checks all.

    Raises
    ------
    InputError
        If a value is out of range. The message names source, curve, wavelength and value.
    """
    bad = (spectra.values < low) | (spectra.values > high)
    if used is not None:
        bad &= used[:, None]
    if not bad.any():
        return
    large = bad & ~are_small_negatives(spectra.values)
    if remedy == SMALL_NEGATIVES and large.any():
        remedy = (
            f"only down to {-100 * SMALL_SHARE:g} % of the highest value of a curve are they "
            "set to 0 on demand; correct the file"
        )
        row, column = (int(i) for i in np.argwhere(large)[0])
    else:
        row, column = (int(i) for i in np.argwhere(bad)[0])
    value = float(spectra.values[row, column])
    demand = f"{low:g} .. {high:g}" if np.isfinite(high) else f">= {low:g}"
    raise InputError(
        spectra.source,
        f"{spectra.quantity} must be {demand} [{spectra.unit}]",
        value=value,
        found=f"is {value:g} ({int(bad.sum())} of {bad.size} values are outside)",
        where=f"column {spectra.names[column]!r} at {spectra.wavelength_nm[row]:g} nm",
        remedy=remedy,
    )


def are_small_negatives(values: Float[Array, "n m"]) -> Bool[Array, "n m"]:
    """Mask of negative values that may be set to 0: at most 1 % of the highest of their curve."""
    return (values < 0) & (values >= -SMALL_SHARE * values.max(axis=0, keepdims=True))


def on_grid(spectra: Spectra, grid: Grid, *, beyond: Beyond = "refuse") -> Spectra:
    """The curves on ``grid``, by linear interpolation between neighboring samples.

    Parameters
    ----------
    beyond
        How to extrapolate curves that do not cover the grid; ``notes`` records the choice.

    Raises
    ------
    InputError
        As for `interpolation_matrix`.
    """
    what = f"{spectra.quantity} of {spectra.source}"
    matrix, notes = interpolation_matrix(spectra.wavelength_nm, grid, beyond=beyond, what=what)
    return replace(
        spectra,
        wavelength_nm=grid.wavelength_nm,
        values=matrix @ spectra.values,
        notes=spectra.notes + notes,
    )


Metric = Literal["quanta", "energy"]
"""Whether spectra are expressed in photons (``quanta``) or in energy (``energy``)."""
METRICS: tuple[Metric, ...] = get_args(Metric)
"""The metrics by name."""


def photons_per_unit(grid: Grid, metric: Metric) -> Float[Array, " n"]:
    """Photons s-1 um-2 nm-1 per unit of light in this metric, at each wavelength.

    Examples
    --------
    >>> photons_per_unit(Grid.uniform(500, 510, 10), "quanta")
    array([1., 1.])
    """
    check.one_of("metric", metric, METRICS)
    if metric == "quanta":
        return np.ones(grid.n)
    return photons_per_joule(grid.wavelength_nm) / UM2_PER_M2
