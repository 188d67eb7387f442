"""HTML of tables and pictures from a template of this package."""

import re
from importlib import resources
from typing import Any

import jinja2
from markupsafe import Markup, escape

from chromanoise import __version__
from chromanoise._palette import palette_css
from chromanoise.charts.mathematics import coordinate_latex, mathml


def environment() -> jinja2.Environment:
    """The environment of all templates, with the filter ``symbols`` (`with_symbols`)."""
    made = jinja2.Environment(
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        loader=jinja2.FunctionLoader(_text_of),
    )
    made.filters["symbols"] = with_symbols
    return made


def with_symbols(text: str) -> Markup:
    """A text in which contravariant coordinates, as M^R, are MathML.

    Examples
    --------
    >>> with_symbols("a < b")
    Markup('a &lt; b')
    """
    parts = re.split(r"(M\^[^\s\[\],;]+)", text)
    return Markup("").join(
        Markup(mathml(coordinate_latex(part))) if i % 2 else escape(part)
        for i, part in enumerate(parts)
    )


def filled_template(name: str, **values: Any) -> str:
    """A template with its values, the palette and the style of tables.

    Parameters
    ----------
    name
        File of a template, e.g. ``characterization.html.j2``.
    values
        All other names that the template uses.
    """
    style = palette_css() + _text_of("tables.css")
    return environment().get_template(name).render(version=__version__, style=style, **values)


def _text_of(name: str) -> str:
    return resources.files("chromanoise.report").joinpath(name).read_text("utf-8")
