"""Models of silicon, color filters and IR-cut filters, as functions of the grid and few numbers.

The models have the right physics and few parameters. They are for hypothetical sensors; a real
sensor is given by its measured curves.

Each number may be one, or one per candidate (m,); the result has the shape (n,) or (m, n). All are
analytic functions of their numbers, so that complex numbers give exact derivatives by the complex
step. Each transmittance is a mean or a product of values within 0 to 1, with weights within 0 to 1.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated

import numpy as np

from chromanoise.base import Array, Float, Inexact, InputError, check, dataclass
from chromanoise.spectra import Beyond, Grid, Spectra, means_on_grid, shifted
from chromanoise.spectra.tables import catalog_curves, catalog_tables, packaged_table

LEAST_LENGTH_UM = 1e-6
"""Shortest depth or thickness of a model: no number is divided by 0. [um]"""
LEAST_LENGTH_NM = 1e-3
"""Shortest wavelength or width of a model: no number is divided by 0. [nm]"""
LEAST_WAVELENGTH_NM = 100.0
"""Shortest wavelength at which a filter of a design does something: 0.56 is one in um. [nm]"""
_CM_PER_UM = 1e-4
_LARGEST = float(np.finfo(np.float64).max)
_MODEL = r"ircut-([\d.]+)(?:/([\d.]+))?"


Number = float | complex | Array
"""A number, or one per candidate (m,); complex for a derivative by the complex step."""


@dataclass(frozen=True, kw_only=True)
class ModelNumber:
    """One number of a filter model.

    Attributes
    ----------
    unit
        Its unit; ``1`` for a ratio.
    what
        What it is, in one phrase.
    default
        Its value where none is given; ``None`` if one must be given.
    least, most
        The smallest and the largest possible value.
    """

    unit: str
    what: str
    default: float | None = None
    least: float = 0.0
    most: float = math.inf


def length_nm(what: str) -> ModelNumber:
    """A length above 0."""
    return ModelNumber(unit="nm", what=what, least=LEAST_LENGTH_NM)


def wavelength_at_nm(what: str) -> ModelNumber:
    """A wavelength at which a filter does something."""
    return ModelNumber(unit="nm", what=what, least=LEAST_WAVELENGTH_NM)


def share_of_light(what: str) -> ModelNumber:
    """A share or a transmittance, 0 to 1."""
    return ModelNumber(unit="1", what=what, most=1.0)


_Peak = Annotated[Number, share_of_light("highest transmittance")]
_Floor = Annotated[Number, share_of_light("transmittance far from the band")]
_Leak = Annotated[Number, share_of_light("share of the stopped light that passes in the infrared")]
_LeakFrom = Annotated[Number, wavelength_at_nm("wavelength above which it passes")]
_EdgeWidth = Annotated[Number, length_nm("logistic scale of the edge")]


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
        demand = f"must be {possible(least, most)}{check.in_brackets(unit)}"
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
    grid: Grid,
    *,
    depth_um: Annotated[
        Number,
        ModelNumber(unit="um", what="collection depth", default=4.0, least=LEAST_LENGTH_UM),
    ],
    dead_layer_um: Annotated[
        Number, ModelNumber(unit="um", what="depth whose carriers are lost")
    ] = 0.05,
    reflectance: Annotated[
        Number, share_of_light("share of the light that the surface reflects")
    ] = 0.1,
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
        Wavelengths, within 400-1050 nm. [nm]
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
    edge_nm: Annotated[Number, length_nm("logistic scale of the edges")] = 12.0,
    peak: Annotated[Number, share_of_light("transmittance of the band")] = 0.9,
    leak: Annotated[Number, share_of_light("transmittance in the infrared")] = 0.95,
    floor: Annotated[Number, share_of_light("transmittance between them")] = 0.02,
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
    grid: Grid, *, edge_nm: Number = 655.0, width_nm: _EdgeWidth = 8.0
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
    name = check.one_of("filter", name, (*measured, "ircut-650", *others))
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
    need = "must have numbers after ircut-, as ircut-650/8 [nm]"
    found = f"{text!r} of {name!r} is not a number"
    return check.number(text, "filter", need, value=name, found=found)


def logistic(at: Float[Array, " n"], middle: Number, scale: Number) -> Inexact[Array, "*m n"]:
    """The logistic edge 1 / (1 + exp(-(at - middle) / scale)), in a form that cannot overflow."""
    edge = np.subtract(at, middle, dtype=np.result_type(at, middle, scale))
    edge *= 0.5
    edge /= scale
    np.tanh(edge, out=edge)
    edge += 1.0
    edge *= 0.5
    return edge


MOST_REFLECTANCE = 0.9999
"""Highest reflectance of a mirror: a finesse of 31,000. [1]"""
LEAK_EDGE_NM = 24.0
"""Logistic scale with which a dye becomes transparent again, as that of `resin_filter`. [nm]"""


def gaussian_filter(
    grid: Grid,
    *,
    center_nm: Annotated[Number, wavelength_at_nm("wavelength of the peak")],
    width_nm: Annotated[Number, length_nm("standard deviation")],
    peak: _Peak = 1.0,
    floor: _Floor = 0.0,
    infrared_leak: _Leak = 0.0,
    leak_nm: _LeakFrom = 800.0,
) -> Inexact[Array, "*m n"]:
    """Transmittance of a passband with the shape of a Gaussian, with the infrared leak of a dye.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    center_nm
        Wavelength of the peak. [nm]
    width_nm
        Standard deviation; the full width at half maximum is 2.3548 times as much. [nm]
    peak, floor
        Transmittance at the peak and far from it. [1]
    infrared_leak
        Share of the light that the band stops and that passes in the infrared. [1]
    leak_nm
        Wavelength above which it passes. [nm]

    Raises
    ------
    InputError
        If a transmittance is not 0 to 1, or a length is not positive.

    Examples
    --------
    >>> green = gaussian_filter(Grid.uniform(500, 600, 50), center_nm=550, width_nm=50, peak=0.8)
    >>> green.round(3)                                      # exp(-1/2) = 0.607 on both sides
    array([0.485, 0.8  , 0.485])
    """
    center = per_candidate("center_nm", "nm", center_nm)
    width = per_candidate("width_nm", "nm", width_nm, least=LEAST_LENGTH_NM)
    shape = np.subtract(grid.wavelength_nm, center, dtype=np.result_type(center, width))
    shape = shape * (math.sqrt(0.5) / width)  # a fixed center has fewer rows than a free width
    np.square(shape, out=shape)
    np.negative(shape, out=shape)
    np.exp(shape, out=shape)
    return _leaking(grid, shape, peak, floor, infrared_leak, leak_nm)


def raised_cosine_filter(
    grid: Grid,
    *,
    center_nm: Annotated[Number, wavelength_at_nm("wavelength of the peak")],
    fwhm_nm: Annotated[Number, length_nm("full width at half maximum")],
    peak: _Peak = 1.0,
    floor: _Floor = 0.0,
    infrared_leak: _Leak = 0.0,
    leak_nm: _LeakFrom = 800.0,
) -> Inexact[Array, "*m n"]:
    """Transmittance of a passband with the shape of one period of a cosine: exactly 0 beside it.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    center_nm
        Wavelength of the peak. [nm]
    fwhm_nm
        Full width at half maximum; the band ends at this distance from the center. [nm]
    peak, floor, infrared_leak, leak_nm
        As for `gaussian_filter`.

    Raises
    ------
    InputError
        As for `gaussian_filter`.

    Examples
    --------
    >>> raised_cosine_filter(Grid.uniform(500, 600, 25), center_nm=550, fwhm_nm=50).round(3)
    array([0. , 0.5, 1. , 0.5, 0. ])
    """
    center = per_candidate("center_nm", "nm", center_nm)
    width = per_candidate("fwhm_nm", "nm", fwhm_nm, least=LEAST_LENGTH_NM)
    away = (grid.wavelength_nm - center) / width
    inside = (away.real > -1) & (away.real < 1)
    shape = np.where(inside, np.cos(0.5 * np.pi * np.where(inside, away, 0.0)), 0.0) ** 2
    return _leaking(grid, shape, peak, floor, infrared_leak, leak_nm)


def long_pass(
    grid: Grid,
    *,
    cuton_nm: Annotated[Number, wavelength_at_nm("wavelength of half transmittance")],
    width_nm: _EdgeWidth = 8.0,
) -> Inexact[Array, "*m n"]:
    """Transmittance of a long-pass filter: 0 below a logistic edge, 1 above it.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    cuton_nm
        Wavelength of half transmittance. [nm]
    width_nm
        Logistic scale, as that of `chromanoise.sensor.ir_cut`. [nm]

    Raises
    ------
    InputError
        If a length is not positive.

    Examples
    --------
    >>> long_pass(Grid.uniform(700, 900, 100), cuton_nm=800, width_nm=20).round(3)
    array([0.007, 0.5  , 0.993])
    """
    edge = per_candidate("cuton_nm", "nm", cuton_nm, least=LEAST_LENGTH_NM)
    scale = per_candidate("width_nm", "nm", width_nm, least=LEAST_LENGTH_NM)
    return logistic(grid.wavelength_nm, edge, scale)


def dual_band_filter(
    grid: Grid,
    *,
    cutoff_nm: Annotated[Number, wavelength_at_nm("wavelength at which the visible ends")],
    band_nm: Annotated[Number, wavelength_at_nm("center of the infrared band")],
    band_width_nm: Annotated[Number, length_nm("full width of the infrared band")],
    width_nm: Annotated[Number, length_nm("logistic scale of the edges")] = 8.0,
    band_peak: Annotated[Number, share_of_light("transmittance of the infrared band")] = 1.0,
) -> Inexact[Array, "*m n"]:
    """Transmittance of a dual-band filter: the visible up to a cutoff, and one infrared band.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    cutoff_nm
        Wavelength at which the visible ends. [nm]
    band_nm, band_width_nm
        Center and full width of the infrared band, between its two edges. [nm]
    width_nm
        Logistic scale of the three edges. [nm]
    band_peak
        Transmittance of the infrared band, if it is wide against its edges. [1]

    Raises
    ------
    InputError
        If a transmittance is not 0 to 1, or a length is not positive.

    Examples
    --------
    >>> dual_band_filter(
    ...     Grid.uniform(600, 900, 50), cutoff_nm=650, band_nm=850, band_width_nm=60, width_nm=4
    ... ).round(3)
    array([1.   , 0.5  , 0.   , 0.   , 0.007, 0.999, 0.007])
    """
    visible = ir_cut(grid, edge_nm=cutoff_nm, width_nm=width_nm)
    scale = per_candidate("width_nm", "nm", width_nm, least=LEAST_LENGTH_NM)
    center = per_candidate("band_nm", "nm", band_nm, least=LEAST_LENGTH_NM)
    half = 0.5 * per_candidate("band_width_nm", "nm", band_width_nm, least=LEAST_LENGTH_NM)
    at = grid.wavelength_nm
    band = logistic(at, center - half, scale) * logistic(-at, -center - half, scale)
    return visible + (1.0 - visible) * per_candidate("band_peak", "1", band_peak, most=1.0) * band


def fabry_perot_filter(
    grid: Grid,
    *,
    center_nm: Annotated[Number, wavelength_at_nm("wavelength of the peak")],
    reflectance: Annotated[
        Number, ModelNumber(unit="1", what="reflectance of each mirror", most=MOST_REFLECTANCE)
    ],
    order: Annotated[
        Number,
        ModelNumber(unit="1", what="order: number of half wavelengths in the cavity", least=0.5),
    ] = 1.0,
    peak: Annotated[Number, share_of_light("transmittance at the peak")] = 1.0,
) -> Inexact[Array, "*m n"]:
    """Transmittance of a Fabry-Perot cavity between two equal mirrors, by Airy's formula.

    T = peak / (1 + F sin^2(2 pi L / wavelength)), F = 4 R / (1 - R)^2, at normal incidence; the
    phase of the mirrors belongs to L.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    center_nm
        Wavelength of the peak of ``order``; the others are at ``order * center_nm / k``. [nm]
    reflectance
        R of each mirror; at most ``MOST_REFLECTANCE``. [1]
    order
        Half wavelengths in the cavity, whose optical thickness is L = order * center_nm / 2. [1]
    peak
        Transmittance at the peaks, below 1 for mirrors that absorb. [1]

    Raises
    ------
    InputError
        If a number is not possible.

    Notes
    -----
    Born & Wolf, Principles of Optics, 7th ed., 7.6.1. The finesse is pi sqrt(F) / 2.

    Examples
    --------
    >>> comb = fabry_perot_filter(Grid.uniform(400, 800, 100), center_nm=800, reflectance=0.5,
    ...                           order=2)
    >>> comb.round(3)               # orders 2 and 4 at 800 and 400 nm
    array([1.   , 0.266, 0.143, 0.17 , 1.   ])
    """
    center = per_candidate("center_nm", "nm", center_nm, least=LEAST_LENGTH_NM)
    mirror = per_candidate("reflectance", "1", reflectance, most=MOST_REFLECTANCE)
    half_waves = per_candidate("order", "1", order, least=0.5)
    top = per_candidate("peak", "1", peak, most=1.0)
    sine = np.sin(np.pi * half_waves * center / grid.wavelength_nm)
    return top / (1.0 + 4.0 * mirror / (1.0 - mirror) ** 2 * sine * sine)


def beer_lambert(transmittance: Float[Array, "*m n"], thickness: Number) -> Inexact[Array, "*m n"]:
    """Transmittance of a dye of another thickness or concentration: T^t, the density times t.

    Parameters
    ----------
    transmittance
        Of the dye as measured. [1]
    thickness
        Product of thickness and concentration over that of the measurement. [1]

    Raises
    ------
    InputError
        If a transmittance is not 0 to 1, or a thickness is negative.

    Examples
    --------
    >>> beer_lambert(np.array([0.0, 0.1, 0.5, 1.0]), 2.0)        # densities inf, 1, 0.301 and 0
    array([0.  , 0.01, 0.25, 1.  ])
    """
    measured = check.fraction("transmittance", "1", transmittance)
    times = per_candidate("thickness", "1", thickness)
    passes = measured > 0
    return np.where(passes, np.exp(times * np.log(np.where(passes, measured, 1.0))), 0.0)


def dye_of_bands(
    grid: Grid,
    *,
    band_nm: Annotated[Sequence[Number], wavelength_at_nm("center of an absorption band")],
    width_nm: Annotated[Sequence[Number], length_nm("standard deviation of the band")],
    density: Annotated[
        Sequence[Number], ModelNumber(unit="1", what="optical density at the center")
    ],
    thickness: Annotated[
        Number, ModelNumber(unit="1", what="relative thickness times concentration")
    ] = 1.0,
) -> Inexact[Array, "*m n"]:
    """Transmittance of a model dye: 10^-(thickness times a sum of Gaussian absorption bands).

    A dye whose bands lie in the visible is transparent in the infrared.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    band_nm, width_nm
        Center and standard deviation of each band. [nm]
    density
        Optical density of each band at its center, at thickness 1. [1]
    thickness
        Product of thickness and concentration, relative. [1]

    Raises
    ------
    InputError
        If a number is not possible, or the numbers of bands differ.

    Examples
    --------
    >>> dye_of_bands(Grid.uniform(500, 600, 50), band_nm=[550], width_nm=[50], density=[2]).round(3)
    array([0.061, 0.01 , 0.061])
    """
    check.same_length("bands", band_nm=len(band_nm), width_nm=len(width_nm), density=len(density))
    absorbance: Array | float = 0.0
    for center, width, strength in zip(band_nm, width_nm, density, strict=True):
        shape = gaussian_filter(grid, center_nm=center, width_nm=width)
        absorbance = absorbance + per_candidate("density", "1", strength) * shape
    return np.exp(-np.log(10.0) * per_candidate("thickness", "1", thickness) * absorbance)


def _leaking(
    grid: Grid,
    shape: Inexact[Array, "*m n"],
    peak: Number,
    floor: Number,
    infrared_leak: Number,
    leak_nm: Number,
) -> Inexact[Array, "*m n"]:
    """A passband of a shape within 0 to 1, between floor and peak, with its infrared leak."""
    bottom = per_candidate("floor", "1", floor, most=1.0)
    band = (per_candidate("peak", "1", peak, most=1.0) - bottom) * shape
    if bottom.any():
        band = band + bottom
    leak = per_candidate("infrared_leak", "1", infrared_leak, most=1.0)
    if not leak.any():
        return band
    start = per_candidate("leak_nm", "nm", leak_nm)
    return band + (1.0 - band) * leak * logistic(grid.wavelength_nm, start, LEAK_EDGE_NM)
