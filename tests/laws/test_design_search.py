"""A search finds known fronts and optima, and a stopped one continues with the same digits."""

import re
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
import scipy.optimize
from hypothesis import HealthCheck, given, settings, strategies as st
from pymoo.operators.crossover.sbx import cross_sbx
from pymoo.operators.mutation.pm import mut_pm
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

import chromanoise.apps.design.descents as descents
import chromanoise.apps.design.search as searching
from chromanoise.apps.design.algorithms import METHODS, _crossed, _fronts, _mutated
from chromanoise.apps.design.descents import _parents, improved
from chromanoise.apps.design.pareto_front import (
    LARGEST,
    Evaluated,
    Problem,
    assessed,
    non_dominated,
)
from chromanoise.apps.design.search import Progress, SearchOptions, searched_front
from chromanoise.base import packages
from chromanoise.base.errors import InputError
from chromanoise.cli import design_commands
from design_problems import bnh, bowl, dtlz2, half_plane, problem_of, rosenbrock, same, zdt1
from outcomes import refused_input

OF_ONE = "de", "cma-es"


def found(problem, method="nsga2", budget=1600, population=40, **options):
    names = {"seed", "seeds", "polish"} & set(options)
    usual = {"seed": 1, "seeds": 1, "polish": False}
    settings = usual | {name: options.pop(name) for name in names}
    return searched_front(
        problem,
        SearchOptions(method=method, budget=budget, population=population, **settings),
        **options,
    )


def watched(problem):
    """The problem, and a list of the values that it evaluates from now on."""
    seen = []

    def kept(values):
        seen.append(values)
        return problem.evaluate(values)

    return replace(problem, evaluate=kept), seen


@pytest.mark.parametrize(("method", "distance"), [("nsga2", 0.02), ("nsga3", 0.05)])
def test_the_front_of_zdt1_is_one_minus_the_root(method, distance):
    result = found(zdt1(), method, 8000, 100)
    first, second = result.objectives.T
    assert result.evaluations == 8000
    assert np.abs(second - (1 - np.sqrt(first))).max() < distance
    assert first.min() < 1e-3
    assert first.max() > 0.99
    assert np.diff(np.sort(first)).max() < 0.04


def test_the_front_of_dtlz2_is_the_unit_sphere():
    result = found(dtlz2(), "nsga3", 6000, 91)
    assert np.quantile(np.abs(np.linalg.norm(result.objectives, axis=1) - 1), 0.95) < 0.03
    assert len(result.values) > 91


def test_the_front_of_binh_and_korn_is_a_line_and_the_upper_bound():
    result = found(bnh(), budget=6000, population=100)
    a, b = result.values.T
    assert (result.violation <= 0).all()
    assert np.abs(np.where(a < 3, a - b, 3 - b)).max() < 0.4
    assert a.min() < 0.05
    assert a.max() > 4.95


@pytest.mark.parametrize("method", METHODS)
def test_every_method_finds_the_bottom_of_a_bowl_that_a_brute_force_grid_finds(method):
    problem = bowl()
    axis = np.linspace(-1, 1, 201)
    grid = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    values = problem.evaluate(grid).objectives[:, 0]
    result = found(problem, method)
    assert result.values.shape == (1, 2)
    assert result.objectives[0, 0] <= values.min() + 1e-4
    assert result.values[0] == pytest.approx(grid[values.argmin()], abs=0.01)


@pytest.mark.parametrize("method", OF_ONE)
def test_the_valley_of_rosenbrock_ends_at_one(method):
    result = found(rosenbrock(), method, 3000, 20)
    assert result.values[0] == pytest.approx([1, 1], abs=1e-5)


