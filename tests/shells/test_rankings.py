"""The ranking of many sensors on the terminal."""

import pytest

import chromanoise as cn
from chromanoise.charts.verdicts import _verdict
from chromanoise.study.ranking import lead_sentences

FIVE = ("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "onyx-rgbw-ircut", "model-rgb-ircut")


@pytest.mark.evidence
def test_the_terminal_shows_a_ranking_of_more_than_three_sensors_and_no_sentence_of_all_pairs(run):
    for command in ("analyze", "compare"):
        code, out, _ = run(command, *FIVE)
        assert code == 0
        assert "rank" in out
        assert "rank" not in run(command, *FIVE[:3])[1]
    result = cn.compare(*FIVE)
    assert len(result.crossovers) == 10
    assert len(result.shown_crossovers) < 10
    assert lead_sentences(result.leads)[0] in result.shown_sentences


def test_the_matrices_of_a_sensor_are_ranked_from_best_to_worst():
    settings = {"time_ms": 12, "points": 2, "lux": 1.0}
    found = cn.compare("onyx-rgbw", matrices=["kernel", "lmmse", "least-squares"], **settings)
    values = {one.matrix: one.value for one in found.ranking}
    best = sorted(values, key=lambda name: -values[name])
    (sentence,) = [one for one in found.shown_sentences if one.startswith("onyx-rgbw: SNR")]
    shown = [sentence.index(f"{name} {values[name]:.2f}") for name in best]
    assert shown == sorted(shown)
    alone = cn.compare("onyx-rgbw", **settings)
    assert not any(one.startswith("onyx-rgbw: SNR") for one in alone.shown_sentences)


def test_of_many_sensors_those_that_lead_and_their_crossovers_are_those_of_all_pairs(monkeypatch):
    settings = {"points": 5, "vary": "ircut-nm", "first": 600.0, "last": 1200.0}
    settings |= {"quantity": "visual-noise"}
    every = cn.compare(*FIVE, **settings)
    monkeypatch.setattr("chromanoise.study.ranking.MOST_CROSSED_SENSORS", 4)
    few = cn.compare(*FIVE, **settings)
    assert few.leads == every.leads
    assert len(every.leads) > 1
    assert 0 < len(few.crossovers) < len(every.crossovers) == 10
    assert few.shown_crossovers == every.shown_crossovers
    assert few.shown_sentences == every.shown_sentences


def test_of_many_sensors_all_have_their_noise_and_few_are_named(monkeypatch):
    names = (*FIVE, "model-rgb", "mt9v024-rgb", "model-rgbw-ircut")
    every = cn.analyze(*names).verdict
    _verdict.cache_clear()
    monkeypatch.setattr("chromanoise.study.trade_offs.MOST_CHECKED", 3)
    few = cn.analyze(*names).verdict
    assert few is not every
    assert few.at_equal_color.standings == every.at_equal_color.standings
    assert few.winner == every.winner == "model-rgbw-ircut"
    assert few.answer[0].text.count(" dB") == 5  # of four, and of the three others together


def test_of_many_sensors_a_band_over_priors_is_that_of_all_pairs(monkeypatch):
    settings = {"points": 5, "first": 0.01, "last": 10.0, "matrices": ["lmmse"], "prior": "all"}
    every = cn.compare(*FIVE[:4], **settings)
    monkeypatch.setattr("chromanoise.study.ranking.MOST_CROSSED_SENSORS", 3)
    few = cn.compare(*FIVE[:4], **settings)
    of_pair = {(one.first, one.second): one for one in every.bands}
    assert 0 < len(few.bands) < len(every.bands) == 6
    assert all(one.by_prior == of_pair[one.first, one.second].by_prior for one in few.bands)
