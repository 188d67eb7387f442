"""HTML of tables and pictures from a template of this package."""

import re
from collections.abc import Callable, Mapping
from importlib import resources
from typing import Any

import jinja2
from markupsafe import Markup, escape

from chromanoise import __version__
from chromanoise._palette import palette_css
from chromanoise.charts.mathematics import coordinate_mathml, mathml


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
    return _replaced(text, _COORDINATES)


def with_paper_symbols(text: str) -> Markup:
    """The same, and the other symbols of the paper's tables, as SNR_Y and cos^2 theta."""
    return _replaced(text, _COORDINATES | _OF_THE_PAPER)


def _replaced(text: str, symbols: Mapping[str, Callable[[str], str]]) -> Markup:
    """A text with MathML in place of what matches a key; values give the MathML of a match."""
    parts = re.split(f"({'|'.join(symbols)})", text)
    return Markup("").join(
        Markup(_mathematics(part, symbols)) if i % 2 else escape(part)
        for i, part in enumerate(parts)
    )


def _mathematics(part: str, symbols: Mapping[str, Callable[[str], str]]) -> str:
    return next(make(part) for pattern, make in symbols.items() if re.fullmatch(pattern, part))


def _lowered(word: str) -> str:
    name, _, index = word.partition("_")
    return mathml(rf"\mathrm{{{name}}}_{{\mathrm{{{index}}}}}")


_COORDINATES: dict[str, Callable[[str], str]] = {r"M\^[^\s\[\],;]+": coordinate_mathml}
_OF_THE_PAPER: dict[str, Callable[[str], str]] = {
    r"\bSNR_\w+": _lowered,
    r"\b(?:RGBW|RGB|G)_n\b": _lowered,
    r"theta\(y,\s?g\)": lambda _: mathml(r"\theta(y, g)"),
    r"\bY\^(?!\w)": lambda _: mathml(r"\hat{Y}"),
    r"cos\^2 theta": lambda _: mathml(r"\cos^2 \theta"),
    r"\|y\|\^2": lambda _: mathml("|y|^2"),
}


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
