"""The same file by threads of this process and by a local dask cluster; the bits must be equal."""

from pathlib import Path

import numpy as np
from races import Times, raced
from subject import SEED, operating_point

from chromanoise.imaging import Picture, Work, rendered
from chromanoise.imaging.distributed import cluster
from chromanoise.io.cubes import read_cube


class OtherBitsError(Exception):
    """Two ways gave two pictures."""


def cluster_race(path: Path, *, workers: int, rounds: int) -> Times:
    """Times of a picture in XYZ and sRGB; starting the cluster is not counted.

    Raises
    ------
    OtherBitsError
        If the pictures differ.
    InputError
        If dask is not installed.
    """
    cube, at = read_cube(path), operating_point()

    def by(work: Work) -> Picture:
        return rendered(cube, at, seed=SEED, work=work)

    with cluster("local", workers=workers) as executor:
        threads = Work(threads=workers)
        processes = Work(executor=executor, threads=workers, same_machine=True)
        one, other = by(threads), by(processes)
        if not (np.array_equal(one.xyz, other.xyz) and np.array_equal(one.srgb, other.srgb)):
            raise OtherBitsError("threads and dask gave pictures that differ")
        del one, other
        return raced({"threads": lambda: by(threads), "dask": lambda: by(processes)}, rounds=rounds)
