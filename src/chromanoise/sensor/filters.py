"""Models of silicon, color filters and IR-cut filters.

The models have the right physics and few parameters. They are for hypothetical sensors; a real
sensor is given by its measured curves.
"""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.spectra import Beyond, Grid, Spectra, means_on_grid
from chromanoise.spectra.tables import catalog_curves, catalog_tables, packaged_table

_CM_PER_UM = 1e-4
_MODEL = r"ircut-([\d.]+)(?:/([\d.]+))?"


def silicon_qe(
    grid: Grid, *, depth_um: float, dead_layer_um: float = 0.05, reflectance: float = 0.1
) -> Float[Array, " n"]:
    """Electrons per photon of a silicon photodiode (Beer-Lambert). [e-/photon]

    (1 - R) exp(-alpha dead) (1 - exp(-alpha depth)): the share of the light that is
    not reflected, not lost in the dead layer at the surface, and absorbed within the collection
    depth.

    Parameters
    ----------
    grid
        Within 400-1050 nm, where the absorption of silicon is tabulated.
    depth_um
        Collection depth. [um]
    dead_layer_um
        Surface layer whose carriers are lost. [um]
    reflectance
        Share of the light that is reflected at the surface.

    Notes
    -----
    Absorption at 300 K: Green & Keevers, Prog. Photovolt. 3 (1995) 189-192; the
    logarithm is interpolated because it is smooth.
    """
    depth = _check.positive("depth_um", "um", depth_um)
    dead = _check.not_negative("dead_layer_um", "um", dead_layer_um)
    entering = 1.0 - float(_check.fraction("reflectance", "1", reflectance))
    table = packaged_table("silicon_absorption")
    wavelength = grid.wavelength_nm
    known = table.wavelength_nm
    if wavelength[0] < known[0] or wavelength[-1] > known[-1]:
        raise InputError(
            "grid",
            f"must lie within {known[0]:g}-{known[-1]:g} nm, where the absorption of silicon is "
            "tabulated",
            value=grid,
        )
    per_cm = np.exp(np.interp(wavelength, known, np.log(table.values[:, 0])))
    per_um = per_cm * _CM_PER_UM
    return entering * np.exp(-per_um * dead) * -np.expm1(-per_um * depth)


def resin_filter(
    grid: Grid,
    *,
    low_nm: float,
    high_nm: float,
    leak_nm: float,
    edge_nm: float = 12.0,
    peak: float = 0.9,
    leak: float = 0.95,
    floor: float = 0.02,
) -> Float[Array, " n"]:
    """Transmittance of a color filter resin: one passband, and transparent again in the NIR.

    Parameters
    ----------
    low_nm, high_nm
        Wavelengths at which the passband rises and falls through half its height. [nm]
    leak_nm
        Wavelength above which the resin is transparent again. [nm]
    edge_nm
        Width of the edges (logistic scale). [nm]
    peak, leak, floor
        Transmittance in the passband, in the NIR, and in the stopband.

    Examples
    --------
    >>> green = resin_filter(Grid.uniform(400, 1050, 50), low_nm=490, high_nm=590, leak_nm=780)
    >>> green[[0, 3, 5, 10]].round(2)       # 400, 550, 650 and 900 nm
    array([0.02, 0.86, 0.03, 0.94])
    """
    for name, value in (("peak", peak), ("leak", leak), ("floor", floor)):
        _check.fraction(name, "1", value)
    scale = _check.positive("edge_nm", "nm", edge_nm)
    if not low_nm < high_nm <= leak_nm:
        raise InputError(
            "low_nm, high_nm and leak_nm",
            "must satisfy low_nm < high_nm <= leak_nm [nm]",
            value=(low_nm, high_nm, leak_nm),
            found=f"are {low_nm:g}, {high_nm:g} and {leak_nm:g}",
        )
    wavelength = grid.wavelength_nm
    passband = _rise(wavelength, low_nm, scale) * _rise(-wavelength, -high_nm, scale)
    open_again = _rise(wavelength, leak_nm, 2 * scale)
    return floor + (peak - floor) * passband * (1 - open_again) + (leak - floor) * open_again


def ir_cut(grid: Grid, *, edge_nm: float = 655.0, width_nm: float = 8.0) -> Float[Array, " n"]:
    """Transmittance of an IR-cut filter: 1 below a logistic edge, 0 above it.

    Parameters
    ----------
    edge_nm
        Wavelength of half transmittance. [nm]
    width_nm
        Logistic scale: 88 % passes two widths below the edge, 12 % two above. [nm]
    """
    scale = _check.positive("width_nm", "nm", width_nm)
    return _rise(-grid.wavelength_nm, -_check.positive("edge_nm", "nm", edge_nm), scale)


def filter_named(
    name: str, grid: Grid, *, beyond: Beyond = "refuse", others: Sequence[str] = ()
) -> Spectra:
    """Transmittance of the catalog filter ``name``, with notes on its source and defects.

    Parameters
    ----------
    name
        A measured filter, such as ``ircut-schott``, or ``ircut-<nm>`` or ``ircut-<nm>/<width>``
        for the model `ir_cut`.
    grid
        Wavelengths of the result.
    beyond
        How to extrapolate where the table does not cover the grid.
    others
        Other valid names, suggested in the error message.

    Raises
    ------
    InputError
        If no filter has this name, or the table does not cover the grid and ``beyond`` is
        ``refuse``.

    Examples
    --------
    >>> filter_named("ircut-650", Grid.uniform(600, 700, 50)).values[:, 0].round(3)
    array([0.998, 0.5  , 0.002])
    """
    if match := re.fullmatch(_MODEL, name):
        edge_nm, width_nm = (_number(text, name) for text in (match[1], match[2] or "8"))
        return Spectra(
            wavelength_nm=grid.wavelength_nm,
            values=ir_cut(grid, edge_nm=edge_nm, width_nm=width_nm)[:, None],
            names=(name,),
            quantity="transmittance",
            unit="1",
            source=name,
            notes=(f"{name}: a model with one logistic edge, not a filter that exists",),
        )
    measured = catalog_tables("filter")
    _check.one_of("filter", name, (*measured, "ircut-650", *others))
    entry = measured[name]
    curve = replace(catalog_curves(entry), notes=(entry.source, entry.defects))
    return means_on_grid(curve, grid, beyond=beyond)


def is_filter_name(name: str) -> bool:
    """Whether `filter_named` accepts this name.

    Examples
    --------
    >>> is_filter_name("ircut-650.5/4"), is_filter_name("glass.dat")
    (True, False)
    """
    return bool(re.fullmatch(_MODEL, name)) or name in catalog_tables("filter")


def _number(text: str, name: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(
            "filter",
            "must have numbers after ircut-, as ircut-650/8 [nm]",
            value=name,
            found=f"{text!r} of {name!r} is not a number",
        ) from None


def _rise(at: Float[Array, " n"], middle: float, scale: float) -> Float[Array, " n"]:
    """The logistic edge 1 / (1 + exp(-(at - middle) / scale)), in a form that cannot overflow."""
    return 0.5 * (1.0 + np.tanh(0.5 * (at - middle) / scale))
