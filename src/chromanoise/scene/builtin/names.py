"""The names of the built-in cubes."""

from importlib import import_module

from chromanoise import _check
from chromanoise.scene.cube import Cube

_MAKERS = {
    "builtin:checker": "checker_cube",
    "builtin:dead-leaves": "dead_leaves_cube",
    "builtin:slanted-edges": "slanted_edges_cube",
    "builtin:foliage": "foliage_cube",
}  # by name, because every command lists the cubes and few make one
BUILTIN_CUBES = tuple(_MAKERS)
"""The names of all built-in cubes, such as ``builtin:checker``."""


def builtin_cube(name: str) -> Cube:
    """The cube with the name ``builtin:...``.

    Parameters
    ----------
    name
        Name of the cube, such as ``builtin:checker``.

    Raises
    ------
    InputError
        If no built-in cube has this name.
    """
    name = _check.one_of("scene", name, BUILTIN_CUBES)
    cube: Cube = getattr(import_module("chromanoise.scene.builtin"), _MAKERS[name])()
    return cube
