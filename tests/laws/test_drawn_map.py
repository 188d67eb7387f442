"""The heat map of the page: the values of `compare_map`, their colors, and the line of equality."""

import numpy as np
import pytest

import chromanoise as cn
from chromanoise.base.palette import DIFFERENCES, VALUES
from chromanoise.charts import drawing, shown
from chromanoise.charts.heat_map import MOST_VALUES
from chromanoise.study import study_from_data

SENSORS = ("onyx-rgb", "onyx-rgb-ircut", "onyx-rgbw")
SWEEP = {"vary": "lux", "first": 0.1, "last": 1000.0, "points": 9}
SECOND = {"vary": "read-noise-e", "first": 1.0, "last": 100.0, "points": 5}


TIME_MS = 12.0


def record(count, **changes):
    """The chart, and its cells."""
    sweep = {**SWEEP, "second": SECOND, **changes}
    sensors = [{"name": name} for name in SENSORS[:count]]
    study = {"sensors": sensors, "sweeps": [sweep], "exposure": {"time_ms": TIME_MS}}
    chart = drawing("map", shown(study_from_data(study, source="")))
    return chart, chart.panels[0].marks[0]


def drawn_values(chart, cells):
    """What chooses the colors, NaN where there is none."""
    return np.array(chart.columns[cells.value].values, dtype=float)


def computed(count):
    ends = {f"second_{key}": value for key, value in SECOND.items()}
    given = {**SWEEP, **ends, "time_ms": TIME_MS}
    return np.array([one.value for one in cn.compare_map(*SENSORS[:count], **given).maps])


@pytest.mark.parametrize("count", [1, 2, 3])
def test_the_table_has_the_values_of_a_comparison_in_python(count):
    table, values = record(count)[0].table, computed(count)
    assert len(table["rows"]) == values[0].size
    for row, *cells in zip(table["rows"], *(one.ravel() for one in values), strict=True):
        for text, value in zip(row[2:], cells, strict=False):
            assert (text == "undefined") == np.isnan(value)
            assert np.isnan(value) or float(text.replace("−", "-")) == pytest.approx(
                value, abs=0.006
            )
        best = SENSORS[int(np.argmax(cells))] if np.isfinite(cells).all() else row[-1]
        assert count == 1 or row[-1] == best


@pytest.mark.parametrize(
    ("count", "colors", "drawn"),
    [(1, VALUES, lambda values: values[0]), (2, DIFFERENCES, lambda values: values[0] - values[1])],
)
def test_the_colors_rise_with_the_value_and_are_absent_where_there_is_none(count, colors, drawn):
    (chart, cells), values = record(count), drawn(computed(count))
    assert (cells.colors[0], cells.colors[-1]) == (colors[0], colors[-1])
    assert cells.high == pytest.approx(np.nanmax(np.abs(values) if count == 2 else values))
    assert cells.low == pytest.approx(-cells.high if count == 2 else np.nanmin(values))
    np.testing.assert_array_equal(drawn_values(chart, cells), values.ravel())
    assert np.isnan(values).any()  # saturated at 1000 lx
    assert "Gray: a channel is saturated" in chart.notes[0]


def test_the_difference_of_a_sensor_and_itself_is_in_the_middle_of_the_scale():
    study = {
        "sensors": [{"name": "onyx-rgb"}, {"name": "onyx-rgb", "pixel": {"prnu": 0.0}}],
        "sweeps": [{**SWEEP, "second": SECOND}],
    }
    chart = drawing("map", shown(study_from_data(study, source="")))
    (cells,) = chart.panels[0].marks
    assert set(drawn_values(chart, cells)[np.isfinite(drawn_values(chart, cells))]) == {0.0}
    assert cells.low == -cells.high < 0


def test_on_the_line_both_sensors_have_the_same_snr():
    """Infrared helps a sensor without IR-cut as long as read noise dominates."""
    infrared, dim = {"vary": "infrared", "first": 0.0}, {"vary": "lux", "first": 0.01, "last": 0.1}
    chart, cells = record(2, **infrared, last=2.0, second=dim | {"points": 3})
    assert cells.low == -cells.high < 0
    (line,) = cells.equal
    assert [level for _, level in line] == list(chart.columns[1].values[:: cells.across])
    for ratio, level in line:
        near = {"vary": "infrared", "first": ratio, "last": ratio + 1e-6, "points": 2}
        curves = cn.compare(*SENSORS[:2], **near, lux=level, time_ms=TIME_MS).curves
        first, second = (one.value[0] for one in curves)
        assert first == pytest.approx(second, abs=0.001)


def test_of_many_sensors_the_key_names_those_that_win_somewhere():
    infrared, dim = {"vary": "infrared", "first": 0.0}, {"vary": "lux", "first": 0.01, "last": 0.1}
    chart, cells = record(3, **infrared, last=2.0, second=dim | {"points": 3})
    values = np.array([one.values for one in chart.columns[2:5]], dtype=float)
    winners = {SENSORS[i] for i in np.argmax(values, axis=0)}
    assert len(winners) > 1
    assert set(cells.names) - {""} == winners
    assert {SENSORS[int(i)] for i in drawn_values(chart, cells)} == winners


def test_of_many_sensors_of_which_one_wins_everywhere_its_lead_is_drawn():
    (chart, cells), values = record(3), computed(3)
    known = np.isfinite(values).all(axis=0)
    (winner,) = {SENSORS[i] for i in np.argmax(values[:, known], axis=0)}
    *_, second, first = np.sort(values[:, known], axis=0)
    drawn = drawn_values(chart, cells)
    np.testing.assert_allclose(drawn[np.isfinite(drawn)], first - second)
    assert cells.name.startswith(f"{winner}, lead over the next sensor [")


def test_a_fine_sweep_is_drawn_on_fewer_values_with_the_same_ends_and_says_so():
    chart, cells = record(1, points=61, second={**SECOND, "points": 21})
    across, up = (one.values for one in chart.columns[:2])
    assert (cells.across, len(up) // cells.across) == MOST_VALUES
    for values, part in ((across, SWEEP), (up, SECOND)):
        assert (values[0], values[-1]) == pytest.approx((part["first"], part["last"]))
    assert "61 by 21" in chart.notes[-1]
    assert not any("a run computes" in one for one in record(1)[0].notes)


def test_a_study_without_such_a_sweep_has_no_map():
    chart = drawing("map", shown(study_from_data({"sensors": [{"name": "onyx-rgb"}]}, source="")))
    assert chart.notes
    assert not chart.panels
    assert chart.table["rows"] == []
