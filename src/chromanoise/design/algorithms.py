"""NSGA-II, NSGA-III, differential evolution and CMA-ES, one generation at a time.

Every algorithm is asked for the candidates of a generation, is told their costs, and gives its
state as arrays. Its random numbers are derived from seed and generation, so that a restored state
continues with the same digits.
"""

import math
import warnings
from importlib import util
from typing import Any, Protocol, runtime_checkable

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.design.problem import Problem
from chromanoise.errors import InputError
from chromanoise.rng import stream

State = dict[str, Array]

_FIRST_STEP = 0.25  # of CMA-ES, as a share of the range of each parameter
_DITHER = (0.5, 1.0)  # weight of a difference in differential evolution
_CONVERGED = 1e-9  # spread of a population, as a share of the range of each parameter
_RECOMBINATION = 0.7  # share of the parameters that a trial takes from the mutant


@runtime_checkable
class Algorithm(Protocol):
    """What `chromanoise.design.search` needs of a method.

    ``misses`` is the sum of the violations of a candidate, 0 if it meets all constraints. In every
    method a feasible candidate precedes an infeasible one, and of two infeasible ones that with
    the lower sum is first (Deb, 2000).
    """

    def ask(self, rng: np.random.Generator) -> Float[Array, "m d"]:
        """The candidates of the next generation; none if there are no new ones."""

    def tell(
        self,
        values: Float[Array, "m d"],
        costs: Float[Array, "m q"],
        misses: Float[Array, " m"],
        rng: np.random.Generator,
    ) -> None:
        """Select from the evaluated candidates of a generation; the first one is not asked for."""

    def state(self) -> State:
        """All that the next generation depends on."""

    def restore(self, state: State) -> None:
        """Continue from a state."""


def generation_rng(seed: int, generation: int) -> np.random.Generator:
    """The random numbers of one generation."""
    return stream(seed, generation)


def latin_hypercube(problem: Problem, count: int, rng: np.random.Generator) -> Float[Array, "m d"]:
    """Candidates of which each of ``count`` equal parts of a parameter's range has exactly one."""
    cells = rng.permuted(np.tile(np.arange(count)[:, None], (1, len(problem.names))), axis=0)
    share = (cells + rng.random(cells.shape)) / count
    return problem.allowed(problem.low + share * (problem.high - problem.low))


class Genetic:
    """NSGA-II or NSGA-III with the operators and the survival of pymoo.

    Parameters
    ----------
    problem
        Integer parameters are rounded after crossover and mutation.
    population
        Number of candidates in a generation.
    many
        Whether to use NSGA-III, whose reference directions (Das & Dennis, 1998) are as many as
        the population allows.

    Notes
    -----
    Deb, Pratap, Agarwal & Meyarivan (2002); Deb & Jain (2014); Blank & Deb, "pymoo" (2020).
    """

    def __init__(self, problem: Problem, population: int, *, many: bool) -> None:
        from pymoo.config import Config

        Config.warnings["not_compiled"] = False  # otherwise printed where pymoo was not compiled
        from pymoo.algorithms.moo.nsga3 import ReferenceDirectionSurvival
        from pymoo.core.duplicate import DefaultDuplicateElimination
        from pymoo.core.mating import Mating
        from pymoo.core.population import Population
        from pymoo.core.problem import Problem as Bounds
        from pymoo.operators.crossover.sbx import SBX
        from pymoo.operators.mutation.pm import PM
        from pymoo.operators.selection.tournament import TournamentSelection
        from pymoo.operators.survival.rank_and_crowding import RankAndCrowding

        def allowed(_: Any, candidates: Any, **__: Any) -> Any:
            candidates.set("X", problem.allowed(candidates.get("X")))
            return candidates

        count = len(problem.objectives)
        self._new, self._merged = Population.new, Population.merge
        self._size, self._many = population, many
        self._bounds = Bounds(
            n_var=len(problem.names),
            n_obj=count,
            n_ieq_constr=1,
            xl=problem.low,
            xu=problem.high,
        )
        self._survival = (
            ReferenceDirectionSurvival(_directions(count, population))
            if many
            else RankAndCrowding()
        )
        self._mating = Mating(
            TournamentSelection(func_comp=_tournament),
            SBX(eta=30, prob=1.0) if many else SBX(eta=15, prob=0.9),
            PM(eta=20),
            repair=allowed,
            eliminate_duplicates=DefaultDuplicateElimination(),
        )
        self._population: Any = None

    def ask(self, rng: np.random.Generator) -> Float[Array, "m d"]:
        """As `Algorithm.ask`."""
        found = self._mating.do(self._bounds, self._population, self._size, random_state=rng)
        return found.get("X").reshape(-1, self._bounds.n_var)

    def tell(
        self,
        values: Float[Array, "m d"],
        costs: Float[Array, "m q"],
        misses: Float[Array, " m"],
        rng: np.random.Generator,
    ) -> None:
        """As `Algorithm.tell`."""
        candidates = self._candidates(values, costs, misses, np.zeros(len(values)))
        if self._population is not None:
            candidates = self._merged(self._population, candidates)
        with warnings.catch_warnings():  # NSGA-III of pymoo changes the filters of warnings
            self._population = self._survival.do(
                self._bounds, candidates, n_survive=self._size, random_state=rng
            )

    def state(self) -> State:
        """As `Algorithm.state`; ranks are derived from the costs, the crowding is kept."""
        names = ("values", "X"), ("costs", "F"), ("misses", "G"), ("crowding", "crowding")
        state = {name: self._population.get(key) for name, key in names}
        state["misses"] = state["misses"][:, 0]
        if self._many and self._survival.norm.extreme_points is not None:
            state |= {name: getattr(self._survival.norm, name) for name in _NORMALIZATION}
        return state

    def restore(self, state: State) -> None:
        """As `Algorithm.restore`."""
        names = "values", "costs", "misses", "crowding"
        self._population = self._candidates(*(state[name] for name in names))
        for name in _NORMALIZATION:
            if name in state:
                setattr(self._survival.norm, name, state[name])

    def _candidates(self, values: Array, costs: Array, misses: Array, crowding: Array) -> Any:
        return self._new(X=values, F=costs, G=misses[:, None], crowding=crowding)


