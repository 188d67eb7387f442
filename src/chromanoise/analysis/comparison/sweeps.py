"""What can be varied: light level, time, read noise, IR-cut edge, the light and its infrared.

A sweep changes one thing of an operating point and nothing else: the time, for example, stays as it
was.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.exposure import OperatingPoint
from chromanoise.sensor import behind_ir_cut, of_the_sum
from chromanoise.spectra import black_body, with_infrared

_ILLUMINATOR_NM = 850.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweep:
    """One thing that varies.

    Attributes
    ----------
    name
        As a person asks for it.
    what
        In words.
    unit
        Of its values.
    logarithmic
        Whether equal ratios, not equal steps, are equally far apart.
    lowest, highest
        Between which it makes sense. [unit]
    at
        The operating point with that value.
    replaces
        Key in a study of the setting that has no effect on the sweep, because every value replaces
        it (``*`` for all sensors); empty if there is none. The light of a study, in contrast,
        determines the exposure time before the sweep.
    """

    name: str
    what: str
    unit: str
    logarithmic: bool
    lowest: float
    highest: float
    at: Callable[[OperatingPoint, float], OperatingPoint]
    replaces: str = ""


def _at_level(operating_point: OperatingPoint, level_lux: float) -> OperatingPoint:
    return replace(operating_point, level_lux=level_lux)


def _at_time(operating_point: OperatingPoint, time_ms: float) -> OperatingPoint:
    return replace(
        operating_point, exposure=replace(operating_point.exposure, time_s=1e-3 * time_ms)
    )


def _at_read_noise(operating_point: OperatingPoint, read_noise_e: float) -> OperatingPoint:
    """The read noise of one reading, also where several readings are summed."""
    own = operating_point.sensor.pixel
    pixel = replace(own, **of_the_sum(own, {"read_noise_e": read_noise_e}))
    return replace(operating_point, sensor=replace(operating_point.sensor, pixel=pixel))


def _at_ir_cut(operating_point: OperatingPoint, edge_nm: float) -> OperatingPoint:
    """A model IR-cut in front of what the sensor is: one that has a cut has two then."""
    return replace(
        operating_point, sensor=behind_ir_cut(operating_point.sensor, edge_nm, noted=False)
    )


def _at_temperature(operating_point: OperatingPoint, kelvin: float) -> OperatingPoint:
    grid = operating_point.illuminant.grid
    return replace(operating_point, illuminant=black_body(grid, kelvin))


def _at_infrared(operating_point: OperatingPoint, ratio: float) -> OperatingPoint:
    """An 850 nm illuminator beside the light; the lux stay what they were."""
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
            what="integration time",
            unit="ms",
            logarithmic=True,
            lowest=1e-9,
            highest=1e12,
            at=_at_time,
            replaces="exposure.time_ms",
        ),
        Sweep(
            name="read-noise-e",
            what="read noise",
            unit="e-",
            logarithmic=True,
            lowest=1e-6,
            highest=1e9,
            at=_at_read_noise,
            replaces="sensors.*.pixel.read_noise_e",
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


def swept_values(sweep: Sweep, first: float, last: float, points: int) -> Float[Array, " k"]:
    """Values from first to last, equally far apart. [unit of the sweep]

    In a logarithmic sweep their ratios are equal, else their differences.

    Parameters
    ----------
    sweep
        One of `SWEEPS`, or your own.
    first, last
        The ends, both among the values. [unit of the sweep]
    points
        How many. [1]

    Raises
    ------
    InputError
        If they do not rise, leave what makes sense, or there are fewer than 2 or over 100,000.
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
    if not 2 <= points <= 100_000:
        raise InputError("points", "must be 2 to 100000 for a sweep", value=points)
    space = np.geomspace if sweep.logarithmic else np.linspace
    return np.asarray(space(first, last, points))
