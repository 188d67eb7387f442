"""Random streams that depend on what is drawn, never on when or by whom.

Each stream is named by integers (frame, channel, row ...). Streams of different names are
independent for all practice, and the same name gives the same numbers for any order of work:
tiles, chunks and workers may come as they like.
"""

import numpy as np

from chromanoise.errors import InputError


def stream(seed: int, *name: int) -> np.random.Generator:
    """The generator called ``name`` under ``seed``: Philox, a counter-based cipher.

    Parameters
    ----------
    seed
        Any integer >= 0.
    name
        Integers >= 0 that tell this stream from every other, e.g. (sensor, row).

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
