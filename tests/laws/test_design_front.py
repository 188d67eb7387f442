"""Fronts: dominance by its definition, and known knees and extremes."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from chromanoise.apps.design.pareto_front import (
    crowding,
    extremes,
    front_of,
    hypervolume,
    knee,
    merged,
    non_dominated,
    thinned,
)
from design_problems import bnh, problem_of

LEVELS = st.integers(0, 5).map(float)


def costs_of(count):
    shape = st.tuples(st.integers(0, 12), st.just(count))
    return shape.flatmap(lambda one: arrays(float, one, elements=LEVELS))


def dominates(one, other):
    return (one <= other).all() and (one < other).any()


@given(st.integers(1, 4).flatmap(costs_of))
def test_the_front_is_what_no_candidate_dominates_and_each_point_once(costs):
    kept = non_dominated(costs)
    for i, own in enumerate(costs):
        dominated = any(dominates(other, own) for other in costs)
        repeated = any((other == own).all() for other in costs[:i])
        assert kept[i] == (not dominated and not repeated)


@given(st.integers(1, 3).flatmap(lambda q: st.tuples(costs_of(q), costs_of(q))))
def test_a_front_merged_with_new_candidates_is_the_front_of_all(pair):
    old, new = pair
    old = old[non_dominated(old)]
    kept, fresh = merged(old, new)
    together = np.concatenate([old, new])
    assert (np.concatenate([kept, fresh]) == non_dominated(together)).all()


def test_thinning_an_uneven_front_keeps_its_ends_and_fills_its_gaps():
    first = np.concatenate([np.linspace(0, 0.1, 900), np.linspace(0.1, 1, 100)[1:]])
    costs = np.stack([first, 1 - first], axis=1)
    left = thinned(costs, 50)
    assert left.size == 50
    assert {0, len(costs) - 1} <= set(left)
    assert np.diff(np.sort(first[left])).max() < 0.06
    assert (thinned(costs, 2000) == np.arange(len(costs))).all()


def test_thinning_keeps_the_members_it_is_told_to_even_if_they_are_more():
    first = np.concatenate([np.linspace(0, 0.1, 900), np.linspace(0.1, 1, 100)[1:]])
    costs = np.stack([first, 1 - first], axis=1)
    crowded = sorted(set(range(900)) - set(thinned(costs, 50)))[400:402]
    kept = thinned(costs, 50, keep=crowded)
    assert kept.size == 50
    assert {0, *crowded, len(costs) - 1} <= set(kept)
    assert list(thinned(costs, 1, keep=crowded)) == crowded


def test_the_knee_of_a_quarter_of_a_circle_is_at_45_degrees():
    angle = np.linspace(0, np.pi / 2, 91)
    costs = 1 - np.stack([np.sin(angle), np.cos(angle)], axis=1)
    assert angle[knee(costs)] == pytest.approx(np.pi / 4)
    assert angle[knee(costs * [1000.0, 0.001])] == pytest.approx(np.pi / 4)


def test_the_knee_of_two_straight_lines_is_where_they_meet():
    lines = np.array([[0, 10], [1, 6], [2, 2], [6, 1], [10, 0]], dtype=float)
    assert knee(lines) == 2
    assert list(extremes(lines)) == [0, 4]


def test_of_equal_extremes_the_better_in_the_other_objectives_is_named():
    costs = np.array([[0.0, 5.0, 1.0], [0.0, 1.0, 9.0], [3.0, 0.0, 2.0], [9.0, 9.0, 0.0]])
    assert list(extremes(costs)) == [0, 2, 3]


def test_the_ends_are_never_crowded():
    assert np.isinf(crowding(np.array([[0.0, 1.0], [1.0, 0.0]]))).all()


def test_members_know_their_extremes_their_knee_and_the_constraints_that_hold_them():
    problem = bnh()
    values = np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0], [5.0, 3.0]])
    at = problem.evaluate(values)
    front = front_of(problem, values, at.objectives, at.violation)
    assert [member.name for member in front.members] == [
        "best-f1", "member-2", "knee", "member-4", "best-f2",
    ]  # fmt: skip
    assert front.best("f1").objectives == {"f1": 0.0, "f2": 50.0}
    assert front.best("f1").active == ("c1",)
    assert front.best("f2").values.tolist() == [5.0, 3.0]
    assert front.knee is front.members[2]
    assert [member.knee for member in front.members] == [False, False, True, False, False]


def test_a_front_of_higher_and_lower_objectives_starts_with_the_best_of_the_first():
    problem = problem_of(lambda a: ([a, a], []), [0.0], [1.0], better=("higher", "lower"))
    values = np.linspace(0, 1, 30)[:, None]
    at = problem.evaluate(values)
    front = front_of(
        problem, values, at.objectives, at.violation, most=10, sensor_of=lambda x, name: (x, name)
    )
    first = [member.objectives["f1"] for member in front.members]
    assert first == sorted(first, reverse=True)
    assert len(front.members) == 10
    assert (front.best("f1").objectives["f1"], front.best("f2").objectives["f2"]) == (1, 0)
    assert [member.sensor[1] for member in front.members] == [m.name for m in front.members]


def test_a_single_optimum_is_extreme_and_knee():
    problem = problem_of(lambda a: ([a], []), [0.0], [1.0], better=("lower",))
    values = np.array([[0.0]])
    at = problem.evaluate(values)
    (only,) = front_of(problem, values, at.objectives, at.violation).members
    assert (only.name, only.knee, only.extreme_of) == ("best-f1", True, ("f1",))


def test_a_constraint_holds_the_members_whose_slack_is_a_hundredth_of_the_largest():
    slack = np.array([0.0, 0.009, 0.011, 0.5, 1.0])
    steps = np.arange(5.0)
    problem = problem_of(lambda a: ([a, -a], []), [0.0], [4.0], constraints=("disk",))
    front = front_of(problem, steps[:, None], np.stack([steps, -steps], axis=1), -slack[:, None])
    assert [one.active for one in front.members] == [("disk",), ("disk",), (), (), ()]


@pytest.mark.parametrize(
    ("costs", "volume"),
    [
        ([[0.0, 0.0]], 1.0),
        ([[1.0, 1.0]], 0.0),
        ([[0.5, 0.5], [0.25, 0.75], [0.6, 0.6]], 0.25 + 0.25 * 0.25),
        ([[-1.0, 0.5]], 0.5),
        ([[0.5, 0.5, 0.5]], 0.125),
        ([[0.0, 0.5, 0.5], [0.5, 0.0, 0.5]], 0.25 + 0.25 - 0.125),
        ([], 0.0),
    ],
)
def test_the_hypervolume_is_that_of_the_union_of_boxes(costs, volume):
    size = len(costs[0]) if costs else 2
    points = np.array(costs).reshape(-1, size)
    assert hypervolume(points, np.zeros(size), np.ones(size)) == pytest.approx(volume)
    stretched = hypervolume(3.0 * points + 1.0, np.ones(size), np.full(size, 4.0))
    assert stretched == pytest.approx(volume)
