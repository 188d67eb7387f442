"""Scenes: reflectances under an illuminant, and hyperspectral cubes."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.scene.builtin import (
        BUILTIN_CUBES as BUILTIN_CUBES,
        SLANTED_EDGES as SLANTED_EDGES,
        SlantedEdge as SlantedEdge,
        builtin_cube as builtin_cube,
        checker_cube as checker_cube,
        dead_leaves_cube as dead_leaves_cube,
        foliage_cube as foliage_cube,
        slanted_edges_cube as slanted_edges_cube,
    )
    from chromanoise.scene.cube import (
        Cube as Cube,
        bands_within as bands_within,
        flat_cube as flat_cube,
    )
    from chromanoise.scene.rows import (
        RowSource as RowSource,
        row_source as row_source,
    )
    from chromanoise.scene.scene import (
        Scene as Scene,
        flat_field as flat_field,
        light as light,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
