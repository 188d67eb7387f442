"""Sphinx extension: writes the reference pages from the program itself before each build.

The pages are ``docs/reference/api/*.rst`` (of the public packages), ``commands/*.rst`` (one per
command), ``results/*.rst``, ``study_keys.rst`` and ``result_keys.rst``. They are not kept in git.
Names in Markdown such as `chromanoise.analyze` become links to them.
"""

import importlib
import inspect
import json
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
from docutils import nodes
from package_pages import api_index, heading, marked_up, pages_of_package
from powers import pieces
from public_names import all_packages, home_of, public_names
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.transforms import SphinxTransform

OWN = re.compile(r"(?:chromanoise|cn)(?:\.\w+)+")


# ---- the command line ----


def escaped(text: str) -> str:
    """Plain help text as reStructuredText: only what is in backticks keeps a meaning."""
    pieces = re.split(r"`+([^`]+)`+", text)
    return "".join(
        f"``{piece}``" if i % 2 else re.sub(r"([*|\\]|_(?=\W|$))", r"\\\1", piece)
        for i, piece in enumerate(pieces)
    )


def help_paragraphs(text: str) -> str:
    """The help of a command; a paragraph after a backspace keeps its lines."""
    shown = []
    for paragraph in inspect.cleandoc(text).split("\n\n"):
        if paragraph.startswith("\b"):
            shown.append("::\n\n" + textwrap.indent(paragraph.strip("\b\n"), "    "))
        else:
            shown.append(escaped(" ".join(paragraph.split())))
    return "\n\n".join(shown)


def page_of_command(name: str, command: click.Command) -> str:
    """The reference page of one command: usage, explanation, every option."""
    context = click.Context(command, info_name=f"chromanoise {name}")
    usage = " ".join(command.get_usage(context).removeprefix("Usage: ").split())
    parts = [
        heading(f"``chromanoise {name}``", "="),
        f".. program:: chromanoise {name}\n",
        f".. code-block:: none\n\n   {usage}\n",
        help_paragraphs(command.help or ""),
        "",
    ]
    options = [one for one in command.params if isinstance(one, click.Option) and not one.hidden]
    if options:
        parts.append(heading("Options", "-"))
    for one in options:
        record = one.get_help_record(context)
        if record is None:
            continue
        forms, text = record
        names = ", ".join(part.strip() for part in re.split(r" / |, ", forms))
        parts.append(f".. option:: {names}\n\n   {escaped(' '.join(text.split()))}\n")
    return "\n".join(parts)


def command_pages() -> dict[str, str]:
    """The reference pages of all commands, by file name."""
    from chromanoise.cli.entry import commands

    context = click.Context(commands)
    names = commands.list_commands(context)
    pages = {}
    rows = []
    for name in names:
        command = commands.get_command(context, name)
        assert command is not None
        pages[name] = page_of_command(name, command)
        summary = " ".join(inspect.cleandoc(command.help or "").partition("\n\n")[0].split())
        rows.append(f"* :doc:`chromanoise {name} <{name}>`: {escaped(summary)}")
    listed = "\n".join(f"   {name}" for name in names)
    pages["index"] = "\n".join(
        [
            heading("Command line", "="),
            "``chromanoise COMMAND --help-all`` prints the same in the terminal.\n",
            "\n".join(rows),
            f"\n.. toctree::\n   :hidden:\n\n{listed}\n",
        ]
    )
    return pages


# ---- study files ----


def type_of(schema: dict[str, Any]) -> str:
    """The type of a key in words."""
    if "anyOf" in schema:
        return " or ".join(type_of(one) for one in schema["anyOf"] if one.get("type") != "null")
    if "enum" in schema:
        return ", ".join(f"``{one}``" for one in schema["enum"])
    if "const" in schema:
        return f"``{schema['const']}``"
    if "$ref" in schema:
        return "table"
    limits = {
        "exclusiveMinimum": "> {}",
        "minimum": ">= {}",
        "exclusiveMaximum": "< {}",
        "maximum": "<= {}",
    }
    kind = schema.get("type", "any")
    if "minimum" in schema and schema["minimum"] == schema.get("maximum"):
        return f"``{schema['minimum']}``"
    if kind == "array":
        items = schema.get("items") or {}
        return f"list of {type_of(items)}" if items else "list"
    if kind == "object":
        values = schema.get("additionalProperties")
        return f"table of {type_of(values)}" if isinstance(values, dict) else "table"
    words = {
        "number": "number",
        "integer": "whole number",
        "string": "text",
        "boolean": "true or false",
    }
    bounds = [form.format(schema[key]) for key, form in limits.items() if key in schema]
    return " ".join([words.get(kind, kind), *bounds[:1], *(f"and {one}" for one in bounds[1:])])


