"""How fast noise is drawn on one thread: against numpy's PCG64 on the same means.

Both give Poisson electrons plus 5 e- of Gaussian read noise for a picture of 512 x 512 pixels and
4 channels. Rounds take turns; the ratio is the median over the rounds.
"""

from statistics import median

import numpy as np
from races import Times, raced, ratio

from chromanoise.imaging.sampling import noisy_electrons

SHAPE = (512, 512, 4)
READ_NOISE_E = 5.0
ROUNDS = 9
HIGHEST_MEANS_E = (1e4, 12.0)


def noise_race(highest_e: float, *, rounds: int = ROUNDS) -> Times:
    """Times of numpy and of chromanoise for means from 0 to ``highest_e``."""
    pcg64 = np.random.default_rng(0)
    mean_e = pcg64.uniform(0, highest_e, SHAPE)
    single = mean_e.astype(np.float32)
    return raced(
        {
            "numpy": lambda: pcg64.poisson(mean_e) + READ_NOISE_E * pcg64.standard_normal(SHAPE),
            "here": lambda: noisy_electrons(single, read_noise_e=READ_NOISE_E, seed=0, threads=1),
        },
        rounds=rounds,
    )


def ns_per_sample(times: Times, who: str) -> float:
    """Wall time per value drawn, median of the rounds."""
    return median(times[who]) * 1e9 / float(np.prod(SHAPE))


def _line(highest_e: float) -> str:
    times = noise_race(highest_e)
    faster = ratio(times, "numpy", "here")
    numpy, own = ns_per_sample(times, "numpy"), ns_per_sample(times, "here")
    return (
        f"means 0 .. {highest_e:g} e-: {faster.middle:.1f} x "
        f"({faster.lowest:.1f} .. {faster.highest:.1f}); numpy {numpy:.0f}, here {own:.1f} ns per "
        "sample"
    )


if __name__ == "__main__":
    for highest in HIGHEST_MEANS_E:
        print(_line(highest))
