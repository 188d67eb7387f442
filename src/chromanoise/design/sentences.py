"""Sentences on a front: extremes, knee, references, limits that hold, tolerances, convergence."""

from collections.abc import Mapping, Sequence

import numpy as np

from chromanoise.design.front import Front, Member
from chromanoise.design.objectives import OBJECTIVES, Objective
from chromanoise.design.parameters import Parameter
from chromanoise.design.search import FrontResult

_AT_BOUND = 1e-3  # distance from a bound, as a share of the range, at which the bound holds
_HALF = (0.45, 0.55)  # ratios that are called half
_TIMES = 1.5  # ratio from which a multiple is printed, not a percentage
AGREEING_DB, AGREEING_SHARE = 0.05, 0.01
"""Differences of the extremes of several seeds up to which a search counts as converged."""
STILL_RISING = 0.02
"""Relative rise of the hypervolume in the second half of the evaluations, up to which a search
counts as converged."""
_ALIKE = 0.005  # relative difference below which no percentage is printed


def held_by(member: Member, parameters: Sequence[Parameter]) -> list[str]:
    """The active constraints and bounds of a member, such as ``R.center_nm <= 680``.

    Parameters
    ----------
    member
        Of a front.
    parameters
        In the order of its values.
    """
    bounds = []
    for value, one in zip(np.asarray(member.values).tolist(), parameters, strict=True):
        if one.choices:
            continue
        if value - one.low <= _AT_BOUND * one.span:
            bounds.append(f"{one.name} >= {one.low:g}")
        if one.high - value <= _AT_BOUND * one.span:
            bounds.append(f"{one.name} <= {one.high:g}")
    return [*member.active, *bounds]


def front_sentences(
    front: Front,
    parameters: Sequence[Parameter],
    references: Mapping[str, Mapping[str, float]],
) -> list[str]:
    """One sentence per extreme and for the knee, and how many members beat the references.

    Parameters
    ----------
    front
        The front.
    parameters
        Of its members.
    references
        Objectives of the references by name.
    """
    marked = [one for one in front.members if one.extreme_of or one.knee]
    sentences = [_sentence(one, front, parameters) for one in marked]
    if references:
        sentences.append(_beaten(front, references))
    return sentences


def tolerance_sentence(member: Member, beside: Mapping[str, float], which: str) -> str:
    """What the tolerances cost a member, in words.

    Parameters
    ----------
    member
        Of a front.
    beside
        Its ``nominal`` or its ``robust`` objectives, by name, beside those of the front.
    which
        What ``beside`` holds.
    """
    parts = []
    for name, value in member.objectives.items():
        exact, robust = (beside[name], value) if which == "nominal" else (value, beside[name])
        one = OBJECTIVES[name]
        after = _shown(robust, one) if np.isfinite(robust) else "undefined"
        parts.append(f"{one.short} from {_shown(exact, one)} to {after}")
    return f"{member.name}: its tolerances change {', '.join(parts)}."


def tolerances_sentence(
    members: Sequence[Member], beside: Sequence[Mapping[str, float]], which: str
) -> str:
    """The extremes of a front in the ``nominal`` or ``robust`` values not used by its search.

    Parameters
    ----------
    members
        Members of a front.
    beside
        The ``nominal`` or ``robust`` objectives of each member, by name.
    which
        ``nominal`` or ``robust``.
    """
    parts = []
    for name in members[0].objectives:
        objective = OBJECTIVES[name]
        best = best_of(objective, [one[name] for one in beside])
        value = beside[best][name]
        shown = _shown(value, objective) if np.isfinite(value) else "undefined"
        parts.append(f"the {_best(objective)} is {shown} ({members[best].name})")
    words = "Within the tolerances" if which == "robust" else "With exact parameters"
    return f"{words}, {', '.join(parts)}."


