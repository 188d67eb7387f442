"""Search algorithms: NSGA-II, NSGA-III, differential evolution, CMA-ES, and gradient descent.

Each of the first four returns the candidates of a generation (`ask`), takes their costs (`tell`),
and returns its state as arrays. Its random numbers are derived from seed and generation, so that a
restored state continues with the same digits.

`improved` improves a candidate by exact gradients under the constraints. It repeats short runs of
SLSQP in a box around the best point so far. After each run it evaluates points between the start
and the end of the run, because an evaluation costs much less than a gradient, and moves the end
onto the constraints that it breaks by little. The box shrinks where the linearizations are poor. A
constraint on the least of several distances is a constraint on each distance within reach, because
the least one has kinks.
"""

import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any, Protocol, runtime_checkable

import numpy as np

from chromanoise.apps.design.pareto_front import (
    MOST_WITHOUT_PYMOO,
    Evaluated,
    Problem,
    checked_evaluation,
    crowding,
    extremes,
    knee,
    misses_of,
    non_dominated,
    thinned,
)
from chromanoise.base import (
    Array,
    Bool,
    Float,
    InputError,
    Int64,
    lstsq,
    refuse_absent_package,
    stream,
)

State = dict[str, Array]

_FIRST_STEP = 0.25  # of CMA-ES, as a share of the range of each parameter
_ATTEMPTS = 100  # times that a generation is completed after duplicates were removed
_CROSSED, _MUTATED = 0.9, 0.9  # shares of pairs and of children, as in NSGA-II of pymoo
_MUTATION = 20.0  # index of the polynomial
_ALIKE_PARENTS = 1e-14  # parameters that differ by less are not crossed
_NORMALIZATION = ("ideal_point", "worst_point", "nadir_point", "extreme_points")
_DITHER = (0.5, 1.0)  # weight of a difference in differential evolution
_CONVERGED = 1e-9  # spread of a population, as a share of the range of each parameter
_RECOMBINATION = 0.7  # share of the parameters that a trial takes from the mutant


