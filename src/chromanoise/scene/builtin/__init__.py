"""Built-in cubes, which need no file: a color chart and three synthetic scenes."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.scene.builtin.checker import checker_cube
    from chromanoise.scene.builtin.dead_leaves import dead_leaves_cube
    from chromanoise.scene.builtin.foliage import foliage_cube
    from chromanoise.scene.builtin.names import BUILTIN_CUBES, builtin_cube
    from chromanoise.scene.builtin.slanted_edges import (
        SLANTED_EDGES,
        SlantedEdge,
        slanted_edges_cube,
    )

__all__ = [
    "BUILTIN_CUBES",
    "SLANTED_EDGES",
    "SlantedEdge",
    "builtin_cube",
    "checker_cube",
    "dead_leaves_cube",
    "foliage_cube",
    "slanted_edges_cube",
]
__getattr__, __dir__ = lazy_names(__name__)
