"""Who has the better raw signal, who the better color, by how much and why: in sentences."""

from collections.abc import Sequence

import numpy as np

from chromanoise.merit import Budget
from chromanoise.merit.budget import CAUSES, FILTERS
from chromanoise.study.analysis import (
    Analysis,
    color_snr_db,
    mean_color_error,
    raw_snr_db,
)
from chromanoise.study.drawings.budget import coordinate_budget
from chromanoise.study.drawings.shown import saturation_sentence

_TIE_DB = 0.05  # what one decimal cannot tell apart
_WORTH_DB = 0.3  # a cause that costs less is no reason
_WHY = {
    "read noise": "read noise",
    "weights": "weighting its channels for the eye",
    "correlation": "unmixing its correlated channels",
    "infrared": "infrared that carries no color",
    "filters": "light that its filters take away",
}


def verdict_sentences(analyses: Sequence[Analysis]) -> list[str]:
    """What an engineer would say of these sensors side by side.

    First who has the better raw signal and who the better luminance, then why, then what the
    color is worth; sensors that are saturated or have no luminance are told apart.
    """
    told = [sentence for a in analyses if (sentence := _left_out(a))]
    able = [a for a in analyses if _left_out(a) is None]
    if len(able) == 1:
        told.insert(0, _alone(able[0]))
    if len(able) < 2:
        return told
    best_raw = max(able, key=lambda a: _raw_db(a, able))
    best_color = max(able, key=_luminance_db)
    if abs(_luminance_db(best_raw) - _luminance_db(best_color)) < _TIE_DB:
        best_color = best_raw  # equals: who leads in raw is named once
    others = [a for a in able if a is not best_color]
    rival = best_raw if best_raw is not best_color else max(others, key=_luminance_db)
    first = _contest(best_color, rival, best_raw, able)
    return [first, *_reasons(best_color, rival), _colors(able), *told]


def _left_out(analysis: Analysis) -> str | None:
    full = saturation_sentence(analysis)
    if full is not None:
        return f"{full}."
    if color_snr_db(analysis)["Y"] is None:
        return (
            f"{analysis.sensor.name}: its matrix makes no luminance of this light, so it has no "
            "color to compare."
        )
    return None


def _alone(analysis: Analysis) -> str:
    budget = coordinate_budget(analysis, "Y")
    most = _largest(budget)
    why = f", most of it for {_WHY[most[0]]} ({most[1]:.1f} dB)" if most else ""
    return (
        f"{_setting(analysis)} {analysis.sensor.name} has {_luminance_db(analysis):.1f} dB of "
        f"luminance SNR, {analysis.price_db:.1f} dB below what its raw channels hold together"
        f"{why}; {_error(analysis)}."
    )


def _contest(winner: Analysis, rival: Analysis, best_raw: Analysis, able: list[Analysis]) -> str:
    measure = _measure(able)
    gap = _luminance_db(winner) - _luminance_db(rival)
    if best_raw is winner:
        raw = _raw_db(winner, able) - _raw_db(rival, able)
        ahead = "level with" if raw < _TIE_DB else f"{raw:.1f} dB better than"
        color = "level with it" if abs(gap) < _TIE_DB else f"{gap:.1f} dB better"
        return (
            f"{_setting(winner)} {winner.sensor.name} is {ahead} {rival.sensor.name} in raw "
            f"({measure}) and {color} in luminance ({_pair(winner, rival)})."
        )
    raw = _raw_db(rival, able) - _raw_db(winner, able)
    ahead = "level with" if raw < _TIE_DB else f"{raw:.1f} dB better than"
    return (
        f"{_setting(winner)} {rival.sensor.name} is {ahead} {winner.sensor.name} in raw "
        f"({measure}) but {gap:.1f} dB worse in luminance ({_pair(rival, winner)})."
    )


def _pair(first: Analysis, second: Analysis) -> str:
    return f"SNR of Y {_luminance_db(first):.1f} against {_luminance_db(second):.1f} dB"


def _reasons(winner: Analysis, loser: Analysis) -> list[str]:
    """The causes that cost the loser most beyond what they cost the winner."""
    good, bad = (_costs(coordinate_budget(a, "Y")) for a in (winner, loser))
    beyond = {cause: bad[cause] - good[cause] for cause in bad if cause in good}
    worst = sorted((c for c in beyond if beyond[c] >= _WORTH_DB), key=lambda c: -beyond[c])[:2]
    if not worst or _luminance_db(winner) - _luminance_db(loser) < _TIE_DB:
        return []
    parts = [f"{_WHY[c]} costs {bad[c]:.1f} dB (there {good[c]:.1f})" for c in worst]
    return [f"What {loser.sensor.name} loses to {winner.sensor.name}: {' and '.join(parts)}."]


def _colors(able: Sequence[Analysis]) -> str:
    found = [(a.sensor.name, mean_color_error(a)) for a in able]
    told = ", ".join(f"{name} {'none' if e is None else f'{e:.1f}'}" for name, e in found)
    return f"Mean color error without noise, Delta E*ab: {told}."


def _costs(budget: Budget | None) -> dict[str, float]:
    costs = budget.costs if budget else ()
    return {cost.cause: cost.loss_db for cost in costs if cost.cause in CAUSES}


def _largest(budget: Budget | None) -> tuple[str, float] | None:
    """The largest cause beyond the filters, which every color sensor has."""
    costs = {c: loss for c, loss in _costs(budget).items() if c != FILTERS and loss >= _WORTH_DB}
    return max(costs.items(), key=lambda item: item[1]) if costs else None


def _setting(analysis: Analysis) -> str:
    scene = analysis.scene
    return f"At {scene.level_lux:.4g} lx of {scene.illuminant.name}"


def _shared(able: Sequence[Analysis]) -> list[str]:
    """Channels that all sensors have and that all see something in."""
    found = [raw_snr_db(analysis) for analysis in able]
    return [
        name for name in able[0].sensor.names if all(one.get(name) is not None for one in found)
    ]


def _raw_db(analysis: Analysis, able: Sequence[Analysis]) -> float:
    shared, snr = _shared(able), raw_snr_db(analysis)
    return float(np.mean([snr[name] for name in shared])) if shared else analysis.bound_db


def _measure(able: Sequence[Analysis]) -> str:
    shared = _shared(able)
    return f"mean of {', '.join(shared)}" if shared else "best linear readout of all channels"


def _luminance_db(analysis: Analysis) -> float:
    found = color_snr_db(analysis)["Y"]
    assert found is not None  # asked only of those that have one
    return found


def _error(analysis: Analysis) -> str:
    error = mean_color_error(analysis)
    return "no mean color error" if error is None else f"mean color error {error:.1f} Delta E*ab"