@runtime_checkable
class Algorithm(Protocol):
    """What `chromanoise.apps.design.search` needs of a method.

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
    """NSGA-II, or NSGA-III with the reference directions of the package ``pymoo``.

    Both cross candidates by simulated binary crossover and mutate them by polynomials.

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
    Deb, Pratap, Agarwal & Meyarivan (2002); Deb & Jain (2014). With the same random numbers, the
    operators give the digits of those of Blank & Deb, "pymoo" (2020).
    """

    def __init__(self, problem: Problem, population: int, *, many: bool) -> None:
        self._problem, self._size = problem, population
        self._kept = dict[str, Array]()
        self._many = many
        self._niches: Any = _niches(len(problem.objectives), population) if many else None

    def ask(self, rng: np.random.Generator) -> Float[Array, "m d"]:
        """As `Algorithm.ask`."""
        seen = {row.tobytes() for row in self._kept["values"]}
        found: list[Array] = []
        for _ in range(_ATTEMPTS):
            for row in self._children(self._size - len(found), rng):
                if (key := row.tobytes()) not in seen:
                    seen.add(key)
                    found.append(row)
            if len(found) == self._size:
                break
        return np.array(found).reshape(-1, len(self._problem.names))

    def _children(self, count: int, rng: np.random.Generator) -> Array:
        low, high, d = self._problem.low, self._problem.high, len(self._problem.names)
        matings = -(-count // 2)
        values = self._kept["values"]
        parents = values[self._winners(2 * matings, rng)].reshape(2, matings, d)
        eta, share = (30.0, 1.0) if self._many else (15.0, _CROSSED)
        crossed = _crossed(parents, low, high, eta, rng)
        pairs = np.where(rng.random((matings, 1)) < share, crossed, parents)
        children = pairs.reshape(-1, d)[:count]
        mutated = _mutated(children, low, high, min(0.5, 1 / d), rng)
        chosen = np.where(rng.random((count, 1)) < _MUTATED, mutated, children)
        return self._problem.allowed(chosen)

    def _winners(self, count: int, rng: np.random.Generator) -> Array:
        """Winners of pairs: lower violation, then dominance, crowding (NSGA-II) and chance."""
        size = len(self._kept["values"])
        rounds = -(-2 * count // size)
        drawn = np.concatenate([rng.permutation(size) for _ in range(rounds)])[: 2 * count]
        first, second = drawn.reshape(-1, 2).T
        costs, misses, distance = (self._kept[name] for name in ("costs", "misses", "crowding"))
        score = np.zeros(count, dtype=int)
        for better, worse in (
            (misses[first] < misses[second], misses[first] > misses[second]),
            (
                _nowhere_above(costs[first], costs[second]),
                _nowhere_above(costs[second], costs[first]),
            ),
            (distance[first] > distance[second], distance[first] < distance[second]),
        ):
            score = np.where(score == 0, better.astype(int) - worse, score)
        score = np.where(score == 0, rng.choice([-1, 1], size=count), score)
        return np.where(score > 0, first, second)

    def tell(
        self,
        values: Float[Array, "m d"],
        costs: Float[Array, "m q"],
        misses: Float[Array, " m"],
        rng: np.random.Generator,
    ) -> None:
        """As `Algorithm.tell`."""
        new = {
            "values": values,
            "costs": costs,
            "misses": misses,
            "crowding": np.zeros(len(misses)),
        }
        if self._kept:
            new = {name: np.concatenate([self._kept[name], array]) for name, array in new.items()}
        feasible = np.flatnonzero(new["misses"] == 0)
        best = feasible[:0]
        if feasible.size:
            select = self._nearest if self._many else self._crowded
            places, distance = select(new["costs"][feasible], rng)
            best = feasible[places]
            new["crowding"][best] = distance
        order = np.argsort(new["misses"], kind="stable")
        rest = order[feasible.size :][: self._size - best.size]
        chosen = np.concatenate([best, rest])
        self._kept = {name: array[chosen] for name, array in new.items()}

    def _crowded(self, costs: Array, rng: np.random.Generator) -> tuple[Array, Array]:
        """Survivors of NSGA-II by rank and crowding, and their crowding distance."""
        chosen: list[int] = []
        distance = np.zeros(len(costs))
        for front in _fronts(costs, self._size):
            distance[front] = crowding(costs[front])
            room = self._size - len(chosen)
            order = np.lexsort((rng.random(front.size), -distance[front]))
            chosen += (front if front.size <= room else front[order[:room]]).tolist()
        return np.array(chosen), distance[chosen]

    def _nearest(self, costs: Array, rng: np.random.Generator) -> tuple[Array, Array]:
        """Survivors of NSGA-III by the reference directions; crowding is not used."""
        every = _Costs(costs, np.arange(len(costs)))
        with warnings.catch_warnings():  # pymoo changes the filters of warnings
            kept = self._niches._do(None, every, min(self._size, len(costs)), random_state=rng)
        return kept.places, np.zeros(kept.places.size)

    def state(self) -> State:
        """As `Algorithm.state`; ranks are derived from the costs, the crowding is kept."""
        if not self._many or self._niches.norm.extreme_points is None:
            return dict(self._kept)
        norm = self._niches.norm
        return self._kept | {name: getattr(norm, name) for name in _NORMALIZATION}

    def restore(self, state: State) -> None:
        """As `Algorithm.restore`."""
        self._kept = {name: array for name, array in state.items() if name not in _NORMALIZATION}
        for name in set(_NORMALIZATION) & set(state):
            setattr(self._niches.norm, name, state[name])


class _Costs:
    """The population that the survival of NSGA-III in pymoo reads: costs and indices."""

    def __init__(self, costs: Array, places: Array) -> None:
        self._costs, self.places = costs, places

    def __len__(self) -> int:
        return self.places.size

    def __getitem__(self, index: Any) -> "_Costs":
        return _Costs(self._costs, self.places[np.asarray(index, dtype=int)])

    def get(self, _: str) -> Array:
        return self._costs[self.places]

    def set(self, *_: Any) -> None:
        """Rank and niche are not used later."""


def _nowhere_above(one: Float[Array, "m q"], other: Float[Array, "m q"]) -> Bool[Array, " m"]:
    return np.all(one <= other, axis=1)


def _crossed(
    parents: Float[Array, "2 m d"],
    low: Float[Array, " d"],
    high: Float[Array, " d"],
    eta: float,
    rng: np.random.Generator,
) -> Float[Array, "2 m d"]:
    """Two children of each pair, by simulated binary crossover within the bounds.

    Deb & Agrawal, Complex Systems 9 (1995), with index ``eta``; half of the parameters are crossed.
    """
    chosen = rng.random(parents[0].shape) < 0.5
    chosen &= (np.abs(parents[0] - parents[1]) > _ALIKE_PARENTS) & (low != high)
    one, other = parents[:, chosen]
    below, above = np.minimum(one, other), np.maximum(one, other)
    lowest, highest = (np.broadcast_to(end, chosen.shape)[chosen] for end in (low, high))
    drawn, between = rng.random(one.size), above - below

    def spread(room: Array) -> Array:
        alpha = 2.0 - (1.0 + 2.0 * room / between) ** -(eta + 1.0)
        part = drawn * alpha
        return np.where(drawn <= 1.0 / alpha, part, 1.0 / (2.0 - part)) ** (1.0 / (eta + 1.0))

    lower = 0.5 * ((below + above) - spread(below - lowest) * between)
    upper = 0.5 * ((below + above) + spread(highest - above) * between)
    is_swapped = rng.random(one.size) < 0.5
    children = parents.copy()
    children[0, chosen] = np.where(is_swapped, upper, lower)
    children[1, chosen] = np.where(is_swapped, lower, upper)
    return np.clip(children, low, high)


def _mutated(
    values: Float[Array, "m d"],
    low: Float[Array, " d"],
    high: Float[Array, " d"],
    rate: float,
    rng: np.random.Generator,
) -> Float[Array, "m d"]:
    """Candidates with a share ``rate`` of their parameters moved, by polynomial mutation.

    Deb & Goyal, Computer Science and Informatics 26 (1996), with an index of 20.
    """
    chosen = (rng.random(values.shape) < rate) & (low != high)
    lowest, span = (np.broadcast_to(one, chosen.shape)[chosen] for one in (low, high - low))
    own = values[chosen]
    drawn = rng.random(own.size)
    is_up = drawn > 0.5
    room = np.where(is_up, (lowest + span) - own, own - lowest) / span
    power = (1.0 - room) ** (_MUTATION + 1.0)
    left = np.where(is_up, 2.0 * (1.0 - drawn), 2.0 * drawn)
    moved = (left + np.abs(1.0 - 2.0 * drawn) * power) ** (1.0 / (_MUTATION + 1.0)) - 1.0
    found = values.copy()
    found[chosen] = own + np.where(is_up, -moved, moved) * span
    return np.clip(found, low, high)


def _fronts(costs: Float[Array, "m q"], enough: int) -> list[Array]:
    """Candidates that none dominates, then those that only these dominate, until there are enough.

    Deb, Pratap, Agarwal & Meyarivan (2002); equal candidates are in one front.
    """
    below = np.logical_and.reduce([one[:, None] <= one for one in costs.T])
    dominates = below & ~below.T
    above = np.count_nonzero(dominates, axis=0)
    fronts: list[Array] = []
    while sum(map(len, fronts)) < min(enough, len(costs)):
        front = np.flatnonzero(above == 0)
        fronts.append(front)
        above -= np.count_nonzero(dominates[front], axis=0)
        above[front] = -1
    return fronts


def _niches(objectives: int, population: int) -> Any:
    """The survival of NSGA-III in pymoo."""
    from pymoo.config import Config

    Config.warnings["not_compiled"] = False  # otherwise printed where pymoo was not compiled
    from pymoo.algorithms.moo.nsga3 import ReferenceDirectionSurvival

    return ReferenceDirectionSurvival(_directions(objectives, population))


def _directions(objectives: int, most: int) -> Float[Array, "k q"]:
    """As many evenly spaced reference directions as a population of ``most`` allows."""
    from pymoo.util.ref_dirs import get_reference_directions

    parts = 1
    while objectives > 1 and math.comb(parts + objectives, objectives - 1) <= most:
        parts += 1
    return get_reference_directions("das-dennis", objectives, n_partitions=parts)


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
    by the transformation of the package. A candidate that violates constraints gets a cost
    above that of all feasible ones of its generation, rising with its sum of violations. Its state
    is the list of all costs so far: the generations are replayed without evaluations.

    Notes
    -----
    Hansen & Ostermeier (2001); active update: Jastrebski & Arnold (2006).
    """

    def __init__(self, problem: Problem, population: int, seed: int) -> None:
        self._problem, self._size, self._seed = problem, population, seed
        self._rng = generation_rng(seed, 0)
        self._strategy: Any = None
        self._origin = np.empty(0)
        self._candidates: Any = None
        self._penalized, self._count = np.empty((64, population)), 0

    def ask(self, rng: np.random.Generator) -> Float[Array, "m d"]:
        """As `Algorithm.ask`."""
        self._rng, count = rng, len(self._problem.names)
        if self._strategy is None or self._strategy.stop():
            origin = rng.random(count) if self._strategy is not None else self._origin
            self._strategy = self._started(origin)
        self._candidates = self._strategy.ask()
        share = np.clip(self._candidates, 0.0, 1.0)
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
        penalized = np.where(kept, costs[:, 0], worst + misses)
        self._update(penalized)

    def _update(self, penalized: Float[Array, " m"]) -> None:
        if self._count == len(self._penalized):
            self._penalized = np.concatenate([self._penalized, np.empty_like(self._penalized)])
        self._penalized[self._count] = penalized
        self._count += 1
        self._strategy.tell(self._candidates, penalized.tolist())

    def state(self) -> State:
        """As `Algorithm.state`."""
        return {"origin": self._origin, "penalized": self._penalized[: self._count]}

    def restore(self, state: State) -> None:
        """As `Algorithm.restore`."""
        self._origin = state["origin"]
        for generation, penalized in enumerate(state["penalized"], start=1):
            self.ask(generation_rng(self._seed, generation))
            self._update(penalized)

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


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchMethod:
    """A method of the search.

    Attributes
    ----------
    algorithm
        From problem, population and seed to the algorithm.
    package
        The optional package that it needs; ``None`` for none.
    of_several
        Whether it takes several objectives.
    least_parameters
        Fewest parameters of a problem.
    """

    algorithm: Callable[[Problem, int, int], Algorithm]
    package: str | None = None
    of_several: bool = False
    least_parameters: int = 1


