"""How fast noise is drawn on one thread: against numpy's PCG64 on the same means.

Both give Poisson electrons plus 5 e- of Gaussian read noise for a picture of 512 x 512 pixels and
4 channels, into memory that has been touched before. Rounds take turns, so that what else the
machine does falls on both; the ratio is the median over the rounds.
"""

import time
from collections.abc import Callable
from statistics import median

import numpy as np

from chromanoise.imaging.sampling import noisy_electrons

SHAPE = (512, 512, 4)
READ_NOISE_E = 5.0
ROUNDS = 9
HIGHEST_MEANS_E = (1e4, 12.0)


def ns_per_sample(work: Callable[[], object]) -> float:
    """Wall time of one call, per value drawn."""
    start = time.perf_counter()
    work()
    return (time.perf_counter() - start) * 1e9 / np.prod(SHAPE)


def race(highest_e: float) -> str:
    """One line: the ratio, its spread, and both times."""
    pcg64 = np.random.default_rng(0)
    mean_e = pcg64.uniform(0, highest_e, SHAPE)
    single = mean_e.astype(np.float32)

    def theirs() -> object:
        return pcg64.poisson(mean_e) + READ_NOISE_E * pcg64.standard_normal(SHAPE)

    def ours() -> object:
        return noisy_electrons(single, read_noise_e=READ_NOISE_E, seed=0, threads=1)

    theirs(), ours()
    rounds = [(ns_per_sample(theirs), ns_per_sample(ours)) for _ in range(ROUNDS)]
    ratios = sorted(numpy / own for numpy, own in rounds)
    numpy, own = (median(times) for times in zip(*rounds, strict=True))
    return (
        f"means 0 .. {highest_e:g} e-: {median(ratios):.1f} x "
        f"({ratios[0]:.1f} .. {ratios[-1]:.1f}); numpy {numpy:.0f}, here {own:.1f} ns per sample"
    )


for highest in HIGHEST_MEANS_E:
    print(race(highest))
