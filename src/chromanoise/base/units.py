"""Physical constants and unit conversions: photons, lux, decibel."""

import numpy as np

from chromanoise.base.check import Array
from chromanoise.base.shapes import Float

PLANCK_J_S = 6.62607015e-34
"""Planck constant, exact (SI 2019)."""
LIGHT_M_PER_S = 299_792_458.0
"""Speed of light in vacuum, exact."""
BOLTZMANN_J_PER_K = 1.380649e-23
"""Boltzmann constant, exact (SI 2019)."""
LUMEN_PER_WATT = 683.002
"""Maximum luminous efficacy at the peak of y-bar (CIE 018:2019: 683 lm/W at 540 THz in air)."""
UM2_PER_M2 = 1e12
"""Square micrometers in a square meter. [um^2/m^2]"""


def photons_per_joule(wavelength_nm: Float[Array, " n"]) -> Float[Array, " n"]:
    """Photons carried by one joule of light: lambda / (h c). [photon/J]

    Parameters
    ----------
    wavelength_nm
        Vacuum wavelengths. [nm]

    Examples
    --------
    >>> float(round(photons_per_joule(np.array([555.0]))[0] / 1e18, 4))
    2.7939
    """
    return wavelength_nm * 1e-9 / (PLANCK_J_S * LIGHT_M_PER_S)


def decibel(ratio: Float[Array, "*any"]) -> Float[Array, "*any"]:
    """20 log10 of an amplitude ratio; a ratio of 0 is -inf. [dB]

    Parameters
    ----------
    ratio
        Amplitude ratio, >= 0. [1]

    Examples
    --------
    >>> decibel(np.array([1.0, 10.0, 0.0]))
    array([  0.,  20., -inf])
    """
    with np.errstate(divide="ignore"):
        return np.asarray(20.0 * np.log10(ratio))


def from_decibel(level_db: Float[Array, "*any"]) -> Float[Array, "*any"]:
    """Amplitude ratio of a level in dB. [1]

    Parameters
    ----------
    level_db
        The level. [dB]

    Examples
    --------
    >>> from_decibel(np.array([20.0]))
    array([10.])
    """
    return np.asarray(np.power(10.0, np.asarray(level_db) / 20.0))
