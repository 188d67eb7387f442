"""Sentences that compare sensors: raw SNR, luminance SNR, their difference and its causes."""

from collections.abc import Mapping, Sequence
from itertools import chain
from typing import Literal

from chromanoise import _check
from chromanoise.analysis.analysis import Analysis, color_snr_db, mean_color_error
from chromanoise.analysis.budgets import coordinate_budget
from chromanoise.analysis.total_error import better_matrix, mean_total_error, total_error_of
from chromanoise.charts.budget import cause_label
from chromanoise.charts.charted_study import saturation_sentence
from chromanoise.charts.machine import machine_sentences
from chromanoise.charts.ranking import compared_raw_name, compared_raw_snr_db
from chromanoise.charts.text import decimal, signed
from chromanoise.exposure import conditions
from chromanoise.metrics import Budget
from chromanoise.metrics.budget import CORRELATION, FILTERS, INFRARED, REST, WEIGHTS
from chromanoise.sensor.noise_source import SOURCES
from chromanoise.spectra import chart_title

_TIE_DB = 0.05  # differences below one decimal
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
    "saturation": " with each sensor exposed to the same share of full well,",
    "light": " with the same photons on all channels of each sensor together,",
}


Reader = Literal["eye", "machine"]


def verdict_sentences(
    analyses: Sequence[Analysis], *, equal: str = "exposure", reader: Reader = "eye"
) -> list[str]:
    """Sentences that compare the sensors of several analyses.

    For an eye, they compare raw SNR and luminance SNR, name the causes of the difference, and give
    the color errors; for a machine, they compare the distances of patches in raw values. Sensors
    that are saturated or have no luminance get a sentence of their own.

    Parameters
    ----------
    analyses
        Analyses under one light.
    equal
        Terms of the comparison, from `chromanoise.exposure.EQUAL_TERMS`; named in the text unless
        all sensors have the same exposure time.
    reader
        Whose sentence comes first.

    Raises
    ------
    InputError
        If ``equal`` is unknown.
    """
    _check.one_of("terms of a comparison", equal, tuple(_TERMS))
    left_out = [sentence for a in analyses if (sentence := _left_out(a))]
    able = [a for a in analyses if _left_out(a) is None]
    sentences = [*left_out, *(sentence for a in able if (sentence := _too_noisy(a)))]
    machine = machine_sentences(analyses)
    if left_out and len(able) < 2 and not (machine and reader == "machine"):
        alone = [_alone(a) for a in able]
        first = f"{_setting(analyses, equal)} {sentences[0]}"
        return [first, *left_out[1:], *alone, *sentences[len(left_out) :], *machine]
    if reader == "machine":
        opening = [f"{_setting(analyses, equal)} {_lower(one)}" for one in machine[:1]]
        return [*opening, *machine[1:], *_for_an_eye(analyses, able, sentences, equal)]
    return _for_an_eye(analyses, able, [*machine, *sentences], equal)


def _lower(sentence: str) -> str:
    return sentence[0].lower() + sentence[1:]


def _for_an_eye(
    analyses: Sequence[Analysis], able: list[Analysis], sentences: list[str], equal: str
) -> list[str]:
    if len(able) == 1:
        sentences.insert(0, f"{_setting(analyses, equal)} {_alone(able[0])}")
    if len(able) < 2:
        return sentences
    best_raw = max(able, key=lambda a: compared_raw_snr_db(a, able))
    best_color = max(able, key=_luminance_db)
    if abs(_luminance_db(best_raw) - _luminance_db(best_color)) < _TIE_DB:
        best_color = best_raw  # equal: the leader in raw is named once
    others = [a for a in able if a is not best_color]
    rival = best_raw if best_raw is not best_color else max(others, key=_luminance_db)
    first = _setting(analyses, equal) + _contest(best_color, rival, best_raw, able)
    return [first, *_reasons(best_color, rival), _colors(able), *sentences]


