"""Conversion of a block of a cube's rows to expected electrons, with checks of the reflectances."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float32, Int64
from chromanoise.exposure import OperatingPoint, band_weights, white_scene
from chromanoise.imaging.blocks import (
    CHANNELS_AT_ONCE,
    LANES,
    PADDED_BANDS,
    Scratch,
    flattened,
    is_planar,
)
from chromanoise.imaging.records import RowsInMemory
from chromanoise.scene import Cube
from chromanoise.scene.cube import BRIGHTEST, reflectance_rows
from chromanoise.scene.rows import RowSource, row_source
from chromanoise.spectra import Beyond

_MOST_E = 1e30  # per stored number: so that the sum of all bands fits in float32

BadPixels = Literal["refuse", "zero"]
"""Handling of invalid reflectances."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Light:
    """Parameters for converting the numbers of a cube to expected electrons.

    Attributes
    ----------
    cube
        The cube that is read.
    weights
        Electrons per stored number, with channels and bands padded with zeros. [e-]
    channels
        Number of channels without padding.
    notes
        Assumptions on the spectra.
    planar
        Whether sums run over pixels of a band (planar) or over bands of a pixel.
    bad_pixels
        Handling of invalid reflectances: ``refuse``, or ``zero``.
    first_row
        Row of the image that is the first row of the cube; above 0 if only a part was sent.
    """

    cube: Cube
    weights: Float32[Array, "q l"]
    channels: int
    notes: tuple[str, ...]
    planar: bool
    bad_pixels: BadPixels = "refuse"
    first_row: int = 0

    @property
    def source(self) -> RowSource:
        """Of the rows."""
        return row_source(self.cube.stored)


def light_of(
    cube: Cube, operating_point: OperatingPoint, *, beyond: Beyond, bad_pixels: BadPixels = "refuse"
) -> Light:
    """Eq. 2 for this cube and operating point, as one weight per band and channel.

    Raises
    ------
    InputError
        As `band_weights`, or if the number of electrons is out of range.
    """
    white, sensor = white_scene(operating_point), operating_point.sensor
    weights, notes = band_weights(cube, white, sensor, operating_point.exposure, beyond=beyond)
    bands, channels = weights.shape
    shape = (_up_to(CHANNELS_AT_ONCE, channels), _up_to(PADDED_BANDS, bands))
    padded = np.zeros(shape, np.float32)
    most = float(np.abs(weights).max() * cube.scale)
    _check.within(f"electrons per number of {cube.source}", "e-", most, 0.0, _MOST_E)
    padded[:channels, :bands] = (weights * cube.scale).T
    return Light(
        cube=cube,
        weights=padded,
        channels=channels,
        notes=notes,
        planar=is_planar(row_source(cube.stored)),
        bad_pixels=bad_pixels,
    )


def _up_to(multiple: int, count: int) -> int:
    return -(-count // multiple) * multiple


def on_rows(
    light: Light,
    start: int,
    stop: int,
    scratch: Scratch,
    sums: Array,
    fill: Callable[[RowsInMemory], None],
) -> Int64[Array, " rows"]:
    """Read the rows and call ``fill``, which fills ``sums``; the result is bad pixels per row.

    Raises
    ------
    InputError
        If a reflectance is invalid and bad pixels are refused.
    """
    source = light.source
    start, stop = start - light.first_row, stop - light.first_row
    block = source.rows(start, stop, into=scratch.of(source.scratch_bytes(stop - start)))
    bad = np.zeros(stop - start, np.int64)
    if _were_reflectances(light, block, sums, fill):
        return bad
    if light.bad_pixels == "zero":
        mended, bad = _mended(block, light.cube.scale)
        sums[...] = 0
        _were_reflectances(light, mended, sums, fill)
    else:
        # raises an error with the value and its position
        reflectance_rows(light.cube, start, stop, first_row=light.first_row)
    return bad


def _were_reflectances(
    light: Light, block: Array, sums: Array, fill: Callable[[RowsInMemory], None]
) -> bool:
    """Call ``fill``; the result is whether all reflectances were valid."""
    flat, lay = flattened(block, planar=light.planar)
    seen = np.repeat(np.array([3e38, -3e38], np.float32), LANES)
    fill(RowsInMemory(flat=flat, lay=lay, weights=light.weights, seen=seen))
    lowest, highest = float(seen[:LANES].min()), float(seen[LANES:].max())
    known = lowest >= 0 and highest * light.cube.scale <= BRIGHTEST
    return bool(known and np.isfinite(sums).all())


def _mended(block: Array, scale: float) -> tuple[Array, Int64[Array, " rows"]]:
    """The block with 0 for invalid reflectances, and the number of such pixels per row."""
    with np.errstate(invalid="ignore", over="ignore"):
        rho = block.astype(np.float64) * scale
    bad = ~((rho >= 0) & (rho <= BRIGHTEST))
    kind = np.float32 if block.dtype.itemsize < 8 else np.float64
    return np.where(bad, 0, block).astype(kind), bad.any(axis=2).sum(axis=1)
