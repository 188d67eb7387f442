"""Operating point: a sensor with its exposure and light."""

from dataclasses import dataclass

from chromanoise import _check
from chromanoise.exposure.electrons import Exposure
from chromanoise.scene import Scene, flat_field
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OperatingPoint:
    """A sensor, its exposure, and the light on the scene.

    Attributes
    ----------
    sensor, exposure
        The sensor and its exposure.
    illuminant, level_lux
        The illuminant, and its illuminance on the scene. [lx]

    Raises
    ------
    InputError
        If the level is not finite and positive.
    """

    sensor: Sensor
    exposure: Exposure
    illuminant: Illuminant
    level_lux: float

    def __post_init__(self) -> None:
        _check.positive("level_lux", "lx", self.level_lux)


def white_scene(operating_point: OperatingPoint) -> Scene:
    """A perfect white under this illuminant."""
    return flat_field(operating_point.illuminant, level_lux=operating_point.level_lux)
