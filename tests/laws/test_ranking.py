"""The table of the sensors: ranks, text and notes."""

import pytest

from chromanoise.charts import drawing, shown
from chromanoise.study import study_from_data

KEYS = [
    *("rank", "raw_db", "luminance_db", "loss_db", "color_error", "visual_noise", "time_ms"),
    "f_number",
]


def ranking_of(names, **study):
    parts = [{"name": one} if isinstance(one, str) else one for one in names]
    data = {"sensors": parts, **study}
    of = shown(study_from_data(data, source=""))
    return drawing("head", of)["ranking"], of


def column(ranking, key, of="text"):
    i = [one["key"] for one in ranking["columns"]].index(key)
    return [row[of][i] for row in ranking["rows"]]


def test_the_numbers_are_those_of_the_paper_and_the_verdict():
    ranking, of = ranking_of(["onyx-rgbw", "onyx-rgb-ircut"])
    assert column(ranking, "rank") == ["2", "1"]
    assert column(ranking, "luminance_db") == ["26.0", "32.4"]
    verdict = " ".join(drawing("head", of)["verdict"])
    lead_db = column(ranking, "raw_db", "values")
    assert f"{lead_db[0] - lead_db[1]:.1f} dB more raw SNR" in verdict
    assert "less SNR of Y than onyx-rgb-ircut on a perfect white (26.0 against 32.4 dB)" in verdict
    assert "best linear readout" in ranking["columns"][1]["what"]


def test_the_columns_are_one_set_for_all_sensors_with_a_channel_for_each_name():
    ranking, of = ranking_of(["onyx-rgb", "model-mono", "model-cmy"])
    keys = [one["key"] for one in ranking["columns"]]
    channels = list(dict.fromkeys(n for a in of.analyses for n in a.sensor.names))
    assert keys == [*KEYS, *(f"mean_e.{name}" for name in channels)]
    assert all(len(row["text"]) == len(row["values"]) == len(keys) for row in ranking["rows"])
    assert column(ranking, "mean_e.C")[:2] == ["–", "–"]


def test_ranks_follow_the_snr_of_y_and_equal_numbers_share_one():
    twin = {"name": "onyx-rgb", "label": "twin", "pixel": {"prnu": 1e-6}}
    ranking, _ = ranking_of(["onyx-rgb", "onyx-rgb-ircut", twin, "onyx-rgbw"])
    assert column(ranking, "rank") == ["2", "1", "2", "4"]


def test_a_saturated_sensor_has_no_rank_and_says_which_channels():
    ranking, _ = ranking_of(["onyx-rgbw", "onyx-rgb-ircut"], exposure={"time_ms": 30.0})
    first, second = ranking["rows"]
    assert first["saturated"] == ["R", "G", "B", "W"]
    assert second["saturated"] == []
    for key in ("rank", "raw_db", "luminance_db", "loss_db"):
        assert column(ranking, key, "values")[0] is None
        assert column(ranking, key)[0] == "–"
        assert column(ranking, key, "values")[1] is not None


@pytest.mark.parametrize("count", [2, 4])
def test_a_note_on_several_sensors_is_shown_once_with_their_names(count):
    names = ["onyx-rgbw", "onyx-rgb-ircut", "onyx-rgb", "onyx-rgbw-ircut"][:count]
    ranking, _ = ranking_of(names)
    notes = ranking["notes"]
    assert len({note.partition(": ")[2] for note in notes}) == len(notes)
    assert notes[0].startswith(", ".join(names) + ": ")
