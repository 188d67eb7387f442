"""Typed dictionaries of the keywords of each function, made from the keys of a study.

Type checkers read the stub, which ``tools/make_stubs.py`` writes.
"""

from typing import Any, TypedDict

from chromanoise.study.function_settings import described_settings


def _keywords(name: str, function: str) -> Any:
    kinds = {one.name: one.of.type for one in described_settings(function)}
    made = TypedDict(name, kinds, total=False)  # type: ignore[misc, operator] # names of a table
    made.__doc__ = f"Settings of ``{function}``, by their names."
    return made


NAMES = {
    "analyze": "AnalysisSettings",
    "card": "CardSettings",
    "compare": "ComparisonSettings",
    "compare_map": "MapSettings",
    "denoise": "DenoiseSettings",
    "league": "LeagueSettings",
    "matrix": "MatrixSettings",
    "render": "RenderSettings",
    "sensitivity": "SensitivitySettings",
}
"""Names of the dictionaries by their functions."""
globals().update({name: _keywords(name, function) for function, name in NAMES.items()})
