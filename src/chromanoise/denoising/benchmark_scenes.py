"""Scenes of the benchmark of denoising: a part of a cube with its edges and flat regions."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Integer
from chromanoise.errors import InputError
from chromanoise.scene import Cube
from chromanoise.scene.builtin import SLANTED_EDGES, builtin_cube
from chromanoise.scene.builtin.checker import PATCH_PX, patch_corners
from chromanoise.scene.builtin.slanted_edges import Region
from chromanoise.scene.rows import row_source

LEAST_CROP_PX = 24
"""Least side of a scene: 4 x 4 mosaics have planes of a quarter of it. [px]"""

_MARGIN_PX = 8  # of the flat part of a patch of the chart
_LEAST_FLAT_PX = 16  # of what a part of a cube leaves of a flat region: fewer show no noise


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BenchmarkScene:
    """A part of a cube, with its known edges and flat regions.

    Attributes
    ----------
    name
        In the tables.
    cube
        Only the part, in memory.
    edges
        Region of each slanted edge that lies wholly in the part, by kind and direction.
    flats
        Number of the flat region of each pixel, 0 for none; ``None`` if none is known. Regions of
        which the part holds less than 16 pixels are left out.
    """

    name: str
    cube: Cube
    edges: Mapping[str, Region] = field(default_factory=lambda: MappingProxyType({}))
    flats: Integer[Array, "h w"] | None = None


def benchmark_scene(
    scene: str | Cube, *, crop_px: int | None = None, name: str | None = None
) -> BenchmarkScene:
    """A scene of the benchmark, from the middle of a cube.

    Parameters
    ----------
    scene
        Name of a built-in cube, or a cube.
    crop_px
        Side of the part, at least 24; the whole cube by default. For ``builtin:slanted-edges`` the
        part starts at the first pixel, so that it holds whole edges. [px]
    name
        Name in the tables; that of the cube by default.

    Raises
    ------
    InputError
        If no built-in cube has the name, or the part is larger than the cube or below 24 px.

    Examples
    --------
    >>> sorted(benchmark_scene("builtin:slanted-edges", crop_px=128).edges)
    ['low-contrast vertical', 'luminance vertical']
    """
    cube = builtin_cube(scene) if isinstance(scene, str) else scene
    called = name or (scene if isinstance(scene, str) else cube.source)
    height, width, _ = cube.stored.shape
    rows, columns = (height, width) if crop_px is None else (crop_px, crop_px)
    for side, whole in ((rows, height), (columns, width)):
        if not LEAST_CROP_PX <= side <= whole:
            raise InputError(
                "crop_px",
                f"must be {LEAST_CROP_PX} to {min(height, width)} for the scene {called}",
                value=side,
            )
    edges = called == "builtin:slanted-edges"
    top, left = (0, 0) if edges else ((height - rows) // 2, (width - columns) // 2)
    part = np.array(row_source(cube.stored).rows(top, top + rows)[:, left : left + columns])
    flats = np.zeros((rows, columns), np.int64)
    for number, region in enumerate(_FLATS.get(called, ()), 1):
        marks = np.zeros((height, width), bool)
        marks[region] = True
        inside = marks[top : top + rows, left : left + columns]
        if np.count_nonzero(inside) >= _LEAST_FLAT_PX:
            flats[inside] = number
    return BenchmarkScene(
        name=called,
        cube=replace(cube, stored=part),
        edges={
            f"{edge.kind} {edge.direction}": edge.cell
            for edge in SLANTED_EDGES
            if edges and edge.rows[1] <= rows and edge.columns[1] <= columns
        },
        flats=flats if flats.any() else None,
    )


def _patches() -> tuple[Region, ...]:
    """The insides of the patches of the chart."""
    inside = PATCH_PX - _MARGIN_PX
    return tuple(
        (slice(top + _MARGIN_PX, top + inside), slice(left + _MARGIN_PX, left + inside))
        for top, left in patch_corners()
    )


_FLATS: Mapping[str, tuple[Region, ...]] = {
    "builtin:checker": _patches(),
    "builtin:slanted-edges": tuple(r for edge in SLANTED_EDGES for r in edge.flat_regions),
}
