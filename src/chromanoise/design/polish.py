"""Improvement of candidates by exact gradients, under the constraints.

A descent repeats short runs of SLSQP in a box around the best point so far. After each run it
evaluates points between the start and the end of the run, because an evaluation costs much less
than a gradient, and moves the end onto the constraints that it breaks by little. The box shrinks
where the linearizations are poor. A constraint on the least of several distances is a constraint on
each distance within reach, because the least one has kinks.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import zip_longest

import numpy as np

from chromanoise._check import Array
from chromanoise._linalg import lstsq
from chromanoise._shapes import Float, Int64
from chromanoise.design.front import extremes, knee, misses_of, non_dominated, thinned
from chromanoise.design.problem import Evaluated, Problem, checked_evaluation

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
