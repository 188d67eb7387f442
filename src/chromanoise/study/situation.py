"""A sensor in use: what a quantity is asked of, and what a sweep changes."""

from collections.abc import Callable
from dataclasses import dataclass

from chromanoise import _check
from chromanoise.color import ColorMatrix
from chromanoise.exposure import Exposure
from chromanoise.scene import Scene, flat_field
from chromanoise.sensor import Sensor
from chromanoise.spectra import Illuminant


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Situation:
    """One sensor, its exposure, and the light that it looks at.

    Attributes
    ----------
    sensor, exposure
        What looks, and how.
    illuminant, level_lux
        The light, and how much of it falls on the scene. [lx]
    """

    sensor: Sensor
    exposure: Exposure
    illuminant: Illuminant
    level_lux: float

    def __post_init__(self) -> None:
        _check.positive("level_lux", "lx", self.level_lux)


MatrixMaker = Callable[[Situation], ColorMatrix]
"""A color matrix for a situation: some adapt to the light level."""


def white_scene(situation: Situation) -> Scene:
    """A perfect white in that light."""
    return flat_field(situation.illuminant, level_lux=situation.level_lux)