_NORMALIZATION = ("ideal_point", "worst_point", "nadir_point", "extreme_points")


def _directions(objectives: int, most: int) -> Float[Array, "k q"]:
    """As many evenly spaced reference directions as a population of ``most`` allows."""
    from pymoo.util.ref_dirs import get_reference_directions

    parts = 1
    while objectives > 1 and math.comb(parts + objectives, objectives - 1) <= most:
        parts += 1
    return get_reference_directions("das-dennis", objectives, n_partitions=parts)


def _tournament(candidates: Any, pairs: Array, random_state: Any, **_: Any) -> Array:
    """The winner of each pair: lower violation, then dominance, crowding (NSGA-II) and chance."""
    first, second = pairs.T
    miss, costs = candidates.get("CV")[:, 0], candidates.get("F")
    crowding = candidates.get("crowding").astype(float)
    below = (costs[first] <= costs[second]).all(axis=1)
    above = (costs[first] >= costs[second]).all(axis=1)
    score = np.zeros(len(pairs), dtype=int)
    for better, worse in (
        (miss[first] < miss[second], miss[first] > miss[second]),
        (below, above),
        (crowding[first] > crowding[second], crowding[first] < crowding[second]),
    ):
        score = np.where(score == 0, better.astype(int) - worse, score)
    score = np.where(score == 0, random_state.choice([-1, 1], size=len(pairs)), score)
    return np.where(score > 0, first, second)[:, None]


