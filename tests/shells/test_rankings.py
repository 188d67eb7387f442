"""The ranking of many sensors on the terminal."""

import chromanoise as cn
from chromanoise.analysis.comparison.ranking import lead_sentences

FIVE = ("onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "onyx-rgbw-ircut", "model-rgb-ircut")


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
