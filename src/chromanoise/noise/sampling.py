"""Random noisy acquisitions: Poisson electrons plus Gaussian read noise."""

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Bool, Float
from chromanoise.errors import InputError
from chromanoise.sensor import Pixel

_MOST_E = 1e15  # above it double precision does not resolve single electrons


def sample_electrons(
    mean_e: Float[Array, "*px p"], pixel: Pixel, rng: np.random.Generator
) -> Float[Array, "*px p"]:
    """One noisy acquisition of every entry, unclipped: may be below 0 or above full well. [e-]

    Parameters
    ----------
    mean_e
        Expected electrons, >= 0. [e-]
    pixel
        The pixel, for its read noise.
    rng
        A random stream of `chromanoise.rng`.

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
    shot = rng.poisson(mean_e).astype(np.float64)
    return shot + pixel.read_noise_e * rng.standard_normal(shot.shape)


def clipped_at_well(
    electrons: Float[Array, "*px p"], pixel: Pixel
) -> tuple[Float[Array, "*px p"], Bool[Array, "*px p"]]:
    """Electrons clipped to 0 and full well, and a mask of the clipped ones."""
    held = np.clip(electrons, 0.0, pixel.full_well_e)
    return held, held != electrons
