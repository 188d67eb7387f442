"""How well a machine that reads raw values tells patches apart: sentences and tables."""

import math
from collections.abc import Callable, Mapping, Sequence

from chromanoise.io import Column, Table
from chromanoise.spectra import chart_on, chart_title
from chromanoise.study import (
    BRIGHT,
    DARK,
    RAW,
    RAW_WITHOUT,
    READINGS,
    TARGET,
    TOLERANCE,
    Analysis,
    MachineReading,
    PairOutcome,
    RawOutcome,
    pairs_of,
    raw_outcomes,
)

_TIE = 0.005  # relative difference that is no lead

_Labeled = tuple[str, RawOutcome]
LabeledOutcomes = tuple[str, Mapping[str, RawOutcome]]
_PairOf = Callable[[RawOutcome], PairOutcome]


def machine_sentences(
    analyses: Sequence[Analysis], found: Sequence[LabeledOutcomes] | None = None
) -> list[str]:
    """Distances of the pairs of patches in raw values: median and worst, with their probability.

    One sentence with brightness, one without. Sensors with a saturated patch are omitted. A
    decision that is nearly chance is marked as such.

    Parameters
    ----------
    analyses
        Analyses under one light.
    found
        What `labeled_outcomes` gives of them; ``None`` to compute it.
    """
    found = labeled_outcomes(analyses) if found is None else found
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


def labeled_outcomes(analyses: Sequence[Analysis]) -> list[LabeledOutcomes]:
    """Label and raw outcomes of each analysis without a saturated patch."""
    if len(chart_on(analyses[0].sensor.grid, analyses[0].chart).names) < 2:
        return []
    outcomes = [(one.sensor.label, raw_outcomes(one)) for one in analyses]
    return [(label, both) for label, both in outcomes if both is not None]


def best_for_a_machine(found: Sequence[LabeledOutcomes]) -> tuple[str | None, float | None]:
    """The sensor of the largest median distance, ``None`` for a tie, and its lead. [dB]"""
    if len(found) < 2:
        return None, None
    ranked = sorted(((label, both[RAW].median) for label, both in found), key=_distance_of)
    (best, first), (_, second) = ranked[:2]
    lead_db = 20 * math.log10(first.distance / second.distance) if second.distance > 0 else None
    tied = first.near_chance or first.distance - second.distance <= _TIE * first.distance
    return None if tied else best, lead_db


def _distance_of(one: tuple[str, PairOutcome]) -> float:
    return -one[1].distance


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
        return f"{best} has a distance of {_text(of_best)}"
    if of_best.near_chance:
        return f"no sensor exceeds a distance of {_text(of_best)}"
    second, of_second = others[0]
    tied = of_best.distance - of_second.distance <= _TIE * of_best.distance
    among_many = len(others) > 1
    lead = f"{best} is {'best' if among_many else 'better'}"
    if tied:
        lead = f"{best} and {second} are {'best and equal' if among_many else 'equal'}"
    against = "" if tied else f" for {second}"
    return f"{lead}, distance {_text(of_best)} against {_text(of_second)}{against}"


def _text(pair: PairOutcome) -> str:
    """A distance with the pair, the share classified correctly, and whether it is chance."""
    size = f"{pair.distance:#.3g}" if pair.distance < 100 else f"{pair.distance:.0f}"
    percent = 100 * pair.probability
    share = f"{percent:.0f} %" if percent < 99.5 else "over 99 %"
    parts = [" / ".join(pair.names)] if pair.names else []
    parts += [f"{share} classified correctly"] + (["nearly chance"] if pair.near_chance else [])
    return f"{size} ({', '.join(parts)})"


_ABOUT = {"spectrum": "spectrum", "visible": "visible light"}
_HEADS = ("raw", "color", "raw, no brightness", "color, no brightness")


def machine_tables(readings: Sequence[MachineReading]) -> list[Table]:
    """Tables of distances, contrast detection and information."""
    return [_separations(readings), _contrasts(readings), _information(readings)]


def _table(
    title: str,
    texts: Sequence[str],
    numbers: Sequence[str],
    rows: Sequence[Sequence[str]],
    note: str,
) -> Table:
    """A table of texts: first the columns of ``texts``, then those of ``numbers``."""
    return Table(
        title=title,
        columns=(
            *(Column(name=name) for name in texts),
            *(Column(name=name, digits=".3g") for name in numbers),
        ),
        rows=tuple(map(tuple, rows)),
        notes=(note,),
    )


def _separations(readings: Sequence[MachineReading]) -> Table:
    rows: list[list[str]] = []
    for reading in readings:
        found = reading.separation
        if found is None:
            rows.append([reading.label, "a patch is saturated", *("" for _ in READINGS)])
            continue
        medians = [(found.median_distance(n), found.median_probability(n)) for n in READINGS]
        count = len(found.pairs.indices)
        rows.append([reading.label, f"median of {count}", *map(_distance, medians)])
        at, names = found.worst, found.pairs.names[found.worst]
        worst = [(found.distance[n][at], found.probability[n][at]) for n in READINGS]
        rows.append(["", f"worst: {names[0]} / {names[1]}", *map(_distance, worst)])
    return _table(
        "Distance of patches for a machine (probability)",
        ("sensor", "pairs"),
        _HEADS,
        rows,
        "Distance of two patches in units of their noise (Mahalanobis), for an ideal "
        "reader of one pixel; in parentheses the probability that it classifies a reading of the "
        "two correctly (0.5 is chance). Medians of distances and of probabilities are taken "
        "separately.",
    )


def _contrasts(readings: Sequence[MachineReading]) -> Table:
    rows = []
    for reading in readings:
        found = reading.contrast
        if found is None:
            rows.append([reading.label, "saturated", "", ""])
            continue
        channels = ", ".join(f"{name} {p:.3f}" for name, p in found.channels.items())
        luminance = "" if math.isnan(found.luminance) else f"{found.luminance:.3f}"
        level = "none" if math.isnan(found.level_lux) else f"{found.level_lux:.3g}"
        rows.append([reading.label, channels, luminance, level])
    return _table(
        "Contrast detection probability for a machine (CDP)",
        ("sensor", "raw channels"),
        ("Y", f"least lux for CDP {TARGET:g}"),
        rows,
        f"Grays of {100 * BRIGHT:g} and {100 * DARK:g} % on one pixel each: the share of "
        f"readings whose Weber contrast is within {100 * TOLERANCE:g} % of the true one (idea of "
        "IEEE P2020). Y has none where a channel has fewer than 200 electrons. The last column is "
        "for the best raw channel, with the time kept.",
    )


def _information(readings: Sequence[MachineReading]) -> Table:
    every = [name for reading in readings for one in reading.information for name in one.bits]
    steps = list(dict.fromkeys(every))
    rows = []
    for reading in readings:
        if not reading.information:
            rows.append([reading.label, "saturated", *("" for _ in steps)])
        for one in reading.information:
            bits = [f"{float(one.bits[n]):.2f}" if n in one.bits else "" for n in steps]
            rows.append([reading.label, _ABOUT[one.about], *bits])
    source = next((one.prior for reading in readings for one in reading.information), "none")
    return _table(
        "Information for a machine [bit per pixel]",
        ("sensor", "about"),
        steps,
        rows,
        f"Least information about reflectances ({source}) that is left after each step, "
        "for a linear reader of one pixel of each channel.",
    )


def _distance(value: tuple[float, float]) -> str:
    distance, probability = value
    digits = "#.3g" if distance < 100 else ".0f"
    return f"{distance:{digits}} ({probability:.3f})"
