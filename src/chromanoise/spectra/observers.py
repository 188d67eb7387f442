"""The observers of the CIE: their color-matching functions and the color axes that they span."""

from collections.abc import Mapping
from functools import cache

import numpy as np

from chromanoise.base import (
    LUMEN_PER_WATT,
    UM2_PER_M2,
    Array,
    Bool,
    Float,
    InputError,
    check,
    frozen,
    photons_per_joule,
)
from chromanoise.spectra.curves import Grid, Metric, Spectra, on_grid, photons_per_unit
from chromanoise.spectra.tables import packaged_table

INFRARED_FROM_NM = 700.0
"""Longer wavelengths count as infrared: y-bar is below 0.5 % of its peak."""


def is_infrared(grid: Grid) -> Bool[Array, " n"]:
    """Which wavelengths of a grid count as infrared: those beyond `INFRARED_FROM_NM`.

    Parameters
    ----------
    grid
        The wavelengths. [nm]

    Examples
    --------
    >>> is_infrared(Grid.uniform(695, 705, 5))
    array([False, False,  True])
    """
    return np.asarray(grid.wavelength_nm > INFRARED_FROM_NM)


OBSERVERS: Mapping[str, str] = {
    "cie-1931-2": "cie_1931",
    "cie-1964-10": "cie_1964",
    "cie-2015-2": "cie_2015_2",
    "cie-2015-10": "cie_2015_10",
}
"""Packaged table of each observer. The names end in the visual field in degrees."""

DEFAULT_OBSERVER = "cie-1931-2"
"""Name of the observer that every result uses unless another is given."""

_PEAK_OF_Y = (0.5, 2.0)


class OwnObserver(str):
    """An observer of one's own: its name, with its color-matching functions.

    Parameters
    ----------
    name
        Name of the observer.
    functions
        Three curves x, y, z in the units of the CIE: y has its peak near 1.

    Raises
    ------
    InputError
        If the name is that of a built-in observer, there are not three curves, one is 0 everywhere,
        or the peak of y is not 0.5 to 2.
    """

    functions: Spectra

    def __new__(cls, name: str, functions: Spectra) -> "OwnObserver":
        """The name as text; `functions` is checked."""
        made = super().__new__(cls, name)
        made.functions = functions
        if name in OBSERVERS:
            raise InputError(
                "observer", "must have another name than the built-in observers", value=name
            )
        if len(functions.names) != 3:
            raise InputError(
                name,
                "must have three color-matching functions, x, y and z",
                value=len(functions.names),
                found=f"has {len(functions.names)}",
            )
        peaks = functions.values.max(axis=0)
        for curve, peak in zip(functions.names, peaks, strict=True):
            if not peak > 0:
                raise InputError(
                    name, "must have values above 0", value=float(peak), where=f"curve {curve!r}"
                )
        if not _PEAK_OF_Y[0] <= peaks[1] <= _PEAK_OF_Y[1]:
            raise InputError(
                name,
                "second function must have a peak of 0.5 to 2, as y of the CIE",
                value=float(peaks[1]),
                found=f"has one of {peaks[1]:g}",
                where=f"curve {functions.names[1]!r}",
                remedy="scale all three functions by the same factor",
            )
        return made

    def __getnewargs__(self) -> tuple[str, Spectra]:  # type: ignore[override]
        """What another process needs to make the same observer."""
        return str(self), self.functions

    def __eq__(self, other: object) -> bool:
        """Whether the name is the same, and the functions where both have some."""
        if not isinstance(other, OwnObserver):
            return str.__eq__(self, other) is True
        one, two = self.functions, other.functions
        return (
            str.__eq__(self, other)
            and np.array_equal(one.wavelength_nm, two.wavelength_nm)
            and np.array_equal(one.values, two.values)
        )

    def __ne__(self, other: object) -> bool:
        """As `__eq__`, which `str` does not use for this."""
        return not self == other

    __hash__ = str.__hash__


def known_observer(observer: str) -> str:
    """The observer itself, if it is one of `OBSERVERS` or an `OwnObserver`.

    Parameters
    ----------
    observer
        Name of an observer, or one's own.

    Raises
    ------
    InputError
        If there is no observer of that name.
    """
    if isinstance(observer, OwnObserver):
        return observer
    return check.one_of("observer", observer, tuple(OBSERVERS))


