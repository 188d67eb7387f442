"""The models of filters by name, with their numbers: also stacks of thin films and color routers.

The transmittance of a stack is that of films without absorption, at normal incidence. The transfer
matrix of a film with the phase d is [[cos d, i sin d / n], [i n sin d, cos d]]. The product of such
matrices is [[a, i b], [i c, e]] with real a, b, c, e and a e + b c = 1. Only these four are
multiplied: the transmittance is then an analytic function of all thicknesses and indices, which
|t|^2 is not, and never above 1:

    1 / T = 1 + ((n0 a - ns e)^2 + (n0 ns b - c)^2) / (4 n0 ns).

The package `tmm` gives the same numbers (the tests compare them), but takes one wavelength of one
stack per call, and real thicknesses only, so that it has no complex step. For 12 films at 66
wavelengths it took 9,500 us per stack, 200 stacks by these functions 25 us each.

A color router is optics over a tile of pixels that sort its light by wavelength. A filter stops the
light that its pixel does not want; a router sends it to a pixel of the same tile that does. All
channels share the light of the tile: the shares sum to 1 at most at each wavelength, and the sensor
is `stacked`, with the tile as its pixel.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field, replace
from functools import reduce
from inspect import signature
from typing import Annotated

import numpy as np

from chromanoise.base import Array, Inexact, InputError, check, dataclass
from chromanoise.sensor.filters import (
    LEAST_LENGTH_NM,
    ModelNumber,
    Number,
    dual_band_filter,
    dye_of_bands,
    fabry_perot_filter,
    gaussian_filter,
    ir_cut,
    length_nm,
    logistic,
    long_pass,
    per_candidate,
    raised_cosine_filter,
    resin_filter,
    silicon_qe,
    wavelength_at_nm,
)
from chromanoise.spectra import Grid

LEAST_INDEX = 1.0
"""Lowest refractive index, that of vacuum. [1]"""
_PER_UM2 = 1e6  # nm^2 in um^2


def cauchy_index(grid: Grid, index: Number, dispersion_um2: Number) -> Inexact[Array, "*m n"]:
    """Refractive index n(wavelength) = A + B / wavelength^2 (Cauchy). [1]

    Parameters
    ----------
    grid
        Wavelengths of the result.
    index
        A, the index at long wavelengths. [1]
    dispersion_um2
        B; 0 for a constant index. [um^2]

    Raises
    ------
    InputError
        If A is below 1, or B is negative.

    Examples
    --------
    >>> cauchy_index(Grid.uniform(500, 1000, 500), 1.45, 0.0035).round(4)
    array([1.464 , 1.4535])
    """
    constant = per_candidate("refractive index", "1", index, least=LEAST_INDEX)
    dispersion = per_candidate("dispersion", "um^2", dispersion_um2)
    return constant + dispersion * _PER_UM2 / grid.wavelength_nm**2


def thin_film_stack(
    grid: Grid,
    *,
    thickness_nm: Sequence[Number],
    index: Sequence[Inexact[Array, "*m n"]],
    index_in: Number = 1.0,
    index_out: Number = 1.52,
) -> Inexact[Array, "*m n"]:
    """Transmittance of a stack of films without absorption, at normal incidence, into a substrate.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    thickness_nm
        Of each film, from the side of the light; 0 for a film that is left out. [nm]
    index
        Refractive index of each film at each wavelength, as by `cauchy_index`. [1]
    index_in, index_out
        Refractive indices before and behind the stack: air and glass. [1]

    Raises
    ------
    InputError
        If a thickness is negative, an index is below 1, or their numbers differ.

    Notes
    -----
    Born & Wolf, Principles of Optics, 7th ed., 1.6.2; Byrnes, arXiv:1603.02720 (`tmm`).

    Examples
    --------
    Glass alone reflects ((1.52 - 1) / (1.52 + 1))^2 = 4.26 %.

    >>> thin_film_stack(Grid.uniform(500, 600, 100), thickness_nm=[], index=[]).round(4)
    array([0.9574, 0.9574])
    """
    check.same_length("films", thickness_nm=len(thickness_nm), index=len(index))
    before = per_candidate("index_in", "1", index_in, least=LEAST_INDEX)
    behind = per_candidate("index_out", "1", index_out, least=LEAST_INDEX)
    wavenumber = 2.0 * np.pi / grid.wavelength_nm
    a = e = np.ones(grid.n)
    b = c = np.zeros(grid.n)
    for thickness, n in zip(thickness_nm, index, strict=True):
        phase = per_candidate("thickness_nm", "nm", thickness) * n * wavenumber
        cosine, sine = np.cos(phase), np.sin(phase)
        up, down = n * sine, sine / n
        a, b, c, e = (
            a * cosine - b * up,
            a * down + b * cosine,
            c * cosine + e * up,
            e * cosine - c * down,
        )
    reflected = (before * a - behind * e) ** 2 + (before * behind * b - c) ** 2
    return 1.0 / (1.0 + reflected / (4.0 * before * behind))


def _index(what: str) -> ModelNumber:
    return ModelNumber(unit="1", what=what, least=LEAST_INDEX)


def _cauchy_b(which: str) -> ModelNumber:
    return ModelNumber(unit="um^2", what=f"Cauchy's B of the {which} material")


def alternating_stack(
    grid: Grid,
    *,
    thickness_nm: Annotated[Sequence[Number], ModelNumber(unit="nm", what="thickness of a film")],
    index_high: Annotated[Number, _index("index of the first material")] = 2.3,
    dispersion_high_um2: Annotated[Number, _cauchy_b("first")] = 0.0,
    index_low: Annotated[Number, _index("index of the second material")] = 1.46,
    dispersion_low_um2: Annotated[Number, _cauchy_b("second")] = 0.0,
    index_in: Annotated[Number, _index("index before the stack")] = 1.0,
    index_out: Annotated[Number, _index("index behind the stack")] = 1.52,
) -> Inexact[Array, "*m n"]:
    """Transmittance of films of two materials in turn, that of the high index first.

    Parameters
    ----------
    grid
        Wavelengths of the result.
    thickness_nm
        Of each film, from the side of the light. [nm]
    index_high, dispersion_high_um2, index_low, dispersion_low_um2
        The two materials, as for `cauchy_index`. [1], [um^2]
    index_in, index_out
        As for `thin_film_stack`.

    Raises
    ------
    InputError
        As for `thin_film_stack`.

    Examples
    --------
    A quarter wave of the index sqrt(1.52) at 550 nm: no reflection at this wavelength.

    >>> n = 1.52**0.5
    >>> coat = alternating_stack(
    ...     Grid.uniform(450, 650, 100), thickness_nm=[550 / 4 / n], index_high=n
    ... )
    >>> coat.round(4)
    array([0.9948, 1.    , 0.9975])
    """
    materials = (
        cauchy_index(grid, index_high, dispersion_high_um2),
        cauchy_index(grid, index_low, dispersion_low_um2),
    )
    return thin_film_stack(
        grid,
        thickness_nm=thickness_nm,
        index=[materials[i % 2] for i in range(len(thickness_nm))],
        index_in=index_in,
        index_out=index_out,
    )


def router_shares(
    grid: Grid,
    *,
    collection: Inexact[Array, "*m p b"],
    crossing_nm: Sequence[Number],
    edge_nm: Annotated[Number, length_nm("logistic scale between bands")] = 10.0,
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
    check.same_length("bands", collection=shares.shape[-1], crossings_and_1=len(crossing_nm) + 1)
    check.non_negative("collection", "1", shares.real)
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


MOST_REPEATED = 100
"""Most films of a stack, or bands of a dye."""


@dataclass(frozen=True, kw_only=True)
class FilterModel:
    """A filter that can be made, with its numbers.

    Attributes
    ----------
    what
        What it models, in one phrase.
    transmittance
        The function of the grid and the numbers; (n,), or (m, n) for numbers of (m,). A repeated
        number is passed as the list of its values.
    numbers
        Its numbers by name.
    repeated
        Numbers that each film or band has: ``thickness_nm`` stands for ``thickness_1_nm``,
        ``thickness_2_nm`` and so on.
    """

    what: str
    transmittance: Callable[..., Array]
    numbers: Mapping[str, ModelNumber] = field(default_factory=dict)
    repeated: Mapping[str, ModelNumber] = field(default_factory=dict)

    def numbers_for(self, given: Iterable[str]) -> dict[str, ModelNumber]:
        """All numbers of a filter for which some are given: as many films or bands as are named.

        Parameters
        ----------
        given
            Names of the numbers that are given.

        Raises
        ------
        InputError
            If more than ``MOST_REPEATED`` films or bands are named.
        """
        named = set(given)
        count = 1
        while any(_nth(name, count + 1) in named for name in self.repeated):
            count += 1
        if count > MOST_REPEATED:
            raise InputError(
                "films or bands",
                f"must be at most {MOST_REPEATED}",
                value=count,
                remedy="give fewer",
            )
        each = {
            _nth(name, i): number
            for i in range(1, count + 1)
            for name, number in self.repeated.items()
        }
        return {**self.numbers, **each}

    def of(self, grid: Grid, numbers: Mapping[str, Number]) -> Array:
        """The transmittance for the numbers of `numbers_for`, by name; (n,) or (m, n).

        Parameters
        ----------
        grid
            Wavelengths of the result.
        numbers
            All numbers of the filter.
        """
        single: dict[str, Number | Sequence[Number]] = {
            name: numbers[name] for name in self.numbers
        }
        count = len(numbers) - len(self.numbers)
        for name in self.repeated:
            each = range(1, count // len(self.repeated) + 1)
            single[name] = [numbers[_nth(name, i)] for i in each]
        return self.transmittance(grid, **single)


def _nth(name: str, i: int) -> str:
    """The name of the i-th of a repeated number: ``density_2``, ``thickness_2_nm``."""
    stem, _, unit = name.rpartition("_")
    return f"{stem}_{i}_{unit}" if stem else f"{name}_{i}"


def declared_numbers(function: Callable[..., Array]) -> dict[str, ModelNumber]:
    """The numbers that a function declares at its parameters, with their defaults.

    Parameters
    ----------
    function
        With parameters whose type is ``Annotated`` with a `ModelNumber`.
    """
    found = {}
    for name, one in signature(function).parameters.items():
        for number in getattr(one.annotation, "__metadata__", ()):
            default = number.default if one.default is one.empty else float(one.default)
            found[name] = replace(number, default=default)
    return found


def _model(
    what: str, *functions: Callable[..., Array], repeated: Sequence[str] = ()
) -> FilterModel:
    """A filter by the first of the functions, which passes other numbers on to the next."""
    numbers = {name: one for each in functions for name, one in declared_numbers(each).items()}
    return FilterModel(
        what=what,
        transmittance=functions[0],
        numbers={name: one for name, one in numbers.items() if name not in repeated},
        repeated={name: numbers[name] for name in repeated},
    )


def _resin(
    grid: Grid,
    *,
    low_nm: Annotated[Number, wavelength_at_nm("wavelength at which the band begins")],
    band_width_nm: Annotated[Number, length_nm("full width of the band")],
    gap_nm: Annotated[
        Number,
        ModelNumber(unit="nm", what="distance from the end of the passband to the infrared edge"),
    ],
    **others: Number,
) -> Array:
    """`resin_filter` by distances, so that no choice of numbers puts its edges out of order."""
    high_nm = low_nm + band_width_nm
    return resin_filter(grid, low_nm=low_nm, high_nm=high_nm, leak_nm=high_nm + gap_nm, **others)


def _ir_cut(
    grid: Grid,
    *,
    cutoff_nm: Annotated[Number, wavelength_at_nm("wavelength of half transmittance")],
    **others: Number,
) -> Array:
    return ir_cut(grid, edge_nm=cutoff_nm, **others)


FILTER_MODELS: Mapping[str, FilterModel] = {
    "gaussian": _model("a passband with the shape of a Gaussian", gaussian_filter),
    "raised-cosine": _model(
        "a passband with the shape of one period of a cosine", raised_cosine_filter
    ),
    "resin": _model(
        "a passband with logistic edges, transparent again in the infrared", _resin, resin_filter
    ),
    "dye-bands": _model(
        "a dye with Gaussian absorption bands",
        dye_of_bands,
        repeated=("band_nm", "width_nm", "density"),
    ),
    "fabry-perot": _model("a cavity between two mirrors (Airy)", fabry_perot_filter),
    "thin-film": _model(
        "a stack of films of two alternating materials, the high index first",
        alternating_stack,
        repeated=("thickness_nm",),
    ),
    "ir-cut": _model("1 below a logistic edge, 0 above it", _ir_cut, ir_cut),
    "long-pass": _model("0 below a logistic edge, 1 above it", long_pass),
    "dual-band": _model("a passband for visible light and one infrared band", dual_band_filter),
}
"""The filters that can be made, by name."""

SILICON_NUMBERS: Mapping[str, ModelNumber] = declared_numbers(silicon_qe)
"""Numbers of `chromanoise.sensor.silicon_qe`."""
