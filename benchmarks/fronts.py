"""Processor time to one hypervolume: this search, NSGA-II of pymoo, and scipy, in one run.

    python benchmarks/fronts.py [DESIGN.toml] [--limit 10] [--peers 3]

The default design (`chromanoise init --design`) with three seeds. The target is the least
hypervolume that one of our seeds alone reaches, in the box of all our fronts. The peers have the
same batched objectives, and stop at the target or at so many times our time for one seed:
`pymoo` NSGA-II with populations of 200, and `scipy.optimize.differential_evolution` (vectorized)
on the largest of the scaled costs above evenly spaced references, with a penalty for violations.
Both extremes of the references are single objectives.
"""

import argparse
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem as PymooProblem
from scipy.optimize import differential_evolution

from chromanoise.apps.design import DESIGN_STARTER, read_design, task_of
from chromanoise.apps.design.optimizing import start_of, with_constraint_sizes
from chromanoise.apps.design.pareto_front import (
    Problem,
    hypervolume,
    merged,
    misses_of,
    non_dominated,
)
from chromanoise.apps.design.search import searched_front

REFERENCES, POPULATION, BEYOND = 24, 200, 0.1
PENALTY = 10.0


class Seen:
    """The costs that no other evaluated candidate dominates."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.costs = problem, np.empty((0, len(problem.objectives)))

    def __call__(self, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Costs and violations of candidates; undefined costs are large."""
        found = self.problem.evaluate(values)
        costs = self.problem.costs(found.objectives)
        new = costs[misses_of(self.problem, found) == 0]
        kept, fresh = merged(self.costs, new)
        self.costs = np.concatenate([self.costs[kept], new[fresh]])
        return np.nan_to_num(costs, posinf=1e6), np.nan_to_num(found.violation, posinf=1e6)


def by_pymoo(seen: Seen, seed: int) -> Iterator[None]:
    """Generations of NSGA-II, without end."""
    problem = seen.problem

    class Same(PymooProblem):
        def __init__(self) -> None:
            super().__init__(
                n_var=len(problem.names),
                n_obj=len(problem.objectives),
                n_ieq_constr=len(problem.constraints),
                xl=problem.low,
                xu=problem.high,
            )

        def _evaluate(self, x: np.ndarray, out: dict, *_: object, **__: object) -> None:
            out["F"], out["G"] = seen(x)

    algorithm = NSGA2(pop_size=POPULATION)
    algorithm.setup(Same(), termination=("n_gen", 10**9), seed=seed)
    while True:
        algorithm.next()
        yield


def by_scipy(seen: Seen, seed: int, low: np.ndarray, high: np.ndarray) -> Iterator[None]:
    """Runs of differential evolution, one per reference, again and again."""
    problem, count = seen.problem, len(low)
    rng = np.random.default_rng(seed)
    alone = [np.where(np.eye(count, dtype=bool)[i], 0.0, np.inf) for i in range(count)]
    between = rng.dirichlet(np.ones(count), REFERENCES)
    while True:
        for reference in [*alone, *(1 - between)]:

            def merit(x: np.ndarray, reference: np.ndarray = reference) -> np.ndarray:
                costs, violation = seen(x.T)
                excess = ((costs - low) / (high - low) - reference).max(axis=1)
                return excess + PENALTY * np.maximum(violation, 0).sum(axis=1)

            differential_evolution(
                merit,
                list(zip(problem.low, problem.high, strict=True)),
                vectorized=True,
                updating="deferred",
                polish=False,
                rng=rng,
            )
            yield


def timed(
    work: Iterator[None],
    seen: Seen,
    volume: Callable[[np.ndarray], float],
    target: float,
    most: float,
) -> str:
    """Processor time until the target, or what was reached in ``most`` seconds."""
    start, last = time.process_time(), 0.0
    for _ in work:
        spent = time.process_time() - start
        if spent < 1.05 * last and spent < most:
            continue
        last, reached = spent, volume(seen.costs)
        best = ", ".join(f"{one:.4f}" for one in seen.costs.min(axis=0))
        if reached >= target:
            return f"{spent:.1f} s, {reached:.4f} (best costs {best})"
        if spent >= most:
            return f"not in {spent:.0f} s: {reached:.4f} (best costs {best})"
    return ""


def main() -> None:
    """Print a line for each search and seed."""
    parser = argparse.ArgumentParser()
    parser.add_argument("design", nargs="?", type=Path)
    parser.add_argument("--limit", type=float, default=10.0)
    parser.add_argument("--peers", type=int, default=3, help="seeds of the peers")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = given.design or Path(folder) / "design.toml"
        if not given.design:
            path.write_text(DESIGN_STARTER, encoding="utf-8")
        document = read_design(path)
        task = task_of(document)
    problem, search = with_constraint_sizes(task), document.design.search
    middle = 0.5 * (problem.low + problem.high)[None]
    problem.evaluate(middle)
    if problem.gradient:
        problem.gradient(middle)  # compiled
    seeds = [search.seed + i for i in range(search.seeds)]
    fronts, times = [], []
    for seed in seeds:
        alone = replace(search, seed=seed, seeds=1, budget=search.budget // search.seeds)
        start = time.process_time()
        found = searched_front(problem, alone, start=start_of(task.space.parameters))
        times.append(time.process_time() - start)
        fronts.append(problem.costs(found.objectives))
    every = np.concatenate(fronts)
    front = every[non_dominated(every)]
    low, high = front.min(axis=0), front.max(axis=0)
    reference = high + BEYOND * (high - low)

    def volume(costs: np.ndarray) -> float:
        return hypervolume(costs, low, reference)

    volumes = [volume(one) for one in fronts]
    target = min(volumes)
    for seed, one, reached, spent in zip(seeds, fronts, volumes, times, strict=True):
        best = ", ".join(f"{cost:.4f}" for cost in one.min(axis=0))
        print(f"this search, seed {seed}: {spent:.1f} s, {reached:.4f} (best costs {best})")
    print(f"target: hypervolume {target:.4f}", flush=True)
    most = given.limit * float(np.median(times))
    for seed in seeds[: given.peers]:
        seen = Seen(problem)
        print(
            f"pymoo, seed {seed}: {timed(by_pymoo(seen, seed), seen, volume, target, most)}",
            flush=True,
        )
        seen = Seen(problem)
        work = by_scipy(seen, seed, low, high)
        print(f"scipy, seed {seed}: {timed(work, seen, volume, target, most)}", flush=True)


if __name__ == "__main__":
    main()
