"""The CSV of a chart holds the numbers of its record to the last digit."""

import csv
import io

import pytest

from chromanoise.charts import DRAWINGS, chart_csv, chart_rows, drawing, shown
from chromanoise.study import study_from_data
from outcomes import refused_input

STUDY = {
    "light": {"illuminant": "E", "level_lux": 20.0},  # one of the two is saturated
    "exposure": {"time_ms": 12.0},
    "sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgb-ircut", "label": 'a "name", and more'}],
    "sweeps": [
        {"vary": "lux", "first": 1.0, "last": 100.0, "points": 5}
        | {"second": {"vary": "f-number", "first": 1.4, "last": 8.0, "points": 3}}
    ],
}


@pytest.fixture(scope="module")
def of():
    return shown(study_from_data(STUDY, source="a test"))


@pytest.mark.parametrize("part", DRAWINGS)
def test_a_csv_has_distinct_headings_and_the_numbers_to_the_last_digit(of, part):
    record = drawing(part, of)
    head, *rows = csv.reader(io.StringIO(chart_csv(part, record)))
    assert len(set(head)) == len(head)
    names, *numbers = chart_rows(part, record)
    assert head == names
    assert rows
    for row, values in zip(rows, numbers, strict=True):
        for cell, value in zip(row, values, strict=True):
            assert (float(cell) if isinstance(value, float) else cell) == (
                "" if value is None else value
            )


def test_half_axes_are_written_as_long_as_they_are_and_drawn_magnified(of):
    record = drawing("vectors", of)
    drawn = [
        v
        for one in record["sensors"]
        if one["ellipsoid"]
        for axis in one["ellipsoid"]["half_axes"]
        for v in axis
    ]
    rows = [row for row in chart_rows("vectors", record) if row[1].startswith("half axis")]
    written = [value for row in rows for value in row[2:5]]
    assert drawn == pytest.approx([record["magnification"] * value for value in written])


def test_what_is_undefined_is_an_empty_cell_and_names_keep_their_commas(of):
    record = drawing("stages", of)
    head, *rows = csv.reader(io.StringIO(chart_csv("stages", record)))
    assert head[-1] == 'a "name", and more'
    (white,) = (row for row in rows if row[0] == "raw SNR" and row[2] == "W")
    assert white[-1] == ""
    assert "" in [row[3] for row in rows]


@pytest.mark.parametrize("label", ["=1+1", "+1", "-1", "@SUM(A1)"])
def test_a_label_is_no_formula_in_a_spreadsheet(label):
    study = {"sensors": [{"name": "onyx-rgbw", "label": label}]}
    record = drawing("budget", shown(study_from_data(study, source="a test")))
    _, *rows = csv.reader(io.StringIO(chart_csv("budget", record)))
    assert {row[0] for row in rows} == {f"'{label}"}
    assert min(float(row[2]) for row in rows if row[2]) < 0  # a number stays one


def test_a_study_without_a_map_has_no_numbers_of_one():
    of = shown(study_from_data({"sensors": [{"name": "onyx-rgbw"}]}, source="a test"))
    assert chart_rows("map", drawing("map", of)) == []


def test_an_unknown_chart_is_refused():
    with refused_input(subject="part", value="pie"):
        chart_rows("pie", {})
