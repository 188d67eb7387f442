"""The noise of `imaging.sampling` by the plain numpy of `imaging.plain`."""

import numpy as np

from chromanoise.imaging.blocks import LIGHT
from chromanoise.imaging.plain import electrons_of, philox4x32 as philox4x32, words_of


def light_words(shape, **place):
    """The words of shot noise, and of shot and read noise drawn as one: (h, w, p) of uint32."""
    return words_for(LIGHT, shape, **place)


def words_for(purpose, shape, *, seed, frame=0, first_row=0, first_column=0, width=None):
    """One word for each channel of each pixel."""
    height, own_width, channels = shape
    rows = first_row + np.arange(height)[:, None, None]
    columns = first_column + np.arange(own_width)[:, None]
    pixel = rows * (own_width if width is None else width) + columns
    return words_of(pixel, purpose, frame, np.arange(channels), seed)


def noisy_electrons(mean_e, *, read_noise_e, **place):
    """What chromanoise.imaging.noisy_electrons returns."""
    mean = np.asarray(mean_e, np.float32)
    return electrons_of(
        mean, lambda purpose: words_for(purpose, mean.shape, **place), np.float32(read_noise_e)
    )
