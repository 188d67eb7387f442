"""A camera of the catalog at an ISO speed: its saturation and its read noise.

The curves of the cameras are relative, and their data sheets say nothing of electrons. Two facts
lead to both: at ISO speed S the sensor saturates at 78 / S lx s (ISO 12232:2019, saturation-based
speed), and a noise profile contains the signal at which read noise and shot noise are equal.
"""

from functools import lru_cache
from math import sqrt

import numpy as np

from chromanoise.base import InputError, check, dataclass
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
    """Electrons of the most sensitive channel where the sensor saturates at an ISO speed. [e-]

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


@dataclass(frozen=True, kw_only=True)
class CameraPixel:
    """Electrons of a camera of the catalog at one ISO speed.

    Attributes
    ----------
    iso
        ISO speed. [1]
    full_well_e
        Electrons at saturation, at this ISO speed. [e-]
    read_noise_e
        Standard deviation of the reading; ``None`` where it is unknown. [e-]
    """

    iso: float
    full_well_e: float
    read_noise_e: float | None

    @property
    def known(self) -> dict[str, float]:
        """The known values by the names of `chromanoise.sensor.Pixel`."""
        values = {"full_well_e": self.full_well_e, "read_noise_e": self.read_noise_e}
        return {name: value for name, value in values.items() if value is not None}

    @property
    def source(self) -> str:
        """Where the values come from, in a phrase."""
        noise = "; read noise from a noise profile" if self.read_noise_e is not None else ""
        return (
            f"full well at ISO {self.iso:g} by {SATURATION_LUX_S:g}/ISO lx s of D55 (ISO 12232)"
            f"{noise}"
        )


def camera_pixel(
    sensor: Sensor, iso: float | None = None, *, full_well_e: float | None = None
) -> CameraPixel:
    """Full well and read noise of a camera of the catalog.

    Parameters
    ----------
    sensor
        The camera; its name is that of the catalog.
    iso
        ISO speed; ``None`` for the lowest with a known read noise, or the base ISO speed without
        one.
    full_well_e
        Electrons at saturation; ``None`` for those of the ISO speed. [e-]

    Returns
    -------
    CameraPixel
        Its read noise is ``None`` at ISO speeds for which no noise profile is known.

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
    lowest = next(iter(camera_noise().get(sensor.name, ())), float(base))
    speed = lowest if iso is None else float(iso)
    full = saturation_electrons(sensor, speed) if full_well_e is None else full_well_e
    if speed < base:
        raise InputError(
            f"ISO speed of {sensor.name}", f"must be at least {base}, its lowest", value=speed
        )
    share = _equal_noise(sensor.name, speed)
    read_noise_e = None if share is None else sqrt(share * full)
    return CameraPixel(iso=speed, full_well_e=full, read_noise_e=read_noise_e)


def _equal_noise(name: str, iso: float) -> float | None:
    """The share of saturation at which read noise and shot noise are equal; None if unknown."""
    known = camera_noise().get(name, {})
    speeds = [*known]
    if not known or not speeds[0] <= iso <= speeds[-1]:
        return None
    shares = np.log([*known.values()])
    return float(np.exp(np.interp(np.log(iso), np.log(speeds), shares)))