def best_of(objective: Objective, values: Sequence[float]) -> int:
    """Index of the best value of an objective; of equal values the first one."""
    return int(np.argmax(values) if objective.better == "higher" else np.argmin(values))


def spread_of(objective: Objective, values: Sequence[float]) -> float:
    """Largest minus smallest of several best values: in dB, otherwise relative to the best one.

    Examples
    --------
    >>> spread_of(OBJECTIVES["delta_e"], [4.0, 4.1])
    0.025
    """
    if not np.isfinite(values).all():
        return float("inf")
    width = float(np.max(values) - np.min(values))
    best = abs(values[best_of(objective, values)])
    if objective.unit == "dB" or width == 0:
        return width
    return round(width / best, 12) if best else float("inf")


def rise_of(result: FrontResult) -> float | None:
    """Relative rise of the hypervolume in the second half of the evaluations; ``None`` if none."""
    milestones = result.convergence.milestones
    last = milestones[-1].hypervolume
    half = [one for one in milestones if one.evaluations <= result.evaluations / 2]
    if last is None or not half:
        return None
    before = half[-1].hypervolume
    return (last - before) / before if before else float("inf")


def has_converged(result: FrontResult, objectives: Sequence[str]) -> bool | None:
    """Whether the seeds agree and the hypervolume rises by at most 2 %; ``None`` for one seed."""
    best = result.convergence.best
    if len(best) < 2:
        return None
    rise = rise_of(result)
    agree = all(
        spread_of(one, best[:, i].tolist()) <= _agreeing(one)
        for i, one in enumerate(OBJECTIVES[name] for name in objectives)
    )
    return agree and (rise is None or rise <= STILL_RISING)


def _agreeing(objective: Objective) -> float:
    return AGREEING_DB if objective.unit == "dB" else AGREEING_SHARE


def convergence_sentences(result: FrontResult, objectives: Sequence[str]) -> list[str]:
    """Sentences on the effort of a search, its convergence, and what to do if not converged.

    Parameters
    ----------
    result
        Result of the search.
    objectives
        Names of its objectives.
    """
    own, count = result.convergence, len(result.convergence.seeds)
    polish = f", {result.gradient_evaluations} gradients" if result.gradient_evaluations else ""
    effort = f"{result.evaluations} sensors{polish}, {count} seed{'' if count == 1 else 's'}"
    converged = has_converged(result, objectives)
    if converged is None:
        sentences = [
            f"Whether the search has converged is not known ({effort}): set design.seeds = 3."
        ]
    else:
        differences = []
        for i, name in enumerate(objectives):
            one = OBJECTIVES[name]
            spread = spread_of(one, own.best[:, i].tolist())
            difference = f"{spread:.2g} dB" if one.unit == "dB" else f"{100 * spread:.2g} %"
            differences.append(
                f"{difference if np.isfinite(spread) else 'undefined'} in {one.short}"
            )
        rise = rise_of(result)
        shown = (
            ""
            if rise is None
            else f"; the hypervolume rose by {_rising(rise)} in the last half of the evaluations"
        )
        verdict = (
            "The search has converged"
            if converged
            else "The search has not converged; raise design.budget"
        )
        sentences = [
            f"{verdict} ({effort}): the best values of the seeds differ by "
            f"{', '.join(differences)}{shown}."
        ]
    if result.undefined:
        sentences.append(
            f"{result.undefined} of {result.evaluations} sensors count as infeasible, because an "
            "objective is undefined: a channel has no signal or is saturated."
        )
    sentences += [f"The polish ended early: {one}." for one in own.failures]
    return sentences


def _rising(rise: float) -> str:
    return f"{100 * rise:.2g} %" if np.isfinite(rise) else "its whole value, from 0"


