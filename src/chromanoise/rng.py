"""Random streams that depend on what is drawn, never on when or by whom.

Each stream is named by integers (frame, channel, row ...). Two names never share a number, and
the same name gives the same numbers for any order of work: tiles, chunks and workers may come
as they like.
"""

import numpy as np


def stream(seed: int, *name: int) -> np.random.Generator:
    """The generator called ``name`` under ``seed``: Philox, a counter-based cipher.

    Parameters
    ----------
    seed
        Any integer >= 0.
    name
        Integers >= 0 that tell this stream from every other, e.g. (sensor, row).

    Notes
    -----
    Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11 (2011).

    Examples
    --------
    >>> bool(stream(7, 0, 3).integers(100) == stream(7, 0, 3).integers(100))
    True
    """
    return np.random.Generator(np.random.Philox(np.random.SeedSequence(seed, spawn_key=name)))