class DifferentialEvolution:
    """Differential evolution, best/1/bin with dither, for one objective.

    A mutant outside the bounds takes a uniform value there. A trial replaces its parent if its sum
    of violations is lower, or if the sums are equal and its cost is not higher. A population that
    has converged is replaced by a Latin hypercube.

    Notes
    -----
    Storn & Price (1997); constraints after Lampinen (2002). The strategy and its constants are the
    defaults of `scipy.optimize.differential_evolution`, which cannot be stopped and resumed
    without evaluating its population again.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem, self._kept = problem, dict[str, Array]()

    def ask(self, rng: np.random.Generator) -> Float[Array, "m d"]:
        """As `Algorithm.ask`."""
        values, problem = self._kept["values"], self._problem
        size, count = values.shape
        if (np.ptp(values, axis=0) <= _CONVERGED * (problem.high - problem.low)).all():
            self._kept = {}
            return latin_hypercube(problem, size, rng)
        best = np.lexsort((self._kept["costs"][:, 0], self._kept["misses"]))[0]
        one = rng.integers(1, size, size)  # offsets to two other candidates that differ
        other = rng.integers(1, size - 1, size)
        other += other >= one
        here = np.arange(size)
        step = values[(here + one) % size] - values[(here + other) % size]
        mutant = values[best] + rng.uniform(*_DITHER, (size, 1)) * step
        outside = (mutant < problem.low) | (mutant > problem.high)
        mutant = np.where(outside, rng.uniform(problem.low, problem.high, mutant.shape), mutant)
        taken = rng.random(values.shape) < _RECOMBINATION
        taken[here, rng.integers(0, count, size)] = True
        return problem.allowed(np.where(taken, mutant, values))

    def tell(
        self,
        values: Float[Array, "m d"],
        costs: Float[Array, "m q"],
        misses: Float[Array, " m"],
        rng: np.random.Generator,
    ) -> None:
        """As `Algorithm.tell`."""
        new = {"values": values, "costs": costs, "misses": misses}
        if not self._kept:
            self._kept = new
            return
        old = self._kept
        lower = misses < old["misses"]
        equal = (misses == old["misses"]) & (costs[:, 0] <= old["costs"][:, 0])
        wins = lower | equal
        self._kept = {
            name: np.where(wins.reshape((-1,) + (1,) * (array.ndim - 1)), array, old[name])
            for name, array in new.items()
        }

    def state(self) -> State:
        """As `Algorithm.state`."""
        return dict(self._kept)

    def restore(self, state: State) -> None:
        """As `Algorithm.restore`."""
        self._kept = dict(state)


class CovarianceMatrixAdaptation:
    """CMA-ES with active covariance update, by the package ``cma``, for one objective.

    It starts at the best candidate of the first generation, with a step of a quarter of the range
    of each parameter, and starts again at a random candidate when it has converged. Bounds are kept
    by the transformation of the package. A candidate that violates constraints is told a cost
    above that of all feasible ones of its generation, rising with its sum of violations. Its state
    is the list of the costs it was told: the generations are replayed without evaluations.

    Notes
    -----
    Hansen & Ostermeier (2001); active update: Jastrebski & Arnold (2006).
    """

    def __init__(self, problem: Problem, population: int, seed: int) -> None:
        self._problem, self._size, self._seed = problem, population, seed
        self._rng = generation_rng(seed, 0)
        self._strategy: Any = None
        self._origin = np.empty(0)
        self._asked: Any = None
        self._told: list[Array] = []

    def ask(self, rng: np.random.Generator) -> Float[Array, "m d"]:
        """As `Algorithm.ask`."""
        self._rng, count = rng, len(self._problem.names)
        if self._strategy is None or self._strategy.stop():
            origin = rng.random(count) if self._strategy is not None else self._origin
            self._strategy = self._started(origin)
        self._asked = self._strategy.ask()
        share = np.clip(self._asked, 0.0, 1.0)
        return self._problem.allowed(
            self._problem.low + share * (self._problem.high - self._problem.low)
        )

    def tell(
        self,
        values: Float[Array, "m d"],
        costs: Float[Array, "m q"],
        misses: Float[Array, " m"],
        rng: np.random.Generator,
    ) -> None:
        """As `Algorithm.tell`."""
        if not self._origin.size:
            best = np.lexsort((costs[:, 0], misses))[0]
            low, high = self._problem.low, self._problem.high
            self._origin = (values[best] - low) / (high - low)
            return
        kept = misses == 0
        worst = costs[kept, 0].max() if kept.any() else 0.0
        told = np.where(kept, costs[:, 0], worst + misses)
        self._told.append(told)
        self._strategy.tell(self._asked, told.tolist())

    def state(self) -> State:
        """As `Algorithm.state`."""
        return {"origin": self._origin, "told": np.array(self._told).reshape(-1, self._size)}

    def restore(self, state: State) -> None:
        """As `Algorithm.restore`."""
        self._origin = state["origin"]
        for generation, told in enumerate(state["told"], start=1):
            self.ask(generation_rng(self._seed, generation))
            self._told.append(told)
            self._strategy.tell(self._asked, told.tolist())

    def _started(self, origin: Float[Array, " d"]) -> Any:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of optional packages for plots
            import cma
        return cma.CMAEvolutionStrategy(
            np.clip(origin, 0.01, 0.99),
            _FIRST_STEP,
            {
                "bounds": [0.0, 1.0],
                "popsize": self._size,
                "randn": lambda *shape: self._rng.standard_normal(shape),
                "seed": np.nan,  # numpy's global generator stays as it is
                "verbose": -9,
                "verb_log": 0,
                "CMA_active": True,
            },
        )


METHODS = ("nsga2", "nsga3", "de", "cma-es")
_OF_ONE = ("de", "cma-es")
_PACKAGES = {"nsga2": "pymoo", "nsga3": "pymoo", "cma-es": "cma"}


def algorithm_of(problem: Problem, method: str, population: int, seed: int) -> Algorithm:
    """The algorithm of a name in `METHODS`.

    Raises
    ------
    InputError
        If its package is not installed, it takes one objective and the problem has several, or the
        problem has one parameter and the method is CMA-ES.
    """
    package = _PACKAGES.get(method)
    if package and util.find_spec(package) is None:
        raise InputError(
            "method",
            f"needs the package {package}, which is not installed",
            value=method,
            found=None,
            remedy=(
                "install it with pip install 'chromanoise[design]'",
                "use de for one objective",
            ),
        )
    count = len(problem.objectives)
    if method in _OF_ONE and count > 1:
        raise InputError(
            "method",
            "must be nsga2 or nsga3 for several objectives",
            value=method,
            found=f"is {method}, which takes one objective, and the design has {count}",
            remedy=("use nsga2", "make all objectives but one constraints"),
        )
    if method == "cma-es" and len(problem.names) < 2:
        raise InputError(
            "method",
            "must not be cma-es for one parameter",
            value=method,
            found=f"the only parameter is {problem.names[0]}",
            remedy="use de",
        )
    if method == "de":
        return DifferentialEvolution(problem)
    if method == "cma-es":
        return CovarianceMatrixAdaptation(problem, population, seed)
    return Genetic(problem, population, many=method == "nsga3")
