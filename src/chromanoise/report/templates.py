"""HTML of tables and pictures from a template of this package."""

from importlib import resources
from typing import Any

import jinja2

from chromanoise import __version__
from chromanoise._palette import palette_css


def filled_template(name: str, **values: Any) -> str:
    """A template with its values, the palette and the style of tables.

    Parameters
    ----------
    name
        File of a template, e.g. ``characterization.html.j2``.
    values
        All other names that the template uses.
    """
    folder = resources.files("chromanoise.report")
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    style = palette_css() + folder.joinpath("tables.css").read_text("utf-8")
    template = environment.from_string(folder.joinpath(name).read_text("utf-8"))
    return template.render(version=__version__, style=style, **values)
