"""The arrays of many sensors that a batched evaluation reads, and the noise of their pixels."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Inexact
from chromanoise.exposure import Exposure
from chromanoise.noise import noise_sources
from chromanoise.properties import Property
from chromanoise.sensor import PAPER_PIXEL, PIXEL, Converter, Sensor
from chromanoise.spectra import Grid


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
    grid = Grid(start_nm=500.0, stop_nm=600.0, step_nm=100.0)
    one = Sensor(name="one", grid=grid, qe=np.ones((2, 1)), names=("one",), pixel=PAPER_PIXEL)
    known = {name: of for name, of in PIXEL.items() if of.least == 0.0 and _added(one, name).any()}
    return MappingProxyType(known)


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

    Notes
    -----
    Sources of noise are independent, so their laws add up. Each is at most quadratic in its
    property of the pixel and linear in the time, so `chromanoise.noise.noise_sources` at two values
    and two times gives it for all, exactly.
    """
    total, added = _fixed_and_free(sensor, tuple(pixel))
    for name, x in pixel.items():
        linear, squared = added[name]
        total = total + (linear * x + squared * (x * x))
    return np.asarray(total[:, 0] + total[:, 1] * time_s)


@lru_cache(maxsize=256)
def _fixed_and_free(
    sensor: Sensor, free: tuple[str, ...]
) -> tuple[Float[Array, "4 2 1"], Mapping[str, Float[Array, "2 4 2 1"]]]:
    """The noise without some of its properties, and what a unit of each of them adds."""
    none = dict.fromkeys(noise_properties(), 0.0)
    quiet = replace(sensor, pixel=replace(sensor.pixel, **none))
    exact = replace(quiet, converter=Converter())  # without digits of its step
    added = {name: _added(exact, name)[..., None] for name in none}
    total = _over_time(quiet)[..., None]
    for name in none:
        if name not in free:
            linear, squared = added[name]
            value = getattr(sensor.pixel, name)
            total = total + (linear * value + squared * (value * value))
    return total, {name: added[name] for name in free}


def _added(sensor: Sensor, name: str) -> Float[Array, "2 4 2"]:
    """What a property of the pixel adds, per unit and per squared unit."""
    step = 2.0 ** math.floor(math.log2(min(PIXEL[name].most, 1.0)) - 1)  # exact in products
    none, one, two = (
        _over_time(replace(sensor, pixel=replace(sensor.pixel, **{name: k * step})))
        for k in range(3)
    )
    one, two = one - none, (two - none) / 2
    return np.stack([(2 * one - two) / step, (two - one) / step**2])


def _over_time(sensor: Sensor) -> Float[Array, "4 2"]:
    """`noise_of` at 0 s, and what a second adds."""
    sources = [noise_sources(sensor, Exposure(time_s=time_s)) for time_s in (1.0, 2.0)]
    laws = [(one.law(), one.dark_e) for one in sources]
    one, two = np.array([(a.floor_e2, a.slope_e, a.square, dark_e) for a, dark_e in laws])
    return np.stack([2 * one - two, two - one], axis=1)