def test_differential_evolution_agrees_with_that_of_scipy():
    problem = problem_of(
        lambda a, b, c: (
            [30 + sum(x**2 - 10 * np.cos(2 * np.pi * x) for x in (a - 0.3, b, c))],
            [],
        ),
        [-5.0] * 3,
        [5.5] * 3,
        better=("lower",),
    )
    theirs = scipy.optimize.differential_evolution(
        lambda x: problem.evaluate(x[None]).objectives[0, 0],
        list(zip(problem.low, problem.high, strict=True)),
        rng=1,
    )
    ours = found(problem, "de", 8000, 45)
    assert ours.values[0] == pytest.approx(theirs.x, abs=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_an_active_constraint_is_reached_and_kept(method):
    result = found(half_plane(), method, 2000)
    assert (result.violation <= 0).all()
    assert result.objectives[0, 0] == pytest.approx(1.4, abs=1e-2)
    polished = found(half_plane(), method, 400, polish=True)
    assert (polished.violation <= 0).all()
    assert polished.objectives[0, 0] == pytest.approx(1.4, abs=2e-6)


@cache
def after_polish(problem):
    """The front of a known problem, by its name, after a short search."""
    return found(SHORT[problem], budget=400, polish=True)


SHORT = {"zdt1": zdt1(5), "bnh": bnh(), "dtlz2": dtlz2(5)}


@pytest.mark.parametrize("problem", SHORT)
def test_polish_makes_no_member_worse_and_the_front_better(problem):
    rough, fine = found(SHORT[problem], budget=400, polish=False), after_polish(problem)
    assert fine.gradient_evaluations > 0
    assert fine.evaluations == rough.evaluations
    assert (fine.violation <= 0).all()
    behind = fine.objectives[None] <= rough.objectives[:, None]
    lost = (fine.objectives[None] - rough.objectives[:, None]).max(axis=2).min(axis=1)
    is_full = len(fine.objectives) == LARGEST  # crowded members of a full front were dropped
    assert lost.max() <= (0.02 if is_full else 0.0)
    assert non_dominated(fine.objectives).all()
    assert (fine.objectives.min(axis=0) <= rough.objectives.min(axis=0)).all()
    better = (fine.objectives[None] < rough.objectives[:, None]).any(axis=2) & behind.all(axis=2)
    assert better.any(axis=1).sum() >= 15


def test_polish_traces_each_edge_of_a_front_of_three_objectives():
    fine = after_polish("dtlz2")
    for k in range(3):
        on_edge = np.delete(fine.objectives[fine.objectives[:, k] < 1e-3], k, axis=1)
        angle = np.sort(np.arctan2(*on_edge.T))
        assert np.diff(angle, prepend=0.0, append=np.pi / 2).max() < 0.25


def in_a_valley():
    """Lowest at (1, 1), around which Rosenbrock's function is at most 1e-6."""
    return problem_of(
        lambda a, b: ([(b - 1) ** 2], [100 * (b - a**2) ** 2 + (1 - a) ** 2 - 1e-6]),
        [-2.0, -2.0],
        [2.0, 2.0],
        better=("lower",),
        constraints=("valley",),
    )


# after two steps no descent has met the constraint; after six, one has met rows that are multiples
@pytest.mark.parametrize("steps", [2, 6])
def test_descents_that_miss_a_constraint_go_on_until_one_meets_it(monkeypatch, steps):
    monkeypatch.setattr(descents, "_ITERATIONS", steps)
    fine = found(in_a_valley(), budget=40, polish=True)
    assert fine.values[0] == pytest.approx([1.0, 1.0], abs=3e-3)
    assert not fine.convergence.failures


def test_descents_end_if_none_comes_nearer_to_constraints_that_exclude_each_other():
    apart = problem_of(
        lambda a, b: ([b], [(a - 1) ** 2 + b**2, (a + 1) ** 2 + b**2]),
        [-2.0, -2.0],
        [2.0, 2.0],
        better=("lower",),
        constraints=("at (1, 0)", "at (-1, 0)"),
    )
    problem, seen = watched(apart)
    with refused_input(subject="the constraints"):
        found(problem, budget=40_000, population=400, polish=True)
    assert sum(len(values) for values in seen) < 400_000


def test_the_front_of_all_seeds_dominates_at_least_what_each_dominates():
    own = found(bnh(), budget=400, seeds=2, polish=True).convergence
    assert own.milestones[-1].hypervolume >= max(own.hypervolumes)


def test_progress_counts_the_gradients_of_the_polish(monkeypatch):
    monkeypatch.setattr(searching, "_TOLD_EVERY_S", 0.01)
    told = []
    fine = found(bnh(), budget=400, seeds=2, polish=True, progress=told.append)
    polish = [one for one in told if one.most_gradients]
    assert {one.evaluations for one in polish} == {fine.evaluations}
    counts = [one.gradients for one in polish]
    assert counts == sorted(counts)
    assert 0 < counts[-1] <= fine.gradient_evaluations
    assert fine.gradient_evaluations < 1.5 * polish[-1].most_gradients


def test_starts_of_one_reference_are_members_far_apart():
    rng = np.random.default_rng(0)
    share = np.concatenate([0.1 * rng.random((50, 3)), 0.9 + 0.1 * rng.random((50, 3))])
    excesses = np.tile(np.sort(rng.random(100)), (200, 1))  # those of the first cluster are better
    assert set(_parents(share, excesses, rng)) == {0, 50}


def test_polish_extends_the_front_to_the_optimum_of_each_objective():
    fine = found(bnh(), budget=200, polish=True)
    assert fine.objectives.min(axis=0) == pytest.approx([0, 4], abs=1e-4)


def test_polished_members_of_zdt1_lie_on_its_front():
    fine = found(zdt1(5), budget=800, polish=True)
    first, second = fine.objectives.T
    on = np.abs(second - (1 - np.sqrt(first))) < 1e-6
    assert on.sum() >= 10  # extremes, knee and members along the front


def test_polish_keeps_a_member_where_the_gradient_is_undefined():
    def nowhere(values):
        known = rosenbrock().gradient(values)
        return replace(known, objectives_jacobian=known.objectives_jacobian * np.nan)

    rough, fine = (
        found(replace(rosenbrock(), gradient=nowhere), budget=400, polish=polish)
        for polish in (False, True)
    )
    assert (fine.objectives <= rough.objectives).all()


def test_polish_reaches_an_optimum_at_a_kink_of_a_constraint():
    problem = problem_of(
        lambda a, b: ([b + 0 * a], [np.where(a.real < 0, -a, a) - b, -b - 5]),
        [-1.0, -1.0],
        [1.0, 3.0],
        better=("lower",),
        constraints=("b at least |a|", "b at least -5"),
    )
    fine = found(problem, budget=40, polish=True)
    assert fine.objectives[0, 0] == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("together", [False, True])
def test_polish_reaches_a_corner_of_a_constraint_that_is_the_largest_of_several(together):
    slopes = np.array([[1.0, 2.0, 0.5], [-2.0, 1.0, 1.0], [0.5, -1.0, 2.0], [1.0, 1.0, -3.0]])

    def largest(*x):
        rows = np.stack([s @ np.stack(x) + 0.3 * sum(y**2 for y in x) - 1 for s in slopes])
        first = rows.real.argmax(axis=0)
        return [-sum(x)], [np.take_along_axis(rows, first[None], axis=0)[0]]

    problem = problem_of(
        largest, [-2.0] * 3, [2.0] * 3, better=("lower",), constraints=("largest",)
    )

    def apart(values):
        rows = values @ slopes.T + 0.3 * (values**2).sum(axis=1, keepdims=True) - 1
        jacobian = slopes + 0.6 * values[:, None]
        known = problem.gradient(values)
        return replace(
            known, violation=rows, violation_jacobian=jacobian, constraint=np.zeros(4, dtype=int)
        )

    wanted = scipy.optimize.minimize(
        lambda x: -x.sum(),
        np.zeros(3),
        bounds=[(-2, 2)] * 3,
        constraints={"type": "ineq", "fun": lambda x: 1 - 0.3 * x @ x - slopes @ x},
        tol=1e-12,
    )
    given = replace(problem, gradient=apart) if together else problem
    fine = found(given, budget=80, polish=True)
    most = 1e-6 if together else 0.02  # one row hides that there are others
    assert fine.objectives[0, 0] == pytest.approx(wanted.fun, abs=most)
    assert (fine.violation <= 0).all()


def test_a_correction_onto_a_constraint_stops_where_the_objective_is_undefined():
    problem = problem_of(
        lambda s, t: ([np.where(s.real < 0.4, np.inf, t)], [0.02 + (s - 0.5) ** 2 + 0 * t]),
        [0.0, 0.0],
        [1.0, 1.0],
        better=("lower",),
        constraints=("never met",),
    )
    at = np.array([[0.75, 0.5]])
    rng = np.random.default_rng(1)
    better = improved(problem, assessed(problem, at), most=50, rng=rng)
    assert np.isfinite(better.found.violation).all()


def test_only_parts_with_equal_numbers_are_exchanged():
    plain = problem_of(lambda *x: ([sum(x)], []), [0.0] * 6, [1.0] * 6, better=("lower",))
    assert plain.exchanges.shape == (0, 6)
    names = "cut.at_nm", "R.center_nm", "R.width_nm", "W.width_nm", "W.center_nm", "G.gap_nm"
    np.testing.assert_array_equal(replace(plain, names=names).exchanges, [[0, 4, 3, 2, 1, 5]])


def test_polish_finds_a_feasible_candidate_where_the_search_has_none():
    problem = problem_of(
        lambda a, b, c: (
            [a + b],
            [(a - 0.4) ** 2 + (b + 0.7) ** 2 + (c - 0.2) ** 2 - 1e-6],
        ),
        [-1.0] * 3,
        [1.0] * 3,
        better=("lower",),
        constraints=("small ball",),
    )
    with refused_input(subject="the constraints") as refused:
        found(problem, budget=40)
    assert "seed 1, no polish" in refused.value.found
    fine = found(problem, budget=40, polish=True)
    assert (fine.violation <= 0).all()
    assert fine.objectives[0, 0] == pytest.approx(-0.3 - np.sqrt(2) * 1e-3, abs=1e-4)


@pytest.mark.parametrize("error", [InputError("x0", "must be 0 to 5"), FloatingPointError("bad")])
def test_a_polish_that_fails_leaves_the_front_of_the_search_and_says_so(error):
    def failing(values):
        raise error

    rough = found(bnh(), budget=400)
    fine = found(replace(bnh(), gradient=failing), budget=400, polish=True)
    assert same(rough, fine)
    assert fine.convergence.failures == (str(error),)


def test_no_point_beyond_the_bounds_is_evaluated_by_the_polish():
    problem, seen = bnh(), []

    def kept(values, of):
        seen.append(np.atleast_2d(values))
        return of(values)

    watched = replace(
        problem,
        evaluate=lambda values: kept(values, problem.evaluate),
        gradient=lambda values: kept(values, problem.gradient),
    )
    found(watched, budget=400, polish=True)
    every = np.concatenate(seen)
    assert (every >= problem.low).all()
    assert (every <= problem.high).all()


@pytest.mark.parametrize("method", ["nsga2", "nsga3"])
def test_several_seeds_give_the_front_of_their_separate_searches_together(method):
    together = found(bnh(), method, 1200, seeds=3, seed=5)
    alone = [found(bnh(), method, 400, seed=seed) for seed in (5, 6, 7)]
    every = np.concatenate([one.objectives for one in alone])
    front = every[non_dominated(every)]
    assert sorted(map(tuple, front)) == sorted(map(tuple, together.objectives))
    own = together.convergence
    assert own.seeds == (5, 6, 7)
    np.testing.assert_array_equal(own.best, [one.objectives.min(axis=0) for one in alone])


def test_a_search_with_too_small_a_budget_for_all_seeds_has_fewer():
    own = found(bnh(), budget=80, seeds=3).convergence
    assert own.seeds == (1, 2)
    assert own.best.shape == (2, 2)


def test_the_hypervolume_over_the_evaluations_never_falls_and_the_polish_never_loses():
    own = found(zdt1(5), budget=2000, seeds=2, polish=True).convergence
    volumes = [one.hypervolume for one in own.milestones]
    assert volumes[-1] > 0.5
    assert all(np.diff(volumes) >= -0.01)  # of at most 64 members
    assert [one.evaluations for one in own.milestones] == [80, 160, 320, 640, 1280, 2000]
    assert (own.gain >= 0).all()
    worst, best = own.reference, own.milestones[-1].best
    assert (worst > best).all()


def test_a_resumed_search_has_the_polish_of_one_that_was_not_stopped(tmp_path):
    search = partial(found, bnh(), budget=480, seeds=2, polish=True)
    whole = search()
    assert whole.gradient_evaluations > 0
    for stop in (3, 11):  # in the first seed, and in the second
        file = tmp_path / f"search-{stop}.npz"
        with pytest.raises(Stopped):
            search(checkpoint=file, progress=stopping(stop))
        again = search(checkpoint=file, resume=True)
        assert same(again, whole)
        assert again.gradient_evaluations == whole.gradient_evaluations
        np.testing.assert_array_equal(again.convergence.best, whole.convergence.best)


class Stopped(KeyboardInterrupt):
    """Ctrl-C after a number of generations."""


def stopping(after):
    def progress(now):
        if now.generation == after:
            raise Stopped

    return progress


@pytest.mark.evidence
@pytest.mark.parametrize("after", [1, 7])
@pytest.mark.parametrize(
    ("problem", "method"),
    [(zdt1(4), "nsga2"), (bnh(), "nsga2"), (bnh(), "nsga3"), (dtlz2(5), "nsga3")]
    + [(problem, method) for problem in (rosenbrock(), half_plane()) for method in METHODS],
)
def test_a_search_that_was_stopped_gives_the_bits_of_one_that_was_not(
    problem, method, after, tmp_path
):
    whole = found(problem, method, 480)
    file = tmp_path / "search.npz"
    np.random.default_rng().random(5)
    with pytest.raises(Stopped):
        found(problem, method, 400, checkpoint=file, progress=stopping(after))
    assert same(found(problem, method, 480, checkpoint=file, resume=True), whole)
    assert same(found(problem, method, 480, checkpoint=file, resume=True), whole)


@pytest.mark.parametrize("method", OF_ONE)
def test_methods_that_have_converged_start_again_and_resume_with_the_same_bits(tmp_path, method):
    file, (problem, seen) = tmp_path / "search.npz", watched(bowl())
    whole = found(problem, method, 2000, 12)
    late = np.concatenate(seen)[-1000:]
    assert np.abs(late - [0.3, -0.2]).max() > 0.3
    found(bowl(), method, 1600, 12, checkpoint=file)
    assert same(found(bowl(), method, 2000, 12, checkpoint=file, resume=True), whole)


@pytest.mark.parametrize("method", METHODS)
def test_a_search_leaves_the_global_random_numbers_and_warnings_alone(method):
    before = np.random.get_state()[1].copy()  # noqa: NPY002
    found(bowl(), method, 200)
    assert (np.random.get_state()[1] == before).all()  # noqa: NPY002


@pytest.mark.parametrize("method", METHODS)
def test_the_budget_is_never_exceeded_and_seeds_differ(method):
    problem, seen = watched(half_plane())
    one = found(problem, method, 439)
    assert sum(map(len, seen)) == one.evaluations == 400
    assert not same(one, found(half_plane(), method, 439, seed=2))
    assert same(one, found(half_plane(), method, 439))


def test_the_front_is_that_of_all_candidates_ever_evaluated():
    problem, seen = watched(bnh())
    result = found(problem, budget=600)
    values = np.concatenate(seen)
    every = bnh().evaluate(values)
    feasible = (every.violation <= 0).all(axis=1)
    front = every.objectives[feasible][non_dominated(every.objectives[feasible])]
    assert sorted(map(tuple, front)) == sorted(map(tuple, result.objectives))


def test_a_front_has_at_most_a_thousand_members_and_keeps_its_ends(monkeypatch):
    # all candidates of a segment are on the front
    segment = problem_of(lambda a: ([a, -a], []), [0.0], [1.0])
    seen = []
    result = found(segment, budget=5000, population=500, progress=seen.append)
    assert len(result.values) == 1000
    assert max(len(now.values) for now in seen) <= 2000
    ends = result.objectives[:, 0]
    assert ends.max() - ends.min() > 0.999


@pytest.mark.parametrize("method", METHODS)
def test_given_values_join_the_first_generation(method):
    problem, seen = watched(rosenbrock())
    result = found(problem, method, 120, start=np.array([[1.0, 1.0], [-1.5, 0.25]]))
    assert (seen[0][:2] == [[1, 1], [-1.5, 0.25]]).all()
    assert result.objectives[0, 0] == 0


@pytest.mark.parametrize("method", METHODS)
def test_integer_parameters_take_whole_numbers_within_the_bounds(method):
    problem = replace(
        problem_of(
            lambda a, b: ([(a - 2.6) ** 2 + (b - 0.4) ** 2], []),
            [0.5, -1.0],
            [7.5, 1.0],
            better=("lower",),
        ),
        integer=("x0",),
    )
    problem, seen = watched(problem)
    result = found(problem, method)
    assert result.values[0] == pytest.approx([3, 0.4], abs=0.01)
    assert set(np.concatenate(seen)[:, 0]) <= set(range(1, 8))


def test_a_space_of_few_choices_ends_when_all_were_tried():
    few = replace(problem_of(lambda a: ([a, -a], []), [0.0], [5.0]), integer=("x0",))
    result = found(few, budget=100_000, population=20)
    assert sorted(result.values[:, 0]) == [0, 1, 2, 3, 4, 5]


@pytest.mark.parametrize("method", METHODS)
def test_a_feasible_region_of_a_ten_thousandth_of_the_space_is_found(method):
    problem = problem_of(
        lambda a, b: ([a], [(a - 0.4) ** 2 + (b + 0.7) ** 2 - 0.01**2]),
        [-1.0, -1.0],
        [1.0, 1.0],
        better=("lower",),
        constraints=("small disk",),
    )
    result = found(problem, method, 2000, 20)
    assert (result.violation <= 0).all()
    assert result.objectives[0, 0] == pytest.approx(0.39, abs=0.006)


@pytest.mark.parametrize("method", METHODS)
def test_saturated_candidates_are_never_members(method):
    def saturated(values):
        known = rosenbrock().evaluate(values)
        return replace(known, objectives=np.where(values[:, :1] > 0.5, np.inf, known.objectives))

    result = found(replace(rosenbrock(), evaluate=saturated, gradient=None), method)
    assert result.values[0, 0] <= 0.5
    assert result.objectives[0, 0] == pytest.approx(0.25, abs=0.05)


def of_one_parameter():
    return problem_of(lambda a: ([a], []), [0.0], [1.0], better=("lower",))


@pytest.mark.parametrize(
    ("make", "fields", "expected"),
    [
        (SearchOptions, {"method": "nsga4"}, {"subject": "method"}),
        (SearchOptions, {"budget": 50, "population": 100}, {"subject": "budget"}),
        (SearchOptions, {"population": 3}, {"subject": "population"}),
        (SearchOptions, {"seed": -1}, {"subject": "seed"}),
        (SearchOptions, {"seeds": 0}, {"subject": "seeds"}),
        (bnh, {"names": ()}, {"subject": "the design"}),
        (bnh, {"objectives": (), "better": ()}, {"subject": "the design"}),
        (bnh, {"names": ("a", "a")}, {"subject": "names of parameters"}),
        (bnh, {"low": np.array([0.0, 3.0])}, {"subject": "x1"}),
        (bnh, {"low": np.array([0.0, np.nan])}, {"subject": "Problem.low"}),
        (bnh, {"better": ("lower", "least")}, {"subject": "better"}),
        (bnh, {"integer": ("y",)}, {"subject": "integer parameters"}),
        (found, {"problem": of_one_parameter(), "method": "cma-es"}, {"value": "cma-es"}),
        (found, {"problem": zdt1(), "method": "de"}, {"value": "de"}),
        (found, {"problem": zdt1(), "method": "cma-es"}, {"value": "cma-es"}),
        (
            found,
            {"problem": rosenbrock(), "start": np.array([[1.0, 1.0], [1.0, 2.5]])},
            {"subject": "start", "value": 2.5, "where": "candidate 2", "requirement": "x1"},
        ),
        (
            found,
            {"problem": replace(bowl(), gradient=None), "polish": True},
            {"subject": "polish", "setting": "polish"},
        ),
    ],
)
def test_what_cannot_be_searched_is_one_sentence(make, fields, expected):
    with refused_input(**expected):
        replace(bnh(), **fields) if make is bnh else make(**fields)


@pytest.mark.parametrize(
    ("method", "problem"),
    [("nsga3", bowl()), ("cma-es", bowl()), ("nsga2", dtlz2())],
    ids=["nsga3", "cma-es", "three objectives"],
)
def test_a_missing_package_is_one_sentence(method, problem, monkeypatch):
    monkeypatch.setattr(packages, "find_spec", lambda _: None)
    with refused_input(subject="method", value=method, requirement="not installed"):
        found(problem, method)
    found(bowl(), "de")
    found(zdt1(), "nsga2", 80)


def test_differential_evolution_takes_a_single_parameter():
    assert found(of_one_parameter(), "de").objectives[0, 0] == pytest.approx(0, abs=1e-6)


def test_an_evaluation_that_is_nan_is_one_sentence_with_the_candidate():
    def spoiled(values):
        known = bnh().evaluate(values)
        violation = known.violation.copy()
        violation[3, 1] = np.nan
        return Evaluated(objectives=known.objectives, violation=violation)

    with refused_input(subject="the constraint c2") as refused:
        found(replace(bnh(), evaluate=spoiled))
    assert "x0 = " in refused.value.found


def contradiction(low, high):
    return problem_of(
        lambda a, b: ([a], [low - a, a - high, b - 5]),
        [0.0, 0.0],
        [1.0, 1.0],
        better=("lower",),
        constraints=("a at least", "a at most", "b at most 5"),
    )


def test_a_constraint_that_no_candidate_meets_is_named_with_its_distance():
    with refused_input(subject="the constraints", value=("a at least",)) as refused:
        found(contradiction(3.0, 9.0))
    assert "a at least by 2" in refused.value.found


def test_constraints_that_exclude_each_other_are_named_with_the_nearest_miss():
    problem, seen = watched(contradiction(0.8, 0.2))
    with refused_input(subject="the constraints", value=("a at least", "a at most")) as refused:
        found(problem, "de")
    violation = contradiction(0.8, 0.2).evaluate(np.concatenate(seen)).violation
    nearest = violation[np.maximum(violation, 0).sum(axis=1).argmin()]
    for amount in nearest[:2]:
        assert f"by {amount:.3g}" in refused.value.found


def test_objectives_that_are_undefined_everywhere_are_one_sentence():
    def undefined(values):
        return Evaluated(
            objectives=np.full((len(values), 1), np.inf), violation=np.empty((len(values), 0))
        )

    with refused_input(subject="the objectives"):
        found(replace(bowl(), evaluate=undefined))


@pytest.mark.parametrize(
    ("changed", "requirement"),
    [
        ({"seed": 2}, "seed"),
        ({"population": 50}, "population"),
        ({"method": "nsga3"}, "method"),
        ({"seeds": 2}, "seeds"),
        ({"polish": True}, "polish"),
        ({"problem": replace(bnh(), identity="other")}, "identity"),
        ({"problem": replace(bnh(), high=np.array([5.0, 2.9]))}, "bounds"),
        ({"start": np.array([[1.0, 1.0]])}, "first generation"),
        ({"problem": replace(bnh(), evaluate=half_plane().evaluate)}, ""),
    ],
)
def test_a_checkpoint_of_another_search_is_one_sentence(changed, requirement, tmp_path):
    file = tmp_path / "search.npz"
    found(bnh(), budget=200, checkpoint=file)
    again = {"problem": bnh(), "budget": 400} | changed
    if not requirement:
        again["problem"] = replace(
            bnh(), evaluate=lambda values: bnh().evaluate(values + np.float64(1e-3))
        )
    with refused_input(subject=str(file), requirement=requirement):
        found(**again, checkpoint=file, resume=True)


def test_a_smaller_budget_than_that_of_the_checkpoint_is_one_sentence(tmp_path):
    file = tmp_path / "search.npz"
    found(bnh(), budget=200, checkpoint=file)
    with refused_input(subject="budget", value=160, setting="budget"):
        found(bnh(), budget=160, checkpoint=file, resume=True)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"chromanoise", None, "half"])
