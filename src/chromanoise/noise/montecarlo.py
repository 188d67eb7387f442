"""Monte Carlo: the witness of the closed form, with its own error bar."""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from chromanoise import _check
from chromanoise.noise.sampling import clipped_at_well, sample_electrons
from chromanoise.rng import stream
from chromanoise.sensor import Pixel

Array = np.ndarray

_CHUNK = 65_536  # acquisitions per stream: memory stays bounded, and the chunk names its draws


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Estimate:
    """What ``draws`` acquisitions say about ``q`` linear coordinates.

    Attributes
    ----------
    mean, sd
        Sample mean and standard deviation per coordinate.
    mean_se
        Standard error of the mean.
    snr_db, snr_se_db
        20 log10(|mean| / sd) and its standard error. [dB]
    clipped_share
        Share of the draws of each raw channel that clipped; zeros where nothing is clipped.
    draws
        Number of acquisitions.
    """

    mean: Float[Array, " q"]
    sd: Float[Array, " q"]
    mean_se: Float[Array, " q"]
    snr_db: Float[Array, " q"]
    snr_se_db: Float[Array, " q"]
    clipped_share: Float[Array, " p"]
    draws: int


def monte_carlo(
    mean_e: Float[Array, " p"],
    pixel: Pixel,
    matrix: Float[Array, "q p"],
    *,
    draws: int,
    seed: int,
    name: tuple[int, ...] = (),
    clip: bool = False,
) -> Estimate:
    """Statistics of ``matrix @ raw`` over many noisy acquisitions of one point.

    Parameters
    ----------
    mean_e
        Expected electrons per channel. [e-]
    pixel
        Read noise, and full well where ``clip``.
    matrix
        One row per coordinate; the identity for the raw channels.
    draws
        Number of acquisitions, at least 2; the paper takes 5000.
    seed, name
        Which random numbers; see `chromanoise.rng.stream`.
    clip
        Hold each acquisition between 0 and full well, as a real sensor does. The paper does not.

    Raises
    ------
    InputError
        If there are fewer than 2 draws.
    """
    if draws < 2:
        raise _check.InputError(
            f"draws must be at least 2 for a standard deviation, but is {draws}"
        )
    expected = matrix @ mean_e
    sums = np.zeros((4, matrix.shape[0]))  # of powers of the deviation from what is expected
    clipped = np.zeros(mean_e.shape)
    for chunk, start in enumerate(range(0, draws, _CHUNK)):
        count = min(_CHUNK, draws - start)
        rng = stream(seed, *name, chunk)
        raw = sample_electrons(np.broadcast_to(mean_e, (count, mean_e.size)), pixel, rng)
        if clip:
            raw, hit = clipped_at_well(raw, pixel)
            clipped += hit.sum(axis=0)
        deviation = raw @ matrix.T - expected
        sums += [(deviation**power).sum(axis=0) for power in (1, 2, 3, 4)]
    return _estimate(expected, sums, clipped / draws, draws)


def _estimate(
    expected: Float[Array, " q"],
    sums: Float[Array, "4 q"],
    clipped_share: Float[Array, " p"],
    draws: int,
) -> Estimate:
    shift, square, cube, fourth = sums / draws
    variance = np.maximum(square - shift**2, 0.0)
    m3 = cube - 3 * shift * square + 2 * shift**3
    m4 = fourth - 4 * shift * cube + 6 * shift**2 * square - 3 * shift**4
    sd = np.sqrt(variance * draws / (draws - 1))
    mean = expected + shift
    with np.errstate(divide="ignore", invalid="ignore"):
        snr_db = 20 * np.log10(np.abs(mean) / sd)
        # delta method for log(mean / sd): both are sample moments and may covary (skewness)
        relative = variance / mean**2 + (m4 / variance**2 - 1) / 4 - m3 / (mean * variance)
        snr_se_db = 20 / math.log(10) * np.sqrt(np.maximum(relative, 0.0) / draws)
    return Estimate(
        mean=mean,
        sd=sd,
        mean_se=sd / math.sqrt(draws),
        snr_db=snr_db,
        snr_se_db=snr_se_db,
        clipped_share=clipped_share,
        draws=draws,
    )
