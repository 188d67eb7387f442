"""Search algorithms: NSGA-II, NSGA-III, differential evolution, CMA-ES, and gradient descent.

Each of the first four returns the candidates of a generation (`ask`), takes their costs (`tell`),
and returns its state as arrays. Its random numbers are derived from seed and generation, so that a
restored state continues with the same digits.

`improved` traces the whole front by exact gradients, in rounds of descents that advance together:
their gradients are one batch, and so are the points that they try. An evaluation costs much less
than a gradient, so that each descent tries several lengths of its step. A constraint on the least
of several distances is a constraint on each distance within reach, because the least one has
kinks.
"""

import math
import warnings
from collections.abc import Callable, Mapping
from typing import Any, Protocol, runtime_checkable

import numpy as np

from chromanoise.apps.design.pareto_front import (
    MOST_WITHOUT_PYMOO,
    Assessed,
    Problem,
    Rows,
    assessed,
    crowding,
    non_dominated,
    scaled,
)
from chromanoise.base import (
    Array,
    Bool,
    Float,
    InputError,
    Int64,
    dataclass,
    inv,
    refuse_absent_package,
    solve,
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

    def tell(self, told: State, rng: np.random.Generator) -> None:
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


def _share(problem: Problem, values: Float[Array, "*m d"]) -> Float[Array, "*m d"]:
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

    def tell(self, told: State, rng: np.random.Generator) -> None:
        """As `Algorithm.tell`."""
        new = told | {"crowding": np.zeros(len(told["misses"]))}
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

    def tell(self, told: State, rng: np.random.Generator) -> None:
        """As `Algorithm.tell`."""
        old, self._kept = self._kept, told
        if old:
            lower = told["misses"] < old["misses"]
            equal = told["misses"] == old["misses"]
            wins = lower | equal & (told["costs"][:, 0] <= old["costs"][:, 0])
            self._kept = {
                name: np.where(wins if array.ndim == 1 else wins[:, None], array, old[name])
                for name, array in told.items()
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

    def tell(self, told: State, rng: np.random.Generator) -> None:
        """As `Algorithm.tell`."""
        costs, misses = told["costs"][:, 0], told["misses"]
        if self._origin.size:
            feasible = misses == 0
            worst = costs[feasible].max() if feasible.any() else 0.0
            self._update(np.where(feasible, costs, worst + misses))
        else:
            best = np.lexsort((costs, misses))[0]
            self._origin = _share(self._problem, told["values"][best])

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


_RADIUS, _LARGEST_RADIUS, _LEAST_RADIUS = 0.2, 0.3, 1e-5  # of the box, as shares of the ranges
_ITERATIONS = 100  # of a descent
_GAIN = 1e-6  # of the scale of the costs; a descent ends when several steps gain less
_SMALL_GAINS = 3
_PREDICTED = 1e-9  # gain of the model below which a descent ends
_MARGIN = 1e-7  # kept from each constraint, which the model meets within rounding only
_STEPS = np.array([1.0, 1.0, 0.6, 0.3, 0.1, 0.03])  # the first one is corrected
_OTHERS = 1e-5  # weight of the sum of all costs, so that no end is only weakly efficient
_PENALTY, _LARGEST_PENALTY = 10.0, 1e4  # per violation
_OF_COSTS, _OF_BOX = 1e3, 1e4  # penalties that exceed every multiplier
_ROWS = 3  # rows of constraints per parameter in a model
_CURVATURE = 0.1  # of the first model
_DAMPING = 0.2  # least share of the curvature that a step keeps (Powell, 1978)
_ACTIVE = 1e-5  # multiplier of an active row
_INTERIOR = 40  # iterations of a model's solution
_INTERIOR_GAP, _INTERIOR_ERROR = 1e-9, 1e-5  # where it ends
_TINY = 1e-13

_SCREENED, _NEAR = 4096, 0.1  # random candidates, and the share that is nearest to the constraints
_FIRST = 96  # descents of the first round, from candidates far apart
_ALONG, _ALONE = 48, 8  # descents of a round along the front, and of each objective alone
_AT_LAST = 500  # descents along the front in the last round
_DRAWN = 2000  # points between members, of which the references of a round are chosen
_DEPTH = 0.15  # of the geometric distribution of the rank of a start
_FROM_PARENT, _RENEWED = 0.6, 0.2  # shares of the parameters in a crossed and a changed start
_UNCHANGED, _CROSSED_STARTS = 0.2, 0.6  # quantiles of the kinds of a start
_CELL = 2  # decimals of the parameters within which two members are one
_ROUNDS = 40  # at most, before the last
_SETTLED, _SETTLED_ROUNDS = 1e-3, 3  # mean gain of the references; rounds that must gain less


@dataclass(frozen=True, kw_only=True, eq=False)
class Improved:
    """The ends of the descents, with their evaluation without gradients.

    Attributes
    ----------
    found
        One row per descent, feasible or not.
    gradients
        Number of gradients that were computed.
    """

    found: Assessed
    gradients: int


def improved(
    problem: Problem,
    found: Assessed,
    *,
    most: int,
    rng: np.random.Generator,
    is_stopped: Callable[[], bool] = bool,
) -> Improved:
    """Candidates along the whole front, by descents in rounds.

    The first round minimizes each objective alone, from candidates that are far apart. Each later
    round takes references evenly spaced along the front so far, and minimizes the largest excess
    of the costs over the reference (Pascoletti & Serafini, 1984), or one objective alone. A
    descent starts at one of the best members for its reference, at a cross of that member and
    another one, or at that member with some parameters drawn anew. When the front has settled, a
    last round with more references starts at the best member for each.

    Parameters
    ----------
    problem
        A problem with gradients. A descent keeps integer parameters.
    found
        Evaluated candidates, at least one.
    most
        Number of gradients after which only the last round begins.
    is_stopped
        Whether no further round shall begin.
    """
    screened = latin_hypercube(problem, min(_SCREENED, max(2 * most, _FIRST)), rng)
    every = found.joined(assessed(problem, screened))
    pool, count = every.some(every.feasible), len(problem.objectives)
    near = np.argsort(every.misses, kind="stable")[: max(_FIRST, int(_NEAR * len(every.values)))]
    nearest = every.values[near]
    starts = nearest[_far_apart(_share(problem, nearest), _FIRST)]
    alone = np.where(np.eye(count, dtype=bool), 0.0, np.inf)
    reference, scale = np.resize(alone, (len(starts), count)), _scale(pool.costs)
    ends, gradients, settled, is_last = list[Assessed](), 0, 0, False
    while not is_stopped():
        descents = _Descents(problem, starts, reference, scale)
        ends.append(assessed(problem, descents.ends()))
        gradients += descents.gradients
        new = ends[-1].some(ends[-1].feasible)
        if len(pool.values) and len(new.values):
            before, after = (
                _excesses(one.costs, reference, scale).min(axis=1) for one in (pool, new)
            )
            gain = np.maximum(before - after, 0.0).mean()
            settled = settled + 1 if gain <= _SETTLED else 0
        pool = pool.joined(new)
        if is_last or not len(pool.values):
            break
        is_last = gradients >= most or settled >= _SETTLED_ROUNDS or len(ends) > _ROUNDS
        pool = pool.some(_distinct(_share(problem, pool.values), pool.costs))
        front = pool.costs[non_dominated(pool.costs)]
        scale = _scale(front)
        along = _references(front / scale, _AT_LAST if is_last else _ALONG, rng) * scale
        reference = np.concatenate([np.repeat(alone, _ALONE, axis=0), along])
        excesses = _excesses(pool.costs, reference, scale)
        starts = (
            pool.values[excesses.argmin(axis=1)]
            if is_last
            else _starts(problem, pool.values, excesses, rng)
        )
    first, *others = ends
    return Improved(found=first.joined(*others), gradients=gradients)


def _scale(costs: Float[Array, "m q"]) -> Float[Array, " q"]:
    if not len(costs):
        return np.ones(costs.shape[1])
    size = np.maximum(np.abs(costs).max(axis=0), 1e-6)
    return np.maximum(np.ptp(costs, axis=0), 1e-3 * size)


def _far_apart(share: Float[Array, "m d"], count: int) -> Int64[Array, " k"]:
    """Indices of ``count`` points: the first, then each time the farthest from those before it."""
    chosen = [0]
    distance = np.linalg.norm(share - share[0], axis=1)
    while len(chosen) < count and distance.max() > 0:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(share - share[chosen[-1]], axis=1))
    return np.array(chosen, dtype=np.int64)


def _excesses(
    costs: Float[Array, "m q"], reference: Float[Array, "k q"], scale: Float[Array, " q"]
) -> Float[Array, "k m"]:
    """Largest scaled excess of the costs over each reference; infinite references do not count."""
    return ((costs - reference[:, None]) / scale).max(axis=2)


def _distinct(share: Float[Array, "m d"], costs: Float[Array, "m q"]) -> Int64[Array, " k"]:
    """Indices of the best of each cell of the parameters, and of the lowest of each cost."""
    order = np.lexsort((scaled(costs).sum(axis=1), ~non_dominated(costs)))
    _, first = np.unique(np.round(share[order], _CELL), axis=0, return_index=True)
    return np.unique(np.concatenate([order[first], costs.argmin(axis=0)]))


def _references(
    costs: Float[Array, "m q"], most: int, rng: np.random.Generator
) -> Float[Array, "k q"]:
    """Points far apart between members of a front, in the plane across the diagonal."""
    count = costs.shape[1]
    corners = costs[rng.integers(0, len(costs), (_DRAWN, count))]
    between = np.einsum("mk,mkq->mq", rng.dirichlet(np.ones(count), _DRAWN), corners)
    points = np.concatenate([costs, between])
    points = points - points.mean(axis=1, keepdims=True)
    return points[_far_apart(points, most)] if count > 1 else points[:0]


def _starts(
    problem: Problem,
    pool: Float[Array, "m d"],
    excesses: Float[Array, "k m"],
    rng: np.random.Generator,
) -> Float[Array, "k d"]:
    """A start for each reference: a good member, a cross of it, or it with changed parameters."""
    count, d = len(excesses), pool.shape[1]
    rank = np.minimum(rng.geometric(_DEPTH, count), len(pool)) - 1
    order = np.argsort(excesses, axis=1, kind="stable")
    parents = pool[order[np.arange(count), rank]]
    mates = pool[rng.integers(0, len(pool), count)]
    fresh = latin_hypercube(problem, count, rng)
    drawn = rng.random((count, d))
    crossed = np.where(drawn < _FROM_PARENT, parents, mates)
    changed = np.where(drawn < max(_RENEWED, 1.5 / d), fresh, parents)
    kind = rng.random((count, 1))
    others = np.where(kind < _CROSSED_STARTS, crossed, changed)
    return np.where(kind < _UNCHANGED, parents, others)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Linear(Rows):
    """Scaled costs and constraints at points of the unit cube, with derivatives."""

    costs: Float[Array, "n q"]
    slopes: Float[Array, "n q f"]
    rows: Float[Array, "n r"]
    jacobian: Float[Array, "n r f"]

    @property
    def defined(self) -> Bool[Array, " n"]:
        parts = self.arrays().values()
        return np.logical_and.reduce(
            [np.isfinite(part).reshape(len(part), -1).all(axis=1) for part in parts]
        )

    def put(self, places: Array, new: "_Linear") -> None:
        for name, array in new.arrays().items():
            getattr(self, name)[places] = array

    def lagrangian_slope(self, of_costs: Array, of_rows: Array) -> Float[Array, "n f"]:
        """Slope of the costs and rows with multipliers, and of the sum of all costs."""
        weights = of_costs + _OTHERS
        return _combined(weights, self.slopes) + _combined(of_rows, self.jacobian)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Merit:
    """Merit of points: the objective of a descent, and the sum of their scaled violations."""

    value: Float[Array, " n"]
    misses: Float[Array, " n"]
    feasible: Bool[Array, " n"]
    costs: Float[Array, "n q"]
    violation: Float[Array, "n r"]


@dataclass(frozen=True, kw_only=True, eq=False)
class _Step:
    """The minimum of a quadratic model within the box, and its multipliers."""

    step: Float[Array, "n f"]
    gain: Float[Array, " n"]
    misses: Float[Array, " n"]
    of_costs: Float[Array, "n q"]
    of_rows: Float[Array, "n r"]
    corrected: Callable[[_Merit], Float[Array, "n f"]]


class _Descents:
    """Descents in the unit cube of the free parameters, all in step.

    Each minimizes the largest excess of its costs over its reference under the constraints, whose
    violation has a penalty. A step is the minimum of a quadratic model within a box (sequential
    quadratic programming with damped BFGS updates; Nocedal & Wright, 2006, chapter 18), corrected
    by the curvature of the active rows, or a part of this step.
    """

    def __init__(
        self,
        problem: Problem,
        values: Float[Array, "n d"],
        reference: Float[Array, "n q"],
        scale: Float[Array, " q"],
    ) -> None:
        self.gradients = 0
        self._problem, self._start = problem, values
        self._free = ~problem.whole
        self._low, self._span = problem.low[self._free], (problem.high - problem.low)[self._free]
        self._sign = problem.costs(np.ones(len(scale))) / scale
        self._sizes = np.array(problem.constraint_sizes)
        self._counts = np.isfinite(reference)
        self._reference = np.where(self._counts, reference / scale, 0.0)
        self._share = (values[:, self._free] - self._low) / self._span
        n, f = self._share.shape
        self._radius, self._penalty = np.full(n, _RADIUS), np.full(n, _PENALTY)
        self._curvature = np.tile(_CURVATURE * np.eye(f), (n, 1, 1))
        self._small = np.zeros(n, dtype=int)
        self._of = np.empty(0, dtype=np.int64)

    def ends(self) -> Float[Array, "n d"]:
        """The best feasible point of each descent; the last one where none is feasible."""
        every = np.arange(len(self._start))
        if not self._free.any():
            return self._start
        first = self._merit(self._share, every)
        self._value, self._misses = first.value, first.misses
        self._best = np.where(first.feasible, first.value, np.inf)
        self._best_share = self._share.copy()
        at = self._linearized(every)
        live = np.flatnonzero(at.defined)
        at = at.some(live)
        for _ in range(_ITERATIONS):
            if not live.size:
                break
            live, at = self._advanced(live, at)
        found = np.isfinite(self._best)[:, None]
        return self._values(np.where(found, self._best_share, self._share), every)

    def _advanced(self, live: Array, at: _Linear) -> tuple[Array, _Linear]:
        """One step of the live descents: those that go on, with their linearization."""
        model = self._model(live, at)
        here, n = self._share[live], live.size
        full = self._merit(here + model.step, live)
        points = here[:, None] + _STEPS[:, None] * model.step[:, None]
        points[:, 0] += model.corrected(full)
        points = np.clip(points, 0.0, 1.0)
        found = self._merit(points.reshape(n * _STEPS.size, -1), np.repeat(live, _STEPS.size))
        value, misses = found.value.reshape(n, -1), found.misses.reshape(n, -1)
        merit = value + self._penalty[live, None] * misses
        first, each = merit.argmin(axis=1), np.arange(n)
        gain = self._value[live] + self._penalty[live] * self._misses[live] - merit[each, first]
        better = (gain > 0) & np.isfinite(merit[each, first])
        self._remember(live, points, np.where(found.feasible.reshape(n, -1), value, np.inf))
        self._resize(live, model, _STEPS[first], np.where(better, gain, 0.0))
        moved, goes_on = points[each, first] - here, self._goes_on(live, model, better, gain)
        won = live[better]
        self._share[won] = points[each, first][better]
        self._value[won], self._misses[won] = (
            value[each, first][better],
            misses[each, first][better],
        )
        fresh = np.flatnonzero(better & goes_on)
        if fresh.size:
            new = self._linearized(live[fresh])
            self._bend(live[fresh], model, fresh, moved[fresh], at, new)
            goes_on[fresh] = new.defined
            at.put(fresh, new)
        return live[goes_on], at.some(goes_on)

    def _remember(self, live: Array, points: Array, value: Float[Array, "n k"]) -> None:
        each, first = np.arange(live.size), value.argmin(axis=1)
        lower = value[each, first] < self._best[live]
        self._best[live[lower]] = value[each, first][lower]
        self._best_share[live[lower]] = points[each, first][lower]

    def _resize(self, live: Array, model: _Step, step: Array, gain: Float[Array, " n"]) -> None:
        """Radius of the box, and penalty, after a step; no gain if it was refused."""
        length, radius = np.abs(model.step).max(axis=1), self._radius[live]
        good = (step == 1) & (gain > 0.7 * model.gain) & (length >= 0.5 * radius)
        factor = np.select([good, step == 1, step > 0.5, step > 0.2], [2.0, 1.0, 0.7, 0.5], 0.25)
        grown = np.minimum(radius * factor, _LARGEST_RADIUS)
        self._radius[live] = np.where(gain > 0, grown, np.minimum(radius / 4, length / 2))
        stuck = (model.misses > _MARGIN) & (
            np.isfinite(self._best[live]) | ((gain == 0) & (self._misses[live] > 10 * _MARGIN))
        )
        raised = np.minimum(4 * self._penalty[live], _LARGEST_PENALTY)
        self._penalty[live] = np.where(stuck, raised, self._penalty[live])

    def _goes_on(self, live: Array, model: _Step, better: Array, gain: Array) -> Bool[Array, " n"]:
        """Which descents have not ended; an end that violates a constraint has a higher penalty."""
        small = better & (gain < _GAIN)
        count = np.where(better & ~small, 0, self._small[live] + small)
        ended = (self._radius[live] < _LEAST_RADIUS) | (count >= _SMALL_GAINS)
        ended |= model.gain < _PREDICTED
        again = ended & np.isinf(self._best[live]) & (self._penalty[live] < _LARGEST_PENALTY)
        self._small[live] = np.where(again, 0, count)
        self._penalty[live[again]] *= 10
        self._radius[live[again]] = _RADIUS / 10
        return ~ended | again

    def _bend(
        self, live: Array, model: _Step, of: Array, step: Array, old: _Linear, new: _Linear
    ) -> None:
        """Damped BFGS update of the curvature of the Lagrangian."""
        multipliers = model.of_costs[of], model.of_rows[of]
        with np.errstate(invalid="ignore", over="ignore"):
            before, after = (one.lagrangian_slope(*multipliers) for one in (old.some(of), new))
            change = after - before
        own = self._curvature[live]
        along = _times(own, step)
        length, product = (step * along).sum(axis=1), (step * change).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            weight = (1 - _DAMPING) * length / (length - product)
            weight = np.where(product < _DAMPING * length, weight, 1.0)[:, None]
            damped = weight * change + (1 - weight) * along
            size = (step * damped).sum(axis=1)
            bent = (
                own
                - along[:, :, None] * along[:, None] / length[:, None, None]
                + damped[:, :, None] * damped[:, None] / size[:, None, None]
            )
        kept = (size > 1e-8 * length) & np.isfinite(bent).all(axis=(1, 2))
        self._curvature[live[kept]] = bent[kept]

    def _model(self, live: Array, at: _Linear) -> _Step:
        """The minimum of the quadratic model, in units of the radius."""
        (n, q), f, radius = at.costs.shape, self._share.shape[1], self._radius[live]
        rows, jacobian, places = self._nearest(at, radius)
        k, counts = rows.shape[1], self._counts[live]
        excess = np.where(counts, at.costs - self._reference[live], -np.inf)
        worst = excess.max(axis=1, keepdims=True)
        high = np.minimum(radius[:, None], 1 - self._share[live])
        low = np.minimum(radius[:, None], self._share[live])
        table = np.zeros((n, q + k + 2 * f, f + 1))
        table[:, :q, :f] = np.where(counts[..., None], at.slopes, 0.0) * radius[:, None, None]
        table[:, :q, f] = np.where(counts, -1.0, 0.0)
        table[:, q : q + k, :f] = jacobian * radius[:, None, None]
        table[:, q + k : q + k + f, :f], table[:, q + k + f :, :f] = np.eye(f), -np.eye(f)
        limits = np.concatenate(
            [
                np.where(counts, worst - excess, 1.0),
                -(rows + _MARGIN),
                high / radius[:, None],
                low / radius[:, None],
            ],
            axis=1,
        )
        penalty = np.concatenate(
            [
                np.full((n, q), _OF_COSTS),
                np.repeat(self._penalty[live, None], k, axis=1),
                np.full((n, 2 * f), _OF_BOX),
            ],
            axis=1,
        )
        hessian, slope = np.zeros((n, f + 1, f + 1)), np.ones((n, f + 1))
        hessian[:, :f, :f] = self._curvature[live] * radius[:, None, None] ** 2
        hessian[:, f, f] = 1e-10
        slope[:, :f] = _OTHERS * at.slopes.sum(axis=1) * radius[:, None]
        minimum, multipliers = _minima(hessian, slope, table, limits, penalty)
        step = np.clip(minimum[:, :f] * radius[:, None], -low, high)
        costs, linear = at.costs + _times(at.slopes, step), rows + _times(jacobian, step)
        value = np.where(counts, costs - self._reference[live], -np.inf).max(axis=1)
        bend = 0.5 * (step * _times(self._curvature[live], step)).sum(axis=1)
        value += _OTHERS * costs.sum(axis=1) + bend
        before, after = (np.maximum(one + _MARGIN, 0.0).sum(axis=1) for one in (rows, linear))
        lost = self._penalty[live] * (before - after)
        of_rows = np.zeros_like(at.rows)
        np.put_along_axis(of_rows, places, multipliers[:, q : q + k], axis=1)
        inside = (step < high - _TINY) & (step > -low + _TINY)

        def corrected(full: _Merit) -> Float[Array, "n f"]:
            """The least step by which the active rows are met again where they curve."""
            of = self._of[places]
            error = np.zeros_like(linear)
            for one, violation in enumerate(full.violation.T):
                top = np.where(of == one, linear, -_OF_BOX).max(axis=1)
                error += np.where(of == one, (violation - top)[:, None], 0.0)
            error = np.concatenate([full.costs - costs, error], axis=1)
            active = multipliers[:, : q + k] > _ACTIVE
            active[:, :q] &= counts
            active &= np.isfinite(error)
            normals = table[:, : q + k].copy()
            normals[..., :f] *= inside[:, None] / radius[:, None, None]
            normals = np.where(active[..., None], normals, 0.0)
            product = normals @ normals.swapaxes(1, 2)
            diagonal = np.arange(q + k)
            product[:, diagonal, diagonal] += np.where(active, 1e-9, 1.0)
            wanted = np.where(active, error, 0.0)[..., None]
            shift = -_times(normals.swapaxes(1, 2), solve("active rows", product, wanted)[..., 0])
            size = np.abs(shift[:, :f]).max(axis=1, keepdims=True)
            near = size <= np.abs(step).max(axis=1, keepdims=True)
            return np.where(near, shift[:, :f], 0.0)

        return _Step(
            step=step,
            gain=worst[:, 0] + _OTHERS * at.costs.sum(axis=1) - value + lost,
            misses=np.maximum(linear + _MARGIN, 0.0).sum(axis=1),
            of_costs=np.where(counts, multipliers[:, :q], 0.0),
            of_rows=of_rows,
            corrected=corrected,
        )

    def _nearest(self, at: _Linear, radius: Array) -> tuple[Array, Array, Array]:
        """The rows that a step can reach first, their Jacobian and their places."""
        count = at.rows.shape[1]
        most = min(count, _ROWS * self._share.shape[1] + self._sizes.size)
        reach = at.rows + radius[:, None] * np.abs(at.jacobian).sum(axis=2)
        places = np.argsort(-reach, axis=1, kind="stable")[:, :most]
        rows = np.take_along_axis(at.rows, places, axis=1)
        return rows, np.take_along_axis(at.jacobian, places[..., None], axis=1), places

    def _linearized(self, live: Array) -> _Linear:
        problem, free = self._problem, self._free
        assert problem.gradient is not None
        self.gradients += live.size
        found = problem.gradient(self._values(self._share[live], live))
        self._of = found.constraint
        sizes = self._sizes[found.constraint]
        return _Linear(
            costs=found.objectives * self._sign,
            slopes=found.objectives_jacobian[..., free] * self._span * self._sign[:, None],
            rows=found.violation / sizes,
            jacobian=found.violation_jacobian[..., free] * self._span / sizes[:, None],
        )

    def _merit(self, share: Float[Array, "n f"], which: Array) -> _Merit:
        values = self._values(share, which)
        found = assessed(self._problem, values)
        costs = found.objectives * self._sign
        with np.errstate(invalid="ignore"):
            excess = np.where(self._counts[which], costs - self._reference[which], -np.inf)
            value = excess.max(axis=1) + _OTHERS * costs.sum(axis=1)
        violation = found.violation / self._sizes
        return _Merit(
            value=np.where(np.isfinite(value), value, np.inf),
            misses=np.maximum(violation + _MARGIN, 0.0).sum(axis=1),
            feasible=found.feasible,
            costs=costs,
            violation=violation,
        )

    def _values(self, share: Float[Array, "n f"], which: Array) -> Float[Array, "n d"]:
        values = self._start[which]
        values[:, self._free] = self._low + np.clip(share, 0.0, 1.0) * self._span
        return self._problem.allowed(values)


def _times(matrices: Float[Array, "n r f"], vectors: Float[Array, "n f"]) -> Float[Array, "n r"]:
    return (matrices @ vectors[..., None])[..., 0]


def _combined(weights: Float[Array, "n r"], rows: Float[Array, "n r f"]) -> Float[Array, "n f"]:
    return (weights[:, None] @ rows)[:, 0]


def _minima(
    hessian: Float[Array, "n f f"],
    slope: Float[Array, "n f"],
    rows: Float[Array, "n r f"],
    limits: Float[Array, "n r"],
    penalty: Float[Array, "n r"],
) -> tuple[Float[Array, "n f"], Float[Array, "n r"]]:
    """Minima y of y'Hy/2 + g'y + sum of penalties times max(Ay - b, 0), and their multipliers.

    A primal-dual interior-point method (Mehrotra, 1992) for all problems at once.
    """
    n, f = slope.shape
    y, over = np.zeros((n, f)), np.maximum(-limits, 0.0) + 0.1
    slack, dual = over + limits, np.minimum(penalty / 2, 1.0)
    ends, multipliers, live = y.copy(), dual.copy(), np.arange(n)
    diagonal = np.arange(f)
    for _ in range(_INTERIOR):
        miss = _times(rows, y) + slack - over - limits
        tilt = _times(hessian, y) + slope + _combined(dual, rows)
        rest = penalty - dual
        gap = ((dual * slack).sum(axis=1) + (rest * over).sum(axis=1)) / (2 * rows.shape[1])
        error = np.maximum(np.abs(miss).max(axis=1), np.abs(tilt).max(axis=1))
        ends[live], multipliers[live] = y, dual
        left = (gap >= _INTERIOR_GAP) | (error >= _INTERIOR_ERROR)
        if not left.any():
            break
        live, hessian, slope, rows, limits, penalty, y, over, slack, dual, miss, tilt, rest, gap = (
            one[left]
            for one in (
                live, hessian, slope, rows, limits, penalty, y, over, slack, dual, miss, tilt,
                rest, gap,
            )
        )  # fmt: skip
        weight = 1 / (slack / dual + over / rest)
        system = hessian + (rows * weight[..., None]).swapaxes(1, 2) @ rows
        system[:, diagonal, diagonal] = system[:, diagonal, diagonal] * (1 + 1e-11) + 1e-11
        inverse = inv("the model of a descent", system)

        def direction(of_slack: Array, of_over: Array) -> tuple[Array, Array, Array, Array]:
            shift = miss - of_slack / dual + of_over / rest  # noqa: B023
            dy = _times(inverse, -tilt - _combined(weight * shift, rows))  # noqa: B023
            dual_step = weight * (_times(rows, dy) + shift)  # noqa: B023
            return (
                dy,
                dual_step,
                -(of_slack + slack * dual_step) / dual,  # noqa: B023
                (over * dual_step - of_over) / rest,  # noqa: B023
            )

        _, dual_step, slack_step, over_step = direction(dual * slack, rest * over)
        length = _longest(
            (dual, dual_step), (rest, -dual_step), (slack, slack_step), (over, over_step)
        )
        reached = (
            ((dual + length * dual_step) * (slack + length * slack_step)).sum(axis=1)
            + ((rest - length * dual_step) * (over + length * over_step)).sum(axis=1)
        ) / (2 * rows.shape[1])
        target = (reached**3 / gap**2)[:, None]
        dy, dual_step, slack_step, over_step = direction(
            dual * slack + dual_step * slack_step - target,
            rest * over - dual_step * over_step - target,
        )
        length = 0.995 * _longest(
            (dual, dual_step), (rest, -dual_step), (slack, slack_step), (over, over_step)
        )
        y = y + length * dy
        dual = np.clip(dual + length * dual_step, _TINY, penalty * (1 - 10 * _TINY))
        slack = np.maximum(slack + length * slack_step, _TINY)
        over = np.maximum(over + length * over_step, _TINY)
    return ends, multipliers


def _longest(*pairs: tuple[Array, Array]) -> Float[Array, "n 1"]:
    """Largest share of the steps, at most 1, with which all values stay positive."""
    with np.errstate(over="ignore"):
        shares = [
            np.where(step < 0, value / np.maximum(-step, 1e-300), np.inf).min(axis=1)
            for value, step in pairs
        ]
    return np.minimum(np.minimum.reduce(shares), 1.0)[:, None]