def _left_out(analysis: Analysis) -> str | None:
    full = saturation_sentence(analysis)
    if full is not None:
        return f"{full}."
    if analysis.one_code.any():
        return (
            f"{analysis.sensor.label}: practically every reading of a channel is the same code of "
            "the converter, so the sensor has no color to compare; take more bits or a higher gain."
        )
    if color_snr_db(analysis)["Y"] is None:
        return (
            f"{analysis.sensor.label}: its matrix gives no valid Y under this light, so it has no "
            "color to compare."
        )
    return None


def _alone(analysis: Analysis) -> str:
    return (
        f"{analysis.sensor.label} has {_luminance_db(analysis):.1f} dB of "
        f"luminance SNR for an eye, {decimal(_loss_db(analysis))} dB below the best linear "
        f"readout{_largest(analysis)}; {_error(analysis)}."
    )


def _contest(winner: Analysis, rival: Analysis, best_raw: Analysis, able: list[Analysis]) -> str:
    gap = _luminance_db(winner) - _luminance_db(rival)
    if best_raw is winner:
        same = abs(gap) < _TIE_DB
        color = (
            "has the same luminance SNR" if same else f"{gap:.1f} dB better in luminance for an eye"
        )
        if compared_raw_snr_db(winner, able) - compared_raw_snr_db(rival, able) < _TIE_DB:
            color = color if same else f"is {color}"
        return f" {_raw_lead(winner, rival, able)} and {color} ({_pair(winner, rival)})."
    same = compared_raw_snr_db(rival, able) - compared_raw_snr_db(winner, able) < _TIE_DB
    color = f"{'is ' if same else ''}{gap:.1f} dB worse in luminance for an eye"
    return f" {_raw_lead(rival, winner, able)} but {color} ({_pair(rival, winner)})."


def _raw_lead(first: Analysis, second: Analysis, able: Sequence[Analysis]) -> str:
    raw = compared_raw_snr_db(first, able) - compared_raw_snr_db(second, able)
    lead = f"is {raw:.1f} dB better than {second.sensor.label} in raw"
    if raw < _TIE_DB:
        lead = f"has the same raw SNR as {second.sensor.label}"
    return f"{first.sensor.label} {lead} ({compared_raw_name(able)})"


def _pair(first: Analysis, second: Analysis) -> str:
    return f"SNR of Y {_luminance_db(first):.1f} against {_luminance_db(second):.1f} dB"


def _reasons(winner: Analysis, loser: Analysis) -> list[str]:
    """Causes that cost the loser more than the winner: two, or as many as explain the gap."""
    gap = _luminance_db(winner) - _luminance_db(loser)
    good, bad = (_costs(coordinate_budget(a, "Y")) for a in (winner, loser))
    if gap < _TIE_DB or not (good and bad):
        return []
    beyond = {cause: loss - good.get(cause, 0.0) for cause, loss in bad.items()}
    beyond[INFRARED] = beyond.get(INFRARED, 0.0) + beyond.pop(REST)  # infrared costs and leaks
    parts: list[list[str]] = []
    explained = 0.0
    for cause in sorted(beyond, key=lambda one: -beyond[one]):
        if beyond[cause] < _WORTH_DB or (len(parts) > 1 and explained > gap - _WORTH_DB):
            break
        explained += beyond[cause]
        bars = [one for one in ((cause, REST) if cause == INFRARED else (cause,)) if one in bad]
        # crosstalk may be a cause for one sensor only
        costs_db = [(one, bad[one], good.get(one, 0.0)) for one in bars]
        parts.append(
            [
                _reason(one, own, other, winner.sensor.label)
                for one, own, other in costs_db
                if one == cause or abs(own - other) >= _TIE_DB
            ]
        )
    if not parts:
        return []
    who = f"{loser.sensor.label} has less luminance SNR than {winner.sensor.label}"
    return [f"Why {who}: {'; '.join(chain.from_iterable(parts))}."]


