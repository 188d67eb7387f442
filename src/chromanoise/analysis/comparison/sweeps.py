"""What can be varied: light level, time, read noise, IR-cut edge, the light and its infrared.

A sweep changes one thing of a situation and nothing else: the time, for one, stays what it was.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.exposure import Situation
from chromanoise.sensor import behind_ir_cut
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
        The situation with that value.
    """

    name: str
    what: str
    unit: str
    logarithmic: bool
    lowest: float
    highest: float
    at: Callable[[Situation, float], Situation]


def _at_level(situation: Situation, level_lux: float) -> Situation:
    return replace(situation, level_lux=level_lux)


def _at_time(situation: Situation, time_ms: float) -> Situation:
    return replace(situation, exposure=replace(situation.exposure, time_s=1e-3 * time_ms))


def _at_read_noise(situation: Situation, read_noise_e: float) -> Situation:
    pixel = replace(situation.sensor.pixel, read_noise_e=read_noise_e)
    return replace(situation, sensor=replace(situation.sensor, pixel=pixel))


def _at_ir_cut(situation: Situation, edge_nm: float) -> Situation:
    """A model IR-cut in front of what the sensor is: one that has a cut has two then."""
    return replace(situation, sensor=behind_ir_cut(situation.sensor, edge_nm, told=False))


def _at_temperature(situation: Situation, kelvin: float) -> Situation:
    grid = situation.illuminant.grid
    return replace(situation, illuminant=black_body(grid, kelvin))


def _at_infrared(situation: Situation, ratio: float) -> Situation:
    """An 850 nm illuminator beside the light; the lux stay what they were."""
    light = with_infrared(situation.illuminant, peak_nm=_ILLUMINATOR_NM, ratio=ratio)
    return replace(situation, illuminant=light)


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
        ),
        Sweep(
            name="read-noise-e",
            what="read noise",
            unit="e-",
            logarithmic=True,
            lowest=1e-6,
            highest=1e9,
            at=_at_read_noise,
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
