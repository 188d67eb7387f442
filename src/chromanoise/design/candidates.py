"""The arrays of many sensors that a batched evaluation reads, and the noise of their pixels."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from functools import cache
from types import MappingProxyType, SimpleNamespace
from typing import Any, get_args

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Inexact
from chromanoise.properties import Property
from chromanoise.sensor import PIXEL, Sensor, quantization_step_e
from chromanoise.sensor.noise_source import Term, sources_of


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidates:
    """``m`` sensors with ``p`` channels on one grid, with their exposure, pixel and matrix.

    All arrays may be complex, for derivatives by the complex step.

    Attributes
    ----------
    qe
        Electrons per photon, filters and crosstalk before counting included. [e-/photon]
    time_s
        Exposure time of each; ``None`` where all have that of the scene. [s]
    pixel_share
        Share of the pixels of the mosaic that each channel has; each row has the sum 1. The
        variance of channel i is divided by ``p * pixel_share[i]``. ``None``: equal shares, as in
        the paper. [1]
    noise_weight
        Weight of the noise in the color matrix: 0 least squares, 1 LMMSE; ``None`` where the matrix
        of the scene decides. [1]
    pixel
        Noise of the pixel of each, by names of `noise_properties`, as the fields of `Pixel`; what
        is omitted is that of the scene.

    Raises
    ------
    InputError
        If the pixel has no noise of such a name.
    """

    qe: Inexact[Array, "m n p"]
    time_s: Inexact[Array, " m"] | None = None
    pixel_share: Inexact[Array, "m p"] | None = None
    noise_weight: Inexact[Array, " m"] | None = None
    pixel: Mapping[str, Inexact[Array, " m"]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        refuse_other_noise(self.pixel)

    def __len__(self) -> int:
        return len(self.qe)

    def some(self, which: Any) -> "Candidates":
        """Some of the candidates.

        Parameters
        ----------
        which
            An index of numpy.
        """
        given = {name: getattr(self, name) for name in _ARRAYS}
        some: dict[str, Any] = {k: None if v is None else v[which] for k, v in given.items()}
        return Candidates(**some, pixel={name: v[which] for name, v in self.pixel.items()})

    @property
    def dtype(self) -> np.dtype:
        """Complex if an array is, otherwise float64."""
        arrays = [*(getattr(self, name) for name in _ARRAYS), *self.pixel.values()]
        return np.result_type(np.float64, *(one for one in arrays if one is not None))


_ARRAYS = ("qe", "time_s", "pixel_share", "noise_weight")


@cache
def noise_properties() -> Mapping[str, Property]:
    """The properties of a pixel that change the variance of a reading, and of which 0 is none.

    By name, in the order of `Pixel`. Each can be a number of a design.
    """
    return MappingProxyType({name: one for name, one in PIXEL.items() if one.least == 0.0})


def refuse_other_noise(names: Iterable[str]) -> None:
    """Refuse a name that is none of `noise_properties`.

    Raises
    ------
    InputError
        If there is one.
    """
    for name in names:
        _check.one_of("number of the pixel", name, tuple(noise_properties()))


def noise_of(
    sensor: Sensor, time_s: Inexact[Array, " m"], pixel: Mapping[str, Inexact[Array, " m"]]
) -> Inexact[Array, "4 m"]:
    """The law of the variance of each candidate, and its dark electrons.

    Parameters
    ----------
    sensor
        Its converter, and the noise of its pixel that ``pixel`` does not have.
    time_s
        Exposure time of each candidate. [s]
    pixel
        Noise of the pixel of each candidate, by name.

    Returns
    -------
    Array
        ``floor_e2``, ``slope_e`` and ``square`` of `chromanoise.sensor.VarianceLaw`, and the mean
        number of dark electrons [e-]: complex where an argument is.
    """
    own = {one.name: getattr(sensor.pixel, one.name) for one in fields(sensor.pixel)}
    known = SimpleNamespace(**own | dict(pixel), temperature_k=sensor.pixel.temperature_k)
    dark_e = known.dark_current_e_per_s * sensor.pixel.temperature_factor * time_s
    step_e = quantization_step_e(sensor.converter, sensor.pixel)
    of: Any = SimpleNamespace(pixel=known, dark_e=dark_e, step_e=step_e)  # arrays for numbers
    sources = sources_of(sensor.pixel)
    law = (sum(one.value(of) for one in sources if one.term == term) for term in get_args(Term))
    return np.array(np.broadcast_arrays(*law, dark_e))
