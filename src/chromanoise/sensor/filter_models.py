"""The models of filters by name, with the numbers that each takes."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from inspect import signature

from chromanoise._check import Array
from chromanoise.errors import InputError
from chromanoise.sensor.filter_shapes import (
    MOST_REFLECTANCE,
    dual_band_filter,
    dye_of_bands,
    fabry_perot_filter,
    gaussian_filter,
    long_pass,
    raised_cosine_filter,
)
from chromanoise.sensor.filters import (
    LEAST_LENGTH_NM,
    LEAST_LENGTH_UM,
    Number,
    ir_cut,
    resin_filter,
    silicon_qe,
)
from chromanoise.sensor.thin_film import LEAST_INDEX, alternating_stack
from chromanoise.spectra import Grid

MOST_REPEATED = 100
"""Most films of a stack, or bands of a dye."""


@dataclass(frozen=True, slots=True, kw_only=True)
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
        What is possible.
    """

    unit: str
    what: str
    default: float | None = None
    least: float = 0.0
    most: float = math.inf


@dataclass(frozen=True, slots=True, kw_only=True)
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
            Names of numbers.

        Raises
        ------
        InputError
            If more than `MOST_REPEATED` films or bands are named.
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


def with_defaults(
    function: Callable[..., Array], numbers: Mapping[str, ModelNumber]
) -> dict[str, ModelNumber]:
    """Numbers with the defaults that a function has for keywords of their names.

    Parameters
    ----------
    function
        With numbers as defaults.
    numbers
        By name; those for which the function has no default stay as they are.
    """
    defaults = {
        name: float(one.default)
        for name, one in signature(function).parameters.items()
        if one.default is not one.empty
    }
    return {
        name: replace(number, default=defaults.get(name, number.default))
        for name, number in numbers.items()
    }


def _model(
    what: str,
    transmittance: Callable[..., Array],
    numbers: Mapping[str, ModelNumber],
    repeated: Mapping[str, ModelNumber] | None = None,
    defaults_of: Callable[..., Array] | None = None,
) -> FilterModel:
    return FilterModel(
        what=what,
        transmittance=transmittance,
        numbers=with_defaults(defaults_of or transmittance, numbers),
        repeated=repeated or {},
    )


def _length(what: str) -> ModelNumber:
    return ModelNumber(unit="nm", what=what, least=LEAST_LENGTH_NM)


def _share(what: str) -> ModelNumber:
    return ModelNumber(unit="1", what=what, most=1.0)


def _index(what: str) -> ModelNumber:
    return ModelNumber(unit="1", what=what, least=LEAST_INDEX)


def _dispersion(what: str) -> ModelNumber:
    return ModelNumber(unit="um^2", what=what)


_BAND = {
    "peak": _share("highest transmittance"),
    "floor": _share("transmittance far from the band"),
    "infrared_leak": _share("share of the stopped light that passes in the infrared"),
    "leak_nm": _length("wavelength above which it passes"),
}


def _resin(
    grid: Grid, *, low_nm: Number, band_width_nm: Number, gap_nm: Number, **others: Number
) -> Array:
    """`resin_filter` by distances, so that no choice of numbers puts its edges out of order."""
    high_nm = low_nm + band_width_nm
    return resin_filter(grid, low_nm=low_nm, high_nm=high_nm, leak_nm=high_nm + gap_nm, **others)


def _ir_cut(grid: Grid, *, cutoff_nm: Number, width_nm: Number) -> Array:
    return ir_cut(grid, edge_nm=cutoff_nm, width_nm=width_nm)