METHODS: Mapping[str, SearchMethod] = {
    "nsga2": SearchMethod(
        algorithm=lambda problem, population, _: Genetic(problem, population, many=False),
        of_several=True,
    ),
    "nsga3": SearchMethod(
        algorithm=lambda problem, population, _: Genetic(problem, population, many=True),
        package="pymoo",
        of_several=True,
    ),
    "de": SearchMethod(algorithm=lambda problem, _, __: DifferentialEvolution(problem)),
    "cma-es": SearchMethod(
        algorithm=CovarianceMatrixAdaptation,
        package="cma",
        least_parameters=2,  # of the package
    ),
}
"""Methods of the search by the names that a design gives them."""
OF_SEVERAL = tuple(name for name, one in METHODS.items() if one.of_several)
"""Names of the methods for several objectives."""
OF_ONE = tuple(name for name in METHODS if name not in OF_SEVERAL)
"""Names of the methods for one objective only."""


def algorithm_of(problem: Problem, method: str, population: int, seed: int) -> Algorithm:
    """The algorithm of a name in `METHODS`.

    Parameters
    ----------
    method
        A name in `METHODS`.
    seed
        Of the random numbers.

    Raises
    ------
    InputError
        As `refuse_method`.
    """
    refuse_method(problem, method)
    return METHODS[method].algorithm(problem, population, seed)


