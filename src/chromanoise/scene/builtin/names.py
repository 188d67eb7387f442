"""The names of the built-in cubes."""

from collections.abc import Callable

from chromanoise import _check
from chromanoise.scene.builtin.checker import checker_cube
from chromanoise.scene.builtin.dead_leaves import dead_leaves_cube
from chromanoise.scene.builtin.foliage import foliage_cube
from chromanoise.scene.builtin.slanted_edges import slanted_edges_cube
from chromanoise.scene.cube import Cube

_MAKERS: dict[str, Callable[[], Cube]] = {
    "builtin:checker": checker_cube,
    "builtin:dead-leaves": dead_leaves_cube,
    "builtin:slanted-edges": slanted_edges_cube,
    "builtin:foliage": foliage_cube,
}
BUILTIN_CUBES = tuple(_MAKERS)


def builtin_cube(name: str) -> Cube:
    """The cube with the name ``builtin:...``.

    Raises
    ------
    InputError
        If no built-in cube has this name.
    """
    _check.one_of("scene", name, BUILTIN_CUBES)
    return _MAKERS[name]()
