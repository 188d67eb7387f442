"""Random streams that do not depend on the order of computation or the number of workers.

Each stream is identified by integers (frame, channel, row ...). Streams with different identifiers
are statistically independent. The same identifier always gives the same numbers, whatever the order
of tiles, chunks and workers.
"""

import numpy as np

from chromanoise.base.errors import InputError


def stream(seed: int, *name: int) -> "np.random.Generator":
    """The random generator for ``seed`` and ``name``: Philox, a counter-based generator.

    Parameters
    ----------
    seed
        Any integer >= 0.
    name
        Integers >= 0 that identify this stream, e.g. (sensor, row).

    Raises
    ------
    InputError
        If the seed is not an integer >= 0.

    Notes
    -----
    Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11 (2011).

    Examples
    --------
    >>> bool(stream(7, 0, 3).integers(100) == stream(7, 0, 3).integers(100))
    True
    """
    if seed != int(seed) or seed < 0:
        raise InputError("seed", "must be an integer >= 0", value=seed)
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(int(seed), spawn_key=name)))