def refuse_method(problem: Problem, method: str) -> None:
    """Refuse a method in `METHODS` that cannot search a problem.

    Parameters
    ----------
    method
        A name in `METHODS`.

    Raises
    ------
    InputError
        If its package is not installed, it takes one objective and the problem has several, or the
        problem has too few parameters for it.
    """
    chosen, count = METHODS[method], len(problem.objectives)
    if count > 1 and not chosen.of_several:
        raise InputError(
            "method",
            f"must be {' or '.join(OF_SEVERAL)} for several objectives",
            value=method,
            found=f"is {method}, which takes one objective, and the design has {count}",
            remedy=(f"use {OF_SEVERAL[0]}", "make all objectives but one constraints"),
        )
    package = "pymoo" if count > MOST_WITHOUT_PYMOO else chosen.package
    if package:
        refuse_absent_package(
            package,
            "method",
            extra="design",
            value=method,
            otherwise=("use de for one objective", "use nsga2 for two objectives"),
        )
    if len(problem.names) < chosen.least_parameters:
        raise InputError(
            "method",
            f"must not be {method} for one parameter",
            value=method,
            found=f"the only parameter is {problem.names[0]}",
            remedy="use de",
        )


_RADIUS, _LARGEST_RADIUS, _LEAST_RADIUS = 0.2, 0.3, 1e-5  # of the box, as shares of the ranges
_ITERATIONS = 40  # of one run of SLSQP
_PRECISION = 1e-10  # of one run
_GAIN = 1e-6  # of the scale of the costs; a descent ends when several runs gain less
_SMALL_GAINS = 3
_MARGIN = 1e-7  # kept from each constraint, because SLSQP meets it within rounding only
_STEPS = np.array(
    [1, 0.999, 0.99, 0.97, 0.94, 0.9, 0.85, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1, 0.05, 0.02]
)
_REACH = 3.0  # times the change of a row within the box by its slope: rows that a run can reach
_REMEMBERED = 4  # linearizations: SLSQP asks for the parts of the last points again
_CORRECTIONS = 6  # Newton steps onto the constraints
_BREACH, _ACTIVE = 0.05, 5e-5  # a row that is broken by more is not corrected; above -5e-5, active
_PER_DESCENT = 600  # gradients
_STARTS = 8  # members along the front, and candidates far apart in the parameters
_AGREEING = 3  # ends of descents of one objective that must agree
_ALIKE = 1e-3  # of the scale of the costs, within which two ends agree


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Improved:
    """The final candidates of the descents, with their evaluation without gradients.

    Attributes
    ----------
    values, found
        One row per descent, feasible or not.
    gradients
        Number of gradients that were computed.
    """

    values: Float[Array, "k d"]
    found: Evaluated
    gradients: int


