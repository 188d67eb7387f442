"""Every chart of a study, by name."""

from collections.abc import Callable, Mapping
from typing import Any

from chromanoise import _check
from chromanoise.charts.budget import drawn_budget
from chromanoise.charts.charted_study import Look, Shown
from chromanoise.charts.color_checker import drawn_chart
from chromanoise.charts.electrons import drawn_head
from chromanoise.charts.ellipses import drawn_ellipses
from chromanoise.charts.maps import drawn_map
from chromanoise.charts.pareto import drawn_pareto
from chromanoise.charts.sensitivities import drawn_sensitivities
from chromanoise.charts.snr_over_light import drawn_levels
from chromanoise.charts.stages import drawn_stages
from chromanoise.charts.vectors import drawn_vectors

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
"""Names of the charts of every study."""
DRAWINGS: Mapping[str, Callable[[Shown, Look], dict[str, Any]]] = {**PARTS, "map": drawn_map}
"""The same, and the heat map of a sweep of two parameters."""


def drawing(part: str, of: Shown, look: Look | None = None) -> dict[str, Any]:
    """The data of one chart.

    Parameters
    ----------
    part
        A name from `DRAWINGS`.
    of
        A study as `shown` gives it.
    look
        Options of the charts.

    Raises
    ------
    InputError
        If there is no such chart, or an option does not fit the study.
    """
    return DRAWINGS[_check.one_of("part", part, tuple(DRAWINGS))](of, look or Look())
