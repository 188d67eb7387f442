"""Models of silicon, color filters and IR-cut filters.

The models have the right physics and few parameters. They are for hypothetical sensors; a real
sensor is given by its measured curves.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Inexact
from chromanoise.errors import InputError
from chromanoise.spectra import Beyond, Grid, Spectra, means_on_grid, shifted
from chromanoise.spectra.tables import catalog_curves, catalog_tables, packaged_table

LEAST_LENGTH_UM = 1e-6
"""Shortest depth or thickness of a model: no number is divided by 0. [um]"""
LEAST_LENGTH_NM = 1e-3
"""Shortest wavelength or width of a model: no number is divided by 0. [nm]"""
_CM_PER_UM = 1e-4
_LARGEST = float(np.finfo(np.float64).max)
_MODEL = r"ircut-([\d.]+)(?:/([\d.]+))?"


Number = float | complex | Array
"""A number, or one per candidate (m,); complex for a derivative by the complex step."""


def per_candidate(
    name: str, unit: str, value: Number, *, least: float = 0.0, most: float = math.inf
) -> Inexact[Array, "*m 1"]:
    """A number with a last axis for wavelengths, after a check of its real part.

    Parameters
    ----------
    name, unit
        What the number is, for the message.
    value
        A number, or one per candidate.
    least, most
        What is possible, both included.

    Raises
    ------
    InputError
        If a real part is not finite or not possible.
    """
    numbers = np.asarray(value)
    if numbers.dtype.kind not in "fc":
        numbers = numbers.astype(np.float64)
    real = numbers.real
    good = (real >= max(least, -_LARGEST)) & (real <= min(most, _LARGEST))  # False for a NaN
    if not good.all():
        demand = f"must be {possible(least, most)}{_check.in_brackets(unit)}"
        raise InputError(name, demand, value=float(real[~good].flat[0]))
    return numbers[..., None]


def possible(least: float, most: float) -> str:
    """The demand of a message for a number from ``least`` to ``most``.

    Examples
    --------
    >>> possible(0.0, 1.0), possible(0.0, math.inf), possible(-math.inf, math.inf)
    ('0 to 1', 'finite and >= 0', 'finite')
    """
    if most < math.inf:
        return f"{least:g} to {most:g}"
    return f"finite and >= {least:g}" if least > -math.inf else "finite"


def silicon_qe(
    grid: Grid, *, depth_um: Number, dead_layer_um: Number = 0.05, reflectance: Number = 0.1
) -> Inexact[Array, "*m n"]:
    """Electrons per photon of a silicon photodiode (Beer-Lambert). [e-/photon]

    (1 - R) exp(-alpha dead) (1 - exp(-alpha depth)): the share of the light that is
    not reflected, not lost in the dead layer at the surface, and absorbed within the collection
    depth. Each number may be one, or one per candidate.

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

    Raises
    ------
    InputError
        If a number is out of range, or the grid exceeds the table of the absorption.

    Notes
    -----
    Absorption at 300 K: Green & Keevers, Prog. Photovolt. 3 (1995) 189-192; the
    logarithm is interpolated because it is smooth.
    """
    depth = per_candidate("depth_um", "um", depth_um, least=LEAST_LENGTH_UM)
    dead = per_candidate("dead_layer_um", "um", dead_layer_um)
    entering = 1.0 - per_candidate("reflectance", "1", reflectance, most=1.0)
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


def layered_silicon_qe(grid: Grid, ends_um: Sequence[Number]) -> Inexact[Array, "*m n p"]:
    """Electrons per photon of stacked photodiodes: each absorbs what those above it transmit.

    The surface has no dead layer, and reflects as that of `silicon_qe`. [e-/photon]

    Parameters
    ----------
    grid
        Within 400-1050 nm.
    ends_um
        Depth at which each diode ends, increasing. [um]

    Raises
    ------
    InputError
        If a depth is not positive, or the depths do not increase.
    """
    depth = np.stack(np.broadcast_arrays(*ends_um), axis=-1)
    if (np.diff(depth.real, axis=-1) <= 0).any():
        raise InputError("ends_um", "must increase [um]", value=depth.real.tolist())
    whole = silicon_qe(grid, depth_um=depth, dead_layer_um=0.0)
    return np.moveaxis(np.diff(whole, axis=-2, prepend=0.0), -2, -1)


def resin_filter(
    grid: Grid,
    *,
    low_nm: Number,
    high_nm: Number,
    leak_nm: Number,
    edge_nm: Number = 12.0,
    peak: Number = 0.9,
    leak: Number = 0.95,
    floor: Number = 0.02,
) -> Inexact[Array, "*m n"]:
    """Transmittance of a color filter resin: one passband, and transparent again in the NIR.

    All numbers may be one per candidate.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    low_nm, high_nm
        Wavelengths at which the passband rises and falls through half its height. [nm]
    leak_nm
        Wavelength above which the resin is transparent again. [nm]
    edge_nm
        Width of the edges (logistic scale). [nm]
    peak, leak, floor
        Transmittance in the passband, in the NIR, and in the stopband.

    Raises
    ------
    InputError
        If a transmittance is not 0 to 1, an edge is too narrow, or the edges are not in order.

    Examples
    --------
    >>> green = resin_filter(Grid.uniform(400, 1050, 50), low_nm=490, high_nm=590, leak_nm=780)
    >>> green[[0, 3, 5, 10]].round(2)       # 400, 550, 650 and 900 nm
    array([0.02, 0.86, 0.03, 0.94])
    """
    top = per_candidate("peak", "1", peak, most=1.0)
    infrared = per_candidate("leak", "1", leak, most=1.0)
    bottom = per_candidate("floor", "1", floor, most=1.0)
    scale = per_candidate("edge_nm", "nm", edge_nm, least=LEAST_LENGTH_NM)
    low, high, again = (
        per_candidate(name, "nm", edge, least=-math.inf)
        for name, edge in (("low_nm", low_nm), ("high_nm", high_nm), ("leak_nm", leak_nm))
    )
    order = (low.real < high.real) & (high.real <= again.real)
    if not order.all():
        first = np.unravel_index(int(order.argmin()), order.shape)
        found = tuple(
            float(np.broadcast_to(edge.real, order.shape)[first]) for edge in (low, high, again)
        )
        raise InputError(
            "low_nm, high_nm and leak_nm",
            "must satisfy low_nm < high_nm <= leak_nm [nm]",
            value=found,
            found=f"are {found[0]:g}, {found[1]:g} and {found[2]:g}",
        )
    wavelength = grid.wavelength_nm
    passband = logistic(wavelength, low, scale) * logistic(-wavelength, -high, scale)
    open_again = logistic(wavelength, again, 2 * scale)
    return bottom + (top - bottom) * passband * (1 - open_again) + (infrared - bottom) * open_again


def ir_cut(
    grid: Grid, *, edge_nm: Number = 655.0, width_nm: Number = 8.0
) -> Inexact[Array, "*m n"]:
    """Transmittance of an IR-cut filter: 1 below a logistic edge, 0 above it.

    Both numbers may be one per candidate.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    edge_nm
        Wavelength of half transmittance. [nm]
    width_nm
        Logistic scale: 88 % passes two widths below the edge, 12 % two above. [nm]
    """
    scale = per_candidate("width_nm", "nm", width_nm, least=LEAST_LENGTH_NM)
    edge = per_candidate("edge_nm", "nm", edge_nm, least=LEAST_LENGTH_NM)
    return logistic(-grid.wavelength_nm, -edge, scale)


def filter_named(
    name: str,
    grid: Grid,
    *,
    beyond: Beyond = "refuse",
    others: Sequence[str] = (),
    shift_nm: float = 0.0,
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
    shift_nm
        Added to the wavelengths of the filter, positive towards red. [nm]

    Raises
    ------
    InputError
        If no filter has this name, or the shifted table does not cover the grid and ``beyond`` is
        ``refuse``.

    Examples
    --------
    >>> filter_named("ircut-650", Grid.uniform(600, 700, 50)).values[:, 0].round(3)
    array([0.998, 0.5  , 0.002])
    """
    if model := ir_cut_model(name):
        edge_nm, width_nm = model
        return Spectra(
            wavelength_nm=grid.wavelength_nm,
            values=ir_cut(grid, edge_nm=edge_nm + shift_nm, width_nm=width_nm)[:, None],
            names=(name,),
            quantity="transmittance",
            unit="1",
            source=name,
            notes=(f"{name}: a model with one logistic edge, not a filter that exists",),
        )
    measured = catalog_tables("filter")
    name = _check.one_of("filter", name, (*measured, "ircut-650", *others))
    entry = measured[name]
    curve = replace(catalog_curves(entry), notes=(entry.source, entry.defects))
    return means_on_grid(shifted(curve, shift_nm), grid, beyond=beyond)


def ir_cut_model(name: str) -> tuple[float, float] | None:
    """Edge and width of a model IR-cut by its name; ``None`` for another name. [nm]

    Parameters
    ----------
    name
        Name such as ``ircut-650/20``.

    Raises
    ------
    InputError
        If the name starts as that of a model and has no numbers.

    Examples
    --------
    >>> ir_cut_model("ircut-650"), ir_cut_model("ircut-schott")
    ((650.0, 8.0), None)
    """
    match = re.fullmatch(_MODEL, name)
    return None if match is None else (_number(match[1], name), _number(match[2] or "8", name))


def is_filter_name(name: str) -> bool:
    """Whether `filter_named` accepts this name.

    Parameters
    ----------
    name
        Name of a filter.

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


def logistic(at: Float[Array, " n"], middle: Number, scale: Number) -> Inexact[Array, "*m n"]:
    """The logistic edge 1 / (1 + exp(-(at - middle) / scale)), in a form that cannot overflow."""
    edge = np.subtract(at, middle, dtype=np.result_type(at, middle, scale))
    edge *= 0.5
    edge /= scale
    np.tanh(edge, out=edge)
    edge += 1.0
    edge *= 0.5
    return edge
