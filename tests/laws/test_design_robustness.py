"""Objectives over the tolerances: what the statistic is, and what a design makes of it."""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.apps.design import read_design
from chromanoise.apps.design.design_result import searched
from chromanoise.apps.design.optimizing import task_of
from chromanoise.apps.design.parameters import Parameter, RobustPart, over_tolerances
from chromanoise.base.errors import errors_in
from outcomes import refused_input

WIDE = Parameter(name="x", unit="nm", low=0.0, high=10.0, tolerance=2.0)
EXACT = Parameter(name="y", unit="nm", low=0.0, high=10.0)
DRAWS = RobustPart(samples=16)

DESIGN = """
[[sensors]]
name = "onyx-rgbw"
[light]
level_lux = 1.0
[exposure]
time_ms = 5.0
[design]
objectives = ["snr_y_db", "delta_e"]
budget = 8
population = 8
[[design.channels]]
name = "R"
filter = "gaussian"
center_nm = {low = 560, high = 680, tolerance = 5}
width_nm = [30, 60]
[[design.channels]]
name = "G"
filter = "gaussian"
center_nm = 540
width_nm = {low = 30, high = 60, tolerance = 3}
[[design.channels]]
name = "B"
filter = "gaussian"
center_nm = 450
width_nm = 40
[design.ir_cut]
cutoff_nm = 650
width_nm = 8
"""
ROBUST = "[design.robust]\n"
LIMITED = (
    '[[design.constraints]]\nobjective = "delta_e"\nat_most = 30\n'
    '[[design.constraints]]\nobjective = "delta_e"\nat_least = 1\n'
)


def task(tmp_path, text):
    file = tmp_path / "design.toml"
    file.write_text(text)
    return task_of(read_design(file))


def both_sides(values):
    return np.column_stack([values[:, 0], -values[:, 0]])


def test_the_worst_of_a_cost_and_of_its_negative_are_equally_far_and_within_the_tolerance():
    values = np.array([[5.0, 1.0], [7.0, 2.0]])
    costs = over_tolerances(both_sides, values, (WIDE, EXACT), DRAWS)
    above, below = costs[:, 0] - values[:, 0], costs[:, 1] + values[:, 0]
    np.testing.assert_allclose(above, below, rtol=1e-12)
    assert ((above > 1.5) & (above <= 2.0)).all()


def test_a_parameter_without_a_tolerance_keeps_its_value():
    values = np.array([[5.0, 1.25]])
    costs = over_tolerances(lambda each: each[:, 1:], values, (WIDE, EXACT), DRAWS)
    assert costs.item() == 1.25


def test_a_deviation_does_not_lead_beyond_what_is_possible():
    inner = replace(WIDE, least=0.0, most=10.0)
    values = np.array([[9.9, 1.0], [0.1, 1.0]])
    highest, lowest = over_tolerances(both_sides, values, (inner, EXACT), DRAWS).T
    assert (highest[0], -lowest[1]) == (10.0, 0.0)


def test_five_percent_of_the_copies_are_worse_than_the_percentile():
    draws = RobustPart(samples=100, statistic="percentile-95")
    seen = []

    def cost(each):
        seen.append(each[:, :1])
        return each[:, :1]

    (found,) = over_tolerances(cost, np.array([[5.0, 1.0]]), (WIDE, EXACT), draws)
    copies = seen[0][1:]
    assert (copies > found).sum() == 5


def test_a_candidate_has_the_same_value_alone_and_in_a_large_batch(tmp_path):
    one = task(tmp_path, DESIGN + ROBUST + LIMITED)
    low, high = one.problem().low, one.problem().high
    values = low + np.random.default_rng(3).random((300, low.size)) * (high - low)
    evaluate = one.problem().evaluate
    whole, alone = evaluate(values), evaluate(values[270:271])
    np.testing.assert_array_equal(whole.objectives[270:271], alone.objectives)
    np.testing.assert_array_equal(whole.violation[270:271], alone.violation)


