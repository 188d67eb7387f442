"""Parameters that can be varied: light, exposure, IR-cut edge, noise of the pixel, crosstalk.

A sweep changes one parameter of an operating point and nothing else; the exposure time, for
example, stays.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError, Setting
from chromanoise.exposure import OperatingPoint
from chromanoise.properties import Property
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
    logarithmic
        Whether values have equal ratios instead of equal steps.
    lowest, highest
        Its range. [unit]
    at
        The operating point with that value.
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
    logarithmic: bool
    lowest: float
    highest: float
    at: Callable[[OperatingPoint, float], OperatingPoint]
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


def _at_level(operating_point: OperatingPoint, level_lux: float) -> OperatingPoint:
    return replace(operating_point, level_lux=level_lux)


def _at_time(operating_point: OperatingPoint, time_ms: float) -> OperatingPoint:
    return replace(
        operating_point, exposure=replace(operating_point.exposure, time_s=1e-3 * time_ms)
    )


def _at_f_number(operating_point: OperatingPoint, f_number: float) -> OperatingPoint:
    return replace(operating_point, exposure=replace(operating_point.exposure, f_number=f_number))


def _at_pixel(operating_point: OperatingPoint, value: float, *, field: str) -> OperatingPoint:
    """Another value of a field of the pixel, of one reading where several are summed."""
    sensor = operating_point.sensor
    changed = with_pixel(sensor, {field: value})
    return replace(operating_point, sensor=changed)


def _of_pixel(field: str, one: Property) -> Sweep:
    """The sweep of a property of the pixel.

    One on which the exposure time depends does not replace the setting of the study.
    """
    return Sweep(
        name=field.replace("_", "-"),
        what=one.label,
        unit=one.unit,
        logarithmic=one.logarithmic,
        lowest=max(one.least, _LEAST_LOGARITHMIC) if one.logarithmic else one.least,
        highest=one.most,
        at=partial(_at_pixel, field=field),
        replaces="" if one.sets_time else f"sensors.*.pixel.{field}",
    )


def _at_bits(operating_point: OperatingPoint, bits: float) -> OperatingPoint:
    """A converter whose top code is at full well, in place of any known gain."""
    sensor = operating_point.sensor
    converter = replace(sensor.converter, bits=round(bits), gain_e_per_dn=None)
    return replace(operating_point, sensor=replace(sensor, converter=converter))


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


def _at_ir_cut(operating_point: OperatingPoint, edge_nm: float) -> OperatingPoint:
    """A model IR-cut in addition to any that the sensor has."""
    return replace(
        operating_point, sensor=behind_ir_cut(operating_point.sensor, edge_nm, noted=False)
    )


def _at_temperature(operating_point: OperatingPoint, kelvin: float) -> OperatingPoint:
    grid = operating_point.illuminant.grid
    return replace(operating_point, illuminant=black_body(grid, kelvin))


def _at_infrared(operating_point: OperatingPoint, ratio: float) -> OperatingPoint:
    """An 850 nm illuminator in addition to the light, at the same illuminance."""
    light = with_infrared(operating_point.illuminant, peak_nm=_ILLUMINATOR_NM, ratio=ratio)
    return replace(operating_point, illuminant=light)


SWEEPS: Mapping[str, Sweep] = {
    sweep.name: sweep
    for sweep in (
        Sweep(
            name="lux",
            what="illuminance",
            unit="lx",
            logarithmic=True,
            lowest=1e-15,
            highest=1e15,
            at=_at_level,
        ),
        Sweep(
            name="time-ms",
            what="exposure time",
            unit="ms",
            logarithmic=True,
            lowest=1e-9,
            highest=1e12,
            at=_at_time,
            replaces="exposure.time_ms",
        ),
        Sweep(
            name="f-number",
            what="f-number",
            unit="1",
            logarithmic=True,
            lowest=1e-2,
            highest=1e6,
            at=_at_f_number,
        ),
        *(_of_pixel(name, one) for name, one in PIXEL.items()),
        Sweep(
            name="bits",
            what="bits of the converter, its top code at full well",
            unit="bit",
            logarithmic=False,
            lowest=8.0,
            highest=16.0,
            at=_at_bits,
            replaces="sensors.*.pixel.bits",
            whole=True,
        ),
        Sweep(
            name="crosstalk",
            what="share of light that ends in the four neighbors",
            unit="1",
            logarithmic=False,
            lowest=0.0,
            highest=1.0,
            at=_at_crosstalk,
            replaces="sensors.*.crosstalk",
        ),
        Sweep(
            name="ircut-nm",
            what="edge of an added IR-cut",
            unit="nm",
            logarithmic=False,
            lowest=450.0,
            highest=2000.0,
            at=_at_ir_cut,
        ),
        Sweep(
            name="kelvin",
            what="temperature of a black body",
            unit="K",
            logarithmic=False,
            lowest=1000.0,
            highest=50_000.0,
            at=_at_temperature,
            replaces_light=True,
        ),
        Sweep(
            name="infrared",
            what="power of an 850 nm illuminator over the light's",
            unit="W/W",
            logarithmic=False,
            lowest=0.0,
            highest=1e3,
            at=_at_infrared,
        ),
    )
}
"""The parameters that a comparison can vary, by name."""


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
