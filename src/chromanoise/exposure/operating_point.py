"""A sensor in use: with its exposure, in its light."""

from dataclasses import dataclass

from chromanoise import _check
from chromanoise.exposure.electrons import Exposure
from chromanoise.scene import Scene, flat_field
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OperatingPoint:
    """One sensor, its exposure, and the light that it looks at.

    Attributes
    ----------
    sensor, exposure
        What looks, and how.
    illuminant, level_lux
        The light, and how much of it falls on the scene. [lx]

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
    """A perfect white in that light."""
    return flat_field(operating_point.illuminant, level_lux=operating_point.level_lux)
