"""The CIE 1931 observer: its color-matching functions and the color axes that they span."""

from functools import cache

from chromanoise._check import Array, frozen
from chromanoise._shapes import Float
from chromanoise.spectra.curves import Spectra, on_grid
from chromanoise.spectra.grid import Grid
from chromanoise.spectra.metric import Metric, photons_per_unit
from chromanoise.spectra.tables import packaged_table
from chromanoise.units import LUMEN_PER_WATT, UM2_PER_M2, photons_per_joule

INFRARED_FROM_NM = 700.0
"""Longer wavelengths count as infrared: y-bar is below 0.5 % of its peak."""


@cache
def cie_1931_table() -> Spectra:
    """The 2-degree color-matching functions as the CIE tabulates them, 360-830 nm @1.

    Notes
    -----
    CIE 018:2019, https://doi.org/10.25039/CIE.DS.xvudnb9b.
    """
    return packaged_table("cie_1931")


@cache
def cie_1931(grid: Grid) -> Spectra:
    """The CIE 1931 observer on ``grid``; outside 360-830 nm it is zero, as the CIE defines it.

    Examples
    --------
    >>> cie_1931(Grid.uniform(400, 1050, 5)).values[31].round(4)    # 555 nm
    array([0.5121, 1.    , 0.0057])
    """
    return on_grid(cie_1931_table(), grid, beyond="zero")


@cache
def color_axes(grid: Grid, metric: Metric) -> Float[Array, "n 3"]:
    """H of eq. 5: H^T L is the color of the light L, with Y in lux.

    Parameters
    ----------
    grid
        The wavelengths of L.
    metric
        The unit in which L is a vector; see `chromanoise.spectra.metric`.

    Returns
    -------
    H
        Columns x, y, z. [lx per unit of L]

    Notes
    -----
    Clouet, Vaillant & Alleysson (CIC27, 2019), eq. 5, with the factor K_m delta-lambda so that
    Y is an illuminance. A common factor changes neither angles nor SNR.
    """
    lux_per_watt = LUMEN_PER_WATT * grid.step_nm * cie_1931(grid).values
    watt_per_unit = (
        photons_per_unit(grid, metric) * UM2_PER_M2 / photons_per_joule(grid.wavelength_nm)
    )
    return frozen(lux_per_watt * watt_per_unit[:, None])
