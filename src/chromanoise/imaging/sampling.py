"""Noisy electrons of an image, bit-identical for any tiles, threads and order of work."""

import os
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from chromanoise.base import Array, Float, Float32, InputError, check
from chromanoise.imaging.blocks import new_rows
from chromanoise.imaging.kernel_cache import kernel_of

_CHUNK_LANES = 1 << 16  # values per task of a thread, about a millisecond
_PIXEL_BITS, _FRAME_BITS, _SEED_BITS = 48, 32, 64  # what the counter holds, see philox.py
_MOST_CHANNELS = 1 << 16
_MOST_E = 1e12  # its square is still a float32


def noisy_electrons(
    mean_e: Float[Array, "h w p"],
    *,
    read_noise_e: float,
    seed: int,
    frame: int = 0,
    first_row: int = 0,
    first_column: int = 0,
    width: int | None = None,
    threads: int | None = None,
) -> Float32[Array, "h w p"]:
    """One sample of the electrons after readout: Poisson(M) + s Z in every channel. [e-]

    Parameters
    ----------
    mean_e
        Expected electrons per channel, >= 0; taken as float32. [e-]
    read_noise_e
        Standard deviation of the readout, >= 0. [e-]
    seed
        0 to 2^64 - 1.
    frame
        Number of the frame in a burst, 0 to 2^32 - 1.
    first_row, first_column, width
        Position of ``mean_e`` in an image of this width [pixels], so that a tile has the same noise
        as in the whole image. By default ``mean_e`` has the full width.
    threads
        Number of threads; one per core by default.

    Raises
    ------
    InputError
        If a mean or the read noise is negative or not finite, if the tile does not fit into the
        width, or if seed, frame or pixel index exceed the range of the counter.

    Notes
    -----
    Salmon, Moraes, Dror & Shaw, SC11 (2011), for the counter-based words; each variate takes one
    word of 32 bits through its quantile function, so it increases with the mean below and above
    20 e- separately, and probabilities below 2^-32 do not occur.

    Below 20 e- the Poisson quantile is exact, and read noise uses a separate word. From 20 e- on
    quantiles are Cornish-Fisher expansions. Of Poisson(M) alone: to the order M^-3/2 (its first
    three terms: Giles, "Algorithm 955", ACM TOMS 42 (2016)); it differs by 1 e- from the exact one
    in 1 of 10,000 draws at most. With s of .75 e- or more: of the sum Poisson(M) + s Z from one
    word, to the order 1 / (M + s^2), its probabilities are within 5e-6 of the exact ones. Here
    read noise is not added to a separate integer number of electrons.

    Examples
    --------
    The lower half of an image is the same when it is computed separately.

    >>> mean = np.full((4, 6, 3), 50.0)
    >>> whole = noisy_electrons(mean, read_noise_e=2.0, seed=7)
    >>> half = noisy_electrons(mean[2:], read_noise_e=2.0, seed=7, first_row=2)
    >>> bool((whole[2:] == half).all())
    True

    No light gives no electrons.

    >>> float(noisy_electrons(np.zeros((2, 2, 1)), read_noise_e=0.0, seed=7).max())
    0.0
    """
    noise = check.within("read_noise_e", "e-", read_noise_e, 0.0, _MOST_E)
    height, own_width, channels = mean_e.shape
    width = own_width if width is None else width
    check.whole_of_bits("seed", seed, _SEED_BITS)
    check.whole_of_bits("frame", frame, _FRAME_BITS)
    check.at_least_one("threads", threads)
    _demand_room(mean_e.shape, first_row, first_column, width)
    with np.errstate(over="ignore"):  # values above float32 are refused as infinite
        mean = np.ascontiguousarray(mean_e, dtype=np.float32).reshape(-1, channels)
    electrons = new_rows(mean.shape, np.float32)
    if electrons.size:
        place = (own_width, first_row * width + first_column, width)
        stream = (np.uint64(frame), np.uint64(seed), np.float32(noise))
        refused = _fill(mean, electrons, (*place, *stream), threads)
        if refused:
            check.non_negative("mean_e", "e-", mean.reshape(mean_e.shape))
    return electrons.reshape(height, own_width, channels)


def _fill(
    mean: Float32[Array, "n p"],
    electrons: Float32[Array, "n p"],
    settings: tuple[Any, ...],
    threads: int | None,
) -> int:
    """Fill ``electrons`` chunk by chunk; the result is the number of refused means.

    ``settings`` are the last arguments of the kernel: place in the picture, and noise.
    """
    fill_noise = kernel_of("noise_draws", "fill_noise", mean.size)
    pixels, channels = mean.shape
    step = max(1, _CHUNK_LANES // channels)

    def fill(start: int) -> int:
        return int(fill_noise(mean, electrons, start, min(start + step, pixels), *settings))

    starts = range(0, pixels, step)
    workers = min(threads or os.cpu_count() or 1, len(starts))
    if workers == 1:
        return sum(map(fill, starts))
    with ThreadPoolExecutor(workers) as pool:
        return sum(pool.map(fill, starts))


def _demand_room(shape: tuple[int, ...], first_row: int, first_column: int, width: int) -> None:
    height, own_width, channels = shape
    if first_row < 0 or first_column < 0 or first_column + own_width > width:
        raise InputError(
            "width",
            f"must hold a tile {own_width} pixels wide at row {first_row} and column "
            f"{first_column} [pixels]",
            value=width,
            remedy="give the width of the whole picture",
        )
    if (first_row + height) * width > 1 << _PIXEL_BITS:
        raise InputError(
            "the picture",
            f"must have at most 2^{_PIXEL_BITS} pixels, because random words are counted up to "
            "that",
            value=(first_row + height) * width,
            found=f"has {(first_row + height) * width}",
            remedy="give its parts seeds of their own",
        )
    if not 1 <= channels <= _MOST_CHANNELS:
        raise InputError(
            "mean_e",
            f"must have 1 to {_MOST_CHANNELS} channels",
            value=channels,
            found=f"has {channels}",
        )
