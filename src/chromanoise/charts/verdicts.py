"""Verdicts in sentences and tables that compare sensors, for color and for machine readings.

The head of a page has the verdict, the light, and the settings and electrons of each sensor. The
table of sensors has rank, SNR, color error and time. A machine reads raw values without a color
matrix.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any

from chromanoise.base import check
from chromanoise.charts.budget_chart import cause_label
from chromanoise.charts.charted_study import Look, Shown, saturated_names, saturation_sentence
from chromanoise.charts.description import numbers_of
from chromanoise.charts.numbers import NONE, brief, decimal, electrons, listed, signed, table
from chromanoise.metrics import CORRELATION, FILTERS, INFRARED, REST, WEIGHTS, Budget
from chromanoise.noise import DEFAULT_RULE, conditions, level_in_words
from chromanoise.sensor import PIXEL, PIXEL_REQUIRED, SOURCES, Sensor
from chromanoise.spectra import Spectra, chart_on, chart_title
from chromanoise.study import (
    BRIGHT,
    DARK,
    DEFAULT_PRIOR,
    HARDLY_SEEN_DELTA_E,
    LEAST_TIE_DB,
    RAW,
    RAW_WITHOUT,
    READINGS,
    TARGET,
    TOLERANCE,
    VISUAL_NOISE,
    Analysis,
    EqualColor,
    MachineReading,
    PairOutcome,
    RawOutcome,
    Reader,
    Standing,
    Told,
    TradeOff,
    Verdict,
    assumptions,
    color_snr_db,
    coordinate_budget,
    diagnosis,
    equal_color,
    is_assumed,
    lost_colors,
    mean_color_error,
    pairs_of,
    raw_outcomes,
    visual_noise_of,
)

_TIE = 0.005  # relative difference that is no lead

_Labeled = tuple[str, RawOutcome]
_Read = tuple[str, Mapping[str, RawOutcome]]
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
    return _machine_sentences(analyses, _read(analyses))


def _read(analyses: Sequence[Analysis]) -> list[_Read]:
    """Of the analyses that a machine can read: label and outcomes."""
    if len(chart_on(analyses[0].sensor.grid, analyses[0].chart).names) < 2:
        return []
    outcomes = [(one.sensor.label, raw_outcomes(one)) for one in analyses]
    return [(label, both) for label, both in outcomes if both is not None]


def _machine_sentences(analyses: Sequence[Analysis], found: Sequence[_Read]) -> list[str]:
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


def _first_for_a_machine(found: Sequence[_Read]) -> tuple[str | None, float | None]:
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


_ABOUT = {"spectrum": "spectrum", "visible": "visible light"}
_HEADS = ("raw", "color", "raw, no brightness", "color, no brightness")


def machine_tables(readings: Sequence[MachineReading]) -> list[dict[str, Any]]:
    """Tables of distances, contrast detection and information, with ``title`` and ``note``."""
    return [_separations(readings), _contrasts(readings), _information(readings)]


def _separations(readings: Sequence[MachineReading]) -> dict[str, Any]:
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
    return {
        "title": "Distance of patches for a machine (probability)",
        "head": ["sensor", "pairs", *_HEADS],
        "rows": rows,
        "note": "Distance of two patches in units of their noise (Mahalanobis), for an ideal "
        "reader of one pixel; in parentheses the probability that it names the right one of the "
        "two (0.5 is chance). Medians of distances and of probabilities are taken separately.",
    }


def _contrasts(readings: Sequence[MachineReading]) -> dict[str, Any]:
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
    return {
        "title": "Contrast detection probability for a machine (CDP)",
        "head": ["sensor", "raw channels", "Y", f"least lux for CDP {TARGET:g}"],
        "rows": rows,
        "note": f"Grays of {100 * BRIGHT:g} and {100 * DARK:g} % on one pixel each: the share of "
        f"readings whose Weber contrast is within {100 * TOLERANCE:g} % of the true one (idea of "
        "IEEE P2020). Y has none where a channel has fewer than 200 electrons. The last column is "
        "for the best raw channel, with the time kept.",
    }


def _information(readings: Sequence[MachineReading]) -> dict[str, Any]:
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
    return {
        "title": "Information for a machine [bit per pixel]",
        "head": ["sensor", "about", *steps],
        "rows": rows,
        "note": f"Least information about reflectances ({source}) that is left after each step, "
        "for a linear reader of one pixel of each channel.",
    }


def _distance(value: tuple[float, float]) -> str:
    distance, probability = value
    digits = "#.3g" if distance < 100 else ".0f"
    return f"{distance:{digits}} ({probability:.3f})"


@dataclass(frozen=True, slots=True)
class _Column:
    """A column: ``better`` is ``higher`` or ``lower``, ``None`` where neither is."""

    key: str
    head: str
    what: str
    better: str | None
    value: Callable[[Analysis], float | None]
    text: Callable[[float], str] = decimal


def ranking(analyses: Sequence[Analysis]) -> dict[str, Any]:
    """Columns and rows of the table, in the order of the sensors, with their notes.

    A rank is that of the SNR of Y as it is shown, so equal numbers share a rank. A sensor that is
    saturated or has no luminance has no rank and no SNR.

    Parameters
    ----------
    analyses
        Analyses under one light.
    """
    columns = _columns(analyses)
    return {
        "columns": [
            {"key": one.key, "head": one.head, "what": one.what, "better": one.better}
            for one in columns
        ],
        "rows": [_row(analysis, columns) for analysis in analyses],
        "notes": _notes(analyses),
    }


def _columns(analyses: Sequence[Analysis]) -> list[_Column]:
    able = [one for one in analyses if _luminance_db(one) is not None]
    shown = sorted((round(_luminance_db(one) or 0.0, 1) for one in able), reverse=True)

    def rank(analysis: Analysis) -> float | None:
        luminance_db = _luminance_db(analysis)
        return None if luminance_db is None else 1.0 + shown.index(round(luminance_db, 1))

    def raw_db(analysis: Analysis) -> float | None:
        found = math.inf if _luminance_db(analysis) is None else _raw_db(analysis)
        return found if math.isfinite(found) else None

    raw = f"raw SNR: {RAW_SNR}"
    loss, error = "best linear SNR minus the SNR of Y", "mean CIE 1976 difference"
    return [
        _Column("rank", "rank by SNR of Y", "rank by the SNR of Y", "lower", rank, brief),
        _Column("raw_db", "raw SNR [dB]", raw, "higher", raw_db),
        _Column("luminance_db", "SNR of Y [dB]", "SNR of luminance", "higher", _luminance_db),
        _Column("loss_db", "color SNR loss [dB]", loss, "lower", _loss_db),
        _Column(
            "color_error", "color error [ΔE]", f"{error}, without noise", "lower", mean_color_error
        ),
        _Column("visual_noise", "visual noise", VISUAL_NOISE, "lower", visual_noise_of, _number),
        _Column("time_ms", "time [ms]", "exposure time", None, _time_ms, _four_digits),
        _Column("f_number", "f-number", "f-number", None, lambda one: one.exposure.f_number, brief),
        *map(_channel, dict.fromkeys(name for one in analyses for name in one.sensor.names)),
    ]


def _channel(name: str) -> _Column:
    def mean_e(analysis: Analysis) -> float | None:
        names = analysis.sensor.names
        return float(analysis.raw.mean[names.index(name)]) if name in names else None

    what = f"mean electrons of channel {name}, perfect white"
    return _Column(f"mean_e.{name}", f"{name} [e⁻]", what, None, mean_e, electrons)


def _row(analysis: Analysis, columns: Sequence[_Column]) -> dict[str, Any]:
    values = [one.value(analysis) for one in columns]
    texts = [
        NONE if value is None else one.text(value)
        for one, value in zip(columns, values, strict=True)
    ]
    return {
        "name": analysis.sensor.label,
        "values": values,
        "text": texts,
        "saturated": saturated_names(analysis),
        "assumed": _assumed(analysis.sensor),
    }


def _assumed(sensor: Sensor) -> str:
    """Which values of the pixel are assumed, in words and numbers; empty if none is."""
    names = [name for name in PIXEL_REQUIRED if is_assumed(sensor, name)]
    if not names:
        return ""
    values = [f"{getattr(sensor.pixel, one):,g} {_UNITS[PIXEL[one].unit]}" for one in names]
    verb = "is" if len(names) == 1 else "are"
    return f"{listed([PIXEL[one].label for one in names])} {verb} assumed: {', '.join(values)}"


_UNITS = {"um": "µm", "e-": "e⁻"}


def _notes(analyses: Sequence[Analysis]) -> list[str]:
    """The remarks on the sensors, each once, with the sensors that it applies to.

    What is assumed is in their rows.
    """
    named: dict[str, list[str]] = {}
    for analysis in analyses:
        beside = assumptions(analysis.sensor)
        for note in diagnosis(analysis):
            if note in beside:
                continue
            named.setdefault(note, []).append(analysis.sensor.label)
    return [f"{', '.join(names)}: {note}" for note, names in named.items()]


def _luminance_db(analysis: Analysis) -> float | None:
    return color_snr_db(analysis)["Y"]


def _loss_db(analysis: Analysis) -> float | None:
    return None if _luminance_db(analysis) is None else analysis.color_snr_loss_db


def _time_ms(analysis: Analysis) -> float:
    return 1e3 * analysis.exposure.time_s


def _four_digits(value: float) -> str:
    return brief(value, 4)


RAW_SNR = "best linear readout of all channels"
"""What the raw SNR of a sensor is; it depends on no other sensor."""


def _raw_db(analysis: Analysis) -> float:
    """Raw SNR of a sensor without saturated channels; infinite for a signal without noise. [dB]"""
    best = analysis.optimal_linear_snr_db
    return math.inf if best is None else best


_MOST_NAMED = 4  # sensors that a sentence names; of the others it says how many they are
_UNSEEN_DELTA_E = 0.05  # a difference of color errors that one decimal does not show [Delta E*ab]
_WORTH_DB = 0.3  # least loss of a cause that is reported
_GLOSSES = {  # of bars of the budget whose label is a word of its own
    WEIGHTS: "weights that make Y of the channels",
    CORRELATION: "unmixing channels that look alike",
    INFRARED: "its noise, without signal",
    FILTERS: "light that they absorb",
    **{one.cause: one.words for one in SOURCES if one.words},
}
_PHOTONS = "photons"
_BELOW_THE_BOUND = (WEIGHTS, CORRELATION, INFRARED)  # the bound is that of the noisy channels
_TERMS: Mapping[str, str] = {
    "exposure": "",
    "saturation": " with the same share of full well on each sensor,",
    "light": " with the same number of photons on each sensor,",
}


@lru_cache(maxsize=16)  # table, JSON and page ask for the same one
def _verdict(
    analyses: tuple[Analysis, ...], equal: str, reader: Reader, prior: str | Spectra
) -> Verdict:
    check.one_of("terms of a comparison", equal, tuple(_TERMS))
    found = equal_color([one.point for one in analyses], prior=prior)
    read = _read(analyses)
    winner, margin_db = found.winner, found.margin_db
    if reader == "machine":
        best, margin_db = _first_for_a_machine(read)
        names = {one.sensor.label: one.sensor.name for one in analyses}
        winner = None if best is None else names[best]
    return Verdict(
        winner=winner,
        margin_db=margin_db,
        at_color_error=None if reader == "machine" else found.at_color_error,
        reader=reader,
        told=tuple(_told(analyses, found, read, equal, reader, prior)),
        prior=prior if isinstance(prior, str) else prior.source,
        at_equal_color=found,
    )


def verdict_of(
    analyses: Sequence[Analysis],
    *,
    equal: str = DEFAULT_RULE,
    reader: Reader = "eye",
    prior: str | Spectra = DEFAULT_PRIOR,
) -> Verdict:
    """The verdict on the sensors of several analyses.

    Parameters
    ----------
    analyses, equal, reader, prior
        As `verdict_sentences`.

    Raises
    ------
    InputError
        As `verdict_sentences`.
    """
    return _verdict(tuple(analyses), equal, reader, prior)


def verdict_sentences(
    analyses: Sequence[Analysis],
    *,
    equal: str = DEFAULT_RULE,
    reader: Reader = "eye",
    prior: str | Spectra = DEFAULT_PRIOR,
) -> list[str]:
    """Sentences that compare the sensors of several analyses.

    For an eye, they compare the visual noise at equal color error, then raw SNR and luminance SNR
    with the matrix of the analyses, name the causes of the difference, and give the color errors;
    for a machine, they compare the distances of patches in raw values. Sensors that are saturated
    or have no luminance get a sentence of their own.

    Parameters
    ----------
    analyses
        Analyses under one light.
    equal
        Terms of the comparison, from `chromanoise.noise.EQUAL_TERMS`; named in the text unless
        all sensors have the same exposure time.
    reader
        Whose sentence comes first.
    prior
        The training set of the comparison at equal color error.

    Raises
    ------
    InputError
        If ``equal`` is unknown.
    """
    return list(verdict_of(analyses, equal=equal, reader=reader, prior=prior).sentences)


def _told(
    analyses: Sequence[Analysis],
    found: EqualColor,
    read: Sequence[_Read],
    equal: str,
    reader: Reader,
    prior: str | Spectra,
) -> list[Told]:
    excluded = [Told("excluded", text) for a in analyses if (text := _excluded(a))]
    rest = [a for a in analyses if _excluded(a) is None]
    able = [a for a in rest if color_snr_db(a)["Y"] is not None]
    lost = {one.sensor for one in found.standings if one.is_lost}
    noisy = [_too_noisy(a, prior) for a in able if a.sensor.label not in lost]
    machine = [Told("machine", text) for text in _machine_sentences(analyses, read)]
    eye = _at_equal_color(found, {a.sensor.label for a in rest}) if len(rest) > 1 else []
    after = [
        *([Told("alone", _alone(able[0]))] if len(able) == 1 else []),
        *(_with_the_matrix(able, found) if len(able) > 1 else []),
        *(_without_luminance(a) for a in rest if a not in able),
    ]
    noise = [Told("lost", text) for text in noisy if text]
    if reader == "machine" and machine:
        opening, *others = machine
        if eye:
            eye[0] = Told(eye[0].about, f"For an eye, {_lower(eye[0])}")
        told = [opening, *excluded, *others, *eye, *after, *noise]
    elif eye:
        told = [eye[0], *excluded, *eye[1:], *after, *machine, *noise]
    else:
        told = [*excluded, *after, *noise, *machine]
    first = f"{_setting(analyses, equal)} {_lower(told[0])}"
    return [Told(told[0].about, first), *told[1:]]


def _lower(told: Told) -> str:
    """The text inside of a sentence: those that begin with a name keep it."""
    names = ("winner", "excluded", "alone")
    return told.text if told.about in names else told.text[0].lower() + told.text[1:]


def _with_the_matrix(able: Sequence[Analysis], found: EqualColor) -> list[Told]:
    """What the matrix of the analyses gives."""
    compared = {one.sensor for one in found.standings}
    rivals = [a for a in able if a.sensor.label in compared]
    rivals = rivals if len(rivals) > 1 else list(able)
    best_raw = max(rivals, key=_raw_db)
    best_color = max(rivals, key=_known_luminance_db)
    if abs(_known_luminance_db(best_raw) - _known_luminance_db(best_color)) < LEAST_TIE_DB:
        best_color = best_raw  # equal: the leader in raw is named once
    others = [a for a in rivals if a is not best_color]
    rival = best_raw if best_raw is not best_color else max(others, key=_known_luminance_db)
    return [
        Told("matrix", _contest(best_color, rival, best_raw)),
        *(Told("matrix order", text) for text in _another_order(found, rivals)),
        *(Told("matrix why", text) for text in _reasons(best_color, rival)),
        *(Told("matrix colors", text) for text in _colors(able, found)),
    ]


def _at_equal_color(found: EqualColor, able: Collection[str]) -> list[Told]:
    """The winner at equal color error, the reason, whether color is lost, where the order turns."""
    left_out = [
        Told("excluded", f"{one.sensor} is not compared at equal color error: {one.why}.")
        for one in found.left_out
        if one.sensor in able
    ]
    if not found.standings:
        return [Told("lost", "No two sensors can be compared at equal color error."), *left_out]
    best, *others = found.standings
    tied = [one for one in others if one.behind_db <= (found.tie_db or 0.0)]
    behind = [one for one in others if one not in tied]
    lost = [Told("lost", text) for text in _lost(found)]
    first = Told("winner", _first(found, tied, behind))
    why = [Told("why", text) for text in _whys(best, behind)]
    turns = [Told("turns", text) for text in _turns(found)]
    total = [Told("total", _totals(found))]
    if all(one.is_lost for one in found.standings):
        return [*lost, first, *why, *left_out, *turns]
    return [first, *why, *total, *lost, *left_out, *turns]


def _first(found: EqualColor, tied: Sequence[Standing], behind: Sequence[Standing]) -> str:
    best = found.standings[0]
    at = f"at equal color error ({found.at_color_error:.1f} ΔE*ab, noise-aware matrices)"
    if not tied:
        less = [
            f"{one.behind_db:.1f} dB less than {one.sensor} ({_number(best.visual_noise)} against "
            f"{_number(one.visual_noise)})"
            for one in behind
        ]
        last = f"up to {behind[-1].behind_db:.1f} dB less than"
        less = _shortened(less, last)
        return f"{best.sensor} has the least visual noise {at}: {listed(less)}."
    names = listed([one.sensor for one in (best, *tied)])
    apart = f"they differ by less than {LEAST_TIE_DB:g} dB"
    if max(found.tie_db or 0.0, tied[-1].behind_db) > LEAST_TIE_DB:
        apart = (
            f"they differ by {tied[-1].behind_db:.1f} dB, and another training set, color error or "
            f"measure of noise shifts this by {found.tie_db:.1f} dB"
        )
    more = listed([f"{one.sensor} has {one.behind_db:.1f} dB more" for one in behind])
    return f"{names} tie in visual noise {at}: {apart}{'; ' if more else ''}{more}."


def _shortened(every: list[str], last: str) -> list[str]:
    """The first few of a list, and of the others how many they are."""
    more = len(every) - _MOST_NAMED
    return every if more < 2 else [*every[:_MOST_NAMED], f"{last} {more} others"]


def _whys(best: Standing, behind: Sequence[Standing]) -> list[str]:
    """Noise of the gray in the raw channels, and what each matrix loses: their sum is told."""
    parts = []
    for one in behind[:_MOST_NAMED]:
        raw_db, lost_db = one.gray_snr_db - best.gray_snr_db, one.lost_in_matrix_db
        raw = "the same raw SNR" if abs(raw_db) < LEAST_TIE_DB else f"{_more(raw_db)} raw SNR"
        lost = "as much" if abs(lost_db) < LEAST_TIE_DB else _more(lost_db)
        link = "but" if raw_db >= LEAST_TIE_DB else "and"
        parts.append(f"{one.sensor} has {raw} {link} loses {lost} in its color matrix")
    return [f"Why: on an 18 % gray, against {best.sensor}, {'; '.join(parts)}."] if parts else []


def _more(db: float) -> str:
    return f"{abs(db):.1f} dB {'more' if db > 0 else 'less'}"


def _totals(found: EqualColor) -> str:
    """The order by color error and noise together."""
    best, *others = sorted(found.standings, key=lambda one: one.least_total_error)
    near = best.least_total_error + HARDLY_SEEN_DELTA_E
    close = [best, *(one for one in others if one.least_total_error < near)]
    leads = f"{listed([one.sensor for one in close])} are about equal"
    if len(close) == 1:
        too = ", too" if best is found.standings[0] and not found.is_tie else ""
        leads = f"{best.sensor} leads{too}"
    own = listed([_number(one.least_total_error) for one in close])
    behind = [
        f"{_number(one.least_total_error)} for {one.sensor}" for one in others if one not in close
    ]
    last = f"up to {_number(others[-1].least_total_error)} for" if others else ""
    against = f", against {listed(_shortened(behind, last))}" if behind else ""
    return (
        "With the matrices of least total color error as viewed (color and noise together), "
        f"{leads}: {own} ΔE*ab{against}."
    )


def _lost(found: EqualColor) -> list[str]:
    """Whose color is lost in the noise."""
    lost = [one for one in found.standings if one.is_lost]
    if not lost:
        return []
    every = len(lost) == len(found.standings)
    who = "each sensor" if every else listed([one.sensor for one in lost])
    one_has = "its least total color error as viewed is"
    have = one_has if len(lost) == 1 else "their least total color errors as viewed are"
    totals = listed([_number(one.least_total_error) for one in lost])
    return [
        f"Color is lost in the noise of {who}: {have} {totals} ΔE*ab; a gray picture without noise "
        f"has {_number(found.colorless_error)} ΔE*ab."
    ]


def _turns(found: EqualColor) -> list[str]:
    """Where another sensor has less noise, or that none has clearly less anywhere."""
    (low_lux, high_lux), (least, most) = found.levels_lux, found.errors or (0.0, 0.0)
    first = found.standings[0].sensor
    if not found.turns:
        if found.is_tie:
            return []
        light = f"at light levels from {_lux(low_lux)} to {_lux(high_lux)}, or "
        return [
            f"No other sensor leads clearly {light if high_lux > low_lux else ''}at color errors "
            f"up to {most:.1f} ΔE*ab."
        ]
    sentences = []
    for one in found.turns:
        of_light = one.over == "light [lx]"
        lowest, highest = (low_lux, high_lux) if of_light else (least, most)
        start, end = (_lux(at) if of_light else f"{at:.1f}" for at in (one.first, one.last))
        if one.first <= lowest:
            where = f"below {end}"
        elif one.last >= highest:
            where = f"above {start}"
        else:
            where = f"from {start} to {end}"
        where = where if of_light else f"at color errors {where} ΔE*ab"
        sentences.append(f"{one.sensor} has less visual noise than {first} {where}.")
    return sentences


def _lux(level_lux: float) -> str:
    return level_in_words(level_lux, 2)


def _another_order(found: EqualColor, able: Sequence[Analysis]) -> list[str]:
    """That this matrix gives another order of visual noise, and why; empty where it does not."""
    noises = {one.sensor.label: visual_noise_of(one) for one in able}
    known = {name: noise for name, noise in noises.items() if noise is not None}
    if len(known) < 2 or len(known) < len(found.standings):
        return []
    least = min(known, key=lambda name: known[name])
    first = found.standings[0].sensor if found.standings else least
    if least == first or 20 * math.log10(known[first] / known[least]) < LEAST_TIE_DB:
        return []
    own, other = (
        mean_color_error(one) for name in (least, first) for one in able if one.sensor.label == name
    )
    why = ""
    if own is not None and other is not None and own > other:
        why = f", because its color error is larger ({own:.1f} against {other:.1f} ΔE*ab)"
    return [
        f"With this matrix {least} has less visual noise than {first} ({_number(known[least])} "
        f"against {_number(known[first])}){why}."
    ]


def _number(value: float) -> str:
    """Three digits, also where the last is 0."""
    return f"{value:#.3g}".removesuffix(".") if 1e-3 <= value < 1000 else brief(value, 3)


def _excluded(analysis: Analysis) -> str | None:
    """Why a sensor is in no comparison for an eye; ``None`` where it is."""
    full = saturation_sentence(analysis)
    if full is not None:
        return f"{full}."
    if analysis.one_code.any():
        return (
            f"{analysis.sensor.label}: practically every reading of a channel is the same code of "
            "the converter, so the sensor has no color to compare; take more bits or a higher gain."
        )
    return None


def _without_luminance(analysis: Analysis) -> Told:
    return Told(
        "matrix",
        f"With the matrix {analysis.matrix.made_by}, {analysis.sensor.label} gives no valid Y "
        "under this light, so it has no SNR of Y.",
    )


def matrices_in_words(analyses: Sequence[Analysis]) -> str:
    """What the color matrices of the analyses are."""
    return listed(list(dict.fromkeys(one.matrix.made_by for one in analyses)))


def _alone(analysis: Analysis) -> str:
    return (
        f"{analysis.sensor.label} has {_known_luminance_db(analysis):.1f} dB of "
        f"luminance SNR for an eye, {decimal(_known_loss_db(analysis))} dB below the best linear "
        f"readout{_largest(analysis)}; {_error(analysis)}."
    )


def _contest(winner: Analysis, rival: Analysis, best_raw: Analysis) -> str:
    """SNR of Y of both with the matrix of the analyses, and their raw SNR."""
    first, second = (winner, rival) if best_raw is winner else (rival, winner)
    raw_db = _raw_db(first) - _raw_db(second)
    luminances_db = [_known_luminance_db(one) for one in (first, second)]
    gap_db = luminances_db[0] - luminances_db[1]
    luminance = "the same SNR of Y as"
    if abs(gap_db) >= LEAST_TIE_DB:
        luminance = f"{_more(gap_db)} SNR of Y than"
    raw = "the same raw SNR" if raw_db < LEAST_TIE_DB else f"{_more(raw_db)} raw SNR"
    link = "but" if raw_db >= LEAST_TIE_DB > gap_db else "and"
    patch = "a perfect white" if first.point.patch is None else first.point.patch_name
    return (
        f"With the matrix {first.matrix.made_by}, {first.sensor.label} has {luminance} "
        f"{second.sensor.label} on {patch} ({luminances_db[0]:.1f} against "
        f"{luminances_db[1]:.1f} dB), {link} {raw} ({RAW_SNR})."
    )


def _reasons(winner: Analysis, loser: Analysis) -> list[str]:
    """Causes that cost the loser more than the winner: two, or as many as explain the gap."""
    gap = _known_luminance_db(winner) - _known_luminance_db(loser)
    good, bad = (_costs(coordinate_budget(a, "Y")) for a in (winner, loser))
    if gap < LEAST_TIE_DB or not (good and bad):
        return []
    beyond = {cause: loss - good.get(cause, 0.0) for cause, loss in bad.items()}
    beyond[INFRARED] = beyond.get(INFRARED, 0.0) + beyond.pop(REST)  # infrared costs and leaks
    parts: list[str] = []
    explained = 0.0
    for cause in sorted(beyond, key=lambda one: -beyond[one]):
        if beyond[cause] < _WORTH_DB or (len(parts) > 1 and explained > gap - _WORTH_DB):
            break
        explained += beyond[cause]
        other = good.get(cause, 0.0)  # crosstalk may be a cause for one sensor only
        other += good.get(REST, 0.0) if cause == INFRARED else 0.0
        parts.append(_reason(cause, beyond[cause] + other, other, winner.sensor.label))
    if not parts:
        return []
    who = f"{loser.sensor.label} has less SNR of Y than {winner.sensor.label}"
    return [f"Why {who}: {'; '.join(parts)}."]


def _reason(cause: str, loss_db: float, winner_db: float, winner: str) -> str:
    """A bar of the budget with its label and number, and the same bar of the winner."""
    if cause == _PHOTONS:
        levels = f"{decimal(-loss_db)} dB, against {decimal(-winner_db)} dB for {winner}"
        return f"all photons: {levels}, as fewer reach the pixels"
    label = _label(cause) if cause != INFRARED else "infrared (its noise, and its signal in Y)"
    if min(loss_db, winner_db) < -LEAST_TIE_DB:  # a gain is not called a cost
        return f"{label}: {signed(-loss_db)} dB, against {signed(-winner_db)} dB for {winner}"
    return f"{label} costs {decimal(loss_db)} dB, against {decimal(winner_db)} dB for {winner}"


def _label(cause: str) -> str:
    gloss = _GLOSSES.get(cause)
    return cause_label(cause, "Y") + (f" ({gloss})" if gloss else "")


def _colors(able: Sequence[Analysis], found: EqualColor) -> list[str]:
    """Color error and visual noise of the matrix of the analyses."""
    place = {one.sensor: k for k, one in enumerate(found.standings)}
    able = sorted(able, key=lambda one: (place.get(one.sensor.label, len(place)), one.sensor.label))
    trades = {one.point.sensor.label: one for one in found.trade_offs}
    errors, noises, below = [], [], []
    for a in able:
        label, error = a.sensor.label, mean_color_error(a)
        trade = trades.get(label)
        above_db = _above_the_least_db(a, trade)
        more = f" ({above_db:.1f} dB above a noise-aware matrix of this color error)"
        errors.append(f"{label} {_delta_e(error)}")
        noises.append(f"{label} {_in_noise(a)}{more if above_db >= LEAST_TIE_DB else ''}")
        if trade and error is not None and error < trade.least_color_error - _UNSEEN_DELTA_E:
            below.append(f"{label} ({error:.1f} against {trade.least_color_error:.1f})")
    matrix = f"the matrix {able[0].matrix.made_by}"
    over = f"mean ΔE*ab over {_patches(able[0])}"
    told = [
        f"With {matrix}, color error ({over}): {', '.join(errors)}; visual noise: "
        f"{', '.join(noises)}."
    ]
    if below:
        told.append(
            f"With {matrix}, the color error is less than with every noise-aware matrix, which "
            f"keeps the white: {listed(below)}."
        )
    return told


def _above_the_least_db(analysis: Analysis, trade: TradeOff | None) -> float:
    """Visual noise over that of the noise-aware matrix with the same color error. [dB]"""
    error, noise = mean_color_error(analysis), visual_noise_of(analysis)
    place = None if trade is None or error is None else trade.place(error)
    if trade is None or place is None or noise is None:
        return 0.0
    return 20 * math.log10(noise / trade.noise_at(place))


def _costs(budget: Budget | None) -> dict[str, float]:
    """Loss of each cause, with the loss from missing photons: the sum is minus the SNR."""
    if budget is None:
        return {}
    return {_PHOTONS: -budget.photons_db} | {cost.cause: cost.cost_db for cost in budget.costs}


def _largest(analysis: Analysis) -> str:
    """The largest loss relative to the best linear SNR, which already contains read noise."""
    costs, whole_db = _costs(coordinate_budget(analysis, "Y")), _known_loss_db(analysis)
    found = [(costs[cause], cause) for cause in _BELOW_THE_BOUND if cause in costs]
    if not found or min(whole_db, max(found)[0]) < _WORTH_DB:
        return ""
    loss_db, cause = max(found)
    how = "mostly" if whole_db / 2 < loss_db <= whole_db + LEAST_TIE_DB else "above all"
    return f", {how} because of {_label(cause)}: {decimal(loss_db)} dB"


def _setting(analyses: Sequence[Analysis], equal: str) -> str:
    return f"At {conditions([one.point for one in analyses])},{_TERMS[equal]}"


def _known_luminance_db(analysis: Analysis) -> float:
    found = color_snr_db(analysis)["Y"]
    assert found is not None  # called only for analyses with a value
    return found


def _known_loss_db(analysis: Analysis) -> float:
    loss_db = analysis.color_snr_loss_db
    assert loss_db is not None  # called only for analyses with a value
    return loss_db


def _error(analysis: Analysis) -> str:
    error = mean_color_error(analysis)
    if error is None:
        return "no color error"
    return (
        f"color error {error:.1f} (mean ΔE*ab over {_patches(analysis)}), visual noise "
        f"{_in_noise(analysis)}"
    )


def _in_noise(analysis: Analysis) -> str:
    noise = visual_noise_of(analysis)
    return "none" if noise is None else _number(noise)


def _patches(analysis: Analysis) -> str:
    """Over what color errors are averaged."""
    return f"the patches of {chart_title(analysis.chart)}"


def _delta_e(error: float | None) -> str:
    return "none" if error is None else f"{error:.1f}"


def _too_noisy(analysis: Analysis, prior: str | Spectra) -> str | None:
    """Where the matrix loses the colors in the noise, and the weight of the noise that does not."""
    lost = lost_colors(analysis.point, analysis.matrix, prior=prior)
    if lost is None:
        return None
    better = (
        f"; the matrix noise-aware={brief(lost.weight)} gives {_number(lost.least_total_error)}"
        if lost.total_error - lost.least_total_error >= 1 and math.isfinite(lost.weight)
        else ""
    )
    return (
        f"With the matrix {analysis.matrix.made_by}, color is lost in the noise of "
        f"{analysis.sensor.label}: the total color error as viewed is {_number(lost.total_error)} "
        f"ΔE*ab; a gray picture without noise has {_number(lost.colorless_error)}{better}."
    )


def drawn_head(shown: Shown, look: Look) -> dict[str, Any]:
    """The verdict in sentences, and the numbers of `drawn_numbers`."""
    return {
        "verdict": verdict_sentences(
            shown.analyses,
            equal=shown.study.exposure.equal,
            reader=shown.study.outputs.reader,
            prior=next(iter(shown.makers.values())).prior,
        ),
        **drawn_numbers(shown, look),
    }


def drawn_numbers(shown: Shown, look: Look) -> dict[str, Any]:
    """The light, and settings and numbers of each sensor: of the head, what is quick."""
    first = shown.analyses[0].scene
    sensors = [_sensor(analysis) for analysis in shown.analyses]
    level = {"level_lux": first.level_lux, "text": level_in_words(first.level_lux, 4)}
    return {
        "light": {"name": first.illuminant.name, **level},
        "sensors": sensors,
        **numbers_of(_rows_of_head(sensors)),
        "table": _table(sensors),
        "ranking": ranking(shown.analyses),
    }


def _rows_of_head(sensors: Sequence[Mapping[str, Any]]) -> list[list[Any]]:
    """A row per channel of a sensor, under a row of headings."""
    head = ["sensor", "channel", "electrons of a white [e-]", "full well [e-]"]
    rows = [
        [one["name"], name, mean_e, one["full_well_e"], one["time_ms"], one["f_number"]]
        for one in sensors
        for name, mean_e in one["mean_e"].items()
    ]
    return [[*head, "exposure time [ms]", "f-number"], *rows]


def sensor_values(sensor: Sensor) -> dict[str, Any]:
    """Channels, origin and pixel of a sensor as plain data."""
    names = ("pitch_um", "full_well_e", "read_noise_e")
    pixel = asdict(sensor.pixel)
    values = {"channels": list(sensor.names), "origin": sensor.origin, "pixel": pixel}
    return values | {name: pixel[name] for name in names}


def _sensor(analysis: Analysis) -> dict[str, Any]:
    sensor, exposure = analysis.sensor, analysis.exposure
    mean = zip(sensor.names, analysis.raw.mean.tolist(), strict=True)
    return {
        "name": sensor.label,
        **sensor_values(sensor),
        "time_ms": 1e3 * exposure.time_s,
        "f_number": exposure.f_number,
        "saturated": saturated_names(analysis),
        "mean_e": dict(mean),
        "notes": list(diagnosis(analysis)),
    }


def _table(sensors: list[dict[str, Any]]) -> dict[str, Any]:
    """Every setting of each sensor, and its electrons from a perfect white."""
    channels = list(dict.fromkeys(name for one in sensors for name in one["channels"]))
    pixel = ("curves", "pixel [µm]", "full well [e⁻]", "read noise [e⁻]")
    units = [f"{name} [e⁻]" for name in channels]
    rows = []
    for one in sensors:
        mean = [electrons(one["mean_e"][c]) if c in one["mean_e"] else NONE for c in channels]
        full = ", ".join(one["saturated"]) or "none"
        rows.append(
            [
                *(one["name"], one["origin"], brief(one["pitch_um"])),
                *(decimal(one["full_well_e"], 0), brief(one["read_noise_e"])),
                *(brief(one["time_ms"], 4), brief(one["f_number"]), *mean, full),
            ]
        )
    return table(["sensor", *pixel, "time [ms]", "f-number", *units, "saturated"], rows)
