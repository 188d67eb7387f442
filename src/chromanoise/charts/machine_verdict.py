"""The verdict for a machine that reads raw values; for an eye see `verdicts`."""

from collections.abc import Callable, Sequence

from chromanoise.analysis.analysis import Analysis
from chromanoise.analysis.separation import (
    RAW,
    RAW_WITHOUT,
    PairOutcome,
    RawOutcome,
    pairs_of,
    raw_outcomes,
)
from chromanoise.spectra import chart_title

_TIE = 0.005  # relative difference that is no lead

_Labeled = tuple[str, RawOutcome]
_PairOf = Callable[[RawOutcome], PairOutcome]


def machine_sentences(analyses: Sequence[Analysis]) -> list[str]:
    """Distances of the pairs of patches in raw values: median and worst, with their probability.

    One sentence with brightness, one without. Sensors with a saturated patch are omitted. A
    decision that is nearly chance is marked as such.

    Parameters
    ----------
    analyses
        Analyses under one light.
    """
    outcomes = [(one.sensor.label, raw_outcomes(one)) for one in analyses]
    found = [(label, both) for label, both in outcomes if both is not None]
    if not found:
        return []
    point = analyses[0].point
    patches = chart_title(point.chart) if point.pairs is None else point.pairs.patches.source
    count = len(pairs_of(point).indices)
    what = f"the {count} pairs of {patches}" if count > 1 else f"the pair of {patches}"
    return [
        f"{start}: {_sentence([(label, both[reading]) for label, both in found], count)}."
        for start, reading in (
            (f"For a machine that reads raw values, over {what}", RAW),
            ("Without brightness", RAW_WITHOUT),
        )
    ]


def _sentence(found: Sequence[_Labeled], count: int) -> str:
    if count == 1:
        return _compared(found, lambda one: one.median)
    median = _compared(found, lambda one: one.median)
    worst = _compared(found, lambda one: one.worst)
    return f"in the median pair {median}; in the worst pair {worst}"


def _compared(found: Sequence[_Labeled], pair: _PairOf) -> str:
    """The best sensor for this pair and the second best."""
    ranked = sorted(found, key=lambda one: -pair(one[1]).distance)
    (best, of_best), *others = [(label, pair(one)) for label, one in ranked]
    if not others:
        return f"{best} has the distance {_text(of_best)}"
    if of_best.near_chance:
        return f"every sensor has at most the distance {_text(of_best)}"
    second, of_second = others[0]
    tied = of_best.distance - of_second.distance <= _TIE * of_best.distance
    lead = f"{best} and {second} are equal" if tied else f"{best} is better"
    against = "" if tied else f" for {second}"
    return f"{lead}, distance {_text(of_best)} against {_text(of_second)}{against}"


def _text(pair: PairOutcome) -> str:
    """A distance with the pair, the probability of a right answer, and whether it is chance."""
    size = f"{pair.distance:#.3g}" if pair.distance < 100 else f"{pair.distance:.0f}"
    percent = 100 * pair.probability
    right = f"{percent:.0f} % right" if percent < 99.5 else "over 99 % right"
    parts = [" / ".join(pair.names)] if pair.names else []
    parts += [right] + (["nearly chance"] if pair.near_chance else [])
    return f"{size} ({', '.join(parts)})"