def beats(member: Mapping[str, float], other: Mapping[str, float], names: Sequence[str]) -> bool:
    """Whether a design is no worse in any objective and better in one.

    Examples
    --------
    >>> beats({"snr_y_db": 26.0, "delta_e": 3.0}, {"snr_y_db": 25.0, "delta_e": 3.0},
    ...       ["snr_y_db", "delta_e"])
    True
    """
    gains = [_gain(OBJECTIVES[name], member[name], other[name]) for name in names]
    return all(gain >= 0 for gain in gains) and any(gain > 0 for gain in gains)


def _gain(objective: Objective, value: float, other: float) -> float:
    if value == other:  # also both infinite
        return 0.0
    return value - other if objective.better == "higher" else other - value


def _beaten(front: Front, references: Mapping[str, Mapping[str, float]]) -> str:
    winners = [
        one
        for one in front.members
        if all(beats(one.objectives, other, front.objectives) for other in references.values())
    ]
    names = " and ".join(references)
    count = f"{len(winners)} of {len(front.members)} sensors"
    are = "is" if len(winners) == 1 else "are"
    return f"{count} {are} better than {names} in at least one objective and worse in none."


def _sentence(member: Member, front: Front, parameters: Sequence[Parameter]) -> str:
    parts = []
    for name in member.extreme_of:
        objective = OBJECTIVES[name]
        value = _shown(member.objectives[name], objective)
        parts.append(f"the {_best(objective)} ({value})")
    for name in front.objectives:
        if name not in member.extreme_of:
            gain = "" if member.extreme_of else _gain_for(member, front.best(name), front)
            parts.append(f"{_shortfall(member, front.best(name), OBJECTIVES[name])}{gain}")
    held = held_by(member, parameters)
    end = f" Held by {', '.join(held)}." if held else ""
    return f"{member.name}: {'; '.join(parts)}.{end}"


def _best(objective: Objective) -> str:
    return f"{'best' if objective.better == 'higher' else 'lowest'} {objective.short}"


def _shortfall(member: Member, best: Member, objective: Objective) -> str:
    """How far a member is from the best value of an objective."""
    value, goal = member.objectives[objective.name], best.objectives[objective.name]
    if objective.unit == "dB":
        return f"{abs(value - goal):.1f} dB short of the {_best(objective)}"
    ratio = value / goal if goal else np.inf
    if not np.isfinite(ratio):
        return f"a {objective.short} of {_shown(value, objective)}"
    if abs(ratio - 1) < _ALIKE:
        return f"within {100 * _ALIKE:g} % of the {_best(objective)}"
    if ratio >= _TIMES:
        return f"{_ratio(ratio)} times the {_best(objective)}"
    side = "above" if ratio > 1 else "below"
    return f"{_percent(abs(ratio - 1))} {side} the {_best(objective)}"


def _gain_for(member: Member, best: Member, front: Front) -> str:
    """What a member gains over another one, in the first objective in which it is better."""
    for name in front.objectives:
        objective = OBJECTIVES[name]
        value, before = member.objectives[name], best.objectives[name]
        if _gain(objective, value, before) > 0:
            return f" for {_gained(value, before, objective)}"
    return ""


def _gained(value: float, before: float, objective: Objective) -> str:
    if objective.unit == "dB":
        return f"{abs(value - before):.1f} dB more {objective.short}"
    ratio = value / before if before else np.inf
    if not np.isfinite(ratio):
        return f"a {objective.short} of {_shown(value, objective)}"
    if _HALF[0] <= ratio <= _HALF[1]:
        return f"half the {objective.short}"
    if ratio >= _TIMES:
        return f"{_ratio(ratio)} times the {objective.short}"
    return f"{_percent(ratio)} of the {objective.short}"


def _ratio(ratio: float) -> str:
    return f"{ratio:.0f}" if ratio >= 10 else f"{ratio:.2g}"


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %" if share >= 0.1 else f"{100 * share:.2g} %"


def _shown(value: float, objective: Objective) -> str:
    unit = "" if objective.unit == "1" else f" {objective.unit}"
    return f"{value:.4g}{unit}"
