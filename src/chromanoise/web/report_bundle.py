"""Parts of a self-contained HTML file: templates, modules as data: URLs, compressed JSON."""

import base64
import gzip
import hashlib
import json
import re
from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from importlib import resources
from typing import TYPE_CHECKING, Any

from markupsafe import Markup, escape

from chromanoise.base import __version__, palette_css
from chromanoise.charts import coordinate_mathml, mathml

if TYPE_CHECKING:
    import jinja2

_DRAW = "charts/draw"


def drawing_style() -> str:
    """The style sheet of the drawing modules, with the palette."""
    return palette_css() + _asset("draw.css")


def import_map() -> str:
    """An import map with every drawing module as a data: URL.

    Modules import each other as ``draw/svg.js``; a browser loads no other file.
    """
    folder = resources.files("chromanoise").joinpath(_DRAW)
    names = sorted(one.name for one in folder.iterdir() if one.name.endswith(".js"))
    found = {
        f"draw/{name}": data_address(_asset(name).encode(), "text/javascript") for name in names
    }
    return json.dumps({"imports": found}, separators=(",", ":"))


def report_script() -> str:
    """The script that draws a report and handles its sliders."""
    return resources.files("chromanoise.web").joinpath("templates/report.js").read_text("utf-8")


def data_address(content: bytes, kind: str) -> str:
    """Content as a data: URL.

    Examples
    --------
    >>> data_address(b"1", "text/plain")
    'data:text/plain;base64,MQ=='
    """
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


def packed_json(data: Any) -> str:
    """Data as JSON, compressed by gzip and encoded in base64, which is safe inside HTML.

    Equal data give equal text.

    Examples
    --------
    >>> import gzip
    >>> gzip.decompress(base64.b64decode(packed_json({"title": "</script>"})))
    b'{"title":"</script>"}'
    """
    text = json.dumps(data, separators=(",", ":"), allow_nan=False, ensure_ascii=False)
    return base64.b64encode(gzip.compress(text.encode("utf-8"), mtime=0)).decode("ascii")


def script_hash(script: str) -> str:
    """The hash of an inline script for a content security policy."""
    digest = hashlib.sha256(script.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


def shortened(data: Any, *, digits: int = 5) -> Any:
    """The data with every number rounded to ``digits`` digits, safe for later rounding.

    Parameters
    ----------
    digits
        Significant ones; a number that would end in a 5 there keeps more, so that rounding it to
        fewer gives what rounding the number itself gives. [1]

    Examples
    --------
    >>> shortened([26.123456, 26.2496, 12.0, "26.2496"])
    [26.123, 26.2496, 12, '26.2496']
    """
    if isinstance(data, float):
        return _shortened(data, digits)
    if isinstance(data, dict):
        return {key: shortened(value, digits=digits) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [shortened(value, digits=digits) for value in data]
    return data


@lru_cache(maxsize=2**14)  # numbers repeat at each position of a slider
def _shortened(value: float, digits: int) -> float | int:
    for more in range(digits, 18):
        text = f"{value:.{more - 1}e}"
        mantissa = text.partition("e")[0].rstrip("0")
        if not mantissa.endswith("5"):
            value = float(text)
            break
    return int(value) if value.is_integer() and abs(value) < 1e15 else value


def _asset(name: str) -> str:
    return resources.files("chromanoise").joinpath(_DRAW, name).read_text("utf-8")


def environment() -> "jinja2.Environment":
    """The environment of all templates, with the filter ``symbols`` (`with_symbols`)."""
    import jinja2  # 12 ms, which commands without a report need not wait for

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
    below = f"<msub><mtext>{escape(name)}</mtext><mtext>{escape(index)}</mtext></msub>"
    return f'<math xmlns="http://www.w3.org/1998/Math/MathML" display="inline">{below}</math>'


def _formula(latex: str, _: str) -> str:
    return mathml(latex)


PAPER_FORMULAS = {
    r"theta\(y,\s?g\)": r"\theta(y, g)",
    r"\bY\^(?!\w)": r"\hat{Y}",
    r"cos\^2 theta": r"\cos^2 \theta",
    r"\|y\|\^2": "|y|^2",
}
"""The formula, in LaTeX, for what a pattern finds in the tables of the paper."""
_COORDINATES: dict[str, Callable[[str], str]] = {r"M\^[^\s\[\],;]+": coordinate_mathml}
_OF_THE_PAPER: dict[str, Callable[[str], str]] = {
    r"\bSNR_\w+": _lowered,
    r"\b(?:RGBW|RGB|G)_n\b": _lowered,
    **{pattern: partial(_formula, latex) for pattern, latex in PAPER_FORMULAS.items()},
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
    return resources.files("chromanoise.web").joinpath("templates", name).read_text("utf-8")
