"""Random noisy acquisitions: Poisson electrons plus Gaussian read noise."""

import math

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.errors import InputError
from chromanoise.noise.sources import CrosstalkPattern, NoiseSources
from chromanoise.sensor import Pixel
from chromanoise.sensor.noise_source import NORMAL

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
        A random stream of `chromanoise.rng`.
    noise
        All noise sources; ``None`` for shot noise and read noise only.

    Raises
    ------
    InputError
        If a mean is negative, not finite, or above 1e15.
    """
    mean_e = _check.non_negative("mean_e", "e-", mean_e)
    if mean_e.size and mean_e.max() > _MOST_E:
        most = float(mean_e.max())
        raise InputError(
            "mean_e",
            f"must be at most {_MOST_E:g} [e-] to be counted",
            value=most,
            found=f"reaches {most:g}",
            remedy="take less light or a shorter time",
        )
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