def improved(
    problem: Problem, values: Float[Array, "m d"], found: Evaluated, *, most: int
) -> Improved:
    """Candidates that are better than the given ones, or nearer to meeting the constraints.

    Each objective is minimized alone, first from its best candidate, then from candidates along the
    front and candidates with distant parameters, until three descents reach the same value.
    Alternating with these descents, the sum of the scaled costs is minimized from the knee and from
    members along the front, under the constraint that no cost rises (Benson, 1978). If no candidate
    is feasible, the sum of the violations is minimized.

    Parameters
    ----------
    problem
        A problem with gradients. Integer parameters keep their values.
    values, found
        Evaluated candidates, at least one.
    most
        Number of gradients after which no further descent begins.
    """
    costs, misses = problem.costs(found.objectives), misses_of(problem, found)
    count = len(problem.objectives)
    scale = _scale(costs[misses == 0])
    gradients, ends = 0, [values[int(np.argmin(misses))]]
    lowest, agreeing = np.full(count, np.inf), np.zeros(count, dtype=int)
    for start, alone in _tasks(problem, values, costs, misses):
        if gradients >= most:
            break
        if alone is not None and agreeing[alone] >= _AGREEING:
            continue
        weights = np.ones(count) if alone is None else np.eye(count)[alone]
        bounded = alone is None and misses[start] == 0
        descent = _Descent(
            problem, values[start], weights, costs[start] if bounded else None, scale
        )
        ends.append(descent.end())
        gradients += descent.gradients
        if alone is not None:
            cost = problem.costs(problem.evaluate(ends[-1][None]).objectives)[0, alone]
            better = cost < lowest[alone] - _ALIKE * scale[alone]
            alike = abs(cost - lowest[alone]) <= _ALIKE * scale[alone]
            agreeing[alone] = 1 if better else agreeing[alone] + alike
            lowest[alone] = min(lowest[alone], cost)
    rows = np.array(ends)
    return Improved(
        values=rows,
        found=checked_evaluation(problem, rows, problem.evaluate),
        gradients=gradients,
    )


