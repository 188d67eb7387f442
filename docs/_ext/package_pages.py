"""The pages of the Python reference, as text: one per package, and one per chapter of a long one.

A chapter holds the names of one source file, so that no page is long.
"""

import ast
import importlib
import inspect
import re
import textwrap
from types import ModuleType

from public_names import (
    PACKAGES,
    documentation_of_data,
    home_of,
    kind_of,
    public_names,
    statements,
)

MOST_NAMES = 12
"""A package with more names of its own has a page per chapter."""
ABBREVIATIONS = ("eq", "eqs", "e.g", "i.e", "et al", "vs", "Rec", "Fig", "No")
CODE = re.compile(r"(``.+?``|`.+?`)")


def heading(text: str, line: str) -> str:
    """A heading of reStructuredText, on lines of its own."""
    return f"\n{text}\n{line * len(text)}\n"


# ---- text of docstrings ----


def marked_up(text: str) -> str:
    """Prose of a docstring as reStructuredText, where stars and bars are signs of mathematics."""
    return "".join(
        piece if i % 2 else re.sub(r"([*|])", r"\\\1", piece)
        for i, piece in enumerate(CODE.split(text))
    )


def summary(text: str | None) -> str:
    """The first sentence of a docstring; a dot of an abbreviation ends none."""
    first = " ".join(inspect.cleandoc(text or "").partition("\n\n")[0].split())
    for dot in re.finditer(r"\.(?= +[A-Z`])", first):
        before = first[: dot.start()]
        if not before.endswith(ABBREVIATIONS) and before.count("(") == before.count(")"):
            return first[: dot.end()]
    return first


# ---- chapters ----


def chapters(module: ModuleType) -> dict[str, list[str]]:
    """The names that a package documents, by the source file that defines them.

    Those of the root package have a chapter each, because their settings are listed in full.
    """
    path, files = module.__name__, {}
    for statement in statements(path):
        if isinstance(statement, ast.ImportFrom) and statement.module:
            own = statement.module.rpartition(".")[2]
            files |= {one.asname or one.name: own for one in statement.names}
    found: dict[str, list[str]] = {}
    for name in public_names(module):
        value = getattr(module, name)
        if not inspect.ismodule(value) and home_of(value, name, path) is None:
            chapter = name if path == "chromanoise" else files.get(name, path.rpartition(".")[2])
            found.setdefault(chapter, []).append(name)
    return dict(sorted(found.items()))


def documentation(module: ModuleType, name: str) -> str:
    """The docstring of a public name."""
    value = getattr(module, name)
    if kind_of(value) == "data":
        return documentation_of_data(module.__name__, name)
    return inspect.getdoc(value) or ""


def table_of(module: ModuleType, names: list[str]) -> str:
    """Names and their first sentences."""
    rows = [
        f"   * - :py:obj:`{name} <{module.__name__}.{name}>`\n"
        f"     - {marked_up(summary(documentation(module, name)))}"
        for name in names
    ]
    return "\n".join(["\n.. list-table::\n   :widths: 35 65\n", *rows, ""])


def entry(module: ModuleType, name: str) -> str:
    """The full documentation of one name."""
    value, path = getattr(module, name), f"{module.__name__}.{name}"
    match kind_of(value):
        case "classes":
            return f".. autoclass:: {path}\n   :members:\n"
        case "functions":
            return f".. autofunction:: {path}\n"
    options = [f"   :value: {value!r}"] if isinstance(value, int | float | str) else []
    text = textwrap.indent(marked_up(documentation(module, name)), "   ")
    return "\n".join([f".. py:data:: {name}", *options, "", text, ""])


def title_of(chapter: str) -> str:
    """A chapter as a heading: its file's name in words."""
    words = chapter.replace("_", " ")
    return words[:1].upper() + words[1:]


def pages_of_package(module: ModuleType) -> dict[str, str]:
    """The pages of one package by file name: an overview, and its chapters if it is long."""
    path, own = module.__name__, chapters(module)
    names = [name for chapter in own.values() for name in chapter]
    is_root = path == "chromanoise"
    first = [heading(f"``{path}``", "="), f".. py:module:: {path}\n"]
    first.append(marked_up(inspect.getdoc(module) or "") + "\n")
    pages = {}
    if is_root or len(names) > MOST_NAMES:
        for chapter, held in own.items():
            title = f"``{path}.{chapter}``" if is_root else f"``{path}``: {title_of(chapter)}"
            top = [heading(title, "="), f".. py:currentmodule:: {path}\n"]
            pages[f"{path}-{chapter}"] = "\n".join([*top, *(entry(module, one) for one in held)])
            if not is_root:
                first += [heading(title_of(chapter), "-"), table_of(module, held)]
        if is_root:
            first.append(table_of(module, names))
    elif names:
        first += [table_of(module, names), *(entry(module, name) for name in names)]
    first.append(table_elsewhere(module))
    if pages:
        listed = "\n".join(f"   {name}" for name in pages)
        first.append(f"\n.. toctree::\n   :hidden:\n\n{listed}\n")
    return {path: "\n".join(first), **pages}


def table_elsewhere(module: ModuleType) -> str:
    """Packages in a package, and the names that it shares with a package that documents them."""
    path, rows = module.__name__, []
    for name in public_names(module):
        value = getattr(module, name)
        home = path if inspect.ismodule(value) else home_of(value, name, path)
        if home is not None:
            rows.append(f"   * - ``{path}.{name}``\n     - :py:obj:`{home}.{name}`")
    title = heading("Packages and shared names", "-")
    return "\n".join([title, ".. list-table::\n", *rows, ""]) if rows else ""


def api_index() -> str:
    """The first page of the Python reference."""
    parts = [
        heading("Python", "="),
        "Every public name, by package. :doc:`chromanoise` lists what ``import chromanoise as cn``"
        " gives: most programs need no more.\n",
        ".. toctree::\n   :hidden:\n\n   chromanoise\n",
    ]
    for title, paths in PACKAGES.items():
        rows = []
        for path in paths:
            module = importlib.import_module(f"chromanoise.{path}")
            rows.append(
                f"* :doc:`chromanoise.{path}`: {marked_up(summary(inspect.getdoc(module)))}"
            )
        pages = "\n".join(f"   chromanoise.{path}" for path in paths)
        parts += [
            heading(title, "-"),
            "\n".join(rows) + "\n",
            f".. toctree::\n   :hidden:\n\n{pages}\n",
        ]
    return "\n".join(parts)
