"""Values of all planes as one value, for a pixel or a noise model with one value for all."""

import math
from collections.abc import Sequence
from dataclasses import replace

from chromanoise.characterization.results import MEASURED, PlaneNoise
from chromanoise.sensor import PAPER_PIXEL, PIXEL
from chromanoise.sensor.noise_source import SOURCES, Drawn, PixelReading


def root_mean_square(values: Sequence[float | None]) -> float | None:
    """Root of the mean square of the known values: the noise of all planes together.

    Values that are ``None`` or not finite are left out; ``None`` if none is known.

    Examples
    --------
    >>> root_mean_square([1.0, 7.0, None]), root_mean_square([None])
    (5.0, None)
    """
    known = [one for one in values if one is not None and math.isfinite(one)]
    if len(known) < 2:
        return known[0] if known else None
    return math.sqrt(sum(one**2 for one in known) / len(known))


def _drawn(name: str) -> set[Drawn]:
    """How the noise of a property of the pixel is drawn, by the list of sources."""
    without = PixelReading(pixel=PAPER_PIXEL)
    with_it = PixelReading(pixel=replace(PAPER_PIXEL, **{name: PIXEL[name].most}))
    return {one.drawn for one in SOURCES if one.value(with_it) != one.value(without)}


SPREADS = {name: PIXEL[name] for name in MEASURED if _drawn(name)}
"""Measured properties of a pixel that are standard deviations."""
SHARED = tuple(name for name in SPREADS if _drawn(name) <= {"row", "column"})
"""Those that a row or a column shares."""


def read_noise_e(plane: PlaneNoise, *shared_e: float | None) -> float | None:
    """Temporal dark noise without row and column noise; ``None`` if it is not known. [e-]

    Parameters
    ----------
    plane
        Its dark noise includes that of rows and columns (EMVA 1288, release 4.0).
    shared_e
        The noise of rows and of columns that a model has besides; ``None`` for none. [e-]
    """
    if plane.dark_noise_e is None:
        return None
    shared_e2 = sum((one or 0.0) ** 2 for one in shared_e)
    return math.sqrt(max(plane.dark_noise_e**2 - shared_e2, 0.0))