def _scale(costs: Float[Array, "m q"]) -> Float[Array, " q"]:
    if not len(costs):
        return np.ones(costs.shape[1])
    size = np.maximum(np.abs(costs).max(axis=0), 1e-6)
    return np.maximum(np.ptp(costs, axis=0), 1e-3 * size)


def _tasks(
    problem: Problem,
    values: Float[Array, "m d"],
    costs: Float[Array, "m q"],
    misses: Float[Array, " m"],
) -> Iterator[tuple[int, int | None]]:
    """Start of each descent, in order, and the objective that it minimizes; ``None`` for all."""
    count = len(problem.objectives)
    share = (values - problem.low) / (problem.high - problem.low)
    feasible = np.flatnonzero(misses == 0)
    if not feasible.size:
        near = np.argsort(misses, kind="stable")[: max(1, len(misses) // 2)]
        yield from ((int(start), None) for start in near[_far_apart(share[near], 2 * _STARTS)])
        return
    front = feasible[non_dominated(costs[feasible])]
    best = front[extremes(costs[front])]
    apart = feasible[_far_apart(share[feasible], _STARTS)]
    yield from ((int(start), i) for i, start in enumerate(best))
    along = front[thinned(costs[front], _STARTS)]
    together = [front[knee(costs[front])], *along] if count > 1 else []
    others = [*dict.fromkeys([*(best if count > 1 else []), *_alternating(along, apart)])]
    for turn in range(max(len(others), len(together))):
        if turn < len(together):
            yield int(together[turn]), None
        if turn < len(others):
            yield from ((int(others[turn]), i) for i in range(count) if others[turn] != best[i])


def _alternating(one: Array, other: Array) -> list[int]:
    pairs = zip_longest(one.tolist(), other.tolist())
    return [index for pair in pairs for index in pair if index is not None]


def _far_apart(share: Float[Array, "m d"], count: int) -> Int64[Array, " k"]:
    """Indices of ``count`` points: the first, then each time the farthest from those before it."""
    chosen = [0]
    distance = np.linalg.norm(share - share[0], axis=1)
    while len(chosen) < count and distance.max() > 0:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(share - share[chosen[-1]], axis=1))
    return np.array(chosen, dtype=np.int64)


class _UndefinedError(Exception):
    """An objective or a derivative is not finite at an iterate."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Linear:
    """Scaled sum of costs and scaled constraints at a point of the unit cube, with derivatives."""

    share: Float[Array, " f"]
    cost: float
    slope: Float[Array, " f"]
    rows: Float[Array, " r"]
    jacobian: Float[Array, "r f"]
    constraint: Int64[Array, " r"]


class _Descent:
    """One descent in the unit cube of the parameters, with scaled costs and constraints."""

    def __init__(
        self,
        problem: Problem,
        values: Float[Array, " d"],
        weights: Float[Array, " q"],
        limits: Float[Array, " q"] | None,
        scale: Float[Array, " q"],
    ) -> None:
        self.gradients = 0
        self._problem, self._start = problem, values
        self._weights, self._limits, self._scale = weights, limits, scale
        self._free = ~problem.whole
        self._sizes = np.array(problem.constraint_sizes)
        self._seen: dict[bytes, _Linear] = {}

    def end(self) -> Float[Array, " d"]:
        """The best point that was found; the start if no better point was found."""
        free, low = self._free, self._problem.low[self._free]
        if not free.any():
            return self._start
        share = (self._start[free] - low) / (self._problem.high[free] - low)
        misses, costs = self._merits(share[None])
        best, radius, small = (misses[0], costs[0]), _RADIUS, 0
        while radius > _LEAST_RADIUS and small < _SMALL_GAINS and self.gradients < _PER_DESCENT:
            try:
                end = self._run(share, radius)
            except _UndefinedError:
                radius /= 4
                continue
            points = np.clip(share + _STEPS[:, None] * (end - share), 0.0, 1.0)
            points = np.vstack([self._corrected(end), points])
            misses, costs = self._merits(points)
            first = int(np.lexsort((costs, misses))[0])
            found = (misses[first], costs[first])
            if found >= best:
                if abs(costs[1] - best[1]) <= _GAIN and misses[1] <= max(best[0], _GAIN):
                    break  # the end of the run is no better either
                radius /= 4
                continue
            gain = best[0] - found[0] if best[0] > 0 else best[1] - found[1]
            small = small + 1 if gain <= _GAIN else 0
            share, best, step = points[first], found, _STEPS[max(first - 1, 0)]
            radius *= 2.0 if step > 0.9 else 0.7 if step > 0.4 else 0.35
            radius = min(radius, _LARGEST_RADIUS)
        return self._values(share[None])[0]

    def _run(self, share: Float[Array, " f"], radius: float) -> Float[Array, " f"]:
        """The end of a short run of SLSQP in the box; broken constraints are elastic."""
        from scipy.optimize import minimize

        here, f = self._at(share), share.size
        kept = self._near(here, radius)
        of = here.constraint[kept]
        broken = np.unique(of[here.rows[kept] > 0])
        elastic = (of[:, None] == broken).astype(float)  # one variable for all rows of a constraint
        first = [here.rows[here.constraint == k].max() for k in broken]

        def cost(x: Array) -> float:
            return float(x[f:].sum()) if broken.size else self._at(x).cost

        def slope(x: Array) -> Array:
            if broken.size:
                return np.concatenate([np.zeros(f), np.ones(broken.size)])
            return self._at(x).slope

        def slack(x: Array) -> Array:
            rows = self._at(x[:f]).rows[kept] - elastic @ x[f:] + _MARGIN
            return -rows

        def slack_slope(x: Array) -> Array:
            return -np.hstack([self._at(x[:f]).jacobian[kept], -elastic])

        low, high = np.maximum(share - radius, 0.0), np.minimum(share + radius, 1.0)
        found = minimize(
            cost,
            np.concatenate([share, np.array(first) + _MARGIN]),
            jac=slope,
            method="SLSQP",
            bounds=[*zip(low, high, strict=True), *[(0.0, None)] * broken.size],
            constraints=[{"type": "ineq", "fun": slack, "jac": slack_slope}] if kept.size else [],
            options={"maxiter": _ITERATIONS, "ftol": _PRECISION},
        )
        return np.clip(found.x[:f], low, high)

    def _corrected(self, share: Float[Array, " f"]) -> Float[Array, " f"]:
        """The point moved onto the constraints that it breaks by little, by Newton steps."""
        last = share
        for _ in range(_CORRECTIONS):
            try:
                here = self._at(share)
            except _UndefinedError:
                return last
            last = share
            if not -_MARGIN / 2 < here.rows.max(initial=-np.inf) <= _BREACH:
                break
            active = here.rows > -_ACTIVE
            excess = here.rows[active] + 2 * _MARGIN
            inside = np.ones(share.size, dtype=bool)
            for _ in range(_CORRECTIONS):  # a parameter that would pass its bound stays
                slopes = np.where(inside, here.jacobian[active], 0.0)
                moved = share - lstsq("the active constraints", slopes, excess, rcond=1e-8)[0]
                passes = (moved < 0) | (moved > 1)
                if not passes.any():
                    break
                inside &= ~passes
            share = np.clip(moved, 0.0, 1.0)
        return share

    def _near(self, here: _Linear, radius: float) -> Int64[Array, " k"]:
        """Rows to keep: those in reach of constraints with several rows, and all of the others."""
        of, counts = here.constraint, np.bincount(here.constraint)
        reached = here.rows > -_REACH * radius * np.abs(here.jacobian).sum(axis=1)
        return np.flatnonzero(reached | (counts[of] == 1))

    def _at(self, share: Float[Array, " f"]) -> _Linear:
        """The linearization at a point; SLSQP asks for each of its parts separately."""
        share = np.clip(share, 0.0, 1.0)
        key = share.tobytes()
        if key not in self._seen:
            self._seen = dict([*self._seen.items()][1 - _REMEMBERED :])
            self._seen[key] = self._linearized(share)
        return self._seen[key]

    def _linearized(self, share: Float[Array, " f"]) -> _Linear:
        problem, free = self._problem, self._free
        assert problem.gradient is not None
        if not np.isfinite(share).all():
            raise _UndefinedError
        self.gradients += 1
        found = problem.gradient(self._values(share[None])[0])
        span = (problem.high - problem.low)[free]
        sign = problem.costs(np.ones(len(self._scale))) / self._scale
        slopes = sign[:, None] * found.objectives_jacobian[:, free] * span
        of = found.constraint
        rows = found.violation / self._sizes[of]
        jacobian = found.violation_jacobian[:, free] * span / self._sizes[of][:, None]
        if self._limits is not None:
            rows = np.append(rows, found.objectives * sign - self._limits / self._scale)
            jacobian = np.vstack([jacobian, slopes])
            of = np.append(of, self._sizes.size + np.arange(len(slopes)))
        cost = float(self._weights @ (found.objectives * sign))
        slope = self._weights @ slopes
        if not all(np.isfinite(part).all() for part in (cost, slope, rows, jacobian)):
            raise _UndefinedError
        return _Linear(
            share=share, cost=cost, slope=slope, rows=rows, jacobian=jacobian, constraint=of
        )

    def _merits(self, share: Float[Array, "m f"]) -> tuple[Float[Array, " m"], Float[Array, " m"]]:
        """Sum of the violations, and scaled sum of the costs, which counts where the first is 0."""
        values = self._values(share)
        found = checked_evaluation(self._problem, values, self._problem.evaluate)
        misses = misses_of(self._problem, found)
        costs = self._problem.costs(found.objectives) / self._scale
        if self._limits is not None:
            above = costs - self._limits / self._scale
            misses = misses + np.maximum(above, 0.0).sum(axis=1)
        chosen = self._weights > 0
        with np.errstate(invalid="ignore"):
            merit = costs[:, chosen] @ self._weights[chosen]
        return misses, np.where(np.isfinite(merit), merit, np.inf)

    def _values(self, share: Float[Array, "m f"]) -> Float[Array, "m d"]:
        values = np.repeat(self._start[None], len(share), axis=0)
        low, high = self._problem.low[self._free], self._problem.high[self._free]
        values[:, self._free] = low + share * (high - low)
        return self._problem.allowed(values)
