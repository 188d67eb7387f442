"""Named tuples of parameters; numba accepts these directly, but not dataclasses."""

from typing import NamedTuple

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float32, Num


class Layout(NamedTuple):
    """Memory layout of a block of rows: number of bands, and strides. [numbers]

    If the stride from pixel to pixel is 1, the pixels of a band are contiguous; otherwise the bands
    of a pixel are.
    """

    bands: int
    row_pitch: int
    pixel_pitch: int
    band_pitch: int


class RowsInMemory(NamedTuple):
    """Rows of a cube as stored in memory, and the weights from stored numbers to electrons."""

    flat: Num[Array, " numbers"]
    """Flat array that starts at the first band of the first pixel."""
    lay: Layout
    weights: Float32[Array, "channels bands"]
    """Shape: channels rounded up to 4, bands rounded up to 16; padded with 0."""
    seen: Float32[Array, "16"]
    """The smallest number so far in each of `LANES` lanes, then the largest."""


class Draw(NamedTuple):
    """Standard deviations, as `chromanoise.sensor.noise_source.Drawn`, bias, and random words."""

    reading_e: np.float32
    gain: np.float32
    pattern_e: np.float32
    row_e: np.float32
    column_e: np.float32
    level_share: np.float32
    levels_e: np.float32
    readings: int
    """Readings that are summed, each with its own level."""
    dark_e: np.float32
    black_error_e: np.float32
    noisy: bool
    """Whether there is shot noise."""
    key: np.uint64
    frame: np.uint64


class Converter(NamedTuple):
    """Converter from electrons to codes."""

    most_e: np.float32
    """Full well minus dark electrons, plus the error of the black level."""
    dn_per_e: np.float32
    black_dn: np.float32
    top_dn: np.float32


class Well(NamedTuple):
    """Full well as `Converter`, and whether electrons are clipped to 0 and to it."""

    most_e: np.float32
    held: bool
