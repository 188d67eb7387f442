"""The unit of spectra as vectors: radiant power or photons.

Eq. 5 applies color-matching functions, which are defined for radiant power, to the spectrum of
eq. 4. Two consistent choices exist. They give different dual bases, kernels and contravariant
coordinates, so every result records which one was used:

========== ============================ ==================== =======================
metric     light L                      sensor f             color axes H
========== ============================ ==================== =======================
``energy`` [W m-2 nm-1]                 k QE lambda / (h c)  K_m CMF
``quanta`` [photons s-1 um-2 nm-1]      k QE                 K_m CMF h c / lambda
========== ============================ ==================== =======================

Both metrics give the same number of electrons F^T L and the same illuminance H^T L.
"""

from typing import Literal, get_args

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.spectra.grid import Grid
from chromanoise.units import UM2_PER_M2, photons_per_joule

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
    _check.one_of("metric", metric, METRICS)
    if metric == "quanta":
        return np.ones(grid.n)
    return photons_per_joule(grid.wavelength_nm) / UM2_PER_M2
