"""Sets of costs of which none dominates another: the front, its thinning, extremes and knee."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from chromanoise._check import Array
from chromanoise._shapes import Bool, Float, Int64
from chromanoise.design.problem import Evaluated, Problem

_ROUND = 0.1  # share of the surplus members that are dropped before crowding is computed anew
_HELD = 0.01  # a constraint holds a member if its slack is this share of the largest on the front


def non_dominated(costs: Float[Array, "m q"]) -> Bool[Array, " m"]:
    """Which candidates no other one dominates; of equal ones the first.

    Parameters
    ----------
    costs
        Lower is better.

    Examples
    --------
    >>> non_dominated(np.array([[1.0, 2.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]]))
    array([ True,  True, False, False])
    """
    kept = np.zeros(len(costs), dtype=bool)
    left = np.lexsort((np.arange(len(costs)), *costs.T[::-1]))  # no candidate dominates an earlier
    while left.size:
        first = left[0]
        kept[first] = True
        left = left[(costs[left] < costs[first]).any(axis=1)]
    return kept


def merged(
    old: Float[Array, "k q"], new: Float[Array, "m q"]
) -> tuple[Bool[Array, " k"], Bool[Array, " m"]]:
    """Which of an old front and of new candidates form the front of both; of equal ones the old."""
    fresh = non_dominated(new)
    if not len(old) or not fresh.any():
        return np.ones(len(old), dtype=bool), fresh
    chosen = new[fresh]
    below = np.ones((len(old), len(chosen)), dtype=bool)  # old not above new in any cost
    above = np.ones_like(below)
    for column in range(new.shape[1]):
        one, other = old[:, column, None], chosen[None, :, column]
        below &= one <= other
        above &= one >= other
    fresh[np.flatnonzero(fresh)[below.any(axis=0)]] = False
    return np.all(below | ~above, axis=1), fresh


def crowding(costs: Float[Array, "m q"]) -> Float[Array, " m"]:
    """Crowding distance of each member of a front; infinite at the extremes.

    Notes
    -----
    Deb, Pratap, Agarwal & Meyarivan (2002).

    Examples
    --------
    >>> crowding(np.array([[0.0, 1.0], [0.1, 0.5], [0.2, 0.4], [1.0, 0.0]]))
    array([inf, 0.8, 1.4, inf])
    """
    distance = np.zeros(len(costs))
    for column in costs.T:
        order = np.argsort(column, kind="stable")
        span = column[order[-1]] - column[order[0]]
        distance[order[[0, -1]]] = np.inf
        if span > 0:
            distance[order[1:-1]] += (column[order[2:]] - column[order[:-2]]) / span
    return distance


def thinned(costs: Float[Array, "m q"], most: int) -> Int64[Array, " k"]:
    """Indices of at most ``most`` members of a front, the most crowded ones dropped in rounds."""
    left = np.arange(len(costs))
    while left.size > most:
        surplus = left.size - most
        dropped = np.argsort(crowding(costs[left]), kind="stable")[: max(1, int(_ROUND * surplus))]
        left = np.delete(left, dropped)
    return left


def scaled(costs: Float[Array, "m q"]) -> Float[Array, "m q"]:
    """Costs from 0, the lowest of the front, to 1, the highest; 0 where all are equal."""
    low, high = costs.min(axis=0), costs.max(axis=0)
    return (costs - low) / np.where(high > low, high - low, 1.0)


def hypervolume(
    costs: Float[Array, "m q"], best: Float[Array, " q"], reference: Float[Array, " q"]
) -> float:
    """Share of the box between two points that the costs dominate. [1]

    Parameters
    ----------
    costs
        Lower is better; a point outside the box counts as its projection onto the box.
    best, reference
        The lowest and the highest corner of the box.

    Notes
    -----
    Zitzler & Thiele (1998); Fonseca, Paquete & Lopez-Ibanez (2006) in pymoo for three and more.

    Examples
    --------
    >>> round(hypervolume(np.array([[0.0, 0.5], [0.5, 0.0]]), np.zeros(2), np.ones(2)), 12)
    0.75
    """
    span = np.where(reference > best, reference - best, 1.0)
    share = np.maximum((costs - best) / span, 0.0)
    share = share[(share < 1).all(axis=1)]
    if not len(share):
        return 0.0
    share = share[non_dominated(share)]
    if share.shape[1] == 2:
        first, second = share[np.argsort(share[:, 0])].T
        return float(np.sum(np.diff(np.append(first, 1.0)) * (1.0 - second)))
    from pymoo.indicators.hv import Hypervolume

    return float(Hypervolume(ref_point=np.ones(share.shape[1]))(share))


def extremes(costs: Float[Array, "m q"]) -> Int64[Array, " q"]:
    """Index of the member with the lowest cost of each objective; of equal ones the best sum."""
    total = scaled(costs).sum(axis=1)
    return np.array([np.lexsort((total, column))[0] for column in costs.T])


def knee(costs: Float[Array, "m q"]) -> int:
    """Index of the member farthest below the plane through the extremes of the scaled front.

    Notes
    -----
    Das, "On characterizing the knee of the Pareto curve" (1999). With two objectives the extremes
    lie at (0, 1) and (1, 0), so the member of the lowest sum of scaled costs is the farthest.
    """
    return int(np.argmin(scaled(costs).sum(axis=1)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Member:
    """One design on the front.

    Attributes
    ----------
    name
        Such as ``best-snr_y_db``, ``knee`` or ``member-07``.
    values
        Of the parameters, each in its unit.
    sensor
        The sensor of these values, or ``None`` if the caller made none.
    objectives
        Value by name, in the objective's own unit.
    extreme_of
        The objectives of which no other member has a better value.
    knee
        Whether it is the knee of the front.
    active
        The constraints that hold it: their slack is at most 1 % of the largest on the front.
    """

    name: str
    values: Float[Array, " d"]
    sensor: Any
    objectives: Mapping[str, float]
    extreme_of: tuple[str, ...]
    knee: bool
    active: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Front:
    """The members of a front, ordered by the first objective, the best first.

    Attributes
    ----------
    objectives
        Names of the objectives.
    better
        ``higher`` or ``lower``, per objective.
    members
        At least one.
    """

    objectives: tuple[str, ...]
    better: tuple[str, ...]
    members: tuple[Member, ...]

    @property
    def knee(self) -> Member:
        """The knee of the front."""
        return next(member for member in self.members if member.knee)

    def best(self, objective: str) -> Member:
        """The member with the best value of an objective.

        Parameters
        ----------
        objective
            Name of the objective.
        """
        return next(member for member in self.members if objective in member.extreme_of)


def front_of(
    problem: Problem,
    values: Float[Array, "k d"],
    objectives: Float[Array, "k q"],
    violation: Float[Array, "k r"],
    *,
    most: int = 100,
    sensor_of: Callable[[Array, str], Any] | None = None,
) -> Front:
    """The front of evaluated designs, thinned and named.

    Parameters
    ----------
    problem
        For the names and the better sides.
    values, objectives, violation
        As in `chromanoise.design.search.FrontResult`.
    most
        Largest number of members; extremes and knee are always kept.
    sensor_of
        The sensor of values (d,) and a name.
    """
    costs = problem.costs(objectives)
    best, middle = extremes(costs), knee(costs)
    chosen = np.unique([*thinned(costs, most), *best, middle])
    order = chosen[np.lexsort((*costs[chosen].T[::-1],))]
    slack = -violation
    held = slack <= _HELD * np.maximum(slack.max(axis=0, initial=0.0), 0.0)
    digits = len(str(len(order)))
    members = []
    for number, index in enumerate(order, start=1):
        extreme_of = tuple(
            name for name, one in zip(problem.objectives, best, strict=True) if one == index
        )
        name = _name(extreme_of, bool(index == middle), f"member-{number:0{digits}}")
        members.append(
            Member(
                name=name,
                values=values[index],
                sensor=sensor_of(values[index], name) if sensor_of else None,
                objectives=dict(zip(problem.objectives, objectives[index].tolist(), strict=True)),
                extreme_of=extreme_of,
                knee=bool(index == middle),
                active=tuple(
                    one for one, on in zip(problem.constraints, held[index], strict=True) if on
                ),
            )
        )
    return Front(objectives=problem.objectives, better=problem.better, members=tuple(members))


def _name(extreme_of: Sequence[str], is_knee: bool, otherwise: str) -> str:
    if extreme_of:
        return f"best-{'-'.join(extreme_of)}"
    return "knee" if is_knee else otherwise


LARGEST = 1000
"""Most members of a final front."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Archive:
    """The front of all evaluated candidates, and the smallest violations of the constraints.

    Attributes
    ----------
    values, objectives, violation
        Of the members. Those with the lowest crowding distance are dropped when there are more
        than 2,000, down to 1,000.
    nearest
        Violations of the candidate that has met the constraints best so far.
    least
        Lowest violation of each constraint by any candidate.
    """

    values: Float[Array, "k d"]
    objectives: Float[Array, "k q"]
    violation: Float[Array, "k r"]
    nearest: Float[Array, " r"]
    least: Float[Array, " r"]

    def joined(self, problem: Problem, values: Float[Array, "m d"], found: Evaluated) -> "Archive":
        """The archive after a generation."""
        feasible = misses_of(problem, found) == 0
        costs = problem.costs(found.objectives)
        old = problem.costs(self.objectives)
        kept, fresh = merged(old, costs[feasible])
        costs = np.concatenate([old[kept], costs[feasible][fresh]])
        chosen = thinned(costs, LARGEST) if len(costs) > 2 * LARGEST else np.arange(len(costs))

        def together(own: Array, new: Array) -> Array:
            return np.concatenate([own[kept], new[feasible][fresh]])[chosen]

        sums = problem.misses(found.violation)
        best = found.violation[np.argmin(sums)]
        nearer = sums.min() < problem.misses(self.nearest[None])[0]
        return Archive(
            values=together(self.values, values),
            objectives=together(self.objectives, found.objectives),
            violation=together(self.violation, found.violation),
            nearest=best if nearer else self.nearest,
            least=np.minimum(self.least, found.violation.min(axis=0)),
        )

    def thinned(self, problem: Problem) -> "Archive":
        """The archive with at most `LARGEST` members."""
        chosen = thinned(problem.costs(self.objectives), LARGEST)
        return replace(
            self,
            values=self.values[chosen],
            objectives=self.objectives[chosen],
            violation=self.violation[chosen],
        )


def empty_archive(problem: Problem) -> Archive:
    """The archive before the first generation."""
    d, q, r = len(problem.names), len(problem.objectives), len(problem.constraints)
    return Archive(
        values=np.empty((0, d)),
        objectives=np.empty((0, q)),
        violation=np.empty((0, r)),
        nearest=np.full(r, np.inf),
        least=np.full(r, np.inf),
    )


def misses_of(problem: Problem, found: Evaluated) -> Float[Array, " m"]:
    """`Problem.misses` of each candidate, and 1 for each infinite objective."""
    return problem.misses(found.violation) + (~np.isfinite(found.objectives)).sum(axis=1)