def _reason(cause: str, loss_db: float, winner_db: float, winner: str) -> str:
    """A bar of the budget with its label and number, and the same bar of the winner."""
    if cause == _PHOTONS:
        levels = f"{decimal(-loss_db)} dB, against {decimal(-winner_db)} dB for {winner}"
        return f"all photons: {levels}, because fewer reach its pixels"
    label = _label(cause)
    if min(loss_db, winner_db) < -_TIE_DB:  # a gain is not called a cost
        return f"{label}: {signed(-loss_db)} dB, against {signed(-winner_db)} dB for {winner}"
    return f"{label} costs {decimal(loss_db)} dB, against {decimal(winner_db)} dB for {winner}"


def _label(cause: str) -> str:
    gloss = _GLOSSES.get(cause)
    return cause_label(cause, "Y") + (f" ({gloss})" if gloss else "")


def _colors(able: Sequence[Analysis]) -> str:
    errors = ", ".join(f"{a.sensor.label} {_delta_e(mean_color_error(a))}" for a in able)
    sums = ", ".join(f"{a.sensor.label} {_delta_e(mean_total_error(a))}" for a in able)
    over = _patches(able[0])
    return f"Color error (mean ΔE*ab over {over}): {errors}; total color error, with noise: {sums}."


def _costs(budget: Budget | None) -> dict[str, float]:
    """Loss of each cause, with the loss from missing photons: the sum is minus the SNR."""
    if budget is None:
        return {}
    return {_PHOTONS: -budget.photons_db} | {cost.cause: cost.loss_db for cost in budget.costs}


def _largest(analysis: Analysis) -> str:
    """The largest loss relative to the best linear SNR, which already contains read noise."""
    costs, whole_db = _costs(coordinate_budget(analysis, "Y")), _loss_db(analysis)
    found = [(costs[cause], cause) for cause in _BELOW_THE_BOUND if cause in costs]
    if not found or min(whole_db, max(found)[0]) < _WORTH_DB:
        return ""
    loss_db, cause = max(found)
    how = "mostly" if whole_db / 2 < loss_db <= whole_db + _TIE_DB else "above all"
    return f", {how} because of {_label(cause)}: {decimal(loss_db)} dB"


def _setting(analyses: Sequence[Analysis], equal: str) -> str:
    return f"At {conditions([one.point for one in analyses])},{_TERMS[equal]}"


def _luminance_db(analysis: Analysis) -> float:
    found = color_snr_db(analysis)["Y"]
    assert found is not None  # called only for analyses with a value
    return found


def _loss_db(analysis: Analysis) -> float:
    loss_db = analysis.color_snr_loss_db
    assert loss_db is not None  # called only for analyses with a value
    return loss_db


def _error(analysis: Analysis) -> str:
    error, total = mean_color_error(analysis), mean_total_error(analysis)
    if error is None:
        return "no color error"
    return (
        f"color error {error:.1f} (mean ΔE*ab over {_patches(analysis)}), total color error with "
        f"noise {_delta_e(total)}"
    )


def _patches(analysis: Analysis) -> str:
    """Over what color errors are averaged."""
    return f"the patches of {chart_title(analysis.chart)}"


def _delta_e(error: float | None) -> str:
    return "none" if error is None else f"{error:.1f}"


def _too_noisy(analysis: Analysis) -> str | None:
    """Where noise exceeds `NOISY_DELTA_E`: the matrix that has less total color error."""
    better, own = better_matrix(analysis), total_error_of(analysis)
    if better is None or own is None:
        return None
    name, error = better
    return (
        f"{analysis.sensor.label}: the color noise is {own.noise.mean():.0f} ΔE*ab. The matrix "
        f"{name} reduces the total color error from {own.total.mean():.0f} to {error:.0f} ΔE*ab."
    )
