"""A camera of the catalog at an ISO speed: its saturation and its read noise.

The curves of the cameras are relative, and their data sheets say nothing of electrons. Two facts
lead to both: at ISO speed S the sensor saturates at 78 / S lx s (ISO 12232:2019, saturation-based
speed), and a noise profile contains the signal at which read noise and shot noise are equal.
"""

from functools import lru_cache
from math import sqrt

import numpy as np

from chromanoise.base import InputError, check
from chromanoise.noise import FASTEST_F_NUMBER, Exposure, expected_electrons
from chromanoise.sensor import Sensor
from chromanoise.spectra import Grid, Illuminant, flat_field, illuminant_named
from chromanoise.spectra.tables import camera_facts, camera_noise

SATURATION_LUX_S = 78.0
"""Exposure of the image at saturation, times ISO speed. [lx s]"""
GRAY_LUX_S = 10.0
"""Exposure of the image of an 18 % gray, times ISO speed. [lx s]"""
AT_THE_SENSOR = Exposure(time_s=1.0, f_number=FASTEST_F_NUMBER)
"""With it, a level in lux of a white is its exposure on the sensor in lx s: t / (4 f#^2) = 1 s."""


def saturation_electrons(sensor: Sensor, iso: float) -> float:
    """Electrons of the fullest channel where the sensor saturates at an ISO speed. [e-]

    Parameters
    ----------
    sensor
        With its quantum efficiency and the pitch of its pixels.
    iso
        Saturation-based ISO speed, 1 to 1e7.

    Raises
    ------
    InputError
        If the speed is out of range.

    Notes
    -----
    ISO 12232:2019: 78 / S lx s of daylight, here D55.
    """
    speed = check.within("iso", "1", iso, 1.0, 1e7)
    white = flat_field(_daylight(sensor.grid), level_lux=SATURATION_LUX_S / speed)
    return float(expected_electrons(white, sensor, AT_THE_SENSOR).max())


@lru_cache(maxsize=4)
def _daylight(grid: Grid) -> Illuminant:
    return illuminant_named("D55", grid, beyond="zero")


def camera_pixel(sensor: Sensor, iso: float | None = None) -> dict[str, float]:
    """Full well and read noise of a camera of the catalog, by the names of `Pixel`.

    Parameters
    ----------
    sensor
        The camera; its name is that of the catalog.
    iso
        ISO speed; ``None`` for the camera's base ISO speed.

    Returns
    -------
    dict
        ``full_well_e``: electrons at saturation at this ISO speed; ``read_noise_e``, where it is
        known. [e-]

    Raises
    ------
    InputError
        If the camera is not in the catalog, or the speed is out of range or below the base ISO
        speed.

    Notes
    -----
    With N electrons at saturation, shot noise at the share x of N has the variance x N. Where the
    read noise has the same variance, its standard deviation is sqrt(x N). Between two ISO speeds of
    a profile, log x is linear in log S; outside of them the read noise is unknown.
    """
    if sensor.name not in camera_facts():
        raise InputError("camera", "must be a camera of the catalog", value=sensor.name)
    base = camera_facts()[sensor.name].base_iso
    speed = float(base if iso is None else iso)
    full_well_e = saturation_electrons(sensor, speed)
    if speed < base:
        raise InputError(
            f"ISO speed of {sensor.name}", f"must be at least {base}, its lowest", value=speed
        )
    share = _equal_noise(sensor.name, speed)
    known = {} if share is None else {"read_noise_e": sqrt(share * full_well_e)}
    return {"full_well_e": full_well_e, **known}


def _equal_noise(name: str, iso: float) -> float | None:
    """The share of saturation at which read noise and shot noise are equal; None if unknown."""
    known = camera_noise().get(name, {})
    speeds = [*known]
    if not known or not speeds[0] <= iso <= speeds[-1]:
        return None
    shares = np.log([*known.values()])
    return float(np.exp(np.interp(np.log(iso), np.log(speeds), shares)))
