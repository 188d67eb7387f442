"""Scenes: reflectances under an illuminant, and hyperspectral cubes."""

from typing import TYPE_CHECKING

from chromanoise._lazy import lazy_names

if TYPE_CHECKING:
    from chromanoise.scene.builtin import (
        BUILTIN_CUBES,
        builtin_cube,
        checker_cube,
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
    "Cube",
    "RowSource",
    "Scene",
    "bands_within",
    "builtin_cube",
    "checker_cube",
    "flat_cube",
    "flat_field",
    "light",
    "row_source",
]
__getattr__, __dir__ = lazy_names(__name__)
