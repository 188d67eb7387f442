"""The verdict for a machine that reads raw values, in one sentence; for an eye see `verdicts`."""

from collections.abc import Sequence

from chromanoise.analysis.analysis import Analysis
from chromanoise.analysis.separation import pairs_of, raw_medians
from chromanoise.spectra import chart_title

_TIE = 0.005  # relative difference that is no lead


def machine_sentences(analyses: Sequence[Analysis]) -> list[str]:
    """One sentence: median distances of the pairs of patches in raw values.

    Sensors with a saturated patch are left out.

    Parameters
    ----------
    analyses
        Analyses under one light.
    """
    medians = [(one.sensor.label, raw_medians(one)) for one in analyses]
    found = [(label, *both) for label, both in medians if both is not None]
    if not found:
        return []
    point = analyses[0].point
    patches = chart_title(point.chart) if point.pairs is None else point.pairs.patches.source
    count = len(pairs_of(point).indices)
    what = f"the {count} pairs of {patches}" if count > 1 else f"the pair of {patches}"
    if len(found) == 1:
        label, with_it, without = found[0]
        return [
            f"A machine that reads the raw values of {label} separates {what} with a median "
            f"distance of {_text(with_it)}, or {_text(without)} without brightness."
        ]
    best = max(found, key=lambda one: one[1])
    rival = max((one for one in found if one is not best), key=lambda one: one[1])
    return [_contest(best, rival, what)]


_Medians = tuple[str, float, float]  # label, median D_M with and without brightness


def _contest(best: _Medians, rival: _Medians, what: str) -> str:
    than = "as well as" if _tied(best[1], rival[1]) else "better than"
    first = (
        f"For a machine that reads raw values, {best[0]} separates {what} {than} {rival[0]}: "
        f"median distance {_text(best[1])} against {_text(rival[1])}"
    )
    if rival[2] > best[2] and not _tied(best[2], rival[2]):
        return (
            f"{first}; without brightness {rival[0]} is better, {_text(rival[2])} against "
            f"{_text(best[2])}."
        )
    return f"{first}; without brightness {_text(best[2])} against {_text(rival[2])}."


def _tied(one: float, other: float) -> bool:
    return abs(one - other) <= _TIE * max(one, other)


def _text(distance: float) -> str:
    return f"{distance:#.3g}" if distance < 100 else f"{distance:.0f}"
