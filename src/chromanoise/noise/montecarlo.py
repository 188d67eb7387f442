"""Random noisy acquisitions, and the Monte Carlo simulation that checks the closed form.

Electrons are Poisson plus Gaussian read noise; simulated values have standard errors.
"""

import math
from collections.abc import Callable

import numpy as np

from chromanoise.base import Array, Bool, Float, InputError, check, dataclass, stream
from chromanoise.noise.readout import refuse_many
from chromanoise.noise.variance import CrosstalkPattern, NoiseSources
from chromanoise.sensor import NORMAL, Pixel

_MOST_E = 1e15  # above it double precision does not resolve single electrons


def sample_electrons(
    mean_e: Float[Array, "*px p"],
    pixel: Pixel,
    rng: "np.random.Generator",
    *,
    noise: NoiseSources | None = None,
) -> Float[Array, "*px p"]:
    """One noisy acquisition of every entry, unclipped: may be below 0 or above full well. [e-]

    All sources are independent between entries, row and column noise too. If crosstalk before
    counting makes a fixed pattern, each pixel has a random place of the mosaic. Crosstalk after
    counting is not drawn.

    Parameters
    ----------
    mean_e
        Expected electrons of the light, >= 0. [e-]
    pixel
        The pixel, for its read noise.
    rng
        A random stream of ``rng``.
    noise
        All noise sources; ``None`` for shot noise and read noise only.

    Raises
    ------
    InputError
        If a mean is negative, not finite, or above 1e15.
    """
    mean_e = check.non_negative("mean_e", "e-", mean_e)
    refuse_many(mean_e, _MOST_E, "to be counted", "take less light or a shorter time")
    if noise is None or not noise.beyond_shot_and_read:
        shot = rng.poisson(mean_e).astype(np.float64)
        return shot + pixel.read_noise_e * rng.standard_normal(shot.shape)
    if noise.pattern is not None:
        mean_e = _at_places(mean_e, noise.pattern, rng)
    if noise.readings > 1:
        total, n = np.zeros_like(mean_e), noise.readings
        for _ in range(n):
            total += sample_electrons(mean_e / n, pixel, rng, noise=noise.one_reading)
        return total
    gain = 1.0 + noise.sd("gain") * rng.standard_normal(mean_e.shape)
    electrons = rng.poisson(mean_e * np.maximum(gain, 0.0) + noise.dark_e).astype(np.float64)
    for drawn in NORMAL:
        sd = noise.sd(drawn)
        if sd or drawn != "column":  # streams from before columns were drawn stay as they were
            electrons += sd * rng.standard_normal(mean_e.shape)
    share, away_e = noise.levels
    if share:
        chances, summed = [1 - share, share / 2, share / 2], int(noise.pixel.summed_readings)
        if summed == 1:
            electrons += rng.choice([0.0, away_e, -away_e], mean_e.shape, p=chances)
        else:
            _, up, down = np.moveaxis(rng.multinomial(summed, chances, mean_e.shape), -1, 0)
            electrons += (up - down) * away_e / math.sqrt(summed)
    electrons += noise.black_error_e - noise.dark_e
    if noise.step_e:
        electrons = noise.step_e * np.floor(electrons / noise.step_e + 0.5)
    return electrons


def _at_places(
    mean_e: Float[Array, "*px p"], pattern: CrosstalkPattern, rng: "np.random.Generator"
) -> Float[Array, "*px p"]:
    """Expected electrons at a place of each channel, all equally probable. [e-]"""
    found = np.empty_like(mean_e)
    for i in range(mean_e.shape[-1]):
        means = pattern.means_e(mean_e, i)
        place = rng.integers(0, means.shape[-1], (*mean_e.shape[:-1], 1))
        found[..., i] = np.take_along_axis(means, place, axis=-1)[..., 0]
    return found


def clipped_at_well(
    electrons: Float[Array, "*px p"], pixel: Pixel, *, noise: NoiseSources | None = None
) -> tuple[Float[Array, "*px p"], Bool[Array, "*px p"]]:
    """Electrons clipped to 0 and full well, and a mask of the clipped ones.

    Parameters
    ----------
    electrons
        Of `sample_electrons`, the mean dark signal subtracted. [e-]
    pixel
        The pixel, for its full well, which dark electrons fill too.
    noise
        As `sample_electrons`.
    """
    most = pixel.full_well_e
    if noise is not None:
        most += noise.black_error_e - noise.dark_e
    held = np.clip(electrons, 0.0, most)
    return held, held != electrons


MOST_DRAWS = 10**10
_CHUNK = 65_536  # acquisitions per random stream; bounds the memory


@dataclass(frozen=True, kw_only=True, eq=False)
class Estimate:
    """Statistics of ``q`` linear coordinates over ``draws`` acquisitions.

    Attributes
    ----------
    mean, sd
        Sample mean and standard deviation per coordinate.
    mean_se, sd_se
        Standard errors of mean and standard deviation.
    snr_db, snr_se_db
        20 log10(|mean| / sd) and its standard error. [dB]
    clipped_share
        Share of the acquisitions in which each raw channel clipped; zeros without clipping.
    any_clipped_share
        Share of the acquisitions in which any channel clipped.
    draws
        Number of acquisitions that were drawn.
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
        check.freeze(self, "mean", "sd", "mean_se", "sd_se", "snr_db", "snr_se_db", "clipped_share")


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
        Seed and name of the random stream; see `chromanoise.base.stream`.
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
    mean_e = check.non_negative("mean_e", "e-", mean_e)
    check.same_length("channels", mean_e=mean_e.size, matrix=matrix.shape[1])
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