@cache
def observer_table(observer: str = DEFAULT_OBSERVER) -> Spectra:
    """The color-matching functions of an observer as the CIE tabulates them, @1 nm.

    Parameters
    ----------
    observer
        A name from `OBSERVERS`, or an `OwnObserver`.

    Raises
    ------
    InputError
        If there is no observer of that name.

    Notes
    -----
    CIE 018:2019 (1931, 2 deg, https://doi.org/10.25039/CIE.DS.xvudnb9b; 1964, 10 deg) from 360 to
    830 nm; CIE 170-2:2015 (2 deg and 10 deg) from 390 to 830 nm.
    """
    if isinstance(known_observer(observer), OwnObserver):
        return observer.functions  # type: ignore[attr-defined]
    return packaged_table(OBSERVERS[observer])


@cache
def color_matching_functions(grid: Grid, observer: str = DEFAULT_OBSERVER) -> Spectra:
    """An observer on ``grid``; outside the range of its table it is zero, as the CIE defines it.

    Parameters
    ----------
    observer
        A name from `OBSERVERS`.

    Raises
    ------
    InputError
        If there is no observer of that name.

    Notes
    -----
    As `observer_table`.

    Examples
    --------
    >>> at_555_nm = color_matching_functions(Grid.uniform(400, 1050, 5), "cie-1964-10").values[31]
    >>> at_555_nm.round(4)
    array([0.6161, 0.9991, 0.0011])
    """
    return on_grid(observer_table(observer), grid, beyond="zero")


def cie_1931(grid: Grid) -> Spectra:
    """The CIE 1931 observer on ``grid``; outside 360-830 nm it is zero, as the CIE defines it.

    Parameters
    ----------
    grid
        Wavelengths of the result.

    Examples
    --------
    >>> cie_1931(Grid.uniform(400, 1050, 5)).values[31].round(4)    # 555 nm
    array([0.5121, 1.    , 0.0057])
    """
    return color_matching_functions(grid, DEFAULT_OBSERVER)


@cache
def color_axes(grid: Grid, metric: Metric, observer: str = DEFAULT_OBSERVER) -> Float[Array, "n 3"]:
    """H of eq. 5: H^T L is the color of the light L, with Y of CIE 1931 in lux.

    Parameters
    ----------
    grid
        The wavelengths of L.
    metric
        The unit in which L is a vector; see ``curves``.
    observer
        A name from `OBSERVERS`.

    Returns
    -------
    H
        Columns x, y, z. [lx per unit of L]

    Raises
    ------
    InputError
        If there is no observer of that name.

    Notes
    -----
    Clouet, Vaillant & Alleysson (CIC27, 2019), eq. 5, with the factor K_m delta-lambda so that
    Y is an illuminance. A common factor changes neither angles nor SNR. The lux is defined by
    y-bar of CIE 1931: Y of another observer has the same factor, but is not an illuminance.
    """
    functions = color_matching_functions(grid, observer).values
    lux_per_watt = LUMEN_PER_WATT * grid.step_nm * functions
    watt_per_unit = (
        photons_per_unit(grid, metric) * UM2_PER_M2 / photons_per_joule(grid.wavelength_nm)
    )
    return frozen(lux_per_watt * watt_per_unit[:, None])


def observer_notes(observer: str) -> tuple[str, ...]:
    """What to know about the colors of an observer; nothing for CIE 1931.

    Parameters
    ----------
    observer
        The observer of the colors.

    Examples
    --------
    >>> observer_notes("cie-1931-2")
    ()
    """
    if observer == DEFAULT_OBSERVER:
        return ()
    note = (
        f"X, Y and Z are those of the observer {observer}; its Y is not an illuminance, because "
        "the lux is defined by the CIE 1931 observer"
    )
    if isinstance(observer, OwnObserver):
        low, high = observer.functions.wavelength_nm[[0, -1]]
        return (f"{note}; it is zero outside {low:g}-{high:g} nm", *observer.functions.notes)
    return (note,)
