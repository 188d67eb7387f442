"""Parameters that can be varied: light, exposure, IR-cut edge, noise of the pixel, crosstalk.

A sweep changes one parameter of an operating point and nothing else; the exposure time, for
example, stays.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError, Setting
from chromanoise.exposure import OperatingPoint
from chromanoise.sensor import (
    PIXEL,
    behind_ir_cut,
    crosstalk_of_share,
    with_crosstalk,
    with_pixel,
    without_crosstalk,
)
from chromanoise.spectra import black_body, with_infrared

_ILLUMINATOR_NM = 850.0
_LEAST_LOGARITHMIC = 1e-6  # of a property that may be 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweep:
    """One parameter that varies.

    Attributes
    ----------
    name
        Its name in options and studies.
    what
        Description, unit not included.
    unit
        Of its values.
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


_At = Callable[[OperatingPoint, float], OperatingPoint]
SWEEPS: dict[str, Sweep] = {}
"""The parameters that a comparison can vary, by name: `_sweep` enters one."""


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
    "bits of the converter, its top code at full well",
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
    for value in (first, last):
        _check.within(f"sweep of {sweep.name}", sweep.unit, value, sweep.lowest, sweep.highest)
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