def parts_of(schema: dict[str, Any]) -> list[str]:
    """The names of the tables that a key holds."""
    if "$ref" in schema:
        return [schema["$ref"].rpartition("/")[2]]
    inner = [*schema.get("anyOf", []), schema.get("items"), schema.get("additionalProperties")]
    return [name for one in inner if isinstance(one, dict) for name in parts_of(one)]


def keys_table(properties: dict[str, Any]) -> str:
    """The keys of one table of a study."""
    rows = []
    for key, schema in properties.items():
        default = schema.get("default")
        shown = (
            ""
            if default in (None, "") or isinstance(default, dict)
            else f"``{json.dumps(default)}``"
        )
        rows.append(
            f"   * - ``{key}``\n     - {type_of(schema)}\n     - {shown}\n"
            f"     - {escaped(schema.get('description', ''))}"
        )
    head = "   * - key\n     - type\n     - default\n     - meaning"
    return "\n".join(
        [".. list-table::\n   :header-rows: 1\n   :widths: 20 22 13 45\n", head, *rows, ""]
    )


def sections_of(schema: dict[str, Any], path: str, defs: dict[str, Any]) -> Iterator[str]:
    """The section of a table of a study, then those of the tables in it."""
    title = f"``[{path}]``" if path else "Top level"
    yield "\n".join(
        [
            heading(title, "-"),
            escaped(schema.get("description", "")) + "\n",
            keys_table(schema["properties"]),
        ]
    )
    for key, value in schema["properties"].items():
        for name in parts_of(value):
            yield from sections_of(defs[name], f"{path}.{key}" if path else key, defs)


def page_of_keys() -> str:
    """Every key of a study file."""
    from chromanoise.study import study_schema

    schema = study_schema()
    top = {**schema, "description": "Keys outside all tables, and the tables."}
    return "\n".join(
        [
            heading("Keys of a study file", "="),
            "A study file is TOML. :doc:`chromanoise init <commands/init>` writes one with"
            " comments, :doc:`chromanoise run <commands/run>` runs it, and ``chromanoise study"
            " --schema`` prints these keys as JSON Schema for editors. In a list of tables,"
            " such as the sensors, the heading in the file is ``[[sensors]]``.\n",
            *sections_of(top, "", schema["$defs"]),
        ]
    )


# ---- results ----


def keys_of_result(name: str, kind: Any) -> str:
    """The page of the keys in the JSON of one command."""
    from chromanoise.base import described_keys

    rows = [
        f"   * - ``{one.name}``\n     - {type_in_words(one)}\n     - {escaped(one.text)}"
        for one in described_keys(kind.json_schema())
    ]
    head = "   * - key\n     - type\n     - meaning"
    summary = (inspect.getdoc(kind) or "").partition("\n\n")[0]
    return "\n".join(
        [
            heading(f"``chromanoise {name} --json``", "="),
            escaped(summary) + "\n",
            ".. list-table::\n   :header-rows: 1\n   :widths: 32 18 50\n",
            *(head, *rows, ""),
        ]
    )


def type_in_words(one: Any) -> str:
    """The type of a key, and whether it may be null."""
    words = {"string": "text", "integer": "whole number", "boolean": "true or false"}
    shown = [words.get(kind, kind) for kind in sorted(one.kinds - {"null"})]
    text = " or ".join(shown) + (" or null" if "null" in one.kinds else "")
    return f"list of {text}" if one.path[-1] == "[]" else text


def pages_of_results() -> dict[str, str]:
    """Every key in the JSON of analyze, compare and matrix: an overview and a page per command."""
    from chromanoise.study import RESULT_KINDS

    pages = {
        f"results/{name}": keys_of_result(name.replace("-map", " --and"), kind)
        for name, kind in RESULT_KINDS.items()
    }
    listed = "\n".join(f"   {name}" for name in pages)
    pages["result_keys"] = "\n".join(
        [
            heading("Keys of results", "="),
            "Keys in the JSON of the commands, of ``to_dict()`` and of the files of ``chromanoise"
            " run``, with units in brackets. Dots separate the parts of a key, lists are left out,"
            " and ``NAME`` is a name: of a channel, a coordinate, a prior. ``chromanoise schema"
            " analyze`` prints the same as JSON Schema. New keys may be added in any release."
            " :doc:`Pipelines <../howto/pipelines>` use them.\n",
            f".. toctree::\n\n{listed}\n",
        ]
    )
    return pages


# ---- Sphinx ----


