"""What is photographed: cubes of 400-1050 nm and a sensor of four channels at 10 lx.

The functions that fill a picture are called with outputs that are used again, because the first
touch of fresh memory is no work of theirs; how much it adds is measured beside it.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from chromanoise.color import kernel_matrix
from chromanoise.imaging.plans import (
    ColorPlan,
    ElectronPlan,
    Light,
    RawPlan,
    color_block,
    color_matrices,
    draw_of,
    electron_block,
    light_of,
    raw_block,
    raw_plan,
    well_of,
)
from chromanoise.imaging.shared_rows import Work, filled, row_blocks
from chromanoise.noise import Exposure, OperatingPoint
from chromanoise.sensor import adc_to_full_well, rgbw_sparse_4x4
from chromanoise.spectra import DEFAULT_GRID, Cube, equal_energy
from chromanoise.study import sensor_named

BANDS = 131
CHANNELS = 4
SEED = 7
_REPEATED_ROWS = 64  # drawing 2 GB of numbers would take longer than all that is measured


def operating_point() -> OperatingPoint:
    """The paper's RGBW sensor, 12 ms at 10 lx: up to 10,000 electrons."""
    return OperatingPoint(
        sensor=sensor_named("onyx-rgbw", DEFAULT_GRID),
        exposure=Exposure(time_s=0.012),
        illuminant=equal_energy(DEFAULT_GRID),
        level_lux=10.0,
    )


def textured(rows: int, width: int, bands: int = BANDS) -> np.ndarray:
    """Reflectances (rows, width, bands) float32: from dark to white pixels, bands apart."""
    rng = np.random.default_rng(1)
    brightness = rng.uniform(0.02, 0.9, (rows, width, 1)).astype(np.float32)
    return brightness * rng.uniform(0.8, 1.1, (rows, width, bands)).astype(np.float32)


def cube_of(stored: np.ndarray) -> Cube:
    """An array as a cube whose bands lie evenly from 400 to 1050 nm."""
    wavelength_nm = np.linspace(400.0, 1050.0, stored.shape[2])
    return Cube(wavelength_nm=wavelength_nm, stored=stored, source="a textured cube")


def large_cubes(height: int, width: int) -> tuple[Cube, Cube]:
    """The same reflectances by pixel (BIP) and by band (BSQ)."""
    rows = textured(_REPEATED_ROWS, width)
    by_pixel = np.empty((height, width, BANDS), np.float32)
    by_band = np.empty((BANDS, height, width), np.float32)
    planes = np.ascontiguousarray(np.moveaxis(rows, 2, 0))
    for start in range(0, height, _REPEATED_ROWS):
        n = min(_REPEATED_ROWS, height - start)
        by_pixel[start : start + n] = rows[:n]
        by_band[:, start : start + n] = planes[:, :n]
    return cube_of(by_pixel), cube_of(np.moveaxis(by_band, 0, 2))


@dataclass(frozen=True, slots=True)
class Outputs:
    """Arrays that every contender fills again."""

    electrons: np.ndarray
    codes: np.ndarray
    xyz: np.ndarray
    srgb: np.ndarray


def outputs_for(height: int, width: int) -> Outputs:
    """Memory that has been touched."""
    return Outputs(
        electrons=np.ones((height, width, CHANNELS), np.float32),
        codes=np.ones((height, width), np.uint16),
        xyz=np.ones((height, width, 3), np.float32),
        srgb=np.ones((height, width, 3), np.uint8),
    )


@dataclass(frozen=True, slots=True)
class Plans:
    """One cube's plans for the three paths."""

    light: Light
    electrons: ElectronPlan
    raw: RawPlan
    color: ColorPlan


def plans_of(cube: Cube) -> Plans:
    """As `chromanoise.imaging.rendered` and its siblings make them."""
    at = operating_point()
    light, draw = light_of(cube, at, beyond="refuse"), draw_of(at, seed=SEED)
    _, matrices, _ = color_matrices(kernel_matrix(at.sensor, at.exposure), at)
    well = well_of(at, draw, held=False)
    adc = adc_to_full_well(at.sensor.pixel)
    return Plans(
        light=light,
        electrons=ElectronPlan(light=light),
        raw=raw_plan(light, draw, at, rgbw_sparse_4x4(), adc, None),
        color=ColorPlan(light=light, draw=draw, well=well, matrices=matrices, coupling=None),
    )


def engine(plans: Plans, out: Outputs, threads: int) -> dict[str, Callable[[], object]]:
    """The three paths of chromanoise into ``out``."""
    work = Work(threads=threads)
    blocks = row_blocks(plans.light.source, work)
    return {
        "electrons": lambda: filled(
            electron_block, plans.electrons, blocks, (out.electrons,), work
        ),
        "raw": lambda: filled(raw_block, plans.raw, blocks, (out.codes,), work),
        "color": lambda: filled(color_block, plans.color, blocks, (out.xyz, out.srgb), work),
    }
