"""Denoising in strips of rows on several threads; the result is bit-identical for any number."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float32
from chromanoise.denoising.method import DenoisingMethod
from chromanoise.denoising.planes import NoisyPlanes
from chromanoise.imaging.blocks import Scratch, new_rows
from chromanoise.imaging.render import ALL_CORES
from chromanoise.imaging.work import Work, filled, threads_of

_FEWEST_ROWS = 128


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Denoising:
    """What a strip needs."""

    planes: NoisyPlanes
    method: DenoisingMethod


def denoised_planes(
    planes: NoisyPlanes, method: DenoisingMethod, *, work: Work = ALL_CORES
) -> Float32[Array, "h w p"]:
    """The planes after a denoising method. [e-]

    Parameters
    ----------
    planes
        Noisy values and their noise.
    method
        Of `DENOISING`.
    work
        Threads and rows per strip; an executor is not used, because the planes are in memory here.
        The result is bit-identical for any setting.

    Notes
    -----
    A strip is denoised with ``reach_px`` rows on each side, so that its rows have the values of the
    whole picture. Strips begin at multiples of ``grid_px``.
    """
    height, width, count = planes.values_e.shape
    out = new_rows((height, width, count), np.float32)
    if method.reach_px is None:
        blocks = [(0, height)]
    else:
        threads = threads_of(work)
        rows = work.tile_rows or max(_FEWEST_ROWS, 2 * method.reach_px, -(-height // threads))
        rows = -(-rows // method.grid_px) * method.grid_px
        blocks = [(start, min(start + rows, height)) for start in range(0, height, rows)]
    plan = _Denoising(planes=planes, method=method)
    filled(_denoised_strip, plan, blocks, (out,), replace(work, executor=None))
    return out


def _denoised_strip(
    plan: _Denoising, start: int, stop: int, scratch: Scratch, out: Float32[Array, "rows w p"]
) -> Any:
    """Fill ``out`` with the rows ``start`` to ``stop``."""
    reach, grid = plan.method.reach_px, plan.method.grid_px
    if reach is None:
        out[:] = plan.method.denoise(plan.planes)
        return
    first = max(0, (start - reach) // grid * grid)
    last = min(plan.planes.values_e.shape[0], stop + reach)
    out[:] = plan.method.denoise(plan.planes.rows(first, last))[start - first : stop - first]
