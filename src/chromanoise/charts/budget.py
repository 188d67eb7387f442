"""From all photons down to one coordinate, step by step."""

from typing import Any

from chromanoise import _check
from chromanoise.analysis.budgets import coordinate_budget
from chromanoise.analysis.stages import Analysis, color_snr_db
from chromanoise.charts.shown import Look, Shown, saturation_sentence
from chromanoise.color import LAB
from chromanoise.exposure import expected_electrons
from chromanoise.metrics import Budget
from chromanoise.metrics.budget_chain import without_infrared


def drawn_budget(shown: Shown, look: Look) -> dict[str, Any]:
    """The dB budget of one coordinate as a waterfall.

    Raises
    ------
    InputError
        If no sensor has such a coordinate.
    """
    known = dict.fromkeys(
        name
        for analysis in shown.analyses
        for name in (
            *analysis.color.names,
            *LAB.coordinates,
            *(f"M^{channel}" for channel in analysis.sensor.names),
        )
    )
    _check.one_of("coordinate", look.coordinate, tuple(known))
    return {
        "coordinate": look.coordinate,
        "coordinates": list(known),
        "sensors": [_sensor(analysis, look.coordinate) for analysis in shown.analyses],
    }


def _sensor(analysis: Analysis, coordinate: str) -> dict[str, Any]:
    budget = coordinate_budget(analysis, coordinate)
    return {
        "name": analysis.sensor.name,
        "why_not": None if budget else _why_not(analysis, coordinate),
        "bound_db": budget.optimal_linear_snr_db if budget else None,
        "steps": _steps(budget) if budget else [],
    }


def _why_not(analysis: Analysis, coordinate: str) -> str:
    name = analysis.sensor.name
    full = saturation_sentence(analysis)
    if full is not None:
        return full
    channel = coordinate.removeprefix("M^")
    if coordinate.startswith("M^") and channel not in analysis.sensor.names:
        return f"{name} has no channel {channel}"
    if color_snr_db(analysis).get(coordinate) is not None:
        return _why_no_budget(analysis, coordinate)
    return (
        f"{name} has no SNR of {coordinate}: its channels and this matrix make no signal of it in "
        "this light; take another matrix or another light"
    )


def _why_no_budget(analysis: Analysis, coordinate: str) -> str:
    """Of a coordinate that has an SNR: a budget counts what the visible light makes of it."""
    seen = without_infrared(analysis.scene)
    electrons = expected_electrons(seen, analysis.sensor, analysis.exposure)
    row = analysis.matrix.matrix[analysis.matrix.coordinates.index(coordinate)]
    if row @ electrons > 0:
        return (
            f"{analysis.sensor.name}: its channels one by one make no {coordinate} of this light, "
            "so there is no budget of it; take another light"
        )
    return (
        f"{analysis.sensor.name}: its {coordinate} comes from the infrared; the visible part of it "
        "is not above 0, so it has no budget; take an IR-cut, another matrix or another light"
    )


def _steps(budget: Budget) -> list[dict[str, Any]]:
    at = budget.photons_db
    steps = [_step("all photons", 0.0, at, at, "start", "every photon that hits the pixels")]
    for cost in budget.costs:
        kind = "gain" if cost.loss_db < 0 else "cost"
        steps.append(_step(cost.cause, -cost.loss_db, at, at - cost.loss_db, kind, cost.reading))
        at -= cost.loss_db
    end = budget.snr_db
    return [*steps, _step(f"SNR of {budget.coordinate}", 0.0, end, end, "end", "what is left")]


def _step(
    label: str, change_db: float, from_db: float, to_db: float, kind: str, reading: str
) -> dict[str, Any]:
    return {
        "label": label,
        "change_db": change_db,
        "from_db": from_db,
        "to_db": to_db,
        "kind": kind,
        "reading": reading,
    }
