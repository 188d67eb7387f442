"""Search algorithms: NSGA-II, NSGA-III, differential evolution and CMA-ES.

Each returns the candidates of a generation (`ask`), takes their costs (`tell`),
and returns its state as arrays. Its random numbers are derived from seed and generation, so that a
restored state continues with the same digits.
"""

import math
import warnings
from collections.abc import Callable, Mapping
from typing import Any, Protocol, runtime_checkable

import numpy as np

from chromanoise.apps.design.pareto_front import MOST_WITHOUT_PYMOO, Problem, crowding
from chromanoise.base import (
    Array,
    Bool,
    Float,
    InputError,
    dataclass,
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

    def tell(self, evaluated: State, rng: np.random.Generator) -> None:
        """Select from an evaluated generation: its ``values``, ``costs`` and ``misses``, by row.

        The first generation is not asked for.
        """

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
    return _at_share(problem, (cells + rng.random(cells.shape)) / count)


def share_of_ranges(problem: Problem, values: Float[Array, "*m d"]) -> Float[Array, "*m d"]:
    """Each parameter as a share of its range."""
    return (values - problem.low) / (problem.high - problem.low)


def _at_share(problem: Problem, share: Float[Array, "*m d"]) -> Float[Array, "*m d"]:
    """The allowed values at shares of the ranges."""
    return problem.allowed(problem.low + share * (problem.high - problem.low))


class _Population:
    """A method whose state is a population: ``values``, ``costs`` and ``misses``, by row."""

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._kept = State()

    def state(self) -> State:
        """As `Algorithm.state`."""
        return dict(self._kept)

    def restore(self, state: State) -> None:
        """As `Algorithm.restore`."""
        self._kept = dict(state)


class Genetic(_Population):
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
        super().__init__(problem)
        self._size, self._many = population, many
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

    def tell(self, evaluated: State, rng: np.random.Generator) -> None:
        """As `Algorithm.tell`."""
        new = evaluated | {"crowding": np.zeros(len(evaluated["misses"]))}
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
            return super().state()
        norm = self._niches.norm
        return self._kept | {name: getattr(norm, name) for name in _NORMALIZATION}

    def restore(self, state: State) -> None:
        """As `Algorithm.restore`."""
        super().restore(state)
        for name in set(_NORMALIZATION) & set(state):
            setattr(self._niches.norm, name, self._kept.pop(name))


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
    """The survival of NSGA-III in pymoo, with as many directions as the population allows."""
    from pymoo.config import Config

    Config.warnings["not_compiled"] = False  # otherwise printed where pymoo was not compiled
    from pymoo.algorithms.moo.nsga3 import ReferenceDirectionSurvival
    from pymoo.util.ref_dirs import get_reference_directions

    parts = 1
    while objectives > 1 and math.comb(parts + objectives, objectives - 1) <= population:
        parts += 1
    return ReferenceDirectionSurvival(
        get_reference_directions("das-dennis", objectives, n_partitions=parts)
    )


class DifferentialEvolution(_Population):
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

    def tell(self, evaluated: State, rng: np.random.Generator) -> None:
        """As `Algorithm.tell`."""
        old, self._kept = self._kept, evaluated
        if old:
            lower = evaluated["misses"] < old["misses"]
            equal = evaluated["misses"] == old["misses"]
            wins = lower | (equal & (evaluated["costs"][:, 0] <= old["costs"][:, 0]))
            self._kept = {
                name: np.where(wins if array.ndim == 1 else wins[:, None], array, old[name])
                for name, array in evaluated.items()
            }


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
        return _at_share(self._problem, np.clip(self._candidates, 0.0, 1.0))

    def tell(self, evaluated: State, rng: np.random.Generator) -> None:
        """As `Algorithm.tell`."""
        costs, misses = evaluated["costs"][:, 0], evaluated["misses"]
        if self._origin.size:
            feasible = misses == 0
            worst = costs[feasible].max() if feasible.any() else 0.0
            self._update(np.where(feasible, costs, worst + misses))
        else:
            best = np.lexsort((costs, misses))[0]
            self._origin = share_of_ranges(self._problem, evaluated["values"][best])

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


@dataclass(frozen=True, kw_only=True)
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
