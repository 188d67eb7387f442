"""The models of filters by name, with the numbers that each takes."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from chromanoise._check import Array
from chromanoise.sensor.filter_shapes import gaussian_filter
from chromanoise.sensor.filters import (
    LEAST_LENGTH_NM,
    LEAST_LENGTH_UM,
    Number,
    ir_cut,
    resin_filter,
)
from chromanoise.spectra import Grid


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
    numbers
        Its numbers by name.
    transmittance
        The function of the grid and the numbers; (n,), or (m, n) for numbers of (m,).
    """

    what: str
    numbers: Mapping[str, ModelNumber]
    transmittance: Callable[..., Array]


def _length(what: str, default: float | None = None) -> ModelNumber:
    return ModelNumber(unit="nm", what=what, default=default, least=LEAST_LENGTH_NM)


def _share(what: str, default: float | None = None) -> ModelNumber:
    return ModelNumber(unit="1", what=what, default=default, most=1.0)


_BAND = {
    "peak": _share("highest transmittance", 1.0),
    "floor": _share("transmittance far from the band", 0.0),
    "infrared_leak": _share("share of the stopped light that passes in the infrared", 0.0),
    "leak_nm": _length("wavelength above which it passes", 800.0),
}


def _ir_cut(grid: Grid, *, cutoff_nm: Number, width_nm: Number) -> Array:
    return ir_cut(grid, edge_nm=cutoff_nm, width_nm=width_nm)


FILTER_MODELS: Mapping[str, FilterModel] = {
    "gaussian": FilterModel(
        what="a passband with the shape of a Gaussian",
        numbers={
            "center_nm": _length("wavelength of the peak"),
            "width_nm": _length("standard deviation"),
            **_BAND,
        },
        transmittance=gaussian_filter,
    ),
    "resin": FilterModel(
        what="a passband with logistic edges, transparent again in the infrared",
        numbers={
            "low_nm": _length("wavelength at which the band begins"),
            "high_nm": _length("wavelength at which the band ends"),
            "leak_nm": _length("wavelength above which it is transparent again"),
            "edge_nm": _length("logistic scale of the edges", 12.0),
            "peak": _share("transmittance of the band", 0.9),
            "leak": _share("transmittance in the infrared", 0.95),
            "floor": _share("transmittance between them", 0.02),
        },
        transmittance=resin_filter,
    ),
    "ir-cut": FilterModel(
        what="1 below a logistic edge, 0 above it",
        numbers={
            "cutoff_nm": _length("wavelength of half transmittance"),
            "width_nm": _length("logistic scale of the edge", 8.0),
        },
        transmittance=_ir_cut,
    ),
}
"""Models of filters by the names that a design gives them."""

SILICON_NUMBERS: Mapping[str, ModelNumber] = {
    "depth_um": ModelNumber(unit="um", what="collection depth", default=4.0, least=LEAST_LENGTH_UM)
}
"""Numbers of `silicon_qe` that a design may choose."""
