"""What a package uses of higher layers, which the root package registers by name.

So no package imports a higher layer: a result draws itself without importing charts.
"""

from importlib import import_module
from typing import Any

_MODULES: dict[str, str] = {}


def register_above(**modules: str) -> None:
    """Register modules of higher packages, imported on first use.

    Parameters
    ----------
    modules
        The dotted name of a module by the name under which lower packages ask for it.
    """
    _MODULES.update(modules)


def from_above(name: str) -> Any:
    """The module that is registered under a name."""
    return import_module(_MODULES[name])
