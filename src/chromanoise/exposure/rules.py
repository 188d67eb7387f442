"""Exposure rules for comparing sensors: equal time, equal saturation, or equal photons.

The rule determines which sensor is best, so each comparison names its rule.
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
    """Each sensor has its own time: its most sensitive channel reaches ``share`` of full well.

    Parameters
    ----------
    white
        The brightest object that must not saturate.
    sensors
        The sensors to compare.
    f_number, magnification
        As `Exposure`, the same for all.
    share
        Share of full well.

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
    """All sensors have the same time: the longest at which none exceeds ``share``.

    Errors as `equal_saturation`.

    Parameters
    ----------
    white
        The light of a perfect white.
    sensors
        The sensors.
    f_number
        Aperture of the lens. [1]
    share
        Share of full well that the most sensitive channel reaches. [1]
    magnification
        Magnification of the lens; ``None``: a distant scene. [1]
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
    """Each set of channels receives the same photons, for any number of pixels per set.

    The time is proportional to 1 / (pixels a^2): four channels on four pixels have 3/4 of the time
    of three channels on three pixels, and three stacked channels on one pixel have 3 times that
    time. It is the longest at which no sensor exceeds ``share`` of full well.

    Errors as `equal_saturation`.

    Parameters
    ----------
    white
        The light of a perfect white.
    sensors
        The sensors.
    f_number
        Aperture of the lens. [1]
    share
        Share of full well that the most sensitive channel reaches. [1]
    magnification
        Magnification of the lens; ``None``: a distant scene. [1]
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
"""The exposure rules by name."""
