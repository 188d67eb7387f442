"""Sweeps: one quantity of several sensors as a function of one parameter.

A quantity is one number of an operating point and a matrix. Parameters are light, exposure, IR-cut
edge, noise of the pixel, and crosstalk. A sweep changes one parameter and nothing else; the
exposure time, for example, stays.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any, ClassVar, TypeVar

import numpy as np

from chromanoise.base import (
    Array,
    Bool,
    Float,
    InputError,
    JsonKey,
    JsonKeys,
    Setting,
    check,
    dataclass,
    with_short_repr,
)
from chromanoise.color import LAB, ColorMatrix, cubature, propagate
from chromanoise.metrics import chart_color_error, mean_chart_errors
from chromanoise.noise import OperatingPoint, saturated, signal_limit_e
from chromanoise.sensor import (
    PIXEL,
    behind_ir_cut,
    crosstalk_of_share,
    with_crosstalk,
    with_pixel,
    without_crosstalk,
)
from chromanoise.spectra import black_body, with_infrared
from chromanoise.study.analysis import Stages, electrons_at, noisy_color_at, stages_at
from chromanoise.study.color_matrices import MatrixFunction, MatrixMaker
from chromanoise.study.color_noise import GRAY, VISUAL_NOISE, total_errors, visual_noise
from chromanoise.study.reading_quality import (
    COLOR,
    COLOR_WITHOUT,
    RAW,
    RAW_WITHOUT,
    best_channel_probability,
    median_distances,
    raw_information,
)


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """One number of an operating point.

    Attributes
    ----------
    name
        Its name in options and studies.
    what
        In words, unit not included.
    unit
        Its unit; 1 for none.
    more_is_better
        Whether the higher value is the better one.
    of
        The number; NaN where it is not defined: a channel is saturated, a color is no signal.
    over_levels
        The same for many light levels [lx] at once, as ``color_snr_over_levels``; ``None`` where
        there is no such function.
    of_raw
        Whether it is one of raw values, which neither a color matrix nor its color error concerns.
    """

    KEYS: ClassVar[JsonKeys] = ("name", "what", "unit")

    name: str
    what: str
    unit: str
    more_is_better: bool
    of: Callable[[OperatingPoint, ColorMatrix], float]
    over_levels: Callable[..., Array] | None = None
    of_raw: bool = False

    @property
    def sign(self) -> float:
        """1 where the higher value is the better one, else -1: times it, more is better."""
        return 1.0 if self.more_is_better else -1.0

    @property
    def key(self) -> str:
        """The name with its unit, where that is one word, in the form of a key: ``snr_y_db``."""
        unit = f"_{self.unit.lower()}" if self.unit.isalpha() else ""
        return self.name.replace("-", "_") + unit


_Function = TypeVar("_Function", bound=Callable[..., Array | float])
QUANTITIES: dict[str, Quantity] = {}
"""The quantities by which sensors are compared, by name: ``_quantity`` enters one."""


def _quantity(
    name: str,
    what: str,
    unit: str,
    *,
    more_is_better: bool = True,
    over_levels: bool = True,
    of_raw: bool = False,
) -> Callable[[_Function], _Function]:
    """A decorator that enters a function as a quantity.

    With ``over_levels``, it takes many light levels [lx] after the matrix, and ``matrices``, one
    per level [lx/e-], in place of that; without them it gives the number of the operating point.
    """

    def entered(function: _Function) -> _Function:
        QUANTITIES[name] = Quantity(
            name=name,
            what=what,
            unit=unit,
            more_is_better=more_is_better,
            of=lambda point, matrix: float(function(point, matrix)),
            over_levels=function if over_levels else None,  # type: ignore[arg-type]
            of_raw=of_raw,
        )
        return function

    return entered


def _of_patch(
    of: Callable[[Stages], Array],
    point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"] | None = None,
    *,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, "*lv"]:
    """A number of the stages of the patch that is analyzed, by default a perfect white."""
    reflectance = 1.0 if point.patch is None else point.patch_reflectance
    at = stages_at(point, matrix, level_lux=level_lux, reflectance=reflectance, lux_per_e=matrices)
    return np.asarray(of(at))


def _color_snr_db(at: Stages, coordinate: str) -> Float[Array, "*lv"]:
    return at.color_snr_db[..., at.matrix.coordinates.index(coordinate)]


def _color_snr_loss_db(at: Stages) -> Float[Array, "*lv"]:
    return np.asarray(at.optimal_linear_snr_db - _color_snr_db(at, "Y"))


for _axis in ("Y", "X", "Z"):
    _snr = partial(_of_patch, partial(_color_snr_db, coordinate=_axis))
    _quantity(f"snr-{_axis.lower()}", f"SNR of {_axis} of a white", "dB")(_snr)
SNR_Y = QUANTITIES["snr-y"]
_quantity("bound", "SNR of the best linear readout of a white", "dB")(
    partial(_of_patch, lambda at: at.optimal_linear_snr_db)
)
_quantity("price", "color SNR loss of a white", "dB", more_is_better=False)(
    partial(_of_patch, _color_snr_loss_db)
)
_color_difference = partial(_quantity, unit="Delta E*ab", more_is_better=False, over_levels=False)


@_color_difference("delta-e", "mean color difference by noise on an 18 % gray")
def gray_delta_e(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """NaN where a channel is saturated, or X, Y or Z of the white is not above 0."""
    white = matrix.matrix @ electrons_at(operating_point)
    if is_saturated(operating_point) or not (white > 0).all():
        return float("nan")
    gray = noisy_color_at(stages_at(operating_point, matrix, reflectance=GRAY), white)
    difference = propagate(gray, LAB, cubature).delta_e
    assert difference is not None  # CIELAB has one
    return float(difference)


_quantity(
    "visual-noise",
    VISUAL_NOISE,
    "CIELUV",
    more_is_better=False,
    over_levels=False,
)(visual_noise)


@_color_difference("color-error", "mean color error of the chart without noise")
def color_error(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """NaN where X, Y or Z of the white is not above 0."""
    error = chart_color_error(
        operating_point.sensor,
        matrix,
        operating_point.exposure,
        operating_point.illuminant,
        operating_point.chart,
    )
    return float("nan") if error is None else float(error.mean())


def color_errors(
    operating_point: OperatingPoint, matrices: Float[Array, "k c p"]
) -> Float[Array, " k"]:
    """`color_error` of many matrices of one sensor and time. [Delta E*ab]"""
    return mean_chart_errors(
        operating_point.sensor,
        matrices,
        operating_point.exposure,
        operating_point.illuminant,
        operating_point.observer,
        operating_point.chart,
    )


@_color_difference("total-error", "mean color error of the chart with noise")
def total_error(operating_point: OperatingPoint, matrix: ColorMatrix) -> float:
    """Bias and noise together; NaN without a color."""
    error = total_errors(operating_point, matrix)
    return float("nan") if error is None else float(error.total.mean())


def _median_distance(
    point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"] | None = None,
    *,
    reading: str,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, "*lv"]:
    return median_distances(point, matrix, reading, level_lux=level_lux, lux_per_e=matrices)


for _reading in (RAW, RAW_WITHOUT, COLOR, COLOR_WITHOUT):
    _is_raw, _without = _reading in (RAW, RAW_WITHOUT), _reading in (RAW_WITHOUT, COLOR_WITHOUT)
    _quantity(
        f"{'' if _is_raw else 'color-'}separation{'-without-brightness' if _without else ''}",
        f"median distance of patches {'in raw values' if _is_raw else 'after the color matrix'}"
        f"{', without brightness' if _without else ''}",
        "1",
        of_raw=_is_raw,
    )(partial(_median_distance, reading=_reading))
_quantity(
    "cdp",
    "contrast detection probability of the best raw channel",
    "1",
    over_levels=False,
    of_raw=True,
)(best_channel_probability)


@_quantity("information", "information of raw values about the spectrum", "bit", of_raw=True)
def information(
    operating_point: OperatingPoint,
    matrix: ColorMatrix,
    level_lux: Float[Array, " k"] | None = None,
    *,
    matrices: Float[Array, "k c p"] | None = None,
) -> Float[Array, "*lv"]:
    """`raw_information` of the default prior; NaN where a white saturates a channel. [bit]"""
    full = is_saturated(operating_point, level_lux)
    return np.where(full, np.nan, raw_information(operating_point, level_lux))


def is_saturated(
    operating_point: OperatingPoint, level_lux: Float[Array, " k"] | None = None
) -> Bool[Array, "*lv"]:
    """Whether a channel is saturated on a perfect white.

    Parameters
    ----------
    operating_point
        A sensor in use.
    level_lux
        Illuminances, the time being kept; ``None`` for that of the operating point. [lx]
    """
    electrons = electrons_at(operating_point, level_lux=level_lux)
    sensor, exposure = operating_point.sensor, operating_point.exposure
    return np.asarray(saturated(electrons, sensor, exposure).any(axis=-1))


def fullest_level_lux(operating_point: OperatingPoint) -> float | None:
    """Highest illuminance at which a perfect white saturates no channel, at a fixed time. [lx]

    ``None`` where no channel receives light. Electrons are linear in light, so it is the white
    level over the electrons per lux of the most sensitive channel.
    """
    most = float(electrons_at(operating_point, level_lux=np.ones(1)).max())
    left_e = signal_limit_e(operating_point.sensor, operating_point.exposure)
    return max(left_e, 0.0) / most if most > 0 else None


_ILLUMINATOR_NM = 850.0
_LEAST_LOGARITHMIC = 1e-6  # of a property that may be 0


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """One parameter that varies.

    Attributes
    ----------
    name
        Its name in options and studies.
    what
        Description, unit not included.
    unit
        Its unit; 1 for none.
    lowest, highest
        Its range. [unit]
    at
        The operating point with that value.
    logarithmic
        Whether values have equal ratios instead of equal steps.
    replaces
        Key in a study of the setting that has no effect on the sweep, because every value replaces
        it (``*`` for all sensors); empty if there is none. The light of a study, in contrast,
        determines the exposure time before the sweep.
    replaces_light
        Whether every value replaces the illuminant.
    whole
        Whether values are whole numbers.
    """

    KEYS: ClassVar[JsonKeys] = ("name", "what", "unit")

    name: str
    what: str
    unit: str
    lowest: float
    highest: float
    at: Callable[[OperatingPoint, float], OperatingPoint]
    logarithmic: bool = False
    replaces: str = ""
    replaces_light: bool = False
    whole: bool = False

    def with_unit(self, text: str) -> str:
        """A value as text with the unit; without one where the unit is 1.

        Parameters
        ----------
        text
            The value as text.
        """
        return text if self.unit == "1" else f"{text} {self.unit}"

    def checked(self, at: Float[Array, " k"]) -> Float[Array, " k"]:
        """Values of the sweep that increase and are within its range.

        Parameters
        ----------
        at
            The values. [unit of the sweep]

        Raises
        ------
        InputError
            If they do not increase, or are out of the range.
        """
        values = check.increasing(f"values of {self.name}", self.unit, at)
        self.demand_in_range(float(values[0]), float(values[-1]))
        return values

    def demand_in_range(self, *values: float) -> None:
        """Refuse values that are out of the range.

        Parameters
        ----------
        values
            Of what is varied, in its unit.

        Raises
        ------
        InputError
            If one is.
        """
        for value in values:
            check.within(f"sweep of {self.name}", self.unit, value, self.lowest, self.highest)


_At = Callable[[OperatingPoint, float], OperatingPoint]
SWEEPS: dict[str, Sweep] = {}
"""The parameters that a comparison can vary, by name: ``_sweep`` enters one."""


def _sweep(
    name: str, what: str, unit: str, lowest: float, highest: float, **more: Any
) -> Callable[[_At], _At]:
    """A decorator that enters the function `Sweep.at` with what it varies."""

    def entered(at: _At) -> _At:
        SWEEPS[name] = Sweep(
            name=name, what=what, unit=unit, lowest=lowest, highest=highest, at=at, **more
        )
        return at

    return entered


@_sweep("lux", "illuminance", "lx", 1e-15, 1e15, logarithmic=True)
def _at_level(operating_point: OperatingPoint, level_lux: float) -> OperatingPoint:
    return replace(operating_point, level_lux=level_lux)


@_sweep("time-ms", "exposure time", "ms", 1e-9, 1e12, logarithmic=True, replaces="exposure.time_ms")
def _at_time(operating_point: OperatingPoint, time_ms: float) -> OperatingPoint:
    return replace(
        operating_point, exposure=replace(operating_point.exposure, time_s=1e-3 * time_ms)
    )


@_sweep("f-number", "f-number", "1", 1e-2, 1e6, logarithmic=True)
def _at_f_number(operating_point: OperatingPoint, f_number: float) -> OperatingPoint:
    return replace(operating_point, exposure=replace(operating_point.exposure, f_number=f_number))


def _at_pixel(operating_point: OperatingPoint, value: float, *, field: str) -> OperatingPoint:
    """Another value of a field of the pixel, of one reading where several are summed."""
    sensor = operating_point.sensor
    changed = with_pixel(sensor, {field: value})
    return replace(operating_point, sensor=changed)


for _field, _one in PIXEL.items():
    _sweep(
        _field.replace("_", "-"),
        _one.label,
        _one.unit,
        max(_one.least, _LEAST_LOGARITHMIC) if _one.logarithmic else _one.least,
        _one.most,
        logarithmic=_one.logarithmic,
        # one on which the exposure time depends does not replace the setting of the study
        replaces="" if _one.sets_time else f"sensors.*.pixel.{_field}",
    )(partial(_at_pixel, field=_field))


@_sweep(
    "bits",
    "bit depth of the converter with its top code at full well",
    "bit",
    8.0,
    16.0,
    replaces="sensors.*.pixel.bits",
    whole=True,
)
def _at_bits(operating_point: OperatingPoint, bits: float) -> OperatingPoint:
    """A converter whose top code is at full well, in place of any known gain."""
    sensor = operating_point.sensor
    converter = replace(sensor.converter, bits=round(bits), gain_e_per_dn=None)
    return replace(operating_point, sensor=replace(sensor, converter=converter))


@_sweep(
    "crosstalk",
    "share of light that ends in the four neighbors",
    "1",
    0.0,
    1.0,
    replaces="sensors.*.crosstalk",
)
def _at_crosstalk(operating_point: OperatingPoint, share: float) -> OperatingPoint:
    """Crosstalk to the four neighbors, in place of any that the sensor has."""
    sensor = operating_point.sensor
    pure = without_crosstalk(sensor)
    if pure is None or sensor.mosaic is None:
        lacks = "no mosaic" if sensor.mosaic is None else "crosstalk that cannot be undone"
        raise InputError(
            "crosstalk",
            "must vary only for sensors with a mosaic, which determines the neighbors",
            value=share,
            found=f"{sensor.label} has {lacks}",
            remedy=(Setting("mosaic"), "omit this sensor"),
        )
    mixing = crosstalk_of_share(share, sensor.mosaic, sensor.names)
    return replace(operating_point, sensor=with_crosstalk(pure, mixing))


@_sweep("ircut-nm", "edge of an added IR-cut", "nm", 450.0, 2000.0)
def _at_ir_cut(operating_point: OperatingPoint, edge_nm: float) -> OperatingPoint:
    """A model IR-cut in addition to any that the sensor has."""
    return replace(
        operating_point, sensor=behind_ir_cut(operating_point.sensor, edge_nm, noted=False)
    )


@_sweep("kelvin", "temperature of a black body", "K", 1000.0, 50_000.0, replaces_light=True)
def _at_temperature(operating_point: OperatingPoint, kelvin: float) -> OperatingPoint:
    grid = operating_point.illuminant.grid
    return replace(operating_point, illuminant=black_body(grid, kelvin))


@_sweep("infrared", "power of an 850 nm illuminator over the light's", "W/W", 0.0, 1e3)
def _at_infrared(operating_point: OperatingPoint, ratio: float) -> OperatingPoint:
    """An 850 nm illuminator in addition to the light, at the same illuminance."""
    light = with_infrared(operating_point.illuminant, peak_nm=_ILLUMINATOR_NM, ratio=ratio)
    return replace(operating_point, illuminant=light)


def swept_values(sweep: Sweep, first: float, last: float, points: int) -> Float[Array, " k"]:
    """Values from first to last, with equal steps, or equal ratios in a logarithmic sweep.

    Where values are whole numbers, they are rounded, and repeated ones are dropped.

    Parameters
    ----------
    sweep
        One of `SWEEPS`, or your own.
    first, last
        First and last value. [unit of the sweep]
    points
        How many. [1]

    Raises
    ------
    InputError
        If they do not increase, are out of the range of the sweep, or are fewer than 2 or more than
        100,000.
    """
    sweep.demand_in_range(first, last)
    if not last > first:
        raise InputError(
            f"sweep of {sweep.name}",
            f"must rise [{sweep.unit}]",
            value=(first, last),
            found=f"goes from {first:g} to {last:g}",
        )
    if sweep.whole and first.is_integer() + last.is_integer() < 2:
        raise InputError(
            f"sweep of {sweep.name}",
            "must go from one whole number to another",
            value=(first, last),
        )
    if not 2 <= points <= 100_000:
        raise InputError("points", "must be 2 to 100000 for a sweep", value=points)
    space = np.geomspace if sweep.logarithmic else np.linspace
    values = np.asarray(space(first, last, points))
    return np.unique(values.round()) if sweep.whole else values


@dataclass(frozen=True, kw_only=True, eq=False)
class OfSensor:
    """What a result over a sweep is of: one sensor with one matrix.

    Attributes
    ----------
    sensor, matrix
        Names of the sensor and of the matrix.
    label
        Name of the sensor in tables, charts and sentences.
    sweep, quantity
        The parameter that varies, and the quantity.
    """

    sensor: str
    label: str
    matrix: str
    sweep: Sweep
    quantity: Quantity

    @property
    def subject(self) -> dict[str, Any]:
        """These fields by name, for another result of the same sensor and matrix."""
        return {field.name: getattr(self, field.name) for field in fields(OfSensor)}


AnyOfSensor = TypeVar("AnyOfSensor", bound=OfSensor)


def by_matrix(found: Sequence[AnyOfSensor]) -> dict[str, list[AnyOfSensor]]:
    """The results of each matrix, by its name."""
    grouped: dict[str, list[AnyOfSensor]] = {}
    for one in found:
        grouped.setdefault(one.matrix, []).append(one)
    return grouped


@dataclass(frozen=True, kw_only=True, eq=False)
class SweptQuantity(OfSensor):
    """A quantity of one sensor with one matrix over a sweep.

    Attributes
    ----------
    at
        Values of the parameter. [unit of the sweep]
    value
        NaN where it is not defined: a channel is saturated, a color is no signal. [unit of the
        quantity]
    saturated
        Where a channel is saturated on a perfect white.
    """

    KEYS: ClassVar[JsonKeys] = ("sensor", "label", "matrix", "value", "saturated")

    at: Float[Array, " k"]
    value: Float[Array, "*j k"]
    saturated: Bool[Array, "*j k"]

    def __post_init__(self) -> None:
        names = (field.name for field in fields(self))
        check.freeze(self, *(name for name in names if isinstance(getattr(self, name), np.ndarray)))

    @property
    def over(self) -> str:
        """What varies, in words."""
        return self.sweep.what

    @property
    def points(self) -> Float[Array, "*j k"]:
        """The values, with another sign where less is better; -inf where one is not defined."""
        return np.where(np.isfinite(self.value), self.quantity.sign * self.value, -np.inf)


@with_short_repr
@dataclass(frozen=True, kw_only=True, eq=False)
class Curve(SweptQuantity):
    """A quantity over one parameter.

    Attributes
    ----------
    time_s
        Exposure time before the sweep. [s]
    color_error
        Mean over the ColorChecker, without noise; NaN where it is not defined. [Delta E*ab]
    """

    KEYS: ClassVar[JsonKeys] = (
        *SweptQuantity.KEYS[:3],
        JsonKey("time_ms", "time_s", factor=1e3),
        *SweptQuantity.KEYS[3:],
        "color_error",
    )

    time_s: float
    color_error: Float[Array, " k"]


def compared(
    contestants: Sequence[OperatingPoint],
    makers: Mapping[str, MatrixFunction],
    at: Float[Array, " k"],
    *,
    sweep: Sweep = SWEEPS["lux"],
    quantity: Quantity = SNR_Y,
    progress: Callable[[int], None] = lambda _: None,
) -> tuple[Curve, ...]:
    """A quantity of every sensor with every matrix over the sweep.

    Parameters
    ----------
    contestants
        Sensors with their exposures and their light; the sweep changes nothing else of them.
    makers
        Matrix methods by name, from `matrix_makers` or functions of your own; each makes a new
        matrix at every value.
    at
        Increasing. [unit of the sweep]
    sweep
        The parameter that varies: one of `SWEEPS`, or your own.
    quantity
        One of `QUANTITIES`, or your own.
    progress
        Called with the number of newly finished values, out of all values of all curves.

    Raises
    ------
    InputError
        If the values do not increase, or are out of the range of the sweep.
    """
    values = sweep.checked(at)
    pairs = [(one, name, maker) for one in contestants for name, maker in makers.items()]
    found = [_over_levels(one, maker, values, sweep, quantity) for one, _, maker in pairs]
    progress(values.size * sum(curve is not None for curve in found))
    slow = [(one, maker) for (one, _, maker), curve in zip(pairs, found, strict=True) if not curve]
    rest = iter(_one_by_one(slow, values, sweep, quantity, progress))
    curves = []
    for (one, name, _), curve in zip(pairs, found, strict=True):
        value, errors, full = curve or next(rest)
        curves.append(
            Curve(
                sensor=one.sensor.name,
                label=one.sensor.label,
                matrix=name,
                time_s=one.exposure.time_s,
                sweep=sweep,
                quantity=quantity,
                at=values,
                value=value,
                saturated=full,
                color_error=errors,
            )
        )
    return tuple(curves)


_OverSweep = tuple[Float[Array, " k"], Float[Array, " k"], Bool[Array, " k"]]


def _over_levels(
    contestant: OperatingPoint,
    maker: MatrixFunction,
    values: Float[Array, " k"],
    sweep: Sweep,
    quantity: Quantity,
) -> _OverSweep | None:
    """All levels at once; ``None`` where the quantity has no function for many levels."""
    if sweep.name != SWEEPS["lux"].name or not isinstance(maker, MatrixMaker):
        return None
    if quantity.over_levels is None:
        return None
    full = is_saturated(contestant, values)
    first = maker(SWEEPS["lux"].at(contestant, float(values[0])))
    matrices = maker.over_levels(contestant, values)
    if matrices is not None:
        found = quantity.over_levels(contestant, first, values, matrices=matrices)
        return found, color_errors(contestant, matrices), full
    error = color_error(contestant, first)  # one matrix for all levels
    return quantity.over_levels(contestant, first, values), np.full(values.size, error), full


def _one_by_one(
    pairs: Sequence[tuple[OperatingPoint, MatrixFunction]],
    values: Float[Array, " k"],
    sweep: Sweep,
    quantity: Quantity,
    progress: Callable[[int], None],
) -> list[_OverSweep]:
    """All curves at each value, so that the first values show how long all of them take."""
    found: list[_OverSweep] = [
        (np.empty(values.size), np.empty(values.size), np.empty(values.size, bool)) for _ in pairs
    ]
    for i, value in enumerate(values.tolist()):
        for (contestant, maker), (of_one, errors, full) in zip(pairs, found, strict=True):
            operating_point = sweep.at(contestant, value)
            matrix = maker(operating_point)
            of_one[i] = quantity.of(operating_point, matrix)
            errors[i] = color_error(operating_point, matrix)
            full[i] = is_saturated(operating_point)
            progress(1)
    return found
