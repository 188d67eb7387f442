"""Values of all planes as one value, for a pixel or a noise model with one value for all."""

import math
from collections.abc import Sequence

from chromanoise.characterization.results import PlaneNoise


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


def read_noise_e(plane: PlaneNoise, row_noise_e: float | None) -> float | None:
    """Temporal dark noise without the noise that rows share; ``None`` if it is not known. [e-]

    Parameters
    ----------
    plane
        Its dark noise includes the row noise (EMVA 1288, release 4.0).
    row_noise_e
        The row noise that a model has besides; ``None`` for none. [e-]
    """
    if plane.dark_noise_e is None:
        return None
    return math.sqrt(max(plane.dark_noise_e**2 - (row_noise_e or 0.0) ** 2, 0.0))
