"""Sphinx extension: formulas as MathML, which browsers draw without any script or font file."""

from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError


def mathml(latex: str, *, display: str) -> str:
    """The MathML element of a formula in LaTeX."""
    try:
        return convert(latex, display=display)
    except Exception as error:
        raise ExtensionError(
            f"the formula {latex!r} is not read by latex2mathml: {error}"
        ) from error


def inline(writer: Any, node: nodes.math) -> None:
    """A formula within a line."""
    writer.body.append(mathml(node.astext(), display="inline"))
    raise nodes.SkipNode


def displayed(writer: Any, node: nodes.math_block) -> None:
    """A formula on its own line, with its number if it has a label."""
    writer.body.append(writer.starttag(node, "div", CLASS="math-block"))
    writer.body.append(mathml(node.astext(), display="block"))
    if node["number"]:
        writer.body.append(f'<span class="eqno">({node["number"]})</span>')
        writer.add_permalink_ref(node, "Link to this equation")
    writer.body.append("</div>")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the renderer ``mathml``."""
    app.add_html_math_renderer("mathml", (inline, None), (displayed, None))
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
