"""``front.json`` and its chart: what is written is read, and wrong values have a key."""

import json

import numpy as np
import pytest

from chromanoise.apps.design.front_charts import drawn_front
from chromanoise.apps.design.pareto_front import front_from_text, member_csv, read_front
from chromanoise.study.resolve_names import resolve_sensor
from fronts import REFERENCES, front_of_ir_cuts
from outcomes import refused_input


@pytest.fixture(scope="module")
def front():
    return front_of_ir_cuts()


@pytest.fixture(scope="module")
def data(front):
    return json.loads(front.as_json())


def test_what_is_written_is_read(front, tmp_path):
    path = tmp_path / "front.json"
    path.write_text(front.as_json())
    assert read_front(path) == front


def test_the_curves_of_a_member_are_those_of_its_sensor_to_the_last_digit(front, tmp_path):
    path = tmp_path / "front-001.csv"
    path.write_text(member_csv(front.members[0]))
    assert np.array_equal(resolve_sensor(str(path)).qe, front.members[0].curves.qe)


def test_default_values_of_a_pixel_are_left_out_because_a_study_refuses_them(front, data):
    pixel = {"read_noise_e": 3.0, "prnu": 0.0, "dark_reference_c": 25.0}
    changed = data | {"members": [data["members"][0] | {"pixel": pixel}]}
    [member] = front_from_text(json.dumps(changed), source="front.json").members
    assert member.pixel.model_dump(exclude_none=True) == {"read_noise_e": 3.0}


def test_later_versions_may_add_keys(front, data):
    assert front_from_text(json.dumps(data | {"speed": 1}), source="front.json") == front


@pytest.mark.parametrize(
    ("place", "value", "where"),
    [
        (("schema",), "chromanoise sensor", "key 'schema'"),
        (("members",), [], "key 'members'"),
        (("objectives", 0, "better"), "more", "key 'objectives.0.better'"),
        (("objectives", 1, "name"), "snr_y_db", "objectives"),
        (("members", 0, "name"), "onyx-rgbw", "members"),
        (("members", 0, "objectives"), {"snr_y_db": 1.0}, "front-001"),
        (("members", 0, "objectives", "snr_y_db"), "high", "key 'members.0.objectives.snr_y_db'"),
        (("members", 0, "pixel", "prnu"), 2.0, "key 'members.0.pixel.prnu'"),
        (("members", 0, "curves", "qe", 3, 1), 1.5, "key 'members.0.curves.qe.3.1'"),
        (("members", 0, "pixel", "size"), 2.0, "key 'members.0.pixel.size'"),
        (("scenes", 0, "matrix"), "best", "key 'scenes.0.matrix'"),
        (("scenes", 0, "light", "level_lux"), -1.0, "key 'scenes.0.light.level_lux'"),
    ],
)
def test_a_wrong_value_is_named_by_its_key(data, place, value, where):
    changed = json.loads(json.dumps(data))
    at = changed
    for step in place[:-1]:
        at = at[step]
    at[place[-1]] = value
    with refused_input(subject="front.json", where=where):
        front_from_text(json.dumps(changed), source="front.json")


def test_curves_with_a_missing_number_are_refused(front):
    member = front.members[0]
    curves = member.curves.model_copy(update={"qe": [*member.curves.qe[:-1], [0.1]]})
    with refused_input(subject="curves of front-001"):
        member_csv(member.model_copy(update={"curves": curves}))


def test_the_chart_has_every_value_of_every_sensor(front):
    chart = drawn_front(front)
    assert (chart["x"], chart["y"]) == ("snr_y_db", "color_error")
    assert {one["name"]: one["values"] for one in (*chart["references"], *chart["members"])} == {
        one.name: one.objectives for one in (*front.references, *front.members)
    }
    assert len(chart["table"]["rows"]) == len(front.members) + len(REFERENCES)
    assert {len(row) for row in chart["table"]["rows"]} == {len(chart["table"]["head"])}
    assert [one["mark"] for one in chart["members"]] == ["extreme", "knee", *["member"] * 4]


def test_any_two_objectives_are_the_axes_of_the_chart(front):
    chart = drawn_front(front, x="bound_db", y="snr_y_db")
    assert (chart["x"], chart["y"]) == ("bound_db", "snr_y_db")
    with refused_input(subject="x", value="speed"):
        drawn_front(front, x="speed")


def test_an_undefined_value_is_no_number_and_no_text(front):
    member = front.members[0]
    values = member.objectives | {"snr_y_db": None}
    undefined = member.model_copy(update={"objectives": values})
    chart = drawn_front(front.model_copy(update={"members": [undefined]}))
    [drawn] = chart["members"]
    assert (drawn["values"]["snr_y_db"], drawn["text"]["snr_y_db"]) == (None, "–")
