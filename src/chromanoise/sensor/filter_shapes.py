"""Transmittances of filters that can be made, as pure functions of the grid and few numbers.

Each number may be one, or one per candidate (m,); the result has the shape (n,) or (m, n). All are
analytic functions of their numbers, so that complex numbers give exact derivatives by the complex
step. Each transmittance is a mean or a product of values within 0 to 1, with weights within 0 to 1.
"""

import math
from collections.abc import Sequence

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Inexact
from chromanoise.sensor.filters import LEAST_LENGTH_NM, Number, ir_cut, logistic, per_candidate
from chromanoise.spectra import Grid

MOST_REFLECTANCE = 0.9999
"""Highest reflectance of a mirror: a finesse of 31,000. [1]"""
LEAK_EDGE_NM = 24.0
"""Logistic scale with which a dye becomes transparent again, as that of `resin_filter`. [nm]"""


def gaussian_filter(
    grid: Grid,
    *,
    center_nm: Number,
    width_nm: Number,
    peak: Number = 1.0,
    floor: Number = 0.0,
    infrared_leak: Number = 0.0,
    leak_nm: Number = 800.0,
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
    center_nm: Number,
    fwhm_nm: Number,
    peak: Number = 1.0,
    floor: Number = 0.0,
    infrared_leak: Number = 0.0,
    leak_nm: Number = 800.0,
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


def long_pass(grid: Grid, *, cuton_nm: Number, width_nm: Number = 8.0) -> Inexact[Array, "*m n"]:
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
    cutoff_nm: Number,
    band_nm: Number,
    band_width_nm: Number,
    width_nm: Number = 8.0,
    band_peak: Number = 1.0,
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
    center_nm: Number,
    reflectance: Number,
    order: Number = 1.0,
    peak: Number = 1.0,
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
        R of each mirror; at most `MOST_REFLECTANCE`. [1]
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
    measured = _check.fraction("transmittance", "1", transmittance)
    times = per_candidate("thickness", "1", thickness)
    passes = measured > 0
    return np.where(passes, np.exp(times * np.log(np.where(passes, measured, 1.0))), 0.0)


def dye_of_bands(
    grid: Grid,
    *,
    band_nm: Sequence[Number],
    width_nm: Sequence[Number],
    density: Sequence[Number],
    thickness: Number = 1.0,
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
    _check.same_length("bands", band_nm=len(band_nm), width_nm=len(width_nm), density=len(density))
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
