"""The dB budget of one coordinate, from all photons, as a waterfall chart."""

from typing import Any

from chromanoise.base import check
from chromanoise.charts.charted_study import Look, Shown, saturation_sentence
from chromanoise.charts.numbers import NONE, decimal, signed, table
from chromanoise.color import LAB
from chromanoise.metrics import REST, WEIGHTS, Budget, without_infrared
from chromanoise.noise import conditions, expected_electrons
from chromanoise.study import Analysis, color_snr_db, coordinate_budget, metric_of


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
    check.one_of("coordinate", look.coordinate, tuple(known))
    sensors = [_sensor(analysis, look.coordinate) for analysis in shown.analyses]
    return {
        "title": (
            f"Budget of the SNR of {coordinate_label(look.coordinate)} at "
            f"{conditions(shown.operating_points)}, {metric_of(shown.analyses)}"
        ),
        "description": _description(sensors, look.coordinate),
        "coordinate": look.coordinate,
        "coordinates": list(known),
        "sensors": sensors,
        "table": _table(sensors, look.coordinate),
    }


def cause_label(cause: str, *coordinates: str) -> str:
    """The label of a cause of `chromanoise.metrics.Budget` in charts and tables.

    Parameters
    ----------
    cause
        A cause of the budget.
    coordinates
        The coordinates that share the label.

    Examples
    --------
    >>> cause_label("weights", "Y"), cause_label("rest", "Y"), cause_label("read noise", "Y")
    ('color target', 'infrared leaking into Y', 'read noise')
    """
    one_channel = coordinates[0].startswith("M^")
    if cause == WEIGHTS:
        return "one channel alone" if one_channel else "color target"
    if cause == REST:
        if coordinates[0] in LAB.coordinates:
            return "error of the color matrix"
        return "remainder" if one_channel else f"infrared leaking into {', '.join(coordinates)}"
    return cause


def coordinate_label(coordinate: str) -> str:
    """A coordinate of a budget in words.

    Examples
    --------
    >>> coordinate_label("Y"), coordinate_label("M^R")
    ('Y', 'contravariant R')
    """
    letter, power, channel = coordinate.partition("^")
    return f"contravariant {channel}" if power else letter


def _sensor(analysis: Analysis, coordinate: str) -> dict[str, Any]:
    budget = coordinate_budget(analysis, coordinate)
    return {
        "name": analysis.sensor.label,
        "why_not": None if budget else _why_not(analysis, coordinate),
        "bound_db": budget.optimal_linear_snr_db if budget else None,
        "steps": budget_steps(budget) if budget else [],
    }


def _why_not(analysis: Analysis, coordinate: str) -> str:
    name = analysis.sensor.label
    full = saturation_sentence(analysis)
    if full is not None:
        return full
    if analysis.readout is not None:
        return f"{name}: a budget follows eq. 7, so clipped values have none"
    channel = coordinate.removeprefix("M^")
    if coordinate.startswith("M^") and channel not in analysis.sensor.names:
        return f"{name} has no channel {channel}"
    if color_snr_db(analysis).get(coordinate) is not None:
        return _why_no_budget(analysis, coordinate)
    return (
        f"{name}: the SNR of {coordinate} is undefined, because its channels and matrix give no "
        f"valid {coordinate} under this light; use another matrix or another light"
    )


def _why_no_budget(analysis: Analysis, coordinate: str) -> str:
    """Why a coordinate with an SNR has no budget: a budget counts only its visible part."""
    seen = without_infrared(analysis.scene)
    electrons = expected_electrons(seen, analysis.sensor, analysis.exposure)
    row = analysis.matrix.matrix[analysis.matrix.coordinates.index(coordinate)]
    if row @ electrons > 0:
        return (
            f"{analysis.sensor.label}: weighting its channels one by one gives no valid "
            f"{coordinate} under this light, so it has no budget; use another light"
        )
    return (
        f"{analysis.sensor.label}: its {coordinate} comes from the infrared; the visible part of "
        "is not above 0, so it has no budget; use an IR-cut, another matrix or another light"
    )


def _description(sensors: list[dict[str, Any]], coordinate: str) -> str:
    name = coordinate_label(coordinate)
    parts = [f"What the SNR of {name} loses and gains, from all photons to the end."]
    for sensor in sensors:
        steps = ", ".join(f"{step['label']} {step['text']} dB" for step in sensor["steps"])
        parts.append(f"{sensor['name']}: {steps or sensor['why_not']}.")
    return " ".join(parts)


def _table(sensors: list[dict[str, Any]], coordinate: str) -> dict[str, Any]:
    rows = []
    for sensor in sensors:
        if not sensor["steps"]:
            rows.append([sensor["name"], sensor["why_not"], NONE, NONE, NONE])
        for step in sensor["steps"]:
            change = NONE if step["kind"] in ("start", "end") else signed(step["change_db"], 2)
            level = decimal(step["to_db"], 2)
            rows.append([sensor["name"], step["label"], change, level, step["reading"]])
    return table(
        ["sensor", "step", "change [dB]", f"SNR of {coordinate_label(coordinate)} [dB]", "why"],
        rows,
    )


def budget_steps(budget: Budget) -> list[dict[str, Any]]:
    """The bars of a waterfall: all photons, each cause from where the bar before ends, the SNR.

    Parameters
    ----------
    budget
        The budget of one coordinate.
    """
    at = budget.photons_db
    steps = [_step("all photons", 0.0, at, at, "start", "every photon that hits the pixels")]
    for cost in budget.costs:
        kind = "gain" if cost.loss_db < 0 else "cost"
        label = cause_label(cost.cause, budget.coordinate)
        steps.append(_step(label, -cost.loss_db, at, at - cost.loss_db, kind, cost.reading))
        at -= cost.loss_db
    end = budget.snr_db
    name = coordinate_label(budget.coordinate)
    return [*steps, _step(f"SNR of {name}", 0.0, end, end, "end", "what is left")]


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
        "text": decimal(to_db) if kind in ("start", "end") else signed(change_db),
    }
