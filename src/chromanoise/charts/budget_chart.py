"""The dB budget of one coordinate, from all photons, as a waterfall chart."""

from collections.abc import Sequence
from functools import partial
from typing import Any

from chromanoise.base import check
from chromanoise.charts.charted_study import Look, Shown, saturation_sentence
from chromanoise.charts.description import Axis, Bars, Chart, Panel, Role, column
from chromanoise.charts.numbers import NONE, decimal, signed
from chromanoise.color import LAB
from chromanoise.metrics import REST, WEIGHTS, Budget, without_infrared
from chromanoise.noise import conditions, expected_electrons
from chromanoise.study import Analysis, color_snr_db, coordinate_budget, metric_of

_KEY = (
    "First and last bar: the SNR before and after. Gray: costs. Outlined: gains. All in dB, on "
    "one scale. Gain if removed: how much the SNR would change without this one cause; these do "
    "not add up."
)


def drawn_budget(shown: Shown, look: Look) -> Chart:
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
    return budget_of(shown.analyses, look.coordinate)


def budget_of(analyses: Sequence[Analysis], coordinate: str) -> Chart:
    """The chart ``budget`` of some analyses under one light.

    Parameters
    ----------
    coordinate
        X, Y or Z, a contravariant coordinate as M^R, or L*, a*, b* of a gray.
    """
    budgets = [coordinate_budget(analysis, coordinate) for analysis in analyses]
    return waterfall(
        [one.sensor.label for one in analyses],
        budgets,
        coordinate,
        title=(
            f"Budget of the SNR of {coordinate_label(coordinate)} at "
            f"{conditions([one.point for one in analyses])}, {metric_of(analyses)}"
        ),
        why_not=[
            "" if budget else _why_not(analysis, coordinate)
            for analysis, budget in zip(analyses, budgets, strict=True)
        ],
    )


def waterfall(
    names: Sequence[str],
    budgets: Sequence[Budget | None],
    coordinate: str,
    *,
    title: str = "",
    why_not: Sequence[str] = (),
) -> Chart:
    """A panel per sensor with a bar per step, from all photons to the SNR.

    Parameters
    ----------
    names
        Names of the sensors.
    budgets
        One per sensor, all of one coordinate.
    why_not
        Why each sensor has no budget, empty where it has one; none where all have one.
    """
    reasons, label = why_not or [""] * len(names), coordinate_label(coordinate)
    rows: list[tuple[Any, ...]] = []
    panels, parts = [], [f"What the SNR of {label} loses and gains, from all photons to the end."]
    levels = [0.0, *(db for one in budgets if one for step in _steps(one) for db in step[3:5])]
    x = Axis(label=f"SNR of {label} [dB]", low=min(levels), high=max(levels) or 1.0)
    for i, (name, budget, reason) in enumerate(zip(names, budgets, reasons, strict=True)):
        steps, first = _steps(budget) if budget else [], len(rows)
        rows += [(name, *step) for step in steps] or [(name, reason, *[None] * 4, NONE)]
        texts: list[str] = []
        roles: list[Role] = []
        for _, change, _, _, level, _ in steps:
            if change is None:
                roles.append("total")
                texts.append(decimal(level))
            else:
                roles.append("cost" if change <= 0 else "gain")
                texts.append(signed(change))
        bars = Bars(
            label=1,
            start=4,
            end=5,
            first=first,
            last=len(rows),
            roles=tuple(roles),
            texts=tuple(texts),
        )
        panels.append(Panel(x=x, marks=(bars,) if budget else (), sensor=i, absence=reason))
        said = ", ".join(f"{step[0]} {text} dB" for step, text in zip(steps, texts, strict=True))
        parts.append(f"{name}: {said or reason}.")
    sensors, labels, changes, gains, before, after, why = zip(*rows, strict=True)
    number = partial(decimal, digits=2)
    return Chart(
        title=title,
        description=" ".join(parts),
        sensors=tuple(names),
        columns=(
            column("sensor", sensors),
            column("step", labels),
            column(
                "change [dB]",
                [0.0 if one is None else one for one in changes],
                [NONE if one is None else signed(one, 2) for one in changes],
            ),
            column(
                "gain if removed [dB]",
                gains,
                [NONE if one is None else signed(one, 2) for one in gains],
            ),
            column(f"SNR of {coordinate} before [dB]", before, None),
            column(f"SNR of {coordinate} [dB]", after, number, shown=f"SNR of {label} [dB]"),
            column(None, why, shown="why"),
        ),
        panels=tuple(panels),
        whole_rows=True,
        notes=(_KEY,) if any(budgets) else (),
        without_numbers=tuple(i for i, row in enumerate(rows) if row[5] is None),
    )


_Step = tuple[str, float | None, float | None, float, float, str]


def _steps(budget: Budget) -> list[_Step]:
    """Label, change, gain if removed, SNR before and after, and why. [dB]"""
    at, end = budget.photons_db, budget.snr_db
    found: list[_Step] = [("all photons", None, None, at, at, "every photon that hits the pixels")]
    for cost in budget.costs:
        after = at - cost.cost_db
        label = cause_label(cost.cause, budget.coordinate)
        gain_db = cost.gain_if_removed_db
        found.append((label, -cost.cost_db, gain_db, at, after, cost.reading))
        at = after
    return [
        *found,
        (f"SNR of {coordinate_label(budget.coordinate)}", None, None, end, end, "what is left"),
    ]


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
