"""Spaces of sensors that can be made: filters, silicon, mosaic and exposure with free numbers."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float, Inexact
from chromanoise.design.candidates import Candidates
from chromanoise.design.parameters import Free, Parameter, Value, refuse_outside, tied_to
from chromanoise.errors import InputError
from chromanoise.sensor import Sensor
from chromanoise.sensor.filter_models import (
    FILTER_MODELS,
    SILICON_NUMBERS,
    FilterModel,
    ModelNumber,
)
from chromanoise.sensor.filters import Number, silicon_qe
from chromanoise.spectra import Grid

MOST_CHANNELS = 16
_BLOCK = 256  # candidates whose curves fit into a processor's cache


@dataclass(frozen=True, slots=True, kw_only=True)
class Filter:
    """One filter of a design: a model and its numbers.

    Attributes
    ----------
    model
        A name of `chromanoise.sensor.filter_models.FILTER_MODELS`.
    numbers
        Fixed, free or tied numbers of the model by name; what is omitted has its default.
    """

    model: str
    numbers: Mapping[str, Value] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """One channel of a design.

    Attributes
    ----------
    name
        Its name; its numbers are ``NAME.center_nm`` and so on.
    filter
        The filter on its pixels; ``None`` for none.
    ir_cut
        A second filter on its pixels, with numbers ``NAME.ir_cut.cutoff_nm`` and so on.
    base
        The channel of the base sensor whose QE it has; ``None`` for silicon.
    """

    name: str
    filter: Filter | None = None
    ir_cut: Filter | None = None
    base: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DesignSpace:
    """Sensors of ``p`` channels that differ in ``d`` free numbers.

    The QE of a channel is that of silicon, or of a channel of the base sensor, times the
    transmittances of its filters and of the filter in front of all channels.

    Attributes
    ----------
    base
        Gives the grid, the pixel, and the curves of the channels that name one of its own.
    channels
        1 to 16 channels.
    ir_cut
        A filter in front of all channels, with numbers ``ir_cut.cutoff_nm`` and so on.
    silicon
        Numbers of `chromanoise.sensor.silicon_qe`: ``silicon.depth_um``.
    time_ms
        Exposure time, ``exposure.time_ms``; ``None`` for that of the scene. [ms]
    noise_weight
        Weight of the noise in the matrix, ``matrix.noise_weight``; ``None`` for that of the scene.
    parameters
        The free numbers, in the order of the coordinates of a search; made from all others.

    Raises
    ------
    InputError
        If a name is unknown or repeated, a number is missing or not possible, bounds are not in
        order, a tie leads nowhere or in a circle, or no number is free.
    """

    base: Sensor
    channels: tuple[Channel, ...]
    ir_cut: Filter | None = None
    silicon: Mapping[str, Value] = field(default_factory=dict)
    time_ms: Value | None = None
    noise_weight: Value | None = None
    parameters: tuple[Parameter, ...] = field(init=False)
    _numbers: Mapping[str, float | int] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        _refuse_channels(self.channels, self.base)
        given: dict[str, tuple[Value, ModelNumber]] = {}
        for place, numbers, known in self._parts():
            for name in numbers:
                if name not in known:
                    _check.one_of(f"number of {place}", name, tuple(known))
            for name, number in known.items():
                value = numbers.get(name, number.default)
                if value is None:
                    raise InputError(
                        f"{place}.{name}",
                        f"must be given: {number.what} [{number.unit}]",
                        found=None,
                        remedy="give a number to fix it, or bounds [low, high] to search it",
                    )
                given[f"{place}.{name}"] = (value, number)
        parameters, numbers_of = _resolved(given)
        object.__setattr__(self, "parameters", parameters)
        object.__setattr__(self, "_numbers", MappingProxyType(numbers_of))

    def _parts(self) -> Iterator[tuple[str, Mapping[str, Value], Mapping[str, ModelNumber]]]:
        """Place, given numbers and known numbers of each part, in the order of the parameters."""
        for channel in self.channels:
            for place, one in _filters_of(channel):
                yield place, one.numbers, _model(place, one).numbers
        if self.ir_cut is not None:
            yield "ir_cut", self.ir_cut.numbers, _model("ir_cut", self.ir_cut).numbers
        if any(channel.base is None for channel in self.channels):
            yield "silicon", self.silicon, SILICON_NUMBERS
        for place, name, value, number in (
            ("exposure", "time_ms", self.time_ms, _TIME),
            ("matrix", "noise_weight", self.noise_weight, _NOISE_WEIGHT),
        ):
            if value is not None:
                yield place, {name: value}, {name: number}

    @property
    def grid(self) -> Grid:
        """The wavelengths of all curves."""
        return self.base.grid

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the channels."""
        return tuple(channel.name for channel in self.channels)

    def number(self, name: str, values: Inexact[Array, "m d"]) -> Number:
        """A number of the design for each candidate, or once where it is fixed.

        Parameters
        ----------
        name
            Its full name, as ``R.center_nm``.
        values
            One row of free numbers per candidate.
        """
        found = self._numbers[name]
        return values[:, found] if isinstance(found, int) else found

    def curves(self, values: Inexact[Array, "m d"]) -> Inexact[Array, "m n p"]:
        """QE of the channels of each candidate, crosstalk before counting included. [e-/photon]

        Parameters
        ----------
        values
            One row of free numbers per candidate, in the order of `parameters`; complex numbers
            give complex curves, for derivatives by the complex step.

        Returns
        -------
        Array
            Within 0 to 1. The wavelengths of one channel are neighbors in memory.

        Raises
        ------
        InputError
            If a number is not possible.
        """
        values = self._checked(values)
        m, n, p = len(values), self.grid.n, len(self.channels)
        result = np.empty((m, p, n), dtype=values.dtype)
        for first in range(0, m, _BLOCK):
            rows = slice(first, first + _BLOCK)
            self._fill(values[rows], result[rows])
        return result.transpose(0, 2, 1)

    def _fill(self, values: Inexact[Array, "m d"], qe: Inexact[Array, "m p n"]) -> None:
        of = partial(self._transmittance, values)
        silicon: Number = 1.0
        if any(channel.base is None for channel in self.channels):
            depth_um = self.number("silicon.depth_um", values)
            silicon = silicon_qe(self.grid, depth_um=depth_um)
        front = of("ir_cut", self.ir_cut) if self.ir_cut is not None else 1.0
        bare = silicon * front
        for i, channel in enumerate(self.channels):
            own = bare
            if channel.base is not None:
                own = self.base.qe[:, self.base.names.index(channel.base)] * front
            for place, one in _filters_of(channel):
                own = own * of(place, one)
            qe[:, i] = own

    def _transmittance(
        self, values: Inexact[Array, "m d"], place: str, one: Filter
    ) -> Inexact[Array, "*m n"]:
        model = FILTER_MODELS[one.model]
        numbers = {name: self.number(f"{place}.{name}", values) for name in model.numbers}
        return model.transmittance(self.grid, **numbers)

    def candidates(self, values: Inexact[Array, "m d"]) -> Candidates:
        """The candidates as a batched evaluation reads them.

        Parameters
        ----------
        values
            As for `curves`.

        Raises
        ------
        InputError
            If a number is not possible.
        """
        values = self._checked(values)
        time_ms = self._each("exposure.time_ms", values)
        return Candidates(
            qe=self.curves(values),
            time_s=None if time_ms is None else time_ms / 1000.0,
            noise_weight=self._each("matrix.noise_weight", values),
        )

    def _each(self, name: str, values: Inexact[Array, "m d"]) -> Inexact[Array, " m"] | None:
        if name not in self._numbers:
            return None
        return np.broadcast_to(self.number(name, values), (len(values),))

    def sensor(self, values: Float[Array, " d"], *, name: str) -> Sensor:
        """One candidate as a sensor that all commands take; its notes say how it was made.

        Parameters
        ----------
        values
            Its free numbers.
        name
            Its name.

        Raises
        ------
        InputError
            If a number is not possible, or a channel has no QE.
        """
        row = np.asarray(values, dtype=np.float64)[None, :]
        return Sensor(
            name=name,
            grid=self.grid,
            qe=self.curves(row)[0],
            names=self.names,
            pixel=self.base.pixel,
            converter=self.base.converter,
            origin="model",
            notes=(f"designed: {self._told(row[0])}",),
        )

    def _told(self, values: Float[Array, " d"]) -> str:
        return ", ".join(
            f"{one.name} {value:.6g}" for one, value in zip(self.parameters, values, strict=True)
        )

    def _checked(self, values: Inexact[Array, "m d"]) -> Inexact[Array, "m d"]:
        array = np.asarray(values)
        if array.ndim != 2 or array.shape[1] != len(self.parameters):
            raise InputError(
                "values",
                f"must be (candidates, {len(self.parameters)}), one column per free number",
                value=array.shape,
                found=f"has shape {array.shape}",
            )
        return array


