"""The ranking of many sensors on the terminal."""

import pytest

import chromanoise as cn
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
