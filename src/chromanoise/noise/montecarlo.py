"""Monte Carlo simulation that checks the closed form, with its standard errors."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.errors import InputError
from chromanoise.noise.sampling import clipped_at_well, sample_electrons
from chromanoise.noise.sources import NoiseSources
from chromanoise.rng import stream
from chromanoise.sensor import Pixel

MOST_DRAWS = 10**10
_CHUNK = 65_536  # acquisitions per random stream; bounds the memory


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Estimate:
    """Statistics of ``q`` linear coordinates over ``draws`` acquisitions.

    Attributes
    ----------
    mean, sd
        Sample mean and standard deviation per coordinate.
    mean_se, sd_se
        Their standard errors.
    snr_db, snr_se_db
        20 log10(|mean| / sd) and its standard error. [dB]
    clipped_share
        Share of the acquisitions in which each raw channel clipped; zeros without clipping.
    any_clipped_share
        Share of the acquisitions in which any channel clipped.
    draws
        Number of acquisitions.
    """

    mean: Float[Array, " q"]
    sd: Float[Array, " q"]
    mean_se: Float[Array, " q"]
    sd_se: Float[Array, " q"]
    snr_db: Float[Array, " q"]
    snr_se_db: Float[Array, " q"]
    clipped_share: Float[Array, " p"]
    any_clipped_share: float
    draws: int

    def __post_init__(self) -> None:
        _check.freeze(
            self, "mean", "sd", "mean_se", "sd_se", "snr_db", "snr_se_db", "clipped_share"
        )


def monte_carlo(
    mean_e: Float[Array, " p"],
    pixel: Pixel,
    matrix: Float[Array, "q p"],
    *,
    draws: int,
    seed: int,
    name: tuple[int, ...] = (),
    clip: bool = False,
    noise: NoiseSources | None = None,
    progress: Callable[[int], None] = lambda _: None,
) -> Estimate:
    """Statistics of ``matrix @ raw`` over many noisy acquisitions of one point.

    Parameters
    ----------
    mean_e
        Expected electrons per channel. [e-]
    pixel
        The pixel, for its read noise, and its full well if ``clip`` is set.
    matrix
        One row per coordinate; the identity for the raw channels.
    draws
        Number of acquisitions, at least 2; the paper uses 5000.
    seed, name
        Seed and name of the random stream; see `chromanoise.rng.stream`.
    clip
        Clip each acquisition to 0 and full well, as a real sensor does. The paper does not clip.
    noise
        All noise sources of the pixel; ``None`` for shot noise and read noise only.
    progress
        Called with the number of draws finished since the last call.

    Raises
    ------
    InputError
        If there are fewer than 2 draws or more than 1e10, a mean is negative or not finite, or
        the matrix has not one column per channel.
    """
    mean_e = _check.non_negative("mean_e", "e-", mean_e)
    _check.same_length("channels", mean_e=mean_e.size, matrix=matrix.shape[1])
    if not 2 <= draws <= MOST_DRAWS:
        raise InputError(
            "draws", f"must be 2 (needed for a standard deviation) to {MOST_DRAWS:g}", value=draws
        )
    expected = matrix @ mean_e
    sums = np.zeros((4, matrix.shape[0]))  # of powers of the deviation from the expected value
    clipped = np.zeros(mean_e.shape)
    any_clipped = 0
    for chunk, start in enumerate(range(0, draws, _CHUNK)):
        count = min(_CHUNK, draws - start)
        rng = stream(seed, *name, chunk)
        means = np.broadcast_to(mean_e, (count, mean_e.size))
        raw = sample_electrons(means, pixel, rng, noise=noise)
        if clip:
            raw, hit = clipped_at_well(raw, pixel, noise=noise)
            clipped += hit.sum(axis=0)
            any_clipped += int(hit.any(axis=1).sum())
        deviation = raw @ matrix.T - expected
        sums += [(deviation**power).sum(axis=0) for power in (1, 2, 3, 4)]
        progress(count)
    return _estimate(expected, sums, clipped / draws, any_clipped / draws, draws)


def _estimate(
    expected: Float[Array, " q"],
    sums: Float[Array, "4 q"],
    clipped_share: Float[Array, " p"],
    any_clipped_share: float,
    draws: int,
) -> Estimate:
    shift, square, cube, fourth = sums / draws
    variance = np.maximum(square - shift**2, 0.0)
    m3 = cube - 3 * shift * square + 2 * shift**3
    m4 = fourth - 4 * shift * cube + 6 * shift**2 * square - 3 * shift**4
    sd = np.sqrt(variance * draws / (draws - 1))
    mean = expected + shift
    spread = variance > 0  # without it an SNR is inf or -inf and its error unknown
    seen = mean != 0
    v, m = np.where(spread, variance, 1.0), np.where(seen, mean, 1.0)
    with np.errstate(divide="ignore"):
        ratio = np.where(seen, np.abs(mean) / np.where(seen, sd, 1.0), 0.0)
        snr_db = 20 * np.log10(ratio)
    # delta method for log(mean / sd): both are sample moments and may covary (skewness)
    relative = v / m**2 + (m4 / v**2 - 1) / 4 - m3 / (m * v)
    snr_se_db = 20 / math.log(10) * np.sqrt(np.maximum(relative, 0.0) / draws)
    snr_se_db = np.where(spread & seen, snr_se_db, np.inf)
    return Estimate(
        mean=mean,
        sd=sd,
        mean_se=sd / math.sqrt(draws),
        sd_se=sd * np.sqrt(np.maximum(m4 / v**2 - 1, 0.0) / (4 * draws)),
        snr_db=snr_db,
        snr_se_db=snr_se_db,
        clipped_share=clipped_share,
        any_clipped_share=any_clipped_share,
        draws=draws,
    )
