"""Verdicts in sentences that compare sensors, for an eye and for a machine.

The answer comes first, then its reason, then what the matrix of the analyses gives.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from typing import Any

from chromanoise.base import check
from chromanoise.charts.budget_chart import cause_label
from chromanoise.charts.charted_study import Look, Shown, saturation_sentence
from chromanoise.charts.machine_verdicts import (
    LabeledOutcomes,
    best_for_a_machine,
    labeled_outcomes,
    machine_sentences,
)
from chromanoise.charts.numbers import brief, decimal, listed, signed, three_digits
from chromanoise.charts.sensor_table import RAW_SNR, drawn_numbers, raw_db
from chromanoise.metrics import CORRELATION, FILTERS, INFRARED, REST, WEIGHTS, Budget
from chromanoise.noise import DEFAULT_RULE, conditions, level_in_words
from chromanoise.sensor import SOURCES
from chromanoise.spectra import Spectra, chart_title
from chromanoise.study import (
    DEFAULT_PRIOR,
    HARDLY_SEEN_DELTA_E,
    LEAST_TIE_DB,
    MOST_CHECKED,
    Analysis,
    EqualColor,
    Reader,
    Standing,
    Told,
    TradeOff,
    Verdict,
    color_snr_db,
    coordinate_budget,
    equal_color,
    lost_colors,
    mean_color_error,
    visual_noise_of,
)

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
    read = labeled_outcomes(analyses)
    winner, margin_db = found.winner, found.margin_db
    if reader == "machine":
        best, margin_db = best_for_a_machine(read)
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
    read: Sequence[LabeledOutcomes],
    equal: str,
    reader: Reader,
    prior: str | Spectra,
) -> list[Told]:
    excluded = [Told("excluded", text) for a in analyses if (text := _excluded(a))]
    rest = [a for a in analyses if _excluded(a) is None]
    able = [a for a in rest if color_snr_db(a)["Y"] is not None]
    lost = {one.sensor for one in found.standings if one.is_lost}
    noisy = [_too_noisy(a, prior) for a in able if a.sensor.label not in lost]
    machine = [Told("machine", text) for text in machine_sentences(analyses, read)]
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
    best_raw = max(rivals, key=raw_db)
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
    tied = found.tied[1:]
    behind = others[len(tied) :]
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
    at = (
        f"at equal color error ({found.at_color_error:.1f} ΔE*ab, the least of "
        f"{found.limiting.sensor}; noise-aware matrices)"
    )
    if not tied:
        less = [
            f"{one.behind_db:.1f} dB less than {one.sensor} ({three_digits(best.visual_noise)} "
            f"against {three_digits(one.visual_noise)})"
            for one in behind
        ]
        less = _shortened(less, f"up to {behind[-1].behind_db:.1f} dB less than {{}} others")
        who = f"{best.sensor}{_unused(found, best)}"
        return f"{who} has the least visual noise {at}: {listed(less)}."
    every = [f"{one.sensor}{_unused(found, one)}" for one in (best, *tied)]
    names = listed(_shortened(every, "{} others"))
    apart = f"they differ by less than {LEAST_TIE_DB:g} dB"
    if max(found.tie_db or 0.0, tied[-1].behind_db) > LEAST_TIE_DB:
        apart = (
            f"they differ by {tied[-1].behind_db:.1f} dB, and another training set, color error or "
            f"measure of noise shifts this by {found.tie_db:.1f} dB"
        )
    more = [f"{one.sensor} has {one.behind_db:.1f} dB more" for one in behind]
    if behind:
        more = _shortened(more, f"{{}} others have up to {behind[-1].behind_db:.1f} dB more")
    return f"{names} tie in visual noise {at}: {apart}{'; ' if more else ''}{listed(more)}."


def _unused(found: EqualColor, one: Standing) -> str:
    """The channels that the matrix of a sensor leaves out, in brackets."""
    trade = next(each for each in found.trade_offs if each.point.sensor.label == one.sensor)
    unused = [name for name in trade.point.sensor.names if name not in one.channels]
    return f" (without {listed(unused)})" if unused else ""


def _shortened(every: list[str], rest: str) -> list[str]:
    """The first few of a list, and of the others how many they are."""
    more = len(every) - _MOST_NAMED
    return every if more < 2 else [*every[:_MOST_NAMED], rest.format(more)]


def _whys(best: Standing, behind: Sequence[Standing]) -> list[str]:
    """Noise of the gray in the raw channels, and what each matrix loses: their sum is told."""
    parts = []
    for one in behind[:_MOST_NAMED]:
        more_raw_db, lost_db = one.gray_snr_db - best.gray_snr_db, one.lost_in_matrix_db
        raw = (
            "the same raw SNR"
            if abs(more_raw_db) < LEAST_TIE_DB
            else f"{_more(more_raw_db)} raw SNR"
        )
        lost = "as much" if abs(lost_db) < LEAST_TIE_DB else _more(lost_db)
        link = "but" if more_raw_db >= LEAST_TIE_DB else "and"
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
        also = "also " if best is found.standings[0] and not found.is_tie else ""
        leads = f"{best.sensor} {also}leads"
    own = listed([three_digits(one.least_total_error) for one in close])
    behind = [
        f"{three_digits(one.least_total_error)} for {one.sensor}"
        for one in others
        if one not in close
    ]
    rest = f"up to {three_digits(others[-1].least_total_error)} for {{}} others" if others else ""
    against = f", against {listed(_shortened(behind, rest))}" if behind else ""
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
    totals = listed([three_digits(one.least_total_error) for one in lost])
    return [
        f"Color is lost in the noise of {who}: {have} {totals} ΔE*ab; a gray picture without noise "
        f"has {three_digits(found.colorless_error)} ΔE*ab."
    ]


def _turns(found: EqualColor) -> list[str]:
    """Where another sensor has less noise, or that none has clearly less anywhere."""
    (low_lux, high_lux), (least, most) = found.levels_lux, found.errors or (0.0, 0.0)
    first = found.standings[0].sensor
    if not found.turns:
        if found.is_tie:
            return []
        light = f"at light levels from {_lux(low_lux)} to {_lux(high_lux)}, or "
        other = "No other sensor"
        if len(found.standings) > MOST_CHECKED:
            other = f"No other of the {MOST_CHECKED} sensors of least noise"
        return [
            f"{other} clearly leads {light if high_lux > low_lux else ''}at color errors "
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
        why = f", but a larger color error ({own:.1f} against {other:.1f} ΔE*ab)"
    return [
        f"With this matrix {least} has less visual noise than {first} "
        f"({three_digits(known[least])} against {three_digits(known[first])}){why}."
    ]


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
    more_db = raw_db(first) - raw_db(second)
    luminances_db = [_known_luminance_db(one) for one in (first, second)]
    gap_db = luminances_db[0] - luminances_db[1]
    luminance = "the same SNR of Y as"
    if abs(gap_db) >= LEAST_TIE_DB:
        luminance = f"{_more(gap_db)} SNR of Y than"
    raw = "the same raw SNR" if more_db < LEAST_TIE_DB else f"{_more(more_db)} raw SNR"
    link = "but" if more_db >= LEAST_TIE_DB > gap_db else "and"
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
    matrix, rest = f"the matrix {able[0].matrix.made_by}", "{} others in the table"
    over = f"mean ΔE*ab over {_patches(able[0])}"
    told = [
        f"With {matrix}, color error ({over}): {', '.join(_shortened(errors, rest))}; visual "
        f"noise: {', '.join(_shortened(noises, rest))}."
    ]
    if below:
        told.append(
            f"With {matrix}, the color error is less than with every noise-aware matrix, as these "
            f"keep the white: {listed(_shortened(below, '{} others'))}."
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
    return "none" if noise is None else three_digits(noise)


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
        f"; the matrix noise-aware={brief(lost.weight)} gives "
        f"{three_digits(lost.least_total_error)}"
        if lost.total_error - lost.least_total_error >= 1 and math.isfinite(lost.weight)
        else ""
    )
    return (
        f"With the matrix {analysis.matrix.made_by}, color is lost in the noise of "
        f"{analysis.sensor.label}: the total color error as viewed is "
        f"{three_digits(lost.total_error)} ΔE*ab; a gray picture without noise has "
        f"{three_digits(lost.colorless_error)}{better}."
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