def test_a_damaged_checkpoint_is_one_sentence(content, tmp_path):
    file = tmp_path / "search.npz"
    found(bnh(), budget=200, checkpoint=file)
    if content is None:
        file.unlink()
    else:
        whole = file.read_bytes()
        file.write_bytes(whole[: len(whole) // 2] if content == "half" else content)
    with refused_input(subject=str(file)):
        found(bnh(), budget=200, checkpoint=file, resume=True)


@given(st.data())
@settings(max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_checkpoint_in_which_one_byte_was_changed_is_one_sentence(tmp_path, data):
    file = tmp_path / "search.npz"
    if not file.exists():
        found(bnh(), budget=200, checkpoint=file)
        (tmp_path / "whole").write_bytes(file.read_bytes())
    content = bytearray((tmp_path / "whole").read_bytes())
    at = data.draw(st.integers(0, len(content) - 1))
    content[at] ^= data.draw(st.integers(1, 255))
    file.write_bytes(content)
    with refused_input(subject=str(file)):
        found(bnh(), budget=200, checkpoint=file, resume=True)


def test_the_checkpoint_is_written_every_few_seconds(tmp_path, monkeypatch):
    monkeypatch.setattr(searching, "_WRITTEN_EVERY_S", -1.0)
    written = []
    monkeypatch.setattr(searching, "write_checkpoint", lambda path, now: written.append(now))
    found(bnh(), budget=200, checkpoint=tmp_path / "search.npz")
    assert [now.evaluations for now in written] == [40, 80, 120, 160, 200, 200]


def test_a_problem_is_frozen():
    assert isinstance(bnh(), Problem)
    with pytest.raises(ValueError, match="read-only"):
        bnh().low[0] = 1


@pytest.mark.parametrize("method", ["nsga2", "nsga3", "de", "cma-es"])
def test_the_unit_of_a_constraint_does_not_change_the_search(method):
    objectives = 1 if method in ("de", "cma-es") else 2

    def problem(unit, **sizes):
        def evaluate(values):
            found = bnh().evaluate(values)
            return Evaluated(
                objectives=found.objectives[:, :objectives],
                violation=(found.violation + np.array([20.0, 30.0]))
                * np.array([unit, 1.0]),  # most are infeasible
            )

        return replace(
            bnh(), evaluate=evaluate, objectives=("f1", "f2")[:objectives],
            better=("lower",) * objectives, gradient=None, **sizes,
        )  # fmt: skip

    settings = SearchOptions(method=method, budget=400, population=20, seeds=1)
    found = searched_front(problem(1.0), settings)
    scaled = searched_front(problem(1024.0, constraint_sizes=(1024.0, 1.0)), settings)
    np.testing.assert_array_equal(scaled.values, found.values)
    np.testing.assert_array_equal(scaled.violation, found.violation * [1024.0, 1.0])


@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 8))
def test_with_the_same_random_numbers_pairs_cross_and_mutate_as_in_pymoo(seed, count):
    rng = np.random.default_rng(seed)
    low = rng.normal(scale=100.0, size=count)
    high = low + rng.choice([0.0, 1.0, 50.0], size=count, p=[0.1, 0.3, 0.6])
    parents = low + (high - low) * rng.random((2, 30, count))
    parents[1, :3] = parents[0, :3]  # equal ones are not crossed
    half, rate = np.full((30, 1), 0.5), min(0.5, 1 / count)
    again = partial(np.random.default_rng, seed)
    crossed = cross_sbx(
        parents.copy(), low, high, np.full((30, 1), 15.0), half, half, random_state=again()
    )
    np.testing.assert_array_equal(_crossed(parents, low, high, 15.0, again()), crossed)
    mutated = mut_pm(
        *(parents[0], low, high, np.full(30, 20.0), np.full(30, rate), False), random_state=again()
    )
    np.testing.assert_array_equal(_mutated(parents[0], low, high, rate, again()), mutated)


@given(seed=st.integers(0, 2**32 - 1), objectives=st.integers(1, 4), enough=st.integers(1, 60))
def test_candidates_are_ranked_as_in_pymoo(seed, objectives, enough):
    costs = np.random.default_rng(seed).integers(0, 6, (50, objectives)).astype(float)
    ranked = NonDominatedSorting().do(costs, n_stop_if_ranked=enough)
    for ours, theirs in zip(_fronts(costs, enough), ranked, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_a_search_estimates_its_time_from_what_it_did_after_its_preparation(monkeypatch, capsys):
    told = design_commands._reporter(("f1",))
    none = np.empty((0, 1))
    for at_s, done, gradients, most in (
        (0, 100, 0, 0),
        (20, 100, 0, 0),
        (40, 300, 0, 0),
        (60, 500, 0, 900),  # the polish compiles
        (160, 500, 0, 900),
        (170, 500, 100, 900),
        (190, 500, 300, 900),
    ):
        monkeypatch.setattr(design_commands.time, "monotonic", lambda at_s=at_s: 1e6 + at_s)
        told(
            Progress(
                generation=1,
                evaluations=done,
                budget=500,
                values=none,
                objectives=none,
                gradients=gradients,
                most_gradients=most,
            )
        )
    lines = capsys.readouterr().err.splitlines()
    assert [re.search(r"about ([\d.]+ \w+) left", line)[1] for line in lines] == ["40 s", "60 s"]
