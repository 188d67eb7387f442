"""Any subset of the properties of a pixel: as the base of a class, and as keyword arguments.

Type checkers and editors read their names in the stub beside this file, which
``tools/make_stubs.py`` writes from `Pixel`.
"""

from typing import Annotated, TypedDict

from chromanoise.base import beside_their_needs, partial_class
from chromanoise.sensor.pixel import PIXEL

PartialPixel = partial_class("PartialPixel", PIXEL)
"""The values of a pixel that are known; ``None`` for the others."""
PixelSettings = TypedDict(
    "PixelSettings",
    {name: Annotated[float, one] for name, one in beside_their_needs(PIXEL).items()},
    total=False,
)
"""Keyword arguments for the values of a pixel."""
PixelSettings.__doc__ = "Keyword arguments for the values of a pixel."