_TIME = ModelNumber(unit="ms", what="exposure time", least=1e-6)
_NOISE_WEIGHT = ModelNumber(unit="1", what="weight of the noise in the matrix")


def _filters_of(channel: Channel) -> Iterator[tuple[str, Filter]]:
    """Place and filter of each filter of a channel."""
    if channel.filter is not None:
        yield channel.name, channel.filter
    if channel.ir_cut is not None:
        yield f"{channel.name}.ir_cut", channel.ir_cut


def _model(place: str, one: Filter) -> FilterModel:
    _check.one_of(f"filter of {place}", one.model, tuple(FILTER_MODELS))
    return FILTER_MODELS[one.model]


def _refuse_channels(channels: Sequence[Channel], base: Sensor) -> None:
    if not 1 <= len(channels) <= MOST_CHANNELS:
        raise InputError(
            "channels", f"must be 1 to {MOST_CHANNELS}", value=len(channels), remedy="give others"
        )
    _check.distinct("channels", [channel.name for channel in channels])
    for channel in channels:
        if channel.base is not None:
            _check.one_of(f"channel of {base.name}", channel.base, base.names)


def _resolved(
    given: Mapping[str, tuple[Value, ModelNumber]],
) -> tuple[tuple[Parameter, ...], dict[str, float | int]]:
    """The free numbers, and by name each fixed number or the index of the free one it takes."""
    values = {name: value for name, (value, _) in given.items()}
    parameters: list[Parameter] = []
    index: dict[str, int] = {}
    for name, (value, number) in given.items():
        if isinstance(value, Free):
            index[name] = len(parameters)
            parameters.append(_parameter(name, value, number))
    if not parameters:
        raise InputError(
            "design",
            "must have a free number",
            found="all are fixed",
            remedy="give bounds in place of a number, as center_nm = [500, 560]",
        )
    numbers: dict[str, float | int] = {}
    for name, (_, number) in given.items():
        source = tied_to(name, values)
        value = values[source]
        bounds = (value.low, value.high) if isinstance(value, Free) else (float(value),)
        for bound in bounds:
            refuse_outside(name, number.unit, bound, number.least, number.most)
        numbers[name] = index[source] if isinstance(value, Free) else float(value)
    return tuple(parameters), numbers


def _parameter(name: str, free: Free, number: ModelNumber) -> Parameter:
    return Parameter(
        name=name,
        unit=number.unit,
        low=free.low,
        high=free.high,
        start=free.start,
        tolerance=free.tolerance,
        least=number.least,
        most=number.most,
    )
