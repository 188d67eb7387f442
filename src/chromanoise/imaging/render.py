"""A cube through a sensor to a noisy color picture, a few rows at a time."""

import zlib
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, UInt8

from chromanoise import _check
from chromanoise._check import Array
from chromanoise.color import adapted_to_d65, kernel_matrix, srgb_from_xyz
from chromanoise.exposure import Exposure, band_weights, expected_electrons
from chromanoise.noise import clipped_at_well, sample_electrons
from chromanoise.rng import stream
from chromanoise.scene import Cube, bands_within, flat_field
from chromanoise.scene.cube import reflectance_rows
from chromanoise.sensor import Sensor
from chromanoise.spectra import Beyond, Illuminant, Metric

_BLOCK_VALUES = 4_000_000  # reflectances held as float64 at a time: 32 MB


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """What a sensor and its matrix make of a cube.

    Attributes
    ----------
    sensor, exposure, illuminant, level_lux, metric, seed
        How it was made.
    xyz
        Linear XYZ with noise; Y = 1 for a perfect white seen by the same sensor.
    srgb
        8-bit sRGB, white-balanced on the illuminant.
    white
        XYZ of the perfect white in the units of ``xyz``.
    mean_e
        Mean expected electrons per channel over the picture. [e-]
    above_full_well
        Share of the noisy values per channel that exceed full well.
    clipped
        Whether these were held at full well, and negative ones at 0.
    notes
        What was assumed on the way.
    """

    sensor: Sensor
    exposure: Exposure
    illuminant: Illuminant
    level_lux: float
    metric: Metric
    seed: int
    xyz: Float[Array, "h w 3"]
    srgb: UInt8[Array, "h w 3"]
    white: Float[Array, " 3"]
    mean_e: Float[Array, " p"]
    above_full_well: Float[Array, " p"]
    clipped: bool
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        for pixels in (self.xyz, self.srgb):  # too large to copy
            pixels.flags.writeable = False
        _check.freeze(self, "white", "mean_e", "above_full_well")


def rendered(
    cube: Cube,
    sensor: Sensor,
    exposure: Exposure,
    illuminant: Illuminant,
    *,
    level_lux: float,
    metric: Metric = "quanta",
    seed: int = 0,
    beyond: Beyond = "refuse",
    clip: bool = False,
) -> Picture:
    """The noisy color picture of ``cube``: every channel at every pixel, then the kernel matrix.

    Parameters
    ----------
    cube
        Reflectances; its rows are read once, a few at a time.
    sensor, exposure, illuminant
        What looks at it, how, and in which light; sensor and illuminant share one grid.
    level_lux
        Illuminance on the scene. [lx]
    metric
        Of the kernel matrix.
    seed
        The same seed gives the same picture.
    beyond
        What the reflectances are where the cube ends short of the grid.
    clip
        Hold electrons between 0 and full well, as a real sensor does. The paper does not.

    Raises
    ------
    InputError
        If the cube holds what is no reflectance, ends short of the grid, or the seed is negative.
    """
    cube = bands_within(cube, sensor.grid)
    perfect_white = flat_field(illuminant, level_lux=level_lux)
    weights, notes = band_weights(cube, perfect_white, sensor, exposure, beyond=beyond)
    matrix = kernel_matrix(sensor, exposure, metric).matrix
    white_lux = matrix @ expected_electrons(perfect_white, sensor, exposure)
    _refuse_no_luminance(white_lux, sensor, illuminant)
    to_xyz, white = matrix / white_lux[1], white_lux / white_lux[1]
    height, width, _ = cube.stored.shape
    xyz = np.empty((height, width, 3), dtype=np.float32)
    srgb = np.empty((height, width, 3), dtype=np.uint8)
    mean_e = np.zeros(len(sensor.names))
    above = np.zeros(len(sensor.names))
    for start, stop in _row_blocks(cube):
        expected = reflectance_rows(cube, start, stop) @ weights
        electrons = _noisy_rows(expected, sensor, seed, start)
        mean_e += expected.sum(axis=(0, 1))
        above += (electrons > sensor.pixel.full_well_e).sum(axis=(0, 1))
        if clip:
            electrons, _ = clipped_at_well(electrons, sensor.pixel)
        xyz[start:stop] = electrons @ to_xyz.T
        srgb[start:stop] = _eight_bit(xyz[start:stop], white)
    return Picture(
        sensor=sensor,
        exposure=exposure,
        illuminant=illuminant,
        level_lux=level_lux,
        metric=metric,
        seed=seed,
        xyz=xyz,
        srgb=srgb,
        white=white,
        mean_e=mean_e / (height * width),
        above_full_well=above / (height * width),
        clipped=clip,
        notes=(*sensor.notes, *illuminant.notes, *cube.notes, *notes),
    )


def _refuse_no_luminance(
    white_lux: Float[Array, " 3"], sensor: Sensor, illuminant: Illuminant
) -> None:
    if not white_lux[1] > 0:
        raise _check.InputError(
            f"{sensor.name}: its kernel matrix gives a perfect white under {illuminant.name} a "
            f"luminance of {white_lux[1]:.3g} lx, so no picture can be scaled to it; take another "
            "light or sensor"
        )


def _noisy_rows(
    expected: Float[Array, "rows w p"], sensor: Sensor, seed: int, start: int
) -> Float[Array, "rows w p"]:
    """Each row has its own stream, so that no choice of blocks changes the picture."""
    who = zlib.crc32(sensor.name.encode())
    return np.stack(
        [
            sample_electrons(row, sensor.pixel, stream(seed, who, start + i))
            for i, row in enumerate(expected)
        ]
    )


def _row_blocks(cube: Cube) -> list[tuple[int, int]]:
    height, width, bands = cube.stored.shape
    rows = max(1, _BLOCK_VALUES // (width * bands))
    return [(start, min(start + rows, height)) for start in range(0, height, rows)]


def _eight_bit(xyz: Float[Array, "h w 3"], white: Float[Array, " 3"]) -> UInt8[Array, "h w 3"]:
    srgb = srgb_from_xyz(adapted_to_d65(xyz.astype(np.float64), white))
    return np.round(255 * srgb).astype(np.uint8)
