"""Color routers: optics over a tile of pixels that sort its light by wavelength.

A filter stops the light that its pixel does not want; a router sends it to a pixel of the same tile
that does. All channels share the light of the tile: the shares sum to 1 at most at each wavelength,
and the sensor is `stacked`, with the tile as its pixel.
"""

from collections.abc import Sequence
from functools import reduce

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Inexact
from chromanoise.errors import InputError
from chromanoise.sensor.filters import LEAST_LENGTH_NM, Number, logistic, per_candidate
from chromanoise.spectra import Grid


def router_shares(
    grid: Grid,
    *,
    collection: Inexact[Array, "*m p b"],
    crossing_nm: Sequence[Number],
    edge_nm: Number = 10.0,
) -> Inexact[Array, "*m n p"]:
    """Share of the light of a tile that reaches each channel.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    collection
        Share of the light of each of ``b`` bands that each channel collects; from short to long
        wavelengths. No band gives more than it has. [1]
    crossing_nm
        The b - 1 wavelengths at which one band passes into the next. [nm]
    edge_nm
        Logistic scale of these edges. [nm]

    Raises
    ------
    InputError
        If a share is negative, a band gives more than it has, or the numbers of bands differ.

    Examples
    --------
    >>> halves = np.array([[0.6, 0.3], [0.3, 0.6]])
    >>> router_shares(
    ...     Grid.uniform(500, 600, 50), collection=halves, crossing_nm=[550], edge_nm=5
    ... ).round(3)
    array([[0.6 , 0.3 ],
           [0.45, 0.45],
           [0.3 , 0.6 ]])
    """
    shares = np.asarray(collection)
    _check.same_length("bands", collection=shares.shape[-1], crossings_and_1=len(crossing_nm) + 1)
    _check.non_negative("collection", "1", shares.real)
    given = float(shares.real.sum(axis=-2).max())
    if given > 1 + 1e-12:
        raise InputError(
            "collection",
            "must give at most all light of each band",
            value=given,
            found=f"gives {given:.4g} of it",
            remedy="lower the efficiency",
        )
    scale = per_candidate("edge_nm", "nm", edge_nm, least=LEAST_LENGTH_NM)
    bands: list[Array] = []
    rest: Array = np.ones(grid.n)
    for crossing in crossing_nm:
        edge = per_candidate("crossing_nm", "nm", crossing, least=LEAST_LENGTH_NM)
        above = logistic(grid.wavelength_nm, edge, scale)
        bands.append(rest * (1.0 - above))
        rest = rest * above
    bands.append(rest)
    terms = (band[..., None] * shares[..., None, :, i] for i, band in enumerate(bands))
    return reduce(np.add, terms)


def router_collection(
    selectivity: Sequence[Number], efficiency: Number
) -> Inexact[Array, "*m p p"]:
    """The collection of a router with one band per channel.

    Parameters
    ----------
    selectivity
        Of each band, the share of the collected light that reaches its own channel; the others
        receive equal parts of the rest. [1]
    efficiency
        Share of the light of the tile that is collected. [1]

    Raises
    ------
    InputError
        If a number is not 0 to 1, or there is one channel only.

    Examples
    --------
    >>> router_collection([0.8, 0.5, 0.8], 0.5)
    array([[0.4  , 0.125, 0.05 ],
           [0.05 , 0.25 , 0.05 ],
           [0.05 , 0.125, 0.4  ]])
    """
    p = len(selectivity)
    if p < 2:
        raise InputError("channels of a router", "must be at least 2", value=p)
    own = [per_candidate("selectivity", "1", one, most=1.0) for one in selectivity]
    collected = per_candidate("efficiency", "1", efficiency, most=1.0)
    columns = [np.where(np.arange(p) == i, one, (1.0 - one) / (p - 1)) for i, one in enumerate(own)]
    return collected[..., None] * np.stack(np.broadcast_arrays(*columns), axis=-1)
