"""HTML representations for notebooks: a caption, a table, and curves.

Plain HTML and SVG without style sheets or scripts, so that any notebook can show them, also after
it was saved and opened again.
"""

import re
from collections.abc import Iterable, Sequence
from html import escape

import numpy as np

from chromanoise.base.check import Array
from chromanoise.base.palette import CHANNELS
from chromanoise.base.shapes import Float

_WIDTH, _HEIGHT, _EDGE = 320, 120, 14


def shown(caption: str, *parts: str, notes: Iterable[str] = ()) -> str:
    """A caption, tables and drawings one below the other, and notes in small type."""
    lines = "".join(f"<div><small>{_text(note)}</small></div>" for note in notes)
    return f"<div><div><b>{_text(caption)}</b></div>{''.join(parts)}{lines}</div>"


def _text(text: str) -> str:
    """Text as HTML, with the symbols e⁻ and µm in place of ASCII."""
    return re.sub(r"\bum\b", "µm", re.sub(r"\be-(?!\w)", "e⁻", escape(text)))


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    r"""An HTML table; the first cell of each row names it.

    Examples
    --------
    >>> table(["", "mean [e-]"], [["R", "12"]]).count("<td")
    1
    """
    top = "".join(f'<th scope="col">{_text(cell)}</th>' for cell in head)
    body = "".join(
        f'<tr><th scope="row" style="text-align:left">{_text(first)}</th>'
        + "".join(f'<td style="text-align:{_side(cell)}">{_text(cell)}</td>' for cell in rest)
        + "</tr>"
        for first, *rest in rows
    )
    return f"<table><thead><tr>{top}</tr></thead><tbody>{body}</tbody></table>"


def _side(cell: str) -> str:
    """Numbers are aligned right, words left."""
    return "left" if " " in cell else "right"


def curves(
    x: Float[Array, " n"], values: Float[Array, "n p"], names: Sequence[str], *, what: str
) -> str:
    """Curves as SVG, scaled to the highest, each with a label where it is far from the others."""
    top = float(values.max()) or 1.0
    across = _EDGE + (x - x[0]) / (x[-1] - x[0]) * (_WIDTH - 2 * _EDGE)
    down = _HEIGHT - _EDGE - values / top * (_HEIGHT - 2 * _EDGE)
    drawn = "".join(
        _curve(across, down[:, i], name, _color(name), at=_alone(values, i))
        for i, name in enumerate(names)
    )
    ends = (
        f'<text x="{_EDGE}" y="{_HEIGHT - 2}" font-size="10">{x[0]:g} nm</text>'
        f'<text x="{_WIDTH - _EDGE}" y="{_HEIGHT - 2}" font-size="10" text-anchor="end">'
        f"{x[-1]:g} nm</text>"
    )
    return (
        f'<svg role="img" width="{_WIDTH}" height="{_HEIGHT}" viewBox="0 0 {_WIDTH} {_HEIGHT}" '
        f'fill="currentColor"><title>{_text(what)}, 0 to {top:.3g}</title>{drawn}{ends}</svg>'
    )


def _color(name: str) -> str:
    """The color of a curve; the text color if it differs between dark and light notebooks."""
    light, dark = CHANNELS.get(name, ("", "currentColor"))
    return light if light == dark else "currentColor"


def _alone(values: Float[Array, "n p"], i: int) -> int:
    """Index at which a curve is high and far from all other curves."""
    apart = np.abs(values - values[:, [i]])
    apart[:, i] = np.inf
    nearest = np.minimum(apart.min(axis=1), values[:, i])
    return int(np.argmax(nearest * values[:, i]))


def _curve(
    across: Float[Array, " n"], down: Float[Array, " n"], name: str, color: str, *, at: int
) -> str:
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(across, down, strict=True))
    return (
        f'<polyline points="{points}" fill="none" stroke="{color}" stroke-width="1.5"/>'
        f'<text x="{across[at]:.1f}" y="{down[at] - 3:.1f}" font-size="11" fill="{color}" '
        f'text-anchor="middle">{escape(name)}</text>'
    )
