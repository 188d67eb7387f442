"""Spaces of sensors that can be made: filters, silicon, mosaic and exposure with free numbers."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, field
from typing import Literal, get_args

import numpy as np

from chromanoise.apps.design.parameters import (
    Candidates,
    Free,
    Parameter,
    Value,
    bounds_of,
    noise_properties,
    refuse_other_noise,
    refuse_outside,
    tied_to,
)
from chromanoise.base import Array, Float, Inexact, InputError, check, dataclass, known_name
from chromanoise.sensor import (
    FILTER_MODELS,
    LEAST_LENGTH_NM,
    LEAST_LENGTH_UM,
    SILICON_NUMBERS,
    Crosstalk,
    ModelNumber,
    Mosaic,
    Number,
    Sensor,
    bayer,
    beer_lambert,
    crosstalk_of_share,
    declared_numbers,
    layered_silicon_qe,
    of_the_sum,
    refuse_other_channels,
    router_collection,
    router_shares,
    silicon_qe,
    with_pixel,
)
from chromanoise.spectra import Grid

MOST_CHANNELS = 16
LEAST_SHARE = 0.01
"""Least share of the pixels that a channel of a searched mosaic has. [1]"""
LIBRARY_MODEL = "dye"
"""The model whose curves are those of `DesignSpace.library`."""
MODELS = (*FILTER_MODELS, LIBRARY_MODEL)
"""Names of the models of a filter of a design."""
Structure = Literal["mosaic", "layers", "router"]
PixelShares = Literal["equal", "free"] | tuple[float, ...]

_BLOCK = 1024  # candidates: large enough that calls cost little, small enough for a cache
_PROBES = 64  # random candidates in the check for a channel without QE
LEAST_QE = 1e-9
"""Highest QE of a channel below which it has no signal. [e-/photon]"""
_ROUNDING = 1e-9


@dataclass(frozen=True, kw_only=True)
class Filter:
    """One filter of a design: a model and its numbers.

    Attributes
    ----------
    model
        A name of `chromanoise.sensor.FILTER_MODELS`, or ``dye``: a curve of the
        library to the power of the number ``thickness`` (Beer-Lambert), 1 by default.
    numbers
        Fixed, free or tied numbers of the model by name; what is omitted has its default.
    curves
        For ``dye`` only: names of the library; the search chooses one of several.
    """

    model: str
    numbers: Mapping[str, Value] = field(default_factory=dict)
    curves: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "model", known_name(self.model, MODELS))


@dataclass(frozen=True, kw_only=True)
class Channel:
    """One channel of a design.

    Attributes
    ----------
    name
        Its name; the numbers of its filter are ``NAME.center_nm`` and so on.
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


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignSpace:
    """Sensors of ``p`` channels that differ in ``d`` free numbers.

    The QE of a channel is that of silicon, or of a channel of the base sensor, times the
    transmittances of its filters and of the filter in front of all channels; crosstalk before
    counting comes last.

    Attributes
    ----------
    base
        Gives the grid, the pixel, and the curves of the channels that name one of its own.
    channels
        1 to 16 channels. Layers are in order from the surface down, channels of a router from short
        to long wavelengths.
    structure
        ``mosaic``: each channel has its own pixels. ``layers``: channels are stacked in silicon.
        ``router``: all light of a tile is sorted to its pixels. The last two are ``stacked``.
    ir_cut
        A filter in front of all channels, with numbers ``ir_cut.cutoff_nm`` and so on.
    silicon
        Numbers of `chromanoise.sensor.silicon_qe`: ``silicon.depth_um`` and so on.
    layers
        ``layers.NAME_um``, the thickness of the layer of each channel. [um]
    router
        ``router.efficiency``, ``router.NAME_selectivity`` as for `router_collection`,
        ``router.crossing_1_nm`` and so on and ``router.edge_nm`` as for `router_shares`.
    library
        Transmittances on the grid by name, for the filters of model ``dye``. [1]
    mosaic
        The channel of each pixel: of the sensors made, and of crosstalk. ``None``: crosstalk
        reaches a neighbor of each channel with the share of its pixels.
    pixel_shares
        Shares of the pixels: ``equal``, one per channel with the sum 1, or ``free``: the numbers
        ``NAME.share_of_rest``, one less than channels, are the share of what the channels before
        it leave, so that any set of shares of at least ``LEAST_SHARE`` can be reached.
    crosstalk
        ``crosstalk.share``, as for `chromanoise.sensor.crosstalk_of_share`; before counting. [1]
    time_ms
        ``exposure.time_ms``, the exposure time; ``None`` for that of the scene. [ms]
    noise_weight
        ``matrix.noise_weight``, the weight of the noise in the matrix; ``None`` for that of the
        scene. [1]
    pixel
        ``pixel.read_noise_e`` and so on: noise of the pixel by the names of
        ``noise_properties``; what is omitted is that of the base.
    parameters
        The free numbers, in the order of the coordinates of a search; made from all others.

    Raises
    ------
    InputError
        If a name is unknown or repeated, a number is missing or not possible, bounds are not in
        order, a tie leads nowhere or in a circle, no number is free, or a channel has no QE.

    Examples
    --------
    >>> from chromanoise.study import sensor_named
    >>> bells = {
    ...     name: Filter(model="gaussian", numbers={"center_nm": at, "width_nm": 40.0})
    ...     for name, at in (("R", Free(low=560.0, high=680.0)), ("G", 540.0), ("B", 460.0))
    ... }
    >>> space = DesignSpace(
    ...     base=sensor_named("model-mono"),
    ...     channels=tuple(Channel(name=name, filter=bell) for name, bell in bells.items()),
    ...     ir_cut=Filter(model="ir-cut", numbers={"cutoff_nm": Free(low=600.0, high=900.0)}),
    ... )
    >>> [parameter.name for parameter in space.parameters]
    ['R.center_nm', 'ir_cut.cutoff_nm']
    >>> space.curves(np.array([[600.0, 650.0], [620.0, 700.0]])).shape
    (2, 131, 3)
    """

    base: Sensor
    channels: tuple[Channel, ...]
    structure: Structure = "mosaic"
    ir_cut: Filter | None = None
    silicon: Mapping[str, Value] = field(default_factory=dict)
    layers: Mapping[str, Value] = field(default_factory=dict)
    router: Mapping[str, Value] = field(default_factory=dict)
    library: Mapping[str, Float[Array, " n"]] = field(default_factory=dict)
    mosaic: Mosaic | None = None
    pixel_shares: PixelShares = "equal"
    crosstalk: Value | None = None
    time_ms: Value | None = None
    noise_weight: Value | None = None
    pixel: Mapping[str, Value] = field(default_factory=dict)
    parameters: tuple[Parameter, ...] = field(init=False)
    _numbers: Mapping[str, float | int] = field(init=False, repr=False)
    _curves: Mapping[str, Float[Array, "k n"]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self._refuse_structure()
        given: dict[str, tuple[Value, ModelNumber]] = {}
        choices: dict[str, tuple[str, ...]] = {}
        for place, numbers, known in self._parts():
            numbers = {
                check.one_of(f"number of {place}", name, tuple(known)): value
                for name, value in numbers.items()
            }
            for name, number in known.items():
                given[f"{place}.{name}"] = (_value(place, name, numbers, number), number)
        for place, one in self._filters():
            if one.model == LIBRARY_MODEL:
                self._refuse_curves(place, one)
                last = len(one.curves) - 1
                name = f"{place}.curve"
                choices[name] = one.curves
                value = Free(low=0.0, high=float(last)) if last else 0.0
                given[name] = (value, ModelNumber(unit="1", what="curve", most=float(last)))
        parameters, numbers_of = _resolved(given, choices)
        object.__setattr__(self, "parameters", parameters)
        object.__setattr__(self, "_numbers", numbers_of)
        object.__setattr__(self, "_curves", dict(self._library_curves()))
        self._refuse_dark_channels()

    # parts of the design

    @property
    def grid(self) -> Grid:
        """The wavelengths of all curves."""
        return self.base.grid

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the channels."""
        return tuple(channel.name for channel in self.channels)

    def _filters(self) -> Iterator[tuple[str, Filter]]:
        """Place and filter of all filters, in the order of the parameters."""
        for channel in self.channels:
            yield from _filters_of(channel)
        if self.ir_cut is not None:
            yield "ir_cut", self.ir_cut

    def _parts(self) -> Iterator[tuple[str, Mapping[str, Value], Mapping[str, ModelNumber]]]:
        """Place, given numbers and known numbers of each part, in the order of the parameters."""
        for place, one in self._filters():
            yield place, one.numbers, _known_numbers(place, one)
        if self._needs_silicon:
            yield "silicon", self.silicon, SILICON_NUMBERS
        if self.structure == "layers":
            yield "layers", self.layers, {f"{name}_um": _THICKNESS for name in self.names}
        if self.structure == "router":
            yield "router", self.router, _router_numbers(self.names)
        if self.pixel_shares == "free":
            last = len(self.channels) - 1
            for i, name in enumerate(self.names[:last]):
                equal = Free(low=0.0, high=1.0, start=1.0 / (last + 1 - i))
                yield name, {"share_of_rest": equal}, {"share_of_rest": _SHARE}
        for place, name, value, number in (
            ("crosstalk", "share", self.crosstalk, _CROSSTALK),
            ("exposure", "time_ms", self.time_ms, _TIME),
            ("matrix", "noise_weight", self.noise_weight, _NOISE_WEIGHT),
        ):
            if value is not None:
                yield place, {name: value}, {name: number}
        known = _pixel_numbers()
        yield "pixel", self.pixel, {name: known[name] for name in known if name in self.pixel}

    @property
    def _needs_silicon(self) -> bool:
        """Whether a channel has the QE of one diode of silicon."""
        return self.structure != "layers" and any(one.base is None for one in self.channels)

    def _library_curves(self) -> Iterator[tuple[str, Float[Array, "k n"]]]:
        """Place and curves of each dye, of its thickness where that is fixed."""
        for place, one in self._filters():
            if one.model == LIBRARY_MODEL:
                curves = np.stack([self.library[name] for name in one.curves])
                thickness = self._numbers[f"{place}.thickness"]
                is_free = isinstance(thickness, int)
                yield place, curves if is_free else beer_lambert(curves, thickness)

    # candidates

    def number(self, name: str, values: Inexact[Array, "m d"]) -> Number:
        """A number of the design for each candidate, or once where it is fixed.

        Parameters
        ----------
        name
            Its full name, as ``R.center_nm``.
        values
            One row of free numbers per candidate.

        Raises
        ------
        InputError
            If the design has no such number.
        """
        return self._number(
            check.one_of("number of the design", name, tuple(self._numbers)), values
        )

    def _number(self, name: str, values: Inexact[Array, "m d"]) -> Number:
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
        result = np.empty((len(values), len(self.channels), self.grid.n), dtype=values.dtype)
        for first in range(0, len(values), _BLOCK):
            rows = slice(first, first + _BLOCK)
            self._fill(values[rows], result[rows])
        return result.transpose(0, 2, 1)

    def _fill(self, values: Inexact[Array, "m d"], qe: Inexact[Array, "m p n"]) -> None:
        """Write the curves of a block of candidates into ``qe``."""
        front: Array | float = 1.0
        if self.ir_cut is not None:
            front = self._transmittance("ir_cut", self.ir_cut, values)
        if self.structure == "layers":
            thickness = [self._number(f"layers.{name}_um", values) for name in self.names]
            bare = front * np.moveaxis(layered_silicon_qe(self.grid, _sums(thickness)), -1, 0)
        else:
            bare = self._bare(values, front)
        shares = self._routed(values) if self.structure == "router" else None
        for i, channel in enumerate(self.channels):
            own = qe[:, i]
            own[...] = bare[i] if shares is None else bare[i] * shares[..., i]
            for place, one in _filters_of(channel):
                own *= self._transmittance(place, one, values)
        if self.crosstalk is not None:
            share = np.asarray(self._number("crosstalk.share", values))[..., None, None]
            mixed = qe + share * (self._neighbors(values) @ qe - qe)
            qe[...] = mixed

    def _bare(self, values: Inexact[Array, "m d"], front: Array | float) -> list[Array | float]:
        """QE of each channel behind the common filter, without its own filters."""
        silicon: Array | float = 1.0
        if self._needs_silicon:
            numbers = {name: self._number(f"silicon.{name}", values) for name in SILICON_NUMBERS}
            silicon = silicon_qe(self.grid, **numbers) * front
        names = self.base.names
        return [
            silicon if one.base is None else self.base.qe[:, names.index(one.base)] * front
            for one in self.channels
        ]

    def _routed(self, values: Inexact[Array, "m d"]) -> Inexact[Array, "*m n p"]:
        """Share of the light of the tile that each channel receives from the router."""
        p = len(self.channels)
        selectivity = [self._number(f"router.{name}_selectivity", values) for name in self.names]
        crossing = [self._number(f"router.crossing_{i}_nm", values) for i in range(1, p)]
        return router_shares(
            self.grid,
            collection=router_collection(selectivity, self._number("router.efficiency", values)),
            crossing_nm=crossing,
            edge_nm=self._number("router.edge_nm", values),
        )

    def _transmittance(
        self, place: str, one: Filter, values: Inexact[Array, "m d"]
    ) -> Inexact[Array, "*m n"]:
        if one.model == LIBRARY_MODEL:
            index = np.asarray(self._number(f"{place}.curve", values))
            curves = self._curves[place][np.rint(index.real).astype(int)]
            thickness = self._numbers[f"{place}.thickness"]
            if isinstance(thickness, int):
                return beer_lambert(curves, values[:, thickness])
            return curves
        known = {name: self._numbers[f"{place}.{name}"] for name in _known_numbers(place, one)}
        own = values[:, [column for column in known.values() if isinstance(column, int)]]
        fresh = np.ones(len(own), dtype=bool)  # of neighbors with equal numbers only the first
        fresh[1:] = (own[1:] != own[:-1]).any(axis=1)
        some = values[fresh]
        numbers = {name: self._number(f"{place}.{name}", some) for name in known}
        found = FILTER_MODELS[one.model].of(self.grid, numbers)
        return found if fresh.all() or found.ndim == 1 else found[np.cumsum(fresh) - 1]

    def shares(self, values: Inexact[Array, "m d"]) -> Inexact[Array, "m p"] | None:
        """Share of the pixels of each channel; ``None`` where all have equal shares. [1]

        Parameters
        ----------
        values
            As for `curves`.
        """
        if self.pixel_shares == "equal":
            return None
        m, p = len(values), len(self.channels)
        if self.pixel_shares != "free":
            return np.broadcast_to(np.array(self.pixel_shares), (m, p))
        left: Array = np.ones(m)
        parts: list[Array] = []
        for name in self.names[:-1]:
            own = self._number(f"{name}.share_of_rest", values)
            parts.append(left * own)
            left = left * (1.0 - own)
        return LEAST_SHARE + (1.0 - p * LEAST_SHARE) * np.stack([*parts, left], axis=1)

    def _neighbors(self, values: Inexact[Array, "m d"]) -> Inexact[Array, "*m p p"]:
        """Row i: the channels of the four neighbors of a pixel of channel i, as shares. [1]"""
        if self.mosaic is not None:
            return crosstalk_of_share(1.0, self.mosaic, self.names).matrix
        p = len(self.channels)
        shares = self.shares(values)
        if shares is None:
            return np.full((p, p), 1.0 / p)
        return np.repeat(shares[:, None, :], p, axis=1)

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
        weight, time_ms = (
            self._each(name, values) if name in self._numbers else None
            for name in ("matrix.noise_weight", "exposure.time_ms")
        )
        return Candidates(
            qe=self.curves(values),
            time_s=None if time_ms is None else time_ms / 1000.0,
            pixel_share=self.shares(values),
            noise_weight=weight,
            pixel=of_the_sum(self.base.pixel, self._pixel(values)),
        )

    def _each(self, name: str, values: Inexact[Array, "m d"]) -> Inexact[Array, " m"]:
        return np.broadcast_to(self._number(name, values), (len(values),))

    def _pixel(self, values: Inexact[Array, "m d"]) -> dict[str, Inexact[Array, " m"]]:
        """Noise of one pixel of each candidate, by name."""
        return {name: self._each(f"pixel.{name}", values) for name in self.pixel}

    def _first(self, name: str, values: Float[Array, "m d"]) -> float:
        return float(self._each(name, values)[0])

    def _checked(self, values: Inexact[Array, "m d"]) -> Inexact[Array, "m d"]:
        if values.shape[1] != len(self.parameters):
            raise InputError(
                "values",
                f"must have {len(self.parameters)} columns, one per free number",
                value=values.shape,
                found=f"has shape {values.shape}",
            )
        return values

    # one candidate

    def sensor(self, values: Float[Array, " d"], *, name: str) -> Sensor:
        """One candidate as a sensor that all commands take; its notes say how it was made.

        Parameters
        ----------
        values
            The free numbers, in the order and the units of `parameters`.

        Returns
        -------
        Sensor
            Its mosaic is that of the design; without one it is made for three or four channels
            whose shares are quarters, and otherwise ``None``.

        Raises
        ------
        InputError
            If a number is not possible, or a channel has no QE.
        """
        row = np.asarray(values, dtype=np.float64)[None, :]
        qe = self.curves(row)[0]
        for channel, curve in zip(self.names, qe.T, strict=True):
            if curve.max() < LEAST_QE:
                raise InputError(
                    f"QE of {name}",
                    "must not be 0 at all wavelengths [e-/photon]",
                    where=f"channel {channel}",
                    found=f"is at most {curve.max():.3g}",
                    remedy="move its filter or the IR-cut so that both transmit",
                )
        shares = self.shares(row)
        mosaic = self.mosaic
        if mosaic is None and self.structure == "mosaic":
            mosaic = _small_mosaic(self.names, qe, shares, self.grid)
        sensor = Sensor(
            name=name,
            grid=self.grid,
            qe=qe,
            names=self.names,
            pixel=self.base.pixel,
            mosaic=mosaic,
            stacked=self.structure != "mosaic",
            converter=self.base.converter,
            crosstalk=self._crosstalk_of(row, shares),
            origin="model",
            notes=self._notes(row, shares),
        )
        return with_pixel(sensor, {k: float(each[0]) for k, each in self._pixel(row).items()})

    def _crosstalk_of(
        self, row: Float[Array, "1 d"], shares: Float[Array, "1 p"] | None
    ) -> Crosstalk | None:
        """The crosstalk in the curves, where shares are whole numbers of pixels."""
        if self.crosstalk is None:
            return None
        share = self._first("crosstalk.share", row)
        if self.mosaic is not None:
            return crosstalk_of_share(share, self.mosaic, self.names)
        if shares is not None:
            return None
        p = len(self.channels)
        matrix = (1.0 - share) * np.eye(p) + share * self._neighbors(row)
        return Crosstalk(matrix=matrix, pixels=(1,) * p)

    def _notes(
        self, row: Float[Array, "1 d"], shares: Float[Array, "1 p"] | None
    ) -> tuple[str, ...]:
        models = dict(self._filters())
        shown_of: dict[str, list[str]] = {}
        for name in self._numbers:
            place, _, number = name.rpartition(".")
            value = self._first(name, row)
            shown = f"{number} {value:.6g}"
            if number == "curve":
                shown = models[place].curves[round(value)]
            shown_of.setdefault(place, []).append(shown)
        kinds = {place: f"{one.model} " for place, one in models.items()}
        parts = [
            f"{place}: {kinds.get(place, '')}{', '.join(of)}" for place, of in shown_of.items()
        ]
        notes = [f"designed from models of filters and silicon, not a device; {'; '.join(parts)}"]
        if any(channel.base is not None for channel in self.channels):
            own = [f"{one.name} has {one.base}" for one in self.channels if one.base is not None]
            notes += (f"QE of {self.base.name}: {', '.join(own)}", *self.base.notes)
        if shares is not None:
            of = [f"{name} {share:.4g}" for name, share in zip(self.names, shares[0], strict=True)]
            notes.append(f"shares of the pixels: {', '.join(of)}")
        if self.crosstalk is not None and self.mosaic is None:
            notes.append("crosstalk between channels in proportion to their shares of the pixels")
        mixing = self._crosstalk_of(row, shares)
        if mixing is not None and mixing.deviations is not None:
            notes.append(
                "pixels of one channel have different neighbors, so crosstalk makes a fixed "
                "pattern, which the objectives of the search do not include"
            )
        return tuple(notes)

    # checks

    def _refuse_structure(self) -> None:
        _refuse_channels(self.channels, self.base)
        refuse_other_noise(self.pixel)
        check.one_of("structure", self.structure, get_args(Structure))
        if self.mosaic is not None:
            refuse_other_channels(self.mosaic, self.names)
        if self.structure != "mosaic":
            for name, is_given in (
                ("mosaic", self.mosaic is not None),
                ("pixel_shares", self.pixel_shares != "equal"),
                ("crosstalk", self.crosstalk is not None),
            ):
                if is_given:
                    raise InputError(
                        name,
                        f"must be omitted for the structure {self.structure}",
                        found="its channels share one pixel",
                        remedy=f"omit {name}, or choose the structure mosaic",
                    )
        if self.structure == "layers" and any(one.base is not None for one in self.channels):
            raise InputError(
                "channels", "must have no curves of a base sensor for the structure layers"
            )
        for name, curve in self.library.items():
            check.fraction(f"transmittance of {name}", "1", curve)
            check.same_length("wavelengths", grid=self.grid.n, **{name: len(curve)})
        if self.crosstalk is not None and self.base.crosstalk is not None:
            raise InputError(
                "crosstalk", "must be given once", found=f"the base {self.base.name} has it"
            )
        self._refuse_shares()

    def _refuse_shares(self) -> None:
        shares = self.pixel_shares
        if isinstance(shares, str):
            check.one_of("pixel_shares", shares, ("equal", "free"))
            return
        check.same_length("channels", channels=len(self.channels), pixel_shares=len(shares))
        for name, share in zip(self.names, shares, strict=True):
            check.within(f"share of the pixels of {name}", "1", share, LEAST_SHARE, 1.0)
        if abs(sum(shares) - 1.0) > _ROUNDING:
            raise InputError("pixel_shares", "must have the sum 1", value=sum(shares))

    def _refuse_curves(self, place: str, one: Filter) -> None:
        if not one.curves:
            raise InputError(
                f"curves of {place}", "must name at least one transmittance", found=None
            )
        check.distinct(f"curves of {place}", one.curves)
        for name in one.curves:
            check.among(f"curve of {place}", name, tuple(self.library))

    def _refuse_dark_channels(self) -> None:
        """Refuse a channel without QE at all of the bounds, the middle, and random candidates."""
        low, high = bounds_of(self.parameters)
        share = np.random.default_rng(0).random((_PROBES, low.size))
        share[:3] = np.array([0.0, 0.5, 1.0])[:, None]
        highest = self.curves(low + share * (high - low)).max(axis=(0, 1))
        for name, qe in zip(self.names, highest, strict=True):
            if qe < LEAST_QE:
                raise InputError(
                    f"channel {name}",
                    "must have a QE above 0 within the bounds [e-/photon]",
                    found=f"has at most {qe:.3g} in {_PROBES} candidates",
                    remedy="choose other bounds of its filter, or of the IR-cut",
                )


_TIME = ModelNumber(unit="ms", what="exposure time", least=1e-6)
_NOISE_WEIGHT = ModelNumber(unit="1", what="weight of the noise in the matrix")
_CROSSTALK = ModelNumber(unit="1", what="share of the light that ends in neighbors", most=1.0)
_SHARE = ModelNumber(unit="1", what="share of the pixels that are left", most=1.0)
_LIBRARY_NUMBERS = {
    "thickness": ModelNumber(unit="1", what="thickness over the measured one", default=1.0)
}
_THICKNESS = ModelNumber(unit="um", what="thickness of the layer", least=LEAST_LENGTH_UM)


def model_numbers(model: str, given: Iterable[str]) -> Mapping[str, ModelNumber]:
    """All numbers of a filter by name.

    Parameters
    ----------
    given
        Names of the numbers that are given, for a model of several films or bands.

    Raises
    ------
    InputError
        If too many films or bands are named.
    """
    if model == LIBRARY_MODEL:
        return _LIBRARY_NUMBERS
    return FILTER_MODELS[model].numbers_for(given)


def _pixel_numbers() -> dict[str, ModelNumber]:
    return {
        name: ModelNumber(unit=one.unit, what=one.label, least=one.least, most=one.most)
        for name, one in noise_properties().items()
    }


def _router_numbers(names: Sequence[str]) -> dict[str, ModelNumber]:
    selectivity = ModelNumber(
        unit="1", what="share of its band that the channel receives of what is collected", most=1.0
    )
    crossing = ModelNumber(unit="nm", what="wavelength between two bands", least=LEAST_LENGTH_NM)
    return {
        "efficiency": ModelNumber(unit="1", what="share of the light collected", most=1.0),
        **{f"{name}_selectivity": selectivity for name in names},
        **{f"crossing_{i}_nm": crossing for i in range(1, len(names))},
        **declared_numbers(router_shares),
    }


def _filters_of(channel: Channel) -> Iterator[tuple[str, Filter]]:
    """Place and filter of each filter of a channel."""
    if channel.filter is not None:
        yield channel.name, channel.filter
    if channel.ir_cut is not None:
        yield f"{channel.name}.ir_cut", channel.ir_cut


def _known_numbers(place: str, one: Filter) -> Mapping[str, ModelNumber]:
    check.among(f"filter of {place}", one.model, MODELS)
    if one.curves and one.model != LIBRARY_MODEL:
        raise InputError(
            f"curves of {place}", f"must be omitted for the model {one.model}", value=one.curves
        )
    return model_numbers(one.model, one.numbers)


def _value(place: str, name: str, numbers: Mapping[str, Value], number: ModelNumber) -> Value:
    value = numbers.get(name, number.default)
    if value is None:
        raise InputError(
            f"{place}.{name}",
            f"must be given: {number.what}{check.in_brackets(number.unit)}",
            found=None,
            remedy="give a number to fix it, or bounds [low, high] to search it",
        )
    return value


def _sums(thickness: Sequence[Number]) -> list[Array]:
    """Depths at which layers of these thicknesses end."""
    depth: Number = 0.0
    ends: list[Array] = []
    for one in thickness:
        depth = depth + one
        ends.append(np.asarray(depth))
    return ends


def _small_mosaic(
    names: tuple[str, ...],
    qe: Float[Array, "n p"],
    shares: Float[Array, "1 p"] | None,
    grid: Grid,
) -> Mosaic | None:
    """A 2 x 2 mosaic for three or four channels, if their shares are quarters.

    For three equal shares, as the paper counts them, the channel nearest to 555 nm is
    doubled, as in Bayer's mosaic.
    """
    p = len(names)
    if p not in (3, 4):
        return None
    if shares is None:
        counts = np.ones(p)
        if p == 3:
            centers = grid.wavelength_nm @ qe / qe.sum(axis=0)
            counts[np.abs(centers - _EYE_NM).argmin()] = 2
    else:
        counts = 4 * shares[0]
    whole = np.rint(counts)
    if np.abs(counts - whole).max() > _ROUNDING or sorted(whole) not in ([1, 1, 2], [1, 1, 1, 1]):
        return None
    if p == 4:
        return Mosaic((names[:2], names[2:]))
    twice = names[int(whole.argmax())]
    first, last = (name for name in names if name != twice)
    pattern = {"R": first, "G": twice, "B": last}
    return Mosaic(tuple(tuple(pattern[one] for one in row) for row in bayer().pattern))


_EYE_NM = 555.0


def _refuse_channels(channels: Sequence[Channel], base: Sensor) -> None:
    if not 1 <= len(channels) <= MOST_CHANNELS:
        raise InputError("number of channels", f"must be 1 to {MOST_CHANNELS}", value=len(channels))
    check.distinct("channels", [channel.name for channel in channels])
    for channel in channels:
        if channel.base is not None:
            check.among(f"{channel.name}.base", channel.base, base.names)


def _resolved(
    given: Mapping[str, tuple[Value, ModelNumber]], choices: Mapping[str, tuple[str, ...]]
) -> tuple[tuple[Parameter, ...], dict[str, float | int]]:
    """The free numbers, and by name each fixed number or the index of the free one it takes."""
    values = {name: value for name, (value, _) in given.items()}
    free = {name: value for name, value in values.items() if isinstance(value, Free)}
    if not free:
        raise InputError(
            "design",
            "must have a free number",
            found="all are fixed",
            remedy="give bounds in place of a number, as center_nm = [500, 560]",
        )
    index = {name: i for i, name in enumerate(free)}
    numbers: dict[str, float | int] = {}
    for name, (_, number) in given.items():
        source = tied_to(name, values)
        value, unit = values[source], given[source][1].unit
        if unit != number.unit:
            raise InputError(
                name,
                f"must be tied to a parameter in {number.unit}",
                value=source,
                found=f"is tied to {source} in {unit}",
            )
        bounds = (value.low, value.high) if isinstance(value, Free) else (value,)
        for bound in bounds:
            refuse_outside(name, number.unit, float(bound), number.least, number.most)
        numbers[name] = index[source] if isinstance(value, Free) else float(value)
    parameters = tuple(
        Parameter(
            name=name,
            unit=number.unit,
            **asdict(free[name]),
            least=number.least,
            most=number.most,
            choices=choices.get(name, ()),
        )
        for name, (_, number) in given.items()
        if name in free
    )
    return parameters, numbers
