"""The CSV of a chart holds the numbers of its record to the last digit."""

import csv
import io

import pytest

from chromanoise.charts import chart_csv, chart_rows, drawing, shown
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
DRAWN = {  # of each record that is no `Chart`, the keys of the numbers behind the marks
    "head": {"mean_e", "full_well_e", "time_ms", "f_number"},
    "stages": {"lines"},
    "budget": {"change_db", "from_db", "to_db"},
    "map": {"values"},
    "vectors": {"at", "norm_share"},
    "chart": {"delta_e", "noise"},
}


@pytest.fixture(scope="module")
def of():
    return shown(study_from_data(STUDY, source="a test"))


def numbers_in(data, keys, inside=False):
    """All numbers below any of the keys."""
    if isinstance(data, bool):
        return
    if isinstance(data, float | int):
        if inside:
            yield float(data)
    elif isinstance(data, dict):
        for key, value in data.items():
            if key != "ellipsoid":
                yield from numbers_in(value, keys, inside or key in keys)
    elif isinstance(data, list):
        for value in data:
            yield from numbers_in(value, keys, inside)


def cells(rows):
    return [cell for row in rows for cell in row]


def number(cell):
    try:
        return float(cell)
    except ValueError:
        return None


@pytest.mark.parametrize("part", DRAWN)
def test_every_number_of_a_chart_is_in_its_csv_and_no_other(of, part):
    record = drawing(part, of)
    head, *rows = csv.reader(io.StringIO(chart_csv(part, record)))
    assert rows
    assert len(set(head)) == len(head)
    assert {len(row) for row in rows} == {len(head)}
    written = {value for cell in cells(rows) if (value := number(cell)) is not None}
    drawn = set(numbers_in(record, DRAWN[part]))
    if part == "vectors":  # half axes are written as long as they are, drawn magnified
        halves = [half for one in record["sensors"] if (half := one["ellipsoid"])]
        long = [v for one in halves for axis in one["half_axes"] for v in axis]
        drawn |= {value / record["magnification"] for value in long}
        assert long
    assert written == drawn


def test_what_is_undefined_is_an_empty_cell_and_names_keep_their_commas(of):
    record = drawing("stages", of)
    head, *rows = csv.reader(io.StringIO(chart_csv("stages", record)))
    assert head[-1] == 'a "name", and more'
    (white,) = (row for row in rows if row[0] == "raw SNR" and row[2] == "W")
    assert white[-1] == ""
    assert record["sensors"][0]["why_not"]
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
