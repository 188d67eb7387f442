"""One file per drawing of the page: plain data in the unit in which it is drawn.

They arrange what `chromanoise.study` computes; what does not exist is ``None``, with a sentence in
``why_not``.
"""

from collections.abc import Callable, Mapping
from typing import Any

from chromanoise import _check
from chromanoise.study.drawings.budget import coordinate_budget, drawn_budget
from chromanoise.study.drawings.chart import drawn_chart
from chromanoise.study.drawings.ellipses import drawn_ellipses
from chromanoise.study.drawings.head import drawn_head
from chromanoise.study.drawings.levels import drawn_levels
from chromanoise.study.drawings.pareto import drawn_pareto
from chromanoise.study.drawings.sensitivities import drawn_sensitivities
from chromanoise.study.drawings.shown import Look, Shown, shown
from chromanoise.study.drawings.stages import drawn_stages
from chromanoise.study.drawings.vectors import drawn_vectors
from chromanoise.study.drawings.verdicts import verdict_sentences

__all__ = [
    "PARTS",
    "Look",
    "Shown",
    "coordinate_budget",
    "drawing",
    "shown",
    "verdict_sentences",
]

PARTS: Mapping[str, Callable[[Shown, Look], dict[str, Any]]] = {
    "head": drawn_head,
    "sensitivities": drawn_sensitivities,
    "stages": drawn_stages,
    "budget": drawn_budget,
    "vectors": drawn_vectors,
    "ellipses": drawn_ellipses,
    "levels": drawn_levels,
    "chart": drawn_chart,
    "pareto": drawn_pareto,
}
"""What can be drawn of a study."""


def drawing(part: str, of: Shown, look: Look | None = None) -> dict[str, Any]:
    """The data of one drawing.

    Parameters
    ----------
    part
        Of `PARTS`.
    of
        A study as `shown` gives it.
    look
        How it is looked at.

    Raises
    ------
    InputError
        If there is no such drawing, or what is looked at does not exist.
    """
    return PARTS[_check.one_of("part", part, tuple(PARTS))](of, look or Look())
