"""The same pictures by numpy: tiles of rows on threads, float32, a generator for each tile.

Each function is what one would write by hand, with BLAS for the sums over the bands (on one thread
of its own: the tiles are what runs side by side) and a table for sRGB.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from subject import CHANNELS, SEED, Outputs, Plans

from chromanoise.imaging.plans import srgb_table

_TILE_ROWS = 32


def numpy_paths(plans: Plans, out: Outputs, threads: int) -> dict[str, Callable[[], object]]:
    """Electrons, raw and color of a whole cube into ``out``."""
    height = out.codes.shape[0]
    starts = range(0, height, _TILE_ROWS)

    def everywhere(tile: Callable[[slice], object]) -> Callable[[], object]:
        def run() -> None:
            with ThreadPoolExecutor(threads) as pool:
                list(pool.map(lambda s: tile(slice(s, min(s + _TILE_ROWS, height))), starts))

        return run

    def electrons(rows: slice) -> None:
        out.electrons[rows] = _electrons(plans, rows)

    return {
        "electrons": everywhere(electrons),
        "raw": everywhere(lambda rows: _raw(plans, out, rows)),
        "color": everywhere(lambda rows: _color(plans, out, rows)),
    }


def _electrons(plans: Plans, rows: slice) -> np.ndarray:
    stored = plans.light.cube.stored[rows]
    weights = plans.light.weights[:CHANNELS, : stored.shape[2]]
    if stored.flags.c_contiguous:
        return stored @ weights.T
    planes = np.moveaxis(stored, 2, 0)  # by band
    sums = weights @ planes.reshape(planes.shape[0], -1)
    return np.moveaxis(sums.reshape(CHANNELS, *planes.shape[1:]), 0, 2)


def _noisy(mean_e: np.ndarray, read_noise_e: np.float32, rows: slice) -> np.ndarray:
    rng = np.random.default_rng((SEED, rows.start))
    noisy = rng.poisson(mean_e).astype(np.float32)
    noisy += read_noise_e * rng.standard_normal(mean_e.shape, dtype=np.float32)
    return noisy


def _raw(plans: Plans, out: Outputs, rows: slice) -> None:
    tile = plans.raw.tile
    electrons = _electrons(plans, rows)
    height, width, _ = electrons.shape
    row, column = np.ogrid[rows.start : rows.start + height, :width]
    channel = tile[row % tile.shape[0], column % tile.shape[1]]
    mean_e = np.take_along_axis(electrons, channel[:, :, None], axis=2)[:, :, 0]
    full_well_e, dn_per_e, black_dn, top_dn = plans.raw.adc
    noisy = np.minimum(_noisy(mean_e, plans.raw.draw.reading_e, rows), full_well_e)
    codes = np.floor(noisy * dn_per_e + black_dn + np.float32(0.5))
    out.codes[rows] = np.clip(codes, 0, top_dn)


def _color(plans: Plans, out: Outputs, rows: slice) -> None:
    noisy = _noisy(_electrons(plans, rows), plans.color.draw.reading_e, rows)
    colors = noisy @ plans.color.matrices.T
    out.xyz[rows] = colors[:, :, :3]
    table = srgb_table()
    within = np.clip(colors[:, :, 3:], 0, 1)
    out.srgb[rows] = table[(within * (table.size - 1) + np.float32(0.5)).astype(np.int32)]
