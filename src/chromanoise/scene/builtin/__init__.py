"""Built-in cubes, which need no file: a color chart and three synthetic scenes."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.scene.builtin.checker import checker_cube as checker_cube
    from chromanoise.scene.builtin.dead_leaves import dead_leaves_cube as dead_leaves_cube
    from chromanoise.scene.builtin.foliage import foliage_cube as foliage_cube
    from chromanoise.scene.builtin.names import (
        BUILTIN_CUBES as BUILTIN_CUBES,
        builtin_cube as builtin_cube,
    )
    from chromanoise.scene.builtin.slanted_edges import (
        SLANTED_EDGES as SLANTED_EDGES,
        SlantedEdge as SlantedEdge,
        slanted_edges_cube as slanted_edges_cube,
    )

__getattr__, __dir__, __all__ = lazy_names(__name__)
