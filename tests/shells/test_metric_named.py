"""Numbers that depend on the metric name it, from the record of their result."""

import re

import pytest

import chromanoise as cn
from chromanoise.charts import as_data, drawing, shown
from chromanoise.charts.charted_study import Look
from chromanoise.charts.run_tables import budget_tables, channels_table
from chromanoise.study import study_from_data
from chromanoise.study.analysis import contravariant_snr_db, diagnosis
from chromanoise.web.story import story

METRICS = ("quanta", "energy")
PAIR = ("onyx-rgbw", "onyx-rgb-ircut")
LIGHT = {"lux": 10, "time_ms": 12}


def study_data(metric):
    return {
        "sensors": [{"name": name} for name in PAIR],
        "exposure": {"time_ms": 12.0},
        "metric": metric,
    }


def names_only(text, metric):
    """Whether the text names this metric and no other."""
    return set(re.findall("|".join(METRICS), text)) == {metric}


def test_one_sensor_has_contravariant_snr_7_db_apart_in_the_two_metrics():
    found = [
        contravariant_snr_db(cn.analyze(PAIR[0], metric=metric, **LIGHT).analyses[0])["R"]
        for metric in METRICS
    ]
    assert [round(value, 1) for value in found] == [9.9, 16.9]


@pytest.mark.parametrize("metric", METRICS)
def test_tables_of_a_report_name_the_metric(metric):
    analyses = cn.analyze(*PAIR, metric=metric, **LIGHT).analyses
    assert names_only(channels_table(analyses).title, metric)
    for table in budget_tables(analyses[0]):
        assert names_only(table.title, metric)
    assert names_only(analyses[0]._repr_html_(), metric)


@pytest.mark.parametrize("metric", METRICS)
def test_the_terminal_names_the_metric_of_each_table_and_of_the_angles(done, metric):
    words = ("--lux", "10", "--time-ms", "12", "--metric", metric, "--notes")
    out, _ = done("analyze", *PAIR, *words)
    for head in ("Channels (eq.", "Spectrum and color (eq.", "angles between channels"):
        lines = [line for line in out.splitlines() if head in line]
        assert lines
        assert all(names_only(line, metric) for line in lines)


@pytest.mark.parametrize("metric", METRICS)
@pytest.mark.parametrize("part", ["budget", "vectors"])
def test_charts_with_angles_name_the_metric(metric, part):
    of = shown(study_from_data(study_data(metric), source=""))
    look = Look(coordinate="M^R") if part == "budget" else Look()
    assert names_only(as_data(drawing(part, of, look))["title"], metric)


@pytest.mark.parametrize("metric", METRICS)
def test_the_chart_of_stages_names_the_metric_beside_what_depends_on_it(metric):
    of = shown(study_from_data(study_data(metric), source=""))
    raw, contravariant, spectral, *others = (one.remark for one in drawing("stages", of).panels)
    assert names_only(contravariant, metric)
    assert names_only(spectral, metric)
    assert not any("quanta" in text for text in (raw, *others))


@pytest.mark.parametrize("metric", METRICS)
def test_every_sentence_of_the_tour_with_such_a_number_names_the_metric(metric):
    steps = story(study_data(metric))["steps"]
    text = [sentence for step in steps for sentence in step["sentences"]]
    found = [one for one in text if re.search(r"contravariant|\d° |VIF\) ", one)]
    assert len(found) >= 4
    assert all(names_only(one, metric) for one in found)


@pytest.mark.parametrize("metric", METRICS)
def test_the_note_on_a_nearly_singular_sensor_names_the_metric(metric):
    (analysis,) = cn.analyze("onyx-rgbw-ircut", metric=metric, **LIGHT).analyses
    (note,) = [note for note in diagnosis(analysis) if "singular" in note]
    assert names_only(note, metric)
