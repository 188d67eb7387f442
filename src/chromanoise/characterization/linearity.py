"""Deviation of the mean from a straight line over the light, as EMVA 1288 defines it."""

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float

_LOWEST, _HIGHEST = 0.05, 0.95  # of saturation, between which the line is fitted


def linearity(
    signal_dn: Float[Array, " m"], light: Float[Array, " m"], saturation_dn: float | None
) -> tuple[Float[Array, " m"], Float[Array, " m"]] | None:
    """The line and the deviation from it; ``None`` with fewer than three levels of light.

    Parameters
    ----------
    signal_dn
        Mean above dark. [DN]
    light
        Photons, or exposure times. [1] or [ms]
    saturation_dn
        Mean above dark at saturation; ``None`` where no level is saturated. [DN]

    Returns
    -------
    tuple
        The line [DN], and the deviation [%], NaN outside 5 to 95 % of saturation.

    Notes
    -----
    EMVA Standard 1288, release 4.0 Linear, chapter 6: least squares of the relative deviations,
    with the weights 1 / signal^2. Without saturation, up to the brightest level.
    """
    top = float(signal_dn.max()) / _HIGHEST if saturation_dn is None else saturation_dn
    used = (signal_dn >= _LOWEST * top) & (signal_dn <= _HIGHEST * top * (1 + 1e-9))
    if np.unique(light[used]).size < 3:
        return None
    weight, at = 1 / signal_dn[used] ** 2, light[used]
    center = (weight @ at) / weight.sum()
    mean = (weight @ signal_dn[used]) / weight.sum()
    offset = at - center
    slope = (weight * offset) @ (signal_dn[used] - mean) / (weight @ offset**2)
    line = mean + slope * (light - center)
    deviation = np.full_like(signal_dn, np.nan)
    deviation[used] = 100 * (signal_dn[used] - line[used]) / line[used]
    return line, deviation
