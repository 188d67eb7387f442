"""A front in words: what its extremes and its knee give up for what, and what holds them."""

from collections.abc import Mapping, Sequence

import numpy as np

from chromanoise.design.front import Front, Member
from chromanoise.design.objectives import OBJECTIVES, Objective
from chromanoise.design.parameters import Parameter

_AT_BOUND = 1e-3  # distance from a bound, as a share of the range, at which the bound holds
_HALF = (0.45, 0.55)
_ALIKE = 0.005  # relative difference below which two values are called the same


def held_by(member: Member, parameters: Sequence[Parameter]) -> list[str]:
    """The constraints and the bounds of parameters that hold a member.

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
            bounds.append(f"the bound {one.name} >= {one.low:g}")
        if one.high - value <= _AT_BOUND * one.span:
            bounds.append(f"the bound {one.name} <= {one.high:g}")
    return [*(f"the constraint {name}" for name in member.active), *bounds]


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
    told = [one for one in front.members if one.extreme_of or one.knee]
    sentences = [_sentence(one, front, parameters) for one in told]
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
        parts.append(f"{one.what} from {_shown(exact, one)} to {after}")
    return f"{member.name}: its tolerances change {_listed(parts)}."


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
    count = f"{len(winners)} of {len(front.members)} designs"
    return (
        f"{count} {'is' if len(winners) == 1 else 'are'} better than {names} in one objective or "
        "more and worse in none."
    )


def _sentence(member: Member, front: Front, parameters: Sequence[Parameter]) -> str:
    parts = []
    for name in member.extreme_of:
        objective = OBJECTIVES[name]
        parts.append(f"the best {objective.what} ({_shown(member.objectives[name], objective)})")
    for name in front.objectives:
        if name in member.extreme_of:
            continue
        parts.append(_trade(member, front.best(name), name, front))
    held = held_by(member, parameters)
    end = f"; held by {_listed(held)}" if held else ""
    return f"{member.name}: {'; '.join(parts)}{end}."


def _trade(member: Member, best: Member, name: str, front: Front) -> str:
    """What a member lacks in one objective, and what it gains over the best one for it."""
    objective = OBJECTIVES[name]
    short = _short(member.objectives[name], best.objectives[name], objective)
    gains = []
    for other in front.objectives:
        one = OBJECTIVES[other]
        if other != name and _gain(one, member.objectives[other], best.objectives[other]) > 0:
            gains.append(_gained(member.objectives[other], best.objectives[other], one))
    for_what = f" for {_listed(gains)}" if gains else ""
    return f"{short} the best {objective.what} ({best.name}){for_what}"


def _short(value: float, best: float, objective: Objective) -> str:
    if objective.unit == "dB":
        return f"{abs(value - best):.1f} dB short of"
    if best == 0 or not np.isfinite(value / best):
        return f"{_shown(value, objective)} against"
    ratio = value / best
    if abs(ratio - 1) < _ALIKE:
        return "the same as"
    if objective.better == "lower":
        return f"{_ratio(ratio)} times"
    return f"{100 * (1 - ratio):.2g} % short of"


def _gained(value: float, before: float, objective: Objective) -> str:
    if objective.unit == "dB":
        return f"{abs(value - before):.1f} dB more {objective.what}"
    ratio = value / before if before else np.inf
    if not np.isfinite(ratio):
        return f"a {objective.what} of {_shown(value, objective)}"
    if _HALF[0] <= ratio <= _HALF[1]:
        return f"half the {objective.what}"
    return f"{_ratio(ratio)} times the {objective.what}"


def _ratio(ratio: float) -> str:
    return f"{ratio:.0f}" if ratio >= 10 else f"{ratio:.2g}"


def _shown(value: float, objective: Objective) -> str:
    unit = "" if objective.unit == "1" else f" {objective.unit}"
    return f"{value:.4g}{unit}"


def _listed(words: Sequence[str]) -> str:
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last
