"""On what terms sensors are compared: the same time, the same filling, or the same photons.

The terms decide who wins, so each comparison names its own.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from chromanoise.exposure.electrons import Exposure, saturating_exposure
from chromanoise.scene import Scene
from chromanoise.sensor import Sensor, pixels_of


def equal_saturation(
    white: Scene,
    sensors: Sequence[Sensor],
    *,
    f_number: float = 1.8,
    share: float = 0.99,
    magnification: float | None = None,
) -> list[Exposure]:
    """Each sensor has its own time, at which its most sensitive channel fills ``share``.

    Parameters
    ----------
    white
        The brightest thing that must not saturate.
    sensors
        To be compared.
    f_number, magnification
        As `Exposure`, the same for all.
    share
        Of full well.

    Raises
    ------
    InputError
        As `saturating_exposure`.
    """
    return [
        saturating_exposure(
            white, sensor, f_number=f_number, share=share, magnification=magnification
        )
        for sensor in sensors
    ]


def equal_exposure(
    white: Scene,
    sensors: Sequence[Sensor],
    *,
    f_number: float = 1.8,
    share: float = 0.99,
    magnification: float | None = None,
) -> list[Exposure]:
    """All sensors have the same time: the longest at which none fills more than ``share``.

    Parameters, errors as `equal_saturation`.
    """
    own = equal_saturation(
        white, sensors, f_number=f_number, share=share, magnification=magnification
    )
    return [min(own, key=lambda exposure: exposure.time_s)] * len(own)


def equal_light(
    white: Scene,
    sensors: Sequence[Sensor],
    *,
    f_number: float = 1.8,
    share: float = 0.99,
    magnification: float | None = None,
) -> list[Exposure]:
    """Each set of channels gets the same photons, however many pixels share them.

    The time goes as 1 / (pixels a^2): four channels on four pixels have three quarters of the time
    of three, and a stack on one pixel three times theirs. It is as long as it can be while none
    fills more than ``share``.

    Parameters, errors as `equal_saturation`.
    """
    own = equal_saturation(
        white, sensors, f_number=f_number, share=share, magnification=magnification
    )
    area_um2 = [pixels_of(sensor) * sensor.pixel.pitch_um**2 for sensor in sensors]
    least = min(e.time_s * area for e, area in zip(own, area_um2, strict=True))
    return [
        replace(exposure, time_s=least / area) for exposure, area in zip(own, area_um2, strict=True)
    ]


EQUAL_TERMS: Mapping[str, Callable[..., list[Exposure]]] = {
    "exposure": equal_exposure,
    "saturation": equal_saturation,
    "light": equal_light,
}
"""The terms by the names that a comparison tells."""
