"""Scenes: reflectances under an illuminant, and hyperspectral cubes."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.scene.builtin import (
        BUILTIN_CUBES,
        SLANTED_EDGES,
        SlantedEdge,
        builtin_cube,
        checker_cube,
        dead_leaves_cube,
        foliage_cube,
        slanted_edges_cube,
    )
    from chromanoise.scene.cube import (
        Cube,
        bands_within,
        flat_cube,
    )
    from chromanoise.scene.rows import (
        RowSource,
        row_source,
    )
    from chromanoise.scene.scene import (
        Scene,
        flat_field,
        light,
    )

__all__ = [
    "BUILTIN_CUBES",
    "SLANTED_EDGES",
    "Cube",
    "RowSource",
    "Scene",
    "SlantedEdge",
    "bands_within",
    "builtin_cube",
    "checker_cube",
    "dead_leaves_cube",
    "flat_cube",
    "flat_field",
    "foliage_cube",
    "light",
    "row_source",
    "slanted_edges_cube",
]
__getattr__, __dir__ = lazy_names(__name__)