def test_over_the_tolerances_no_objective_is_better_and_no_constraint_has_more_slack(tmp_path):
    one = task(tmp_path, DESIGN + ROBUST + LIMITED)
    values = np.array([[620.0, 40.0, 45.0], [570.0, 50.0, 35.0]])
    exact, robust = one.evaluation(None)(values), one.problem().evaluate(values)
    assert (robust.objectives[:, 0] < exact.objectives[:, 0]).all()
    assert (robust.objectives[:, 1] > exact.objectives[:, 1]).all()
    assert (robust.violation > exact.violation).all()


@pytest.fixture(scope="module", params=["robust", "nominal"])
def searched_with(request, tmp_path_factory):
    """What a search did not take, and its design."""
    text = DESIGN if request.param == "robust" else DESIGN + ROBUST
    return request.param, searched(task(tmp_path_factory.mktemp("design"), text))


def test_a_front_with_tolerances_gives_both_kinds_of_objectives(searched_with):
    name, design = searched_with
    other = "nominal" if name == "robust" else "robust"
    for member in design.to_file().members:
        exact, worst = member.objectives, getattr(member, name)
        if name == "nominal":
            exact, worst = worst, exact
        assert exact["snr_y_db"] > worst["snr_y_db"]
        assert exact["delta_e"] < worst["delta_e"]
        assert getattr(member, other) == {}
    assert [c.name for c in design.to_table().columns if c.name.endswith(name)] == [
        f"snr_y_db_{name}",
        f"delta_e_{name}",
    ]
    knee = f"{design.front.knee.name}: its tolerances change"
    assert any(sentence.startswith(knee) for sentence in design.sentences)


def test_the_extremes_with_and_without_tolerances_are_both_marked(searched_with):
    name, design = searched_with
    members = design.to_file().members
    for objective, best in (("snr_y_db", max), ("delta_e", min)):
        values = {one.name: getattr(one, name)[objective] for one in members}
        marked = [one.name for one in members if objective in getattr(one, f"{name}_extreme_of")]
        assert [values[one] for one in marked] == [best(values.values())]
        assert len([one for one in members if objective in one.extreme_of]) == 1


def test_a_candidate_without_signal_counts_as_infeasible_and_is_counted(tmp_path):
    text = DESIGN.replace('"delta_e"]', '"visual_noise"]')
    text = text.replace("cutoff_nm = 650", "cutoff_nm = [320, 700]").replace(
        "budget = 8\npopulation = 8", "budget = 32\npopulation = 16"
    )
    one = task(tmp_path, text)
    rows = np.array([[620.0, 45.0, 40.0, cutoff] for cutoff in (330.0, 690.0)])
    found = one.evaluation(None)(rows).objectives
    assert not np.isfinite(found[0]).any()
    assert np.isfinite(found[1]).all()
    design = searched(one)
    assert design.to_file().convergence.undefined == design.result.undefined > 0


def test_a_front_without_tolerances_has_neither(tmp_path):
    text = DESIGN.replace(", tolerance = 5", "").replace(", tolerance = 3", "")
    design = searched(task(tmp_path, text))
    assert all(one.nominal == one.robust == {} for one in design.to_file().members)


@pytest.mark.parametrize(
    ("change", "setting"),
    [
        ((", tolerance = 5", ""), "design.robust"),
        (("budget = 8", "budget = 8\npolish = true"), "design.polish"),
        ((ROBUST, ROBUST + "samples = 15\n"), "design.robust.samples"),
        ((ROBUST, ROBUST + 'statistic = "percentile-95"\n'), "design.robust.samples"),
        ((ROBUST, ROBUST + 'statistic = "best"\n'), "design.robust.statistic"),
        ((ROBUST, ROBUST + "seed = -1\n"), "design.robust.seed"),
    ],
)
def test_what_a_search_over_tolerances_cannot_use_is_refused_with_its_key(
    tmp_path, change, setting
):
    text = (DESIGN + ROBUST).replace(", tolerance = 3", "").replace(*change)
    with refused_input() as caught:
        task(tmp_path, text)
    assert [one.setting for one in errors_in(caught.value)] == [setting]
