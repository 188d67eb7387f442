"""The public packages and names of chromanoise, and where their documentation is."""

import ast
import importlib
import inspect
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from types import ModuleType

PACKAGES = {  # by the headings of the Python reference
    "The stages": ["spectra", "sensor", "noise", "geometry", "color", "metrics"],
    "Pictures": ["imaging", "imaging.denoising"],
    "Files": ["io", "io.spectra", "io.cubes", "io.frames", "io.pixels"],
    "Whole studies": ["study"],
    "Charts and reports": ["charts", "web"],
    "Applications, not yet stable": [
        *(
            "apps",
            "apps.camera",
            "apps.design",
            "apps.training",
            "apps.denoising_benchmark",
            "apps.paper",
        ),
    ],
    "Basics": ["base"],
}


def all_packages() -> Iterator[str]:
    """The paths of all public packages, the root first."""
    yield "chromanoise"
    for paths in PACKAGES.values():
        yield from (f"chromanoise.{path}" for path in paths)


def public_names(module: ModuleType) -> list[str]:
    """The public names of a package, in alphabetical order."""
    return sorted(module.__all__)


def kind_of(value: object) -> str:
    """Whether a value is documented as a function, a class or data."""
    if inspect.isclass(value) and type(value) is not type(list[int]):
        return "classes"
    return "functions" if inspect.isroutine(value) or hasattr(value, "py_func") else "data"


@cache
def statements(path: str) -> list[ast.stmt]:
    """The statements of a module, those of its ``if`` blocks last."""
    source = Path(str(importlib.import_module(path).__file__)).read_text(encoding="utf-8")
    body = ast.parse(source).body
    nested = [block.body for block in body if isinstance(block, ast.If)]
    return [*body, *(statement for block in nested for statement in block)]


def documentation_of_data(path: str, name: str) -> str:
    """The docstring below the assignment of a constant or a type; empty if there is none.

    Parameters
    ----------
    path
        The module that assigns or imports it.
    name
        The name there.
    """
    body = statements(path)
    for statement, after in zip(body, [*body[1:], None], strict=True):
        targets = getattr(statement, "targets", [getattr(statement, "target", None)])
        if any(isinstance(one, ast.Name) and one.id == name for one in targets):
            text = after.value if isinstance(after, ast.Expr) else None
            known = isinstance(text, ast.Constant) and isinstance(text.value, str)
            return inspect.cleandoc(text.value) if known else ""  # type: ignore[union-attr]
        if isinstance(statement, ast.ImportFrom) and statement.module:
            for alias in statement.names:
                if (alias.asname or alias.name) == name:
                    return documentation_of_data(statement.module, alias.name)
    return ""


def home_of(value: object, name: str, path: str) -> str | None:
    """Another package that documents a name which ``path`` exports too; ``None`` if there is none.

    Packages within ``path`` and those above it in the list come first; the root documents only
    what no package does.
    """
    if kind_of(value) == "data":
        return None
    paths = list(all_packages())
    for one in paths[1:]:
        module = importlib.import_module(one)
        first = path == "chromanoise" or one.startswith(f"{path}.")
        if one == path or not (first or paths.index(one) < paths.index(path)):
            continue
        if path.startswith(f"{one}."):
            continue
        if name in public_names(module) and getattr(module, name) is value:
            return one
    return None
