"""How a block of a cube's rows becomes expected electrons, and what is refused on the way."""

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

_MOST_E = 1e30  # of one stored number: what float32 can hold, and the sum of all bands

BadPixels = Literal["refuse", "zero"]
"""What is done with a number that is no reflectance."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Light:
    """How the numbers of a cube become expected electrons.

    Attributes
    ----------
    cube
        Where they are read.
    weights
        Electrons per stored number, channels and bands filled up with zeros. [e-]
    channels
        How many are real.
    notes
        What was assumed of the spectra.
    planar
        In which order its sums are taken.
    bad_pixels
        What is done with numbers that are no reflectance: ``refuse``, or ``zero``.
    first_row
        Of the picture, that is the cube's first: more than 0 where only a part was sent.
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
    """Eq. 2 for this cube in this operating point, folded into one weight per band and channel.

    Raises
    ------
    InputError
        As `band_weights`, or if its electrons are more than can be counted.
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
    """Read the rows and do the work, which fills ``sums``; pixels of each row that were bad.

    Raises
    ------
    InputError
        If a number is no reflectance and bad pixels are refused.
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
        # says which value is wrong, and where
        reflectance_rows(light.cube, start, stop, first_row=light.first_row)
    return bad


def _were_reflectances(
    light: Light, block: Array, sums: Array, fill: Callable[[RowsInMemory], None]
) -> bool:
    """Do the work; whether all numbers were reflectances."""
    flat, lay = flattened(block, planar=light.planar)
    seen = np.repeat(np.array([3e38, -3e38], np.float32), LANES)
    fill(RowsInMemory(flat=flat, lay=lay, weights=light.weights, seen=seen))
    lowest, highest = float(seen[:LANES].min()), float(seen[LANES:].max())
    known = lowest >= 0 and highest * light.cube.scale <= BRIGHTEST
    return bool(known and np.isfinite(sums).all())


def _mended(block: Array, scale: float) -> tuple[Array, Int64[Array, " rows"]]:
    """The block with 0 for every number that is no reflectance; pixels that had one, per row."""
    with np.errstate(invalid="ignore", over="ignore"):
        rho = block.astype(np.float64) * scale
    bad = ~((rho >= 0) & (rho <= BRIGHTEST))
    kind = np.float32 if block.dtype.itemsize < 8 else np.float64
    return np.where(bad, 0, block).astype(kind), bad.any(axis=2).sum(axis=1)
