"""Numbers with names that the compiled functions take as they are: tuples, not dataclasses."""

from typing import NamedTuple

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float32, Num


class Layout(NamedTuple):
    """How a block of rows lies in memory: its bands, and the steps between neighbors. [numbers]

    Where the step from pixel to pixel is 1, the pixels of a band lie together; otherwise the bands
    of a pixel do.
    """

    bands: int
    row_pitch: int
    pixel_pitch: int
    band_pitch: int


class RowsInMemory(NamedTuple):
    """Rows of a cube as they lie in memory, and what makes electrons of their numbers."""

    flat: Num[Array, " numbers"]
    """From the first band of the first pixel on."""
    lay: Layout
    weights: Float32[Array, "channels bands"]
    """Channels rounded up to 4, bands rounded up to 16, the rest 0."""
    seen: Float32[Array, "16"]
    """The least number so far in each of `LANES`, then the greatest."""


class Draw(NamedTuple):
    """Which noise: its strengths, and where its random words come from."""

    read_noise_e: np.float32
    prnu: np.float32
    dark_e: np.float32
    dsnu_e: np.float32
    row_noise_e: np.float32
    noisy: bool
    """Whether there are shot noise and read noise; the imperfections stay."""
    key: np.uint64
    frame: np.uint64


class Converter(NamedTuple):
    """From electrons to codes."""

    most_e: np.float32
    """What dark electrons leave of the full well."""
    dn_per_e: np.float32
    black_dn: np.float32
    top_dn: np.float32


class Well(NamedTuple):
    """What dark electrons leave of the full well, and whether electrons are held at 0 and there."""

    most_e: np.float32
    held: bool