def written(path: Path, text: str) -> None:
    """Write a page where it changed, so that Sphinx reads only what is new."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def write_pages(app: Sphinx) -> None:
    """Write all reference pages and remove those of names that are gone."""
    folder = Path(app.srcdir) / "reference"
    pages = {
        folder / "api" / f"{name}.rst": text
        for path in all_packages()
        for name, text in pages_of_package(importlib.import_module(path)).items()
    }
    pages[folder / "api" / "index.rst"] = api_index()
    pages |= {folder / "commands" / f"{name}.rst": text for name, text in command_pages().items()}
    pages[folder / "study_keys.rst"] = page_of_keys()
    pages |= {folder / f"{name}.rst": text for name, text in pages_of_results().items()}
    for path, text in pages.items():
        written(path, text)
    for old in [*folder.glob("api/*.rst"), *folder.glob("commands/*.rst")]:
        if old not in pages:
            old.unlink()


class RaisedPowers(SphinxTransform):
    """Sets powers and indices of running text as such; names and code stay."""

    default_priority = 410
    names = (
        *(nodes.literal, nodes.literal_block, nodes.doctest_block, nodes.math, nodes.math_block),
        *(nodes.raw, nodes.comment, nodes.strong, nodes.title, addnodes.desc_signature),
        *(addnodes.pending_xref, addnodes.literal_strong, addnodes.index, nodes.reference),
    )

    def apply(self, **_: Any) -> None:
        """Replace each text that has a power or an index."""
        for text in list(self.document.findall(nodes.Text)):
            parts = list(pieces(text.astext()))
            node = text.parent
            while len(parts) > 1 and node is not None and not isinstance(node, self.names):
                node = node.parent
            if len(parts) > 1 and node is None:
                kinds = {"": nodes.Text, "sup": _superscript, "sub": _subscript}
                text.parent.replace(text, [kinds[kind](part) for kind, part in parts if part])


def _superscript(text: str) -> nodes.superscript:
    return nodes.superscript("", text)


def _subscript(text: str) -> nodes.subscript:
    return nodes.subscript("", text)


class LinkedNames(SphinxTransform):
    """Makes a link of a public name that stands as code in a page."""

    default_priority = 400

    def apply(self, **_: Any) -> None:
        """Wrap each name of this package in a reference; without target it stays code."""
        for literal in list(self.document.findall(nodes.literal)):
            text = literal.astext()
            name = text.removesuffix("()")
            if not OWN.fullmatch(name) or isinstance(literal.parent, addnodes.pending_xref):
                continue
            target = re.sub(r"^cn\.", "chromanoise.", name)
            link = addnodes.pending_xref(
                "", refdomain="py", reftype="obj", reftarget=target, refexplicit=True, refwarn=False
            )
            literal.replace_self(link)
            link.append(literal)


def escape_docstring(
    _app: Sphinx, _what: str, _name: str, _obj: object, _options: object, lines: list[str]
) -> None:
    """Stars and bars of a docstring are signs of mathematics, not of reStructuredText."""
    example = literal = False
    for i, line in enumerate(lines):
        example = line.lstrip().startswith(">>>") or (example and bool(line.strip()))
        literal = literal and (not line.strip() or line.startswith(" "))
        if not (example or literal):
            start, text = re.fullmatch(r"(\s*(?:\* |\*+(?=\w+$))?)(.*)", line).groups()  # type: ignore[union-attr]
            lines[i] = start + marked_up(text)
        literal = literal or line.endswith("::")


def literal_types(
    _app: Sphinx, _what: str, _name: str, _obj: object, _options: object, lines: list[str]
) -> None:
    """Types with shapes, which napoleon adds to attributes, are code."""
    for i, line in enumerate(lines):
        if line.startswith(":vartype ") and "*" in line:
            lines[i] = re.sub(r"^(:vartype [^:]+: )(.*)$", r"\1``\2``", line)


def check_inventory(app: Sphinx, error: Exception | None) -> None:
    """Refuse a site in which a public name has no entry."""
    if error is not None:
        return
    known = app.env.domains["py"].objects  # type: ignore[attr-defined]
    for path in all_packages():
        module = importlib.import_module(path)
        for name in public_names(module):
            home = home_of(getattr(module, name), name, path) or path
            if f"{home}.{name}" not in known:
                raise ExtensionError(f"{path}.{name} is not in the Python reference")


def level_captions(
    _app: Sphinx, _page: str, _template: str, context: dict[str, Any], _tree: object
) -> None:
    """Captions of the navigation are headings, which need a level (WAI-ARIA)."""
    tree = context.get("furo_navigation_tree")
    if tree:
        context["furo_navigation_tree"] = tree.replace(
            'role="heading"', 'role="heading" aria-level="2"'
        )


def setup(app: Sphinx) -> dict[str, Any]:
    """Write the pages when a build starts; link names in all pages."""
    app.connect("builder-inited", write_pages, priority=100)
    app.connect("autodoc-process-docstring", escape_docstring, priority=100)  # before napoleon
    app.connect("autodoc-process-docstring", literal_types, priority=900)  # after napoleon
    app.connect("build-finished", check_inventory)
    app.connect("html-page-context", level_captions, priority=900)  # after the theme
    app.add_transform(LinkedNames)
    app.add_transform(RaisedPowers)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