FILTER_MODELS: Mapping[str, FilterModel] = {
    "gaussian": _model(
        what="a passband with the shape of a Gaussian",
        transmittance=gaussian_filter,
        numbers={
            "center_nm": _length("wavelength of the peak"),
            "width_nm": _length("standard deviation"),
            **_BAND,
        },
    ),
    "raised-cosine": _model(
        what="a passband with the shape of one period of a cosine",
        transmittance=raised_cosine_filter,
        numbers={
            "center_nm": _length("wavelength of the peak"),
            "fwhm_nm": _length("full width at half maximum"),
            **_BAND,
        },
    ),
    "resin": _model(
        what="a passband with logistic edges, transparent again in the infrared",
        transmittance=_resin,
        defaults_of=resin_filter,
        numbers={
            "low_nm": _length("wavelength at which the band begins"),
            "band_width_nm": _length("full width of the band"),
            "gap_nm": ModelNumber(
                unit="nm", what="distance from the end of the passband to the infrared edge"
            ),
            "edge_nm": _length("logistic scale of the edges"),
            "peak": _share("transmittance of the band"),
            "leak": _share("transmittance in the infrared"),
            "floor": _share("transmittance between them"),
        },
    ),
    "dye-bands": _model(
        what="a dye with Gaussian absorption bands",
        transmittance=dye_of_bands,
        numbers={"thickness": ModelNumber(unit="1", what="relative thickness times concentration")},
        repeated={
            "band_nm": _length("center of an absorption band"),
            "width_nm": _length("standard deviation of the band"),
            "density": ModelNumber(unit="1", what="optical density at the center"),
        },
    ),
    "fabry-perot": _model(
        what="a cavity between two mirrors (Airy)",
        transmittance=fabry_perot_filter,
        numbers={
            "center_nm": _length("wavelength of the peak"),
            "reflectance": ModelNumber(
                unit="1", what="reflectance of each mirror", most=MOST_REFLECTANCE
            ),
            "order": ModelNumber(
                unit="1", what="order: number of half wavelengths in the cavity", least=0.5
            ),
            "peak": _share("transmittance at the peak"),
        },
    ),
    "thin-film": _model(
        what="a stack of films of two alternating materials, the high index first",
        transmittance=alternating_stack,
        numbers={
            "index_high": _index("index of the first material"),
            "dispersion_high_um2": _dispersion("Cauchy's B of the first material"),
            "index_low": _index("index of the second material"),
            "dispersion_low_um2": _dispersion("Cauchy's B of the second material"),
            "index_in": _index("index before the stack"),
            "index_out": _index("index behind the stack"),
        },
        repeated={"thickness_nm": ModelNumber(unit="nm", what="thickness of a film")},
    ),
    "ir-cut": _model(
        what="1 below a logistic edge, 0 above it",
        transmittance=_ir_cut,
        defaults_of=ir_cut,
        numbers={
            "cutoff_nm": _length("wavelength of half transmittance"),
            "width_nm": _length("logistic scale of the edge"),
        },
    ),
    "long-pass": _model(
        what="0 below a logistic edge, 1 above it",
        transmittance=long_pass,
        numbers={
            "cuton_nm": _length("wavelength of half transmittance"),
            "width_nm": _length("logistic scale of the edge"),
        },
    ),
    "dual-band": _model(
        what="a passband for visible light and one infrared band",
        transmittance=dual_band_filter,
        numbers={
            "cutoff_nm": _length("wavelength at which the visible ends"),
            "band_nm": _length("center of the infrared band"),
            "band_width_nm": _length("full width of the infrared band"),
            "width_nm": _length("logistic scale of the edges"),
            "band_peak": _share("transmittance of the infrared band"),
        },
    ),
}
"""Models of filters by the names that a design gives them."""

SILICON_NUMBERS: Mapping[str, ModelNumber] = with_defaults(
    silicon_qe,
    {
        "depth_um": ModelNumber(
            unit="um", what="collection depth", default=4.0, least=LEAST_LENGTH_UM
        ),
        "dead_layer_um": ModelNumber(unit="um", what="depth whose carriers are lost"),
        "reflectance": _share("share of the light that the surface reflects"),
    },
)
"""Numbers of `chromanoise.sensor.silicon_qe`."""
